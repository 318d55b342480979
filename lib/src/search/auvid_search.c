/*
 * The configuration of a search: defaults, checks, and what zeros stand for.
 */
#include "auvid_search_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"

#define OMEGA_MAX AUVID_C(1e9)
/* The global phase only has to find the region, so a small phi makes it fast. It takes 45 % of the
 * evaluations of omega = n to a spread of 1e-2. For functions with many minima it finds the lowest
 * at least as often. */
#define OMEGA AUVID_C(2.0)
#define REDUCTION AUVID_C(0.05)

void auvid_search_defaults(auvid_search_config_t *cfg, uint8_t n)
{
    if (cfg == NULL) {
        return;
    }
    memset(cfg, 0, sizeof *cfg);
    for (size_t i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        cfg->lower[i] = AUVID_C(-1000.0);
        cfg->upper[i] = AUVID_C(1000.0);
    }
    cfg->seed = 1u;
    cfg->epsilon_crs = AUVID_C(1e-2);
    cfg->delta = AUVID_C(2.0);
    cfg->gamma = AUVID_C(1e-6);
    cfg->n = n;
    cfg->phases = AUVID_MAX_POPULATION > 0 ? AUVID_SEARCH_BOTH : AUVID_SEARCH_LOCAL;
    cfg->restarts = 1;
}

/* alpha0, sigma, epsilon_line: as given, or what zero stands for. */
static void search_steps(const auvid_search_config_t *c, auvid_real_t step[3])
{
    static const auvid_real_t defaults[2][3] = {{AUVID_C(0.35), AUVID_C(0.09), AUVID_C(3e-6)},
                                                {AUVID_C(0.05), AUVID_C(0.5), AUVID_C(3e-5)}};
    const auvid_real_t given[3] = {c->alpha0, c->sigma, c->epsilon_line};
    for (size_t i = 0; i < 3; ++i) {
        step[i] = given[i] > AUVID_C(0.0) ? given[i] : defaults[c->paper][i];
    }
}

static uint32_t search_population(const auvid_search_config_t *c)
{
    uint32_t n = c->n, m = 4u * n > n + 2u ? 4u * n : n + 2u;
    m = m <= AUVID_MAX_POPULATION ? m : AUVID_MAX_POPULATION;
    return c->population != 0 ? c->population : m;
}

static uint32_t search_cap(uint32_t given, uint32_t otherwise)
{
    return given != 0 ? given : otherwise;
}

void auvid_search_resolve(auvid_search_config_t *c)
{
    auvid_real_t step[3];
    search_steps(c, step);
    c->population = (uint16_t)search_population(c);
    if (!(c->omega > AUVID_C(0.0))) {
        c->omega = c->paper ? (auvid_real_t)c->n : OMEGA;
        c->reduction = c->paper ? c->reduction : auvid_max(c->reduction, REDUCTION);
    }
    c->alpha0 = step[0];
    c->sigma = step[1];
    c->epsilon_line = step[2];
    c->max_evaluations_crs = search_cap(c->max_evaluations_crs, 40u * c->population);
    c->max_evaluations_line = search_cap(c->max_evaluations_line, 1000u * c->n);
    c->max_rejections = search_cap(c->max_rejections, 50u * c->population);
}

void auvid_search_check_fields(const auvid_search_config_t *c, auvid_refusal_t *why)
{
#define BELOW_1 (AUVID_C(1.0) - AUVID_EPSILON / 2)
#define REAL_IN(name, low, high) REALS_IN(auvid_search_config_t, name, 1, low, high)
    static const auvid_field_t fields[] = {
        REAL_IN(epsilon_crs, AUVID_C(0.0), AUVID_LARGEST),
        REAL_IN(omega, AUVID_C(0.0), OMEGA_MAX),
        REAL_IN(reduction, AUVID_C(0.0), BELOW_1),
        REAL_IN(alpha0, AUVID_C(0.0), AUVID_C(1e3)),
        REAL_IN(sigma, AUVID_C(0.0), BELOW_1),
        REALS_ABOVE(auvid_search_config_t, delta, 1, AUVID_C(1.0), AUVID_C(100.0)),
        REAL_IN(gamma, AUVID_C(0.0), BELOW_1),
        REAL_IN(epsilon_line, AUVID_C(0.0), AUVID_C(1e-3)),
        WHOLE_IN(auvid_search_config_t, phases, 1, AUVID_SEARCH_BOTH, AUVID_SEARCH_LOCAL),
    };
    const uint32_t m = search_population(c);
    auvid_check_count(why, AUVID_ERR_PARAMETERS, "n", c->n, AUVID_MAX_PARAMETERS);
    auvid_check_limit(why, AUVID_MAX_POPULATION > 0 || c->phases == AUVID_SEARCH_LOCAL,
                      AUVID_ERR_POPULATION, "phases: AUVID_MAX_POPULATION", (auvid_real_t)c->phases,
                      (auvid_real_t)AUVID_SEARCH_LOCAL);
    auvid_check_limit(why, (m > c->n || AUVID_MAX_POPULATION == 0) && m <= AUVID_MAX_POPULATION,
                      AUVID_ERR_POPULATION, "population", (auvid_real_t)m,
                      (auvid_real_t)(m > c->n ? AUVID_MAX_POPULATION : c->n + 1));
    for (int i = 0; i < c->n && why->status == AUVID_OK; ++i) {
        const auvid_real_t low = c->lower[i], high = c->upper[i];
        auvid_check_element(why, i);
        auvid_check_in(why, "lower", low, -SEARCH_BOUND_MAX, SEARCH_BOUND_MAX);
        auvid_check_in(why, "upper", high, -SEARCH_BOUND_MAX, SEARCH_BOUND_MAX);
        auvid_check_limit(why, !c->has_good || auvid_is_finite(c->good[i]), AUVID_ERR_NOT_FINITE,
                          "good", c->good[i], high);
        auvid_check_limit(why, low < high, AUVID_ERR_BOUNDS, "lower", low, high);
    }
    auvid_check_element(why, -1);
    AUVID_CHECK_TABLE(why, c, fields);
    auvid_real_t step[3];
    search_steps(c, step);
    auvid_check_limit(why, step[0] > step[2], AUVID_ERR_RANGE, "alpha0", step[0], step[2]);
}

auvid_status_t auvid_search_check(const auvid_search_config_t *cfg)
{
    auvid_refusal_t why;
    if (cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_check_begin(&why);
    auvid_search_check_fields(cfg, &why);
    return why.status;
}

bool auvid_search_is_certified(const auvid_optimizer_t *o, auvid_real_t cost)
{
    auvid_real_t excess = cost - o->least;
    return o->certified && excess <= o->allowed && -excess <= o->allowed;
}

bool auvid_search_inside(const auvid_search_config_t *c, const auvid_real_t *theta)
{
    for (size_t i = 0; i < c->n; ++i) {
        if (!(theta[i] >= c->lower[i] && theta[i] <= c->upper[i])) {
            return false;
        }
    }
    return true;
}

void auvid_search_clip(const auvid_search_config_t *c, const auvid_real_t *theta, auvid_real_t *to)
{
    for (size_t i = 0; i < c->n; ++i) {
        to[i] = auvid_clamp_here(theta[i], c->lower[i], c->upper[i]);
    }
}
