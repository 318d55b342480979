#!/usr/bin/env bash
# Node and simulated vehicle by the clock, 50 Hz, over the bus in memory: no tick is missed, but for
# the time in which a hypervisor gave this machine's processors to another (steal in /proc/stat).
# Long form: ten minutes. Short form: three seconds; what else runs may then make it miss a tick.
. "$(dirname "$0")/common.sh"

if [ "$(uname -s)" != Linux ]; then
    echo "ok - skipped: the tick needs Linux"
    finish
fi

# interrupted STATUS SECONDS ARGUMENTS...: as exits, with SIGINT after so many seconds.
interrupted() {
    local wanted=$1 after=$2 status=0
    shift 2
    timeout --preserve-status -s INT "$after" "$AUVID" "$@" >out 2>err </dev/null || status=$?
    cat err
    [ "$status" = "$wanted" ]
}

# ticked LOW HIGH: so many ticks are told of, and how long their work took.
ticked() {
    sed -nE 's/.*p50 [0-9]+, p99 [0-9]+, max [0-9]+ us; of ([0-9]+) ticks in .* s, missed .*/\1/p' \
        out >ticks
    [ "$(cat ticks)" -ge "$1" ] && [ "$(cat ticks)" -le "$2" ]
}

# Time stolen since boot, all processors together [ms].
stolen() {
    awk -v hz="$(getconf CLK_TCK)" '$1 == "cpu" { print int(1000 * $9 / hz) }' /proc/stat
}

# kept STOLEN: a tick is missed for each 20 ms stolen, at most.
kept() {
    [ $((20 * $(sed -n 's/.*, missed \([0-9]*\)$/\1/p' out))) -le "$1" ]
}

if [ -z "${AUVID_TEST_LONG:-}" ]; then
    check "three seconds, then SIGINT: nothing identified yet" \
        interrupted 1 3 node --bus memory --realtime
    check "50 ticks a second" ticked 140 155
else
    # 20 sets of 30 s, and the last search
    before=$(stolen)
    check "ten minutes at 50 Hz identify the vehicle" \
        exits 0 node --bus memory --excite --sets 20 --realtime
    check "50 ticks a second" ticked 30000 31500
    stolen=$(($(stolen) - before))
    check "none is missed but for the $stolen ms stolen" kept "$stolen"
    check "none takes half of its 20 ms" test "$(grep -o 'max [0-9]*' out | cut -c 5-)" -lt 10000
fi
cat err
grep '^  tick ' out
finish
