#!/usr/bin/env bash
# Build each fuzzer with libFuzzer, ASan and UBSan, and run it from its corpus.
#
# usage: fuzz.sh SECONDS FILE.c...
# The corpus of fuzz_x.c is tests/fuzz/corpus/x, which stays as it is; what is found on the way goes
# to build/fuzz/x. A crash leaves its input there; exit status 1.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=$1
shift
sanitize="-fsanitize=fuzzer,address,undefined,float-cast-overflow -fno-sanitize-recover=all"
for file in "$@"; do
    name=$(basename "$file" .c)
    name=${name#fuzz_}
    out=build/fuzz/$name
    mkdir -p "$out/found"
    # shellcheck disable=SC2086
    clang -std=c11 -O2 -g $sanitize ${CFLAGS:-} -MF "$out/fuzz.d" -Ilib/include -Ilib/src \
        -o "$out/fuzz" "$file" lib/src/auvid_can*.c
    status=0
    "$out/fuzz" -max_total_time="$seconds" -max_len=352 -print_final_stats=1 \
        -artifact_prefix="$out/" "$out/found" "tests/fuzz/corpus/$name" >"$out/log" 2>&1 ||
        status=$?
    awk '/number_of_executed_units|average_exec_per_sec/ { print "  '"$name"': " $0 }' "$out/log"
    if [ "$status" != 0 ]; then
        grep -E 'fuzz_can|ERROR|runtime error' "$out/log" | head -n 5
        echo "fuzz: $name failed; see $out/log"
        exit 1
    fi
done
