#!/usr/bin/env bash
# Sweeps the tables of both roads where they are not there, computes the tread's slip curves on each at 10 and 40 °C, and
# fits the Magic Formula to them, and scales a property file by them: all but the tables in FOLDER, by default target/slip.
#
#   scenes/slip/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/slip}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
sweep() {
    "$asperity" sweep "$here/../patch-mujoco/road.toml" --speeds 1e-3..10/9 --pressures 5e3,5e4,2e5,6e5 \
        --temperatures 10°C,40°C --points 2048 --set "surface.fine.shortest=$2" -o "$here/$1.table.csv" --plot "$folder/$1.sweep.svg"
}
sweep asphalt 5e-6
sweep smooth 1e-5
for road in asphalt smooth; do
    "$asperity" slip "$here/$road.toml" --loads 2000,4000,6000 --slips -0.3..0.3/41 --angles -20deg..20deg/41 \
        --temperatures 10°C,40°C --fit mf -o "$folder/$road.csv" --plot "$folder/$road.svg"
done
# tread.tir is of asphalt at 10 °C, and becomes that of the others: a table of one temperature each.
at() {
    grep -E "^(#|temperature|$2,)" "$folder/$1.csv" > "$folder/$1-$2.csv"
}
at asphalt 283.15
for other in "asphalt 313.15" "smooth 283.15"; do
    at $other
    name=${other/ /-}
    "$asperity" tir "$here/tread.tir" --from "$folder/asphalt-283.15.csv" --to "$folder/$name.csv" --carcass 8e5,4e5 \
        -o "$folder/$name.tir"
done
echo "$folder/asphalt.svg $folder/smooth.svg"
