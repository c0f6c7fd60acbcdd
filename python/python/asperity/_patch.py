"""Contact patches: many point-contact elements on a rigid face, in three dimensions."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from . import _native
from ._arguments import Floats, described
from ._files import folder_of
from ._library import options as library_options
from ._library import warn_of_packed

PatchState = _native.PatchState
Six = tuple[float, float, float, float, float, float]
_AT_REST: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Patch:
    """A contact patch, and its motion.

    ``patch["force.z"]`` is the present value of an output; ``patch.state`` is all that changes, to be kept, pickled and
    put back. A copy goes on exactly as the original, bit for bit. The pose is x, y, z (m), roll, pitch, yaw (rad).
    """

    def __init__(
        self,
        path: str | PathLike[str],
        *,
        pose: Sequence[float] | Floats | None = None,
        rates: Sequence[float] | Floats | None = None,
        transport_speed: float = 0.0,
        temperature: float | None = None,
    ) -> None:
        """The patch in a file, and where it starts.

        Args:
            path: The patch file.
            pose: Where the body starts, m and rad, six numbers; None: all 0.
            rates: How fast it moves just after the start, m/s and rad/s, six numbers; None: it rests.
            transport_speed: Speed of the tread, m/s; 0 without one.
            temperature: Temperature, K; None: as the patch has it.

        Raises:
            SceneError: Where the patch is refused.
            SimulationError: Where it is beyond its table at the start given, and that is refused.
        """
        self._folder: TemporaryDirectory[str] | None = None
        self._patch = _native.Patch(Path(path))
        self._started: _native.PatchRun | None = None
        # A patch that is read to be packed starts nowhere, and need not be within its table.
        if pose is not None or rates is not None or transport_speed != 0.0 or temperature is not None:
            at, moving = _AT_REST if pose is None else pose, _AT_REST if rates is None else rates
            self._start(at, moving, transport_speed, temperature)

    def _start(
        self, pose: Sequence[float] | Floats, rates: Sequence[float] | Floats, speed: float, temperature: float | None
    ) -> _native.PatchRun:
        self._started = _native.PatchRun(self._patch, pose, rates, speed, temperature)
        for text in self._started.take_warnings():
            warnings.warn(text, stacklevel=3)
        return self._started

    @property
    def _run(self) -> _native.PatchRun:
        """The run; without a start given it begins where it is first looked at, at rest at 0."""
        return self._start(_AT_REST, _AT_REST, 0.0, None) if self._started is None else self._started

    def advance(
        self,
        dt: float,
        pose: Sequence[float] | Floats | None = None,
        *,
        rates: Sequence[float] | Floats | None = None,
        transport_speed: float | None = None,
        temperature: float | None = None,
    ) -> None:
        """Moves the body, straight, for a time.

        Warns of the first temperature and of the first element beyond the table, each once a run.

        Args:
            dt: How long, s.
            pose: Where it is at the end, m and rad; or give ``rates``. Without either it rests.
            rates: Rates of the pose's coordinates, m/s and rad/s.
            transport_speed: Speed of the tread at the end, m/s; None: as it is.
            temperature: Temperature from now on, K; None: as it is.

        Raises:
            SimulationError: Where the run cannot go on; the patch is then as it was.
        """
        self._run.advance(dt, pose, rates=rates, transport_speed=transport_speed, temperature=temperature)
        for text in self._run.take_warnings():
            warnings.warn(text, stacklevel=2)

    def __getitem__(self, name: str) -> float:
        """The present value of an output of the patch's groups."""
        return self._run.value(name)

    def describe(self) -> str:
        """What the patch is, in the lines of ``asperity describe --patch``."""
        for text in self._patch.warnings:
            warnings.warn(text, stacklevel=2)
        return described(self._patch.describe())

    def __len__(self) -> int:
        """The number of elements."""
        return len(self._patch)

    @property
    def name(self) -> str:
        """The patch's name."""
        return self._patch.name

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
    def time(self) -> float:
        """The time reached, s."""
        return self._run.time

    @property
    def pose(self) -> Six:
        """The pose reached: x, y, z (m), roll, pitch, yaw (rad)."""
        x, y, z, roll, pitch, yaw = self._run.pose
        return x, y, z, roll, pitch, yaw

    @property
    def state(self) -> PatchState:
        """All that changes in the run; can be set, compared, copied and pickled."""
        return self._run.state()

    @state.setter
    def state(self, state: PatchState) -> None:
        self._run.set_state(state)

    def copy(self) -> Patch:
        """A patch that goes on as this one."""
        return _patch(self._patch, self._run.copy(), self._folder)

    def __copy__(self) -> Patch:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Patch:
        return self.copy()

    def __reduce__(self) -> tuple[Any, tuple[str, dict[str, bytes], PatchState]]:
        file = self._patch.file
        files = {str(name): (file.parent / name).read_bytes() for name in (Path(file.name), *self._patch.files())}
        return _unpickled, (file.name, files, self.state)

    def pack(
        self,
        path: str | PathLike[str],
        libraries: Sequence[str | PathLike[str]] | None = None,
        *,
        flat_names: bool = False,
        references: bool = True,
    ) -> Path:
        """Packs the patch, where it starts left out, as an FMU, and returns its path.

        Args:
            path: The FMU to write.
            libraries: As for :meth:`Scene.pack`.
            flat_names: As for :meth:`Scene.pack`.
            references: As for :meth:`Scene.pack`.
        """
        given = library_options() if libraries is None else [str(library) for library in libraries]
        warn_of_packed(self._patch.pack(Path(path), given, {"flat_names": flat_names, "references": references}))
        return Path(path)

    def __repr__(self) -> str:
        return f"<asperity.Patch {self.name!r}: {len(self)} elements, t = {self.time:g} s>"


def _patch(native: _native.Patch, run: _native.PatchRun, folder: TemporaryDirectory[str] | None) -> Patch:
    patch = Patch.__new__(Patch)
    patch._patch, patch._started, patch._folder = native, run, folder
    return patch


def _unpickled(name: str, files: dict[str, bytes], state: PatchState) -> Patch:
    folder = folder_of(files)
    native = _native.Patch(Path(folder.name) / name)
    return _patch(native, _native.PatchRun.restore(native, state), folder)
