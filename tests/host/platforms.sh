#!/usr/bin/env bash
# Builds FMUs for all platforms, runs them in the C host beside this file, on Linux and, under wine, as on Windows, and
# compares what they answer. To be run by hand: installs nothing, takes what ./build-fmu.sh --all-platforms takes and
# Debian's packages gcc, wine and wine64.
#
#   tests/host/platforms.sh [SCENE.toml ...]
#
# Default: the tread block and two scenes of tests/reference that stick, slip and hit the profile.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$here/../..
target=$(mkdir -p "${CARGO_TARGET_DIR:-$root/target}" && cd "${CARGO_TARGET_DIR:-$root/target}" && pwd)
folder=$target/platforms
export WINEPREFIX=${WINEPREFIX:-$target/wine}

scenes=("$@")
[ $# -gt 0 ] || scenes=("$root"/scenes/tread-block/tread-block.toml "$root"/tests/reference/{rough-coulomb,rattle}.toml)

python=$("$root/tests/python/environment.sh" "$target/venv")
mkdir -p "$folder"
for scene in "${scenes[@]}"; do
    base=$folder/$(basename "$scene" .toml)
    "$root/build-fmu.sh" "$scene" -o "$base.fmu" --all-platforms
    "$target/release/asperity" simulate "$scene" -o "$base.csv" --rows 100
    for platform in linux64 win64; do
        "$python" "$here/run.py" "$base.fmu" "$base.csv" -o "$base.$platform.csv" --platform "$platform"
    done
    "$python" "$here/compare.py" "$base.linux64.csv" "$base.win64.csv"
done
