/*
 * Composition of Algorithms 1 and 2 of Karras et al., IROS 2013, Section III-C: the best point of
 * the global phase is the start of the local one.
 */
#include "auvid/detail/optimizer.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "auvid_crs_internal.h"
#include "auvid_line_search_internal.h"
#include "auvid_search_internal.h"

static bool optimizer_is_global(const auvid_optimizer_t *o)
{
    return AUVID_MAX_POPULATION > 0 && o->state < AUVID_OPTIMIZER_START;
}

auvid_status_t auvid_optimizer_init(auvid_optimizer_t *o, const auvid_search_config_t *cfg,
                                    const auvid_real_t *scale)
{
    if (o == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_search_check(cfg);
    for (size_t i = 0; status >= 0 && scale != NULL && i < cfg->n; ++i) {
        if (!(scale[i] >= AUVID_C(0.0) && scale[i] <= SEARCH_BOUND_MAX)) {
            status = auvid_is_finite(scale[i]) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
        }
    }
    if (status < 0) {
        return status;
    }
    o->cfg = *cfg; /* may be the same */
    const size_t before = offsetof(auvid_optimizer_t, cfg), after = before + sizeof o->cfg;
    memset(o, 0, before);
    memset((unsigned char *)o + after, 0, sizeof *o - after);
    auvid_search_config_t *c = &o->cfg;
    auvid_search_resolve(c);
    for (size_t i = 0; i < c->n; ++i) {
        auvid_real_t low = c->lower[i], high = c->upper[i];
        bool given = scale != NULL && scale[i] > AUVID_C(0.0);
        o->scale[i] = given ? scale[i] : (high - low) * AUVID_C(0.5);
        o->trial[i] =
            auvid_clamp(c->has_good ? c->good[i] : (low + high) * AUVID_C(0.5), low, high);
    }
    if (AUVID_MAX_POPULATION == 0 || c->phases == AUVID_SEARCH_LOCAL) {
        auvid_line_search_begin(o, AUVID_C(0.0));
        return AUVID_OK;
    }
    auvid_crs_begin(o);
    return c->has_good ? auvid_optimizer_add_point(o, c->good) : AUVID_OK;
}

auvid_status_t auvid_optimizer_add_point(auvid_optimizer_t *o, const auvid_real_t *theta)
{
    if (o == NULL || theta == NULL) {
        return AUVID_ERR_NULL;
    }
    if (AUVID_MAX_POPULATION == 0 || o->state != AUVID_OPTIMIZER_FRESH) {
        return AUVID_ERR_STATE;
    }
    if (o->crs.known == o->cfg.population) {
        return AUVID_ERR_POPULATION;
    }
    if (!auvid_all_finite(theta, o->cfg.n)) {
        return AUVID_ERR_NOT_FINITE;
    }
    auvid_search_clip(&o->cfg, theta, o->crs.theta[o->crs.known++]);
    return AUVID_OK;
}

auvid_status_t auvid_optimizer_set_goal(auvid_optimizer_t *o, auvid_real_t cost)
{
    if (o == NULL) {
        return AUVID_ERR_NULL;
    }
    if (o->state != AUVID_OPTIMIZER_START || o->asked || o->certified) {
        return AUVID_ERR_STATE;
    }
    if (!auvid_is_finite(cost)) {
        return AUVID_ERR_NOT_FINITE;
    }
    o->least = cost;
    o->has_goal = true;
    return AUVID_OK;
}

auvid_status_t auvid_optimizer_certify(auvid_optimizer_t *o, const auvid_real_t *theta,
                                       auvid_real_t least, auvid_real_t allowed)
{
    if (o == NULL || theta == NULL) {
        return AUVID_ERR_NULL;
    }
    bool global = AUVID_MAX_POPULATION > 0 && o->state == AUVID_OPTIMIZER_FRESH;
    if (!global && (o->state != AUVID_OPTIMIZER_START || o->asked)) {
        return AUVID_ERR_STATE;
    }
    if (!auvid_all_finite(theta, o->cfg.n) || !auvid_is_finite(least) ||
        !auvid_is_finite(allowed)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (!(allowed >= AUVID_C(0.0))) {
        return AUVID_ERR_RANGE;
    }
    auvid_search_clip(&o->cfg, theta, o->trial);
    o->least = least;
    o->allowed = allowed;
    o->certified = true;
    o->has_goal = false;
    if (global) {
        uint16_t last = (uint16_t)(o->cfg.population - 1u);
        last = o->crs.known < last ? o->crs.known : last;
        memcpy(o->crs.theta[last], o->trial, sizeof o->trial);
        o->crs.known = (uint16_t)(last + 1u);
    } else {
        auvid_line_search_begin(o, AUVID_C(0.0));
    }
    return AUVID_OK;
}

auvid_status_t auvid_optimizer_ask(auvid_optimizer_t *o, auvid_real_t *theta)
{
    auvid_status_t status = AUVID_OK;
    if (o == NULL || theta == NULL) {
        return AUVID_ERR_NULL;
    }
    if (o->state == AUVID_OPTIMIZER_NONE) {
        return AUVID_ERR_STATE;
    }
    if (!o->asked && optimizer_is_global(o)) {
        status = auvid_crs_next(o);
        if (o->state > AUVID_OPTIMIZER_GLOBAL && o->cfg.phases == AUVID_SEARCH_BOTH) {
            memcpy(o->trial, o->crs.theta[o->crs.best], sizeof o->trial);
            auvid_line_search_begin(o, o->crs.cost[o->crs.best]);
        }
    }
    if (!o->asked && !optimizer_is_global(o)) {
        status = auvid_line_search_next(o);
    }
    if (status == AUVID_OK) {
        o->asked = true;
        memcpy(theta, o->trial, o->cfg.n * sizeof *theta);
    }
    return status;
}

auvid_status_t auvid_optimizer_tell(auvid_optimizer_t *o, auvid_real_t cost)
{
    if (o == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!o->asked) {
        return AUVID_ERR_STATE;
    }
    if (!(cost >= -AUVID_COST_FAILED && cost <= AUVID_COST_FAILED)) {
        cost = AUVID_COST_FAILED;
    }
    o->asked = false;
    if (optimizer_is_global(o)) {
        auvid_crs_take(o, cost);
    } else {
        auvid_line_search_take(o, cost);
    }
    return AUVID_OK;
}

const auvid_real_t *auvid_optimizer_best(const auvid_optimizer_t *o, auvid_real_t *cost)
{
    if (o == NULL || o->work.crs + o->work.line_search == 0) {
        return NULL;
    }
    bool global = optimizer_is_global(o);
    if (cost != NULL) {
        *cost = global ? o->crs.cost[o->crs.best] : o->line_search.cost;
    }
    return global ? o->crs.theta[o->crs.best] : o->line_search.theta;
}
