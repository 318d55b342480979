/*
 * Motion, attitude, velocity and wrench from elsewhere: what is recorded, and what is refused
 * without any other effect.
 */
#include <math.h>
#include <string.h>

#include "two_sets.h"
#include "unity.h"

void setUp(void)
{
    two_sets_defaults();
}

void tearDown(void)
{
}

static void test_motion_and_wrench_of_a_wrong_time_or_value_are_refused(void)
{
    static auvid_identifier_t before;
    auvid_real_t attitude[3] = {0, 0, 0}, nu[AUVID_DOF_COUNT] = {0}, tau[AUVID_DOF_COUNT] = {0};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&chain.id, 1000, attitude, nu));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, 1000, tau, NULL));
    TEST_ASSERT_EQUAL_UINT64(1000, chain.id.t_us); /* of the next estimate */
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

/* One wrong stamp would end the record until its time comes. */
static void test_a_wrench_far_ahead_of_the_motion_is_refused(void)
{
    static auvid_identifier_t before;
    const auvid_real_t attitude[3] = {0, 0, 0}, nu[AUVID_DOF_COUNT] = {0};
    const uint64_t latest_us = 1000 + AUVID_INPUT_AHEAD_US;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, 500, nu, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&chain.id, 1000, attitude, nu));
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE,
                      auvid_identifier_applied(&chain.id, latest_us + 1, nu, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, latest_us, nu, NULL));
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
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_identifier_attitude(&chain.id, t_us, attitude, nu + AUVID_ROLL));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_velocity(&chain.id, t_us, nu, 7u));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, t_us, tau, NULL));
    }
    TEST_ASSERT_EQUAL_MEMORY(&together.recorder, &chain.id.recorder, sizeof chain.id.recorder);
    TEST_ASSERT_EQUAL_MEMORY(&together.metric, &chain.id.metric, sizeof chain.id.metric);
}

static void test_without_the_filter_motion_is_recorded_and_sensors_are_dropped(void)
{
    static auvid_identifier_t filters;
    auvid_real_t attitude[3] = {0}, nu[AUVID_DOF_COUNT] = {0}, tau[AUVID_DOF_COUNT] = {0};
    auvid_input_t in = {.t_us = 5000000, .imu = {.present = true, .t_us = 5000000}};
    auvid_output_t out;
    in.dvl.present = true;
    in.dvl.sample.t_us = 5000000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&filters, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init_motion(&chain.id, &cfg.id));
    for (uint64_t t_us = 20000; t_us < 5000000; t_us += 20000) {
        attitude[2] = nu[AUVID_YAW] += AUVID_C(0.0001);
        for (int k = 0; k < 2; ++k) {
            auvid_identifier_t *to = k == 0 ? &filters : &chain.id;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(to, t_us, attitude, nu));
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(to, t_us, tau, NULL));
        }
    }
    TEST_ASSERT_EQUAL_MEMORY(&filters.recorder, &chain.id.recorder, sizeof chain.id.recorder);
    TEST_ASSERT_EQUAL_MEMORY(&filters.metric, &chain.id.metric, sizeof chain.id.metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_IMU_DROPPED | AUVID_EVENT_DVL_DROPPED, out.events);
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

/* Mass of a body in surge that answers within half a second, from velocities so far apart. */
static double mass_from_velocities(uint32_t period_us)
{
    const double mass = 80.0, drag = 160.0, dt = 0.01;
    const auvid_real_t level[3] = {0, 0, 0};
    auvid_real_t nu[AUVID_DOF_COUNT] = {0}, wrench[AUVID_DOF_COUNT] = {0};
    auvid_identifier_t *id = &chain.id;
    double u = 0.0;
    uint32_t next = 0;
    sim_rng_t rng;
    sim_rng_seed(&rng, 1, 1);
    cfg.id.exact_inputs = true;
    cfg.id.metric.free = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(id, &cfg.id));
    for (uint32_t k = 0; k < 30000; ++k) {
        uint64_t t_us = (uint64_t)(k + 1u) * 10000u;
        if (k == next) { /* steps of 1 to 3 s */
            wrench[AUVID_SURGE] = (auvid_real_t)(100.0 * sim_rng_uniform(&rng) - 50.0);
            next += 100u + (uint32_t)(200.0 * sim_rng_uniform(&rng));
        }
        nu[AUVID_SURGE] = (auvid_real_t)u;
        (void)auvid_identifier_applied(id, t_us, wrench, NULL);
        (void)auvid_identifier_attitude(id, t_us, level, nu + AUVID_ROLL);
        if (t_us % period_us == 0) {
            (void)auvid_identifier_velocity(id, t_us, nu, 7u);
        }
        u += ((double)wrench[AUVID_SURGE] - drag * u) / mass * dt;
        (void)auvid_identifier_work(id, AUVID_DEFAULT_BUDGET);
    }
    TEST_ASSERT_EQUAL_UINT32(period_us, id->metric.cfg.velocity_us);
    TEST_ASSERT_TRUE(id->estimate.number > 0);
    return (double)id->estimate.pi[AUVID_G500_M_U] / mass;
}

static void test_velocities_that_are_far_apart_leave_the_mass_right(void)
{
    for (uint32_t period_us = 100000; period_us <= 900000; period_us += 100000) {
        TEST_ASSERT_DOUBLE_WITHIN(0.04, 1.0, mass_from_velocities(period_us));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_motion_and_wrench_of_a_wrong_time_or_value_are_refused);
    RUN_TEST(test_a_wrench_far_ahead_of_the_motion_is_refused);
    RUN_TEST(test_motion_is_refused_as_a_whole_if_one_half_is);
    RUN_TEST(test_attitude_and_velocity_apart_record_the_bits_of_motion);
    RUN_TEST(test_without_the_filter_motion_is_recorded_and_sensors_are_dropped);
    RUN_TEST(test_attitude_and_velocity_apart_may_have_different_rates);
    RUN_TEST(test_attitude_and_velocity_of_a_wrong_time_or_value_are_refused);
    RUN_TEST(test_the_period_of_motion_from_elsewhere_is_observed);
    RUN_TEST(test_velocities_that_are_far_apart_leave_the_mass_right);
    return UNITY_END();
}
