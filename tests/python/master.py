"""What the scripts that run an FMU in a master have in common: arguments, the FMU's outputs, the result file.

The motion's rows lie evenly in time. At each the master gives the FMU u and w, without rates, and does a step to the
next; the result file has a row for the end of each step.
"""

import argparse
import zipfile
from xml.etree import ElementTree

from tables import read_motion, write


def outputs(fmu, kind):
    """The names and value references of the FMU's outputs of the type "Real" or "Integer"."""
    with zipfile.ZipFile(fmu) as archive:
        description = ElementTree.fromstring(archive.read("modelDescription.xml"))
    variables = description.iterfind("ModelVariables/ScalarVariable[@causality='output']")
    return {v.get("name"): int(v.get("valueReference")) for v in variables if v.find(kind) is not None}


def run(simulate, description):
    """Runs `simulate(fmu, step, inputs, reals, integers)`. It yields a row after each step: the time, the outputs
    `reals` and the outputs `integers`."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmu", metavar="MODEL.fmu")
    parser.add_argument("motion", metavar="MOTION.csv")
    parser.add_argument("-o", "--output", required=True, metavar="RESULT.csv")
    arguments = parser.parse_args()
    motion = read_motion(arguments.motion)
    reals, integers = (outputs(arguments.fmu, kind) for kind in ("Real", "Integer"))
    inputs = [row[1:] for row in motion[:-1]]
    rows = simulate(arguments.fmu, motion[1][0] - motion[0][0], inputs, reals, integers)
    write(arguments.output, ["time", *reals, *integers], rows)
