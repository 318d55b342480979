/*
 * The metric's residual path: models that give residuals instead of rows.
 */
#include <math.h>
#include <string.h>

#include "metric_cells.h"
#include "unity.h"

void setUp(void)
{
    cells_defaults();
}

void tearDown(void)
{
}

static void assert_canaries(void)
{
    const unsigned char *low = (const unsigned char *)store;
    const unsigned char *high =
        (const unsigned char *)(store + CANARY + (cfg.sets + 1) * cfg.set_rows);
    for (size_t i = 0; i < CANARY * sizeof store[0]; ++i) {
        TEST_ASSERT_EQUAL_HEX8(0xA5, low[i]);
        TEST_ASSERT_EQUAL_HEX8(0xA5, high[i]);
    }
}

/* Rows of one cell are not averaged, so both paths have the same equations. Both costs are smallest
 * at the true parameters, exactly except for rounding. */
static void test_residual_path_has_its_minimum_where_the_regressor_path_has(void)
{
    cfg.sets = 4;
    use_residual_path(1, 120);
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(4, feed(&metric, &w, 0, cells_of(&cfg, 480)));
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, auvid_metric_active(&metric));
    assert_minimum_at_truth(&metric, AUVID_G500_FREE);
}

/* Means over 0.2 s: |u| u of the mean is not the mean of |u| u, by (u' T)^2 / 12 = 1e-4 of 0.2. */
static void test_residual_path_with_rows_of_two_cells_is_within_half_a_percent(void)
{
    cfg.sets = 4;
    use_residual_path(2, 120);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 480));
    merge_all(&metric);
    for (int i = 0; i < 13; ++i) {
        auvid_real_t pi[AUVID_MAX_PARAMETERS];
        double h = 0.1 * fabs((double)truth[i]), at_truth = cost_of(&metric, truth);
        memcpy(pi, truth, sizeof pi);
        pi[i] = truth[i] + (auvid_real_t)h;
        double up = cost_of(&metric, pi);
        pi[i] = truth[i] - (auvid_real_t)h;
        double down = cost_of(&metric, pi);
        double vertex = 0.5 * h * (down - up) / (up + down - 2 * at_truth);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * h, 0, vertex);
    }
}

static void test_residual_path_gives_the_same_bits_for_any_split_of_the_budget(void)
{
    use_residual_path(2, 20);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 70));
    assert_budgets_do_not_matter();
}

static void test_residual_path_takes_one_unit_for_each_row(void)
{
    uint32_t budget = 1000;
    use_residual_path(2, 20);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 70));
    merge_all(&metric);
    auvid_metric_cost_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    TEST_ASSERT_EQUAL_UINT32(1000 - 60, budget);
}

/* Residuals are smoothed across the borders of sets, so it does not matter where sets end. */
static void test_residual_path_gives_the_same_bits_for_any_division_into_sets(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS], cost[2];
    memcpy(pi, truth, sizeof pi);
    pi[AUVID_G500_M_V] += 30;
    for (int k = 0; k < 2; ++k) {
        setUp();
        use_residual_path(2, k == 0 ? 120 : 30);
        start();
        world_t w = world_of(&cfg);
        feed(&metric, &w, 0, cells_of(&cfg, 120));
        merge_all(&metric);
        cost_of(&metric, pi);
        cost[k] = metric.result.cost;
    }
    TEST_ASSERT_EQUAL_MEMORY(&cost[0], &cost[1], sizeof cost[0]);
}

static void test_residual_path_has_its_minimum_in_the_delay_too(void)
{
    cfg.sets = 4;
    use_residual_path(2, 120);
    start();
    world_t w = world_of(&cfg);
    w.shift_s = 0.2;
    feed(&metric, &w, 0, cells_of(&cfg, 480));
    merge_all(&metric);
    double cost[3];
    for (int k = 0; k < 3; ++k) {
        uint32_t budget = UINT32_MAX;
        auvid_metric_cost_begin(&metric, truth, AUVID_C(0.1) * (auvid_real_t)(k + 1));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
        cost[k] = (double)metric.result.cost;
    }
    TEST_ASSERT_TRUE(cost[1] < 0.01 * cost[0] && cost[1] < 0.01 * cost[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.6, (double)auvid_metric_longest_delay(&metric));
}

static void test_a_record_whose_times_are_rounded_is_still_one_record(void)
{
    use_residual_path(2, 60);
    start();
    world_t w = world_of(&cfg);
    for (int k = 0; k < cells_of(&cfg, 60); ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.t_us += (uint64_t)(k % 3);
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    TEST_ASSERT_TRUE(cost_of(&metric, pi) > 1e-3);
}

/* 31 rows are smoothed at once: on each side of a gap there are thirty fewer results than rows. */
static void test_residuals_are_not_smoothed_over_a_gap(void)
{
    double sse[2];
    for (int k = 0; k < 2; ++k) {
        setUp();
        use_residual_path(2, 80);
        cfg.free = 0;
        start();
        world_t w = world_of(&cfg);
        feed(&metric, &w, 0, cells_of(&cfg, 40));
        if (k == 1) {
            auvid_metric_gap(&metric);
            feed(&metric, &w, 500, cells_of(&cfg, 40));
        } else {
            feed(&metric, &w, cells_of(&cfg, 40) * w.cell_s, 40 * cfg.row_cells);
        }
        merge_all(&metric);
        uint32_t budget = UINT32_MAX;
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
        memcpy(pi, truth, sizeof pi);
        pi[AUVID_G500_X_0] = 10; /* a residual of -10 N everywhere */
        auvid_metric_measure_begin(&metric, pi, 0);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
        sse[k] = (double)metric.result.sse[AUVID_SURGE];
    }
    TEST_ASSERT_DOUBLE_WITHIN(100, 50 * 100, sse[0]);
    TEST_ASSERT_DOUBLE_WITHIN(100, 20 * 100, sse[1]);
}

/* The residual of DoF j is its velocity, whatever pi is. */
static void velocities(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                       auvid_real_t residual[AUVID_DOF_COUNT])
{
    (void)context;
    (void)pi;
    memcpy(residual, s->nu, sizeof s->nu);
}

static double velocity_of(int cell, int j)
{
    return (cell * (7 + j) + cell / 5) % 11 - 5.0;
}

/* Rows of one cell, of which 31 are smoothed at once, with the weights C(30, i) / 2^30. */
static void test_residuals_of_all_six_dofs_are_smoothed_with_binomial_weights(void)
{
    enum { CELLS = 100 };
    static const auvid_parameter_t parameter = {.name = "a", .unit = "kg", .dof = AUVID_SURGE};
    auvid_vehicle_t six = {.built_for = AUVID_BUILD,
                           .path = &auvid_path_residual,
                           .name = "six",
                           .parameters = 1,
                           .parameter = &parameter,
                           .columns = {1, 1, 1, 1, 1, 1},
                           .residual = velocities};
    use_residual_path(1, 80);
    cfg.vehicle = &six;
    cfg.free = 0;
    start();
    for (int k = 0; k < CELLS; ++k) {
        auvid_sample_t s = {.t_us = 100000u * (uint64_t)k};
        for (int j = 0; j < 6; ++j) {
            s.nu[j] = (auvid_real_t)velocity_of(k, j);
            s.tau[j] = k % 20 < 10 ? AUVID_C(50.0) : AUVID_C(-50.0);
        }
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX8(63, metric.result.excited);
    uint32_t budget = UINT32_MAX;
    auvid_metric_measure_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
    for (int j = 0; j < 6; ++j) {
        double squares = 0;
        for (int last = 30; last < 80; ++last) {
            double smoothed = 0, weight = ldexp(1, -30);
            for (int i = 0; i <= 30; ++i) {
                smoothed += weight * velocity_of(first_row(&cfg) - 1 + last - i, j);
                weight *= (30.0 - i) / (i + 1);
            }
            squares += smoothed * smoothed;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * squares, squares, (double)metric.result.sse[j]);
    }
}

/* Heave is not measured for 1 s in every 10: no residual may read the values that replace it. */
static void test_residuals_of_what_was_not_measured_do_not_count(void)
{
    double cost[2];
    for (int marked = 0; marked < 2; ++marked) {
        cells_defaults();
        cfg.sets = 2;
        use_residual_path(2, 120);
        start();
        world_t w = world_of(&cfg);
        for (int k = 0; metric.sets.recorded < 2; ++k) {
            auvid_sample_t s = cell_at(&w, k * w.cell_s);
            if (k % 100 < 10) {
                s.nu[AUVID_HEAVE] += 1;
                s.missing = (uint8_t)(marked ? 1u << AUVID_HEAVE : 0u);
            }
            TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
        }
        merge_all(&metric);
        cost[marked] = cost_of(&metric, truth);
        uint32_t budget = UINT32_MAX;
        static auvid_metric_windows_t windows;
        auvid_metric_linearise_begin(&metric, truth, 0, 2);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_linearise(&metric, &windows, &budget));
        const auvid_set_t *set = auvid_metric_newest(&metric);
        /* of 240 cells 20 or 30, in rows of two */
        TEST_ASSERT_UINT16_WITHIN(marked ? 3 : 0, marked ? 108 : 120, set->rows_of[AUVID_SURGE]);
        TEST_ASSERT_EQUAL_UINT16(120, set->rows_of[AUVID_YAW]);
        if (marked) {
            TEST_ASSERT_TRUE(set->windows[AUVID_SURGE] < set->windows[AUVID_YAW]);
        } else {
            TEST_ASSERT_EQUAL_UINT16(set->windows[AUVID_YAW], set->windows[AUVID_SURGE]);
        }
    }
    TEST_ASSERT_TRUE(cost[1] < 1e-5);
    TEST_ASSERT_TRUE(cost[0] > 1e-2);
}

static void test_rows_are_stored_only_inside_the_storage(void)
{
    cfg.sets = 3;
    use_residual_path(1, 7);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 7 * 15));
    TEST_ASSERT_EQUAL_UINT32(15, metric.sets.recorded);
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, (feed(&metric, &w, 0, 3), auvid_metric_close(&metric)));
    feed(&metric, &w, 0, 7 * 5);
    merge_all(&metric);
    (void)cost_of(&metric, truth);
    assert_canaries();
}

static void test_residual_path_has_neither_least_squares_nor_scale(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {1}, scale[AUVID_MAX_PARAMETERS];
    use_residual_path(2, 20);
    start();
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_metric_least_squares(&metric, 1, pi));
    auvid_metric_scale(&metric, scale);
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)scale[i]);
    }
}

static void test_cost_that_is_not_finite_is_returned_unchanged(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    uint32_t budget = UINT32_MAX;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    memcpy(pi, truth, sizeof pi);
    pi[0] = AUVID_LARGEST;
    auvid_metric_cost_begin(&metric, pi, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    TEST_ASSERT_FALSE(auvid_is_finite(metric.result.cost));
    TEST_ASSERT_TRUE(cost_of(&metric, truth) < 1e-3); /* and the next one is correct */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_residual_path_has_its_minimum_where_the_regressor_path_has);
    RUN_TEST(test_residual_path_with_rows_of_two_cells_is_within_half_a_percent);
    RUN_TEST(test_residual_path_gives_the_same_bits_for_any_split_of_the_budget);
    RUN_TEST(test_residual_path_takes_one_unit_for_each_row);
    RUN_TEST(test_residual_path_gives_the_same_bits_for_any_division_into_sets);
    RUN_TEST(test_residual_path_has_its_minimum_in_the_delay_too);
    RUN_TEST(test_a_record_whose_times_are_rounded_is_still_one_record);
    RUN_TEST(test_residuals_are_not_smoothed_over_a_gap);
    RUN_TEST(test_residuals_of_all_six_dofs_are_smoothed_with_binomial_weights);
    RUN_TEST(test_residuals_of_what_was_not_measured_do_not_count);
    RUN_TEST(test_rows_are_stored_only_inside_the_storage);
    RUN_TEST(test_residual_path_has_neither_least_squares_nor_scale);
    RUN_TEST(test_cost_that_is_not_finite_is_returned_unchanged);
    return UNITY_END();
}
