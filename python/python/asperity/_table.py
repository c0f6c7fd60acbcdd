"""Tables of sweeps."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._arguments import Floats, given, given_columns
from ._files import table_file
from ._library import options as library_options
from ._library import warn_of_packed

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from ._arguments import Progress
    from ._comparison import Comparison
    from ._scene import Scene


class Table:
    """Friction in steady sliding over speed, load and temperature.

    ``table["friction"]`` is a column, an array of shape (speeds, loads, temperatures), nan where a point has no value.

    Attributes:
        speeds: Speeds, m/s, shape (nv,).
        load: What the loads are: "pressure" (Pa) or "force" (N).
        loads: Mean pressures, Pa, or forces, N, shape (np,).
        temperatures: Temperatures, K, shape (nT,); one that is nan where the scene has none.
        units: Units of the columns.
        status: "steady"; "full contact", where friction and area are a result, but nothing gives way; or why the values
            cannot be relied on; shape (nv, np, nT), "" of points not found yet.
    """

    def __init__(self, text: str, matters: str = "", drawn: Mapping[str, Sequence[float]] | None = None) -> None:
        """The table of this text; of one with samples what matters, as text, and what was drawn."""
        given = [(name, list(values)) for name, values in (drawn or {}).items()]
        self._fill(_native.Table(text, matters, given))

    @classmethod
    def _of(cls, native: _native.Table) -> Table:
        table = cls.__new__(cls)
        table._fill(native)
        return table

    def _fill(self, native: _native.Table) -> None:
        self._native = native
        columns = {name: (unit, values) for name, unit, values in native.columns()}
        self.units = {name: unit for name, (unit, _) in columns.items()}
        self.load = "pressure" if "pressure" in columns else "force"
        at = [np.asarray(columns[name][1]) for name in ("speed", self.load, "temperature")]
        self.speeds, self.loads, self.temperatures = map(np.unique, at)
        axes = (self.speeds, self.loads, self.temperatures)
        self._places = tuple(np.searchsorted(axis, values) for axis, values in zip(axes, at, strict=True))
        self.status = np.full(tuple(map(len, axes)), "", dtype=object)
        self.status[self._places] = columns["status"][1]
        of_points = {name: values for name, (_, values) in columns.items() if not isinstance(values, list)}
        own = ("speed", self.load, "temperature")
        self._columns = {name: self._on_grid(values) for name, values in of_points.items() if name not in own}

    def _on_grid(self, values: Floats) -> Floats:
        """The values of the rows at their points."""
        found = np.full((*self.status.shape, *values.shape[1:]), np.nan)
        found[self._places] = values
        return found

    @property
    def text(self) -> str:
        """The table as ``asperity sweep`` writes it."""
        return self._native.text

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Table:
        """The table in a file that ``asperity sweep`` or :meth:`to_csv` wrote."""
        return cls._of(_native.Table.read(Path(path)))

    def __getitem__(self, name: str) -> Floats:
        """A column, shape (speeds, loads, temperatures)."""
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"{name}: expected one of {', '.join(self._columns)}") from None

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return list(self._columns)

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Writes the table, as ``asperity pack --table`` and patches read it."""
        Path(path).write_text(self.text, encoding="utf-8")

    def to_pandas(self) -> pd.DataFrame:
        """A row a point: speed, load, temperature, status and the columns."""
        import pandas as pd

        grid = np.meshgrid(self.speeds, self.loads, self.temperatures, indexing="ij")
        axes = dict(zip(("speed", self.load, "temperature"), grid, strict=True))
        values = {**axes, "status": self.status, **self._columns}
        frame = pd.DataFrame({name: array.ravel() for name, array in values.items()})
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_xarray(self) -> xr.Dataset:
        """The columns with dimensions v, p (or F) and T."""
        import xarray as xr

        names, coordinates = self._coordinates()
        data: dict[str, Any] = {
            name: (names, values, {"units": self.units[name]}) for name, values in self._columns.items()
        }
        data["status"] = (names, self.status)
        return xr.Dataset(data, coords=coordinates)

    def _coordinates(self) -> tuple[tuple[str, str, str], dict[str, Any]]:
        names = ("v", "p" if self.load == "pressure" else "F", "T")
        axes = zip(
            names, ("speed", self.load, "temperature"), (self.speeds, self.loads, self.temperatures), strict=True
        )
        return names, {name: (name, values, {"units": self.units.get(column, "K")}) for name, column, values in axes}

    @property
    def samples(self) -> xr.Dataset:
        """All samples: friction, hysteresis and contact_ratio with dimensions sample, v, p (or F) and T, nan where one has no
        result; and what was drawn with dimension sample, where the table was just swept.

        Raises:
            ValueError: Of a table without samples.
        """
        import xarray as xr

        rows = {name: values.reshape(len(self._places[0]), -1) for name, values in self._native.samples()}
        if not rows:
            raise ValueError("expected the table of a sweep with samples")
        samples = {name: np.moveaxis(self._on_grid(values), -1, 0) for name, values in rows.items()}
        names, coordinates = self._coordinates()
        data: dict[str, Any] = {name: (("sample", *names), values) for name, values in samples.items()}
        data |= {name: ("sample", values) for name, values in self._native.drawn()}
        coordinates["sample"] = np.arange(1, 1 + len(samples["friction"]))
        return xr.Dataset(data, coords=coordinates)

    @property
    def matters(self) -> pd.DataFrame:
        """The part of friction's variance over the samples that each uncertain key explains (share) and its standard_error: in
        the mean over all points, where speed is nan, and at each point.

        Raises:
            ValueError: Of a table that was not just swept with samples.
        """
        import pandas as pd

        matters = self._native.matters()
        if matters is None:
            raise ValueError("expected a table that was just swept with samples")
        return pd.DataFrame({name: values for name, _, values in matters})

    def quantile(self, probability: float, scene: Scene, *, progress: Progress = False) -> Table:
        """The table of one sample: of the one whose mean friction over the table is the quantile of a probability.

        It is drawn again from the scene and swept again, so that the whole is a curve that can occur.

        Args:
            probability: From 0 to 1.
            scene: The scene that this table with samples was swept from.
            progress: As for :meth:`Scene.sweep`.

        Raises:
            SceneError: Where the table has no samples, or was not swept from the scene.
        """
        from ._arguments import shown

        return Table._of(self._native.quantile(scene._native, probability, shown(progress)))

    def plot(self, column: str = "friction") -> Figure:
        """Draws a column over the speed with matplotlib, a curve for each load and temperature.

        Points that are not steady are hollow.
        """
        from ._plots import drawn

        self[column]
        return drawn(self._native.picture(column))

    def plot_map(self, x: str = "speed", y: str = "temperature", column: str = "friction") -> Figure:
        """Draws a column in colours over two of speed, load and temperature, with contour lines.

        A map for each value of the third. Dots mark where along x the column is largest for each y, if that is inside.
        What has no result is empty.

        Raises:
            ValueError: Where these are not two of them, or one has a single value.
        """
        from ._plots import drawn

        self[column]
        return drawn(self._native.map(x, y, column))

    def compare(self, data: object, *, columns: Mapping[str, str | int] | None = None) -> Comparison:
        """Compares the table with measured friction, as ``asperity compare`` does.

        Args:
            data: What :meth:`Scene.calibrate` takes: the path of a table, a DataFrame or a mapping.
            columns: As for :meth:`Scene.calibrate`.

        Raises:
            ValueError: Where the table is over forces, or has no friction at any of the measurements.
        """
        from ._comparison import Comparison

        with table_file(data) as path:
            found = self._native.compare(given(data=path, columns=given_columns(columns)))
        for text in found.pop("warnings"):
            warnings.warn(text, stacklevel=2)
        refused = found.pop("refused")
        if refused is not None:
            raise ValueError(refused)
        return Comparison._of(found)

    def pack(
        self,
        path: str | PathLike[str],
        libraries: Sequence[str | PathLike[str]] | None = None,
        *,
        flat_names: bool = False,
        references: bool = True,
    ) -> Path:
        """Packs the table as an FMU, a point-contact element, and returns its path.

        Args:
            path: The FMU to write.
            libraries: As for :meth:`Scene.pack`.
            flat_names: As for :meth:`Scene.pack`.
            references: As for :meth:`Scene.pack`.
        """
        given = library_options(libraries)
        with tempfile.TemporaryDirectory(prefix="asperity-") as folder:
            file = Path(folder) / "table.csv"
            self.to_csv(file)
            warn_of_packed(_native.pack_table(file, Path(path), given, {"flat_names": flat_names, "references": references}))
        return Path(path)

    def __reduce__(self) -> tuple[Any, tuple[_native.Table]]:
        return Table._of, (self._native,)

    def __repr__(self) -> str:
        sizes = f"{len(self.speeds)} speeds, {len(self.loads)} loads, {len(self.temperatures)} temperatures"
        return f"<asperity.Table: {sizes}; {', '.join(self.columns)}>"
