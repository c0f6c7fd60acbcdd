"""Contact patches: many point-contact elements on a rigid face, in three dimensions."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

from . import _native
from ._arguments import Floats
from ._library import options as library_options

Six = tuple[float, float, float, float, float, float]
_AT_REST: Six = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Patch:
    """A contact patch, and its motion.

    ``patch["force.z"]`` is the present value of an output. The pose is x, y, z (m), roll, pitch, yaw (rad).
    """

    def __init__(
        self,
        path: str | PathLike[str],
        *,
        pose: Six = _AT_REST,
        rates: Six = _AT_REST,
        transport_speed: float = 0.0,
        temperature: float | None = None,
    ) -> None:
        """The patch in a file, and where it starts.

        Args:
            path: The patch file.
            pose: Where the body starts, m and rad, six numbers.
            rates: How fast it moves just after the start, m/s and rad/s, six numbers.
            transport_speed: Speed of the tread, m/s; 0 without one.
            temperature: Temperature, K; None: as the patch has it.

        Raises:
            SceneError: Where the patch is refused.
        """
        self._patch = _native.Patch(Path(path))
        self._temperature = self._patch.temperature if temperature is None else temperature
        self._run = _native.PatchRun(self._patch, pose, rates, transport_speed, temperature)
        for text in self._run.take_warnings():
            warnings.warn(text, stacklevel=2)

    def advance(
        self,
        dt: float,
        pose: Six | None = None,
        *,
        rates: Six | None = None,
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
            ValueError: Where the motion is refused; the patch is then as it was.
        """
        if dt <= 0.0:
            raise ValueError(f"dt = {dt}: expected a number above 0, in s")
        if pose is not None and rates is not None:
            raise ValueError("pose and rates: expected one of them")
        if pose is not None:
            x, y, z, roll, pitch, yaw = ((there - here) / dt for here, there in zip(self.pose, pose, strict=True))
            rates = (x, y, z, roll, pitch, yaw)
        kelvin = self._temperature if temperature is None else temperature
        self._run.advance(dt, rates or _AT_REST, transport_speed, kelvin)
        self._temperature = kelvin
        for text in self._run.take_warnings():
            warnings.warn(text, stacklevel=2)

    def __getitem__(self, name: str) -> float:
        """The present value of an output of the patch's groups."""
        return self._run.value(name)

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

    def pack(self, path: str | PathLike[str], libraries: Sequence[str | PathLike[str]] | None = None) -> Path:
        """Packs the patch, where it starts left out, as an FMU, and returns its path.

        Args:
            path: The FMU to write.
            libraries: As for :meth:`Scene.pack`.
        """
        given = library_options() if libraries is None else [str(library) for library in libraries]
        self._patch.pack(Path(path), given)
        return Path(path)

    def __repr__(self) -> str:
        return f"<asperity.Patch {self.name!r}: {len(self)} elements, t = {self.time:g} s>"
