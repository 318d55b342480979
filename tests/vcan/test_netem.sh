#!/usr/bin/env bash
# Node and vehicle at the two ends of a vxcan pair. In both directions netem loses, duplicates,
# delays and reorders. Simulated time and netem run SPEED times as fast as the clock.
AUVID=$(realpath "${AUVID:-build/auvid}")
# Twice the error of the demo: the root mean square over runs is 2.59 % [2.40 2.78] with two sets
# (build/auvid demo --runs 200 --sets 2), 1.09 % [1.03 1.15] with eight.
SETS=2 MOST=5.18 TRIES=3
[ -z "${AUVID_TEST_LONG:-}" ] || SETS=8 MOST=2.18
export VCAN_CLOCK=instructions VCAN_TIMEOUT=1150
[ -z "${AUVID_TEST_LONG:-}" ] || VCAN_TIMEOUT=14000
# shellcheck source=tests/vcan/common.sh
. "$(dirname "$0")/common.sh"
SPEED=8

connect() {
    local end
    ip link add vx0 type vxcan peer name vx1
    for end in vx0 vx1; do
        ip link set "$end" up
        tc qdisc add dev "$end" root netem delay $((20000 / SPEED))us $((5000 / SPEED))us loss 10% \
            duplicate 5% limit 10000
        # An end's log has its sent frames before netem and its received frames after netem.
        dump "$end" "$end.log"
        within 20 listening "$end" 1
    done
}

# progress PATTERN: succeeds if a progress frame of the node (40E) matches. The state persists, so
# the end of the log is enough.
progress() {
    tail -n 1000 vx1.log | grep -q " 40E#$1"
}

# Two lost DVL samples interrupt the record, so a set takes longer than 30 s. Therefore twice as
# many sets are excited, but not awaited. After four lost ones the guard aborts, and the operator
# arms again.
one_run() {
    start node node --bus vx1 --excite --realtime --sets $((2 * SETS))
    within 20 listening vx1 2
    start vehicle vehicle --bus vx0 --realtime --speed "$SPEED" --arm-again
    until progress ".\{8\}$(printf %02X "$SETS")"; do
        kill -0 "$node"
        sleep 0.5
    done
    sleep 2 # the last search
    kill -TERM "$vehicle"
    wait "$vehicle"
    sleep 0.5
    kill -TERM "$node" 2>/dev/null || true
    wait "$node" || true
}

identified() {
    compared | awk -v most="$MOST" '
        { sum += ($2 / $4 - 1) ^ 2 }
        END { rms = 100 * sqrt(sum / NR)
            print NR " parameters, rms error " rms " %"
            exit !(NR == 13 && rms < most) }'
}

# The limit holds for the rms error over runs. A single run exceeds it in 7 % (two sets) and 9 %
# (eight) of the runs of tests/unit/can/test_lossy_bus.c; TRIES in a row do in less than 1 of 1000.
run() {
    local end
    for _ in $(seq "$TRIES"); do
        connect
        one_run
        for end in vx0 vx1; do
            tc -s qdisc show dev "$end" >"$end.netem"
            cat "/sys/class/net/$end/statistics/rx_packets" >"$end.rx"
        done
        ip link del vx0
        grep guard node.out || true
        ! identified || break
    done
    identified
    tail -n 4 node.out
    cat vehicle.out
}

# direction SENDER RECEIVER IDS: checks the effect of netem on one direction, within five standard
# deviations. A frame that is lost and duplicated passes once, and a copy may be lost like any other
# frame: 0.1 * 0.95 + 0.05 * 0.9 * 0.1 are lost, 0.05 * 0.9 duplicated. IDS are all that the sender
# sends. A copy may be merged with its frame for a socket (test_bus.sh).
direction() {
    local before behind passed dropped
    before=$(grep -Ec " ($3)#" "$1.log")
    behind=$(grep -Ec " ($3)#" "$2.log")
    passed=$(sed -n 's/.* bytes \([0-9]*\) pkt .*/\1/p' "$1.netem")
    dropped=$(sed -n 's/.*(dropped \([0-9]*\),.*/\1/p' "$1.netem")
    awk -v b="$before" -v r="$behind" -v p="$passed" -v d="$dropped" -v rx="$(cat "$2.rx")" '
        function near(n, p) { return (n - b * p) ^ 2 <= 25 * b * p }
        BEGIN { twice = p + d - b
            print b " sent, " d " lost, " twice " doubled, " r " got, " p - r " merged"
            exit !(p == rx && r <= p && p - r < 0.3 * twice && near(d, 0.0995) &&
                near(twice, 0.045)) }'
    ! grep DROPCOUNT "$2.log"
}

# Frames that the node should have refused by its rules. The counter is the fourth digit; a tick has
# its number in the next five and the third. A copy may be merged (test_bus.sh) for one socket and
# not for the other: up to ten. The vehicle has a state for every command.
counters() {
    awk -v OFS= '
        function hex(s, i, n) { n = 0; for (i = 1; i <= length(s); i++)
            n = 16 * n + index("0123456789ABCDEF", substr(s, i, 1)) - 1; return n }
        { split($3, f, "#"); id = f[1] }
        id !~ /^(04[14]|40[0-8])$/ { next }
        { c = hex(substr(f[2], 4, 1))
          good = !(id in last) || (c - last[id] + 15) % 16 < 3
          last[id] = c }
        good && id == "041" { n = hex(substr(f[2], 7, 2) substr(f[2], 5, 2) substr(f[2], 3, 1))
          if (ticks++ && (newest - n + 1048576) % 1048576 < 16) good = 0; else newest = n }
        { refused += !good }
        END { print "vx1.log: ", NR, " frames, to be refused: ", refused }' vx1.log | tee expected
    sed -n -e 's/.*: \([0-9]*\) frames received.*/received \1/p' \
        -e 's/.*refused: \([0-9]*\) .*/refused \1/p' node.out | tee reported
    awk -v arrived="$(grep -Ec ' (04[014]|40[0-8])#' vx1.log)" '
        function near(a, b) { return (a - b) ^ 2 <= 100 }
        NR == FNR { refused = $NF; next }
        /received/ { good += near($2, arrived) }
        /refused/ { good += near($2, refused) }
        END { exit good != 2 }' expected reported
    awk -v arrived="$(grep -c ' 042#' vx0.log)" '
        /commands/ { print; good = ($2 + $6 + $8 - arrived) ^ 2 <= 100 && $12 == 0 }
        END { exit !good }' vehicle.out
}

# Thrust is cut after 150 ms without a good command of each half: eight ticks. A tick delivers a
# half with probability 0.9^2. Six in a row fail with 0.19^6 = 5e-5, seven with 9e-6; and delays
# differ. So thrust is cut for a tick or two once in some minutes, and never without such a silence.
# The end is one more cut with two silences. In the log a command may be off by a tick.
interruptions() {
    awk '
        { split($3, f, "#"); id = f[1] }
        id == "041" { n++; for (k in at) if (n - at[k] == 7) gaps++ }
        id == "042" || id == "043" {
            c = index("0123456789ABCDEF", substr(f[2], 4, 1)) - 1; step = (c - last[id] + 16) % 16
            last[id] = c; if (step && step < 4) { at[id] = n; got++ } }
        END { print got " good commands; " gaps - 2 " silences of 7 ticks before the last" }
        ' vx0.log | tee silences
    awk 'NR == FNR { silences = $4; next }
        /thrust/ { cuts = $(NF - 1) - 1; print "thrust interrupted " cuts " times" }
        END { exit !(cuts <= silences) }' silences vehicle.out
}

check "it identifies with 10 % loss, 5 % duplication, 20 ms delay, reordering" run
check "vehicle to node: counters add up" direction vx0 vx1 '04[014]|40[0-8]'
check "node to vehicle: counters add up" direction vx1 vx0 '04[235]|409|40[A-F]|41[0-4]'
check "each receiver refused the frames it should refuse" counters
check "thrust is not interrupted by single losses" interruptions
finish
