/*
 * A BlueROV2 Heavy in six degrees of freedom: a pilot moves all of them, and the autopilot holds
 * roll and pitch. The identifier is passive, with uncertain inputs.
 */
#include <math.h>
#include <string.h>

#include "auvid/allocation.h"
#include "auvid/fossen.h"
#include "auvid/uncertain.h"
#include "metric/auvid_metric_feedback_internal.h"
#include "uncertain/auvid_uncertain_table_internal.h"
#include "simulator.h"
#include "unity.h"

enum { SECONDS = 420, TICKS_PER_S = 1000000 / SIM_TICK_US };

static sim_t sim;
static sim_config_t world;
static auvid_identifier_config_t cfg;
static auvid_identifier_t id;
static auvid_uncertain_t uncertain;
static auvid_allocation_t allocation;
static double truth[SIM_FOSSEN_PARAMETERS];

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

/* The pilot pushes each stick to another place every 1 to 5 s. */
static void push(sim_rng_t *rng, double *until, auvid_real_t *wrench)
{
    static const double largest[AUVID_DOF_COUNT] = {38, 38, 38, 4, 4, 5};
    for (int k = 0; k < AUVID_DOF_COUNT; ++k) {
        until[k] -= 1.0 / TICKS_PER_S;
        if (until[k] <= 0.0) {
            until[k] = 1.0 + 4.0 * sim_rng_uniform(rng);
            wrench[k] = (auvid_real_t)(largest[k] * (2.0 * sim_rng_uniform(rng) - 1.0));
        }
    }
}

static void record(const sim_output_t *seen)
{
    const sim_measurement_t *imu = &seen->sensor[SIM_IMU], *dvl = &seen->sensor[SIM_DVL];
    auvid_real_t attitude[3], nu[AUVID_DOF_COUNT], wrench[AUVID_DOF_COUNT];
    auvid_real_t command[SIM_THRUSTERS];
    for (int i = 0; i < 3; ++i) {
        attitude[i] = (auvid_real_t)imu->value[i];
        nu[i] = (auvid_real_t)dvl->value[i];
        nu[AUVID_ROLL + i] = (auvid_real_t)imu->value[3 + i];
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench[j] = (auvid_real_t)seen->wrench[j];
    }
    for (int i = 0; i < SIM_THRUSTERS; ++i) {
        command[i] = (auvid_real_t)seen->thruster_N[i];
    }
    (void)auvid_identifier_applied(&id, seen->t_us - SIM_TICK_US, wrench, command);
    if (dvl->has && imu->has) {
        (void)auvid_identifier_motion(&id, dvl->t_us, attitude, nu);
    }
    (void)auvid_identifier_work(&id, 10000);
}

static void attach(void)
{
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_allocation_init(&allocation, &auvid_allocation_bluerov2_heavy));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &allocation));
}

static void dive(void)
{
    sim_rng_t rng;
    auvid_real_t wrench[AUVID_DOF_COUNT] = {0};
    double until[AUVID_DOF_COUNT] = {0};
    attach();
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    sim_rng_seed(&rng, 11, 1);
    for (int k = 0; k < SECONDS * TICKS_PER_S; ++k) {
        auvid_allocation_result_t thrust;
        double force[SIM_THRUSTERS] = {0};
        sim_output_t seen;
        push(&rng, until, wrench);
        (void)auvid_allocation_solve(&allocation, wrench, &thrust);
        for (int i = 0; i < world.thrusters; ++i) {
            force[i] = (double)thrust.force_N[i];
        }
        sim_step(&sim, force, NULL, &seen);
        record(&seen);
    }
    while (auvid_identifier_work(&id, 1000000) == AUVID_PENDING) {
    }
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

/* If its height counts as exact, masses are 10 % too large. */
static void test_a_dvl_that_is_lower_than_configured_is_named_and_bends_no_mass(void)
{
    auvid_causes_t causes;
    world.dvl_arm_m[2] = 0.05;
    dive();
    check_path();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&uncertain, &causes));
    const auvid_cause_t *mounting = &causes.cause[AUVID_CAUSE_MOUNTING];
    TEST_ASSERT_TRUE(mounting->named);
    TEST_ASSERT_EQUAL(AUVID_UNCERTAIN_ARM_Z, mounting->input);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.05, (double)mounting->value);
}

/* It tilts the vehicle, and tilt gives its weight a moment of yaw. That made N_r 0.5 Nm s, and N_rr
 * a fifth too small. */
static void test_a_centre_of_gravity_ahead_is_no_drag_of_yaw(void)
{
    auvid_causes_t causes;
    world.fossen.r_g[0] = 0.02;
    dive();
    check_path();
    const auvid_real_t *pi = auvid_identifier_estimate(&id)->pi;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_causes(&uncertain, &causes));
    const auvid_cause_t *mounting = &causes.cause[AUVID_CAUSE_MOUNTING];
    TEST_ASSERT_TRUE(mounting->named);
    TEST_ASSERT_EQUAL(INPUT_ASTERN, mounting->input);
    TEST_ASSERT_DOUBLE_WITHIN(0.004, -0.02, (double)mounting->value);
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
    RUN_TEST(test_a_centre_of_gravity_ahead_is_no_drag_of_yaw);
    RUN_TEST(test_wrong_inertias_of_roll_and_pitch_bend_no_mass);
    return UNITY_END();
}
