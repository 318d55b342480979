/*
 * The identifier (Karras et al. 2013, Fig. 2): optimization, a few units at a time.
 *
 *     sets complete -> validate -> MERGE -> ASK <-> COST -> MEASURE -> LINEARISE -> CONFIDENCE
 *           ^                                                                             |
 *           +--------------------- sets that were completed meanwhile <------ estimate ---+
 *
 * From the validation to the estimate the ring is held (auvid_metric_hold): a search uses the sets
 * that it began with, however slow it is. A set that enters the ring meanwhile replaces the oldest;
 * then the phases that read the ring restart with the remaining sets. The validation is in
 * auvid_identifier_validate.c, LINEARISE for the regressor path in auvid_identifier_optimum.c.
 */
#include <string.h>

#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"

/* Is the delay one of the parameters of the search? Then it is the last one. */
static bool identifier_searches_delay(const auvid_identifier_t *id)
{
    return auvid_metric_stores_rows(&id->metric) && id->metric.cfg.estimate_delay;
}

static auvid_status_t identifier_begin_search(auvid_identifier_t *id)
{
    auvid_search_config_t *search = &id->optimizer.cfg;
    auvid_real_t scale[AUVID_MAX_PARAMETERS], last[AUVID_MAX_PARAMETERS];
    id->active = auvid_metric_searched(&id->metric);
    *search = id->search;
    search->seed += id->searches;
    auvid_identifier_select(search, id->active, id->parameter_of);
    auvid_metric_scale(&id->metric, scale);
    for (int i = 0; i < search->n; ++i) { /* in place: the i-th is the i-th or a later one */
        auvid_real_t half = AUVID_C(0.5) * (search->upper[i] - search->lower[i]);
        int p = id->parameter_of[i];
        scale[i] = auvid_min(scale[p], half);
        last[i] = id->estimate.pi[p];
    }
    if (identifier_searches_delay(id)) {
        int n = search->n++;
        search->lower[n] = scale[n] = AUVID_C(0.0);
        search->upper[n] = auvid_metric_longest_delay(&id->metric);
        search->good[n] = id->metric.cfg.delay_s[0];
        last[n] = auvid_identifier_common_delay(&id->estimate);
    }
    auvid_status_t status =
        auvid_optimizer_init(&id->optimizer, search, search->scale_by_bounds ? NULL : scale);
    if (status < 0) {
        return status;
    }
    ++id->searches;
    if (id->estimate.number > 0 && !id->cold_start) {
        (void)auvid_optimizer_add_point(&id->optimizer, last);
    }
    id->cold_start = false;
    return AUVID_OK;
}

/* All parameters of the model from those of the optimizer; the others have their fixed value. */
static void identifier_expand(auvid_identifier_t *id, const auvid_real_t *theta)
{
    const int n = id->optimizer.cfg.n - identifier_searches_delay(id);
    memcpy(id->candidate, id->metric.cfg.fixed, sizeof id->candidate);
    for (int i = 0; i < n; ++i) {
        id->candidate[id->parameter_of[i]] = theta[i];
    }
    id->delay_s = identifier_searches_delay(id) ? theta[n] : id->metric.cfg.delay_s[0];
}

/* Begin to measure the result's residuals, on the remaining sets. */
static void identifier_begin_measure(auvid_identifier_t *id)
{
    auvid_metric_measure_begin(&id->metric, id->candidate, id->delay_s);
    id->phase = AUVID_WORK_MEASURE;
}

static AUVID_NOINLINE void identifier_ask(auvid_identifier_t *id)
{
    auvid_real_t theta[AUVID_MAX_PARAMETERS];
    auvid_status_t status = auvid_optimizer_ask(&id->optimizer, theta);
    if (status == AUVID_OK) {
        identifier_expand(id, theta);
        auvid_metric_cost_begin(&id->metric, id->candidate, id->delay_s);
        id->phase = AUVID_WORK_COST;
    } else if (status != AUVID_PENDING) {
        identifier_expand(id, auvid_optimizer_best(&id->optimizer, &id->cost));
        id->searched = id->optimizer.work;
        id->not_converged = status != AUVID_FINISHED || !(id->cost < AUVID_COST_FAILED);
        identifier_begin_measure(id);
    }
}

/* Largest speeds in the sets of the estimate. */
static void identifier_collect_speeds(const auvid_metric_t *m, auvid_estimate_t *e)
{
    for (int k = 0; k < 2 * AUVID_DOF_COUNT; ++k) {
        uint16_t max_speed = 0;
        for (int age = 0; age < auvid_metric_sets(m); ++age) {
            const auvid_set_t *set = auvid_metric_set(m, age);
            uint16_t speed = (set->excited >> k / 2 & 1) != 0 ? set->fastest[k / 2][k % 2] : 0;
            max_speed = speed > max_speed ? speed : max_speed;
        }
        e->speed[k / 2][k % 2] = AUVID_C(0.001) * (auvid_real_t)max_speed;
    }
}

static void identifier_publish_estimate(auvid_identifier_t *id)
{
    auvid_estimate_t *e = &id->estimate;
    ++e->number;
    e->t_us = id->t_us;
    e->sets = id->sets;
    e->identified = auvid_metric_active(&id->metric);
    e->excited = id->metric.result.excited;
    memcpy(e->pi, id->candidate, sizeof e->pi);
    e->cost = id->cost;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool common = auvid_metric_stores_rows(&id->metric) && (e->excited >> j & 1);
        e->delay_s[j] = common ? id->delay_s : id->metric.result.delay_s[j];
    }
    e->first_order_lag = id->metric.result.first_order_lag;
    auvid_metric_r2(&id->metric, e->r2_force);
    identifier_collect_speeds(&id->metric, e);
    e->not_converged = id->not_converged;
    e->evaluations_crs = id->searched.crs;
    e->evaluations_line = id->searched.line_search;
    e->confidence = id->confidence.result;
    memcpy(e->covariance, id->confidence.covariance, sizeof e->covariance);
    e->accepted = false;
    identifier_simulate(id);
    id->events |= AUVID_EVENT_ESTIMATE;
    auvid_identifier_rest(id);
}

/* Assess the result: its residuals, then their derivatives or (regressor path) the minimum, then
 * the standard errors. */
static auvid_status_t identifier_assess(auvid_identifier_t *id, uint32_t *budget)
{
    auvid_metric_t *m = &id->metric;
    auvid_status_t status = AUVID_OK;
    if (id->phase == AUVID_WORK_MEASURE) {
        status = auvid_metric_measure(m, budget);
        if (status == AUVID_OK && auvid_metric_stores_rows(&id->metric)) {
            auvid_metric_linearise_begin(m, id->candidate, id->delay_s, m->cfg.sets);
        } else if (status == AUVID_OK) {
            id->searching = false;
            auvid_identifier_begin_optimum(id);
        }
        id->phase = status == AUVID_OK ? AUVID_WORK_LINEARISE : id->phase;
    } else if (id->phase == AUVID_WORK_LINEARISE) {
        status = auvid_metric_stores_rows(&id->metric) ? auvid_metric_linearise(m, budget)
                                                       : auvid_identifier_optimum(id, budget);
        if (status == AUVID_OK) {
            id->searching = false;
            auvid_confidence_begin(&id->confidence, m, id->candidate, id->dry_mass_kg,
                                   &id->uncertainty);
            auvid_confidence_limits(&id->confidence, id->search.lower, id->search.upper,
                                    id->not_converged && !auvid_metric_stores_rows(&id->metric));
            id->phase = AUVID_WORK_CONFIDENCE;
        }
    } else {
        status = auvid_confidence_work(&id->confidence, m, budget);
        if (status == AUVID_OK) {
            identifier_publish_estimate(id);
        }
    }
    return status;
}

/* Merge, then spend the start cost of a search, then begin it. */
static auvid_status_t identifier_finish_merge(auvid_identifier_t *id, uint32_t *budget)
{
    auvid_status_t status = AUVID_OK;
    if (id->spent == 0) {
        status = auvid_metric_merge(&id->metric, budget);
        id->spent = status == AUVID_OK;
    } else {
        --*budget;
        if (id->spent++ == SEARCH_START_COST) {
            status = identifier_begin_search(id);
            id->searching = true;
            id->phase = AUVID_WORK_ASK;
        }
    }
    if (status < 0) {
        auvid_identifier_rest(id);
    }
    return status;
}

/* A set has replaced the oldest: restart the phase that reads the ring. */
static void identifier_restart_phase(auvid_identifier_t *id)
{
    switch ((auvid_work_phase_t)id->phase) {
    case AUVID_WORK_PREPARE:
    case AUVID_WORK_PREDICT:
    case AUVID_WORK_COMPARE:
        auvid_identifier_begin_change_test(id);
        break;
    case AUVID_WORK_CHANGE_TEST:
        auvid_metric_change_begin(&id->metric);
        break;
    case AUVID_WORK_MERGE:
        auvid_identifier_begin_merge(id);
        break;
    case AUVID_WORK_MEASURE:
    case AUVID_WORK_LINEARISE:
    case AUVID_WORK_CONFIDENCE:
        identifier_begin_measure(id);
        break;
    case AUVID_WORK_IDLE:
    case AUVID_WORK_ASK:
    case AUVID_WORK_COST:
    case AUVID_WORK_PHASE_COUNT:
    default: /* the search uses the merged sets */
        break;
    }
}

/* Continue the present phase. */
static auvid_status_t identifier_advance(auvid_identifier_t *id, uint32_t *budget)
{
    auvid_status_t status = AUVID_OK;
    switch ((auvid_work_phase_t)id->phase) {
    case AUVID_WORK_MERGE:
        status = identifier_finish_merge(id, budget);
        break;
    case AUVID_WORK_ASK:
        --*budget;
        identifier_ask(id);
        break;
    case AUVID_WORK_COST:
        status = auvid_metric_cost(&id->metric, budget);
        if (status == AUVID_OK) {
            (void)auvid_optimizer_tell(&id->optimizer, id->metric.result.cost);
            id->phase = AUVID_WORK_ASK;
        }
        break;
    case AUVID_WORK_MEASURE:
    case AUVID_WORK_LINEARISE:
    case AUVID_WORK_CONFIDENCE:
        status = identifier_assess(id, budget);
        break;
    case AUVID_WORK_PREPARE:
    case AUVID_WORK_PREDICT:
    case AUVID_WORK_COMPARE:
    case AUVID_WORK_CHANGE_TEST:
        status = auvid_identifier_change_test(id, budget);
        break;
    case AUVID_WORK_IDLE:
    case AUVID_WORK_PHASE_COUNT:
    default:
        id->phase = AUVID_WORK_IDLE;
        break;
    }
    return status;
}

auvid_status_t auvid_identifier_work(auvid_identifier_t *id, uint32_t budget)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    uint32_t left = budget;
    auvid_status_t status = AUVID_OK;
    if (budget > 0 && auvid_metric_ring_changed(&id->metric)) {
        identifier_restart_phase(id);
    }
    if (budget > 0 && id->set_pending && id->phase == AUVID_WORK_IDLE) {
        id->set_pending = false;
        auvid_identifier_begin_sets(id);
    }
    while (left > 0 && id->phase != AUVID_WORK_IDLE && status >= 0) {
        status = identifier_advance(id, &left);
    }
    id->work_last = budget - left;
    id->max_work = id->work_last > id->max_work ? id->work_last : id->max_work;
    bool idle = id->phase == AUVID_WORK_IDLE && !id->set_pending;
    return status < 0 || idle ? status : AUVID_PENDING;
}
