/*
 * Uncertain inputs: configuration, and the estimate.
 */
#include "auvid/uncertain.h"

#include <string.h>

#include "../identifier/auvid_identifier_internal.h"
#include "auvid_uncertain_parts_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../metric/auvid_metric_feedback_internal.h"
#include "../navigation/auvid_recorder_internal.h"

/* Linear part of the drag at 1 m/s or rad/s before the first solution: as large as the quadratic
 * one at 0.33. */
#define FIRST_LINEAR AUVID_C(0.25)

void auvid_uncertain_defaults(auvid_uncertain_config_t *cfg)
{
    if (cfg != NULL) {
        *cfg = (auvid_uncertain_config_t){.backward = AUVID_C(0.05),
                                          .dead_band = AUVID_C(0.012),
                                          .curve = AUVID_C(0.05),
                                          .inflow = AUVID_C(0.18),
                                          .sag = AUVID_C(0.05),
                                          .gain = AUVID_C(0.05),
                                          .lag_s = AUVID_C(0.06),
                                          .delay_s = AUVID_C(0.04),
                                          .current = AUVID_C(0.05),
                                          .asymmetry = AUVID_C(0.12),
                                          .cross = AUVID_C(0.15),
                                          .force = AUVID_C(0.03),
                                          .arm_m = AUVID_C(0.05),
                                          .mount_rad = AUVID_C(0.015),
                                          .dvl_late_s = AUVID_C(0.05),
                                          .filter_s = AUVID_C(0.05),
                                          .response_s2 = AUVID_C(0.02),
                                          .gravity_m = AUVID_C(0.01),
                                          .cross_flow = AUVID_C(0.5),
                                          .nominal_lag_s = AUVID_C(0.15)};
    }
}

#define UNCERTAIN_UP_TO(name, high) REALS_IN(auvid_uncertain_config_t, name, 1, AUVID_C(0.0), high)
#define ONE AUVID_C(1.0)
#define TEN AUVID_C(10.0)
static const auvid_field_t uncertain_fields[] = {
    UNCERTAIN_UP_TO(backward, ONE),
    UNCERTAIN_UP_TO(dead_band, ONE),
    UNCERTAIN_UP_TO(curve, ONE),
    UNCERTAIN_UP_TO(inflow, TEN),
    UNCERTAIN_UP_TO(sag, ONE),
    UNCERTAIN_UP_TO(gain, ONE),
    UNCERTAIN_UP_TO(lag_s, ONE),
    UNCERTAIN_UP_TO(delay_s, ONE),
    UNCERTAIN_UP_TO(current, TEN),
    UNCERTAIN_UP_TO(asymmetry, ONE),
    UNCERTAIN_UP_TO(cross, ONE),
    UNCERTAIN_UP_TO(force, ONE),
    UNCERTAIN_UP_TO(arm_m, ONE),
    UNCERTAIN_UP_TO(mount_rad, ONE),
    UNCERTAIN_UP_TO(dvl_late_s, ONE),
    UNCERTAIN_UP_TO(filter_s, ONE),
    UNCERTAIN_UP_TO(response_s2, ONE),
    UNCERTAIN_UP_TO(gravity_m, ONE),
    UNCERTAIN_UP_TO(cross_flow, ONE),
    REALS_IN(auvid_uncertain_config_t, nominal_lag_s, 1, AUVID_C(0.01), ONE)};

static auvid_uncertain_t *uncertain_of(const auvid_identifier_t *id)
{
    return id->attached.uncertain;
}

/* Have all excited DoF the rows for a solution, and one at least? */
static bool uncertain_is_ready(const auvid_identifier_t *id)
{
    bool ready = true, any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool has = auvid_uncertain_has_rows(uncertain_of(id), j);
        ready = ready && (has || !auvid_metric_is_excited(&id->metric, j));
        any = any || has;
    }
    return ready && any;
}

static bool uncertain_begin(auvid_identifier_t *id)
{
    if (uncertain_of(id)->work.solving) {
        return false; /* it is solved: only the sets have been measured again */
    }
    /* sets after an excitation have no rows here, and say nothing of its DoF */
    bool over = uncertain_of(id)->excited && !uncertain_of(id)->fresh;
    bool ready = !over && uncertain_is_ready(id);
    if (ready) { /* else the last estimate stays: also if early rows are forgotten, a DoF is new */
        uncertain_of(id)->fresh = false;
        auvid_uncertain_begin(uncertain_of(id));
    }
    return ready;
}

static const auvid_estimate_t *uncertain_estimate(const auvid_identifier_t *id)
{
    const auvid_estimate_t *e = &uncertain_of(id)->estimate;
    return e->number > 0 ? e : NULL;
}

static void uncertain_accept(auvid_identifier_t *id)
{
    auvid_estimate_t *e = &uncertain_of(id)->estimate;
    e->accepted = e->accepted || e->number == id->estimate.number;
}

static void uncertain_change_vehicle(auvid_identifier_t *id)
{
    auvid_uncertain_t *u = uncertain_of(id);
    auvid_uncertain_restart(u);
    u->excited = u->gave_set = false; /* without another excitation passive rows count again */
    u->estimate.number = 0;
    memset(&u->causes, 0, sizeof u->causes);
    u->contradicted = false;
}

/* Only a sag that is certain: noise must not hide a change of the vehicle. */
static auvid_real_t uncertain_sag(const auvid_identifier_t *id)
{
    const auvid_cause_t *sag = &uncertain_of(id)->causes.cause[AUVID_CAUSE_SAG];
    const auvid_metric_t *m = &id->metric;
    uint32_t cells = (uint32_t)m->cfg.set_rows * m->cfg.row_cells;
    auvid_real_t set_s =
        AUVID_C(1e-6) * (auvid_real_t)cells * (auvid_real_t)auvid_metric_cell_us(m);
    return auvid_abs(sag->value) > AUVID_CAUSE_SIGMAS * sag->sigma
               ? set_s / AUVID_UNCERTAIN_SAG_S * sag->value
               : AUVID_C(0.0);
}

/* Write, for each parameter, that among these, a bit each, with which it is most correlated, and by
 * more than `least`; or NOWHERE. */
static void uncertain_find_partners(const auvid_estimate_t *e, int n, const auvid_real_t *sigma,
                                    uint32_t among, auvid_real_t least, uint8_t *partner)
{
    auvid_real_t largest[AUVID_MAX_PARAMETERS];
    const auvid_real_t *covariance = e->covariance;
    for (int p = 0; p < n; ++p) {
        largest[p] = least;
        partner[p] = NOWHERE;
    }
    for (int p = 0; p < n && among != 0; ++p) {
        ++covariance; /* its variance */
        for (int k = p + 1; k < n; ++k) {
            auvid_real_t both = sigma[p] * sigma[k], size = auvid_abs(*covariance++);
            bool some = both > AUVID_C(0.0);
            if (some && (among >> k & 1u) != 0 && size > largest[p] * both) {
                largest[p] = size / both;
                partner[p] = (uint8_t)k;
            }
            if (some && (among >> p & 1u) != 0 && size > largest[k] * both) {
                largest[k] = size / both;
                partner[k] = (uint8_t)p;
            }
        }
    }
}

/* Inputs less exact than configured make the scales that are not observable less certain, by the
 * square of the factor: it is too small, as it counts three inputs as right that were not seen. */
static void uncertain_widen_scales(auvid_uncertainty_t *scales, auvid_real_t factor)
{
    auvid_real_t by = auvid_max(factor * factor, ONE);
    scales->thrust_scale = auvid_min(by * scales->thrust_scale, ONE);
    scales->dvl_scale = auvid_min(by * scales->dvl_scale, ONE);
}

/* Are the inputs not checked? None is uncertain, or more was found than their priors allow. */
static bool uncertain_is_unchecked(const auvid_identifier_t *id)
{
    const auvid_uncertain_t *u = uncertain_of(id);
    bool exact = true;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        exact = exact && u->equation[j].inputs == 0;
    }
    return (exact && !id->exact_inputs) || u->scale >= AUVID_UNCERTAIN_LARGEST_SCALE;
}

/* Assess the parameters of the joint solution. free: what they would be without bounds. */
static void uncertain_assess_parameters(auvid_identifier_t *id, const auvid_real_t *sigma,
                                        const auvid_real_t *free)
{
    const auvid_estimate_t *e = &uncertain_of(id)->estimate;
    const auvid_vehicle_t *vehicle = id->metric.cfg.vehicle;
    auvid_confidence_job_t *job = &id->confidence;
    uint8_t partner[AUVID_MAX_PARAMETERS], at_bound[AUVID_MAX_PARAMETERS];
    uncertain_find_partners(e, vehicle->parameters, sigma, ~0u, AUVID_CORRELATED, partner);
    uncertain_find_partners(e, vehicle->parameters, sigma, job->at_bound, AUVID_C(0.0), at_bound);
    for (int i = 0; i < job->n; ++i) {
        int p = job->parameter_of[i];
        auvid_finding_t found = {
            .sigma = sigma[p],
            .exact = auvid_confidence_is_known(&job->result, p), /* without uncertain inputs */
            .bound_shift = free[p] - e->pi[p],
            .partner = partner[p],
            .bound_partner = at_bound[p]};
        auvid_confidence_revise_parameter(job, &id->metric, i, &found);
    }
}

/* Assess the solution, and write the estimate. */
static void uncertain_assess(auvid_identifier_t *id)
{
    auvid_uncertain_t *u = uncertain_of(id);
    auvid_confidence_job_t *job = &id->confidence;
    const auvid_vehicle_t *vehicle = id->metric.cfg.vehicle;
    auvid_estimate_t *e = &u->estimate;
    auvid_real_t sigma[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)}, free[AUVID_MAX_PARAMETERS];
    *e = id->estimate;
    e->evaluations_crs = u->work.searched.crs;
    e->evaluations_line = u->work.searched.line_search;
    e->not_converged = u->work.not_converged;
    memcpy(e->covariance, u->work.part.factor,
           (size_t)AUVID_QR_FACTOR(vehicle->parameters) * sizeof e->covariance[0]);
    for (int i = 0; i < vehicle->parameters; ++i) {
        sigma[i] = auvid_sqrt(auvid_estimate_covariance(e, vehicle, i, i));
        e->pi[i] = sigma[i] > AUVID_C(0.0) ? u->pi[i] : e->pi[i];
    }
    uncertain_widen_scales(&job->result.uncertainty, u->scale);
    job->result.unchecked = uncertain_is_unchecked(id);
    auvid_confidence_revise(job, e->pi);
    auvid_confidence_limits(job, id->search.lower, id->search.upper, e->not_converged);
    memcpy(free, e->pi, sizeof free);
    if (job->at_bound != 0) {
        auvid_uncertain_free(u, free);
    }
    uncertain_assess_parameters(id, sigma, free);
    auvid_confidence_close_loop(job, &id->metric,
                                u->excited ? id->metric.cfg.closed_loop
                                           : auvid_metric_feedback_dofs(&id->metric),
                                u->work.strong);
    e->confidence = job->result;
}

static auvid_status_t uncertain_solve(auvid_identifier_t *id, uint32_t *budget)
{
    return auvid_uncertain_solve(uncertain_of(id), &id->metric, budget);
}

/* Say why the inputs of an estimate were not checked. */
static void uncertain_say_why(const auvid_identifier_t *id, auvid_confidence_t *c, uint8_t why)
{
    for (int i = 0; i < id->metric.cfg.vehicle->parameters; ++i) {
        c->partner[i] = c->note[i] == AUVID_NOTE_UNCHECKED ? why : c->partner[i];
    }
}

static void uncertain_publish(auvid_identifier_t *id)
{
    auvid_uncertain_t *u = uncertain_of(id);
    if (!u->work.solving) { /* uncertain_begin was not ready */
        uncertain_say_why(id, &id->estimate.confidence, TOO_FEW_ROWS);
        return;
    }
    u->work.solving = false;
    if (u->contradicted || auvid_uncertain_thrust_differs(u)) {
        u->estimate.number = 0;
        uncertain_say_why(id, &id->estimate.confidence, INEXACT_INPUTS);
    } else {
        uncertain_assess(id);
        uncertain_say_why(id, &u->estimate.confidence, INEXACT_INPUTS);
    }
    auvid_uncertain_publish_causes(u);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        u->linear[j] = auvid_uncertain_linear_part(u, &id->metric, j);
    }
    u->half_length_m = auvid_uncertain_half_length(u, &id->metric);
    u->informed = (uint8_t)(u->informed + (u->informed < 2));
}

/* Half of the length before the first solution: twice the arm of the largest yaw moment. */
static auvid_real_t uncertain_first_half(const auvid_metric_t *m)
{
    const auvid_real_t *max = m->cfg.tau_max;
    auvid_real_t force = auvid_max(auvid_max(max[AUVID_SURGE], max[AUVID_SWAY]), max[AUVID_HEAVE]);
    return force > AUVID_C(0.0) ? AUVID_C(2.0) * max[AUVID_YAW] / force : AUVID_C(0.0);
}

static const auvid_uncertain_functions_t uncertain_table = {
    auvid_uncertain_add_cell, auvid_uncertain_rotate,   uncertain_begin,
    uncertain_solve,          uncertain_publish,        uncertain_estimate,
    uncertain_accept,         uncertain_change_vehicle, uncertain_sag,
    auvid_uncertain_drag};

/* Check what needs no layout. */
static void uncertain_check(const auvid_identifier_t *id, const auvid_uncertain_config_t *cfg,
                            const auvid_allocation_t *allocation, auvid_refusal_t *why)
{
    auvid_check_begin(why);
    AUVID_CHECK_TABLE(why, cfg, uncertain_fields);
    auvid_check_that(why, !auvid_metric_stores_rows(&id->metric), AUVID_ERR_MODEL, "vehicle");
    auvid_check_that(why, AUVID_MAX_UNCERTAIN > 0, AUVID_ERR_SIZE, "AUVID_MAX_UNCERTAIN");
    auvid_check_limit(why, AUVID_MAX_COMMANDS >= AUVID_MAX_THRUSTERS, AUVID_ERR_SIZE,
                      "AUVID_MAX_COMMANDS", (auvid_real_t)AUVID_MAX_COMMANDS,
                      (auvid_real_t)AUVID_MAX_THRUSTERS);
    auvid_check_count(why, AUVID_ERR_SIZE, "thrusters", allocation->cfg.thrusters,
                      AUVID_MAX_THRUSTERS);
}

/* Connect them to what calls them. */
static void uncertain_connect(auvid_identifier_t *id, auvid_uncertain_t *u)
{
    u->half_length_m = uncertain_first_half(&id->metric);
    id->attached.uncertain = u;
    id->attached.uncertain_functions = &uncertain_table;
    auvid_metric_attach_extra(&id->metric, &auvid_uncertain_extra, u);
    auvid_recorder_attach(&id->recorder, auvid_uncertain_advance_propellers, u);
}

auvid_status_t auvid_identifier_attach_uncertain(auvid_identifier_t *id, auvid_uncertain_t *storage,
                                                 const auvid_uncertain_config_t *cfg,
                                                 const auvid_allocation_t *allocation)
{
    auvid_refusal_t why;
    if (id == NULL || storage == NULL || cfg == NULL || allocation == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_identifier_check_attach(id, id->attached.uncertain);
    if (status < 0) {
        return status;
    }
    const auvid_uncertain_config_t own = *cfg; /* it may be that of *storage */
    uncertain_check(id, &own, allocation, &why);
    memset(storage, 0, sizeof *storage);
    storage->cfg = own;
    storage->id = id;
    storage->allocation = allocation;
    storage->checkpoint = &auvid_uncertain_checkpoint;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        storage->linear[j] = FIRST_LINEAR;
    }
    if (why.status == AUVID_OK) {
        auvid_uncertain_lay_out(storage, &id->metric, &why);
    }
    if (why.status < 0) {
        storage->refusal = why;
        return why.status;
    }
    auvid_identifier_set_scale(id, allocation);
    uncertain_connect(id, storage);
    return AUVID_OK;
}

/* Have both the same columns? */
static bool uncertain_is_same(const auvid_uncertain_t *u, const auvid_uncertain_t *known)
{
    bool same = true;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        same = same && u->equation[j].order == known->equation[j].order;
    }
    for (int k = 0; k < AUVID_UNCERTAIN_CHANNELS; ++k) {
        same = same && u->code[k] == known->code[k];
    }
    return same;
}

auvid_status_t auvid_uncertain_start(auvid_uncertain_t *uncertain, const auvid_uncertain_t *known)
{
    auvid_uncertain_t *u = uncertain;
    if (u == NULL || known == NULL) {
        return AUVID_ERR_NULL;
    }
    if (u->id == NULL || u->id->attached.uncertain != u || known->estimate.number == 0) {
        return AUVID_ERR_STATE;
    }
    auvid_status_t status = auvid_identifier_check_attach(u->id, NULL);
    if (status < 0) {
        return status;
    }
    if (!uncertain_is_same(u, known)) {
        return AUVID_ERR_MODEL;
    }
    memcpy(u->pi, known->pi, sizeof u->pi);
    memcpy(u->shared, known->shared, sizeof u->shared);
    memcpy(u->own, known->own, sizeof u->own);
    memcpy(u->linear, known->linear, sizeof u->linear);
    memcpy(u->hidden, known->hidden, sizeof u->hidden);
    u->half_length_m = known->half_length_m;
    u->scale = known->scale;
    u->informed = 2;
    u->given = true;
    return AUVID_OK;
}
