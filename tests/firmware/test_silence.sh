#!/usr/bin/env bash
# The example's supervision of the tick. A controller may start 0.3 s after the board, as in all
# logs here (driver_qemu.c). A controller that is silent for half a second during the excitation
# ends it with exactly one command of zero.
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD
: "${LOGS:=build/test-logs}"
work=$top/$LOGS/silence
rm -rf "$work"
mkdir -p "$work/late" "$work/lost"

# Twelve seconds of a run; the arm frame comes after one second.
build/auvid node --bus memory --plain --excite --sets 1 --log "$work/all.log" \
    >"$work/node.txt" || true
awk '{ t = substr($1, 2) + 0; begin = NR == 1 ? t : begin } t < begin + 12' "$work/all.log" \
    >"$work/late/bus.log"
awk '{ t = substr($1, 2) + 0; begin = NR == 1 ? t : begin } t < begin + 6 || t > begin + 6.5' \
    "$work/late/bus.log" >"$work/lost/bus.log"
before=$(awk '{ t = substr($1, 2) + 0; begin = NR == 1 ? t : begin } t < begin + 6 && / 042#/' \
    "$work/late/bus.log" | wc -l)

commands() {
    awk '{ print $3 }' "$1" | grep -E '^04[23]#' || true
}

# run NAME CASE COMMAND...: with the log of that case.
run() {
    local name=$1 case=$2
    shift 2
    (cd "$work/$case" && timeout 120 "$@") >"$work/$case/said" 2>&1 ||
        echo "not ok $name, $case: $(tail -n 2 "$work/$case/said")"
    commands "$work/$case/sent.log" >"$work/$case/commands"
}

both() {
    local name=$1
    shift
    run "$name" late "$@"
    if cmp -s <(commands "$work/late/bus.log") "$work/late/commands" && [ "$before" -gt 200 ]; then
        echo "ok $name: excites as the host did, though the first tick came 0.3 s after the board"
    else
        echo "not ok $name: $(wc -l <"$work/late/commands") commands after a late first tick"
    fi
    run "$name" lost "$@"
    if [ "$(grep -c ^042 "$work/lost/commands")" = $((before + 1)) ] &&
        [ "$(tail -n 2 "$work/lost/commands" | grep -Ec '^04[23]#..0.0{12}$')" = 2 ]; then
        echo "ok $name: one command of zero when the tick is lost, and none after it"
    else
        echo "not ok $name: after $before commands and a lost tick:" \
            "$(tail -n 2 "$work/lost/commands")"
    fi
}

both host "$top/build/firmware/host/gcc-O0"
for board in m4f; do
    both "$board" "$top/port/cortex_m/board.sh" "$board" run \
        "$top/build/firmware/$board-Os/example.elf"
done
