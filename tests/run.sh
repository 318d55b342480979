#!/usr/bin/env bash
# Run test programs, one more at once than there are cores, and add up what they report.
#
# usage: tests/run.sh PROGRAM... [-- PROGRAM...]
# What stands after "--" runs when the others have ended.
# A PROGRAM is a Unity program ("12 Tests 0 Failures 1 Ignored") or a script that prints "ok ...",
# "not ok ..." or "ok ... # SKIP why" lines. What was not built, crashes, hangs or reports no test
# counts as one failure. The last line is "N passed, N failed" (", N skipped" when there are any).
# Exit status 0 when nothing failed; with CI=true nothing may be skipped either.
# With AUVID_TEST_LONG=1 tests have their long form, campaigns of many runs. In double and under the
# sanitizers these would take hours and show the same: there only what forges input has it.
#   TEST_LIMIT=1200               seconds until a program is stopped
#   TEST_LOGS=build/test-logs     what each program prints
#   TEST_RESUME=1                 go on with an earlier run that was stopped: what passed there
#                                 and is not newer than its result is counted, and not run again
set -euo pipefail
cd "$(dirname "$0")/.."

export LOGS=${TEST_LOGS:-build/test-logs} AUVID=build/auvid
# Seconds until a program counts as hung: no limit on speed. Idle, with two cores, the slowest takes
# less than a fifth of it; so it holds on a machine that is five times slower, or as busy.
export LIMIT=${TEST_LIMIT:-1200}
[ -z "${AUVID_TEST_LONG:-}" ] || LIMIT=14400
[ -n "${TEST_RESUME:-}" ] || rm -rf "$LOGS"
mkdir -p "$LOGS"

# Tests start Python hundreds of times, for its standard library only. Where a script chooses its
# version (pyenv) and packages are installed, that takes several times as long as what it is for.
bin=$PWD/build/bin
if command -v python3 >/dev/null && [ "$(command -v python3)" != "$bin/python3" ]; then
    mkdir -p "$bin"
    printf '#!/bin/sh\nexec "%s" -S "$@"\n' "$(python3 -c 'import sys; print(sys.executable)')" \
        >"$bin/python3"
    chmod +x "$bin/python3"
    export PATH=$bin:$PATH
fi

# What keeps time with a clock sleeps between, and goes first when it wakes. All others have the
# usual priority where that is possible: what else keeps the machine busy must not starve them.
FIRST='nice -n -10' OTHERS=''
[ "$(nice -n -10 nice 2>/dev/null)" = -10 ] || FIRST='' OTHERS=nice
export FIRST OTHERS

# Runs one program; leaves its output and "passed failed skipped" in $LOGS; prints one line.
run_one() {
    local name=${1#build/} log status=0 start=$SECONDS passed failed skipped nice=$OTHERS
    [[ $name != tests/vcan/* && $name != */test_realtime.sh ]] || nice=$FIRST
    log=$LOGS/${name//\//-}
    if [ -e "$log.count" ] && [ "$(cut -d ' ' -f 2 "$log.count")" = 0 ] &&
        [ ! "$1" -nt "$log.count" ]; then
        return
    fi
    rm -f "$log.count"
    if [[ $name =~ ^(wide_)?(double|sanitized)/ && ! $name =~ hostile|forged ]]; then
        unset AUVID_TEST_LONG
    fi
    if [ -x "$1" ]; then
        # shellcheck disable=SC2086 # words, or none
        $nice timeout --kill-after=5 "$LIMIT" "$1" >"$log.log" 2>&1 </dev/null || status=$?
    else
        status=127
        echo "did not build, or is not executable" >"$log.log"
    fi
    read -r passed failed skipped < <(awk '
        /^[0-9]+ Tests [0-9]+ Failures [0-9]+ Ignored/ { p += $1 - $3 - $5; f += $3; s += $5 }
        /^ok / { if (/# SKIP/) s++; else p++ }
        /^not ok / { f++ }
        END { print p + 0, f + 0, s + 0 }' "$log.log")
    if [ "$failed" = 0 ] && { [ "$status" != 0 ] || [ $((passed + skipped)) = 0 ]; }; then
        echo "$name: exit status $status after $passed passed, $skipped skipped" >>"$log.log"
        failed=1
    fi
    echo "$passed $failed $skipped" >"$log.count"
    if [ "$failed" = 0 ]; then
        echo "ok    $name ($passed passed, $skipped skipped, $((SECONDS - start)) s)"
    else
        echo "FAIL  $name (see $log.log)"
    fi
}
export -f run_one

run_all() {
    [ $# = 0 ] || printf '%s\0' "$@" | xargs -0 -n 1 -P $(($(nproc) + 1)) bash -c 'run_one "$1"' run
}
first=()
while [ $# != 0 ] && [ "$1" != -- ]; do
    first+=("$1")
    shift
done
run_all "${first[@]}"
run_all "${@:2}"

# Show the reasons together at the end, where they are read.
for count in "$LOGS"/*.count; do
    if [ -e "$count" ] && [ "$(cut -d ' ' -f 2 "$count")" != 0 ]; then
        echo "---- ${count%.count}.log"
        grep -E ':FAIL|^not ok|ERROR: |runtime error|exit status|did not build' \
            "${count%.count}.log" | head -n 20 || tail -n 20 "${count%.count}.log"
    fi
done
read -r passed failed skipped < <(cat "$LOGS"/*.count 2>/dev/null |
    awk '{ p += $1; f += $2; s += $3 } END { print p + 0, f + 0, s + 0 }')
summary="$passed passed, $failed failed"
[ "$skipped" = 0 ] || summary+=", $skipped skipped"
echo "$summary" | tee "$LOGS/summary"
[ "$failed" = 0 ] && [ "$passed" != 0 ] && { [ "$skipped" = 0 ] || [ "${CI:-}" != true ]; }
