#!/usr/bin/env bash
# Builds the FMUs of this example, runs it and draws its picture: all in FOLDER, by default target/coupled.
#
#   scenes/coupled/run.sh [FOLDER] [--quick]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=$root/target/coupled
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
    folder=$1
    shift
fi
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)

python=$("$root/tests/python/environment.sh" "$folder/venv" "$here/requirements.txt")
for scene in smooth stuck inside rough; do
    "$root/build-fmu.sh" "$here/$scene.toml" -o "$folder/$scene.fmu"
done
"$python" -m pythonfmu build -f "$here/body.py" -d "$folder/body.fmu" --handle-state
"$python" "$here/coupled.py" "$folder" "$@"
