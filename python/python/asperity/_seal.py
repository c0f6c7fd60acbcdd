"""Seals: a lip with a film of fluid on a rod."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from . import _native
from ._arguments import Floats, described
from ._files import folder_of
from ._library import options as library_options
from ._library import warn_of_packed

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from ._arguments import Progress

SealState = _native.SealState


class Seal:
    """A lip with a film, and the rod that moves under it.

    ``seal["F_x"]`` is the present value of an output; ``seal.state`` is all that changes, to be kept, pickled and put back.
    A copy goes on exactly as the original, bit for bit.
    """

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
        self._folder: TemporaryDirectory[str] | None = None
        self._seal = _native.Seal(Path(path))
        self._start = (u, w, sealed_pressure, temperature, u_rate)
        self._started: _native.SealRun | None = None

    @property
    def _run(self) -> _native.SealRun:
        """The run, which begins where it is first looked at."""
        if self._started is None:
            self._started = _native.SealRun(self._seal, *self._start)
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

    def __getitem__(self, name: str) -> float:
        """The present value of an output of the seal's groups."""
        return self._run.value(name)

    def describe(self) -> str:
        """What the seal is, in the lines of ``asperity describe --seal``."""
        return described(self._seal.describe())

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

        found = self._seal.sweep(
            None if speeds is None else axis("speeds", speeds),
            None if sealed is None else list(numbers("sealed", sealed)),
            None if temperatures is None else axis("temperatures", temperatures),
            shown(progress),
        )
        return Stribeck(*found)

    def __len__(self) -> int:
        """The number of cells."""
        return len(self._seal)

    @property
    def name(self) -> str:
        """The seal's name."""
        return self._seal.name

    @property
    def width(self) -> float:
        """The width of the lip, m."""
        return self._seal.width

    @property
    def names(self) -> list[str]:
        """The names of the outputs."""
        return self._run.names

    @property
    def units(self) -> dict[str, str]:
        """Their units."""
        return dict(self._run.units)

    @property
    def values(self) -> Floats:
        """Present values of all outputs, in the order of :attr:`names`, shape (n,)."""
        return self._run.values()

    @property
    def contents(self) -> Floats:
        """The fluid's volume per area in the cells from the sealed side, m, shape (cells,)."""
        return self._run.contents()

    @property
    def time(self) -> float:
        """The time reached, s."""
        return self._run.time

    @property
    def u(self) -> float:
        """The displacement of the rod, m."""
        return self._run.inputs[0]

    @property
    def sealed_pressure(self) -> float:
        """The pressure of the fluid before the lip, Pa."""
        return self._run.inputs[2]

    @property
    def state(self) -> SealState:
        """All that changes in the run; can be set, compared, copied and pickled."""
        return self._run.state()

    @state.setter
    def state(self, state: SealState) -> None:
        self._run.set_state(state)

    def copy(self) -> Seal:
        """A seal that goes on as this one."""
        return _seal(self._seal, self._run.copy(), self._folder)

    def __copy__(self) -> Seal:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Seal:
        return self.copy()

    def __reduce__(self) -> tuple[Any, tuple[str, dict[str, bytes], SealState]]:
        file = self._seal.file
        files = {str(name): (file.parent / name).read_bytes() for name in (Path(file.name), *self._seal.files())}
        return _unpickled, (file.name, files, self.state)

    def pack(
        self,
        path: str | PathLike[str],
        libraries: Sequence[str | PathLike[str]] | None = None,
        *,
        flat_names: bool = False,
        references: bool = True,
    ) -> Path:
        """Packs the seal, where it starts left out, as an FMU, and returns its path.

        Args:
            path: The FMU to write.
            libraries: As for :meth:`Scene.pack`.
            flat_names: As for :meth:`Scene.pack`.
            references: As for :meth:`Scene.pack`.
        """
        given = library_options() if libraries is None else [str(library) for library in libraries]
        warn_of_packed(self._seal.pack(Path(path), given, {"flat_names": flat_names, "references": references}))
        return Path(path)

    def __repr__(self) -> str:
        return f"<asperity.Seal {self.name!r}: {len(self)} cells>"


class Stribeck:
    """Friction, film and leak of a seal in steady motion: a row for each point and stroke.

    ``stribeck["friction"]`` is a column, an array of shape (rows,).

    Attributes:
        units: Units of the columns.
        stroke: "out" to the air or "in", of each row.
        status: "steady", or why not, of each row.
    """

    def __init__(self, columns: list[tuple[str, str, Any]], picture: _native.Picture) -> None:
        """Of the columns and the picture that the native part has."""
        self._columns = {name: values for name, _, values in columns}
        self._picture = picture
        self.units = {name: unit for name, unit, _ in columns}
        self.stroke: list[str] = self._columns["stroke"]
        self.status: list[str] = self._columns["status"]

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A column, shape (rows,)."""
        import numpy as np

        try:
            return np.asarray(self._columns[name])
        except KeyError:
            raise KeyError(f"{name}: expected one of {', '.join(self._columns)}") from None

    def to_pandas(self) -> pd.DataFrame:
        """The rows."""
        import pandas as pd

        frame = pd.DataFrame(self._columns)
        frame.attrs["units"] = dict(self.units)
        return frame

    def plot(self) -> Figure:
        """Draws friction, film and the load on contacts over viscosity times speed, instrokes broken."""
        from ._plots import drawn

        return drawn(self._picture)

    def __repr__(self) -> str:
        return f"<asperity.Stribeck: {len(self.stroke)} rows; {', '.join(self._columns)}>"


def _seal(native: _native.Seal, run: _native.SealRun, folder: TemporaryDirectory[str] | None) -> Seal:
    seal = Seal.__new__(Seal)
    seal._seal, seal._started, seal._folder = native, run, folder
    return seal


def _unpickled(name: str, files: dict[str, bytes], state: SealState) -> Seal:
    folder = folder_of(files)
    native = _native.Seal(Path(folder.name) / name)
    return _seal(native, _native.SealRun.restore(native, state), folder)
