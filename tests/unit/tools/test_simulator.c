/* The simulator against physics and statistics: thrusters, disturbance, random numbers, and its
 * configuration. Statistical tests use fixed seeds and intervals of four standard deviations. */
#include <math.h>
#include <string.h>

#include "sim_run.h"
#include "unity.h"

void setUp(void)
{
    sim_defaults(&cfg);
}

void tearDown(void)
{
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
    RUN_TEST(test_thrusters_produce_the_wrench_of_the_girona500);
    RUN_TEST(test_commands_saturate_and_a_command_that_is_not_finite_is_no_thrust);
    RUN_TEST(test_lag_is_the_exact_exponential_and_so_is_its_impulse);
    RUN_TEST(test_feedback_is_the_command_unless_true_thrust_is_selected);
    RUN_TEST(test_disturbance_starts_with_its_rms);
    RUN_TEST(test_disturbance_keeps_its_rms_and_its_correlation_time);
    RUN_TEST(test_generator_is_xoshiro256_starstar);
    RUN_TEST(test_gaussian_has_the_moments_of_a_standard_normal);
    RUN_TEST(test_streams_and_neighbouring_seeds_are_uncorrelated);
    RUN_TEST(test_the_same_seed_repeats_the_run_and_a_copy_continues_identically);
    RUN_TEST(test_init_refuses_invalid_values);
    return UNITY_END();
}
