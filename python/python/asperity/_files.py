"""Files for the time being: tables in memory, what a scene reads."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping
from os import PathLike
from pathlib import Path

from ._arguments import table_text
from ._errors import SceneError


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


def text_of(path: str | PathLike[str]) -> str:
    """The text of a scene's or a patch's file."""
    try:
        return Path(path).read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise SceneError(f"{path}: expected text in UTF-8, found other bytes at {error.start}", Path(path)) from None


def folder_of(files: Mapping[str, bytes]) -> tempfile.TemporaryDirectory[str]:
    """A folder with these files, by their names in it; it is removed with the object."""
    folder = tempfile.TemporaryDirectory(prefix="asperity-")
    for name, content in files.items():
        place = Path(folder.name) / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(content)
    return folder
