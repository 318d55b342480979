#!/usr/bin/env bash
# The node and the simulated vehicle as two processes on a bus.
AUVID=$(realpath "${AUVID:-build/auvid}")
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

SETS=2 KILLS=3
[ -z "${AUVID_TEST_LONG:-}" ] || SETS=8 KILLS=50

# within SECONDS COMMAND...: waits until the command succeeds.
within() {
    local end=$((SECONDS + $1))
    shift
    until "$@"; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.05
    done
}

# start NAME ARGUMENTS...: the program in the background, its pid in $NAME.
start() {
    local name=$1
    shift
    "$AUVID" "$@" >"$name.out" 2>"$name.err" &
    printf -v "$name" '%s' $!
}

lock_step() {
    start node node --bus vcan0 --excite --lock-step --sets "$SETS" --log node.log
    within 20 grep -q 'no tick frame' node.err # it listens: not a tick is missed
    start vehicle vehicle --bus vcan0 --lock-step
    wait "$node"
    wait "$vehicle"
    cat vehicle.out
    grep -q ' 0 lost;' node.out
    # "estimate  2 sets, rms error 1.44 %"
    awk '/rms error/ { found = $6 < 3 } END { exit !found }' vehicle.out
}

memory_alike() {
    "$AUVID" node --bus memory --excite --sets "$SETS" >memory.out
    diff <(awk '$1 ~ /_/ || $1 == "W-B" { print $1, $3, $4 }' memory.out) \
        <(awk '$1 ~ /_/ || $1 == "W-B" { print $1, $3, $4 }' node.out)
}

replay() {
    "$AUVID" replay node.log --sets "$SETS" >replay.out
    tail -n 1 replay.out
    grep -q ' 0 different' replay.out
}

# Nothing from a passive node, though it is told to arm.
passive() {
    start node node --bus vcan0 --log passive.log
    start vehicle vehicle --bus vcan0
    sleep 8
    kill -TERM "$node" "$vehicle"
    wait "$node" || true
    wait "$vehicle"
    grep -q ' 044#' passive.log
    ! grep -Eq ' 04[23]#' passive.log
}

no_arm() {
    start node node --bus vcan0 --excite --log noarm.log
    start vehicle vehicle --bus vcan0 --no-arm
    sleep 4
    kill -TERM "$node" "$vehicle"
    wait "$node" || true
    ! grep -Eq ' 04[23]#' noarm.log
}

# Ends with a command of zero: the CRC and counter are bytes 0 and 1, the four thrusts the rest.
stopped() {
    start node node --bus vcan0 --excite --log stopped.log
    start vehicle vehicle --bus vcan0
    within 20 grep -q ' 042#' stopped.log
    sleep 1
    kill -INT "$node"
    wait "$node" || true
    kill -TERM "$vehicle"
    wait "$vehicle"
    grep ' 042#' stopped.log | tail -n 1
    grep ' 042#' stopped.log | tail -n 1 | grep -Eq '042#..0[0-9A-F]0{12}$'
}

# However it dies, the vehicle's thrust is zero 200 ms after the last command.
killed() {
    local k
    for k in $(seq "$KILLS"); do
        : >killed.log
        start node node --bus vcan0 --excite --log killed.log
        start vehicle vehicle --bus vcan0 --seed "$k"
        within 20 grep -q ' 042#' killed.log
        sleep "0.$((RANDOM % 900 + 100))"
        kill -KILL "$node"
        wait "$node" || true
        wait "$vehicle"
        awk -v k="$k" '/thrust +zero/ { print "run " k ": " $3 " ms"; found = $3 <= 200 }
            END { exit !found }' vehicle.out
    done
}

check "node and vehicle in lock step identify" lock_step
check "bit for bit as over the bus in memory" memory_alike
check "the log replays bit for bit" replay
check "a passive node sends no command" passive
check "an exciting one sends none before it is armed" no_arm
check "one that is stopped sends zero" stopped
check "one that is killed leaves no thrust" killed
exit "$failed"
