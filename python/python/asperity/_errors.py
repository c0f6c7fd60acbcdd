"""Exceptions of asperity."""

from __future__ import annotations

from pathlib import Path


class SceneError(ValueError):
    """A scene, a patch or what is asked of it is refused.

    The message says what was expected, what was found, and where.

    Attributes:
        file: The file with the error; None where it is in none.
        line: Its line, from 1; None where the whole file or no file is meant.
        key: The path of the key, as in ``"friction.coulomb"``; None where no key is meant.
    """

    def __init__(self, message: str, file: Path | None = None, line: int | None = None, key: str | None = None) -> None:
        super().__init__(message)
        self.file = None if file is None else Path(file)
        self.line = line
        self.key = key

    def __reduce__(self) -> tuple[type[SceneError], tuple[str, Path | None, int | None, str | None]]:
        return type(self), (str(self), self.file, self.line, self.key)


class SimulationError(RuntimeError):
    """A run could not go on, as where its steps were used up."""
