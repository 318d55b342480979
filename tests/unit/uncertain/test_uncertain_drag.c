/*
 * Drag force in one direction: of a hull whose drag differs forward and backward, at speeds that
 * were seen, within its half-width; without asymmetry that of the estimate.
 */
#include <math.h>
#include <string.h>

#include "field_identify.h"
#include "identifier/auvid_identifier_internal.h"

static auvid_causes_t causes;
static auvid_estimate_t estimate;
static auvid_drag_t drag, mean;

void setUp(void)
{
    memset(&causes, 0, sizeof causes);
    memset(&estimate, 0, sizeof estimate);
}

void tearDown(void)
{
}

/* Of so many directions, at all speeds: how many mean forces are off by more than a tenth; how many
 * forces in one direction are. Each is identifiable, and the latter within its half-width. */
static void count_off(int directions, int off[2])
{
    off[0] = off[1] = 0;
    for (int k = 1; k < FIELD_PARTS; ++k) {
        for (int d = 0; d < directions; ++d) {
            double speed = field_part[k] * record.truth.speed[d / 2][d % 2];
            double truth = field_drag(record.truth.one_way[d % 2], d / 2, d % 2 ? -speed : speed);
            const field_force_t *force = &record.one_way[k][d];
            TEST_ASSERT_TRUE(force->flagged);
            TEST_ASSERT_DOUBLE_WITHIN(force->half, truth, force->value);
            TEST_ASSERT_TRUE(force->half < 0.2 * fabs(truth));
            off[0] += fabs(record.force[k][d].value - truth) > 0.1 * fabs(truth);
            off[1] += fabs(force->value - truth) > 0.1 * fabs(truth);
        }
    }
}

static void test_each_direction_of_an_asymmetric_hull_has_its_own_drag(void)
{
    for (int vehicle = 0; vehicle < FIELD_ANY; ++vehicle) {
        int off[2];
        prepare((field_vehicle_t)vehicle, FIELD_EXCITED, 4);
        choose("drag_asymmetry", 0.2);
        identify();
        count_off(FIELD_DIRECTIONS, off);
        TEST_ASSERT_GREATER_THAN(2 * FIELD_DIRECTIONS / 2, off[0]);
        TEST_ASSERT_EQUAL(0, off[1]);
    }
}

/* Of a hull that has half of its drag more forward than backward, or the other way round. */
static void test_the_asymmetry_is_that_of_the_hull(void)
{
    for (int vehicle = 0; vehicle < FIELD_ANY; ++vehicle) {
        prepare((field_vehicle_t)vehicle, FIELD_EXCITED, 4);
        choose("drag_asymmetry", 0.4);
        identify();
        for (int e = 0; e < FIELD_EQUATIONS; ++e) {
            int j = field_dof(e);
            double truth = run.field.hull.asymmetry[j];
            TEST_ASSERT_DOUBLE_WITHIN(0.05, truth, (double)record.causes.asymmetry[j]);
        }
    }
}

static int chosen;
static double given;

static bool fix_chosen(auvid_identifier_config_t *cfg)
{
    cfg->metric.free &= ~(1u << chosen);
    cfg->metric.fixed[chosen] = (auvid_real_t)given;
    return true;
}

static void test_a_parameter_that_is_known_leaves_the_others_right(void)
{
    static const int known[] = {AUVID_G500_M_U, AUVID_G500_W_B, AUVID_G500_X_U, AUVID_G500_X_UU};
    field_sheet_t sheet;
    field_sheet(FIELD_GIRONA500, 6, &sheet);
    for (size_t k = 0; k < sizeof known / sizeof known[0]; ++k) {
        prepare(FIELD_GIRONA500, FIELD_EXCITED, 6);
        chosen = known[k];
        given = sheet.parameter[chosen];
        choose("current", 0.08);
        field.configure = fix_chosen;
        identify();
        TEST_ASSERT_FALSE(record.estimated[chosen]);
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            if (record.flagged[i]) {
                TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.06, 0.0, error(i),
                                                  auvid_girona500.parameter[i].name);
            }
        }
        TEST_ASSERT_TRUE(record.flagged[AUVID_G500_M_V] && record.flagged[AUVID_G500_Z_WW]);
    }
}

static bool bound_chosen(auvid_identifier_config_t *cfg)
{
    cfg->search.lower[chosen] = (auvid_real_t)given;
    return true;
}

/* Then no cause is named, but each direction still has its own drag. */
static void test_a_bound_leaves_the_asymmetry(void)
{
    int off[2];
    prepare(FIELD_GIRONA500, FIELD_EXCITED, 4);
    choose("drag_asymmetry", 0.2);
    chosen = AUVID_G500_N_RR;
    given = -15.0; /* the truth is -61 */
    field.configure = bound_chosen;
    identify();
    TEST_ASSERT_EQUAL(AUVID_NOTE_AT_BOUND, record.note[AUVID_G500_N_RR]);
    TEST_ASSERT_EQUAL(0, record.causes.named);
    count_off(2, off); /* of surge */
    TEST_ASSERT_TRUE(off[0] >= 3 && off[1] == 0);
}

/* It looks like asymmetry: the half-widths contain it. */
static void test_weaker_backward_thrust_is_within_the_half_width(void)
{
    int off[2];
    prepare(FIELD_GIRONA500, FIELD_EXCITED, 5);
    choose("thrust_backward", 0.05);
    identify();
    count_off(FIELD_DIRECTIONS, off);
}

/* Place of a variance in the packed covariance. */
static int variance_of(int i)
{
    return i * (int)auvid_girona500.parameters - i * (i - 1) / 2;
}

static void use_known_estimate(void)
{
    const int linear = AUVID_G500_X_U, quadratic = AUVID_G500_X_UU;
    estimate.number = causes.number = 3;
    estimate.excited = 0x01;
    estimate.speed[AUVID_SURGE][0] = estimate.speed[AUVID_SURGE][1] = AUVID_C(1.0);
    estimate.identified = 1u << linear | 1u << quadratic;
    estimate.pi[linear] = AUVID_C(-20.0);
    estimate.pi[quadratic] = AUVID_C(-40.0);
    estimate.confidence.thrust_error[linear] = AUVID_C(-1.0);
    estimate.confidence.thrust_error[quadratic] = AUVID_C(-2.0);
    estimate.confidence.dvl_error[quadratic] = AUVID_C(0.4);
    estimate.covariance[variance_of(linear)] = AUVID_C(4.0);
    estimate.covariance[variance_of(quadratic)] = AUVID_C(9.0);
    causes.asymmetry[AUVID_SURGE] = AUVID_C(0.1);
    causes.asymmetry_sigma[AUVID_SURGE] = AUVID_C(0.02);
    causes.one_way[AUVID_SURGE][0][0] = AUVID_C(0.35);
    causes.one_way[AUVID_SURGE][0][1] = AUVID_C(0.7);
    causes.one_way[AUVID_SURGE][1][0] = AUVID_C(0.32);
    causes.one_way[AUVID_SURGE][1][1] = AUVID_C(0.64);
}

static void surge_at(double speed)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_causes_drag(&causes, &estimate, &auvid_girona500, AUVID_SURGE,
                                                  (auvid_real_t)speed, &drag));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(&estimate, &auvid_girona500, AUVID_SURGE,
                                                    (auvid_real_t)speed, &mean));
}

static void test_force_and_its_half_width_follow_the_asymmetry(void)
{
    for (int backward = 0; backward < 2; ++backward) {
        double v = backward ? -0.5 : 0.5, square = backward ? -0.25 : 0.25;
        double column = backward ? 19.2 * 0.5 + 38.4 * 0.25 : 21.0 * 0.5 + 42.0 * 0.25;
        double base = -20.0 * v - 40.0 * square, force = base - 0.1 * column;
        double scale = fmax(force / base, 1.0), own = 0.02 * column;
        use_known_estimate();
        surge_at(v);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, force, (double)drag.force);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, hypot(scale * (double)mean.sigma, own), (double)drag.sigma);
        TEST_ASSERT_TRUE(drag.speed == (auvid_real_t)v);
        TEST_ASSERT_TRUE(drag.half_width == AUVID_CONFIDENCE_HALF_WIDTH * drag.sigma);
    }
}

/* 2.1 sigma is 16 % of the mean force, and beyond a fifth of what is left of it backward. */
static void test_the_limit_is_a_fifth_of_the_force_in_this_direction(void)
{
    use_known_estimate();
    causes.asymmetry[AUVID_SURGE] = AUVID_C(0.4);
    surge_at(0.9);
    TEST_ASSERT_TRUE(mean.identifiable && drag.identifiable);
    surge_at(0.04); /* 0.9 N */
    TEST_ASSERT_TRUE(drag.force < AUVID_C(1.3) * mean.force);
    estimate.not_converged = true;
    surge_at(0.9);
    TEST_ASSERT_FALSE(drag.identifiable);
    estimate.not_converged = false;
    surge_at(-0.9);
    TEST_ASSERT_TRUE(mean.identifiable && !drag.identifiable);
    TEST_ASSERT_TRUE(drag.force > AUVID_C(0.0) && drag.force < mean.force);
}

static void the_mean_is_taken(void)
{
    surge_at(-0.7);
    TEST_ASSERT_EQUAL_MEMORY(&mean, &drag, sizeof drag);
}

static void test_what_is_not_known_changes_nothing(void)
{
    use_known_estimate();
    causes.asymmetry_sigma[AUVID_SURGE] = AUVID_C(0.0);
    the_mean_is_taken();
    use_known_estimate();
    causes.number = 2; /* of another estimate */
    the_mean_is_taken();
}

/* As auvid_calibrated_estimate does. */
static void test_forces_of_an_estimate_in_other_newtons_are_in_these(void)
{
    use_known_estimate();
    surge_at(-0.7);
    auvid_drag_t supplied = drag;
    for (int i = AUVID_G500_X_U; i <= AUVID_G500_X_UU; ++i) {
        estimate.pi[i] *= AUVID_C(0.5);
        estimate.covariance[variance_of(i)] *= AUVID_C(0.25);
        estimate.confidence.thrust_error[i] *= AUVID_C(0.5);
        estimate.confidence.dvl_error[i] *= AUVID_C(0.5);
    }
    surge_at(-0.7);
    TEST_ASSERT_FLOAT_WITHIN(1e-4, 0.5 * supplied.force, drag.force);
    TEST_ASSERT_FLOAT_WITHIN(1e-4, 0.5 * supplied.sigma, drag.sigma);
}

static void test_an_unknown_error_stays_unknown(void)
{
    use_known_estimate();
    estimate.confidence.sigma[AUVID_G500_X_U] = AUVID_LARGEST;
    surge_at(0.7);
    TEST_ASSERT_TRUE(drag.sigma == AUVID_LARGEST && drag.half_width == AUVID_LARGEST);
    TEST_ASSERT_TRUE(drag.force < mean.force && !drag.identifiable);
    surge_at(0.0);
    TEST_ASSERT_EQUAL_MEMORY(&mean, &drag, sizeof drag);
}

/* A vehicle that only drives forward does not show its drag backward, and the force forward is no
 * less certain than that of the curve. */
static void test_motion_in_one_direction_shows_its_own_drag(void)
{
    use_known_estimate();
    causes.one_way[AUVID_SURGE][0][0] = causes.one_way[AUVID_SURGE][0][1] = AUVID_C(0.0);
    surge_at(0.7);
    TEST_ASSERT_TRUE(drag.force == mean.force && drag.sigma == mean.sigma);
}

static void test_errors_are_those_of_the_estimate(void)
{
    const auvid_vehicle_t *g500 = &auvid_girona500;
    use_known_estimate();
    memset(&drag, 1, sizeof drag);
    mean = drag;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_causes_drag(NULL, &estimate, g500, AUVID_SURGE, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_causes_drag(&causes, NULL, g500, AUVID_SURGE, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_causes_drag(&causes, &estimate, NULL, AUVID_SURGE, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_causes_drag(&causes, &estimate, g500, AUVID_SURGE, 1, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_causes_drag(&causes, &estimate, g500, AUVID_ROLL, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_causes_drag(&causes, &estimate, g500, (auvid_dof_t)77, 1, &drag));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_causes_drag(&causes, &estimate, g500, AUVID_SURGE,
                                                              (auvid_real_t)NAN, &drag));
    estimate.number = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA,
                      auvid_causes_drag(&causes, &estimate, g500, AUVID_SURGE, 1, &drag));
    TEST_ASSERT_EQUAL_MEMORY(&mean, &drag, sizeof drag);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_direction_of_an_asymmetric_hull_has_its_own_drag);
    RUN_TEST(test_the_asymmetry_is_that_of_the_hull);
    RUN_TEST(test_a_parameter_that_is_known_leaves_the_others_right);
    RUN_TEST(test_a_bound_leaves_the_asymmetry);
    RUN_TEST(test_weaker_backward_thrust_is_within_the_half_width);
    RUN_TEST(test_force_and_its_half_width_follow_the_asymmetry);
    RUN_TEST(test_the_limit_is_a_fifth_of_the_force_in_this_direction);
    RUN_TEST(test_what_is_not_known_changes_nothing);
    RUN_TEST(test_forces_of_an_estimate_in_other_newtons_are_in_these);
    RUN_TEST(test_an_unknown_error_stays_unknown);
    RUN_TEST(test_motion_in_one_direction_shows_its_own_drag);
    RUN_TEST(test_errors_are_those_of_the_estimate);
    return UNITY_END();
}
