#!/usr/bin/env bash
# The node and the simulated vehicle as two processes on a bus, observed by can-utils and cantools.
AUVID=$(realpath "${AUVID:-build/auvid}")
export VCAN_TIMEOUT=1150
[ -z "${AUVID_TEST_LONG:-}" ] || VCAN_TIMEOUT=9000
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

SETS=2 SILENT_SETS=1
[ -z "${AUVID_TEST_LONG:-}" ] || SETS=8 SILENT_SETS=8

# whole_run NAME SETS OTHERS NODE_OPTION [VEHICLE_OPTION]: a run in lock step, observed by candump
# (NAME.log) and OTHERS. The vehicle starts when the node listens, so no tick is missed.
whole_run() {
    witness "$1.log"
    within 20 listening vcan0 $(($3 + 1))
    # shellcheck disable=SC2086 # nothing where there is no option
    start node node --bus vcan0 --lock-step --json --sets "$2" $4
    within 20 listening vcan0 $(($3 + 2))
    # shellcheck disable=SC2086
    start vehicle vehicle --bus vcan0 --lock-step ${5:-}
    status=0
    wait "$node" || status=$?
    kill -TERM "$vehicle"
    wait "$vehicle"
    cat node.err vehicle.out
    all_seen "$1.log"
}

# estimates JSON: prints value and sigma, one line per parameter.
estimates() {
    sed -n 's/.*"estimate": \([^,]*\), "sigma": \([^,]*\),.*/\1 \2/p' "$1"
}

# order LOG: counts thruster commands relative to arm and abort. The thrust is all bits but the
# checksum and the counter, which are the first byte and the low half of the second.
order() {
    awk '{
        id = substr($3, 1, 3)
        arms += id == "044"
        aborts += id == "040"
        ticks += aborts && id == "041"
        zero = $3 ~ /#..0.0*$/
    }
    id == "042" || id == "043" {
        commands++
        early += !arms
        moving += !zero
        under_way += aborts && ticks == 0
        last += aborts && ticks == 1
        last_a += aborts && ticks == 1 && id == "042" && zero
        last_b += aborts && ticks == 1 && id == "043" && zero
        late += ticks > 1
    }
    END {
        printf "arms=%d commands=%d early=%d moving=%d aborts=%d under_way=%d last=%d last_a=%d " \
            "last_b=%d late=%d ticks=%d\n", arms, commands, early, moving, aborts, under_way, last,
            last_a, last_b, late, ticks
    }' "$1" | tee order
}

lock_step() {
    "$TOP/third_party/venv/bin/python" "$TOP/tests/vcan/listen.py" vcan0 "$TOP/lib/can/auvid.dbc" \
        >heard 2>heard.err &
    local cantools=$!
    within 60 grep -q ready heard.err
    whole_run bus "$SETS" 1 '--excite --plain'
    [ "$status" = 0 ]
    kill -TERM "$cantools"
    wait "$cantools"
    # "estimate  2 sets, rms error 1.44 %"
    awk '/rms error/ { found = $6 < 3 } END { exit !found }' vehicle.out
    grep -q ' 0 lost,' vehicle.out
    cp node.out node.json
}

cantools_decodes() {
    grep "frames=$(wc -l <bus.log) undecoded=0" heard.err
    [ "$(wc -l <heard)" = 13 ]
    diff <(estimates node.json) heard
}

memory_alike() {
    "$AUVID" node --bus memory --plain --excite --sets "$SETS" --json >memory.json
    diff <(estimates memory.json) heard
}

replay() {
    "$AUVID" replay bus.log --plain --sets "$SETS" >replay.out
    tail -n 1 replay.out
    grep -q " $(grep -Ec ' 40[CD]#' bus.log) as in the log, 0 different" replay.out
}

# No command from a passive node, despite an arm frame.
passive() {
    whole_run passive "$SILENT_SETS" 0 ''
    order passive.log
    holds 'v["arms"] > 0 && v["commands"] == 0' <order
}

no_arm() {
    whole_run no_arm "$SILENT_SETS" 0 --excite --no-arm
    order no_arm.log
    holds 'v["arms"] == 0 && v["commands"] == 0' <order
}

excited() {
    [ "$(grep -c ' 042#' abort.log)" -gt 200 ]
}

# The operator's abort. The command of the current tick may follow it. In the next tick the node
# sends one command of zero for each half of the thrusters, and none after that.
aborted() {
    : >abort.log
    (within 60 excited && cansend vcan0 040#AC10000000000000) &
    whole_run abort "$SILENT_SETS" 0 --excite
    order abort.log
    holds 'v["aborts"] == 1 && v["under_way"] <= 2 && v["ticks"] > 1000' <order
    holds 'v["arms"] > 0 && v["early"] == 0 && v["moving"] > 300' <order
    holds 'v["last"] == 2 && v["last_a"] == 1 && v["last_b"] == 1 && v["late"] == 0' <order
}

# The vehicle prints the sentence that the node puts into its JSON.
late() {
    local words
    whole_run late "$SILENT_SETS" 0 --excite '--lag 0.6'
    words=$(grep -o 'thrust acts later than stamped[^"]*' node.out)
    grep -F "    $words" vehicle.out
}

check "node and vehicle in lock step identify; candump lost no frame" lock_step
check "cantools decodes every frame and the node's estimates" cantools_decodes
check "the bits are those of the bus in memory" memory_alike
check "candump's log replays bit for bit" replay
check "a whole run without an arm frame has no thruster command" no_arm
check "a whole run with an abort: no command before arm, one of zero after the abort" aborted
# In the short form tests/program/test_bus.sh has these two over the bus in memory.
if [ -n "${AUVID_TEST_LONG:-}" ]; then
    check "a whole passive run has no thruster command" passive
    check "thrusters that lag are found by the node and said by the vehicle, which reads frames" \
        late
fi
exit "$failed"
