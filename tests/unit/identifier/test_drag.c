/*
 * Drag force at a speed: exact numbers for an invented covariance, what makes a force unknown, and
 * the largest speeds of an estimate.
 */
#include <math.h>
#include <string.h>

#include "auvid/identifier.h"
#include "chain.h"
#include "metric_cells.h"
#include "unity.h"

enum { LINEAR = AUVID_G500_X_U, QUADRATIC = AUVID_G500_X_UU, FORWARD = 0, BACKWARD = 1 };

static auvid_estimate_t estimate;
static auvid_drag_t drag;
static chain_t chain;

/* Index of entry i <= j in the packed covariance of the model's parameters. */
static int entry(int i, int j)
{
    return i * N - i * (i - 1) / 2 + j - i;
}

/* X_u = -40 +- 10, X_uu = -120 +- 20 are correlated: the sum at 0.6 m/s is known. */
void setUp(void)
{
    cells_defaults();
    memset(&estimate, 0, sizeof estimate);
    memset(&drag, 0, sizeof drag);
    estimate.number = 1;
    estimate.excited = 1u << AUVID_SURGE;
    estimate.identified = 1u << LINEAR | 1u << QUADRATIC;
    estimate.speed[AUVID_SURGE][FORWARD] = 1;
    estimate.speed[AUVID_SURGE][BACKWARD] = AUVID_C(0.5);
    estimate.pi[LINEAR] = -40;
    estimate.pi[QUADRATIC] = -120;
    estimate.covariance[entry(LINEAR, LINEAR)] = 100;
    estimate.covariance[entry(QUADRATIC, QUADRATIC)] = 400;
    estimate.covariance[entry(LINEAR, QUADRATIC)] = AUVID_C(-0.95) * 10 * 20;
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        estimate.confidence.sigma[i] = AUVID_LARGEST;
        estimate.confidence.note[i] = AUVID_NOTE_NOT_EXCITED;
    }
    estimate.confidence.sigma[LINEAR] = 10;
    estimate.confidence.sigma[QUADRATIC] = 20;
    estimate.confidence.note[LINEAR] = AUVID_NOTE_COMBINATION;
    estimate.confidence.note[QUADRATIC] = AUVID_NOTE_COMBINATION;
}

void tearDown(void)
{
}

static void ask(double speed)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(&estimate, &auvid_girona500, AUVID_SURGE,
                                                    (auvid_real_t)speed, &drag));
}

static void close_to(double expected, auvid_real_t got)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * fabs(expected), expected, (double)got);
}

/* Unknown: neither flagged nor with a half-width. */
static void assert_unknown(double speed)
{
    ask(speed);
    TEST_ASSERT_FALSE(drag.identifiable);
    TEST_ASSERT_EQUAL_DOUBLE((double)AUVID_LARGEST, (double)drag.sigma);
    TEST_ASSERT_EQUAL_DOUBLE((double)AUVID_LARGEST, (double)drag.half_width);
}

/* ---- force and half-width ---- */

static void test_the_force_is_the_sum_of_both_drags_against_the_motion(void)
{
    ask(0.6);
    close_to(-40 * 0.6 - 120 * 0.36, drag.force);
    TEST_ASSERT_EQUAL_DOUBLE((double)AUVID_C(0.6), (double)drag.speed);
    ask(-0.5);
    close_to(40 * 0.5 + 120 * 0.25, drag.force);
}

static void test_its_variance_is_that_of_the_sum(void)
{
    static const double speed[] = {0.1, 0.3, 0.6, 1.0, -0.3, -0.5};
    for (int k = 0; k < 6; ++k) {
        double x = speed[k], q = fabs(x) * x;
        double variance = x * x * 100 + 2 * x * q * -190 + q * q * 400;
        ask(x);
        close_to(sqrt(variance), drag.sigma);
        close_to((double)AUVID_CONFIDENCE_HALF_WIDTH * sqrt(variance), drag.half_width);
    }
}

/* 2.1 * 10 of 40, 2.1 * 20 of 120; at 0.6: 2.1 * 3.8 of 67. */
static void test_a_force_may_be_known_although_neither_of_its_coefficients_is(void)
{
    double half = (double)AUVID_CONFIDENCE_HALF_WIDTH;
    double allowed = (double)AUVID_CONFIDENCE_IDENTIFIABLE;
    TEST_ASSERT_TRUE(half * 10 > allowed * 40 && half * 20 > allowed * 120);
    ask(0.6);
    TEST_ASSERT_TRUE(drag.identifiable);
    estimate.covariance[entry(LINEAR, QUADRATIC)] = 190;
    ask(0.6);
    TEST_ASSERT_FALSE(drag.identifiable);
}

static void test_it_is_identifiable_up_to_the_same_relative_half_width_as_a_parameter(void)
{
    ask(0.6);
    double allowed = (double)AUVID_CONFIDENCE_IDENTIFIABLE * fabs((double)drag.force);
    double factor = pow(allowed / (double)drag.half_width, 2.0);
    for (int above = 0; above < 2; ++above) {
        setUp();
        for (int i = 0; i < AUVID_COVARIANCE; ++i) {
            estimate.covariance[i] *= (auvid_real_t)(factor * (above ? 1.001 : 0.999));
        }
        ask(0.6);
        TEST_ASSERT_EQUAL(!above, drag.identifiable);
        TEST_ASSERT_TRUE(drag.half_width < AUVID_LARGEST);
    }
}

/* A thrust scale changes both in the same direction, a DVL scale in opposite ones: the errors of
 * the two coefficients are added with their signs, then squared. */
static void test_errors_of_scales_are_added_with_their_signs(void)
{
    auvid_confidence_t *c = &estimate.confidence;
    ask(0.6);
    double before = pow((double)drag.sigma, 2.0);
    c->thrust_error[LINEAR] = -2;
    c->thrust_error[QUADRATIC] = -6;
    c->dvl_error[LINEAR] = 3;
    c->dvl_error[QUADRATIC] = -5;
    ask(0.6);
    double thrust = 0.6 * -2 + 0.36 * -6, dvl = 0.6 * 3 + 0.36 * -5;
    close_to(sqrt(before + thrust * thrust + dvl * dvl), drag.sigma);
    c->dvl_error[LINEAR] = -3;
    ask(0.6);
    dvl = 0.6 * -3 + 0.36 * -5;
    close_to(sqrt(before + thrust * thrust + dvl * dvl), drag.sigma);
}

static void test_a_coefficient_that_is_fixed_is_exact(void)
{
    estimate.confidence.note[LINEAR] = AUVID_NOTE_FIXED;
    estimate.confidence.sigma[LINEAR] = AUVID_LARGEST;
    ask(0.6);
    close_to(-40 * 0.6 - 120 * 0.36, drag.force);
    close_to(0.36 * 20, drag.sigma);
    estimate.confidence.note[QUADRATIC] = AUVID_NOTE_FIXED;
    estimate.confidence.sigma[QUADRATIC] = AUVID_LARGEST;
    ask(0.6);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)drag.sigma);
    TEST_ASSERT_TRUE(drag.identifiable);
}

static void test_at_rest_the_force_is_zero_and_nothing_is_claimed(void)
{
    ask(0);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)drag.force);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)drag.half_width);
    TEST_ASSERT_FALSE(drag.identifiable);
}

/* ---- not identifiable ---- */

static void test_beyond_the_recorded_speeds_of_its_direction_it_is_not_identifiable(void)
{
    static const struct {
        double speed;
        bool seen;
    } at[] = {{0.99, true}, {1.0, true}, {1.06, false}, {-0.5, true}, {-0.53, false}};
    memset(estimate.covariance, 0, sizeof estimate.covariance);
    estimate.covariance[entry(LINEAR, LINEAR)] = 1;
    estimate.covariance[entry(QUADRATIC, QUADRATIC)] = 1;
    for (unsigned k = 0; k < sizeof at / sizeof *at; ++k) {
        ask(at[k].speed);
        TEST_ASSERT_EQUAL(at[k].seen, drag.identifiable);
        TEST_ASSERT_TRUE(drag.half_width < AUVID_LARGEST); /* it is known even so */
    }
}

static void test_a_force_along_the_motion_is_not_identifiable(void)
{
    ask(0.6);
    TEST_ASSERT_TRUE(drag.identifiable);
    estimate.pi[LINEAR] = 40;
    estimate.pi[QUADRATIC] = 120;
    ask(0.6);
    TEST_ASSERT_FALSE(drag.identifiable);
}

static void test_an_implausible_parameter_of_its_equation_discredits_the_force(void)
{
    static const int own[] = {LINEAR, QUADRATIC, AUVID_G500_M_U};
    for (int k = 0; k < 3; ++k) {
        setUp();
        estimate.confidence.implausible = 1u << own[k];
        ask(0.6);
        TEST_ASSERT_FALSE(drag.identifiable);
    }
    estimate.confidence.implausible = 1u << AUVID_G500_Y_V; /* of another equation */
    ask(0.6);
    TEST_ASSERT_TRUE(drag.identifiable);
}

static void test_a_search_that_has_not_converged_identifies_no_force(void)
{
    estimate.not_converged = true;
    ask(0.6);
    TEST_ASSERT_FALSE(drag.identifiable);
}

static void test_the_force_of_a_dof_that_was_not_excited_is_not_identifiable(void)
{
    estimate.excited = (uint8_t)~estimate.excited;
    ask(0.6);
    TEST_ASSERT_FALSE(drag.identifiable);
}

static void test_a_coefficient_without_standard_error_makes_the_force_unknown(void)
{
    for (int i = LINEAR; i <= QUADRATIC; ++i) {
        setUp();
        estimate.confidence.sigma[i] = AUVID_LARGEST;
        estimate.confidence.note[i] = AUVID_NOTE_AT_BOUND;
        assert_unknown(0.6);
        setUp();
        estimate.covariance[entry(i, i)] = 0; /* not known, as the header says */
        assert_unknown(0.6);
        setUp();
        estimate.covariance[entry(i, i)] = (auvid_real_t)NAN;
        assert_unknown(0.6);
    }
}

static void test_refusals_are_named_and_write_nothing(void)
{
    const auvid_vehicle_t *g500 = &auvid_girona500;
    const auvid_estimate_t none = {.number = 0};
    auvid_drag_t untouched;
    memset(&drag, 0x5A, sizeof drag);
    untouched = drag;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_estimate_drag(NULL, g500, AUVID_SURGE, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_estimate_drag(&estimate, NULL, AUVID_SURGE, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_estimate_drag(&estimate, g500, AUVID_SURGE, 1, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_estimate_drag(&none, g500, AUVID_SURGE, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_estimate_drag(&estimate, g500, AUVID_ROLL, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_estimate_drag(&estimate, g500, (auvid_dof_t)77, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_estimate_drag(&estimate, g500, AUVID_SURGE, AUVID_C(1.1e9), &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE,
                      auvid_estimate_drag(&estimate, g500, AUVID_SURGE, (auvid_real_t)NAN, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_estimate_drag(&estimate, g500, AUVID_SURGE,
                                                                (auvid_real_t)INFINITY, &drag));
    TEST_ASSERT_EQUAL_MEMORY(&untouched, &drag, sizeof drag);
}

/* ---- largest speeds ---- */

/* One set of cells, with velocity j at `speed` in cell 200 of it. */
static void record_set(double t, int j, double speed, uint8_t missing)
{
    world_t w = world_of(&cfg);
    uint32_t sets = metric.sets.recorded;
    for (int k = 0; metric.sets.recorded == sets; ++k) {
        auvid_sample_t s = cell_at(&w, t + k * w.cell_s);
        s.nu[j] = k == 200 ? (auvid_real_t)speed : s.nu[j];
        s.missing = k == 200 ? missing : 0;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
}

static const auvid_set_t *newest(void)
{
    return &metric.sets.set[auvid_metric_slot(&metric, 0)];
}

static void test_a_set_keeps_its_largest_speed_in_each_direction(void)
{
    start();
    record_set(0, AUVID_SURGE, 2.5, 0);
    TEST_ASSERT_UINT_WITHIN(1, 2500, newest()->fastest[AUVID_SURGE][FORWARD]);
    TEST_ASSERT_TRUE(newest()->fastest[AUVID_SURGE][BACKWARD] > 100 &&
                     newest()->fastest[AUVID_SURGE][BACKWARD] < 1000);
    record_set(100, AUVID_YAW, -3.5, 0);
    TEST_ASSERT_UINT_WITHIN(1, 3500, newest()->fastest[AUVID_YAW][BACKWARD]);
    TEST_ASSERT_TRUE(newest()->fastest[AUVID_SURGE][FORWARD] < 1000); /* it starts again */
    record_set(200, AUVID_HEAVE, -1e6, 0);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, newest()->fastest[AUVID_HEAVE][BACKWARD]);
}

static void test_a_velocity_that_was_not_measured_does_not_count(void)
{
    start();
    record_set(0, AUVID_SWAY, 2.5, 1u << AUVID_SWAY);
    TEST_ASSERT_TRUE(newest()->fastest[AUVID_SWAY][FORWARD] < 1000);
    record_set(100, AUVID_SWAY, 2.5, 1u << AUVID_SURGE);
    TEST_ASSERT_UINT_WITHIN(1, 2500, newest()->fastest[AUVID_SWAY][FORWARD]);
}

/* Half a set; then 3 m/s without rows; then 2 m/s with rows again. */
static void test_a_speed_without_a_row_does_not_count(void)
{
    cfg.sets = 2;
    use_residual_path(1, 120);
    start();
    world_t w = world_of(&cfg);
    int taken = 60, late = taken + 200, end = late + 100;
    auvid_metric_hold(&metric, cell_at(&w, taken * w.cell_s).t_us);
    for (int k = 0; k < end; ++k) {
        auvid_sample_t s = cell_at(&w, k * w.cell_s);
        s.nu[AUVID_SURGE] = k > taken ? 3 : s.nu[AUVID_SURGE];
        if (k == late) {
            TEST_ASSERT_TRUE(auvid_metric_release(&metric, s.t_us) >= 0);
        }
        s.nu[AUVID_SURGE] = k >= late ? 2 : s.nu[AUVID_SURGE];
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= 0);
    }
    TEST_ASSERT_EQUAL_UINT32(1, metric.sets.recorded);
    TEST_ASSERT_TRUE(newest()->fastest[AUVID_SURGE][FORWARD] < 1000);
    TEST_ASSERT_EQUAL_UINT16(2000, metric.rows.set.fastest[AUVID_SURGE][FORWARD]);
}

static double fastest_of(const auvid_set_t *set, int j, int backward)
{
    return (set->excited >> j & 1) ? 1e-3 * set->fastest[j][backward] : 0.0;
}

/* Heave is not excited. */
static void test_an_estimate_has_the_largest_speeds_of_its_sets(void)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 0, 0, 0, 40};
    chain_config_t cfg;
    chain_defaults(&cfg, 3, 3, 1.0);
    (void)auvid_excitation_plan(&cfg.acting.excitation, amplitude, CHAIN_SET_S, 3, 3);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 3));
    TEST_ASSERT_TRUE(chain_finish(&chain, 100000, 10000) <= 10000);
    const auvid_estimate_t *e = &chain.id.estimate;
    const auvid_metric_t *m = &chain.id.metric;
    TEST_ASSERT_TRUE(e->number > 0 && m->sets.recorded == 3);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int backward = 0; backward < 2; ++backward) {
            double largest = 0.0;
            for (int age = 0; age < 3; ++age) {
                const auvid_set_t *set = &m->sets.set[auvid_metric_slot(m, age)];
                largest = fmax(largest, fastest_of(set, j, backward));
            }
            close_to(largest, e->speed[j][backward]);
        }
    }
    TEST_ASSERT_TRUE((double)e->speed[AUVID_SURGE][FORWARD] > 0.2);
    TEST_ASSERT_TRUE((double)e->speed[AUVID_SURGE][BACKWARD] > 0.2);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)e->speed[AUVID_HEAVE][FORWARD]);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)e->speed[AUVID_ROLL][FORWARD]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_force_is_the_sum_of_both_drags_against_the_motion);
    RUN_TEST(test_its_variance_is_that_of_the_sum);
    RUN_TEST(test_a_force_may_be_known_although_neither_of_its_coefficients_is);
    RUN_TEST(test_it_is_identifiable_up_to_the_same_relative_half_width_as_a_parameter);
    RUN_TEST(test_errors_of_scales_are_added_with_their_signs);
    RUN_TEST(test_a_coefficient_that_is_fixed_is_exact);
    RUN_TEST(test_at_rest_the_force_is_zero_and_nothing_is_claimed);
    RUN_TEST(test_beyond_the_recorded_speeds_of_its_direction_it_is_not_identifiable);
    RUN_TEST(test_a_force_along_the_motion_is_not_identifiable);
    RUN_TEST(test_an_implausible_parameter_of_its_equation_discredits_the_force);
    RUN_TEST(test_a_search_that_has_not_converged_identifies_no_force);
    RUN_TEST(test_the_force_of_a_dof_that_was_not_excited_is_not_identifiable);
    RUN_TEST(test_a_coefficient_without_standard_error_makes_the_force_unknown);
    RUN_TEST(test_refusals_are_named_and_write_nothing);
    RUN_TEST(test_a_set_keeps_its_largest_speed_in_each_direction);
    RUN_TEST(test_a_velocity_that_was_not_measured_does_not_count);
    RUN_TEST(test_a_speed_without_a_row_does_not_count);
    RUN_TEST(test_an_estimate_has_the_largest_speeds_of_its_sets);
    return UNITY_END();
}
