#!/usr/bin/env bash
# Runs the scene at three pressures and draws force over displacement: all in FOLDER, by default target/figure-7.
#
#   scenes/figure-7/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/figure-7}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
for pressure in low middle high; do
    "$asperity" simulate "$here/$pressure.toml" -o "$folder/$pressure.csv" --rows 200
done
"$asperity" plot "$folder/low.csv" "$folder/middle.csv" "$folder/high.csv" --x u --y F_x --negate --from-motion \
    --labels "F_z = 0.05 N,F_z = 0.2 N,F_z = 0.6 N" --title "Tangential force against displacement" \
    -o "$folder/figure-7.svg"
