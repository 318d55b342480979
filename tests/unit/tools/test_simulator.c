/* The simulator against physics and statistics. Statistical tests use fixed seeds and intervals of
 * four standard deviations. */
#include "simulator.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/excitation.h"
#include "finish.h"
#include "unity.h"

#define PI 3.14159265358979323846

static sim_config_t cfg;
static sim_t sim;
static sim_output_t out;

void setUp(void)
{
    sim_defaults(&cfg);
}

void tearDown(void)
{
}

static void begin(void)
{
    TEST_ASSERT_TRUE(sim_init(&sim, &cfg));
}

static void without_noise(void)
{
    cfg.imu_angle_rad = cfg.imu_rate_rad_s = cfg.dvl_m_s = cfg.depth_m = cfg.gps_m = 0;
}

/* Neutral and without drag: only inertia, and Coriolis forces that do no work. */
static void without_losses(void)
{
    for (int i = SIM_X_U; i < SIM_PARAMETERS; ++i) {
        cfg.parameter[i] = 0;
    }
    cfg.tilt_linear = cfg.tilt_quadratic = 0;
    cfg.munk = 1;
}

static void run(double seconds, const double wrench[6])
{
    for (long i = lround(seconds * 50); i > 0; --i) {
        sim_step(&sim, NULL, wrench, &out);
    }
}

/* ---- the vehicle ---- */

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

/* ---- thrusters and disturbance ---- */

static void test_thrusters_produce_the_wrench_of_the_girona500(void)
{
    const double f[5] = {10, 20, -5, 15, 7};
    begin();
    sim_step(&sim, f, NULL, &out);
    const double expected[6] = {-30, 7, -10, 0, 7, 4};
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected[i], out.wrench[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, expected[i], sim.truth.wrench[i]);
    }
}

static void test_commands_saturate_and_a_command_that_is_not_finite_is_no_thrust(void)
{
    const double f[5] = {1000, -1000, NAN, INFINITY, 153.8};
    const double expected[5] = {153.8, -153.8, 0, 0, 153.8};
    begin();
    sim_step(&sim, f, NULL, &out);
    for (int i = 0; i < 5; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(expected[i], out.thruster_N[i]);
    }
}

static void test_lag_is_the_exact_exponential_and_so_is_its_impulse(void)
{
    const double f[5] = {-50, -50, 0, 0, 0}, lag = 0.15;
    without_losses();
    cfg.parameter[SIM_WB] = 0;
    cfg.pitch_arm_m = 0;
    cfg.lag_s = lag;
    begin();
    for (int i = 1; i <= 50; ++i) {
        double t = 0.02 * i;
        sim_step(&sim, f, NULL, &out);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, -50 * (1 - exp(-t / lag)), sim.truth.thruster_N[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, 100 * (t - lag * (1 - exp(-t / lag))) / 249.5384,
                                  sim.truth.nu[0]);
    }
}

static void test_feedback_is_the_command_unless_true_thrust_is_selected(void)
{
    const double f[5] = {0, 0, 0, 0, 40}, wrench[6] = {10};
    cfg.lag_s = 0.2;
    begin();
    sim_step(&sim, f, wrench, &out);
    TEST_ASSERT_EQUAL_DOUBLE(40.0, out.thruster_N[4]);
    TEST_ASSERT_EQUAL_DOUBLE(10.0, out.wrench[0]);
    cfg.feedback_true = true;
    begin();
    sim_step(&sim, f, wrench, &out);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 40 * (1 - exp(-0.1)), out.thruster_N[4]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 10 * (1 - exp(-0.1)), out.wrench[0]);
    TEST_ASSERT_EQUAL_DOUBLE(sim.truth.wrench[1], out.wrench[1]);
}

/* 3000 starts give 9000 independent forces and 3000 moments. */
static void test_disturbance_starts_with_its_rms(void)
{
    double force = 0, moment = 0;
    cfg.disturbance_N = 3;
    cfg.disturbance_Nm = 1.2;
    for (cfg.seed = 0; cfg.seed < 3000; ++cfg.seed) {
        begin();
        for (int i = 0; i < 3; ++i) {
            force += pow(sim.truth.disturbance[i], 2) / 9000;
        }
        moment += pow(sim.truth.disturbance[5], 2) / 3000;
        TEST_ASSERT_EQUAL_DOUBLE(0.0, sim.truth.disturbance[3]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(3 * 4 / sqrt(2 * 9000.0), 3.0, sqrt(force));
    TEST_ASSERT_DOUBLE_WITHIN(1.2 * 4 / sqrt(2 * 3000.0), 1.2, sqrt(moment));
}

/* 2000 s of X, Y, Z: the variance of a mean square is 2 tau / T, with T = 6000 s pooled; that of a
 * correlation is not larger. */
static void test_disturbance_keeps_its_rms_and_its_correlation_time(void)
{
    enum { N = 100000, LAG = 100 };
    static double f[3][N];
    double sum = 0, product = 0;
    cfg.disturbance_N = 1;
    memset(cfg.sensor, 0, sizeof cfg.sensor);
    begin();
    for (int i = 0; i < N; ++i) {
        sim_step(&sim, NULL, NULL, &out);
        for (int j = 0; j < 3; ++j) {
            f[j][i] = sim.truth.disturbance[j];
            sum += f[j][i] * f[j][i] / (3.0 * N);
            product += i < LAG ? 0 : f[j][i] * f[j][i - LAG] / (3.0 * (N - LAG));
        }
    }
    double deviation = sqrt(2 * 2.0 / 6000);
    TEST_ASSERT_DOUBLE_WITHIN(4 * deviation, 1.0, sum);
    TEST_ASSERT_DOUBLE_WITHIN(4 * deviation, exp(-1.0), product / sum);
}

/* ---- random numbers ---- */

/* The first numbers of xoshiro256** from the state 1, 2, 3, 4, by the code of its authors. */
static void test_generator_is_xoshiro256_starstar(void)
{
    const uint64_t expected[4] = {11520u, 0u, 1509978240u, 1215971899390074240u};
    sim_rng_t rng = {.s = {1, 2, 3, 4}};
    for (int i = 0; i < 4; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE((double)(expected[i] >> 11) * 0x1p-53, sim_rng_uniform(&rng));
    }
}

static void test_gaussian_has_the_moments_of_a_standard_normal(void)
{
    enum { N = 400000 };
    double m[5] = {0};
    sim_rng_t rng;
    sim_rng_seed(&rng, 5, 6);
    for (int i = 0; i < N; ++i) {
        double x = sim_rng_gauss(&rng);
        for (int k = 1; k < 5; ++k) {
            m[k] += pow(x, k) / N;
        }
    }
    /* Variances of the sample moments of a standard normal: 1, 2, 15, 96 over N. */
    TEST_ASSERT_DOUBLE_WITHIN(4 * sqrt(1.0 / N), 0.0, m[1]);
    TEST_ASSERT_DOUBLE_WITHIN(4 * sqrt(2.0 / N), 1.0, m[2]);
    TEST_ASSERT_DOUBLE_WITHIN(4 * sqrt(15.0 / N), 0.0, m[3]);
    TEST_ASSERT_DOUBLE_WITHIN(4 * sqrt(96.0 / N), 3.0, m[4]);
}

static void test_streams_and_neighbouring_seeds_are_uncorrelated(void)
{
    enum { N = 100000 };
    double streams = 0, seeds = 0;
    sim_rng_t a, b, c;
    sim_rng_seed(&a, 1, 0);
    sim_rng_seed(&b, 1, 1);
    sim_rng_seed(&c, 2, 0);
    for (int i = 0; i < N; ++i) {
        double x = sim_rng_gauss(&a);
        streams += x * sim_rng_gauss(&b) / N;
        seeds += x * sim_rng_gauss(&c) / N;
    }
    TEST_ASSERT_DOUBLE_WITHIN(4 / sqrt(N), 0.0, streams);
    TEST_ASSERT_DOUBLE_WITHIN(4 / sqrt(N), 0.0, seeds);
}

/* ---- sensors ---- */

static void test_sensors_sample_at_their_rates_and_gps_only_at_the_surface(void)
{
    for (int surface = 0; surface < 2; ++surface) {
        int count[SIM_SENSORS] = {0};
        const double hover[6] = {0, 0, 37.3058};
        cfg.position[2] = surface ? 0.2 : 50;
        begin();
        for (int i = 0; i < 500; ++i) {
            sim_step(&sim, NULL, hover, &out);
            for (int s = 0; s < SIM_SENSORS; ++s) {
                count[s] += out.sensor[s].has;
            }
        }
        TEST_ASSERT_EQUAL_INT(500, count[SIM_IMU]);
        TEST_ASSERT_EQUAL_INT(50, count[SIM_DVL]);
        TEST_ASSERT_EQUAL_INT(100, count[SIM_DEPTH]);
        TEST_ASSERT_EQUAL_INT(surface ? 10 : 0, count[SIM_GPS]);
    }
}

/* At rest, heading 1 rad, at the surface: mean and rms of every channel. */
static void test_noise_has_its_rms_and_no_mean(void)
{
    const double hover[6] = {0, 0, 37.3058};
    const double rms[SIM_SENSORS][6] = {{0.2 * PI / 180, 0.2 * PI / 180, 0.2 * PI / 180,
                                         0.1 * PI / 180, 0.1 * PI / 180, 0.1 * PI / 180},
                                        {0.007, 0.007, 0.007},
                                        {0.015},
                                        {1.5, 1.5}};
    const int channels[SIM_SENSORS] = {6, 3, 1, 2};
    double sum[SIM_SENSORS][6] = {{0}}, square[SIM_SENSORS][6] = {{0}}, n[SIM_SENSORS] = {0};
    cfg.position[2] = 0;
    cfg.euler[2] = 1;
    begin();
    for (int i = 0; i < 50000; ++i) {
        sim_step(&sim, NULL, hover, &out);
        for (int s = 0; s < SIM_SENSORS; ++s) {
            n[s] += out.sensor[s].has;
            for (int k = 0; k < channels[s] && out.sensor[s].has; ++k) {
                double error = out.sensor[s].value[k] - (s == SIM_IMU && k == 2 ? 1 : 0);
                sum[s][k] += error;
                square[s][k] += error * error;
            }
        }
    }
    for (int s = 0; s < SIM_SENSORS; ++s) {
        for (int k = 0; k < channels[s]; ++k) {
            TEST_ASSERT_DOUBLE_WITHIN(4 * rms[s][k] / sqrt(n[s]), 0.0, sum[s][k] / n[s]);
            TEST_ASSERT_DOUBLE_WITHIN(4 * rms[s][k] / sqrt(2 * n[s]), rms[s][k],
                                      sqrt(square[s][k] / n[s]));
        }
    }
}

/* Delayed samples between the ticks have their own timestamps, and the truth at these times. */
static void test_a_late_sample_has_its_own_timestamp_and_the_truth_at_that_time(void)
{
    const double wrench[6] = {90, -50, 80, 0, 0, 30};
    uint64_t next = 53000;
    int seen = 0;
    without_noise();
    cfg.sensor[SIM_DVL].phase_s = 0.053;
    cfg.sensor[SIM_DVL].age_s = 0.33;
    begin();
    for (int i = 0; i < 500; ++i) {
        sim_step(&sim, NULL, wrench, &out);
        const sim_measurement_t *m = &out.sensor[SIM_DVL];
        if (!m->has) {
            TEST_ASSERT_TRUE(out.t_us < next + 330000);
            continue;
        }
        TEST_ASSERT_TRUE(m->t_us == next);
        TEST_ASSERT_TRUE(out.t_us >= next + 330000 && out.t_us < next + 350000);
        double state[12];
        memcpy(state, cfg.position, sizeof cfg.position);
        memcpy(state + 3, cfg.euler, sizeof cfg.euler);
        memcpy(state + 6, cfg.nu, sizeof cfg.nu);
        for (uint64_t t = 0; t < next; t += 1000) {
            sim_rk4(&cfg, state, wrench, 0.001);
        }
        for (int k = 0; k < 3; ++k) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, state[6 + k], m->value[k]);
        }
        next += 200000;
        ++seen;
    }
    TEST_ASSERT_EQUAL_INT(49, seen);
}

/* 5000 samples at probability 0.3; those that arrive equal those of the run without losses. */
static void test_dropouts_have_their_share_and_do_not_change_other_samples(void)
{
    static sim_t whole;
    sim_output_t all;
    int lost = 0;
    TEST_ASSERT_TRUE(sim_init(&whole, &cfg));
    cfg.sensor[SIM_IMU].dropout = 0.3;
    begin();
    for (int i = 0; i < 5000; ++i) {
        sim_step(&whole, NULL, NULL, &all);
        sim_step(&sim, NULL, NULL, &out);
        if (out.sensor[SIM_IMU].has) {
            TEST_ASSERT_EQUAL_MEMORY(all.sensor[SIM_IMU].value, out.sensor[SIM_IMU].value,
                                     sizeof all.sensor[SIM_IMU].value);
        } else {
            ++lost;
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(4 * sqrt(0.3 * 0.7 / 5000), 0.3, lost / 5000.0);
}

static void test_switching_a_sensor_off_changes_no_other_numbers(void)
{
    static sim_t with;
    sim_output_t all;
    cfg.disturbance_N = 1;
    TEST_ASSERT_TRUE(sim_init(&with, &cfg));
    cfg.sensor[SIM_IMU].rate_hz = 0;
    cfg.sensor[SIM_DEPTH].rate_hz = 7;
    begin();
    for (int i = 0; i < 500; ++i) {
        sim_step(&with, NULL, NULL, &all);
        sim_step(&sim, NULL, NULL, &out);
        TEST_ASSERT_FALSE(out.sensor[SIM_IMU].has);
        TEST_ASSERT_EQUAL_INT(all.sensor[SIM_DVL].has, out.sensor[SIM_DVL].has);
        TEST_ASSERT_EQUAL_MEMORY(all.sensor[SIM_DVL].value, out.sensor[SIM_DVL].value,
                                 sizeof out.sensor[SIM_DVL].value);
        TEST_ASSERT_EQUAL_MEMORY(&with.truth, &sim.truth, sizeof sim.truth);
    }
}

static void first_dvl(void)
{
    without_noise();
    begin();
    uint32_t turns = 0;
    do {
        finish_turn(&turns, 1000000);
        sim_step(&sim, NULL, NULL, &out);
    } while (!out.sensor[SIM_DVL].has);
}

static void test_dvl_measures_over_ground_or_through_the_water(void)
{
    cfg.euler[2] = 0.5 * PI; /* heading east, current to the north: from starboard to port */
    cfg.current[0] = 0.3;
    cfg.parameter[SIM_WB] = 0;
    first_dvl();
    TEST_ASSERT_TRUE(out.sensor[SIM_DVL].bottom);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, out.sensor[SIM_DVL].value[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, -0.3, out.sensor[SIM_DVL].value[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 30.0, out.sensor[SIM_DVL].value[3]);
    cfg.dvl_lock = SIM_LOCK_WATER;
    first_dvl();
    TEST_ASSERT_FALSE(out.sensor[SIM_DVL].bottom);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, out.sensor[SIM_DVL].value[1]);
}

static void test_dvl_loses_the_bottom_above_its_range(void)
{
    cfg.dvl_lock = SIM_LOCK_ALTITUDE;
    cfg.position[2] = 41;
    first_dvl();
    TEST_ASSERT_TRUE(out.sensor[SIM_DVL].bottom);
    cfg.position[2] = 39;
    first_dvl();
    TEST_ASSERT_FALSE(out.sensor[SIM_DVL].bottom);
}

/* Turning at 0.5 rad/s with the DVL 0.75 m aft: it moves to port at 0.375 m/s. It is yawed by 225
 * degrees, so that port is forward and starboard in equal parts. */
static void test_dvl_mounting_adds_the_lever_arm_and_rotates_the_axes(void)
{
    without_losses();
    cfg.parameter[SIM_WB] = 0;
    cfg.nu[5] = 0.5;
    cfg.dvl_arm_m[0] = -0.75;
    cfg.dvl_yaw_rad = 225 * PI / 180;
    first_dvl();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.375 * sqrt(0.5), out.sensor[SIM_DVL].value[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.375 * sqrt(0.5), out.sensor[SIM_DVL].value[1]);
}

static void test_depth_sensor_ahead_of_the_origin_rises_with_the_bow(void)
{
    without_noise();
    cfg.parameter[SIM_WB] = 0;
    cfg.euler[1] = 0.1;
    cfg.tilt_righting = 0;
    cfg.depth_arm_m[0] = 1;
    begin();
    run(0.1, NULL);
    TEST_ASSERT_TRUE(out.sensor[SIM_DEPTH].has);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 50 - sin(0.1), out.sensor[SIM_DEPTH].value[0]);
}

static void test_gps_ahead_of_the_origin_turns_with_the_bow(void)
{
    without_noise();
    cfg.position[2] = 0.2;
    cfg.euler[2] = 0.5;
    cfg.gps_arm_m[0] = 1;
    cfg.sensor[SIM_GPS].rate_hz = 50;
    begin();
    run(0.02, NULL);
    TEST_ASSERT_TRUE(out.sensor[SIM_GPS].has);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, cos(0.5), out.sensor[SIM_GPS].value[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, sin(0.5), out.sensor[SIM_GPS].value[1]);
}

static void test_imu_yaw_is_wrapped_and_the_truth_is_not(void)
{
    without_losses();
    without_noise();
    cfg.nu[5] = 1;
    begin();
    run(10, NULL);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 10.0, sim.truth.euler[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 10 - 4 * PI, out.sensor[SIM_IMU].value[2]);
}

/* ---- repeatability and configuration ---- */

static void test_the_same_seed_repeats_the_run_and_a_copy_continues_identically(void)
{
    static sim_t twin;
    sim_output_t other;
    const double f[5] = {-40, -20, 30, 30, 10};
    cfg.disturbance_N = 1;
    cfg.sensor[SIM_DVL].age_s = 0.3;
    begin();
    TEST_ASSERT_TRUE(sim_init(&twin, &cfg));
    for (int i = 0; i < 200; ++i) {
        sim_step(&sim, f, NULL, &out);
        sim_step(&twin, f, NULL, &other);
        TEST_ASSERT_EQUAL_MEMORY(&out, &other, sizeof out);
        if (i == 100) {
            twin = sim;
        }
    }
    cfg.seed = 2;
    TEST_ASSERT_TRUE(sim_init(&twin, &cfg));
    sim_step(&twin, f, NULL, &other);
    TEST_ASSERT_TRUE(other.sensor[SIM_IMU].value[0] != out.sensor[SIM_IMU].value[0]);
}

static void refuse(double *field, double value)
{
    double before = *field;
    sim_t untouched = sim;
    *field = value;
    TEST_ASSERT_FALSE(sim_init(&sim, &cfg));
    TEST_ASSERT_EQUAL_MEMORY(&untouched, &sim, sizeof sim);
    *field = before;
    TEST_ASSERT_TRUE(sim_init(&sim, &cfg));
}

static void test_init_refuses_invalid_values(void)
{
    begin();
    refuse(&cfg.parameter[SIM_M_W], 0);
    refuse(&cfg.parameter[SIM_N_RR], NAN);
    refuse(&cfg.tilt_inertia, -1);
    refuse(&cfg.lag_s, -0.1);
    refuse(&cfg.disturbance_s, 0);
    refuse(&cfg.disturbance_N, INFINITY);
    refuse(&cfg.current[1], NAN);
    refuse(&cfg.dvl_m_s, -1);
    refuse(&cfg.thruster_matrix[3][2], NAN);
    refuse(&cfg.sensor[SIM_IMU].rate_hz, 51);
    refuse(&cfg.sensor[SIM_IMU].age_s, 1);
    refuse(&cfg.sensor[SIM_DVL].age_s, NAN);
    refuse(&cfg.sensor[SIM_DVL].dropout, 1.1);
    refuse(&cfg.sensor[SIM_GPS].phase_s, -1);
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
    RUN_TEST(test_thrusters_produce_the_wrench_of_the_girona500);
    RUN_TEST(test_commands_saturate_and_a_command_that_is_not_finite_is_no_thrust);
    RUN_TEST(test_lag_is_the_exact_exponential_and_so_is_its_impulse);
    RUN_TEST(test_feedback_is_the_command_unless_true_thrust_is_selected);
    RUN_TEST(test_disturbance_starts_with_its_rms);
    RUN_TEST(test_disturbance_keeps_its_rms_and_its_correlation_time);
    RUN_TEST(test_generator_is_xoshiro256_starstar);
    RUN_TEST(test_gaussian_has_the_moments_of_a_standard_normal);
    RUN_TEST(test_streams_and_neighbouring_seeds_are_uncorrelated);
    RUN_TEST(test_sensors_sample_at_their_rates_and_gps_only_at_the_surface);
    RUN_TEST(test_noise_has_its_rms_and_no_mean);
    RUN_TEST(test_a_late_sample_has_its_own_timestamp_and_the_truth_at_that_time);
    RUN_TEST(test_dropouts_have_their_share_and_do_not_change_other_samples);
    RUN_TEST(test_switching_a_sensor_off_changes_no_other_numbers);
    RUN_TEST(test_dvl_measures_over_ground_or_through_the_water);
    RUN_TEST(test_dvl_loses_the_bottom_above_its_range);
    RUN_TEST(test_dvl_mounting_adds_the_lever_arm_and_rotates_the_axes);
    RUN_TEST(test_depth_sensor_ahead_of_the_origin_rises_with_the_bow);
    RUN_TEST(test_gps_ahead_of_the_origin_turns_with_the_bow);
    RUN_TEST(test_imu_yaw_is_wrapped_and_the_truth_is_not);
    RUN_TEST(test_the_same_seed_repeats_the_run_and_a_copy_continues_identically);
    RUN_TEST(test_init_refuses_invalid_values);
    return UNITY_END();
}
