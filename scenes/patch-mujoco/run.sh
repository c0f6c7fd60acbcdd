#!/usr/bin/env bash
# Sweeps the tread's table where it is not there, builds the FMU, brakes the wheel on it in MuJoCo and draws it: all but
# the table in FOLDER, by default target/patch-mujoco.
#
#   scenes/patch-mujoco/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/patch-mujoco}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

python=$("$root/tests/python/environment.sh" "$folder/venv" "$here/requirements.txt")
asperity=$("$root/scenes/program")
"$asperity" sweep "$here/road.toml" --speeds 1e-3..10/13 --pressures 5e3,2e4,5e4,1e5,2e5,4e5 \
    --temperatures 293.15,308.15,323.15,343.15,363.15,393.15 --points 4096 -o "$here/tread.table.csv" \
    --plot "$folder/sweep.svg"
"$root/build-fmu.sh" --patch "$here/tread.toml" -o "$folder/tread.fmu"
"$python" -B "$here/braking.py" "$folder"
echo "$folder/braking.svg"
