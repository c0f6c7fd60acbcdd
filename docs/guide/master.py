"""A small master for any FMU of asperity: along a motion that is straight from row to row, with the rates that it has."""

import shutil

import fmpy
from fmpy.fmi2 import FMU2Slave


def follow(fmu_file, motion, outputs=("F_x", "F_z")):
    """The outputs at the rows of `motion`, a structured array with the column time and one for each input."""
    model, folder = fmpy.read_model_description(fmu_file), fmpy.extract(fmu_file)
    reference = {variable.name: variable.valueReference for variable in model.modelVariables}
    names = [name for name in motion.dtype.names if name != "time"]
    inputs, wanted = [reference[name] for name in names], [reference[name] for name in outputs]
    identifier = model.coSimulation.modelIdentifier
    fmu = FMU2Slave(guid=model.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="layer")
    fmu.instantiate()
    fmu.setupExperiment(startTime=motion["time"][0])
    fmu.enterInitializationMode()
    fmu.setReal(inputs, [motion[name][0] for name in names])
    fmu.exitInitializationMode()
    rows = [fmu.getReal(wanted)]
    for here, there in zip(motion, motion[1:]):
        h = there["time"] - here["time"]
        fmu.setReal(inputs, [here[name] for name in names])
        fmu.setRealInputDerivatives(inputs, [1] * len(inputs), [(there[name] - here[name]) / h for name in names])
        fmu.doStep(here["time"], h)
        rows.append(fmu.getReal(wanted))
    fmu.terminate()
    fmu.freeInstance()
    shutil.rmtree(folder)
    return rows
