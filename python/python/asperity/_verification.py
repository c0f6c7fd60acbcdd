"""What ways of driving an FMU lose against the result that it carries."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ._arguments import Floats

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False, repr=False)
class Verification:
    """The experiment of an FMU, driven in several ways.

    Attributes:
        name: The model's name.
        ways: How it was driven: with rates or with values alone, at the experiment's steps, longer and shorter ones.
        quantities: The outputs that were compared.
        differences: The largest difference from the result over the rows, as a share of the largest value of all results of
            the same unit; shape (ways, quantities), nan where the FMU did not come to the end.
        problems: Why it did not, by the way.
        result: What the result is, with its own estimated error, in a sentence.
        deviations: What of the FMU is not as this package packs it of its resources; empty where all is.
        facts: What else was looked at.
    """

    name: str
    ways: tuple[str, ...]
    quantities: tuple[str, ...]
    differences: Floats
    problems: Mapping[str, str]
    result: str
    deviations: tuple[str, ...] = ()
    facts: tuple[str, ...] = ()

    def __getitem__(self, way: str) -> dict[str, float]:
        """The differences of a way, by quantity."""
        try:
            row = self.differences[self.ways.index(way)]
        except ValueError:
            raise KeyError(f"{way}: expected one of {', '.join(self.ways)}") from None
        return dict(zip(self.quantities, row.tolist(), strict=True))

    def to_pandas(self) -> pd.DataFrame:
        """The differences as a DataFrame: a row a way, a column a quantity."""
        import pandas as pd

        return pd.DataFrame(self.differences, index=list(self.ways), columns=list(self.quantities))

    def __str__(self) -> str:
        """The table: forces, the energy lost, and what differs most."""
        main = ("F_x", "F_z", "force.x", "force.z", "force_x", "force_z", "E_diss")
        shown = [name for name in main if name in self.quantities]
        width = max(len(way) for way in self.ways) + 2
        lines = [f"{self.name}: difference from the result that it carries, as a share of the largest value"]
        lines.append("".ljust(width) + "".join(f"{name:>14}" for name in shown) + "   most")
        for way, row in zip(self.ways, self.differences, strict=True):
            if way in self.problems:
                lines.append(f"{way.ljust(width)}{self.problems[way]}")
                continue
            worst = int(np.argmax(row))
            numbers = "".join(f"{self[way][name]:14.1e}" for name in shown)
            lines.append(f"{way.ljust(width)}{numbers}   {row[worst]:.1e} of {self.quantities[worst]}")
        lines.append(f"The result: {self.result}")
        lines.extend(self.facts)
        lines.extend(f"Not as packed: {deviation}" for deviation in self.deviations)
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<asperity.Verification: {self.name}, {len(self.ways)} ways, {len(self.quantities)} quantities>"
