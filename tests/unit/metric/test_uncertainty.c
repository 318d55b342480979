/*
 * What the user supplies and does not know exactly: the scale of the thrust and of the DVL's
 * velocity. Also the covariance of an estimate, which is conditional on both as supplied.
 *
 * The data are synthetic, as in confidence_data.h: a vehicle's equations evaluated for synthetic
 * motion at the cells of the recorder.
 */
#include <math.h>
#include <string.h>

#include "auvid/detail/confidence.h"
#include "auvid/identifier.h"
#include "chain.h"
#include "sines.h"
#include "unity.h"

enum { SETS = 8, COUNT = 13 };

static auvid_metric_t metric;
static auvid_confidence_job_t job;
static const auvid_confidence_t *const result = &job.result;
static auvid_real_t truth[AUVID_G500_COUNT], estimate[AUVID_MAX_PARAMETERS];
static auvid_uncertainty_t uncertainty;

void setUp(void)
{
    memcpy(truth, auvid_girona500_paper, sizeof truth);
    uncertainty = (auvid_uncertainty_t){.thrust_scale = AUVID_C(0.05), .dvl_scale = AUVID_C(0.005)};
}

void tearDown(void)
{
}

/* ---- synthetic data ---- */

/* Ratios of the supplied values to the true ones. */
typedef struct {
    double force_N; /* rms of white noise */
    double thrust, dvl;
    uint64_t seed;
} world_t;

enum { MOVED = 1u << AUVID_SURGE | 1u << AUVID_SWAY | 1u << AUVID_HEAVE | 1u << AUVID_YAW };

/* The wrench that gives the motion with the true parameters, and noise; then both as supplied. */
static void act(auvid_sample_t *s, const world_t *world, uint64_t *state)
{
    double tau[AUVID_DOF_COUNT];
    sines_wrench(s, truth, tau);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        tau[j] += sines_noise(world->force_N, j, state);
        s->tau[j] = (auvid_real_t)(world->thrust * tau[j]);
        s->nu[j] *= (auvid_real_t)(j <= AUVID_HEAVE ? world->dvl : 1.0);
        s->nu_dot[j] *= (auvid_real_t)(j <= AUVID_HEAVE ? world->dvl : 1.0);
    }
}

static auvid_metric_config_t default_config(void)
{
    auvid_metric_config_t cfg;
    auvid_metric_defaults(&cfg, &auvid_girona500);
    cfg.estimate_delay = false;
    cfg.velocity_us = 0;
    return cfg;
}

/* Least squares over the free parameters, and their confidence. */
static void observe(const auvid_metric_config_t *cfg, const world_t *world)
{
    uint32_t budget = UINT32_MAX;
    uint64_t state = world->seed;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, cfg));
    for (uint64_t k = 1; metric.sets.recorded < SETS; ++k) {
        auvid_sample_t s;
        sines_motion(0.1 * (double)k, MOVED, &s);
        act(&s, world, &state);
        s.t_us = 100000 * k;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= AUVID_OK);
    }
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&metric, &budget));
    memcpy(estimate, cfg->fixed, sizeof cfg->fixed);
    TEST_ASSERT_EQUAL(
        AUVID_OK, auvid_metric_least_squares(&metric, auvid_metric_searched(&metric), estimate));
    auvid_metric_measure_begin(&metric, estimate, AUVID_C(0.0));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
    auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), &uncertainty);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
}

static const world_t true_scales = {1.0, 1.0, 1.0, 5};

/* d pi / d scale, by two estimates from data that differ in the scale by 4 %. */
static void differentiate(const auvid_metric_config_t *cfg, bool thrust, double slope[COUNT])
{
    world_t more = true_scales, less = true_scales;
    *(thrust ? &more.thrust : &more.dvl) = 1.02;
    *(thrust ? &less.thrust : &less.dvl) = 0.98;
    observe(cfg, &more);
    for (int i = 0; i < COUNT; ++i) {
        slope[i] = (double)estimate[i];
    }
    observe(cfg, &less);
    for (int i = 0; i < COUNT; ++i) {
        slope[i] = (slope[i] - (double)estimate[i]) / 0.04;
    }
    observe(cfg, &true_scales);
}

/* ---- considered parameters ---- */

static void test_a_thrust_scale_changes_all_parameters_by_the_reported_error(void)
{
    auvid_metric_config_t cfg = default_config();
    double slope[COUNT];
    differentiate(&cfg, true, slope);
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * fabs(0.05 * slope[i]), 0.05 * slope[i],
                                  (double)result->thrust_error[i]);
    }
}

/* Yaw's (m_u - m_v) u v has another degree than the terms of the forces, which set the degree of
 * the masses. In motion as coupled as this the difference is 15 %. */
static void test_a_dvl_scale_changes_parameters_by_their_degree(void)
{
    auvid_metric_config_t cfg = default_config();
    double slope[COUNT];
    differentiate(&cfg, false, slope);
    for (int i = 0; i < COUNT; ++i) {
        double part = i == AUVID_G500_M_U || i == AUVID_G500_M_V ? 0.2 : 0.03;
        TEST_ASSERT_DOUBLE_WITHIN(part * fabs((double)estimate[i]), slope[i],
                                  (double)result->dvl_error[i] / 0.005);
    }
}

/* A known parameter does not scale with the thrust. Its column is nearly orthogonal to the others
 * in its own equation. Sway contains m_u u r, yaw (m_u - m_v) u v. */
static void test_with_a_known_mass_the_others_still_change_with_the_thrust_scale(void)
{
    auvid_metric_config_t cfg = default_config();
    double slope[COUNT];
    cfg.free &= ~(1u << AUVID_G500_M_U);
    cfg.fixed[AUVID_G500_M_U] = truth[AUVID_G500_M_U];
    differentiate(&cfg, true, slope);
    TEST_ASSERT_TRUE(fabs(slope[AUVID_G500_M_U]) < 1e-6);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, (double)result->thrust_error[AUVID_G500_M_U]);
    for (int i = AUVID_G500_M_V; i < COUNT; ++i) {
        bool sway = auvid_girona500.parameter[i].dof == AUVID_SWAY;
        double ratio = (double)result->thrust_error[i] / 0.05 / slope[i];
        TEST_ASSERT_TRUE(ratio > (sway ? 0.85 : 0.97));
        TEST_ASSERT_TRUE(ratio < (sway ? 1.5 : 1.03));
    }
}

/* The other drag takes over the part of a known drag: the considered error is larger than the true
 * one, up to twice. */
static void test_with_a_known_drag_the_other_drag_of_its_equation_takes_over_its_part(void)
{
    for (int known = AUVID_G500_X_U; known <= AUVID_G500_X_UU; ++known) {
        int other = known == AUVID_G500_X_U ? AUVID_G500_X_UU : AUVID_G500_X_U;
        for (int thrust = 0; thrust < 2; ++thrust) {
            auvid_metric_config_t cfg = default_config();
            double slope[COUNT];
            cfg.free &= ~(1u << known);
            cfg.fixed[known] = truth[known];
            differentiate(&cfg, thrust == 1, slope);
            double considered = (double)(thrust ? result->thrust_error : result->dvl_error)[other];
            double ratio = considered / (thrust ? 0.05 : 0.005) / slope[other];
            TEST_ASSERT_TRUE(fabs(slope[other]) > 1.2 * fabs((double)estimate[other]));
            TEST_ASSERT_TRUE(ratio > 0.95);
            TEST_ASSERT_TRUE(ratio < 2.0);
        }
    }
}

static void test_without_uncertain_scales_the_standard_errors_are_unchanged(void)
{
    auvid_metric_config_t cfg = default_config();
    auvid_real_t sigma[COUNT];
    observe(&cfg, &true_scales);
    auvid_confidence_t with = *result;
    memset(&uncertainty, 0, sizeof uncertainty);
    observe(&cfg, &true_scales);
    memcpy(sigma, result->sigma, sizeof sigma);
    for (int i = 0; i < COUNT; ++i) {
        double with_thrust = hypot((double)sigma[i], (double)with.thrust_error[i]);
        TEST_ASSERT_TRUE(result->thrust_error[i] == AUVID_C(0.0));
        TEST_ASSERT_TRUE(result->dvl_error[i] == AUVID_C(0.0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * with_thrust, hypot(with_thrust, (double)with.dvl_error[i]),
                                  (double)with.sigma[i]);
    }
    TEST_ASSERT_EQUAL_MEMORY(&uncertainty, &result->uncertainty, sizeof uncertainty);
}

/* A model without regressor also scales if its parameters have a known kind. A model that forms the
 * thrust from commands does not. */
static void residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                     auvid_real_t *e)
{
    (void)context;
    e[AUVID_SURGE] = pi[0] * s->nu_dot[AUVID_SURGE] - pi[1] * s->nu[AUVID_SURGE] +
                     pi[2] * s->nu[AUVID_SWAY] - s->tau[AUVID_SURGE];
}

/* But those that are said not to, and all where the model computes its thrust from commands. */
static void test_without_regressor_all_parameters_scale(void)
{
    enum { N = 3, ROWS = 20 };
    static auvid_parameter_t parameter[N] = {
        {"m", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
        {"d", "N s/m", AUVID_SURGE, AUVID_PARAMETER_LINEAR_DRAG},
        {"c", "?", AUVID_SURGE, AUVID_PARAMETER_OTHER}};
    static auvid_row_t rows[(SETS + 1) * ROWS];
    static auvid_vehicle_t vehicle;
    for (int k = 0; k < 3; ++k) {
        bool from_commands = k == 1, unscaled = k == 2;
        auvid_metric_config_t cfg;
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {AUVID_C(200.0), AUVID_C(-80.0), AUVID_C(10.0)};
        uint64_t state = 7;
        uint32_t budget = UINT32_MAX;
        parameter[2].kind = unscaled ? AUVID_PARAMETER_UNSCALED : AUVID_PARAMETER_OTHER;
        vehicle = (auvid_vehicle_t){.built_for = AUVID_BUILD,
                                    .path = &auvid_path_residual,
                                    .name = "of one DoF",
                                    .parameters = N,
                                    .parameter = parameter,
                                    .columns = {7u},
                                    .residual = residual,
                                    .own_thrust = from_commands};
        auvid_metric_defaults(&cfg, &vehicle);
        cfg.estimate_delay = false;
        cfg.set_rows = ROWS;
        cfg.rows = rows;
        cfg.row_slots = sizeof rows / sizeof rows[0];
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
        for (uint64_t cell = 1; metric.sets.recorded < SETS; ++cell) {
            auvid_sample_t s;
            auvid_real_t e[AUVID_DOF_COUNT] = {AUVID_C(0.0)};
            sines_motion(0.1 * (double)cell, MOVED, &s);
            residual(NULL, &s, pi, e);
            s.tau[AUVID_SURGE] = e[AUVID_SURGE] + (auvid_real_t)sines_gauss(&state);
            s.t_us = 100000 * cell;
            TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= AUVID_OK);
        }
        auvid_metric_merge_begin(&metric);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&metric, &budget));
        auvid_metric_measure_begin(&metric, pi, AUVID_C(0.0));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
        static auvid_metric_windows_t windows;
        auvid_metric_linearise_begin(&metric, pi, AUVID_C(0.0), SETS);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_linearise(&metric, &windows, &budget));
        auvid_confidence_begin(&job, &metric, pi, AUVID_C(0.0), &uncertainty);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
        for (int i = 0; i < N; ++i) {
            double scale = (i == 2 && unscaled) || from_commands ? 0.0 : 0.05;
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, scale * (double)pi[i], (double)result->thrust_error[i]);
            TEST_ASSERT_TRUE(result->sigma[i] < AUVID_LARGEST);
        }
    }
}

/* ---- notes ---- */

/* The total half-width decides. A note says if only the thrust scale prevents identification. */
static void test_what_only_the_thrust_scale_prevents_is_called_so(void)
{
    static char text[160];
    auvid_metric_config_t cfg = default_config();
    uncertainty.thrust_scale = AUVID_C(0.12);
    observe(&cfg, &true_scales);
    TEST_ASSERT_EQUAL_HEX32(0, result->identifiable | result->implausible);
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_EQUAL(AUVID_NOTE_THRUST_SCALE, result->note[i]);
        bool force = i == AUVID_G500_W_B;
        double max_sigma = (force ? 0.02 * 100.0 : 0.2 * fabs((double)estimate[i])) / 2.1;
        double without_thrust =
            sqrt(pow((double)result->sigma[i], 2.0) - pow((double)result->thrust_error[i], 2.0));
        double max_scale = sqrt(max_sigma * max_sigma - without_thrust * without_thrust) /
                           fabs((double)estimate[i]);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * max_scale, max_scale, (double)result->bound[i]);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_missing(result, &auvid_girona500, AUVID_G500_FREE,
                                                         0, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("surge: m_u is known to 2 % up to the thrust scale; calibrate thrust "
                             "to 9 % with a known force",
                             text);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_missing(result, &auvid_girona500, AUVID_G500_FREE,
                                                         4, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("heave: W-B is known to 0.1 N up to the thrust scale; calibrate "
                             "thrust to 2 % with a known force",
                             text);
    uncertainty.thrust_scale = (auvid_real_t)(0.99 * (double)result->bound[AUVID_G500_M_U]);
    observe(&cfg, &true_scales);
    TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, result->note[AUVID_G500_M_U]);
}

static void test_a_constant_force_has_its_tolerance_in_newtons(void)
{
    auvid_metric_config_t cfg = default_config();
    memset(&uncertainty, 0, sizeof uncertainty);
    truth[AUVID_G500_W_B] = AUVID_C(0.1); /* known to 0.06 N */
    observe(&cfg, &true_scales);
    TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, result->note[AUVID_G500_W_B]);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, result->identifiable);
    cfg.tau_max[AUVID_HEAVE] = (auvid_real_t)(2.0 * (double)result->sigma[AUVID_G500_W_B] / 0.02);
    observe(&cfg, &true_scales);
    TEST_ASSERT_TRUE(result->note[AUVID_G500_W_B] == AUVID_NOTE_UNCERTAIN ||
                     result->note[AUVID_G500_W_B] == AUVID_NOTE_SMALL);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~(1u << AUVID_G500_W_B), result->identifiable);
}

static void test_an_impossible_estimate_is_reported_once_for_its_equation(void)
{
    static char text[160];
    auvid_metric_config_t cfg = default_config();
    truth[AUVID_G500_X_UU] = AUVID_C(890.0);
    truth[AUVID_G500_X_U] = AUVID_C(-546.0);
    uncertainty.thrust_scale = AUVID_C(0.0);
    observe(&cfg, &(world_t){0.0, 1.0, 1.0, 5});
    uint32_t surge = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U | 1u << AUVID_G500_X_UU;
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~surge, result->identifiable);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_missing(result, &auvid_girona500, AUVID_G500_FREE,
                                                         0, text, sizeof text));
    TEST_ASSERT_EQUAL_MEMORY("surge: X_uu is impossible (+8", text, 29);
    TEST_ASSERT_NOT_NULL(
        strstr(text, "): the equation is not trusted; check signs, units and the model"));
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(result, &auvid_girona500, AUVID_G500_FREE, 1, text, sizeof text));
}

/* ---- covariance ---- */

static auvid_estimate_t published(void)
{
    auvid_estimate_t e;
    memset(&e, 0, sizeof e);
    e.confidence = *result;
    memcpy(e.covariance, job.covariance, sizeof e.covariance);
    return e;
}

static double covariance(const auvid_estimate_t *e, int i, int k)
{
    return (double)auvid_estimate_covariance(e, &auvid_girona500, i, k);
}

/* Cholesky decomposition of the correlations. @return smallest pivot */
static double smallest_pivot(const auvid_estimate_t *e, int n)
{
    double l[COUNT][COUNT], smallest = 1.0;
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k <= i; ++k) {
            double sum = covariance(e, i, k) / sqrt(covariance(e, i, i) * covariance(e, k, k));
            for (int m = 0; m < k; ++m) {
                sum -= l[i][m] * l[k][m];
            }
            if (i == k && sum < smallest) {
                smallest = sum;
            }
            l[i][k] = i == k ? sqrt(sum) : sum / l[k][k];
        }
    }
    return smallest;
}

static void test_the_covariance_is_symmetric_positive_and_has_the_standard_errors(void)
{
    auvid_metric_config_t cfg = default_config();
    observe(&cfg, &true_scales);
    auvid_estimate_t e = published();
    for (int i = 0; i < COUNT; ++i) {
        double total = covariance(&e, i, i) + pow((double)result->thrust_error[i], 2.0) +
                       pow((double)result->dvl_error[i], 2.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * total, total, pow((double)result->sigma[i], 2.0));
        for (int k = 0; k < COUNT; ++k) {
            TEST_ASSERT_TRUE(covariance(&e, i, k) == covariance(&e, k, i));
        }
    }
    TEST_ASSERT_TRUE(smallest_pivot(&e, COUNT) > 1e-4);
    TEST_ASSERT_TRUE(covariance(&e, AUVID_G500_X_U, AUVID_G500_X_UU) < 0.0); /* one for the other */
}

static void test_a_covariance_out_of_range_or_not_known_is_zero(void)
{
    auvid_metric_config_t cfg = default_config();
    cfg.free &= ~(1u << AUVID_G500_N_RR);
    cfg.fixed[AUVID_G500_N_RR] = truth[AUVID_G500_N_RR];
    observe(&cfg, &true_scales);
    auvid_estimate_t e = published();
    for (int k = 0; k < AUVID_G500_COUNT; ++k) {
        TEST_ASSERT_TRUE(covariance(&e, AUVID_G500_N_RR, k) == 0.0);
        TEST_ASSERT_TRUE(covariance(&e, k, AUVID_G500_N_RR) == 0.0);
    }
    TEST_ASSERT_TRUE(covariance(&e, AUVID_G500_N_R, AUVID_G500_N_R) > 0.0);
    TEST_ASSERT_TRUE(covariance(&e, -1, 0) == 0.0);
    TEST_ASSERT_TRUE(covariance(&e, 0, AUVID_G500_COUNT) == 0.0);
    TEST_ASSERT_TRUE(auvid_estimate_covariance(NULL, &auvid_girona500, 0, 0) == AUVID_C(0.0));
    TEST_ASSERT_TRUE(auvid_estimate_covariance(&e, NULL, 0, 0) == AUVID_C(0.0));
}

/* The drag force at a speed is more accurate than the sum of its coefficients' errors. Fraction of
 * the runs within one standard error, and within two. */
static void test_a_linear_combination_is_covered_as_often_as_its_standard_error_says(void)
{
    enum { RUNS = 60, SPEEDS = 3 };
    static const int linear[4] = {AUVID_G500_X_U, AUVID_G500_Y_V, AUVID_G500_Z_W, AUVID_G500_N_R};
    static const int square[4] = {AUVID_G500_X_UU, AUVID_G500_Y_VV, AUVID_G500_Z_WW,
                                  AUVID_G500_N_RR};
    auvid_metric_config_t cfg = default_config();
    int covered[2] = {0, 0}, all = 0;
    double gain = 0.0;
    for (uint64_t run = 1; run <= RUNS; ++run) {
        observe(&cfg, &(world_t){2.0, 1.0, 1.0, run * 7919});
        auvid_estimate_t e = published();
        for (int k = 0; k < 4; ++k) {
            double u = 0.3, l = u, q = u * u;
            double off = l * (double)(estimate[linear[k]] - truth[linear[k]]) +
                         q * (double)(estimate[square[k]] - truth[square[k]]);
            double ll = l * l * covariance(&e, linear[k], linear[k]);
            double qq = q * q * covariance(&e, square[k], square[k]);
            double lq = l * q * covariance(&e, linear[k], square[k]);
            double variance = ll + 2.0 * lq + qq;
            TEST_ASSERT_TRUE(variance > 0.0);
            covered[0] += off * off <= variance;
            covered[1] += off * off <= 4.0 * variance;
            gain += (ll + qq) / variance;
            ++all;
        }
    }
    TEST_ASSERT_TRUE(gain / all > 2.0);
    TEST_ASSERT_TRUE(covered[0] > 0.6 * all && covered[0] < 0.9 * all);
    TEST_ASSERT_TRUE(covered[1] > 0.93 * all);
}

/* ---- the identifier ---- */

static chain_t chain;
static chain_config_t cfg;

static void test_an_uncertainty_out_of_range_is_refused(void)
{
    chain_defaults(&cfg, 1, 2, 0.0);
    for (int k = 0; k < 3; ++k) {
        auvid_uncertainty_t *supplied = &cfg.id.uncertainty;
        auvid_real_t *one = k == 0   ? &supplied->thrust_scale
                            : k == 1 ? &supplied->dvl_scale
                                     : &supplied->delay_s;
        *one = (auvid_real_t)NAN;
        TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_identifier_init(&chain.id, &cfg.id));
        *one = AUVID_C(-0.01);
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_init(&chain.id, &cfg.id));
        *one = AUVID_C(1.01);
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_identifier_init(&chain.id, &cfg.id));
        *one = AUVID_C(1.0);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    }
}

static void test_five_per_cent_of_thrust_and_half_of_the_dvl_are_the_default(void)
{
    auvid_identifier_defaults(&cfg.id, &auvid_girona500);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.05, (double)cfg.id.uncertainty.thrust_scale);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.005, (double)cfg.id.uncertainty.dvl_scale);
}

static void test_an_estimate_carries_covariance_and_considered_errors(void)
{
    chain_defaults(&cfg, 1, 4, 1.0);
    cfg.id.uncertainty = uncertainty;
    cfg.budget = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 4));
    TEST_ASSERT_TRUE(chain_finish(&chain, UINT32_MAX, 10) <= 10);
    const auvid_estimate_t *e = &chain.id.estimate;
    TEST_ASSERT_EQUAL_MEMORY(&uncertainty, &e->confidence.uncertainty, sizeof uncertainty);
    for (int i = 0; i < COUNT; ++i) {
        double thrust = (double)e->confidence.thrust_error[i];
        double dvl = (double)e->confidence.dvl_error[i];
        double total = covariance(e, i, i) + thrust * thrust + dvl * dvl;
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * fabs(thrust), 0.05 * (double)e->pi[i], thrust);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * total, total, pow((double)e->confidence.sigma[i], 2.0));
    }
    TEST_ASSERT_TRUE(smallest_pivot(e, COUNT) > 1e-4);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_thrust_scale_changes_all_parameters_by_the_reported_error);
    RUN_TEST(test_a_dvl_scale_changes_parameters_by_their_degree);
    RUN_TEST(test_with_a_known_mass_the_others_still_change_with_the_thrust_scale);
    RUN_TEST(test_with_a_known_drag_the_other_drag_of_its_equation_takes_over_its_part);
    RUN_TEST(test_without_uncertain_scales_the_standard_errors_are_unchanged);
    RUN_TEST(test_without_regressor_all_parameters_scale);
    RUN_TEST(test_what_only_the_thrust_scale_prevents_is_called_so);
    RUN_TEST(test_a_constant_force_has_its_tolerance_in_newtons);
    RUN_TEST(test_an_impossible_estimate_is_reported_once_for_its_equation);
    RUN_TEST(test_the_covariance_is_symmetric_positive_and_has_the_standard_errors);
    RUN_TEST(test_a_covariance_out_of_range_or_not_known_is_zero);
    RUN_TEST(test_a_linear_combination_is_covered_as_often_as_its_standard_error_says);
    RUN_TEST(test_an_uncertainty_out_of_range_is_refused);
    RUN_TEST(test_five_per_cent_of_thrust_and_half_of_the_dvl_are_the_default);
    RUN_TEST(test_an_estimate_carries_covariance_and_considered_errors);
    return UNITY_END();
}
