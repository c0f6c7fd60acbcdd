"""What the scripts that run an FMU in a master have in common: arguments, the FMU's variables, the result file.

The motion's rows lie evenly in time. At each the master gives the FMU the inputs that the motion has, without rates, and
does a step to the next; the result file has a row for the end of each step.
"""

import argparse
import zipfile
from xml.etree import ElementTree

from tables import names_of, read_motion, write


def variables(fmu, causality, kind):
    """The names and value references of the FMU's inputs or outputs of the type "Real" or "Integer"."""
    with zipfile.ZipFile(fmu) as archive:
        description = ElementTree.fromstring(archive.read("modelDescription.xml"))
    found = description.iterfind(f"ModelVariables/ScalarVariable[@causality='{causality}']")
    return {v.get("name"): int(v.get("valueReference")) for v in found if v.find(kind) is not None}


def run(simulate, description):
    """Runs `simulate(fmu, step, inputs, reals, integers)`, where `inputs` has the inputs' values by name for each step. It
    yields a row after each step: the time, the outputs `reals` and the outputs `integers`."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmu", metavar="MODEL.fmu")
    parser.add_argument("motion", metavar="MOTION.csv")
    parser.add_argument("-o", "--output", required=True, metavar="RESULT.csv")
    arguments = parser.parse_args()
    names = names_of(arguments.motion)
    motion = read_motion(arguments.motion, names)
    reals, integers = (variables(arguments.fmu, "output", kind) for kind in ("Real", "Integer"))
    inputs = [dict(zip(names, row[1:])) for row in motion[:-1]]
    rows = simulate(arguments.fmu, motion[1][0] - motion[0][0], inputs, reals, integers)
    write(arguments.output, ["time", *reals, *integers], rows)
