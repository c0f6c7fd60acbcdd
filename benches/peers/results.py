"""What comes of a race: ratios at equal error, and all figures with what they depend on."""

import csv
import os
import platform
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from ladder import fastest_at
from programs import ASPERITY, COLUMNS, SCIPY, SUNDIALS


@dataclass(frozen=True)
class Result:
    """Who was fastest on either side at one error, each with its time in s; None where nobody got there."""

    scene: str
    error: float
    asked: float  # the ratio
    ours: tuple
    peer: tuple

    @property
    def ratio(self):
        return self.peer[0] / self.ours[0] if self.ours and self.peer else None


def results_of(ladders, races):
    """The results of all scenes that ran."""

    def result(scene, race, error):
        ours, peer = (fastest_at(ladders[scene], side, error) for side in (race.ours, race.peers))
        return Result(scene, error, race.ratio, ours, peer)

    return [result(scene, races[scene], error) for scene in ladders for error in races[scene].errors]


def named(best):
    return "-" if best is None else f"{1e3 * best[0]:9.1f} {best[1].method:<6}"


def print_ratios(results):
    """Times at equal error, the ratio found and the one asked for."""
    print(f"{'scene':<22} {'error':>6}  {'asperity, ms':>16}  {'best peer, ms':>16}  {'ratio':>6} {'asked':>6}")
    for result in results:
        ratio = "-" if result.ratio is None else f"{result.ratio:.2f}"
        ours, peer = named(result.ours), named(result.peer)
        print(f"{result.scene:<22} {result.error:>6.0e}  {ours:>16}  {peer:>16}  {ratio:>6} {result.asked:>6g}")


def print_table(results, errors):
    """The ratios as a table of Markdown: scenes by errors, each with the method and the variant that were fastest."""
    print("\n| scene | " + " | ".join(f"{error:.0e}" for error in errors) + " |")
    print("|---" * (len(errors) + 1) + "|")
    for scene in dict.fromkeys(result.scene for result in results):
        cells = {result.error: result for result in results if result.scene == scene}
        print(f"| {scene} | " + " | ".join(cell(cells.get(error)) for error in errors) + " |")


def cell(result):
    if result is None or result.ratio is None:
        return ""
    return f"{result.ratio:.2f} ({result.ours[1].method}, {result.peer[1].method})"


def said(*command):
    """The first line that a command prints."""
    found = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    return found[0] if found else ""


def macro(header, name):
    """The value of a macro of a C header, as the compiler finds it."""
    command = ["gcc", "-E", "-dM", "-include", header, "-I/usr/include/suitesparse", "-x", "c", os.devnull]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    found = re.search(rf"#define {name} (.*)", text)
    return found[1].strip('"') if found else "?"


@dataclass(frozen=True)
class Machine:
    """What the figures depend on."""

    cpu: str
    cores: int
    system: str
    builds: dict  # by program, what it was built by and with

    @classmethod
    def here(cls, asperity):
        cpu = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
        sundials = macro("sundials/sundials_config.h", "SUNDIALS_VERSION")
        builds = {
            ASPERITY: f"{said(asperity, '--version')}, {said('rustc', '--version')}",
            SUNDIALS: f"SUNDIALS {sundials}, {said('gcc', '--version')}, -O3 -march=native",
            SCIPY: f"Python {platform.python_version()}",
        }
        return cls(cpu[1] if cpu else platform.processor(), os.cpu_count(), platform.platform(), builds)


def write_figures(path, ladders, machine):
    """All runs, one a row."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        errors = [f"error_{name}" for name in COLUMNS]
        times = ["run_time", "median_above_least", "most_above_least", "runs"]
        writer.writerow(
            ["scene", "program", "method", "tolerance", *errors, *times, "steps", "events"]
            + ["cpu", "cores", "system", "build"]
        )
        for scene, found in ladders.items():
            for program, rungs in found.items():
                for rung in rungs:
                    row = [scene, program.name, program.method, f"{rung.tolerance:.4g}"]
                    row += [f"{rung.errors[name]:.4e}" for name in COLUMNS]
                    row += [f"{rung.time:.6f}", *(f"{part:.3f}" for part in rung.spread), len(rung.times) or 1]
                    row += [rung.steps, rung.events, machine.cpu, machine.cores, machine.system]
                    writer.writerow([*row, machine.builds[program.name]])
