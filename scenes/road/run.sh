#!/usr/bin/env bash
# Sweeps the compound over the road at three temperatures and pressures, slides the locked wheel and draws both: all in
# FOLDER, by default target/road. With --sweep the wheel, which takes longer, is left out.
#
#   scenes/road/run.sh [FOLDER [--sweep]]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/road}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
"$asperity" describe "$here/road.toml" --plot "$folder/law.svg"
"$asperity" sweep "$here/road.toml" --speeds 1e-5..10/25 --pressures 1e5,3e5,1e6 --temperatures 278.15,293.15,313.15 \
    -o "$folder/road.csv" --plot "$folder/sweep.svg" --master "$folder/master.svg"
if [ "${2:-}" = --sweep ]; then exit; fi
"$asperity" simulate "$here/slide.toml" -o "$folder/warm.csv" --rows 400
# As if no heat reached the rubber.
"$asperity" simulate "$here/slide.toml" --set material.heat.share=1e-9 -o "$folder/cold.csv" --rows 400
"$asperity" plot "$folder/warm.csv" "$folder/cold.csv" --x u --y friction.coefficient --labels warm,cold \
    --title "Friction of the locked wheel" -o "$folder/slide.svg"
