/* The vehicle of the simulator against physics. */
#include <math.h>
#include <string.h>

#include "auvid/excitation.h"
#include "finish.h"
#include "sim_run.h"
#include "unity.h"

#define PI 3.14159265358979323846

void setUp(void)
{
    sim_defaults(&cfg);
}

void tearDown(void)
{
}

/* X + X_u u + X_uu u^2 = 0 for u > 0. */
static double terminal(double force, double linear, double quadratic)
{
    return (-linear - sqrt(linear * linear - 4 * quadratic * force)) / (2 * quadratic);
}

static void test_a_constant_force_ends_at_the_root_of_the_quadratic(void)
{
    const double surge[6] = {100, 0, 37.3058}, sway[6] = {0, 100, 37.3058};
    const double heave[6] = {0, 0, 137.3058}, yaw[6] = {0, 0, 37.3058, 0, 0, 40};
    cfg.pitch_arm_m = cfg.roll_arm_m = 0;
    begin();
    run(120, surge);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, terminal(100, -42.4181, -125.3578), sim.truth.nu[0]);
    begin();
    run(120, sway);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, terminal(100, -75.7673, -447.6195), sim.truth.nu[1]);
    begin();
    run(120, heave);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, terminal(100, -44.0561, -325.0138), sim.truth.nu[2]);
    begin();
    run(120, yaw);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, terminal(40, -20.5833, -60.9373), sim.truth.nu[5]);
}

static void test_hover_thrust_keeps_the_depth_and_without_it_the_vehicle_rises(void)
{
    const double hover[6] = {0, 0, 37.3058};
    begin();
    run(60, hover);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50.0, sim.truth.position[2]);
    begin();
    run(60, NULL);
    TEST_ASSERT_TRUE(sim.truth.position[2] < 45.0);
}

/* Exact solution of straight motion with linear drag: u = X / d (1 - exp(-d t / m)). */
static void test_motion_with_linear_drag_is_the_exponential(void)
{
    const double force[6] = {50, 0, 37.3058};
    cfg.pitch_arm_m = 0;
    cfg.parameter[SIM_X_UU] = 0;
    begin();
    run(5, force);
    double d = 42.4181, k = d / 249.5384;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50 / d * (1 - exp(-k * 5)), sim.truth.nu[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50 / d * (5 - (1 - exp(-k * 5)) / k), sim.truth.position[0]);
}

/* All velocities stay positive, so that |u| u is smooth. */
static double error_of_steps(double h, const double reference[12])
{
    double state[12] = {0, 0, 50, 0.1, 0.1, 0.3, 1, 1, 1, 0.3, 0.3, 0.3}, worst = 0;
    const double wrench[6] = {100, 100, 140, 50, 50, 200};
    for (long i = lround(1.0 / h); i > 0; --i) {
        sim_rk4(&cfg, state, wrench, h);
    }
    for (int i = 0; i < 12; ++i) {
        worst = fmax(worst, fabs(state[i] - reference[i]));
    }
    return worst;
}

static void test_rk4_converges_with_the_fourth_order(void)
{
    double fine[12] = {0, 0, 50, 0.1, 0.1, 0.3, 1, 1, 1, 0.3, 0.3, 0.3};
    const double wrench[6] = {100, 100, 140, 50, 50, 200};
    for (int i = 0; i < 1600; ++i) {
        sim_rk4(&cfg, fine, wrench, 1.0 / 1600);
        for (int k = 6; k < 12; ++k) {
            TEST_ASSERT_TRUE(fine[k] > 0);
        }
    }
    for (int n = 20; n <= 80; n *= 2) {
        double order = log2(error_of_steps(1.0 / n, fine) / error_of_steps(0.5 / n, fine));
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 4.0, order);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, error_of_steps(0.005, fine));
}

/* Kinetic energy, energy of the righting moment, and energy of weight and buoyancy. */
static double energy(void)
{
    const double *m = cfg.parameter, *nu = sim.truth.nu, *euler = sim.truth.euler;
    return 0.5 * (m[SIM_M_U] * nu[0] * nu[0] + m[SIM_M_V] * nu[1] * nu[1] +
                  m[SIM_M_W] * nu[2] * nu[2] + m[SIM_M_R] * nu[5] * nu[5] +
                  cfg.tilt_inertia * (nu[3] * nu[3] + nu[4] * nu[4])) +
           cfg.tilt_righting * (1 - cos(euler[0]) * cos(euler[1])) -
           m[SIM_WB] * sim.truth.position[2];
}

static void start_tumbling(void)
{
    const double nu[6] = {0.6, -0.4, 0.3, 0.2, -0.3, 0.5}, euler[3] = {0.2, -0.3, 1.0};
    memcpy(cfg.nu, nu, sizeof nu);
    memcpy(cfg.euler, euler, sizeof euler);
    begin();
}

static void test_energy_is_conserved_without_losses(void)
{
    without_losses();
    start_tumbling();
    double before = energy();
    run(10, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, before, energy()); /* of 2000 J */
}

static void test_energy_is_not_conserved_by_Eq_13_as_printed(void)
{
    without_losses();
    cfg.printed_eq13 = true;
    start_tumbling();
    double before = energy();
    run(10, NULL);
    TEST_ASSERT_TRUE(fabs(energy() - before) > 1.0);
}

static void test_drag_only_dissipates_energy(void)
{
    cfg.munk = 1;
    start_tumbling();
    for (int i = 0; i < 500; ++i) {
        double before = energy();
        run(0.02, NULL);
        TEST_ASSERT_TRUE(energy() <= before + 1e-9);
    }
}

static void test_work_of_the_wrench_is_the_energy_gained(void)
{
    const double wrench[6] = {80, -60, 50, 5, -5, 30};
    without_losses();
    cfg.roll_arm_m = cfg.pitch_arm_m = 0; /* their work is not part of X and Y */
    start_tumbling();
    double before = energy(), work = 0;
    for (int i = 0; i < 250; ++i) {
        double power = 0;
        for (int d = 0; d < 6; ++d) {
            power += wrench[d] * sim.truth.nu[d];
        }
        run(0.02, wrench);
        for (int d = 0; d < 6; ++d) {
            power += wrench[d] * sim.truth.nu[d];
        }
        work += 0.01 * power; /* trapezoidal rule */
    }
    TEST_ASSERT_TRUE(fabs(work) > 50.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * fabs(work), work, energy() - before);
}

/* d/dt R = R [omega x], by central differences of the rotation. */
static void test_euler_rates_rotate_the_attitude_by_omega(void)
{
    const double state[12] = {0, 0, 0, 0.4, -0.6, 2.0, 0.5, -0.2, 0.3, 0.3, -0.5, 0.7};
    const double none[6] = {0}, h = 1e-6, *w = state + 9;
    const double cross[3][3] = {{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
    double d[12], before[3][3], after[3][3], r[3][3], e0[3], e1[3];
    sim_derivative(&cfg, state, none, d);
    for (int i = 0; i < 3; ++i) {
        e0[i] = state[3 + i] - h * d[3 + i];
        e1[i] = state[3 + i] + h * d[3 + i];
    }
    sim_rotation(e0, before);
    sim_rotation(e1, after);
    sim_rotation(state + 3, r);
    for (int i = 0; i < 3; ++i) {
        double velocity = 0;
        for (int j = 0; j < 3; ++j) {
            double expected = 0;
            for (int k = 0; k < 3; ++k) {
                expected += r[i][k] * cross[k][j];
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-8, expected, (after[i][j] - before[i][j]) / (2 * h));
            velocity += r[i][j] * state[6 + j];
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, velocity, d[i]);
    }
}

static void test_a_current_carries_the_vehicle_and_changes_nothing_else(void)
{
    const double wrench[6] = {60, -40, 50, 0, 0, 20};
    double nu[6], position[3];
    start_tumbling();
    run(20, wrench);
    memcpy(nu, sim.truth.nu, sizeof nu);
    memcpy(position, sim.truth.position, sizeof position);
    cfg.current[0] = 0.3;
    cfg.current[1] = -0.2;
    start_tumbling();
    run(20, wrench);
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, nu[i], sim.truth.nu[i]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, position[0] + 6.0, sim.truth.position[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, position[1] - 4.0, sim.truth.position[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, position[2], sim.truth.position[2]);
}

static void test_a_load_in_body_axes_is_the_wrench_of_its_force_and_arm(void)
{
    const double wrench[6] = {0, 0, 0, 0.2 * 4 + 0.1 * 2, 0.1 * 3 - 0.5 * 4, -0.5 * 2 - 0.2 * 3};
    double direct[6] = {3, -2, 4};
    sim_t loaded;
    cfg.euler[0] = 0.2;
    cfg.load_body_N[0] = 3;
    cfg.load_body_N[1] = -2;
    cfg.load_body_N[2] = 4;
    cfg.load_at_m[0] = 0.5;
    cfg.load_at_m[1] = 0.2;
    cfg.load_at_m[2] = 0.1;
    begin();
    run(5, NULL);
    loaded = sim;
    memset(cfg.load_body_N, 0, sizeof cfg.load_body_N);
    memcpy(direct + 3, wrench + 3, 3 * sizeof *wrench);
    begin();
    run(5, direct);
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, sim.truth.nu[i], loaded.truth.nu[i]);
    }
    TEST_ASSERT_TRUE(fabs(sim.truth.nu[0]) > 0.01);
}

static void test_a_weight_pulls_down_at_any_attitude(void)
{
    double with[6], r[3][3];
    cfg.euler[0] = 0.3;
    cfg.euler[1] = -0.2;
    cfg.euler[2] = 1.0;
    cfg.load_N[2] = 12;
    begin();
    memcpy(with, sim.truth.nu_dot, sizeof with);
    cfg.load_N[2] = 0;
    begin();
    sim_rotation(cfg.euler, r);
    for (int i = 0; i < 3; ++i) {
        double mass = cfg.parameter[SIM_M_U + i];
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 12 * r[2][i], mass * (with[i] - sim.truth.nu_dot[i]));
    }
}

static void test_acceleration_of_the_truth_is_the_derivative_of_its_velocity(void)
{
    const double wrench[6] = {60, -40, 50, 0, 0, 20};
    start_tumbling();
    run(2, wrench);
    sim_truth_t a = sim.truth;
    run(0.02, wrench);
    sim_truth_t b = sim.truth;
    run(0.02, wrench);
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, (sim.truth.nu[i] - a.nu[i]) / 0.04, b.nu_dot[i]);
    }
}

/* Pitch is an oscillator of damping z = 60 / (2 sqrt(80 * 150)), forced by 0.08 m times at most
 * 100 N. Its first overshoot is o = exp(-pi z / sqrt(1 - z^2)); the worst force within the limit,
 * with a sign change at every swing, takes it to (1 + o) / (1 - o) times the static angle. Roll
 * has the shorter arm. */
static void test_roll_and_pitch_stay_small_under_the_usual_excitation(void)
{
    const auvid_real_t amplitude[6] = {100, 100, 100, 0, 0, 40};
    static auvid_excitation_t excitation;
    auvid_excitation_config_t plan;
    double z = 60 / (2 * sqrt(80.0 * 150)), o = exp(-PI * z / sqrt(1 - z * z)), max_angle = 0;
    double worst = asin(0.08 * 100 / 150 * (1 + o) / (1 - o)); /* 7.3 degrees */
    auvid_excitation_defaults(&plan);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_plan(&plan, amplitude, 30, 8, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_excitation_init(&excitation, &plan));
    auvid_excitation_start(&excitation, 0);
    begin();
    for (uint32_t turns = 0;;) {
        auvid_real_t asked[6];
        finish_turn(&turns, 1000000);
        double wrench[6];
        if (auvid_excitation_step(&excitation, sim.truth.t_us, asked) == AUVID_FINISHED) {
            break;
        }
        for (int i = 0; i < 6; ++i) {
            wrench[i] = (double)asked[i] + (i == 2 ? 37.3058 : 0);
        }
        sim_step(&sim, NULL, wrench, &out);
        max_angle = fmax(max_angle, fmax(fabs(sim.truth.euler[0]), fabs(sim.truth.euler[1])));
    }
    TEST_ASSERT_TRUE(sim.truth.t_us == 240000000u);
    TEST_ASSERT_TRUE(max_angle > 0.01 && max_angle < worst);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_constant_force_ends_at_the_root_of_the_quadratic);
    RUN_TEST(test_hover_thrust_keeps_the_depth_and_without_it_the_vehicle_rises);
    RUN_TEST(test_motion_with_linear_drag_is_the_exponential);
    RUN_TEST(test_rk4_converges_with_the_fourth_order);
    RUN_TEST(test_energy_is_conserved_without_losses);
    RUN_TEST(test_energy_is_not_conserved_by_Eq_13_as_printed);
    RUN_TEST(test_drag_only_dissipates_energy);
    RUN_TEST(test_work_of_the_wrench_is_the_energy_gained);
    RUN_TEST(test_euler_rates_rotate_the_attitude_by_omega);
    RUN_TEST(test_a_current_carries_the_vehicle_and_changes_nothing_else);
    RUN_TEST(test_a_load_in_body_axes_is_the_wrench_of_its_force_and_arm);
    RUN_TEST(test_a_weight_pulls_down_at_any_attitude);
    RUN_TEST(test_acceleration_of_the_truth_is_the_derivative_of_its_velocity);
    RUN_TEST(test_roll_and_pitch_stay_small_under_the_usual_excitation);
    return UNITY_END();
}
