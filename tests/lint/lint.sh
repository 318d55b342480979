#!/usr/bin/env bash
# The rules of the house, all of them: run by `make lint`. Exit status 0 when none is broken.
#
# Every step runs even when an earlier one failed, so that one run shows everything; but the first
# configuration that does not compile ends its own step, for the others would say the same.
set -euo pipefail
cd "$(dirname "$0")/../.."
tests/support/setup.sh lint

export OUT=build/lint
rm -rf "$OUT"
mkdir -p "$OUT"

export STRICT="-std=c11 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion \
-Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla -Walloca \
-Wfloat-equal -Wcast-qual -Wundef -Wswitch-enum -Werror -Ilib/include"
TOOLS="-std=c11 -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow \
-Wfloat-equal -Wcast-qual -Wundef -Wswitch-enum -Werror \
-Ilib/include -Ilib/src -Itools/simulator -Iport/linux_socketcan -Iport/cortex_m"
shopt -s nullglob
lib=(lib/src/*/*.c)
tools=(tools/*/*.c tools/auvid/*/*.c port/linux_socketcan/*.c port/cortex_m/example/*.c
    port/cortex_m/passive/*.c port/cortex_m/optional/*.c)
broken=0

# step NAME COMMAND...: run a check, say how it went.
step() {
    local name=$1
    shift
    if "$@"; then
        echo "lint: ok    $name"
    else
        echo "lint: FAIL  $name"
        broken=1
    fi
}

# each COMMAND FILE...: COMMAND for every FILE, in parallel; {} is the file's name.
each() {
    local command=$1
    shift
    [ $# = 0 ] || printf '%s\0' "$@" | xargs -0 -P "$(nproc)" -I {} bash -c "$command"
}

# The smallest and the largest sizes, read from the ranges that config.h itself enforces; the
# smallest have no commands, and so no memory for the residual path.
write_sizes() {
    awk -v column="$1" '$1 == "#if" && $2 ~ /^AUVID_MAX_/ && $3 == "<" {
        print "#define", $2, (column == "min" ? $4 : $8) }' lib/include/auvid/config.h
}

# compile COMPILER FLAGS DIRECTORY: the library into $OUT/DIRECTORY.
compile() {
    mkdir -p "$OUT/$3"
    each "$1 $STRICT $2 -c -o $OUT/$3/\$(basename {} .c).o {}" "${lib[@]}"
}

# Position-independent code would put constant tables of pointers into .data.
PLAIN="-fno-pic -fno-stack-protector -U_FORTIFY_SOURCE"

# Some of gcc's warnings need the optimizer; clang's do not. Code depends on the sizes or on the
# precision, hardly on both: the smallest sizes are in float, the largest in double.
check_matrix() {
    local size real flags
    for size in min max; do
        write_sizes "$size" >"$OUT/sizes_$size.h"
        [ -s "$OUT/sizes_$size.h" ] || return 1
    done
    : >"$OUT/sizes_default.h"
    while read -r size real; do
        flags="-DAUVID_REAL_$real -I$OUT -DAUVID_USER_CONFIG='\"sizes_$size.h\"'"
        compile gcc "$PLAIN -O2 $flags" "gcc-$real-$size" || return 1
        [ "$size $real" = "default FLOAT" ] || # check_objects compiles this with clang
            each "clang $STRICT $flags -fsyntax-only {}" "${lib[@]}" || return 1
    done <<<$'default FLOAT\nmin FLOAT\nmax DOUBLE'
}

# Of gcc's objects those that check_matrix leaves. The call graph is taken without optimisation:
# inlining and tail calls hide recursion.
check_objects() {
    compile clang "$PLAIN -O2" objects-clang || return 1
    compile gcc "$PLAIN -O0 -fcallgraph-info" objects-graph || return 1
    each "tests/lint/objects.py {}/*.o" "--float $OUT/gcc-FLOAT-default" \
        "--float $OUT/objects-clang" "$OUT/gcc-DOUBLE-max" "--float $OUT/objects-graph"
}

check_headers() {
    local flags="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -I. -Ilib/include"
    local status=0 compiler language real
    for compiler in gcc clang; do
        for language in "-std=c11 -xc" "-std=c++14 -xc++"; do
            for real in FLOAT DOUBLE; do
                each "printf '#include \"{}\"\nextern int alone;\n' |
                    $compiler -fsyntax-only $flags -DAUVID_REAL_$real $language -" \
                    lib/include/auvid/*.h lib/include/auvid/detail/*.h || status=1
            done
        done
    done
    return "$status"
}

check_unity() {
    tests/lint/unity.sh "${lib[@]}"
}

check_tools() {
    each "gcc $TOOLS -O2 -fsyntax-only {}" "${tools[@]}" &&
        each "clang $TOOLS -fsyntax-only {}" "${tools[@]}"
}

# The analyzer looks at fewer states of each function than its default, 225000, and finds nearly as
# much: of 21 null pointers planted on one path of a function 13, 15 with 50000 or the default.
check_tidy() {
    local nodes=25000
    [ -z "${AUVID_TEST_LONG:-}" ] || nodes=225000
    each "clang-tidy --quiet {} -- -std=c11 -Ilib/include -Ilib/src -Itools/simulator \
        -Iport/linux_socketcan -Iport/cortex_m -Xclang -analyzer-config -Xclang max-nodes=$nodes \
        2>&1 | grep -Ev '^[0-9]+ warnings? (generated|treated)|^Suppressed|^Use -header-filter'; \
        exit \${PIPESTATUS[0]}" "${lib[@]}" "${tools[@]}"
}

# One configuration, with the sizes of the program: the defaults leave out some code. All that
# cppcheck can think of take four times as long.
check_cppcheck() {
    cppcheck --quiet --std=c11 --enable=warning,portability,performance --error-exitcode=1 \
        --inline-suppr --suppress=missingIncludeSystem -j "$(nproc)" -UAUVID_USER_CONFIG \
        -DAUVID_MAX_PARAMETERS=32 -DAUVID_REAL_FLOAT -D__GNUC__=12 -D__linux__ \
        -Ilib/include -Ilib/src -Itools/simulator -Iport/linux_socketcan -Iport/cortex_m \
        "${lib[@]}" "${tools[@]}"
}

# Each of these takes one core: beside the others.
single() {
    step "the rules below can fail" tests/lint/selftest.sh
    step "bits that no longer fit do not compile" tests/lint/packed_bits.sh
    step "text: includes, rooms, circles, columns, lengths, version" tests/lint/sources.py
    step "the library as one translation unit: unique names" check_unity
    return "$broken"
}

single >"$OUT/single.txt" 2>&1 &
step "the library, gcc and clang, float and double, three sizes, no warning" check_matrix
step "objects: no statics, heap, libm, double, recursion" check_objects
step "each header alone, C11 and C++14, float and double" check_headers
step "tools, gcc and clang, no warning" check_tools
step "clang-tidy" check_tidy
step "cppcheck" check_cppcheck
wait $! || broken=1
cat "$OUT/single.txt"
exit "$broken"
