"""Checks that the peers agree with asperity, times all of them side by side and prints ratios at equal error.

Run by benches/peers/run, which says what this needs; README.md says how errors and times are taken.
"""

import argparse
import csv
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import scenes
from ladder import climb, differences, time_at
from programs import ASPERITY, BDF, COLUMNS, COND, CVODE, EVENT, KLU, RADAU, SCIPY, STEP, Bench, Refused


@dataclass(frozen=True)
class Target:
    """A ratio that is asked for: time of `peer` over that of `ours` at each of `errors`."""

    scene: str
    errors: tuple
    ours: object
    peer: object
    ratio: float


THREE_DECADES = (1e-3, 1e-4, 1e-5, 1e-6)
TIGHT = (3e-8,)  # what cvode reaches in the forces at a tolerance of 1e-9
TARGETS = (
    Target("free-chain-1000", (1e-4,), EVENT, KLU, 6),
    Target("tread-block-200", THREE_DECADES, EVENT, KLU, 6),
    Target("tread-block-200", THREE_DECADES, EVENT, COND, 2.5),
    Target("tread-block-200", TIGHT, EVENT, COND, 1),
    Target("tread-block-200", (1e-2,), STEP, COND, 4),
    Target("tread-block-200-rough", THREE_DECADES, EVENT, COND, 4),
    Target("tread-block-200-rough", (1e-2,), STEP, COND, 10),
    Target("tread-block-800", (1e-2,), STEP, COND, 40),
    Target("tread-block-50", (1e-4,), EVENT, RADAU, 300),
    Target("tread-block-50", (1e-4,), EVENT, BDF, 300),
    Target("tread-block-50-rough", (1e-4,), EVENT, RADAU, 300),
    Target("tread-block-50-rough", (1e-4,), EVENT, BDF, 300),
)

REFERENCE = 1e-11  # tolerance of the reference run
# Each peer's tolerance in the check, and the largest difference then allowed, over the largest value. CVODE errs by
# some 1e-8 at 1e-10, by more where deflections are small (free-chain-1000); scipy, which has to be waited for, by some
# 1e-4 at 1e-5.
CHECKS = {CVODE: (1e-10, 1e-6), SCIPY: (1e-5, 1e-3)}
# The tightest tolerance of a ladder.
TIGHTEST = {ASPERITY: 1e-11, CVODE: 1e-10, SCIPY: 1e-6}


@dataclass(frozen=True)
class Effort:
    """How much is run."""

    per_decade: int
    repeats: int


FULL, QUICK = Effort(2, 9), Effort(1, 3)


def say(text):
    print(text, file=sys.stderr, flush=True)


def programs_of(scene):
    """The programs of the scene's targets, ours first, and the smallest error that each is wanted at."""
    wanted = {}
    for target in TARGETS:
        if target.scene == scene:
            for program in (target.ours, target.peer):
                wanted[program] = min(wanted.get(program, 1.0), *target.errors)
    return dict(sorted(wanted.items(), key=lambda item: str(item[0])))


def check(bench, scene, programs, reference):
    """Ends the program unless every peer agrees with the reference."""
    for peer in programs:
        if peer.name == ASPERITY:
            continue
        tolerance, allowed = CHECKS[peer.name]
        found = differences(bench.outcome(peer, scene, tolerance), reference)
        text = ", ".join(f"{name} {found[name]:.1e}" for name in COLUMNS)
        say(f"{scene}: {peer} at {tolerance:g} differs from asperity at {REFERENCE:g} by {text}")
        if not max(found.values()) <= allowed:
            sys.exit(f"{scene}: {peer} disagrees by more than {allowed:g}: nothing is timed")


def climb_all(bench, scene, wanted, reference, effort):
    """The rungs of every program that runs."""
    ladders = {}
    for program, error in wanted.items():
        try:
            ladders[program] = climb(bench, program, scene, reference, error, effort.per_decade, TIGHTEST[program.name])
        except Refused as refusal:
            say(f"left out: {refusal}")
    return ladders


def time_all(bench, scene, ladders, repeats):
    """All rungs of all programs one after another, and all that again: what else the machine does meets all alike."""
    for i in range(repeats):
        say(f"{scene}: timing, {i + 1} of {repeats}")
        for program, rungs in ladders.items():
            for rung in rungs if program.name != SCIPY else ():
                rung.times.append(bench.time(program, scene, rung.tolerance))


def compare(bench, scene, effort):
    """One scene: the ladders of its programs."""
    bench.prepare(scene)
    wanted = programs_of(scene)
    reference = bench.outcome(EVENT, scene, REFERENCE)
    check(bench, scene, wanted, reference)
    ladders = climb_all(bench, scene, wanted, reference, effort)
    time_all(bench, scene, ladders, effort.repeats)
    return ladders


def seconds(value):
    return "-" if value is None else f"{value:.4f}"


def print_ratios(ladders):
    """The ratios asked for, beside those found."""
    print(
        f"{'scene':<22} {'error':>7}  {'ours':<6} {'peer':<11} {'ours, s':>9} {'peer, s':>9} {'ratio':>7} {'asked':>6}"
    )
    for target in TARGETS:
        for error in target.errors if target.scene in ladders else ():
            mine, other = (ladders[target.scene].get(program) for program in (target.ours, target.peer))
            ours, peer = (time_at(rungs, error) if rungs else None for rungs in (mine, other))
            ratio = "-" if None in (ours, peer) else f"{peer / ours:.2f}"
            figures = f"{seconds(ours):>9} {seconds(peer):>9} {ratio:>7} {target.ratio:>6g}"
            print(f"{target.scene:<22} {error:>7.0e}  {target.ours.method:<6} {str(target.peer):<11} {figures}")
    if any(STEP not in found for scene, found in ladders.items() if STEP in programs_of(scene)):
        print("This asperity has no method `step`: see the messages above.")


def write_figures(path, ladders):
    """All runs, one a row."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        errors = [f"error_{name}" for name in COLUMNS]
        writer.writerow(["scene", "program", "method", "tolerance", *errors, "run_time", "steps", "events"])
        for scene, found in ladders.items():
            for program, rungs in found.items():
                for rung in rungs:
                    values = [f"{rung.errors[name]:.4e}" for name in COLUMNS]
                    row = [scene, program.name, program.method, f"{rung.tolerance:.4g}", *values, f"{rung.time:.6f}"]
                    writer.writerow([*row, rung.steps, rung.events])


def use_one_core():
    """This process and all it starts."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def main():
    parser = argparse.ArgumentParser(description="Times asperity beside its peers and prints ratios at equal error.")
    parser.add_argument("--asperity", required=True, help="the program (given by run)")
    parser.add_argument("--cvode", required=True, help="the C peer (given by run)")
    parser.add_argument("--folder", required=True, type=Path, help="room for scenes and results (given by run)")
    parser.add_argument("--quick", action="store_true", help="fewer tolerances, fewer repeats")
    parser.add_argument(
        "--scene", action="append", choices=scenes.NAMES, help="this scene alone; may be given several times"
    )
    parser.add_argument("-o", "--output", metavar="OUT.csv", help="all figures, one run a row")
    options = parser.parse_args()
    use_one_core()
    scenes.write(options.folder)
    bench = Bench(options.asperity, options.cvode, options.folder)
    effort = QUICK if options.quick else FULL
    ladders = {}
    for scene in options.scene or scenes.NAMES:
        ladders[scene] = compare(bench, scene, effort)
        if options.output:
            write_figures(options.output, ladders)
    print_ratios(ladders)


if __name__ == "__main__":
    main()
