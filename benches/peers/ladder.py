"""Error against run time: ladders of tolerances, and times at equal error."""

import itertools
import math
import statistics
import sys
from dataclasses import dataclass

from programs import COLUMNS, Refused


@dataclass
class Rung:
    """One run of a program at one tolerance."""

    tolerance: float
    errors: dict  # by column, the largest difference over the largest value
    steps: int
    events: int
    first_time: float  # processor seconds of the run that gave the errors
    times: list  # those of the runs that are compared

    @property
    def error(self):
        """The larger of those of F_x and F_z."""
        return max(self.errors["F_x"], self.errors["F_z"])

    @property
    def time(self):
        """The least: what else the machine does makes no run faster."""
        return min(self.times, default=self.first_time)

    @property
    def spread(self):
        """Median over least, and most over least, less 1."""
        times = self.times or [self.first_time]
        return statistics.median(times) / min(times) - 1, max(times) / min(times) - 1


def differences(outcome, reference):
    """The largest difference of each column over the largest value of the reference."""
    a, b = outcome.columns, reference.columns
    span = b["time"][-1]
    if len(a["time"]) != len(b["time"]) or any(abs(p - q) > 1e-9 * span for p, q in zip(a["time"], b["time"])):
        raise ValueError("the rows are at other times")
    largest = {name: max(map(abs, b[name])) for name in COLUMNS}
    return {name: max(abs(p - q) for p, q in zip(a[name], b[name])) / (largest[name] or 1.0) for name in COLUMNS}


def tolerances(per_decade, tightest):
    """From 0.1 on."""
    step, value = 0, 0.1
    while value >= tightest * 0.999:
        yield value
        step += 1
        value = 10 ** (-1 - step / per_decade)


def climb(bench, program, scene, reference, wanted, per_decade, tightest, longest):
    """The rungs of a program: down to the first whose error is below `wanted`, or that takes longer than `longest` (s).
    A tolerance at which the program gives up is left out."""
    rungs = []
    for tolerance in tolerances(per_decade, tightest):
        try:
            outcome = bench.outcome(program, scene, tolerance)
        except Refused as refusal:
            print(f"left out: {refusal}", file=sys.stderr)
            continue
        errors = differences(outcome, reference)
        rungs.append(Rung(tolerance, errors, outcome.steps, outcome.events, outcome.time, []))
        if rungs[-1].error < wanted or outcome.time > longest:
            break
    return rungs


def counting_errors(rungs):
    """The error that each rung counts with: the largest of it and of all tighter ones. A small error by chance, which
    the next tighter tolerance does not confirm, wins nothing."""
    return list(itertools.accumulate((rung.error for rung in reversed(rungs)), max))[::-1]


def front(rungs):
    """The rungs that no other one beats in both error and time, from the tightest on: (error, time)."""
    best = []
    for error, time in sorted(zip(counting_errors(rungs), (rung.time for rung in rungs))):
        if not best or time < best[-1][1]:
            best.append((error, time))
    return best


def time_at(rungs, error):
    """Time at an error, s: straight lines between the logarithms of the front's errors and times. Above the largest
    error the time of the fastest rung; None below the smallest."""
    best = front(rungs)
    if not best or error < best[0][0]:
        return None
    for (error_1, time_1), (error_2, time_2) in itertools.pairwise(best):
        if error <= error_2:
            part = math.log(error / error_1) / math.log(error_2 / error_1)
            return time_1 * (time_2 / time_1) ** part
    return best[-1][1]


def fastest_at(ladders, programs, error):
    """The time (s) of the fastest of the programs at an error, and which it is; None where none gets there."""
    found = [(time_at(ladders[program], error), program) for program in programs if program in ladders]
    found = [(time, program) for time, program in found if time is not None]
    return min(found, key=lambda pair: pair[0], default=None)
