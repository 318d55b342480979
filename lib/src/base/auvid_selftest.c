/*
 * Hashes all bits of a known computation. Inputs pass through a volatile, so that the machine and
 * not the compiler computes. Each expression detects a certain fault. NaN is never hashed, because
 * its bits differ between machines.
 */
#include "auvid/types.h"
#include "auvid_math_internal.h"

#ifdef AUVID_REAL_DOUBLE
#define EXPECTED 0x352fa703u
#define MIN_NORMAL AUVID_C(2.2250738585072014e-308)
typedef int64_t odd_t;
#define ODD_INTEGER INT64_C(0x20000000000001) /* 2^53 + 1: half-way, rounds to even */
#else
#define EXPECTED 0xf96e2484u
#define MIN_NORMAL AUVID_C(1.17549435e-38)
typedef int32_t odd_t;
#define ODD_INTEGER INT32_C(0x1000001) /* 2^24 + 1 */
#endif

/* Hides a value from the optimizer. */
static auvid_real_t selftest_opaque(auvid_real_t x)
{
    volatile auvid_real_t v = x;
    return v;
}

/* Adds a word to the hash: FNV prime with a rotation. Words make it independent of byte order. */
static uint32_t selftest_mix(uint32_t hash, uint32_t word)
{
    return (((hash << 5) | (hash >> 27)) ^ word) * 16777619u;
}

/* Adds the bits of n values to the hash. */
static uint32_t selftest_add(uint32_t hash, const auvid_real_t *x, size_t n)
{
    for (size_t i = 0; i < n; ++i) {
#ifdef AUVID_REAL_DOUBLE
        union {
            auvid_real_t x;
            uint64_t bits;
        } u = {x[i]};
        hash = selftest_mix(selftest_mix(hash, (uint32_t)u.bits), (uint32_t)(u.bits >> 32));
#else
        union {
            auvid_real_t x;
            uint32_t bits;
        } u = {x[i]};
        hash = selftest_mix(hash, u.bits);
#endif
    }
    return hash;
}

#define SELFTEST_COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* The four operations, and compiler transformations of several of them. */
static uint32_t selftest_operations(uint32_t hash, auvid_real_t a, auvid_real_t b)
{
    auvid_real_t product = selftest_opaque(a * b);
    const auvid_real_t x[] = {
        a + b,           a - b,
        product,         a / b,
        b / a,           a * b - product, /* 0 unless contracted */
        product - a * b,                  /* the same, negated product */
        a * a + b * b,                    /* contracted: one rounding less */
        (a + b) - a,                      /* reassociated: b */
        (a + b) / b,                      /* by a common reciprocal: other bits */
        product / b,     auvid_sqrt(auvid_abs(a)),
    };
    return selftest_add(hash, x, SELFTEST_COUNT(x));
}

/* Rounding, denormals, range. */
static uint32_t selftest_limits(uint32_t hash)
{
    auvid_real_t one = selftest_opaque(AUVID_C(1.0));
    auvid_real_t half = selftest_opaque(AUVID_C(0.5));
    auvid_real_t e = selftest_opaque(AUVID_EPSILON);
    auvid_real_t smallest = selftest_opaque(MIN_NORMAL);
    auvid_real_t largest = selftest_opaque(AUVID_LARGEST);
    auvid_real_t denormal = selftest_opaque(smallest * half); /* 0 if results are flushed */
    const auvid_real_t x[] = {
        one + e * half,             /* half-way: down to even */
        one + e * (one + half),     /* half-way: up to even */
        -one - e * half,            /* and for negative numbers */
        one + e * half * (one + e), /* above half-way */
        one - e * half * half * (one - e),
        denormal,
        denormal + denormal, /* 0 if operands are flushed */
        denormal * (one + half),
        auvid_sqrt(denormal),
        (smallest * (one + e)) - smallest, /* gradual underflow */
        (largest * (one + one)) * half,    /* infinity, unless there is excess range */
        largest + largest * e * half * half,
    };
    auvid_real_t infinity = selftest_opaque(largest + largest);
    auvid_real_t nan = selftest_opaque(infinity - infinity);
    hash = selftest_add(hash, x, SELFTEST_COUNT(x));
    hash = selftest_mix(hash, auvid_is_finite(nan) ? 1u : 0u);
    hash = selftest_mix(hash, auvid_is_finite(infinity) ? 1u : 0u);
    hash = selftest_mix(hash, (nan < one) || !auvid_is_nan(nan) ? 1u : 0u);
    return hash;
}

/* Integers to reals and back. */
static uint32_t selftest_conversions(uint32_t hash)
{
    volatile int32_t min_int = -INT32_MAX;
    volatile uint32_t max_unsigned = UINT32_MAX;
    volatile odd_t odd = ODD_INTEGER;
    volatile uint64_t sticky = UINT64_C(0x8000008000000001); /* just above half-way in float */
    const auvid_real_t x[] = {(auvid_real_t)min_int, (auvid_real_t)max_unsigned, (auvid_real_t)odd,
                              (auvid_real_t)-odd, auvid_real_of(sticky)};
    hash = selftest_add(hash, x, SELFTEST_COUNT(x));
    hash =
        selftest_mix(hash, (uint32_t)(int32_t)selftest_opaque(AUVID_C(-2.75))); /* towards zero */
    hash = selftest_mix(hash, (uint32_t)selftest_opaque(AUVID_C(4000000000.0)));
    return hash;
}

auvid_status_t auvid_selftest(void)
{
    uint32_t hash = 2166136261u;
    auvid_real_t a = selftest_opaque(AUVID_C(0.7));
    auvid_real_t b = selftest_opaque(AUVID_C(-1.3));
    for (int i = 0; i < 4; ++i) {
        auvid_real_t x[3];
        hash = selftest_operations(hash, a, b);
        auvid_sincos(a * AUVID_C(37.0), &x[0], &x[1]);
        x[2] = auvid_atan2(a, b);
        hash = selftest_add(hash, x, SELFTEST_COUNT(x));
        a = a * AUVID_C(-1.9) + AUVID_C(0.1);
        b = b * AUVID_C(0.6) + AUVID_C(0.3);
    }
    hash = selftest_conversions(selftest_limits(hash));
    return hash == EXPECTED ? AUVID_OK : AUVID_ERR_ARITHMETIC;
}
