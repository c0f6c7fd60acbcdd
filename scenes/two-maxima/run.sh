#!/usr/bin/env bash
# Sweeps the scene over speed at two temperatures and draws friction, and its master curve: all in FOLDER, by default target/two-maxima.
#
#   scenes/two-maxima/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/two-maxima}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
"$asperity" sweep "$here/two-maxima.toml" --method layer --speeds 1e-5..20/15 --pressures 4e5 \
    --temperatures 293.15,303.15 --distance 0.5 --friction-error 0.02 -o "$folder/two-maxima.csv" \
    --plot "$folder/two-maxima.svg" --master "$folder/master.svg"
