#!/usr/bin/env bash
# Finds the load at which friction damps a resonance best, and draws it: all in FOLDER, by default target/damper.
#
#   scenes/damper/run.sh [FOLDER] [--loads 0.03,0.05,...]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=$root/target/damper
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
    folder=$1
    shift
fi
mkdir -p "$folder"

asperity=$("$root/scenes/program")
python3 "$here/damper.py" "$asperity" "$folder" "$@"
"$asperity" plot "$folder/damper.csv" --x load --y amplitude --y one_harmonic -o "$folder/damper.svg" \
    --title "Largest amplitude over frequency: the scene, and a Jenkins element by one harmonic"
echo "$folder/damper.svg"
