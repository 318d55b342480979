/*
 * A torpedo of 32 kg in six degrees of freedom: one propeller, and fins whose force stands for
 * thrusters at the tail. Nothing moves its roll. The identifier is passive, with uncertain inputs.
 */
#include <math.h>
#include <string.h>

#include "six_dof.h"

#define PROPELLER_N 20
#define FIN_N 9
#define TAIL_M 0.65

static const six_dof_sticks_t sticks = {
    .mean = {[AUVID_SURGE] = 12}, .range = {[AUVID_SURGE] = 7, [AUVID_PITCH] = 2, [AUVID_YAW] = 4}};

static auvid_allocation_config_t thrusters;

void setUp(void)
{
    static const sim_fossen_t hull = {.mass_kg = 31,
                                      .inertia = {0.18, 3.45, 3.45},
                                      .weight_N = 304,
                                      .buoyancy_N = 304,
                                      .r_g = {0, 0, 0.02},
                                      .added = {{0.93},
                                                {0, 35.5},
                                                {0, 0, 35.5},
                                                {0, 0, 0, 0.07},
                                                {0, 0, 0, 0, 4.9},
                                                {0, 0, 0, 0, 0, 4.9}},
                                      .linear = {2, 10, 10, 0.13, 3, 3},
                                      .quadratic = {5, 131, 131, 0.2, 9, 9}};
    static const double arm[][6] = {
        {1, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, -TAIL_M}, {0, 0, 1, 0, TAIL_M, 0}};
    sim_defaults(&world);
    world.model = SIM_FOSSEN;
    world.fossen = hull;
    world.seed = 5;
    world.disturbance_N = 0.2;
    world.disturbance_Nm = 0.02;
    world.lag_s = 0.15;
    world.thrusters = 3;
    world.thruster_max_N = PROPELLER_N;
    memset(world.thruster_matrix, 0, sizeof world.thruster_matrix);
    memset(&thrusters, 0, sizeof thrusters);
    thrusters.thrusters = 3;
    thrusters.dofs = 1u << AUVID_SURGE | 1u << AUVID_PITCH | 1u << AUVID_YAW;
    for (int i = 0; i < 3; ++i) {
        thrusters.thruster[i].max_N = i == 0 ? PROPELLER_N : FIN_N;
        thrusters.thruster[i].min_N = -thrusters.thruster[i].max_N;
        thrusters.thruster[i].gain_forward = thrusters.thruster[i].gain_backward = AUVID_C(1.0);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            world.thruster_matrix[j][i] = arm[i][j];
            thrusters.thruster[i].wrench[j] = (auvid_real_t)arm[i][j];
        }
    }
    sim_fossen_parameters(&world.fossen, truth);
    auvid_identifier_defaults(&cfg, &auvid_fossen);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        cfg.metric.tau_max[j] = j < AUVID_ROLL ? AUVID_C(20.0) : AUVID_C(6.0);
    }
}

void tearDown(void)
{
}

static void check(int first, int last, double part)
{
    const auvid_estimate_t *e = auvid_identifier_estimate(&id);
    for (int i = first; i <= last; ++i) {
        const char *name = auvid_fossen.parameter[i].name;
        TEST_ASSERT_EQUAL_MESSAGE(AUVID_NOTE_NONE, e->confidence.note[i], name);
        TEST_ASSERT_TRUE_MESSAGE(fabs((double)e->pi[i] / truth[i] - 1.0) < part, name);
    }
}

/* An equation without a moment says nothing of the scale of its terms: with that of roll, I_y is
 * 31 % too small. */
static void test_noise_of_the_roll_angle_bends_no_inertia(void)
{
    six_dof_sticks_t weak = sticks;
    weak.range[AUVID_PITCH] = 0.5;
    weak.range[AUVID_YAW] = 1;
    world.imu_angle_rad = 0.01;
    world.disturbance_N = 0.02;
    world.disturbance_Nm = 0.002;
    six_dof_dive(&thrusters, &weak);
    check(AUVID_FOSSEN_M_Q, AUVID_FOSSEN_M_R, 0.08);
    TEST_ASSERT_NOT_EQUAL(AUVID_NOTE_NONE, /* nothing moves it */
                          auvid_identifier_estimate(&id)->confidence.note[AUVID_FOSSEN_M_P]);
}

/* At speed it sees sway and heave that are none. With exact angles drag is 10 % too small. */
static void test_a_turned_dvl_bends_no_mass_or_drag(void)
{
    world.dvl_euler[1] = -0.02;
    world.dvl_euler[2] = 0.02;
    six_dof_dive(&thrusters, &sticks);
    check(AUVID_FOSSEN_M_V, AUVID_FOSSEN_M_W, 0.05);
    check(AUVID_FOSSEN_M_Q, AUVID_FOSSEN_M_R, 0.05);
    check(AUVID_FOSSEN_Y_VV, AUVID_FOSSEN_Z_WW, 0.05);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_noise_of_the_roll_angle_bends_no_inertia);
    RUN_TEST(test_a_turned_dvl_bends_no_mass_or_drag);
    return UNITY_END();
}
