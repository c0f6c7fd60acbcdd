"""Tables of sweeps beside measured friction."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from . import _native

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


class Compared(NamedTuple):
    """A measurement and the friction of the table there.

    Attributes:
        line: Its line in the file, from 1.
        speed: Speed, m/s.
        pressure: Mean pressure, Pa.
        temperature: Temperature, K; None where it has none.
        measured: The friction coefficient that was measured.
        sigma: Its standard deviation, or what is assumed: 5 % of it and 0.01.
        swept: Friction of the table there.
        deviations: How far the table is off, over the standard deviation.
    """

    line: int
    speed: float
    pressure: float
    temperature: float | None
    measured: float
    sigma: float
    swept: float
    deviations: float


class LeftOut(NamedTuple):
    """A measurement where the table has no friction.

    Attributes:
        line: Its line in the file, from 1.
        speed: Speed, m/s.
        pressure: Mean pressure, Pa.
        temperature: Temperature, K; None where it has none.
        measured: The friction coefficient that was measured.
        why: Why the table has none there.
    """

    line: int
    speed: float
    pressure: float
    temperature: float | None
    measured: float
    why: str


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """How far the table of a sweep is from measured friction.

    Attributes:
        scene: The name of the scene that was swept.
        points: The measurements that the table reaches, the worst first.
        left_out: The other ones.
        chi_square: Sum of the squared deviations over the standard deviations, 1.
        sigma_assumed: Whether a standard deviation is assumed.
        notes: How the table of measurements was read.
    """

    scene: str
    points: tuple[Compared, ...]
    left_out: tuple[LeftOut, ...]
    chi_square: float
    sigma_assumed: bool
    notes: list[str]
    _picture: _native.Picture

    @classmethod
    def _of(cls, found: dict[str, Any]) -> Comparison:
        points = tuple(Compared(*one) for one in found.pop("worst"))
        left_out = tuple(LeftOut(*one) for one in found.pop("left_out"))
        return cls(points=points, left_out=left_out, _picture=found.pop("picture"), **found)

    @property
    def chi_square_per_measurement(self) -> float:
        """χ² over the number of measurements, 1."""
        return self.chi_square / len(self.points)

    def to_pandas(self) -> pd.DataFrame:
        """A row a measurement that the table reaches, by their lines."""
        import pandas as pd

        return pd.DataFrame(self.points, columns=list(Compared._fields)).set_index("line").sort_index()

    def plot(self) -> Figure:
        """Draws the measurements with bars of a standard deviation, and the table's curves, with matplotlib."""
        from ._plots import drawn

        return drawn(self._picture)

    def __repr__(self) -> str:
        per_one = f"χ² {self.chi_square_per_measurement:.4g} per measurement"
        return f"<asperity.Comparison: {len(self.points)} measurements, {len(self.left_out)} left out; {per_one}>"
