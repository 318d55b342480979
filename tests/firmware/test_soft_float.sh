#!/usr/bin/env bash
# The numbers of port/cortex_m/optional/soft_float.c are those of the host's processor, bit for bit.
# test_same_bits.sh runs the example with it.
set -euo pipefail
cd "$(dirname "$0")/../.."
pairs=20000000
[ -z "${AUVID_TEST_LONG:-}" ] || pairs=1000000000
program=$(mktemp)
trap 'rm -f "$program"' EXIT
gcc -std=c11 -O2 -ffp-contract=off -o "$program" tests/firmware/soft_float.c \
    port/cortex_m/optional/soft_float.c
if out=$("$program" "$pairs"); then
    echo "ok soft_float.c: $out"
else
    echo "not ok soft_float.c: $out"
fi
