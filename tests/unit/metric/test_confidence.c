/*
 * Confidence: notes and sentences, on data for which they are known. Coverage is measured in
 * tests/reference/test_coverage.cpp. tests/reference/test_confidence_reference.cpp computes the
 * formulas again.
 *
 * Most tests evaluate a vehicle's equations for synthetic motion at the cells of the recorder. A
 * metric is then full at once, and the test chooses what the data determine.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/detail/confidence.h"
#include "chain.h"
#include "finish.h"
#include "sines.h"
#include "unity.h"

enum { SETS = 8, COUNT = 13 };

static auvid_metric_t metric;
static auvid_confidence_job_t job;
static const auvid_confidence_t *const result = &job.result;
static auvid_real_t truth[AUVID_G500_COUNT], estimate[AUVID_MAX_PARAMETERS];

void setUp(void)
{
    memcpy(truth, auvid_girona500_paper, sizeof truth);
}

void tearDown(void)
{
}

/* ---- synthetic data ---- */

/* Motion in the DoF of the mask, with some roll. */
static void move(double t, uint32_t dofs, auvid_sample_t *s)
{
    sines_motion(t, dofs, s);
    s->phi = (auvid_real_t)(0.02 * sin(0.29 * t + 1.0));
}

/* A synthetic run: the DoF that move, the number of sets, white noise of the force and of the
 * measured acceleration. */
typedef struct {
    uint32_t dofs;
    int sets;
    double force_N, acceleration;
} world_t;

enum {
    SURGE = 1u << AUVID_SURGE,
    ALL = 1u << AUVID_SURGE | 1u << AUVID_SWAY | 1u << AUVID_HEAVE | 1u << AUVID_YAW
};

/* The wrench that gives the motion with the true parameters, then the noise. */
static void add_noise(auvid_sample_t *s, const world_t *world, uint64_t *state)
{
    double tau[AUVID_DOF_COUNT];
    sines_wrench(s, truth, tau);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s->tau[j] = (auvid_real_t)(tau[j] + sines_noise(world->force_N, j, state));
        s->nu_dot[j] += (auvid_real_t)(world->acceleration * sines_gauss(state));
    }
}

static void record(const auvid_metric_config_t *cfg, const world_t *world)
{
    uint64_t state = 5;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, cfg));
    for (uint64_t k = 1; metric.sets.recorded < (uint32_t)world->sets; ++k) {
        auvid_sample_t s;
        move(0.1 * (double)k, world->dofs, &s);
        add_noise(&s, world, &state);
        s.t_us = 100000 * k;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= AUVID_OK);
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

/* The confidence in `estimate`. */
static void compute_confidence(auvid_real_t dry_mass_kg)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_measure_begin(&metric, estimate, AUVID_C(0.0));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
    auvid_confidence_begin(&job, &metric, estimate, dry_mass_kg, NULL);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
}

/* Least squares over the searched parameters, except those left at zero, and their confidence. */
static void estimate_without(uint32_t left_out, auvid_real_t dry_mass_kg)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&metric, &budget));
    memcpy(estimate, metric.cfg.fixed, sizeof metric.cfg.fixed);
    uint32_t solved = auvid_metric_searched(&metric) & ~left_out;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, solved, estimate));
    compute_confidence(dry_mass_kg);
}

static void estimate_all(void)
{
    estimate_without(0, AUVID_C(0.0));
}

static void observe(const world_t *world)
{
    auvid_metric_config_t cfg = default_config();
    record(&cfg, world);
    estimate_all();
}

static bool is_identifiable(int i)
{
    return (result->identifiable >> i & 1u) != 0;
}

/* ---- standard errors ---- */

/* The predicted bias grows with the square of the noise. The rounding of stored sets acts like a
 * noise of 0.02 N. Both are small here. */
static void test_standard_errors_are_proportional_to_the_noise(void)
{
    auvid_real_t sigma[COUNT];
    observe(&(world_t){ALL, SETS, 0.4, 0.0});
    memcpy(sigma, result->sigma, sizeof sigma);
    observe(&(world_t){ALL, SETS, 0.8, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 2.0, (double)result->sigma[i] / (double)sigma[i]);
    }
}

static void test_standard_errors_fall_as_sets_come_in(void)
{
    auvid_real_t sigma[COUNT];
    double ratio = 0.0;
    observe(&(world_t){ALL, 2, 1.0, 0.0});
    memcpy(sigma, result->sigma, sizeof sigma);
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_TRUE(result->sigma[i] < sigma[i]);
        ratio += log((double)sigma[i] / (double)result->sigma[i]) / COUNT;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.35, log(2.0), ratio); /* a quarter of the data */
}

static void test_one_set_is_enough_for_standard_errors(void)
{
    observe(&(world_t){ALL, 1, 1.0, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        double error = fabs((double)estimate[i] - (double)truth[i]);
        TEST_ASSERT_TRUE(result->sigma[i] > AUVID_C(0.0));
        TEST_ASSERT_TRUE(result->sigma[i] < AUVID_LARGEST);
        TEST_ASSERT_TRUE(error < 5.0 * (double)result->sigma[i]);
    }
}

/* The numbers are those of the build in double. In float, with sets stored in 16 bits, the results
 * were within 4e-3 of them; with sets in float, within 4e-5. */
static void test_float_and_double_give_the_same_standard_errors(void)
{
    static const double expected[COUNT] = {0.16674,  0.170391, 0.205302, 0.0743761, 0.0231826,
                                           0.282209, 1.01882,  0.321731, 1.04528,   0.312877,
                                           1.11128,  0.165562, 0.513716};
    double tolerance = sizeof(auvid_real_t) == sizeof(double) ? 1e-5 : 5e-3;
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(tolerance * expected[i], expected[i], (double)result->sigma[i]);
    }
}

static void test_any_budget_gives_the_same_bits(void)
{
    static const uint32_t pieces[] = {1, 2, 7, 100};
    static auvid_confidence_t whole;
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    whole = *result;
    for (size_t k = 0; k < sizeof pieces / sizeof pieces[0]; ++k) {
        auvid_status_t status = AUVID_PENDING;
        uint32_t turns = 0;
        auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), NULL);
        while (status == AUVID_PENDING) {
            finish_turn(&turns, 1000000);
            uint32_t budget = pieces[k];
            status = auvid_confidence_work(&job, &metric, &budget);
            TEST_ASSERT_TRUE(status != AUVID_PENDING || budget == 0);
        }
        TEST_ASSERT_EQUAL(AUVID_OK, status);
        TEST_ASSERT_EQUAL_MEMORY(&whole, result, sizeof whole);
    }
}

static void test_a_job_copied_half_way_with_its_metric_continues(void)
{
    static auvid_metric_t other;
    static auvid_confidence_job_t copy;
    static auvid_confidence_t whole;
    uint32_t budget = 400;
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    whole = *result;
    auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), NULL);
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_confidence_work(&job, &metric, &budget));
    other = metric;
    copy = job;
    memset(&metric, 0xA5, sizeof metric);
    budget = UINT32_MAX;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&copy, &other, &budget));
    TEST_ASSERT_EQUAL_MEMORY(&whole, &copy.result, sizeof whole);
}

static void test_the_cost_of_eight_sets_is_what_the_header_says(void)
{
    uint32_t budget = UINT32_MAX;
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), NULL);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
    TEST_ASSERT_UINT32_WITHIN(50, 7700, UINT32_MAX - budget);
}

/* An unmodelled lag of the thrusters: the errors of the masses contain the cost of estimating it.
 * */
static void test_an_estimated_delay_widens_the_masses(void)
{
    static chain_t chain;
    static chain_config_t cfg;
    double widened[2][COUNT];
    for (int known = 0; known < 2; ++known) {
        chain_defaults(&cfg, 3, 4, 1.0);
        cfg.sim.lag_s = 0.15;
        cfg.budget = 0;
        cfg.id.uncertainty.delay_s = 0; /* a given delay has none */
        if (known) {                    /* as it was estimated */
            memcpy(cfg.id.metric.delay_s, chain.id.estimate.delay_s, sizeof cfg.id.metric.delay_s);
            cfg.id.metric.first_order_lag = chain.id.estimate.first_order_lag;
            cfg.id.metric.estimate_delay = false;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 4));
        TEST_ASSERT_TRUE(chain_finish(&chain, UINT32_MAX, 10) <= 10);
        for (int i = 0; i < COUNT; ++i) {
            widened[known][i] = (double)chain.id.estimate.confidence.sigma[i];
        }
    }
    for (int i = 0; i < COUNT; ++i) {
        double ratio = widened[0][i] / widened[1][i];
        TEST_ASSERT_TRUE(ratio > 0.999);
        TEST_ASSERT_TRUE(ratio < 2.0);
        TEST_ASSERT_TRUE(i > AUVID_G500_M_R || ratio > 1.03);
    }
}

/* ---- notes ---- */

static void test_good_data_make_everything_identifiable(void)
{
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, result->identifiable);
    TEST_ASSERT_EQUAL_HEX32(0, result->implausible);
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, result->note[i]);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_EQUAL((ALL >> j & 1u) != 0, result->effective_noise[j] > AUVID_C(0.0));
        TEST_ASSERT_EQUAL((ALL >> j & 1u) != 0, result->residual_rms[j] > AUVID_C(0.0));
    }
}

static void test_a_fixed_parameter_is_called_so(void)
{
    auvid_metric_config_t cfg = default_config();
    cfg.free = AUVID_G500_FREE & ~(1u << AUVID_G500_N_RR);
    cfg.fixed[AUVID_G500_N_RR] = truth[AUVID_G500_N_RR];
    record(&cfg, &(world_t){ALL, SETS, 1.0, 0.0});
    estimate_all();
    TEST_ASSERT_EQUAL(AUVID_NOTE_FIXED, result->note[AUVID_G500_N_RR]);
    TEST_ASSERT_TRUE(result->sigma[AUVID_G500_N_RR] == AUVID_LARGEST);
    TEST_ASSERT_EQUAL_HEX32(cfg.free, result->identifiable);
}

static void test_parameters_of_a_dof_that_was_not_excited_are_not_known(void)
{
    observe(&(world_t){SURGE, SETS, 0.0, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        bool surge = auvid_girona500.parameter[i].dof == AUVID_SURGE;
        bool heave = auvid_girona500.parameter[i].dof == AUVID_HEAVE;
        TEST_ASSERT_TRUE(surge || !is_identifiable(i));
        TEST_ASSERT_TRUE(surge || heave || result->note[i] == AUVID_NOTE_NOT_EXCITED);
        TEST_ASSERT_TRUE(surge == (result->sigma[i] < AUVID_LARGEST));
    }
}

static void tonnes(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                   auvid_regressor_t *y)
{
    auvid_girona500.regressor(context, s, pi, y);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        y->row[j][AUVID_G500_M_U] *= 1000;
    }
}

/* A model may use its own units. */
static void test_a_mass_in_tonnes_is_as_identifiable_as_in_kilograms(void)
{
    static auvid_vehicle_t vehicle;
    auvid_metric_config_t cfg = default_config();
    record(&cfg, &(world_t){ALL, SETS, 1.0, 0.0});
    estimate_all();
    uint32_t identifiable = result->identifiable;
    vehicle = auvid_girona500;
    vehicle.regressor = tonnes;
    cfg.vehicle = &vehicle;
    record(&cfg, &(world_t){ALL, SETS, 1.0, 0.0});
    estimate_all();
    TEST_ASSERT_EQUAL_HEX32(identifiable, result->identifiable);
}

/* A velocity that is always measured as zero does not determine drag; the mass is known. */
static void test_drags_of_a_velocity_that_is_always_zero_are_not_known(void)
{
    const uint32_t drags = 1u << AUVID_G500_X_U | 1u << AUVID_G500_X_UU;
    const world_t world = {ALL, SETS, 1.0, 0.0};
    auvid_metric_config_t cfg = default_config();
    uint64_t state = 5;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, &cfg));
    for (uint64_t k = 1; metric.sets.recorded < SETS; ++k) {
        auvid_sample_t s;
        move(0.1 * (double)k, world.dofs, &s);
        s.nu[AUVID_SURGE] = 0;
        add_noise(&s, &world, &state);
        s.t_us = 100000 * k;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= AUVID_OK);
    }
    estimate_without(drags, 0);
    TEST_ASSERT_EQUAL_HEX32(0, result->identifiable & drags);
    TEST_ASSERT_TRUE(is_identifiable(AUVID_G500_M_U));
    for (int i = AUVID_G500_X_U; i <= AUVID_G500_X_UU; ++i) {
        TEST_ASSERT_TRUE(result->sigma[i] == AUVID_LARGEST);
        TEST_ASSERT_EQUAL(AUVID_NOTE_UNCERTAIN, result->note[i]);
    }
}

/* W-B and Z_0 differ only by the cosine of small angles. */
static void test_two_constants_of_heave_are_known_as_a_sum_only(void)
{
    static auvid_confidence_t single;
    auvid_metric_config_t cfg = default_config();
    observe(&(world_t){1u << AUVID_HEAVE | SURGE, SETS, 1.0, 0.0});
    single = *result;
    cfg.free = AUVID_G500_FREE | 1u << AUVID_G500_Z_0;
    record(&cfg, &(world_t){1u << AUVID_HEAVE, SETS, 1.0, 0.0});
    estimate_without(1u << AUVID_G500_Z_0, AUVID_C(0.0));
    TEST_ASSERT_EQUAL(AUVID_NOTE_COMBINATION, result->note[AUVID_G500_W_B]);
    TEST_ASSERT_EQUAL(AUVID_NOTE_COMBINATION, result->note[AUVID_G500_Z_0]);
    TEST_ASSERT_EQUAL(AUVID_G500_Z_0, result->partner[AUVID_G500_W_B]);
    TEST_ASSERT_EQUAL(AUVID_G500_W_B, result->partner[AUVID_G500_Z_0]);
    static const int others[] = {AUVID_G500_M_W, AUVID_G500_Z_W, AUVID_G500_Z_WW};
    for (int k = 0; k < 3; ++k) {
        int i = others[k];
        TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, result->note[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 1.0, (double)result->sigma[i] / (double)single.sigma[i]);
    }
}

/* No parameter of surge is identifiable; the other equations are unchanged. */
static void expect_surge_discredited_by(int culprit)
{
    uint32_t surge = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U | 1u << AUVID_G500_X_UU;
    TEST_ASSERT_EQUAL_HEX32(1u << culprit, result->implausible);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~surge, result->identifiable);
    for (int i = 0; i < COUNT; ++i) {
        if (surge >> i & 1u) {
            TEST_ASSERT_EQUAL(AUVID_NOTE_DISCREDITED, result->note[i]);
            TEST_ASSERT_EQUAL(culprit, result->partner[i]);
        } else {
            TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, result->note[i]);
        }
    }
}

static void test_a_mass_below_the_dry_mass_discredits_its_equation(void)
{
    auvid_metric_config_t cfg = default_config();
    record(&cfg, &(world_t){ALL, SETS, 1.0, 0.0});
    estimate_without(0, AUVID_C(300.0)); /* m_u is 250 kg, the others more */
    expect_surge_discredited_by(AUVID_G500_M_U);
}

static void test_a_drag_that_accelerates_discredits_its_equation(void)
{
    truth[AUVID_G500_X_UU] = -truth[AUVID_G500_X_UU];
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    expect_surge_discredited_by(AUVID_G500_X_UU);
}

/* Its interval has possible values, but its impossible part explains much of the force. */
static void test_a_large_impossible_part_discredits_its_equation_without_being_known(void)
{
    truth[AUVID_G500_X_U] = AUVID_C(-1000.0);
    truth[AUVID_G500_X_UU] = AUVID_C(500.0);
    observe(&(world_t){ALL, SETS, 300.0, 0.0});
    TEST_ASSERT_TRUE(estimate[AUVID_G500_X_UU] < AUVID_C(2.1) * result->sigma[AUVID_G500_X_UU]);
    TEST_ASSERT_EQUAL(AUVID_NOTE_DISCREDITED, result->note[AUVID_G500_X_U]);
    TEST_ASSERT_EQUAL(AUVID_G500_X_UU, result->partner[AUVID_G500_X_U]);
    TEST_ASSERT_FALSE(is_identifiable(AUVID_G500_M_U) || is_identifiable(AUVID_G500_X_U) ||
                      is_identifiable(AUVID_G500_X_UU));
}

/* The estimate of a drag that is truly zero is positive in half of the runs. */
static void test_a_zero_drag_that_comes_out_positive_discredits_nothing(void)
{
    int positive = 0;
    for (int k = 0; k < 8; ++k) {
        truth[AUVID_G500_X_U] = (auvid_real_t)(0.2 * (k - 3));
        observe(&(world_t){ALL, SETS, 1.0, 0.0});
        positive += estimate[AUVID_G500_X_U] > AUVID_C(0.0);
        TEST_ASSERT_EQUAL_HEX32(0, result->implausible);
        TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~(1u << AUVID_G500_X_U), result->identifiable);
    }
    TEST_ASSERT_TRUE(positive > 0 && positive < 8);
}

/* A search that ended at its bounds or in a worse optimum: the mass seems well determined. */
static void test_what_explains_no_force_is_implausible(void)
{
    auvid_real_t r2[AUVID_DOF_COUNT];
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    TEST_ASSERT_EQUAL_HEX32(0, result->implausible);
    estimate[AUVID_G500_M_U] *= AUVID_C(3.0);
    compute_confidence(AUVID_C(0.0));
    auvid_metric_r2(&metric, r2);
    TEST_ASSERT_TRUE(r2[AUVID_SURGE] < 0);
    TEST_ASSERT_TRUE(is_identifiable(AUVID_G500_M_U));
    TEST_ASSERT_EQUAL_HEX32(1u << AUVID_G500_M_U, result->implausible);
    TEST_ASSERT_EQUAL(AUVID_NOTE_IMPLAUSIBLE, result->note[AUVID_G500_M_U]);
}

/* ---- bounds ---- */

static auvid_real_t lower[AUVID_MAX_PARAMETERS], upper[AUVID_MAX_PARAMETERS];

/* The confidence in `estimate` of a search within the bounds. */
static void compute_within_bounds(bool not_converged)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_measure_begin(&metric, estimate, AUVID_C(0.0));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
    auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), NULL);
    auvid_confidence_limits(&job, lower, upper, not_converged);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
}

/* A run that determines all parameters, with m_u at its upper bound, `part` of its optimum. The
 * other parameters are optimal for it. @return where they would be without the bound */
static const auvid_real_t *hold_mass(double part)
{
    static auvid_real_t optimum[AUVID_MAX_PARAMETERS];
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    memcpy(optimum, estimate, sizeof optimum);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        lower[i] = AUVID_C(-2000.0);
        upper[i] = AUVID_C(2000.0);
    }
    upper[AUVID_G500_M_U] = (auvid_real_t)(part * (double)optimum[AUVID_G500_M_U]);
    estimate[AUVID_G500_M_U] = upper[AUVID_G500_M_U];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(
                                    &metric, AUVID_G500_FREE & ~(1u << AUVID_G500_M_U), estimate));
    compute_within_bounds(false);
    return optimum;
}

static void test_a_parameter_at_its_bound_is_named_with_it_and_not_identifiable(void)
{
    (void)hold_mass(0.9);
    TEST_ASSERT_EQUAL(AUVID_NOTE_AT_BOUND, result->note[AUVID_G500_M_U]);
    TEST_ASSERT_FALSE(is_identifiable(AUVID_G500_M_U));
    TEST_ASSERT_TRUE(result->bound[AUVID_G500_M_U] == upper[AUVID_G500_M_U]);
    TEST_ASSERT_EQUAL(1, result->partner[AUVID_G500_M_U]);
    TEST_ASSERT_TRUE(result->sigma[AUVID_G500_M_U] == AUVID_LARGEST);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) { /* the lower one */
        estimate[i] = -estimate[i];
        lower[i] = -upper[i];
    }
    compute_within_bounds(false);
    TEST_ASSERT_EQUAL(AUVID_NOTE_AT_BOUND, result->note[AUVID_G500_M_U]);
    TEST_ASSERT_EQUAL(0, result->partner[AUVID_G500_M_U]);
    TEST_ASSERT_TRUE(result->bound[AUVID_G500_M_U] == lower[AUVID_G500_M_U]);
}

/* The residual gives the standard errors of such a result, so the half-widths are known. */
static void test_a_parameter_that_a_bound_shifts_by_more_than_its_half_width_is_named(void)
{
    static const double parts[] = {0.5, 0.9, 0.99};
    int named = 0, left = 0;
    for (size_t k = 0; k < sizeof parts / sizeof parts[0]; ++k) {
        const auvid_real_t *free = hold_mass(parts[k]);
        static auvid_confidence_t within;
        within = *result;
        compute_confidence(AUVID_C(0.0)); /* the same without bounds: half-widths */
        for (int i = 0; i < COUNT; ++i) {
            double moves = fabs((double)free[i] - (double)estimate[i]);
            double half = 2.1 * (double)result->sigma[i];
            if (i == AUVID_G500_M_U || fabs(moves / half - 1.0) < 0.05) {
                continue;
            }
            bool beside_bound = within.note[i] == AUVID_NOTE_BESIDE_BOUND;
            TEST_ASSERT_EQUAL(moves > half, beside_bound);
            TEST_ASSERT_FALSE(beside_bound && (within.identifiable >> i & 1u));
            TEST_ASSERT_TRUE(!beside_bound || within.partner[i] == AUVID_G500_M_U);
            named += beside_bound;
            left += !beside_bound && (within.identifiable >> i & 1u);
        }
    }
    TEST_ASSERT_TRUE(named > 0);
    TEST_ASSERT_TRUE(left > 0);
}

static void test_a_parameter_near_a_bound_by_more_than_its_half_width_is_not_at_it(void)
{
    (void)hold_mass(0.9);
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    upper[AUVID_G500_M_U] = estimate[AUVID_G500_M_U] + AUVID_C(1.0); /* a thousandth is 2.2 kg */
    TEST_ASSERT_TRUE(AUVID_C(2.1) * result->sigma[AUVID_G500_M_U] < AUVID_C(1.0));
    compute_within_bounds(false);
    TEST_ASSERT_EQUAL(AUVID_NOTE_NONE, result->note[AUVID_G500_M_U]);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, result->identifiable);
}

static void test_a_search_that_has_not_converged_identifies_nothing(void)
{
    (void)hold_mass(0.9);
    compute_within_bounds(true);
    TEST_ASSERT_EQUAL_HEX32(0, result->identifiable | result->implausible);
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_EQUAL(AUVID_NOTE_NOT_CONVERGED, result->note[i]);
        TEST_ASSERT_TRUE(result->sigma[i] == AUVID_LARGEST);
    }
}

static void test_a_parameter_known_to_be_zero_is_called_small(void)
{
    truth[AUVID_G500_X_U] = AUVID_C(0.0);
    observe(&(world_t){ALL, SETS, 0.02, 0.0});
    TEST_ASSERT_EQUAL(AUVID_NOTE_SMALL, result->note[AUVID_G500_X_U]);
    TEST_ASSERT_FALSE(is_identifiable(AUVID_G500_X_U));
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE & ~(1u << AUVID_G500_X_U), result->identifiable);
}

static void test_a_parameter_that_may_be_zero_is_not_called_small(void)
{
    truth[AUVID_G500_X_U] = AUVID_C(0.0);
    observe(&(world_t){ALL, SETS, 20.0, 0.0});
    TEST_ASSERT_TRUE(result->note[AUVID_G500_X_U] == AUVID_NOTE_UNCERTAIN ||
                     result->note[AUVID_G500_X_U] == AUVID_NOTE_COMBINATION);
}

/* Noise of the acceleration makes masses smaller: a note says where this may be large. */
static void test_a_mass_that_noise_may_bias_is_called_so(void)
{
    observe(&(world_t){ALL, SETS, 0.0, 0.2});
    TEST_ASSERT_EQUAL(AUVID_NOTE_NOISE, result->note[AUVID_G500_M_U]);
    TEST_ASSERT_TRUE(estimate[AUVID_G500_M_U] < truth[AUVID_G500_M_U]);
    double short_by = (double)truth[AUVID_G500_M_U] - (double)estimate[AUVID_G500_M_U];
    TEST_ASSERT_TRUE(short_by < 2.0 * (double)result->sigma[AUVID_G500_M_U]);
}

static void test_too_much_noise_makes_all_uncertain(void)
{
    observe(&(world_t){ALL, 1, 300.0, 0.0});
    TEST_ASSERT_EQUAL_HEX32(0, result->identifiable);
    TEST_ASSERT_EQUAL_HEX32(0, result->implausible);
    TEST_ASSERT_EQUAL(AUVID_NOTE_UNCERTAIN, result->note[AUVID_G500_M_R]);
}

/* ---- sentences ---- */

static auvid_confidence_t notes;
static char text[160];

static void expect(const char *words, unsigned which)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE,
                                                         which, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(words, text);
}

static void test_every_need_has_its_sentence(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_U] = AUVID_NOTE_NOISE;
    notes.note[AUVID_G500_M_R] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_W_B] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_X_U] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_X_UU] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_Z_W] = AUVID_NOTE_SMALL;
    notes.note[AUVID_G500_Z_WW] = AUVID_NOTE_IMPLAUSIBLE;
    notes.note[AUVID_G500_Y_VV] = AUVID_NOTE_FIXED;
    expect("surge: too little acceleration for m_u; sines of 0.1-0.3 Hz, stronger or for longer",
           0);
    expect("yaw: too little acceleration for m_r; sines of 0.1-0.3 Hz, stronger or for longer", 1);
    expect("heave: too short a record for W-B; continue recording", 2);
    expect("surge: too little slow motion for X_u; more steps held 4-8 s, some at a third of the "
           "strength",
           3);
    expect("surge: too little speed for X_uu; steps held 4-8 s, stronger or more of them", 4);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 5, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("", text);
}

static void test_an_unexplained_force_is_reported_before_any_advice_on_motion(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_U] = notes.note[AUVID_G500_X_U] = AUVID_NOTE_UNCERTAIN;
    notes.note[AUVID_G500_N_R] = notes.note[AUVID_G500_N_RR] = AUVID_NOTE_UNCERTAIN;
    notes.partner[AUVID_G500_N_R] = notes.partner[AUVID_G500_N_RR] = 1;
    notes.bound[AUVID_G500_N_R] = notes.bound[AUVID_G500_N_RR] = AUVID_C(0.359);
    expect("yaw: only 35 % of the force is explained; check signs, thrust, time stamps, current "
           "and cable",
           0);
    expect("surge: too little acceleration for m_u; sines of 0.1-0.3 Hz, stronger or for longer",
           1);
    expect("surge: too little slow motion for X_u; more steps held 4-8 s, some at a third of the "
           "strength",
           2);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 3, text, sizeof text));
    notes.bound[AUVID_G500_N_R] = -2;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE,
                                                         0, text, sizeof text));
    TEST_ASSERT_NOT_NULL(strstr(text, "only 0 %"));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_note(&notes, &auvid_girona500, AUVID_G500_N_R,
                                                      text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("most of the force is unexplained", text);
}

static void test_an_unexplained_force_never_asks_for_motion(void)
{
    observe(&(world_t){ALL, 1, 300.0, 0.0});
    for (unsigned which = 0; auvid_confidence_missing(result, &auvid_girona500, AUVID_G500_FREE,
                                                      which, text, sizeof text) == AUVID_OK;
         ++which) {
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, "of the force is explained"), text);
    }
    for (int i = 0; i < auvid_girona500.parameters; ++i) {
        TEST_ASSERT_TRUE(result->note[i] != AUVID_NOTE_UNCERTAIN || result->partner[i] == 1);
    }
}

static void test_a_large_part_of_rows_lost_to_gaps_is_reported(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_U] = AUVID_NOTE_UNCERTAIN;
    notes.lost[AUVID_SURGE] = 5;
    notes.lost[AUVID_HEAVE] = AUVID_CONFIDENCE_LOST_PERCENT - 1;
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 1, text, sizeof text));
    notes.lost[AUVID_HEAVE] = 37;
    expect("heave: 37 % of the rows were lost to gaps in the record", 1);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 2, text, sizeof text));
}

static void test_a_pair_and_a_dof_have_one_sentence_each(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_X_U] = notes.note[AUVID_G500_X_UU] = AUVID_NOTE_COMBINATION;
    notes.partner[AUVID_G500_X_U] = AUVID_G500_X_UU;
    notes.partner[AUVID_G500_X_UU] = AUVID_G500_X_U;
    notes.note[AUVID_G500_M_V] = notes.note[AUVID_G500_Y_V] = notes.note[AUVID_G500_Y_VV] =
        AUVID_NOTE_NOT_EXCITED;
    notes.note[AUVID_G500_M_W] = notes.note[AUVID_G500_W_B] = AUVID_NOTE_COMBINATION;
    notes.partner[AUVID_G500_M_W] = AUVID_G500_W_B;
    notes.partner[AUVID_G500_W_B] = AUVID_G500_M_W;
    expect("sway: not excited; apply steps held 4-8 s and sines of 0.1-0.3 Hz", 0);
    expect("heave: m_w and W-B cannot be distinguished; fix one of them, or vary the motion", 1);
    expect("surge: X_u and X_uu cannot be distinguished; steps held 4-8 s at two strengths", 2);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 3, text, sizeof text));
}

static void test_a_bound_is_reported_with_its_value_and_its_dependents(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_V] = notes.note[AUVID_G500_Z_W] = AUVID_NOTE_AT_BOUND;
    notes.partner[AUVID_G500_M_V] = 1;
    notes.bound[AUVID_G500_M_V] = AUVID_C(300.0);
    notes.bound[AUVID_G500_Z_W] = AUVID_C(-0.05);
    notes.note[AUVID_G500_X_U] = notes.note[AUVID_G500_Y_VV] = AUVID_NOTE_BESIDE_BOUND;
    notes.partner[AUVID_G500_X_U] = notes.partner[AUVID_G500_Y_VV] = AUVID_G500_M_V;
    expect("sway: m_v is at its upper bound of 300 kg: widen it", 0);
    expect("surge: m_v at its bound also changes X_u, Y_vv", 1);
    expect("heave: Z_w is at its lower bound of -0.05 N s/m: widen it", 2);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 3, text, sizeof text));
}

static void test_numbers_in_sentences_are_those_of_printf(void)
{
    static const double numbers[] = {0,     1,        -1,   0.001,     0.5,
                                     12.25, -999.999, 1000, 65536.125, 999999};
    for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; ++k) {
        char words[100];
        memset(&notes, 0, sizeof notes);
        notes.note[AUVID_G500_M_U] = AUVID_NOTE_AT_BOUND;
        notes.bound[AUVID_G500_M_U] = (auvid_real_t)numbers[k];
        (void)snprintf(words, sizeof words, "surge: m_u is at its lower bound of %.9g kg: widen it",
                       numbers[k]);
        expect(words, 0);
    }
}

static void test_a_search_that_has_not_converged_is_reported_once(void)
{
    memset(&notes, 0, sizeof notes);
    notes.note[AUVID_G500_M_U] = notes.note[AUVID_G500_X_U] = notes.note[AUVID_G500_Y_V] =
        AUVID_NOTE_NOT_CONVERGED;
    expect("the search has not converged; narrow the bounds, or give a good start", 0);
    TEST_ASSERT_EQUAL(
        AUVID_FINISHED,
        auvid_confidence_missing(&notes, &auvid_girona500, AUVID_G500_FREE, 1, text, sizeof text));
}

static void test_before_the_first_estimate_every_dof_is_asked_for(void)
{
    static const char *const dof[] = {"surge: ", "sway: ", "heave: ", "yaw: "};
    unsigned which = 0;
    for (;
         auvid_confidence_missing(NULL, &auvid_girona500, 0, which, text, sizeof text) == AUVID_OK;
         ++which) {
        TEST_ASSERT_TRUE(which < 4);
        TEST_ASSERT_EQUAL_PTR(text, strstr(text, dof[which]));
        TEST_ASSERT_NOT_NULL(strstr(text, "not excited"));
    }
    TEST_ASSERT_EQUAL(4, which);
}

static void test_a_text_too_long_is_truncated_and_terminated(void)
{
    for (size_t size = 1; size < 60; ++size) {
        memset(text, 'x', sizeof text);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_confidence_missing(NULL, &auvid_girona500, 0, 0, text, size));
        TEST_ASSERT_EQUAL(size - 1, strlen(text));
        TEST_ASSERT_EQUAL('x', text[size]);
        TEST_ASSERT_EQUAL(0, memcmp(text, "surge: not excited; apply steps held 4-8 s and sines o",
                                    size - 1 < 54 ? size - 1 : 54));
    }
}

static void expect_note(const auvid_confidence_t *c, int i, const char *expected)
{
    char text[64];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_note(c, &auvid_girona500, i, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING(expected, text);
}

static void test_a_note_names_the_partner(void)
{
    static auvid_confidence_t c;
    char text[10];
    memset(&c, 0, sizeof c);
    c.partner[AUVID_G500_X_U] = AUVID_G500_X_UU;
    c.note[AUVID_G500_X_U] = AUVID_NOTE_COMBINATION;
    expect_note(&c, AUVID_G500_X_U, "only a combination with X_uu");
    TEST_ASSERT_EQUAL(
        AUVID_OK, auvid_confidence_note(&c, &auvid_girona500, AUVID_G500_X_U, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("only a co", text);
    c.note[AUVID_G500_X_U] = AUVID_NOTE_BESIDE_BOUND;
    expect_note(&c, AUVID_G500_X_U, "depends on X_uu, at its bound");
    c.note[AUVID_G500_X_U] = AUVID_NOTE_DISCREDITED;
    expect_note(&c, AUVID_G500_X_U, "X_uu is impossible");
    c.note[AUVID_G500_X_U] = AUVID_NOTE_SMALL;
    expect_note(&c, AUVID_G500_X_U, "too small to matter");
    c.note[AUVID_G500_X_U] = AUVID_NOTE_NONE;
    expect_note(&c, AUVID_G500_X_U, "");
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_note(NULL, &auvid_girona500, 0, text, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_note(&c, NULL, 0, text, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_note(&c, &auvid_girona500, 0, NULL, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_confidence_note(&c, &auvid_girona500, 0, text, 0));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_confidence_note(&c, &auvid_girona500, -1, text, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_confidence_note(&c, &auvid_girona500, AUVID_G500_COUNT, text, 10));
}

/* X_uu is in two pairs: the sentence of X_u does not name m_u. */
static void test_what_is_missing_names_each_of_three_parameters_that_move_together(void)
{
    static auvid_confidence_t c;
    char text[128];
    const uint32_t free = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U | 1u << AUVID_G500_X_UU;
    memset(&c, 0, sizeof c);
    c.note[AUVID_G500_M_U] = c.note[AUVID_G500_X_U] = c.note[AUVID_G500_X_UU] =
        AUVID_NOTE_COMBINATION;
    c.partner[AUVID_G500_M_U] = AUVID_G500_X_UU;
    c.partner[AUVID_G500_X_UU] = AUVID_G500_M_U;
    c.partner[AUVID_G500_X_U] = AUVID_G500_M_U;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_confidence_missing(&c, &auvid_girona500, free, 0, text, sizeof text));
    TEST_ASSERT_NOT_NULL(strstr(text, "m_u and X_uu cannot be distinguished"));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_confidence_missing(&c, &auvid_girona500, free, 1, text, sizeof text));
    TEST_ASSERT_NOT_NULL(strstr(text, "X_u and m_u cannot be distinguished"));
    TEST_ASSERT_EQUAL(AUVID_FINISHED,
                      auvid_confidence_missing(&c, &auvid_girona500, free, 2, text, sizeof text));
}

static void test_every_note_has_a_phrase(void)
{
    for (int a = AUVID_NOTE_FIXED; a <= AUVID_NOTE_UNCHECKED; ++a) {
        TEST_ASSERT_TRUE(strlen(auvid_note_str((auvid_note_t)a)) > 5);
        for (int b = AUVID_NOTE_NONE; b < a; ++b) {
            TEST_ASSERT_TRUE(
                strcmp(auvid_note_str((auvid_note_t)a), auvid_note_str((auvid_note_t)b)) != 0);
        }
    }
    TEST_ASSERT_EQUAL_STRING("", auvid_note_str(AUVID_NOTE_NONE));
    TEST_ASSERT_EQUAL_STRING("unknown note", auvid_note_str((auvid_note_t)77));
}

static void test_wrong_arguments_are_refused(void)
{
    uint32_t budget = 1;
    observe(&(world_t){SURGE, 1, 1.0, 0.0});
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_work(NULL, &metric, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_work(&job, NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_work(&job, &metric, NULL));
    TEST_ASSERT_EQUAL_UINT32(1, budget);
    auvid_confidence_begin(NULL, &metric, estimate, AUVID_C(0.0), NULL);
    auvid_confidence_begin(&job, NULL, estimate, AUVID_C(0.0), NULL);
    auvid_confidence_begin(&job, &metric, NULL, AUVID_C(0.0), NULL);
    auvid_confidence_limits(NULL, lower, upper, true);
    auvid_confidence_limits(&job, NULL, upper, true);
    auvid_confidence_limits(&job, lower, NULL, true);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_confidence_missing(&notes, NULL, 0, 0, text, sizeof text));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_confidence_missing(&notes, &auvid_girona500, 0, 0, NULL, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_confidence_missing(&notes, &auvid_girona500, 0, 0, text, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_standard_errors_are_proportional_to_the_noise);
    RUN_TEST(test_standard_errors_fall_as_sets_come_in);
    RUN_TEST(test_one_set_is_enough_for_standard_errors);
    RUN_TEST(test_float_and_double_give_the_same_standard_errors);
    RUN_TEST(test_any_budget_gives_the_same_bits);
    RUN_TEST(test_a_job_copied_half_way_with_its_metric_continues);
    RUN_TEST(test_the_cost_of_eight_sets_is_what_the_header_says);
    RUN_TEST(test_an_estimated_delay_widens_the_masses);
    RUN_TEST(test_good_data_make_everything_identifiable);
    RUN_TEST(test_a_fixed_parameter_is_called_so);
    RUN_TEST(test_parameters_of_a_dof_that_was_not_excited_are_not_known);
    RUN_TEST(test_a_mass_in_tonnes_is_as_identifiable_as_in_kilograms);
    RUN_TEST(test_drags_of_a_velocity_that_is_always_zero_are_not_known);
    RUN_TEST(test_two_constants_of_heave_are_known_as_a_sum_only);
    RUN_TEST(test_a_mass_below_the_dry_mass_discredits_its_equation);
    RUN_TEST(test_a_drag_that_accelerates_discredits_its_equation);
    RUN_TEST(test_a_large_impossible_part_discredits_its_equation_without_being_known);
    RUN_TEST(test_a_zero_drag_that_comes_out_positive_discredits_nothing);
    RUN_TEST(test_what_explains_no_force_is_implausible);
    RUN_TEST(test_a_parameter_at_its_bound_is_named_with_it_and_not_identifiable);
    RUN_TEST(test_a_parameter_that_a_bound_shifts_by_more_than_its_half_width_is_named);
    RUN_TEST(test_a_parameter_near_a_bound_by_more_than_its_half_width_is_not_at_it);
    RUN_TEST(test_a_search_that_has_not_converged_identifies_nothing);
    RUN_TEST(test_a_parameter_known_to_be_zero_is_called_small);
    RUN_TEST(test_a_parameter_that_may_be_zero_is_not_called_small);
    RUN_TEST(test_a_mass_that_noise_may_bias_is_called_so);
    RUN_TEST(test_too_much_noise_makes_all_uncertain);
    RUN_TEST(test_every_need_has_its_sentence);
    RUN_TEST(test_an_unexplained_force_is_reported_before_any_advice_on_motion);
    RUN_TEST(test_an_unexplained_force_never_asks_for_motion);
    RUN_TEST(test_a_large_part_of_rows_lost_to_gaps_is_reported);
    RUN_TEST(test_a_pair_and_a_dof_have_one_sentence_each);
    RUN_TEST(test_a_bound_is_reported_with_its_value_and_its_dependents);
    RUN_TEST(test_numbers_in_sentences_are_those_of_printf);
    RUN_TEST(test_a_search_that_has_not_converged_is_reported_once);
    RUN_TEST(test_before_the_first_estimate_every_dof_is_asked_for);
    RUN_TEST(test_a_text_too_long_is_truncated_and_terminated);
    RUN_TEST(test_every_note_has_a_phrase);
    RUN_TEST(test_wrong_arguments_are_refused);
    RUN_TEST(test_a_note_names_the_partner);
    RUN_TEST(test_what_is_missing_names_each_of_three_parameters_that_move_together);
    return UNITY_END();
}
