"""Strokes of the rod under the seal's FMU, by fmpy: strokes.py SEAL.fmu FOLDER

Two strokes of 10 mm to and fro, as a sine, at largest speeds of 1, 10 and 100 mm/s after a rest, 5 MPa sealed: FOLDER gets
loop-SPEED.csv, with the displacement, the force on the rod and what leaked in mm³, and motion-SPEED.csv.
"""

import csv
import math
import sys
from pathlib import Path

import numpy as np
from fmpy import simulate_fmu

STROKE, SEALED, ROWS = 10e-3, 5e6, 400  # m, Pa, rows of a stroke
OUTPUTS = ["F_x", "film.leak", "film.thickness", "contact.share"]


def loop(fmu, speed):
    """Time, u and the outputs of two strokes."""
    period = math.pi * STROKE / speed
    time = np.linspace(0.0, 2.0 * period, 2 * ROWS + 1)
    u = 0.5 * STROKE * (1.0 - np.cos(2.0 * np.pi * time / period))
    given = np.zeros(time.size, [("time", float), ("u", float), ("sealed_pressure", float)])
    given["time"], given["u"], given["sealed_pressure"] = time, u, SEALED
    # fmpy gives the rates of what goes straight from row to row: the FMU follows that exactly.
    result = simulate_fmu(
        fmu, start_values={"sealed_pressure": SEALED}, input=given, output=OUTPUTS, output_interval=time[1],
        step_size=time[1], stop_time=time[-1], relative_tolerance=1e-3,
    )
    return result["time"], np.interp(result["time"], time, u), [result[name] for name in OUTPUTS]


def main():
    fmu, folder = sys.argv[1], Path(sys.argv[2])
    for speed in (1e-3, 1e-2, 1e-1):
        time, u, outputs = loop(fmu, speed)
        name = f"loop-{1e3 * speed:g}mm.csv"
        with (folder / name).open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["time", "u", "F_x", "leak in mm³", *OUTPUTS[2:]])
            writer.writerows(zip(time, u, outputs[0], 1e9 * outputs[1], *outputs[2:]))
        with (folder / f"motion-{1e3 * speed:g}mm.csv").open("w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([["time", "u", "sealed_pressure"], *zip(time, u, [SEALED] * len(u))])
        force, leak = outputs[0], outputs[1]
        half = len(u) // 2
        print(
            f"{1e3 * speed:5g} mm/s: breaks away at {max(abs(force[: half // 4])):.1f} N, slides at "
            f"{abs(force[half + half // 4]):.2f} N out at mid stroke; two strokes leak {1e9 * leak[-1]:.3g} mm3"
        )


main()
