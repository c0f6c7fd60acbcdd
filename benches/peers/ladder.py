"""Error against run time: ladders of tolerances, and times at equal error."""

import math
import statistics
from dataclasses import dataclass

from programs import COLUMNS, SCIPY


@dataclass
class Rung:
    """One run of a program at one tolerance."""

    tolerance: float
    errors: dict  # by column, the largest difference over the largest value
    steps: int
    events: int
    times: list  # processor seconds of each run

    @property
    def error(self):
        """The larger of those of F_x and F_z."""
        return max(self.errors["F_x"], self.errors["F_z"])

    @property
    def time(self):
        return statistics.median(self.times)


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


def climb(bench, program, scene, reference, wanted, per_decade, tightest):
    """The rungs of a program down to the first whose error is below `wanted`: without times, but for scipy, hundreds of
    times slower than the others, for which this run has to be enough."""
    rungs = []
    for tolerance in tolerances(per_decade, tightest):
        outcome = bench.outcome(program, scene, tolerance)
        times = [outcome.time] if program.name == SCIPY else []
        rungs.append(Rung(tolerance, differences(outcome, reference), outcome.steps, outcome.events, times))
        if rungs[-1].error < wanted:
            break
    return rungs


def front(rungs):
    """The rungs that no other one beats in both error and time, from the tightest on: (error, time)."""
    best = []
    for error, time in sorted((rung.error, rung.time) for rung in rungs):
        if not best or time < best[-1][1]:
            best.append((error, time))
    return best


def time_at(rungs, error):
    """Time at an error, s: straight lines between the logarithms of the front's errors and times. Above the largest
    error the time of the fastest rung; None below the smallest."""
    best = front(rungs)
    if error < best[0][0]:
        return None
    for (error_1, time_1), (error_2, time_2) in zip(best, best[1:]):
        if error <= error_2:
            part = math.log(error / error_1) / math.log(error_2 / error_1)
            return time_1 * (time_2 / time_1) ** part
    return best[-1][1]
