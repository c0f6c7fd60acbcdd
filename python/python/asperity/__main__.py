"""The command ``asperity``: the command line program, which the wheel brings."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

from ._library import program


def main() -> int:
    """Executes the command line and returns the exit status; where the system can, in place of this process."""
    try:
        command = [os.fspath(program()), *sys.argv[1:]]
    except FileNotFoundError as error:
        print(f"asperity: {error}", file=sys.stderr)
        return 1
    if sys.platform != "win32":
        os.execv(command[0], command)
    # The program does on Ctrl-C what is left to do, and this process waits for it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    return subprocess.call(command)


if __name__ == "__main__":
    sys.exit(main())
