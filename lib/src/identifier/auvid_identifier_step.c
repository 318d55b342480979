/*
 * The identifier (Karras et al. 2013, Fig. 2): the tick. Guard and excitation are in
 * auvid_actuation.c, the optimization is in auvid_identifier_work.c.
 */
#include "auvid_identifier_internal.h"

#include <string.h>

#include "auvid_actuation_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_feedback_internal.h"
#include "../metric/auvid_metric_rows_internal.h"
#include "../metric/auvid_metric_sets_internal.h"
#include "../navigation/auvid_nav_internal.h"
#include "auvid_input_internal.h"

_Static_assert(AUVID_EVENT_END - 1u <= 1u << 30, "an enumerator of C11 is an int");

/* Pass a cell to what simulates velocity. NULL: a gap. */
static void identifier_pass_cell(auvid_identifier_t *id, const auvid_sample_t *cell)
{
    if (id->attached.simulate != NULL) {
        id->attached.simulate->cell(id, cell);
    }
}

/* Returns the part of the thrust that is certainly lost since the middle of the estimate's sets. */
static auvid_real_t identifier_lost_thrust(const auvid_identifier_t *id)
{
    const auvid_uncertain_functions_t *uncertain = id->attached.uncertain_functions;
    const auvid_metric_t *m = &id->metric;
    if (uncertain == NULL) {
        return AUVID_C(0.0);
    }
    auvid_real_t sets = (auvid_real_t)(m->sets.recorded - id->estimate.sets) +
                        (auvid_real_t)m->rows.set.rows / (auvid_real_t)m->cfg.set_rows +
                        AUVID_C(0.5) * (auvid_real_t)id->estimate.confidence.sets;
    return sets * uncertain->sag(id);
}

/* Test whether the wrench is feedback; the excitation is not. */
static void identifier_watch_cell(auvid_identifier_t *id, const auvid_sample_t *cell)
{
    const auvid_estimate_t *e = &id->estimate;
    auvid_change_detector_t *change = id->attached.change;
    bool excites = auvid_actuation_excites(id), watched = e->number > 0 && !excites;
    auvid_metric_watch(&id->metric, cell, watched ? e->pi : NULL, e->excited,
                       watched ? identifier_lost_thrust(id) : AUVID_C(0.0));
    if (change != NULL) {
        change->passive_cells = excites ? 0 : change->passive_cells + 1;
    }
}

/* Set the event if rows were dropped since there were `dropped`. */
static void identifier_flag_dropped(auvid_identifier_t *id, uint32_t dropped)
{
    bool drops = id->metric.sets.rows_dropped != dropped;
    id->events |= drops ? AUVID_EVENT_ROWS_DROPPED : 0u;
}

/* Do a part of what the last cell has left to do. @return false: nothing was left */
static bool identifier_continue_cell(auvid_identifier_t *id)
{
    const auvid_simulate_functions_t *simulate = id->attached.simulate;
    const auvid_uncertain_functions_t *uncertain = id->attached.uncertain_functions;
    if (auvid_metric_waits(&id->metric)) {
        uint32_t dropped = id->metric.sets.rows_dropped;
        identifier_take_set(id, auvid_metric_continue(&id->metric));
        identifier_flag_dropped(id, dropped);
        return true;
    }
    return (simulate != NULL && simulate->advance(id)) ||
           (uncertain != NULL && uncertain->add_cell(id));
}

/* Pass a complete cell to the metric and the simulation of velocity. @return false: none is */
static bool identifier_take_cell(auvid_identifier_t *id)
{
    auvid_sample_t cell;
    uint32_t dropped = id->metric.sets.rows_dropped;
    auvid_status_t status = auvid_recorder_pop(&id->recorder, &cell);
    if (status == AUVID_GAP) {
        auvid_metric_gap(&id->metric);
        identifier_pass_cell(id, NULL);
        id->events |= AUVID_EVENT_GAP;
    } else if (status == AUVID_OK) {
        auvid_metric_set_velocity_us(&id->metric, id->recorder.velocity_us);
        identifier_pass_cell(id, &cell);
        (void)auvid_metric_take_cell(&id->metric, &cell);
        identifier_watch_cell(id, &cell);
        identifier_flag_dropped(id, dropped);
    }
    return status == AUVID_GAP || status == AUVID_OK;
}

/* Take complete cells, at most max_cells, each with all that it leaves to do. */
static void identifier_take_cells(auvid_identifier_t *id, int max_cells)
{
    do {
        while (identifier_continue_cell(id)) {
        }
    } while (max_cells-- > 0 && identifier_take_cell(id));
}

/* Cells that the recorder has open where none piles up, at a DVL of 5 Hz; where ticks are short. */
enum { MAX_OPEN_CELLS = 6, FEW_OPEN_CELLS = 4 };

/* The same in a tick: one cell, or a part of what the last one has left to do, two if ticks are
 * long, unless cells pile up. */
static void identifier_take_cells_of_tick(auvid_identifier_t *id)
{
    const auvid_uncertain_functions_t *uncertain = id->attached.uncertain_functions;
    const auvid_recorder_t *recorder = &id->recorder; /* at its start next is 2, opened 0 */
    uint32_t open = recorder->opened > recorder->next ? recorder->opened - recorder->next : 0;
    if (open > MAX_OPEN_CELLS) {
        identifier_take_cells(id, AUVID_CELLS_PER_STEP);
    } else if (identifier_continue_cell(id)) {
        (void)(open > FEW_OPEN_CELLS && identifier_continue_cell(id));
    } else if (!identifier_take_cell(id) && uncertain != NULL) {
        uncertain->rotate(id);
    }
}

/* Record the velocity only after a DVL update: between updates a constant-velocity filter lags. */
static void identifier_record_velocity(auvid_identifier_t *id)
{
    bool water = id->velocity == AUVID_VELOCITY_WATER;
    const auvid_nav_velocity_sample_t *sample = water ? &id->nav.water : &id->nav.ground;
    if (sample->sequence != id->last_sample) {
        id->last_sample = sample->sequence;
        (void)auvid_recorder_velocity(&id->recorder, sample->t_us, sample->velocity,
                                      sample->measured);
    }
}

static void identifier_flag_rejected(auvid_identifier_t *id, auvid_status_t status, uint32_t event)
{
    id->events |= status < 0 || status == AUVID_GATED ? event : 0u;
}

/* Flag the rejected ones among the samples that waited for the IMU. */
static void identifier_flag_held(auvid_identifier_t *id)
{
    for (int i = 0; id->nav.held.rejected >> i != 0; ++i) {
        id->events |= (id->nav.held.rejected >> i & 1) != 0 ? auvid_input_places[i].event : 0u;
    }
    identifier_record_velocity(id); /* another update may follow in this step */
}

static auvid_status_t identifier_take_imu(auvid_nav_t *nav, const auvid_input_t *in)
{
    return in->imu.by_quaternion
               ? auvid_nav_imu_quaternion(nav, in->imu.t_us, in->imu.quaternion, in->imu.rates)
               : auvid_nav_imu(nav, in->imu.t_us, in->imu.attitude, in->imu.rates);
}

/* Pass the sensors to the filter; what it rejects becomes an event. */
static void identifier_navigate(auvid_identifier_t *id, const auvid_input_t *in)
{
    id->nav.held.until_us = in->t_us + id->nav.cfg.future_us;
    if (in->imu.present) {
        /* The filter follows the IMU's time: a sample far ahead would exclude all others. */
        if (in->imu.t_us > id->nav.held.until_us || identifier_take_imu(&id->nav, in) < 0) {
            id->events |= AUVID_EVENT_IMU_DROPPED;
        } else {
            identifier_flag_held(id);
        }
    }
    if (in->dvl.present) {
        identifier_flag_rejected(id, auvid_nav_dvl(&id->nav, &in->dvl.sample),
                                 AUVID_EVENT_DVL_DROPPED);
    }
    if (in->dvl_water.present) {
        identifier_flag_rejected(id, auvid_nav_dvl(&id->nav, &in->dvl_water.sample),
                                 AUVID_EVENT_DVL_DROPPED);
    }
    if (in->pressure.present) {
        identifier_flag_rejected(
            id, auvid_nav_pressure(&id->nav, in->pressure.t_us, in->pressure.pressure_pa),
            AUVID_EVENT_DEPTH_DROPPED);
    }
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        if (auvid_nav_rows[i].kind == NAV_POSITION && auvid_input_has(in, i)) {
            const uint64_t *t_us = INPUT_AT(in, i, t_us);
            auvid_status_t status =
                auvid_nav_update(&id->nav, (auvid_nav_sensor_t)i, *t_us, INPUT_AT(in, i, value), 0);
            identifier_flag_rejected(id, status, auvid_input_places[i].event);
        }
    }
}

/* Record the filter's state: the attitude in every tick. */
static void identifier_record_state(auvid_identifier_t *id, const auvid_input_t *in)
{
    auvid_nav_state_t state;
    if (!auvid_nav_pose(&id->nav, &state)) {
        return;
    }
    bool water = id->velocity == AUVID_VELOCITY_WATER;
    if (in->imu.present) {
        (void)auvid_recorder_attitude(&id->recorder, state.t_us, state.attitude, state.rates);
    }
    identifier_record_velocity(id);
    if (!nav_is_fresh(&id->nav, water ? AUVID_NAV_DVL_WATER : AUVID_NAV_DVL_BOTTOM)) {
        id->events |= AUVID_EVENT_VELOCITY_STALE;
    }
}

/* Record a wrench that is known from t_us on. */
static auvid_status_t identifier_record_input(auvid_identifier_t *id, uint64_t t_us,
                                              const auvid_real_t *wrench,
                                              const auvid_real_t *command)
{
    auvid_status_t status = auvid_recorder_input(&id->recorder, t_us, wrench, command);
    if (status >= 0) {
        id->applied.t_us = t_us;
        id->applied.known = true;
        if (identifier_listener(id) != NULL && !auvid_metric_drops_rows(&id->metric, t_us)) {
            id->attached.listener->command(id->attached.listener_context, t_us, command);
        }
    }
    return status;
}

/* Tell the acting half, if there is one, that a step is rejected. All may be NULL. */
static void identifier_refuse(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out)
{
    if (id != NULL && id->actuation != NULL) {
        id->actuation->functions->refuse(id, in, out);
    }
}

auvid_status_t auvid_identifier_step(auvid_identifier_t *id, const auvid_input_t *in,
                                     auvid_output_t *out)
{
    if (out != NULL) {
        auvid_zero(out, sizeof *out);
    }
    if (id == NULL || in == NULL || out == NULL) {
        identifier_refuse(id, in, out);
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    if (id->started && in->t_us <= id->t_us) {
        identifier_refuse(id, in, out);
        out->events |= AUVID_EVENT_TIME;
        return in->t_us == id->t_us ? AUVID_ERR_TIME_SAME : AUVID_ERR_TIME_BACK;
    }
    id->started = true;
    id->t_us = in->t_us;
    identifier_navigate(id, in);
    identifier_record_state(id, in);
    if (in->applied.present &&
        identifier_record_input(id, in->t_us, in->applied.wrench, in->applied.command) < 0) {
        id->events |= AUVID_EVENT_INPUT_DROPPED;
    }
    identifier_take_cells_of_tick(id);
    if (id->actuation != NULL) {
        id->actuation->functions->step(id, in, out);
    }
    out->events = id->events;
    id->events = 0;
    return AUVID_OK;
}

/* A sample of motion from outside is recorded, or refused: take the cells that it completes. */
static auvid_status_t identifier_recorded(auvid_identifier_t *id, uint64_t t_us,
                                          auvid_status_t status)
{
    if (status == AUVID_OK) {
        id->t_us = id->started || t_us < id->t_us ? id->t_us : t_us;
        identifier_take_cells(id, AUVID_RECORDER_CELLS);
    }
    return status;
}

auvid_status_t auvid_identifier_motion(auvid_identifier_t *id, uint64_t t_us,
                                       const auvid_real_t *attitude, const auvid_real_t *nu)
{
    if (id == NULL || attitude == NULL || nu == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    return identifier_recorded(id, t_us, auvid_recorder_motion(&id->recorder, t_us, attitude, nu));
}

auvid_status_t auvid_identifier_attitude(auvid_identifier_t *id, uint64_t t_us,
                                         const auvid_real_t *attitude, const auvid_real_t *rates)
{
    if (id == NULL || attitude == NULL || rates == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    return identifier_recorded(id, t_us,
                               auvid_recorder_attitude(&id->recorder, t_us, attitude, rates));
}

auvid_status_t auvid_identifier_velocity(auvid_identifier_t *id, uint64_t t_us,
                                         const auvid_real_t *velocity, unsigned measured)
{
    if (id == NULL || velocity == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    return identifier_recorded(id, t_us,
                               auvid_recorder_velocity(&id->recorder, t_us, velocity, measured));
}

auvid_status_t auvid_identifier_applied(auvid_identifier_t *id, uint64_t t_us,
                                        const auvid_real_t *wrench, const auvid_real_t *command)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    bool known = id->started || id->t_us > 0; /* the time */
    if (known && t_us > id->t_us && t_us - id->t_us > AUVID_INPUT_AHEAD_US) {
        return AUVID_ERR_STALE;
    }
    return identifier_record_input(id, t_us, wrench, command);
}

auvid_status_t auvid_identifier_close(auvid_identifier_t *id)
{
    if (id == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    identifier_take_cells(id, AUVID_RECORDER_CELLS);
    auvid_status_t status = auvid_metric_close(&id->metric);
    identifier_take_set(id, status);
    return status;
}
