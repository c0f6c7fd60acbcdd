"""Writes the licences of all packages that are linked into what the wheel brings, with their texts.

    licences.py CARGO.toml OUT.txt

Packages come from cargo's own resolution: normal dependencies of the native part, of the program and of the FMUs' shared
library, without procedural macros, which are no part of what is linked. A text that several packages have stands there once.
"""

import json
import subprocess
import sys
from pathlib import Path

ROOTS = ("asperity-python", "asperity-cli", "asperity-fmu")
NAMES = ("LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE", "COPYRIGHT")
LINE = "-" * 78


def metadata(manifest):
    """What cargo resolves."""
    command = ["cargo", "metadata", "--locked", "--format-version", "1", "--manifest-path", manifest]
    return json.loads(subprocess.run(command, check=True, capture_output=True).stdout)


def linked(found):
    """The packages that are linked, without this repository's own, by name and version."""
    packages = {package["id"]: package for package in found["packages"]}
    nodes = {node["id"]: node for node in found["resolve"]["nodes"]}

    def is_macro(package):
        return any("proc-macro" in target["kind"] for target in package["targets"])

    left, seen = [one["id"] for one in packages.values() if one["name"] in ROOTS], set()
    while left:
        package = left.pop()
        if package in seen or is_macro(packages[package]):
            continue
        seen.add(package)
        for dependency in nodes[package]["deps"]:
            if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
                left.append(dependency["pkg"])
    others = (packages[package] for package in seen if packages[package]["source"] is not None)
    return sorted(others, key=lambda package: (package["name"], package["version"]))


def texts(package):
    """The files of a package that hold its licences."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name.upper().startswith(NAMES))
    return [path.read_text(encoding="utf-8", errors="replace").strip() for path in files]


def main():
    """Writes the file."""
    manifest, output = sys.argv[1:]
    holders, lines = {}, ["Packages that are linked into what this wheel brings, and their licences.", ""]
    # The figures' font is no package.
    font = Path(manifest).parent / "crates/cli/src/picture/font/LICENSE.txt"
    holders[font.read_text(encoding="utf-8").strip()] = ["DejaVu Sans"]
    lines.append("DejaVu Sans, the font of the program's figures")
    for package in linked(metadata(manifest)):
        name = f"{package['name']} {package['version']}"
        lines.append(f"{name}: {package['license'] or 'see its text'}, {package['repository'] or ''}")
        for text in texts(package):
            holders.setdefault(text, []).append(name)
    for text, names in holders.items():
        lines += ["", LINE, ", ".join(names), LINE, "", text]
    Path(output).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
