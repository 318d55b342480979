/**
 * @file auvid_math_internal.h
 * Private: elementary functions that give the same bits on every target.
 *
 * auvid does not use libm: sinf, cosf, atan2f differ between C libraries, and a firmware image
 * should not contain one. This header disables contraction, because users build with their own
 * flags. Every .c file of lib/ includes it (directly or through another private header) before any
 * arithmetic.
 */
#ifndef AUVID_MATH_INTERNAL_H
#define AUVID_MATH_INTERNAL_H

#include "auvid/types.h"
#include "auvid_sqrt_internal.h"

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

_Static_assert(AUVID_DOF_COUNT <= 8, "masks of degrees of freedom are uint8_t");

/* For the few functions that dominate the cost of a tick; not with -Os. */
#if defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define AUVID_INLINE static inline __attribute__((always_inline))
#else
#define AUVID_INLINE static inline
#endif

/* For a function that many places call: copied into them, but not with -Os. One .c file declares it
 * `extern`. */
#if defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define AUVID_SHARED inline __attribute__((always_inline))
#else
#define AUVID_SHARED inline
#endif

/* For a function that must not merge into its callers: its stack frame is large, or copies of it
 * would be. */
#if defined(__GNUC__)
#define AUVID_NOINLINE __attribute__((noinline))
#else
#define AUVID_NOINLINE
#endif

/* Absolute value; +0 for both zeros. */
static inline auvid_real_t auvid_abs(auvid_real_t x)
{
#if defined(__GNUC__) && defined(AUVID_REAL_DOUBLE)
    return __builtin_fabs(x); /* one instruction, never a call */
#elif defined(__GNUC__)
    return __builtin_fabsf(x);
#else
    return x > AUVID_C(0.0) ? x : AUVID_C(0.0) - x;
#endif
}

/* Exact comparisons; -Wfloat-equal rejects them elsewhere. */
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wfloat-equal"
#endif
static inline bool auvid_is_zero(auvid_real_t x)
{
    return x == AUVID_C(0.0);
}

static inline bool auvid_is_nan(auvid_real_t x)
{
    return x != x;
}
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

auvid_real_t auvid_min(auvid_real_t a, auvid_real_t b);

auvid_real_t auvid_max(auvid_real_t a, auvid_real_t b);

auvid_real_t auvid_clamp(auvid_real_t x, auvid_real_t low, auvid_real_t high);

/** auvid_clamp() without a call: for what is called in every tick or trial. */
static inline auvid_real_t auvid_clamp_here(auvid_real_t x, auvid_real_t low, auvid_real_t high)
{
    return x < low ? low : (x > high ? high : x);
}

/** Returns x, half a unit further from zero. Truncated to an integer, that is x rounded to the
 * nearest one, halves away from zero, to within the rounding of the sum. */
static inline auvid_real_t auvid_half_further(auvid_real_t x)
{
    return x < AUVID_C(0.0) ? x - AUVID_C(0.5) : x + AUVID_C(0.5);
}

/** Returns the explained part of a sum of squares, 1 - unexplained / total; 0: it is no number. */
auvid_real_t auvid_r2(auvid_real_t unexplained, auvid_real_t total);

/** Sets an object that consists of whole words of 4 bytes to zero. memset() of small C libraries
 * works byte by byte, which is noticed in a tick. */
void auvid_zero(void *object, size_t bytes);

/** Sets n values to zero. */
void auvid_clear(auvid_real_t *x, size_t n);

/** Returns true if all n values are finite. */
bool auvid_all_finite(const auvid_real_t *x, size_t n);

/** Returns AUVID_OK if all n values are within +-limit, AUVID_ERR_NOT_FINITE if one is not finite,
 * else AUVID_ERR_RANGE. */
auvid_status_t auvid_all_within(const auvid_real_t *x, size_t n, auvid_real_t limit);

/** Returns the time from a to b [s], b >= a, limited to 2147 s. The difference is formed in
 * integers; the only error is the rounding of one conversion. */
static inline auvid_real_t auvid_seconds(uint64_t a_us, uint64_t b_us)
{
    uint64_t us = b_us - a_us;
    return (auvid_real_t)(us < INT32_MAX ? (int32_t)us : INT32_MAX) * AUVID_C(1e-6);
}

/** Returns the number of bits that are set. */
static inline uint32_t auvid_count_bits(uint32_t bits)
{
    uint32_t count = 0;
    for (; bits != 0; bits &= bits - 1u) {
        ++count;
    }
    return count;
}

/** Returns n, rounded once. In float the compiler's conversion of 64 bits has ten times the code
 * size. */
auvid_real_t auvid_real_of(uint64_t n);

/** Returns n / d, rounded down; d in 1..2^63. For rare use: small but slow. The compiler's 64-bit
 * division has ten times the code size. */
uint64_t auvid_divide(uint64_t n, uint64_t d);

/** Returns the correctly rounded square root; 0 for x <= 0 and for NaN. */
auvid_real_t auvid_sqrt(auvid_real_t x);

/** auvid_sqrt() without a call, for inner loops; x >= 0 or NaN. */
static inline auvid_real_t auvid_sqrt_here(auvid_real_t x)
{
#if defined(AUVID_SQRT)
    auvid_real_t r;
    AUVID_SQRT(r, x);
    return r;
#else
    return auvid_sqrt(x);
#endif
}

/** Computes sin and cos of x [rad], |x| <= 1e9, else NaN. The error is below 0.75 AUVID_EPSILON up
 * to 1e4 (auvid_math.c), and below the spacing of numbers at x beyond that. Either pointer may be
 * NULL. */
void auvid_sincos(auvid_real_t x, auvid_real_t *sin_x, auvid_real_t *cos_x);

/** Returns sin(x + quarters pi/2), so 0: sin x, 1: cos x. Same bits as auvid_sincos(). */
auvid_real_t auvid_sin_turned(auvid_real_t x, uint32_t quarters);

/** Returns the angle of (x, y) in [-pi, pi]; 0 for (0, 0). Relative error below 2 AUVID_EPSILON. */
auvid_real_t auvid_atan2(auvid_real_t y, auvid_real_t x);

/** Computes the rotation from body to world, R(phi, theta, psi) = Rz(psi) Ry(theta) Rx(phi) (Fossen
 * 2011, Eq. 2.18). r[i][j]: row i world axis, column j body axis. */
void auvid_rotation(auvid_real_t phi, auvid_real_t theta, auvid_real_t psi, auvid_real_t r[3][3]);

/** Random number generator xoshiro128** (Blackman & Vigna 2018), 32-bit operations only. */
typedef struct {
    uint32_t s[4]; /**< never all zero */
} auvid_rng_t;

/** Initialises the generator from any seed, expanded by splitmix64. */
void auvid_rng_seed(auvid_rng_t *rng, uint64_t seed);
/** Returns the next 32 random bits. */
uint32_t auvid_rng_next(auvid_rng_t *rng);
/** Returns a uniform number in [0, 1), a multiple of 2^-24. */
auvid_real_t auvid_rng_uniform(auvid_rng_t *rng);
/** Returns a uniform integer in [0, n), n >= 1. Multiply-shift: bias < n / 2^32, one draw, no loop.
 * */
uint32_t auvid_rng_below(auvid_rng_t *rng, uint32_t n);

#endif
