#!/usr/bin/env bash
# The part of test_node.sh with a bus: the node and the simulated vehicle as two processes, observed
# by can-utils. The log and the node's JSON of the first run are left in VCAN_KEPT.
AUVID=$(realpath "${AUVID:-build/auvid}")
export VCAN_TIMEOUT=1150
[ -z "${AUVID_TEST_LONG:-}" ] || VCAN_TIMEOUT=9000
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

SETS=2 SILENT_SETS=1
[ -z "${AUVID_TEST_LONG:-}" ] || SETS=8 SILENT_SETS=8

# whole_run NAME SETS NODE_OPTION [VEHICLE_OPTION]: a run in lock step, observed by candump
# (NAME.log). The vehicle starts when the node listens, so no tick is missed.
whole_run() {
    witness "$1.log"
    within 20 listening vcan0 1
    # shellcheck disable=SC2086 # nothing where there is no option
    start node node --bus vcan0 --lock-step --json --sets "$2" $3
    within 20 listening vcan0 2
    # shellcheck disable=SC2086
    start vehicle vehicle --bus vcan0 --lock-step ${4:-}
    status=0
    wait "$node" || status=$?
    kill -TERM "$vehicle"
    wait "$vehicle"
    cat node.err vehicle.out
    all_seen "$1.log"
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
    whole_run bus "$SETS" '--excite --plain'
    [ "$status" = 0 ]
    # "estimate  2 sets, rms error 1.44 %"
    awk '/rms error/ { found = $6 < 3 } END { exit !found }' vehicle.out
    grep -q ' 0 lost,' vehicle.out
    cp node.out "$VCAN_KEPT/node.json"
    cp bus.log "$VCAN_KEPT"
}

# No command from a passive node, despite an arm frame.
passive() {
    whole_run passive "$SILENT_SETS" ''
    order passive.log
    holds 'v["arms"] > 0 && v["commands"] == 0' <order
}

no_arm() {
    whole_run no_arm "$SILENT_SETS" --excite --no-arm
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
    whole_run abort "$SILENT_SETS" --excite
    order abort.log
    holds 'v["aborts"] == 1 && v["under_way"] <= 2 && v["ticks"] > 1000' <order
    holds 'v["arms"] > 0 && v["early"] == 0 && v["moving"] > 300' <order
    holds 'v["last"] == 2 && v["last_a"] == 1 && v["last_b"] == 1 && v["late"] == 0' <order
}

# The vehicle prints the sentence that the node puts into its JSON.
late() {
    local words
    whole_run late "$SILENT_SETS" --excite '--lag 0.6'
    words=$(grep -o 'thrust acts later than stamped[^"]*' node.out)
    grep -F "    $words" vehicle.out
}

check "node and vehicle in lock step identify; candump lost no frame" lock_step
check "a whole run without an arm frame has no thruster command" no_arm
check "a whole run with an abort: no command before arm, one of zero after the abort" aborted
# In the short form tests/program/test_bus.sh has these two over the bus in memory.
if [ -n "${AUVID_TEST_LONG:-}" ]; then
    check "a whole passive run has no thruster command" passive
    check "thrusters that lag are found by the node and said by the vehicle, which reads frames" \
        late
fi
exit "$failed"
