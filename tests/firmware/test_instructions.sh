#!/usr/bin/env bash
# Instructions on microcontrollers: no figure of instructions.csv has grown by more than 2 % without
# a commit, and no tick takes more than the README states, with any input.
set -euo pipefail
cd "$(dirname "$0")/../.."
top=$PWD
: "${LOGS:=build/test-logs}"
work=$LOGS/instructions
mkdir -p "$work"

# Maximum instructions per tick at the default budget on a Cortex-M4F: see port/cortex_m/README.md.
most=130000

names=(m4f-O2 m4f-Os)
[ -z "${AUVID_TEST_LONG:-}" ] ||
    names=($(cut -d ' ' -f 1 tests/firmware/instructions.csv | grep -v key | sort -u))
pattern=$(IFS='|' && echo "^(key|(${names[*]}) )")
pattern=${pattern//key|/key,|}
tests/firmware/bench.sh "$work/new.csv" "${names[@]}" >"$work/table.txt"
grep -E "$pattern" tests/firmware/instructions.csv >"$work/old.csv"
if said=$(python3 tests/firmware/baseline.py "$work/old.csv" "$work/new.csv"); then
    echo "ok instructions: $said"
else
    echo "not ok instructions: $said"
fi

# Ticks of hostile frames, then of hostile samples without a node.
for level in O2 Os; do
    image=$top/build/firmware/m4f-$level/tests/unit/identifier/test_hostile_inputs.elf
    if ! (cd "$work" && "$top/tests/firmware/count.sh" m4f "$image" >said); then
        echo "not ok m4f-$level: $(tail -n 2 "$work/said")"
        continue
    fi
    read -r ticks heaviest < <(awk '$1 == "tick" { print $2, $4 }' "$work/count")
    what="m4f-$level: the heaviest of $ticks hostile ticks took $heaviest instructions"
    if [ "$ticks" -ge 10000 ] && [ "$heaviest" -le $most ]; then
        echo "ok $what, at most $most"
    else
        echo "not ok $what; wanted: ten thousand, at most $most"
    fi
done
