#!/usr/bin/env bash
# The end of an excitation on a bus: the node always sends a command of zero to both halves of the
# thrusters. After a stall, of itself or of the vehicle, it commands nothing more.
AUVID=$(realpath "${AUVID:-build/auvid}")
export VCAN_TIMEOUT=300
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

# end_with_zero NAME: ends the vehicle and checks that the last command was zero in both halves.
end_with_zero() {
    kill -TERM "$vehicle" || true # it ends by itself when the node is silent
    wait "$vehicle"
    all_seen "$1.log"
    grep -E ' 04[23]#' "$1.log" | tail -n 2 | tee last
    [ "$(grep -Ec ' 04[23]#..0.0{12}$' last)" = 2 ]
}

stopped() {
    witness stopped.log
    start node node --bus vcan0 --excite
    start vehicle vehicle --bus vcan0
    within 20 grep -q ' 042#' stopped.log
    sleep 1
    kill -INT "$node"
    wait "$node" || true
    end_with_zero stopped
}

# Its log is a pipe whose reader ends.
unread() {
    local status=0
    witness unread.log
    mkfifo pipe
    head -n 2500 pipe >read.log &
    sleep 0.5 # it is open
    start node node --bus vcan0 --excite --log pipe
    start vehicle vehicle --bus vcan0
    wait "$node" || status=$?
    cat node.err
    [ "$status" = 2 ] && [ "$(wc -l <node.err)" = 1 ] && grep -q 'Broken pipe' node.err
    [ "$(grep -c ' 042#' unread.log)" -gt 20 ]
    end_with_zero unread
}

# They detect each other as soon as their fade-in differs.
two_nodes() {
    witness two.log
    start node node --bus vcan0 --excite --seed 1
    start second node --bus vcan0 --excite --seed 2
    start vehicle vehicle --bus vcan0
    within 20 grep -q ' 042#' two.log
    sleep 1
    kill -INT "$node" "$second"
    wait "$node" || true
    wait "$second" || true
    grep 'another node commands the thrusters' node.out
    grep 'another node commands the thrusters' second.out
    end_with_zero two
    [ "$(grep -c ' 042#' two.log)" -lt 40 ]
}

# pause NAME WHICH COMMAND...: a node that excites, or the vehicle, is paused for a second; during
# that time the command. From the frame 7FF at its end on there is no thrust; $WHICH.err says why.
pause() {
    local name=$1 which=$2
    shift 2
    witness "$name.log"
    start vehicle vehicle --bus vcan0
    within 20 grep -q ' 042#..[^0]' "$name.log"
    kill -STOP "${!which}"
    sleep 0.3
    "$@"
    sleep 0.7
    cansend vcan0 7FF#
    kill -CONT "${!which}"
    sleep 1.5
    kill -INT "$node"
    wait "$node" || true
    cat node.err
    end_with_zero "$name"
    ! sed '1,/ 7FF#/d' "$name.log" | grep -E ' 04[23]#' | grep -Evq '#..0.0{12}$'
}

# Its ticks wait in the queue, 20 ms apart.
node_stalls() {
    start node node --bus vcan0 --excite
    pause stalled node true
    grep 'a tick waited too long: excitation aborted' node.err
    grep 'aborted .*tick' node.out
}

# Ahead of the abort there are ticks.
abort_waits() {
    start node node --bus vcan0 --excite
    pause waiting node cansend vcan0 040#AC10000000000000
}

# The buffer of a program without privileges is full when the abort comes: it is lost.
abort_is_lost() {
    setpriv --reuid 65534 --regid 65534 --clear-groups --bounding-set=-all \
        "$AUVID" node --bus vcan0 --excite >node.out 2>node.err &
    node=$!
    pause lost node flood
}
flood() {
    cangen vcan0 -g 0 -I 700 -L 8 -n 600
    cansend vcan0 040#AC10000000000000
}

vehicle_stalls() {
    start node node --bus vcan0 --excite
    pause silent vehicle true
    grep 'no tick comes: excitation aborted' node.err
}

check "a node that is stopped sends zero" stopped
check "a node that was paused does not go on" node_stalls
check "nor does it while an abort waits" abort_waits
check "nor where an abort was lost" abort_is_lost
check "without ticks a node sends zero, and does not go on with them" vehicle_stalls
check "a node that can no longer write its log sends zero to both halves" unread
check "two nodes that excite on one bus abort and end with zero" two_nodes
exit "$failed"
