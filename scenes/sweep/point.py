"""One point of a sweep: pressed to its pressure, slid until its means are steady, averaged."""

import math
from dataclasses import dataclass

import numpy as np

from layer import CHANNELS, Layer, layer

PRESSED = 1e-3  # the mean load is the one asked for within this share of it; so well has it to be known
NEAR = 1e-2  # as close to it, runs become long ones
FEWEST, MOST = 3, 400  # blocks of a window, of a run
RUNS = 30  # runs that a point may take
SLOPES = 0.3, 30.0  # how far the layer's stiffness may be from the guess
STICK = 1e-6  # the way over which the tangential stiffness is taken, m


@dataclass(frozen=True)
class Settings:
    """What all points have in common."""

    area: float  # nominal, m²
    rest_separation: float  # of the carrier's rest line from the profile's mean at w = 0, m
    block: float  # a period of the profile, m
    samples: int  # of a block
    slowest: float  # relaxation time, s, at the reference temperature
    error: float  # standard error of the friction coefficient, over its mean
    lifts: tuple  # heights of the profile above the layer at w = 0, m
    stiffness: float  # pressure over displacement of the relaxed rubber, Pa/m


@dataclass(frozen=True)
class Point:
    speed: float
    pressure: float
    temperature: float | None
    slowing: float  # a_T: all relaxation times are so many times as long


class Secant:
    """The displacement w for a mean pressure."""

    def __init__(self, pressure: float, settings: Settings):
        """From a layer of bars side by side."""
        lifts, self.pressure, self.last = np.array(settings.lifts), pressure, None
        low, high = lifts.min() - pressure / settings.stiffness, lifts.max()
        for _ in range(60):
            middle = (low + high) / 2
            pressed = np.maximum(lifts - middle, 0.0)
            low, high = (middle, high) if settings.stiffness * pressed.mean() > pressure else (low, middle)
        self.w = float(low)
        self.first = self.slope = settings.stiffness * float(np.mean(lifts > low))

    def off(self, found: float) -> float:
        return found / self.pressure - 1

    def correct(self, found: float):
        """Moves w, where the mean pressure was `found`."""
        if self.last and abs(found - self.last[1]) > 1e-3 * self.pressure:
            slope = (self.last[1] - found) / (self.w - self.last[0])
            if slope > 0:
                self.slope = min(max(slope, SLOPES[0] * self.first), SLOPES[1] * self.first)
        self.last = self.w, found
        self.w += float(found - self.pressure) / self.slope


def solve(archive: bytes, settings: Settings, point: Point) -> dict:
    """The row of a point; where something is wrong, its status says so."""
    row = {"speed": point.speed, "pressure": point.pressure, "temperature": point.temperature}
    try:
        return row | find(layer(archive), settings, point)
    except Exception as error:  # whatever it is: the other points go on
        return row | {"status": f"{type(error).__name__}: {error}"}


def find(fmu: Layer, settings: Settings, point: Point) -> dict:
    secant = Secant(point.pressure, settings)
    for runs in range(1, RUNS + 1):
        blocks, steady = slide(fmu, settings, point, secant)
        window = blocks[-max(FEWEST, math.ceil(len(blocks) / 2)) :]
        mean = {name: float(np.mean([block[name] for block in window])) for name in blocks[0]}
        off = secant.off(mean["load"] / settings.area)
        if steady and abs(off) <= PRESSED:
            break
        if not steady and len(blocks) == MOST:
            return {"status": f"not steady after {MOST} blocks of {settings.block} m"}
        if runs < RUNS:
            secant.correct(mean["load"] / settings.area)
    else:
        return {"status": f"not pressed after {RUNS} runs: the mean pressure is off by {100 * off:.2f} %"}
    shares = [block["drag"] / block["load"] for block in window]
    friction, hysteresis = parts(mean)
    return {
        "status": "steady",
        "friction": friction,
        "friction_standard_error": standard_error(shares),
        "friction_hysteresis": hysteresis,
        "friction_adhesion": friction - hysteresis,
        "mean_pressure": mean["load"] / settings.area,
        "contact_ratio": mean["contact"],
        "area_real": mean["area"] / settings.area,
        **{f"P_{channel}": mean[channel] for channel in CHANNELS},
        "separation": settings.rest_separation + secant.w,
        "w": secant.w,
        "runs": runs,
        "time": fmu.time,
    } | {"tangential_stiffness": tangential_stiffness(fmu, settings, point)}


def slide(fmu: Layer, settings: Settings, point: Point, secant: Secant) -> tuple:
    """Blocks at one w: where it is far from right, until all relaxation is over; else until their means are steady."""
    fmu.start(secant.w, point.speed, point.temperature)
    passing = settings.block / point.speed
    settling = FEWEST + math.ceil(5 * point.slowing * settings.slowest / passing)
    blocks = []
    while len(blocks) < MOST:
        blocks.append(fmu.block(settings.block, settings.samples))
        if len(blocks) == settling and abs(secant.off(blocks[-1]["load"] / settings.area)) > NEAR:
            return blocks[-1:], False
        if len(blocks) >= settling and is_steady(blocks, settings.error):
            return blocks, True
    return blocks, False


def is_steady(blocks: list, error: float) -> bool:
    """Whether the latter half of the blocks tells friction and load well enough, and neither has a trend."""
    window = blocks[-max(FEWEST, math.ceil(len(blocks) / 2)) :]
    load = np.array([block["load"] for block in window])
    friction = np.array([block["drag"] / block["load"] for block in window])
    return all(
        standard_error(values) <= tolerance * abs(values.mean()) and abs(trend(values)) <= 2 * tolerance * abs(values.mean())
        for values, tolerance in ((friction, error), (load, PRESSED / 2))
    )


def standard_error(blocks) -> float:
    """Of the mean; blocks that follow each other may be alike, so pairs, and pairs of pairs, count as well."""
    joined = np.array(blocks)
    error = np.std(joined, ddof=1) / math.sqrt(len(joined))
    while len(joined) >= 16:
        joined = (joined[: len(joined) // 2 * 2 : 2] + joined[1::2]) / 2
        error = max(error, np.std(joined, ddof=1) / math.sqrt(len(joined)))
    return float(error)


def trend(values) -> float:
    """The change along the straight line of least squares."""
    return float(np.polyfit(np.linspace(0, 1, len(values)), values, 1)[0])


def parts(mean: dict) -> tuple:
    """The friction coefficient, from the carrier's work, and what of it is hysteresis: as the sampled forces have it."""
    friction, size = mean["drag"] / mean["load"], abs(mean["hysteresis"]) + abs(mean["adhesion"])
    hysteresis = mean["hysteresis"] / mean["load"]
    missing = friction - hysteresis - mean["adhesion"] / mean["load"]
    return friction, hysteresis + missing * (abs(mean["hysteresis"]) / size if size > 0 else 1.0)


def tangential_stiffness(fmu: Layer, settings: Settings, point: Point) -> float | None:
    """The slope of |F_x| over u from stick, under the same pressure at rest."""
    secant = Secant(point.pressure, settings)
    for _ in range(RUNS):
        fmu.start(secant.w, 0.0, point.temperature)
        fmu.step(10 * point.slowing * settings.slowest)
        before, load = fmu.get(("F_x", "F_z"))
        if abs(secant.off(load / settings.area)) <= PRESSED:
            break
        secant.correct(load / settings.area)
    else:
        return None
    fmu.speed, samples = point.speed, 16
    way, forces = np.linspace(STICK / samples, STICK, samples), []
    for _ in way:
        fmu.step(STICK / samples / point.speed)
        forces.append(before - fmu.get(("F_x",))[0])
    return float(way @ forces / (way @ way))
