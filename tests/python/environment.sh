#!/usr/bin/env bash
# Prints the Python to use, after making it a place with the packages of requirements.txt, or of another list: a path, or
# a name beside it. FOLDER is made if it is not there. For build-fmu.sh and the tests alike; several at once wait for one
# another.
#
#   tests/python/environment.sh FOLDER [LIST.txt]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
requirements=${2:-requirements.txt}
case $requirements in */*) ;; *) requirements=$here/$requirements ;; esac
mkdir -p "$1"
folder=$(cd "$1" && pwd)
python=$folder/bin/python
stamp=$folder/requirements.txt

# A virtual environment where Python can make one; else (Debian without python3-venv) a folder of packages and a
# Python that looks there first.
make_environment() {
    rm -rf "$folder"/{bin,lib,lib64,include,share,packages,pyvenv.cfg}
    if python3 -m venv "$folder" || python3 -m virtualenv -q "$folder"; then
        "$python" -m pip install --quiet --disable-pip-version-check -r "$requirements"
        return
    fi
    echo "no virtual environment can be made (python3-venv is missing?); installing into $folder/packages" >&2
    rm -rf "$folder"/{bin,lib,lib64,include,share,pyvenv.cfg}
    python3 -m pip install --quiet --disable-pip-version-check --target "$folder/packages" -r "$requirements"
    mkdir -p "$folder/bin"
    printf '#!/bin/sh\nPYTHONPATH=%q exec python3 "$@"\n' "$folder/packages" > "$python"
    chmod +x "$python"
}

command -v python3 > /dev/null || { echo "Python 3 is needed: python3 is not on the PATH" >&2; exit 1; }
exec 9> "$folder/lock"
if command -v flock > /dev/null; then flock 9; fi
if ! cmp -s "$requirements" "$stamp" || [ ! -x "$python" ]; then
    rm -f "$stamp"
    make_environment >&2
    cp "$requirements" "$stamp"
fi
echo "$python"
