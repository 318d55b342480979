/*
 * The limits of the guard: every exceeded limit, every stale sensor and every value that is not
 * finite withdraws the permission in the same step, latches, and reports the cause.
 */
#include "guard_steps.h"

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

int main(void)
{
    UNITY_BEGIN();
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
    RUN_TEST(test_lasting_saturation);
    RUN_TEST(test_saturation_with_interruptions_is_none);
    return UNITY_END();
}
