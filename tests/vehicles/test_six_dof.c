/*
 * A BlueROV2 Heavy in six degrees of freedom: a pilot moves all of them, and the autopilot holds
 * roll and pitch. The identifier is passive, with uncertain inputs.
 */
#include <math.h>
#include <string.h>

#include "metric/auvid_metric_feedback_internal.h"
#include "uncertain/auvid_uncertain_table_internal.h"
#include "six_dof.h"

/* Where the pilot pushes the sticks. */
static const six_dof_sticks_t sticks = {.range = {38, 38, 38, 4, 4, 5}};

void setUp(void)
{
    sim_bluerov2(&world);
    world.seed = 5;
    world.disturbance_N = 1.0;
    world.disturbance_Nm = 0.1;
    world.lag_s = 0.15;
    sim_fossen_parameters(&world.fossen, truth);
    auvid_identifier_defaults(&cfg, &auvid_fossen);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        cfg.metric.tau_max[j] = j < AUVID_ROLL ? AUVID_C(40.0) : AUVID_C(6.0);
    }
}

void tearDown(void)
{
}

static void check_path(void)
{
    static const int path[] = {AUVID_FOSSEN_M_U,  AUVID_FOSSEN_M_V,  AUVID_FOSSEN_M_W,
                               AUVID_FOSSEN_X_UU, AUVID_FOSSEN_Y_VV, AUVID_FOSSEN_Z_WW,
                               AUVID_FOSSEN_N_RR};
    const auvid_estimate_t *e = auvid_identifier_estimate(&id);
    for (size_t k = 0; k < sizeof path / sizeof path[0]; ++k) {
        int i = path[k];
        const char *name = auvid_fossen.parameter[i].name;
        TEST_ASSERT_EQUAL_MESSAGE(AUVID_NOTE_NONE, e->confidence.note[i], name);
        TEST_ASSERT_TRUE_MESSAGE(fabs((double)e->pi[i] / truth[i] - 1.0) < 0.12, name);
    }
}

static void dive(void)
{
    six_dof_dive(&auvid_allocation_bluerov2_heavy, &sticks);
}

/* Only in roll and pitch is the wrench feedback. */
static void test_an_autopilot_of_roll_and_pitch_leaves_the_path_identifiable(void)
{
    static const int tilt[] = {AUVID_FOSSEN_M_P, AUVID_FOSSEN_K_PP, AUVID_FOSSEN_M_QQ};
    dive();
    const auvid_estimate_t *e = auvid_identifier_estimate(&id);
    TEST_ASSERT_EQUAL_HEX32(AUVID_FEEDBACK_TILT, auvid_metric_feedback_dofs(&id.metric));
    check_path();
    for (size_t k = 0; k < sizeof tilt / sizeof tilt[0]; ++k) {
        TEST_ASSERT_EQUAL(AUVID_NOTE_FEEDBACK, e->confidence.note[tilt[k]]);
        TEST_ASSERT_FALSE(e->confidence.identifiable >> tilt[k] & 1u);
    }
    for (int i = AUVID_FOSSEN_M_P; i <= AUVID_FOSSEN_M_Q;
         ++i) { /* with Munk's moments, of masses */
        TEST_ASSERT_TRUE(fabs((double)e->pi[i] / truth[i] - 1.0) < 0.3);
    }
}

static void check_mounting(int input, double value, double within)
{
    auvid_causes_t causes;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&uncertain, &causes));
    const auvid_cause_t *mounting = &causes.cause[AUVID_CAUSE_MOUNTING];
    TEST_ASSERT_TRUE(mounting->named);
    TEST_ASSERT_EQUAL(input, mounting->input);
    TEST_ASSERT_DOUBLE_WITHIN(within, value, (double)mounting->value);
}

/* If its height counts as exact, masses are 10 % too large. */
static void test_a_dvl_that_is_lower_than_configured_is_named_and_bends_no_mass(void)
{
    world.dvl_arm_m[2] = 0.05;
    dive();
    check_path();
    check_mounting(AUVID_UNCERTAIN_ARM_Z, 0.05, 0.01);
}

static void test_a_dvl_that_is_turned_is_named(void)
{
    world.dvl_euler[2] = 0.05;
    dive();
    check_path();
    check_mounting(AUVID_UNCERTAIN_DVL_YAW, 0.05, 0.01);
}

/* It tilts the vehicle, and tilt gives its weight a moment of yaw. That made N_r 0.5 Nm s, and N_rr
 * a fifth too small. */
static void test_a_centre_of_gravity_ahead_is_no_drag_of_yaw(void)
{
    world.fossen.r_g[0] = 0.02;
    dive();
    check_path();
    const auvid_real_t *pi = auvid_identifier_estimate(&id)->pi;
    check_mounting(INPUT_ASTERN, -0.02, 0.004);
    TEST_ASSERT_DOUBLE_WITHIN(0.15, truth[AUVID_FOSSEN_N_R], (double)pi[AUVID_FOSSEN_N_R]);
    TEST_ASSERT_DOUBLE_WITHIN(0.15, truth[AUVID_FOSSEN_N_RR], (double)pi[AUVID_FOSSEN_N_RR]);
}

/* The moments of roll and pitch inform no parameter of other DoF. */
static void test_wrong_inertias_of_roll_and_pitch_bend_no_mass(void)
{
    auvid_real_t right[3];
    dive();
    memcpy(right, auvid_identifier_estimate(&id)->pi + AUVID_FOSSEN_M_U, sizeof right);
    for (int i = AUVID_FOSSEN_M_P; i <= AUVID_FOSSEN_M_Q; ++i) {
        cfg.metric.free &= ~(UINT32_C(1) << i);
        cfg.metric.fixed[i] = (auvid_real_t)(3.0 * truth[i]);
    }
    dive();
    check_path();
    for (int i = 0; i < 3; ++i) {
        double mass = (double)auvid_identifier_estimate(&id)->pi[AUVID_FOSSEN_M_U + i];
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * (double)right[i], (double)right[i], mass);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_autopilot_of_roll_and_pitch_leaves_the_path_identifiable);
    RUN_TEST(test_a_dvl_that_is_lower_than_configured_is_named_and_bends_no_mass);
    RUN_TEST(test_a_dvl_that_is_turned_is_named);
    RUN_TEST(test_a_centre_of_gravity_ahead_is_no_drag_of_yaw);
    RUN_TEST(test_wrong_inertias_of_roll_and_pitch_bend_no_mass);
    return UNITY_END();
}
