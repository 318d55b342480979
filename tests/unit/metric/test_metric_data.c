/*
 * How the metric treats its data: excitation of the DoF, contents of a stored set, delays, gaps,
 * and cells that no model can explain.
 */
#include <math.h>
#include <string.h>

#include "metric/auvid_metric_sets_internal.h"
#include "metric_cells.h"
#include "unity.h"

void setUp(void)
{
    cells_defaults();
}

void tearDown(void)
{
}

/* ---- excitation ---- */

/* Two minutes in which sway moves, but is not excited. */
static void drift_sideways(void)
{
    start();
    world_t w = world_of(&cfg);
    for (int k = 0; k < cells_of(&cfg, 120); ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.tau[AUVID_SWAY] = 0;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
}

/* m_v v r acts on surge, and (m_u - m_v) u v on yaw. */
static void test_motion_of_a_dof_that_is_not_excited_does_not_bias_the_others(void)
{
    const uint32_t drag = 1u << AUVID_G500_Y_V | 1u << AUVID_G500_Y_VV;
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    drift_sideways();
    uint32_t searched = auvid_metric_searched(&metric);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~drag, searched);
    TEST_ASSERT_EQUAL_HEX32(searched & ~(1u << AUVID_G500_M_V), auvid_metric_active(&metric));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, searched, pi));
    assert_truth(pi, searched);
}

static void test_known_parameters_of_a_dof_that_is_not_excited_are_not_searched(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    memcpy(cfg.fixed, truth, sizeof cfg.fixed);
    drift_sideways();
    uint32_t active = auvid_metric_active(&metric);
    TEST_ASSERT_EQUAL_HEX32(active, auvid_metric_searched(&metric));
    memcpy(pi, cfg.fixed, sizeof pi);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, active, pi));
    assert_truth(pi, active);
}

static void test_columns_that_are_zero_are_not_searched(void)
{
    cfg.vehicle = &auvid_girona500_decoupled;
    drift_sideways();
    uint32_t active = auvid_metric_active(&metric);
    TEST_ASSERT_EQUAL_HEX32(0, active & 1u << AUVID_G500_M_V);
    TEST_ASSERT_EQUAL_HEX32(active, auvid_metric_searched(&metric));
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_searched(NULL));
}

static void test_dof_that_is_not_excited_is_left_out(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    start();
    for (int k = 0; k < cells_of(&cfg, 120); ++k) {
        world_t w = world_of(&cfg);
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.tau[AUVID_SWAY] = AUVID_C(1.0) + AUVID_C(0.5) * (auvid_real_t)(k % 2);
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    uint32_t sway = 1u << AUVID_G500_M_V | 1u << AUVID_G500_Y_V | 1u << AUVID_G500_Y_VV;
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_SURGE | 1u << AUVID_HEAVE | 1u << AUVID_YAW,
                           metric.result.excited);
    TEST_ASSERT_EQUAL_UINT16(0, metric.result.dof_rows[AUVID_SWAY]);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~sway, auvid_metric_active(&metric));
    memcpy(pi, truth, sizeof pi);
    double at_truth = cost_of(&metric, pi);
    pi[AUVID_G500_Y_V] = 900;
    pi[AUVID_G500_Y_VV] = -900;
    TEST_ASSERT_EQUAL_DOUBLE(at_truth, cost_of(&metric, pi));
}

/* Three periods of a sine slow enough to pass the smoother, with an rms 5 % from the threshold. */
static void test_dof_is_excited_above_the_stated_part_of_its_scale(void)
{
    for (int above = 0; above < 2; ++above) {
        setUp();
        cfg.excitation_threshold = AUVID_C(0.1);
        cfg.tau_max[AUVID_YAW] = 30;
        start();
        for (int k = 0; k < cells_of(&cfg, 60); ++k) {
            world_t w = world_of(&cfg);
            auvid_sample_t s = cell_at(&w, k * w.cell_s);
            double rms = 0.1 * 30 * (above ? 1.05 : 0.95);
            s.tau[AUVID_YAW] = (auvid_real_t)(7 + rms * sqrt(2) * sin(2 * PI * 0.1 * k * 0.1));
            TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
        }
        merge_all(&metric);
        TEST_ASSERT_EQUAL(above, metric.result.excited >> AUVID_YAW & 1);
    }
}

/* Add a set of 60 s with a sine of the yaw moment of this rms. Returns whether yaw is excited. */
static bool set_excites_yaw(double rms)
{
    world_t w = world_of(&cfg);
    uint32_t recorded = metric.sets.recorded;
    auvid_metric_gap(&metric);
    for (int k = 0; metric.sets.recorded == recorded; ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.tau[AUVID_YAW] = (auvid_real_t)(rms * sqrt(2) * sin(2 * PI * 0.1 * k * 0.1));
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    return (auvid_metric_newest(&metric)->excited >> AUVID_YAW & 1) != 0;
}

/* sqrt(3) = 1.73. The rms of 60 s of the smoothed sine is 2 % off. */
static void test_dof_is_excited_above_a_multiple_of_the_residual(void)
{
    auvid_real_t rms[AUVID_DOF_COUNT] = {[AUVID_YAW] = 4};
    start();
    TEST_ASSERT_TRUE(set_excites_yaw(8.0));
    auvid_metric_set_residual(&metric, rms);
    TEST_ASSERT_FALSE(set_excites_yaw(1.65 * 4.0));
    TEST_ASSERT_TRUE(set_excites_yaw(1.8 * 4.0));
    rms[AUVID_YAW] = 1; /* a later estimate has a smaller residual */
    auvid_metric_set_residual(&metric, rms);
    TEST_ASSERT_TRUE(set_excites_yaw(1.65 * 4.0));
}

/* Else a large residual of few sets would lock out all later ones. */
static void test_any_wrench_counts_while_the_sets_have_no_more(void)
{
    const auvid_real_t rms[AUVID_DOF_COUNT] = {[AUVID_YAW] = 4};
    start();
    TEST_ASSERT_TRUE(set_excites_yaw(1.65 * 4.0));
    auvid_metric_set_residual(&metric, rms);
    TEST_ASSERT_TRUE(set_excites_yaw(4.0));
}

static void test_set_in_which_a_dof_is_not_excited_does_not_count_in_its_r2(void)
{
    auvid_real_t r2[2][6], pi[AUVID_MAX_PARAMETERS];
    memcpy(pi, truth, sizeof pi);
    pi[AUVID_G500_M_R] *= AUVID_C(1.3);
    for (int more = 0; more < 2; ++more) {
        uint32_t budget = UINT32_MAX;
        setUp();
        start();
        world_t w = world_of(&cfg);
        feed(&metric, &w, 0, cells_of(&cfg, 60));
        auvid_metric_gap(&metric);
        for (int k = 0; more && k < cells_of(&cfg, 60); ++k) {
            auvid_sample_t s = cell_at(&w, 200 + k * w.cell_s);
            s.tau[AUVID_YAW] = AUVID_C(1.4) * (auvid_real_t)(k / 100 % 2);
            TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
        }
        merge_all(&metric);
        TEST_ASSERT_EQUAL_UINT16(60, metric.result.dof_rows[AUVID_YAW]);
        TEST_ASSERT_EQUAL_UINT16(more ? 120 : 60, metric.result.dof_rows[AUVID_SURGE]);
        auvid_metric_measure_begin(&metric, pi, 0);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
        auvid_metric_r2(&metric, r2[more]);
    }
    TEST_ASSERT_TRUE(r2[0][AUVID_YAW] < AUVID_C(0.999));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)r2[0][AUVID_YAW], (double)r2[1][AUVID_YAW]);
}

static void test_no_dof_excited_is_no_data(void)
{
    uint32_t budget = 100;
    start();
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_merge(&metric, &budget));
    auvid_sample_t s;
    world_t w = world_of(&cfg);
    for (int k = 0; k < cells_of(&cfg, 60); ++k) {
        motion(&w, k * w.cell_s, &s);
        s.tau[AUVID_HEAVE] = 40; /* constant */
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_merge(&metric, &budget));
    TEST_ASSERT_EQUAL_HEX32(0, auvid_metric_active(&metric));
    TEST_ASSERT_EQUAL_UINT32(100, budget);
}

/* A fixed mass times an acceleration is not a wrench. */
static void test_what_fixed_parameters_explain_does_not_excite_a_dof(void)
{
    cfg.free = AUVID_G500_FREE & ~(1u << AUVID_G500_M_V);
    cfg.fixed[AUVID_G500_M_V] = truth[AUVID_G500_M_V];
    start();
    for (int k = 0; k < cells_of(&cfg, 60); ++k) {
        world_t w = world_of(&cfg);
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.tau[AUVID_SWAY] = 0;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX8(0, metric.result.excited & 1u << AUVID_SWAY);
}

static void test_the_force_of_fixed_parameters_is_subtracted_from_the_wrench(void)
{
    uint32_t fixed = 1u << AUVID_G500_M_U | 1u << AUVID_G500_W_B | 1u << AUVID_G500_N_RR;
    truth[AUVID_G500_X_0] = 4;
    cfg.free = AUVID_G500_FREE & ~fixed;
    memcpy(cfg.fixed, truth, sizeof cfg.fixed);
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    assert_least_squares_find_truth(AUVID_G500_FREE & ~fixed);

    auvid_real_t pi[AUVID_MAX_PARAMETERS]; /* their values are ignored */
    memcpy(pi, truth, sizeof pi);
    pi[AUVID_G500_X_UU] *= AUVID_C(1.1);
    double cost = cost_of(&metric, pi);
    pi[AUVID_G500_M_U] = -1000;
    pi[AUVID_G500_X_0] = 1000;
    TEST_ASSERT_EQUAL_DOUBLE(cost, cost_of(&metric, pi));

    uint32_t all = AUVID_G500_FREE; /* and they are not solved for */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, all, pi));
    TEST_ASSERT_EQUAL_DOUBLE(-1000, (double)pi[AUVID_G500_M_U]);
}

/* ---- stored sets ---- */

/* Pseudo-random within +-1. */
static auvid_real_t noise(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (auvid_real_t)((double)*state / 2147483648.0 - 1.0);
}

static void test_stored_entries_have_an_error_relative_to_their_column(void)
{
    static const double size[] = {1e17, 3e-30, 1, 0, 1e-20, 7e3, 250, 1e-38, 1.0 / 3};
    auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS],
        max_entry[AUVID_MAX_COLUMNS] = {0};
    uint32_t state = 1;
    start();
    int n = auvid_metric_order(&metric, 0), entries = n * (n + 1) / 2;
    for (int band = 0; band < AUVID_METRIC_BANDS; ++band) {
        for (int i = 0, at = 0; i < n; ++i) {
            for (int k = i; k < n; ++k, ++at) {
                auvid_real_t value = noise(&state) * (auvid_real_t)size[k % 9];
                metric.rows.set.factor[band][at] = value;
                max_entry[k] = (auvid_real_t)fmax((double)max_entry[k], fabs((double)value));
            }
        }
    }
    auvid_metric_pack(&metric, &metric.sets.set[0]);
    for (int band = 0, at = 0; band < AUVID_METRIC_BANDS; ++band, at -= entries) {
        for (int i = 0; i < n; ++i) {
            auvid_metric_unpack_row(&metric, &metric.sets.set[0], band, 0, i, row);
            for (int k = i; k < n; ++k, ++at) {
                double off = fabs((double)row[k] - (double)metric.rows.set.factor[band][at]);
                double unit = fmax(ldexp(1.001 * (double)max_entry[k], -15), ldexp(1, -127));
                TEST_ASSERT_TRUE(off <= unit);
            }
        }
    }
}

/* In yaw m_u and m_v have the columns -u v and u v: one pivot must be zero, or rounding would count
 * as information. */
static void test_a_column_that_depends_on_others_has_no_pivot_after_rounding(void)
{
    for (int begin = 0; begin < 60; ++begin) {
        start();
        world_t w = world_of(&cfg);
        feed(&metric, &w, 17.3 * begin, cells_of(&cfg, 2 * cfg.set_rows));
        merge_all(&metric);
        int n = auvid_metric_order(&metric, AUVID_YAW), pivots = 0;
        for (int i = 0; i < metric.layout.count[AUVID_YAW]; ++i) {
            int at = metric.layout.factor_at[AUVID_YAW] + i * n - i * (i - 1) / 2;
            pivots += metric.evaluator.merged[at] != AUVID_C(0.0);
        }
        TEST_ASSERT_EQUAL(metric.layout.count[AUVID_YAW] - 1, pivots);
    }
}

static void test_every_parameter_is_free_where_the_mask_is_zero(void)
{
    cfg.free = 0;
    start();
    world_t w = world_of(&cfg);
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    TEST_ASSERT_EQUAL_HEX32((1u << N) - 1, auvid_metric_active(&metric));
}

static void test_least_squares_report_what_the_data_do_not_determine(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    start();
    world_t w = world_of(&cfg);
    w.still[AUVID_YAW] = 1; /* N = (m_v - m_u) u v moves nothing about yaw */
    feed(&metric, &w, 0, cells_of(&cfg, 60));
    merge_all(&metric);
    pi[AUVID_G500_N_R] = 7;
    TEST_ASSERT_EQUAL(AUVID_ERR_SINGULAR, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)pi[AUVID_G500_N_R]);
    uint32_t seen =
        AUVID_G500_FREE & ~(1u << AUVID_G500_M_R | 1u << AUVID_G500_N_R | 1u << AUVID_G500_N_RR);
    pi[AUVID_G500_N_R] = 7;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, seen, pi));
    assert_truth(pi, seen);
    TEST_ASSERT_EQUAL_DOUBLE(7, (double)pi[AUVID_G500_N_R]);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_least_squares(NULL, 1, pi));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_least_squares(&metric, 1, NULL));
}

/* ---- delays ---- */

static void find_delay(double shift_s, double lag_s)
{
    start();
    world_t w = world_of(&cfg);
    w.shift_s = shift_s;
    w.lag_s = lag_s;
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    for (int j = 0; j < 6; ++j) {
        if (auvid_girona500.columns[j] != 0) {
            TEST_ASSERT_DOUBLE_WITHIN(5e-3, shift_s + lag_s, (double)metric.result.delay_s[j]);
            TEST_ASSERT_EQUAL(lag_s > 0, metric.result.first_order_lag >> j & 1);
        } else {
            TEST_ASSERT_EQUAL_DOUBLE(0, (double)metric.result.delay_s[j]);
        }
    }
}

static void test_delay_of_the_wrench_is_found_within_5_ms(void)
{
    find_delay(0.06, 0);
    find_delay(0.10, 0);
    find_delay(0.25, 0);
    find_delay(0.45, 0);
}

static void test_lag_of_the_wrench_is_found_within_5_ms_and_flagged(void)
{
    find_delay(0, 0.1);
    find_delay(0, 0.2);
}

static void test_parameters_come_back_from_a_delayed_wrench(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    find_delay(0.2, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    for (int i = 0; i < 13; ++i) { /* three nodes 0.3 s apart do not interpolate 0.14 Hz exactly */
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * fabs((double)truth[i]), (double)truth[i], (double)pi[i]);
    }
}

static void test_response_before_its_command_has_no_delay(void)
{
    start();
    world_t w = world_of(&cfg);
    w.shift_s = -0.1;
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    for (int j = 0; j < 6; ++j) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)metric.result.delay_s[j]);
    }
}

static void test_given_delay_is_used_as_it_is(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    cfg.estimate_delay = false;
    for (int j = 0; j < 6; ++j) {
        cfg.delay_s[j] = AUVID_C(0.3);
    }
    start();
    world_t w = world_of(&cfg);
    w.shift_s = 0.3; /* a node: no interpolation */
    feed(&metric, &w, 0, cells_of(&cfg, 120));
    merge_all(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, AUVID_G500_FREE, pi));
    assert_truth(pi, AUVID_G500_FREE);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.3, (double)metric.result.delay_s[AUVID_YAW]);
}

/* ---- gaps and bad cells ---- */

/* A smoothed equation holds across a jump as well; a delayed wrench does not. */
static void test_gap_inside_a_set_does_not_mix_its_two_sides(void)
{
    double whole[2];
    for (int marked = 0; marked < 2; ++marked) {
        setUp();
        cfg.estimate_delay = false;
        for (int j = 0; j < 6; ++j) {
            cfg.delay_s[j] = AUVID_C(0.3);
        }
        start();
        world_t w = world_of(&cfg);
        w.shift_s = 0.3;
        feed(&metric, &w, 0, cells_of(&cfg, 40) + 3);
        if (marked) {
            auvid_metric_gap(&metric);
        }
        TEST_ASSERT_EQUAL(1, feed(&metric, &w, 333, cells_of(&cfg, 20)));
        merge_all(&metric);
        whole[marked] = cost_of(&metric, truth) + (double)metric.result.constant;
    }
    TEST_ASSERT_TRUE(whole[1] < 1e-8);
    TEST_ASSERT_TRUE(whole[0] > 1e-4);
    auvid_metric_gap(NULL);
}

/* Two sets of cells in which a velocity is not measured for 2 s in every 20; a wrong value replaces
 * it. */
static void feed_wrong_values(int velocity, bool marked)
{
    world_t w = world_of(&cfg);
    start();
    for (int k = 0; metric.sets.recorded < 2; ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        if (k % 200 < 20) {
            s.nu[velocity] += 1;
            s.nu_dot[velocity] -= 2;
            s.missing = (uint8_t)(marked ? 1u << velocity : 0u);
        }
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
}

static void test_an_equation_has_no_row_where_a_velocity_that_it_reads_is_missing(void)
{
    for (int velocity = 0; velocity < 3; ++velocity) {
        feed_wrong_values(velocity, true);
        assert_least_squares_find_truth(AUVID_G500_FREE);
        feed_wrong_values(velocity, false);
        merge_all(&metric);
        TEST_ASSERT_TRUE(cost_of(&metric, truth) + (double)metric.result.constant > 1e-4);
    }
    feed_wrong_values(AUVID_HEAVE, true); /* yaw does not read it */
    const auvid_set_t *set = auvid_metric_newest(&metric);
    TEST_ASSERT_EQUAL_UINT16(60, set->rows);
    TEST_ASSERT_EQUAL_UINT16(60, set->rows_of[AUVID_YAW]);
    TEST_ASSERT_EQUAL_UINT16(0, set->lost);
    for (int j = 0; j < 3; ++j) {
        /* of 40 rows in 20 s, 12 have a cell without velocity among their 41 (43 with the ends) */
        TEST_ASSERT_UINT16_WITHIN(3, 60 - 60 * 12 / 40, set->rows_of[j]);
    }
    merge_all(&metric);
    TEST_ASSERT_EQUAL_UINT16(120, metric.result.dof_rows[AUVID_YAW]);
    TEST_ASSERT_UINT16_WITHIN(6, 84, metric.result.dof_rows[AUVID_HEAVE]);
}

static void test_rows_lost_to_gaps_in_the_record_are_counted(void)
{
    world_t w = world_of(&cfg);
    start();
    feed(&metric, &w, 0, cells_of(&cfg, 30));
    auvid_metric_gap(&metric);
    TEST_ASSERT_EQUAL(1, feed(&metric, &w, 333, cells_of(&cfg, 30)));
    uint32_t cost = (uint32_t)(cells_of(&cfg, 1) - 1) / cfg.row_cells;
    TEST_ASSERT_EQUAL_UINT16(cost, auvid_metric_newest(&metric)->lost);
}

static void test_cell_that_is_not_finite_is_ignored(void)
{
    world_t w = world_of(&cfg);
    start();
    feed(&metric, &w, 0, 70);
    before = metric;
    auvid_sample_t good = cell_at(&w, 7.0);
    auvid_real_t *field[] = {&good.phi,
                             &good.theta,
                             &good.psi,
                             &good.nu[5],
                             &good.nu_dot[0],
                             &good.tau[2],
                             &good.command[AUVID_MAX_COMMANDS - 1]};
    for (size_t i = 0; i < sizeof field / sizeof field[0]; ++i) {
        auvid_real_t keep = *field[i];
        *field[i] = (auvid_real_t)(i % 2 ? NAN : INFINITY);
        TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_metric_add(&metric, &good));
        TEST_ASSERT_EQUAL_MEMORY(&before, &metric, sizeof metric);
        *field[i] = keep;
    }
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_add(&metric, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_metric_add(NULL, &good));
}

/* Girona500's trigonometry ends at 1e9 rad; 1e30 squared overflows. */
static void test_rows_whose_regressor_fails_are_left_out(void)
{
    world_t w = world_of(&cfg);
    start();
    feed(&metric, &w, 0, cells_of(&cfg, 20));
    auvid_sample_t bad = cell_at(&w, cells_of(&cfg, 20) * w.cell_s);
    bad.phi = AUVID_C(1e12);
    TEST_ASSERT_TRUE(auvid_metric_add(&metric, &bad) >= 0);
    feed(&metric, &w, (cells_of(&cfg, 20) + 1) * w.cell_s, cells_of(&cfg, 40));
    merge_all(&metric);
    TEST_ASSERT_TRUE(isfinite(cost_of(&metric, truth)));
    TEST_ASSERT_TRUE(isfinite((double)metric.result.constant));
    assert_least_squares_find_truth(AUVID_G500_FREE);
}

/* The value of the faulty regressor for m_u. */
static auvid_real_t broken_entry;

static void broken_regressor(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                             auvid_regressor_t *y)
{
    auvid_girona500.regressor(context, s, pi, y);
    y->row[AUVID_SURGE][AUVID_G500_M_U] = broken_entry;
}

static void test_rows_whose_regressor_always_fails_do_not_count_as_explained(void)
{
    const auvid_real_t entries[] = {(auvid_real_t)NAN, -(auvid_real_t)INFINITY, AUVID_C(1e16)};
    auvid_vehicle_t broken = auvid_girona500;
    uint32_t budget = UINT32_MAX;
    broken.regressor = broken_regressor;
    for (int k = 0; k < 3; ++k) {
        setUp();
        cfg.vehicle = &broken;
        broken_entry = entries[k];
        world_t w = world_of(&cfg);
        start();
        feed(&metric, &w, 0, cells_of(&cfg, 2 * cfg.set_rows));
        TEST_ASSERT_EQUAL_UINT32(0, metric.sets.recorded);
        TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_close(&metric));
        auvid_metric_merge_begin(&metric);
        TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_metric_merge(&metric, &budget));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_motion_of_a_dof_that_is_not_excited_does_not_bias_the_others);
    RUN_TEST(test_known_parameters_of_a_dof_that_is_not_excited_are_not_searched);
    RUN_TEST(test_columns_that_are_zero_are_not_searched);
    RUN_TEST(test_dof_that_is_not_excited_is_left_out);
    RUN_TEST(test_dof_is_excited_above_the_stated_part_of_its_scale);
    RUN_TEST(test_dof_is_excited_above_a_multiple_of_the_residual);
    RUN_TEST(test_any_wrench_counts_while_the_sets_have_no_more);
    RUN_TEST(test_set_in_which_a_dof_is_not_excited_does_not_count_in_its_r2);
    RUN_TEST(test_no_dof_excited_is_no_data);
    RUN_TEST(test_what_fixed_parameters_explain_does_not_excite_a_dof);
    RUN_TEST(test_the_force_of_fixed_parameters_is_subtracted_from_the_wrench);
    RUN_TEST(test_stored_entries_have_an_error_relative_to_their_column);
    RUN_TEST(test_a_column_that_depends_on_others_has_no_pivot_after_rounding);
    RUN_TEST(test_every_parameter_is_free_where_the_mask_is_zero);
    RUN_TEST(test_least_squares_report_what_the_data_do_not_determine);
    RUN_TEST(test_delay_of_the_wrench_is_found_within_5_ms);
    RUN_TEST(test_lag_of_the_wrench_is_found_within_5_ms_and_flagged);
    RUN_TEST(test_parameters_come_back_from_a_delayed_wrench);
    RUN_TEST(test_response_before_its_command_has_no_delay);
    RUN_TEST(test_given_delay_is_used_as_it_is);
    RUN_TEST(test_gap_inside_a_set_does_not_mix_its_two_sides);
    RUN_TEST(test_an_equation_has_no_row_where_a_velocity_that_it_reads_is_missing);
    RUN_TEST(test_rows_lost_to_gaps_in_the_record_are_counted);
    RUN_TEST(test_cell_that_is_not_finite_is_ignored);
    RUN_TEST(test_rows_whose_regressor_fails_are_left_out);
    RUN_TEST(test_rows_whose_regressor_always_fails_do_not_count_as_explained);
    return UNITY_END();
}
