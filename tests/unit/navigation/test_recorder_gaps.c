/*
 * The recorder's gaps: silence, velocities that are not measured, and the observed period.
 */
#include <math.h>
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

/* ---- gaps ---- */

static int gaps, popped;
static uint64_t latest_us;

static void pop_all(void)
{
    auvid_sample_t s;
    auvid_status_t status;
    while ((status = auvid_recorder_pop(&recorder, &s)) != AUVID_EMPTY) {
        if (status == AUVID_GAP) {
            ++gaps;
        } else {
            TEST_ASSERT_EQUAL(AUVID_OK, status);
            TEST_ASSERT_TRUE(s.t_us > latest_us);
            latest_us = s.t_us;
            ++popped;
        }
    }
}

static void run(int from, int to, unsigned streams, bool pop)
{
    for (int k = from; k < to; ++k) {
        for (int stream = 0; stream < 3; ++stream) {
            if (streams >> stream & 1u) {
                TEST_ASSERT_EQUAL(AUVID_OK, feed(stream, T0 + 10000ull * (uint64_t)k, 1));
            }
        }
        if (pop) {
            pop_all();
        }
    }
}

static void reset_counts(void)
{
    gaps = popped = 0;
    latest_us = 0;
    setUp();
}

static void test_silence_longer_than_the_gap_breaks_the_record_once(void)
{
    reset_counts();
    run(0, 101, 7, true);
    TEST_ASSERT_EQUAL_INT(6, popped);
    run(152, 260, 7, true); /* 520 ms later */
    TEST_ASSERT_EQUAL_INT(1, gaps);
    TEST_ASSERT_EQUAL_INT(6 + 6, popped);
    TEST_ASSERT_TRUE(latest_us > T0 + 1520000);
}

static void test_silence_as_long_as_the_gap_is_bridged(void)
{
    reset_counts();
    run(0, 101, 7, true);
    run(150, 251, 7, true); /* 500 ms later */
    TEST_ASSERT_EQUAL_INT(0, gaps);
    TEST_ASSERT_EQUAL_INT(21, popped);
}

static void test_silence_of_one_stream_breaks_the_record_for_all(void)
{
    for (unsigned quiet = 0; quiet < 3; ++quiet) {
        reset_counts();
        run(0, 101, 7, true);
        run(101, 160, 7u & ~(1u << quiet), true);
        TEST_ASSERT_EQUAL_INT(0, gaps);
        run(160, 261, 7, true);
        TEST_ASSERT_EQUAL_INT(1, gaps);
        TEST_ASSERT_EQUAL_INT(6 + 6, popped);
    }
}

static void test_stream_that_stops_for_good_breaks_the_record_once(void)
{
    for (unsigned quiet = 0; quiet < 3; ++quiet) {
        reset_counts();
        run(0, 101, 7, true);
        run(101, 1000, 7u & ~(1u << quiet), true);
        TEST_ASSERT_EQUAL_INT(1, gaps);
        TEST_ASSERT_EQUAL_INT(6, popped);
        run(1000, 1101, 7, true);
        TEST_ASSERT_EQUAL_INT(1, gaps);
        TEST_ASSERT_EQUAL_INT(12, popped);
    }
}

static void test_record_that_the_caller_breaks_is_broken_once(void)
{
    auvid_recorder_break(NULL);
    auvid_recorder_break(&recorder); /* there is none */
    reset_counts();
    run(0, 101, 7, true);
    auvid_recorder_break(&recorder);
    auvid_recorder_break(&recorder);
    run(101, 202, 7, true);
    TEST_ASSERT_EQUAL_INT(1, gaps);
    TEST_ASSERT_EQUAL_INT(6 + 6, popped);
}

/* A stream with one sample long before the others: no record was broken, so there is no gap. */
static void test_stream_sampled_long_before_the_others_does_not_begin_a_record(void)
{
    reset_counts();
    TEST_ASSERT_EQUAL(AUVID_OK, feed(INPUT, T0 - 50000000, 1));
    TEST_ASSERT_EQUAL(AUVID_OK, feed(VELOCITY, T0 - 40000000, 1));
    TEST_ASSERT_EQUAL(AUVID_OK, feed(VELOCITY, T0 - 20000000, 1));
    run(0, 300, 3, true);
    run(300, 401, 7, true);
    TEST_ASSERT_EQUAL_INT(0, gaps);
    TEST_ASSERT_EQUAL_INT(6, popped);
    TEST_ASSERT_TRUE(latest_us > T0 + 3000000);
}

/* ---- partial velocity ---- */

typedef struct {
    int cells, gaps;
    uint8_t missing[200]; /* by cell, from T0 on */
    auvid_sample_t sample[200];
} heard_t;
static heard_t heard[2];

/* 15 s: all else at 50 Hz, velocity at 5 Hz, 20 ms late; `measured` of the k-th sample. */
static void feed_15_s(heard_t *to, uint32_t gap_us, unsigned (*measured)(int k))
{
    cfg.gap_us = gap_us;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&recorder, &cfg));
    memset(to, 0, sizeof *to);
    for (int k = 0; k <= 750; ++k) {
        uint64_t t_us = T0 + 20000ull * (uint64_t)k;
        if (k % 10 == 1) {
            int number = k / 10;
            auvid_real_t v[3];
            for (int i = 0; i < 3; ++i) { /* components that are not measured must not be read */
                bool is = (measured(number) >> i & 1u) != 0;
                v[i] = is ? (auvid_real_t)sin(0.3 * number + i) : (auvid_real_t)NAN;
            }
            auvid_status_t status =
                auvid_recorder_velocity(&recorder, t_us - 20000, v, measured(number));
            TEST_ASSERT_EQUAL(measured(number) == 0 ? AUVID_UNUSED : AUVID_OK, status);
        }
        TEST_ASSERT_EQUAL(AUVID_OK, feed(ATTITUDE, t_us, sin(0.01 * k)));
        TEST_ASSERT_EQUAL(AUVID_OK, feed(INPUT, t_us, cos(0.01 * k)));
        auvid_sample_t s;
        auvid_status_t status;
        while ((status = auvid_recorder_pop(&recorder, &s)) != AUVID_EMPTY) {
            to->gaps += status == AUVID_GAP;
            if (status == AUVID_OK) {
                uint32_t number = (uint32_t)(s.t_us - T0) / 100000u;
                to->missing[number] = s.missing;
                to->sample[number] = s;
                ++to->cells;
            }
        }
    }
}

static unsigned always(int k)
{
    (void)k;
    return 7;
}

static unsigned no_sway_from_20_to_29(int k)
{
    return k >= 20 && k < 30 ? 5 : 7;
}

static unsigned no_sway_in_20_and_21(int k)
{
    return k == 20 || k == 21 ? 5 : 7;
}

static unsigned heave_only_until_10(int k)
{
    return k < 10 ? 4 : 7;
}

static unsigned nothing_in_20_and_21(int k)
{
    return k == 20 || k == 21 ? 0 : 7;
}

static void test_a_velocity_that_is_not_measured_for_long_is_missing_and_breaks_no_record(void)
{
    feed_15_s(&heard[0], 0, always);
    feed_15_s(&heard[1], 0, no_sway_from_20_to_29);
    TEST_ASSERT_EQUAL(0, heard[1].gaps);
    for (int n = 2; n < 145; ++n) {
        const auvid_sample_t *whole = &heard[0].sample[n], *part = &heard[1].sample[n];
        /* samples 0.2 s apart; unknown from number 19 (3.8 s) to number 30 (6 s), and two cells
         * beside for the accelerations; it counts again from a whole cell on */
        bool known = n < 36 || n > 62;
        TEST_ASSERT_EQUAL_HEX8(0, heard[0].missing[n]);
        TEST_ASSERT_EQUAL_HEX8(known ? 0 : 2, heard[1].missing[n]);
        for (int i = 0; i < 3; ++i) {
            bool same = memcmp(&whole->nu[i], &part->nu[i], sizeof part->nu[i]) == 0 &&
                        memcmp(&whole->nu_dot[i], &part->nu_dot[i], sizeof part->nu[i]) == 0;
            TEST_ASSERT_TRUE(same || (i == 1 && !known));
            TEST_ASSERT_TRUE(auvid_is_finite(part->nu[i]) && auvid_is_finite(part->nu_dot[i]));
        }
    }
}

static void test_a_velocity_is_interpolated_over_samples_that_do_not_measure_it(void)
{
    feed_15_s(&heard[0], 1000000, no_sway_in_20_and_21);
    feed_15_s(&heard[1], 1000000, nothing_in_20_and_21);
    TEST_ASSERT_EQUAL(0, heard[0].gaps + heard[1].gaps);
    for (int n = 2; n < 145; ++n) {
        TEST_ASSERT_EQUAL_HEX8(0, heard[0].missing[n] | heard[1].missing[n]);
        TEST_ASSERT_TRUE(heard[0].sample[n].nu[1] == heard[1].sample[n].nu[1]);
    }
}

static void test_a_record_begins_with_one_velocity(void)
{
    feed_15_s(&heard[0], 0, heave_only_until_10);
    TEST_ASSERT_EQUAL(0, heard[0].gaps);
    TEST_ASSERT_EQUAL_HEX8(3, heard[0].missing[10]);
    TEST_ASSERT_EQUAL_HEX8(3, heard[0].missing[20]);
    TEST_ASSERT_EQUAL_HEX8(0, heard[0].missing[24]);
    TEST_ASSERT_EQUAL_HEX8(0, heard[0].missing[144]);
}

/* A late sample may be older than the beginning of the record. */
static void test_a_velocity_first_sampled_late_counts_from_the_beginning(void)
{
    const auvid_real_t v[3] = {1, 2, 3};
    auvid_sample_t s;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_velocity(&recorder, T0, v, 4));
    for (uint64_t t_us = T0 + 100000; t_us <= T0 + 1200000; t_us += 20000) {
        TEST_ASSERT_EQUAL(AUVID_OK, feed(ATTITUDE, t_us, 0));
        TEST_ASSERT_EQUAL(AUVID_OK, feed(INPUT, t_us, 0));
        if ((t_us - T0) % 200000 == 100000) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_velocity(&recorder, t_us - 50000, v, 7));
        }
    }
    for (int k = 0; k < 5; ++k) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_pop(&recorder, &s));
        TEST_ASSERT_EQUAL_HEX8(0, s.missing);
    }
}

static void test_default_gap_is_five_velocity_samples_or_one_and_a_half_slow_ones(void)
{
    TEST_ASSERT_EQUAL_UINT32(500000, auvid_recorder_gap(0));
    TEST_ASSERT_EQUAL_UINT32(500000, auvid_recorder_gap(100000));
    TEST_ASSERT_EQUAL_UINT32(750000, auvid_recorder_gap(150000));
    TEST_ASSERT_EQUAL_UINT32(1000000, auvid_recorder_gap(200000));
    TEST_ASSERT_EQUAL_UINT32(1000000, auvid_recorder_gap(666666));
    TEST_ASSERT_EQUAL_UINT32(1200000, auvid_recorder_gap(800000));
    TEST_ASSERT_EQUAL_UINT32(1500000, auvid_recorder_gap(1000000));
    TEST_ASSERT_EQUAL_UINT32(1000000, auvid_recorder_gap(AUVID_VELOCITY_OBSERVED));
    TEST_ASSERT_EQUAL_UINT32(500000, recorder.gap_us);
}

/* Attitude and input at 50 Hz, velocity samples interval_ms[] apart, at which the period of the
 * velocity samples is observed. */
static void observe(const int *interval_ms, int intervals)
{
    int velocity_ms = 0, k = 0;
    popped = gaps = 0;
    latest_us = 0;
    cfg.velocity_us = AUVID_VELOCITY_OBSERVED;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&recorder, &cfg));
    for (int ms = 0; k <= intervals; ms += 20) {
        uint64_t t_us = T0 + 1000ull * (uint64_t)ms;
        TEST_ASSERT_EQUAL(AUVID_OK, feed(ATTITUDE, t_us, 1));
        TEST_ASSERT_EQUAL(AUVID_OK, feed(INPUT, t_us, 1));
        if (ms == velocity_ms) {
            TEST_ASSERT_EQUAL(AUVID_OK, feed(VELOCITY, t_us, 1));
            velocity_ms += interval_ms[k++];
        }
        if (k <= intervals) {
            pop_all();
        }
    }
}

static void test_the_period_of_the_velocity_is_the_median_of_the_first_seven_intervals(void)
{
    static const int steady[] = {200, 200, 200, 200, 200, 200, 200, 0};
    static const int fast[] = {100, 100, 100, 100, 100, 100, 100, 0};
    static const int lossy[] = {400, 200, 600, 180, 200, 220, 400, 0};
    observe(steady, 6);
    TEST_ASSERT_EQUAL_UINT32(AUVID_VELOCITY_OBSERVED, recorder.velocity_us);
    observe(fast, 7);
    TEST_ASSERT_EQUAL_UINT32(100000, recorder.velocity_us);
    TEST_ASSERT_EQUAL_UINT32(500000, recorder.gap_us);
    observe(lossy, 7);
    TEST_ASSERT_EQUAL_UINT32(220000, recorder.velocity_us);
    TEST_ASSERT_EQUAL_UINT32(1000000, recorder.gap_us);
    cfg.gap_us = 300000;
    observe(fast, 7);
    TEST_ASSERT_EQUAL_UINT32(300000, recorder.gap_us);
}

/* At 5 Hz they fit into the ring. */
static void test_cells_wait_until_the_period_of_the_velocity_is_known(void)
{
    static const int steady[] = {200, 200, 200, 200, 200, 200, 200, 0};
    observe(steady, 7);
    TEST_ASSERT_EQUAL_INT(0, popped + gaps);
    pop_all();
    TEST_ASSERT_EQUAL_INT(0, gaps);
    TEST_ASSERT_EQUAL_INT(10, popped); /* of 14 cells */
}

/* The ring overflows again and again. The record begins after that, without a gap. */
static void test_the_period_of_a_slow_velocity_is_observed_without_a_gap(void)
{
    static const int slow[] = {1000, 1000, 1000, 1000, 1000, 1000, 1000, 0};
    observe(slow, 7);
    pop_all();
    TEST_ASSERT_EQUAL_UINT32(1000000, recorder.velocity_us);
    TEST_ASSERT_EQUAL_INT(0, gaps);
}

/* No sensor with 1 Hz is that punctual. */
static void test_a_velocity_that_comes_about_once_a_second_breaks_no_record(void)
{
    static const int late[] = {1000, 1040, 980, 1060, 1020, 1000, 1040,
                               1020, 1100, 960, 1040, 1200, 1020, 0};
    observe(late, 13);
    TEST_ASSERT_EQUAL_UINT32(1500000, recorder.gap_us);
    TEST_ASSERT_GREATER_THAN_INT(
        30, popped); /* of 61 cells since the period is known, the last ones wait */
    TEST_ASSERT_LESS_THAN_INT(2, gaps); /* before */
}

/* Slower than any gap that the default bridges: nothing is recorded, and each sample is a gap. */
static void test_a_velocity_that_is_too_slow_to_be_observed_is_a_gap(void)
{
    static const int too_slow[] = {2000, 2000, 2000, 2000, 2000, 2000, 2000, 2000, 0};
    observe(too_slow, 8);
    TEST_ASSERT_EQUAL_INT(8, gaps);
    TEST_ASSERT_EQUAL_INT(0, popped);
    cfg.gap_us = 3000000; /* with a longer gap and longer cells it is recorded */
    cfg.cell_us = 300000;
    observe(too_slow, 7);
    TEST_ASSERT_EQUAL_UINT32(1000000, recorder.velocity_us);
    TEST_ASSERT_EQUAL_INT(0, gaps);
}

static void test_cells_that_are_not_popped_are_lost_and_reported_as_a_gap(void)
{
    reset_counts();
    run(0, 161, 7, false); /* sixteen cells: just full */
    pop_all();
    TEST_ASSERT_EQUAL_INT(0, gaps);
    TEST_ASSERT_EQUAL_INT(12, popped);
    reset_counts();
    run(0, 162, 7, false); /* a fraction of the seventeenth */
    pop_all();
    TEST_ASSERT_EQUAL_INT(1, gaps);
    TEST_ASSERT_EQUAL_INT(0, popped);
    reset_counts();
    run(0, 300, 7, false);
    pop_all();
    TEST_ASSERT_EQUAL_INT(1, gaps);
    TEST_ASSERT_TRUE(popped > 0);
}

static void test_record_after_a_gap_is_independent_of_the_previous_one(void)
{
    auvid_sample_t s;
    reset_counts();
    run(0, 101, 7, true);
    for (int k = 200; k <= 260; ++k) {
        for (int stream = 0; stream < 3; ++stream) {
            TEST_ASSERT_EQUAL(AUVID_OK, feed(stream, T0 + 10000ull * (uint64_t)k, 5));
        }
    }
    TEST_ASSERT_EQUAL(AUVID_GAP, auvid_recorder_pop(&recorder, &s));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_pop(&recorder, &s));
    TEST_ASSERT_EQUAL_UINT64(T0 + 2250000, s.t_us);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, 5, (double)s.nu[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0, (double)s.nu_dot[0]);
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, 5, (double)s.tau[0]);
}

static void test_gap_leaves_the_sample_untouched(void)
{
    auvid_sample_t s, untouched;
    memset(&s, 0x5A, sizeof s);
    untouched = s;
    reset_counts();
    TEST_ASSERT_EQUAL(AUVID_EMPTY, auvid_recorder_pop(&recorder, &s));
    run(0, 30, 7, false);
    run(100, 130, 7, false);
    TEST_ASSERT_EQUAL(AUVID_GAP, auvid_recorder_pop(&recorder, &s));
    TEST_ASSERT_EQUAL_MEMORY(&untouched, &s, sizeof s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_silence_longer_than_the_gap_breaks_the_record_once);
    RUN_TEST(test_silence_as_long_as_the_gap_is_bridged);
    RUN_TEST(test_silence_of_one_stream_breaks_the_record_for_all);
    RUN_TEST(test_stream_that_stops_for_good_breaks_the_record_once);
    RUN_TEST(test_record_that_the_caller_breaks_is_broken_once);
    RUN_TEST(test_stream_sampled_long_before_the_others_does_not_begin_a_record);
    RUN_TEST(test_a_velocity_that_is_not_measured_for_long_is_missing_and_breaks_no_record);
    RUN_TEST(test_a_velocity_is_interpolated_over_samples_that_do_not_measure_it);
    RUN_TEST(test_a_record_begins_with_one_velocity);
    RUN_TEST(test_a_velocity_first_sampled_late_counts_from_the_beginning);
    RUN_TEST(test_default_gap_is_five_velocity_samples_or_one_and_a_half_slow_ones);
    RUN_TEST(test_the_period_of_the_velocity_is_the_median_of_the_first_seven_intervals);
    RUN_TEST(test_cells_wait_until_the_period_of_the_velocity_is_known);
    RUN_TEST(test_the_period_of_a_slow_velocity_is_observed_without_a_gap);
    RUN_TEST(test_a_velocity_that_comes_about_once_a_second_breaks_no_record);
    RUN_TEST(test_a_velocity_that_is_too_slow_to_be_observed_is_a_gap);
    RUN_TEST(test_cells_that_are_not_popped_are_lost_and_reported_as_a_gap);
    RUN_TEST(test_record_after_a_gap_is_independent_of_the_previous_one);
    RUN_TEST(test_gap_leaves_the_sample_untouched);
    return UNITY_END();
}
