"""Runs an FMU in the C host beside this file along a motion given as a CSV file and writes what it answers.

    run.py MODEL.fmu MOTION.csv -o RESULT.csv [--platform linux64|win64] [--instances N] [--points N] [--under COMMAND]

MOTION.csv has the columns time, u and w, as for ../python/drive.py. The host is compiled with the headers that fmpy
carries. For win64 that takes x86_64-w64-mingw32-gcc, and wine to run it. --under runs the host under a command, such
as "valgrind --leak-check=full". What the host and that command say goes to stderr.
"""

import argparse
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

import fmpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "python"))
from drive import read_motion

# Commands and the packages of Debian that have them.
PACKAGES = {
    "gcc": "gcc",
    "x86_64-w64-mingw32-gcc": "gcc-mingw-w64-x86-64-win32",
    "wine": "wine and wine64",
    "valgrind": "valgrind",
}
FLAGS = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-g"]


class Platform:
    """How a host is built and run: the compiler, the ending of libraries, the command in front, the drive of paths."""

    def __init__(self, compiler, extension, libraries=(), before=(), drive=""):
        self.compiler, self.extension, self.libraries = compiler, extension, list(libraries)
        self.before, self.drive = list(before), drive

    def compile(self, folder):
        """The host as a program."""
        source = pathlib.Path(__file__).with_name("host.c")
        program = folder / "host.exe"
        headers = pathlib.Path(fmpy.__file__).with_name("c-code")
        command = [found(self.compiler), *FLAGS, f"-I{headers}", str(source), "-o", str(program), *self.libraries]
        subprocess.run(command, check=True)
        return program

    def uri(self, path):
        """A folder as the standard wants it."""
        return "file://" + urllib.parse.quote(("/" if self.drive else "") + self.drive + str(path), safe="/:")


PLATFORMS = {
    "linux64": Platform("gcc", "so", ["-ldl"]),
    "win64": Platform("x86_64-w64-mingw32-gcc", "dll", before=["wine"], drive="Z:"),
}


def found(command):
    """The command's path, or the end with the package to install."""
    path = shutil.which(command)
    if path is None:
        raise SystemExit(f"run.py: {command} is needed; Debian has it in {PACKAGES.get(command, command)}")
    return path


def reference(variable):
    """A variable as the host wants it."""
    return ("r" if variable.type == "Real" else "i") + str(variable.valueReference)


def run(arguments, folder):
    """The names of the outputs and the host's line for every point of the motion."""
    platform = PLATFORMS[arguments.platform]
    description = fmpy.read_model_description(arguments.fmu)
    fmpy.extract(arguments.fmu, unzipdir=folder / "fmu")
    outputs = [v for v in description.modelVariables if v.causality in ("output", "local")]
    name = f"{description.coSimulation.modelIdentifier}.{platform.extension}"
    # Relative to the folder: what is not ASCII in an argument, Windows shows a C program in a code page of its own.
    library = f"./fmu/binaries/{arguments.platform}/{name}"
    before = [*platform.before, *shlex.split(arguments.under)]
    command = [*map(found, before[:1]), *before[1:], f"./{platform.compile(folder).name}"]
    command += [library, description.guid, platform.uri(folder / "fmu" / "resources")]
    command += [str(arguments.instances), str(arguments.points), *map(reference, outputs)]
    motion = "".join(f"{time!r} {u!r} {w!r}\n" for time, u, w in read_motion(arguments.motion))
    environment = {"WINEDEBUG": "-all", **os.environ}
    result = subprocess.run(command, cwd=folder, env=environment, input=motion, stdout=subprocess.PIPE, text=True)
    if result.returncode != 0:
        raise SystemExit(f"run.py: {shlex.join(command[:2])} ... ended with {result.returncode}")
    return [variable.name for variable in outputs], result.stdout.splitlines()


def write(path, motion, names, lines):
    """Writes a result file like the program's."""
    with open(path, "w") as file:
        file.write(",".join(["time", "u", "w", *names]) + "\n")
        for point, line in zip(motion, lines):
            file.write(",".join([*map(repr, point), line]) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fmu", metavar="MODEL.fmu")
    parser.add_argument("motion", metavar="MOTION.csv")
    parser.add_argument("-o", "--output", required=True, metavar="RESULT.csv")
    parser.add_argument("--platform", choices=PLATFORMS, default="linux64")
    parser.add_argument("--instances", type=int, default=1, help="made and run one after another; the first writes")
    parser.add_argument("--points", type=int, default=0, help="of the motion; 0: all")
    parser.add_argument("--under", default="", metavar="COMMAND")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="host ä ") as folder:
        names, lines = run(arguments, pathlib.Path(folder).resolve())
    write(arguments.output, read_motion(arguments.motion), names, lines)


if __name__ == "__main__":
    main()
