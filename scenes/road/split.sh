#!/usr/bin/env bash
# Friction of the road by the layer and by the solver of steady sliding, with the profile down to 4, 2 and 1 mm and the finer
# waves in the law of the contacts: in FOLDER, by default target/road-split. The layer of 256 masses takes minutes.
#
#   scenes/road/split.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/road-split}
mkdir -p "$folder"
asperity=$("$root/scenes/program")

# The shortest wave of the profile (m), masses an eighth of it apart, and the rms height that such a profile of the same road
# has: seed and spectrum are the same, waves are added.
while read -r cut_off masses rms; do
    for method in steady layer; do
        "$asperity" sweep "$here/road.toml" --method "$method" --speeds 0.01,0.1,1,10 --pressures 3e5 \
            --set surface.cut_off_wavelength="$cut_off" --set layer.masses="$masses" \
            --set layer.spacing="$(awk "BEGIN { print 0.032 / $masses }")" --set surface.points=$((4 * masses)) \
            --set surface.rms="$rms" --set 'layer.kinematics="material"' -o "$folder/$method-$cut_off.csv"
    done
done << 'END'
4e-3 64 2e-4
2e-3 128 2.090e-4
1e-3 256 2.121e-4
END
cd "$folder"
"$asperity" plot steady-4e-3.csv steady-1e-3.csv layer-4e-3.csv layer-2e-3.csv layer-1e-3.csv --x speed --y friction \
    --log x --labels "solver to 4 mm,solver to 1 mm,layer to 4 mm,layer to 2 mm,layer to 1 mm" \
    --title "Friction of scenes/road at 3 bar" -o split.svg
