#!/usr/bin/env bash
# The program without the bus or a permission prints one line with the remedy.
AUVID=$(realpath "${AUVID:-build/auvid}")
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

# refuses WORDS ARGUMENTS...: exit status 2 and one line that contains these words.
refuses() {
    local status=0 words=$1
    shift
    "$AUVID" "$@" 2>err || status=$?
    cat err
    [ "$status" = 2 ] && [ "$(wc -l <err)" = 1 ] && grep -qF -- "$words" err
}

# A raw CAN socket needs no privilege; priority and locked memory do: one line, and it continues.
unprivileged() {
    local node status=0
    setpriv --reuid 65534 --regid 65534 --clear-groups --bounding-set=-all \
        prlimit --rtprio=0 --memlock=0 "$AUVID" node --bus vcan0 --realtime >out 2>err &
    node=$!
    for _ in $(seq 500); do
        grep -q 'no tick frame' err && break
        sleep 0.1
    done
    kill -TERM "$node"
    wait "$node" || status=$?
    cat err
    [ "$status" -lt 2 ] && [ "$(wc -l <err)" = 2 ]
    grep -q "no real-time priority .* 'ulimit -r'. memory not locked .* 'ulimit -l'" err
}

check "a missing interface is reported" \
    refuses "there is no interface 'can7': 'ip link' lists them" node --bus can7
check "an interface that is not CAN is reported" \
    refuses "'lo' is not a CAN interface: 'ip link show type can'" vehicle --bus lo
check "without privileges the node runs and reports what --realtime lacks" unprivileged
finish
