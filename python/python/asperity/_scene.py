"""Scenes: what is simulated."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arguments import Progress, axis, given, given_columns, mapping, numbers, positive, shown, to_toml
from ._files import table_file
from ._library import options as library_options
from ._library import warn_of_packed
from ._scene_inputs import SceneInputs

if TYPE_CHECKING:
    from ._calibration import Calibration
    from ._contact import Contact
    from ._convergence import Convergence
    from ._result import Result
    from ._surface import Surface
    from ._table import Table

Method = Literal["steady", "layer"]


class Scene(SceneInputs):
    """A rubber layer on a rough, rigid surface, its friction and its motion.

    A scene is the text of a scene file (TOML, in SI units; all keys are in docs/reference.md) with keys set in it.
    ``scene["friction.coulomb"] = 0.4`` sets one, ``scene["friction"]`` reads one. The methods ``with_...`` return a
    changed copy. Scenes compare by what they are, and can be copied and pickled with the files that they read.

    Raises:
        SceneError: Where a key or a value is refused: with file, line and key.
    """

    def simulate(
        self,
        rows: int = 50,
        motion: object = None,
        *,
        times: ArrayLike = (),
        elements: bool = False,
        progress: Progress = False,
    ) -> Result:
        """Runs the scene along its excitation, or along a motion.

        The interpreter's lock is released, and Ctrl-C ends the run.

        Args:
            rows: Number of rows for each phase; a motion has a row for each of its own.
            motion: What :meth:`with_motion` takes; None: the scene's excitation.
            times: Times of rows besides these, s, within the run.
            elements: Whether to keep position, forces and mode of every mass, for :meth:`Result.animate` and
                :meth:`Result.contact` too.
            progress: True for a line on standard error, or a function of the fraction done.

        Raises:
            SimulationError: Where the run cannot go on.
        """
        from ._result import Result

        scene = self if motion is None else self.with_motion(motion)
        if rows < 1:
            raise ValueError(f"rows = {rows}: expected 1 or more")
        if scene.duration <= 0.0:
            raise ValueError(f"{self.name}: the scene has no excitation to run along; expected motion=, or [[excitation]]")
        also_at = numbers("times", times)
        if not np.all((also_at >= 0.0) & (also_at <= scene.duration)):
            raise ValueError(f"times: expected numbers from 0 to {scene.duration:g} s, the end of the run")
        found = _native.simulate(scene._native, given(rows=rows, times=also_at), elements, shown(progress))
        (columns, units), (of_masses, mass_units), instants, said = found
        for text in said:
            warnings.warn(text, stacklevel=2)
        length = len(columns["time"])
        fields = {name: values.reshape(length, -1) for name, values in of_masses.items()}
        return Result(scene.name, columns, {**mass_units, **units}, fields, scene.profile, scene, instants)

    def sweep(
        self,
        speeds: ArrayLike,
        pressures: ArrayLike | None = None,
        temperatures: ArrayLike | None = None,
        *,
        forces: ArrayLike | None = None,
        method: Method | None = None,
        way: float | None = None,
        points: int | None = None,
        friction_error: float | None = None,
        distance: float | None = None,
        gaps: bool | Literal["solved", "medium"] = False,
        samples: int | None = None,
        seed: int = 1,
        refit: bool = False,
        progress: Progress = False,
    ) -> Table:
        """Friction in steady sliding over speed, load and temperature, on all cores.

        Ctrl-C is raised at once. A point that is being solved for as it comes ends in the background.

        Args:
            speeds: Speeds, m/s.
            pressures: Mean pressures, Pa; of a scene in the material form.
            temperatures: Temperatures, K, or texts such as ``"20 °C"``; None: the scene's own.
            forces: Mean normal forces of the whole layer, N, in place of pressures.
            method: "steady" solves for steady sliding, "layer" lets the layer slide until it is steady; None: "steady"
                where the scene can be solved for.
            way: The way slid so far, m: the scene's temperature is that of the rubber before it slid; None: of the surface
                around its contacts. With "steady", of a scene with material.heat.
            points: Points of a period along x, with "steady".
            friction_error: Admissible standard error of friction over it, with "layer"; None: 5e-3.
            distance: Longest distance that a layer slides, m; None: 100 blocks.
            gaps: Also how a fluid passes the gaps of the contact, with "steady": columns ``leak_gap`` and ``drag_gap``, m,
                of a map ``leak_gap_across``; "medium" has the effective medium of a map beside.
            samples: Each point also for so many scenes drawn from the section [uncertainty] of this one: quantiles are
                columns of the table, all samples :attr:`Table.samples`, what matters :attr:`Table.matters`.
            seed: What scrambles the points of the samples.
            refit: Fits the numbers of the covariance in [uncertainty] anew in each sample, by the measurements that
                :meth:`calibrate` stored with it, before they vary: so bands hold what was measured where other things
                vary beside it (surface, seed, series).
            progress: True for a line on standard error, or a function of the fraction done.

        Raises:
            SceneError: Where the scene does not go with what is asked for.
            ValueError: Where ``refit`` has no samples.
        """
        from ._table import Table

        if refit and samples is None:
            raise ValueError("refit: expected samples, in each of which the covariance's numbers are fitted anew")

        swept, said = _native.sweep(
            self._native,
            given(
                speeds=axis("speeds", speeds),
                pressures=None if pressures is None else axis("pressures", pressures),
                forces=None if forces is None else axis("forces", forces),
                temperatures=None if temperatures is None else axis("temperatures", temperatures),
                method=method,
                way=None if way is None else positive("way", way),
                points=points,
                friction_error=friction_error,
                distance=distance,
                gaps="solved" if gaps is True else gaps or None,
            ),
            None if samples is None else (samples, seed, refit),
            shown(progress),
        )
        for warning in said:
            warnings.warn(warning, stacklevel=2)
        table = Table._of(swept)
        failed = [status for status in table.status.ravel() if status not in ("steady", "full contact")]
        if failed:
            text = f"{len(failed)} of {table.status.size} points are not steady or failed, the first: {failed[0]}"
            warnings.warn(f"{text}; Table.status says which", stacklevel=2)
        return table

    def contact(
        self,
        pressure: float,
        speed: float,
        points: int | None = None,
        *,
        way: float | None = None,
        flow: bool = False,
    ) -> Contact:
        """Where the rubber touches in steady sliding, and how hard.

        The scene has to be in the material form with a foundation "half_space" or "layer" and a periodic surface.

        Args:
            pressure: Mean pressure, Pa.
            speed: Speed, m/s.
            points: Points of a period along x; None: the surface's own, or of a profile 8 to its shortest wave where
                they are uneven or fewer.
            way: As for :meth:`sweep`.
            flow: Whether it has how a fluid passes the gaps, and of a map where it leaks.

        Raises:
            SceneError: Where the scene cannot be solved for.
        """
        from ._contact import Contact

        slid = None if way is None else positive("way", way)
        state = {"pressure": positive("pressure", pressure), "speed": positive("speed", speed)}
        found = _native.contact(self._native, given(**state, way=slid, points=points, flow=flow))
        for warning in found.pop("warnings"):
            warnings.warn(warning, stacklevel=2)
        return Contact._of(found)

    def converge(
        self,
        pressure: float,
        speed: float,
        *,
        error: float = 0.05,
        seeds: int | None = None,
        method: Method | None = None,
        way: float | None = None,
        points: int | None = None,
        most_points: int | None = None,
        distance: float | None = None,
        progress: Progress = False,
    ) -> Convergence:
        """Whether friction and area in steady sliding depend on the scene's spacing, its length or on chance.

        The spacing is halved until neither changes by more than the error; then come twice the length, another split
        into profile and finer waves, and other seeds, each where the scene has such. On all cores.

        Args:
            pressure: Mean pressure, Pa.
            speed: Speed, m/s.
            error: The change of friction and of area that is small enough, as a share of them.
            seeds: Number of seeds, the scene's own included; None: 4 where it has any.
            method: As for :meth:`sweep`.
            way: As for :meth:`sweep`.
            points: Points of a period along x to begin with, with "steady".
            most_points: Most masses, or points of the surface, that are tried; None: 4096 masses, 2097152 points.
            distance: As for :meth:`sweep`.
            progress: True for a line on standard error, or a function of the fraction done.

        Raises:
            SceneError: Where the scene has nothing that could be varied, or cannot slide steadily.
        """
        from ._convergence import Convergence

        found = _native.converge(
            self._native,
            given(
                pressure=positive("pressure", pressure),
                speed=positive("speed", speed),
                error=positive("error", error),
                seeds=seeds,
                method=method,
                way=None if way is None else positive("way", way),
                points=points,
                most_points=most_points,
                distance=distance,
            ),
            shown(progress),
        )
        for warning in found.pop("warnings"):
            warnings.warn(warning, stacklevel=2)
        return Convergence._of(found)

    def surface(
        self,
        *,
        smooth: float | None = None,
        split: float | None = None,
        mirror: bool = False,
        taper: bool = False,
        wavelengths: tuple[float, float] | None = None,
    ) -> Surface:
        """The surface of the scene, analysed: heights, slopes, spectrum and Hurst exponent.

        Args:
            smooth: As for :func:`asperity.surface`.
            split: As for :func:`asperity.surface`.
            mirror: As for :func:`asperity.surface`.
            taper: As for :func:`asperity.surface`.
            wavelengths: As for :func:`asperity.surface`.
        """
        from ._surface import Surface

        treatment = {"smooth": smooth, "split": split, "mirror": mirror, "taper": taper, "wavelengths": wavelengths}
        return Surface(self.name, _native.surface_of(self._native, treatment))

    def calibrate(
        self,
        data: object,
        free: Mapping[str, tuple[float, float]],
        *,
        columns: Mapping[str, str | int] | None = None,
        method: Method | None = None,
        way: float | None = None,
        points: int | None = None,
        friction_error: float | None = None,
        distance: float | None = None,
    ) -> Calibration:
        """Fits numbers of the scene to measured friction.

        Args:
            data: The path of a table, a DataFrame, or a mapping of names to arrays of shape (n,): speed, pressure (or
                force on the whole layer) and friction; temperature, the way slid and the standard deviation of friction
                if there are any. Names have units, as in ``"speed [mm/s]"``; without one, SI.
            free: Keys of the scene to fit, each with its bounds (low, high); of positive bounds a decade apart the
                logarithm is fitted.
            columns: Which column is which, by its name or number, where the names do not say it: ``{"speed": "v2"}``.
            method: As for :meth:`sweep`.
            way: As for :meth:`sweep`, where the data has no column of it.
            points: As for :meth:`sweep`.
            friction_error: As for :meth:`sweep`.
            distance: As for :meth:`sweep`.

        Raises:
            SceneError, ValueError: Where the scene, the keys or the data are refused.
        """
        from ._calibration import Calibration

        bounds = [(key, float(low), float(high)) for key, (low, high) in mapping("free", free).items()]
        with table_file(data) as path:
            slid = None if way is None else positive("way", way)
            options = given(
                data=path,
                columns=given_columns(columns),
                free=bounds,
                method=method,
                way=slid,
                points=points,
                friction_error=friction_error,
                distance=distance,
            )
            found = _native.calibrate(self._native, options)
        for text in found["warnings"]:
            warnings.warn(text, stacklevel=2)
        settings = {one["key"]: to_toml(one["value"]) for one in found["parameters"]}
        return Calibration._of(found, self._changed(settings))

    def pack(
        self,
        path: str | PathLike[str],
        libraries: Sequence[str | PathLike[str]] | None = None,
        *,
        flat_names: bool = False,
        references: bool = True,
    ) -> Path:
        """Packs the scene as an FMI 2.0 co-simulation FMU, and returns its path.

        Args:
            path: The FMU to write.
            libraries: Shared libraries, as ``asperity pack --library`` takes them; None: those of this package.
            flat_names: Gives variables names without structure, such as ``transport_speed``.
            references: Runs the FMU's experiment and packs it with its result and the list of all files (FMI-LS-REF), by
                which :func:`asperity.fmi.verify` judges a master.

        Raises:
            SceneError: Where a key was set that stands in a file which the scene names: an FMU carries the text.
        """
        from ._errors import SceneError

        given = library_options(libraries)
        packed = self._in_own_folder(self.to_toml(), [], self._read_files())
        if packed != self:
            raise SceneError(
                "a key is set that stands in a file which the scene names: expected it in the text to pack"
            )
        warn_of_packed(packed._native.pack(Path(path), given, {"flat_names": flat_names, "references": references}))
        return Path(path)
