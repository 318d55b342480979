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
#include "../base/auvid_refusal_internal.h"

/* Minimum spread: 1 / (AUVID_EPSILON SPREAD_MIN), times 33 points, is finite in float32. */
#define SPREAD_MIN AUVID_C(1e-28)
/* phi <= omega D RATIO_MAX <= 1e9 * 2e24 * 1e3, finite in float32. D exceeds D0 only if J_min
 * falls while the worst initial point is still in S. */
#define RATIO_MAX AUVID_C(1e3)
#define OMEGA_MAX AUVID_C(1e9)
/* A box of this width has a finite width and finite trials. */
#define BOUND_MAX AUVID_C(1e18)
/* Costs closer than this many units in the last place are indistinguishable. */
#define SPREAD_ULPS AUVID_C(4.0)

void auvid_crs_defaults(auvid_crs_config_t *cfg, uint8_t n)
{
    if (cfg == NULL) {
        return;
    }
    memset(cfg, 0, sizeof *cfg);
    cfg->n = n;
    cfg->epsilon = AUVID_C(1e-2);
    cfg->seed = 1u;
}

static uint32_t crs_default_population(uint32_t n)
{
    uint32_t m = 4u * n > n + 2u ? 4u * n : n + 2u;
    return m < AUVID_MAX_POPULATION ? m : AUVID_MAX_POPULATION;
}

auvid_status_t auvid_crs_check_fields(const auvid_crs_config_t *c, auvid_refusal_t *why)
{
    static const auvid_field_t fields[] = {
        REALS_IN(auvid_crs_config_t, epsilon, 1, AUVID_C(0.0), AUVID_LARGEST),
        REALS_IN(auvid_crs_config_t, omega, 1, AUVID_C(0.0), OMEGA_MAX),
        REALS_IN(auvid_crs_config_t, reduction, 1, AUVID_C(0.0), AUVID_C(1.0) - AUVID_EPSILON / 2),
    };
    if (c->n < 1 || c->n > AUVID_MAX_PARAMETERS) {
        return auvid_refuse(why, AUVID_ERR_PARAMETERS, "n", (auvid_real_t)c->n,
                            (auvid_real_t)(c->n < 1 ? 1 : AUVID_MAX_PARAMETERS));
    }
    uint32_t m = c->population != 0 ? c->population : crs_default_population(c->n);
    if (m < (uint32_t)c->n + 1u || m > AUVID_MAX_POPULATION) {
        return auvid_refuse(
            why, AUVID_ERR_POPULATION, "population", (auvid_real_t)m,
            (auvid_real_t)(m > AUVID_MAX_POPULATION ? AUVID_MAX_POPULATION : c->n + 1));
    }
    for (int i = 0; i < c->n; ++i) {
        auvid_real_t low = c->lower[i], high = c->upper[i];
        auvid_status_t status = AUVID_OK;
        if (!(auvid_abs(low) <= BOUND_MAX)) {
            status = auvid_is_finite(low) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
            (void)auvid_refuse(why, status, "lower", low, -BOUND_MAX);
        } else if (!(auvid_abs(high) <= BOUND_MAX)) {
            status = auvid_is_finite(high) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
            (void)auvid_refuse(why, status, "upper", high, BOUND_MAX);
        } else if (!(low < high)) {
            status = auvid_refuse(why, AUVID_ERR_BOUNDS, "lower", low, high);
        }
        if (status != AUVID_OK) {
            return auvid_refuse_element(why, status, i);
        }
    }
    return auvid_check_fields(c, fields, sizeof fields / sizeof fields[0], why);
}

auvid_status_t auvid_crs_check(const auvid_crs_config_t *cfg)
{
    return cfg == NULL ? AUVID_ERR_NULL : auvid_crs_check_fields(cfg, NULL);
}

auvid_status_t auvid_crs_init(auvid_crs_t *crs, const auvid_crs_config_t *cfg)
{
    auvid_rng_t rng;
    if (crs == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_crs_check(cfg);
    if (status != AUVID_OK) {
        return status;
    }
    memset(crs, 0, sizeof *crs);
    crs->cfg = *cfg;
    auvid_crs_config_t *c = &crs->cfg;
    if (c->population == 0) {
        c->population = (uint16_t)crs_default_population(c->n);
    }
    if (!(c->omega > AUVID_C(0.0))) {
        c->omega = (auvid_real_t)c->n;
    }
    if (c->max_evaluations == 0) {
        c->max_evaluations = 40u * c->population;
    }
    if (c->max_rejections == 0) {
        c->max_rejections = 50u * c->population;
    }
    auvid_rng_seed(&rng, c->seed);
    for (uint16_t k = 0; k < c->population; ++k) { /* (3) */
        crs->order[k] = k;
        for (size_t i = 0; i < c->n; ++i) {
            auvid_real_t x = c->lower[i] + (c->upper[i] - c->lower[i]) * auvid_rng_uniform(&rng);
            crs->theta[k][i] = auvid_min(x, c->upper[i]); /* the sum may round upwards */
        }
    }
    memcpy(crs->rng, rng.s, sizeof crs->rng);
    crs->state = CRS_FRESH;
    return AUVID_OK;
}

static bool crs_inside(const auvid_crs_config_t *c, const auvid_real_t *theta)
{
    for (size_t i = 0; i < c->n; ++i) {
        if (!(theta[i] >= c->lower[i] && theta[i] <= c->upper[i])) {
            return false;
        }
    }
    return true;
}

auvid_status_t auvid_crs_add_point(auvid_crs_t *crs, const auvid_real_t *theta)
{
    if (crs == NULL || theta == NULL) {
        return AUVID_ERR_NULL;
    }
    if (crs->state != CRS_FRESH) {
        return AUVID_ERR_STATE;
    }
    if (crs->known == crs->cfg.population) {
        return AUVID_ERR_POPULATION;
    }
    if (!auvid_all_finite(theta, crs->cfg.n)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (!crs_inside(&crs->cfg, theta)) {
        return AUVID_ERR_RANGE;
    }
    memcpy(crs->theta[crs->known++], theta, crs->cfg.n * sizeof *theta);
    return AUVID_OK;
}

/* (6) and the caps: the state after a cost or a rejection. */
static uint8_t crs_next_state(const auvid_crs_t *crs)
{
    auvid_real_t low = crs->cost[crs->best], high = crs->cost[crs->worst];
    auvid_real_t ulps = SPREAD_ULPS * AUVID_EPSILON * auvid_max(auvid_abs(low), auvid_abs(high));
    auvid_real_t limit = auvid_max(crs->last_spread, ulps);
    if (low >= AUVID_CRS_COST_FAILED) {
        return CRS_CAPPED; /* the model failed everywhere */
    }
    if (high - low <= limit) {
        return CRS_FINISHED;
    }
    if (crs->evaluations - crs->extra_evaluations >= crs->cfg.max_evaluations ||
        crs->rejections >= crs->cfg.max_rejections) {
        return CRS_CAPPED;
    }
    return CRS_SEARCH;
}

/* (5) The best is updated with each cost; the worst needs a scan when it is replaced. */
static void crs_find_worst(auvid_crs_t *crs)
{
    const auvid_real_t *worst = crs->cost, *end = worst + crs->cfg.population;
    auvid_real_t high = *worst;
    for (const auvid_real_t *cost = worst + 1; cost < end; ++cost) {
        if (*cost > high) {
            high = *cost;
            worst = cost;
        }
    }
    crs->worst = (uint16_t)(worst - crs->cost);
}

/* All of S is evaluated: take D0 over the points that did not fail. */
static void crs_complete_population(auvid_crs_t *crs)
{
    auvid_real_t low = crs->cost[crs->best], high = low;
    for (uint16_t k = 0; k < crs->cfg.population; ++k) {
        if (crs->cost[k] < AUVID_CRS_COST_FAILED && crs->cost[k] > high) {
            high = crs->cost[k];
        }
    }
    crs->initial_spread = auvid_max(high - low, SPREAD_MIN);
    if (!crs->reevaluating) {
        crs->last_spread = auvid_max(crs->cfg.epsilon, crs->cfg.reduction * crs->initial_spread);
        crs->last_spread = auvid_max(crs->last_spread, SPREAD_MIN);
    }
    crs_find_worst(crs);
    crs->state = crs_next_state(crs);
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
static void crs_draw(auvid_crs_t *crs, auvid_real_t phi, crs_simplex_t *f)
{
    const auvid_real_t low = crs->cost[crs->best];
    const uint32_t n = crs->cfg.n, m = crs->cfg.population;
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
static bool crs_reflect(auvid_crs_t *crs)
{
    crs_simplex_t f;
    const size_t n = crs->cfg.n;
    const auvid_real_t d = crs->cost[crs->worst] - crs->cost[crs->best];
    const auvid_real_t ratio = auvid_min(d / crs->initial_spread, RATIO_MAX);
    const auvid_real_t phi = auvid_max(crs->cfg.omega * d * ratio, AUVID_EPSILON * d);

    crs_draw(crs, phi, &f);
    const auvid_real_t mean = (auvid_real_t)(int32_t)(n + 1u) / f.sum - phi;
    const auvid_real_t alpha = AUVID_C(1.0) - (f.d_worst - mean) / (d + phi);
    const auvid_real_t factor = (AUVID_C(1.0) + alpha) / f.sum;
    f.of[f.worst].eta -= alpha / factor;
    size_t i = 0;
    for (; i + 4 <= n; i += 4) {
        crs_combine_four(&f, n, i, factor, crs->trial);
    }
    for (; i < n; ++i) {
        crs_combine_one(&f, n, i, factor, crs->trial);
    }
    return crs_inside(&crs->cfg, crs->trial);
}

/* (12) Make a trial. If it is outside the box, the next ask makes another one. */
static auvid_status_t crs_make_trial(auvid_crs_t *crs)
{
    ++crs->attempts;
    if (!crs_reflect(crs)) {
        ++crs->rejections;
        if (crs->rejections > crs->max_rejections_seen) {
            crs->max_rejections_seen = crs->rejections;
        }
        crs->state = crs_next_state(crs);
        return crs->state == CRS_SEARCH ? AUVID_PENDING : AUVID_EVALUATION_LIMIT;
    }
    crs->rejections = 0;
    return AUVID_OK;
}

/* Index of the next point of S to evaluate: in order, after auvid_crs_reevaluate from the best one
 * on, so that the best always has a known cost. */
static uint16_t crs_fill_index(const auvid_crs_t *crs)
{
    uint32_t k = (uint32_t)crs->first + crs->filled;
    return (uint16_t)(k < crs->cfg.population ? k : k - crs->cfg.population);
}

auvid_status_t auvid_crs_ask(auvid_crs_t *crs, auvid_real_t *theta)
{
    if (crs == NULL || theta == NULL) {
        return AUVID_ERR_NULL;
    }
    if (crs->state == CRS_NONE) {
        return AUVID_ERR_STATE;
    }
    if (!crs->asked) {
        if (crs->state == CRS_FINISHED) {
            return AUVID_FINISHED;
        }
        if (crs->state == CRS_CAPPED) {
            return AUVID_EVALUATION_LIMIT;
        }
        if (crs->state == CRS_SEARCH) {
            auvid_status_t status = crs_make_trial(crs);
            if (status != AUVID_OK) {
                return status;
            }
        } else {
            crs->state = CRS_FILL;
            ++crs->attempts;
            memcpy(crs->trial, crs->theta[crs_fill_index(crs)], sizeof crs->trial);
        }
        crs->asked = true;
    }
    memcpy(theta, crs->trial, crs->cfg.n * sizeof *theta);
    return AUVID_OK;
}

auvid_status_t auvid_crs_tell(auvid_crs_t *crs, auvid_real_t cost)
{
    if (crs == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!crs->asked) {
        return AUVID_ERR_STATE;
    }
    if (!(cost >= -AUVID_CRS_COST_FAILED && cost <= AUVID_CRS_COST_FAILED)) {
        cost = AUVID_CRS_COST_FAILED;
    }
    crs->asked = false;
    ++crs->evaluations;
    if (crs->state == CRS_FILL) {
        uint16_t k = crs_fill_index(crs);
        crs->cost[k] = cost;
        crs->best = crs->filled == 0 || cost < crs->cost[crs->best] ? k : crs->best;
        crs->extra_evaluations += crs->reevaluating ? 1u : 0u;
        if (++crs->filled == crs->cfg.population) {
            crs_complete_population(crs);
        }
        return AUVID_OK;
    }
    if (cost < crs->cost[crs->worst]) { /* (17-20) */
        memcpy(crs->theta[crs->worst], crs->trial, sizeof crs->trial);
        crs->cost[crs->worst] = cost;
        crs->best = cost < crs->cost[crs->best] ? crs->worst : crs->best;
        crs_find_worst(crs);
    }
    crs->state = crs_next_state(crs);
    return AUVID_OK;
}

auvid_status_t auvid_crs_reevaluate(auvid_crs_t *crs)
{
    if (crs == NULL) {
        return AUVID_ERR_NULL;
    }
    if (crs->state == CRS_NONE) {
        return AUVID_ERR_STATE;
    }
    /* If S was not complete, the evaluation starts over and is not an extra. */
    crs->reevaluating = crs->reevaluating || crs->state > CRS_FILL;
    crs->asked = false;
    crs->rejections = 0;
    crs->first = crs->evaluations > 0 ? crs->best : 0;
    crs->filled = 0;
    crs->state = crs->state == CRS_FRESH ? CRS_FRESH : CRS_FILL;
    return AUVID_OK;
}

const auvid_real_t *auvid_crs_best(const auvid_crs_t *crs, auvid_real_t *cost)
{
    if (crs == NULL || crs->state == CRS_NONE || crs->evaluations == 0) {
        return NULL;
    }
    if (cost != NULL) {
        *cost = crs->cost[crs->best];
    }
    return crs->theta[crs->best];
}
