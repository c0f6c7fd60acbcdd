"""Slip curves of a patch, and the Magic Formula fitted to them."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from . import _native
from ._found import Found

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class SlipCurves(Found):
    """Forces of a patch over slip and slip angle: a row for each point, in the axes of ISO 8855 and ISO-W.

    ``curves["F_x"]`` is a column, an array of shape (rows,), nan where rolling is not steady.

    Attributes:
        units: Units of the columns.
        status: "steady", or why not, of each row.
    """

    def __init__(self, found: _native.SlipCurves) -> None:
        """Of what the native part has found."""
        super().__init__(found.columns())
        self._found = found
        self.status: list[str] = self._columns["status"]

    def magic_formula(self, nominal: float | None = None) -> MagicFormula:
        """Fits the Magic Formula: B, C, D, E of each curve, and coefficients of MF 5.2 and 6.1 over loads, pure slip.

        Args:
            nominal: The load FNOMIN of the coefficients, N; None: the middle one.

        Raises:
            ValueError: Where no curve has five points.
        """
        return MagicFormula(self._found, self._found.magic_formula(nominal))

    def save(self, path: str | PathLike[str]) -> Path:
        """Writes the table of ``asperity slip``."""
        Path(path).write_text(self._found.text(), encoding="utf-8")
        return Path(path)

    def plot(self) -> Figure:
        """Draws F_x and the share that slides over the slip, F_y and M_z over the slip angle."""
        from ._plots import drawn

        return drawn(self._found.picture(None))


class MagicFormula(Found):
    """The Magic Formula fitted to slip curves: a row for each number, ``formula["value"]`` and ``formula["error"]``.

    Attributes:
        units: Units of the columns.
        status: "fitted", or what else is known of the number, of each row.
    """

    def __init__(self, curves: _native.SlipCurves, formula: _native.MagicFormula) -> None:
        """Of what the native part has found."""
        super().__init__(formula.columns())
        self._curves, self._formula = curves, formula
        self.status: list[str] = self._columns["status"]

    def save(self, path: str | PathLike[str]) -> Path:
        """Writes the table of ``asperity slip --fit mf``."""
        Path(path).write_text(self._formula.text(), encoding="utf-8")
        return Path(path)

    def plot(self) -> Figure:
        """Draws the curves with the formula, and what that is off by."""
        from ._plots import drawn

        return drawn(self._curves.picture(self._formula))
