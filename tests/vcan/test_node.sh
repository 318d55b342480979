#!/usr/bin/env bash
# The node and the simulated vehicle as two processes on a bus (node_on_bus.sh), then what others
# make of candump's log. That happens outside: in a virtual machine Python takes a minute for it.
. "$(dirname "$0")/../program/common.sh"
export AUVID VCAN_KEPT=$ROOT/build/node_on_bus
SETS=2
[ -z "${AUVID_TEST_LONG:-}" ] || SETS=8
LOG=$VCAN_KEPT/bus.log

# estimates JSON: prints value and sigma, one line per parameter.
estimates() {
    sed -n 's/.*"estimate": \([^,]*\), "sigma": \([^,]*\),.*/\1 \2/p' "$1"
}

cantools_decodes() {
    "$ROOT/third_party/venv/bin/python" "$ROOT/tests/vcan/decode.py" "$LOG" \
        "$ROOT/lib/can/auvid.dbc" >decoded 2>decoded.err || { cat decoded.err && false; }
    grep "frames=$(wc -l <"$LOG") undecoded=0" decoded.err
    [ "$(wc -l <decoded)" = 13 ]
    diff <(estimates "$VCAN_KEPT/node.json") decoded
}

memory_alike() {
    "$AUVID" node --bus memory --plain --excite --sets "$SETS" --json >memory.json
    diff <(estimates memory.json) decoded
}

replay() {
    "$AUVID" replay "$LOG" --plain --sets "$SETS" >replay.out
    tail -n 1 replay.out
    grep -q " $(grep -Ec ' 40[CD]#' "$LOG") as in the log, 0 different" replay.out
}

rm -rf "$VCAN_KEPT"
mkdir -p "$VCAN_KEPT"
"$ROOT/tests/vcan/node_on_bus.sh" || failed=1
if [ -e "$LOG" ]; then # else it has said why
    check "cantools decodes every frame and the node's estimates" cantools_decodes
    check "the bits are those of the bus in memory" memory_alike
    check "candump's log replays bit for bit" replay
fi
finish
