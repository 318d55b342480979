/*
 * What the identifier is fed: refused or dropped with the right status or event, nothing else
 * disturbed; the same bits for the same inputs, however they are brought.
 */
#include <fenv.h>
#include <math.h>
#include <string.h>

#include "chain.h"
#include "unity.h"

#define ALL_DROPPED                                                                                \
    (AUVID_EVENT_IMU_DROPPED | AUVID_EVENT_DVL_DROPPED | AUVID_EVENT_DEPTH_DROPPED |               \
     AUVID_EVENT_GPS_DROPPED | AUVID_EVENT_INPUT_DROPPED | AUVID_EVENT_TIME)

enum { SETS = 2, SPOILT_EVERY = 250 }; /* ticks; a multiple of what lies between DVL samples */

static chain_t chain, other;
static chain_config_t config;

void setUp(void)
{
    chain_defaults(&config, 11, SETS, 1.0);
    config.budget = 0;
}

void tearDown(void)
{
}

static void finish(chain_t *c)
{
    TEST_ASSERT_TRUE(chain_finish(c, 1000, 1000) <= 1000);
}

static void run(chain_t *c)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(c, &config, SETS));
    finish(c);
    TEST_ASSERT_EQUAL_UINT32(SETS, c->id.estimate.sets);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, c->id.estimate.identified);
}

static void check_same_estimate(void)
{
    TEST_ASSERT_EQUAL_MEMORY(&other.id.estimate, &chain.id.estimate, sizeof chain.id.estimate);
}

static void check_masses(const chain_t *c)
{
    for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
        TEST_ASSERT_TRUE(fabs(chain_error(c, i)) < 0.10);
    }
}

static bool is_zero(const auvid_output_t *out)
{
    auvid_real_t sum = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        sum += out->excitation[j] < 0 ? -out->excitation[j] : out->excitation[j];
    }
    for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
        sum += out->thruster_N[i] < 0 ? -out->thruster_N[i] : out->thruster_N[i];
    }
    return sum == 0;
}

/* ---- the same bits ---- */

static void test_same_inputs_give_the_same_bits(void)
{
    config.budget = 50;
    run(&chain);
    run(&other);
    check_same_estimate();
}

static void test_interleaved_identifiers_do_not_interact(void)
{
    static chain_t alone[2];
    chain_config_t second;
    chain_defaults(&second, 12, SETS, 0.0);
    config.budget = 500;
    second.budget = 1000;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&alone[0], &config, SETS));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&alone[1], &second, SETS));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&other, &second));
    while (chain.tick < alone[0].tick) {
        chain_tick(&chain);
        chain_tick(&other);
    }
    TEST_ASSERT_TRUE(alone[0].id.estimate.number > 0 && alone[1].id.estimate.number > 0);
    TEST_ASSERT_EQUAL_MEMORY(&alone[0].id, &chain.id, sizeof chain.id);
    TEST_ASSERT_EQUAL_MEMORY(&alone[1].id, &other.id, sizeof other.id);
}

static void test_a_copy_of_an_identifier_goes_on_identically(void)
{
    config.budget = 20;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain_run(&chain, 40.0); /* searching, exciting, recording */
    TEST_ASSERT_EQUAL(AUVID_PENDING, chain.work);
    memcpy(&other, &chain, sizeof other);
    chain_run(&chain, 30.0);
    memset(&chain.config.id, 0xFF, sizeof chain.config.id); /* nothing points there */
    chain_run(&other, 30.0);
    TEST_ASSERT_EQUAL_MEMORY(&chain.id, &other.id, sizeof chain.id);
    TEST_ASSERT_TRUE(chain.id.estimate.number > 0);
}

static void give_applied_apart(chain_t *c, auvid_input_t *in)
{
    in->applied.present = false;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&c->id, in->t_us, in->applied.wrench,
                                                         in->applied.command));
}

static void test_the_applied_wrench_may_come_with_the_step_or_apart(void)
{
    chain_set_driver(&config);
    run(&other);
    config.before = give_applied_apart;
    run(&chain);
    check_same_estimate();
}

/* A navigation of one's own, its state recorded in every tick. */
static auvid_nav_t own_nav;

static void navigate_apart(chain_t *c, auvid_input_t *in)
{
    auvid_nav_state_t state;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_nav_imu(&own_nav, in->imu.t_us, in->imu.attitude, in->imu.rates));
    if (in->dvl.present) {
        (void)auvid_nav_dvl(&own_nav, &in->dvl.sample);
    }
    if (in->depth.present) {
        (void)auvid_nav_depth(&own_nav, in->depth.t_us, in->depth.depth_m);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&own_nav, &state));
    if (state.flags & AUVID_NAV_FRESH_BOTTOM) {
        auvid_real_t nu[AUVID_DOF_COUNT];
        memcpy(nu, state.velocity, sizeof state.velocity);
        memcpy(nu + AUVID_ROLL, state.rates, sizeof state.rates);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_identifier_motion(&c->id, state.t_us, state.attitude, nu));
    }
    in->imu.present = in->dvl.present = in->depth.present = false;
}

static void test_motion_from_elsewhere_gives_the_same_as_the_sensors_it_came_from(void)
{
    chain_set_driver(&config);
    config.id.velocity_every_tick = true;
    run(&other);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_init(&own_nav, &config.id.nav));
    config.before = navigate_apart;
    run(&chain);
    check_same_estimate();
}

static void test_the_clock_may_begin_anywhere(void)
{
    run(&other);
    config.epoch_us = UINT64_C(1) << 60;
    run(&chain);
    TEST_ASSERT_EQUAL_MEMORY(other.id.estimate.pi, chain.id.estimate.pi,
                             sizeof chain.id.estimate.pi);
}

/* ---- bad samples ---- */

typedef enum {
    IMU_ATTITUDE,
    IMU_RATE,
    IMU_FUTURE,
    IMU_PAST,
    IMU_SAME,
    DVL_VALUE,
    DVL_FUTURE,
    DVL_PAST,
    DVL_TOO_FAST,
    DVL_OUTLIER,
    DEPTH_VALUE,
    DEPTH_PAST,
    DEPTH_OUTLIER,
    GPS_VALUE,
    INPUT_WRENCH,
    INPUT_COMMAND,
    SPOILS
} spoil_t;

static const uint32_t expected_event[SPOILS] = {
    [IMU_ATTITUDE] = AUVID_EVENT_IMU_DROPPED,    [IMU_RATE] = AUVID_EVENT_IMU_DROPPED,
    [IMU_FUTURE] = AUVID_EVENT_IMU_DROPPED,      [IMU_PAST] = AUVID_EVENT_IMU_DROPPED,
    [IMU_SAME] = AUVID_EVENT_IMU_DROPPED,        [DVL_VALUE] = AUVID_EVENT_DVL_DROPPED,
    [DVL_FUTURE] = AUVID_EVENT_DVL_DROPPED,      [DVL_PAST] = AUVID_EVENT_DVL_DROPPED,
    [DVL_TOO_FAST] = AUVID_EVENT_DVL_DROPPED,    [DVL_OUTLIER] = AUVID_EVENT_DVL_DROPPED,
    [DEPTH_VALUE] = AUVID_EVENT_DEPTH_DROPPED,   [DEPTH_PAST] = AUVID_EVENT_DEPTH_DROPPED,
    [DEPTH_OUTLIER] = AUVID_EVENT_DEPTH_DROPPED, [GPS_VALUE] = AUVID_EVENT_GPS_DROPPED,
    [INPUT_WRENCH] = AUVID_EVENT_INPUT_DROPPED,  [INPUT_COMMAND] = AUVID_EVENT_INPUT_DROPPED,
};

typedef struct {
    spoil_t what;
    auvid_real_t value;
    bool absent; /* leave the sample out instead */
    int element;
    int spoilt;
} spoiler_t;

static void spoil_sensor(const spoiler_t *s, auvid_input_t *in)
{
    switch (s->what) {
    case IMU_ATTITUDE:
        in->imu.attitude[s->element % 3] = s->value;
        break;
    case IMU_RATE:
        in->imu.rates[s->element % 3] = s->value;
        break;
    case IMU_FUTURE:
        in->imu.t_us += 3600000000u;
        break;
    case IMU_PAST:
        in->imu.t_us -= 5 * SIM_TICK_US;
        break;
    case IMU_SAME:
        in->imu.t_us -= SIM_TICK_US;
        break;
    case DVL_VALUE:
        in->dvl.sample.velocity[s->element % 3] = s->value;
        break;
    case DVL_FUTURE:
        in->dvl.sample.t_us += 3600000000u;
        break;
    case DVL_PAST:
        in->dvl.sample.t_us -= 10 * SIM_TICK_US;
        break;
    case DVL_TOO_FAST:
        in->dvl.sample.velocity[s->element % 3] = 20;
        break;
    case DVL_OUTLIER:
        in->dvl.sample.velocity[s->element % 3] +=
            in->dvl.sample.velocity[s->element % 3] > 0 ? -1 : 1;
        break;
    case DEPTH_OUTLIER:
        in->depth.depth_m += 5;
        break;
    case DEPTH_VALUE:
        in->depth.depth_m = s->value;
        break;
    case DEPTH_PAST:
        in->depth.t_us -= 5 * SIM_TICK_US;
        break;
    case GPS_VALUE:
        in->gps.present = true;
        in->gps.t_us = in->t_us;
        in->gps.x_m = s->element % 2 ? s->value : 0;
        in->gps.y_m = s->element % 2 ? 0 : s->value;
        break;
    case INPUT_WRENCH:
        in->applied.wrench[s->element % AUVID_DOF_COUNT] = s->value;
        break;
    default:
        in->applied.command[s->element % AUVID_MAX_COMMANDS] = s->value;
        break;
    }
}

/* Every so often: spoil the sample, or leave it out. */
static void spoil(chain_t *c, auvid_input_t *in)
{
    spoiler_t *s = c->config.context;
    uint32_t event = expected_event[s->what];
    if (c->tick % SPOILT_EVERY != 0) {
        return;
    }
    ++s->spoilt;
    if (!s->absent) {
        s->element = s->spoilt;
        spoil_sensor(s, in);
    } else if (event == AUVID_EVENT_IMU_DROPPED) {
        in->imu.present = false;
    } else if (event == AUVID_EVENT_DVL_DROPPED) {
        TEST_ASSERT_TRUE(in->dvl.present);
        in->dvl.present = false;
    } else if (event == AUVID_EVENT_DEPTH_DROPPED) {
        TEST_ASSERT_TRUE(in->depth.present);
        in->depth.present = false;
    } else if (event == AUVID_EVENT_INPUT_DROPPED) {
        in->applied.present = false;
    }
}

/* The event in the very tick, no other one for it, and all else as if it had not been there. */
static void expect_event(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    const spoiler_t *s = c->config.context;
    bool now = c->tick % SPOILT_EVERY == 0 && !s->absent;
    TEST_ASSERT_EQUAL(AUVID_OK, status);
    TEST_ASSERT_EQUAL_HEX32(now ? expected_event[s->what] : 0, out->events & ALL_DROPPED);
}

static void check_spoilt(spoil_t what, auvid_real_t value)
{
    spoiler_t s = {what, value, false, 0, 0};
    chain_defaults(&config, 11, SETS, 1.0);
    config.budget = 0;
    chain_set_driver(&config);
    config.before = spoil;
    config.after = expect_event;
    config.context = &s;
    run(&chain);
    TEST_ASSERT_TRUE(s.spoilt > 10);
    s.absent = true;
    run(&other);
    check_same_estimate();
}

static void check_not_finite(spoil_t what)
{
    check_spoilt(what, (auvid_real_t)NAN);
    check_spoilt(what, (auvid_real_t)INFINITY);
    check_spoilt(what, (auvid_real_t)-INFINITY);
}

static void test_an_attitude_that_is_not_finite_is_dropped(void)
{
    check_not_finite(IMU_ATTITUDE);
}

static void test_a_rate_that_is_not_finite_is_dropped(void)
{
    check_not_finite(IMU_RATE);
}

static void test_a_dvl_velocity_that_is_not_finite_is_dropped(void)
{
    check_not_finite(DVL_VALUE);
}

static void test_a_depth_that_is_not_finite_is_dropped(void)
{
    check_not_finite(DEPTH_VALUE);
}

static void test_a_gps_fix_that_is_not_finite_is_dropped(void)
{
    check_not_finite(GPS_VALUE);
}

static void test_an_applied_wrench_that_is_not_finite_is_dropped(void)
{
    check_not_finite(INPUT_WRENCH);
}

static void test_an_applied_wrench_out_of_all_proportion_is_dropped(void)
{
    check_spoilt(INPUT_WRENCH, AUVID_C(1e30)); /* its square is not finite in single precision */
}

static void test_a_thruster_command_that_is_not_finite_is_dropped(void)
{
    check_not_finite(INPUT_COMMAND);
}

static void test_an_imu_sample_from_the_past_or_of_the_same_time_is_dropped(void)
{
    check_spoilt(IMU_PAST, 0);
    check_spoilt(IMU_SAME, 0);
}

static void test_an_imu_sample_from_far_ahead_does_not_shut_out_those_that_follow(void)
{
    check_spoilt(IMU_FUTURE, 0);
}

static void test_dvl_and_depth_samples_of_a_wrong_time_are_dropped(void)
{
    check_spoilt(DVL_FUTURE, 0);
    check_spoilt(DVL_PAST, 0);
    check_spoilt(DEPTH_PAST, 0);
}

static void test_a_dvl_velocity_beyond_the_speed_limit_is_dropped(void)
{
    check_spoilt(DVL_TOO_FAST, 0);
}

static void test_outliers_are_dropped(void)
{
    check_spoilt(DVL_OUTLIER, 0);
    check_spoilt(DEPTH_OUTLIER, 0);
}

/* ---- time ---- */

/* A second step of the same time, or an earlier one, between two good ones. */
static void repeat_steps(chain_t *c, auvid_status_t status, const auvid_output_t *good)
{
    static auvid_identifier_t before;
    auvid_output_t out;
    auvid_input_t in;
    (void)status;
    (void)good;
    if (c->tick % SPOILT_EVERY != 0) {
        return;
    }
    memset(&in, 0, sizeof in);
    before = c->id;
    for (int back = 0; back < 2; ++back) {
        in.t_us = c->t_us - (back ? SIM_TICK_US : 0);
        memset(&out, 0xFF, sizeof out);
        TEST_ASSERT_EQUAL(back ? AUVID_ERR_TIME_BACK : AUVID_ERR_TIME_SAME,
                          auvid_identifier_step(&c->id, &in, &out));
        TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_TIME, out.events);
        TEST_ASSERT_TRUE(is_zero(&out));
        TEST_ASSERT_EQUAL_MEMORY(&before, &c->id, sizeof before);
    }
}

static void test_a_step_whose_time_does_not_advance_is_refused_and_changes_nothing(void)
{
    chain_set_driver(&config); /* while it excites, the guard takes it amiss */
    run(&other);
    config.after = repeat_steps;
    run(&chain);
    check_same_estimate();
}

static void test_a_step_of_zero_dt_at_the_very_beginning_is_refused(void)
{
    auvid_input_t in;
    auvid_output_t out;
    memset(&in, 0, sizeof in);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &config.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out)); /* time 0 is a time */
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_identifier_step(&chain.id, &in, &out));
}

static void test_news_wait_for_a_step_that_is_taken(void)
{
    auvid_input_t in;
    auvid_output_t out;
    chain_set_driver(&config);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain_run(&chain, 20.0);
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, auvid_identifier_close(&chain.id));
    memset(&in, 0, sizeof in);
    in.t_us = chain.t_us;
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_TIME, out.events);
    chain_tick(&chain);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_SET, chain.out.events);
}

static void test_motion_and_wrench_of_a_wrong_time_or_value_are_refused(void)
{
    static auvid_identifier_t before;
    auvid_real_t attitude[3] = {0, 0, 0}, nu[AUVID_DOF_COUNT] = {0}, tau[AUVID_DOF_COUNT] = {0};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &config.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&chain.id, 1000, attitude, nu));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, 1000, tau, NULL));
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_identifier_motion(&chain.id, 1000, attitude, nu));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, auvid_identifier_motion(&chain.id, 999, attitude, nu));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_identifier_applied(&chain.id, 1000, tau, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, auvid_identifier_applied(&chain.id, 999, tau, NULL));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        nu[j] = (auvid_real_t)NAN;
        tau[j] = (auvid_real_t)INFINITY;
        TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE,
                          auvid_identifier_motion(&chain.id, 2000, attitude, nu));
        TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE,
                          auvid_identifier_applied(&chain.id, 2000, tau, NULL));
        nu[j] = tau[j] = 0;
    }
    attitude[2] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_identifier_motion(&chain.id, 2000, attitude, nu));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
}

/* ---- gaps ---- */

typedef enum { GAP_DVL, GAP_IMU, GAP_INPUT, GAP_ALL, GAPS } gap_t;

/* Silence from 20 s to 25 s. */
static void be_silent(chain_t *c, auvid_input_t *in)
{
    gap_t gap = *(const gap_t *)c->config.context;
    if (c->tick >= 1000 && c->tick < 1250) {
        in->dvl.present = in->dvl.present && gap != GAP_DVL && gap != GAP_ALL;
        in->imu.present = in->imu.present && gap != GAP_IMU && gap != GAP_ALL;
        in->applied.present = in->applied.present && gap != GAP_INPUT && gap != GAP_ALL;
        in->depth.present = in->depth.present && gap != GAP_ALL;
    }
}

static auvid_validation_t cells;

/* Compare every cell from here on with the simulated truth. */
static void attach(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_validation_init(&cells, &auvid_girona500, auvid_girona500_paper, 0,
                                            NULL, 0, AUVID_C(0.1)));
    auvid_identifier_attach(&chain.id, &cells);
}

/* No row may be made of cells from both sides, and no integration run across. */
static void test_a_gap_of_5_s_breaks_the_record_and_identification_goes_on(void)
{
    for (gap_t gap = GAP_DVL; gap < GAPS; ++gap) {
        auvid_real_t r2[AUVID_DOF_COUNT];
        chain_defaults(&config, 11, SETS + 1, 0.0);
        chain_set_driver(&config);
        config.before = be_silent;
        config.context = &gap;
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
        attach();
        chain_run(&chain, 19.0);
        TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_GAP);
        chain_run(&chain, 8.0);
        TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_GAP, chain.events & AUVID_EVENT_GAP);
        chain_run(&chain, 17.0); /* a set is 30 s; the gap 5; before each piece 5 of the filter */
        TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_SET);
        chain.events = 0;
        chain_run(&chain, 33.0);
        finish(&chain);
        TEST_ASSERT_EQUAL_HEX32(0, chain.events & (AUVID_EVENT_GAP | ALL_DROPPED));
        TEST_ASSERT_EQUAL_UINT32(SETS, chain.id.estimate.sets);
        TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, chain.id.estimate.identified);
        check_masses(&chain);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&cells, r2));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            bool driven = j != AUVID_ROLL && j != AUVID_PITCH;
            TEST_ASSERT_TRUE(!driven || r2[j] > AUVID_C(0.98));
        }
    }
}

/* No tick at all for 5 s, while the vehicle goes on. */
static void test_ticks_left_out_for_5_s_are_a_gap(void)
{
    sim_output_t seen;
    const double hover[AUVID_DOF_COUNT] = {0, 0, -config.sim.parameter[SIM_WB], 0, 0, 0};
    chain_defaults(&config, 11, SETS + 1, 0.0);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain_run(&chain, 20.0);
    for (int k = 0; k < 250; ++k) {
        sim_step(&chain.sim, NULL, hover, &seen);
    }
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_GAP, chain.events & AUVID_EVENT_GAP);
    chain_run(&chain, 55.0);
    finish(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.id.guard.state); /* what follows is idle */
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.sets);
    check_masses(&chain);
}

/* ---- nothing to work on ---- */

static void test_an_empty_set_cannot_be_closed(void)
{
    static auvid_identifier_t before;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_identifier_close(&chain.id));
    chain_run(&chain, 2.0); /* cells, but no row yet */
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_identifier_close(&chain.id));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_work(&chain.id, 100));
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.work_last);
}

static void test_a_set_may_be_closed_early(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain_run(&chain, 25.0);
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, auvid_identifier_close(&chain.id));
    finish(&chain);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, chain.id.estimate.identified);
    chain_tick(&chain);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_SET | AUVID_EVENT_ESTIMATE, chain.out.events);
}

/* One more set is recorded, and left out. */
static void check_idle_set(void)
{
    uint32_t number = chain.id.estimate.number;
    do {
        chain_tick(&chain);
    } while (!(chain.out.events & AUVID_EVENT_SET));
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_SET | AUVID_EVENT_NOT_DRIVEN, chain.out.events);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_work(&chain.id, 1000));
    TEST_ASSERT_EQUAL_UINT32(number, chain.id.estimate.number);
    chain_tick(&chain);
    TEST_ASSERT_EQUAL_HEX32(0, chain.out.events);
}

static void test_sets_in_which_nothing_is_driven_are_not_searched(void)
{
    auvid_excitation_defaults(&config.id.excitation); /* hovers */
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    check_idle_set();
    chain_run(&chain, 25.0);
    TEST_ASSERT_EQUAL(AUVID_SET_IDLE, auvid_identifier_close(&chain.id));
}

static void test_an_idle_vehicle_keeps_what_it_has_learnt(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &config, SETS));
    chain_run(&chain, 40.0); /* the set in which the excitation ends */
    finish(&chain);
    for (int k = 0; k <= AUVID_MAX_SETS; ++k) {
        check_idle_set();
    }
    auvid_metric_merge_begin(&chain.id.metric);
    uint32_t budget = UINT32_MAX;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&chain.id.metric, &budget));
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, auvid_metric_active(&chain.id.metric));
}

static void test_drive_without_a_free_parameter_is_not_searched(void)
{
    config.id.metric.free = 1u << AUVID_G500_M_R | 1u << AUVID_G500_N_R; /* yaw's alone */
    config.id.excitation.segments = 2;                                   /* surge alone */
    TEST_ASSERT_EQUAL(AUVID_SURGE, config.id.excitation.segment[0].dof);
    TEST_ASSERT_EQUAL(AUVID_SURGE, config.id.excitation.segment[1].dof);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    check_idle_set();
}

static void stand_still(chain_t *c, auvid_input_t *in)
{
    (void)c;
    memset(in->dvl.sample.velocity, 0, sizeof in->dvl.sample.velocity);
}

static void test_a_velocity_that_stands_at_zero_identifies_nothing(void)
{
    const uint32_t yaw = 1u << AUVID_G500_M_R | 1u << AUVID_G500_N_R | 1u << AUVID_G500_N_RR;
    config.before = stand_still;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &config, SETS));
    finish(&chain);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_HEX32(0, chain.id.estimate.confidence.identifiable & ~yaw);
}

/* ---- configurations that are refused ---- */

static void check_init(auvid_status_t status)
{
    TEST_ASSERT_EQUAL(status, auvid_identifier_init(&chain.id, &config.id));
    chain_defaults(&config, 11, SETS, 0.0);
}

static void test_bounds_reversed_or_equal_are_refused(void)
{
    config.id.search.lower[3] = 10;
    config.id.search.upper[3] = -10;
    check_init(AUVID_ERR_BOUNDS);
    config.id.search.lower[3] = config.id.search.upper[3];
    check_init(AUVID_ERR_BOUNDS);
    config.id.search.lower[3] = (auvid_real_t)NAN;
    check_init(AUVID_ERR_NOT_FINITE);
    config.id.search.upper[3] = (auvid_real_t)INFINITY;
    check_init(AUVID_ERR_NOT_FINITE);
    config.id.search.upper[3] = AUVID_C(1e30);
    check_init(AUVID_ERR_RANGE);
    config.id.search.lower[AUVID_G500_X_0] = 10; /* not free: not looked at */
    config.id.search.upper[AUVID_G500_X_0] = -10;
    check_init(AUVID_OK);
}

static void test_a_population_too_small_or_too_large_is_refused(void)
{
    config.id.search.population = 13; /* 13 parameters want 14 */
    check_init(AUVID_ERR_POPULATION);
    config.id.search.population = AUVID_MAX_POPULATION + 1;
    check_init(AUVID_ERR_POPULATION);
    config.id.search.population = 14;
    check_init(AUVID_OK);
    config.id.search.population = AUVID_MAX_POPULATION;
    check_init(AUVID_OK);
}

static void test_an_omega_or_a_good_point_that_cannot_be_is_refused(void)
{
    config.id.search.omega = (auvid_real_t)NAN;
    check_init(AUVID_ERR_NOT_FINITE);
    config.id.search.omega = AUVID_C(1e12);
    check_init(AUVID_ERR_RANGE);
    config.id.search.omega = -1;
    check_init(AUVID_ERR_RANGE);
    config.id.search.has_good = true;
    config.id.search.good[12] = (auvid_real_t)NAN;
    check_init(AUVID_ERR_NOT_FINITE);
    config.id.search.good[12] = (auvid_real_t)NAN; /* not used */
    check_init(AUVID_OK);
}

static void no_residual(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                        auvid_real_t *e)
{
    (void)context;
    (void)sample;
    (void)pi;
    (void)e;
}

static void test_too_many_parameters_or_none_are_refused(void)
{
    static auvid_row_t row[2 * 60];
    static auvid_parameter_t parameter[AUVID_MAX_PARAMETERS + 1];
    auvid_vehicle_t vehicle = {.name = "large",
                               .parameters = AUVID_MAX_PARAMETERS + 1,
                               .parameter = parameter,
                               .columns = {[AUVID_SURGE] = (1u << AUVID_MAX_PARAMETERS) - 1},
                               .residual = no_residual};
    auvid_identifier_defaults(&config.id, &vehicle);
    check_init(AUVID_ERR_PARAMETERS);
    for (int delay = 0; delay < 2; ++delay) { /* the delay is one more */
        vehicle.parameters = AUVID_MAX_PARAMETERS;
        auvid_identifier_defaults(&config.id, &vehicle);
        config.id.metric.sets = 1;
        config.id.metric.rows = row;
        config.id.metric.estimate_delay = delay;
        check_init(delay ? AUVID_ERR_PARAMETERS : AUVID_OK);
    }
    config.id.metric.free = 1u << 31;
    check_init(AUVID_ERR_PARAMETERS);
    config.id.vehicle = NULL;
    check_init(AUVID_ERR_NULL);
}

static void test_an_excitation_above_the_thrusters_limit_is_refused(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {400, 0, 0, 0, 0, 0};
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&config.id.excitation, amplitude, CHAIN_SET_S, 1, 1));
    chain_config_t wanted = config;
    check_init(AUVID_ERR_LIMIT);
    config = wanted;
    config.id.allocation.thrusters = 0; /* no thrusters known: no limit */
    check_init(AUVID_OK);
}

static void test_what_the_modules_refuse_is_refused(void)
{
    config.id.nav.sigma_dvl = 0;
    check_init(AUVID_ERR_RANGE);
    config.id.recorder.cell_us = 10;
    check_init(AUVID_ERR_RANGE);
    config.id.metric.passes = 0;
    check_init(AUVID_ERR_RANGE);
    config.id.excitation.segments = AUVID_MAX_SEGMENTS + 1;
    check_init(AUVID_ERR_SIZE);
    config.id.allocation.thrusters = AUVID_MAX_THRUSTERS + 1;
    check_init(AUVID_ERR_SIZE);
}

static void test_another_arithmetic_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(0, fesetround(FE_UPWARD));
    auvid_status_t status = auvid_identifier_init(&chain.id, &config.id);
    TEST_ASSERT_EQUAL_INT(0, fesetround(FE_TONEAREST));
    TEST_ASSERT_EQUAL(AUVID_ERR_ARITHMETIC, status);
}

static void test_a_velocity_source_that_cannot_be_is_refused(void)
{
    config.id.velocity = (auvid_velocity_source_t)2;
    check_init(AUVID_ERR_RANGE);
    config.id.velocity = AUVID_VELOCITY_WATER;
    config.id.velocity_every_tick = true;
    check_init(AUVID_ERR_RANGE);
}

static void check_refuses_all(void)
{
    auvid_real_t x[AUVID_DOF_COUNT] = {0};
    auvid_input_t in;
    auvid_output_t out;
    memset(&in, 0, sizeof in);
    in.t_us = 1;
    in.applied.present = true;
    other = chain;
    memset(&out, 0xFF, sizeof out);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL_HEX32(0, out.events);
    TEST_ASSERT_TRUE(is_zero(&out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_stop(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_abort(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_disarm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_motion(&chain.id, 1, x, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_applied(&chain.id, 1, x, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_close(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_work(&chain.id, 1));
    TEST_ASSERT_EQUAL_MEMORY(&other.id, &chain.id, sizeof chain.id);
}

static void test_an_identifier_that_is_not_initialised_refuses_everything(void)
{
    memset(&chain.id, 0, sizeof chain.id);
    check_refuses_all();
    memset(&chain.id, 0xFF, sizeof chain.id);
    config.id.search.omega = -1; /* refused first of all */
    check_init(AUVID_ERR_RANGE);
    check_refuses_all();
    memset(&chain.id, 0xFF, sizeof chain.id);
    config.id.allocation.thrusters = AUVID_MAX_THRUSTERS + 1; /* refused last */
    check_init(AUVID_ERR_SIZE);
    check_refuses_all();
}

static void test_the_metric_has_the_recorders_cell(void)
{
    config.id.recorder.cell_us = 50000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &config.id));
    TEST_ASSERT_EQUAL_UINT32(50000, chain.id.metric.cfg.cell_us);
}

/* ---- null pointers ---- */

static void test_null_pointers_are_refused_and_outputs_written(void)
{
    auvid_real_t x[AUVID_DOF_COUNT] = {0};
    auvid_input_t in;
    auvid_output_t out;
    memset(&in, 0, sizeof in);
    in.t_us = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &config.id));
    other = chain;
    auvid_identifier_defaults(NULL, &auvid_girona500);
    auvid_identifier_literal(NULL);
    auvid_identifier_attach(NULL, NULL);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_init(NULL, &config.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_init(&chain.id, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_excite(NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_stop(NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_arm(NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_abort(NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_disarm(NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_close(NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_work(NULL, 1));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_motion(NULL, 1, x, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_motion(&chain.id, 1, NULL, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_motion(&chain.id, 1, x, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_applied(NULL, 1, x, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_applied(&chain.id, 1, NULL, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_step(&chain.id, &in, NULL));
    memset(&out, 0xFF, sizeof out);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_step(NULL, &in, &out));
    TEST_ASSERT_EQUAL_HEX32(0, out.events);
    TEST_ASSERT_TRUE(is_zero(&out));
    memset(&out, 0xFF, sizeof out);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_step(&chain.id, NULL, &out));
    TEST_ASSERT_EQUAL_HEX32(0, out.events);
    TEST_ASSERT_TRUE(is_zero(&out));
    TEST_ASSERT_EQUAL_MEMORY(&other.id, &chain.id, sizeof chain.id);
}

/* ---- excitation ---- */

static void test_excitation_is_zero_until_it_is_asked_for(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain.waiting = false;
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_stop(&chain.id)); /* before it has begun */
    chain_tick(&chain);
    TEST_ASSERT_TRUE(chain.out.events & AUVID_EVENT_EXCITATION_DONE);
    for (int k = 0; k < 250; ++k) {
        TEST_ASSERT_TRUE(is_zero(&chain.out));
        chain_tick(&chain);
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id));
    chain_run(&chain, 5.0);
    TEST_ASSERT_FALSE(is_zero(&chain.out));
}

/* Largest change of the excitation from tick to tick, as a part of the amplitude. */
static double step_of(const auvid_real_t *before, const auvid_real_t *now)
{
    static const double amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 1, 1, 40};
    double most = 0.0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (j != AUVID_ROLL && j != AUVID_PITCH) {
            most = fmax(most, fabs((double)now[j] - (double)before[j]) / amplitude[j]);
        }
    }
    return most;
}

/* The run's fade is a raised cosine of fade_s: its steepest part is pi / 2 / fade_s. Sines move by
 * 2 pi 0.28 Hz at most besides (the segments' own changes are not in this set). */
static void test_stop_fades_the_excitation_out(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&config.id.excitation, amplitude, CHAIN_SET_S, 2, 1));
    double fade_s = (double)config.id.excitation.fade_s, tick_s = 1e-6 * SIM_TICK_US;
    double steepest = tick_s * (3.1416 / 2.0 / fade_s + 2.0 * 3.1416 * 0.28);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain_run(&chain, 40.0); /* in the sines of the second set */
    TEST_ASSERT_FALSE(is_zero(&chain.out));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_stop(&chain.id));
    for (int k = 1; (double)k * tick_s <= fade_s + 0.1; ++k) {
        auvid_output_t before = chain.out;
        chain_tick(&chain);
        TEST_ASSERT_TRUE(step_of(before.excitation, chain.out.excitation) <= steepest);
        TEST_ASSERT_TRUE((double)k * tick_s > fade_s - 0.5 || !is_zero(&chain.out));
    }
    TEST_ASSERT_TRUE(is_zero(&chain.out));
    TEST_ASSERT_TRUE(chain.events & AUVID_EVENT_EXCITATION_DONE);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_stop(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_disarm(&chain.id)); /* not waiting for calm */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id)); /* it may begin again */
    chain_run(&chain, 5.0);
    TEST_ASSERT_FALSE(is_zero(&chain.out));
}

static void test_the_excitation_ends_by_itself(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain_run(&chain, SETS * CHAIN_SET_S - 1.0);
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_EXCITATION_DONE);
    chain_run(&chain, 2.0);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_EXCITATION_DONE,
                            chain.events & AUVID_EVENT_EXCITATION_DONE);
    TEST_ASSERT_TRUE(is_zero(&chain.out));
}

static void test_a_passive_identifier_cannot_excite(void)
{
    chain_set_driver(&config);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_stop(&chain.id));
}

static void test_the_wrench_told_is_that_of_the_thrusters_told(void)
{
    auvid_real_t wrench[AUVID_DOF_COUNT];
    double roll = 0.0;
    /* a side thruster above the centre: roll comes along with sway */
    config.id.allocation.thruster[4].wrench[AUVID_ROLL] = AUVID_C(0.1);
    config.id.allocation.dofs = (uint8_t)~AUVID_DOF_BIT(AUVID_ROLL) & 0x3Fu;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    for (int k = 0; k < 1000; ++k) {
        chain_tick(&chain);
        TEST_ASSERT_EQUAL(
            AUVID_OK, auvid_allocation_wrench(&chain.id.allocation, chain.out.thruster_N, wrench));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)wrench[j], (double)chain.out.excitation[j]);
        }
        roll += fabs((double)chain.out.excitation[AUVID_ROLL]);
    }
    TEST_ASSERT_TRUE(roll > 0.0);
}

/* ---- cells ---- */

static void count_cells(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    uint32_t *last = c->config.context;
    (void)status;
    (void)out;
    TEST_ASSERT_TRUE(cells.cells - *last <= AUVID_CELLS_PER_STEP);
    *last = cells.cells;
}

/* DVL samples 0.4 s apart, and late, make several cells complete at once. */
static void test_a_step_takes_no_more_cells_than_it_says(void)
{
    uint32_t last = 0;
    chain_set_driver(&config);
    config.sim.sensor[SIM_DVL].rate_hz = 2.5;
    config.sim.sensor[SIM_DVL].age_s = 0.1;
    config.after = count_cells;
    config.context = &last;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    attach();
    chain_run(&chain, 30.0);
    TEST_ASSERT_TRUE(cells.cells > 270); /* and it keeps up: of 300, less both ends */
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_GAP);
    auvid_identifier_attach(&chain.id, NULL);
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL_UINT32(last, cells.cells);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_same_inputs_give_the_same_bits);
    RUN_TEST(test_interleaved_identifiers_do_not_interact);
    RUN_TEST(test_a_copy_of_an_identifier_goes_on_identically);
    RUN_TEST(test_the_applied_wrench_may_come_with_the_step_or_apart);
    RUN_TEST(test_motion_from_elsewhere_gives_the_same_as_the_sensors_it_came_from);
    RUN_TEST(test_the_clock_may_begin_anywhere);
    RUN_TEST(test_an_attitude_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_rate_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_dvl_velocity_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_depth_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_gps_fix_that_is_not_finite_is_dropped);
    RUN_TEST(test_an_applied_wrench_that_is_not_finite_is_dropped);
    RUN_TEST(test_an_applied_wrench_out_of_all_proportion_is_dropped);
    RUN_TEST(test_a_thruster_command_that_is_not_finite_is_dropped);
    RUN_TEST(test_an_imu_sample_from_the_past_or_of_the_same_time_is_dropped);
    RUN_TEST(test_an_imu_sample_from_far_ahead_does_not_shut_out_those_that_follow);
    RUN_TEST(test_dvl_and_depth_samples_of_a_wrong_time_are_dropped);
    RUN_TEST(test_a_dvl_velocity_beyond_the_speed_limit_is_dropped);
    RUN_TEST(test_outliers_are_dropped);
    RUN_TEST(test_a_step_whose_time_does_not_advance_is_refused_and_changes_nothing);
    RUN_TEST(test_a_step_of_zero_dt_at_the_very_beginning_is_refused);
    RUN_TEST(test_news_wait_for_a_step_that_is_taken);
    RUN_TEST(test_motion_and_wrench_of_a_wrong_time_or_value_are_refused);
    RUN_TEST(test_a_gap_of_5_s_breaks_the_record_and_identification_goes_on);
    RUN_TEST(test_ticks_left_out_for_5_s_are_a_gap);
    RUN_TEST(test_an_empty_set_cannot_be_closed);
    RUN_TEST(test_a_set_may_be_closed_early);
    RUN_TEST(test_sets_in_which_nothing_is_driven_are_not_searched);
    RUN_TEST(test_an_idle_vehicle_keeps_what_it_has_learnt);
    RUN_TEST(test_a_velocity_that_stands_at_zero_identifies_nothing);
    RUN_TEST(test_drive_without_a_free_parameter_is_not_searched);
    RUN_TEST(test_bounds_reversed_or_equal_are_refused);
    RUN_TEST(test_a_population_too_small_or_too_large_is_refused);
    RUN_TEST(test_an_omega_or_a_good_point_that_cannot_be_is_refused);
    RUN_TEST(test_too_many_parameters_or_none_are_refused);
    RUN_TEST(test_an_excitation_above_the_thrusters_limit_is_refused);
    RUN_TEST(test_what_the_modules_refuse_is_refused);
    RUN_TEST(test_another_arithmetic_is_refused);
    RUN_TEST(test_a_velocity_source_that_cannot_be_is_refused);
    RUN_TEST(test_an_identifier_that_is_not_initialised_refuses_everything);
    RUN_TEST(test_the_metric_has_the_recorders_cell);
    RUN_TEST(test_null_pointers_are_refused_and_outputs_written);
    RUN_TEST(test_excitation_is_zero_until_it_is_asked_for);
    RUN_TEST(test_stop_fades_the_excitation_out);
    RUN_TEST(test_the_excitation_ends_by_itself);
    RUN_TEST(test_a_passive_identifier_cannot_excite);
    RUN_TEST(test_the_wrench_told_is_that_of_the_thrusters_told);
    RUN_TEST(test_a_step_takes_no_more_cells_than_it_says);
    return UNITY_END();
}
