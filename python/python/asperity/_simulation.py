"""Simulations that Python advances step by step."""

from __future__ import annotations

from typing import Any

from . import _native
from ._arguments import Floats
from ._scene import Scene

State = _native.State


class Simulation:
    """A run of a scene that is moved step by step, for masters and loops in Python.

    ``sim["F_x"]`` is the present value of an output; ``sim.state`` is all that changes, to be kept, pickled and put
    back. A copy goes on exactly as the original, bit for bit.
    """

    def __init__(
        self,
        scene: Scene,
        *,
        u: float = 0.0,
        w: float = 0.0,
        u_rate: float = 0.0,
        w_rate: float = 0.0,
        load: float = 0.0,
        pull: float = 0.0,
        temperature: float | None = None,
    ) -> None:
        """Starts a run: the layer hangs under the carrier, masses under the profile lifted onto it.

        Args:
            scene: The scene; its excitation is not used.
            u: Displacement of the carrier along x, m.
            w: Displacement along z, m; negative presses.
            u_rate: Speed along x just after the start, m/s: the layer starts with it.
            w_rate: Speed along z just after the start, m/s.
            load: Load on a carrier that is a body, without its constant part, N.
            pull: Tangential force on it, without its constant part, N.
            temperature: Temperature of the layer where it is an input, K; None: the material's.
        """
        self._start: dict[str, Any] = {
            "u": u,
            "w": w,
            "u_rate": u_rate,
            "w_rate": w_rate,
            "load": load,
            "pull": pull,
            "temperature": temperature,
        }
        self.scene = scene
        self._native = _native.Simulation(scene._native, **self._start)
        self._advance = self._native.advance

    def advance(
        self,
        dt: float,
        u: float | None = None,
        w: float | None = None,
        *,
        u_rate: float | None = None,
        w_rate: float | None = None,
        load: float | None = None,
        load_rate: float | None = None,
        pull: float | None = None,
        pull_rate: float | None = None,
        temperature: float | None = None,
    ) -> None:
        """Moves the carrier, straight, for a time.

        Args:
            dt: How long, s.
            u: Displacement along x at the end, m; or give ``u_rate``. Without either it rests along x.
            w: Displacement along z at the end, m; or give ``w_rate``. Without either it rests along z.
            u_rate: Speed along x, m/s.
            w_rate: Speed along z, m/s.
            load: Load on a body from now on, N; None: as it is.
            load_rate: Its change, N/s.
            pull: Tangential force on a body from now on, N; None: as it is.
            pull_rate: Its change, N/s.
            temperature: Temperature from now on, K, where it is an input; None: as it is.

        Raises:
            SimulationError: Where the run cannot go on; it is then as it was.
        """
        self._advance(
            dt,
            u,
            w,
            u_rate=u_rate,
            w_rate=w_rate,
            load=load,
            load_rate=load_rate,
            pull=pull,
            pull_rate=pull_rate,
            temperature=temperature,
        )

    def __getitem__(self, name: str) -> float:
        """The present value of an output of the scene's groups.

        Raises:
            KeyError: Where there is none of this name.
        """
        return self._native.value(name)

    @property
    def names(self) -> list[str]:
        """The names of the outputs."""
        return self._native.names

    @property
    def units(self) -> dict[str, str]:
        """Their units."""
        return dict(self._native.units)

    @property
    def values(self) -> Floats:
        """Present values of all outputs, in the order of :attr:`names`, shape (n,)."""
        return self._native.values()

    @property
    def time(self) -> float:
        """The time reached, s."""
        return self._native.time

    @property
    def u(self) -> float:
        """Displacement of the carrier along x, m."""
        return self._native.carrier[0]

    @property
    def w(self) -> float:
        """Displacement of the carrier along z, m."""
        return self._native.carrier[1]

    @property
    def temperature(self) -> float | None:
        """Temperature of the layer, K; None where it is no input."""
        return self._native.temperature

    @property
    def force_rates(self) -> tuple[float, float]:
        """Rates of F_x and F_z, N/s, from the left; at the start, from the right."""
        return self._native.force_rates()

    def derivative(self, name: str, u: float = 0.0, w: float = 0.0) -> float:
        """Change of an output as the carrier is displaced at once, the state of the layer held.

        Args:
            name: The output.
            u: Displacement along x, m; 1 for the derivative by u.
            w: Displacement along z, m; 1 for the derivative by w.
        """
        return self._native.derivative(name, u, w)

    @property
    def tangents(self) -> dict[str, float]:
        """Derivatives of the forces by the targets of the last motion, for masters that iterate.

        They are the outputs of the group "tangent": empty where ``fmu.outputs`` of the scene does not name it.
        """
        return {name: self[name] for name in self.names if name.startswith("tangent.")}

    @property
    def state(self) -> State:
        """All that changes in the run; can be set, compared, copied and pickled."""
        return self._native.state()

    @state.setter
    def state(self, state: State) -> None:
        self._native.set_state(state)

    def copy(self) -> Simulation:
        """A run that goes on as this one."""
        copied = Simulation(self.scene, **self._start)
        copied.state = self.state
        return copied

    def __copy__(self) -> Simulation:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Simulation:
        return self.copy()

    def __reduce__(self) -> tuple[Any, tuple[Scene, dict[str, Any], State]]:
        return _unpickled, (self.scene, self._start, self.state)

    def __repr__(self) -> str:
        return f"<asperity.Simulation of {self.scene.name!r} at t = {self.time:g} s>"


def _unpickled(scene: Scene, start: dict[str, Any], state: State) -> Simulation:
    simulation = Simulation(scene, **start)
    simulation.state = state
    return simulation
