#!/usr/bin/env bash
# Prints the longest tick of the firmware's example with another budget, optionally passive, and
# with port/cortex_m/optional/soft_float.c. Run `make bench-firmware` first: this uses its log and
# objects.
#
# usage: tests/firmware/heaviest.sh BOARD-LEVEL BUDGET [passive] [soft]   e.g. m0plus-Os 2 passive
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD board=${1%-*} objects=build/firmware/$1 here=build/firmware/heaviest
rm -rf "$here"
mkdir -p "$here"
ln -s ../bench/bus.log "$here/bus.log"
compile=$(port/cortex_m/board.sh "$board" compile)
optional=()
if [[ " $* " == *" soft "* ]]; then
    optional=("$here/soft_float.o")
    $compile -O2 -std=c11 -c -o "${optional[0]}" port/cortex_m/optional/soft_float.c
fi
cp port/cortex_m/example/main.c "$here/main.c"
if [[ " $* " == *" passive "* ]]; then
    sed -i 's/if (!configure_excitation())/if (false \&\& configure_excitation())/' "$here/main.c"
    grep -q 'false && configure' "$here/main.c" ||
        { echo "heaviest: main.c configures its excitation elsewhere" >&2; exit 1; }
fi
$compile "-${1#*-}" -std=c11 -ffp-contract=off -Ilib/include \
    -Iport/cortex_m/example "-DBUDGET=$2" -c -o "$here/main.o" "$here/main.c"
$(port/cortex_m/board.sh "$board" link) -Wl,--wrap=machine_timer,--wrap=machine_sleep \
    -o "$here/image.elf" "$here/main.o" "$objects"/lib/src/*/*.o "$objects"/port/cortex_m/*.o \
    "$objects"/port/cortex_m/example/driver_qemu.o "$objects"/tests/firmware/machine_calm.o \
    "${optional[@]}"
(cd "$here" && "$top/tests/firmware/count.sh" "$board" ./image.elf >said)
awk -v what="$*" '{ sub(/^auvid_node_/, "", $1); mean[$1] = $3 / $2; most[$1] = $4 }
    END { printf "%s: instructions, mean / max: tick %d / %d; step %d / %d; work %d / %d\n", what,
        mean["tick"], most["tick"], mean["step"], most["step"], mean["work"], most["work"] }' \
    "$here/count"
