"""A piston that creeps, coupled to the seal's FMU: piston.py SEAL.fmu OUT.csv

Oil pushes a piston of 5 kg through its own stiffness, 2e5 N/m, at 0.2 mm/s after a rest, 5 MPa sealed. fmpy's FMU2Slave is
the seal; the piston is followed exactly under a force that goes straight on over each step (Jacobi with rates: docs/fmu.md,
"How to stand still"). OUT.csv has time, drive, u and F_x.
"""

import csv
import shutil
import sys

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

MASS, STIFFNESS, SPEED, SEALED = 5.0, 2e5, 2e-4, 5e6  # kg, N/m, m/s, Pa
H, END, PARTS = 1e-4, 8.0, 4  # s, s, parts of a step of the piston


def main():
    description, folder = read_model_description(sys.argv[1]), extract(sys.argv[1])
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    seal = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="seal",
    )
    inputs, outputs = [reference["u"], reference["sealed_pressure"]], [reference["F_x"]]
    seal.instantiate()
    seal.setupExperiment(startTime=0.0)
    seal.enterInitializationMode()
    seal.setReal(inputs, [0.0, SEALED])
    seal.exitInitializationMode()
    u, v, force, slope, rows = 0.0, 0.0, 0.0, 0.0, []
    for step in range(round(END / H)):
        time = step * H
        seal.setReal(inputs, [u, SEALED])
        seal.setRealInputDerivatives(inputs, [1, 1], [v, 0.0])
        for part in range(PARTS):
            at = (part + 0.5) * H / PARTS
            v += H / PARTS / MASS * (STIFFNESS * (SPEED * (time + at) - u) + force + slope * at)
            u += H / PARTS * v
        seal.doStep(time, H)
        (now,) = seal.getReal(outputs)
        slope, force = (now - force) / H, now
        rows.append((time + H, SPEED * (time + H), u, force))
    seal.terminate()
    seal.freeInstance()
    shutil.rmtree(folder)
    with open(sys.argv[2], "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time", "drive", "u", "F_x"])
        writer.writerows(rows)
    late = [row for row in rows if row[0] > 0.5 * END]
    speeds = [(after[2] - before[2]) / H for before, after in zip(late, late[1:])]
    print(f"In the last {0.5 * END:g} s the piston moves at {1e3 * min(speeds):.3f} to {1e3 * max(speeds):.3f} mm/s")


main()
