#!/usr/bin/env bash
# Runs the commands of the guide that make its pictures: all in FOLDER, by default target/guide. With --sled the FMUs of
# layer and element too, in fmpy.
#
#   docs/guide/run.sh [FOLDER [--sled]]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/guide}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
cp "$here"/*.{csv,txt,toml} "$folder"
folder=$(cd "$folder" && pwd)
cd "$folder"
"$asperity" fit dma.csv -o compound.csv --wlf 7.52,119.75,293.15
"$asperity" surface road.txt --missing fill --tilt remove --smooth 2.5e-4 -o road.svg --write road.csv
"$asperity" surface road.csv --mirror --write road-periodic.csv
if [ "${2:-}" = --sled ]; then
    "$root/build-fmu.sh" "$folder/block.toml" -o "$folder/block.fmu"
    python=$("$root/tests/python/environment.sh" "$folder/venv")
    "$asperity" sweep block.toml --speeds 1e-4..10/11 --pressures 1e5,2e5,4e5 -o block.sweep.csv
    "$root/build-fmu.sh" --table block.sweep.csv -o element.fmu
    "$python" "$here/sled.py" block.fmu 8.2e-5 -o sled-layer.csv
    "$python" "$here/sled.py" element.fmu 6.5e-5 -o sled-element.csv
    "$root/build-fmu.sh" stop.toml -o stop.fmu
    "$python" "$here/stop.py" stop.fmu
    "$asperity" plot stop-values.csv stop-rates.csv stop-hold.csv --y F_x --labels "values alone,rates,hold" -o stop.svg
    "$root/build-fmu.sh" --patch "$root/scenes/patch-mujoco/tread.toml" -o tread.fmu
    "$python" "$here/slope.py" tread.fmu
    "$asperity" plot slope-values.csv slope-hold.csv slope-rates.csv slope-damped.csv --y F_x \
        --labels "values alone,hold,rates,damped" -o slope.svg
    "$asperity" plot sled-layer.csv sled-element.csv --y F_x --labels layer,element -o sled.svg
    exit
fi
"$asperity" simulate block.toml -o block.csv --rows 200 --plot block.svg --contact 4e-3=contact.svg
"$asperity" sweep block.toml --speeds 1e-4..10/11 --pressures 1e5,2e5,4e5 -o block.sweep.csv --plot sweep.svg
"$asperity" converge "$root/tests/reference/half-plane/rough.toml" --pressure 1e5 --speed 0.1 --points 128 \
    -o rough.converge.csv --plot converge.svg
"$asperity" calibrate measured.toml --data measured.csv --set friction.rate_shear.strength=3e6 \
    --set friction.rate_shear.reference_speed=5e-2 --set friction.rate_shear.sharpness=0.2 \
    --set surface.fine.shortest=1e-5 --free friction.rate_shear.strength=1e6..2e7 \
    --free friction.rate_shear.reference_speed=1e-4..1 --free friction.rate_shear.sharpness=0.02..0.5 \
    --free surface.fine.shortest=1e-6..1e-4 -o measured.calibrated.toml --plot calibrate.svg
