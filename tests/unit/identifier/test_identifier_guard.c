/*
 * The guard within the identifier, on the simulated vehicle: once a limit is exceeded, the operator
 * aborts or a step is refused, the excitation and the thruster forces are exactly zero in that same
 * tick and in all later ones. What arming needs, and what an abort leaves.
 */
#include <math.h>
#include <string.h>

#include "identifier_guard.h"

/* ---- limits ---- */

static void test_too_deep(void)
{
    cfg.sim.position[2] = 99.9;
    cfg.sim.seabed_m = 150;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    (void)check_aborts(AUVID_GUARD_DEPTH_MAX, 60);
    TEST_ASSERT_TRUE(chain.actuation.guard.trip.value > 100);
    TEST_ASSERT_TRUE(chain.actuation.guard.trip.value < 100.1);
}

static void test_too_shallow(void)
{
    for (int i = 0; i < cfg.acting.excitation.segments; ++i) { /* upwards where it went down */
        cfg.acting.excitation.segment[i].amplitude *= -1;
    }
    cfg.sim.position[2] = 1.1;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    (void)check_aborts(AUVID_GUARD_DEPTH_MIN, 60);
    TEST_ASSERT_TRUE(chain.actuation.guard.trip.value < 1);
}

static void test_too_close_to_the_bottom(void)
{
    cfg.sim.seabed_m = 52.1;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    (void)check_aborts(AUVID_GUARD_ALTITUDE, 60);
    TEST_ASSERT_TRUE(chain.actuation.guard.trip.value < 2);
}

/* Some altimeters say "no bottom" by their largest number, which no checkpoint holds. */
static void say_no_bottom(chain_t *c, auvid_input_t *in)
{
    (void)c;
    in->altitude.altitude_m = in->altitude.present ? AUVID_C(3e38) : in->altitude.altitude_m;
}

static void test_an_altitude_beyond_all_bounds_is_dropped(void)
{
    cfg.before = say_no_bottom;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    TEST_ASSERT_TRUE((chain.events & AUVID_EVENT_ALTITUDE_DROPPED) != 0);
    TEST_ASSERT_FALSE(chain.actuation.altitude.known);
}

/* Roll wrapped to 0 .. 2 pi passes from 0 to a full turn. */
static void turn_roll(chain_t *c, auvid_input_t *in)
{
    (void)c;
    in->imu.attitude[0] += AUVID_C(6.2831853);
}

static void test_a_full_turn_of_roll_is_level(void)
{
    cfg.before = turn_roll;
    begin();
}

static void test_too_much_roll(void)
{
    cfg.acting.guard.roll_max_rad = AUVID_C(0.03);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    (void)check_aborts(AUVID_GUARD_ROLL, 60);
}

static void test_too_much_pitch(void)
{
    cfg.acting.guard.pitch_max_rad = AUVID_C(0.05);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    (void)check_aborts(AUVID_GUARD_PITCH, 60);
}

static void test_too_fast(void)
{
    cfg.acting.guard.speed_max = AUVID_C(0.4);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    (void)check_aborts(AUVID_GUARD_SPEED, 60);
}

static void test_turning_too_fast(void)
{
    cfg.acting.guard.yaw_rate_max = AUVID_C(0.3);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    (void)check_aborts(AUVID_GUARD_YAW_RATE, 60);
}

static void test_too_far_away(void)
{
    cfg.acting.guard.distance_max_m = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.5);
    (void)check_aborts(AUVID_GUARD_DISTANCE, 60);
}

static void test_the_run_takes_too_long(void)
{
    cfg.acting.guard.run_max_s = 20;
    begin();
    (void)check_aborts(AUVID_GUARD_RUN_TIME, 9);
    TEST_ASSERT_DOUBLE_WITHIN(0.021, 20.01, (double)chain.actuation.guard.trip.value);
}

static void test_lasting_saturation(void)
{
    begin();
    wrong = SATURATED;
    TEST_ASSERT_EQUAL(51, check_aborts(AUVID_GUARD_SATURATION, 2)); /* 1 s since the first tick */
}

static void test_lasting_saturation_by_the_excitation_itself(void)
{
    begin();
    for (int i = 0; i < SIM_THRUSTERS; ++i) { /* weakened thrusters: init checked them intact */
        chain.allocation.cfg.thruster[i].min_N = AUVID_C(-5.0);
        chain.allocation.cfg.thruster[i].max_N = AUVID_C(5.0);
    }
    (void)check_aborts(AUVID_GUARD_SATURATION, 10);
}

/* ---- the operator ---- */

static void test_the_operator_aborts(void)
{
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_abort(&chain.id));
    chain_tick(&chain);
    check_aborted(&chain.out, AUVID_GUARD_OPERATOR);
    check_stays_zero(AUVID_GUARD_OPERATOR);
}

static void test_the_operator_aborts_between_excite_and_the_first_tick(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain.waiting = false;
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_abort(&chain.id));
    chain_tick(&chain);
    check_aborted(&chain.out, AUVID_GUARD_OPERATOR);
    check_stays_zero(AUVID_GUARD_OPERATOR);
}

static void test_the_operators_heartbeat_stops(void)
{
    cfg.acting.guard.heartbeat_timeout_us = 15000000;
    begin();
    (void)check_aborts(AUVID_GUARD_LINK, 10);
}

/* ---- time, and steps that are refused ---- */

static void check_refused(const auvid_input_t *in, auvid_status_t status, auvid_guard_cause_t cause)
{
    auvid_output_t out;
    memset(&out, 0xFF, sizeof out);
    TEST_ASSERT_EQUAL(status, auvid_identifier_step(&chain.id, in, &out));
    check_aborted(&out, cause);
    check_stays_zero(cause);
}

static void test_time_goes_back(void)
{
    auvid_input_t in;
    begin();
    memset(&in, 0, sizeof in);
    in.t_us = chain.t_us - 1;
    check_refused(&in, AUVID_ERR_TIME_BACK, AUVID_GUARD_TIME);
}

static void test_time_stands_still(void)
{
    auvid_input_t in;
    begin();
    memset(&in, 0, sizeof in);
    in.t_us = chain.t_us;
    check_refused(&in, AUVID_ERR_TIME_SAME, AUVID_GUARD_TIME);
}

static void test_a_step_without_input_or_output(void)
{
    begin();
    check_refused(NULL, AUVID_ERR_NULL, AUVID_GUARD_NO_INPUT);
    auvid_input_t in;
    memset(&in, 0, sizeof in);
    begin();
    in.t_us = chain.t_us + SIM_TICK_US;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_step(&chain.id, &in, NULL));
    chain_tick(&chain);
    check_aborted(&chain.out, AUVID_GUARD_NO_INPUT);
}

/* Armed or exciting; with or without a tick after that; all optional limits are off. */
static void begin_unlimited(bool exciting, bool stepped)
{
    cfg.acting.guard.off = AUVID_GUARD_SWITCHABLE;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain.waiting = false;
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    if (exciting) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id));
    }
    if (stepped) {
        chain_tick(&chain);
        TEST_ASSERT_EQUAL(exciting ? AUVID_GUARD_EXCITING : AUVID_GUARD_ARMED, chain.out.guard);
    }
}

static void test_every_refused_step_aborts_whatever_limits_are_off(void)
{
    for (int k = 0; k < 4; ++k) {
        auvid_input_t in;
        memset(&in, 0, sizeof in);
        begin_unlimited(k & 1, k & 2);
        in.t_us = chain.t_us;
        check_refused(&in, AUVID_ERR_TIME_SAME, AUVID_GUARD_TIME);
        begin_unlimited(k & 1, k & 2);
        in.t_us = chain.t_us - 1;
        check_refused(&in, AUVID_ERR_TIME_BACK, AUVID_GUARD_TIME);
        begin_unlimited(k & 1, k & 2);
        check_refused(NULL, AUVID_ERR_NULL, AUVID_GUARD_NO_INPUT);
        begin_unlimited(k & 1, k & 2);
        in.t_us = chain.t_us + SIM_TICK_US;
        TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_step(&chain.id, &in, NULL));
        chain_tick(&chain);
        check_aborted(&chain.out, AUVID_GUARD_NO_INPUT);
    }
}

static void test_a_tick_that_stalled(void)
{
    auvid_input_t in;
    auvid_output_t out;
    begin();
    memset(&in, 0, sizeof in);
    in.t_us = chain.t_us + 250001u; /* all sensors at that time: only the loop was late */
    in.imu.present = in.depth.present = in.dvl.present = true;
    in.imu.t_us = in.depth.t_us = in.dvl.sample.t_us = in.t_us;
    in.depth.depth_m = (auvid_real_t)chain.sim.truth.position[2];
    in.dvl.sample.valid = AUVID_DVL_ALL;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    check_aborted(&out, AUVID_GUARD_TICK);
}

static void test_the_applied_wrench_is_not_recorded(void)
{
    sim_output_t seen;
    auvid_input_t in;
    auvid_output_t out;
    begin();
    for (int k = 0;; ++k) {
        TEST_ASSERT_TRUE(k < 100);
        sim_step(&chain.sim, NULL, NULL, &seen);
        chain_sense(&seen, 0, &in);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
        if (out.guard == AUVID_GUARD_ABORTED) {
            break;
        }
    }
    check_aborted(&out, AUVID_GUARD_APPLIED_STALE);
}

/* ---- arming ---- */

static void test_arming_before_the_first_sensor_samples_is_refused_with_a_reason(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_GUARD_IMU_STALE, chain.actuation.guard.refused.cause);
    TEST_ASSERT_EQUAL_FLOAT((float)AUVID_LARGEST, (float)chain.actuation.guard.refused.value);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain.waiting = false;
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_GUARD_VELOCITY_STALE, chain.actuation.guard.refused.cause);
    chain_run(&chain, 0.3);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ARMED, chain.out.guard);
    TEST_ASSERT_TRUE(is_zero(&chain.out));
}

static void test_arming_beyond_a_limit_is_refused(void)
{
    cfg.sim.position[2] = 101;
    cfg.sim.seabed_m = 150;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL(AUVID_ERR_LIMIT, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_GUARD_DEPTH_MAX, chain.actuation.guard.refused.cause);
    TEST_ASSERT_TRUE(is_zero(&chain.out));
}

static void test_a_breach_while_armed_keeps_it_from_exciting(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain.waiting = false;
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    wrong = NO_DVL;
    chain_run(&chain, 1.5);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.out.guard);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_excite(&chain.id));
}

static void test_after_an_abort_disarm_arm_and_excite_start_again(void)
{
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_abort(&chain.id));
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_disarm(&chain.id));
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, chain.out.guard);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id));
    chain_run(&chain, 5.0);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
    TEST_ASSERT_FALSE(is_zero(&chain.out));
}

/* The saturation ends with the disarm. */
static void test_saturation_ends_with_the_excitation(void)
{
    begin();
    for (int i = 0; i < SIM_THRUSTERS; ++i) { /* weakened thrusters: init checked them intact */
        chain.allocation.cfg.thruster[i].min_N = AUVID_C(-5.0);
        chain.allocation.cfg.thruster[i].max_N = AUVID_C(5.0);
    }
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_disarm(&chain.id));
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    chain_run(&chain, 3.0);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ARMED, chain.out.guard);
}

static void test_disarming_while_exciting_ends_it_at_once(void)
{
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_disarm(&chain.id));
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, chain.out.guard);
    TEST_ASSERT_TRUE(is_zero(&chain.out));
}

static void test_stop_fades_settles_and_is_done(void)
{
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_stop(&chain.id));
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
    TEST_ASSERT_FALSE(is_zero(&chain.out));
    chain_run(&chain, 2.1);
    TEST_ASSERT_EQUAL(AUVID_GUARD_SETTLING, chain.out.guard);
    TEST_ASSERT_TRUE(is_zero(&chain.out));
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_SETTLED);
    chain_run(&chain, 30.0);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_TRUE(chain.events & AUVID_EVENT_SETTLED);
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_ABORTED);
}

/* ---- the excursion limit ---- */

/* A current of 0.3 m/s carries the vehicle 70 m in this run without the excursion limit. */
static void test_the_excursion_limit_keeps_the_vehicle_within_its_distance_in_a_current(void)
{
    for (int limited = 0; limited < 2; ++limited) {
        chain_defaults(&cfg, 5, 8, 3.0);
        cfg.budget = 0;
        cfg.sim.current[0] = -0.2;
        cfg.sim.current[1] = 0.2236;
        cfg.acting.guard.distance_max_m = 20;
        if (!limited) {
            memset(cfg.acting.excitation.excursion_limit, 0,
                   sizeof cfg.acting.excitation.excursion_limit);
        }
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
        chain_run(&chain, 239.0);
        TEST_ASSERT_EQUAL(limited ? AUVID_GUARD_EXCITING : AUVID_GUARD_ABORTED, chain.out.guard);
        TEST_ASSERT_EQUAL(limited ? AUVID_GUARD_NO_CAUSE : AUVID_GUARD_DISTANCE, chain.out.cause);
    }
}

/* ---- data ---- */

/* The abort comes during a search, 20 s into the second set. */
static void test_an_abort_loses_neither_the_search_nor_the_data(void)
{
    cfg.budget = 20;
    cfg.id.search.has_good = false;
    cfg.id.search.paper = true; /* a long search */
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 52.0);
    TEST_ASSERT_EQUAL(AUVID_PENDING, chain.work);
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.metric.sets.recorded);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_abort(&chain.id));
    chain_run(&chain, 3.0);
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, auvid_identifier_close(&chain.id));
    TEST_ASSERT_EQUAL_UINT32(2, chain.id.metric.sets.recorded);
    TEST_ASSERT_TRUE(chain_finish(&chain, 1000, 1000) <= 1000);
    TEST_ASSERT_EQUAL_UINT32(2, chain.id.estimate.sets);
    for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
        TEST_ASSERT_TRUE(fabs(chain_error(&chain, i)) < 0.10);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_too_deep);
    RUN_TEST(test_too_shallow);
    RUN_TEST(test_too_close_to_the_bottom);
    RUN_TEST(test_an_altitude_beyond_all_bounds_is_dropped);
    RUN_TEST(test_a_full_turn_of_roll_is_level);
    RUN_TEST(test_too_much_roll);
    RUN_TEST(test_too_much_pitch);
    RUN_TEST(test_too_fast);
    RUN_TEST(test_turning_too_fast);
    RUN_TEST(test_too_far_away);
    RUN_TEST(test_the_run_takes_too_long);
    RUN_TEST(test_lasting_saturation);
    RUN_TEST(test_lasting_saturation_by_the_excitation_itself);
    RUN_TEST(test_the_operator_aborts);
    RUN_TEST(test_the_operator_aborts_between_excite_and_the_first_tick);
    RUN_TEST(test_the_operators_heartbeat_stops);
    RUN_TEST(test_time_goes_back);
    RUN_TEST(test_time_stands_still);
    RUN_TEST(test_a_step_without_input_or_output);
    RUN_TEST(test_every_refused_step_aborts_whatever_limits_are_off);
    RUN_TEST(test_a_tick_that_stalled);
    RUN_TEST(test_the_applied_wrench_is_not_recorded);
    RUN_TEST(test_arming_before_the_first_sensor_samples_is_refused_with_a_reason);
    RUN_TEST(test_arming_beyond_a_limit_is_refused);
    RUN_TEST(test_a_breach_while_armed_keeps_it_from_exciting);
    RUN_TEST(test_after_an_abort_disarm_arm_and_excite_start_again);
    RUN_TEST(test_saturation_ends_with_the_excitation);
    RUN_TEST(test_disarming_while_exciting_ends_it_at_once);
    RUN_TEST(test_stop_fades_settles_and_is_done);
    RUN_TEST(test_the_excursion_limit_keeps_the_vehicle_within_its_distance_in_a_current);
    RUN_TEST(test_an_abort_loses_neither_the_search_nor_the_data);
    return UNITY_END();
}
