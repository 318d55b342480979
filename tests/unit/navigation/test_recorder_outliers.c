/*
 * The recorder: outliers of the velocity are put on the line between their neighbours, and motion
 * is not taken for one.
 */
#include <stdlib.h>
#include <string.h>

#include "auvid/detail/recorder.h"
#include "recorder_streams.h"
#include "unity.h"

void setUp(void)
{
    auvid_recorder_defaults(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&recorder, &cfg));
}

void tearDown(void)
{
}

/* The velocity, sampled with the period, is x(k), and `off` more at sample 40. All else is as in
 * play(). The signal is on the line between the neighbours there: cells follow it, but for those
 * that were popped before the next sample came. Returns how many do not. */
static int popped_with_outlier(uint32_t period_us, double (*x)(int), double off)
{
    int popped = 0;
    auvid_sample_t s;
    memset(track, 0, sizeof track);
    setUp();
    for (int k = 0; k < 80; ++k) {
        uint64_t t_us = T0 + (uint64_t)k * period_us;
        TEST_ASSERT_EQUAL(AUVID_OK, feed_noted(ATTITUDE, t_us, 1));
        TEST_ASSERT_EQUAL(AUVID_OK, feed_noted(INPUT, t_us, 1));
        TEST_ASSERT_EQUAL(AUVID_OK, feed(VELOCITY, t_us, x(k) + (k == 40 ? off : 0)));
        track[VELOCITY].t_us[k] = t_us;
        track[VELOCITY].value[k] = (double)(auvid_real_t)x(k);
        track[VELOCITY].samples = (size_t)k + 1;
        while (auvid_recorder_pop(&recorder, &s) == AUVID_OK) {
            bool waits = k == 40 && s.t_us + 5 * cfg.cell_us / 2 > t_us - period_us;
            if (!waits) {
                assert_cell(&s);
            }
            popped += waits;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(off != 0 ? 3 : 0, recorder.outliers);
    return popped;
}

/* Noise of 0.01 m/s; straight from the sample before the outlier to the one after it. */
static double noisy_line(int k)
{
    return k >= 39 && k <= 41 ? 0.01 * k : 0.01 * k + 0.01 * (k * 7 % 5 - 2) / 2;
}

static void test_a_velocity_that_jumps_and_comes_back_is_as_if_not_measured(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        TEST_ASSERT_EQUAL_INT(1, popped_with_outlier(50000, noisy_line, 0.3 * sign));
        TEST_ASSERT_EQUAL_INT(1, popped_with_outlier(100000, noisy_line, 0.3 * sign));
        TEST_ASSERT_EQUAL_INT(2, popped_with_outlier(200000, noisy_line, 0.3 * sign));
        TEST_ASSERT_EQUAL_INT(3, popped_with_outlier(300000, noisy_line, 0.3 * sign));
        TEST_ASSERT_EQUAL_INT(5, popped_with_outlier(470000, noisy_line, 0.3 * sign));
    }
}

/* The velocity alternates by 0.01 m/s, which is how far samples are from the line between their
 * neighbours. One of them jumps by this. */
static uint32_t outliers_of(double jump)
{
    const int at = jump > 0 ? 60 : 61;
    setUp();
    for (int k = 0; k < 80; ++k) {
        double x = k == at ? (k % 2 == 0 ? -0.005 : 0.005) + jump : k % 2 == 0 ? 0.005 : -0.005;
        auvid_real_t velocity[3] = {(auvid_real_t)x};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_velocity(&recorder, T0 + 100000ull * (uint64_t)k,
                                                            velocity, 1u));
    }
    return recorder.outliers;
}

static void test_an_outlier_jumps_by_five_times_the_usual_deviation(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, outliers_of(0.05));
    TEST_ASSERT_EQUAL_UINT32(1, outliers_of(0.07));
    TEST_ASSERT_EQUAL_UINT32(0, outliers_of(-0.05));
    TEST_ASSERT_EQUAL_UINT32(1, outliers_of(-0.07));
}

/* Feed surge every 0.1 s from *t_us on. */
static void feed_surge(uint64_t *t_us, double value, int samples)
{
    auvid_real_t velocity[3] = {(auvid_real_t)value};
    for (int k = 0; k < samples; ++k, *t_us += 100000) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_velocity(&recorder, *t_us, velocity, 1u));
    }
}

static void test_the_second_sample_may_be_an_outlier(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        uint64_t t_us = T0;
        setUp();
        feed_surge(&t_us, 0, 1);
        feed_surge(&t_us, sign, 1);
        feed_surge(&t_us, 0, 1);
        TEST_ASSERT_EQUAL_UINT32(1, recorder.outliers);
    }
}

static void test_a_jump_across_a_gap_is_no_outlier(void)
{
    uint64_t t_us = T0;
    feed_surge(&t_us, 0, 30);
    t_us += recorder.gap_us;
    feed_surge(&t_us, 0.9, 1);
    feed_surge(&t_us, 0, 30);
    t_us += recorder.gap_us - 100000u; /* as long as the gap: the next sample follows */
    feed_surge(&t_us, 0.9, 1);
    TEST_ASSERT_EQUAL_UINT32(0, recorder.outliers);
    feed_surge(&t_us, 0, 1);
    TEST_ASSERT_EQUAL_UINT32(1, recorder.outliers);
    feed_surge(&t_us, 0.9, 1);
    t_us += recorder.gap_us;
    feed_surge(&t_us, 0, 2);
    TEST_ASSERT_EQUAL_UINT32(1, recorder.outliers);
}

static void test_after_long_rest_the_resolution_of_a_dvl_is_no_outlier(void)
{
    uint64_t t_us = T0;
    feed_surge(&t_us, 0, 300);
    feed_surge(&t_us, 0.004, 1);
    feed_surge(&t_us, 0, 300);
    TEST_ASSERT_EQUAL_UINT32(0, recorder.outliers);
    feed_surge(&t_us, 0.008, 1);
    feed_surge(&t_us, 0, 1);
    TEST_ASSERT_EQUAL_UINT32(1, recorder.outliers);
}

static double step(int k)
{
    return k < 40 ? 0 : 0.8;
}

static double kink(int k)
{
    return 0.1 * abs(k - 40);
}

static double pulse(int k) /* two samples long */
{
    return k == 40 || k == 41 ? 0.5 : 0;
}

static double ripple(int k)
{
    return 0.05 * (k & 1);
}

static void test_steps_kinks_pulses_and_ripple_are_motion(void)
{
    static double (*const motion[])(int) = {step, kink, pulse, ripple};
    for (size_t i = 0; i < sizeof motion / sizeof motion[0]; ++i) {
        popped_with_outlier(100000, motion[i], 0);
        popped_with_outlier(200000, motion[i], 0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_velocity_that_jumps_and_comes_back_is_as_if_not_measured);
    RUN_TEST(test_an_outlier_jumps_by_five_times_the_usual_deviation);
    RUN_TEST(test_the_second_sample_may_be_an_outlier);
    RUN_TEST(test_a_jump_across_a_gap_is_no_outlier);
    RUN_TEST(test_after_long_rest_the_resolution_of_a_dvl_is_no_outlier);
    RUN_TEST(test_steps_kinks_pulses_and_ripple_are_motion);
    return UNITY_END();
}
