"""Tables that the native part finds, by their columns."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

FoundColumn = tuple[str, str, Any]


class Found:
    """Columns of numbers and of words, each by its name, an array of shape (rows,)."""

    def __init__(self, columns: list[FoundColumn]) -> None:
        """Of names, units and values."""
        self._columns = {name: values for name, _, values in columns}
        self.units = {name: unit for name, unit, _ in columns}

    def __getitem__(self, name: str) -> NDArray[Any]:
        """A column, shape (rows,)."""
        import numpy as np

        try:
            return np.asarray(self._columns[name])
        except KeyError:
            raise KeyError(f"{name}: expected one of {', '.join(self._columns)}") from None

    def to_pandas(self) -> pd.DataFrame:
        """The rows."""
        import pandas as pd

        frame = pd.DataFrame(self._columns)
        frame.attrs["units"] = dict(self.units)
        return frame

    def __len__(self) -> int:
        """The number of rows."""
        return len(next(iter(self._columns.values()), ()))

    def __repr__(self) -> str:
        return f"<asperity.{type(self).__name__}: {len(self)} rows; {', '.join(self._columns)}>"
