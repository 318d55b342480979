#!/usr/bin/env bash
# bus_socketcan between processes over vcan and vxcan, with can-utils as the peer.
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

# refuses WORDS INTERFACE: opening fails with one line that contains these words.
refuses() {
    local status=0
    "$PEER" receive "$2" 2>err || status=$?
    cat err
    [ "$status" = 2 ] && [ "$(wc -l <err)" = 1 ] && grep -qF -- "$1" err
}

two_processes() {
    listen vcan0
    "$PEER" send vcan0 5000 0
    check_received 'v["different"] == 5000' 'v["again"] + v["late"] + v["dropped"] == 0' \
        'v["ordered"]' 'v["oldest_us"] < 5000000'
}

down_and_up() {
    local status=0
    listen vcan0
    "$PEER" send vcan0 10 0
    ip link set vcan0 down
    "$PEER" send vcan0 10 0 2>err || status=$?
    sleep 0.1
    ip link set vcan0 up
    sleep 0.1
    "$PEER" send vcan0 10 0
    check_received 'v["received"] == 20' 'v["link_downs"] == 1' 'v["link_ups"] == 1'
    [ "$status" = 2 ] && grep -q "'vcan0' is down" err
}

unplugged() {
    ip link add vcan7 type vcan
    ip link set vcan7 up
    listen vcan7
    "$PEER" send vcan7 10 0
    ip link del vcan7
    sleep 0.1
    ip link add vcan7 type vcan
    ip link set vcan7 up
    sleep 0.1
    "$PEER" send vcan7 10 0
    check_received 'v["received"] == 20' 'v["link_downs"] == 1' 'v["link_ups"] == 1'
    ip link del vcan7
}

bus_off() {
    listen vcan0
    "$PEER" busoff vcan0
    check_received 'v["bus_offs"] == 1' 'v["restarts"] == 1' 'v["received"] == 2'
}

# asleep PID: the process is waiting.
asleep() {
    [ "$(awk '{ print $3 }' "/proc/$1/stat")" = S ]
}

# The receiver is stopped while more frames arrive than its buffer holds. One more reports the
# drops.
full_buffer() {
    listen vcan0
    kill -STOP "$listener"
    "$PEER" send vcan0 15000 0
    kill -CONT "$listener"
    within 20 asleep "$listener" # it has read all frames
    "$PEER" send vcan0 1 0
    check_received 'v["dropped"] > 1000' 'v["received"] > v["buffer"] / 1000' \
        'v["received"] + v["dropped"] == 15001'
}

# 3000 frames; the rates within five standard deviations (82, 57). netem may lose a duplicate, too.
# Of two adjacent copies the kernel may deliver only one: it takes them for one frame that passed
# two filters.
disturbed() {
    local left lost merged
    ip link add vx0 type vxcan peer name vx1
    ip link set vx0 up
    ip link set vx1 up
    tc qdisc add dev vx0 root netem delay 20ms 5ms loss 10% duplicate 5% limit 10000
    listen vx1
    "$PEER" send vx0 3000 500
    check_received 'v["numbered"] == v["different"] + v["again"]' \
        'v["malformed"] + v["dropped"] == 0' \
        'v["late"] > 30' 'v["ordered"]'
    tc -s qdisc show dev vx0 | tee netem
    left=$(sed -n 's/.* bytes \([0-9]*\) pkt .*/\1/p' netem)
    lost=$(sed -n 's/.*(dropped \([0-9]*\),.*/\1/p' netem)
    merged=$((left - $(word received received)))
    echo "netem let $left pass and dropped $lost; $merged were merged"
    [ "$(cat /sys/class/net/vx1/statistics/rx_packets)" = "$left" ]
    [ "$merged" -ge 0 ]
    holds "$merged <= 0.3 * v[\"again\"]" <received
    holds "3000 - v[\"different\"] <= $lost" <received
    holds 'v["different"] >= 2700 - 82 && v["different"] <= 2700 + 82' <received
    holds "v[\"again\"] + $merged >= 135 - 57 && v[\"again\"] + $merged <= 135 + 57" <received
    ip link del vx0
}

candump_log() {
    local recorder
    candump -L vcan0 >theirs.log &
    recorder=$!
    within 20 listening vcan0 1
    listen vcan0 ours.log
    "$PEER" send vcan0 500 100
    cangen vcan0 -e -g 1 -n 300
    cangen vcan0 -g 1 -n 300 -R
    check_received 'v["received"] == 1100'
    kill "$recorder"
    wait "$recorder" || true
    "$PEER" read theirs.log >theirs
    "$PEER" read ours.log >ours
    cat theirs ours
    [ "$(word received theirs)" = 1100 ]
    [ "$(word checksum theirs)" = "$(word checksum received)" ]
    [ "$(word checksum ours)" = "$(word checksum received)" ]
}

played_log() {
    listen vcan0
    canplayer -t -I ours.log vcan0=vcan0
    check_received 'v["received"] == 1100'
    [ "$(word checksum ours)" = "$(word checksum received)" ]
}

flood() {
    local before
    before=$(passed_by vcan0)
    listen vcan0
    timeout 2 cangen vcan0 -g 0 -i -e || true
    sleep 1
    check_received 'v["received"] > 2000' 'v["malformed"] == 0' 'v["ordered"]' \
        "v[\"received\"] + v[\"dropped\"] == $(passed_by vcan0) - $before"
}

# Only in the virtual machine: it sets the clock. Two steps between two frames count as one, so
# there are frames before, between and after the steps, however slow the machine is.
clock_step() {
    listen vcan0
    "$PEER" send vcan0 200 5000 &
    "$PEER" send vcan0 20 5000
    date -s "@$(($(date +%s) + 7200))"
    "$PEER" send vcan0 20 5000
    date -s "@$(($(date +%s) - 7300))"
    "$PEER" send vcan0 20 5000
    wait $!
    check_received 'v["different"] == 200' 'v["numbered"] == 260' 'v["clock_steps"] == 2' \
        'v["ordered"]' 'v["oldest_us"] < 5000000'
}

check "a missing interface is reported" refuses "there is no interface 'can7'" can7
check "an interface that is not CAN is reported" refuses "'lo' is not a CAN interface" lo
check "two processes exchange 5000 frames in order, with monotone timestamps" two_processes
check "the same socket works after the interface was down" down_and_up
check "an interface that vanished and came back is used again" unplugged
check "an injected bus-off and the restart are reported" bus_off
check "a full receive buffer: received and dropped add up" full_buffer
check "10 % loss, 5 % duplication, 20 ms delay, reordering: counters add up" disturbed
check "logs of candump and of auvid are read back alike" candump_log
check "canplayer plays a log of auvid" played_log
check "a flood of random frames is received or counted" flood
[ "$VCAN_INSIDE" = namespace ] ||
    check "timestamps survive a wall clock set forward and back" clock_step
finish
