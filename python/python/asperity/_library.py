"""The shared library of the FMUs, which the wheel brings."""

from __future__ import annotations

from pathlib import Path

_BINARIES = Path(__file__).parent / "binaries"


def shared_libraries() -> list[Path]:
    """The shared libraries that this package brings, one a platform."""
    return sorted(path for path in _BINARIES.glob("*/*") if path.is_file())


def options() -> list[str]:
    """These libraries as ``asperity pack --library`` takes them.

    Raises:
        FileNotFoundError: Where this package was built without any.
    """
    found = [f"{path.parent.name}={path}" for path in shared_libraries()]
    if not found:
        raise FileNotFoundError(
            f"no shared library below {_BINARIES}: expected the one of a wheel built by build-fmu.sh --wheel"
        )
    return found
