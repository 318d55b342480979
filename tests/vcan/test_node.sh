#!/usr/bin/env bash
# The node and the simulated vehicle as two processes on a bus, with can-utils and cantools beside.
AUVID=$(realpath "${AUVID:-build/auvid}")
export VCAN_TIMEOUT=230
[ -z "${AUVID_TEST_LONG:-}" ] || VCAN_TIMEOUT=1800
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

SETS=2 SILENT_SETS=1
[ -z "${AUVID_TEST_LONG:-}" ] || SETS=8 SILENT_SETS=8

# whole_run NAME SETS OTHERS NODE_OPTION [VEHICLE_OPTION]: a run in lock step, seen by candump
# (NAME.log) and OTHERS. The vehicle starts when the node listens: no tick is missed.
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

# estimates JSON: value and sigma, a line for each parameter.
estimates() {
    sed -n 's/.*"estimate": \([^,]*\), "sigma": \([^,]*\),.*/\1 \2/p' "$1"
}

# order LOG: thruster commands, against arm and abort. A thrust is all bits but the checksum and the
# counter, which are the first byte and the low half of the second.
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
    whole_run bus "$SETS" 1 --excite
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
    "$AUVID" node --bus memory --excite --sets "$SETS" --json >memory.json
    diff <(estimates memory.json) heard
}

replay() {
    "$AUVID" replay bus.log --sets "$SETS" >replay.out
    tail -n 1 replay.out
    grep -q " $(grep -Ec ' 40[CD]#' bus.log) as in the log, 0 different" replay.out
}

# Nothing from a passive node, though it is told to arm.
passive() {
    whole_run passive "$SILENT_SETS" 0 ''
    order passive.log
    saw 'v["arms"] > 0 && v["commands"] == 0' <order
}

no_arm() {
    whole_run no_arm "$SILENT_SETS" 0 --excite --no-arm
    order no_arm.log
    saw 'v["arms"] == 0 && v["commands"] == 0' <order
}

excited() {
    [ "$(grep -c ' 042#' abort.log)" -gt 200 ]
}

# The operator's abort. The command of the tick that was open may follow it; the next tick is
# answered with one command of zero for each half of the thrusters, and no other is answered.
aborted() {
    : >abort.log
    (within 60 excited && cansend vcan0 040#AC10000000000000) &
    whole_run abort "$SILENT_SETS" 0 --excite
    order abort.log
    saw 'v["aborts"] == 1 && v["under_way"] <= 2 && v["ticks"] > 1000' <order
    saw 'v["arms"] > 0 && v["early"] == 0 && v["moving"] > 300' <order
    saw 'v["last"] == 2 && v["last_a"] == 1 && v["last_b"] == 1 && v["late"] == 0' <order
}

check "node and vehicle in lock step identify; candump lost no frame" lock_step
check "cantools beside them decodes every frame, and the node's estimates" cantools_decodes
check "bit for bit as over the bus in memory" memory_alike
check "candump's log replays bit for bit" replay
check "a whole passive run: no thruster command" passive
check "a whole run that nobody arms: no thruster command" no_arm
check "a whole run with an abort: none before arm, one of zero after the abort" aborted
exit "$failed"
