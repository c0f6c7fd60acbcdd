#!/usr/bin/env bash
# Sweeps the table of the rod, draws the seal's Stribeck curve, packs its FMU, strokes it in fmpy and couples it to a piston:
# all but the table and the pressures in FOLDER, by default target/rod-seal.
#
#   scenes/rod-seal/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/rod-seal}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

python=$("$root/tests/python/environment.sh" "$folder/venv" "$here/requirements.txt")
asperity=$("$root/scenes/program")
"$python" "$here/lip.py" > "$here/lip.csv"
"$asperity" sweep "$here/rod.toml" --gaps --speeds 1e-4..1/9 --pressures 20kPa..1.5MPa/12 \
    --temperatures 20°C,40°C,60°C,80°C -o "$here/rod.sweep.csv" --plot "$folder/sweep.svg"
"$asperity" sweep --seal "$here/seal.toml" --speeds 1e-4..0.5/16 --sealed 0MPa,5MPa,10MPa \
    -o "$folder/stribeck.csv" --plot "$folder/stribeck.svg" --force
"$root/build-fmu.sh" --seal "$here/seal.toml" -o "$folder/seal.fmu"
cd "$folder"
"$python" -B "$here/strokes.py" seal.fmu .
"$asperity" plot loop-1mm.csv loop-10mm.csv loop-100mm.csv --x u --y F_x --y "leak in mm³" \
    --labels "1 mm/s,10 mm/s,100 mm/s" --title "Two strokes of the rod, 5 MPa sealed" -o loops.svg
"$asperity" simulate --seal "$here/seal.toml" --motion motion-10mm.csv -o film.csv --plot film.svg
"$python" -B "$here/piston.py" seal.fmu piston.csv
"$asperity" plot piston.csv --y u --y F_x --title "A piston that creeps after a rest" -o piston.svg
echo "$folder/stribeck.svg $folder/loops.svg $folder/film.svg $folder/piston.svg"
