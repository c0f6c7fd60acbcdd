#!/usr/bin/env bash
# Runs the scene and draws it: all in FOLDER, by default target/seal.
#
#   scenes/seal/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/seal}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
"$asperity" simulate "$here/seal.toml" -o "$folder/seal.csv" --rows 400 --plot "$folder/seal.svg"
