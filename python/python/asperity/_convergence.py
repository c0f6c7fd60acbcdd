"""Studies of convergence: whether friction and area depend on spacing, length or chance."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._arguments import Floats

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Convergence:
    """What a study of a scene found.

    ``study["friction"]`` is a column of its runs, an array of shape (runs,), nan where a run has no value.

    Attributes:
        text: The table as ``asperity converge`` writes it.
        is_converged: Whether all that is left open is known and within the error.
        verdict: The same in a sentence, which names the source that leaves most open.
        open: What each source (spacing, length, split, chance) leaves open, as shares of friction and of area; None
            where that is not known.
        coarsest: The coarsest spacings that will do for friction and for area, m; None where none that was tried does.
        parts: What is counted in a run: "points" of the surface along x, or "masses".
        units: Units of the columns.
        status: "steady", "full contact", or why a run has no values; shape (runs,).
    """

    text: str
    is_converged: bool
    verdict: str
    open: dict[str, tuple[float, float] | None]
    coarsest: tuple[float | None, float | None]
    parts: str
    units: dict[str, str]
    status: np.ndarray[Any, np.dtype[np.object_]]
    _columns: dict[str, Floats]
    _picture: _native.Picture

    @classmethod
    def _of(cls, found: dict[str, Any]) -> Convergence:
        columns = {name: (unit, values) for name, unit, values in found.pop("columns")}
        units = {name: unit for name, (unit, _) in columns.items()}
        _, status = columns.pop("status")
        # Seeds, which have 64 bits, are words.
        floats = {
            name: np.array([value or "nan" if isinstance(value, str) else value for value in values], dtype=np.float64)
            for name, (_, values) in columns.items()
        }
        found |= {"coarsest": tuple(found["coarsest"]), "_picture": found.pop("picture")}
        return cls(**found, units=units, status=np.array(status, dtype=object), _columns=floats)

    def __getitem__(self, name: str) -> Floats:
        """A column, shape (runs,)."""
        try:
            return self._columns[name]
        except KeyError:
            raise KeyError(f"{name}: expected one of {', '.join(self._columns)}") from None

    def __len__(self) -> int:
        return len(self.status)

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return list(self._columns)

    def to_csv(self, path: str | PathLike[str]) -> None:
        """Writes the table, which ``asperity converge`` goes on with."""
        Path(path).write_text(self.text, encoding="utf-8")

    def to_pandas(self) -> pd.DataFrame:
        """A row a run."""
        import pandas as pd

        frame = pd.DataFrame({**self._columns, "status": self.status})
        frame.attrs["units"] = dict(self.units)
        return frame

    def plot(self) -> Figure:
        """Draws friction and area over the spacing with matplotlib, beside Persson's theory."""
        from ._plots import drawn

        return drawn(self._picture)

    def __repr__(self) -> str:
        return f"<asperity.Convergence: {len(self)} runs; {self.verdict}>"
