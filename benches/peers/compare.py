"""Checks that the peers agree with asperity, races all of them side by side and prints ratios at equal error.

Run by benches/peers/run, which says what this needs; README.md says how errors and times are taken.
"""

import argparse
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import scenes
from ladder import climb, differences, fastest_at
from programs import ASPERITY, BDF, COLUMNS, EVENT, OURS, RADAU, SCIPY, USUAL, VARIANTS, Bench
from results import Machine, print_ratios, print_table, results_of, write_figures


@dataclass(frozen=True)
class Race:
    """Who runs on a scene, at which errors, and the ratio asked for: the best peer's time over our better method's."""

    errors: tuple
    ours: tuple
    peers: tuple
    ratio: float


ALL_ERRORS = (3e-2, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
RACES = {
    "tread-block-50": Race((1e-4,), (EVENT,), (RADAU, BDF), 300),
    "tread-block-50-rough": Race((1e-4,), (EVENT,), (RADAU, BDF), 300),
    "tread-block-200": Race(ALL_ERRORS, OURS, (*USUAL, *VARIANTS), 1.5),
    "tread-block-200-rough": Race(ALL_ERRORS, OURS, VARIANTS, 2),
    "tread-block-800": Race(ALL_ERRORS, OURS, VARIANTS, 1.5),
    "smooth-chain-1000": Race(ALL_ERRORS, OURS, VARIANTS, 1.5),
}

REFERENCE = 1e-11  # tolerance of the reference run
# Each peer's tolerance in the check, and the largest difference then allowed, over the largest value: for SUNDIALS by
# what it reaches within seconds, ark2 being of order two; scipy, which has to be waited for, errs by some 1e-4 at 1e-5.
CHECKS = {"ark2": (1e-7, 1e-4), "ark3": (1e-8, 1e-5), "Radau": (1e-5, 1e-3), "BDF": (1e-5, 1e-3)}
USUAL_CHECK = (1e-9, 1e-6)
# The tightest tolerance of a ladder.
TIGHTEST = {ASPERITY: 1e-11, SCIPY: 1e-6}
USUAL_TIGHTEST = 1e-10
# A run that takes so many times what asperity takes for the smallest error wins nowhere: its ladder ends.
HOPELESS = 4
# Nor is a rung timed again that took so many times the fastest of its side at its error in its first run.
BEATEN = 1.5


@dataclass(frozen=True)
class Effort:
    """How much is run."""

    per_decade: int
    repeats: int


FULL, QUICK = Effort(4, 9), Effort(2, 3)


def say(text):
    print(text, file=sys.stderr, flush=True)


def check(bench, scene, peers, reference):
    """Ends the program unless every peer agrees with the reference."""
    for peer in peers:
        tolerance, allowed = CHECKS.get(peer.method, USUAL_CHECK)
        found = differences(bench.outcome(peer, scene, tolerance), reference)
        text = ", ".join(f"{name} {found[name]:.1e}" for name in COLUMNS)
        say(f"{scene}: {peer} at {tolerance:g} differs from asperity at {REFERENCE:g} by {text}")
        if not max(found.values()) <= allowed:
            sys.exit(f"{scene}: {peer} disagrees by more than {allowed:g}: nothing is timed")


def climb_all(bench, scene, race, reference, per_decade):
    """The rungs of every program, asperity first: what it takes says how long the others are waited for."""
    ladders, wanted = {}, min(race.errors)

    def add(program, longest):
        tightest = TIGHTEST.get(program.name, USUAL_TIGHTEST)
        ladders[program] = climb(bench, program, scene, reference, wanted, per_decade, tightest, longest)

    add(EVENT, float("inf"))
    longest = HOPELESS * max(rung.first_time for rung in ladders[EVENT])
    for program in (*race.ours, *race.peers):
        if program != EVENT:
            say(f"{scene}: {program}")
            add(program, float("inf") if program.name == SCIPY else longest)
    return ladders


def contenders(ladders, race):
    """The rungs that may win at some error: not beaten by far in their first run by another program of their side."""
    for side in (race.ours, race.peers):
        for program in side:
            for rung in ladders[program]:
                if program.name == SCIPY:
                    continue
                best = fastest_at(ladders, side, rung.error)
                if best is None or rung.first_time < BEATEN * best[0]:
                    yield program, rung


def time_all(bench, scene, timed, repeats):
    """Rungs of all programs one after another, and all that again: what else the machine does meets all alike."""
    for i in range(repeats):
        say(f"{scene}: timing {len(timed)} runs, {i + 1} of {repeats}")
        for program, rung in timed:
            rung.times.append(bench.time(program, scene, rung.tolerance))


def run_race(bench, scene, effort):
    """One scene: the ladders of its programs."""
    race = RACES[scene]
    bench.prepare(scene)
    reference = bench.outcome(EVENT, scene, REFERENCE)
    check(bench, scene, race.peers, reference)
    ladders = climb_all(bench, scene, race, reference, effort.per_decade)
    time_all(bench, scene, list(contenders(ladders, race)), effort.repeats)
    return ladders


def use_one_core():
    """This process and all it starts."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def main():
    parser = argparse.ArgumentParser(description="Races asperity and its peers and prints ratios at equal error.")
    parser.add_argument("--asperity", required=True, help="the program (given by run)")
    parser.add_argument("--sundials", required=True, help="the C peer (given by run)")
    parser.add_argument("--folder", required=True, type=Path, help="room for scenes and results (given by run)")
    parser.add_argument("--quick", action="store_true", help="fewer tolerances, fewer repeats, without scipy")
    parser.add_argument(
        "--scene", action="append", choices=scenes.NAMES, help="this scene alone; may be given several times"
    )
    parser.add_argument("-o", "--output", metavar="OUT.csv", help="all figures, one run a row")
    options = parser.parse_args()
    use_one_core()
    scenes.write(options.folder)
    bench = Bench(options.asperity, options.sundials, options.folder)
    machine = Machine.here(options.asperity)
    say(f"{machine.cpu}, {machine.cores} cores")
    names = [name for name in scenes.NAMES if not (options.quick and RADAU in RACES[name].peers)]
    ladders = {}
    for scene in options.scene or names:
        ladders[scene] = run_race(bench, scene, QUICK if options.quick else FULL)
        if options.output:
            write_figures(options.output, ladders, machine)
    results = results_of(ladders, RACES)
    print_ratios(results)
    print_table(results, ALL_ERRORS)


if __name__ == "__main__":
    main()
