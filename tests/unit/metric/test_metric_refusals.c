/*
 * What the metric rejects without any change, and the limits up to which it accepts.
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

static void assert_refused(auvid_status_t expected)
{
    memset(&metric, 0x5A, sizeof metric);
    before = metric;
    TEST_ASSERT_EQUAL(expected, auvid_metric_init(&metric, &cfg));
    TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof metric);
    setUp();
}

#define REFUSED(status, assignment)                                                                \
    do {                                                                                           \
        assignment;                                                                                \
        assert_refused(status);                                                                    \
    } while (0)

static void test_init_refuses_a_field_out_of_its_range_and_changes_nothing(void)
{
    REFUSED(AUVID_ERR_RANGE, cfg.tau_max[4] = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.tau_max[0] = -1);
    REFUSED(AUVID_ERR_RANGE, cfg.tau_max[0] = AUVID_C(0.9e-9));
    REFUSED(AUVID_ERR_RANGE, cfg.tau_max[0] = AUVID_C(1.1e9));
    REFUSED(AUVID_ERR_RANGE, cfg.excitation_threshold = AUVID_C(-0.01));
    REFUSED(AUVID_ERR_RANGE, cfg.excitation_threshold = AUVID_C(1.01));
    REFUSED(AUVID_ERR_RANGE, cfg.cell_us = 999);
    REFUSED(AUVID_ERR_RANGE, cfg.cell_us = 1000001);
    REFUSED(AUVID_ERR_RANGE, cfg.row_cells = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.set_rows = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.set_rows = 60000 / AUVID_MAX_SETS + 1);
    REFUSED(AUVID_ERR_RANGE, cfg.sets = 0);
    REFUSED(AUVID_ERR_SIZE, cfg.sets = AUVID_MAX_SETS + 1);
    REFUSED(AUVID_ERR_RANGE, cfg.lag[0] = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.lag[1] = AUVID_METRIC_LAGS + 1);
    REFUSED(AUVID_ERR_RANGE, cfg.passes = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.passes = 3);
    REFUSED(AUVID_ERR_RANGE, cfg.half_width[0] = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.half_width[1] = 0);
    REFUSED(AUVID_ERR_RANGE, cfg.delay_s[2] = AUVID_C(-0.21));
    REFUSED(AUVID_ERR_RANGE, cfg.delay_s[2] = AUVID_C(0.61));
}

static void test_init_refuses_numbers_that_are_not_finite_and_changes_nothing(void)
{
    REFUSED(AUVID_ERR_NOT_FINITE, cfg.fixed[3] = (auvid_real_t)NAN);
    REFUSED(AUVID_ERR_NOT_FINITE, cfg.tau_max[3] = (auvid_real_t)INFINITY);
    REFUSED(AUVID_ERR_NOT_FINITE, cfg.excitation_threshold = (auvid_real_t)NAN);
    REFUSED(AUVID_ERR_NOT_FINITE, cfg.delay_s[5] = (auvid_real_t)NAN);
}

static void test_init_refuses_what_exceeds_the_sizes_and_changes_nothing(void)
{
    static auvid_vehicle_t wide;
    REFUSED(AUVID_ERR_SIZE, cfg.half_width[0] = (AUVID_MAX_TAPS - 1) / 4 + 1);
    REFUSED(AUVID_ERR_SIZE, cfg.row_cells = 4); /* 41 taps over 4 cells are 11 rows at once */
    REFUSED(AUVID_ERR_SIZE, (cfg.half_width[0] = AUVID_MAX_HALF_WIDTH + 1, cfg.passes = 1));
    wide = auvid_girona500;
    wide.columns[AUVID_SURGE] |= 1u << AUVID_G500_Y_V; /* one column more: factor full */
    REFUSED(AUVID_ERR_SIZE, (cfg.vehicle = &wide, cfg.free = 0));
    for (int j = 0; j < 6; ++j) {
        wide.columns[j] = (1u << N) - 1;
    }
    REFUSED(AUVID_ERR_SIZE, (cfg.vehicle = &wide, cfg.free = 0));
    REFUSED(AUVID_ERR_SIZE, use_residual_path(AUVID_MAX_TAPS + 1, 10));
}

static void test_init_refuses_what_cannot_work_and_changes_nothing(void)
{
    static auvid_vehicle_t broken;
    REFUSED(AUVID_ERR_NULL, cfg.vehicle = NULL);
    REFUSED(AUVID_ERR_PARAMETERS, cfg.free = 1u << 20); /* none of the model's */
    broken = auvid_girona500;
    broken.parameters = 0;
    REFUSED(AUVID_ERR_PARAMETERS, cfg.vehicle = &broken);
    broken = auvid_girona500;
    broken.regressor = NULL;
    broken.path = &auvid_path_residual;
    REFUSED(AUVID_ERR_MODEL, cfg.vehicle = &broken);
    REFUSED(AUVID_ERR_MODEL, (use_residual_path(2, 10), cfg.rows = NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_init(NULL, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_init(&metric, NULL));
}

static void test_largest_filter_that_fits_is_accepted(void)
{
    cfg.half_width[0] = (AUVID_MAX_TAPS - 1) / 4;
    cfg.row_cells = 6;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    assert_least_squares_find_truth(AUVID_G500_FREE);
}

static void test_rows_further_apart_than_the_filter_is_long_are_formed(void)
{
    cfg.half_width[0] = cfg.half_width[1] = 2;
    cfg.passes = 1;
    cfg.row_cells = 9;
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(1, feed(&metric, &w, 0, cells_of(&cfg, 60)));
    assert_least_squares_find_truth(AUVID_G500_FREE);
}

static void test_null_pointers_are_refused_or_a_no_op(void)
{
    uint32_t budget = 1;
    auvid_real_t x[AUVID_MAX_PARAMETERS];
    start();
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_merge(NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_merge(&metric, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_cost(NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_cost(&metric, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_measure(NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_measure(&metric, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_drop(NULL, 0));
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_active(NULL));
    auvid_metric_defaults(NULL, NULL);
    auvid_metric_merge_begin(NULL);
    auvid_metric_cost_begin(&metric, NULL, 0);
    auvid_metric_measure_begin(NULL, truth, 0);
    auvid_metric_scale(NULL, x);
    auvid_metric_scale(&metric, NULL);
    auvid_metric_r2(NULL, x);
    auvid_metric_r2(&metric, NULL);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)auvid_metric_longest_delay(NULL));
}

/* Only W-B acts: no DoF is excited. */
static world_t still_world(void)
{
    world_t w = world_of(&cfg);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        w.still[j] = 1;
    }
    return w;
}

static auvid_status_t feed_to_the_end(const world_t *w)
{
    auvid_status_t status = AUVID_OK;
    for (int k = 0; k < 1000 && status == AUVID_OK; ++k) {
        auvid_sample_t s = cell_at(w, k * w->cell_s);
        status = auvid_metric_add(&metric, &s);
    }
    return status;
}

static void test_add_and_close_tell_of_a_set_that_is_complete_or_idle(void)
{
    for (int idle = 0; idle < 2; ++idle) {
        start();
        world_t w = idle ? still_world() : world_of(&cfg);
        TEST_ASSERT_EQUAL(idle ? AUVID_SET_IDLE : AUVID_SET_COMPLETE, feed_to_the_end(&w));
        feed(&metric, &w, 0, cells_of(&cfg, 3));
        TEST_ASSERT_EQUAL(idle ? AUVID_SET_IDLE : AUVID_SET_COMPLETE, auvid_metric_close(&metric));
    }
}

static void test_a_held_ring_delays_a_set_of_the_residual_path(void)
{
    for (int idle = 0; idle < 2; ++idle) {
        cells_defaults();
        use_residual_path(2, 60);
        start();
        world_t w = idle ? still_world() : world_of(&cfg);
        auvid_metric_hold(&metric, UINT64_MAX);
        feed(&metric, &w, 0, cells_of(&cfg, 30));
        TEST_ASSERT_EQUAL(idle ? AUVID_SET_IDLE : AUVID_PENDING, auvid_metric_close(&metric));
        TEST_ASSERT_EQUAL(idle ? AUVID_OK : AUVID_SET_COMPLETE, auvid_metric_release(&metric, 0));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_release(&metric, 0)); /* nothing waits */
    }
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_release(NULL, 0));
}

static void test_a_budget_of_one_unit_leaves_work(void)
{
    auvid_metric_change_t change;
    uint32_t budget = 1;
    start();
    world_t w = world_of(&cfg);
    TEST_ASSERT_EQUAL(3, feed(&metric, &w, 0, cells_of(&cfg, 3 * 60)));
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_metric_merge(&metric, &budget));
    merge_all(&metric);
    budget = 1;
    auvid_metric_measure_begin(&metric, truth, 0);
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_metric_measure(&metric, &budget));
    budget = 1;
    auvid_metric_change_begin(&metric, &change, 0);
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_metric_change(&metric, &change, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_change(NULL, &change, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_change(&metric, &change, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_change(&metric, NULL, &budget));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_init_refuses_a_field_out_of_its_range_and_changes_nothing);
    RUN_TEST(test_init_refuses_numbers_that_are_not_finite_and_changes_nothing);
    RUN_TEST(test_init_refuses_what_exceeds_the_sizes_and_changes_nothing);
    RUN_TEST(test_init_refuses_what_cannot_work_and_changes_nothing);
    RUN_TEST(test_largest_filter_that_fits_is_accepted);
    RUN_TEST(test_rows_further_apart_than_the_filter_is_long_are_formed);
    RUN_TEST(test_null_pointers_are_refused_or_a_no_op);
    RUN_TEST(test_add_and_close_tell_of_a_set_that_is_complete_or_idle);
    RUN_TEST(test_a_held_ring_delays_a_set_of_the_residual_path);
    RUN_TEST(test_a_budget_of_one_unit_leaves_work);
    return UNITY_END();
}
