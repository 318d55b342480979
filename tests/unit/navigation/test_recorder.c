/*
 * The recorder by its contract. Cells are compared with the signals as the header defines them.
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

static uint32_t seed;

static uint32_t draw(uint32_t n)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)(((uint64_t)seed * n) >> 32);
}

/* Of random slope, but without an outlier: it only rises. */
static double rising(uint64_t t_us)
{
    const track_t *t = &track[VELOCITY];
    uint64_t since = t->samples == 0 ? T0 : t->t_us[t->samples - 1];
    double x = t->samples == 0 ? 0 : t->value[t->samples - 1];
    return x + draw(1000) * 2e-10 * (double)(t_us - since);
}

static double shape(int stream, uint64_t t_us)
{
    double t = (double)(t_us - T0) * 1e-6;
    if (stream == VELOCITY) {
        return rising(t_us);
    }
    return sin(3 * t + stream) + 0.7 * cos(11 * t) + (draw(1000) / 1000.0 - 0.5) * 0.3;
}

/* All three streams in time order, samples min_us..max_us apart; every cell is compared. */
static int play(const uint32_t *min_us, const uint32_t *max_us, uint64_t until_us)
{
    uint64_t next[3] = {T0 + 7, T0 + 13001, T0 + 40003}, last_us = 0;
    int cells = 0;
    auvid_sample_t s;
    memset(track, 0, sizeof track);
    for (;;) {
        int first = next[0] <= next[1] && next[0] <= next[2] ? 0 : (next[1] <= next[2] ? 1 : 2);
        if (next[first] > until_us) {
            return cells;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, feed_noted(first, next[first], shape(first, next[first])));
        next[first] += min_us[first] + draw(max_us[first] - min_us[first] + 1);
        while (auvid_recorder_pop(&recorder, &s) == AUVID_OK) {
            TEST_ASSERT_TRUE(last_us == 0 || s.t_us == last_us + cfg.cell_us);
            last_us = s.t_us;
            assert_cell(&s);
            ++cells;
        }
    }
}

static void test_cells_are_exact_means_of_streams_at_different_irregular_rates(void)
{
    static const uint32_t min_us[3] = {3000, 60000, 11000}, max_us[3] = {37000, 390000, 190000};
    for (seed = 1; seed <= 5; ++seed) {
        uint32_t keep = seed;
        setUp();
        TEST_ASSERT_INT_WITHIN(8, 195, play(min_us, max_us, T0 + 20000000));
        seed = keep;
    }
}

static void test_input_can_be_interpolated_linearly(void)
{
    static const uint32_t min_us[3] = {3000, 60000, 11000}, max_us[3] = {37000, 390000, 190000};
    cfg.input = AUVID_INPUT_LINEAR;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&recorder, &cfg));
    seed = 11;
    TEST_ASSERT_INT_WITHIN(8, 195, play(min_us, max_us, T0 + 20000000));
}

static void test_samples_rarer_than_cells_and_cells_of_other_lengths_are_averaged_alike(void)
{
    static const uint32_t min_us[3] = {300, 6000, 2000}, max_us[3] = {900, 9000, 2000};
    cfg.cell_us = 1000;
    cfg.gap_us = 10000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&recorder, &cfg));
    seed = 21;
    TEST_ASSERT_INT_WITHIN(14, 956, play(min_us, max_us, T0 + 1000000));
}

static void test_samples_exactly_on_cell_borders_are_averaged_alike(void)
{
    static const uint32_t step[3] = {50000, 100000, 20000};
    auvid_sample_t s;
    int cells = 0;
    memset(track, 0, sizeof track);
    seed = 31;
    for (uint32_t k = 0; k <= 500; ++k) {
        for (int stream = 0; stream < 3; ++stream) {
            uint64_t t_us = T0 + 10000ull * k;
            if (10000u * k % step[stream] == 0) {
                TEST_ASSERT_EQUAL(AUVID_OK, feed_noted(stream, t_us, shape(stream, t_us)));
            }
        }
        while (auvid_recorder_pop(&recorder, &s) == AUVID_OK) {
            TEST_ASSERT_EQUAL_UINT64(T0 + 250000 + 100000ull * (uint64_t)cells, s.t_us);
            assert_cell(&s);
            ++cells;
        }
    }
    TEST_ASSERT_EQUAL_INT(46, cells); /* 50 cells, less two at each end */
}

/* A cell's mean of nu_dot is (nu(end) - nu(begin)) / T; the difference of means is exact up to the
 * fourth degree. Samples every millisecond: straight lines between them are off by h^2 / 8 nu''. */
static void test_acceleration_is_exact_for_polynomials_of_fourth_degree(void)
{
    auvid_sample_t s;
    int cells = 0;
    for (uint32_t k = 0; k <= 1000; ++k) {
        double t = k * 1e-3 - 0.5, x = 0.5 + t - 2 * t * t + 3 * t * t * t - 2 * t * t * t * t;
        uint64_t t_us = T0 + 1000ull * k;
        for (int stream = 0; stream < 3; ++stream) {
            TEST_ASSERT_EQUAL(AUVID_OK, feed(stream, t_us, x));
        }
        while (auvid_recorder_pop(&recorder, &s) == AUVID_OK) {
            double a = (double)(s.t_us - T0) * 1e-6 - 0.55, b = a + 0.1, f[2];
            for (int i = 0; i < 2; ++i) {
                double y = i == 0 ? a : b;
                f[i] = y - 2 * y * y + 3 * y * y * y - 2 * y * y * y * y;
            }
            double exact = (f[1] - f[0]) / 0.1;
            double rounding = 15 * 60 * (double)AUVID_EPSILON; /* 18/12/T times a hundred sums */
            TEST_ASSERT_DOUBLE_WITHIN(1e-5 + rounding, exact, (double)s.nu_dot[AUVID_SURGE]);
            TEST_ASSERT_DOUBLE_WITHIN(6e-5 + 6 * rounding, 6 * exact, (double)s.nu_dot[AUVID_YAW]);
            ++cells;
        }
    }
    TEST_ASSERT_EQUAL_INT(6, cells);
}

static void test_null_commands_are_zeros(void)
{
    auvid_real_t x[6] = {1, 1, 1, 1, 1, 1};
    auvid_sample_t s;
    memset(&s, 0xFF, sizeof s);
    for (uint32_t k = 0; k <= 60; ++k) {
        uint64_t t_us = T0 + 10000ull * k;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_attitude(&recorder, t_us, x, x));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_velocity(&recorder, t_us, x, 7u));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_input(&recorder, t_us, x, NULL));
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_pop(&recorder, &s));
    for (int i = 0; i < AUVID_MAX_COMMANDS; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)s.command[i]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, (double)s.tau[AUVID_YAW]);
}

/* ---- order of feeding ---- */

enum { TICKS = 300 };

/* Samples of ticks first .. first + count - 1 of one stream. */
static void feed_stream(int stream, int first, int count)
{
    static const uint32_t step[3] = {20000, 40000, 10000};
    for (int k = first; k < first + count; ++k) {
        uint64_t t_us = T0 + 10000ull * (uint64_t)k;
        if (10000u * (uint32_t)k % step[stream] == 0) {
            TEST_ASSERT_EQUAL(AUVID_OK, feed(stream, t_us, sin(0.1 * k + stream)));
        }
    }
}

/* Streams alternate by blocks of `block` ticks, in a rotating order. */
static int cells_by_blocks(int block, auvid_sample_t *out)
{
    int cells = 0;
    setUp();
    for (int stream = 0; stream < 3; ++stream) {
        feed_stream(stream, 0, 1); /* the record begins at the same time */
    }
    for (int first = 1; first < TICKS; first += block) {
        for (int k = 0; k < 3; ++k) {
            feed_stream((k + first) % 3, first, first + block > TICKS ? TICKS - first : block);
        }
        while (auvid_recorder_pop(&recorder, &out[cells]) == AUVID_OK) {
            ++cells;
        }
    }
    return cells;
}

static void test_order_in_which_the_streams_are_fed_does_not_change_a_bit(void)
{
    static auvid_sample_t one[64], other[64];
    int cells = cells_by_blocks(1, one);
    TEST_ASSERT_EQUAL_INT(25, cells);
    static const int block[] = {2, 7, 30, 90};
    for (size_t i = 0; i < sizeof block / sizeof block[0]; ++i) {
        TEST_ASSERT_EQUAL_INT(cells, cells_by_blocks(block[i], other));
        TEST_ASSERT_EQUAL_MEMORY(one, other, sizeof one[0] * (size_t)cells);
    }
}

/* Velocity is fed cell by cell; before each step it lags by `cells`. Returns the gaps. */
static int gaps_when_late_by(int cells)
{
    auvid_sample_t s;
    int gaps = 0;
    setUp();
    for (int k = 0; k <= 1000; ++k) {
        uint64_t t_us = T0 + 10000ull * (uint64_t)k, late_us = 100000ull * (uint64_t)(cells - 1);
        if (k == 0) {
            TEST_ASSERT_EQUAL(AUVID_OK, feed(VELOCITY, t_us, 1));
        } else if (t_us > T0 + late_us && k % 10 == 0) {
            TEST_ASSERT_EQUAL(AUVID_OK, feed(VELOCITY, t_us - late_us, 1));
        }
        auvid_status_t status;
        while ((status = auvid_recorder_pop(&recorder, &s)) != AUVID_EMPTY) {
            gaps += status == AUVID_GAP;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, feed(ATTITUDE, t_us + 5000, 1));
        TEST_ASSERT_EQUAL(AUVID_OK, feed(INPUT, t_us + 5000, 1));
    }
    return gaps;
}

static void test_slow_stream_may_lag_by_the_stored_cells_less_five(void)
{
    TEST_ASSERT_EQUAL_INT(0, gaps_when_late_by(AUVID_RECORDER_CELLS - 5));
    TEST_ASSERT_TRUE(gaps_when_late_by(AUVID_RECORDER_CELLS - 2) > 0);
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

static void test_velocity_refuses_more_than_three_axes(void)
{
    const auvid_real_t v[3] = {0};
    before = recorder;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_recorder_velocity(&recorder, T0, v, 8));
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_recorder_velocity(&recorder, T0, v, 0));
    TEST_ASSERT_EQUAL_MEMORY(&before, &recorder, sizeof recorder);
}

static void test_default_gap_is_five_velocity_samples_between_half_a_second_and_one(void)
{
    TEST_ASSERT_EQUAL_UINT32(500000, auvid_recorder_gap(0));
    TEST_ASSERT_EQUAL_UINT32(500000, auvid_recorder_gap(100000));
    TEST_ASSERT_EQUAL_UINT32(750000, auvid_recorder_gap(150000));
    TEST_ASSERT_EQUAL_UINT32(1000000, auvid_recorder_gap(200000));
    TEST_ASSERT_EQUAL_UINT32(1000000, auvid_recorder_gap(1000000));
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

/* ---- long records ---- */

static void test_a_million_cells_beyond_32_bits_of_microseconds_stay_exact(void)
{
    cfg.cell_us = 10000;
    cfg.gap_us = 100000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&recorder, &cfg));
    uint64_t t0 =
        0xFFFFFFFFull * 1000; /* begins 49 days in; lasts 2.8 hours, beyond 2^32 us more */
    auvid_real_t x[6] = {0}, nu[3] = {0};
    auvid_sample_t s;
    uint32_t cells = 0;
    for (uint32_t k = 0; k <= 1000004; ++k) {
        /* a saw tooth of 16 cells keeps its slope between the corners */
        x[0] = x[3] = (auvid_real_t)(k % 16 < 8 ? k % 16 : 16 - k % 16);
        nu[0] = -x[0];
        uint64_t t_us = t0 + 10000ull * k;
        bool ok = auvid_recorder_attitude(&recorder, t_us, x, x + 3) == AUVID_OK &&
                  auvid_recorder_velocity(&recorder, t_us, nu, 7u) == AUVID_OK &&
                  auvid_recorder_input(&recorder, t_us, x, NULL) == AUVID_OK;
        TEST_ASSERT_TRUE(ok);
        while (auvid_recorder_pop(&recorder, &s) == AUVID_OK) {
            uint32_t number = cells + 2;
            double first = number % 16 < 8 ? number % 16 : 16 - number % 16;
            double rise = number % 16 < 8 ? 1 : -1;
            bool straight = number % 8 >= 2 && number % 8 <= 5;
            bool exact = s.t_us == t0 + 10000ull * number + 5000 &&
                         fabs((double)s.phi - (first + 0.5 * rise)) < 1e-5 &&
                         fabs((double)s.tau[0] - first) < 1e-5 &&
                         (!straight || fabs((double)s.nu_dot[0] + 100 * rise) < 1e-3);
            TEST_ASSERT_TRUE(exact);
            ++cells;
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1000000, cells);
}

/* ---- refusals ---- */

static void refuse(auvid_status_t expected, auvid_status_t status)
{
    TEST_ASSERT_EQUAL(expected, status);
    TEST_ASSERT_EQUAL_MEMORY(&before, &recorder, sizeof recorder);
}

static void test_times_that_do_not_advance_are_refused_and_change_nothing(void)
{
    reset_counts();
    run(0, 55, 7, true);
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
    reset_counts();
    run(0, 55, 7, true);
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
    reset_counts();
    run(0, 55, 7, true);
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
    reset_counts();
    run(0, 55, 7, true);
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
    RUN_TEST(test_cells_are_exact_means_of_streams_at_different_irregular_rates);
    RUN_TEST(test_input_can_be_interpolated_linearly);
    RUN_TEST(test_samples_rarer_than_cells_and_cells_of_other_lengths_are_averaged_alike);
    RUN_TEST(test_samples_exactly_on_cell_borders_are_averaged_alike);
    RUN_TEST(test_acceleration_is_exact_for_polynomials_of_fourth_degree);
    RUN_TEST(test_null_commands_are_zeros);
    RUN_TEST(test_order_in_which_the_streams_are_fed_does_not_change_a_bit);
    RUN_TEST(test_slow_stream_may_lag_by_the_stored_cells_less_five);
    RUN_TEST(test_silence_longer_than_the_gap_breaks_the_record_once);
    RUN_TEST(test_silence_as_long_as_the_gap_is_bridged);
    RUN_TEST(test_silence_of_one_stream_breaks_the_record_for_all);
    RUN_TEST(test_stream_that_stops_for_good_breaks_the_record_once);
    RUN_TEST(test_stream_sampled_long_before_the_others_does_not_begin_a_record);
    RUN_TEST(test_a_velocity_that_is_not_measured_for_long_is_missing_and_breaks_no_record);
    RUN_TEST(test_a_velocity_is_interpolated_over_samples_that_do_not_measure_it);
    RUN_TEST(test_a_record_begins_with_one_velocity);
    RUN_TEST(test_a_velocity_first_sampled_late_counts_from_the_beginning);
    RUN_TEST(test_velocity_refuses_more_than_three_axes);
    RUN_TEST(test_default_gap_is_five_velocity_samples_between_half_a_second_and_one);
    RUN_TEST(test_the_period_of_the_velocity_is_the_median_of_the_first_seven_intervals);
    RUN_TEST(test_cells_wait_until_the_period_of_the_velocity_is_known);
    RUN_TEST(test_the_period_of_a_slow_velocity_is_observed_without_a_gap);
    RUN_TEST(test_a_velocity_that_is_too_slow_to_be_observed_is_a_gap);
    RUN_TEST(test_cells_that_are_not_popped_are_lost_and_reported_as_a_gap);
    RUN_TEST(test_record_after_a_gap_is_independent_of_the_previous_one);
    RUN_TEST(test_gap_leaves_the_sample_untouched);
    RUN_TEST(test_a_million_cells_beyond_32_bits_of_microseconds_stay_exact);
    RUN_TEST(test_times_that_do_not_advance_are_refused_and_change_nothing);
    RUN_TEST(test_motion_is_refused_like_its_parts);
    RUN_TEST(test_numbers_that_are_not_finite_are_refused_and_change_nothing);
    RUN_TEST(test_numbers_beyond_the_largest_are_refused_and_change_nothing);
    RUN_TEST(test_null_pointers_are_refused);
    RUN_TEST(test_init_refuses_fields_out_of_their_range_and_changes_nothing);
    RUN_TEST(test_samples_as_far_apart_as_the_largest_gap_allows_are_still_straight_lines);
    return UNITY_END();
}
