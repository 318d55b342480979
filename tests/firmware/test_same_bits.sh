#!/usr/bin/env bash
# Identifies a recorded log on every core, and on the host with different compiler flags. Every
# frame that the firmware's example sends is compared bit for bit.
#
# The reference is the library as built by `make`: the run that recorded the log. The log has the
# frames it sent; only its load (in health) and its answers to ticks depend on the machine. For the
# board with 20 KiB of RAM the reference is the host with the same sizes.
#
# The log has eight sets. In the short form the emulators have its first 100 s, with three sets, and
# two cores are left out (board.sh short). The board with 20 KiB has the whole log: its sets are
# longer, and its estimate is judged.
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD
: "${LOGS:=build/test-logs}"
work=$top/$LOGS/same-bits
rm -rf "$work"
mkdir -p "$work"

# Frames as "ID#DATA" in order, without those that depend on the machine's speed.
frames() {
    awk '{ print $3 }' "$1"
}

build/auvid node --bus memory --plain --excite --sets 8 --json --log "$work/whole.log" \
    >"$work/node.json" ||
    { echo "not ok the log could not be recorded"; exit 1; }
emulated=whole
if [ -z "${AUVID_TEST_LONG:-}" ]; then
    emulated=begin
    awk '/ 041#/ && ++ticks > 5000 { exit } { print }' "$work/whole.log" >"$work/begin.log"
fi
# The node's messages: lib/can/README.md. 40F is health, 045 tick_done.
for log in "$work"/*.log; do
    frames "$log" | grep -E '^(042|043|409|40A|40B|40C|40D|40E|41[0-2])#' >"${log%.log}.frames"
done
declare -A hash

# compare NAME LOG: compares $work/NAME/sent.log with the reference and with all others.
compare() {
    local sent=$work/$1/sent.log mine same line reference=$work/$2.frames
    frames "$sent" | grep -v '^40F#' >"$work/$1/frames"
    if [[ $1 == *20k* ]]; then
        reference+=-20k
        [ -e "$reference" ] || cp "$work/$1/frames" "$reference"
    fi
    if ! cmp -s "$reference" "$work/$1/frames"; then
        line=$(diff --speed-large-files "$reference" "$work/$1/frames" | grep -m1 '^[0-9]')
        echo "not ok $1: first difference (line of reference, change, line of sent): $line"
        diff "$reference" "$work/$1/frames" | grep -m2 '^[<>]' || true
        return 1
    fi
    mine=$(sha256sum <"$sent")
    mine=${mine:0:16}
    : "${hash[$reference]:=$mine}"
    same=$(wc -l <"$sent")
    [ "$mine" = "${hash[$reference]}" ] ||
        { echo "not ok $1: hash $mine, not ${hash[$reference]}"; return 1; }
    echo "ok $1: $same frames sent, hash $mine; $(tr '\n' ' ' <"$work/$1/said")"
}

# run NAME LOG COMMAND...: runs it in a separate folder, with the log of that name.
run() {
    local name=$1 log=$2
    shift 2
    mkdir -p "$work/$name"
    ln -s "../$log.log" "$work/$name/bus.log"
    if (cd "$work/$name" && timeout 600 "$@") >"$work/$name/said" 2>&1; then
        compare "$name" "$log" || true
    else
        echo "not ok $name: $(tail -n 2 "$work/$name/said")"
    fi
}

# check_stack BOARD: the stack used is no more than the maximum of the call graph (size.py).
check_stack() {
    local used most
    used=$(grep -o 'stack: [0-9]*' "$work/$1-Os/said" | cut -d ' ' -f 2)
    most=$(awk -F , -v at="^stack/$1/(main|interrupt)$" '$1 ~ at { sum += $2 } END { print sum }' \
        tests/firmware/size.csv)
    if [ "${used:-999999}" -le "$most" ]; then
        echo "ok $1: stack used: $used of at most $most bytes"
    else
        echo "not ok $1: stack used: ${used:-unknown}, the call graph says at most $most bytes"
    fi
}

for host in build/firmware/host/*; do
    [ ! -x "$host" ] || [ -d "$host" ] || run "${host##*/}" whole "$top/$host"
done
levels=(Os) which=short
[ -z "${AUVID_TEST_LONG:-}" ] || levels+=(O2) which=list
for level in "${levels[@]}"; do
    for board in $(port/cortex_m/board.sh $which); do
        image=$top/build/firmware/$board-$level/example.elf log=$emulated
        [ "$board" != m3_20k ] || log=whole
        run "$board-$level" "$log" "$top/port/cortex_m/board.sh" "$board" run "$image"
        [ "$level" != Os ] || check_stack "$board"
    done
done

# With multiplication and sums of port/cortex_m/optional/soft_float.c.
for image in build/firmware/m0plus-Os/soft_float*.elf; do
    name=$(basename "$image" .elf)
    run "m0plus-$name" "$emulated" "$top/port/cortex_m/board.sh" m0plus run "$top/$image"
    if grep -Eq '(mul|add|sub)sf3\.o' "${image%.elf}.map"; then
        echo "not ok $name: the compiler's functions are linked too"
    fi
done

# A complete identification in 20 KiB of RAM.
error=$(tests/firmware/estimates.py "$work/m3_20k-Os/sent.log" "$work/node.json") || error="none 99"
echo "$error" | awk '{ print ($2 < 3 ? "ok" : "not ok"), "m3_20k, rms error below 3 %:", $0 }'
