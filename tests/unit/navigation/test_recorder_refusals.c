/*
 * What the recorder refuses, and that it changes nothing then.
 */
#include <math.h>
#include <string.h>

#include "auvid/detail/recorder.h"
#include "recorder_streams.h"
#include "unity.h"

static auvid_recorder_t before;

void setUp(void)
{
    auvid_recorder_defaults(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&recorder, &cfg));
}

void tearDown(void)
{
}

/* All streams at 100 Hz until T0 + 540 ms. */
static void record_550_ms(void)
{
    auvid_sample_t s;
    for (uint64_t k = 0; k < 55; ++k) {
        for (int stream = 0; stream < 3; ++stream) {
            TEST_ASSERT_EQUAL(AUVID_OK, feed(stream, T0 + 10000 * k, 1));
        }
        while (auvid_recorder_pop(&recorder, &s) == AUVID_OK) {
        }
    }
}

static void refuse(auvid_status_t expected, auvid_status_t status)
{
    TEST_ASSERT_EQUAL(expected, status);
    TEST_ASSERT_EQUAL_MEMORY(&before, &recorder, sizeof recorder);
}

static void test_velocity_refuses_more_than_three_axes(void)
{
    const auvid_real_t v[3] = {0};
    before = recorder;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_recorder_velocity(&recorder, T0, v, 8));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_recorder_velocity(&recorder, T0, v, 0));
    TEST_ASSERT_EQUAL_MEMORY(&before, &recorder, sizeof recorder);
}

static void test_times_that_do_not_advance_are_refused_and_change_nothing(void)
{
    record_550_ms();
    before = recorder;
    for (int stream = 0; stream < 3; ++stream) {
        refuse(AUVID_ERR_TIME_SAME, feed(stream, T0 + 540000, 2));
        refuse(AUVID_ERR_TIME_BACK, feed(stream, T0 + 539999, 2));
        refuse(AUVID_ERR_TIME_BACK, feed(stream, 0, 2));
    }
}

static void test_motion_is_refused_like_its_parts(void)
{
    auvid_real_t x[6] = {0}, bad[6] = {0};
    uint64_t t_us = T0 + 550000;
    record_550_ms();
    before = recorder;
    refuse(AUVID_ERR_NULL, auvid_recorder_motion(NULL, t_us, x, x));
    refuse(AUVID_ERR_NULL, auvid_recorder_motion(&recorder, t_us, NULL, x));
    refuse(AUVID_ERR_NULL, auvid_recorder_motion(&recorder, t_us, x, NULL));
    refuse(AUVID_ERR_TIME_SAME, auvid_recorder_motion(&recorder, T0 + 540000, x, x));
    refuse(AUVID_ERR_TIME_BACK, auvid_recorder_motion(&recorder, T0 + 539999, x, x));
    bad[2] = (auvid_real_t)NAN;
    refuse(AUVID_ERR_NOT_FINITE, auvid_recorder_motion(&recorder, t_us, x, bad));
    refuse(AUVID_ERR_NOT_FINITE, auvid_recorder_motion(&recorder, t_us, bad, x));
    bad[2] = AUVID_C(1.01) * AUVID_RECORDER_LARGEST;
    refuse(AUVID_ERR_RANGE, auvid_recorder_motion(&recorder, t_us, x, bad));
    refuse(AUVID_ERR_RANGE, auvid_recorder_motion(&recorder, t_us, bad, x));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_motion(&recorder, t_us, x, x));
}

static void test_numbers_that_are_not_finite_are_refused_and_change_nothing(void)
{
    record_550_ms();
    before = recorder;
    static const double bad[] = {NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < 3; ++i) {
        auvid_real_t x[6] = {0}, command[AUVID_MAX_COMMANDS] = {0};
        uint64_t t_us = T0 + 550000;
        for (int k = 0; k < 6; ++k) {
            x[k] = (auvid_real_t)bad[i];
            refuse(AUVID_ERR_NOT_FINITE, auvid_recorder_attitude(&recorder, t_us, x, x + 3));
            refuse(AUVID_ERR_NOT_FINITE,
                   auvid_recorder_velocity(&recorder, t_us, x + k / 3 * 3, 7u));
            refuse(AUVID_ERR_NOT_FINITE, auvid_recorder_input(&recorder, t_us, x, NULL));
            x[k] = 0;
        }
        command[AUVID_MAX_COMMANDS - 1] = (auvid_real_t)bad[i];
        refuse(AUVID_ERR_NOT_FINITE, auvid_recorder_input(&recorder, t_us, x, command));
    }
}

static void test_numbers_beyond_the_largest_are_refused_and_change_nothing(void)
{
    record_550_ms();
    before = recorder;
    const auvid_real_t bad[] = {AUVID_C(1.01) * AUVID_RECORDER_LARGEST, -AUVID_LARGEST};
    for (size_t i = 0; i < 2; ++i) {
        auvid_real_t x[6] = {0}, command[AUVID_MAX_COMMANDS] = {0};
        uint64_t t_us = T0 + 550000;
        x[0] = x[5] = bad[i];
        command[AUVID_MAX_COMMANDS - 1] = bad[i];
        refuse(AUVID_ERR_RANGE, auvid_recorder_attitude(&recorder, t_us, x, x + 3));
        refuse(AUVID_ERR_RANGE, auvid_recorder_velocity(&recorder, t_us, x, 7u));
        refuse(AUVID_ERR_RANGE, auvid_recorder_input(&recorder, t_us, x, NULL));
        x[0] = x[5] = 0;
        refuse(AUVID_ERR_RANGE, auvid_recorder_input(&recorder, t_us, x, command));
    }
}

static void test_null_pointers_are_refused(void)
{
    auvid_real_t x[6] = {0};
    auvid_sample_t s;
    before = recorder;
    refuse(AUVID_ERR_NULL, auvid_recorder_attitude(NULL, 1, x, x));
    refuse(AUVID_ERR_NULL, auvid_recorder_attitude(&recorder, 1, NULL, x));
    refuse(AUVID_ERR_NULL, auvid_recorder_attitude(&recorder, 1, x, NULL));
    refuse(AUVID_ERR_NULL, auvid_recorder_velocity(NULL, 1, x, 7u));
    refuse(AUVID_ERR_NULL, auvid_recorder_velocity(&recorder, 1, NULL, 7u));
    refuse(AUVID_ERR_NULL, auvid_recorder_input(NULL, 1, x, x));
    refuse(AUVID_ERR_NULL, auvid_recorder_input(&recorder, 1, NULL, x));
    refuse(AUVID_ERR_NULL, auvid_recorder_pop(NULL, &s));
    refuse(AUVID_ERR_NULL, auvid_recorder_pop(&recorder, NULL));
    refuse(AUVID_ERR_NULL, auvid_recorder_init(&recorder, NULL));
    refuse(AUVID_ERR_NULL, auvid_recorder_init(NULL, &cfg));
    auvid_recorder_defaults(NULL);
}

static void test_init_refuses_fields_out_of_their_range_and_changes_nothing(void)
{
    auvid_recorder_config_t bad[6];
    for (int i = 0; i < 6; ++i) {
        bad[i] = cfg;
    }
    bad[0].cell_us = 999;
    bad[1].cell_us = 1000001;
    bad[1].gap_us = 2000000;
    bad[2].gap_us = 99999;
    bad[3].gap_us = 1000000001;
    bad[4].input = (auvid_input_mode_t)2;
    bad[5].cell_us = bad[5].gap_us = 0;
    before = recorder;
    for (int i = 0; i < 6; ++i) {
        refuse(AUVID_ERR_RANGE, auvid_recorder_init(&recorder, &bad[i]));
    }
}

/* The largest gap: time differences between samples must not wrap. */
static void test_samples_as_far_apart_as_the_largest_gap_allows_are_still_straight_lines(void)
{
    auvid_sample_t s;
    cfg.cell_us = 1000000;
    cfg.gap_us = 1000000000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&recorder, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, feed(ATTITUDE, T0, 0));
    TEST_ASSERT_EQUAL(AUVID_OK, feed(VELOCITY, T0 + 990000000, 0));
    TEST_ASSERT_EQUAL(AUVID_OK, feed(INPUT, T0 + 990000000, 0));
    TEST_ASSERT_EQUAL(AUVID_OK, feed(ATTITUDE, T0 + 1000000000, 1));
    TEST_ASSERT_EQUAL(AUVID_OK, feed(VELOCITY, T0 + 1000000000, 1));
    TEST_ASSERT_EQUAL(AUVID_OK, feed(INPUT, T0 + 1000000000, 1));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_pop(&recorder, &s));
    TEST_ASSERT_EQUAL_UINT64(T0 + 992500000, s.t_us);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.9925, (double)s.phi);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.25, (double)s.nu[0]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_velocity_refuses_more_than_three_axes);
    RUN_TEST(test_times_that_do_not_advance_are_refused_and_change_nothing);
    RUN_TEST(test_motion_is_refused_like_its_parts);
    RUN_TEST(test_numbers_that_are_not_finite_are_refused_and_change_nothing);
    RUN_TEST(test_numbers_beyond_the_largest_are_refused_and_change_nothing);
    RUN_TEST(test_null_pointers_are_refused);
    RUN_TEST(test_init_refuses_fields_out_of_their_range_and_changes_nothing);
    RUN_TEST(test_samples_as_far_apart_as_the_largest_gap_allows_are_still_straight_lines);
    return UNITY_END();
}
