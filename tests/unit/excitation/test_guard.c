/*
 * The guard: every exceeded limit, every stale sensor and every value that is not finite withdraws
 * the permission in the same step, latches, and reports the cause.
 */
#include "auvid/guard.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "unity.h"

#define TICK 20000u
#define START 5000000u

static auvid_guard_config_t cfg;
static auvid_guard_t g;
static auvid_guard_input_t in;
static uint64_t now;

static void see(auvid_guard_seen_t *seen)
{
    seen->t_us = now;
    seen->known = true;
}

/* Everything fresh, the vehicle moving a little, well within the limits. */
static void all_is_well(void)
{
    memset(&in, 0, sizeof in);
    see(&in.imu);
    see(&in.velocity);
    see(&in.ground);
    see(&in.depth);
    see(&in.altitude);
    see(&in.applied);
    in.position[0] = 101;
    in.position[1] = -50;
    in.position[2] = 10;
    in.roll = AUVID_C(0.1);
    in.pitch = AUVID_C(-0.1);
    in.velocity_ground[0] = AUVID_C(0.5);
    in.rates[2] = AUVID_C(0.2);
    in.altitude_m = 8;
}

void setUp(void)
{
    auvid_guard_defaults(&cfg);
    memset(&g, 0, sizeof g);
    now = START;
    all_is_well();
}

void tearDown(void)
{
}

static bool step(void)
{
    now += TICK;
    return auvid_guard_step(&g, now, &in);
}

static bool step_well(void)
{
    now += TICK;
    all_is_well();
    return auvid_guard_step(&g, now, &in);
}

/* To one of the watched states, with all inputs within the limits; the excitation starts now. */
static void go(auvid_guard_state_t state)
{
    now = START;
    all_is_well();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_FALSE(step_well());
    if (state != AUVID_GUARD_ARMED) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
        TEST_ASSERT_TRUE(step_well());
    }
    if (state == AUVID_GUARD_SETTLING) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_finished(&g, now));
        TEST_ASSERT_FALSE(step_well());
    }
    TEST_ASSERT_EQUAL(state, g.state);
}

static void check_aborted(auvid_guard_cause_t cause, double value, double limit)
{
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, g.state);
    TEST_ASSERT_EQUAL_STRING(auvid_guard_cause_str(cause), auvid_guard_cause_str(g.trip.cause));
    if (isnan(value)) {
        TEST_ASSERT_TRUE(isnan((double)g.trip.value));
    } else {
        TEST_ASSERT_EQUAL_FLOAT((float)value, (float)g.trip.value);
    }
    TEST_ASSERT_EQUAL_FLOAT((float)limit, (float)g.trip.limit);
    TEST_ASSERT_EQUAL_UINT64(now, g.trip.t_us);
}

/* Aborted now, and still so when all inputs are within the limits again. */
static void check_latched(auvid_guard_cause_t cause, double value, double limit)
{
    check_aborted(cause, value, limit);
    auvid_guard_trip_t trip = g.trip;
    for (int k = 0; k < 200; ++k) {
        TEST_ASSERT_FALSE(step_well());
        TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, g.state);
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_arm(&g, now, &in));
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_excite(&g, now));
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_finished(&g, now));
    }
    TEST_ASSERT_EQUAL_MEMORY(&trip, &g.trip, sizeof trip);
}

/* Set *where to `value`: a breach in the same step in every watched state, none with the limit off;
 * arming is refused. A value just inside the limit is no breach. */
static void check_limit(auvid_real_t *where, double value, auvid_guard_cause_t cause,
                        double reported, double limit, double inside)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        go((auvid_guard_state_t)state);
        *where = (auvid_real_t)inside;
        TEST_ASSERT_EQUAL(state == AUVID_GUARD_EXCITING, step());
        now += TICK;
        all_is_well();
        *where = (auvid_real_t)value;
        TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
        check_latched(cause, reported, limit);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    all_is_well();
    *where = (auvid_real_t)value;
    TEST_ASSERT_EQUAL(AUVID_ERR_LIMIT, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, g.state);
    TEST_ASSERT_EQUAL(cause, g.refused.cause);
    cfg.off = AUVID_GUARD_BIT(cause);
    go(AUVID_GUARD_EXCITING);
    *where = (auvid_real_t)value;
    bool otherwise = cause == AUVID_GUARD_DEPTH_MIN && !isfinite(value); /* the other limit */
    TEST_ASSERT_EQUAL(!otherwise, step());
    cfg.off = 0;
}

static void test_too_shallow(void)
{
    check_limit(&in.position[2], 0.99, AUVID_GUARD_DEPTH_MIN, 0.99, 1, 1);
}

static void test_too_deep(void)
{
    check_limit(&in.position[2], 100.1, AUVID_GUARD_DEPTH_MAX, 100.1, 100, 100);
}

static void test_too_close_to_the_bottom(void)
{
    check_limit(&in.altitude_m, 1.99, AUVID_GUARD_ALTITUDE, 1.99, 2, 2);
}

static void test_too_much_roll_to_either_side(void)
{
    check_limit(&in.roll, 0.61, AUVID_GUARD_ROLL, 0.61, 0.6, 0.6);
    check_limit(&in.roll, -0.61, AUVID_GUARD_ROLL, 0.61, 0.6, -0.6);
}

static void test_too_much_pitch_up_or_down(void)
{
    check_limit(&in.pitch, 0.61, AUVID_GUARD_PITCH, 0.61, 0.6, 0.6);
    check_limit(&in.pitch, -0.61, AUVID_GUARD_PITCH, 0.61, 0.6, -0.6);
}

static void test_too_fast_in_all_three_axes_together(void)
{
    cfg.speed_max = AUVID_C(0.7);
    check_limit(&in.velocity_ground[1], -1.2, AUVID_GUARD_SPEED, 1.3, 0.7, -0.4);
    check_limit(&in.velocity_ground[2], 1.2, AUVID_GUARD_SPEED, 1.3, 0.7, 0.4);
}

static void test_turning_too_fast_either_way(void)
{
    check_limit(&in.rates[2], 1.6, AUVID_GUARD_YAW_RATE, 1.6, 1.5, 1.5);
    check_limit(&in.rates[2], -1.6, AUVID_GUARD_YAW_RATE, 1.6, 1.5, -1.5);
}

static void check_distance(auvid_real_t *where, double value, double inside)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        go((auvid_guard_state_t)state);
        *where = (auvid_real_t)inside;
        TEST_ASSERT_EQUAL(state == AUVID_GUARD_EXCITING, step());
        *where = (auvid_real_t)value;
        TEST_ASSERT_FALSE(step());
        check_latched(AUVID_GUARD_DISTANCE, 31, 30);
    }
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_DISTANCE);
    go(AUVID_GUARD_EXCITING);
    *where = (auvid_real_t)value;
    TEST_ASSERT_TRUE(step());
    cfg.off = 0;
}

static void test_too_far_from_where_it_was_armed(void)
{
    check_distance(&in.position[0], 101 + 31, 101 + 30);
    check_distance(&in.position[1], -50 - 31, -50 - 30);
}

static void test_depth_does_not_count_as_distance(void)
{
    go(AUVID_GUARD_EXCITING);
    in.position[2] = 90;
    TEST_ASSERT_TRUE(step());
}

static void test_the_run_takes_too_long(void)
{
    cfg.run_max_s = 3;
    go(AUVID_GUARD_ARMED);
    while (now < START + 10000000u) { /* ARMED does not count as a run */
        TEST_ASSERT_FALSE(step_well());
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
    for (uint64_t end = now + 3000000u; now < end;) {
        TEST_ASSERT_TRUE(step_well());
    }
    TEST_ASSERT_FALSE(step_well());
    check_latched(AUVID_GUARD_RUN_TIME, 3.02, 3);
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_RUN_TIME);
    go(AUVID_GUARD_EXCITING);
    while (now < START + 10000000u) {
        TEST_ASSERT_TRUE(step_well());
    }
}

static void test_a_run_may_be_longer_than_32_bits_of_microseconds(void)
{
    cfg.run_max_s = 5000;
    cfg.max_tick_us = 4000000000u;
    go(AUVID_GUARD_EXCITING);
    now += 3500000000u;
    TEST_ASSERT_TRUE(step_well());
    now += 1600000000u;
    TEST_ASSERT_FALSE(step_well());
    check_aborted(AUVID_GUARD_RUN_TIME, 5100.04, 5000);
}

static void test_the_run_is_limited_to_the_microsecond(void)
{
    cfg.run_max_s = 3;
    cfg.max_tick_us = 4000000;
    for (uint64_t more = 0; more < 2; ++more) {
        go(AUVID_GUARD_ARMED);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
        now += 3000000u + more;
        all_is_well();
        TEST_ASSERT_EQUAL(more == 0, auvid_guard_step(&g, now, &in));
    }
    check_aborted(AUVID_GUARD_RUN_TIME, 3.000001, 3);
}

/* One sensor has no samples while the others have. */
static void check_stale(auvid_guard_seen_t *sensor, auvid_guard_cause_t cause, uint32_t stale_us)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        if (cause == AUVID_GUARD_APPLIED_STALE && state != AUVID_GUARD_EXCITING) {
            continue;
        }
        go((auvid_guard_state_t)state);
        uint64_t last = now;
        for (;;) {
            now += TICK;
            all_is_well();
            sensor->t_us = last;
            if (now - last > stale_us) {
                break;
            }
            TEST_ASSERT_EQUAL(state == AUVID_GUARD_EXCITING, auvid_guard_step(&g, now, &in));
        }
        TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
        check_latched(cause, 1e-6 * (double)(now - last), 1e-6 * stale_us);
    }
    cfg.off = AUVID_GUARD_BIT(cause);
    go(AUVID_GUARD_EXCITING);
    for (int k = 0; k < 1000; ++k) {
        now += TICK;
        all_is_well();
        sensor->known = false;
        TEST_ASSERT_TRUE(auvid_guard_step(&g, now, &in));
    }
    cfg.off = 0;
}

static void check_cannot_arm(auvid_guard_seen_t *sensor, auvid_guard_cause_t cause)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    all_is_well();
    sensor->known = false;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(cause, g.refused.cause);
    TEST_ASSERT_EQUAL_FLOAT((float)AUVID_LARGEST, (float)g.refused.value);
    all_is_well();
    sensor->t_us = now - 1100000u;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL_FLOAT(1.1f, (float)g.refused.value);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, g.state);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_excite(&g, now));
    all_is_well();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_GUARD_NO_CAUSE, g.refused.cause);
}

static void test_the_imu_is_stale(void)
{
    check_stale(&in.imu, AUVID_GUARD_IMU_STALE, 200000);
    check_cannot_arm(&in.imu, AUVID_GUARD_IMU_STALE);
}

static void test_no_velocity_is_accepted(void)
{
    check_stale(&in.velocity, AUVID_GUARD_VELOCITY_STALE, 1000000);
    check_cannot_arm(&in.velocity, AUVID_GUARD_VELOCITY_STALE);
}

/* Velocity through the water is measured, without bottom lock for longer than velocity_stale_us. */
static void test_speed_and_distance_are_limits_only_where_they_are_measured(void)
{
    const auvid_guard_cause_t cause[2] = {AUVID_GUARD_SPEED, AUVID_GUARD_DISTANCE};
    const double limit[2] = {1.5, 30};
    cfg.water_lock = true;
    for (int k = 0; k < 2; ++k) {
        for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
            go((auvid_guard_state_t)state);
            in.ground.t_us = now - 1000000u + TICK;
            TEST_ASSERT_EQUAL(state == AUVID_GUARD_EXCITING, step());
            in.imu.t_us = in.velocity.t_us = now;
            TEST_ASSERT_FALSE(step());
            check_latched(cause[k], (double)AUVID_LARGEST, limit[k]);
        }
        all_is_well();
        in.ground.known = false;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
        TEST_ASSERT_EQUAL(AUVID_ERR_LIMIT, auvid_guard_arm(&g, now, &in));
        TEST_ASSERT_EQUAL(cause[k], g.refused.cause);
        cfg.off |= AUVID_GUARD_BIT(cause[k]);
    }
    go(AUVID_GUARD_EXCITING);
    in.ground.known = false;
    TEST_ASSERT_TRUE(step());
}

static void test_no_depth_is_accepted(void)
{
    check_stale(&in.depth, AUVID_GUARD_DEPTH_STALE, 1000000);
    check_cannot_arm(&in.depth, AUVID_GUARD_DEPTH_STALE);
}

static void test_the_altitude_is_lost(void)
{
    check_stale(&in.altitude, AUVID_GUARD_ALTITUDE_STALE, 1000000);
    cfg.altitude_required = true;
    check_stale(&in.altitude, AUVID_GUARD_ALTITUDE_STALE, 1000000);
    check_cannot_arm(&in.altitude, AUVID_GUARD_ALTITUDE_STALE);
}

static void test_no_applied_wrench_is_recorded(void)
{
    check_stale(&in.applied, AUVID_GUARD_APPLIED_STALE, 1000000);
}

/* None yet, or an old one: a vehicle that did not move. */
static void test_a_missing_applied_wrench_is_aged_from_excite_on(void)
{
    for (int old = 0; old < 2; ++old) {
        go(AUVID_GUARD_ARMED);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
        uint64_t end = now + 1000000u;
        do {
            now += TICK;
            all_is_well();
            in.applied.known = old;
            in.applied.t_us = old ? START - 4000000u : now; /* not read if none is known */
            TEST_ASSERT_EQUAL(now <= end, auvid_guard_step(&g, now, &in));
        } while (now <= end);
        check_aborted(AUVID_GUARD_APPLIED_STALE, 1.02, 1);
    }
}

static void test_while_not_exciting_no_applied_wrench_is_needed(void)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; state += 2) {
        go((auvid_guard_state_t)state);
        for (uint64_t end = now + 5000000u; now < end;) {
            now += TICK;
            all_is_well();
            in.applied.known = false;
            TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
        }
        TEST_ASSERT_EQUAL(state, g.state);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_disarm(&g));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
}

static void test_an_age_of_any_length_is_reported_in_seconds(void)
{
    cfg.imu_stale_us = 4000000000u;
    cfg.max_tick_us = 4000000000u;
    const uint64_t age_us[] = {4000000001u, 5000000000u, 70000000000u, 4000000000000000u};
    const float age_s[] = {4000.0f, 5000.0f, 70000.0f, 4e9f};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    for (int i = 0; i < 4; ++i) {
        now = 5000000000000000u;
        all_is_well();
        in.imu.t_us = now - age_us[i];
        TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_guard_arm(&g, now, &in));
        TEST_ASSERT_FLOAT_WITHIN(age_s[i] * 1.5e-7f, age_s[i], (float)g.refused.value);
        TEST_ASSERT_EQUAL_FLOAT(4000.0f, (float)g.refused.limit);
    }
}

static void test_a_sample_from_far_ahead_does_not_count_as_fresh(void)
{
    go(AUVID_GUARD_EXCITING);
    in.velocity.t_us = now + 100000000u;
    TEST_ASSERT_FALSE(step());
    check_aborted(AUVID_GUARD_VELOCITY_STALE, 99.98, 1);
}

static void test_depth_need_not_be_known_where_both_its_limits_are_off(void)
{
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX);
    check_cannot_arm(&in.depth, AUVID_GUARD_DEPTH_STALE);
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN);
    check_cannot_arm(&in.depth, AUVID_GUARD_DEPTH_STALE);
    cfg.off |= AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    in.depth.known = false;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
}

static void test_the_altitude_limit_is_not_watched_until_an_altitude_is_known(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    in.altitude.known = false;
    in.altitude_m = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
    TEST_ASSERT_TRUE(step());
    TEST_ASSERT_TRUE(step_well()); /* but once it was known, */
    for (uint64_t end = now + 1000000u; now < end;) {
        now += TICK;
        all_is_well();
        in.altitude.known = false;
        if (!auvid_guard_step(&g, now, &in)) {
            break;
        }
    }
    check_aborted(AUVID_GUARD_ALTITUDE_STALE, (double)AUVID_LARGEST, 1); /* losing it is a breach */
}

static void test_an_altitude_known_at_arming_and_then_lost_is_a_breach(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    in.altitude.known = false;
    TEST_ASSERT_FALSE(step());
    check_aborted(AUVID_GUARD_ALTITUDE_STALE, (double)AUVID_LARGEST, 1);
}

static void test_altitude_may_be_lost_where_its_limit_is_off(void)
{
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_ALTITUDE);
    go(AUVID_GUARD_EXCITING);
    in.altitude.known = false;
    TEST_ASSERT_TRUE(step());
}

static void test_an_altitude_of_long_ago_is_not_read(void)
{
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_ALTITUDE_STALE);
    go(AUVID_GUARD_EXCITING);
    in.altitude_m = 1;
    in.altitude.t_us = now + TICK - 1000001u;
    TEST_ASSERT_TRUE(step());
    in.altitude.t_us = now + TICK - 1000000u;
    TEST_ASSERT_FALSE(step());
    check_aborted(AUVID_GUARD_ALTITUDE, 1, 2);
}

/* ---- a surface craft ---- */

static void no_depth(void)
{
    in.depth.known = false;
    in.position[2] = (auvid_real_t)NAN; /* dead reckoned */
}

static void go_at_surface(void)
{
    cfg.surface = true;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    no_depth();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
}

static void test_a_surface_craft_needs_no_depth(void)
{
    go_at_surface();
    for (int k = 0; k < 500; ++k) {
        now += TICK;
        all_is_well();
        no_depth();
        TEST_ASSERT_TRUE(auvid_guard_step(&g, now, &in));
    }
    in.altitude_m = 1; /* all other limits hold */
    TEST_ASSERT_FALSE(step());
    check_aborted(AUVID_GUARD_ALTITUDE, 1, 2);
}

static void test_a_depth_that_a_surface_craft_measures_is_watched(void)
{
    go_at_surface();
    all_is_well();
    in.position[2] = AUVID_C(0.1); /* less than depth_min_m, which has no meaning */
    TEST_ASSERT_TRUE(step());
    in.position[2] = 101;
    TEST_ASSERT_FALSE(step());
    check_aborted(AUVID_GUARD_DEPTH_MAX, 101, 100);
    all_is_well();
    go_at_surface();
    TEST_ASSERT_TRUE(step_well());
    in.depth.known = false; /* and lost */
    TEST_ASSERT_FALSE(step());
    check_aborted(AUVID_GUARD_DEPTH_STALE, (double)AUVID_LARGEST, 1);
}

static void test_a_craft_that_is_excited_in_heave_counts_as_submerged(void)
{
    cfg.surface = true;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    in.heaves = true;
    in.depth.known = false;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_GUARD_DEPTH_STALE, g.refused.cause);
    all_is_well();
    in.heaves = true;
    in.position[2] = AUVID_C(0.5);
    TEST_ASSERT_EQUAL(AUVID_ERR_LIMIT, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_GUARD_DEPTH_MIN, g.refused.cause);
}

static void test_any_other_craft_needs_a_depth(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    in.depth.known = false;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_guard_arm(&g, now, &in));
}

/* ---- not finite ---- */

static void check_not_finite(auvid_real_t *where, auvid_guard_cause_t cause, double limit)
{
    static const double values[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; ++i) {
        go(AUVID_GUARD_EXCITING);
        *where = (auvid_real_t)values[i];
        TEST_ASSERT_FALSE(step());
        bool positive = cause != AUVID_GUARD_DEPTH_MIN && cause != AUVID_GUARD_ALTITUDE;
        double reported = positive && !isnan(values[i]) ? INFINITY : values[i];
        check_latched(cause, reported, limit);
    }
}

static void test_a_depth_that_is_not_finite(void)
{
    check_not_finite(&in.position[2], AUVID_GUARD_DEPTH_MIN, 1);
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN);
    go(AUVID_GUARD_EXCITING);
    in.position[2] = -(auvid_real_t)INFINITY;
    TEST_ASSERT_FALSE(step());
    check_latched(AUVID_GUARD_DEPTH_MAX, -INFINITY, 100);
}

static void test_an_altitude_that_is_not_finite(void)
{
    check_not_finite(&in.altitude_m, AUVID_GUARD_ALTITUDE, 2);
}

static void test_a_roll_that_is_not_finite(void)
{
    check_not_finite(&in.roll, AUVID_GUARD_ROLL, 0.6);
}

static void test_a_pitch_that_is_not_finite(void)
{
    check_not_finite(&in.pitch, AUVID_GUARD_PITCH, 0.6);
}

static void test_a_velocity_that_is_not_finite(void)
{
    for (int i = 0; i < 3; ++i) {
        go(AUVID_GUARD_EXCITING);
        in.velocity_ground[i] = (auvid_real_t)NAN;
        TEST_ASSERT_FALSE(step());
        check_latched(AUVID_GUARD_SPEED, NAN, 1.5);
    }
}

static void test_a_yaw_rate_that_is_not_finite(void)
{
    check_not_finite(&in.rates[2], AUVID_GUARD_YAW_RATE, 1.5);
}

static void test_a_position_that_is_not_finite(void)
{
    for (int i = 0; i < 2; ++i) {
        go(AUVID_GUARD_EXCITING);
        in.position[i] = (auvid_real_t)NAN;
        TEST_ASSERT_FALSE(step());
        check_latched(AUVID_GUARD_DISTANCE, NAN, 30);
    }
}

/* ---- saturation ---- */

static void test_lasting_saturation(void)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        go((auvid_guard_state_t)state);
        uint64_t since = now + TICK;
        for (;;) {
            now += TICK;
            all_is_well();
            in.saturated = true;
            if (now - since >= 1000000u) {
                break;
            }
            TEST_ASSERT_EQUAL(state == AUVID_GUARD_EXCITING, auvid_guard_step(&g, now, &in));
        }
        TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
        check_latched(AUVID_GUARD_SATURATION, 1, 1);
    }
}

static void test_saturation_with_interruptions_is_none(void)
{
    go(AUVID_GUARD_EXCITING);
    for (int k = 1; k < 1000; ++k) {
        now += TICK;
        all_is_well();
        in.saturated = k % 50 != 0;
        TEST_ASSERT_TRUE(auvid_guard_step(&g, now, &in));
    }
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_SATURATION);
    go(AUVID_GUARD_EXCITING);
    for (int k = 1; k < 1000; ++k) {
        now += TICK;
        all_is_well();
        in.saturated = true;
        TEST_ASSERT_TRUE(auvid_guard_step(&g, now, &in));
    }
}

/* ---- operator, time, link, input ---- */

static void test_the_operator_aborts_from_any_state(void)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        go((auvid_guard_state_t)state);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_abort(&g, now));
        check_latched(AUVID_GUARD_OPERATOR, 0, 0);
    }
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_guard_init(&g, &cfg)); /* an arm already under way is refused */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_abort(&g, now));
    check_latched(AUVID_GUARD_OPERATOR, 0, 0);
}

static void test_an_abort_after_a_breach_keeps_the_first_cause(void)
{
    go(AUVID_GUARD_EXCITING);
    in.roll = 1;
    TEST_ASSERT_FALSE(step());
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_abort(&g, now));
    check_latched(AUVID_GUARD_ROLL, 1, 0.6);
}

static void test_an_abort_for_another_cause_reports_it(void)
{
    for (int cause = -1; cause <= AUVID_GUARD_CAUSE_COUNT; ++cause) {
        bool known = cause > AUVID_GUARD_NO_CAUSE && cause < AUVID_GUARD_CAUSE_COUNT;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
        TEST_ASSERT_EQUAL(known ? AUVID_OK : AUVID_ERR_RANGE,
                          auvid_guard_abort_for(&g, now + 7, (auvid_guard_cause_t)cause));
        TEST_ASSERT_EQUAL(known ? AUVID_GUARD_ABORTED : AUVID_GUARD_ARMED, g.state);
        TEST_ASSERT_EQUAL(known ? cause : AUVID_GUARD_NO_CAUSE, g.trip.cause);
        TEST_ASSERT_EQUAL_UINT64(known ? now + 7 : 0, g.trip.t_us);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_abort(&g, now + 8));
        TEST_ASSERT_EQUAL(known ? cause : AUVID_GUARD_OPERATOR, g.trip.cause); /* the first stays */
    }
    memset(&g, 0, sizeof g);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_abort_for(&g, now, AUVID_GUARD_LINK));
}

static void test_time_that_goes_back_or_stands_still(void)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        for (uint64_t back = 0; back <= 40000; back += 40000) {
            go((auvid_guard_state_t)state);
            now -= back;
            TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
            check_latched(AUVID_GUARD_TIME, -1e-6 * (double)back, 0);
        }
    }
}

static void test_arm_excite_and_step_may_share_a_time(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
    TEST_ASSERT_TRUE(auvid_guard_step(&g, now, &in));
    TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
    check_aborted(AUVID_GUARD_TIME, 0, 0);
}

static void test_after_a_stall_the_loop_does_not_resume_the_excitation(void)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        go((auvid_guard_state_t)state);
        now += 230000;
        TEST_ASSERT_EQUAL(state == AUVID_GUARD_EXCITING, step_well()); /* 250 ms */
        now += 230001;
        TEST_ASSERT_FALSE(step_well());
        check_latched(AUVID_GUARD_TICK, 0.250001, 0.25);
    }
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_TICK);
    go(AUVID_GUARD_EXCITING);
    now += 5000000;
    TEST_ASSERT_TRUE(step_well());
}

static void test_a_step_without_input(void)
{
    go(AUVID_GUARD_EXCITING);
    now += TICK;
    TEST_ASSERT_FALSE(auvid_guard_step(&g, now, NULL));
    check_latched(AUVID_GUARD_NO_INPUT, 0, 0);
}

static void test_the_heartbeat_times_out(void)
{
    cfg.heartbeat_timeout_us = 500000;
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        go((auvid_guard_state_t)state);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_heartbeat(&g, now));
        for (uint64_t end = now + 500000u; now < end;) {
            TEST_ASSERT_EQUAL(state == AUVID_GUARD_EXCITING, step_well());
        }
        TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, auvid_guard_heartbeat(&g, START - 1));
        TEST_ASSERT_FALSE(step_well());
        check_latched(AUVID_GUARD_LINK, 0.52, 0.5);
    }
}

static void test_only_a_timeout_of_zero_switches_the_dead_mans_switch_off(void)
{
    cfg.heartbeat_timeout_us = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_FALSE(step_well());
    check_aborted(AUVID_GUARD_LINK, 0.02, 1e-6);
}

static void test_a_heartbeat_of_the_same_time_is_accepted(void)
{
    go(AUVID_GUARD_EXCITING);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_heartbeat(&g, now));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_heartbeat(&g, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, auvid_guard_heartbeat(&g, now - 1));
}

static void test_arming_is_a_heartbeat_and_heartbeats_prevent_the_timeout(void)
{
    cfg.heartbeat_timeout_us = 500000;
    go(AUVID_GUARD_EXCITING);
    for (int k = 1; k < 1000; ++k) {
        if (k % 20 == 0) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_heartbeat(&g, now));
        }
        TEST_ASSERT_TRUE(step_well());
    }
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_guard_heartbeat(&g, now + 100000000u)); /* but not without end */
    TEST_ASSERT_FALSE(step_well());
    TEST_ASSERT_EQUAL(AUVID_GUARD_LINK, g.trip.cause);
}

/* ---- the states ---- */

static void test_a_run_from_arm_to_done(void)
{
    go(AUVID_GUARD_SETTLING);
    for (int k = 0; k < 100; ++k) { /* 0.5 m/s is not at rest */
        TEST_ASSERT_FALSE(step_well());
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_SETTLING, g.state);
    uint64_t rest_us = now + TICK;
    while (g.state == AUVID_GUARD_SETTLING && now < rest_us + 100000000u) {
        now += TICK;
        all_is_well();
        in.velocity_ground[0] = AUVID_C(0.05);
        in.rates[2] = AUVID_C(0.05);
        TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, g.state);
    TEST_ASSERT_EQUAL_UINT64(rest_us + 2000000u, now);
    in.roll = 3;
    TEST_ASSERT_FALSE(step());
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, g.state); /* no longer watched */
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_excite(&g, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_LIMIT, auvid_guard_arm(&g, now, &in));
    all_is_well();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
    TEST_ASSERT_TRUE(step_well());
}

static void test_rest_must_last(void)
{
    go(AUVID_GUARD_SETTLING);
    for (int k = 1; now < START + 25000000u; ++k) {
        now += TICK;
        all_is_well();
        in.velocity_ground[0] = k % 90 == 0 ? AUVID_C(0.11) : AUVID_C(0.0);
        in.rates[2] = 0;
        in.rates[0] = k % 90 == 45 ? AUVID_C(0.11) : AUVID_C(0.0);
        TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
        TEST_ASSERT_EQUAL(AUVID_GUARD_SETTLING, g.state);
    }
}

static void test_rest_counts_from_the_first_step_after_the_end(void)
{
    go(AUVID_GUARD_EXCITING);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_finished(&g, now));
    uint64_t since = now + TICK;
    while (g.state == AUVID_GUARD_SETTLING && now < since + 10000000u) {
        now += TICK;
        all_is_well();
        in.velocity_ground[0] = in.rates[2] = 0;
        TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, g.state);
    TEST_ASSERT_EQUAL_UINT64(since + 2000000u, now);
}

/* Speeds of 0.25 m/s, rates of 0.5 rad/s, in one axis at a time and in two together. */
static void test_at_rest_the_axes_together_are_within_the_limits(void)
{
    cfg.rest_speed = AUVID_C(0.25);
    cfg.rest_rate = AUVID_C(0.5);
    for (int axis = 0; axis < 6; ++axis) {
        auvid_real_t *motion = axis < 3 ? in.velocity_ground : in.rates;
        auvid_real_t limit = axis < 3 ? cfg.rest_speed : cfg.rest_rate;
        const auvid_real_t one[] = {limit, -limit, limit * AUVID_C(1.001), limit * AUVID_C(0.8)};
        const auvid_real_t two[] = {0, 0, 0, limit * AUVID_C(0.8)};
        for (int i = 0; i < 4; ++i) {
            go(AUVID_GUARD_SETTLING);
            for (uint64_t end = now + 3000000u; now < end;) {
                now += TICK;
                all_is_well();
                in.velocity_ground[0] = in.rates[2] = 0;
                motion[(axis + 1) % 3] = two[i];
                motion[axis % 3] = one[i];
                TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
            }
            TEST_ASSERT_EQUAL(i < 2 ? AUVID_GUARD_DONE : AUVID_GUARD_SETTLING, g.state);
        }
    }
}

static void test_settling_times_out(void)
{
    go(AUVID_GUARD_SETTLING);
    uint64_t since = now - TICK;
    while (g.state == AUVID_GUARD_SETTLING && now < since + 100000000u) {
        TEST_ASSERT_FALSE(step_well());
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, g.state);
    TEST_ASSERT_EQUAL_UINT64(since + 30000000u, now);
}

static void test_disarm_leaves_every_state(void)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING; ++state) {
        go((auvid_guard_state_t)state);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_disarm(&g));
        TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, g.state);
        TEST_ASSERT_FALSE(step_well());
        in.roll = 3;
        TEST_ASSERT_FALSE(step());
        TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, g.state);
    }
}

static void test_after_an_abort_disarm_and_arm_permit_again(void)
{
    go(AUVID_GUARD_EXCITING);
    in.roll = 1;
    TEST_ASSERT_FALSE(step());
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_disarm(&g));
    TEST_ASSERT_EQUAL(AUVID_GUARD_NO_CAUSE, g.trip.cause);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_excite(&g, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_LIMIT,
                      auvid_guard_arm(&g, now, &in)); /* the roll is still too large */
    all_is_well();
    in.position[0] = 500; /* a new origin of the distance */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
    TEST_ASSERT_TRUE(step());
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, g.state);
}

static void test_calls_out_of_order_are_refused_and_change_nothing(void)
{
    auvid_guard_t before;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    before = g;
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_excite(&g, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_finished(&g, now));
    TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
    go(AUVID_GUARD_EXCITING);
    before = g;
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_excite(&g, now));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
}

static void test_a_guard_that_is_all_zeros_permits_nothing(void)
{
    auvid_guard_t zeros;
    memset(&zeros, 0, sizeof zeros);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_excite(&g, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_abort(&g, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_disarm(&g));
    TEST_ASSERT_FALSE(auvid_guard_step(&g, now, &in));
    TEST_ASSERT_EQUAL_MEMORY(&zeros, &g, sizeof g);
}

/* ---- configuration ---- */

static void test_the_defaults_are_those_that_the_header_names(void)
{
    auvid_guard_config_t named = {.depth_min_m = 1,
                                  .depth_max_m = 100,
                                  .altitude_min_m = 2,
                                  .roll_max_rad = AUVID_C(0.6),
                                  .pitch_max_rad = AUVID_C(0.6),
                                  .speed_max = AUVID_C(1.5),
                                  .yaw_rate_max = AUVID_C(1.5),
                                  .distance_max_m = 30,
                                  .run_max_s = 1800,
                                  .imu_stale_us = 200000,
                                  .velocity_stale_us = 1000000,
                                  .depth_stale_us = 1000000,
                                  .altitude_stale_us = 1000000,
                                  .applied_stale_us = 1000000,
                                  .saturation_us = 1000000,
                                  .max_tick_us = 250000,
                                  .rest_speed = AUVID_C(0.1),
                                  .rest_rate = AUVID_C(0.1),
                                  .rest_dwell_us = 2000000,
                                  .settle_timeout_us = 30000000};
    memset(&cfg, 0xFF, sizeof cfg);
    auvid_guard_defaults(&cfg);
    TEST_ASSERT_EQUAL_MEMORY(&named, &cfg, offsetof(auvid_guard_config_t, off));
    TEST_ASSERT_EQUAL_HEX32(0, cfg.off);
    TEST_ASSERT_FALSE(cfg.altitude_required);
    TEST_ASSERT_FALSE(cfg.water_lock);
}

static void check_init(auvid_status_t status)
{
    auvid_guard_t before;
    memset(&g, 0x5A, sizeof g);
    before = g;
    TEST_ASSERT_EQUAL(status, auvid_guard_init(&g, &cfg));
    if (status < 0) {
        TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g);
    }
}

static void test_limits_that_are_negative_or_not_finite_are_refused(void)
{
    auvid_real_t *const limits[] = {&cfg.depth_min_m,  &cfg.depth_max_m,    &cfg.altitude_min_m,
                                    &cfg.roll_max_rad, &cfg.pitch_max_rad,  &cfg.speed_max,
                                    &cfg.yaw_rate_max, &cfg.distance_max_m, &cfg.rest_speed,
                                    &cfg.rest_rate};
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; ++i) {
        auvid_real_t good = *limits[i];
        *limits[i] = -good;
        check_init(AUVID_ERR_RANGE);
        *limits[i] = (auvid_real_t)NAN;
        check_init(AUVID_ERR_NOT_FINITE);
        *limits[i] = (auvid_real_t)INFINITY;
        check_init(AUVID_ERR_NOT_FINITE);
        *limits[i] = good;
    }
    check_init(AUVID_OK);
}

static void test_depth_limits_in_reverse_order_are_refused(void)
{
    cfg.depth_min_m = 101;
    check_init(AUVID_ERR_BOUNDS);
    cfg.depth_min_m = 100;
    check_init(AUVID_OK);
}

static void test_what_cannot_be_switched_off_is_refused(void)
{
    for (int cause = 0; cause < 32; ++cause) {
        bool may = cause >= AUVID_GUARD_TICK && cause < AUVID_GUARD_CAUSE_COUNT &&
                   cause != AUVID_GUARD_LINK && cause != AUVID_GUARD_FOREIGN_COMMAND;
        cfg.off = AUVID_GUARD_BIT(cause);
        check_init(may ? AUVID_OK : AUVID_ERR_RANGE);
    }
}

static void test_a_limit_of_zero_is_a_limit_of_zero(void)
{
    cfg.roll_max_rad = 0;
    check_init(AUVID_OK);
    TEST_ASSERT_EQUAL(AUVID_ERR_LIMIT, auvid_guard_arm(&g, now, &in));
    in.roll = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
}

static void test_null_is_refused(void)
{
    auvid_guard_defaults(NULL);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_init(NULL, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_init(&g, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_arm(NULL, now, &in));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_arm(&g, now, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_excite(NULL, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_finished(NULL, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_abort(NULL, now));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_abort_for(NULL, now, AUVID_GUARD_LINK));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_disarm(NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_guard_heartbeat(NULL, now));
    TEST_ASSERT_FALSE(auvid_guard_step(NULL, now, &in));
}

static void test_every_state_and_cause_has_its_own_words(void)
{
    for (int i = 0; i < AUVID_GUARD_CAUSE_COUNT; ++i) {
        for (int j = 0; j < i; ++j) {
            TEST_ASSERT_TRUE(strcmp(auvid_guard_cause_str((auvid_guard_cause_t)i),
                                    auvid_guard_cause_str((auvid_guard_cause_t)j)) != 0);
        }
    }
    for (int i = 0; i < AUVID_GUARD_STATE_COUNT; ++i) {
        TEST_ASSERT_TRUE(strlen(auvid_guard_state_str((auvid_guard_state_t)i)) > 3);
    }
    TEST_ASSERT_EQUAL_STRING("unknown cause", auvid_guard_cause_str(AUVID_GUARD_CAUSE_COUNT));
    TEST_ASSERT_EQUAL_STRING("unknown state", auvid_guard_state_str((auvid_guard_state_t)-1));
}

static void run_limits(void)
{
    RUN_TEST(test_too_shallow);
    RUN_TEST(test_too_deep);
    RUN_TEST(test_too_close_to_the_bottom);
    RUN_TEST(test_too_much_roll_to_either_side);
    RUN_TEST(test_too_much_pitch_up_or_down);
    RUN_TEST(test_too_fast_in_all_three_axes_together);
    RUN_TEST(test_turning_too_fast_either_way);
    RUN_TEST(test_too_far_from_where_it_was_armed);
    RUN_TEST(test_depth_does_not_count_as_distance);
    RUN_TEST(test_the_run_takes_too_long);
    RUN_TEST(test_a_run_may_be_longer_than_32_bits_of_microseconds);
    RUN_TEST(test_the_run_is_limited_to_the_microsecond);
    RUN_TEST(test_the_imu_is_stale);
    RUN_TEST(test_no_velocity_is_accepted);
    RUN_TEST(test_speed_and_distance_are_limits_only_where_they_are_measured);
    RUN_TEST(test_no_depth_is_accepted);
    RUN_TEST(test_the_altitude_is_lost);
    RUN_TEST(test_no_applied_wrench_is_recorded);
    RUN_TEST(test_a_missing_applied_wrench_is_aged_from_excite_on);
    RUN_TEST(test_while_not_exciting_no_applied_wrench_is_needed);
    RUN_TEST(test_an_age_of_any_length_is_reported_in_seconds);
    RUN_TEST(test_a_sample_from_far_ahead_does_not_count_as_fresh);
    RUN_TEST(test_depth_need_not_be_known_where_both_its_limits_are_off);
    RUN_TEST(test_the_altitude_limit_is_not_watched_until_an_altitude_is_known);
    RUN_TEST(test_an_altitude_known_at_arming_and_then_lost_is_a_breach);
    RUN_TEST(test_altitude_may_be_lost_where_its_limit_is_off);
    RUN_TEST(test_a_surface_craft_needs_no_depth);
    RUN_TEST(test_a_depth_that_a_surface_craft_measures_is_watched);
    RUN_TEST(test_a_craft_that_is_excited_in_heave_counts_as_submerged);
    RUN_TEST(test_any_other_craft_needs_a_depth);
    RUN_TEST(test_an_altitude_of_long_ago_is_not_read);
    RUN_TEST(test_a_depth_that_is_not_finite);
    RUN_TEST(test_an_altitude_that_is_not_finite);
    RUN_TEST(test_a_roll_that_is_not_finite);
    RUN_TEST(test_a_pitch_that_is_not_finite);
    RUN_TEST(test_a_velocity_that_is_not_finite);
    RUN_TEST(test_a_yaw_rate_that_is_not_finite);
    RUN_TEST(test_a_position_that_is_not_finite);
}

int main(void)
{
    UNITY_BEGIN();
    run_limits();
    RUN_TEST(test_lasting_saturation);
    RUN_TEST(test_saturation_with_interruptions_is_none);
    RUN_TEST(test_the_operator_aborts_from_any_state);
    RUN_TEST(test_an_abort_after_a_breach_keeps_the_first_cause);
    RUN_TEST(test_an_abort_for_another_cause_reports_it);
    RUN_TEST(test_time_that_goes_back_or_stands_still);
    RUN_TEST(test_arm_excite_and_step_may_share_a_time);
    RUN_TEST(test_after_a_stall_the_loop_does_not_resume_the_excitation);
    RUN_TEST(test_a_step_without_input);
    RUN_TEST(test_the_heartbeat_times_out);
    RUN_TEST(test_only_a_timeout_of_zero_switches_the_dead_mans_switch_off);
    RUN_TEST(test_a_heartbeat_of_the_same_time_is_accepted);
    RUN_TEST(test_arming_is_a_heartbeat_and_heartbeats_prevent_the_timeout);
    RUN_TEST(test_a_run_from_arm_to_done);
    RUN_TEST(test_rest_must_last);
    RUN_TEST(test_rest_counts_from_the_first_step_after_the_end);
    RUN_TEST(test_at_rest_the_axes_together_are_within_the_limits);
    RUN_TEST(test_settling_times_out);
    RUN_TEST(test_disarm_leaves_every_state);
    RUN_TEST(test_after_an_abort_disarm_and_arm_permit_again);
    RUN_TEST(test_calls_out_of_order_are_refused_and_change_nothing);
    RUN_TEST(test_a_guard_that_is_all_zeros_permits_nothing);
    RUN_TEST(test_the_defaults_are_those_that_the_header_names);
    RUN_TEST(test_limits_that_are_negative_or_not_finite_are_refused);
    RUN_TEST(test_depth_limits_in_reverse_order_are_refused);
    RUN_TEST(test_what_cannot_be_switched_off_is_refused);
    RUN_TEST(test_a_limit_of_zero_is_a_limit_of_zero);
    RUN_TEST(test_null_is_refused);
    RUN_TEST(test_every_state_and_cause_has_its_own_words);
    return UNITY_END();
}
