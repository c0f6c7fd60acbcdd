"""Seals: a lip with a film of fluid on a rod."""

from __future__ import annotations

import warnings
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from . import _native
from ._arguments import Floats, described
from ._found import Found, FoundColumn
from ._moving import Moving

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from ._arguments import Progress

SealState = _native.SealState


class Seal(Moving[_native.SealState]):
    """A lip with a film, and the rod that moves under it.

    ``seal["F_x"]`` is the present value of an output; ``seal.state`` is all that changes, to be kept, pickled and put back.
    A copy goes on exactly as the original, bit for bit.
    """

    _native_definition = _native.Seal
    _native_run = _native.SealRun
    _definition: _native.Seal
    _started: _native.SealRun | None

    def __init__(
        self,
        path: str | PathLike[str],
        *,
        u: float = 0.0,
        w: float = 0.0,
        sealed_pressure: float | None = None,
        temperature: float | None = None,
        u_rate: float = 0.0,
    ) -> None:
        """The seal in a file, and where it starts.

        Args:
            path: The seal file.
            u: Displacement of the rod to the air, m.
            w: How far the lip is lifted, m; of a seal with an approach_stiffness.
            sealed_pressure: Pressure of the fluid before the lip, Pa; None: the first of the seal's sets of pressures.
            temperature: Temperature, K; None: as the seal has it.
            u_rate: Speed of the rod just after the start, m/s.

        Raises:
            SceneError: Where the seal is refused.
            SimulationError: Where it is open at the start given.
        """
        self._folder = None
        self._definition = _native.Seal(Path(path))
        self._start = (u, w, sealed_pressure, temperature, u_rate)
        self._started = None

    @property
    def _run(self) -> _native.SealRun:
        """The run, which begins where it is first looked at."""
        if self._started is None:
            self._started = _native.SealRun(self._definition, *self._start)
            self._warn(stacklevel=4)
        return self._started

    def _warn(self, stacklevel: int) -> None:
        for text in self._run.take_warnings():
            warnings.warn(text, stacklevel=stacklevel)

    def advance(
        self,
        dt: float,
        u: float | None = None,
        *,
        w: float | None = None,
        sealed_pressure: float | None = None,
        temperature: float | None = None,
    ) -> None:
        """Moves the rod, straight, for a time.

        Args:
            dt: How long, s.
            u: Displacement of the rod at the end, m; None: it rests.
            w: How far the lip is lifted at the end, m; None: as it is.
            sealed_pressure: Pressure of the fluid before the lip at the end, Pa; None: as it is.
            temperature: Temperature from now on, K; None: as it is.

        Raises:
            SimulationError: Where the run cannot go on, as where the seal is blown open; it is then as it was.
        """
        self._run.advance(dt, u, w=w, sealed_pressure=sealed_pressure, temperature=temperature)
        self._warn(stacklevel=3)

    def describe(self) -> str:
        """What the seal is, in the lines of ``asperity describe --seal``."""
        return described(self._definition.describe())

    def sweep(
        self,
        speeds: ArrayLike | None = None,
        sealed: ArrayLike | None = None,
        temperatures: ArrayLike | None = None,
        *,
        progress: Progress = False,
    ) -> Stribeck:
        """The Stribeck curve: friction, film and leak in steady motion to the air and back.

        Args:
            speeds: Speeds, m/s; None: those of the seal's table.
            sealed: Sealed pressures, Pa; None: the first of the seal's sets of pressures.
            temperatures: Temperatures, K, or texts such as ``"20 °C"``; None: the seal's own.
            progress: As for :meth:`Scene.sweep`.

        Raises:
            ValueError: Where a value is out of range, or nothing depends on the temperature.
        """
        from ._arguments import axis, numbers, shown

        found = self._definition.sweep(
            None if speeds is None else axis("speeds", speeds),
            None if sealed is None else list(numbers("sealed", sealed)),
            None if temperatures is None else axis("temperatures", temperatures),
            shown(progress),
        )
        return Stribeck(*found)

    def __len__(self) -> int:
        """The number of cells."""
        return len(self._definition)

    @property
    def width(self) -> float:
        """The width of the lip, m."""
        return self._definition.width

    @property
    def contents(self) -> Floats:
        """The fluid's volume per area in the cells from the sealed side, m, shape (cells,)."""
        return self._run.contents()

    @property
    def u(self) -> float:
        """The displacement of the rod, m."""
        return self._run.inputs[0]

    @property
    def sealed_pressure(self) -> float:
        """The pressure of the fluid before the lip, Pa."""
        return self._run.inputs[2]

    def __repr__(self) -> str:
        return f"<asperity.Seal {self.name!r}: {len(self)} cells>"


class Stribeck(Found):
    """Friction, film and leak of a seal in steady motion: a row for each point and stroke.

    ``stribeck["friction"]`` is a column, an array of shape (rows,).

    Attributes:
        units: Units of the columns.
        stroke: "out" to the air or "in", of each row.
        status: "steady", or why not, of each row.
    """

    def __init__(self, columns: list[FoundColumn], picture: _native.Picture) -> None:
        """Of the columns and the picture that the native part has."""
        super().__init__(columns)
        self._picture = picture
        self.stroke: list[str] = self._columns["stroke"]
        self.status: list[str] = self._columns["status"]

    def plot(self) -> Figure:
        """Draws friction, film and the load on contacts over viscosity times speed, instrokes broken."""
        from ._plots import drawn

        return drawn(self._picture)
