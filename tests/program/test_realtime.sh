#!/usr/bin/env bash
# Node and simulated vehicle in real time, 50 Hz, over the bus in memory: no tick is missed, except
# while a hypervisor gave the processors of this machine to another one (steal in /proc/stat).
# Long form: ten minutes. Short form: three seconds, in which other programs may cause missed ticks.
. "$(dirname "$0")/common.sh"

if [ "$(uname -s)" != Linux ]; then
    echo "ok - skipped: the tick needs Linux"
    finish
fi

# interrupted STATUS SECONDS ARGUMENTS...: as exits, with SIGINT so many seconds after the first
# logged tick. `began`: ticks in the log, time before and after counting them; `ended`: time before
# and after the end.
interrupted() {
    local wanted=$1 after=$2 status=0 node before
    shift 2
    "$AUVID" "$@" --log log >out 2>err </dev/null &
    node=$!
    until grep -q ' 041#' log 2>/dev/null; do
        kill -0 "$node" || return 1
        sleep 0.05
    done
    before=$EPOCHREALTIME
    echo "$(grep -c ' 041#' log) $before $EPOCHREALTIME" >began
    sleep "$after"
    before=$EPOCHREALTIME
    kill -INT "$node"
    wait "$node" || status=$?
    echo "$before $EPOCHREALTIME" >ended
    cat err
    [ "$status" = "$wanted" ]
}

# on_time: 50 ticks a second since `began`, however busy the machine is; missed ticks are not in the
# log and count.
on_time() {
    sed -nE 's/.* of ([0-9]+) ticks in .* s, missed ([0-9]+)$/\1 \2/p' out | cat - began ended |
        tee /dev/stderr | awk 'NR == 1 { ticks = $1; missed = $2 }
            NR == 2 { ticks -= $1; early = $2; late = $3 }
            NR == 3 { exit !(ticks > 100 && ticks >= 50 * ($1 - late) - 2 &&
                             ticks <= 50 * ($2 - early) + 2 + missed) }'
}

# ticked LOW HIGH: so many ticks are reported, with the execution times.
ticked() {
    sed -nE 's/.*p50 [0-9]+, p99 [0-9]+, max [0-9]+ us; of ([0-9]+) ticks in .* s, missed .*/\1/p' \
        out >ticks
    [ "$(cat ticks)" -ge "$1" ] && [ "$(cat ticks)" -le "$2" ]
}

# Time stolen since boot, sum over the processors [ms].
stolen() {
    awk -v hz="$(getconf CLK_TCK)" '$1 == "cpu" { print int(1000 * $9 / hz) }' /proc/stat
}

# kept STOLEN: at most one tick is missed per 20 ms stolen.
kept() {
    [ $((20 * $(sed -n 's/.*, missed \([0-9]*\)$/\1/p' out))) -le "$1" ]
}

if [ -z "${AUVID_TEST_LONG:-}" ]; then
    check "three seconds, then SIGINT: nothing identified yet" \
        interrupted 1 3 node --bus memory --realtime
    check "50 ticks a second" on_time
else
    # 20 sets of 30 s, and the last search
    before=$(stolen)
    check "ten minutes at 50 Hz identify the vehicle" \
        exits 0 node --bus memory --excite --sets 20 --realtime
    check "50 ticks a second" ticked 30000 31500
    stolen=$(($(stolen) - before))
    check "none is missed except in the $stolen ms stolen" kept "$stolen"
    check "none takes half of its 20 ms" test "$(grep -o 'max [0-9]*' out | cut -c 5-)" -lt 10000
fi
cat err
grep '^  tick ' out
finish
