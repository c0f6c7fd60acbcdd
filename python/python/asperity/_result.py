"""Results of runs."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._arguments import Floats

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from ._moment import Moment
    from ._scene import Scene


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """The rows of a run: ``result["F_x"]`` is a column, an array of shape (rows,).

    Attributes:
        name: The scene's name.
        columns: All columns by their names, each of shape (rows,): ``time``, the inputs, the outputs.
        units: Their units, and those of the elements' fields.
        elements: The fields of the masses by their names, each of shape (rows, masses): x, z (m), F_N, F_T (N), mode
            (0 free, 1 or -1 slipping, 2 sticking), flash (K); empty unless they were asked for.
        profile: x and z of the data points of the profile, m, each of shape (n,).
        scene: The scene that was run; None of an FMU's run.
    """

    name: str
    columns: dict[str, Any]
    units: dict[str, str]
    elements: dict[str, Any]
    profile: tuple[Floats, Floats]
    scene: Scene | None = None
    _instants: Floats | None = None

    def __getitem__(self, name: str) -> Any:
        """A column, shape (rows,)."""
        try:
            return self.columns[name]
        except KeyError:
            known = ", ".join(self.columns)
            raise KeyError(f"{name}: expected one of {known}; fmu.outputs of the scene says which there are") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.time)

    @property
    def time(self) -> Floats:
        """Times of the rows, s, shape (rows,)."""
        time: Floats = self.columns["time"]
        return time

    def to_pandas(self) -> pd.DataFrame:
        """The columns as a DataFrame over the time; ``attrs["units"]`` has their units."""
        import pandas as pd

        frame = pd.DataFrame(self.columns).set_index("time")
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_xarray(self) -> xr.Dataset:
        """The columns over the time and, where they were kept, the fields of the masses over time and mass."""
        import xarray as xr

        unit = {name: {"units": unit} for name, unit in self.units.items()}
        data: dict[str, Any] = {
            name: ("time", values, unit[name]) for name, values in self.columns.items() if name != "time"
        }
        for name, values in self.elements.items():
            data[f"element_{name}"] = (("time", "mass"), values, unit[name])
        return xr.Dataset(data, coords={"time": ("time", self.time, unit["time"])}, attrs={"scene": self.name})

    def plot(self, *names: str, x: str = "time") -> Figure:
        """Draws columns over the time with matplotlib, those of one unit in one panel.

        Args:
            names: The columns; none for F_x and F_z.
            x: The column on the horizontal axis.
        """
        from ._plots import drawn

        chosen = names or tuple(name for name in ("F_x", "F_z") if name in self.columns)
        panels: dict[str, list[str]] = {}
        for name in chosen:
            panels.setdefault(self.units[name], []).append(name)

        def values(name: str) -> Floats:
            return np.asarray(self[name], dtype=np.float64)

        curves = [
            (", ".join(group), unit, [(name, values(name)) for name in group]) for unit, group in panels.items()
        ]
        return drawn(_native.curves(self.name, (x, self.units[x], values(x)), curves))

    def animate(self, path: str | PathLike[str]) -> Path:
        """Writes the page for a browser that ``asperity simulate --animate`` writes, and returns its path.

        The run has to have kept its masses: ``simulate(elements=True)``.

        Args:
            path: The file to write, .html.
        """
        place = Path(path)
        if place.suffix.lower() != ".html":
            raise ValueError(f"{place}: expected a name that ends in .html")
        place.write_text(_native.animate(*self._masses()), encoding="utf-8")
        return place

    def contact(self, time: float) -> Moment:
        """The masses at the row that is nearest to a time, as ``asperity simulate --contact`` draws them.

        The run has to have kept its masses: ``simulate(elements=True, times=[...])``, which makes rows of these times.

        Args:
            time: The time, s.
        """
        from ._moment import Moment

        last = float(self.time[-1])
        if not 0.0 <= time <= last * (1.0 + 1e-9):
            raise ValueError(f"time = {time:g}: expected a time of the run, 0 to {last:g} s")
        return Moment._of(self.name, _native.moment(*self._masses(), time))

    def _masses(self) -> tuple[_native.Scene, Floats, Floats]:
        """The scene, its rows, and the fields of a mass beside each other, mass by mass, row by row."""
        if self.scene is None or self._instants is None or not self.elements:
            raise ValueError("the masses of the run were not kept: expected simulate(elements=True)")
        fields = [np.asarray(values, dtype=np.float64) for values in self.elements.values()]
        return self.scene._native, self._instants, np.stack(fields, axis=-1).ravel()

    def __repr__(self) -> str:
        return f"<asperity.Result of {self.name!r}: {len(self)} rows of {', '.join(self.columns)}>"

    def _repr_html_(self) -> str:
        head = f"<p>{html.escape(self.name)}: {len(self)} rows, t = {self.time[0]:g} to {self.time[-1]:g} s</p>"
        try:
            figure = self.plot()
        except ImportError:
            return head + f"<p>{html.escape(', '.join(self.columns))}</p>"
        image = io.BytesIO()
        figure.savefig(image, format="png", dpi=100)
        return head + f'<img src="data:image/png;base64,{base64.b64encode(image.getvalue()).decode()}">'
