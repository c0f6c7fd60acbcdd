"""Contact patches: many point-contact elements on a rigid face, in three dimensions."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from . import _native
from ._arguments import Floats, described
from ._moving import Moving

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._arguments import Progress
    from ._slip import SlipCurves

PatchState = _native.PatchState
Six = tuple[float, float, float, float, float, float]
_AT_REST: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Patch(Moving[_native.PatchState]):
    """A contact patch, and its motion.

    ``patch["force.z"]`` is the present value of an output; ``patch.state`` is all that changes, to be kept, pickled and
    put back. A copy goes on exactly as the original, bit for bit. The pose is x, y, z (m), roll, pitch, yaw (rad).
    """

    _native_definition = _native.Patch
    _native_run = _native.PatchRun
    _definition: _native.Patch
    _started: _native.PatchRun | None

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
        self._folder = None
        self._definition = _native.Patch(Path(path))
        self._started = None
        # A patch that is read to be packed starts nowhere, and need not be within its table.
        if pose is not None or rates is not None or transport_speed != 0.0 or temperature is not None:
            at, moving = _AT_REST if pose is None else pose, _AT_REST if rates is None else rates
            self._start(at, moving, transport_speed, temperature)

    def _start(
        self, pose: Sequence[float] | Floats, rates: Sequence[float] | Floats, speed: float, temperature: float | None
    ) -> _native.PatchRun:
        self._started = _native.PatchRun(self._definition, pose, rates, speed, temperature)
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

    def slip(
        self,
        loads: ArrayLike,
        slips: ArrayLike | None = None,
        angles: ArrayLike | None = None,
        *,
        speeds: ArrayLike | None = None,
        temperatures: ArrayLike | None = None,
        combined: bool = False,
        progress: Progress = False,
    ) -> SlipCurves:
        """Forces over slip and slip angle in steady rolling at loads, as ``asperity slip`` has them.

        Args:
            loads: Vertical loads, N.
            slips: Longitudinal slips κ, by the effective rolling radius.
            angles: Slip angles, rad, of travel to the left of the wheel.
            speeds: Speeds of travel, m/s; None: 10.
            temperatures: Temperatures, K, or texts such as ``"20 °C"``; None: the patch's own.
            combined: Each slip at each angle; else slips straight ahead, and angles in free rolling.
            progress: As for :meth:`Scene.sweep`.

        Raises:
            SceneError: Where the patch has no tread that runs through.
            ValueError: Where a value is out of range.
        """
        from ._arguments import axis, given, numbers, shown
        from ._slip import SlipCurves

        options = given(
            loads=axis("loads", loads),
            slips=None if slips is None else numbers("slips", slips),
            angles=None if angles is None else numbers("angles", angles),
            speeds=None if speeds is None else axis("speeds", speeds),
            temperatures=None if temperatures is None else axis("temperatures", temperatures),
            combined=combined,
        )
        found = self._definition.slip(options, shown(progress))
        for text in found.warnings:
            warnings.warn(text, stacklevel=2)
        return SlipCurves(found)

    def describe(self) -> str:
        """What the patch is, in the lines of ``asperity describe --patch``."""
        for text in self._definition.warnings:
            warnings.warn(text, stacklevel=2)
        return described(self._definition.describe())

    def __len__(self) -> int:
        """The number of elements."""
        return len(self._definition)

    @property
    def pose(self) -> Six:
        """The pose reached: x, y, z (m), roll, pitch, yaw (rad)."""
        x, y, z, roll, pitch, yaw = self._run.pose
        return x, y, z, roll, pitch, yaw

    def __repr__(self) -> str:
        return f"<asperity.Patch {self.name!r}: {len(self)} elements, t = {self.time:g} s>"
