/*
 * The guard within the identifier and its sensors: when one of the simulated vehicle's fails, the
 * excitation and the thruster forces are exactly zero in that same tick and in all later ones. The
 * effect of samples written by hand on the guard and on the excitation.
 */
#include <math.h>
#include <string.h>

#include "auvid/adaptive.h"
#include "identifier_guard.h"

/* ---- sensors ---- */

static void test_the_imu_is_lost(void)
{
    begin();
    wrong = NO_IMU;
    TEST_ASSERT_EQUAL(11, check_aborts(AUVID_GUARD_IMU_STALE, 1)); /* 0.2 s */
}

static void test_the_imu_sends_values_that_are_not_finite(void)
{
    begin();
    wrong = NAN_IMU;
    TEST_ASSERT_EQUAL(11, check_aborts(AUVID_GUARD_IMU_STALE, 1));
}

static void test_the_dvl_is_lost(void)
{
    begin();
    wrong = NO_DVL;
    int ticks = check_aborts(AUVID_GUARD_VELOCITY_STALE, 2);
    TEST_ASSERT_TRUE(ticks > 40 && ticks <= 51); /* 1 s from the last sample on, at 5 Hz */
}

static void test_the_dvl_loses_the_bottom(void)
{
    begin();
    chain.sim.cfg.dvl_lock = SIM_LOCK_WATER;
    (void)check_aborts(AUVID_GUARD_VELOCITY_STALE, 2);
}

/* One axis of the DVL continues to measure, in a current. The excitation ends before the error of
 * dead reckoning is large. */
static void check_one_axis_in_a_current(double current, double within_m, double within_m_s)
{
    cfg.sim.current[0] = current;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 3.0);
    wrong = HEAVE_ONLY;
    int ticks = check_aborts(AUVID_GUARD_VELOCITY_STALE, 2);
    TEST_ASSERT_TRUE(ticks > 40 && ticks <= 51);
    chain_begin(&chain, &cfg); /* again, to compare with the truth at the end */
    wrong = 0;
    chain_run(&chain, 3.0);
    wrong = HEAVE_ONLY;
    chain_run(&chain, ticks * 0.02);
    const sim_truth_t *t = &chain.sim.truth;
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.out.guard);
    TEST_ASSERT_TRUE(hypot(t->position[0], t->position[1]) < within_m);
    TEST_ASSERT_TRUE(hypot(t->ground[0], t->ground[1]) < within_m_s);
}

static void test_one_axis_of_the_dvl_is_no_velocity_in_a_current_of_0_8_m_s(void)
{
    check_one_axis_in_a_current(0.8, 5.0, 1.5);
}

static void test_one_axis_of_the_dvl_is_no_velocity_in_a_current_of_1_2_m_s(void)
{
    check_one_axis_in_a_current(1.2, 7.0, 1.5);
}

static void test_heave_must_be_measured_where_it_is_excited(void)
{
    begin();
    wrong = NO_HEAVE;
    int ticks = check_aborts(AUVID_GUARD_VELOCITY_STALE, 2);
    TEST_ASSERT_TRUE(ticks > 40 && ticks <= 51);
}

static void test_heave_need_not_be_measured_where_it_is_not_excited(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {60, 60, 0, 0, 0, 20};
    (void)auvid_excitation_plan(&cfg.acting.excitation, amplitude, CHAIN_SET_S, 2, 3);
    begin();
    wrong = NO_HEAVE;
    chain_run(&chain, 20.0);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
    wrong = HEAVE_ONLY;
    check_aborts(AUVID_GUARD_VELOCITY_STALE, 2);
}

/* The adaptive excitation replaces a plan without heave. */
static void test_heave_must_be_measured_where_the_adaptive_excitation_excites_it(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {60, 60, 0, 0, 0, 20};
    auvid_adaptive_config_t adaptive;
    auvid_adaptive_defaults(&adaptive);
    memcpy(adaptive.amplitude, amplitude, sizeof amplitude);
    (void)auvid_excitation_plan(&cfg.acting.excitation, amplitude, CHAIN_SET_S, 2, 3);
    for (int heave = 0; heave < 2; ++heave) {
        wrong = 0;
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
        adaptive.amplitude[AUVID_HEAVE] = (auvid_real_t)(60 * heave);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_adaptive_begin(&chain.id, &chain.adaptive, &adaptive, NULL));
        chain_run(&chain, BEFORE_S);
        wrong = NO_HEAVE;
        chain_run(&chain, 5.0);
        TEST_ASSERT_EQUAL(heave ? AUVID_GUARD_ABORTED : AUVID_GUARD_EXCITING, chain.out.guard);
    }
}

static void test_water_lock_leaves_speed_and_distance_over_ground_unknown(void)
{
    cfg.acting.guard.water_lock = true;
    begin();
    wrong = WATER;
    int ticks = check_aborts(AUVID_GUARD_SPEED, 2);
    TEST_ASSERT_TRUE(ticks > 40 && ticks <= 51);
    cfg.acting.guard.off = AUVID_GUARD_BIT(AUVID_GUARD_SPEED);
    begin();
    wrong = WATER;
    check_aborts(AUVID_GUARD_DISTANCE, 2);
    cfg.acting.guard.off |= AUVID_GUARD_BIT(AUVID_GUARD_DISTANCE);
    begin();
    wrong = WATER;
    chain_run(&chain, 20.0);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
    wrong = WATER | NO_HEAVE; /* a partial water lock does not count */
    check_aborts(AUVID_GUARD_VELOCITY_STALE, 2);
}

static void test_depth_is_lost(void)
{
    begin();
    wrong = NO_DEPTH;
    int ticks = check_aborts(AUVID_GUARD_DEPTH_STALE, 2);
    TEST_ASSERT_TRUE(ticks > 45 && ticks <= 51);
}

static void test_altitude_is_lost(void)
{
    begin();
    wrong = NO_ALTITUDE;
    (void)check_aborts(AUVID_GUARD_ALTITUDE_STALE, 2);
}

static void test_without_an_altimeter_all_goes_well(void)
{
    wrong = NO_ALTITUDE;
    begin();
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
}

/* ---- sensors written by hand ---- */

static auvid_identifier_t *const id = &chain.id;
static auvid_input_t in;
static auvid_output_t out;

/* Without thrusters; a long step of 10 N in surge; of the guard's optional limits only those kept.
 * The clock begins with the first tick. */
static void begin_by_hand(uint32_t kept, uint64_t first_us)
{
    auvid_identifier_defaults(&cfg.id, &auvid_girona500);
    auvid_actuation_defaults(&cfg.acting);
    auvid_allocation_defaults(&cfg.thrusters);
    cfg.acting.excitation.segments = 1;
    cfg.acting.excitation.segment[0] = (auvid_segment_t){
        .dof = AUVID_SURGE, .kind = AUVID_SEGMENT_STEP, .duration_s = 600, .amplitude = 10};
    cfg.acting.guard.off = AUVID_GUARD_SWITCHABLE & ~kept;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
    memset(&in, 0, sizeof in);
    in.t_us = first_us - SIM_TICK_US; /* the first tick advances it to first_us */
}

/* The input of the next tick: an IMU sample and the others as they are. */
static void next_by_hand(void)
{
    in.t_us += SIM_TICK_US;
    in.imu.present = true;
    in.imu.t_us = in.dvl.sample.t_us = in.depth.t_us = in.t_us;
}

static void tick_by_hand(void)
{
    next_by_hand();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(id, &in, &out));
}

static void excite_by_hand(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(id));
}

/* A vehicle rolls, pitches and turns through pi while it moves. In every tick the excitation gets
 * R' (position - home), with R of Fossen's (2.18), and the change of the angles. */
static void test_the_excitation_gets_the_displacement_in_present_body_axes(void)
{
    double home[6] = {0};
    begin_by_hand(0, 1000000);
    for (int k = 0; k < 250; ++k) {
        double turned = k < 50 ? 0 : 0.02 * (k - 50);
        in.imu.attitude[0] = (auvid_real_t)(0.3 + 0.1 * turned);
        in.imu.attitude[1] = (auvid_real_t)(-0.2 - 0.05 * turned);
        in.imu.attitude[2] = (auvid_real_t)remainder(2.0 + turned, 2 * acos(-1.0));
        in.dvl.present = in.depth.present = true;
        in.dvl.sample.valid = AUVID_DVL_ALL;
        in.dvl.sample.velocity[0] = AUVID_C(0.5);
        in.dvl.sample.velocity[1] = AUVID_C(-0.4);
        in.dvl.sample.velocity[2] = AUVID_C(0.3);
        in.depth.depth_m = AUVID_C(10.0);
        if (k == 50) {
            excite_by_hand();
        }
        tick_by_hand();
        auvid_nav_state_t state;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&id->nav, &state));
        double moved[3], d[6], s[3], c[3];
        for (int i = 0; i < 3; ++i) {
            home[i] = k == 50 ? (double)state.position[i] : home[i];
            home[3 + i] = k == 50 ? (double)state.attitude[i] : home[3 + i];
            moved[i] = (double)state.position[i] - home[i];
            d[3 + i] = (double)state.attitude[i] - home[3 + i];
            s[i] = sin((double)state.attitude[i]);
            c[i] = cos((double)state.attitude[i]);
        }
        d[0] = c[2] * c[1] * moved[0] + s[2] * c[1] * moved[1] - s[1] * moved[2];
        d[1] = (-s[2] * c[0] + c[2] * s[1] * s[0]) * moved[0] +
               (c[2] * c[0] + s[2] * s[1] * s[0]) * moved[1] + c[1] * s[0] * moved[2];
        d[2] = (s[2] * s[0] + c[2] * s[1] * c[0]) * moved[0] +
               (-c[2] * s[0] + s[2] * s[1] * c[0]) * moved[1] + c[1] * c[0] * moved[2];
        for (int j = 0; j < 6 && k >= 50; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, d[j],
                                      (double)id->actuation->excitation.displacement[j]);
        }
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, out.guard);
    TEST_ASSERT_TRUE(hypot((double)id->actuation->excitation.displacement[0],
                           (double)id->actuation->excitation.displacement[1]) > 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 3.98,
                              (double)id->actuation->excitation.displacement[AUVID_YAW]);
}

static void test_without_thrusters_the_excitation_is_not_limited_by_them(void)
{
    begin_by_hand(0, 1000000);
    tick_by_hand();
    excite_by_hand();
    for (int k = 0; k < 150; ++k) { /* the fade in is over after two seconds */
        tick_by_hand();
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_EQUAL_FLOAT(j == AUVID_SURGE ? 10.0f : 0.0f, (float)out.excitation[j]);
    }
    for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
        TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)out.thruster_N[i]);
    }
}

static void test_a_refused_excite_does_not_cancel_the_one_before(void)
{
    begin_by_hand(0, 1000000);
    tick_by_hand();
    excite_by_hand();
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_excite(id));
    for (int k = 0; k < 150; ++k) {
        tick_by_hand();
        TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, out.guard);
    }
    TEST_ASSERT_EQUAL_FLOAT(10.0f, (float)out.excitation[AUVID_SURGE]);
}

static void test_an_abort_is_reported_once_however_often_it_is_called(void)
{
    begin_by_hand(0, 1000000);
    for (int k = 0; k < 3; ++k) {
        tick_by_hand();
        TEST_ASSERT_EQUAL_HEX32(k == 1 ? AUVID_EVENT_ABORTED : 0,
                                out.events & (AUVID_EVENT_ABORTED | AUVID_EVENT_TIME));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_abort(id));
    }
}

static void test_water_lock_may_be_the_only_lock_from_time_zero_on(void)
{
    const uint32_t kept = AUVID_GUARD_BIT(AUVID_GUARD_VELOCITY_STALE);
    for (int water = 0; water < 2; ++water) {
        begin_by_hand(kept, 0);
        cfg.acting.guard.water_lock = true;
        TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
        in.dvl.present = water;
        in.dvl.sample.lock = AUVID_DVL_WATER;
        in.dvl.sample.valid = AUVID_DVL_ALL;
        tick_by_hand();
        TEST_ASSERT_EQUAL(water ? AUVID_OK : AUVID_ERR_STALE, auvid_identifier_arm(id));
        if (!water) {
            TEST_ASSERT_EQUAL(AUVID_GUARD_VELOCITY_STALE, id->actuation->guard.refused.cause);
            TEST_ASSERT_EQUAL_FLOAT((float)AUVID_LARGEST,
                                    (float)id->actuation->guard.refused.value);
        }
    }
}

static void test_bottom_lock_counts_where_a_water_lock_was_before(void)
{
    begin_by_hand(AUVID_GUARD_BIT(AUVID_GUARD_VELOCITY_STALE), 1000000);
    cfg.acting.guard.water_lock = true;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
    in.dvl.present = true;
    in.dvl.sample.lock = AUVID_DVL_WATER;
    in.dvl.sample.valid = AUVID_DVL_ALL;
    tick_by_hand();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(id));
    in.dvl.sample.lock = AUVID_DVL_BOTTOM;
    for (int k = 0; k < 100; ++k) {
        tick_by_hand();
        TEST_ASSERT_EQUAL(AUVID_GUARD_ARMED, out.guard);
    }
}

static void test_a_surface_craft_needs_a_depth_only_to_excite_heave(void)
{
    const uint32_t kept =
        AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_STALE) | AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX);
    for (int heave = 0; heave < 2; ++heave) {
        const auvid_real_t amplitude[AUVID_DOF_COUNT] = {60, 0, (auvid_real_t)(60 * heave)};
        begin_by_hand(kept, 1000000);
        cfg.acting.guard.surface = true;
        (void)auvid_excitation_plan(&cfg.acting.excitation, amplitude, CHAIN_SET_S, 2, 3);
        TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
        in.depth.present = false;
        tick_by_hand();
        TEST_ASSERT_EQUAL(heave ? AUVID_ERR_STALE : AUVID_OK, auvid_identifier_arm(id));
        TEST_ASSERT_EQUAL(heave ? AUVID_GUARD_DEPTH_STALE : AUVID_GUARD_NO_CAUSE,
                          id->actuation->guard.refused.cause);
    }
}

static void test_roll_and_pitch_each_have_their_limit(void)
{
    const uint32_t kept = AUVID_GUARD_BIT(AUVID_GUARD_ROLL) | AUVID_GUARD_BIT(AUVID_GUARD_PITCH);
    for (int pitch = 0; pitch < 2; ++pitch) {
        begin_by_hand(kept, 1000000);
        in.imu.attitude[pitch] = AUVID_C(0.7);
        tick_by_hand();
        TEST_ASSERT_EQUAL(AUVID_ERR_LIMIT, auvid_identifier_arm(id));
        TEST_ASSERT_EQUAL(pitch ? AUVID_GUARD_PITCH : AUVID_GUARD_ROLL,
                          id->actuation->guard.refused.cause);
    }
}

static void test_a_vehicle_that_has_rolled_over_once_is_level_again(void)
{
    begin_by_hand(AUVID_GUARD_BIT(AUVID_GUARD_ROLL), 1000000);
    for (int k = 0; k <= 64; ++k) {
        in.imu.attitude[0] = (auvid_real_t)remainder(acos(-1.0) / 32 * k, 2 * acos(-1.0));
        tick_by_hand();
        TEST_ASSERT_EQUAL(k <= 6 || k >= 58 ? AUVID_OK : AUVID_ERR_LIMIT, auvid_identifier_arm(id));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_disarm(id));
    }
}

/* One identifier has sensors, the other has none. The other cannot be armed if they are required.
 * With all limits off its excitation gets no displacement. */
static void test_an_identifier_without_sensors_takes_nothing_from_another_one(void)
{
    static auvid_identifier_t blind;
    static auvid_actuation_t acting;
    begin_by_hand(0, 1000000);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&blind, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_actuation(&blind, &acting, &cfg.acting, NULL));
    in.dvl.present = true;
    in.dvl.sample.valid = AUVID_DVL_ALL;
    in.dvl.sample.velocity[0] = AUVID_C(0.5);
    for (int k = 0; k < 100; ++k) {
        if (k == 1) {
            acting.guard.cfg.off = 0;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(id));
            TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_identifier_arm(&blind));
            TEST_ASSERT_EQUAL(AUVID_GUARD_IMU_STALE, acting.guard.refused.cause);
            acting.guard.cfg.off = AUVID_GUARD_SWITCHABLE;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&blind));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(id));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&blind));
        }
        next_by_hand();
        auvid_input_t nothing = {.t_us = in.t_us};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(id, &in, &out));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&blind, &nothing, &out));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            TEST_ASSERT_EQUAL_FLOAT(0.0f, (float)acting.excitation.displacement[j]);
        }
    }
    TEST_ASSERT_TRUE(id->actuation->excitation.displacement[AUVID_SURGE] > AUVID_C(0.5));
}

/* ---- altitude ---- */

static void check_altitude(uint64_t now_us, uint64_t ahead_us, double altitude, bool taken)
{
    begin_by_hand(AUVID_GUARD_BIT(AUVID_GUARD_ALTITUDE), now_us);
    in.altitude.present = true;
    in.altitude.t_us = now_us + ahead_us;
    in.altitude.altitude_m = (auvid_real_t)altitude;
    tick_by_hand();
    TEST_ASSERT_EQUAL(!taken, (out.events & AUVID_EVENT_ALTITUDE_DROPPED) != 0);
    TEST_ASSERT_EQUAL(taken ? AUVID_ERR_LIMIT : AUVID_OK, auvid_identifier_arm(id));
    if (taken) {
        TEST_ASSERT_EQUAL(AUVID_GUARD_ALTITUDE, id->actuation->guard.refused.cause);
        TEST_ASSERT_EQUAL_FLOAT((float)altitude, (float)id->actuation->guard.refused.value);
    }
}

/* The minimum altitude for arming is 2 m. */
static void test_altitudes_from_zero_on_and_not_too_far_ahead_are_taken(void)
{
    uint64_t future_us = cfg.id.nav.future_us;
    TEST_ASSERT_TRUE(future_us > 0);
    for (uint64_t now_us = 0; now_us <= 1000000; now_us += 1000000) {
        check_altitude(now_us, 0, 0.5, true);
        check_altitude(now_us, 0, 0.0, true);
        check_altitude(now_us, 0, -0.001, false);
        check_altitude(now_us, future_us, 1.0, true);
        check_altitude(now_us, future_us + 1, 1.0, false);
    }
}

static void test_impossible_altitudes_are_dropped(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
    memset(&in, 0, sizeof in);
    in.t_us = 1000000;
    in.altitude.present = true;
    in.altitude.t_us = 990000;
    in.altitude.altitude_m = 3;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL_HEX32(0, out.events & AUVID_EVENT_ALTITUDE_DROPPED);
    static const double altitude[] = {4, NAN, INFINITY, -1, 4};
    static const uint64_t t_us[] = {990000, 991000, 991000, 991000, 9000000};
    for (int i = 0; i < 5; ++i) {
        in.t_us += SIM_TICK_US;
        in.altitude.t_us = t_us[i];
        in.altitude.altitude_m = (auvid_real_t)altitude[i];
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
        TEST_ASSERT_TRUE(out.events & AUVID_EVENT_ALTITUDE_DROPPED);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_imu_is_lost);
    RUN_TEST(test_the_imu_sends_values_that_are_not_finite);
    RUN_TEST(test_the_dvl_is_lost);
    RUN_TEST(test_the_dvl_loses_the_bottom);
    RUN_TEST(test_one_axis_of_the_dvl_is_no_velocity_in_a_current_of_0_8_m_s);
    RUN_TEST(test_one_axis_of_the_dvl_is_no_velocity_in_a_current_of_1_2_m_s);
    RUN_TEST(test_heave_must_be_measured_where_it_is_excited);
    RUN_TEST(test_heave_need_not_be_measured_where_it_is_not_excited);
    RUN_TEST(test_heave_must_be_measured_where_the_adaptive_excitation_excites_it);
    RUN_TEST(test_water_lock_leaves_speed_and_distance_over_ground_unknown);
    RUN_TEST(test_depth_is_lost);
    RUN_TEST(test_altitude_is_lost);
    RUN_TEST(test_without_an_altimeter_all_goes_well);
    RUN_TEST(test_the_excitation_gets_the_displacement_in_present_body_axes);
    RUN_TEST(test_without_thrusters_the_excitation_is_not_limited_by_them);
    RUN_TEST(test_a_refused_excite_does_not_cancel_the_one_before);
    RUN_TEST(test_an_abort_is_reported_once_however_often_it_is_called);
    RUN_TEST(test_water_lock_may_be_the_only_lock_from_time_zero_on);
    RUN_TEST(test_bottom_lock_counts_where_a_water_lock_was_before);
    RUN_TEST(test_a_surface_craft_needs_a_depth_only_to_excite_heave);
    RUN_TEST(test_roll_and_pitch_each_have_their_limit);
    RUN_TEST(test_a_vehicle_that_has_rolled_over_once_is_level_again);
    RUN_TEST(test_an_identifier_without_sensors_takes_nothing_from_another_one);
    RUN_TEST(test_altitudes_from_zero_on_and_not_too_far_ahead_are_taken);
    RUN_TEST(test_impossible_altitudes_are_dropped);
    return UNITY_END();
}
