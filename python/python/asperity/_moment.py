"""The contact of a run at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._arguments import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Moment:
    """The masses of a layer at a row of a run, as ``asperity simulate --contact`` draws them.

    Attributes:
        name: The scene's name.
        time: The time of the row, s.
        u: Displacement of the carrier along x, m.
        w: Displacement along z, m.
        slides: How far the carrier came along x since the row before, m: its sign is the direction of sliding.
        x: Places of the masses along x, m, shape (masses,).
        z: Their heights, m, shape (masses,).
        load: Their pressures, Pa, or their normal forces, N, where the scene gives them no area; shape (masses,).
        load_name: What the load is, "pressure" or "normal force".
        load_unit: Its unit.
        touch: "sticks", "slips" or "free", shape (masses,).
        flash: Flash temperatures, K, shape (masses,); None where friction heats nothing.
        profile: x and z of the profile below the layer, m, each of shape (n,).
        heights: The lowest and the highest z that are drawn, m.
        spacing: Distance of the masses at rest, m.
    """

    name: str
    time: float
    u: float
    w: float
    slides: float
    x: Floats
    z: Floats
    load: Floats
    load_name: str
    load_unit: str
    touch: np.ndarray[Any, np.dtype[np.str_]]
    flash: Floats | None
    profile: tuple[Floats, Floats]
    heights: tuple[float, float]
    spacing: float
    _picture: _native.Picture

    @classmethod
    def _of(cls, name: str, found: dict[str, Any]) -> Moment:
        load_name, load_unit = found.pop("load_unit")
        touch = np.array(found.pop("touch"))
        picture = found.pop("picture")
        return cls(name=name, load_name=load_name, load_unit=load_unit, touch=touch, _picture=picture, **found)

    def plot(self) -> Figure:
        """Draws masses, profile and loads with matplotlib."""
        from ._plots import drawn

        return drawn(self._picture)

    def __repr__(self) -> str:
        counts = ", ".join(f"{np.sum(self.touch == touch)} {touch}" for touch in ("sticks", "slips", "free"))
        return f"<asperity.Moment of {self.name!r} at t = {self.time:g} s: {counts}>"
