#!/usr/bin/env bash
# The unit tests on an emulated microcontroller; long form: also on one without hardware floating
# point, of which test_same_bits.sh compares a whole dive. unit.txt lists those that do not run
# there, and why.
set -euo pipefail
cd "$(dirname "$0")/../.."

boards=m4f-O2
[ -z "${AUVID_TEST_LONG:-}" ] || boards+=' m0plus-Os'
for built in $boards; do
    board=${built%-*}
    left_out='host|long'
    # Without hardware floating point these take hours.
    [ -z "${AUVID_TEST_LONG:-}" ] || [ "$board" = m0plus ] || left_out=host
    for test in tests/unit/*/test_*.c; do
        name=$(basename "$test" .c)
        why=$(awk -v name="$name" '$1 == name { $1 = ""; print }' tests/firmware/unit.txt)
        if [[ $why =~ ^\ ($left_out) ]]; then
            echo "not here: $board $name:$why"
            continue
        fi
        image=build/firmware/$built/${test%.c}.elf
        echo "$board $name"
        # Unity prints the failures and the number of tests.
        status=0
        out=$(timeout 3600 port/cortex_m/board.sh "$board" run "$image" 2>&1) || status=$?
        echo "$out"
        [ "$status" = 0 ] || grep -q '^[0-9]* Tests [1-9]' <<<"$out" ||
            echo "not ok $board $name: exit status $status"
    done
done
