/*
 * The identifier (Karras et al. 2013, Fig. 2): optimization, a few units at a time.
 *
 *     sets complete -> validate -> MERGE -> ASK <-> COST -> MEASURE -> LINEARISE -> CONFIDENCE
 *           ^                                                                             |
 *           +--------------------- sets that were completed meanwhile <------ estimate ---+
 *
 * From the validation to the estimate the ring is held (auvid_metric_hold): a search uses the sets
 * that it began with, however slow it is, and so does a solution with uncertain inputs. A set that
 * enters the ring meanwhile replaces the oldest; then the phases that read the ring restart with
 * the remaining sets. The validation, if it is attached, is in auvid_identifier_validate.c; the
 * minimum of the regressor path, part of MERGE, in auvid_identifier_optimum.c; its LINEARISE, with
 * uncertain inputs, in auvid_uncertain_solve.c. The start of the residual path, also part of MERGE,
 * is in auvid_identifier_newton.c. How a search begins, and what follows if it refutes that start,
 * is in auvid_identifier_search.c. With kinks, ASK leads to MERGE again, for neighbouring minima
 * (auvid_identifier_neighbour.c).
 */
#include <string.h>

#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"
#include "../navigation/auvid_recorder_internal.h"

/* End the work: nothing is left to do for the sets of the ring. */
static void identifier_rest(auvid_identifier_t *id)
{
    bool has_log = identifier_listener(id) != NULL && id->attached.listener->lead_us != NULL;
    uint64_t lead_us = has_log ? id->attached.listener->lead_us(id->attached.listener_context) : 0u;
    id->work.searching = id->work.seeks_optimum = false;
    id->work.neighbours = 0;
    id->work.phase = AUVID_WORK_IDLE;
    identifier_take_set(id, auvid_metric_release(&id->metric, id->applied.t_us + lead_us));
}

/* Write the largest speeds of each DoF, forward and backward, in the sets in which it was excited.
 */
static void identifier_find_speeds(const auvid_metric_t *m, auvid_real_t speed[AUVID_DOF_COUNT][2])
{
    uint16_t largest[2 * AUVID_DOF_COUNT] = {0};
    for (int age = 0; age < auvid_metric_sets(m); ++age) {
        const auvid_set_t *set = auvid_metric_set(m, age);
        for (int k = 0; k < 2 * AUVID_DOF_COUNT; ++k) {
            uint16_t of_set = set->fastest[k / 2][k % 2];
            bool counts = of_set > largest[k] && auvid_metric_set_counts(m, set, k / 2);
            largest[k] = counts ? of_set : largest[k];
        }
    }
    for (int k = 0; k < 2 * AUVID_DOF_COUNT; ++k) {
        speed[k / 2][k % 2] = AUVID_C(0.001) * (auvid_real_t)largest[k];
    }
}

/* The rows were mostly noise: record longer cells. */
static void identifier_lengthen_cells(auvid_identifier_t *id)
{
    auvid_recorder_set_cell(&id->recorder, auvid_metric_cell_us(&id->metric));
    if (id->attached.validation != NULL) {
        id->attached.validation->vehicle = NULL; /* it simulates cells of the old length */
    }
    identifier_discard_uncertain(id);
    if (id->attached.change != NULL) { /* noise has biased its masses: no reference for drift */
        memset(&id->attached.change->accepted, 0, sizeof id->attached.change->accepted);
        memset(&id->attached.change->first, 0, sizeof id->attached.change->first);
        memset(id->attached.change->noise, 0, sizeof id->attached.change->noise);
    }
    id->work.set_pending = false;
    id->events |= AUVID_EVENT_LONGER_CELLS;
}

static void identifier_publish_estimate(auvid_identifier_t *id)
{
    auvid_estimate_t *e = &id->estimate;
    const auvid_estimate_t *last = auvid_identifier_estimate(id);
    const uint32_t number = last == NULL ? 0u : last->number;
    ++e->number;
    e->t_us = id->t_us;
    e->sets = id->work.sets;
    e->excited = id->metric.result.excited;
    e->coupled = id->metric.result.coupled;
    e->identified = auvid_metric_free_of(&id->metric, e->excited | e->coupled) &
                    auvid_metric_searched(&id->metric);
    memcpy(e->pi, id->work.candidate, sizeof e->pi);
    e->cost = id->work.cost;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool common = auvid_metric_stores_rows(&id->metric) && (e->excited >> j & 1);
        e->delay_s[j] = common ? id->work.delay_s : id->metric.result.delay_s[j];
    }
    e->first_order_lag = id->metric.result.first_order_lag;
    auvid_metric_r2(&id->metric, e->r2_force);
    identifier_find_speeds(&id->metric, e->speed);
    e->not_converged = id->work.not_converged;
    e->evaluations_crs = id->work.searched.crs;
    e->evaluations_line = id->work.searched.line_search;
    e->confidence = id->confidence.result;
    memcpy(e->covariance, id->confidence.covariance, sizeof e->covariance);
    e->accepted = false;
    if (id->attached.uncertain_functions != NULL) {
        id->attached.uncertain_functions->publish(id);
    }
    if (auvid_identifier_estimate(id)->number != number) { /* uncertain inputs may keep the last */
        id->events |= AUVID_EVENT_ESTIMATE;
    }
    identifier_rest(id);
    if (auvid_metric_lengthen(&id->metric)) {
        identifier_lengthen_cells(id);
    }
    auvid_metric_set_residual(&id->metric, e->confidence.residual_rms);
    identifier_simulate(id);
}

/* ---- from sets to the merge ---- */

/* Longest time from the first row of a set to its last [us]. */
static uint64_t identifier_set_duration_us(const auvid_metric_config_t *cfg)
{
    return (uint64_t)cfg->cell_us * cfg->row_cells * cfg->set_rows;
}

static void identifier_begin_merge(auvid_identifier_t *id)
{
    if (auvid_metric_sets(&id->metric) == 0) { /* overwritten: the waiting sets are next */
        identifier_rest(id);
        return;
    }
    auvid_metric_merge_begin(&id->metric);
    id->work.seeks_optimum = false;
    id->work.refuted = id->work.neighbours = 0;
    id->work.spent = 0;
    id->work.phase = AUVID_WORK_MERGE;
}

void auvid_identifier_begin_tests(auvid_identifier_t *id)
{
    if (id->work.untested == 0 || !id->attached.change_functions->begin(id)) {
        auvid_metric_protect(&id->metric, 0);
        identifier_begin_merge(id);
    }
}

/* Sets are complete: test the last estimate with each, the oldest first, then merge. */
static void identifier_begin_sets(auvid_identifier_t *id)
{
    auvid_metric_t *m = &id->metric;
    const auvid_listener_t *listener = identifier_listener(id);
    bool tests = id->attached.change_functions != NULL && id->estimate.number > 0;
    if (id->attached.simulate != NULL) {
        id->attached.simulate->finish(id);
    }
    if (listener != NULL) {
        listener->set(id->attached.listener_context, m);
    }
    id->work.sets = m->sets.recorded;
    id->work.untested = tests ? m->sets.waiting : 0u;
    auvid_metric_hold(m, listener == NULL ? UINT64_MAX
                                          : id->applied.t_us + identifier_set_duration_us(&m->cfg));
    auvid_metric_exclude(m, (uint8_t)(id->work.untested > 0 ? id->work.untested - 1u : 0u));
    auvid_identifier_begin_tests(id);
}

/* ---- the phases ---- */

/* The sets are merged: find the start of the search next. */
static void identifier_end_sets(auvid_identifier_t *id)
{
    id->work.active = auvid_metric_searched(&id->metric);
    memcpy(id->work.candidate, id->metric.cfg.fixed, sizeof id->work.candidate);
    auvid_metric_path(&id->metric)->start->begin(id);
    id->work.spent = WORK_OPTIMUM;
}

/* Merge, find the start of the search, spend its start cost, then begin it. */
static auvid_status_t identifier_merge(auvid_identifier_t *id, uint32_t *budget)
{
    auvid_status_t status = AUVID_OK;
    if (id->work.spent == 0) {
        status = auvid_metric_merge(&id->metric, budget);
        if (status == AUVID_OK) {
            identifier_end_sets(id);
            status = AUVID_PENDING;
        }
        return status;
    }
    if (id->work.spent == WORK_OPTIMUM) {
        status = auvid_metric_path(&id->metric)->start->run(id, budget);
        id->work.spent = status == AUVID_OK ? WORK_START : WORK_OPTIMUM;
        return AUVID_PENDING;
    }
    --*budget;
    if (id->work.spent++ < WORK_LAST_SPENT) {
        return AUVID_PENDING;
    }
    *budget = 0; /* most of the cost may have been spent in earlier calls, but it is due now */
    return auvid_identifier_begin_sets_search(id);
}

static void identifier_end_merge(auvid_identifier_t *id)
{
    id->work.searching = true;
    id->work.phase = AUVID_WORK_ASK;
}

/* Begin to measure the result's residuals, on the remaining sets. */
static void identifier_begin_measure(auvid_identifier_t *id)
{
    auvid_metric_measure_begin(&id->metric, id->work.candidate, id->work.delay_s);
    id->work.phase = AUVID_WORK_MEASURE;
}

/* Add the parameters of DoF that only coupling moves to the result, within their bounds. */
static void identifier_solve_coupled(auvid_identifier_t *id)
{
    auvid_metric_solve_coupled(&id->metric, id->work.candidate);
    uint32_t solved = auvid_metric_searched(&id->metric) & ~id->work.active;
    for (int i = 0; solved != 0; ++i, solved >>= 1) {
        if ((solved & 1u) != 0) {
            id->work.candidate[i] =
                auvid_clamp(id->work.candidate[i], id->search.lower[i], id->search.upper[i]);
        }
    }
}

/* Is the search's result the minimum, as far as that is known? */
static bool identifier_found_minimum(const auvid_identifier_t *id)
{
    const auvid_minimum_t *minimum = &id->work.minimum;
    return auvid_metric_stores_rows(&id->metric)
               ? id->work.cost < AUVID_COST_FAILED
               : id->work.cost - minimum->cost <= minimum->allowed;
}

/* A set has entered the ring: measure again. The uncertain inputs are solved from rows of their
 * own, however long it takes; what follows restarts. */
static void identifier_restart_linearise(auvid_identifier_t *id)
{
    if (auvid_metric_stores_rows(&id->metric)) {
        identifier_begin_measure(id);
    } else {
        auvid_metric_change_ring(&id->metric);
    }
}

static AUVID_NOINLINE auvid_status_t identifier_ask(auvid_identifier_t *id, uint32_t *budget)
{
    const auvid_path_start_t *start = auvid_metric_path(&id->metric)->start;
    auvid_real_t theta[AUVID_MAX_PARAMETERS];
    --*budget;
    auvid_status_t status = auvid_optimizer_ask(&id->optimizer, theta);
    if (status == AUVID_OK) {
        auvid_identifier_expand(id, theta, id->optimizer.cfg.n);
    } else if (status != AUVID_PENDING) {
        auvid_identifier_end_search(id);
        bool converged = status == AUVID_FINISHED && identifier_found_minimum(id);
        if (start->next_neighbour == NULL) {
            id->work.not_converged = !converged;
        } else if (start->next_neighbour(id, converged)) {
            return AUVID_PENDING;
        }
        identifier_solve_coupled(id);
        identifier_begin_measure(id);
        status = AUVID_PENDING;
    }
    return status;
}

static void identifier_begin_cost(auvid_identifier_t *id)
{
    auvid_metric_cost_begin(&id->metric, id->work.candidate, id->work.delay_s);
    id->work.phase = AUVID_WORK_COST;
}

static void identifier_end_cost(auvid_identifier_t *id)
{
    (void)auvid_optimizer_tell(&id->optimizer, id->metric.result.cost);
    id->work.phase = AUVID_WORK_ASK;
    auvid_identifier_check_start(id);
}

static void identifier_begin_confidence(auvid_identifier_t *id)
{
    id->work.searching = false;
    auvid_confidence_begin(&id->confidence, &id->metric, id->work.candidate, id->dry_mass_kg,
                           &id->uncertainty);
    id->confidence.result.unchecked = !id->exact_inputs || id->attached.uncertain != NULL;
    /* a residual path's search may end before it has converged near a minimum, but not if no cost
     * was finite */
    bool failed = !auvid_metric_stores_rows(&id->metric) || !(id->work.cost < AUVID_COST_FAILED);
    auvid_confidence_limits(&id->confidence, id->search.lower, id->search.upper,
                            id->work.not_converged && failed);
    id->work.phase = AUVID_WORK_CONFIDENCE;
}

static void identifier_begin_linearise(auvid_identifier_t *id)
{
    const auvid_uncertain_functions_t *uncertain = id->attached.uncertain_functions;
    id->work.phase = AUVID_WORK_LINEARISE;
    id->work.searching = false;
    if (auvid_metric_stores_rows(&id->metric)) {
        auvid_metric_linearise_begin(&id->metric, id->work.candidate, id->work.delay_s,
                                     id->metric.cfg.sets);
        return;
    }
    if (uncertain == NULL || !uncertain->begin(id)) {
        identifier_begin_confidence(id);
    }
}

/* Residual path: if the sets contradict the prior of the search, search again without it. */
static auvid_status_t identifier_linearise(auvid_identifier_t *id, uint32_t *budget)
{
    if (!auvid_metric_stores_rows(&id->metric)) {
        return id->attached.uncertain_functions->solve(id, budget);
    }
    auvid_status_t status = auvid_metric_linearise(&id->metric, &id->linear.windows, budget);
    if (status == AUVID_EMPTY) {
        identifier_begin_merge(id);
        status = AUVID_PENDING;
    }
    return status;
}

/* What follows, publishing the estimate, has a call of its own. */
static auvid_status_t identifier_confidence(auvid_identifier_t *id, uint32_t *budget)
{
    uint32_t before = *budget;
    auvid_status_t status = auvid_confidence_work(&id->confidence, &id->metric, budget);
    if (status == AUVID_OK && *budget < before) {
        *budget = 0;
        status = AUVID_PENDING;
    }
    return status;
}

/* The search reads only the merged sets. */
static const auvid_work_phase_row_t identifier_phases[AUVID_WORK_PHASE_COUNT] = {
    [AUVID_WORK_MERGE] = {NULL, identifier_merge, identifier_end_merge, identifier_begin_merge},
    [AUVID_WORK_ASK] = {NULL, identifier_ask, identifier_begin_cost, NULL},
    [AUVID_WORK_COST] = {auvid_metric_cost, NULL, identifier_end_cost, NULL},
    [AUVID_WORK_MEASURE] = {auvid_metric_measure, NULL, identifier_begin_linearise,
                            identifier_begin_measure},
    [AUVID_WORK_LINEARISE] = {NULL, identifier_linearise, identifier_begin_confidence,
                              identifier_restart_linearise},
    [AUVID_WORK_CONFIDENCE] = {NULL, identifier_confidence, identifier_publish_estimate,
                               identifier_begin_measure},
};

static const auvid_work_phase_row_t *identifier_phase(const auvid_identifier_t *id)
{
    uint32_t phase = id->work.phase, test = phase - AUVID_WORK_PREPARE;
    return test <= AUVID_WORK_CHANGE_TEST - AUVID_WORK_PREPARE &&
                   id->attached.change_functions != NULL
               ? &id->attached.change_functions->phases[test]
               : &identifier_phases[phase < AUVID_WORK_PHASE_COUNT ? phase : AUVID_WORK_IDLE];
}

/* Continue the present phase. */
static auvid_status_t identifier_advance(auvid_identifier_t *id, uint32_t *budget)
{
    const auvid_work_phase_row_t *phase = identifier_phase(id);
    if (phase->next == NULL) { /* damaged */
        id->work.phase = AUVID_WORK_IDLE;
        return AUVID_OK;
    }
    auvid_status_t status =
        phase->metric != NULL ? phase->metric(&id->metric, budget) : phase->run(id, budget);
    if (status == AUVID_OK) {
        phase->next(id);
    } else if (status < 0) {
        identifier_rest(id);
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
    bool begins = false;
    auvid_status_t status = AUVID_OK;
    if (budget > 0 && auvid_metric_ring_changed(&id->metric) &&
        identifier_phase(id)->restart != NULL) {
        identifier_phase(id)->restart(id);
    }
    if (budget > 0 && id->work.set_pending && id->work.phase == AUVID_WORK_IDLE) {
        id->work.set_pending = false;
        identifier_begin_sets(id);
        begins = true; /* the tick has just completed a set: the work continues in the next one */
    }
    while (left > 0 && !begins && id->work.phase != AUVID_WORK_IDLE && status >= 0) {
        status = identifier_advance(id, &left);
    }
    id->work.last_units = budget - left;
    if (id->work.last_units > id->work.max_units) {
        id->work.max_units = id->work.last_units;
    }
    bool idle = id->work.phase == AUVID_WORK_IDLE && !id->work.set_pending;
    return status < 0 || idle ? status : AUVID_PENDING;
}
