#!/usr/bin/env bash
# Runs the scene and draws it: all in FOLDER, by default target/tread-block.
#
#   scenes/tread-block/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/tread-block}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
"$asperity" simulate "$here/tread-block.toml" -o "$folder/tread-block.csv" --rows 400 --plot "$folder/tread-block.svg"
