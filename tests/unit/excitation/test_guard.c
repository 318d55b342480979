/*
 * The guard's states and configuration; the operator, time and link.
 */
#include "guard_steps.h"

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
                                  .repeat_us = 3000000,
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

static void test_init_takes_its_own_configuration(void)
{
    auvid_guard_defaults(&cfg);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_guard_init(&g, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_guard_init(&g, &g.cfg));
    TEST_ASSERT_EQUAL_MEMORY(&cfg, &g.cfg, sizeof cfg);
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

int main(void)
{
    UNITY_BEGIN();
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
    RUN_TEST(test_init_takes_its_own_configuration);
    RUN_TEST(test_depth_limits_in_reverse_order_are_refused);
    RUN_TEST(test_what_cannot_be_switched_off_is_refused);
    RUN_TEST(test_a_limit_of_zero_is_a_limit_of_zero);
    RUN_TEST(test_null_is_refused);
    RUN_TEST(test_every_state_and_cause_has_its_own_words);
    return UNITY_END();
}
