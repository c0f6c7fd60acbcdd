#!/usr/bin/env bash
# Builds the program and the shared library and packs a scene, a patch, a table or a seal as an FMU.
#
#   ./build-fmu.sh [SCENE.toml] [-o OUT.fmu] [--simulate] [--all-platforms]
#   ./build-fmu.sh --patch PATCH.toml | --table SWEEP.csv | --seal SEAL.toml [-o OUT.fmu] [--all-platforms]
#   ./build-fmu.sh --wheel [--all-platforms]
#
# Default: the tread block in scenes/, packed as target/<name of the file>.fmu; a contact patch with --patch, the element
# of a sweep's table with --table, a lip with a film with --seal. With --simulate the FMU is run in fmpy along the scene's excitation; a table is
# printed and a picture drawn beside the FMU.
#
# With --all-platforms, on Linux on x86-64, the FMU has a library for linux64, from glibc 2.17 on, and one for win64.
# That takes Debian's packages rustc-web, rust-web-src and gcc-mingw-w64-x86-64-win32, and cargo-zigbuild and ziglang,
# which are fetched from PyPI into target/.
#
# With --wheel the Python package asperity is built in place of an FMU, by maturin, which is fetched from PyPI into
# target/: a wheel with the program and the shared library of the FMUs, and a source distribution, in target/wheels. With
# --all-platforms there is a wheel for Linux from glibc 2.17 on, on x86-64 and on aarch64, and one for Windows, all
# linked by zig; that takes the targets of Rust that rustup adds.
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

scene='' kind=() output='' simulate=false all_platforms=false wheel=false
while [ $# -gt 0 ]; do
    case $1 in
        -o | --output) [ $# -ge 2 ] || refuse "$1 needs a file name"; output=$2; shift ;;
        --patch | --table | --seal) [ ${#kind[@]} -eq 0 ] || refuse "${kind[*]} or $1"; kind=("$1") ;;
        --simulate) simulate=true ;;
        --all-platforms) all_platforms=true ;;
        --wheel) wheel=true ;;
        -h | --help) usage; exit 0 ;;
        -*) refuse "unknown option $1; see --help" ;;
        *) [ -z "$scene" ] || refuse "one file at a time: $scene or $1"; scene=$1 ;;
    esac
    shift
done
if $wheel && { [ -n "$scene$output" ] || [ ${#kind[@]} -gt 0 ] || $simulate; }; then
    refuse "--wheel builds no FMU: it goes with --all-platforms alone"
fi
if [ ${#kind[@]} -gt 0 ]; then
    [ -n "$scene" ] || refuse "${kind[*]} needs a file"
    ! $simulate || refuse "--simulate follows the excitation of a scene; ${kind[*]} has none"
fi
scene=${scene:-$root/scenes/tread-block/tread-block.toml}
[ -f "$scene" ] || refuse "no file at $scene"
command -v cargo > /dev/null || refuse "Rust is needed: cargo is not on the PATH"
name=$(basename "$scene")
name=${name%.*}
output=${output:-$target/$name.fmu}

# Other platforms have folders of their own.
options=(--manifest-path "$root/Cargo.toml" --locked --release)

# The libraries would name the folders, and so the user, of who built them.
if [ -n "${CARGO_ENCODED_RUSTFLAGS:-}" ]; then
    IFS=$'\037' read -ra flags <<< "$CARGO_ENCODED_RUSTFLAGS"
else
    read -ra flags <<< "${RUSTFLAGS:-}"
fi
flags+=("--remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=cargo" "--remap-path-prefix=$root=asperity")
CARGO_ENCODED_RUSTFLAGS=$(IFS=$'\037' && echo "${flags[*]}")
export CARGO_ENCODED_RUSTFLAGS

# What the machine itself runs: the program, and with `-p asperity-fmu` the shared library.
build() {
    if ! [ -e "$target/release/asperity" ]; then
        echo "Building asperity: some two minutes on two cores where nothing is built yet; packages come from the network." >&2
    fi
    cargo build "${options[@]}" -p asperity-cli "$@" --target-dir "$target"
    local prefix=lib suffix=.so ending=''
    case $(uname -s) in
        Darwin) suffix=.dylib platform=darwin64 ;;
        MINGW* | MSYS* | CYGWIN*) prefix='' suffix=.dll ending=.exe platform=win64 ;;
        *) platform=linux64 ;;
    esac
    asperity=$target/release/asperity$ending
    library=$target/release/${prefix}asperity_fmu$suffix
}

# Packages by zig's linker, which knows the symbols of every glibc: a target, with the version of glibc behind it, a
# folder, and options that name them.
build_by_zig() {
    local python triple=$1 folder=$2
    shift 2
    python=$("$root/tests/python/environment.sh" "$target/zig" "$root/tests/host/zig.txt")
    PATH=$target/zig/bin:$target/zig/packages/bin:$PATH CARGO_ZIGBUILD_PYTHON_PATH=$python \
        cargo-zigbuild build "${options[@]}" "$@" --target "$triple" --target-dir "$folder"
}

build_linux64() {
    local glibc=2.17 triple=x86_64-unknown-linux-gnu folder=$target/linux64 newest
    local library=$folder/$triple/release/libasperity_fmu.so
    build_by_zig "$triple.$glibc" "$folder" -p asperity-fmu
    newest=$(objdump -T "$library" | grep -o 'GLIBC_[0-9.]*' | sed s/GLIBC_// | sort -V | tail -n 1)
    [ "$(printf '%s\n' "$newest" "$glibc" | sort -V | tail -n 1)" = "$glibc" ] ||
        refuse "$library needs glibc $newest, more than $glibc"
    libraries+=("linux64=$library")
}

# Debian's compiler and its standard library's sources: Rust's own has no Windows library on every machine.
build_win64() {
    local triple=x86_64-pc-windows-gnu folder=$target/win64
    RUSTC=$debian_rustc RUSTC_BOOTSTRAP=1 cargo build "${options[@]}" -p asperity-fmu -Zbuild-std=std,panic_unwind \
        --target "$triple" --target-dir "$folder"
    libraries+=("win64=$folder/$triple/release/asperity_fmu.dll")
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
    [ -x "$target/venv/bin/python" ] || echo "Installing fmpy and matplotlib into target/venv ..." >&2
    python=$("$root/tests/python/environment.sh" "$target/venv")
    "$asperity" simulate "$scene" -o "$base.csv" --rows 200
    "$python" "$root/tests/python/drive.py" "$output" "$base.csv" -o "$base.fmu.csv"
    "$python" "$root/tests/python/show.py" "$base.fmu.csv" -o "$base.png" --title "$name, simulated in fmpy" \
        --against "$base.csv"
    echo "$base.png"
}

package=$root/python/python/asperity

# A wheel with the program and the shared library of a platform, as FMUs name it; the other arguments are options of
# maturin.
build_wheel() {
    local platform=$1 program=$2 library=$3
    shift 3
    rm -rf "$package/binaries"
    mkdir -p "$package/binaries/$platform"
    cp "$program" "$library" "$package/binaries/$platform/"
    PATH=$target/zig/bin:$target/zig/packages/bin:$target/wheel/bin:$target/wheel/packages/bin:$PATH \
        maturin build --manifest-path "$root/python/Cargo.toml" --locked --release --out "$target/wheels" "$@"
}

build_wheel_by_zig() {
    local platform=$1 triple=$2 glibc=$3 program=$4 library=$5 folder=$target/$2/$2/release
    shift 5
    rustup target list --installed | grep -qx "$triple" || refuse "the wheel for $triple needs: rustup target add $triple"
    build_by_zig "$triple$glibc" "$target/$triple" -p asperity-cli -p asperity-fmu
    build_wheel "$platform" "$folder/$program" "$folder/$library" --zig --target "$triple" \
        --target-dir "$target/$triple" ${glibc:+--compatibility manylinux2014} "$@"
}

# The licences of what a wheel brings are collected from the packages themselves.
build_wheels() {
    local python
    python=$("$root/tests/python/environment.sh" "$target/wheel" wheel.txt)
    mkdir -p "$root/python/licenses"
    cp "$root"/LICENSE-* "$root/python/licenses/"
    "$python" "$root/python/licences.py" "$root/Cargo.toml" "$root/python/licenses/third-party.txt"
    if $all_platforms; then
        command -v rustup > /dev/null || refuse "--wheel --all-platforms needs rustup, which adds Rust's targets"
        build_wheel_by_zig linux64 x86_64-unknown-linux-gnu .2.17 asperity libasperity_fmu.so
        build_wheel_by_zig linux64 aarch64-unknown-linux-gnu .2.17 asperity libasperity_fmu.so
        # The feature does nothing in this version of pyo3, but this one of maturin asks for it; and it would build for
        # interpreters that the stable interface does not serve, were none named.
        build_wheel_by_zig win64 x86_64-pc-windows-gnu '' asperity.exe asperity_fmu.dll --features pyo3/generate-import-lib \
            --interpreter 3.10
    else
        build -p asperity-fmu
        build_wheel "$platform" "$asperity" "$library" --target-dir "$target"
    fi
    PATH=$target/wheel/bin:$target/wheel/packages/bin:$PATH \
        maturin sdist --manifest-path "$root/python/Cargo.toml" --out "$target/wheels"
}

libraries=()
if $wheel; then
    build_wheels
    exit
fi
if $all_platforms; then
    check_tools
    build_linux64
    build_win64
    build
else
    build -p asperity-fmu
    libraries=("$library")
fi
"$asperity" pack ${kind[@]+"${kind[@]}"} "$scene" -o "$output" "${libraries[@]/#/--library=}"
echo "$output"
if $simulate; then simulate; fi
