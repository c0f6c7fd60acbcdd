#!/usr/bin/env bash
# Builds the program and the shared library and packs a scene as an FMU.
#
#   ./build-fmu.sh [SCENE.toml] [-o OUT.fmu] [--simulate]
#
# Default: the tread block in scenes/, packed as target/<name of the scene file>.fmu. With --simulate the FMU is run in
# fmpy along the scene's excitation; a table is printed and a picture drawn beside the FMU.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
target=$root/target
if [ -n "${CARGO_TARGET_DIR:-}" ]; then
    mkdir -p "$CARGO_TARGET_DIR"
    target=$(cd "$CARGO_TARGET_DIR" && pwd)
fi

usage() {
    sed -n '2,/^set/{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"
}

refuse() {
    echo "build-fmu.sh: $1" >&2
    exit 2
}

scene='' output='' simulate=false
while [ $# -gt 0 ]; do
    case $1 in
        -o | --output) [ $# -ge 2 ] || refuse "$1 needs a file name"; output=$2; shift ;;
        --simulate) simulate=true ;;
        -h | --help) usage; exit 0 ;;
        -*) refuse "unknown option $1; see --help" ;;
        *) [ -z "$scene" ] || refuse "one scene at a time: $scene or $1"; scene=$1 ;;
    esac
    shift
done
scene=${scene:-$root/scenes/tread-block/tread-block.toml}
[ -f "$scene" ] || refuse "no scene at $scene"
command -v cargo > /dev/null || refuse "Rust is needed: cargo is not on the PATH"
name=$(basename "$scene" .toml)
output=${output:-$target/$name.fmu}

# Without the program's packages, and in a folder of its own: the two builds would rebuild each other's otherwise.
build() {
    cargo build --manifest-path "$root/Cargo.toml" --locked --release --bin asperity --target-dir "$target"
    cargo build --manifest-path "$root/Cargo.toml" --locked --release --lib --no-default-features \
        --target-dir "$target/fmu"
}

library() {
    case $(uname -s) in
        Darwin) echo "$target/fmu/release/libasperity.dylib" ;;
        MINGW* | MSYS* | CYGWIN*) echo "$target/fmu/release/asperity.dll" ;;
        *) echo "$target/fmu/release/libasperity.so" ;;
    esac
}

# The program's own run gives the carrier's motion; the FMU follows it, straight from row to row with rates given.
simulate() {
    local python base
    base=${output%.fmu}
    python=$("$root/tests/python/environment.sh" "$target/venv")
    "$asperity" simulate "$scene" -o "$base.csv" --points 200
    "$python" "$root/tests/python/drive.py" "$output" "$base.csv" -o "$base.fmu.csv"
    "$python" "$root/tests/python/show.py" "$base.fmu.csv" -o "$base.png" --title "$name, simulated in fmpy" \
        --against "$base.csv"
    echo "$base.png"
}

build
asperity=$target/release/asperity
"$asperity" pack "$scene" -o "$output" --library "$(library)"
echo "$output"
if $simulate; then simulate; fi
