"""A master: joins a body to layers, by one of three methods.

    jacobi        both step at once, by what they told each other at the last communication point
    gauss_seidel  the body steps first, and the layers follow it to where it has gone
    newton        steps are done and taken back (FMU states) until both meet; the layers' tangents tell where to try

With rates, a force runs linearly over the body's step: at the layers' output derivatives, or (newton) to the force at
the step's end. With values only it is held: that of the step's start, or (newton) of its end.
"""

import numpy as np

from slaves import Body, Layer

METHODS = ("jacobi", "gauss_seidel", "newton")


class Master:
    """A body and layers stepped together by `h`. `layers`: for each the path of its FMU and whether it is mirrored."""

    def __init__(self, method: str, rates: bool, body: Body, layers: list, h: float):
        self.advance, self.rates, self.h = getattr(self, method), rates, h
        # What a layer does when it is told values only: go on as it came, until the next value is known, or to the value.
        extrapolation = "linear" if method == "jacobi" else "hold"
        self.body = body
        self.layers = [Layer(path, mirrored, extrapolation) for path, mirrored in layers]
        self.tries = 0

    def start(self, settle: float):
        """The layers settle under the body, which is held until the time 0 and then let go."""
        self.time = 0.0
        self.body.start(0.0)
        for layer in self.layers:
            layer.start(-settle)
            layer.step_along(-settle, settle, self.body.place(), np.zeros(2))
        self.compliance = self.measure_compliance()

    def step(self):
        self.advance(self.time, self.h)
        self.time += self.h

    def jacobi(self, time: float, h: float):
        place, speed = self.body.place(), self.body.speed() if self.rates else None
        self.body.step_under(time, h, self.force(), self.force_rate())
        for layer in self.layers:
            layer.step_along(time, h, place, speed)

    def gauss_seidel(self, time: float, h: float):
        start = self.body.place()
        self.body.step_under(time, h, self.force(), self.force_rate())
        self.lead(time, h, start, self.body.place())

    def newton(self, time: float, h: float, tolerance: float = 1e-15):
        """Until the body goes where the layers were led, to `tolerance` in m."""
        start, before = self.body.place(), self.force()
        end = start + h * self.body.speed()
        states = self.save()
        for _ in range(20):
            self.lead(time, h, start, end)
            self.body.step_under(time, h, *self.force_over(before, self.force()))
            self.tries += 1
            gap = self.body.place() - end
            if np.max(np.abs(gap)) <= tolerance:
                return self.free(states)
            end = end + np.linalg.solve(np.eye(2) - self.compliance @ self.tangent(), gap)
            self.restore(states)
        raise RuntimeError(f"no convergence at {time} s: gap {gap} m")

    def lead(self, time: float, h: float, start, end):
        """The layers step along the body's way: told by its rate, or by its end."""
        for layer in self.layers:
            if self.rates:
                layer.step_along(time, h, start, (end - start) / h)
            else:
                layer.step_along(time, h, end)

    def force(self) -> np.ndarray:
        """The layers' force on the body."""
        return sum(layer.force() for layer in self.layers)

    def force_rate(self) -> np.ndarray:
        return sum(layer.force_rate() for layer in self.layers) if self.rates else np.zeros(2)

    def force_over(self, before, after) -> tuple:
        """The force over a step, value and rate, from those at its ends."""
        return (before, (after - before) / self.h) if self.rates else (after, np.zeros(2))

    def tangent(self) -> np.ndarray:
        return sum(layer.tangent() for layer in self.layers)

    def measure_compliance(self) -> np.ndarray:
        """How far the body ends with the force at the step's end: a difference by rollback, exact as it is linear."""
        state, ends = self.body.fmu.getFMUstate(), []
        for force in ([0.0, 0.0], [1.0, 0.0], [0.0, 1.0]):
            self.body.step_under(self.time, self.h, *self.force_over(np.zeros(2), np.array(force)))
            ends.append(self.body.place())
            self.body.fmu.setFMUstate(state)
        self.body.fmu.freeFMUstate(state)
        return np.column_stack([ends[1] - ends[0], ends[2] - ends[0]])

    def slaves(self) -> list:
        return [self.body, *self.layers]

    def save(self) -> list:
        return [slave.fmu.getFMUstate() for slave in self.slaves()]

    def restore(self, states: list):
        for slave, state in zip(self.slaves(), states):
            slave.fmu.setFMUstate(state)

    def free(self, states: list):
        for slave, state in zip(self.slaves(), states):
            slave.fmu.freeFMUstate(state)

    def energies(self) -> tuple:
        """The energy that the layers have received, and that which the body has given off."""
        return sum(layer.get(["energy.input"])[0] for layer in self.layers), self.body.get(["energy_out"])[0]

    def close(self):
        for slave in self.slaves():
            slave.close()
