"""Shows a result file: a table of the forces, the contact and the losses at several times, and a picture.

    show.py RESULT.csv -o PICTURE.png [--title TITLE] [--against OTHER.csv]

With --against, also how far the columns F_x, F_z and E_diss of the two files lie apart.
"""

import argparse
import csv
import math
from bisect import bisect_left

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import EngFormatter, MaxNLocator

TABLE = ["time", "u", "w", "F_x", "F_z", "contact.count", "contact.sticking", "P_diss", "E_diss"]
UNITS = {"time": "s", "u": "m", "w": "m", "F_x": "N", "F_z": "N", "P_diss": "W", "E_diss": "J"}
TABLE_ROWS = 12
# Okabe and Ito's colours, told apart by colour-blind readers too.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#464646"]


def read(path):
    """The columns of a result file by name."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [float(row[name]) for row in rows] for name in rows[0]}


def print_table(columns):
    """The rows at, or just after, times evenly spread over the run."""
    names = [name for name in TABLE if name in columns]
    times = columns["time"]
    wanted = (times[0] + (times[-1] - times[0]) * i / TABLE_ROWS for i in range(TABLE_ROWS + 1))
    rows = sorted({min(bisect_left(times, time), len(times) - 1) for time in wanted})
    print(" ".join(f"{f'{name}/{UNITS[name]}' if name in UNITS else name:>16}" for name in names))
    for row in rows:
        print(" ".join(f"{columns[name][row]:16.6g}" for name in names))


def print_difference(columns, other):
    """The largest difference of each column over its largest value."""
    for name in ("F_x", "F_z", "E_diss"):
        if name in columns and name in other:
            largest = max(map(abs, other[name]))
            difference = max(abs(a - b) for a, b in zip(columns[name], other[name]))
            relative = difference / largest if largest else 0.0
            print(f"{name}: largest difference {difference:.2e}, {relative:.2e} of the largest value")


def panels(columns):
    """What each panel shows: label, unit, columns; a panel without columns is left out."""
    channels = ["E_diss", *(name for name in columns if name.startswith("dissipation."))]
    wanted = [
        ("force on the carrier", "N", ["F_x", "F_z"]),
        ("masses", "", ["contact.count", "contact.sticking"]),
        ("energy lost", "J", channels),
    ]
    found = [(label, unit, [name for name in names if name in columns]) for label, unit, names in wanted]
    return [panel for panel in found if panel[2]]


def draw(columns, path, title):
    """The panels above one another, over time."""
    shown = panels(columns)
    figure, axes = plt.subplots(
        len(shown), 1, figsize=(9, 1 + 2.6 * len(shown)), sharex=True, squeeze=False, layout="constrained"
    )
    for ax, (label, unit, names) in zip(axes[:, 0], shown):
        draw_panel(ax, columns, label, unit, names)
    axes[-1, 0].set_xlabel("time")
    axes[-1, 0].xaxis.set_major_formatter(EngFormatter("s"))
    axes[-1, 0].set_xlim(columns["time"][0], columns["time"][-1])
    figure.suptitle(title)
    figure.savefig(path, dpi=150)


def draw_panel(ax, columns, label, unit, names):
    counts = unit == ""
    for name, colour in zip(names, COLOURS):
        style = "steps-pre" if counts else "default"
        ax.plot(columns["time"], columns[name], label=name, color=colour, linewidth=1.6, drawstyle=style)
    ax.set_ylabel(label)
    ax.yaxis.set_major_locator(MaxNLocator(nbins=6, integer=counts))
    if not counts:
        ax.yaxis.set_major_formatter(EngFormatter(unit))
    ax.grid(color="0.9")
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize="small")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", metavar="RESULT.csv")
    parser.add_argument("-o", "--output", required=True, metavar="PICTURE.png")
    parser.add_argument("--title", default="")
    parser.add_argument("--against", metavar="OTHER.csv")
    arguments = parser.parse_args()
    columns = read(arguments.result)
    print_table(columns)
    if arguments.against:
        print_difference(columns, read(arguments.against))
    if not all(math.isfinite(value) for column in columns.values() for value in column):
        raise SystemExit(f"{arguments.result}: a value is not finite")
    if panels(columns):
        draw(columns, arguments.output, arguments.title)


if __name__ == "__main__":
    main()
