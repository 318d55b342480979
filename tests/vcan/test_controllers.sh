#!/usr/bin/env bash
# Two emulated controllers (SJA1000) on one bus at 500 kbit/s, both directions at once.
export VCAN_CONTROLLERS=2
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

# Each receiver also hears what the other program sends on its own controller: 500 and 500.
both_ways() {
    local other
    "$PEER" receive can0 >other_received &
    other=$!
    listen can1
    until grep -q ready other_received; do sleep 0.02; done
    "$PEER" send can1 500 2000 &
    "$PEER" send can0 500 2000
    wait $!
    hear 'v["numbered"] == 1000' 'v["different"] == 500' 'v["ordered"]' \
        'v["dropped"] + v["malformed"] == 0'
    kill -TERM "$other"
    wait "$other"
    saw 'v["numbered"] == 1000 && v["different"] == 500 && v["dropped"] == 0' <other_received
}

for controller in can0 can1; do
    check "$controller comes up at 500 kbit/s" \
        ip link set "$controller" up type can bitrate 500000 restart-ms 100
done
check "500 frames each way, in order, none lost" both_ways
finish
