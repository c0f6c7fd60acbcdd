"""Motions of the carrier and result files, as the scripts read and write them."""

import csv


def read_motion(path):
    """The rows (time, u, w)."""
    with open(path, newline="") as file:
        return [tuple(float(row[name]) for name in ("time", "u", "w")) for row in csv.DictReader(file)]


def write(path, names, rows):
    """Writes a result file like the program's."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows(rows)
