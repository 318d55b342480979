#!/usr/bin/env bash
# Do the statuses that the headers list and those that the unit tests have just seen agree? See
# statuses.py. Runs after the unit tests.
set -euo pipefail
cd "$(dirname "$0")/../.."

files=()
for test in tests/unit/*/test_*.c tests/vehicles/test_*.c; do
    way=release
    [[ $test != tests/vehicles/* ]] || way=wide
    files+=("build/$way/${test%.c}.statuses")
done
tests/statuses/statuses.py check "${files[@]}"

# Can it fail?
found=$(echo 'auvid_metric_drop -12 1' | tests/statuses/statuses.py check /dev/stdin)
[ "$(grep -c '^not ok' <<<"$found")" = 2 ] &&
    grep -q '^# undocumented: auvid_metric_drop returns AUVID_ERR_NO_DATA$' <<<"$found" &&
    grep -q '^# unasserted: auvid_metric_drop AUVID_OK (never returned)$' <<<"$found" &&
    echo "ok a status too many and one too few are found" ||
    echo "not ok a status too many and one too few are found"
