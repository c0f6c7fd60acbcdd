"""What is found for other programs: property files of tyres, and laws of friction."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import NamedTuple

from . import _native


class Scaling(NamedTuple):
    """A number of a property file that was scaled.

    Attributes:
        before: What the file had; 1 where it had none.
        after: What the scaled file has.
        why: What the ratio is of, in words.
    """

    before: float
    after: float
    why: str


def scale_tir(
    base: str | PathLike[str],
    from_table: str | PathLike[str],
    to_table: str | PathLike[str],
    output: str | PathLike[str],
    *,
    carcass: float | Sequence[float] = (),
) -> dict[str, Scaling]:
    """Writes a tyre property file for another road, temperature or compound: ``asperity tir``.

    Args:
        base: The property file (.tir) to scale.
        from_table: The table of slip curves for what it is of.
        to_table: The one for what it is scaled to.
        output: The property file to write.
        carcass: What the carcass yields within the contact, in series with the tread, N/m, along x and along y.

    Returns:
        LMUX, LKX, LMUY and LKY, those that the tables have.

    Raises:
        ValueError: Where a file is refused.
    """
    stiffnesses = list(carcass) if isinstance(carcass, Sequence) else [carcass]
    scaled, notes = _native.scale_tir(Path(base), Path(from_table), Path(to_table), Path(output), stiffnesses)
    for text in notes:
        warnings.warn(text, stacklevel=2)
    return {key: Scaling(before, after, why) for key, before, after, why in scaled}


class FrictionFit(NamedTuple):
    """A law of friction fitted at a temperature by :func:`fit_friction`.

    Attributes:
        temperature: K; None where the table has none.
        rms: Root mean square of what it is off by: N, or Pa of a sweep.
        largest: The largest friction of the table, in the same unit.
        numbers: Values and standard errors by name, None for the error of a value at its bound or taken for this; None of
            what the table does not determine.
    """

    temperature: float | None
    rms: float
    largest: float
    numbers: dict[str, tuple[float, float | None] | None]


def fit_friction(table: str | PathLike[str], law: str = "stribeck") -> list[FrictionFit]:
    """Fits the numbers of a cylinder's friction or of LuGre to friction in steady motion: ``asperity slip --fit``.

    Args:
        table: A table of a sweep, also of a lip.
        law: ``"stribeck"`` or ``"lugre"``.

    Returns:
        A fit for each temperature of the table.

    Raises:
        ValueError: Where the table is refused.
    """
    if law not in ("stribeck", "lugre"):
        raise ValueError(f"law: expected stribeck or lugre, found {law!r}")
    fits = _native.fit_friction(Path(table), law == "lugre")
    return [
        FrictionFit(
            temperature,
            rms,
            largest,
            {name: None if value is None else (value, error) for name, value, error in numbers},
        )
        for temperature, rms, largest, numbers in fits
    ]
