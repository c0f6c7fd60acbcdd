"""Masters that give values alone, rates or values to be held: pressed by 10 um in 6 ms, slid, stopped, slid back, held.

    python stop.py stop.fmu      # writes stop-values.csv, stop-rates.csv, stop-hold.csv
"""

import csv
import shutil
import sys

import fmpy
from fmpy.fmi2 import FMU2Slave

STEP = 2e-3


# Times (s) and places (m) between which u and w go straight.
U = [(0, 0), (0.01, 0), (0.02, 2e-5), (0.026, 2e-5), (0.036, 0), (0.06, 0)]
W = [(0, 0), (0.006, -1e-5), (0.06, -1e-5)]


def at(corners, time):
    """The place at a time, and the rate just after it."""
    late = time + 1e-9
    (t_0, x_0), (t_1, x_1) = next(pair for pair in zip(corners, corners[1:]) if late < pair[1][0])
    rate = (x_1 - x_0) / (t_1 - t_0)
    return x_0 + rate * (time - t_0), rate


def drive(model, folder, rates, extrapolation):
    """The times and F_x at the communication points."""
    reference = {variable.name: variable.valueReference for variable in model.modelVariables}
    inputs = [reference["u"], reference["w"]]
    identifier = model.coSimulation.modelIdentifier
    fmu = FMU2Slave(guid=model.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName="layer")
    fmu.instantiate()
    fmu.setupExperiment(startTime=0)
    fmu.enterInitializationMode()
    fmu.setString([reference["input.extrapolation"]], [extrapolation])
    fmu.exitInitializationMode()
    rows = [(0.0, 0.0)]
    for k in range(30):
        time = k * STEP
        (u, u_rate), (w, w_rate) = at(U, time), at(W, time)
        fmu.setReal(inputs, [u, w])
        if rates:
            fmu.setRealInputDerivatives(inputs, [1, 1], [u_rate, w_rate])
        fmu.doStep(time, STEP)
        rows.append((time + STEP, fmu.getReal([reference["F_x"]])[0]))
    fmu.terminate()
    fmu.freeInstance()
    return rows


if __name__ == "__main__":
    model, folder = fmpy.read_model_description(sys.argv[1]), fmpy.extract(sys.argv[1])
    for name, rates, extrapolation in [("values", False, "linear"), ("rates", True, "linear"), ("hold", False, "hold")]:
        with open(f"stop-{name}.csv", "w", newline="") as file:
            rows = drive(model, folder, rates, extrapolation)
            csv.writer(file).writerows([("time [s]", "F_x [N]"), *rows])
        print(f"{name:7} F_x at 22 ms {rows[11][1]:+.4f} N, at 28 ms {rows[14][1]:+.4f} N, at the end {rows[-1][1]:+.4f} N")
    shutil.rmtree(folder)
