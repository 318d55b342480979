/*
 * Savitzky-Golay smoothing (Savitzky, Golay 1964) through Gram polynomials (Gorry 1990).
 *
 * On the N = 2 h + 1 points i = -h..h the discrete Chebyshev (Gram) polynomials
 *     t_0 = 1,  t_1 = 2 i,  (m+1) t_{m+1} = (2m+1) 2 i t_m - m (N^2 - m^2) t_{m-1}
 * are orthogonal, with integer coefficients, and sum_i t_m(i)^2 = N (N^2-1)..(N^2-m^2) / (2m+1).
 * In the d-th derivative at position s of the fitted polynomial of order p, x_k has the weight
 *     c_k = sum_{m=0}^{p} (2m+1) t_m(k) t_m^(d)(s) / (N (N^2-1)..(N^2-m^2)) / dt^d .
 *
 * All terms up to the quotient are integers. So the sum is formed exactly, in integers, over the
 * common denominator D = N (N^2-1)..(N^2-p^2), by Horner's rule in m. Bounds for N <= 255, p <= 5,
 * d <= 2: |t_m| < 2^40, |t_m^(d)| < 2^43, D < 2^89. With |c_k| < 10 (in samples) the numerator is
 * below 2^93, so 128 bits are sufficient. Numerator, denominator and quotient are rounded, and with
 * d > 0 also the power of dt and one product: 3..6 half-units in the last place.
 */
#include <string.h>

#include "auvid/smoother.h"
#include "auvid_math_internal.h"

#define MAX_ORDER AUVID_SMOOTHER_MAX_ORDER

/* A signed 128-bit integer in two's complement. */
typedef struct {
    uint64_t high, low;
} wide_t;

/* The terms of the sum for c_k that do not depend on k. */
typedef struct {
    int32_t points;            /* N */
    int32_t order;             /* p */
    int64_t at[MAX_ORDER + 1]; /* (2m+1) t_m^(d)(s) */
    auvid_real_t denominator;  /* D = denominator 2^shift, denominator in 2^63..2^64 */
    int32_t shift;
    auvid_real_t scale; /* 1 / dt^d */
} gram_t;

static wide_t smoother_wide_negative(wide_t a)
{
    wide_t r = {~a.high, ~a.low + 1u};
    r.high += r.low == 0u ? 1u : 0u;
    return r;
}

static wide_t smoother_wide_sum(wide_t a, wide_t b)
{
    wide_t r = {a.high + b.high, a.low + b.low};
    r.high += r.low < a.low ? 1u : 0u;
    return r;
}

/* a b, with partial products of 32 bits. */
static wide_t smoother_wide_product(uint64_t a, uint64_t b)
{
    const uint64_t mask = 0xffffffffu;
    uint64_t low = (a & mask) * (b & mask);
    uint64_t m1 = (a >> 32) * (b & mask) + (low >> 32);
    uint64_t m2 = (a & mask) * (b >> 32) + (m1 & mask);
    wide_t r = {(a >> 32) * (b >> 32) + (m1 >> 32) + (m2 >> 32), (m2 << 32) | (low & mask)};
    return r;
}

static wide_t smoother_wide_signed_product(int64_t a, int64_t b)
{
    wide_t r = smoother_wide_product(a < 0 ? 0u - (uint64_t)a : (uint64_t)a,
                                     b < 0 ? 0u - (uint64_t)b : (uint64_t)b);
    return (a < 0) != (b < 0) ? smoother_wide_negative(r) : r;
}

/* a b, b < 2^32, modulo 2^128; also correct for negative a. */
static wide_t smoother_wide_times(wide_t a, uint32_t b)
{
    wide_t r = smoother_wide_product(a.low, b);
    r.high += a.high * b;
    return r;
}

/* Returns r of |a| = r 2^shift, normalised to 2^63..2^64, with one rounding. a is not 0. */
static auvid_real_t smoother_wide_magnitude(wide_t a, int32_t *shift)
{
    if ((a.high >> 63) != 0u) {
        a = smoother_wide_negative(a);
    }
    *shift = 64;
    if (a.high == 0u) {
        a.high = a.low;
        a.low = 0u;
        *shift = 0;
    }
    for (int32_t s = 32; s > 0; s /= 2) {
        if ((a.high >> (64 - s)) == 0u) {
            a.high = (a.high << s) | (a.low >> (64 - s));
            a.low <<= s;
            *shift -= s;
        }
    }
    return auvid_real_of(a.high | (a.low != 0u ? 1u : 0u));
}

/* a / b, b in 1..MAX_ORDER, for a divisible by b. First halvings, then multiplication by the
 * inverse of the odd part of b modulo 2^64. */
static int64_t smoother_exact_quotient(int64_t a, int32_t b)
{
    for (; b % 2 == 0; b /= 2) {
        a /= 2;
    }
    uint64_t third = UINT64_C(0xaaaaaaaaaaaaaaab), fifth = UINT64_C(0xcccccccccccccccd);
    uint64_t inverse = b == 5 ? fifth : b == 3 ? third : 1u;
    return (int64_t)((uint64_t)a * inverse);
}

/* t[m] = t_m^(d)(i), m = 0..order, by the recurrence above, differentiated d times. */
static void smoother_gram_polynomials(int32_t points, int32_t order, int32_t i, int32_t d,
                                      int64_t *t)
{
    int64_t f[AUVID_SMOOTHER_MAX_DERIVATIVE + 1][MAX_ORDER + 1];
    for (int32_t e = 0; e <= d; ++e) {
        f[e][0] = e == 0 ? 1 : 0;
        for (int32_t m = 0; m < order; ++m) {
            int64_t last = m == 0 ? 0 : f[e][m - 1];
            int64_t lower = e == 0 ? 0 : e * f[e - 1][m];
            f[e][m + 1] = smoother_exact_quotient((2 * m + 1) * 2 * (i * f[e][m] + lower) -
                                                      (int64_t)m * (points * points - m * m) * last,
                                                  m + 1);
        }
    }
    for (int32_t m = 0; m <= order; ++m) {
        t[m] = f[d][m];
    }
}

static void smoother_gram_prepare(gram_t *g, const auvid_smoother_config_t *cfg, int32_t position)
{
    g->points = 2 * cfg->half_width + 1;
    g->order = cfg->order;
    smoother_gram_polynomials(g->points, g->order, position, cfg->derivative, g->at);
    wide_t d = {0u, (uint64_t)g->points};
    for (int32_t m = 0; m <= g->order; ++m) {
        g->at[m] *= 2 * m + 1;
        if (m > 0) {
            d = smoother_wide_times(d, (uint32_t)(g->points * g->points - m * m));
        }
    }
    g->denominator = smoother_wide_magnitude(d, &g->shift);
    auvid_real_t dt = cfg->dt_s;
    g->scale = cfg->derivative == 2u ? AUVID_C(1.0) / (dt * dt) : AUVID_C(1.0) / dt;
    if (cfg->derivative == 0u) {
        g->scale = AUVID_C(1.0);
    }
}

/* c_k, k = -h..h */
static auvid_real_t smoother_gram_coefficient(const gram_t *g, int32_t k)
{
    int64_t t[MAX_ORDER + 1];
    smoother_gram_polynomials(g->points, g->order, k, 0, t);
    wide_t sum = smoother_wide_signed_product(t[0], g->at[0]);
    for (int32_t m = 1; m <= g->order; ++m) {
        sum = smoother_wide_times(sum, (uint32_t)(g->points * g->points - m * m));
        sum = smoother_wide_sum(sum, smoother_wide_signed_product(t[m], g->at[m]));
    }
    if ((sum.high | sum.low) == 0u) {
        return AUVID_C(0.0);
    }
    int32_t shift;
    auvid_real_t c = smoother_wide_magnitude(sum, &shift) / g->denominator;
    for (; shift > g->shift; --shift) {
        c *= AUVID_C(2.0);
    }
    for (; shift < g->shift; ++shift) {
        c *= AUVID_C(0.5);
    }
    c *= g->scale;
    return (sum.high >> 63) != 0u ? -c : c;
}

static auvid_status_t smoother_check(const auvid_smoother_config_t *cfg, int32_t position)
{
    int32_t h = cfg->half_width;
    if (h > AUVID_MAX_HALF_WIDTH) {
        return AUVID_ERR_SIZE;
    }
    if (!auvid_is_finite(cfg->dt_s)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (auvid_is_zero(cfg->dt_s)) {
        return AUVID_ERR_TIME_SAME;
    }
    if (h < 1 || cfg->order > MAX_ORDER || cfg->derivative > cfg->order ||
        cfg->derivative > AUVID_SMOOTHER_MAX_DERIVATIVE || position < -h || position > h ||
        cfg->dt_s < AUVID_C(1e-6) || cfg->dt_s > AUVID_C(1e6)) {
        return AUVID_ERR_RANGE;
    }
    return cfg->order > 2 * h ? AUVID_ERR_SINGULAR : AUVID_OK;
}

void auvid_smoother_defaults(auvid_smoother_config_t *cfg)
{
    static const auvid_smoother_config_t defaults = {
        .half_width = AUVID_MAX_HALF_WIDTH < 25 ? AUVID_MAX_HALF_WIDTH : 25,
        .order = AUVID_MAX_HALF_WIDTH < 2 ? 2 : 3,
        .derivative = 0,
        .dt_s = AUVID_C(0.02)};
    if (cfg != NULL) {
        *cfg = defaults;
    }
}

auvid_status_t auvid_smoother_coefficients(uint8_t half_width, uint8_t order, uint8_t derivative,
                                           auvid_real_t dt_s, int16_t position, auvid_real_t *c)
{
    auvid_smoother_config_t cfg = {half_width, order, derivative, dt_s};
    if (c == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = smoother_check(&cfg, position);
    if (status != AUVID_OK) {
        return status;
    }
    gram_t g;
    smoother_gram_prepare(&g, &cfg, position);
    for (int32_t k = 0; k < g.points; ++k) {
        c[k] = smoother_gram_coefficient(&g, k - half_width);
    }
    return AUVID_OK;
}

auvid_status_t auvid_smoother_init(auvid_smoother_t *smoother, const auvid_smoother_config_t *cfg)
{
    if (smoother == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_smoother_config_t copy = *cfg; /* *cfg may lie inside *smoother */
    auvid_status_t status = smoother_check(&copy, 0);
    if (status != AUVID_OK) {
        return status;
    }
    memset(smoother, 0, sizeof *smoother);
    smoother->cfg = copy;
    return auvid_smoother_coefficients(copy.half_width, copy.order, copy.derivative, copy.dt_s, 0,
                                       smoother->c);
}

auvid_status_t auvid_smoother_reset(auvid_smoother_t *smoother)
{
    if (smoother == NULL) {
        return AUVID_ERR_NULL;
    }
    smoother->pushed = 0u;
    smoother->next = 0u;
    smoother->oldest = 0u;
    smoother->ended = false;
    return AUVID_OK;
}

auvid_status_t auvid_smoother_push(auvid_smoother_t *smoother, auvid_real_t x)
{
    if (smoother == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!auvid_is_finite(x)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (smoother->ended) {
        return AUVID_ERR_STATE;
    }
    uint16_t points = (uint16_t)(2u * smoother->cfg.half_width + 1u);
    smoother->window[smoother->oldest] = x;
    smoother->oldest = (uint16_t)(smoother->oldest + 1u == points ? 0u : smoother->oldest + 1u);
    ++smoother->pushed;
    if (smoother->pushed > points) { /* later windows give only their middle */
        smoother->next = smoother->pushed - 1u - smoother->cfg.half_width;
    }
    return smoother->pushed < points ? AUVID_EMPTY : AUVID_OK;
}

/* Adds c x over n samples. `rest` accumulates the rounding errors of `sum` (Neumaier 1974; Knuth's
 * exact error of one addition). At the end, sum + rest equals the rounded exact sum of the
 * products. */
typedef struct {
    auvid_real_t sum, rest;
} compensated_sum_t;

static inline void smoother_add_products(compensated_sum_t *total, const auvid_real_t *c,
                                         const auvid_real_t *x, int32_t n)
{
    auvid_real_t sum = total->sum;
    auvid_real_t rest = total->rest;
    for (int32_t i = 0; i < n; ++i) {
        auvid_real_t term = c[i] * x[i];
        auvid_real_t next = sum + term;
        auvid_real_t added = next - sum;
        rest += (sum - (next - added)) + (term - added);
        sum = next;
    }
    total->sum = sum;
    total->rest = rest;
}

/* sum_k c_k x_k over the window, for the output at this position. */
static auvid_real_t smoother_weighted_sum(const auvid_smoother_t *s, int32_t position)
{
    int32_t points = 2 * s->cfg.half_width + 1;
    int32_t first = points - s->oldest; /* samples up to the end of the ring */
    compensated_sum_t total = {AUVID_C(0.0), AUVID_C(0.0)};
    if (position == 0) {
        smoother_add_products(&total, s->c, &s->window[s->oldest], first);
        smoother_add_products(&total, &s->c[first], s->window, s->oldest);
        return total.sum + total.rest;
    }
    gram_t g;
    smoother_gram_prepare(&g, &s->cfg, position);
    for (int32_t k = 0; k < points; ++k) {
        auvid_real_t c = smoother_gram_coefficient(&g, k - s->cfg.half_width);
        smoother_add_products(&total, &c, &s->window[k < first ? k + s->oldest : k - first], 1);
    }
    return total.sum + total.rest;
}

auvid_status_t auvid_smoother_take(auvid_smoother_t *smoother, uint64_t *sample, auvid_real_t *y)
{
    if (smoother == NULL || y == NULL) {
        return AUVID_ERR_NULL;
    }
    uint64_t h = smoother->cfg.half_width;
    uint64_t ready =
        smoother->ended ? smoother->pushed : smoother->pushed - h; /* one past the last */
    if (smoother->pushed < 2u * h + 1u || smoother->next >= ready) {
        return AUVID_EMPTY;
    }
    int32_t position = (int32_t)(int64_t)(smoother->next + h + 1u - smoother->pushed);
    *y = smoother_weighted_sum(smoother, position);
    if (sample != NULL) {
        *sample = smoother->next;
    }
    ++smoother->next;
    return AUVID_OK;
}

auvid_status_t auvid_smoother_end(auvid_smoother_t *smoother)
{
    if (smoother == NULL) {
        return AUVID_ERR_NULL;
    }
    if (smoother->ended) {
        return AUVID_ERR_STATE;
    }
    if (smoother->pushed < 2u * smoother->cfg.half_width + 1u) {
        return AUVID_ERR_NO_DATA;
    }
    smoother->ended = true;
    return AUVID_OK;
}
