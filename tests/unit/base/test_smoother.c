/*
 * Behaviour of the streaming smoother. tests/reference/test_smoother.cpp compares its numbers with
 * an independent least-squares fit.
 */
#include <math.h>
#include <string.h>

#include "auvid/smoother.h"
#include "base/auvid_smoother_centre_internal.h"
#include "unity.h"

#define POINTS 300

/* The window of most tests: 9 samples, order 3; 3 samples and order 2 in the smallest build. */
#define H (AUVID_MAX_HALF_WIDTH < 4 ? AUVID_MAX_HALF_WIDTH : 4)
#define N (2 * H + 1)
#define ORDER (H < 2 ? 2 : 3)

static auvid_smoother_t smoother;
static auvid_smoother_config_t cfg;

void setUp(void)
{
    auvid_smoother_defaults(&cfg);
    cfg.half_width = H;
    cfg.order = ORDER;
}

void tearDown(void)
{
}

/* A reproducible pseudo-random signal in [-1, 1]. */
static auvid_real_t signal(int i)
{
    uint32_t x = (uint32_t)i * 2654435761u;
    x ^= x >> 15;
    x *= 2246822519u;
    x ^= x >> 13;
    return (auvid_real_t)(int32_t)(x >> 8) * AUVID_C(1.1920929e-7) - AUVID_C(1.0);
}

/* Pushes n samples from `first` on and takes all ready outputs into y. Returns their number. */
static size_t run(auvid_smoother_t *s, int first, int n, auvid_real_t *y)
{
    size_t count = 0;
    for (int i = first; i < first + n; ++i) {
        auvid_smoother_push(s, signal(i));
        while (auvid_smoother_take(s, NULL, &y[count]) == AUVID_OK) {
            ++count;
        }
    }
    return count;
}

static size_t finish(auvid_smoother_t *s, auvid_real_t *y)
{
    size_t count = 0;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_end(s));
    while (auvid_smoother_take(s, NULL, &y[count]) == AUVID_OK) {
        ++count;
    }
    return count;
}

static auvid_status_t init_with(int half_width, int order, int derivative, auvid_real_t dt_s)
{
    auvid_smoother_config_t c = {(uint8_t)half_width, (uint8_t)order, (uint8_t)derivative, dt_s};
    return auvid_smoother_init(&smoother, &c);
}

static void test_defaults_are_the_documented_ones_and_are_accepted(void)
{
    auvid_smoother_defaults(NULL);
    auvid_smoother_defaults(&cfg);
    TEST_ASSERT_EQUAL_INT(AUVID_MAX_HALF_WIDTH < 25 ? AUVID_MAX_HALF_WIDTH : 25, cfg.half_width);
    TEST_ASSERT_EQUAL_INT(ORDER, cfg.order);
    TEST_ASSERT_EQUAL_INT(0, cfg.derivative);
    TEST_ASSERT_TRUE(cfg.dt_s == AUVID_C(0.02));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_init(&smoother, &cfg));
}

static void test_known_table_of_savitzky_and_golay_is_reproduced(void)
{
#if AUVID_MAX_HALF_WIDTH >= 2
    /* 5 points, order 2: (-3 12 17 12 -3) / 35; first derivative (-2 -1 0 1 2) / 10 */
    const auvid_real_t value[] = {-3, 12, 17, 12, -3};
    const auvid_real_t slope[] = {-2, -1, 0, 1, 2};
    const auvid_real_t over_value = AUVID_C(35.0);
    const auvid_real_t over_slope = AUVID_C(10.0);
#else
    /* 3 points, order 2: the middle sample; (-1 0 1) / 2 */
    const auvid_real_t value[] = {0, 1, 0};
    const auvid_real_t slope[] = {-1, 0, 1};
    const auvid_real_t over_value = AUVID_C(1.0);
    const auvid_real_t over_slope = AUVID_C(2.0);
#endif
    const int n = (int)(sizeof value / sizeof value[0]);
    const uint8_t h = (uint8_t)(n / 2);
    auvid_real_t c[5];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_coefficients(h, 2, 0, AUVID_C(0.1), 0, c));
    for (int i = 0; i < n; ++i) {
        TEST_ASSERT_TRUE(c[i] == value[i] / over_value);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_coefficients(h, 2, 1, AUVID_C(0.5), 0, c));
    for (int i = 0; i < n; ++i) {
        TEST_ASSERT_TRUE(c[i] == slope[i] / over_slope / AUVID_C(0.5));
    }
}

static void test_order_zero_is_the_moving_average(void)
{
    auvid_real_t c[N];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_coefficients(H, 0, 0, AUVID_C(1.0), H, c));
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_TRUE(c[i] == AUVID_C(1.0) / (auvid_real_t)N);
    }
}

static void test_the_largest_order_reproduces_the_samples(void)
{
    const int h = H < 2 ? H : 2;
    auvid_real_t c[5];
    for (int position = -h; position <= h; ++position) {
        auvid_smoother_coefficients((uint8_t)h, (uint8_t)(2 * h), 0, AUVID_C(1.0),
                                    (int16_t)position, c);
        for (int i = 0; i < 2 * h + 1; ++i) {
            TEST_ASSERT_TRUE(c[i] == (i == position + h ? AUVID_C(1.0) : AUVID_C(0.0)));
        }
    }
}

/* Sum of |c| |x|, in double: the scale of rounding errors. */
static double weight(const auvid_real_t *c, const auvid_real_t *x, int n)
{
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        sum += fabs((double)c[i] * (double)x[i]);
    }
    return sum;
}

static void test_polynomials_of_its_order_pass_unchanged_edges_included(void)
{
    const int h = AUVID_MAX_HALF_WIDTH < 20 ? AUVID_MAX_HALF_WIDTH : 20;
    auvid_real_t x[POINTS];
    auvid_real_t c[2 * AUVID_MAX_HALF_WIDTH + 1];
    for (int order = 0; order <= 5 && order <= 2 * h; ++order) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, init_with(h, order, 0, AUVID_C(1.0)));
        int taken = 0;
        for (int i = 0; i < 100; ++i) {
            x[i] = (auvid_real_t)pow((i - 50) / 50.0, order);
            auvid_smoother_push(&smoother, x[i]);
            if (i == 99) {
                auvid_smoother_end(&smoother);
            }
            auvid_real_t y;
            uint64_t sample;
            while (auvid_smoother_take(&smoother, &sample, &y) == AUVID_OK) {
                TEST_ASSERT_EQUAL_UINT32((uint32_t)taken, (uint32_t)sample);
                int first = taken < h ? 0 : (taken > 99 - h ? 99 - 2 * h : taken - h);
                auvid_smoother_coefficients((uint8_t)h, (uint8_t)order, 0, AUVID_C(1.0),
                                            (int16_t)(taken - first - h), c);
                double limit = 4.0 * (double)AUVID_EPSILON * weight(c, &x[first], 2 * h + 1);
                TEST_ASSERT_TRUE(fabs((double)y - (double)x[taken]) <= limit);
                ++taken;
            }
        }
        TEST_ASSERT_EQUAL_INT(100, taken);
    }
}

static void test_nothing_is_ready_before_the_first_window_is_full(void)
{
    auvid_real_t y = AUVID_C(7.0);
    auvid_smoother_init(&smoother, &cfg);
    for (int i = 0; i < N - 1; ++i) {
        TEST_ASSERT_EQUAL_INT(AUVID_EMPTY, auvid_smoother_push(&smoother, signal(i)));
        TEST_ASSERT_EQUAL_INT(AUVID_EMPTY, auvid_smoother_take(&smoother, NULL, &y));
        TEST_ASSERT_TRUE(y == AUVID_C(7.0));
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_push(&smoother, signal(N)));
}

static void test_the_first_window_gives_its_edge_and_middle_then_each_sample_gives_one_output(void)
{
    auvid_real_t y[POINTS];
    auvid_smoother_init(&smoother, &cfg);
    TEST_ASSERT_EQUAL_UINT32(H + 1, run(&smoother, 0, N, y));
    TEST_ASSERT_EQUAL_UINT32(1u, run(&smoother, N, 1, y));
    TEST_ASSERT_EQUAL_UINT32(20u, run(&smoother, N + 1, 20, y));
    TEST_ASSERT_EQUAL_UINT32(H, finish(&smoother, y));
    TEST_ASSERT_EQUAL_INT(AUVID_EMPTY, auvid_smoother_take(&smoother, NULL, y));
}

static void test_an_output_not_taken_is_lost_and_the_next_has_its_own_sample(void)
{
    auvid_real_t all[POINTS];
    auvid_real_t y;
    uint64_t sample = 0;
    auvid_smoother_init(&smoother, &cfg);
    run(&smoother, 0, 30, all);
    auvid_smoother_reset(&smoother);
    for (int i = 0; i < 30; ++i) {
        auvid_smoother_push(&smoother, signal(i));
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_take(&smoother, &sample, &y));
    TEST_ASSERT_EQUAL_UINT32(29 - H, (uint32_t)sample);
    TEST_ASSERT_TRUE(memcmp(&y, &all[29 - H], sizeof y) == 0);
    TEST_ASSERT_EQUAL_INT(AUVID_EMPTY, auvid_smoother_take(&smoother, &sample, &y));
}

static void test_a_record_in_two_parts_gives_the_bits_of_one_run(void)
{
    auvid_real_t one[POINTS];
    auvid_real_t two[POINTS];
    auvid_smoother_t copy;
    auvid_smoother_init(&smoother, &cfg);
    size_t n = run(&smoother, 0, 100, one);
    n += finish(&smoother, &one[n]);
    for (int cut = 0; cut <= 100; ++cut) {
        auvid_smoother_reset(&smoother);
        size_t m = run(&smoother, 0, cut, two);
        copy = smoother;
        m += run(&copy, cut, 100 - cut, &two[m]);
        m += finish(&copy, &two[m]);
        TEST_ASSERT_EQUAL_UINT32(n, m);
        TEST_ASSERT_TRUE(memcmp(one, two, n * sizeof one[0]) == 0);
    }
    TEST_ASSERT_EQUAL_UINT32(100u, n);
}

static void test_streaming_gives_what_the_coefficients_give(void)
{
    auvid_real_t y[POINTS];
    auvid_real_t c[N];
    cfg.derivative = 1;
    auvid_smoother_init(&smoother, &cfg);
    size_t n = run(&smoother, 0, 40, y);
    finish(&smoother, &y[n]);
    for (int i = 0; i < 40; ++i) {
        int first = i < H ? 0 : (i > 39 - H ? 40 - N : i - H);
        double sum = 0.0;
        double scale = 0.0;
        auvid_smoother_coefficients(H, ORDER, 1, cfg.dt_s, (int16_t)(i - first - H), c);
        for (int k = 0; k < N; ++k) {
            sum += (double)c[k] * (double)signal(first + k);
            scale += fabs((double)c[k]);
        }
        TEST_ASSERT_TRUE(fabs((double)y[i] - sum) <= 1.1 * (double)AUVID_EPSILON * scale);
    }
}

static void test_two_smoothers_do_not_interact(void)
{
    auvid_real_t single[POINTS];
    auvid_real_t beside[POINTS];
    auvid_real_t other_y[POINTS];
    auvid_smoother_t other;
    auvid_smoother_init(&smoother, &cfg);
    size_t n = run(&smoother, 0, 50, single);
    auvid_smoother_reset(&smoother);
    cfg.half_width = 1;
    cfg.order = 1;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_init(&other, &cfg));
    size_t m = 0;
    for (int i = 0; i < 50; ++i) {
        m += run(&smoother, i, 1, &beside[m]);
        run(&other, 1000 - i, 1, other_y);
    }
    TEST_ASSERT_EQUAL_UINT32(n, m);
    TEST_ASSERT_TRUE(memcmp(single, beside, n * sizeof single[0]) == 0);
}

static void test_reset_discards_the_record(void)
{
    auvid_real_t first[POINTS];
    auvid_real_t again[POINTS];
    auvid_smoother_init(&smoother, &cfg);
    size_t n = run(&smoother, 0, 23, first);
    finish(&smoother, &first[n]);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_reset(&smoother));
    TEST_ASSERT_EQUAL_UINT32(n, run(&smoother, 0, 23, again));
    TEST_ASSERT_TRUE(memcmp(first, again, n * sizeof first[0]) == 0);
}

static void test_a_sample_that_is_not_finite_is_refused_and_changes_nothing(void)
{
    volatile auvid_real_t zero = AUVID_C(0.0);
    const auvid_real_t bad[] = {AUVID_C(1.0) / zero, AUVID_C(-1.0) / zero, zero / zero};
    auvid_real_t y[POINTS];
    auvid_smoother_init(&smoother, &cfg);
    run(&smoother, 0, 12, y);
    auvid_smoother_t before = smoother;
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_smoother_push(&smoother, bad[i]));
    }
    TEST_ASSERT_TRUE(memcmp(&before, &smoother, sizeof before) == 0);
}

static void test_only_take_and_reset_are_accepted_after_the_end(void)
{
    auvid_real_t y[POINTS];
    auvid_smoother_init(&smoother, &cfg);
    run(&smoother, 0, 12, y);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_end(&smoother));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_smoother_end(&smoother));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_smoother_push(&smoother, AUVID_C(1.0)));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_smoother_take(&smoother, NULL, y));
}

static void test_a_record_shorter_than_the_window_has_no_output(void)
{
    auvid_real_t y[POINTS];
    auvid_smoother_init(&smoother, &cfg);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NO_DATA, auvid_smoother_end(&smoother));
    TEST_ASSERT_EQUAL_UINT32(0u, run(&smoother, 0, N - 1, y));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NO_DATA, auvid_smoother_end(&smoother));
    TEST_ASSERT_EQUAL_UINT32(H + 1, run(&smoother, N - 1, 1, y)); /* the record can continue */
}

static void test_a_bad_configuration_is_refused_and_changes_nothing(void)
{
    volatile auvid_real_t zero = AUVID_C(0.0);
    const auvid_real_t dt = AUVID_C(0.02);
    const auvid_smoother_t before = smoother;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, init_with(0, 0, 0, dt));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SIZE, init_with(AUVID_MAX_HALF_WIDTH + 1, 2, 0, dt));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SINGULAR, init_with(1, 3, 0, dt));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SINGULAR, init_with(1, 5, 0, dt));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, init_with(H, 6, 0, dt));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, init_with(H, 1, 2, dt));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, init_with(H, 2, 3, dt));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, init_with(H, 2, 1, zero));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, init_with(H, 2, 1, -dt));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, init_with(H, 2, 1, AUVID_C(1e-7)));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, init_with(H, 2, 1, zero / zero));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, init_with(H, 2, 1, dt / zero));
    TEST_ASSERT_TRUE(memcmp(&before, &smoother, sizeof before) == 0);
}

static void test_coefficients_of_no_smoother_are_refused_and_nothing_is_written(void)
{
    auvid_real_t c[N] = {AUVID_C(7.0)};
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE,
                          auvid_smoother_coefficients(H, 2, 0, AUVID_C(1.0), H + 1, c));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE,
                          auvid_smoother_coefficients(H, 2, 0, AUVID_C(1.0), -H - 1, c));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SIZE,
                          auvid_smoother_coefficients(AUVID_MAX_HALF_WIDTH + 1, 2, 0, 1, 0, c));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_SINGULAR, auvid_smoother_coefficients(1, 3, 0, 1, 0, c));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, auvid_smoother_coefficients(H, 2, 0, 0, 0, c));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE,
                          auvid_smoother_coefficients(H, 2, 0, (auvid_real_t)NAN, 0, c));
    TEST_ASSERT_TRUE(c[0] == AUVID_C(7.0));
}

static void test_null_pointers_are_refused(void)
{
    auvid_real_t y;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_smoother_init(NULL, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_smoother_init(&smoother, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_smoother_reset(NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_smoother_push(NULL, AUVID_C(1.0)));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_smoother_take(NULL, NULL, &y));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_smoother_take(&smoother, NULL, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_smoother_end(NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL,
                          auvid_smoother_coefficients(H, 2, 0, AUVID_C(1.0), 0, NULL));
}

static void test_the_closed_form_of_the_centre_equals_the_coefficients(void)
{
    auvid_real_t expected[2 * AUVID_MAX_HALF_WIDTH + 1], c[2 * AUVID_MAX_HALF_WIDTH + 1];
    for (int h = 1; h <= AUVID_MAX_HALF_WIDTH; ++h) {
        for (int order = 0; order <= AUVID_SMOOTHER_MAX_ORDER && order <= 2 * h; ++order) {
            TEST_ASSERT_EQUAL_INT(AUVID_OK,
                                  auvid_smoother_coefficients((uint8_t)h, (uint8_t)order, 0,
                                                              AUVID_C(1.0), 0, expected));
            auvid_smoother_centre(h, order, c);
            for (int k = 0; k <= 2 * h; ++k) {
                double error = fabs((double)c[k] - (double)expected[k]);
                double size = fabs((double)expected[order < 4 ? k : h]);
                double units = order < 4 ? 3.5 : 7.0; /* 3 of them by the coefficients */
                TEST_ASSERT_TRUE(error <= units * (double)AUVID_EPSILON * size);
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_defaults_are_the_documented_ones_and_are_accepted);
    RUN_TEST(test_known_table_of_savitzky_and_golay_is_reproduced);
    RUN_TEST(test_order_zero_is_the_moving_average);
    RUN_TEST(test_the_largest_order_reproduces_the_samples);
    RUN_TEST(test_polynomials_of_its_order_pass_unchanged_edges_included);
    RUN_TEST(test_nothing_is_ready_before_the_first_window_is_full);
    RUN_TEST(test_the_first_window_gives_its_edge_and_middle_then_each_sample_gives_one_output);
    RUN_TEST(test_an_output_not_taken_is_lost_and_the_next_has_its_own_sample);
    RUN_TEST(test_a_record_in_two_parts_gives_the_bits_of_one_run);
    RUN_TEST(test_streaming_gives_what_the_coefficients_give);
    RUN_TEST(test_two_smoothers_do_not_interact);
    RUN_TEST(test_reset_discards_the_record);
    RUN_TEST(test_a_sample_that_is_not_finite_is_refused_and_changes_nothing);
    RUN_TEST(test_only_take_and_reset_are_accepted_after_the_end);
    RUN_TEST(test_a_record_shorter_than_the_window_has_no_output);
    RUN_TEST(test_a_bad_configuration_is_refused_and_changes_nothing);
    RUN_TEST(test_coefficients_of_no_smoother_are_refused_and_nothing_is_written);
    RUN_TEST(test_null_pointers_are_refused);
    RUN_TEST(test_the_closed_form_of_the_centre_equals_the_coefficients);
    return UNITY_END();
}
