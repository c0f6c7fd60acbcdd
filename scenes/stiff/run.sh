#!/usr/bin/env bash
# Runs the scene and draws it: all in FOLDER, by default target/stiff.
#
#   scenes/stiff/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/stiff}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
"$asperity" simulate "$here/stiff.toml" -o "$folder/stiff.csv" --rows 400 --plot "$folder/stiff.svg"
