"""Tables of sweeps."""

from __future__ import annotations

import csv
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
from ._library import warn_of_start

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
        text: The table as ``asperity sweep`` writes it.
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
        self.text = text
        self._matters = matters
        self._drawn = {name: np.array(values) for name, values in (drawn or {}).items()}
        self._samples: dict[str, Floats] = {}
        lines = [line for line in text.splitlines() if line and not line.startswith("#")]
        if not lines:
            raise ValueError("expected the text of a table, found no rows")
        head, *rows = csv.reader(lines)
        names = [name.split(" [")[0] for name in head]
        self.units = {name: full.partition(" [")[2].rstrip("]") for name, full in zip(names, head, strict=True)}
        if any(len(row) != len(head) for row in rows) or not rows:
            raise ValueError("expected the text of a table of asperity sweep, found rows of other lengths")
        columns = dict(zip(names, zip(*rows, strict=True), strict=True))
        self.load = "pressure" if "pressure" in columns else "force"
        missing = {"speed", self.load, "status", "friction"} - set(columns)
        if missing:
            raise ValueError(f"expected the text of a table of asperity sweep, found none of {sorted(missing)}")
        kelvin = columns.get("temperature", ("",) * len(rows))
        axes = [np.unique(_floats(values)) for values in (columns["speed"], columns[self.load], kelvin)]
        self.speeds, self.loads, self.temperatures = axes
        places = tuple(
            np.searchsorted(axis, _floats(values))
            for axis, values in zip(axes, (columns["speed"], columns[self.load], kelvin), strict=True)
        )
        shape = tuple(map(len, axes))
        self.status = np.full(shape, "", dtype=object)
        self.status[places] = columns["status"]
        self._columns: dict[str, Floats] = {}
        for name in names:
            if name.endswith("_samples"):
                values = np.array([_floats(text.split(";")) for text in columns[name]])
                samples = np.full((*shape, values.shape[1]), np.nan)
                samples[places] = values
                self._samples[name.removesuffix("_samples")] = np.moveaxis(samples, -1, 0)
            elif name not in ("speed", self.load, "temperature", "status"):
                self._columns[name] = np.full(shape, np.nan)
                self._columns[name][places] = _floats(columns[name])

    @classmethod
    def read(cls, path: str | PathLike[str]) -> Table:
        """The table in a file that ``asperity sweep`` or :meth:`to_csv` wrote."""
        return cls(Path(path).read_text(encoding="utf-8"))

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

        if not self._samples:
            raise ValueError("expected the table of a sweep with samples")
        names, coordinates = self._coordinates()
        data: dict[str, Any] = {name: (("sample", *names), values) for name, values in self._samples.items()}
        data |= {name: ("sample", values) for name, values in self._drawn.items()}
        coordinates["sample"] = np.arange(1, 1 + len(self._samples["friction"]))
        return xr.Dataset(data, coords=coordinates)

    @property
    def matters(self) -> pd.DataFrame:
        """The part of friction's variance over the samples that each uncertain key explains (share) and its standard_error: in
        the mean over all points, where speed is nan, and at each point.

        Raises:
            ValueError: Of a table that was not just swept with samples.
        """
        import io

        import pandas as pd

        if not self._matters:
            raise ValueError("expected a table that was just swept with samples")
        frame = pd.read_csv(io.StringIO(self._matters))
        return frame.rename(columns={name: name.split(" [")[0] for name in frame.columns})

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

        return Table(_native.quantile(scene._native, self.text, probability, shown(progress)))

    def plot(self, column: str = "friction") -> Figure:
        """Draws a column over the speed with matplotlib, a curve for each load and temperature.

        Points that are not steady are hollow.
        """
        from ._plots import swept

        unit = "Pa" if self.load == "pressure" else "N"
        found = np.isin(self.status, ("steady", "full contact"))
        curves = [
            (_label(load, unit, kelvin), self.speeds, self[column][:, j, k], found[:, j, k])
            for k, kelvin in enumerate(self.temperatures)
            for j, load in enumerate(self.loads)
        ]
        return swept(f"{column} [{self.units[column]}]", curves)

    def plot_map(self, x: str = "speed", y: str = "temperature", column: str = "friction") -> Figure:
        """Draws a column in colours over two of speed, load and temperature, with contour lines.

        A map for each value of the third. Dots mark where along x the column is largest for each y, if that is inside.
        What has no result is empty.

        Raises:
            ValueError: Where these are not two of them, or one has a single value.
        """
        from ._plots import maps

        names = ("speed", self.load, "temperature")
        if x == y or not {x, y} <= set(names):
            raise ValueError(f"x = {x!r}, y = {y!r}: expected two of {', '.join(names)}")
        axes = dict(zip(names, (self.speeds, self.loads, self.temperatures), strict=True))
        for name in (x, y):
            if len(axes[name]) < 2:
                raise ValueError(f"{name}: expected at least 2 values along each side of a map, found {len(axes[name])}")
        (third,) = set(names) - {x, y}
        units = {"speed": "m/s", "pressure": "Pa", "force": "N", "temperature": "K"}
        found = np.isin(self.status, ("steady", "full contact"))
        values = np.where(found, self[column], np.nan)
        values = np.moveaxis(values, [names.index(third), names.index(y), names.index(x)], [0, 1, 2])
        titles = ["" if np.isnan(value) else f"{value:g} {units[third]}" for value in axes[third]]
        sides = [(f"{name} [{units[name]}]", axes[name], _is_logarithmic(name, axes[name])) for name in (x, y)]
        return maps(f"{column} [{self.units[column]}]", (sides[0], sides[1]), list(zip(titles, values, strict=True)))

    def compare(self, data: object, *, columns: Mapping[str, str | int] | None = None) -> Comparison:
        """Compares the table with measured friction, as ``asperity compare`` does.

        Args:
            data: What :meth:`Scene.calibrate` takes: the path of a table, a DataFrame or a mapping.
            columns: As for :meth:`Scene.calibrate`.

        Raises:
            ValueError: Where the table is over forces, or has no friction at any of the measurements.
        """
        from ._comparison import Comparison

        with tempfile.TemporaryDirectory(prefix="asperity-") as folder, table_file(data) as path:
            file = Path(folder) / "table.csv"
            self.to_csv(file)
            found = _native.compare(file, given(data=path, columns=given_columns(columns)))
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
        given = library_options() if libraries is None else [str(library) for library in libraries]
        with tempfile.TemporaryDirectory(prefix="asperity-") as folder:
            file = Path(folder) / "table.csv"
            self.to_csv(file)
            warn_of_start(_native.pack_table(file, Path(path), given, {"flat_names": flat_names, "references": references}))
        return Path(path)

    def __reduce__(self) -> tuple[type[Table], tuple[str, str, dict[str, Floats]]]:
        return type(self), (self.text, self._matters, self._drawn)

    def __repr__(self) -> str:
        sizes = f"{len(self.speeds)} speeds, {len(self.loads)} loads, {len(self.temperatures)} temperatures"
        return f"<asperity.Table: {sizes}; {', '.join(self.columns)}>"


def _is_logarithmic(name: str, values: Floats) -> bool:
    return name == "speed" or (name != "temperature" and bool(values[-1] >= 10.0 * values[0]))


def _label(load: float, unit: str, kelvin: float) -> str:
    return f"{load:g} {unit}" + ("" if np.isnan(kelvin) else f", {kelvin:g} K")


def _floats(texts: Sequence[str]) -> Floats:
    return np.array([float(text) if text else np.nan for text in texts], dtype=np.float64)
