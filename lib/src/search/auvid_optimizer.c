/*
 * Composition of Algorithms 1 and 2 of Karras et al., IROS 2013, Section III-C: the best point of
 * the global phase is the start of the local one.
 */
#include "auvid/detail/optimizer.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "auvid_optimizer_internal.h"

/* The global phase only has to find the region, so a small phi makes it fast. It takes 45 % of the
 * evaluations of omega = n to a spread of 1e-2. For functions with many minima it finds the lowest
 * at least as often. */
#define OMEGA AUVID_C(2.0)
#define REDUCTION AUVID_C(0.05)

void auvid_optimizer_defaults(auvid_optimizer_config_t *cfg, uint8_t n)
{
    if (cfg == NULL) {
        return;
    }
    memset(cfg, 0, sizeof *cfg);
    auvid_crs_defaults(&cfg->crs, n);
    auvid_line_search_defaults(&cfg->line_search, n);
}

auvid_status_t auvid_optimizer_init(auvid_optimizer_t *optimizer,
                                    const auvid_optimizer_config_t *cfg)
{
    if (optimizer == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_optimizer_config_t copy = *cfg;
    return auvid_optimizer_begin(optimizer, &copy);
}

auvid_status_t auvid_optimizer_begin(auvid_optimizer_t *optimizer, auvid_optimizer_config_t *cfg)
{
    auvid_status_t status = auvid_crs_check(&cfg->crs);
    if (status != AUVID_OK) {
        return status;
    }
    auvid_line_search_config_t *local = &cfg->line_search;
    local->n = cfg->crs.n;
    memcpy(local->lower, cfg->crs.lower, sizeof local->lower);
    memcpy(local->upper, cfg->crs.upper, sizeof local->upper);
    memcpy(local->scale, cfg->scale, sizeof local->scale);
    memcpy(local->start, cfg->crs.lower, sizeof local->start); /* until a better one is known */
    status = auvid_line_search_init(&optimizer->line_search, local); /* only to check it */
    if (status != AUVID_OK) {
        return status;
    }
    optimizer->local = *local;
    optimizer->phase = AUVID_OPTIMIZER_GLOBAL;
    status = auvid_crs_init(&optimizer->crs, &cfg->crs);
    if (!local->paper && !(cfg->crs.omega > AUVID_C(0.0))) {
        optimizer->crs.cfg.omega = OMEGA;
        optimizer->crs.cfg.reduction = auvid_max(cfg->crs.reduction, REDUCTION);
    }
    return status;
}

auvid_status_t auvid_optimizer_add_point(auvid_optimizer_t *optimizer, const auvid_real_t *theta)
{
    return optimizer == NULL ? AUVID_ERR_NULL : auvid_crs_add_point(&optimizer->crs, theta);
}

static auvid_status_t optimizer_ask_local(auvid_optimizer_t *optimizer, auvid_real_t *theta)
{
    auvid_status_t status = auvid_line_search_ask(&optimizer->line_search, theta);
    if (status == AUVID_FINISHED || status == AUVID_EVALUATION_LIMIT) {
        optimizer->phase = AUVID_OPTIMIZER_DONE;
    }
    return status;
}

auvid_status_t auvid_optimizer_ask(auvid_optimizer_t *optimizer, auvid_real_t *theta)
{
    if (optimizer == NULL || theta == NULL) {
        return AUVID_ERR_NULL;
    }
    if (optimizer->phase != AUVID_OPTIMIZER_GLOBAL) {
        return optimizer_ask_local(optimizer, theta);
    }
    auvid_status_t status = auvid_crs_ask(&optimizer->crs, theta);
    if (status != AUVID_FINISHED && status != AUVID_EVALUATION_LIMIT) {
        return status;
    }
    /* In both cases S is complete, so there is a best point in the box. */
    optimizer->evaluations = optimizer->crs.evaluations;
    optimizer->attempts = optimizer->crs.attempts;
    memcpy(optimizer->local.start, auvid_crs_best(&optimizer->crs, &optimizer->cost),
           optimizer->local.n * sizeof *theta);
    status = auvid_line_search_init(&optimizer->line_search, &optimizer->local);
    if (status != AUVID_OK) {
        return AUVID_ERR_RANGE; /* damaged since init: the best point of the global phase stays */
    }
    optimizer->phase = AUVID_OPTIMIZER_LOCAL;
    return optimizer_ask_local(optimizer, theta);
}

auvid_status_t auvid_optimizer_tell(auvid_optimizer_t *optimizer, auvid_real_t cost)
{
    if (optimizer == NULL) {
        return AUVID_ERR_NULL;
    }
    return optimizer->phase == AUVID_OPTIMIZER_GLOBAL
               ? auvid_crs_tell(&optimizer->crs, cost)
               : auvid_line_search_tell(&optimizer->line_search, cost);
}

auvid_status_t auvid_optimizer_reevaluate(auvid_optimizer_t *optimizer)
{
    if (optimizer == NULL) {
        return AUVID_ERR_NULL;
    }
    if (optimizer->phase == AUVID_OPTIMIZER_GLOBAL) {
        return auvid_crs_reevaluate(&optimizer->crs);
    }
    optimizer->phase = AUVID_OPTIMIZER_LOCAL;
    return auvid_line_search_reevaluate(&optimizer->line_search);
}

auvid_optimizer_phase_t auvid_optimizer_phase(const auvid_optimizer_t *optimizer)
{
    return optimizer == NULL ? AUVID_OPTIMIZER_GLOBAL : (auvid_optimizer_phase_t)optimizer->phase;
}

const auvid_real_t *auvid_optimizer_best(const auvid_optimizer_t *optimizer, auvid_real_t *cost)
{
    if (optimizer == NULL) {
        return NULL;
    }
    if (optimizer->phase == AUVID_OPTIMIZER_GLOBAL) {
        return auvid_crs_best(&optimizer->crs, cost);
    }
    if (optimizer->line_search.evaluations > 0) {
        return auvid_line_search_best(&optimizer->line_search, cost);
    }
    if (cost != NULL) {
        *cost = optimizer->cost;
    }
    return optimizer->local.start;
}

auvid_optimizer_work_t auvid_optimizer_work(const auvid_optimizer_t *optimizer)
{
    auvid_optimizer_work_t work = {0, 0, 0};
    if (optimizer != NULL && optimizer->phase == AUVID_OPTIMIZER_GLOBAL) {
        work.crs = optimizer->crs.evaluations;
        work.attempts = optimizer->crs.attempts;
    } else if (optimizer != NULL) {
        work.crs = optimizer->evaluations;
        work.line_search = optimizer->line_search.evaluations;
        work.attempts = optimizer->attempts + optimizer->line_search.attempts;
    }
    return work;
}
