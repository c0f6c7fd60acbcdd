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

cargo build --release --locked --manifest-path "$root/Cargo.toml"
asperity=${CARGO_TARGET_DIR:-$root/target}/release/asperity
python3 "$here/damper.py" "$asperity" "$folder" "$@"
"$asperity" plot "$folder/damper.csv" --x load --y amplitude_um --y jenkins_one_harmonic_um --labels damper -o "$folder/damper.svg" \
    --title "Largest amplitude over frequency in micrometres"
echo "$folder/damper.svg"
