#!/usr/bin/env bash
# Runs the scene and draws it: all in FOLDER, by default target/tread-block-rubber.
#
#   scenes/tread-block-rubber/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/tread-block-rubber}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
"$asperity" simulate "$here/tread-block-rubber.toml" -o "$folder/tread-block-rubber.csv" --rows 400
"$asperity" plot "$folder/tread-block-rubber.csv" --y friction.coefficient --y contact.ratio \
    --title "A warm tread block: friction, and the part of it that touches" -o "$folder/tread-block-rubber.svg"
