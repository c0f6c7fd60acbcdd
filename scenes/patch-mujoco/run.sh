#!/usr/bin/env bash
# Builds the FMU of the tread, brakes the wheel on it in MuJoCo and draws it: all in FOLDER, by default target/patch-mujoco.
#
#   scenes/patch-mujoco/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/patch-mujoco}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

python=$("$root/tests/python/environment.sh" "$folder/venv" "$here/requirements.txt")
cargo build --release --locked --bin asperity --manifest-path "$root/Cargo.toml"
cargo rustc --release --locked --lib --no-default-features --crate-type cdylib --manifest-path "$root/Cargo.toml"
asperity=${CARGO_TARGET_DIR:-$root/target}/release/asperity
"$asperity" pack --patch "$here/tread.toml" -o "$folder/tread.fmu"
"$python" -B "$here/braking.py" "$folder"
echo "$folder/braking.svg"
