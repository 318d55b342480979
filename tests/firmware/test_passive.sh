#!/usr/bin/env bash
# The passive examples identify a simulated dive on an emulated Cortex-M4F and on the host: the same
# estimates, bit for bit, and close to the truth.
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD
: "${LOGS:=build/test-logs}"
work=$top/$LOGS/passive
rm -rf "$work"
mkdir -p "$work"
build/auvid demo --sets 4 --csv "$work/demo.csv" --json >"$work/demo.json"
tests/firmware/passive.py log "$work/demo.csv" >"$work/dive.log"

# run NAME COMMAND...: runs it in a separate folder.
run() {
    local here=$work/$1
    mkdir -p "$here"
    ln -s ../dive.log "$here/dive.log"
    (cd "$here" && timeout 300 "${@:2}") >"$here/said" 2>&1 ||
        echo "not ok $1: $(tail -n 2 "$here/said")"
}

library=(lib/src/*/*.c)
library=("${library[@]/%.c/.o}")
for image in own_navigation with_filter; do
    ${CC:-gcc} -O2 -std=c11 -ffp-contract=off -Ilib/include -Iport/cortex_m \
        -o "$work/$image" "port/cortex_m/passive/$image.c" port/cortex_m/passive/driver_qemu.c \
        tests/firmware/machine_host.c "${library[@]/#/build/release/}"
    run "$image-host" "$work/$image"
    run "$image-m4f" "$top/port/cortex_m/board.sh" m4f run \
        "$top/build/firmware/m4f-Os/$image.elf"
    if cmp "$work/$image-"{host,m4f}/estimates.log; then
        echo "ok $image: estimates of m4f are those of the host; $(cat "$work/$image-m4f/said")"
    else
        echo "not ok $image: estimates of m4f are not those of the host"
    fi
    if out=$(tests/firmware/passive.py error "$work/$image-m4f/estimates.log" "$work/demo.json")
    then
        echo "ok $image: $out"
    else
        echo "not ok $image: $out"
    fi
done
