/*
 * Bad inputs of a step are refused or dropped with the right status or event, without any other
 * effect.
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

/* One wrong stamp would end the record until its time comes. */
static void spoil_a_stamp(chain_t *c, auvid_status_t status, const auvid_output_t *good)
{
    static auvid_identifier_t before;
    const auvid_real_t wrench[AUVID_DOF_COUNT] = {0};
    (void)status;
    (void)good;
    if (c->tick % SPOILT_EVERY == 0) {
        before = c->id;
        TEST_ASSERT_EQUAL(
            AUVID_ERR_STALE,
            auvid_identifier_applied(&c->id, c->t_us + AUVID_INPUT_AHEAD_US + 1, wrench, NULL));
        TEST_ASSERT_EQUAL_MEMORY(&before, &c->id, sizeof before);
    }
}

static void test_a_wrench_far_ahead_of_the_tick_is_refused_and_changes_nothing(void)
{
    auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    const auvid_real_t wrench[AUVID_DOF_COUNT] = {0};
    run(&other);
    cfg.after = spoil_a_stamp;
    run(&chain);
    check_same_estimate();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_applied(&chain.id, 1 + AUVID_INPUT_AHEAD_US, wrench, NULL));
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
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_init_motion(NULL, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_init_motion(&chain.id, NULL));
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
    RUN_TEST(test_a_wrench_far_ahead_of_the_tick_is_refused_and_changes_nothing);
    RUN_TEST(test_a_step_of_zero_dt_at_the_very_beginning_is_refused);
    RUN_TEST(test_events_wait_for_the_next_accepted_step);
    RUN_TEST(test_null_pointers_are_refused_and_outputs_written);
    return UNITY_END();
}
