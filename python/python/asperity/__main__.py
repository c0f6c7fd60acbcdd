"""The command ``asperity``: the command line program, in this process."""

from __future__ import annotations

import os
import signal
import sys

from . import _native
from ._library import shared_libraries


def main() -> int:
    """Executes the command line and returns the exit status."""
    # The program does on Ctrl-C what is left to do, which Python's own handler would put off until it returns.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    libraries = shared_libraries()
    host = {"win32": "win64", "darwin": "darwin64"}.get(sys.platform, "linux64")
    library = next((path for path in libraries if path.parent.name == host), None)
    return _native.main(["asperity", *sys.argv[1:]], None if library is None else os.fspath(library))


if __name__ == "__main__":
    sys.exit(main())
