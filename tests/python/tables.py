"""Motions of the carrier and result files, as the scripts read and write them."""

import csv


def names_of(path):
    """The names of the columns but the first, the time."""
    with open(path, newline="") as file:
        return next(csv.reader(file))[1:]


def read_motion(path, names=("u", "w")):
    """The rows: the time, then the inputs of these names, 0 where the file has no such column."""
    with open(path, newline="") as file:
        return [tuple(float(row.get(name, 0.0)) for name in ("time", *names)) for row in csv.DictReader(file)]


def write(path, names, rows):
    """Writes a result file like the program's."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(names)
        writer.writerows(rows)
