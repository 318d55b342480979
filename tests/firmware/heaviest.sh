#!/usr/bin/env bash
# Prints the longest tick of the firmware's example with another budget, optionally passive. Run
# `make bench-firmware` first: this uses its log and objects.
#
# usage: tests/firmware/heaviest.sh BOARD-LEVEL BUDGET [passive]      e.g. m0plus-Os 2 passive
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD board=${1%-*} objects=build/firmware/$1 here=build/firmware/heaviest
rm -rf "$here"
mkdir -p "$here"
ln -s ../bench/bus.log "$here/bus.log"
sed "$([ "${3:-}" = passive ] && echo 's/ || !configure_excitation()//')" \
    port/cortex_m/example/main.c >"$here/main.c"
$(port/cortex_m/board.sh "$board" compile) "-${1#*-}" -std=c11 -ffp-contract=off -Ilib/include \
    -Iport/cortex_m/example "-DBUDGET=$2" -c -o "$here/main.o" "$here/main.c"
$(port/cortex_m/board.sh "$board" link) -Wl,--wrap=machine_timer,--wrap=machine_sleep \
    -o "$here/image.elf" "$here/main.o" "$objects"/lib/src/*/*.o "$objects"/port/cortex_m/*.o \
    "$objects"/port/cortex_m/example/driver_qemu.o "$objects"/tests/firmware/machine_calm.o
(cd "$here" && "$top/tests/firmware/count.sh" "$board" ./image.elf >said)
awk -v what="$*" '{ sub(/^auvid_node_/, "", $1); mean[$1] = $3 / $2; most[$1] = $4 }
    END { printf "%s: instructions, mean / max: tick %d / %d; step %d / %d; work %d / %d\n", what,
        mean["tick"], most["tick"], mean["step"], most["step"], mean["work"], most["work"] }' \
    "$here/count"
