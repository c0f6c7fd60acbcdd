#!/usr/bin/env bash
# Runs the friction tester and draws its forces and the friction law behind them: all in FOLDER, by default target/tester.
#
#   scenes/tester/run.sh [FOLDER]
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
folder=${1:-$root/target/tester}
mkdir -p "$folder"

asperity=$("$root/scenes/program")
"$asperity" simulate "$here/tester.toml" -o "$folder/tester.csv" --rows 4000
"$asperity" plot "$folder/tester.csv" --y carrier.drive_x --labels tester --title "Force of the arm on the block" -o "$folder/force.svg"

# The law of the ten masses together under 20 N: 6 N + 10 N exp(-0.3 log10(v/v_0)^2), constant up to v_0 = 1 mm/s.
awk 'BEGIN {
    print "speed [m/s],friction [N]"
    for (i = 0; i <= 200; i++) {
        v = 0.0025 * i
        decades = v > 0.001 ? log(v / 0.001) / log(10) : 0
        printf "%g,%g\n", v, 0.3 * 20 + 10 * exp(-0.3 * decades * decades)
    }
}' > "$folder/law.csv"
"$asperity" plot "$folder/law.csv" --x speed --y friction --labels law --title "Friction of the block over its speed" -o "$folder/law.svg"
echo "$folder/force.svg $folder/law.svg"
