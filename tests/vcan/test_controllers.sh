#!/usr/bin/env bash
# Two emulated controllers (SJA1000) on one bus at 500 kbit/s, both directions at once.
AUVID=$(realpath "${AUVID:-build/auvid}")
export VCAN_CONTROLLERS=2
[ -z "${AUVID_TEST_LONG:-}" ] || export VCAN_TIMEOUT=3000
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"

# Each receiver also receives the frames of the other program on its own controller: 500 and 500.
both_ways() {
    local other
    "$PEER" receive can0 >other_received &
    other=$!
    listen can1
    until grep -q ready other_received; do sleep 0.02; done
    "$PEER" send can1 500 2000 &
    "$PEER" send can0 500 2000
    wait $!
    check_received 'v["numbered"] == 1000' 'v["different"] == 500' 'v["ordered"]' \
        'v["dropped"] + v["malformed"] == 0'
    kill -TERM "$other"
    wait "$other"
    holds 'v["numbered"] == 1000 && v["different"] == 500 && v["dropped"] == 0' <other_received
}

bit_rate() {
    ip -details link show can0 | sed -n 's/.* bitrate \([0-9]*\) .*/\1/p'
}

# load LOG: bus load in percent, over the run and in its busiest second. A second is 50 tick frames.
# A frame of n bytes has 47 + 8 n bits including the pause after it. It is assumed to have the
# maximum of (33 + 8 n) / 4 stuff bits.
load() {
    awk -v bit_rate="$(bit_rate)" '
        {
            n = (length($3) - 4) / 2
            bits = 47 + 8 * n + int((33 + 8 * n) / 4)
            all += bits
            second += bits
        }
        $3 ~ /^041#/ && ++ticks % 50 == 0 {
            busiest = second > busiest ? second : busiest
            second = 0
        }
        END {
            printf "frames=%d seconds=%.1f load=%.2f busiest=%.2f\n", NR, ticks / 50,
                100 * all / (ticks / 50 * bit_rate), 100 * busiest / bit_rate
        }' "$1"
}

sent() {
    echo "$(($(passed_by can0) + $(passed_by can1)))"
}

# Each log has the frames of both.
complete() {
    [ "$(cat can0.log can1.log | wc -l)" = "$((2 * ($(sent) - before)))" ]
}

# At 50 Hz in real time, the node on can0, the vehicle on can1: all cyclic messages.
identification() {
    local dumps=() can node vehicle before
    before=$(sent)
    for can in can0 can1; do
        dump "$can" "$can.log"
        dumps+=("$candump")
    done
    within 20 listening can0 1
    within 20 listening can1 1
    timeout "$LIMIT" "$AUVID" node --bus can0 --excite >node.out &
    node=$!
    "$AUVID" vehicle --bus can1 >vehicle.out &
    vehicle=$!
    wait "$node" || [ "$LIMIT" = 25 ]
    kill -TERM "$vehicle"
    wait "$vehicle"
    within 20 complete
    kill "${dumps[@]}"
    grep -A 1 '  bus  ' node.out
    tail -n +2 vehicle.out
    grep -q ' 0 lost;' node.out
    grep -q ' 0 lost,' vehicle.out
    diff <(cut -d ' ' -f 3 can0.log | sort) <(cut -d ' ' -f 3 can1.log | sort)
    load can0.log | tee load
    holds 'v["seconds"] > 10 && v["load"] > 10 && v["busiest"] <= 20' <load
}

LIMIT=25
[ -z "${AUVID_TEST_LONG:-}" ] || LIMIT=500
for controller in can0 can1; do
    check "$controller comes up at 500 kbit/s" \
        ip link set "$controller" up type can bitrate 500000 restart-ms 100
done
check "  and reports it" [ "$(bit_rate)" = 500000 ]
check "500 frames each way, in order, none lost" both_ways
check "node and vehicle, each with a controller: none lost, bus load at most 20 %" identification
finish
