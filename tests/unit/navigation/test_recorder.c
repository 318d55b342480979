/*
 * The recorder by its contract. Cells are compared with the signals as the header defines them.
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
    RUN_TEST(test_a_million_cells_beyond_32_bits_of_microseconds_stay_exact);
    return UNITY_END();
}
