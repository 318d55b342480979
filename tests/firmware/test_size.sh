#!/usr/bin/env bash
# Flash, RAM and stack of the firmware have not grown by more than 2 % without a commit that gives
# the reason (make size SIZE=write).
set -euo pipefail
cd "$(dirname "$0")/../.."
figures=build/firmware/size.csv
# shellcheck disable=SC2046
if tests/firmware/size.py $(port/cortex_m/board.sh list) >"$figures" &&
    out=$(tests/firmware/baseline.py tests/firmware/size.csv "$figures"); then
    echo "ok $out"
else
    echo "${out:-}"
    echo "not ok flash, RAM or stack have grown, or the stack has no bound"
fi
