"""The programs that are compared: how each is run, how long it takes, what it gives."""

import csv
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import flatten

POINTS = 100  # rows a phase
COLUMNS = ("F_x", "F_z", "E_diss")


class Refused(Exception):
    """A program that would not run; its text is what it said."""


@dataclass(frozen=True)
class Program:
    """One program and one of its methods."""

    name: str
    method: str

    def __str__(self):
        return f"{self.name} {self.method}"


ASPERITY, SUNDIALS, SCIPY = "asperity", "sundials", "scipy"
EVENT, STEP = Program(ASPERITY, "event"), Program(ASPERITY, "step")
OURS = (EVENT, STEP)
# The variants of sundials/variant.c: those that win somewhere, and those that do not but are the usual ways.
VARIANTS = tuple(Program(SUNDIALS, name) for name in ("bdf", "adams", "ark2", "ark3", "ark4", "ark4p", "ark5"))
USUAL = tuple(Program(SUNDIALS, name) for name in ("klu", "cond"))
RADAU, BDF = Program(SCIPY, "Radau"), Program(SCIPY, "BDF")


@dataclass(frozen=True)
class Outcome:
    """What a run gave: columns of its result file, its processor time in s, and what it counted."""

    columns: dict
    time: float
    steps: int
    events: int


class Bench:
    """The folder with the scenes, and the programs."""

    def __init__(self, asperity, sundials, folder):
        self.asperity, self.sundials, self.folder = asperity, sundials, Path(folder)
        self.environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}

    def prepare(self, scene):
        """Writes the scene in the forms that the programs read: one with counters for ours, JSON, flat text."""
        toml = self.scene(scene)
        counted = toml.read_text() + '\n[fmu]\noutputs = ["forces", "dissipation", "solver"]\n'
        self.scene(scene, ".counted.toml").write_text(counted)
        text = subprocess.run(
            [self.asperity, "describe", toml, "--json"], check=True, capture_output=True, text=True
        ).stdout
        self.scene(scene, ".json").write_text(text)
        self.scene(scene, ".txt").write_text(flatten.flatten(json.loads(text)))

    def scene(self, name, suffix=".toml"):
        return self.folder / (name + suffix)

    def command(self, program, scene, tolerance, output, counted):
        """The command line of a run."""
        if program.name == ASPERITY:
            toml = self.scene(scene, ".counted.toml" if counted else ".toml")
            settings = (f"solver.relative_tolerance={tolerance:g}", f"solver.method={program.method}")
            sets = [word for setting in settings for word in ("--set", setting)]
            return [self.asperity, "simulate", toml, "-o", output, "--rows", str(POINTS), *sets]
        options = [output, f"{tolerance:g}", "--points", str(POINTS)]
        if program.name == SUNDIALS:
            return [self.sundials, self.scene(scene, ".txt"), *options, "--variant", program.method]
        script = Path(__file__).with_name("scipy_contact.py")
        return [sys.executable, script, self.scene(scene, ".json"), *options, "--method", program.method]

    def run(self, program, scene, tolerance, counted=False):
        """Runs; returns processor seconds of the whole process, user and system, and what it printed."""
        output = self.folder / "out.csv"
        command = self.command(program, scene, tolerance, output, counted)
        with open(self.folder / "said.txt", "w+") as said:
            process = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT, env=self.environment)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            said.seek(0)
            text = said.read()
        if process.returncode != 0:
            raise Refused(f"{program} on {scene} at {tolerance:g}: {text.strip()}")
        return usage.ru_utime + usage.ru_stime, text

    def time(self, program, scene, tolerance):
        return self.run(program, scene, tolerance)[0]

    def outcome(self, program, scene, tolerance):
        """Runs for the result."""
        time, text = self.run(program, scene, tolerance, counted=True)
        with open(self.folder / "out.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        columns = {name: [float(row[name]) for row in rows] for name in ("time", *COLUMNS)}
        if program.name == ASPERITY:
            time = self.time(program, scene, tolerance)  # without the second run that estimates the error
            return Outcome(columns, time, *(int(float(rows[-1][f"solver.{name}"])) for name in ("steps", "events")))
        counts = dict(pair.split("=") for pair in text.split() if "=" in pair)
        return Outcome(columns, time, int(counts["steps"]), int(counts["events"]))
