#!/usr/bin/env bash
# Flash, RAM and stack of the firmware have not grown by more than 2 % without a commit that gives
# the reason (make size SIZE=write).
set -euo pipefail
cd "$(dirname "$0")/../.."
: "${LOGS:=build/test-logs}"
figures=build/firmware/size.csv baseline=$LOGS/size.csv which=short
mkdir -p "$LOGS"
[ -z "${AUVID_TEST_LONG:-}" ] || which=list
mapfile -t boards < <(port/cortex_m/board.sh $which)
# Figures of all boards (rooms are of one that is in every list), and of these.
grep -E "^(key|sizeof|rooms|[a-z]+/(all|$(IFS='|' && echo "${boards[*]}"))/)" \
    tests/firmware/size.csv >"$baseline"
if tests/firmware/size.py "${boards[@]}" >"$figures" &&
    out=$(tests/firmware/baseline.py "$baseline" "$figures"); then
    echo "ok $out"
else
    grep -v '^if this is intended' <<<"${out:-}" || true
    echo "not ok flash, RAM or stack have grown, or the stack has no bound;" \
        "if this is intended: make size SIZE=write"
fi
