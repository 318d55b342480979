/* Statistics over field runs: wrong flags, and intervals. */
#include "field/field_table.h"

#include <math.h>
#include <string.h>

#include "report/report.h"
#include "unity.h"

enum { RUNS = 160 };

static field_table_t table;
static field_record_t run;

/* A run in which everything is flagged and correct, with standard errors of 5 %. */
void setUp(void)
{
    static const double truth[SIM_PARAMETERS] = {250, 370,  660, 75,   -37, -42, -125,
                                                 -76, -448, -44, -325, -21, -61};
    memset(&run, 0, sizeof run);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        run.truth.si[i] = run.truth.reported[i] = run.pi[i] = truth[i];
        run.sigma[i] = 0.05 * fabs(truth[i]);
        run.estimated[i] = run.flagged[i] = true;
    }
    for (int e = 0; e < FIELD_EQUATIONS; ++e) {
        run.tau_max[e] = e == 3 ? 40 : 100;
        run.truth.speed[e][0] = 0.6;
        run.truth.speed[e][1] = 0.4;
        run.truth.acceleration[e] = 0.2;
    }
    for (int k = 0; k < FIELD_PARTS; ++k) {
        for (int d = 0; d < FIELD_DIRECTIONS; ++d) {
            double speed = field_part[k] * run.truth.speed[d / 2][d % 2];
            run.force[k][d].value = field_drag(truth, d / 2, d % 2 == 0 ? speed : -speed);
            run.force[k][d].half = 0.1 * fabs(run.force[k][d].value);
            run.force[k][d].estimated = run.force[k][d].flagged = true;
        }
    }
    TEST_ASSERT_TRUE(field_table_begin(&table, RUNS));
}

void tearDown(void)
{
    field_table_free(&table);
}

static const field_figure_t *finish(void)
{
    TEST_ASSERT_TRUE(field_table_finish(&table, 1));
    return table.figure;
}

static bool is_wrong(int i)
{
    return field_is_wrong(&run, i, run.truth.si);
}

/* ---- wrong ---- */

static void test_within_20_percent_is_never_wrong(void)
{
    run.pi[SIM_M_U] = 1.19 * run.truth.si[SIM_M_U]; /* 9.5 N of 100 */
    TEST_ASSERT_FALSE(is_wrong(SIM_M_U));
}

static void test_a_mass_is_wrong_by_the_force_error_at_the_largest_acceleration(void)
{
    run.pi[SIM_M_U] = 1.3 * run.truth.si[SIM_M_U]; /* 75 kg */
    run.truth.acceleration[0] = 2.1 / 75;
    TEST_ASSERT_TRUE(is_wrong(SIM_M_U));
    run.truth.acceleration[0] = 1.9 / 75;
    TEST_ASSERT_FALSE(is_wrong(SIM_M_U));
}

static void test_drag_is_wrong_by_the_force_error_at_the_largest_speed_of_both_directions(void)
{
    run.pi[SIM_X_U] = run.truth.si[SIM_X_U] - 10;
    run.pi[SIM_X_UU] = run.truth.si[SIM_X_UU] + 50;
    run.truth.speed[0][0] = 0.1;
    run.truth.speed[0][1] = 0.21;
    TEST_ASSERT_TRUE(is_wrong(SIM_X_U));
    TEST_ASSERT_TRUE(is_wrong(SIM_X_UU));
    run.truth.speed[0][1] = 0.19;
    TEST_ASSERT_FALSE(is_wrong(SIM_X_U));
    TEST_ASSERT_FALSE(is_wrong(SIM_X_UU));
}

static void test_a_moment_is_compared_with_tau_max_of_yaw(void)
{
    run.pi[SIM_M_R] = run.truth.si[SIM_M_R] + 30;
    run.truth.acceleration[3] = 0.9 / 30;
    TEST_ASSERT_TRUE(is_wrong(SIM_M_R));
    run.truth.acceleration[3] = 0.7 / 30;
    TEST_ASSERT_FALSE(is_wrong(SIM_M_R));
}

static void test_weight_is_wrong_only_by_its_force(void)
{
    run.pi[SIM_WB] = run.truth.si[SIM_WB] + 2.1; /* 5.7 % */
    TEST_ASSERT_TRUE(is_wrong(SIM_WB));
    run.truth.si[SIM_WB] = 0.1;
    run.pi[SIM_WB] = 2.0; /* 1900 % */
    TEST_ASSERT_FALSE(is_wrong(SIM_WB));
}

static void test_an_estimate_that_is_not_a_number_is_wrong(void)
{
    run.pi[SIM_M_U] = NAN;
    TEST_ASSERT_TRUE(is_wrong(SIM_M_U));
}

/* ---- shares ---- */

static void test_shares_are_of_flags_and_by_class(void)
{
    run.pi[SIM_M_U] *= 1.5;
    run.flagged[SIM_M_W] = false;
    run.flagged[SIM_X_U] = run.flagged[SIM_Y_V] = false;
    field_table_add(&table, &run);
    const field_figure_t *f = finish();
    TEST_ASSERT_EQUAL_DOUBLE(10.0 / 13, f[FIELD_AT(FIELD_FLAGGED, FIELD_ALL)].value);
    TEST_ASSERT_EQUAL_DOUBLE(3.0 / 4, f[FIELD_AT(FIELD_FLAGGED, FIELD_MASSES)].value);
    TEST_ASSERT_EQUAL_DOUBLE(2.0 / 4, f[FIELD_AT(FIELD_FLAGGED, FIELD_LINEAR)].value);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, f[FIELD_AT(FIELD_FLAGGED, FIELD_QUADRATIC)].value);
    TEST_ASSERT_EQUAL_DOUBLE(1.0 / 10, f[FIELD_AT(FIELD_WRONG, FIELD_ALL)].value);
    TEST_ASSERT_EQUAL_DOUBLE(1.0 / 3, f[FIELD_AT(FIELD_WRONG, FIELD_MASSES)].value);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, f[FIELD_AT(FIELD_WRONG, FIELD_CLASSES + SIM_M_U)].value);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, f[FIELD_AT(FIELD_WRONG, FIELD_CLASSES + SIM_M_V)].value);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, f[FIELD_AT_WRONG_RUN].value);
}

static void test_beyond_uses_the_printed_half_width(void)
{
    run.pi[SIM_M_U] += (HALF_WIDTH + 0.01) * run.sigma[SIM_M_U];
    run.pi[SIM_M_V] -= (HALF_WIDTH - 0.01) * run.sigma[SIM_M_V];
    field_table_add(&table, &run);
    const field_figure_t *f = finish();
    TEST_ASSERT_EQUAL_DOUBLE(1.0 / 4, f[FIELD_AT(FIELD_BEYOND, FIELD_MASSES)].value);
    TEST_ASSERT_EQUAL_DOUBLE(2.0 / 4, f[FIELD_AT(FIELD_WITHIN_1, FIELD_MASSES)].value);
    double mean = (2.11 * 2.11 + 2.09 * 2.09) / 4;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, sqrt(mean), f[FIELD_AT(FIELD_OVER_SIGMA, FIELD_MASSES)].value);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.05 * sqrt(mean),
                              f[FIELD_AT(FIELD_ERROR_FLAGGED, FIELD_MASSES)].value);
}

static void test_flags_are_also_compared_with_the_truth_for_reported_thrust(void)
{
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        run.pi[i] *= 1.3; /* all thrusters weaker than reported */
        run.truth.reported[i] *= 1.3;
    }
    field_table_add(&table, &run);
    const field_figure_t *f = finish();
    TEST_ASSERT_EQUAL_DOUBLE(1, f[FIELD_AT(FIELD_WRONG, FIELD_MASSES)].value);
    TEST_ASSERT_EQUAL_DOUBLE(1, f[FIELD_AT(FIELD_BEYOND, FIELD_ALL)].value);
    TEST_ASSERT_EQUAL_DOUBLE(0, f[FIELD_AT(FIELD_TOLD_WRONG, FIELD_ALL)].value);
    TEST_ASSERT_EQUAL_DOUBLE(0, f[FIELD_AT(FIELD_TOLD_BEYOND, FIELD_ALL)].value);
}

static void test_the_relative_error_excludes_weight(void)
{
    run.truth.si[SIM_WB] = 0;
    run.pi[SIM_WB] = 3;
    field_table_add(&table, &run);
    const field_figure_t *f = finish();
    TEST_ASSERT_EQUAL_DOUBLE(0, f[FIELD_AT(FIELD_ERROR, FIELD_ALL)].value);
    TEST_ASSERT_EQUAL_DOUBLE(12, f[FIELD_AT(FIELD_ERROR, FIELD_ALL)].whole);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.03, f[FIELD_AT(FIELD_ERROR, FIELD_WEIGHT)].value);
}

static void test_without_flags_there_are_no_figures_of_flags(void)
{
    memset(run.flagged, 0, sizeof run.flagged);
    field_table_add(&table, &run);
    const field_figure_t *f = finish();
    TEST_ASSERT_EQUAL_DOUBLE(0, f[FIELD_AT(FIELD_FLAGGED, FIELD_ALL)].value);
    TEST_ASSERT_TRUE(isnan(f[FIELD_AT(FIELD_WRONG, FIELD_ALL)].value));
    TEST_ASSERT_TRUE(isnan(f[FIELD_AT(FIELD_WRONG, FIELD_ALL)].high));
    TEST_ASSERT_EQUAL_DOUBLE(0, f[FIELD_AT_WRONG_RUN].value);
}

static void test_notes_are_counted(void)
{
    run.note[SIM_X_U] = run.note[SIM_Y_V] = AUVID_NOTE_COMBINATION;
    field_table_add(&table, &run);
    const field_figure_t *f = finish() + FIELD_AT_NOTE;
    TEST_ASSERT_EQUAL_DOUBLE(2.0 / 13, f[AUVID_NOTE_COMBINATION].value);
    TEST_ASSERT_EQUAL_DOUBLE(11.0 / 13, f[AUVID_NOTE_NONE].value);
}

/* ---- drag forces ---- */

static void test_forces_are_compared_with_the_truth_flagged_or_not(void)
{
    field_force_t *force = run.force[1];
    force[0].value *= 1.25; /* of 28 N: wrong */
    force[2].value *= 1.25;
    force[2].flagged = false; /* wrong, but not flagged */
    force[4].value *= 1.15;   /* beyond */
    force[6].estimated = force[6].flagged = false;
    force[6].half = HUGE_VAL;
    field_table_add(&table, &run);
    const field_figure_t *f = finish() + FIELD_AT_FORCE + 1;
    TEST_ASSERT_EQUAL_DOUBLE(2.0 / 7, f[FIELD_FORCE_OFF * FIELD_PARTS].value);
    TEST_ASSERT_EQUAL_DOUBLE(6.0 / 8, f[FIELD_FORCE_FLAGGED * FIELD_PARTS].value);
    TEST_ASSERT_EQUAL_DOUBLE(1.0 / 6, f[FIELD_FORCE_WRONG * FIELD_PARTS].value);
    TEST_ASSERT_EQUAL_DOUBLE(2.0 / 6, f[FIELD_FORCE_BEYOND * FIELD_PARTS].value);
    TEST_ASSERT_EQUAL_DOUBLE(4.0 / 7, f[FIELD_FORCE_WITHIN * FIELD_PARTS].value);
    TEST_ASSERT_EQUAL_DOUBLE(0, f[FIELD_FORCE_OFF * FIELD_PARTS + 1].value);
}

/* ---- the curve ---- */

static void test_the_curve_flags_by_width_unless_another_reason_forbids(void)
{
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        run.sigma[i] = 0.27 / HALF_WIDTH * fabs(run.pi[i]);
        run.flagged[i] = false;
        run.note[i] = AUVID_NOTE_UNCERTAIN;
    }
    run.note[SIM_M_U] = AUVID_NOTE_AT_BOUND;
    run.pi[SIM_M_V] *= 1.25;
    run.sigma[SIM_M_V] *= 1.25;
    field_table_add(&table, &run);
    const field_figure_t *f = finish() + FIELD_AT_CURVE;
    for (int k = 0; k < FIELD_LIMITS;
         ++k) { /* all except W-B, which keeps the flag of the library */
        double share = field_limit[k] < 0.27 ? 0.0 : 11.0 / 13;
        TEST_ASSERT_EQUAL_DOUBLE(share, f[k].value);
    }
    TEST_ASSERT_EQUAL_DOUBLE(1.0 / 11, f[FIELD_LIMITS + FIELD_LIMITS - 1].value);
}

static void test_the_curve_equals_the_flags_at_the_limit_of_the_library(void)
{
    run.sigma[SIM_M_U] = 0.201 / HALF_WIDTH * run.pi[SIM_M_U];
    for (int i = SIM_M_V; i <= SIM_M_W;
         ++i) { /* not flagged because of a bias, which is part of sigma */
        run.sigma[i] = 0.199 / HALF_WIDTH * run.pi[i];
        run.flagged[i] = false;
        run.note[i] = AUVID_NOTE_NOISE;
    }
    field_table_add(&table, &run);
    const field_figure_t *f = finish() + FIELD_AT_CURVE;
    TEST_ASSERT_EQUAL_DOUBLE(10.0 / 13, f[1].value);
    TEST_ASSERT_EQUAL_DOUBLE(11.0 / 13, f[2].value);
    TEST_ASSERT_EQUAL_DOUBLE(table.figure[FIELD_AT(FIELD_FLAGGED, FIELD_ALL)].value, f[2].value);
    TEST_ASSERT_EQUAL_DOUBLE(1.0, f[3].value);
}

static void test_an_equation_with_an_impossible_estimate_has_no_flags_at_any_limit(void)
{
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        run.sigma[i] = 0.27 / HALF_WIDTH * fabs(run.pi[i]);
        run.flagged[i] = false;
        run.note[i] = AUVID_NOTE_UNCERTAIN; /* without flags nothing is discredited */
    }
    run.impossible[SIM_Y_V] = true;
    field_table_add(&table, &run);
    const field_figure_t *f = finish() + FIELD_AT_CURVE;
    TEST_ASSERT_EQUAL_DOUBLE(9.0 / 13, f[FIELD_LIMITS - 1].value); /* not m_v, Y_v, Y_vv, W-B */
}

/* ---- intervals ---- */

static void test_the_bootstrap_is_over_runs_not_over_flags(void)
{
    for (int k = 0; k < RUNS; ++k) { /* all correct, or all wrong */
        for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
            run.pi[i] = (k % 2 == 0 ? 1.0 : 1.5) * run.truth.si[i];
        }
        field_table_add(&table, &run);
    }
    const field_figure_t *f = &finish()[FIELD_AT(FIELD_WRONG, FIELD_MASSES)];
    double half = 1.96 * sqrt(0.25 / RUNS);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, f->value);
    TEST_ASSERT_EQUAL_DOUBLE(4 * RUNS, f->whole);
    TEST_ASSERT_DOUBLE_WITHIN(0.15 * half, 0.5 - half, f->low);
    TEST_ASSERT_DOUBLE_WITHIN(0.15 * half, 0.5 + half, f->high);
}

static void test_no_wrong_flag_has_the_interval_of_the_runs(void)
{
    for (int k = 0; k < 100; ++k) {
        field_table_add(&table, &run);
    }
    const field_figure_t *f = finish();
    double upper = 1 - pow(0.025, 1.0 / 100); /* of 100 runs, not of 1300 flags */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, upper, f[FIELD_AT(FIELD_WRONG, FIELD_ALL)].high);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1 - upper, f[FIELD_AT(FIELD_FLAGGED, FIELD_ALL)].low);
    TEST_ASSERT_EQUAL_DOUBLE(1, f[FIELD_AT(FIELD_FLAGGED, FIELD_ALL)].high);
}

static void test_the_same_seed_gives_the_same_intervals(void)
{
    for (int k = 0; k < 30; ++k) {
        run.pi[SIM_M_U] = (k % 3 == 0 ? 1.5 : 1.0) * run.truth.si[SIM_M_U];
        field_table_add(&table, &run);
    }
    field_figure_t first = finish()[FIELD_AT(FIELD_WRONG, FIELD_ALL)];
    field_figure_t again = finish()[FIELD_AT(FIELD_WRONG, FIELD_ALL)];
    TEST_ASSERT_EQUAL_MEMORY(&first, &again, sizeof first);
}

/* Values from tables of the Clopper-Pearson interval. */
static void test_clopper_pearson_against_known_values(void)
{
    static const double known[][4] = {{0, 10, 0, 0.30850},        {1, 10, 0.00253, 0.44502},
                                      {5, 10, 0.18709, 0.81291},  {10, 10, 0.69150, 1},
                                      {3, 300, 0.00207, 0.02895}, {0, 300, 0, 0.01222}};
    for (size_t k = 0; k < sizeof known / sizeof known[0]; ++k) {
        double interval[2];
        field_clopper_pearson((uint32_t)known[k][0], (uint32_t)known[k][1], interval);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, known[k][2], interval[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, known[k][3], interval[1]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_within_20_percent_is_never_wrong);
    RUN_TEST(test_a_mass_is_wrong_by_the_force_error_at_the_largest_acceleration);
    RUN_TEST(test_drag_is_wrong_by_the_force_error_at_the_largest_speed_of_both_directions);
    RUN_TEST(test_a_moment_is_compared_with_tau_max_of_yaw);
    RUN_TEST(test_weight_is_wrong_only_by_its_force);
    RUN_TEST(test_an_estimate_that_is_not_a_number_is_wrong);
    RUN_TEST(test_shares_are_of_flags_and_by_class);
    RUN_TEST(test_beyond_uses_the_printed_half_width);
    RUN_TEST(test_flags_are_also_compared_with_the_truth_for_reported_thrust);
    RUN_TEST(test_the_relative_error_excludes_weight);
    RUN_TEST(test_without_flags_there_are_no_figures_of_flags);
    RUN_TEST(test_notes_are_counted);
    RUN_TEST(test_forces_are_compared_with_the_truth_flagged_or_not);
    RUN_TEST(test_the_curve_flags_by_width_unless_another_reason_forbids);
    RUN_TEST(test_the_curve_equals_the_flags_at_the_limit_of_the_library);
    RUN_TEST(test_an_equation_with_an_impossible_estimate_has_no_flags_at_any_limit);
    RUN_TEST(test_the_bootstrap_is_over_runs_not_over_flags);
    RUN_TEST(test_no_wrong_flag_has_the_interval_of_the_runs);
    RUN_TEST(test_the_same_seed_gives_the_same_intervals);
    RUN_TEST(test_clopper_pearson_against_known_values);
    return UNITY_END();
}
