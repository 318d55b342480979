/*
 * The identifier: how the search of the sets begins, and how it continues if the line search finds
 * a better point than the one that it had to confirm. That happens on the residual path, where the
 * steps of Gauss-Newton may end beside the minimum: they continue at the better point, and a poll
 * has to confirm their new end. After WORK_CONTINUATIONS of these both algorithms search
 * everywhere. A search that has begun with Algorithm 1 continues with Algorithm 2 instead.
 *
 * The cost of a model with kinks has several minima whose delays are within a cell: with the delay,
 * one command after the other leaves a row. Algorithm 2 ends in one of them. So it runs again from
 * delays that are 1.5 cells longer and shorter, with the other parameters of the best end, until
 * neither ends lower: it comes from both sides of these minima.
 */
#include <string.h>

#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"

/* A lower minimum is lower by this part. */
#define LOWER_BY AUVID_C(1e-4)
/* How far beside the best end the next search begins [cells], and the unit of its steps over that
 * of the last one. */
#define STEP_BESIDE AUVID_C(1.5)
#define SHORTER AUVID_C(0.3)

auvid_real_t auvid_identifier_common_delay(const auvid_estimate_t *estimate)
{
    auvid_real_t delay_s = AUVID_C(0.0);
    for (int j = 0; AUVID_MAX_COMMANDS > 0 && j < AUVID_DOF_COUNT; ++j) {
        delay_s = auvid_max(delay_s, estimate->delay_s[j]); /* the same in all excited DoF */
    }
    return delay_s;
}

const auvid_real_t *auvid_identifier_known_point(const auvid_identifier_t *id,
                                                 auvid_real_t *delay_s)
{
    if (id->work.refuted > 0) {
        *delay_s = id->work.delay_s;
        return id->work.candidate;
    }
    if (id->estimate.number == 0 || id->work.cold_start) {
        return NULL;
    }
    *delay_s = auvid_identifier_common_delay(&id->estimate);
    return id->estimate.pi;
}

/* Does this search only have to confirm a point, although both phases are configured? */
static bool identifier_only_confirms(const auvid_identifier_t *id)
{
    return auvid_metric_stores_rows(&id->metric) && id->search.phases == AUVID_SEARCH_BOTH &&
           id->optimizer.cfg.phases == AUVID_SEARCH_LOCAL;
}

/* Is the minimum a certificate, or only a good point? Steps of Gauss-Newton may end at a kink. */
static bool identifier_certifies(const auvid_identifier_t *id)
{
    return !auvid_metric_stores_rows(&id->metric) || identifier_vehicle(id)->smooth;
}

auvid_status_t auvid_identifier_begin_search(auvid_identifier_t *id, auvid_real_t *scale,
                                             const auvid_real_t *last,
                                             const auvid_minimum_t *minimum, const auvid_real_t *pi,
                                             auvid_real_t delay_s)
{
    auvid_search_config_t *search = &id->optimizer.cfg;
    auvid_real_t known[AUVID_MAX_PARAMETERS], at[AUVID_MAX_PARAMETERS];
    *search = id->search;
    search->seed += id->work.searches;
    if (id->work.refuted == 0) {
        id->work.searched = (auvid_optimizer_work_t){0};
    }
    auvid_identifier_select(search, id->work.active, id->work.parameter_of);
    for (int i = 0; i < search->n; ++i) { /* in place: the i-th is the i-th or a later one */
        auvid_real_t half = AUVID_C(0.5) * (search->upper[i] - search->lower[i]);
        int p = id->work.parameter_of[i];
        scale[i] = auvid_min(scale[p], half);
        known[i] = last != NULL ? last[p] : AUVID_C(0.0);
        at[i] = minimum != NULL ? pi[p] : AUVID_C(0.0);
    }
    if (identifier_searches_delay(id)) {
        int n = search->n++;
        search->lower[n] = AUVID_C(0.0);
        search->upper[n] = auvid_metric_longest_delay(&id->metric);
        search->good[n] = id->metric.cfg.delay_s[0];
        scale[n] = auvid_min(scale[identifier_vehicle(id)->parameters], search->upper[n]);
        known[n] = at[n] = delay_s;
    }
    if (auvid_metric_stores_rows(&id->metric) && last != NULL && minimum != NULL &&
        search->phases == AUVID_SEARCH_BOTH && identifier_certifies(id)) {
        search->phases = AUVID_SEARCH_LOCAL;
    }
    auvid_status_t status =
        auvid_optimizer_init(&id->optimizer, search, search->scale_by_bounds ? NULL : scale);
    if (status >= 0 && last != NULL) {
        (void)auvid_optimizer_add_point(&id->optimizer, known);
    }
    if (status >= 0 && minimum != NULL && !id->search.paper) {
        (void)(identifier_certifies(id)
                   ? auvid_optimizer_certify(&id->optimizer, at, minimum->cost, minimum->allowed)
                   : auvid_optimizer_add_point(&id->optimizer, at));
    }
    return status;
}

/* The delay at which the next search beside the best end begins [s]. */
static auvid_real_t identifier_delay_beside(const auvid_identifier_t *id)
{
    const auvid_search_config_t *search = &id->optimizer.cfg;
    int n = search->n - 1;
    auvid_real_t step_s = STEP_BESIDE * AUVID_C(1e-6) * (auvid_real_t)id->metric.cfg.cell_us;
    auvid_real_t at = search->good[n] + (id->work.sides_left == 2 ? step_s : -step_s);
    return auvid_clamp(at, search->lower[n], search->upper[n]);
}

/* Do the bounds leave room for it, at least a tenth of a cell? */
static bool identifier_has_room_beside(const auvid_identifier_t *id)
{
    auvid_real_t step =
        identifier_delay_beside(id) - id->optimizer.cfg.good[id->optimizer.cfg.n - 1];
    return auvid_abs(step) >= AUVID_C(1e-7) * (auvid_real_t)id->metric.cfg.cell_us;
}

/* The best end is search.good, its cost minimum.cost. */
static auvid_status_t identifier_begin_beside(auvid_identifier_t *id)
{
    auvid_optimizer_t *o = &id->optimizer;
    auvid_real_t scale[AUVID_MAX_PARAMETERS], *delay_s = &o->cfg.good[o->cfg.n - 1];
    auvid_real_t end_s = *delay_s;
    for (int i = 0; i < o->cfg.n; ++i) {
        scale[i] = SHORTER * o->scale[i];
    }
    *delay_s = identifier_delay_beside(id);
    o->cfg.phases = AUVID_SEARCH_LOCAL;
    o->cfg.has_good = true;
    auvid_status_t status = auvid_optimizer_init(o, &o->cfg, scale);
    *delay_s = end_s;
    return status < 0 ? status
                      : auvid_optimizer_set_goal(o, (1 - LOWER_BY) * id->work.minimum.cost);
}

bool auvid_identifier_search_beside(auvid_identifier_t *id)
{
    auvid_optimizer_t *o = &id->optimizer;
    if (!identifier_searches_delay(id) || identifier_certifies(id) || id->search.paper) {
        return false;
    }
    if (id->work.beside == 0 || id->work.cost < (1 - LOWER_BY) * id->work.minimum.cost) {
        memcpy(o->cfg.good, auvid_optimizer_best(o, NULL), o->cfg.n * sizeof *o->cfg.good);
        id->work.minimum.cost = id->work.cost;
        id->work.sides_left = 2;
    } else {
        --id->work.sides_left;
    }
    while (id->work.sides_left > 0 && !identifier_has_room_beside(id)) {
        --id->work.sides_left;
    }
    if (id->work.sides_left == 0 || id->work.beside == WORK_SEARCHES_BESIDE) {
        auvid_identifier_expand(id, o->cfg.good, o->cfg.n);
        id->work.cost = id->work.minimum.cost;
        return false;
    }
    ++id->work.beside;
    id->work.spent = WORK_START;
    id->work.phase = AUVID_WORK_MERGE;
    return true;
}

/* Search everywhere, with the scale of the search that has been refuted. */
static auvid_status_t identifier_begin_full_search(auvid_identifier_t *id)
{
    auvid_real_t scale[SCALES] = {AUVID_C(0.0)};
    int n = id->optimizer.cfg.n;
    for (int i = 0; i < n; ++i) {
        bool delay = identifier_searches_delay(id) && i == n - 1;
        int p = delay ? identifier_vehicle(id)->parameters : id->work.parameter_of[i];
        scale[p] = id->optimizer.scale[i];
    }
    return auvid_identifier_begin_search(id, scale, id->work.candidate, NULL, NULL,
                                         id->work.delay_s);
}

auvid_status_t auvid_identifier_begin_sets_search(auvid_identifier_t *id)
{
    auvid_real_t scale[SCALES] = {AUVID_C(0.0)}, delay_s = AUVID_C(0.0);
    bool known = id->work.minimum.cost < AUVID_COST_FAILED;
    if (id->work.beside > 0) {
        return identifier_begin_beside(id);
    }
    if (id->work.searching) {
        return identifier_begin_full_search(id);
    }
    auvid_metric_path(&id->metric)->start->scale(id, scale);
    const auvid_real_t *last = auvid_identifier_known_point(id, &delay_s);
    auvid_status_t status =
        auvid_identifier_begin_search(id, scale, last, known ? &id->work.minimum : NULL,
                                      id->work.candidate, known ? id->work.delay_s : delay_s);
    if (status >= 0 && id->work.refuted == 0) {
        ++id->work.searches;
        id->work.cold_start = false;
    }
    return status;
}

void auvid_identifier_expand(auvid_identifier_t *id, const auvid_real_t *theta, int n)
{
    bool delay = identifier_searches_delay(id);
    memcpy(id->work.candidate, id->metric.cfg.fixed, sizeof id->work.candidate);
    for (int i = 0; i < n - delay; ++i) {
        id->work.candidate[id->work.parameter_of[i]] = theta[i];
    }
    id->work.delay_s = delay ? theta[n - 1] : id->metric.cfg.delay_s[0];
}

void auvid_identifier_end_search(auvid_identifier_t *id)
{
    auvid_identifier_expand(id, auvid_optimizer_best(&id->optimizer, &id->work.cost),
                            id->optimizer.cfg.n);
    id->work.searched.crs += id->optimizer.work.crs;
    id->work.searched.line_search += id->optimizer.work.line_search;
    id->work.searched.attempts += id->optimizer.work.attempts;
}

/* Has the line search found a better point than the one that it had to confirm? */
static bool identifier_is_refuted(const auvid_identifier_t *id)
{
    return auvid_metric_stores_rows(&id->metric) && identifier_certifies(id) &&
           id->work.minimum.cost < AUVID_COST_FAILED && !id->optimizer.certified &&
           id->optimizer.state >= AUVID_OPTIMIZER_START;
}

void auvid_identifier_check_start(auvid_identifier_t *id)
{
    if (!identifier_is_refuted(id)) {
        return;
    }
    bool again = id->work.refuted < WORK_CONTINUATIONS;
    if (!again) {
        id->work.minimum.cost = AUVID_COST_FAILED; /* nothing is left to confirm */
    }
    if (again || identifier_only_confirms(id)) {
        ++id->work.refuted;
        auvid_identifier_end_search(id);
        id->work.spent = WORK_START;
        id->work.phase = AUVID_WORK_MERGE;
    }
    if (again) {
        id->work.searching = false;
        id->work.spent = WORK_OPTIMUM;
        auvid_metric_path(&id->metric)->start->begin(id);
    }
}
