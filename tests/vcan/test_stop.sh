#!/usr/bin/env bash
# The end of a node that excites, on a bus: it always sends a command of zero to both halves of the
# thrusters.
AUVID=$(realpath "${AUVID:-build/auvid}")
export VCAN_TIMEOUT=230
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

check "a node that is stopped sends zero" stopped
check "a node that can no longer write its log sends zero to both halves" unread
check "two nodes that excite on one bus abort and end with zero" two_nodes
exit "$failed"
