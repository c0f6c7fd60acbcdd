#!/usr/bin/env bash
# Builds the program and the shared library and packs a scene as an FMU.
#
#   ./build-fmu.sh [SCENE.toml] [-o OUT.fmu] [--simulate] [--all-platforms]
#
# Default: the tread block in scenes/, packed as target/<name of the scene file>.fmu. With --simulate the FMU is run in
# fmpy along the scene's excitation; a table is printed and a picture drawn beside the FMU.
#
# With --all-platforms, on Linux on x86-64, the FMU has a library for linux64, from glibc 2.17 on, and one for win64.
# That takes Debian's packages rustc-web, rust-web-src and gcc-mingw-w64-x86-64-win32, and cargo-zigbuild and ziglang,
# which are fetched from PyPI into target/.
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

scene='' output='' simulate=false all_platforms=false
while [ $# -gt 0 ]; do
    case $1 in
        -o | --output) [ $# -ge 2 ] || refuse "$1 needs a file name"; output=$2; shift ;;
        --simulate) simulate=true ;;
        --all-platforms) all_platforms=true ;;
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

# The library alone, without the program's packages and optimised as a whole, which cargo does where nothing else is
# made of it. Each platform has a folder of its own: the builds would rebuild each other's packages otherwise.
library_options=(--manifest-path "$root/Cargo.toml" --locked --release --lib --no-default-features --crate-type cdylib)

build_library() {
    cargo rustc "${library_options[@]}" --target-dir "$target/fmu"
    case $(uname -s) in
        Darwin) libraries=("$target/fmu/release/libasperity.dylib") ;;
        MINGW* | MSYS* | CYGWIN*) libraries=("$target/fmu/release/asperity.dll") ;;
        *) libraries=("$target/fmu/release/libasperity.so") ;;
    esac
}

# zig's linker knows the symbols of every glibc.
build_linux64() {
    local glibc=2.17 triple=x86_64-unknown-linux-gnu folder=$target/linux64 python newest
    local library=$folder/$triple/release/libasperity.so
    python=$("$root/tests/python/environment.sh" "$target/zig" "$root/tests/host/zig.txt")
    PATH=$target/zig/bin:$target/zig/packages/bin:$PATH CARGO_ZIGBUILD_PYTHON_PATH=$python \
        cargo-zigbuild rustc "${library_options[@]}" --target "$triple.$glibc" --target-dir "$folder"
    newest=$(objdump -T "$library" | grep -o 'GLIBC_[0-9.]*' | sed s/GLIBC_// | sort -V | tail -n 1)
    [ "$(printf '%s\n' "$newest" "$glibc" | sort -V | tail -n 1)" = "$glibc" ] ||
        refuse "$library needs glibc $newest, more than $glibc"
    libraries+=("linux64=$library")
}

# Debian's compiler and its standard library's sources: Rust's own has no Windows library on every machine.
build_win64() {
    local triple=x86_64-pc-windows-gnu folder=$target/win64
    RUSTC=$debian_rustc RUSTC_BOOTSTRAP=1 cargo rustc "${library_options[@]}" -Zbuild-std=std,panic_unwind \
        --target "$triple" --target-dir "$folder"
    libraries+=("win64=$folder/$triple/release/asperity.dll")
}

debian_rustc=/usr/bin/rustc

# Names the packages of Debian that are not there.
check_tools() {
    local needed found missing=()
    [ "$(uname -sm)" = "Linux x86_64" ] || refuse "--all-platforms works on Linux on x86-64 alone"
    [ -x "$debian_rustc" ] || missing+=(rustc-web)
    [ -e /usr/lib/rustlib/src/rust/library/std/Cargo.toml ] || missing+=(rust-web-src)
    command -v x86_64-w64-mingw32-gcc > /dev/null || missing+=(gcc-mingw-w64-x86-64-win32)
    command -v objdump > /dev/null || missing+=(binutils)
    [ ${#missing[@]} -eq 0 ] || refuse "--all-platforms needs Debian's packages ${missing[*]}"
    needed=$(sed -n 's/^rust-version = "\(.*\)"/\1/p' "$root/Cargo.toml")
    found=$("$debian_rustc" --version | cut -d ' ' -f 2)
    [ "$(printf '%s\n' "$needed" "$found" | sort -V | head -n 1)" = "$needed" ] ||
        refuse "rustc-web $needed or later is needed, $found is there; Debian's security updates have it"
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

libraries=()
if $all_platforms; then
    check_tools
    build_linux64
    build_win64
else
    build_library
fi
cargo build --manifest-path "$root/Cargo.toml" --locked --release --bin asperity --target-dir "$target"
asperity=$target/release/asperity
"$asperity" pack "$scene" -o "$output" "${libraries[@]/#/--library=}"
echo "$output"
if $simulate; then simulate; fi
