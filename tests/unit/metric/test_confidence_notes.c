/*
 * Confidence: the notes of the parameters, on data for which they are known.
 */
#include <math.h>
#include <string.h>

#include "auvid/detail/confidence.h"
#include "confidence_data.h"
#include "unity.h"

void setUp(void)
{
    confidence_data_defaults();
}

void tearDown(void)
{
}

static bool is_identifiable(int i)
{
    return (result->identifiable >> i & 1u) != 0;
}

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

/* Thrust in kilograms-force would do this: the other masses may be possible, but not right. */
static void test_two_impossible_masses_discredit_everything(void)
{
    auvid_metric_config_t cfg = default_config();
    record(&cfg, &(world_t){ALL, SETS, 1.0, 0.0});
    estimate_without(0, AUVID_C(450.0)); /* m_u is 250 kg, m_v 368, m_w 660 */
    TEST_ASSERT_EQUAL_HEX32(0, result->identifiable);
    TEST_ASSERT_EQUAL_HEX32(1u << AUVID_G500_M_U | 1u << AUVID_G500_M_V, result->implausible);
    TEST_ASSERT_EQUAL(AUVID_NOTE_DISCREDITED, result->note[AUVID_G500_M_R]);
    TEST_ASSERT_EQUAL(AUVID_G500_M_U, result->partner[AUVID_G500_M_R]);
    TEST_ASSERT_TRUE(estimate[AUVID_G500_M_U] == result->bound[AUVID_G500_M_R]);
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_good_data_make_everything_identifiable);
    RUN_TEST(test_a_fixed_parameter_is_called_so);
    RUN_TEST(test_parameters_of_a_dof_that_was_not_excited_are_not_known);
    RUN_TEST(test_a_mass_in_tonnes_is_as_identifiable_as_in_kilograms);
    RUN_TEST(test_drags_of_a_velocity_that_is_always_zero_are_not_known);
    RUN_TEST(test_two_constants_of_heave_are_known_as_a_sum_only);
    RUN_TEST(test_a_mass_below_the_dry_mass_discredits_its_equation);
    RUN_TEST(test_two_impossible_masses_discredit_everything);
    RUN_TEST(test_a_drag_that_accelerates_discredits_its_equation);
    RUN_TEST(test_a_large_impossible_part_discredits_its_equation_without_being_known);
    RUN_TEST(test_a_zero_drag_that_comes_out_positive_discredits_nothing);
    RUN_TEST(test_what_explains_no_force_is_implausible);
    RUN_TEST(test_a_parameter_known_to_be_zero_is_called_small);
    RUN_TEST(test_a_parameter_that_may_be_zero_is_not_called_small);
    RUN_TEST(test_a_mass_that_noise_may_bias_is_called_so);
    RUN_TEST(test_too_much_noise_makes_all_uncertain);
    RUN_TEST(test_a_parameter_at_its_bound_is_named_with_it_and_not_identifiable);
    RUN_TEST(test_a_parameter_that_a_bound_shifts_by_more_than_its_half_width_is_named);
    RUN_TEST(test_a_parameter_near_a_bound_by_more_than_its_half_width_is_not_at_it);
    RUN_TEST(test_a_search_that_has_not_converged_identifies_nothing);
    return UNITY_END();
}
