"""What the master joins: FMUs with their variables by name."""

import shutil

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave

DISPLACEMENT, SPEED = ("u", "w"), ("u_rate", "w_rate")
FORCE, FORCE_RATE = ("F_x", "F_z"), ("F_x_rate", "F_z_rate")
TANGENT = ("tangent.dF_x_du", "tangent.dF_x_dw", "tangent.dF_z_du", "tangent.dF_z_dw")


class Slave:
    """An FMU, unpacked and instantiated."""

    def __init__(self, path: str):
        description = fmpy.read_model_description(path)
        identifier = description.coSimulation.modelIdentifier
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.folder = fmpy.extract(path)
        self.fmu = FMU2Slave(
            guid=description.guid, modelIdentifier=identifier, unzipDirectory=self.folder, instanceName=identifier
        )
        self.fmu.instantiate()

    def find(self, names) -> list:
        """The value references of variables."""
        return [self.references[name] for name in names]

    def set(self, names, values):
        self.fmu.setReal(self.find(names), list(values))

    def get(self, names) -> np.ndarray:
        return np.array(self.fmu.getReal(self.find(names)))

    def start(self, time: float):
        """Through the initialisation."""
        self.fmu.setupExperiment(startTime=time)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def step(self, time: float, h: float):
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=h)

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


class Body(Slave):
    """The body: takes forces, gives displacements."""

    def __init__(self, path: str, parameters: dict):
        super().__init__(path)
        self.set(parameters.keys(), parameters.values())

    def step_under(self, time: float, h: float, force, rate=(0.0, 0.0)):
        """Steps under a force that runs linearly; with no rate it is held."""
        self.set(FORCE + FORCE_RATE, [*force, *rate])
        self.step(time, h)

    def place(self) -> np.ndarray:
        return self.get(DISPLACEMENT)

    def speed(self) -> np.ndarray:
        return self.get(SPEED)


class Layer(Slave):
    """A layer below the body, or above it: mirrored in z."""

    def __init__(self, path: str, mirrored: bool, extrapolation: str):
        super().__init__(path)
        self.signs = np.array([1.0, -1.0 if mirrored else 1.0])
        self.fmu.setString(self.find(["input.extrapolation"]), [extrapolation])

    def step_along(self, time: float, h: float, place, rate=None):
        """Steps with the body at `place`, going on at `rate`; with none, as the layer's extrapolation says."""
        self.set(DISPLACEMENT, self.signs * place)
        if rate is not None:
            self.fmu.setRealInputDerivatives(self.find(DISPLACEMENT), [1, 1], list(self.signs * rate))
        self.step(time, h)

    def force(self) -> np.ndarray:
        """The force on the body."""
        return self.signs * self.get(FORCE)

    def force_rate(self) -> np.ndarray:
        return self.signs * self.fmu.getRealOutputDerivatives(self.find(FORCE), [1, 1])

    def tangent(self) -> np.ndarray:
        """The change of the force at the end of the last step with the place of the body there."""
        return np.outer(self.signs, self.signs) * self.get(TANGENT).reshape(2, 2)
