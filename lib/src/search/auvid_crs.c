/*
 * Controlled random search, Algorithm 1 of Karras et al., IROS 2013, after Brachetti et al. 1997.
 * Numbers in parentheses are the lines of Algorithm 1.
 *
 * Let d_j = J(theta_ij) - J_min, D = J_max - J_min, D0 the initial D. Then
 *     phi   = omega D^2 / D0
 *     eta_j = 1 / (d_j + phi),  w_j = eta_j / sum eta
 *     c     = sum w_j theta_ij                       over all n + 1 points drawn
 *     alpha = 1 - (d_0 - sum w_j d_j) / (D + phi)    the same as with J, as sum w_j = 1
 *     trial = c - alpha (theta_i0 - c)               i0 the worst of those drawn
 * Only differences of costs are used: in float32 the costs' common part would hide them.
 */
#include "auvid_crs_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "auvid_search_internal.h"

/* Minimum spread: 1 / (AUVID_EPSILON SPREAD_MIN), times 33 points, is finite in float32. */
#define SPREAD_MIN AUVID_C(1e-28)
/* phi <= omega D RATIO_MAX <= 1e9 * 2e24 * 1e3, finite in float32. D exceeds D0 only if J_min
 * falls while the worst initial point is still in S. */
#define RATIO_MAX AUVID_C(1e3)
/* Costs closer than this many units in the last place are indistinguishable. */
#define SPREAD_ULPS AUVID_C(4.0)

void auvid_crs_begin(auvid_optimizer_t *o)
{
    const auvid_search_config_t *c = &o->cfg;
    auvid_crs_t *crs = &o->crs;
    auvid_rng_t rng;
    auvid_rng_seed(&rng, c->seed);
    for (uint16_t k = 0; k < c->population; ++k) {
        crs->order[k] = k;
    }
    memcpy(crs->rng, rng.s, sizeof crs->rng);
    o->state = AUVID_OPTIMIZER_FRESH;
}

/* (3) Draw point k of S, when it is asked for. A known point takes the place of a random one. */
static void crs_draw_point(auvid_optimizer_t *o, uint32_t k)
{
    const auvid_search_config_t *c = &o->cfg;
    auvid_crs_t *crs = &o->crs;
    auvid_rng_t rng;
    memcpy(rng.s, crs->rng, sizeof rng.s);
    for (size_t i = 0; i < c->n; ++i) {
        auvid_real_t x = c->lower[i] + (c->upper[i] - c->lower[i]) * auvid_rng_uniform(&rng);
        if (k >= crs->known) {
            crs->theta[k][i] = auvid_min(x, c->upper[i]); /* the sum may round upwards */
        }
    }
    memcpy(crs->rng, rng.s, sizeof crs->rng);
}

/* (6) and the caps: the state after a cost or a rejection. */
static uint8_t crs_next_state(const auvid_optimizer_t *o)
{
    const auvid_crs_t *crs = &o->crs;
    auvid_real_t low = crs->cost[crs->best], high = crs->cost[crs->worst];
    auvid_real_t ulps = SPREAD_ULPS * AUVID_EPSILON * auvid_max(auvid_abs(low), auvid_abs(high));
    if (low >= AUVID_COST_FAILED) {
        return AUVID_OPTIMIZER_GLOBAL_CAPPED; /* the model failed everywhere */
    }
    if (auvid_search_is_certified(o, low) || high - low <= auvid_max(crs->last_spread, ulps)) {
        return AUVID_OPTIMIZER_GLOBAL_CONVERGED;
    }
    return o->work.crs >= o->cfg.max_evaluations_crs || crs->rejections >= o->cfg.max_rejections
               ? AUVID_OPTIMIZER_GLOBAL_CAPPED
               : AUVID_OPTIMIZER_GLOBAL;
}

/* (5) The best is updated with each cost; the worst needs a scan when it is replaced. */
static void crs_find_worst(auvid_optimizer_t *o)
{
    const auvid_real_t *worst = o->crs.cost, *end = worst + o->cfg.population;
    auvid_real_t high = *worst;
    for (const auvid_real_t *cost = worst + 1; cost < end; ++cost) {
        if (*cost > high) {
            high = *cost;
            worst = cost;
        }
    }
    o->crs.worst = (uint16_t)(worst - o->crs.cost);
}

/* All of S is evaluated: take D0 over the points that did not fail. */
static void crs_complete_population(auvid_optimizer_t *o)
{
    auvid_crs_t *crs = &o->crs;
    auvid_real_t low = crs->cost[crs->best], high = low;
    for (uint16_t k = 0; k < o->cfg.population; ++k) {
        if (crs->cost[k] < AUVID_COST_FAILED && crs->cost[k] > high) {
            high = crs->cost[k];
        }
    }
    crs->initial_spread = auvid_max(high - low, SPREAD_MIN);
    crs->last_spread = auvid_max(o->cfg.epsilon_crs, o->cfg.reduction * crs->initial_spread);
    crs->last_spread = auvid_max(crs->last_spread, SPREAD_MIN);
    crs_find_worst(o);
    o->state = crs_next_state(o);
}

/* The n + 1 points drawn, each with its weight, because the inner loop reads both. */
typedef struct {
    struct {
        const auvid_real_t *point;
        auvid_real_t eta;
    } of[AUVID_MAX_PARAMETERS + 1];
    auvid_real_t sum;     /* of eta */
    auvid_real_t d_worst; /* d of theta_i0 */
    uint32_t worst;       /* its index among the points */
} crs_simplex_t;

/* (9) n + 1 distinct points: the first steps of a Fisher-Yates shuffle of a permutation that is
 * kept. One random number serves two picks, 16 bits each: bias < m / 2^16. */
static void crs_draw(auvid_optimizer_t *o, auvid_real_t phi, crs_simplex_t *f)
{
    auvid_crs_t *crs = &o->crs;
    const auvid_real_t low = crs->cost[crs->best];
    const uint32_t n = o->cfg.n, m = o->cfg.population;
    auvid_real_t sum = AUVID_C(0.0), d_worst = AUVID_C(-1.0);
    uint32_t worst = 0, bits = 0;
    auvid_rng_t rng;
    memcpy(rng.s, crs->rng, sizeof rng.s);
    for (uint32_t j = 0; j <= n; ++j) {
        bits = j % 2u != 0 ? bits >> 16 : auvid_rng_next(&rng);
        uint32_t pick = j + (((bits & 0xffffu) * (m - j)) >> 16);
        uint16_t k = crs->order[pick];
        crs->order[pick] = crs->order[j];
        crs->order[j] = k;
        auvid_real_t d = crs->cost[k] - low;
        auvid_real_t eta = AUVID_C(1.0) / (d + phi);
        if (d > d_worst) {
            d_worst = d;
            worst = j;
        }
        f->of[j].point = crs->theta[k];
        f->of[j].eta = eta;
        sum += eta;
    }
    memcpy(crs->rng, rng.s, sizeof rng.s);
    f->sum = sum;
    f->d_worst = d_worst;
    f->worst = worst;
}

/* trial_i = factor sum_j eta_j theta_ij, i = first..first+3: four sums at once halve the loads. */
static void crs_combine_four(const crs_simplex_t *f, size_t n, size_t first, auvid_real_t factor,
                             auvid_real_t *trial)
{
    auvid_real_t a = AUVID_C(0.0), b = a, c = a, d = a;
    for (size_t j = 0; j <= n; ++j) {
        const auvid_real_t eta = f->of[j].eta, *x = f->of[j].point + first;
        a += eta * x[0];
        b += eta * x[1];
        c += eta * x[2];
        d += eta * x[3];
    }
    trial[first] = factor * a;
    trial[first + 1] = factor * b;
    trial[first + 2] = factor * c;
    trial[first + 3] = factor * d;
}

static void crs_combine_one(const crs_simplex_t *f, size_t n, size_t i, auvid_real_t factor,
                            auvid_real_t *trial)
{
    auvid_real_t a = AUVID_C(0.0);
    for (size_t j = 0; j <= n; ++j) {
        a += f->of[j].eta * f->of[j].point[i];
    }
    trial[i] = factor * a;
}

/* (10, 11) Write the trial and return whether it is in the box. Since eta_j d_j = 1 - phi eta_j,
 * the mean of the d_j is (n + 1) / sum - phi. Centroid and reflection are one weighted sum:
 *     c - alpha (theta_i0 - c) = factor sum eta_j theta_ij,   factor = (1 + alpha) / sum,
 * with eta_0 reduced by alpha / factor. d_0 <= D, hence alpha >= 0 and factor > 0. */
static bool crs_reflect(auvid_optimizer_t *o)
{
    crs_simplex_t f;
    const auvid_crs_t *crs = &o->crs;
    const size_t n = o->cfg.n;
    const auvid_real_t d = crs->cost[crs->worst] - crs->cost[crs->best];
    const auvid_real_t ratio = auvid_min(d / crs->initial_spread, RATIO_MAX);
    const auvid_real_t phi = auvid_max(o->cfg.omega * d * ratio, AUVID_EPSILON * d);

    crs_draw(o, phi, &f);
    const auvid_real_t mean = (auvid_real_t)(int32_t)(n + 1u) / f.sum - phi;
    const auvid_real_t alpha = AUVID_C(1.0) - (f.d_worst - mean) / (d + phi);
    const auvid_real_t factor = (AUVID_C(1.0) + alpha) / f.sum;
    f.of[f.worst].eta -= alpha / factor;
    size_t i = 0;
    for (; i + 4 <= n; i += 4) {
        crs_combine_four(&f, n, i, factor, o->trial);
    }
    for (; i < n; ++i) {
        crs_combine_one(&f, n, i, factor, o->trial);
    }
    return auvid_search_inside(&o->cfg, o->trial);
}

/* (12) Make a trial. If it is outside the box, the next ask makes another one. */
static auvid_status_t crs_make_trial(auvid_optimizer_t *o)
{
    if (crs_reflect(o)) {
        o->crs.rejections = 0;
        return AUVID_OK;
    }
    ++o->crs.rejections;
    o->state = crs_next_state(o);
    return o->state == AUVID_OPTIMIZER_GLOBAL ? AUVID_PENDING : AUVID_EVALUATION_LIMIT;
}

auvid_status_t auvid_crs_next(auvid_optimizer_t *o)
{
    if (o->state == AUVID_OPTIMIZER_GLOBAL_CONVERGED) {
        return AUVID_FINISHED;
    }
    if (o->state == AUVID_OPTIMIZER_GLOBAL_CAPPED) {
        return AUVID_EVALUATION_LIMIT;
    }
    ++o->work.attempts;
    if (o->state == AUVID_OPTIMIZER_GLOBAL) {
        return crs_make_trial(o);
    }
    o->state = AUVID_OPTIMIZER_FILL;
    crs_draw_point(o, o->work.crs);
    memcpy(o->trial, o->crs.theta[o->work.crs], sizeof o->trial);
    return AUVID_OK;
}

void auvid_crs_take(auvid_optimizer_t *o, auvid_real_t cost)
{
    auvid_crs_t *crs = &o->crs;
    const uint32_t k = o->work.crs++;
    if (o->state == AUVID_OPTIMIZER_FILL) {
        crs->cost[k] = cost;
        crs->best = cost < crs->cost[crs->best] ? (uint16_t)k : crs->best;
        if (o->work.crs == o->cfg.population) {
            crs_complete_population(o);
        }
        return;
    }
    if (cost < crs->cost[crs->worst]) { /* (17-20) */
        memcpy(crs->theta[crs->worst], o->trial, sizeof o->trial);
        crs->cost[crs->worst] = cost;
        crs->best = cost < crs->cost[crs->best] ? crs->worst : crs->best;
        crs_find_worst(o);
    }
    o->state = crs_next_state(o);
}
