/*
 * Uncertainty of the delay between thrust and motion: its part in standard errors, and delays of
 * both signs. tests/reference/test_confidence_reference.cpp computes the formulas again.
 * tests/vehicles/test_propeller_lag.c counts flags.
 *
 * The vehicle's equations are evaluated for synthetic motion at the cells of the recorder. It is
 * made of parabolas instead of sines, which give the same numbers with any C library.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/detail/confidence.h"
#include "auvid/identifier.h"
#include "auvid/validation.h"
#include "finish.h"
#include "unity.h"

enum { SETS = 8, N = 13 }; /* free parameters */

/* A synthetic run: parameters, white noise of the force, and the number of cells by which the time
 * stamps of the wrench are late (negative: early). */
typedef struct {
    const auvid_real_t *truth;
    double force_N;
    int late;
    bool sine; /* only surge moves, in a sine */
} world_t;

static auvid_metric_t metric;
static auvid_confidence_job_t job;
static const auvid_confidence_t *const result = &job.result;
static auvid_metric_config_t cfg;
static auvid_real_t estimate[AUVID_MAX_PARAMETERS];

void setUp(void)
{
    auvid_metric_defaults(&cfg, &auvid_girona500);
    cfg.velocity_us = 0;
}

void tearDown(void)
{
}

/* ---- synthetic data ---- */

/* A wave of period one made of parabolas, and its derivative. */
static double wave(double x, double *slope)
{
    x -= floor(x);
    double half = x < 0.5 ? x : x - 0.5, sign = x < 0.5 ? 1 : -1;
    *slope = sign * 8 * (1 - 4 * half);
    return sign * 8 * half * (1 - 2 * half);
}

static void move(const world_t *world, double t, auvid_sample_t *s)
{
    static const double hertz[3] = {0.031, 0.083, 0.171};
    memset(s, 0, sizeof *s);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double u = 0, a = 0;
        for (int k = 0; k < 3 && j != AUVID_ROLL && j != AUVID_PITCH; ++k) {
            double f = hertz[k] * (1 + 0.07 * j), slope;
            u += 0.25 / (1 + k) * wave(f * t + 0.37 * j + 0.21 * k, &slope);
            a += 0.25 / (1 + k) * f * slope;
        }
        if (world->sine) {
            u = j == AUVID_SURGE ? 0.3 * sin(0.6 * t) : 0;
            a = j == AUVID_SURGE ? 0.3 * 0.6 * cos(0.6 * t) : 0;
        }
        s->nu[j] = (auvid_real_t)u;
        s->nu_dot[j] = (auvid_real_t)a;
    }
}

static void wrench(const world_t *world, double t, double tau[AUVID_DOF_COUNT])
{
    auvid_sample_t s;
    auvid_regressor_t y;
    memset(&y, 0, sizeof y);
    move(world, t, &s);
    auvid_girona500.regressor(auvid_girona500.context, &s, NULL, &y);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        tau[j] = 0;
        for (int i = 0; i < N; ++i) {
            tau[j] += (double)y.row[j][i] * (double)world->truth[i];
        }
    }
}

/* Approximately Gaussian, the same in every build. */
static double gauss(uint64_t *state)
{
    double sum = -6;
    for (int k = 0; k < 12; ++k) {
        *state = *state * 6364136223846793005u + 1442695040888963407u;
        sum += (double)(*state >> 11) / 9007199254740992.0;
    }
    return sum;
}

static void record(const world_t *world)
{
    uint64_t state = 5;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
    for (uint64_t k = 1; metric.sets.recorded < SETS; ++k) {
        auvid_sample_t s;
        double tau[AUVID_DOF_COUNT];
        move(world, 0.1 * (double)k, &s);
        wrench(world, 0.1 * ((double)k - world->late), tau);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            double scale = j == AUVID_YAW ? 0.4 : 1;
            s.tau[j] = (auvid_real_t)(tau[j] + world->force_N * scale * gauss(&state));
        }
        s.t_us = 100000 * k;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= AUVID_OK);
    }
}

static void solve(void)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&metric, &budget));
    memset(estimate, 0, sizeof estimate);
    TEST_ASSERT_EQUAL(
        AUVID_OK, auvid_metric_least_squares(&metric, auvid_metric_searched(&metric), estimate));
    auvid_metric_measure_begin(&metric, estimate, AUVID_C(0.0));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
}

/* @return units of work */
static uint32_t compute_confidence(auvid_real_t delay_s)
{
    const auvid_uncertainty_t uncertainty = {0, 0, delay_s};
    uint32_t budget = UINT32_MAX;
    auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), &uncertainty);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
    return UINT32_MAX - budget;
}

/* Data, estimate and confidence; delay_s is the uncertainty of the delay. */
static void observe(const world_t *world, auvid_real_t delay_s)
{
    cfg.delay_sigma_s = delay_s;
    record(world);
    solve();
    (void)compute_confidence(delay_s);
}

static double error_of(const world_t *world, int i)
{
    return (double)estimate[i] - (double)world->truth[i];
}

/* ---- standard errors ---- */

/* In a sine a delay d turns a linear drag X into a mass of -X d: the data show only the sum. */
static void test_an_undetermined_delay_widens_the_mass(void)
{
    auvid_real_t viscous[AUVID_G500_COUNT];
    memcpy(viscous, auvid_girona500_paper, sizeof viscous);
    viscous[AUVID_G500_X_U] = AUVID_C(-200.0);
    viscous[AUVID_G500_X_UU] = AUVID_C(-1.0);
    const world_t world = {viscous, 1, 0, true};
    observe(&world, AUVID_C(0.0));
    double before = (double)result->sigma[AUVID_G500_M_U];
    observe(&world, AUVID_C(0.1));
    double after = (double)result->sigma[AUVID_G500_M_U];
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, (double)metric.result.delay_s[AUVID_SURGE]);
    TEST_ASSERT_TRUE(before < 1);
    TEST_ASSERT_TRUE(after > 0.1 * 200);
    TEST_ASSERT_TRUE(after < 3 * 0.1 * 200);
}

static void test_a_determined_delay_hardly_widens(void)
{
    const world_t world = {auvid_girona500_paper, 1, 0, false};
    auvid_real_t before[N];
    observe(&world, AUVID_C(0.0));
    memcpy(before, result->sigma, sizeof before);
    observe(&world, AUVID_C(0.1));
    for (int i = 0; i < N; ++i) {
        double ratio = (double)result->sigma[i] / (double)before[i];
        TEST_ASSERT_TRUE(ratio > 0.99);
        TEST_ASSERT_TRUE(ratio < 2.5);
        TEST_ASSERT_TRUE(i <= AUVID_G500_M_R || ratio < 1.5);
    }
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, result->identifiable);
}

/* The user gives a delay of zero, which the data contradict. */
static void test_a_given_delay_that_the_data_contradict_is_in_the_standard_errors(void)
{
    const world_t world = {auvid_girona500_paper, 1, -1, false};
    int far = 0;
    cfg.estimate_delay = false;
    observe(&world, AUVID_C(0.0));
    for (int i = 0; i < N; ++i) {
        far += fabs(error_of(&world, i)) > 2.1 * (double)result->sigma[i];
    }
    TEST_ASSERT_TRUE(far >= 5);
    (void)compute_confidence(AUVID_C(0.1));
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_TRUE(fabs(error_of(&world, i)) < 2.1 * (double)result->sigma[i]);
    }
}

/* ---- time stamps ---- */

static void test_late_stamps_are_found_as_a_negative_delay(void)
{
    const world_t world = {auvid_girona500_paper, 1, 1, false};
    observe(&world, AUVID_C(0.1));
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_TRUE(fabs(error_of(&world, i)) < 3 * (double)result->sigma[i]);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool excited = (metric.result.excited >> j & 1) != 0;
        TEST_ASSERT_DOUBLE_WITHIN(0.02, excited ? -0.1 : 0, (double)metric.result.delay_s[j]);
    }
    TEST_ASSERT_EQUAL_HEX8(0, metric.result.first_order_lag);
}

static void test_late_stamps_beyond_two_cells_give_no_earlier_delay(void)
{
    const world_t world = {auvid_girona500_paper, 1, 4, false};
    observe(&world, AUVID_C(0.1));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_TRUE(metric.result.delay_s[j] >= AUVID_C(-0.2001));
    }
    TEST_ASSERT_TRUE(metric.result.delay_s[AUVID_SURGE] < AUVID_C(-0.15));
}

static void test_without_uncertainty_no_delay_is_negative(void)
{
    const world_t world = {auvid_girona500_paper, 1, 1, false};
    observe(&world, AUVID_C(0.0));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_TRUE(metric.result.delay_s[j] >= AUVID_C(0.0));
    }
}

/* ---- without uncertainty ---- */

/* Numbers of the library before it considered this uncertainty. */
static void test_without_uncertainty_the_numbers_are_unchanged(void)
{
    static const world_t world = {auvid_girona500_paper, 1, -1, false};
    static const double pi[N] = {0x1.f2a238p+7,  0x1.6fabc6p+8,  0x1.49d8acp+9,  0x1.2bfc8cp+6,
                                 -0x1.2a7b9cp+5, -0x1.501458p+5, -0x1.fbb86ep+6, -0x1.2f8b94p+6,
                                 -0x1.bee8dap+8, -0x1.5c0cb6p+5, -0x1.461e2cp+8, -0x1.4cc7b4p+4,
                                 -0x1.e0a11p+5};
    static const double sigma[N] = {0x1.5ba968p-3, 0x1.a1c47ap-3, 0x1.eebc7ap-3, 0x1.46cd3ep-4,
                                    0x1.805924p-6, 0x1.04a26p-2,  0x1.cd5d84p-1, 0x1.a28d0cp-2,
                                    0x1.6737e6p+0, 0x1.ab4448p-2, 0x1.68a72p+0,  0x1.3e598ep-3,
                                    0x1.083316p-1};
    double tolerance = sizeof(auvid_real_t) == sizeof(double) ? 5e-3 : 0;
    observe(&world, AUVID_C(0.0));
    for (int i = 0; i < N; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(tolerance * fabs(pi[i]), pi[i], (double)estimate[i]);
        TEST_ASSERT_DOUBLE_WITHIN(tolerance * sigma[i], sigma[i], (double)result->sigma[i]);
    }
}

static void test_any_budget_gives_the_same_bits(void)
{
    static const uint32_t pieces[] = {1, 7, 100};
    static auvid_confidence_t whole;
    const auvid_uncertainty_t uncertainty = {0, 0, AUVID_C(0.1)};
    const world_t world = {auvid_girona500_paper, 1, 1, false};
    observe(&world, AUVID_C(0.1));
    whole = *result;
    for (size_t k = 0; k < sizeof pieces / sizeof pieces[0]; ++k) {
        auvid_status_t status = AUVID_PENDING;
        uint32_t turns = 0;
        auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), &uncertainty);
        while (status == AUVID_PENDING) {
            finish_turn(&turns, 1000000);
            uint32_t budget = pieces[k];
            status = auvid_confidence_work(&job, &metric, &budget);
        }
        TEST_ASSERT_EQUAL_MEMORY(&whole, result, sizeof whole);
    }
}

static void test_the_uncertainty_costs_what_the_header_says(void)
{
    const world_t world = {auvid_girona500_paper, 1, 0, false};
    observe(&world, AUVID_C(0.0));
    uint32_t without = compute_confidence(AUVID_C(0.0));
    TEST_ASSERT_UINT32_WITHIN(20, 538, compute_confidence(AUVID_C(0.1)) - without);
}

/* ---- accepted values ---- */

static void test_the_metric_refuses_delays_and_uncertainties_out_of_range(void)
{
    cfg.delay_s[AUVID_SWAY] = AUVID_C(-0.2);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
    cfg.delay_s[AUVID_SWAY] = AUVID_C(-0.21);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_init(&metric, &cfg));
    cfg.delay_s[AUVID_SWAY] = AUVID_C(0.0);
    cfg.delay_sigma_s = AUVID_C(-0.1);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_init(&metric, &cfg));
    cfg.delay_sigma_s = AUVID_C(1.1);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_metric_init(&metric, &cfg));
    cfg.delay_sigma_s = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_metric_init(&metric, &cfg));
    cfg.delay_sigma_s = AUVID_C(1.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
}

static void test_the_identifier_passes_its_uncertainty_to_the_metric(void)
{
    static auvid_identifier_t id;
    static auvid_identifier_config_t cfg;
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 0.1, (double)cfg.uncertainty.delay_s);
    cfg.uncertainty.delay_s = AUVID_C(0.25);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_DOUBLE_WITHIN(0, 0.25, (double)id.metric.cfg.delay_sigma_s);
}

static void test_a_validation_treats_a_negative_delay_as_zero(void)
{
    static auvid_validation_t early, none;
    const auvid_real_t delay[AUVID_DOF_COUNT] = {AUVID_C(-0.2), AUVID_C(-0.1)};
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_validation_init(&early, &auvid_girona500, auvid_girona500_paper, 0,
                                            delay, 0, AUVID_C(0.1)));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_validation_init(&none, &auvid_girona500, auvid_girona500_paper, 0, NULL,
                                            0, AUVID_C(0.1)));
    TEST_ASSERT_EQUAL_MEMORY(&none, &early, sizeof none);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_undetermined_delay_widens_the_mass);
    RUN_TEST(test_a_determined_delay_hardly_widens);
    RUN_TEST(test_a_given_delay_that_the_data_contradict_is_in_the_standard_errors);
    RUN_TEST(test_late_stamps_are_found_as_a_negative_delay);
    RUN_TEST(test_late_stamps_beyond_two_cells_give_no_earlier_delay);
    RUN_TEST(test_without_uncertainty_no_delay_is_negative);
    RUN_TEST(test_without_uncertainty_the_numbers_are_unchanged);
    RUN_TEST(test_any_budget_gives_the_same_bits);
    RUN_TEST(test_the_uncertainty_costs_what_the_header_says);
    RUN_TEST(test_the_metric_refuses_delays_and_uncertainties_out_of_range);
    RUN_TEST(test_the_identifier_passes_its_uncertainty_to_the_metric);
    RUN_TEST(test_a_validation_treats_a_negative_delay_as_zero);
    return UNITY_END();
}
