"""Friction over speed, pressure and temperature: the points of a sweep, each an FMU's runs, on the workers of Dask.

    sweep.py MODEL.fmu -o TABLE.csv --speeds 0.01..10/10 --pressures 1e5,2e5 [--temperatures 273.15,293.15]

By default the workers are processes of this machine, one a core; with --scheduler they are those of a cluster. The table has
the columns of `asperity sweep`. Points that are in it already are kept and not done again.
"""

import argparse
import csv
import hashlib
import itertools
import logging
import math
import os
import tomllib
import zipfile
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from distributed import Client, LocalCluster, as_completed

from layer import CHANNELS
from point import Point, Settings, solve

COLUMNS = {
    "speed": "m/s",
    "pressure": "Pa",
    "temperature": "K",
    "status": None,
    "friction": "1",
    "friction_standard_error": "1",
    "friction_hysteresis": "1",
    "friction_fine": "1",
    "friction_adhesion": "1",
    "mean_pressure": "Pa",
    "contact_ratio": "1",
    "area_real": "1",
    "flash_mean": "K",
    "surface_rise": "K",
    **{f"P_{channel}": "W" for channel in CHANNELS},
    "separation": "m",
    "tangential_stiffness": "N/m",
    "w": "m",
    "runs": "1",
    "time": "s",
}
HERE = Path(__file__).resolve().parent


class Model:
    """The scene in the FMU, as far as a sweep has to know it."""

    def __init__(self, path: Path):
        self.archive = path.read_bytes()
        with zipfile.ZipFile(path) as archive:
            name = next(name for name in archive.namelist() if name.startswith("resources/") and name.endswith(".toml"))
            self.scene = tomllib.loads(archive.read(name).decode())
            surface = self.scene["surface"]
            if surface["kind"] != "file" or not surface.get("periodic"):
                raise SystemExit("this example slides over a periodic profile from a file")
            if self.scene["layer"].get("foundation") != "half_space":
                raise SystemExit("this example slides a half-space")
            lines = archive.read(f"resources/{surface['path']}").decode().splitlines()
        self.x, self.z = np.loadtxt(lines, delimiter=",", skiprows=1, unpack=True)

    def settings(self, error: float) -> Settings:
        layer, material = self.scene["layer"], self.scene["material"]
        # The mean of a periodic spline over even points is that of the points.
        rest, heights, period = layer.get("clearance", 0.0), self.z[:-1], float(self.x[-1] - self.x[0])
        return Settings(
            area=layer["masses"] * layer["spacing"] * layer["width"],
            rest_separation=float(rest - heights.mean()),
            block=period,
            # One more than there are intervals, so that masses are seen at all places between the points.
            samples=min(max(len(self.x), 129), 2049),
            slowest=max(term["relaxation_time"] for term in material["prony"]),
            error=error,
            lifts=tuple(heights - rest),
            # A half-space against a wave as long as the period: half its wave number times the plane modulus.
            stiffness=math.pi / period * material["equilibrium_modulus"] / (1 - material["poisson_ratio"] ** 2),
        )

    def points(self, arguments) -> list:
        """By temperature, pressure, speed."""
        wlf = self.scene["material"].get("wlf")
        if arguments.temperatures and not wlf:
            raise SystemExit("--temperatures: the scene has no material.wlf")
        temperatures = arguments.temperatures or ([wlf["temperature"]] if wlf else [None])
        product = itertools.product(temperatures, arguments.pressures, arguments.speeds)
        return [Point(speed, pressure, temperature, slowing(wlf, temperature)) for temperature, pressure, speed in product]


def slowing(wlf, temperature) -> float:
    """a_T."""
    if temperature is None:
        return 1.0
    above = temperature - wlf["reference_temperature"]
    if wlf["c2"] + above <= 0:
        raise SystemExit(f"{temperature} K is below the pole of WLF")
    return 10 ** (-wlf["c1"] * above / (wlf["c2"] + above))


def values(text: str) -> list:
    """`0.01..10/10`, ten values evenly in the logarithm, or a list; rising, each once."""
    found = []
    for part in text.split(","):
        if ".." in part:
            ends, count = part.split("/")
            low, high = map(float, ends.split(".."))
            between = np.geomspace(low, high, int(count))[1:-1]
            found += [low, *(float(f"{value:.5e}") for value in between), high]
        else:
            found.append(float(part))
    if not all(0 < value < math.inf for value in found):
        raise argparse.ArgumentTypeError("expected positive numbers")
    return sorted(set(found))


class Table:
    """The file of the results: a header that tells one sweep from another, a line a point."""

    def __init__(self, path: Path, model: Model, settings: Settings, points: list):
        self.path, self.points = path, points
        names = ",".join(name if unit is None else f"{name} [{unit}]" for name, unit in COLUMNS.items())
        listed = {
            "speeds": ("m/s", {point.speed for point in points}),
            "pressures": ("Pa", {point.pressure for point in points}),
            "temperatures": ("K", {point.temperature for point in points} - {None}),
        }
        digest = hashlib.sha256(model.archive + repr(settings).encode()).hexdigest()[:32]
        comments = [
            "asperity sweep = 1",
            f"scene = {model.scene['name']}",
            f"fingerprint = {digest}",
            f"nominal_area = {settings.area!r} m2",
            f"rest_separation = {settings.rest_separation!r} m",
            *(f"{name} = {','.join(map(repr, sorted(all)))} {unit}" for name, (unit, all) in listed.items() if all),
        ]
        self.header = "".join(f"# {comment}\n" for comment in comments) + names + "\n"
        self.rows = self.read() if path.exists() else []

    def read(self) -> list:
        """The rows that are there already; a line that was being written as the writer was stopped counts not."""
        text = self.path.read_text()
        if not text.startswith(self.header):
            raise SystemExit(f"{self.path} is another sweep's table: take another name, or delete it")
        whole = text[len(self.header) : text.rfind("\n") + 1]
        rows = (zip(COLUMNS, fields) for fields in csv.reader(whole.splitlines()))
        return [{name: value(name, text) for name, text in row} for row in rows]

    def left(self) -> list:
        done = {key(row) for row in self.rows}
        return [point for point in self.points if (point.temperature, point.pressure, point.speed) not in done]

    def add(self, row: dict):
        self.rows.append(row)
        self.write()

    def write(self):
        """All rows in the order of the points, so that a reader never sees half a table."""
        order = {(point.temperature, point.pressure, point.speed): i for i, point in enumerate(self.points)}
        beside = self.path.with_name(self.path.name + ".part")
        with open(beside, "w", newline="") as file:
            file.write(self.header)
            writer = csv.writer(file, lineterminator="\n")
            for row in sorted(self.rows, key=lambda row: order[key(row)]):
                writer.writerow([field(row.get(name)) for name in COLUMNS])
        os.replace(beside, self.path)


def value(name: str, text: str):
    """What a field of the table says."""
    if name == "status" or not text:
        return text or None
    return int(text) if name == "runs" else float(text)


def key(row: dict) -> tuple:
    return row["temperature"], row["pressure"], row["speed"]


def field(value) -> str:
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return value if isinstance(value, str) else repr(value)


@contextmanager
def workers(scheduler: str | None, count: int | None):
    """A client of the cluster at `scheduler`, or of one of this machine's processes."""
    if scheduler:
        with Client(scheduler) as client:
            yield client
    else:
        # Processes of one thread each: every point has its own FMU, and Python one lock.
        with LocalCluster(n_workers=count, threads_per_worker=1, dashboard_address=None, silence_logs=logging.ERROR) as cluster:
            with Client(cluster) as client:
                yield client


def run(client: Client, model: Model, settings: Settings, table: Table):
    """Sends the points out and takes in the rows as they are done."""
    for name in ("layer.py", "point.py"):
        client.upload_file(str(HERE / name))
    archive = client.scatter(model.archive, broadcast=True)
    left = table.left()
    futures = [client.submit(solve, archive, settings, point, pure=False) for point in left]
    for done, future in enumerate(as_completed(futures), 1):
        row = future.result()
        table.add(row)
        print(f"{done}/{len(left)}  {row['speed']:g} m/s, {row['pressure']:g} Pa: {row['status']}", flush=True)


def draw(path: Path, table: Table):
    """Friction over speed, one line a pressure and temperature, its parts dashed."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, ax = plt.subplots(figsize=(7, 4.5), layout="constrained")
    groups = itertools.groupby(sorted(table.rows, key=key), key=lambda row: key(row)[:2])
    for i, ((temperature, pressure), rows) in enumerate(groups):
        rows = [row for row in rows if row.get("friction") is not None]
        speeds, colour = [row["speed"] for row in rows], f"C{i}"
        name = f"{pressure / 1e5:g} bar" + ("" if temperature is None else f", {temperature:g} K")
        ax.semilogx(speeds, [row["friction"] for row in rows], marker="o", markersize=4, color=colour, label=name)
        ax.semilogx(speeds, [row["friction_hysteresis"] for row in rows], "--", color=colour)
        ax.semilogx(speeds, [row["friction_adhesion"] for row in rows], ":", color=colour)
    for line, part in (("--", "hysteresis"), (":", "adhesion")):
        ax.plot([], [], line, color="0.2", label=part)
    ax.set_ylim(bottom=0)
    ax.set_xlabel("speed in m/s")
    ax.set_ylabel("friction coefficient")
    ax.legend(frameon=False)
    ax.grid(color="0.9")
    ax.spines[["top", "right"]].set_visible(False)
    plt.rcParams["svg.hashsalt"] = "sweep"
    figure.savefig(path, metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmu", metavar="MODEL.fmu", type=Path)
    parser.add_argument("-o", "--output", required=True, metavar="TABLE.csv", type=Path)
    parser.add_argument("--speeds", required=True, metavar="A..B/N", type=values, help="m/s")
    parser.add_argument("--pressures", required=True, metavar="A,B,...", type=values, help="Pa")
    parser.add_argument("--temperatures", metavar="A,B,...", type=values, help="K; default: the scene's")
    parser.add_argument("--error", type=float, default=1e-2, metavar="E", help="standard error of the friction coefficient over its mean")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a running cluster, such as tcp://head:8786")
    parser.add_argument("--workers", type=int, help="processes of this machine; default: one a core")
    parser.add_argument("--plot", metavar="OUT.svg", type=Path)
    arguments = parser.parse_args()
    model = Model(arguments.fmu)
    settings = model.settings(arguments.error)
    table = Table(arguments.output, model, settings, model.points(arguments))
    if table.left():
        with workers(arguments.scheduler, arguments.workers) as client:
            run(client, model, settings, table)
    if arguments.plot:
        draw(arguments.plot, table)
    failed = sum(row["status"] != "steady" for row in table.rows)
    if failed:
        raise SystemExit(f"{failed} of {len(table.rows)} points are not steady: see the column status of {arguments.output}")


if __name__ == "__main__":
    main()
