"""Scenes: what is simulated."""

from __future__ import annotations

import shutil
import tempfile
import warnings
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arguments import Floats, Progress, axis, columns_of, numbers, positive, shown, table_text, to_toml
from ._library import options as library_options
from ._library import warn_of_start

if TYPE_CHECKING:
    from ._calibration import Calibration
    from ._contact import Contact
    from ._fit import Fit
    from ._result import Result
    from ._table import Table

_SCENE = "scene.toml"
Method = Literal["steady", "layer"]


class Scene:
    """A rubber layer on a rough, rigid surface, its friction and its motion.

    A scene is the text of a scene file (TOML, in SI units; all keys are in docs/reference.md) with keys set in it.
    ``scene["friction.coulomb"] = 0.4`` sets one, ``scene["friction"]`` reads one. The methods ``with_...`` return a
    changed copy. Scenes compare by what they are, and can be copied and pickled with the files that they read.

    Raises:
        SceneError: Where a key or a value is refused: with file, line and key.
    """

    def __init__(self, text: str, file: str | PathLike[str] = _SCENE, settings: Sequence[tuple[str, str]] = ()) -> None:
        """A scene from the text of a file.

        Args:
            text: The text, TOML.
            file: Where it stands: files that it names are looked for beside it.
            settings: Keys and values, as TOML, that take the place of those in the text.
        """
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._native = _native.Scene(text, Path(file), list(settings))

    @classmethod
    def from_toml(cls, path: str | PathLike[str]) -> Scene:
        """The scene in a file.

        Args:
            path: The scene file.

        Raises:
            SceneError: Where it is refused.
            OSError: Where it cannot be read.
        """
        return cls(Path(path).read_text(encoding="utf-8"), path)

    @classmethod
    def from_dict(cls, keys: Mapping[str, Any], folder: str | PathLike[str] = ".") -> Scene:
        """The scene of these keys, tables as dictionaries: numbers, texts, flags, lists and arrays of numpy.

        Args:
            keys: The keys, as a scene file has them.
            folder: Where files that they name are looked for.
        """
        text = "".join(f"{key} = {to_toml(value)}\n" for key, value in keys.items())
        return cls(text, Path(folder) / _SCENE)

    # Keys

    def __getitem__(self, key: str) -> Any:
        """What stands at a key, as in ``"layer.vertical.maxwell[1].stiffness"``; a table as a dictionary.

        Raises:
            KeyError: Where the text of the scene has no such key.
        """
        return self._native.get(key)

    def __setitem__(self, key: str, value: object) -> None:
        """Sets a key, or adds it.

        Raises:
            SceneError: Where the key or the value is refused; the scene is then as it was.
        """
        native = self._native
        self._native = _native.Scene(native.source, native.file, [*native.settings, (key, to_toml(value))])

    def __contains__(self, key: str) -> bool:
        try:
            self._native.get(key)
        except KeyError:
            return False
        return True

    def update(self, keys: Mapping[str, object]) -> None:
        """Sets several keys at once, so that they only have to go together in the end."""
        native = self._native
        added = [(key, to_toml(value)) for key, value in keys.items()]
        self._native = _native.Scene(native.source, native.file, [*native.settings, *added])

    def with_keys(self, keys: Mapping[str, object]) -> Scene:
        """A copy with these keys set."""
        return self._changed({key: to_toml(value) for key, value in keys.items()})

    # What comes in as arrays

    def with_profile(self, x: ArrayLike, z: ArrayLike, periodic: bool = False, **keys: object) -> Scene:
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
    ) -> Scene:
        """A copy that slides on a map of heights.

        Args:
            heights: Heights, m, shape (ny, nx): lines along x, the direction of sliding, one after the other along y.
            spacing: Distance of the points, m; or those along x and along y.
            periodic: Whether it is repeated without end along both axes; the point behind the last is then the first.
            keys: Other keys of the surface, such as ``line``, or ``fine``, which is kept where it is not given.
        """
        array = np.asarray(heights, dtype=np.float64)
        if array.ndim != 2:
            raise ValueError(f"heights: expected an array of shape (ny, nx), found {array.shape}")
        dx, dy = spacing if isinstance(spacing, tuple) else (spacing, spacing)
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
    ) -> Scene:
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

    def with_prony(self, moduli: ArrayLike, times: ArrayLike, equilibrium: float | None = None) -> Scene:
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

    def with_fit(self, fit: Fit) -> Scene:
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

    def with_motion(self, motion: object) -> Scene:
        """A copy that moves along a table, straight from row to row.

        Args:
            motion: A DataFrame, or a mapping of names to arrays of shape (n,): ``time`` (s), ``u`` and ``w`` (m); of a
                carrier that is a body ``load``, ``pressure`` and ``pull``; ``temperature`` (K) where it is an input.
                Time, u and w count from the first row, with a warning where that is not u = w = 0: a run of a scene
                starts there. :class:`Simulation` starts anywhere.
        """
        offset = {name: float(np.asarray(column)[0]) for name, column in columns_of(motion).items() if name in ("u", "w")}
        if any(offset.values()):
            said = ", ".join(f"{name} = {value:g} m" for name, value in offset.items())
            warnings.warn(f"u and w count from the first row of the motion, {said}", stacklevel=2)
        settings = {"excitation": to_toml([{"file": "with_motion.csv"}])}
        return self._changed(settings, {"with_motion.csv": table_text(motion).encode()})

    def _fine(self) -> dict[str, Any]:
        return {"fine": self["surface.fine"]} if "surface.fine" in self else {}

    def _changed(self, settings: Mapping[str, str], files: Mapping[str, bytes] | None = None) -> Scene:
        """A copy with keys set, in a folder of its own where it needs files."""
        native = self._native
        added = [*native.settings, *settings.items()]
        if files is None:
            scene = Scene(native.source, native.file, added)
            scene._folder = self._folder
            return scene
        return _in_own_folder(native.source, added, {**self._read_files(), **files})

    def save(self, path: str | PathLike[str], overwrite: bool = False) -> Path:
        """Writes the scene file and, beside it, the files that it reads; returns its path.

        Args:
            path: The scene file to write.
            overwrite: Whether other files of these names are replaced.

        Raises:
            FileExistsError: Where another file of such a name is there; nothing is then written.
        """
        file = Path(path)
        contents = {file.parent / name: content for name, content in self._read_files().items()}
        contents[file] = self.to_toml().encode()
        others = [place for place, content in contents.items() if place.exists() and place.read_bytes() != content]
        if others and not overwrite:
            raise FileExistsError(f"{others[0]}: expected no other file of this name, or overwrite=True")
        for place, content in contents.items():
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
        return file

    def _read_files(self) -> dict[str, bytes]:
        """The files that the scene reads, by the names it has for them."""
        folder = self._native.file.parent
        return {str(file): (folder / file).read_bytes() for file in self._native.files()}

    # What it is

    @property
    def name(self) -> str:
        """The scene's name."""
        return self._native.name

    @property
    def file(self) -> Path:
        """Where its text stands, or would: files that it names are beside it."""
        return self._native.file

    @property
    def duration(self) -> float:
        """How long its excitation takes, s, where no force ends a phase."""
        return self._native.duration

    @property
    def warnings(self) -> list[str]:
        """What is probably not meant though the scene is valid."""
        return self._native.warnings

    @property
    def notes(self) -> list[str]:
        """How the tables were read that it names."""
        return self._native.notes

    @property
    def profile(self) -> tuple[Floats, Floats]:
        """x and z of the data points of the profile, m, each of shape (n,)."""
        return self._native.profile()

    @property
    def map(self) -> tuple[Floats, tuple[float, float]] | None:
        """The map of which the profile is a line: heights, m, shape (ny, nx), and the distances of points, m."""
        found = self._native.map()
        if found is None:
            return None
        heights, nx, (dx, dy) = found
        return heights.reshape(-1, nx), (dx, dy)

    def complex_modulus(self, omega: ArrayLike) -> np.ndarray[Any, np.dtype[np.complex128]]:
        """E' + iE'' of the compound at its temperature, Pa, shape (n,).

        Args:
            omega: Angular frequencies, rad/s, shape (n,).

        Raises:
            KeyError: Where the scene is in the direct form, without a material.
        """
        return self._native.modulus(numbers("omega", omega)).view(np.complex128)

    def to_toml(self) -> str:
        """The text of the scene with its keys set."""
        return self._native.text()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self._native.is_same(other._native)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<asperity.Scene {self.name!r} of {self.file}>"

    def __copy__(self) -> Scene:
        return self._changed({})

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self._changed({})

    def __reduce__(self) -> tuple[Any, tuple[str, list[tuple[str, str]], dict[str, bytes], Path]]:
        native = self._native
        return _unpickled, (native.source, native.settings, self._read_files(), native.file)

    # What it does

    def simulate(
        self,
        points: int = 50,
        motion: object = None,
        *,
        times: ArrayLike = (),
        elements: bool = False,
        progress: Progress = False,
    ) -> Result:
        """Runs the scene along its excitation, or along a motion.

        The interpreter's lock is released, and Ctrl-C ends the run.

        Args:
            points: Number of rows for each phase; a motion has a row for each of its own.
            motion: What :meth:`with_motion` takes; None: the scene's excitation.
            times: Times of rows besides these, s, within the run.
            elements: Whether to keep position, forces and mode of every mass.
            progress: True for a line on standard error, or a function of the fraction done.

        Raises:
            SimulationError: Where the run cannot go on.
        """
        from ._result import Result

        scene = self if motion is None else self.with_motion(motion)
        if points < 1:
            raise ValueError(f"points = {points}: expected 1 or more")
        if scene.duration <= 0.0:
            raise ValueError(f"{self.name}: the scene has no excitation to run along; expected motion=, or [[excitation]]")
        also_at = numbers("times", times)
        if not np.all((also_at >= 0.0) & (also_at <= scene.duration)):
            raise ValueError(f"times: expected numbers from 0 to {scene.duration:g} s, the end of the run")
        found = _native.simulate(scene._native, points, also_at.tolist(), elements, shown(progress))
        columns, units, of_masses, mass_units, said = found
        for text in said:
            warnings.warn(text, stacklevel=2)
        rows = len(columns["time"])
        fields = {name: values.reshape(rows, -1) for name, values in of_masses.items()}
        return Result(scene.name, columns, {**mass_units, **units}, fields, scene.profile)

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
        error: float | None = None,
        distance: float | None = None,
        progress: Progress = False,
    ) -> Table:
        """Friction in steady sliding over speed, load and temperature, on all cores.

        Ctrl-C is raised at once. A point that is being solved for as it comes ends in the background.

        Args:
            speeds: Speeds, m/s.
            pressures: Mean pressures, Pa; of a scene in the material form.
            temperatures: Temperatures, K; None: the scene's own.
            forces: Mean normal forces of the whole layer, N, in place of pressures.
            method: "steady" solves for steady sliding, "layer" lets the layer slide until it is steady; None: "steady"
                where the scene can be solved for.
            way: The way slid so far, m: the scene's temperature is that of the rubber before it slid; None: of the surface
                around its contacts. With "steady", of a scene with material.heat.
            points: Points of a period along x, with "steady".
            error: Admissible standard error of friction over it, with "layer"; None: 5e-3.
            distance: Longest distance that a layer slides, m; None: 100 blocks.
            progress: True for a line on standard error, or a function of the fraction done.

        Raises:
            SceneError: Where the scene does not go with what is asked for.
        """
        from ._table import Table

        text, said = _native.sweep(
            self._native,
            axis("speeds", speeds),
            None if pressures is None else axis("pressures", pressures),
            None if forces is None else axis("forces", forces),
            None if temperatures is None else axis("temperatures", temperatures),
            method,
            None if way is None else positive("way", way),
            points,
            error,
            distance,
            shown(progress),
        )
        for warning in said:
            warnings.warn(warning, stacklevel=2)
        table = Table(text)
        failed = [status for status in table.status.ravel() if status not in ("steady", "full contact")]
        if failed:
            text = f"{len(failed)} of {table.status.size} points are not steady or failed, the first: {failed[0]}"
            warnings.warn(f"{text}; Table.status says which", stacklevel=2)
        return table

    def contact(
        self, pressure: float, speed: float, points: int | None = None, *, way: float | None = None
    ) -> Contact:
        """Where the rubber touches in steady sliding, and how hard.

        The scene has to be in the material form with a foundation "half_space" or "layer" and a periodic surface.

        Args:
            pressure: Mean pressure, Pa.
            speed: Speed, m/s.
            points: Points of a period along x; None: the surface's own, or of a profile 8 to its shortest wave where
                they are uneven or fewer.
            way: As for :meth:`sweep`.

        Raises:
            SceneError: Where the scene cannot be solved for.
        """
        from ._contact import Contact

        slid = None if way is None else positive("way", way)
        at = (positive("pressure", pressure), positive("speed", speed))
        found = _native.contact(self._native, *at, slid, points)
        for warning in found.pop("warnings"):
            warnings.warn(warning, stacklevel=2)
        return Contact._of(found)

    def calibrate(
        self,
        data: object,
        free: Mapping[str, tuple[float, float]],
        *,
        method: Method | None = None,
        way: float | None = None,
        points: int | None = None,
        error: float | None = None,
        distance: float | None = None,
    ) -> Calibration:
        """Fits numbers of the scene to measured friction.

        Args:
            data: The path of a table, a DataFrame, or a mapping of names to arrays of shape (n,): speed, pressure (or
                force on the whole layer) and friction; temperature, the way slid and the standard deviation of friction
                if there are any. Names have units, as in ``"speed [mm/s]"``; without one, SI.
            free: Keys of the scene to fit, each with its bounds (low, high); of positive bounds a decade apart the
                logarithm is fitted.
            method: As for :meth:`sweep`.
            way: As for :meth:`sweep`, where the data has no column of it.
            points: As for :meth:`sweep`.
            error: As for :meth:`sweep`.
            distance: As for :meth:`sweep`.

        Raises:
            SceneError, ValueError: Where the scene, the keys or the data are refused.
        """
        from ._calibration import Calibration

        bounds = [(key, float(low), float(high)) for key, (low, high) in free.items()]
        with table_file(data) as path:
            slid = None if way is None else positive("way", way)
            found = _native.calibrate(self._native, path, bounds, method, slid, points, error, distance)
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
    ) -> Path:
        """Packs the scene as an FMI 2.0 co-simulation FMU, and returns its path.

        Args:
            path: The FMU to write.
            libraries: Shared libraries, as ``asperity pack --library`` takes them; None: those of this package.
            flat_names: Gives variables names without structure, such as ``transport_speed``.

        Raises:
            SceneError: Where a key was set that stands in a file which the scene names: an FMU carries the text.
        """
        from ._errors import SceneError

        given = library_options() if libraries is None else [str(library) for library in libraries]
        packed = _in_own_folder(self.to_toml(), [], self._read_files())
        if packed != self:
            raise SceneError(
                "a key is set that stands in a file which the scene names: expected it in the text to pack"
            )
        warn_of_start(packed._native.pack(Path(path), given, flat_names))
        return Path(path)


class table_file:
    """A path as it is; a table in memory in a file for the time being."""

    def __init__(self, data: object) -> None:
        self._data = data
        self._folder: str | None = None

    def __enter__(self) -> Path:
        if isinstance(self._data, str | PathLike):
            return Path(self._data)
        text = table_text(self._data)
        self._folder = tempfile.mkdtemp(prefix="asperity-")
        path = Path(self._folder) / "data.csv"
        path.write_text(text, encoding="utf-8")
        return path

    def __exit__(self, *_: object) -> None:
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)


def folder_of(files: Mapping[str, bytes]) -> tempfile.TemporaryDirectory[str]:
    """A folder with these files, by their names in it; it is removed with the object."""
    folder = tempfile.TemporaryDirectory(prefix="asperity-")
    for name, content in files.items():
        place = Path(folder.name) / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(content)
    return folder


def _in_own_folder(text: str, settings: Sequence[tuple[str, str]], files: Mapping[str, bytes]) -> Scene:
    """A scene with its files in a folder that is removed with it."""
    folder = folder_of(files)
    path = Path(folder.name) / _SCENE
    path.write_text(text, encoding="utf-8")
    scene = Scene(text, path, settings)
    scene._folder = folder
    return scene


def _unpickled(text: str, settings: list[tuple[str, str]], files: dict[str, bytes], file: Path) -> Scene:
    return _in_own_folder(text, settings, files) if files else Scene(text, file, settings)
