"""Prony series from measured moduli."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arguments import Floats, given_columns, numbers
from ._files import table_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Fit:
    """A generalised Maxwell model fitted to measured moduli by :func:`fit`."""

    def __init__(self, native: _native.Fit) -> None:
        self._native = native

    @property
    def equilibrium_modulus(self) -> float:
        """E_∞, Pa."""
        return self._native.equilibrium_modulus

    @property
    def viscosity(self) -> float:
        """The viscosity in parallel, Pa s; 0 where none was asked for."""
        return self._native.viscosity

    @property
    def moduli(self) -> Floats:
        """Moduli of the terms, Pa, shape (n,), from short to long relaxation times."""
        return self._native.terms()[0]

    @property
    def times(self) -> Floats:
        """Relaxation times, s, shape (n,)."""
        return self._native.terms()[1]

    @property
    def error(self) -> float:
        """Root mean square of the relative errors at all points, 1."""
        return self._native.error

    @property
    def wlf(self) -> tuple[float, float, float] | None:
        """C_1 (1), C_2 (K) and T_ref (K) that put the temperatures together; None where they are not known."""
        return self._native.wlf

    @property
    def consistency(self) -> dict[str, Any] | None:
        """How far E' and E'' are apart by the relations of Kramers and Kronig; None of relaxation.

        ``apart`` is the root mean square over decades, ``nearest`` the error that no sum of Maxwell elements is below, and
        ``decades`` an array of shape (n, 5): from (rad/s), rows, measured E'' over that of E', and the errors of E' and
        E'' that the nearest sum leaves.
        """
        found = self._native.consistency
        if found is None:
            return None
        apart, nearest, decades = found
        return {"apart": apart, "nearest": nearest, "decades": np.array(decades, dtype=float).reshape(-1, 5)}

    @property
    def notes(self) -> list[str]:
        """How the table was read, and what was assumed."""
        return self._native.notes

    @property
    def points(self) -> Floats:
        """The measured points at the reference temperature, shape (n, 3).

        Each has ω (rad/s), E' and E'' (Pa); of relaxation t (s), E(t) (Pa) and 0.
        """
        return self._native.points().reshape(-1, 3)

    def complex_modulus(self, omega: ArrayLike) -> np.ndarray[Any, np.dtype[np.complex128]]:
        """E' + iE'' at the reference temperature, Pa, shape (n,); of relaxation E(t).

        Args:
            omega: Angular frequencies, rad/s, or of relaxation times, s, shape (n,).
        """
        return self._native.response(numbers("omega", omega)).view(np.complex128)

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Writes the file of Prony terms that ``material.prony`` of a scene can name."""
        Path(path).write_text(self._native.text(), encoding="utf-8")

    def plot(self) -> Figure:
        """Draws points and fit with matplotlib, and how the errors add up."""
        from ._plots import drawn

        return drawn(self._native.picture(), f"{len(self.moduli)} terms, {100 * self.error:.2g} %")

    def __repr__(self) -> str:
        return f"<asperity.Fit: {len(self.moduli)} terms, error {100 * self.error:.3g} %>"


def fit(
    data: object,
    fit_error: float = 0.02,
    *,
    viscosity: bool = False,
    wlf: tuple[float, float, float] | None = None,
    shifts: str | PathLike[str] | None = None,
    reference: float | None = None,
    frequency: float | None = None,
    poisson_ratio: float = 0.5,
    shear: bool = False,
    units: Mapping[str, str] | None = None,
    sheet: str | None = None,
    columns: Mapping[str, str | int] | None = None,
    ignore: Sequence[str] = (),
    weight: str = "both",
    vertical: str = "divide",
    expansion: float = 6.6e-4,
) -> Fit:
    """Fits a Prony series to measured moduli; those of several temperatures are put together first.

    Args:
        data: The path of a table or a workbook, a DataFrame, or a mapping of names to arrays of shape (n,): frequency,
            E' and E'' or tan delta, and temperature if it varies; or time and E(t). Names have units, as in
            ``"frequency [Hz]"``.
        fit_error: Admissible root mean square of the relative errors.
        viscosity: Whether to fit a viscosity in parallel to the terms too.
        wlf: C_1, C_2 (K) and T_ref (K), which shift rows at other temperatures; None: found where curves overlap.
        shifts: A table of shift factors in their place, with columns temperature and a_T.
        reference: Temperature of the master curve where none of these are given, K; None: 293.15.
        frequency: Frequency of all rows where there is no column of it, rad/s.
        poisson_ratio: By which moduli of shear become moduli of tension.
        shear: Whether moduli whose names have no letter are of shear.
        units: Units of columns whose names have none or another one.
        sheet: The sheet of a workbook.
        columns: Which column is which, by its name or number: ``{"storage_modulus": "E' 1"}``.
        ignore: Columns to ignore.
        weight: Which modulus the error counts, ``"storage"``, ``"loss"`` or ``"both"``.
        vertical: What becomes of the moduli of other temperatures: ``"divide"`` by a column b_T where there is one,
            ``"multiply"`` by it, ``"density"``: divided by ρT/(ρ0 T0), or ``"none"``.
        expansion: Coefficient of expansion of the volume for ``"density"``, 1/K.

    Raises:
        ValueError: Where the table cannot be read, or its temperatures cannot be put together.
    """
    options = {
        "fit_error": fit_error,
        "viscosity": viscosity,
        "wlf": wlf,
        "shifts": None if shifts is None else str(Path(shifts)),
        "reference": reference,
        "frequency": frequency,
        "poisson_ratio": poisson_ratio,
        "shear": shear,
        "units": list((units or {}).items()),
        "sheet": sheet,
        "columns": given_columns(columns),
        "ignore": list(ignore),
        "weight": weight,
        "vertical": vertical,
        "expansion": expansion if vertical == "density" else None,
    }
    with table_file(data) as path:
        native = _native.fit(path, options)
    for text in native.warnings:
        warnings.warn(text, stacklevel=2)
    if native.error > fit_error:
        warnings.warn(f"the error asked for, {fit_error:g}, cannot be reached: it is {native.error:.3g}", stacklevel=2)
    return Fit(native)
