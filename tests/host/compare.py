"""Compares two result files of the same run.

    compare.py ONE.csv OTHER.csv

They have to have the same columns and rows and may differ by 1e-9 of each column's largest value, the residual of the
energy, a difference of large numbers, by 1e-9 of the largest energy; the processor's time is left out. Tells whether
they are the same bit for bit, else the column that differs most.

pow and sin are those of the platform's mathematical library: where they differ in the last digit, so do the step sizes.
glibc's pow takes another way on processors with FMA, unless GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2.
"""

import csv
import sys

TOLERANCE = 1e-9
LEFT_OUT = ["solver.run_time"]
SCALES = {"energy.residual": "energy.input"}


def read(path):
    """The columns by name."""
    with open(path, newline="") as file:
        names, *rows = csv.reader(file)
    columns = zip(*([float(field) for field in row] for row in rows), strict=True)
    return {name: column for name, column in zip(names, columns, strict=True) if name not in LEFT_OUT}


def error(one, other, scale):
    """The largest difference over the largest value in the scale; what is not a number differs from everything."""
    differences = [abs(a - b) for a, b in zip(one, other, strict=True) if a != b]
    if not all(difference < float("inf") for difference in differences):
        return float("inf")
    return max(differences) / (max(map(abs, scale)) or 1.0) if differences else 0.0


def main():
    one, other = map(read, sys.argv[1:])
    if list(one) != list(other):
        raise SystemExit("not the same columns")
    errors = {name: error(one[name], other[name], one[SCALES.get(name, name)]) for name in one}
    worst = max(errors, key=errors.get)
    same = errors[worst] == 0
    print("the same bit for bit" if same else f"{worst} differs most: {errors[worst]:.2e} of its largest value")
    if errors[worst] > TOLERANCE:
        raise SystemExit(f"more than {TOLERANCE:g}")


if __name__ == "__main__":
    main()
