#!/usr/bin/env bash
# Moves the ring, and draws its wrench, its heat and the pressure at two places of it: all in FOLDER, by default
# target/seal-ring.
#
#   scenes/seal-ring/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/seal-ring}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
python3 "$here/ring.py" motion > "$folder/motion.csv"
"$asperity" simulate --patch "$here/ring.toml" --motion "$folder/motion.csv" -o "$folder/ring.csv" --plot "$folder/ring.svg"
# At two opposite places, near the inner edge.
"$asperity" plot "$folder/ring.csv" --y "element[1].pressure" --y "element[73].pressure" --labels ring \
    --title "Pressure at two opposite places of the ring" -o "$folder/pressure.svg"
"$asperity" plot "$folder/ring.csv" --y P_diss --labels ring --title "Heat of the ring" -o "$folder/heat.svg"
echo "$folder/ring.svg $folder/pressure.svg $folder/heat.svg"
