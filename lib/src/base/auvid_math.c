/*
 * Elementary functions that give the same bits on every target. They use only + - * / and
 * conversions, in a fixed order, without contraction.
 *
 * - sin, cos: x = n pi/2 + r by Cody and Waite's reduction (Software Manual for the Elementary
 *   Functions, 1980), then minimax polynomials on |r| <= pi/4.
 * - atan: a minimax polynomial on [0, tan(pi/8)]; larger arguments by
 *   atan q = pi/4 + atan((q - 1) / (q + 1)).
 * - The Remez exchange algorithm computed the coefficients with 40 digits. The error of each fit is
 *   given with the coefficients.
 * - Random numbers: xoshiro128** (Blackman, Vigna 2018), seeded by splitmix64 (Steele et al. 2014).
 *
 * Error bounds, e = AUVID_EPSILON (tests/unit/base/test_math.c tests them):
 *   sin, cos: 0.75 e absolute for |x| <= 1e4; sin also 1.25 e relative for |x| <= pi
 *   atan2:    2 e relative if the angle is not denormal
 */
#include "auvid_math_internal.h"

#include <string.h>

#if !defined(AUVID_SQRT)
#include "auvid_sqrt_soft_internal.h"
#endif

auvid_real_t auvid_min(auvid_real_t a, auvid_real_t b)
{
    return a < b ? a : b;
}

auvid_real_t auvid_max(auvid_real_t a, auvid_real_t b)
{
    return a > b ? a : b;
}

auvid_real_t auvid_clamp(auvid_real_t x, auvid_real_t low, auvid_real_t high)
{
    return auvid_clamp_here(x, low, high);
}

auvid_real_t auvid_r2(auvid_real_t unexplained, auvid_real_t total)
{
    auvid_real_t part = unexplained / total;
    return total > AUVID_C(0.0) && auvid_is_finite(part) ? AUVID_C(1.0) - part : AUVID_C(0.0);
}

void auvid_zero(void *object, size_t bytes)
{
#if defined(__GNUC__)
    typedef uint32_t __attribute__((may_alias)) word_t;
    word_t *x = object;
    size_t n = bytes / sizeof *x;
    for (; n >= 8; n -= 8, x += 8) { /* compilers do not replace this by memset() */
        x[0] = x[1] = x[2] = x[3] = x[4] = x[5] = x[6] = x[7] = 0;
    }
    if (n >= 4) {
        x[0] = x[1] = x[2] = x[3] = 0;
        x += 4;
        n -= 4;
    }
    if (n >= 2) {
        x[0] = x[1] = 0;
        x += 2;
    }
    if (n % 2 > 0) {
        x[0] = 0;
    }
#else
    memset(object, 0, bytes);
#endif
}

void auvid_clear(auvid_real_t *x, size_t n)
{
    auvid_zero(x, n * sizeof *x);
}

bool auvid_all_finite(const auvid_real_t *x, size_t n)
{
    for (; n > 0; --n, ++x) {
        if (!auvid_is_finite(*x)) {
            return false;
        }
    }
    return true;
}

auvid_status_t auvid_all_within(const auvid_real_t *x, size_t n, auvid_real_t limit)
{
    for (size_t i = 0; i < n; ++i) {
        if (!(auvid_abs(x[i]) <= limit)) {
            return auvid_all_finite(x, n) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
        }
    }
    return AUVID_OK;
}

/* A 1 that is shifted out stays in the last bit, so the conversion rounds as that of n does. */
auvid_real_t auvid_real_of(uint64_t n)
{
#ifdef AUVID_REAL_DOUBLE
    return (auvid_real_t)n;
#else
    auvid_real_t unit = AUVID_C(1.0);
    for (; n > UINT32_MAX; n = n >> 1 | (n & 1u)) {
        unit *= AUVID_C(2.0);
    }
    return (auvid_real_t)(uint32_t)n * unit;
#endif
}

/* Bit by bit: n shifts out to the left while the quotient shifts in from the right. */
uint64_t auvid_divide(uint64_t n, uint64_t d)
{
    uint64_t rest = 0;
    for (int i = 0; i < 64; ++i) {
        rest = (rest << 1) | (n >> 63);
        n <<= 1;
        if (rest >= d) {
            rest -= d;
            n |= 1u;
        }
    }
    return n;
}

auvid_real_t auvid_sqrt(auvid_real_t x)
{
    if (!(x > AUVID_C(0.0))) {
        return AUVID_C(0.0);
    }
#if defined(AUVID_SQRT)
    return auvid_sqrt_here(x);
#elif defined(AUVID_REAL_DOUBLE)
    union {
        auvid_real_t x;
        uint64_t bits;
    } u = {x};
    u.bits = auvid_sqrt_soft_64(u.bits);
    return u.x;
#else
    union {
        auvid_real_t x;
        uint32_t bits;
    } u = {x};
    u.bits = auvid_sqrt_soft_32(u.bits);
    return u.x;
#endif
}

/*
 * pi/2 = HALF_PI_1 + HALF_PI_2 + HALF_PI_3. The first two have few bits (11; 40 in double). So
 * their products with |n| <= 6367 (13 bits) and the two subtractions are exact. The remaining error
 * is the rounding of n HALF_PI_3, below 6367 * 7.6e-8 * 6e-8 = 3e-11.
 *
 * sin r = r + r^3 S(r^2), cos r = 1 - r^2/2 + r^4 C(r^2), atan q = q + q^3 A(q^2). Errors of the
 * fits, in this order, that of atan relative to q: float 3.7e-9, 9.7e-11, 6.6e-10; double 3.5e-18,
 * 4.8e-20, 1.3e-18.
 */
#ifdef AUVID_REAL_DOUBLE
#define HALF_PI_1 AUVID_C(1.5707963267941522645)
#define HALF_PI_2 AUVID_C(7.4435474804802548064e-13)
#define HALF_PI_3 AUVID_C(6.3683171635109501376e-25)
/* pi minus AUVID_PI */
#define PI_TAIL AUVID_C(1.2246467991473531772e-16)
static const auvid_real_t sin_c[] = {
    AUVID_C(-0.166666666666666317),    AUVID_C(0.00833333333332231502),
    AUVID_C(-0.000198412698297251246), AUVID_C(2.75573136620365989e-6),
    AUVID_C(-2.50507532619605124e-8),  AUVID_C(1.58965048243306812e-10)};
static const auvid_real_t cos_c[] = {
    AUVID_C(0.0416666666666665987),    AUVID_C(-0.00138888888888739908),
    AUVID_C(0.0000248015872893949923), AUVID_C(-2.75573143260493349e-7),
    AUVID_C(2.08757195611160126e-9),   AUVID_C(-1.13594487966358602e-11)};
static const auvid_real_t atan_c[] = {
    AUVID_C(-0.333333333333331989),  AUVID_C(0.199999999999540015),
    AUVID_C(-0.142857142802398712),  AUVID_C(0.111111107856837945),
    AUVID_C(-0.0909089782283516305), AUVID_C(0.0769206138609740744),
    AUVID_C(-0.0666311743927422343), AUVID_C(0.0584798688093536469),
    AUVID_C(-0.0503974367912582994), AUVID_C(0.0380756733378124083),
    AUVID_C(-0.0179193177449345849)};
#else
#define HALF_PI_1 AUVID_C(1.5703125)
#define HALF_PI_2 AUVID_C(0.0004837512969970703125)
#define HALF_PI_3 AUVID_C(7.5497899548918821692e-8)
#define PI_TAIL AUVID_C(-8.74227800037e-8)
static const auvid_real_t sin_c[] = {AUVID_C(-0.1666665487), AUVID_C(0.008332173541),
                                     AUVID_C(-0.0001951665549)};
static const auvid_real_t cos_c[] = {AUVID_C(0.04166664675), AUVID_C(-0.001388736146),
                                     AUVID_C(2.443773085e-5)};
static const auvid_real_t atan_c[] = {AUVID_C(-0.3333331549), AUVID_C(0.1999848836),
                                      AUVID_C(-0.1424382682), AUVID_C(0.1059582908),
                                      AUVID_C(-0.06082992464)};
#endif

#define TERMS(table) ((int)(sizeof(table) / sizeof((table)[0])))

/* c[0] + c[1] z + ... + c[n-1] z^(n-1) */
static inline auvid_real_t math_polynomial(const auvid_real_t *c, int n, auvid_real_t z)
{
    auvid_real_t p = c[n - 1];
    for (int i = n - 2; i >= 0; --i) {
        p = p * z + c[i];
    }
    return p;
}

/* x - n pi/2 */
static inline auvid_real_t math_reduce(auvid_real_t x, int32_t n)
{
    auvid_real_t k = (auvid_real_t)n;
    return ((x - k * HALF_PI_1) - k * HALF_PI_2) - k * HALF_PI_3;
}

/* Returns true if the reduction is valid for x; false for NaN. */
static inline bool math_in_range(auvid_real_t x)
{
    return auvid_abs(x) <= AUVID_C(10000.0);
}

/* Returned for an argument out of range: the next auvid_is_finite() detects it. */
static auvid_real_t math_nan(void)
{
    auvid_real_t zero = AUVID_C(0.0);
    return zero / zero;
}

/* Returns an x beyond the range less whole revolutions: it has no more digits. NaN beyond 1e9. */
static AUVID_NOINLINE auvid_real_t math_unwind(auvid_real_t x)
{
    const auvid_real_t turn = AUVID_C(2.0) * AUVID_PI;
    return auvid_abs(x) <= AUVID_C(1e9)
               ? x - turn * (auvid_real_t)(int32_t)auvid_half_further(x / turn)
               : math_nan();
}

/* sin r for |r| <= pi/4 (plus rounding); z = r^2. */
AUVID_INLINE auvid_real_t math_sin_reduced(auvid_real_t r, auvid_real_t z)
{
    return r + r * z * math_polynomial(sin_c, TERMS(sin_c), z);
}

/* cos r for |r| <= pi/4 (plus rounding); z = r^2. */
AUVID_INLINE auvid_real_t math_cos_reduced(auvid_real_t z)
{
    return AUVID_C(1.0) - (AUVID_C(0.5) * z - z * z * math_polynomial(cos_c, TERMS(cos_c), z));
}

/* Returns r of x = n pi/2 + r. */
static auvid_real_t math_to_quadrant(auvid_real_t x, uint32_t *n)
{
    int32_t nearest_n = (int32_t)auvid_half_further(x * AUVID_C(0.63661977236758134308));
    *n = (uint32_t)nearest_n;
    return nearest_n != 0 ? math_reduce(x, nearest_n) : x;
}

auvid_real_t auvid_sin_turned(auvid_real_t x, uint32_t quarters)
{
    uint32_t n;
    if (!math_in_range(x)) {
        x = math_unwind(x);
        if (!math_in_range(x)) {
            return math_nan();
        }
    }
    auvid_real_t r = math_to_quadrant(x, &n);
    n += quarters;
    r = (n & 1u) != 0u ? math_cos_reduced(r * r) : math_sin_reduced(r, r * r);
    return (n & 2u) != 0u ? -r : r;
}

void auvid_sincos(auvid_real_t x, auvid_real_t *sin_x, auvid_real_t *cos_x)
{
    auvid_real_t s = math_nan();
    auvid_real_t c = s;
    if (!math_in_range(x)) {
        x = math_unwind(x);
    }
    if (math_in_range(x)) {
        uint32_t n;
        auvid_real_t r = math_to_quadrant(x, &n);
        auvid_real_t sr = math_sin_reduced(r, r * r), cr = math_cos_reduced(r * r);
        s = (n & 1u) != 0u ? cr : sr;
        c = (n & 1u) != 0u ? sr : cr;
        s = (n & 2u) != 0u ? -s : s;
        c = ((n + 1u) & 2u) != 0u ? -c : c;
    }
    if (sin_x != NULL) {
        *sin_x = s;
    }
    if (cos_x != NULL) {
        *cos_x = c;
    }
}

auvid_real_t auvid_atan2(auvid_real_t y, auvid_real_t x)
{
    auvid_real_t ax = auvid_abs(x);
    auvid_real_t ay = auvid_abs(y);
    bool steep = ay > ax;
    auvid_real_t large = steep ? ay : ax;
    auvid_real_t small = steep ? ax : ay;
    if (auvid_is_zero(large) && auvid_is_zero(small)) {
        return AUVID_C(0.0);
    }
    /* angle = turn + turn_tail +- atan q, q in [-tan(pi/8), tan(pi/8)] */
    auvid_real_t q = small / large;
    auvid_real_t turn = AUVID_C(0.0); /* in pi/4 */
    if (q > AUVID_C(0.41421356237309504880)) {
        q = (q - AUVID_C(1.0)) / (q + AUVID_C(1.0));
        turn = AUVID_C(1.0);
    }
    auvid_real_t z = q * q;
    auvid_real_t a = q + q * z * math_polynomial(atan_c, TERMS(atan_c), z);
    if (steep) { /* pi/2 - angle */
        a = -a;
        turn = AUVID_C(2.0) - turn;
    }
    if (x < AUVID_C(0.0)) { /* pi - angle */
        a = -a;
        turn = AUVID_C(4.0) - turn;
    }
    turn *= AUVID_C(0.25);
    a = turn * AUVID_PI + (a + turn * PI_TAIL);
    return y < AUVID_C(0.0) ? -a : a;
}

/* auvid_sincos(), without a call if x is small. */
AUVID_INLINE void math_sincos_small(auvid_real_t x, auvid_real_t *sin_x, auvid_real_t *cos_x)
{
    if (auvid_abs(x) < AUVID_C(0.785)) {
        *sin_x = math_sin_reduced(x, x * x);
        *cos_x = math_cos_reduced(x * x);
    } else {
        auvid_sincos(x, sin_x, cos_x);
    }
}

void auvid_rotation(auvid_real_t phi, auvid_real_t theta, auvid_real_t psi, auvid_real_t r[3][3])
{
    auvid_real_t sf, cf, st, ct, sp, cp;
    math_sincos_small(phi, &sf, &cf);
    math_sincos_small(theta, &st, &ct);
    auvid_sincos(psi, &sp, &cp);
    r[0][0] = cp * ct;
    r[0][1] = cp * st * sf - sp * cf;
    r[0][2] = cp * st * cf + sp * sf;
    r[1][0] = sp * ct;
    r[1][1] = sp * st * sf + cp * cf;
    r[1][2] = sp * st * cf - cp * sf;
    r[2][0] = -st;
    r[2][1] = ct * sf;
    r[2][2] = ct * cf;
}

static AUVID_NOINLINE uint64_t math_splitmix64(uint64_t *state)
{
    *state += UINT64_C(0x9e3779b97f4a7c15);
    uint64_t z = *state;
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

void auvid_rng_seed(auvid_rng_t *rng, uint64_t seed)
{
    /* splitmix64 is a permutation: consecutive outputs differ, so they are not both zero. */
    for (int i = 0; i < 4; i += 2) {
        uint64_t z = math_splitmix64(&seed);
        rng->s[i] = (uint32_t)z;
        rng->s[i + 1] = (uint32_t)(z >> 32);
    }
}

static uint32_t math_rotate_left(uint32_t x, unsigned k)
{
    return (x << k) | (x >> (32u - k));
}

uint32_t auvid_rng_next(auvid_rng_t *rng)
{
    uint32_t *s = rng->s;
    uint32_t result = math_rotate_left(s[1] * 5u, 7u) * 9u;
    uint32_t t = s[1] << 9;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = math_rotate_left(s[3], 11u);
    return result;
}

auvid_real_t auvid_rng_uniform(auvid_rng_t *rng)
{
    return (auvid_real_t)(int32_t)(auvid_rng_next(rng) >> 8) * AUVID_C(5.9604644775390625e-8);
}

uint32_t auvid_rng_below(auvid_rng_t *rng, uint32_t n)
{
    return (uint32_t)(((uint64_t)auvid_rng_next(rng) * n) >> 32);
}
