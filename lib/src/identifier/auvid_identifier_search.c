/*
 * The identifier: how the search of the sets begins, and how it continues if the line search finds
 * a better point than the one that it had to confirm. That happens on the residual path, where the
 * steps of Gauss-Newton may end beside the minimum: they continue at the better point, and a poll
 * has to confirm their new end. After WORK_CONTINUATIONS of these both algorithms search
 * everywhere. A search that has begun with Algorithm 1 continues with Algorithm 2 instead.
 */
#include <string.h>

#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"

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

auvid_minimum_t auvid_identifier_minimum(auvid_real_t cost, auvid_real_t constant,
                                         auvid_real_t zero)
{
    auvid_real_t allowed = AUVID_C(1e-3) * (cost + constant) + AUVID_C(1e-8) * zero;
    return (auvid_minimum_t){auvid_min(cost, AUVID_COST_FAILED),
                             auvid_min(allowed, AUVID_COST_FAILED)};
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
    const auvid_path_start_t *start = auvid_metric_path(&id->metric)->start;
    if (id->work.searching) {
        return id->work.neighbours > 0 ? start->begin_neighbour(id)
                                       : identifier_begin_full_search(id);
    }
    start->scale(id, scale);
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
    id->work.neighbours = 0;
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
