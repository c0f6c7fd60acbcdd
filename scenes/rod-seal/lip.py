"""The total pressure on the lip over its width at four sealed pressures, as of a finite element run: lip.csv.

A steep rise from the sealed side to a peak at a quarter of the width and a shallow fall to the air, of the pressure with
which the lip is fitted (2 MPa at its peak, and 30 % of the sealed pressure more), beside the sealed pressure itself, which
falls to 0 under the lip.
"""

import csv
import sys

WIDTH, PEAK = 1.0e-3, 0.25  # m, share of the width
FITTED, ENERGISED = 2.0e6, 0.3  # Pa, 1
POINTS = 101


def smooth(s):
    """From 0 to 1 with level ends."""
    return s * s * (3.0 - 2.0 * s)


def pressure(x, sealed):
    rise = smooth(x / PEAK) if x < PEAK else smooth((1.0 - x) / (1.0 - PEAK))
    return sealed * (1.0 - smooth(x)) + (FITTED + ENERGISED * sealed) * rise


writer = csv.writer(sys.stdout, lineterminator="\n")
writer.writerow(["sealed_pressure [Pa]", "x [m]", "pressure [Pa]"])
for sealed in (0.0, 2.5e6, 5.0e6, 1.0e7):
    for i in range(POINTS):
        x = i / (POINTS - 1)
        writer.writerow([f"{sealed:g}", f"{x * WIDTH:.3g}", f"{pressure(x, sealed):.6g}"])
