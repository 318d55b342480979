/*
 * The metric through its header: noise-free cells of known parameters, so that every smoother must
 * return the parameters. tests/reference/test_metric.cpp compares numbers with an independent
 * pipeline.
 */
#include <math.h>
#include <string.h>

#include "auvid/smoother.h"
#include "metric_cells.h"
#include "sines.h"
#include "unity.h"

void setUp(void)
{
    cells_defaults();
}

void tearDown(void)
{
}

/* ---- parameters are recovered ---- */

static void test_least_squares_give_the_parameters_of_noise_free_cells_back(void)
{
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(2, feed(&metric, &w, 0, cells_of(&cfg, 120)));
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_SURGE | 1u << AUVID_SWAY | 1u << AUVID_HEAVE |
                               1u << AUVID_YAW,
                           metric.result.excited);
    for (int j = 0; j < 6; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-3, 0, (double)metric.result.delay_s[j]);
    }
}

/* J is quadratic: its minimum is where the derivative along each parameter vanishes. The vertex of
 * the parabola through three points is exact except for rounding. */
static void test_cost_is_smallest_at_the_true_parameters(void)
{
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    assert_minimum_at_truth(&metric, AUVID_G500_FREE);
}

static void test_measurement_of_the_true_parameters_has_r2_of_one(void)
{
    auvid_real_t r2[6];
    uint32_t budget = UINT32_MAX;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    auvid_metric_measure_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
    auvid_metric_r2(&metric, r2);
    for (int j = 0; j < 6; ++j) {
        bool modelled = auvid_girona500.columns[j] != 0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, modelled ? 1 : 0, (double)r2[j]);
    }
}

/* The cost is of the ring's only set. The residuals of the bands differ, because noise is smoothed.
 * */
static void test_a_prediction_weighs_the_bands_as_the_cost_does(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    uint64_t state = 7;
    uint32_t budget = UINT32_MAX;
    cfg.sets = 1;
    start();
    world_t w = world_of(&cfg);
    for (int k = 0; metric.sets.recorded == 0; ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            s.tau[j] += (auvid_real_t)(10 * sines_gauss(&state));
        }
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        pi[i] = truth[i] * AUVID_C(1.02);
    }
    double cost = cost_of(&metric, pi) + (double)metric.result.constant, weighed = 0, plain = 0;
    auvid_metric_predict_begin(&metric, pi, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double scale = pow((double)cfg.tau_max[j], 2) * metric.result.dof_rows[j];
        weighed += scale > 0 ? (double)auvid_metric_predicted(&metric, j) / scale : 0;
        plain += scale > 0 ? (double)metric.result.sse[j] / scale : 0;
    }
    TEST_ASSERT_TRUE(fabs(plain - cost) > 0.05 * cost);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * cost, cost, weighed);
}

/* ---- budgets ---- */

static void test_any_split_of_the_budget_gives_the_same_bits(void)
{
    cfg.set_rows = 20;
    start();
    world_t w = world_of(&cfg);
    w.shift_s = 0.1;
    feed(&metric, &w, 0, cells_of(&cfg, 100));
    assert_budgets_do_not_matter();
}

static void test_a_cost_takes_one_unit_for_each_row_of_r(void)
{
    uint32_t budget = 1000;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    auvid_metric_cost_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    TEST_ASSERT_EQUAL_UINT32(1000 - (6 + 6 + 6 + 5), budget);
    budget = 0;
    auvid_metric_cost_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_metric_cost(&metric, &budget));
    TEST_ASSERT_EQUAL_UINT32(0, budget);
}

static void test_a_merge_takes_three_passes_and_twenty_units_for_each_dof(void)
{
    uint32_t budget = 1000000;
    cfg.set_rows = 20;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 100));
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&metric, &budget));
    uint32_t rows = 5 * 2 * (9 + 9 + 9 + 8);
    /* rotating a row costs four, measuring its residual one */
    TEST_ASSERT_EQUAL_UINT32(1000000 - (2 * 4 * rows + rows + 3 * 20 * 4), budget);
}

/* ---- the ring ---- */

static void feed_wrong_set(int rows)
{
    static auvid_real_t wrong[AUVID_MAX_PARAMETERS];
    for (int i = 0; i < N; ++i) {
        wrong[i] = truth[i] * AUVID_C(1.5);
    }
    world_t w = world_of(&cfg);
    w.pi = wrong;
    auvid_metric_gap(&metric);
    feed(&metric, &w, 1000, cells_of(&cfg, rows));
    auvid_metric_gap(&metric);
}

static void test_ninth_set_drops_the_first(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    world_t w = world_of(&cfg);
    start();
    feed_wrong_set(60);
    TEST_ASSERT_EQUAL(7, feed(&metric, &w, 0, cells_of(&cfg, 7 * 60)));
    merge_all(&metric);
    TEST_ASSERT_EQUAL_UINT16(8 * 60, metric.result.dof_rows[AUVID_SURGE]);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    TEST_ASSERT_TRUE(fabs((double)pi[0] - (double)truth[0]) > 0.01 * (double)truth[0]);

    TEST_ASSERT_EQUAL(1, feed(&metric, &w, cells_of(&cfg, 7 * 60) * w.cell_s, 60 * 5));
    TEST_ASSERT_EQUAL_UINT32(9, metric.sets.recorded);
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_UINT16(8 * 60, metric.result.dof_rows[AUVID_SURGE]);
}

static void test_ring_of_one_set_keeps_the_last(void)
{
    cfg.sets = 1;
    start();
    feed_wrong_set(60);
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_UINT16(60, metric.result.dof_rows[AUVID_SURGE]);
}

static void test_a_dropped_set_is_deleted_and_cannot_be_dropped_again(void)
{
    world_t w = world_of(&cfg);
    start();
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_drop(&metric, 0));
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    feed_wrong_set(60);
    auvid_metric_gap(&metric);
    feed(&metric, &w, 100, cells_of(&cfg, 60));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_drop(&metric, 3));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_drop(&metric, 8));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_drop(&metric, 1));
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_UINT16(2 * 60, metric.result.dof_rows[AUVID_SURGE]);
    before = metric;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_drop(&metric, 1));
    TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof metric);
}

static void test_the_newest_set_is_not_a_deleted_one(void)
{
    world_t w = world_of(&cfg);
    start();
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    uint32_t first = auvid_metric_newest(&metric)->number;
    auvid_metric_gap(&metric);
    feed(&metric, &w, 100, cells_of(&cfg, 60));
    TEST_ASSERT_EQUAL_UINT32(first + 1, auvid_metric_newest(&metric)->number);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_drop(&metric, 0));
    TEST_ASSERT_EQUAL_UINT32(first, auvid_metric_newest(&metric)->number);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_drop(&metric, 1));
    TEST_ASSERT_EQUAL_UINT16(0, auvid_metric_newest(&metric)->rows);
}

static void test_close_of_an_empty_set_is_refused(void)
{
    start();
    before = metric;
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_close(&metric));
    TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof metric);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_close(NULL));
}

static void test_set_closed_early_counts_its_rows(void)
{
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(0, feed(&metric, &w, 0, cells_of(&cfg, 59)));
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, auvid_metric_close(&metric));
    TEST_ASSERT_EQUAL_UINT32(1, metric.sets.recorded);
    assert_least_squares_find_truth(AUVID_G500_FREE);
    TEST_ASSERT_EQUAL_UINT16(59, metric.result.dof_rows[AUVID_YAW]);
}

static void test_a_set_completes_with_its_last_row_and_not_before(void)
{
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(0, feed(&metric, &w, 0, cells_of(&cfg, 60) - 1));
    TEST_ASSERT_EQUAL(1, feed(&metric, &w, (cells_of(&cfg, 60) - 1) * w.cell_s, 1));
}

/* Pairs of rows reach across the border of two sets: many small sets give the result of a large
 * one. */
static void test_sets_of_one_row_use_pairs_across_their_borders(void)
{
    cfg.set_rows = 1;
    cfg.sets = AUVID_MAX_SETS;
    cfg.excitation_threshold = 0;
    cfg.free = 1u << AUVID_G500_M_R | 1u << AUVID_G500_N_R;
    memcpy(cfg.fixed, truth, sizeof cfg.fixed);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 12));
    for (int s = 0; s < AUVID_MAX_SETS; ++s) { /* a single row has no variance: not excited */
        TEST_ASSERT_EQUAL_HEX8(0, metric.sets.set[s].excited);
    }
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_merge(&metric, &budget));

    cfg.set_rows = 2;
    start();
    feed(&metric, &w, 0, cells_of(&cfg, 2 * AUVID_MAX_SETS + 2));
    assert_least_squares_find_truth(cfg.free);
}

/* ---- change test ---- */

static auvid_metric_change_t change;

static void compute_change(double sag)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_change_begin(&metric, &change, (auvid_real_t)sag);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_change(&metric, &change, &budget));
}

/* The vehicle gets 2 % less of the wrench in each set than in the one before, also in one without
 * thrust. */
static void test_thrust_that_sags_as_assumed_is_no_change(void)
{
    const double sag = 0.02;
    world_t w = world_of(&cfg);
    start();
    for (int set = 0, k = 0; set < 5; ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            s.tau[j] *= (auvid_real_t)(set == 2 ? 0.0 : 1.0 / (1.0 + sag * (4 - set)));
        }
        if (auvid_metric_add(&metric, &s) == (set == 2 ? AUVID_SET_IDLE : AUVID_SET_COMPLETE)) {
            auvid_metric_gap(&metric); /* no row is of two sets */
            ++set;
        }
    }
    merge_all(&metric); /* weights of the bands */
    compute_change(0.0);
    auvid_metric_change_t without = change;
    compute_change(-sag);
    auvid_metric_change_t contrary = change;
    compute_change(sag);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int newest = 0; newest < 2 && metric.layout.count[j] > 0; ++newest) {
            double blind = (double)without.change[newest][j];
            TEST_ASSERT_TRUE(blind > 1.0);
            TEST_ASSERT_DOUBLE_WITHIN(0.001 * blind, 0.0, (double)change.change[newest][j]);
            TEST_ASSERT_TRUE((double)contrary.change[newest][j] > 2.0 * blind);
        }
    }
}

/* ---- the smoother ---- */

/* The kernel has the bits of smoother.h up to half-width 13, whose numerators are below 2^24. For
 * more it rounds once, the smoother three times. */
static void test_one_pass_has_the_weights_of_savitzky_golay_of_order_2(void)
{
    const int widest = (AUVID_MAX_TAPS - 1) / 2;
    cfg.passes = 1;
    cfg.row_cells = AUVID_MAX_TAPS;
    for (uint8_t h = 1; h <= widest && h <= AUVID_MAX_HALF_WIDTH; ++h) {
        auvid_real_t c[2 * AUVID_MAX_HALF_WIDTH + 1];
        cfg.half_width[0] = cfg.half_width[1] = h;
        start();
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_smoother_coefficients(h, 2, 0, 1, 0, c));
        for (int k = 0; k <= 2 * h; ++k) {
            double tolerance = h <= 13 ? 0 : 2 * (double)AUVID_EPSILON * fabs((double)c[k]);
            TEST_ASSERT_DOUBLE_WITHIN(tolerance, (double)c[k], (double)metric.layout.kernel[0][k]);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_least_squares_give_the_parameters_of_noise_free_cells_back);
    RUN_TEST(test_cost_is_smallest_at_the_true_parameters);
    RUN_TEST(test_measurement_of_the_true_parameters_has_r2_of_one);
    RUN_TEST(test_a_prediction_weighs_the_bands_as_the_cost_does);
    RUN_TEST(test_any_split_of_the_budget_gives_the_same_bits);
    RUN_TEST(test_a_cost_takes_one_unit_for_each_row_of_r);
    RUN_TEST(test_a_merge_takes_three_passes_and_twenty_units_for_each_dof);
    RUN_TEST(test_ninth_set_drops_the_first);
    RUN_TEST(test_ring_of_one_set_keeps_the_last);
    RUN_TEST(test_a_dropped_set_is_deleted_and_cannot_be_dropped_again);
    RUN_TEST(test_the_newest_set_is_not_a_deleted_one);
    RUN_TEST(test_close_of_an_empty_set_is_refused);
    RUN_TEST(test_set_closed_early_counts_its_rows);
    RUN_TEST(test_a_set_completes_with_its_last_row_and_not_before);
    RUN_TEST(test_sets_of_one_row_use_pairs_across_their_borders);
    RUN_TEST(test_thrust_that_sags_as_assumed_is_no_change);
    RUN_TEST(test_one_pass_has_the_weights_of_savitzky_golay_of_order_2);
    return UNITY_END();
}
