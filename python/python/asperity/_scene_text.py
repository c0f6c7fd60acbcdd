"""The text of a scene: its keys, its copies, its files, what it says."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from . import _native
from ._arguments import Floats, described, mapping, numbers, to_toml
from ._files import folder_of, text_of

if TYPE_CHECKING:
    from typing_extensions import Self

_SCENE = "scene.toml"


class SceneText:
    """The text of a scene file with keys set in it, read and checked."""

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
    def from_toml(cls, path: str | PathLike[str]) -> Self:
        """The scene in a file.

        Args:
            path: The scene file.

        Raises:
            SceneError: Where it is refused.
            OSError: Where it cannot be read.
        """
        return cls(text_of(path), path)

    @classmethod
    def from_dict(cls, keys: Mapping[str, Any], folder: str | PathLike[str] = ".") -> Self:
        """The scene of these keys, tables as dictionaries: numbers, texts, flags, lists and arrays of numpy.

        Args:
            keys: The keys, as a scene file has them.
            folder: Where files that they name are looked for.
        """
        text = "".join(f"{key} = {to_toml(value)}\n" for key, value in mapping("keys", keys).items())
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

    def with_keys(self, keys: Mapping[str, object]) -> Self:
        """A copy with these keys set."""
        return self._changed({key: to_toml(value) for key, value in keys.items()})

    # Copies and files

    def _changed(self, settings: Mapping[str, str], files: Mapping[str, bytes] | None = None) -> Self:
        """A copy with keys set, in a folder of its own where it needs files."""
        native = self._native
        added = [*native.settings, *settings.items()]
        if files is None:
            scene = type(self)(native.source, native.file, added)
            scene._folder = self._folder
            return scene
        return self._in_own_folder(native.source, added, {**self._read_files(), **files})

    @classmethod
    def _in_own_folder(cls, text: str, settings: Sequence[tuple[str, str]], files: Mapping[str, bytes]) -> Self:
        """A scene with its files in a folder that is removed with it."""
        folder = folder_of(files)
        path = Path(folder.name) / _SCENE
        path.write_text(text, encoding="utf-8")
        scene = cls(text, path, settings)
        scene._folder = folder
        return scene

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

    def describe(self) -> str:
        """What the scene is, in the lines of ``asperity describe``.

        Raises:
            SceneError: Where no run can start with it.
        """
        return described(self._native.describe())

    def to_toml(self) -> str:
        """The text of the scene with its keys set."""
        return self._native.text()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SceneText) and self._native.is_same(other._native)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<asperity.Scene {self.name!r} of {self.file}>"

    def __copy__(self) -> Self:
        return self._changed({})

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        return self._changed({})

    def __reduce__(self) -> tuple[Any, tuple[type[SceneText], str, list[tuple[str, str]], dict[str, bytes], Path]]:
        native = self._native
        return _unpickled, (type(self), native.source, native.settings, self._read_files(), native.file)


def _unpickled(
    cls: type[SceneText], text: str, settings: list[tuple[str, str]], files: dict[str, bytes], file: Path
) -> SceneText:
    return cls._in_own_folder(text, settings, files) if files else cls(text, file, settings)
