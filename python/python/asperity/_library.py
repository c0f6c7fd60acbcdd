"""What the wheel brings beside its native part: the program, and the shared library of the FMUs."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from os import PathLike
from pathlib import Path

_BINARIES = Path(__file__).parent / "binaries"
_WHEEL = "expected the one of a wheel built by build-fmu.sh --wheel"
_LIBRARIES = {".so", ".dll", ".dylib"}
_PLATFORM = {"win32": "win64", "darwin": "darwin64"}.get(sys.platform, "linux64")


def program() -> Path:
    """The command line program; it finds the shared library beside itself.

    Raises:
        FileNotFoundError: Where this package was built without it.
    """
    path = _BINARIES / _PLATFORM / ("asperity.exe" if sys.platform == "win32" else "asperity")
    if not path.is_file():
        raise FileNotFoundError(f"no program at {path}: {_WHEEL}")
    return path


def warn_of_packed(texts: list[str]) -> None:
    """Warns the caller's caller of start values that do not initialise, and of what an FMU does without."""
    for text in texts:
        warnings.warn(text, stacklevel=3)


def own_libraries() -> list[str]:
    """As :func:`options`, none where this package was built without any."""
    return [f"{path.parent.name}={path}" for path in sorted(_BINARIES.glob("*/*")) if path.suffix in _LIBRARIES]


def options(given: Sequence[str | PathLike[str]] | None = None) -> list[str]:
    """The shared libraries given, as ``asperity pack --library`` takes them; ``None``: those that this package brings.

    Raises:
        FileNotFoundError: Where none are given and this package was built without any.
    """
    if given is not None:
        return [str(library) for library in given]
    libraries = own_libraries()
    if not libraries:
        raise FileNotFoundError(f"no shared library below {_BINARIES}: {_WHEEL}")
    return libraries
