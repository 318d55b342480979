/*
 * The active half of the identifier: guard and excitation.
 */
#include "auvid_identifier_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"

static auvid_guard_seen_t identifier_last_seen(const auvid_nav_t *nav, auvid_nav_sensor_t sensor)
{
    auvid_guard_seen_t seen = {nav->diagnostics[sensor].good_us,
                               nav->diagnostics[sensor].has_sample};
    return seen;
}

/* Collect the guard's input from the filter and the other sensors. */
static void identifier_fill_guard_input(const auvid_identifier_t *id, bool saturated,
                                        auvid_guard_input_t *in)
{
    auvid_nav_state_t state;
    memset(in, 0, sizeof *in);
    in->saturated = saturated || id->saturated;
    in->heaves = id->excitation.heaves;
    in->altitude = id->altitude;
    in->altitude_m = id->altitude_m;
    in->applied = id->applied;
    if (auvid_nav_state(&id->nav, &state) != AUVID_OK) {
        return; /* without IMU samples there are no others */
    }
    in->imu.t_us = state.t_us;
    in->imu.known = true;
    in->ground = (auvid_guard_seen_t){id->nav.horizontal_us, id->nav.horizontal};
    in->velocity = in->ground;
    if (id->excitation.heaves) {
        in->velocity = (auvid_guard_seen_t){id->nav.complete_us, id->nav.complete};
    }
    in->depth = identifier_last_seen(&id->nav, AUVID_NAV_DEPTH);
    const auvid_nav_velocity_sample_t *water = &id->nav.water;
    if (id->guard.cfg.water_lock && water->sequence > 0 &&
        (!in->velocity.known || water->t_us > in->velocity.t_us)) {
        in->velocity = (auvid_guard_seen_t){water->t_us, true};
    }
    memcpy(in->position, state.position, sizeof in->position);
    memcpy(in->velocity_ground, state.velocity, sizeof in->velocity_ground);
    memcpy(in->rates, state.rates, sizeof in->rates);
    in->roll = id->nav.attitude[0]; /* not unwrapped: a full turn is level */
    in->pitch = state.attitude[1];
}

/* Step the guard and add its events to *events. @return whether the excitation may act */
static bool identifier_step_guard(auvid_identifier_t *id, uint64_t t_us,
                                  const auvid_guard_input_t *in, uint32_t *events)
{
    auvid_guard_state_t before = id->guard.state;
    bool may = auvid_guard_step(&id->guard, t_us, in);
    if (id->guard.state != before) {
        *events |=
            id->guard.state == AUVID_GUARD_ABORTED ? AUVID_EVENT_ABORTED : AUVID_EVENT_SETTLED;
    }
    return may;
}

static void identifier_take_altitude(auvid_identifier_t *id, const auvid_input_t *in)
{
    if (!in->altitude.present) {
        return;
    }
    uint64_t t_us = in->altitude.t_us;
    bool newer = !id->altitude.known || t_us > id->altitude.t_us;
    bool ahead = t_us > in->t_us && t_us - in->t_us > id->nav.future_us;
    if (newer && !ahead && auvid_is_finite(in->altitude.altitude_m) &&
        in->altitude.altitude_m >= AUVID_C(0.0)) {
        id->altitude.t_us = t_us;
        id->altitude.known = true;
        id->altitude_m = in->altitude.altitude_m;
    } else {
        id->events |= AUVID_EVENT_ALTITUDE_DROPPED;
    }
}

/* Displacement since the excitation began: d = R' (position - home), angles as differences. */
static void identifier_set_displacement(auvid_identifier_t *id)
{
    auvid_nav_state_t state;
    auvid_real_t moved[AUVID_DOF_COUNT], d[AUVID_DOF_COUNT], r[3][3];
    if (auvid_nav_state(&id->nav, &state) != AUVID_OK) {
        return;
    }
    if (id->starting) {
        memcpy(id->home, state.position, sizeof state.position);
        memcpy(id->home + AUVID_ROLL, state.attitude, sizeof state.attitude);
    }
    for (int i = 0; i < 3; ++i) {
        moved[i] = state.position[i] - id->home[i];
        d[AUVID_ROLL + i] = state.attitude[i] - id->home[AUVID_ROLL + i];
    }
    auvid_rotation(state.attitude[0], state.attitude[1], state.attitude[2], r);
    for (int j = 0; j < 3; ++j) {
        d[j] = r[0][j] * moved[0] + r[1][j] * moved[1] + r[2][j] * moved[2];
    }
    (void)auvid_excitation_set_displacement(&id->excitation, d);
}

static void identifier_end_excitation(auvid_identifier_t *id)
{
    (void)auvid_guard_finished(&id->guard, id->t_us);
    id->starting = false;
    id->events |= AUVID_EVENT_EXCITATION_DONE;
}

static void identifier_play_excitation(auvid_identifier_t *id, auvid_output_t *out)
{
    auvid_real_t wrench[AUVID_DOF_COUNT];
    if (id->starting) {
        (void)auvid_excitation_start(&id->excitation, id->t_us);
    }
    identifier_set_displacement(id);
    id->starting = false;
    if (auvid_excitation_step(&id->excitation, id->t_us, wrench) != AUVID_OK) {
        identifier_end_excitation(id);
        return;
    }
    if (id->adapt != NULL) {
        id->adapt(id, wrench);
    }
    if (id->allocation.cfg.thrusters == 0) {
        memcpy(out->excitation, wrench, sizeof wrench);
        return;
    }
    auvid_allocation_result_t result;
    auvid_status_t status = auvid_allocation_solve(&id->allocation, wrench, &result);
    id->saturated = status == AUVID_SATURATED;
    if (status >= 0) {
        memcpy(out->excitation, result.wrench, sizeof out->excitation);
        memcpy(out->thruster_N, result.force_N, sizeof out->thruster_N);
    }
}

static void identifier_publish_state(const auvid_identifier_t *id, auvid_output_t *out)
{
    out->guard = id->guard.state;
    out->cause = id->guard.trip.cause;
}

void auvid_identifier_act(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out)
{
    bool may;
    identifier_take_altitude(id, in);
    { /* a block, so that the guard's input is not on the stack during the excitation */
        auvid_guard_input_t seen;
        identifier_fill_guard_input(id, in->saturated, &seen);
        id->saturated = false;
        may = identifier_step_guard(id, id->t_us, &seen, &id->events);
    }
    if (may) {
        identifier_play_excitation(id, out);
    }
    identifier_publish_state(id, out);
}

void auvid_identifier_refused(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out)
{
    auvid_guard_input_t nothing;
    if (id == NULL || !identifier_is_ready(id)) {
        return;
    }
    memset(&nothing, 0, sizeof nothing);
    if (in == NULL || out == NULL) {
        (void)identifier_step_guard(id, id->t_us, NULL, out == NULL ? &id->events : &out->events);
    } else {
        (void)identifier_step_guard(id, in->t_us, &nothing, &out->events);
    }
    if (out != NULL) {
        identifier_publish_state(id, out);
    }
}

auvid_status_t auvid_identifier_arm(auvid_identifier_t *id)
{
    auvid_guard_input_t seen;
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id) || id->excitation.cfg.segments == 0) {
        return AUVID_ERR_STATE;
    }
    identifier_fill_guard_input(id, false, &seen);
    auvid_status_t status = auvid_guard_arm(&id->guard, id->t_us, &seen);
    if (status == AUVID_OK) { /* a step at the time of arming exists: the next must be later */
        id->guard.stepped = id->started;
    }
    return status;
}

auvid_status_t auvid_identifier_excite(auvid_identifier_t *id)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_guard_excite(&id->guard, id->t_us);
    id->starting = id->starting || status == AUVID_OK;
    return status;
}

auvid_status_t auvid_identifier_stop(auvid_identifier_t *id)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    if (id->guard.state != AUVID_GUARD_EXCITING) {
        return AUVID_ERR_STATE;
    }
    if (id->starting) {
        identifier_end_excitation(id);
        return AUVID_OK;
    }
    return auvid_excitation_stop(&id->excitation, id->t_us);
}

auvid_status_t auvid_identifier_abort(auvid_identifier_t *id)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    bool before = id->guard.state == AUVID_GUARD_ABORTED;
    auvid_status_t status = auvid_guard_abort(&id->guard, id->t_us);
    if (status == AUVID_OK && !before) {
        id->events |= AUVID_EVENT_ABORTED;
    }
    return status;
}

auvid_status_t auvid_identifier_disarm(auvid_identifier_t *id)
{
    return id == NULL ? AUVID_ERR_NULL : auvid_guard_disarm(&id->guard);
}
