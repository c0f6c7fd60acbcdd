"""The patch's FMU as the master sees it."""

import shutil

import fmpy
from fmpy.fmi2 import FMU2Slave

POSE = ("x", "y", "z", "roll", "pitch", "yaw")
INPUTS = (*POSE, "transport.speed")
WRENCH = ("force.x", "force.y", "force.z", "moment.x", "moment.y", "moment.z")
CONTACT = ("contact.nominal_area", "contact.temperature_largest", "contact.temperature_mean")
OUTPUTS = (*WRENCH, "transport.force", "E_diss", *CONTACT)


class Patch:
    """An FMU, unpacked, instantiated with parameters and initialised."""

    def __init__(self, path, start, parameters):
        description = fmpy.read_model_description(path)
        references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.inputs, self.outputs = ([references[name] for name in names] for names in (INPUTS, OUTPUTS))
        self.folder = fmpy.extract(path)
        self.fmu = FMU2Slave(
            guid=description.guid,
            modelIdentifier=description.coSimulation.modelIdentifier,
            unzipDirectory=self.folder,
            instanceName="patch",
        )
        self.fmu.instantiate()
        self.fmu.setReal([references[name] for name in parameters], list(parameters.values()))
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        self.fmu.setReal(self.inputs, start)
        self.fmu.exitInitializationMode()

    def follow(self, time, h, start, end):
        """Steps along the straight way from one set of inputs to another."""
        self.fmu.setReal(self.inputs, start)
        self.fmu.setRealInputDerivatives(self.inputs, [1] * len(start), [(b - a) / h for a, b in zip(start, end)])
        self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=h)

    def values(self):
        """The outputs, by their names."""
        return dict(zip(OUTPUTS, self.fmu.getReal(self.outputs)))

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)
