"""Contacts in steady sliding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _native
from ._arguments import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class Contact:
    """Where the rubber touches in steady sliding, and how hard.

    Attributes:
        x: Places along x, the direction of sliding, m, shape (nx,).
        y: Places along y, m, shape (ny,); one of a profile.
        height: Heights of the surface about their mean, m, shape (ny, nx).
        pressure: Pressures, Pa, shape (ny, nx); 0 where nothing touches.
        gap: Gaps between rubber and surface, m, shape (ny, nx).
        friction: Friction coefficient, 1; None where it jams.
        friction_profile: The part of it by the slopes of the surface, 1.
        friction_fine: The part by the waves that the surface lacks, 1; None where it lacks none that rub.
        friction_adhesion: The part by what acts in the contacts else, 1; None where it jams.
        area: Points in contact over all, 1.
        area_real: Area that touches with the waves that the surface lacks over the whole, 1; None without them.
        separation: Distance of the mean planes of rubber and surface, m.
        flash_mean: Mean flash temperature over the contact, K; None where friction heats nothing.
        surface_rise: How much warmer the surface is than the rubber was before, K; None without a way.
        leak_gap: Distance of smooth plates that let as much of a fluid through along the sliding, m; None unless asked for.
        drag_gap: Distance of smooth plates that carry as much of it along, m; None unless asked for.
        leak_gap_across: The leak gap across the sliding, m; None of a profile, and unless asked for.
        leak: Where it leaks along the sliding, m³, shape (ny, nx): 12 η times the flow per width over the mean gradient of
            pressure; None of a profile, whose gaps stand for an isotropic roughness, and unless asked for.
        status: "steady", or why the values cannot be relied on.
    """

    x: Floats
    y: Floats
    height: Floats
    pressure: Floats
    gap: Floats
    friction: float | None
    friction_profile: float
    friction_fine: float | None
    friction_adhesion: float | None
    area: float
    area_real: float | None
    separation: float
    flash_mean: float | None
    surface_rise: float | None
    leak_gap: float | None
    drag_gap: float | None
    leak_gap_across: float | None
    leak: Floats | None
    status: str
    _picture: _native.Picture

    @classmethod
    def _of(cls, found: dict[str, Any]) -> Contact:
        shape = (len(found["y"]), len(found["x"]))
        given = (name for name in ("height", "pressure", "gap", "leak") if found[name] is not None)
        fields = {name: found[name].reshape(shape) for name in given}
        picture = found.pop("picture")
        return cls(**{**found, **fields}, _picture=picture)

    def plot(self) -> Figure:
        """Draws with matplotlib: along a profile curves, over a map pressure, gap, contact and, where it has one, leak."""
        from ._plots import drawn

        return drawn(self._picture)

    def __repr__(self) -> str:
        friction = "none" if self.friction is None else f"{self.friction:.4g}"
        return f"<asperity.Contact: friction {friction}, area {self.area:.4g}, {self.status}>"
