#!/usr/bin/env bash
# Builds each fuzzer with libFuzzer, ASan and UBSan, and runs it on its corpus; as many at once as
# there are cores.
#
# usage: fuzz.sh SECONDS FILE.c...
# The fuzzers share SECONDS of one core. The corpus of fuzz_x.c is tests/fuzz/corpus/x, which is not
# modified. New inputs go to build/fuzz/x, and so does the input of a crash. Exit status 1 after a
# crash. FUZZ_FLAGS are passed to each fuzzer.
set -euo pipefail
cd "$(dirname "$0")/../.."
export SECONDS_EACH=$(($1 / ($# - 1)))
shift
export OUT=build/fuzz
sanitize="-fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all"
export COMPILE="clang -std=c11 -O1 -g1 $sanitize ${CFLAGS:-} -Ilib/include -Ilib/src \
-Iport/linux_socketcan -Itools/auvid -Itools/simulator"
sources=(lib/src/*/*.c port/linux_socketcan/bus.c port/linux_socketcan/bus_candump.c
    tools/auvid/base/{ini,json_string,report_error}.c
    tools/auvid/vehicle/{thrust_map,vehicle_*}.c
    tools/simulator/{simulator,sensors,noise,fossen}.c)
objects=("${sources[@]##*/}")
objects=("${objects[@]/#/$OUT/objects/}")
export OBJECTS="${objects[*]/%.c/.o}"
mkdir -p $OUT/objects

build_object() {
    local object=${1##*/}
    object=$OUT/objects/${object%.c}.o
    if [ "$1" -nt "$object" ] ||
        [ -n "$(find lib port tools -name '*.h' -newer "$object" -print -quit)" ]; then
        $COMPILE -fsanitize=fuzzer-no-link -c -o "$object" "$1"
    fi
}

fuzz() {
    local name status=0 longest=352
    name=$(basename "$1" .c)
    name=${name#fuzz_}
    [ "$name" != vehicle ] || longest=3000 # a file, not frames
    mkdir -p "$OUT/$name/found"
    # shellcheck disable=SC2086 # words
    $COMPILE -fsanitize=fuzzer -MF "$OUT/$name/fuzz.d" -o "$OUT/$name/fuzz" "$1" $OBJECTS -lm
    # shellcheck disable=SC2086
    "$OUT/$name/fuzz" -max_total_time="$SECONDS_EACH" -max_len=$longest -print_final_stats=1 \
        ${FUZZ_FLAGS:-} -artifact_prefix="$OUT/$name/" "$OUT/$name/found" \
        "tests/fuzz/corpus/$name" >"$OUT/$name/log" 2>&1 || status=$?
    awk '/number_of_executed_units|average_exec_per_sec/ { print "  '"$name"': " $0 }' \
        "$OUT/$name/log"
    if [ "$status" != 0 ]; then
        grep -E 'tests/fuzz|ERROR|runtime error' "$OUT/$name/log" | head -n 5
        echo "fuzz: $name failed; see $OUT/$name/log"
        exit 1
    fi
}

# each FUNCTION FILE...: FUNCTION for every FILE, in parallel.
each() {
    printf '%s\0' "${@:2}" |
        xargs -0 -n 1 -P "$(nproc)" bash -euo pipefail -c "$1 \"\$1\"" fuzz
}
export -f build_object fuzz
each build_object "${sources[@]}"
each fuzz "$@" || exit 1
