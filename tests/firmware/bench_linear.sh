#!/usr/bin/env bash
# Evaluations, instructions and memory of a search, by the number of parameters of a linear model:
# one search on eight sets on a Cortex-M4F at -Os, counted in QEMU. The sizes of config.h are those
# of the model, with AUVID_MAX_COMMANDS 0. Needs build/firmware/count_plugin.so (make
# bench-firmware).
#
# usage: tests/firmware/bench_linear.sh [SIZE...]       default: 4 7 13 22 26 32
# all: instructions from the complete sets to the estimate; time: at the default budget, in ticks of
# 20 ms; work, record: the largest call of auvid_identifier_work at this budget, and of
# auvid_identifier_motion, which completes rows and sets. bytes: sizeof(auvid_identifier_t), and
# the same with AUVID_MAX_POPULATION 0.
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD here=build/firmware/linear
[ $# -gt 0 ] || set -- 4 7 13 22 26 32
rm -rf "$here"
mkdir -p "$here"
compile="$(port/cortex_m/board.sh m4f compile) -Os -std=c11 -ffp-contract=off -Ilib/include \
    -Ilib/src -Iport/cortex_m -ffunction-sections -fdata-sections -DAUVID_MAX_COMMANDS=0"
# A room is one unit of translation: it takes seconds, and calls between rooms remain calls.
for room in base models navigation metric search excitation identifier; do
    printf '#include "%s"\n' "$top"/lib/src/$room/*.c >"$here/$room.c"
done
cp tests/firmware/bench_linear.c port/cortex_m/machine*.c "$here"

# bytes FLAG...: prints sizeof(auvid_identifier_t)
bytes() {
    echo '#include "auvid/identifier.h"
        char size[sizeof(auvid_identifier_t)];' | $compile "$@" -xc -c -o "$here/size.o" -
    echo $((16#$("$(port/cortex_m/board.sh m4f tools)nm" -S "$here/size.o" | cut -d ' ' -f 2)))
}

# run SIZE: prints "parameters evaluations not_converged", and counts in build/firmware/linear/SIZE
run() {
    local out=$here/$1 file
    mkdir "$out"
    for file in "$here"/*.c; do
        $compile "-DAUVID_MAX_PARAMETERS=$1" -c -o "$out/$(basename "$file" .c).o" "$file"
    done
    $(port/cortex_m/board.sh m4f link) -o "$out/image.elf" "$out"/*.o
    (cd "$out" && "$top/tests/firmware/count.sh" m4f ./image.elf >said)
    awk '{ of[$1] = $2 } END { print of["parameters"], of["evaluations"], of["not_converged"] }' \
        "$out/said"
}

echo "parameters  evaluations  all [k]  / n^3  time [s]  work [k]  record [k]          bytes"
for size; do
    read -r n evaluations not_converged < <(run "$size")
    [ "$not_converged" = 0 ] || echo "the search with size $size has not converged" >&2
    memory="$(bytes "-DAUVID_MAX_PARAMETERS=$size") / $(bytes "-DAUVID_MAX_PARAMETERS=$size" \
        -DAUVID_MAX_POPULATION=0)"
    awk -v n="$n" -v evaluations="$evaluations" -v memory="$memory" '
        { sub(/_f32.*/, "", $1) }
        $1 == "auvid_identifier_work" { calls = $2; all = $3; work = $4 }
        $1 == "auvid_identifier_motion" { record = $4 }
        END { printf "%10d  %11d  %7.0f  %5.0f  %8.1f  %8.0f  %10.0f  %13s\n", n, evaluations,
            all / 1e3, all / n ^ 3, 0.02 * calls, work / 1e3, record / 1e3, memory }' \
        "$here/$size/count"
done
