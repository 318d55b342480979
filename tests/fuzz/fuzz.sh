#!/usr/bin/env bash
# Builds each fuzzer with libFuzzer, ASan and UBSan, and runs it on its corpus.
#
# usage: fuzz.sh SECONDS FILE.c...
# The fuzzers share SECONDS. The corpus of fuzz_x.c is tests/fuzz/corpus/x, which is not modified.
# New inputs go to build/fuzz/x, and so does the input of a crash. Exit status 1 after a crash.
# FUZZ_FLAGS are passed to each fuzzer.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=$(($1 / ($# - 1)))
shift
out=build/fuzz
sanitize="-fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all"
compile="clang -std=c11 -O2 -g $sanitize ${CFLAGS:-} -Ilib/include -Ilib/src -Iport/linux_socketcan"
objects=()
mkdir -p $out/objects
for file in lib/src/*/*.c port/linux_socketcan/bus.c port/linux_socketcan/bus_candump.c; do
    objects+=("$out/objects/$(basename "$file" .c).o")
    if [ "$file" -nt "${objects[-1]}" ] || [ -n "$(find lib port -name '*.h' \
        -newer "${objects[-1]}" -print -quit)" ]; then
        $compile -fsanitize=fuzzer-no-link -c -o "${objects[-1]}" "$file"
    fi
done
for file in "$@"; do
    name=$(basename "$file" .c)
    name=${name#fuzz_}
    mkdir -p "$out/$name/found"
    $compile -fsanitize=fuzzer -MF "$out/$name/fuzz.d" -o "$out/$name/fuzz" "$file" "${objects[@]}"
    status=0
    # shellcheck disable=SC2086
    "$out/$name/fuzz" -max_total_time="$seconds" -max_len=352 -print_final_stats=1 \
        ${FUZZ_FLAGS:-} -artifact_prefix="$out/$name/" "$out/$name/found" \
        "tests/fuzz/corpus/$name" >"$out/$name/log" 2>&1 || status=$?
    awk '/number_of_executed_units|average_exec_per_sec/ { print "  '"$name"': " $0 }' \
        "$out/$name/log"
    if [ "$status" != 0 ]; then
        grep -E 'tests/fuzz|ERROR|runtime error' "$out/$name/log" | head -n 5
        echo "fuzz: $name failed; see $out/$name/log"
        exit 1
    fi
done
