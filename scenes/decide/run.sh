#!/usr/bin/env bash
# Compares the two treads over speed and temperature with what is not known of them, over a year and over its cold months,
# and says what to measure next: all in FOLDER, by default target/decide.
#
#   scenes/decide/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/decide}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
points=(--speeds 0.03..1/4 --pressures 3bar)
temperatures=(--temperatures=-10°C..60°C/8)
# Exit status 3 is an answer, too: the two are not told apart.
rank() { "$asperity" rank "$here/summer.toml" "$here/winter.toml" "${points[@]}" "${temperatures[@]}" --samples 64 "$@" || [ $? = 3 ]; }
rank --weights "$here/year.csv" -o "$folder/year.csv" --plot "$folder/year.svg"
rank --weights "$here/cold-months.csv" -o "$folder/cold-months.csv" --plot "$folder/cold-months.svg"
for tread in summer winter; do
    "$asperity" sweep "$here/$tread.toml" "${points[@]}" --temperatures 0°C,20°C --samples 64 --force \
        -o "$folder/$tread.csv" --plot "$folder/$tread.svg"
done
"$asperity" sweep "$here/summer.toml" --speeds 1e-3..1/13 --pressures 3bar --temperatures=-10°C..60°C/15 --force \
    --over speed,temperature -o "$folder/map.csv" --plot "$folder/map.svg"
