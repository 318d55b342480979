#!/usr/bin/env bash
# Exact instructions of each public function. The firmware's example identifies a recorded log with
# eight sets in QEMU, which counts every call (count_plugin.c). Run by `make bench-firmware`.
#
# usage: tests/firmware/bench.sh CSV [BOARD-LEVEL...]     default: all built images
# Prints a table and writes it as CSV, for a comparison with instructions.csv (baseline.py).
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD csv=$1
shift
[ $# -gt 0 ] || set -- $(cd build/firmware && ls -d ./*/counted.elf | cut -d / -f 2)
work=$top/build/firmware/bench
rm -rf "$work"
mkdir -p "$work"
build/auvid node --bus memory --plain --excite --sets 8 --log "$work/bus.log" >"$work/node.txt"

# count BOARD-LEVEL IMAGE: runs it in a separate folder.
count() {
    local here=$work/$1/$2 image=$top/build/firmware/$1/$2.elf
    mkdir -p "$here"
    ln -s "$work/bus.log" "$here/bus.log"
    (cd "$here" && "$top/tests/firmware/count.sh" "${1%-*}" "$image" >said) ||
        { echo "bench: $1 $2: $(tail -n 2 "$here/said")" >&2; exit 1; }
}

for name in "$@"; do
    count "$name" counted
    count "$name" rows
done
python3 tests/firmware/instructions.py "$work" "$csv" "$@"
