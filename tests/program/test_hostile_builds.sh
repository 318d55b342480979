#!/usr/bin/env bash
# Builds that would change the results are refused by the compiler or, where it cannot detect them,
# by init, with a message that says what to change. Harmless builds give the same bits.
# (Other sizes in library and caller: test_sizes_link.sh. Machines: test_refused_arithmetic.c.)
set -uo pipefail
cd "$(dirname "$0")/../.." || exit 1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# report WHAT: "ok" or "not ok" by the last command's status.
report() {
    if [ $? = 0 ]; then
        echo "ok - $1"
    else
        echo "not ok - $1"
        head -n 5 "$scratch/output"
    fi
}

# stops SENTENCE COMPILER FLAG...: the compiler refuses the headers with this message.
stops() {
    local sentence=$1
    shift
    ! echo '#include "auvid/config.h"' | "$@" -std=c11 -Ilib/include -E -x c - \
        >"$scratch/output" 2>&1 && grep -q "error: .*auvid: $sentence" "$scratch/output"
}

# Every size, one below and one above its allowed range.
config=lib/include/auvid/config.h
tested=0
while read -r macro low high; do
    tested=$((tested + 1))
    for value in $((low - 1)) $((high + 1)); do
        stops "$macro must be $low..$high" gcc "-D$macro=$value"
        report "$macro=$value is refused"
    done
done < <(grep '^#error' $config |
    sed -nE 's/.*auvid: (AUVID_[A-Z_]*) must be ([0-9]+)\.\.([0-9]+)"/\1 \2 \3/p')
stops 'AUVID_MAX_COLUMNS must be at least' gcc -DAUVID_MAX_COLUMNS=40
report "too few columns for the commands are refused"
stops 'AUVID_MAX_POPULATION must be at least' gcc -DAUVID_MAX_POPULATION=17
report "a population too small for the parameters is refused"
stops 'AUVID_MAX_POPULATION 0 needs AUVID_MAX_COMMANDS 0' gcc -DAUVID_MAX_POPULATION=0
report "no population, but commands: refused"
tested=$((tested + 4)) # with -ffast-math below
[ "$(grep -c '#error' $config)" = $tested ]
report "all $tested sentences of config.h are tested here"

for compiler in gcc clang; do
    for flag in -ffast-math -Ofast; do
        stops 'build without -ffast-math' $compiler $flag
        report "$compiler $flag is refused"
    done
done

# init COMPILER FLAG...: builds the library and a caller, and prints the result of init.
init() {
    "$@" -std=c11 -Ilib/include -o "$scratch/caller" "$scratch/caller.c" lib/src/*/*.c \
        >"$scratch/output" 2>&1 && "$scratch/caller"
}
cat >"$scratch/caller.c" <<'END_C'
#include <stdio.h>
#include "auvid/identifier.h"
static auvid_identifier_t id;
static auvid_identifier_config_t cfg;
int main(void)
{
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    puts(auvid_status_str(auvid_identifier_init(&id, &cfg)));
    return 0;
}
END_C
init gcc -O1 | grep -q '^done'
report "gcc: init accepts"
# The parts of -ffast-math, without the name.
for flag in -funsafe-math-optimizations -freciprocal-math; do
    init gcc -O1 $flag | grep -q 'fast math'
    report "gcc $flag: init refuses, and says what to switch off"
done
if [ "$(uname -m)" = x86_64 ]; then
    init gcc -O1 -mfpmath=387 | grep -q 'fast math'
    report "the 387's precision: init refuses"
fi

# Contraction to fused multiply-add, on machines that have it. auvid_math_internal.h prevents it
# with gcc; clang contracts despite the pragma.
if grep -qw fma /proc/cpuinfo 2>/dev/null; then
    init clang -O1 -mfma -ffp-contract=fast | grep -q 'contraction'
    report "clang -ffp-contract=fast: init refuses, and says what to switch off"
    mkdir "$scratch/plain" "$scratch/wild"
    build/auvid node --bus memory --excite --sets 1 --log "$scratch/bus.log" >"$scratch/output"
    example="-Ilib/include -Iport/cortex_m port/cortex_m/example/main.c
        port/cortex_m/example/driver_qemu.c tests/firmware/machine_host.c"
    gcc -O2 -std=c11 $example lib/src/*/*.c -o "$scratch/plain/run" &&
        gcc -O3 -march=native -ffp-contract=fast -flto $example lib/src/*/*.c \
            -o "$scratch/wild/run" 2>"$scratch/output" &&
        (cd "$scratch/plain" && ln -s ../bus.log . && ./run) >"$scratch/output" &&
        (cd "$scratch/wild" && ln -s ../bus.log . && ./run) >"$scratch/output" &&
        [ "$(wc -l <"$scratch/plain/sent.log")" -gt 5000 ] &&
        cmp "$scratch/plain/sent.log" "$scratch/wild/sent.log" >"$scratch/output" 2>&1
    report "gcc -O3 -march=native -ffp-contract=fast -flto: the same bits"
fi
