"""A sled on rubber: a mass, pulled over the road by a spring, on the FMU of a layer or of an element.

    sled.py MODEL.fmu DEPTH -o RESULT.csv [--step H]

The carrier is pressed down by DEPTH (m) at 0.05 m/s. Then the spring's other end moves along the road. In each step
the master moves the sled first, then gives the FMU the present displacements and their rates over the step. The force at
the end of the step acts on the sled in the next one.
"""

import argparse
import csv
import shutil

import fmpy
from fmpy.fmi2 import FMU2Slave

MASS = 0.02  # kg
SPRING = 5.0e3  # N/m
DAMPER = 4.0  # N s/m
SPEED = 0.5  # m/s, of the spring's other end
PRESS_SPEED = 0.05  # m/s
DURATION = 0.02  # s, of the pull


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmu")
    parser.add_argument("depth", type=float)
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--step", type=float, default=1e-5)
    arguments = parser.parse_args()

    description = fmpy.read_model_description(arguments.fmu)
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    inputs = [reference["u"], reference["w"]]
    outputs = [reference["F_x"], reference["F_z"]]
    folder = fmpy.extract(arguments.fmu)
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="layer",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()

    t, h, rows = 0.0, arguments.step, []
    press = arguments.depth / PRESS_SPEED
    u, v, force_x = 0.0, 0.0, 0.0
    while t < press + DURATION:
        pulled = max(t + h - press, 0.0)
        if pulled > 0.0:
            v += h / MASS * (SPRING * (SPEED * pulled - u) + DAMPER * (SPEED - v) + force_x)
        w, next_w = (max(-arguments.depth, -PRESS_SPEED * at) for at in (t, t + h))
        # The present values, and the rates over the step: the FMU follows this motion exactly.
        fmu.setReal(inputs, [u, w])
        fmu.setRealInputDerivatives(inputs, [1, 1], [v, (next_w - w) / h])
        fmu.doStep(currentCommunicationPoint=t, communicationStepSize=h)
        force_x, force_z = fmu.getReal(outputs)
        u, t = u + h * v, t + h
        rows.append((t, u, v, force_x, force_z))

    fmu.terminate()
    fmu.freeInstance()
    shutil.rmtree(folder)
    with open(arguments.output, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["time", "u", "speed", "F_x", "F_z"])
        writer.writerows(rows)
    last = rows[len(rows) // 2 :]
    friction = -sum(row[3] for row in last) / sum(row[4] for row in last)
    pressing = sum(row[4] for row in last) / len(last)
    print(f"{len(rows)} steps; in the second half F_z is {pressing:.2f} N and -F_x/F_z {friction:.3f}")


main()
