#!/usr/bin/env bash
# Builds the FMU of this example and sweeps it over speed and pressure: all in FOLDER, by default target/sweep. Options are
# those of sweep.py, such as --scheduler tcp://head:8786.
#
#   scenes/sweep/run.sh [FOLDER] [OPTION ...]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=$root/target/sweep
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
    folder=$1
    shift
fi
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

python=$("$root/tests/python/environment.sh" "$folder/venv" "$here/requirements.txt")
"$root/build-fmu.sh" "$here/block.toml" -o "$folder/block.fmu"
"$python" "$here/sweep.py" "$folder/block.fmu" -o "$folder/table.csv" --plot "$folder/table.svg" \
    --speeds 0.01..10/10 --pressures 1e5,2e5 "$@"
