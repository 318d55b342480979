/*
 * The guard of the excitation. Every limit is tested as !(value <= limit), so that NaN is a breach.
 */
#include "auvid_excitation_init_internal.h"
#include "auvid_guard_repeats_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../base/auvid_refusal_internal.h"

_Static_assert(AUVID_GUARD_CAUSE_COUNT <= 32, "AUVID_GUARD_BIT: a bit for each cause");

void auvid_guard_defaults(auvid_guard_config_t *cfg)
{
    if (cfg == NULL) {
        return;
    }
    memset(cfg, 0, sizeof *cfg);
    cfg->depth_min_m = AUVID_C(1.0);
    cfg->depth_max_m = AUVID_C(100.0);
    cfg->altitude_min_m = AUVID_C(2.0);
    cfg->roll_max_rad = AUVID_C(0.6);
    cfg->pitch_max_rad = AUVID_C(0.6);
    cfg->speed_max = AUVID_C(1.5);
    cfg->yaw_rate_max = AUVID_C(1.5);
    cfg->distance_max_m = AUVID_C(30.0);
    cfg->run_max_s = 1800;
    cfg->imu_stale_us = 200000;
    cfg->velocity_stale_us = 1000000;
    cfg->depth_stale_us = 1000000;
    cfg->altitude_stale_us = 1000000;
    cfg->applied_stale_us = 1000000;
    cfg->saturation_us = 1000000;
    cfg->repeat_us = 3000000;
    cfg->max_tick_us = 250000;
    cfg->rest_speed = AUVID_C(0.1);
    cfg->rest_rate = AUVID_C(0.1);
    cfg->rest_dwell_us = 2000000;
    cfg->settle_timeout_us = 30000000;
}

#define GUARD_LIMIT(name) REALS_IN(auvid_guard_config_t, name, 1, AUVID_C(0.0), AUVID_LARGEST)

void auvid_guard_set_up(auvid_guard_t *g, const auvid_guard_config_t *cfg, auvid_refusal_t *why)
{
    static const auvid_field_t limits[] = {
        GUARD_LIMIT(depth_min_m),  GUARD_LIMIT(depth_max_m),    GUARD_LIMIT(altitude_min_m),
        GUARD_LIMIT(roll_max_rad), GUARD_LIMIT(pitch_max_rad),  GUARD_LIMIT(speed_max),
        GUARD_LIMIT(yaw_rate_max), GUARD_LIMIT(distance_max_m), GUARD_LIMIT(rest_speed),
        GUARD_LIMIT(rest_rate),
    };
    AUVID_CHECK_TABLE(why, cfg, limits);
    auvid_check_limit(why, (cfg->off & ~AUVID_GUARD_SWITCHABLE) == 0, AUVID_ERR_RANGE, "off",
                      (auvid_real_t)cfg->off, (auvid_real_t)AUVID_GUARD_SWITCHABLE);
    auvid_check_limit(why, cfg->depth_min_m <= cfg->depth_max_m, AUVID_ERR_BOUNDS, "depth_min_m",
                      cfg->depth_min_m, cfg->depth_max_m);
    if (why->status != AUVID_OK) {
        return;
    }
    g->cfg = *cfg; /* which may be the same */
    memset((unsigned char *)g + sizeof g->cfg, 0, sizeof *g - sizeof g->cfg);
    g->ready = true;
}

auvid_status_t auvid_guard_init(auvid_guard_t *g, const auvid_guard_config_t *cfg)
{
    auvid_refusal_t why;
    if (g == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_check_begin(&why);
    auvid_guard_set_up(g, cfg, &why);
    return why.status;
}

static bool guard_is_on(const auvid_guard_t *g, auvid_guard_cause_t cause)
{
    return (g->cfg.off >> cause & 1u) == 0;
}

static bool guard_is_watching(const auvid_guard_t *g)
{
    return g->state == AUVID_GUARD_ARMED || g->state == AUVID_GUARD_EXCITING ||
           g->state == AUVID_GUARD_SETTLING;
}

/* For reports only. Whole seconds and fraction are converted separately, for any length. */
static auvid_real_t guard_to_s(uint64_t us)
{
    uint64_t whole = auvid_divide(us, 1000000u);
    return (auvid_real_t)(whole < UINT32_MAX ? (uint32_t)whole : UINT32_MAX) +
           (auvid_real_t)(uint32_t)(us - whole * 1000000u) * AUVID_C(1e-6);
}

static uint64_t guard_abs_diff_us(uint64_t a_us, uint64_t b_us)
{
    return a_us > b_us ? a_us - b_us : b_us - a_us;
}

/* A value that is not finite remains so; auvid_sqrt() would convert NaN to zero. */
static auvid_real_t guard_norm(auvid_real_t x, auvid_real_t y, auvid_real_t z)
{
    auvid_real_t sum = x * x + y * y + z * z;
    return auvid_is_finite(sum) ? auvid_sqrt(sum) : sum;
}

static bool guard_is_fresh(const auvid_guard_seen_t *seen, uint64_t t_us, uint32_t stale_us)
{
    return seen->known && guard_abs_diff_us(t_us, seen->t_us) <= stale_us;
}

/* Clears the padding too, so that guards compare bit for bit. */
static void guard_init_trip(auvid_guard_trip_t *trip, auvid_guard_cause_t cause, uint64_t t_us)
{
    memset(trip, 0, sizeof *trip);
    trip->cause = (uint8_t)cause;
    trip->t_us = t_us;
}

static bool guard_set_trip(auvid_guard_trip_t *trip, auvid_guard_cause_t cause, auvid_real_t value,
                           auvid_real_t limit)
{
    trip->cause = (uint8_t)cause;
    trip->value = value;
    trip->limit = limit;
    return true;
}

static bool guard_set_trip_time(auvid_guard_trip_t *trip, auvid_guard_cause_t cause, uint64_t us,
                                uint64_t limit_us)
{
    return guard_set_trip(trip, cause, guard_to_s(us), guard_to_s(limit_us));
}

/* Set the trip and return true if it took longer. */
static bool guard_too_long(const auvid_guard_t *g, auvid_guard_trip_t *trip,
                           auvid_guard_cause_t cause, uint64_t us, uint64_t limit_us)
{
    return guard_is_on(g, cause) && us > limit_us && guard_set_trip_time(trip, cause, us, limit_us);
}

/* Set the trip and return true unless value <= limit. */
static bool guard_above(const auvid_guard_t *g, auvid_guard_trip_t *trip, auvid_guard_cause_t cause,
                        auvid_real_t value, auvid_real_t limit)
{
    return guard_is_on(g, cause) && !(value <= limit && auvid_is_finite(value)) &&
           guard_set_trip(trip, cause, value, limit);
}

static bool guard_below(const auvid_guard_t *g, auvid_guard_trip_t *trip, auvid_guard_cause_t cause,
                        auvid_real_t value, auvid_real_t limit)
{
    return guard_is_on(g, cause) && !(value >= limit && auvid_is_finite(value)) &&
           guard_set_trip(trip, cause, value, limit);
}

static bool guard_stale(const auvid_guard_t *g, auvid_guard_trip_t *trip, auvid_guard_cause_t cause,
                        const auvid_guard_seen_t *seen, uint32_t stale_us)
{
    if (!guard_is_on(g, cause) || guard_is_fresh(seen, trip->t_us, stale_us)) {
        return false;
    }
    return guard_set_trip(trip, cause,
                          seen->known ? guard_to_s(guard_abs_diff_us(trip->t_us, seen->t_us))
                                      : AUVID_LARGEST,
                          guard_to_s(stale_us));
}

/* Set the trip and return true if a source that is watched repeats its values for too long. */
static bool guard_repeats(const auvid_guard_t *g, auvid_guard_trip_t *trip,
                          auvid_guard_cause_t cause, int source)
{
    return g->cfg.repeat_us > 0 &&
           guard_too_long(g, trip, cause, g->repeat_us[source], g->cfg.repeat_us);
}

/* Does the craft stay at the surface? Then depth_min_m has no meaning. */
static bool guard_at_surface(const auvid_guard_t *g, const auvid_guard_input_t *in)
{
    return g->cfg.surface && !in->heaves;
}

/* Is there a depth to watch? */
static bool guard_watches_depth(const auvid_guard_t *g, const auvid_guard_input_t *in)
{
    return !guard_at_surface(g, in) || g->depth_known;
}

/* Test the age of each source that the limits or the recording need. */
static bool guard_any_stale(const auvid_guard_t *g, auvid_guard_trip_t *trip,
                            const auvid_guard_input_t *in)
{
    const auvid_guard_config_t *cfg = &g->cfg;
    bool depth = guard_watches_depth(g, in) &&
                 (guard_is_on(g, AUVID_GUARD_DEPTH_MIN) || guard_is_on(g, AUVID_GUARD_DEPTH_MAX));
    bool altitude =
        guard_is_on(g, AUVID_GUARD_ALTITUDE) && (cfg->altitude_required || g->altitude_known);
    auvid_guard_seen_t applied = in->applied;
    if (!applied.known || applied.t_us < g->excite_us) {
        applied.known = true; /* nothing is to be recorded before excite */
        applied.t_us = g->excite_us;
    }
    return guard_stale(g, trip, AUVID_GUARD_IMU_STALE, &in->imu, cfg->imu_stale_us) ||
           guard_repeats(g, trip, AUVID_GUARD_IMU_STALE, AUVID_GUARD_ATTITUDE) ||
           guard_repeats(g, trip, AUVID_GUARD_IMU_STALE, AUVID_GUARD_RATES) ||
           guard_stale(g, trip, AUVID_GUARD_VELOCITY_STALE, &in->velocity,
                       cfg->velocity_stale_us) ||
           guard_repeats(g, trip, AUVID_GUARD_VELOCITY_STALE, AUVID_GUARD_BOTTOM) ||
           (depth &&
            (guard_stale(g, trip, AUVID_GUARD_DEPTH_STALE, &in->depth, cfg->depth_stale_us) ||
             guard_repeats(g, trip, AUVID_GUARD_DEPTH_STALE, AUVID_GUARD_PRESSURE))) ||
           (altitude && guard_stale(g, trip, AUVID_GUARD_ALTITUDE_STALE, &in->altitude,
                                    cfg->altitude_stale_us)) ||
           (g->state == AUVID_GUARD_EXCITING &&
            guard_stale(g, trip, AUVID_GUARD_APPLIED_STALE, &applied, cfg->applied_stale_us));
}

/* Test the limits of the motion. Over ground, it is a breach without a fresh measurement. */
static bool guard_any_exceeded(const auvid_guard_t *g, auvid_guard_trip_t *trip,
                               const auvid_guard_input_t *in)
{
    const auvid_guard_config_t *cfg = &g->cfg;
    const auvid_real_t *v = in->velocity_ground;
    bool altitude = guard_is_fresh(&in->altitude, trip->t_us, cfg->altitude_stale_us);
    bool ground = guard_is_fresh(&in->ground, trip->t_us, cfg->velocity_stale_us);
    auvid_real_t speed = guard_norm(v[0], v[1], v[2]);
    auvid_real_t distance =
        guard_norm(in->position[0] - g->home[0], in->position[1] - g->home[1], AUVID_C(0.0));
    return (!guard_at_surface(g, in) &&
            guard_below(g, trip, AUVID_GUARD_DEPTH_MIN, in->position[2], cfg->depth_min_m)) ||
           (guard_watches_depth(g, in) &&
            guard_above(g, trip, AUVID_GUARD_DEPTH_MAX, in->position[2], cfg->depth_max_m)) ||
           (altitude &&
            guard_below(g, trip, AUVID_GUARD_ALTITUDE, in->altitude_m, cfg->altitude_min_m)) ||
           guard_above(g, trip, AUVID_GUARD_ROLL, auvid_abs(in->roll), cfg->roll_max_rad) ||
           guard_above(g, trip, AUVID_GUARD_PITCH, auvid_abs(in->pitch), cfg->pitch_max_rad) ||
           guard_above(g, trip, AUVID_GUARD_SPEED, ground ? speed : AUVID_LARGEST,
                       cfg->speed_max) ||
           guard_above(g, trip, AUVID_GUARD_YAW_RATE, auvid_abs(in->rates[2]), cfg->yaw_rate_max) ||
           guard_above(g, trip, AUVID_GUARD_DISTANCE, ground ? distance : AUVID_LARGEST,
                       cfg->distance_max_m);
}

/* Test the limits of run time and saturation time. */
static bool guard_any_too_long(const auvid_guard_t *g, auvid_guard_trip_t *trip)
{
    uint64_t run_us = trip->t_us - g->excite_us, saturated_us = trip->t_us - g->saturated_us;
    return (g->state == AUVID_GUARD_EXCITING &&
            guard_too_long(g, trip, AUVID_GUARD_RUN_TIME, run_us,
                           (uint64_t)g->cfg.run_max_s * 1000000u)) ||
           (g->saturated && guard_is_on(g, AUVID_GUARD_SATURATION) &&
            saturated_us >= g->cfg.saturation_us &&
            guard_set_trip_time(trip, AUVID_GUARD_SATURATION, saturated_us, g->cfg.saturation_us));
}

/* Test that time advances, by at most max_tick_us, and that the heartbeat is recent. */
static bool guard_timing_violation(const auvid_guard_t *g, auvid_guard_trip_t *trip)
{
    if (trip->t_us < g->t_us || (trip->t_us == g->t_us && g->stepped)) {
        return guard_set_trip(trip, AUVID_GUARD_TIME, -guard_to_s(g->t_us - trip->t_us),
                              AUVID_C(0.0));
    }
    uint64_t silence_us = guard_abs_diff_us(trip->t_us, g->heartbeat_us);
    return guard_too_long(g, trip, AUVID_GUARD_TICK, trip->t_us - g->t_us, g->cfg.max_tick_us) ||
           (g->cfg.heartbeat_timeout_us > 0 &&
            guard_too_long(g, trip, AUVID_GUARD_LINK, silence_us, g->cfg.heartbeat_timeout_us));
}

/* Remember which optional sensors exist. */
static void guard_track_known(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in)
{
    g->altitude_known =
        g->altitude_known || guard_is_fresh(&in->altitude, t_us, g->cfg.altitude_stale_us);
    g->depth_known = g->depth_known || guard_is_fresh(&in->depth, t_us, g->cfg.depth_stale_us);
}

auvid_status_t auvid_guard_arm(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in)
{
    if (g == NULL || in == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!g->ready || (g->state != AUVID_GUARD_DISARMED && g->state != AUVID_GUARD_DONE)) {
        return AUVID_ERR_STATE;
    }
    auvid_guard_t armed;
    auvid_guard_trip_t trip;
    guard_init_trip(&trip, AUVID_GUARD_NO_CAUSE, t_us);
    memset(&armed, 0, sizeof armed);
    armed.ready = true;
    armed.cfg = g->cfg;
    armed.state = AUVID_GUARD_ARMED;
    armed.t_us = armed.heartbeat_us = t_us;
    armed.home[0] = in->position[0];
    armed.home[1] = in->position[1];
    guard_track_known(&armed, t_us, in);
    if (guard_any_stale(&armed, &trip, in)) {
        g->refused = trip;
        return AUVID_ERR_STALE;
    }
    if (guard_any_exceeded(&armed, &trip, in)) {
        g->refused = trip;
        return AUVID_ERR_LIMIT;
    }
    *g = armed;
    return AUVID_OK;
}

auvid_status_t auvid_guard_excite(auvid_guard_t *g, uint64_t t_us)
{
    if (g == NULL) {
        return AUVID_ERR_NULL;
    }
    if (g->state != AUVID_GUARD_ARMED) {
        return AUVID_ERR_STATE;
    }
    g->state = AUVID_GUARD_EXCITING;
    g->excite_us = t_us;
    return AUVID_OK;
}

auvid_status_t auvid_guard_finished(auvid_guard_t *g, uint64_t t_us)
{
    if (g == NULL) {
        return AUVID_ERR_NULL;
    }
    if (g->state != AUVID_GUARD_EXCITING) {
        return AUVID_ERR_STATE;
    }
    g->state = AUVID_GUARD_SETTLING;
    g->settling_us = t_us;
    g->at_rest = false;
    return AUVID_OK;
}

static void guard_enter_aborted(auvid_guard_t *g, const auvid_guard_trip_t *trip)
{
    g->state = AUVID_GUARD_ABORTED;
    g->trip = *trip;
}

auvid_status_t auvid_guard_abort_for(auvid_guard_t *g, uint64_t t_us, auvid_guard_cause_t cause)
{
    if (g == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!g->ready) {
        return AUVID_ERR_STATE;
    }
    if ((unsigned)cause - 1u >= AUVID_GUARD_CAUSE_COUNT - 1u) {
        return AUVID_ERR_RANGE;
    }
    if (g->state != AUVID_GUARD_ABORTED) {
        auvid_guard_trip_t trip;
        guard_init_trip(&trip, cause, t_us);
        guard_enter_aborted(g, &trip);
    }
    return AUVID_OK;
}

auvid_status_t auvid_guard_abort(auvid_guard_t *g, uint64_t t_us)
{
    return auvid_guard_abort_for(g, t_us, AUVID_GUARD_OPERATOR);
}

auvid_status_t auvid_guard_disarm(auvid_guard_t *g)
{
    if (g == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!g->ready) {
        return AUVID_ERR_STATE;
    }
    g->state = AUVID_GUARD_DISARMED;
    memset(&g->trip, 0, sizeof g->trip);
    return AUVID_OK;
}

auvid_status_t auvid_guard_heartbeat(auvid_guard_t *g, uint64_t t_us)
{
    if (g == NULL) {
        return AUVID_ERR_NULL;
    }
    if (t_us < g->heartbeat_us) {
        return AUVID_ERR_TIME_BACK;
    }
    g->heartbeat_us = t_us;
    return AUVID_OK;
}

/* Update the state that persists between ticks. */
static void guard_track_inputs(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in)
{
    if (in->saturated && !g->saturated) {
        g->saturated_us = t_us;
    }
    g->saturated = in->saturated;
    guard_track_known(g, t_us, in);
    auvid_guard_track_repeats(g, t_us, in);
}

/* SETTLING ends after rest_dwell_us at rest, or after settle_timeout_us. */
static void guard_update_settling(auvid_guard_t *g, const auvid_guard_input_t *in)
{
    const auvid_real_t *v = in->velocity_ground, *w = in->rates;
    bool at_rest = guard_norm(v[0], v[1], v[2]) <= g->cfg.rest_speed &&
                   guard_norm(w[0], w[1], w[2]) <= g->cfg.rest_rate;
    if (at_rest && !g->at_rest) {
        g->at_rest_us = g->t_us;
    }
    g->at_rest = at_rest;
    if ((at_rest && g->t_us - g->at_rest_us >= g->cfg.rest_dwell_us) ||
        g->t_us - g->settling_us >= g->cfg.settle_timeout_us) {
        g->state = AUVID_GUARD_DONE;
    }
}

bool auvid_guard_step(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in)
{
    if (g == NULL || !g->ready || !guard_is_watching(g)) {
        return false;
    }
    auvid_guard_trip_t trip;
    guard_init_trip(&trip, AUVID_GUARD_NO_INPUT, t_us);
    if (in == NULL || guard_timing_violation(g, &trip)) {
        guard_enter_aborted(g, &trip);
        return false;
    }
    guard_track_inputs(g, t_us, in);
    if (guard_any_stale(g, &trip, in) || guard_any_exceeded(g, &trip, in) ||
        guard_any_too_long(g, &trip)) {
        guard_enter_aborted(g, &trip);
        return false;
    }
    g->t_us = t_us;
    g->stepped = true;
    if (g->state == AUVID_GUARD_SETTLING) {
        guard_update_settling(g, in);
    }
    return g->state == AUVID_GUARD_EXCITING;
}
