#!/usr/bin/env bash
# Sweeps the pads' table where it is not there, builds the FMU, grips the box with it in MuJoCo and draws it: all but the
# table in FOLDER, by default target/grip-mujoco.
#
#   scenes/grip-mujoco/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/grip-mujoco}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

python=$("$root/tests/python/environment.sh" "$folder/venv" "$here/../patch-mujoco/requirements.txt")
asperity=$("$root/scenes/program")
"$asperity" sweep "$here/face.toml" --speeds 1e-6..1e-1/11 --pressures 5e3,2e4,5e4,1e5,2e5,5e5 --points 1024 \
    -o "$here/pad.table.csv" --plot "$folder/sweep.svg"
"$root/build-fmu.sh" --patch "$here/pad.toml" -o "$folder/pad.fmu"
"$python" -B "$here/grip.py" "$folder"
echo "$folder/grip.svg"
