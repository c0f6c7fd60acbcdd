"""Surfaces: profiles and maps, analysed."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._arguments import Floats, given_columns
from ._files import table_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

class Surface:
    """A profile or a map, as read or smoothed, split, made periodic, and its analysis.

    ``surface["rms_height"]`` is a number of the analysis, by the names that ``asperity surface --json`` has;
    ``surface["roughness"]`` has what drawings say, by ISO 21920: ``ra``, ``rq``, ``rz``, ``rmr_depth`` in m, ``rmr``, and by
    which filters; None of a surface that is too short for any of them.

    Attributes:
        name: The name of the file or of the scene.
        analysis: All numbers of the analysis, in SI units.
        x: Positions of the profile, m, shape (n,).
        z: Heights, m, shape (n,).
        notes: How the file was read.
    """

    def __init__(self, name: str, found: dict[str, Any]) -> None:
        self.name = name
        self.analysis: dict[str, Any] = json.loads(found["analysis"])
        self.x: Floats = found["x"]
        self.z: Floats = found["z"]
        self.notes: list[str] = found["notes"]
        self._found = found

    def __getitem__(self, name: str) -> Any:
        """A number of the analysis."""
        try:
            return self.analysis[name]
        except KeyError:
            raise KeyError(f"{name}: expected one of {', '.join(self.analysis)}") from None

    @property
    def hurst(self) -> float | None:
        """The Hurst exponent of the profile, 1; None where its spectrum follows no power law."""
        law = self.analysis["law"]
        return None if law is None else float(law["hurst"])

    @property
    def spectrum(self) -> Floats:
        """Wave numbers, rad/m, and densities, m³, of the profile's power spectrum by bands, shape (n, 2)."""
        return self._pairs("spectrum")

    @property
    def isotropic_spectrum(self) -> Floats | None:
        """Wave numbers, rad/m, and densities, m⁴, of the waves that were split off, or else of the map; shape (n, 2).

        None of a profile that was not split. :meth:`Scene.with_spectrum` takes both columns.
        """
        return None if self._found["isotropic"] is None else self._pairs("isotropic")

    @property
    def map(self) -> tuple[Floats, tuple[float, float]] | None:
        """The map that the profile is a line of: heights, m, shape (ny, nx), and the distances of points, m."""
        found = self._found["map"]
        if found is None:
            return None
        heights, nx, (dx, dy) = found
        return heights.reshape(-1, nx), (dx, dy)

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Writes the profile, or of a map that was mirrored its matrix of heights, in m, as a scene can name it."""
        Path(path).write_text(self._found["text"], encoding="utf-8")

    def spectrum_to_csv(self, path: str | PathLike[str]) -> None:
        """Writes the isotropic spectrum, as ``fine.spectrum`` of a scene's surface can name it.

        Raises:
            ValueError: Where there is none.
        """
        text = self._found["isotropic_text"]
        if text is None:
            raise ValueError("expected split=, or a map, whose isotropic spectrum is written")
        Path(path).write_text(text, encoding="utf-8")

    def plot(self) -> Figure:
        """Draws the profile and its spectrum with matplotlib, before smoothing too."""
        from ._plots import drawn

        return drawn(self._found["picture"], self.name)

    def _pairs(self, name: str) -> Floats:
        pairs: Floats = self._found[name].reshape(-1, 2)
        return pairs

    def __repr__(self) -> str:
        hurst = "no power law" if self.hurst is None else f"Hurst exponent {self.hurst:.3g}"
        return f"<asperity.Surface {self.name!r}: {len(self.x)} points, rms {self['rms_height']:.4g} m, {hurst}>"


def _columns(columns: Mapping[str, str | int] | Sequence[str]) -> dict[str, Any]:
    """The options of the command that say the columns."""
    if isinstance(columns, Mapping):
        return {"column": given_columns(columns)}
    names = [columns] if isinstance(columns, str) else [str(name) for name in columns]
    if len(names) > 2:
        raise ValueError(f"columns: expected those of x and z, or of z alone, found {names}")
    return {"columns": names}


def surface(
    data: object,
    *,
    smooth: float | None = None,
    split: float | None = None,
    mirror: bool = False,
    taper: bool = False,
    wavelengths: tuple[float, float] | None = None,
    unit: str | None = None,
    x_unit: str | None = None,
    z_unit: str | None = None,
    missing: str | None = None,
    tilt: str | None = None,
    depth: str | None = None,
    third_column: str | None = None,
    columns: Mapping[str, str | int] | Sequence[str] = (),
    spacing: float | Sequence[float] = (),
    line: int | None = None,
    periodic: bool = False,
) -> Surface:
    """Analyses a measured profile or map: heights, slopes, spectrum and Hurst exponent.

    Args:
        data: The path of a file, a DataFrame, or a mapping of names to arrays of shape (n,), as in ``"x [mm]"`` and
            ``"z [µm]"``. A scene has :meth:`Scene.surface`.
        smooth: A Gaussian filter halves waves of this length, m, and takes away shorter ones.
        split: The same, and the finer waves become a spectrum.
        mirror: Makes it periodic by its mirror image; of a map, unless a line is chosen, along x and y.
        taper: Makes the profile periodic: over a tenth of its length its end goes over into its beginning.
        wavelengths: The shortest and the longest wave, m, that the power law is fitted to; None: the widest range that
            follows one.
        unit: Unit of x and z: m, mm, um, nm, cm, Å, in, mil or ft; None: the one in the file, else m.
        x_unit: Unit of x only.
        z_unit: Unit of z only.
        missing: Missing heights: "refuse" the file, or "fill" the gaps.
        tilt: "keep" it, or "remove" the least squares line or plane.
        depth: Whether numbers of z are heights ("up") or depths ("down"); None: by the name of their column.
        third_column: What it marks: "invalid" or "valid" points, or nothing ("ignore").
        columns: The columns of x and z, by their names or numbers; one alone holds heights. Or by their axes, as in
            ``{"z": "Texture"}``.
        spacing: The distance of points of a file without x, and of the lines of a matrix, m.
        line: The line of an areal measurement, from 1; None: the middle one.
        periodic: Whether the profile is repeated without end.

    Raises:
        SceneError: Where the file is refused.
        ValueError: Where the surface cannot be made what is asked for.
    """
    treatment = {"smooth": smooth, "split": split, "mirror": mirror, "taper": taper, "wavelengths": wavelengths}
    reading = {
        "unit": unit,
        "x_unit": x_unit,
        "z_unit": z_unit,
        "missing": missing,
        "tilt": tilt,
        "depth": depth,
        "third_column": third_column,
        **_columns(columns),
        "spacing": np.atleast_1d(np.asarray(spacing, dtype=np.float64)).tolist(),
        "line": line,
        "periodic": periodic,
    }
    with table_file(data) as path:
        found = _native.surface(path, reading, treatment)
    for text in found["warnings"]:
        warnings.warn(text, stacklevel=2)
    return Surface(path.name, found)
