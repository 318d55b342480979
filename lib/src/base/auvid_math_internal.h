/**
 * @file auvid_math_internal.h
 * Private: elementary functions that give the same bits on every target.
 *
 * No libm: sinf, cosf, atan2f differ between C libraries, and a firmware image should not carry
 * one. Contraction is switched off here, because users build with their own flags: every .c file of
 * lib/ includes this header (directly or through another private header) before any arithmetic.
 */
#ifndef AUVID_MATH_INTERNAL_H
#define AUVID_MATH_INTERNAL_H

#include "auvid/types.h"

#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif

/* For the few lines that the cost of a tick is made of, unless a small program is wanted. */
#if defined(__GNUC__) && !defined(__OPTIMIZE_SIZE__)
#define AUVID_INLINE static inline __attribute__((always_inline))
#else
#define AUVID_INLINE static inline
#endif

/* For a function whose large frame must not lie under what its caller calls next. */
#if defined(__GNUC__)
#define AUVID_NOINLINE __attribute__((noinline))
#else
#define AUVID_NOINLINE
#endif

/* +0 for both zeros. */
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

/* Exact comparisons, which -Wfloat-equal refuses elsewhere. */
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

static inline auvid_real_t auvid_clamp(auvid_real_t x, auvid_real_t low, auvid_real_t high)
{
    return x < low ? low : (x > high ? high : x);
}

/** n zeros. memset() of small C libraries goes byte by byte. */
void auvid_clear(auvid_real_t *x, size_t n);

/** Are all n values finite? */
bool auvid_all_finite(const auvid_real_t *x, size_t n);

/** AUVID_OK when all n values are within +-limit, else AUVID_ERR_NOT_FINITE or AUVID_ERR_RANGE. */
auvid_status_t auvid_all_within(const auvid_real_t *x, size_t n, auvid_real_t limit);

/** From a to b, which is not before a [s]: formed in integers, exact to the rounding of one
 * conversion, at most 2147 s. */
static inline auvid_real_t auvid_seconds(uint64_t a_us, uint64_t b_us)
{
    uint64_t us = b_us - a_us;
    return (auvid_real_t)(us < INT32_MAX ? (int32_t)us : INT32_MAX) * AUVID_C(1e-6);
}

/** n / d, rounded down; d in 1..2^63. For rare use: a compiler's own weighs ten times as much. */
uint64_t auvid_divide(uint64_t n, uint64_t d);

/** Correctly rounded square root; 0 for x <= 0 and for NaN. */
auvid_real_t auvid_sqrt(auvid_real_t x);

/** sin and cos of x [rad], |x| <= 1e4, else NaN; error below 0.75 AUVID_EPSILON (auvid_math.c).
 * Either pointer may be null. */
void auvid_sincos(auvid_real_t x, auvid_real_t *sin_x, auvid_real_t *cos_x);

/** sin(x + quarters pi/2), exactly what auvid_sincos() gives for it: sin x for 0, cos x for 1. */
auvid_real_t auvid_sin_turned(auvid_real_t x, uint32_t quarters);

/** Angle of (x, y) in [-pi, pi]; 0 for (0, 0); relative error below 2 AUVID_EPSILON. */
auvid_real_t auvid_atan2(auvid_real_t y, auvid_real_t x);

/** x brought into [-pi, pi], |x| <= 1e4, else NaN; error below 1.25 AUVID_EPSILON. */
auvid_real_t auvid_wrap_pi(auvid_real_t x);

/** Rotation body to world, R(phi, theta, psi) = Rz(psi) Ry(theta) Rx(phi) (Fossen 2011, Eq. 2.18).
 * r[i][j]: row i world axis, column j body axis. */
void auvid_rotation(auvid_real_t phi, auvid_real_t theta, auvid_real_t psi, auvid_real_t r[3][3]);

/** Random numbers: xoshiro128** (Blackman & Vigna 2018), 32-bit operations only. */
typedef struct {
    uint32_t s[4]; /**< never all zero */
} auvid_rng_t;

/** Start from any seed (splitmix64 spreads it). */
void auvid_rng_seed(auvid_rng_t *rng, uint64_t seed);
/** Next 32 random bits. */
uint32_t auvid_rng_next(auvid_rng_t *rng);
/** Uniform in [0, 1), multiple of 2^-24. */
auvid_real_t auvid_rng_uniform(auvid_rng_t *rng);
/** Uniform integer in [0, n), n >= 1: multiply-shift, bias < n / 2^32, one draw, no loop. */
uint32_t auvid_rng_below(auvid_rng_t *rng, uint32_t n);

#endif
