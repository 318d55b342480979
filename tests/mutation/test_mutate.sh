#!/usr/bin/env bash
# Does mutate.py say of each change what it should? On a file of a few lines and a test that leaves
# out what it is to find.
set -euo pipefail
cd "$(dirname "$0")/../.."
tests/support/setup.sh test mutate
root=$PWD unity=$(realpath "${UNITY_DIR:-third_party/unity/src}")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
mkdir -p lib/src tests/mutation

cat >lib/src/demo.c <<'END'
#define LIMIT 10
int demo_add(int a, int b) { return a + b; }
int demo_is_large(int x) { return x > LIMIT; }
int demo_both(int x) { return x > 2 && x > 2; }
long demo_between(const int *a, const int *b) { return a - b; }
unsigned demo_count(unsigned n)
{
    volatile unsigned count = 0;
    while (n != 0) {
        --n;
        ++count;
    }
    return count;
}
int demo_has(int x)
{
    volatile int a[] = {7, 77777};
    int n = 0;
    for (int i = 0; i < 2; ++i) {
        n += a[i] == x;
    }
    return n;
}
int demo_unused(int x) { return x + x + x; }
END
cat >test_demo.c <<'END'
#include "unity.h"
int demo_add(int, int), demo_is_large(int), demo_both(int), demo_has(int);
long demo_between(const int *, const int *);
unsigned demo_count(unsigned);
static int seen;
static void test_add(void) { TEST_ASSERT_EQUAL(5, demo_add(2, 3)); seen = 1; }
static void test_rest(void)
{
    int a[3];
    TEST_ASSERT_TRUE(demo_is_large(20) && !demo_is_large(0));
    TEST_ASSERT_TRUE(demo_both(9) && demo_both(3) && !demo_both(2));
    TEST_ASSERT_EQUAL(2, demo_between(a + 2, a));
    TEST_ASSERT_EQUAL(3, demo_count(3));
    TEST_ASSERT_EQUAL(1, demo_has(77777));
#ifdef NEEDS_ANOTHER
    TEST_ASSERT_EQUAL(1, seen);
#endif
}
int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_add);
    RUN_TEST(test_rest);
    return UNITY_END();
}
END
build_test() {
    gcc "$@" -I"$unity" -c -o test_demo.o test_demo.c
}
build_test
gcc -w -c -o unity.o "$unity/unity.c"
gcc -I"$unity" -c -o one_test.o "$root/tests/mutation/one_test.c"

mutate() {
    status=0
    "$root/third_party/mutation/bin/python" "$root/tests/mutation/mutate.py" lib/src/demo.c "$@" \
        --compile 'gcc -O1' --link gcc --objects unity.o one_test.o --tests test_demo.o \
        >output 2>&1 || status=$?
}

# check WHAT COMMAND...: the command must succeed.
check() {
    local what=$1
    shift
    if "$@" >/dev/null; then
        echo "ok $what"
    else
        echo "not ok $what"
        sed 's/^/# /' output
    fi
}

# changed VERDICT BEFORE AFTER: the change was shown with that verdict.
changed() {
    grep -qFx -- "- $2" output && grep -A3 "^lib/src/demo.c:[0-9]*: $1" output | grep -qFx -- "+ $3"
}
refute() {
    ! "$@"
}

mutate
cp output first
check 'a survivor that is not listed is a failure' [ "$status" = 1 ]
check 'a limit that no test is near to survives' \
    changed survived '#define LIMIT 10' '#define LIMIT 11'
check 'what compiles to the same code is counted, not shown' refute grep -q 'x >= LIMIT' output
check 'a place too far that is read survives' \
    changed survived 'for (int i = 0; i < 2; ++i) {' 'for (int i = 0; i <= 2; ++i) {'
check 'what no test executes survives' changed survived \
    'int demo_unused(int x) { return x + x + x; }' 'int demo_unused(int x) { return x + x - x; }'
check 'a change that a test notices does not' refute grep -q 'return a - b; }$' output
check 'a loop without end is timed out, not killed' changed 'timed out (test_rest)' '--n;' ';'
check 'a sum of pointers is not C' grep -q '[1-9][0-9]* not C$' output
check 'the same condition twice is equivalent to once' grep -q ' [1-9][0-9]* equivalent' output
check 'every mutant has one verdict' awk '/ mutants: / {
    gsub(/\([^)]*\)/, "")
    for (i = 4; i < NF; ++i) if ($i ~ /^[0-9]+$/) sum += $i
    exit $2 != sum }' output

mutate --sanitize '-O1 -fsanitize=address,undefined -fno-sanitize-recover=all'
check 'but not where the change is sanitized' refute grep -q 'i <= 2' output
check 'which tells nothing else apart' changed survived '#define LIMIT 10' '#define LIMIT 11'

grep -A3 ': survived' first | grep -E '^[-+@] ' >tests/mutation/survivors.txt
mutate
check 'listed, they are none' [ "$status" = 0 ]
printf '%s\n' '@ demo.c demo_add' '- int demo_add(int a, int b) { return a + b; }' \
    '+ int demo_add(int a, int b) { return a - b; }' '  Nobody adds.' >>tests/mutation/survivors.txt
mutate
check 'a listed survivor that is killed is a failure' [ "$status" = 1 ]
check 'and is named' grep -q '^stale' output
mutate --lines 2-2 --part
check 'a part of a file says nothing of the rest of the list' [ "$status" = 0 ]
check 'and changes that part alone' grep -q '^lib/src/demo.c: 1 mutants: 1 killed' output

build_test -DNEEDS_ANOTHER
mutate
check 'a test that needs another one before it is refused' grep -q 'fail: test_rest$' output
