#!/usr/bin/env bash
# Builds the C peer: sundials/build.sh PROGRAM. Needs gcc and Debian's libsundials-dev and libsuitesparse-dev.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
gcc -std=gnu11 -O3 -march=native -fopenmp-simd -fno-math-errno -fno-trapping-math -Wall -Wextra \
    -I/usr/include/suitesparse "$here"/*.c -o "$1" -lsundials_arkode -lsundials_cvodes -lsundials_nvecserial \
    -lsundials_sunmatrixsparse -lsundials_sunlinsolklu -lklu -lm
