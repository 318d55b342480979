/*
 * The acting half of the identifier: guard, excitation and allocation. The rest of the identifier
 * names none of its functions: it calls those of actuation_functions, once they are attached.
 */
#include "auvid_actuation_internal.h"

#include <string.h>

#include "auvid_identifier_internal.h"

#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"
#include "../excitation/auvid_excitation_init_internal.h"
#include "../navigation/auvid_nav_internal.h"

static auvid_guard_seen_t actuation_last_seen(const auvid_nav_t *nav, auvid_nav_sensor_t sensor)
{
    const auvid_nav_diagnostics_t *d = &nav->diagnostics[sensor];
    return (auvid_guard_seen_t){.t_us = d->good_us, .known = d->has_sample};
}

/* The angle within half a turn. */
static auvid_real_t actuation_wrap(auvid_real_t angle)
{
    auvid_real_t s, c;
    if (auvid_abs(angle) <= AUVID_C(3.1415927)) {
        return angle;
    }
    auvid_sincos(angle, &s, &c);
    return auvid_atan2(s, c);
}

/* The samples of this tick, for the test of repetition. */
static void actuation_fill_values(const auvid_input_t *in, uint32_t *values)
{
    if (in->imu.present) {
        bool quaternion = in->imu.by_quaternion;
        values[AUVID_GUARD_ATTITUDE] = auvid_guard_values(
            quaternion ? in->imu.quaternion : in->imu.attitude, quaternion ? 4 : 3);
        values[AUVID_GUARD_RATES] = auvid_guard_values(in->imu.rates, 3);
    }
    if (in->dvl.present && in->dvl.sample.lock == AUVID_DVL_BOTTOM) {
        values[AUVID_GUARD_BOTTOM] = auvid_guard_values(in->dvl.sample.velocity, 3);
    }
    if (in->depth.present || in->pressure.present) {
        values[AUVID_GUARD_PRESSURE] = auvid_guard_values(
            in->depth.present ? &in->depth.depth_m : &in->pressure.pressure_pa, 1);
    }
}

/* Collect the guard's input from the filter and the other sensors. */
static void actuation_fill_guard_input(const auvid_identifier_t *id, bool saturated,
                                       auvid_guard_input_t *in)
{
    const auvid_actuation_t *a = id->actuation;
    auvid_nav_state_t state;
    auvid_zero(in, sizeof *in);
    in->saturated = saturated || a->saturated;
    in->heaves = a->excitation.heaves;
    in->altitude = a->altitude;
    in->altitude_m = a->altitude_m;
    in->applied = id->applied;
    if (!auvid_nav_pose(&id->nav, &state)) {
        return; /* without IMU samples there are no others */
    }
    in->imu.t_us = state.t_us;
    in->imu.known = true;
    in->ground = (auvid_guard_seen_t){.t_us = id->nav.horizontal_us, .known = id->nav.horizontal};
    in->velocity = in->ground;
    if (a->excitation.heaves) {
        in->velocity = (auvid_guard_seen_t){.t_us = id->nav.complete_us, .known = id->nav.complete};
    }
    in->depth = actuation_last_seen(&id->nav, AUVID_NAV_DEPTH);
    const auvid_nav_velocity_sample_t *water = &id->nav.water;
    if (a->guard.cfg.water_lock && water->sequence > 0 &&
        (!in->velocity.known || water->t_us > in->velocity.t_us)) {
        in->velocity = (auvid_guard_seen_t){.t_us = water->t_us, .known = true};
    }
    memcpy(in->position, state.position, sizeof in->position);
    memcpy(in->velocity_ground, state.velocity, sizeof in->velocity_ground);
    memcpy(in->rates, state.rates, sizeof in->rates);
    in->roll = actuation_wrap(id->nav.imu.attitude[0]); /* not unwrapped: a full turn is level */
    in->pitch = state.attitude[1];
}

/* Step the guard and add its events to *events. @return whether the excitation may act */
static bool actuation_step_guard(auvid_actuation_t *a, uint64_t t_us, const auvid_guard_input_t *in,
                                 uint32_t *events)
{
    auvid_guard_state_t before = a->guard.state;
    bool may = auvid_guard_step(&a->guard, t_us, in);
    if (a->guard.state != before) {
        *events |=
            a->guard.state == AUVID_GUARD_ABORTED ? AUVID_EVENT_ABORTED : AUVID_EVENT_SETTLED;
    }
    return may;
}

static void actuation_take_altitude(auvid_identifier_t *id, const auvid_input_t *in)
{
    auvid_actuation_t *a = id->actuation;
    if (!in->altitude.present) {
        return;
    }
    uint64_t t_us = in->altitude.t_us;
    bool newer = !a->altitude.known || t_us > a->altitude.t_us;
    bool ahead = t_us > in->t_us && t_us - in->t_us > id->nav.cfg.future_us;
    if (newer && !ahead && in->altitude.altitude_m >= AUVID_C(0.0) &&
        in->altitude.altitude_m <= AUVID_ACTUATION_HIGHEST_M) {
        a->altitude.t_us = t_us;
        a->altitude.known = true;
        a->altitude_m = in->altitude.altitude_m;
    } else {
        id->events |= AUVID_EVENT_ALTITUDE_DROPPED;
    }
}

/* Displacement since the excitation began: d = R' (position - home), angles as differences. */
static void actuation_set_displacement(const auvid_identifier_t *id)
{
    auvid_actuation_t *a = id->actuation;
    auvid_nav_state_t state;
    auvid_real_t moved[AUVID_DOF_COUNT], d[AUVID_DOF_COUNT], r[3][3];
    if (!auvid_nav_pose(&id->nav, &state)) {
        return;
    }
    if (a->starting) {
        memcpy(a->home, state.position, sizeof state.position);
        memcpy(a->home + AUVID_ROLL, state.attitude, sizeof state.attitude);
    }
    for (int i = 0; i < 3; ++i) {
        moved[i] = state.position[i] - a->home[i];
        d[AUVID_ROLL + i] = state.attitude[i] - a->home[AUVID_ROLL + i];
    }
    auvid_rotation(state.attitude[0], state.attitude[1], state.attitude[2], r);
    for (int j = 0; j < 3; ++j) {
        d[j] = r[0][j] * moved[0] + r[1][j] * moved[1] + r[2][j] * moved[2];
    }
    (void)auvid_excitation_set_displacement(&a->excitation, d);
}

static void actuation_end_excitation(auvid_identifier_t *id)
{
    auvid_actuation_t *a = id->actuation;
    (void)auvid_guard_finished(&a->guard, id->t_us);
    a->starting = false;
    id->events |= AUVID_EVENT_EXCITATION_DONE;
}

static void actuation_play_excitation(auvid_identifier_t *id, auvid_output_t *out)
{
    auvid_actuation_t *a = id->actuation;
    auvid_real_t wrench[AUVID_DOF_COUNT];
    if (a->starting) {
        (void)auvid_excitation_start(&a->excitation, id->t_us);
    }
    actuation_set_displacement(id);
    a->starting = false;
    if (a->shape != NULL) {
        a->shape(id);
    }
    if (auvid_excitation_step(&a->excitation, id->t_us, wrench) != AUVID_OK) {
        actuation_end_excitation(id);
        return;
    }
    if (a->allocation == NULL) {
        memcpy(out->excitation, wrench, sizeof wrench);
        return;
    }
    auvid_allocation_result_t result;
    auvid_status_t status = auvid_allocation_solve(a->allocation, wrench, &result);
    a->saturated = status == AUVID_SATURATED;
    if (status >= 0) {
        memcpy(out->excitation, result.wrench, sizeof out->excitation);
        memcpy(out->thruster_N, result.force_N, sizeof out->thruster_N);
    }
}

static void actuation_publish_state(const auvid_actuation_t *a, auvid_output_t *out)
{
    out->guard = a->guard.state;
    out->cause = a->guard.trip.cause;
}

static void actuation_step(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out)
{
    auvid_actuation_t *a = id->actuation;
    bool may;
    actuation_take_altitude(id, in);
    { /* a block, so that the guard's input is not on the stack during the excitation */
        auvid_guard_input_t seen;
        actuation_fill_guard_input(id, in->saturated, &seen);
        actuation_fill_values(in, seen.values);
        a->saturated = false;
        may = actuation_step_guard(a, id->t_us, &seen, &id->events);
    }
    if (may) {
        actuation_play_excitation(id, out);
    }
    actuation_publish_state(a, out);
}

static void actuation_refuse(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out)
{
    auvid_guard_input_t nothing;
    memset(&nothing, 0, sizeof nothing);
    if (in == NULL || out == NULL) {
        (void)actuation_step_guard(id->actuation, id->t_us, NULL,
                                   out == NULL ? &id->events : &out->events);
    } else {
        (void)actuation_step_guard(id->actuation, in->t_us, &nothing, &out->events);
    }
    if (out != NULL) {
        actuation_publish_state(id->actuation, out);
    }
}

/* ---- attaching ---- */

static const auvid_actuation_functions_t actuation_functions = {actuation_step, actuation_refuse};

void auvid_actuation_defaults(auvid_actuation_config_t *cfg)
{
    if (cfg != NULL) {
        auvid_excitation_defaults(&cfg->excitation);
        auvid_guard_defaults(&cfg->guard);
    }
}

/* The excitation must be within the thrusters' limits. */
static void actuation_check_peak(const auvid_actuation_t *a, auvid_refusal_t *why)
{
    auvid_real_t peak[AUVID_DOF_COUNT];
    auvid_allocation_fit_t fit;
    (void)auvid_excitation_peak(&a->excitation, peak);
    auvid_status_t status = auvid_allocation_check(a->allocation, peak, NULL, &fit);
    if (status < 0) { /* no hold, so some DoF is too large */
        auvid_check_part(why, "excitation");
        auvid_check_element(why, fit.dof);
        auvid_check_limit(why, false, status, "segment.amplitude", peak[fit.dof],
                          fit.factor * peak[fit.dof]);
    }
}

static void actuation_init(auvid_actuation_t *a, const auvid_actuation_config_t *cfg,
                           auvid_refusal_t *why)
{
    const auvid_allocation_t *allocation = a->allocation;
    auvid_check_part(why, "allocation");
    auvid_check_limit(why, allocation == NULL || allocation->cfg.thrusters > 0, AUVID_ERR_SIZE,
                      "thrusters", AUVID_C(0.0), AUVID_C(1.0));
    auvid_check_part(why, "guard");
    auvid_guard_set_up(&a->guard, &cfg->guard, why);
    if (cfg->excitation.segments > 0) {
        auvid_check_part(why, "excitation");
        auvid_excitation_set_up(&a->excitation, &cfg->excitation, why);
        if (why->status == AUVID_OK && allocation != NULL) {
            actuation_check_peak(a, why);
        }
    }
}

auvid_status_t auvid_identifier_attach_actuation(auvid_identifier_t *id, auvid_actuation_t *storage,
                                                 const auvid_actuation_config_t *cfg,
                                                 const auvid_allocation_t *allocation)
{
    if (id == NULL || storage == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_identifier_check_attach(id, id->actuation);
    if (status != AUVID_OK) {
        return status;
    }
    memset(storage, 0, sizeof *storage);
    storage->functions = &actuation_functions;
    storage->allocation = allocation;
    auvid_refusal_t why;
    auvid_check_begin(&why);
    actuation_init(storage, cfg, &why);
    if (why.status < 0) {
        storage->refusal = why;
        return why.status;
    }
    id->actuation = storage;
    if (allocation != NULL) {
        auvid_identifier_set_scale(id, allocation);
    }
    return AUVID_OK;
}

/* ---- orders ---- */

auvid_status_t auvid_actuation_check(const auvid_identifier_t *id)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    return !identifier_is_ready(id) ? AUVID_ERR_STATE
           : id->actuation == NULL  ? AUVID_ERR_DETACHED
                                    : AUVID_OK;
}

auvid_status_t auvid_identifier_arm(auvid_identifier_t *id)
{
    auvid_guard_input_t seen;
    auvid_status_t status = auvid_actuation_check(id);
    if (status < 0) {
        return status;
    }
    auvid_actuation_t *a = id->actuation;
    if (a->excitation.cfg.segments == 0) {
        return AUVID_ERR_STATE;
    }
    actuation_fill_guard_input(id, false, &seen);
    status = auvid_guard_arm(&a->guard, id->t_us, &seen);
    if (status == AUVID_OK) { /* a step at the time of arming exists, if it has started */
        auvid_guard_require_later(&a->guard, id->started);
    }
    return status;
}

auvid_status_t auvid_identifier_excite(auvid_identifier_t *id)
{
    auvid_status_t status = auvid_actuation_check(id);
    if (status == AUVID_OK) {
        status = auvid_guard_excite(&id->actuation->guard, id->t_us);
        id->actuation->starting = id->actuation->starting || status == AUVID_OK;
    }
    return status;
}

auvid_status_t auvid_identifier_stop(auvid_identifier_t *id)
{
    auvid_status_t status = auvid_actuation_check(id);
    if (status < 0) {
        return status;
    }
    auvid_actuation_t *a = id->actuation;
    if (!auvid_actuation_excites(id)) {
        return AUVID_ERR_STATE;
    }
    if (a->starting) {
        actuation_end_excitation(id);
        return AUVID_OK;
    }
    return auvid_excitation_stop(&a->excitation, id->t_us);
}

auvid_status_t auvid_identifier_abort(auvid_identifier_t *id)
{
    auvid_status_t status = auvid_actuation_check(id);
    if (status == AUVID_OK) {
        bool before = id->actuation->guard.state == AUVID_GUARD_ABORTED;
        status = auvid_guard_abort(&id->actuation->guard, id->t_us);
        id->events |= before ? 0u : AUVID_EVENT_ABORTED;
    }
    return status;
}

auvid_status_t auvid_identifier_disarm(auvid_identifier_t *id)
{
    auvid_status_t status = auvid_actuation_check(id);
    return status < 0 ? status : auvid_guard_disarm(&id->actuation->guard);
}
