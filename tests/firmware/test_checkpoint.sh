#!/usr/bin/env bash
# The bytes of a checkpoint do not depend on the core, its pointers or its compiler's enums.
set -euo pipefail
cd "$(dirname "$0")/../.."
program=build/release/tests/unit/checkpoint/test_checkpoint
[ -x $program ] || make -s $program >/dev/null
host=$($program | grep checksum)
for built in m4f-O2 m0plus-Os; do
    board=${built%-*} image=build/firmware/$built/tests/unit/checkpoint/test_checkpoint.elf
    # The first test prints it; the others run there in the long form (test_unit.sh).
    exec 3< <(exec timeout 1200 port/cortex_m/board.sh "$board" run "$image" 2>&1)
    emulator=$!
    there=$(grep -m 1 checksum <&3) || true
    kill "$emulator" 2>/dev/null || true
    exec 3<&-
    if [ "$there" = "$host" ]; then
        echo "ok - $board: $there, as on the host"
    else
        echo "not ok - $board: '$there', on the host '$host'"
    fi
done
