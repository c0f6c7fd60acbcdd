"""A wheel that brakes on a slope of 5° and is held there: how masters of the patch's FMU let it stand.

    slope.py TREAD.fmu [--step H] [--end T]

TREAD.fmu is that of scenes/patch-mujoco/tread.toml. A wheel of 100 kg rolls down at 5 m/s, pressed in by a fixed depth,
brakes and stands with its brake locked. Each master writes slope-MASTER.csv: for a second as the wheel stops, where it
is along the slope (m), the force of the ground along it (N) and what is lost (J).
"""

import argparse
import csv
import math
import shutil

import fmpy
from fmpy.fmi2 import FMU2Slave

MASS, INERTIA, RADIUS = 100.0, 1.0, 0.3  # kg, kg m², m
DRIVE = MASS * 9.81 * math.sin(math.radians(5.0))  # N
BRAKE = 400.0  # N m, from 0.5 s on, within 0.1 s
TOUCH, PRESSED = 0.30048, 0.298  # m, of the axle
INPUTS, OUTPUTS = ("x", "z", "transport.speed"), ("force.x", "transport.force", "E_diss")
# Jacobi masters, which step wheel and patch at once: with values alone, held or not, with rates, and with values alone on
# rubber that has a loss (s).
MASTERS = {"values": ("linear", 0.0), "hold": ("hold", 0.0), "rates": ("linear", 0.0), "damped": ("linear", 1e-3)}


def height(time):
    return TOUCH + (PRESSED - TOUCH) * min(1.0, time / 0.2)


def move(state, force, time, h):
    """The wheel under the force of the ground and on its tread."""
    x, v, omega = state
    v += h / MASS * (DRIVE + force[0])
    omega += h / INERTIA * RADIUS * force[1]
    brake = h / INERTIA * BRAKE * min(1.0, max(0.0, (time - 0.5) / 0.1))
    omega -= math.copysign(min(abs(omega), brake), omega)
    return x + h * v, v, omega


def run(description, folder, master, h, end):
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=master,
    )
    reference = {variable.name: variable.valueReference for variable in description.modelVariables}
    inputs, outputs = ([reference[name] for name in names] for names in (INPUTS, OUTPUTS))
    fmu.instantiate()
    extrapolation, damping = MASTERS[master]
    fmu.setString([reference["input.extrapolation"]], [extrapolation])
    fmu.setReal([reference["patch.damping"]], [damping])
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    state = (0.0, 5.0, 5.0 / RADIUS)
    fmu.setReal(inputs, [0.0, TOUCH, 5.0])
    fmu.exitInitializationMode()
    force, before, omega_before, rows = (0.0, 0.0), (0.0, 0.0), state[2], []
    for k in range(round(end / h)):
        time = k * h
        fmu.setReal(inputs, [state[0], height(time), RADIUS * state[2]])
        slopes = (0.0, 0.0)
        if master == "rates":
            rates = [state[1], (height(time + h) - height(time)) / h, RADIUS * (state[2] - omega_before) / h]
            fmu.setRealInputDerivatives(inputs, [1, 1, 1], rates)
            slopes = tuple((now - then) / h for now, then in zip(force, before))
        omega_before = state[2]
        for i in range(10):
            part = (i + 0.5) * h / 10
            here = tuple(now + slope * part for now, slope in zip(force, slopes))
            state = move(state, here, time + part, h / 10)
        fmu.doStep(time, h)
        before, (*force, lost) = force, fmu.getReal(outputs)
        rows.append((time + h, state[0], force[0], lost))
    fmu.terminate()
    fmu.freeInstance()
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmu")
    parser.add_argument("--step", type=float, default=1e-3)
    parser.add_argument("--end", type=float, default=12.0)
    arguments = parser.parse_args()
    description = fmpy.read_model_description(arguments.fmu)
    folder = fmpy.extract(arguments.fmu)
    for master in MASTERS:
        rows = run(description, folder, master, arguments.step, arguments.end)
        stands = [row for row in rows if row[0] > arguments.end - 2.0]
        places = [row[1] for row in stands]
        swing, lost = max(places) - min(places), stands[-1][3] - stands[0][3]
        print(f"{master:7} x {places[-1]:.6f} m, swings by {swing:.2e} m and loses {0.5 * lost:.2e} W in the last 2 s")
        with open(f"slope-{master}.csv", "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["time", "x", "F_x", "E_diss"])
            writer.writerows(row for row in rows if 1.4 <= row[0] <= 2.4)
    shutil.rmtree(folder)


main()
