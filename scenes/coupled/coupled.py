"""Runs the masters over ever shorter communication steps and shows how far they lie from the system solved as one.

    coupled.py FOLDER [--quick]

FOLDER holds body.fmu and the layers' FMUs (see run.sh); tables and picture go there. Four cases: `smooth`, the body on a
layer; `pair`, the body between two such layers; `stuck`, on masses that stick; `rough`, with friction and loss of
contact. The first two are compared with the equations of the whole system solved by scipy; the third with inside.fmu,
in which the same body is the layer's own carrier; the last with the iterated master at a far shorter step.
"""

import argparse
import csv
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter

from body import PARAMETERS
from master import METHODS, Master
from monolith import System
from slaves import Body, Slave

# The same picture, the same bytes.
plt.rcParams.update({"svg.hashsalt": "coupled", "svg.fonttype": "none"})
HERE = Path(__file__).parent
DURATION, SETTLE = 5e-3, 1e-4
VARIANTS = [(method, rates) for rates in (False, True) for method in METHODS]
# Okabe and Ito's colours, told apart by colour-blind readers too.
COLOURS = dict(zip(METHODS, ["#0072B2", "#D55E00", "#009E73"]))


@dataclass
class Case:
    """A scene, the layers (whether each is mirrored) and what the body has instead of its defaults."""

    name: str
    scene: str
    mirrored: list
    body: dict = field(default_factory=dict)

    def reference(self, folder: Path, times: np.ndarray) -> np.ndarray:
        """u and w at the times; the equations to some 1e-8 of the largest."""
        if self.scene == "smooth":
            body = {name: start for name, (start, _) in PARAMETERS.items()} | self.body
            return System(HERE / "smooth.toml", self.mirrored, body).solve(SETTLE, times, 1e-7)
        if self.scene == "stuck":
            return inside(folder, times)
        fine = 4 * (len(times) - 1)
        return run(self, folder, "newton", True, fine)[0][::4]


def inside(folder: Path, times: np.ndarray) -> np.ndarray:
    """u and w at the times with the body inside the layer's FMU, its force in straight pieces of a tenth of a step."""
    values = {name: start for name, (start, _) in PARAMETERS.items()}
    pull = values["load_x"] * np.sin(2 * np.pi * values["frequency"] * np.linspace(times[0], times[-1], 10 * len(times) - 9))
    slave = Slave(folder / "inside.fmu")
    slave.start(times[0])
    h = (times[1] - times[0]) / 10
    places = [slave.get(("carrier.u", "carrier.w"))]
    for i, (start, end) in enumerate(zip(pull, pull[1:])):
        slave.set(("pull",), [start])
        slave.fmu.setRealInputDerivatives(slave.find(("pull",)), [1], [(end - start) / h])
        slave.step(times[0] + i * h, h)
        if i % 10 == 9:
            places.append(slave.get(("carrier.u", "carrier.w")))
    slave.close()
    return np.array(places)


CASES = [
    Case("smooth", "smooth", [False]),
    Case("pair", "smooth", [False, True], {"load_z": 0.5}),
    Case("stuck", "stuck", [False]),
    Case("rough", "rough", [False], {"load_x": 2.0}),
]


def run(case: Case, folder: Path, method: str, rates: bool, steps: int) -> tuple:
    """u and w at the communication points, and the energies received and given off there."""
    layers = [(folder / f"{case.scene}.fmu", mirrored) for mirrored in case.mirrored]
    master = Master(method, rates, Body(folder / "body.fmu", case.body), layers, DURATION / steps)
    master.start(SETTLE)
    places, energies = [master.body.place()], [master.energies()]
    for _ in range(steps):
        master.step()
        places.append(master.body.place())
        energies.append(master.energies())
    master.close()
    return np.array(places), np.array(energies)


def measure(case: Case, folder: Path, counts: list) -> tuple:
    """For each variant, over the numbers of steps: the relative errors of the place and defects of the energy."""
    times = np.linspace(0.0, DURATION, counts[-1] + 1)
    reference = case.reference(folder, times)
    found = [[compare(*run(case, folder, *variant, n), reference) for n in counts] for variant in VARIANTS]
    return np.moveaxis(np.array(found), 2, 0)


def compare(places, energies, reference) -> tuple:
    """The largest distance from the reference over the largest displacement, and alike for the energies."""
    wanted = reference[:: (len(reference) - 1) // (len(places) - 1)]
    error = np.linalg.norm(places - wanted, axis=1).max() / np.linalg.norm(wanted, axis=1).max()
    received, given = energies.T
    return error, np.abs(received - given).max() / np.abs(given).max()


def check_balance(folder: Path):
    """Between two layers and without a normal load, the body does not move in z at all."""
    case = Case("balanced", "smooth", [False, True], {"load_z": 0.0})
    for variant in VARIANTS:
        places, _ = run(case, folder, *variant, 50)
        if np.any(places[:, 1] != 0.0) or not np.any(places[:, 0]):
            raise SystemExit(f"{label(*variant)}: two layers that mirror each other move the body by {places}")


def label(method: str, rates: bool) -> str:
    return f"{method}_rates" if rates else method


def title(method: str, rates: bool) -> str:
    return f"{method}, {'rates' if rates else 'values only'}"


def order(h, values) -> float:
    """The slope over the two shortest steps."""
    return np.log(values[-2] / values[-1]) / np.log(h[-2] / h[-1])


def write(path: Path, h, table):
    """A table as a CSV file: h, then a column for each variant."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["h", *(label(*variant) for variant in VARIANTS)])
        writer.writerows([step, *row] for step, row in zip(h, np.transpose(table)))


def show(h, tables: dict):
    """The errors, and the defects at the shortest step, in Markdown."""
    print("| case | master | " + " | ".join(f"h = {step * 1e6:g} µs" for step in h) + " | order | defect | order |")
    print("|---" * (len(h) + 5) + "|")
    for case, (errors, defects) in tables.items():
        for variant, error, defect in zip(VARIANTS, errors, defects):
            numbers = [*(f"{value:.1e}" for value in error), f"{order(h, error):.2f}"]
            numbers += [f"{defect[-1]:.1e}", f"{order(h, defect):.2f}"]
            print(f"| {case} | {title(*variant)} | " + " | ".join(numbers) + " |")


def draw(path: Path, h, tables: dict):
    """For each case the errors and the defects over h."""
    figure, axes = plt.subplots(len(tables), 2, figsize=(9, 3.4 * len(tables)), squeeze=False, layout="constrained")
    for row, (name, pair) in zip(axes, tables.items()):
        for ax, what, table in zip(row, ("error of u and w", "energy defect at the coupling"), pair):
            draw_panel(ax, f"{name}: {what}", h, table)
    lines, names = axes[0, 0].get_legend_handles_labels()
    figure.legend(lines, names, loc="outside upper center", ncols=2, frameon=False, fontsize="small")
    figure.savefig(path, metadata={"Date": None})


def draw_panel(ax, heading: str, h, table):
    for (method, rates), values in zip(VARIANTS, table):
        style = "-" if rates else "--"
        ax.loglog(h, values, style, marker="o", markersize=3, color=COLOURS[method], label=title(method, rates))
    top = np.max(table[:, 0])
    for slope in (1, 2):
        guide = top * (np.array(h) / h[0]) ** slope
        ax.loglog(h, guide, ":", color="0.6")
        ax.annotate(f"h{'²' if slope == 2 else ''}", (h[-1], guide[-1]), color="0.4", ha="right")
    ax.set_title(heading, fontsize="medium")
    ax.set_xlabel("communication step in µs")
    ax.set_ylabel("share of the largest")
    ax.xaxis.set_major_formatter(FuncFormatter(lambda step, _: f"{1e6 * step:g}"))
    ax.grid(color="0.9")
    ax.spines[["top", "right"]].set_visible(False)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER", type=Path)
    parser.add_argument("--quick", action="store_true", help="fewer and longer steps, without the case `rough`")
    arguments = parser.parse_args()
    folder, quick = arguments.folder, arguments.quick
    check_balance(folder)
    counts = [50, 100, 200] if quick else [25, 50, 100, 200, 400, 800]
    h, tables = [DURATION / n for n in counts], {}
    for case in CASES[:3] if quick else CASES:
        errors, defects = tables[case.name] = measure(case, folder, counts)
        write(folder / f"{case.name}.errors.csv", h, errors)
        write(folder / f"{case.name}.defects.csv", h, defects)
    show(h, tables)
    draw(folder / "coupled.svg", h, tables)


if __name__ == "__main__":
    main()
