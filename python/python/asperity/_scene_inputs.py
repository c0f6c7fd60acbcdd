"""What comes into a scene as arrays, tables and files."""

from __future__ import annotations

import warnings
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import lines_along_x, numbers, table_text, to_toml, with_units
from ._scene_text import SceneText

if TYPE_CHECKING:
    from typing_extensions import Self

    from ._fit import Fit

# The columns of a motion that are in SI units where their names say nothing else.
_MOTION = {"time": "s", "u": "m", "w": "m", "load": "N", "pull": "N", "pressure": "Pa", "temperature": "K"}


class SceneInputs(SceneText):
    """The methods that take a surface, a compound or a motion, and return a changed copy."""

    def with_profile(self, x: ArrayLike, z: ArrayLike, periodic: bool = False, **keys: object) -> Self:
        """A copy that slides on the profile through these points.

        Args:
            x: Positions, m, shape (n,), rising.
            z: Heights, m, shape (n,). Of a periodic profile the last is the first.
            periodic: Whether it is repeated without end.
            keys: Other keys of the surface, such as ``fine``, which is kept where it is not given.
        """
        surface = {"kind": "points", "x": numbers("x", x), "z": numbers("z", z), "periodic": periodic}
        return self._changed({"surface": to_toml({**self._fine(), **surface, **keys})})

    def with_map(
        self, heights: ArrayLike, spacing: float | tuple[float, float], periodic: bool = True, **keys: object
    ) -> Self:
        """A copy that slides on a map of heights.

        Args:
            heights: Heights, m, shape (ny, nx): lines along x, the direction of sliding, one after the other along y. Of
                an array that names its axes, of xarray or pandas, these count, and their coordinates have to have the
                spacing; masked heights are missing, as NaN are.
            spacing: Distance of the points, m; or those along x and along y.
            periodic: Whether it is repeated without end along both axes; the point behind the last is then the first.
            keys: Other keys of the surface, such as ``line``, or ``fine``, which is kept where it is not given.
        """
        dx, dy = spacing if isinstance(spacing, tuple) else (spacing, spacing)
        array = lines_along_x(heights, (float(dx), float(dy)))
        surface = {"kind": "file", "path": "with_map.csv", "spacing": [float(dx), float(dy)], "periodic": periodic}
        units = {"x_unit": "m", "z_unit": "m"}
        text = "\n".join(",".join(map(repr, line)) for line in array.tolist()) + "\n"
        keys = {**self._fine(), **surface, **units, **keys}
        return self._changed({"surface": to_toml(keys)}, {"with_map.csv": text.encode()})

    def with_spectrum(
        self,
        q: ArrayLike,
        C: ArrayLike,
        longest: float | None = None,
        shortest: float | None = None,
        **keys: object,
    ) -> Self:
        """A copy whose surface has, below its profile, the roughness of a spectrum.

        Args:
            q: Wave numbers, 1/m, shape (n,), rising.
            C: Spectrum of an isotropic surface, m⁴, shape (n,).
            longest: Longest wave of that roughness, m: where the profile ends; None: that of the first q.
            shortest: Shortest wave, m; None: that of the last q.
            keys: Other keys of ``surface.fine``, such as ``convention`` ("persson" or "contact.engineering") and
                ``hysteresis``.
        """
        waves = numbers("q", q)
        text = table_text({"q [1/m]": waves, "C [m^4]": numbers("C", C)})
        first, last = 2.0 * np.pi / waves[0], 2.0 * np.pi / waves[-1]
        ends = {"longest": first if longest is None else longest, "shortest": last if shortest is None else shortest}
        fine = {"spectrum": "with_spectrum.csv", **ends, **keys}
        return self._changed({"surface.fine": to_toml(fine)}, {"with_spectrum.csv": text.encode()})

    def with_prony(self, moduli: ArrayLike, times: ArrayLike, equilibrium: float | None = None) -> Self:
        """A copy of another compound.

        Args:
            moduli: Moduli E_j of the terms, Pa, shape (n,).
            times: Relaxation times τ_j, s, shape (n,).
            equilibrium: Modulus E_∞, Pa; None: as it was.
        """
        moduli, times = numbers("moduli", moduli), numbers("times", times)
        if len(moduli) != len(times):
            raise ValueError(f"expected a time for each modulus, found {len(moduli)} moduli and {len(times)} times")
        terms = [{"modulus": modulus, "relaxation_time": time} for modulus, time in zip(moduli, times, strict=True)]
        settings = {"material.prony": to_toml(terms)}
        if equilibrium is not None:
            settings["material.equilibrium_modulus"] = to_toml(float(equilibrium))
        return self._changed(settings)

    def with_fit(self, fit: Fit) -> Self:
        """A copy of the compound that was fitted by :func:`asperity.fit`, with its viscosity and its shift."""
        scene = self.with_prony(fit.moduli, fit.times, fit.equilibrium_modulus)
        if fit.viscosity > 0.0:
            scene["material.viscosity"] = fit.viscosity
        if fit.wlf is not None:
            c1, c2, reference = fit.wlf
            temperature = self["material.wlf.temperature"] if "material.wlf.temperature" in self else reference
            wlf = {"c1": c1, "c2": c2, "reference_temperature": reference, "temperature": temperature}
            scene["material.wlf"] = wlf
        return scene

    def with_motion(self, motion: object) -> Self:
        """A copy that moves along a table, straight from row to row.

        Args:
            motion: The path of a table, a DataFrame, or a mapping of names to arrays of shape (n,): ``time`` (s), ``u``
                and ``w`` (m); of a carrier that is a body ``load``, ``pressure`` and ``pull``; ``temperature`` (K) where
                it is an input. Names may have units, as in ``"u [mm]"``. Inputs that are missing stay as at the start, u
                and w with a warning. Both count from the first row, with a warning where that is not u = w = 0: a run of
                a scene starts there. :class:`Simulation` starts anywhere.
        """
        if isinstance(motion, str | PathLike):
            path = Path(motion)
            name, content = f"with_motion{path.suffix}", path.read_bytes()
        else:
            name, content = "with_motion.csv", table_text(with_units(motion, _MOTION)).encode()
        scene = self._changed({"excitation": to_toml([{"file": name}])}, {name: content})
        place = motion if isinstance(motion, str | PathLike) else "motion"
        for text in scene._native.assumptions:
            if text.startswith(f"{name}: "):
                warnings.warn(f"{place}{text.removeprefix(name)}", stacklevel=2)
        return scene

    def _fine(self) -> dict[str, Any]:
        return {"fine": self["surface.fine"]} if "surface.fine" in self else {}
