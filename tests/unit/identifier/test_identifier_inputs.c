/*
 * Bad inputs of the identifier are refused or dropped with the right status or event, without any
 * other effect.
 */
#include <math.h>
#include <string.h>

#include "two_sets.h"
#include "unity.h"

#define ALL_DROPPED                                                                                \
    (AUVID_EVENT_IMU_DROPPED | AUVID_EVENT_DVL_DROPPED | AUVID_EVENT_DEPTH_DROPPED |               \
     AUVID_EVENT_GPS_DROPPED | AUVID_EVENT_INPUT_DROPPED | AUVID_EVENT_TIME)

enum { SPOILT_EVERY = 250 }; /* ticks; a multiple of the DVL's period */

void setUp(void)
{
    two_sets_defaults();
}

void tearDown(void)
{
}

static void check_masses(const chain_t *c)
{
    for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
        TEST_ASSERT_TRUE(fabs(chain_error(c, i)) < 0.10);
    }
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
    DVL_SOON,
    DVL_PAST,
    DVL_TOO_FAST,
    DVL_OUTLIER,
    DEPTH_VALUE,
    DEPTH_SOON,
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
    [DVL_SOON] = AUVID_EVENT_DVL_DROPPED,        [DEPTH_SOON] = AUVID_EVENT_DEPTH_DROPPED,
    [DVL_TOO_FAST] = AUVID_EVENT_DVL_DROPPED,    [DVL_OUTLIER] = AUVID_EVENT_DVL_DROPPED,
    [DEPTH_VALUE] = AUVID_EVENT_DEPTH_DROPPED,   [DEPTH_PAST] = AUVID_EVENT_DEPTH_DROPPED,
    [DEPTH_OUTLIER] = AUVID_EVENT_DEPTH_DROPPED, [GPS_VALUE] = AUVID_EVENT_GPS_DROPPED,
    [INPUT_WRENCH] = AUVID_EVENT_INPUT_DROPPED,  [INPUT_COMMAND] = AUVID_EVENT_INPUT_DROPPED,
};

typedef struct {
    spoil_t what;
    auvid_real_t value;
    bool absent; /* omit the sample instead */
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
    case DVL_SOON: /* within the time for which it may be held */
        in->dvl.sample.t_us += 2 * SIM_TICK_US;
        break;
    case DEPTH_SOON:
        in->depth.t_us += 2 * SIM_TICK_US;
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

/* Spoil the sample periodically, or omit it. */
static void spoil(chain_t *c, auvid_input_t *in)
{
    spoiler_t *s = c->cfg.context;
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

/* The event comes in the same tick, and only that one; all else is as without the sample. */
static void expect_event(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    const spoiler_t *s = c->cfg.context;
    bool now = c->tick % SPOILT_EVERY == 0 && !s->absent;
    TEST_ASSERT_EQUAL(AUVID_OK, status);
    TEST_ASSERT_EQUAL_HEX32(now ? expected_event[s->what] : 0, out->events & ALL_DROPPED);
}

static void check_spoilt(spoil_t what, auvid_real_t value)
{
    spoiler_t s = {what, value, false, 0, 0};
    two_sets_defaults();
    chain_set_driver(&cfg);
    cfg.before = spoil;
    cfg.after = expect_event;
    cfg.context = &s;
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

static void test_an_excessive_applied_wrench_is_dropped(void)
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

static void test_an_imu_sample_from_far_ahead_does_not_block_those_that_follow(void)
{
    check_spoilt(IMU_FUTURE, 0);
}

static void test_dvl_and_depth_samples_of_a_wrong_time_are_dropped(void)
{
    check_spoilt(DVL_FUTURE, 0);
    check_spoilt(DVL_SOON, 0);
    check_spoilt(DEPTH_SOON, 0);
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

/* A step of the same or an earlier time between two good ones. */
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
    chain_set_driver(&cfg); /* during an excitation the guard would abort */
    run(&other);
    cfg.after = repeat_steps;
    run(&chain);
    check_same_estimate();
}

static void test_a_step_of_zero_dt_at_the_very_beginning_is_refused(void)
{
    auvid_input_t in;
    auvid_output_t out;
    memset(&in, 0, sizeof in);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out)); /* time 0 is valid */
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_identifier_step(&chain.id, &in, &out));
}

static void test_events_wait_for_the_next_accepted_step(void)
{
    auvid_input_t in;
    auvid_output_t out;
    chain_set_driver(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
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
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
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
    nu[3] = tau[5] = AUVID_C(1.01) * AUVID_RECORDER_LARGEST;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_motion(&chain.id, 2000, attitude, nu));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_applied(&chain.id, 2000, tau, NULL));
    nu[3] = tau[5] = 0;
    attitude[2] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_identifier_motion(&chain.id, 2000, attitude, nu));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
}

/* With steps in between, one of the two may be further ahead than the other. */
static void test_motion_is_refused_as_a_whole_if_one_half_is(void)
{
    static auvid_identifier_t before;
    const auvid_real_t attitude[3] = {0, 0, 0}, nu[AUVID_DOF_COUNT] = {0};
    for (int ahead = 0; ahead < 2; ++ahead) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&chain.id, 1000, attitude, nu));
        if (ahead) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_velocity(&chain.id.recorder, 3000, nu, 7u));
        } else {
            TEST_ASSERT_EQUAL(AUVID_OK,
                              auvid_recorder_attitude(&chain.id.recorder, 3000, attitude, nu));
        }
        before = chain.id;
        TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK,
                          auvid_identifier_motion(&chain.id, 2000, attitude, nu));
        TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME,
                          auvid_identifier_motion(&chain.id, 3000, attitude, nu));
        TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&chain.id, 3001, attitude, nu));
    }
}

static void test_attitude_and_velocity_apart_record_the_bits_of_motion(void)
{
    static auvid_identifier_t together;
    const auvid_real_t tau[AUVID_DOF_COUNT] = {AUVID_C(10.0)};
    auvid_real_t attitude[3] = {0}, nu[AUVID_DOF_COUNT] = {0};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&together, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    for (uint64_t t_us = 20000; t_us < 10000000; t_us += 20000) {
        nu[AUVID_SURGE] += AUVID_C(0.001);
        attitude[2] = nu[AUVID_YAW] += AUVID_C(0.0001);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&together, t_us, attitude, nu));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&together, t_us, tau, NULL));
        TEST_ASSERT_EQUAL(
            AUVID_OK, auvid_identifier_attitude(&chain.id, t_us, attitude, nu + AUVID_ROLL));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_velocity(&chain.id, t_us, nu, 7u));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, t_us, tau, NULL));
    }
    TEST_ASSERT_EQUAL_MEMORY(&together.recorder, &chain.id.recorder, sizeof chain.id.recorder);
    TEST_ASSERT_EQUAL_MEMORY(&together.metric, &chain.id.metric, sizeof chain.id.metric);
}

static void test_attitude_and_velocity_apart_may_have_different_rates(void)
{
    const auvid_real_t zero[AUVID_DOF_COUNT] = {0};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    for (uint64_t t_us = 20000; t_us < 4000000; t_us += 20000) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attitude(&chain.id, t_us, zero, zero));
        if (t_us % 200000 == 0) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_velocity(&chain.id, t_us, zero, 7u));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, t_us, zero, NULL));
        }
    }
    TEST_ASSERT_EQUAL_UINT32(200000, chain.id.recorder.velocity_us);
    TEST_ASSERT_TRUE(chain.id.recorder.next > 30); /* cells of 0.1 s were taken */
}

static void test_attitude_and_velocity_of_a_wrong_time_or_value_are_refused(void)
{
    static auvid_identifier_t before;
    auvid_real_t x[3] = {0, 0, 0};
    const auvid_real_t zero[3] = {0, 0, 0};
    auvid_identifier_t *id = &chain.id;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attitude(id, 1000, x, x));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_velocity(id, 1000, x, 7u));
    before = *id;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attitude(NULL, 2000, x, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attitude(id, 2000, NULL, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attitude(id, 2000, x, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_velocity(NULL, 2000, x, 7u));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_velocity(id, 2000, NULL, 7u));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_identifier_attitude(id, 1000, x, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, auvid_identifier_attitude(id, 999, x, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_identifier_velocity(id, 1000, x, 7u));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, auvid_identifier_velocity(id, 999, x, 7u));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_velocity(id, 2000, x, 8u));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_identifier_velocity(id, 2000, x, 0u));
    x[1] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_identifier_attitude(id, 2000, zero, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_identifier_velocity(id, 2000, x, 2u));
    x[1] = AUVID_C(1.01) * AUVID_RECORDER_LARGEST;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_attitude(id, 2000, x, zero));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_velocity(id, 2000, x, 2u));
    TEST_ASSERT_EQUAL_MEMORY(&before, id, sizeof before);
    memset(id, 0, sizeof *id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_attitude(id, 2000, zero, zero));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_velocity(id, 2000, zero, 7u));
}

/* ---- an IMU that is later than the other sensors ---- */

enum { LATE_TICKS = 5 };

typedef struct {
    uint32_t dvl; /* samples sent */
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t attitude[3], rates[3];
    } past[LATE_TICKS];
} late_t;

/* The IMU's sample of five ticks ago. */
static void delay_imu(chain_t *c, auvid_input_t *in)
{
    late_t *late = c->cfg.context;
    auvid_input_t now = *in;
    int slot = (int)(c->tick % LATE_TICKS);
    late->dvl += in->dvl.present;
    in->imu.present = late->past[slot].present;
    in->imu.t_us = late->past[slot].t_us;
    memcpy(in->imu.attitude, late->past[slot].attitude, sizeof in->imu.attitude);
    memcpy(in->imu.rates, late->past[slot].rates, sizeof in->imu.rates);
    late->past[slot].present = now.imu.present;
    late->past[slot].t_us = now.imu.t_us;
    memcpy(late->past[slot].attitude, now.imu.attitude, sizeof now.imu.attitude);
    memcpy(late->past[slot].rates, now.imu.rates, sizeof now.imu.rates);
}

static void test_an_imu_that_is_100_ms_late_loses_no_sample_of_the_others(void)
{
    late_t late = {0};
    cfg.before = delay_imu;
    cfg.context = &late;
    cfg.budget = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.15); /* before the first IMU sample no other is accepted */
    chain.events = late.dvl = 0;
    chain_run(&chain, 30.1);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & (ALL_DROPPED | AUVID_EVENT_GAP));
    const auvid_nav_t *nav = &chain.id.nav;
    TEST_ASSERT_TRUE(late.dvl >= 150);
    TEST_ASSERT_EQUAL_UINT32(late.dvl - 1, nav->diagnostics[AUVID_NAV_DVL_BOTTOM].accepted);
    TEST_ASSERT_EQUAL_UINT32(late.dvl - 1, nav->ground.sequence); /* the last is held */
    TEST_ASSERT_EQUAL_UINT(0, nav->diagnostics[AUVID_NAV_DVL_BOTTOM].unused);
    TEST_ASSERT_EQUAL_UINT32(nav->ground.sequence, chain.id.last_sample);
}

/* A step with an IMU sample of imu_us, and a DVL sample of dvl_us if that is not 0. */
static uint32_t step_at(uint64_t t_us, uint64_t imu_us, uint64_t dvl_us, double u)
{
    auvid_input_t in;
    auvid_output_t out;
    memset(&in, 0, sizeof in);
    in.t_us = t_us;
    in.imu.present = true;
    in.imu.t_us = imu_us;
    in.dvl.present = dvl_us != 0;
    in.dvl.sample.t_us = dvl_us;
    in.dvl.sample.velocity[0] = (auvid_real_t)u;
    in.dvl.sample.valid = AUVID_DVL_ALL;
    in.applied.present = true;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    return out.events;
}

static void test_a_held_sample_that_is_refused_is_an_event_when_the_imu_comes_to_it(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL_HEX32(0, step_at(1000000, 1000000, 1000000, 0) & ALL_DROPPED);
    TEST_ASSERT_EQUAL_HEX32(0, step_at(1100000, 1020000, 1100000, 2.9) & ALL_DROPPED);
    TEST_ASSERT_EQUAL_HEX32(0, step_at(1120000, 1040000, 0, 0) & ALL_DROPPED);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_DVL_DROPPED, step_at(1180000, 1100000, 0, 0) & ALL_DROPPED);
    TEST_ASSERT_EQUAL_UINT(1, chain.id.nav.diagnostics[AUVID_NAV_DVL_BOTTOM].gated);
    TEST_ASSERT_EQUAL_HEX32(0, step_at(1200000, 1120000, 0, 0) & ALL_DROPPED);
}

/* The IMU catches up in one step: a held sample and one of this tick are used together. Without the
 * held one the record would have a gap. */
static void test_a_held_sample_and_the_next_one_are_both_recorded(void)
{
    uint32_t events = 0;
    cfg.id.recorder.gap_us = 150000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    for (uint64_t k = 0; k <= 5; ++k) {
        uint64_t t = 1000000 + 100000 * k;
        (void)step_at(t, t, t, 0);
    }
    events |= step_at(1580000, 1520000, 0, 0);
    events |= step_at(1600000, 1540000, 1600000, 0);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_NAV_DVL_BOTTOM, chain.id.nav.held.sensors);
    events |= step_at(1690000, 1690000, 1690000, 0);
    events |= step_at(1790000, 1790000, 1790000, 0);
    TEST_ASSERT_EQUAL_UINT32(9, chain.id.nav.ground.sequence);
    TEST_ASSERT_EQUAL_HEX32(0, events & (AUVID_EVENT_GAP | ALL_DROPPED));
}

/* ---- gaps ---- */

typedef enum { GAP_DVL, GAP_IMU, GAP_INPUT, GAP_ALL, GAPS } gap_t;

/* No samples from 20 s to 25 s. */
static void drop_all_samples(chain_t *c, auvid_input_t *in)
{
    gap_t gap = *(const gap_t *)c->cfg.context;
    if (c->tick >= 1000 && c->tick < 1250) {
        in->dvl.present = in->dvl.present && gap != GAP_DVL && gap != GAP_ALL;
        in->imu.present = in->imu.present && gap != GAP_IMU && gap != GAP_ALL;
        in->applied.present = in->applied.present && gap != GAP_INPUT && gap != GAP_ALL;
        in->depth.present = in->depth.present && gap != GAP_ALL;
    }
}

static auvid_validation_t cells;

/* Compare every subsequent cell with the simulated truth. */
static void attach(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_validation_init(&cells, &auvid_girona500, auvid_girona500_paper, 0,
                                            NULL, 0, AUVID_C(0.1)));
    auvid_identifier_attach(&chain.id, &cells);
}

/* No row may contain cells from both sides of the gap, and no integration may cross it. */
static void test_a_gap_of_5_s_breaks_the_record_and_identification_continues(void)
{
    for (gap_t gap = GAP_DVL; gap < GAPS; ++gap) {
        auvid_real_t r2[AUVID_DOF_COUNT];
        chain_defaults(&cfg, 11, SETS + 1, 0.0);
        chain_set_driver(&cfg);
        cfg.before = drop_all_samples;
        cfg.context = &gap;
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
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
            bool excited = j != AUVID_ROLL && j != AUVID_PITCH;
            TEST_ASSERT_TRUE(!excited || r2[j] > AUVID_C(0.98));
        }
    }
}

/* No tick for 5 s, while the vehicle continues to move. */
static void test_ticks_left_out_for_5_s_are_a_gap(void)
{
    sim_output_t seen;
    const double hover[AUVID_DOF_COUNT] = {0, 0, -cfg.sim.parameter[SIM_WB], 0, 0, 0};
    chain_defaults(&cfg, 11, SETS + 1, 0.0);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 20.0);
    for (int k = 0; k < 250; ++k) {
        sim_step(&chain.sim, NULL, hover, &seen);
    }
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_GAP, chain.events & AUVID_EVENT_GAP);
    chain_run(&chain, 55.0);
    finish(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED,
                      chain.actuation.guard.state); /* no excitation from now on */
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.sets);
    check_masses(&chain);
}

/* ---- NULL pointers ---- */

static void test_null_pointers_are_refused_and_outputs_written(void)
{
    auvid_real_t x[AUVID_DOF_COUNT] = {0};
    auvid_input_t in;
    auvid_output_t out;
    memset(&in, 0, sizeof in);
    in.t_us = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    other = chain;
    auvid_identifier_defaults(NULL, &auvid_girona500);
    auvid_identifier_attach(NULL, NULL);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_init(NULL, &cfg.id));
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

/* ---- cells ---- */

static void count_cells(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    uint32_t *last = c->cfg.context;
    (void)status;
    (void)out;
    TEST_ASSERT_TRUE(cells.cells - *last <= AUVID_CELLS_PER_STEP);
    *last = cells.cells;
}

/* DVL samples 0.4 s apart, and late, make several cells complete at once. */
static void test_a_step_takes_no_more_cells_than_it_says(void)
{
    uint32_t last = 0;
    chain_set_driver(&cfg);
    cfg.sim.sensor[SIM_DVL].rate_hz = 2.5;
    cfg.sim.sensor[SIM_DVL].age_s = 0.1;
    cfg.id.metric.velocity_us = 400000;
    cfg.after = count_cells;
    cfg.context = &last;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    attach();
    chain_run(&chain, 30.0);
    TEST_ASSERT_TRUE(cells.cells > 270); /* it keeps up: of 300, less both ends */
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_GAP);
    auvid_identifier_attach(&chain.id, NULL);
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL_UINT32(last, cells.cells);
}

/* ---- period of the velocity samples ---- */

static void test_the_period_of_the_dvl_is_observed_and_no_cell_is_lost_at_5_hz(void)
{
    chain_set_driver(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    cfg.id.metric.velocity_us = 200000;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&other, &cfg));
    chain_run(&chain, 20.0);
    chain_run(&other, 20.0);
    other.id.metric.add_rows_context = chain.id.metric.add_rows_context; /* each has its own */
    TEST_ASSERT_EQUAL_MEMORY(&other.id.metric, &chain.id.metric, sizeof chain.id.metric);
}

static void test_the_period_of_another_dvl_spreads_the_wrench_as_if_it_were_given(void)
{
    chain_set_driver(&cfg);
    cfg.sim.sensor[SIM_DVL].rate_hz = 10.0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    cfg.id.metric.velocity_us = 100000;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&other, &cfg));
    chain_run(&chain, 20.0);
    chain_run(&other, 20.0);
    TEST_ASSERT_EQUAL_UINT32(100000, chain.id.metric.cfg.velocity_us);
    other.id.metric.add_rows_context = chain.id.metric.add_rows_context; /* each has its own */
    TEST_ASSERT_EQUAL_MEMORY(&other.id.metric, &chain.id.metric, sizeof chain.id.metric);
}

/* The samples are those of the user's own navigation: one in each tick. */
static void test_the_period_of_motion_from_elsewhere_is_observed(void)
{
    auvid_real_t x[AUVID_DOF_COUNT] = {0};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    for (uint64_t t_us = 0; t_us <= 1000000; t_us += 50000) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, t_us, x, NULL));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&chain.id, t_us, x, x));
    }
    TEST_ASSERT_EQUAL_UINT32(50000, chain.id.metric.cfg.velocity_us);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_attitude_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_rate_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_dvl_velocity_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_depth_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_gps_fix_that_is_not_finite_is_dropped);
    RUN_TEST(test_an_applied_wrench_that_is_not_finite_is_dropped);
    RUN_TEST(test_an_excessive_applied_wrench_is_dropped);
    RUN_TEST(test_a_thruster_command_that_is_not_finite_is_dropped);
    RUN_TEST(test_an_imu_sample_from_the_past_or_of_the_same_time_is_dropped);
    RUN_TEST(test_an_imu_sample_from_far_ahead_does_not_block_those_that_follow);
    RUN_TEST(test_dvl_and_depth_samples_of_a_wrong_time_are_dropped);
    RUN_TEST(test_a_dvl_velocity_beyond_the_speed_limit_is_dropped);
    RUN_TEST(test_outliers_are_dropped);
    RUN_TEST(test_a_step_whose_time_does_not_advance_is_refused_and_changes_nothing);
    RUN_TEST(test_a_step_of_zero_dt_at_the_very_beginning_is_refused);
    RUN_TEST(test_events_wait_for_the_next_accepted_step);
    RUN_TEST(test_motion_and_wrench_of_a_wrong_time_or_value_are_refused);
    RUN_TEST(test_motion_is_refused_as_a_whole_if_one_half_is);
    RUN_TEST(test_attitude_and_velocity_apart_record_the_bits_of_motion);
    RUN_TEST(test_attitude_and_velocity_apart_may_have_different_rates);
    RUN_TEST(test_attitude_and_velocity_of_a_wrong_time_or_value_are_refused);
    RUN_TEST(test_an_imu_that_is_100_ms_late_loses_no_sample_of_the_others);
    RUN_TEST(test_a_held_sample_that_is_refused_is_an_event_when_the_imu_comes_to_it);
    RUN_TEST(test_a_held_sample_and_the_next_one_are_both_recorded);
    RUN_TEST(test_a_gap_of_5_s_breaks_the_record_and_identification_continues);
    RUN_TEST(test_ticks_left_out_for_5_s_are_a_gap);
    RUN_TEST(test_null_pointers_are_refused_and_outputs_written);
    RUN_TEST(test_a_step_takes_no_more_cells_than_it_says);
    RUN_TEST(test_the_period_of_the_dvl_is_observed_and_no_cell_is_lost_at_5_hz);
    RUN_TEST(test_the_period_of_another_dvl_spreads_the_wrench_as_if_it_were_given);
    RUN_TEST(test_the_period_of_motion_from_elsewhere_is_observed);
    return UNITY_END();
}
