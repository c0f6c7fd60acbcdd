"""The layer as a sweep sees it: an FMU that slides block by block and tells its means."""

import atexit
import functools
import shutil
import tempfile
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

INPUTS = ("u", "w")
# Sampled: their means. Added up by the FMU itself: the powers are differences of these energies.
SAMPLED = ("F_z", "friction.F_hysteresis", "friction.F_adhesion", "contact.ratio", "contact.area_real")
CHANNELS = ("damper", "maxwell", "friction", "impact")
ENERGIES = ("energy.input", *(f"dissipation.E_{channel}" for channel in CHANNELS))
TEMPERATURE = "material.wlf.temperature"


class Layer:
    """The FMU, unpacked and instantiated once; every run resets it."""

    def __init__(self, archive: bytes):
        self.folder = Path(tempfile.mkdtemp(prefix="sweep-"))
        atexit.register(shutil.rmtree, self.folder, ignore_errors=True)
        path = self.folder / "layer.fmu"
        path.write_bytes(archive)
        description = fmpy.read_model_description(str(path))
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.fmu = FMU2Slave(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=fmpy.extract(str(path), str(self.folder / "layer")),
            instanceName="layer",
        )
        self.fmu.instantiate()

    def start(self, w: float, speed: float, temperature: float | None):
        """At rest for long, pressed to w; the carrier then moves at once at the speed."""
        self.fmu.reset()
        if temperature is not None:
            self.fmu.setReal([self.references[TEMPERATURE]], [temperature])
        self.time, self.place, self.speed = 0.0, [0.0, w], speed
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.move()
        self.fmu.exitInitializationMode()

    def move(self):
        """Tells where the carrier is and that it goes straight on."""
        inputs = [self.references[name] for name in INPUTS]
        self.fmu.setReal(inputs, self.place)
        self.fmu.setRealInputDerivatives(inputs, [1, 1], [self.speed, 0.0])

    def step(self, duration: float):
        self.move()
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=duration)
        self.time += duration
        self.place[0] += self.speed * duration

    def get(self, names) -> np.ndarray:
        """The values of variables; those that the scene cannot have are NaN."""
        there = [self.references[name] for name in names if name in self.references]
        values = iter(self.fmu.getReal(there))
        return np.array([next(values) if name in self.references else np.nan for name in names])

    def block(self, length: float, samples: int) -> dict:
        """The means over a way of `length` at the speed."""
        duration, before, sums = length / self.speed, self.get(ENERGIES), np.zeros(len(SAMPLED))
        for _ in range(samples):
            self.step(duration / samples)
            sums += self.get(SAMPLED)
        power = (self.get(ENERGIES) - before) / duration
        load, hysteresis, adhesion, contact, area = sums / samples
        # The carrier's work is exact, whatever is between the samples.
        means = {"drag": power[0] / self.speed, "load": load, "hysteresis": -hysteresis, "adhesion": -adhesion}
        return means | {"contact": contact, "area": area} | dict(zip(CHANNELS, power[1:]))


@functools.lru_cache(maxsize=1)
def layer(archive: bytes) -> Layer:
    """The layer of this process: the points that it works at come one after another."""
    return Layer(archive)
