#!/usr/bin/env bash
# Prints the instructions of a tick of the firmware's example, and its memory, with another budget.
# Optionally it is passive, has uncertain inputs, or has port/cortex_m/optional/soft_float.c.
# Run `make bench-firmware` first: this uses its log and objects.
#
# usage: tests/firmware/heaviest.sh BOARD-LEVEL BUDGET [passive] [uncertain] [soft]
# e.g. m0plus-Os 2 passive. The instructions of all functions are in build/firmware/heaviest/count.
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
if [[ " $* " == *" uncertain "* ]]; then
    sed -i -e 's/exact_inputs = true/exact_inputs = false/' -e '/^static bool configure(void)/i \
static bool attach_uncertain(void) \
{ \
    static auvid_uncertain_t uncertain; \
    auvid_uncertain_config_t inputs; \
    auvid_uncertain_defaults(&inputs); \
    return auvid_node_attach_uncertain(&node, &uncertain, &inputs) >= 0; \
}' -e '/return auvid_node_init/s/ \&\&$/ \&\& attach_uncertain() \&\&/' "$here/main.c"
    [ "$(grep -c -e 'attach_uncertain() &&' -e 'inputs = false' "$here/main.c")" = 2 ] ||
        { echo "heaviest: main.c configures its inputs elsewhere" >&2; exit 1; }
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
"$(port/cortex_m/board.sh "$board" tools)size" "$here/image.elf" | awk -v what="$*" \
    'NR == 2 { printf "%s: flash %d, static RAM %d bytes\n", what, $1 + $2, $2 + $3 }'
