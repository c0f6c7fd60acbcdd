"""Drives an FMU along a motion given as a CSV file and writes what it answers.

    drive.py MODEL.fmu MOTION.csv -o RESULT.csv [--set NAME=VALUE ...] [--jump TIME:NAME=VALUE ...]

MOTION.csv has the column time and those of the FMU's inputs; others are ignored, and an input without a column is 0. The
communication points are its times. The motion between them is straight, and the FMU is told so: by the values at a row and
the rates to the next. A row at a jump holds the value before it, --jump the one after it.
"""

import argparse
import shutil
import sys

import fmpy
from fmpy.fmi2 import FMU2Slave

from tables import read_motion, write


def rates(motion, i):
    """The rates from row i to the next; after the last, none."""
    if i + 1 == len(motion):
        return [0.0] * (len(motion[i]) - 1)
    (t0, *here), (t1, *there) = motion[i], motion[i + 1]
    return [(b - a) / (t1 - t0) for a, b in zip(here, there)]


class Slave:
    """An FMU, unpacked and instantiated, with its variables by name."""

    def __init__(self, path, parameters):
        self.description = fmpy.read_model_description(path)
        self.folder = fmpy.extract(path)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.outputs = [v for v in self.description.modelVariables if v.causality in ("output", "local")]
        self.names = [v.name for v in self.description.modelVariables if v.causality == "input"]
        self.inputs = [self.variables[name].valueReference for name in self.names]
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="driven",
        )
        self.fmu.instantiate()
        for name, value in parameters:
            self.set(self.variables[name], value)

    def set(self, variable, text):
        """Sets a parameter from its text."""
        reference = [variable.valueReference]
        if variable.type == "Real":
            self.fmu.setReal(reference, [float(text)])
        elif variable.type == "Integer":
            self.fmu.setInteger(reference, [int(text)])
        else:
            self.fmu.setString(reference, [text])

    def move(self, row, rate):
        """Tells the FMU where the carrier is and how fast it goes on."""
        self.fmu.setReal(self.inputs, list(row[1:]))
        self.fmu.setRealInputDerivatives(self.inputs, [1] * len(self.inputs), rate)

    def after_jumps(self, row, jumps):
        """The row with the values that inputs jump to at its time."""
        values = list(row)
        for time, name, value in jumps:
            if abs(time - row[0]) <= 1e-9 * abs(time):
                values[1 + self.names.index(name)] = value
        return tuple(values)

    def values(self):
        """The outputs, in the order of the model description."""
        found = {}
        for kind, get in (("Real", self.fmu.getReal), ("Integer", self.fmu.getInteger)):
            references = [v.valueReference for v in self.outputs if v.type == kind]
            if references:
                found.update(((kind, r), value) for r, value in zip(references, get(references)))
        return [found[v.type, v.valueReference] for v in self.outputs]

    def run(self, motion, jumps=()):
        """Yields the outputs at every row of the motion."""
        self.fmu.setupExperiment(startTime=motion[0][0], stopTime=motion[-1][0])
        self.fmu.enterInitializationMode()
        self.move(motion[0], rates(motion, 0))
        self.fmu.exitInitializationMode()
        yield self.values()
        for i in range(len(motion) - 1):
            time = motion[i][0]
            start = self.after_jumps(motion[i], jumps)
            self.move(start, rates([start, motion[i + 1]], 0))
            self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=motion[i + 1][0] - time)
            yield self.values()
        self.fmu.terminate()

    def close(self):
        """Frees the instance and what was unpacked."""
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def drive(fmu, path, parameters=(), jumps=()):
    """The names of inputs and outputs, and their values at every row of the motion."""
    slave = Slave(fmu, parameters)
    try:
        motion = read_motion(path, slave.names)
        rows = [[*here, *values] for here, values in zip(motion, slave.run(motion, jumps))]
        return [*slave.names, *(variable.name for variable in slave.outputs)], rows
    finally:
        slave.close()


def jump(text):
    """A jump as TIME:NAME=VALUE."""
    time, rest = text.split(":", 1)
    name, value = rest.split("=", 1)
    return float(time), name, float(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmu", metavar="MODEL.fmu")
    parser.add_argument("motion", metavar="MOTION.csv")
    parser.add_argument("-o", "--output", required=True, metavar="RESULT.csv")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--jump", action="append", default=[], type=jump, metavar="TIME:NAME=VALUE")
    arguments = parser.parse_args()
    parameters = [tuple(text.split("=", 1)) for text in arguments.set]
    names, rows = drive(arguments.fmu, arguments.motion, parameters, arguments.jump)
    write(arguments.output, ["time", *names], rows)


if __name__ == "__main__":
    sys.exit(main())
