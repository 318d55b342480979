#!/usr/bin/env bash
# Golden vectors of the program: a CSV log through fit, and a log of the bus through replay. The
# simulated vehicles write the same logs in every run.
. "$(dirname "$0")/common.sh"

golden() {
    python3 "$ROOT/tests/golden/golden.py" "$@"
}

check "a vehicle is simulated, with a CSV log" exits 0 demo --seed 1 --disturbance 1 --csv demo.csv
check "fit identifies it" exits 0 fit demo.csv --plain --seed 1 --validate demo.csv --json
cp out fit.json
check "fit gives the numbers recorded" golden fit fit.json
check "a node identifies over the bus in memory, with a log" \
    exits 0 node --bus memory --plain --excite --seed 1 --sets 3 --log bus.log --json
check "replay reads the log" exits 0 replay bus.log --plain --seed 1 --sets 3 --json
cp out replay.json
check "replay gives the numbers recorded, the log the order of frames" \
    golden replay replay.json bus.log
finish
