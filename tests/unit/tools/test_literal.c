/*
 * Literal smoothing. tests/reference/test_metric.cpp computes its rows and costs independently.
 */
#include "literal.h"

#include "chain.h"
#include "metric_cells.h"

static literal_t literal;
static chain_t chain;
static chain_config_t world;

void setUp(void)
{
    cells_defaults();
}

void tearDown(void)
{
}

static void begin(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, literal_metric(&literal, &cfg));
    start();
    literal_attach(&literal, &metric);
}

/* Adds `cells` cells from t on. */
static void add(double t, int cells)
{
    world_t w = world_of(&cfg);
    for (int k = 0; k < cells; ++k) {
        auvid_sample_t s = cell_at(&w, t + k * w.cell_s);
        TEST_ASSERT_TRUE(literal_add(&literal, &s) >= 0);
    }
}

static void merge(void)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, literal_merge(&metric, &budget));
}

static void test_noise_free_data_give_parameters_within_ten_percent(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    begin();
    add(0, 6 + 11 + 5 * 119);
    TEST_ASSERT_EQUAL_UINT32(2, metric.sets.recorded);
    merge();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    for (int i = 0; i < 13; ++i) { /* it is biased, and therefore not what the library does */
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * fabs((double)truth[i]), (double)truth[i], (double)pi[i]);
    }
}

static void test_the_window_is_a_second_long(void)
{
    const uint32_t cell_us[] = {100000, 50000, 20000, 1000000}, half[] = {5, 10, 25, 2};
    for (int k = 0; k < 4; ++k) {
        setUp();
        cfg.cell_us = cell_us[k];
        TEST_ASSERT_EQUAL(AUVID_OK, literal_metric(&literal, &cfg));
        TEST_ASSERT_EQUAL_UINT32(half[k], literal.half);
    }
}

static void test_a_window_or_a_row_that_does_not_fit_is_refused(void)
{
    cfg.cell_us = 9000; /* half-width 55 */
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, literal_metric(&literal, &cfg));
    setUp();
    cfg.row_cells = 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, literal_metric(&literal, &cfg));
    cfg.row_cells = LITERAL_CELLS;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, literal_metric(&literal, &cfg));
    cfg.row_cells = 2;
    TEST_ASSERT_EQUAL(AUVID_OK, literal_metric(&literal, &cfg));
}

/* Six cells for the delays, eleven for the window, then five for each row. */
static void test_a_row_is_complete_with_its_window(void)
{
    begin();
    for (int k = 0; k < 60; ++k) {
        TEST_ASSERT_EQUAL(k < 17 ? 0 : 1 + (k - 17) / 5, metric.rows.set.rows);
        add(0.1 * k, 1);
    }
}

static void test_rows_that_a_gap_costs_are_counted(void)
{
    begin();
    add(0, 10);
    literal_gap(&literal);
    TEST_ASSERT_EQUAL(10 / 5, metric.rows.set.lost);
    add(5, 60);
    literal_gap(&literal);
    TEST_ASSERT_EQUAL(10 / 5 + (6 + 10) / 5, metric.rows.set.lost);
    TEST_ASSERT_EQUAL(1 + (59 - 16) / 5, metric.rows.set.rows);
}

static void test_rows_whose_regressor_fails_are_left_out(void)
{
    auvid_sample_t bad;
    begin();
    add(0, 100);
    int rows = metric.rows.set.rows;
    world_t w = world_of(&cfg);
    bad = cell_at(&w, 10);
    bad.phi = AUVID_C(1e12); /* beyond the model's trigonometry */
    TEST_ASSERT_TRUE(literal_add(&literal, &bad) >= 0);
    add(10.1, 10);
    TEST_ASSERT_EQUAL(rows, metric.rows.set.rows);
    add(11.1, 600);
    merge();
    TEST_ASSERT_TRUE(isfinite(cost_of(&metric, truth)));
}

static void test_the_largest_speed_is_that_of_the_cells(void)
{
    begin();
    add(0, 16);
    world_t w = world_of(&cfg);
    auvid_sample_t fast = cell_at(&w, 1.6);
    fast.nu[AUVID_SURGE] = 3;
    fast.nu[AUVID_YAW] = -2;
    fast.nu[AUVID_SWAY] = 9;
    fast.missing = 1u << AUVID_SWAY;
    TEST_ASSERT_TRUE(literal_add(&literal, &fast) >= 0);
    TEST_ASSERT_EQUAL(3000, metric.rows.set.fastest[AUVID_SURGE][0]);
    TEST_ASSERT_EQUAL(2000, metric.rows.set.fastest[AUVID_YAW][1]);
    TEST_ASSERT_TRUE(metric.rows.set.fastest[AUVID_SWAY][0] < 1000);
}

static void test_an_identifier_estimates_with_it(void)
{
    chain_defaults(&world, 1, 2, 0.0);
    world.literal = &literal;
    world.id.recorder.cell_us = SIM_TICK_US;
    world.id.metric.row_cells = 25;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &world, 2));
    (void)chain_finish(&chain, 1000, 100000);
    TEST_ASSERT_EQUAL_UINT32(2, chain.id.metric.sets.recorded);
    TEST_ASSERT_EQUAL(2, chain.id.estimate.sets);
    TEST_ASSERT_FALSE(chain.over_budget);
    TEST_ASSERT_TRUE(sqrt(chain_mean_square(&chain)) < 0.15);
    TEST_ASSERT_TRUE(chain.events & AUVID_EVENT_VALIDATED);
    auvid_real_t band = chain.id.metric.evaluator.band_weight[0][AUVID_SURGE];
    TEST_ASSERT_EQUAL_DOUBLE(1, (double)band);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_noise_free_data_give_parameters_within_ten_percent);
    RUN_TEST(test_the_window_is_a_second_long);
    RUN_TEST(test_a_window_or_a_row_that_does_not_fit_is_refused);
    RUN_TEST(test_a_row_is_complete_with_its_window);
    RUN_TEST(test_rows_that_a_gap_costs_are_counted);
    RUN_TEST(test_rows_whose_regressor_fails_are_left_out);
    RUN_TEST(test_the_largest_speed_is_that_of_the_cells);
    RUN_TEST(test_an_identifier_estimates_with_it);
    return UNITY_END();
}
