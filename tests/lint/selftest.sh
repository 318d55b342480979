#!/usr/bin/env bash
# Do the lint rules refuse what they are there for? Each rule gets a bad snippet and must name it;
# a good one must pass.
set -euo pipefail
cd "$(dirname "$0")"
here=$PWD
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
broken=0

# expect RULE COMMAND...: COMMAND must fail and print "RULE: ...".
expect() {
    local rule=$1
    shift
    if "$@" >output 2>&1 || ! grep -q "^$rule: " output; then
        echo "lint selftest: rule '$rule' did not refuse: $(cat snippet)"
        sed 's/^/    /' output
        broken=1
    fi
}

# object RULE SNIPPET...: the compiled snippet must break RULE ("" for none).
object() {
    local rule=$1
    shift
    printf '%s\n' "$@" >snippet
    gcc -std=c11 -O0 -fno-pic -fcallgraph-info -xc -c -o snippet.o snippet
    if [ -n "$rule" ]; then
        expect "$rule" "$here/objects.py" --float snippet.o
    else
        "$here/objects.py" --float snippet.o || broken=1
    fi
}

object '' '#include <string.h>' 'void auvid_f(float *x) { memset(x, 0, 8); x[0] = 2.0f * x[1]; }'
object data 'int auvid_x = 1;'
object data 'int *auvid_f(void) { static int n; return &n; }'
object symbol 'void *malloc(unsigned long); void *auvid_f(void) { return malloc(4); }'
object symbol 'float sinf(float); float auvid_f(float x) { return sinf(x); }'
object symbol 'void auvid_g(void); void auvid_f(void) { auvid_g(); }'
object name 'void helper(void) { }'
object double 'float auvid_f(float x) { return (float)(x * 0.1); }'
object double 'int auvid_f(float x) { return x < 0.1; }'
object double 'float auvid_f(float x) { return (float)(x * 0.1L); }'
object recursion 'int auvid_f(int n) { return n ? auvid_f(n - 1) : 0; }'
object recursion 'static int g(int); int auvid_f(int n) { return g(n); }' \
    'static int g(int n) { return n ? auvid_f(n - 1) : 0; }'

# text RULE FILE LINE...: a tree whose only unusual file is FILE must break RULE ("" for none).
text() {
    local rule=$1 file=$2
    shift 2
    rm -rf tree
    mkdir -p tree/lib/src/{base,search} tree/lib/include/auvid "tree/$(dirname "$file")"
    printf '#include "auvid/types.h"\n' >tree/lib/src/base/auvid_math_internal.h
    : >tree/lib/src/search/auvid_crs_internal.h
    printf '%s\n' "$math" '#include "auvid_crs_internal.h"' 'int auvid_crs_low(void)' '{' '}' \
        >tree/lib/src/search/auvid_crs_low.c
    printf '#define AUVID_VERSION_%s\n' 'MAJOR 1' 'MINOR 2' 'PATCH 3' 'STRING "1.2.3"' \
        >tree/lib/include/auvid/config.h
    printf '#ifndef AUVID_MAX_X\n#endif\n' >>tree/lib/include/auvid/config.h
    printf '## [1.2.3] - unreleased\n' >tree/CHANGELOG.md
    printf '%s\n' "$@" >snippet
    cp snippet "tree/$file"
    if [ -n "$rule" ]; then
        expect "$rule" "$here/sources.py" tree
    else
        "$here/sources.py" tree || broken=1
    fi
}

math='#include "../base/auvid_math_internal.h"'
text '' lib/src/metric/auvid_metric.c "$math" '#include "auvid/smoother.h"' \
    'x = AUVID_C(1e-3); /* 0.5 */'
text include lib/src/metric/auvid_metric.c "$math" '#include <math.h>'
text include lib/src/metric/auvid_metric.c "$math" '#include "../../../tools/simulator/world.h"'
text '' lib/src/metric/auvid_metric.c "$math" '#include "auvid/vehicle.h"'
text '' lib/src/can/auvid_node.c "$math" '#include "auvid/identifier.h"' '#include "auvid/can.h"'
text '' lib/include/auvid/auvid.h '#include "auvid/config.h"' '#include "auvid/node.h"'
text public lib/include/auvid/auvid.h '#include "auvid/node.h"'
text dependency lib/src/search/auvid_optimizer.c "$math" '#include "auvid/detail/metric.h"'
text dependency lib/src/search/auvid_optimizer.c "$math" \
    '#include "../metric/auvid_metric_internal.h"'
text dependency lib/src/base/auvid_smoother.c "$math" '#include "auvid/vehicle.h"'
text dependency lib/src/models/auvid_current.c "$math" '#include "auvid/nav.h"'
text dependency lib/src/can/auvid_can.c "$math" '#include "auvid/identifier.h"'
text dependency lib/src/can/auvid_can.c "$math" '#include "auvid/node.h"'
text dependency lib/src/identifier/auvid_prior.c "$math" '#include "auvid/can.h"'
text dependency lib/src/identifier/auvid_prior.c "$math" '#include "auvid/unheard_of.h"'
text dependency lib/include/auvid/nav.h '#include "auvid/vehicle.h"'
text dependency lib/include/auvid/unheard_of.h ''
text dependency lib/src/auvid_flat.c '#include "base/auvid_math_internal.h"'
text dependency lib/src/unheard_of/auvid_x.c "$math"
text '' tools/auvid/log/csv.c '#include "../base/ini.h"' '#include "../commands.h"'
text dependency tools/auvid/log/csv.c '#include "../report/report.h"'
text dependency tools/auvid/unheard_of/x.c ''
calls_low() { # RULE FILE: a file that calls what auvid_crs_low.c defines
    text "$1" "$2" "$math" 'int auvid_crs_go(void)' '{' '    return auvid_crs_low();' '}'
}
calls_low '' lib/src/search/auvid_crs_high.c
calls_low circle lib/src/search/auvid_crs.c
text arithmetic lib/src/navigation/auvid_nav.c '#include "auvid/types.h"'
text literal lib/src/navigation/auvid_nav.c "$math" 'x = 0.5 * y;'
text literal lib/src/navigation/auvid_nav.c "$math" 'x = 1e-3f;'
text columns tools/long.c "$(printf '%101s' x)"
text object lib/src/metric/auvid_confidence.c "$math" 'x = m->evaluator.weight[0];'
text object lib/src/identifier/auvid_identifier_work.c "$math" 'm->sets.from = 1;'
text '' lib/src/identifier/auvid_identifier_work.c "$math" 'x = m->sets.recorded;'
text '' lib/src/metric/auvid_metric_cost.c "$math" 'x = m->evaluator.weight[0];'
text length tools/long.c 'int f(void)' '{' "$(yes '    x();' | head -n 61)" '}'
text path tools/where.c 'open("/home''/somebody/x");'
text word tools/names.c 'int tie_knot(void);'
text word tools/names.md 'The leash is foretold anew.'
text '' tools/names.md 'The excursion limit is predicted again.'
text public README.md '```c' '#include "auvid/detail/metric.h"' '```'
text survivor tests/mutation/survivors.txt '@ auvid_nav.c nav_f' '- x = 1;'
text version CHANGELOG.md '## [1.2.4] - unreleased'
link_name() { # RULE DEFINE: a function of a struct that AUVID_MAX_X is in, renamed like this
    text "$1" lib/include/auvid/nav.h 'typedef struct {' '    auvid_real_t x[1 + AUVID_MAX_X];' \
        '} auvid_x_t;' "$2" 'void auvid_x_take(const auvid_x_t *x);'
}
link_name '' '#define auvid_x_take AUVID_SIZED(auvid_x_take)'
link_name 'link name' '#define auvid_x_take AUVID_SIZED0(auvid_x_take)'
link_name 'link name' ''
text 'link name' lib/include/auvid/config.h '#define AUVID_VERSION_MAJOR 1' \
    '#define AUVID_VERSION_MINOR 2' '#define AUVID_VERSION_PATCH 3' \
    '#define AUVID_VERSION_STRING "1.2.3"' '#ifndef AUVID_MAX_X' '#endif' '#ifndef AUVID_MAX_Y' \
    '#endif' '#define AUVID_SIZED(name) JOIN(name, AUVID_MAX_X)' ''
text target Makefile '.PHONY: all' 'all:' '	true'

# Compilers: what the object rules leave to the flags of lint.sh.
refuse() {
    printf '%s\n' "$1" >snippet
    for compiler in gcc clang; do
        if $compiler $STRICT -xc -c -o snippet.o snippet 2>/dev/null; then
            echo "lint selftest: $compiler does not refuse: $1"
            broken=1
        fi
    done
}
if [ -n "${STRICT:-}" ]; then
    refuse 'int auvid_f(int n); int auvid_f(int n) { int x[n]; x[0] = n; return x[0]; }'
    refuse 'void *auvid_f(void); void *auvid_f(void) { return __builtin_alloca(8); }'
    refuse 'int auvid_f(float x); int auvid_f(float x) { return x < 0.1; }'
    refuse 'void auvid_f(void) { }'
    refuse 'int auvid_f(float x, float y); int auvid_f(float x, float y) { return x == y; }'
    refuse 'char *auvid_f(const char *x); char *auvid_f(const char *x) { return (char *)x; }'
    refuse 'extern int auvid_x;
#if AUVID_UNHEARD_OF
#endif'
    refuse 'enum e { A, B }; int auvid_f(enum e x);
        int auvid_f(enum e x) { switch (x) { case A: return 1; default: return 0; } }'

    # together OUTCOME STATIC MACRO: does a file with these go with one that has f and M?
    part() { # FILE STATIC MACRO
        printf '%s\n' "#define $3 ${#1}" "static int $2(int x) { return x + $3; }" \
            "int auvid_${1%.c}(int x);" "int auvid_${1%.c}(int x) { return $2(x); }" >"$1"
    }
    together() {
        local outcome=refused
        part a.c f M
        part bb.c "$2" "$3"
        ! "$here/unity.sh" a.c bb.c 2>/dev/null || outcome=taken
        if [ $outcome != "$1" ]; then
            echo "lint selftest: unity build: f and M beside $2 and $3 are $outcome"
            broken=1
        fi
    }
    together taken g N
    together refused f N
    together refused g M
fi
exit "$broken"
