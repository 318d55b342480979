/* Sensors and clocks of the field simulator: base noise, and each mismatch in its size. */
#include "field.h"

#include <math.h>
#include <string.h>

#include "unity.h"

#define DEGREE (3.14159265358979323846 / 180)
#define MOST 12000

enum { X, Y, Z, K, M, N };

static field_config_t cfg;
static field_t field;
static field_output_t out;
static double force[SIM_THRUSTERS];

/* The DVL samples of a run, and the truth at the ends of its ticks. */
static struct {
    sim_measurement_t sample[MOST];
    double arrived_s[MOST];
    int samples, ticks;
    double nu[MOST][6], euler[MOST][3];
} seen;

void setUp(void)
{
    memset(force, 0, sizeof force);
    field_defaults(&cfg, FIELD_GIRONA500, FIELD_EXCITED, 1);
}

void tearDown(void)
{
}

static void begin_with(const char *name, double size)
{
    field_defaults(&cfg, cfg.vehicle, cfg.driver, cfg.seed);
    TEST_ASSERT_TRUE_MESSAGE(field_set(&cfg, name, size), name);
    TEST_ASSERT_TRUE(field_init(&field, &cfg));
}

/* Runs with motion in all axes, and records a sensor. */
static void watch(sim_sensor_id_t sensor, double seconds)
{
    seen.samples = seen.ticks = 0;
    for (int tick = 0; tick < lround(seconds * 50); ++tick) {
        if (tick % 150 == 0) {
            force[0] = tick % 300 == 0 ? 50 : -60;
            force[1] = tick % 450 == 0 ? -40 : 30;
            force[4] = tick % 600 < 300 ? 80 : -80;
        }
        field_step(&field, force, &out);
        memcpy(seen.nu[seen.ticks], field.truth.nu, sizeof seen.nu[0]);
        memcpy(seen.euler[seen.ticks], field.truth.euler, sizeof seen.euler[0]);
        ++seen.ticks;
        if (out.sensor[sensor].has) {
            seen.arrived_s[seen.samples] = 1e-6 * (double)out.t_us;
            seen.sample[seen.samples++] = out.sensor[sensor];
        }
    }
}

/* Truth at a time between two ticks. */
static void truth_at(double t_s, double nu[6], double euler[3])
{
    double tick = fmax(t_s * 50 - 1, 0);
    int i = (int)fmin(tick, seen.ticks - 2);
    for (int k = 0; k < 6; ++k) {
        nu[k] = seen.nu[i][k] + (tick - i) * (seen.nu[i + 1][k] - seen.nu[i][k]);
    }
    for (int k = 0; k < 3; ++k) {
        euler[k] = seen.euler[i][k] + (tick - i) * (seen.euler[i + 1][k] - seen.euler[i][k]);
    }
}

/* Mean and rms difference of samples from the truth `late_s` before their timestamps. */
static double mean[6], rms[6];

static void compare(bool imu, double late_s)
{
    memset(mean, 0, sizeof mean);
    memset(rms, 0, sizeof rms);
    for (int i = 0; i < seen.samples; ++i) {
        double nu[6], euler[3];
        truth_at(1e-6 * (double)seen.sample[i].t_us - late_s, nu, euler);
        for (int k = 0; k < (imu ? 6 : 3); ++k) {
            double true_value = !imu ? nu[k] : k < 3 ? euler[k] : nu[k];
            double off = seen.sample[i].value[k] - true_value;
            off = imu && k == 2 ? remainder(off, 360 * DEGREE) : off;
            mean[k] += off / seen.samples;
            rms[k] += off * off / seen.samples;
        }
    }
    for (int k = 0; k < 6; ++k) {
        rms[k] = sqrt(rms[k]);
    }
}

/* ---- without mismatch ---- */

static void test_the_imu_measures_attitude_and_rates_at_50_hz(void)
{
    begin_with("hull", 0);
    watch(SIM_IMU, 100);
    TEST_ASSERT_EQUAL(5000, seen.samples);
    compare(true, 0);
    for (int k = 0; k < 6; ++k) {
        double sigma = (k < 3 ? 0.2 : 0.1) * DEGREE;
        TEST_ASSERT_DOUBLE_WITHIN(0.06 * sigma, 0, mean[k]);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * sigma, sigma, rms[k]);
    }
}

static void test_the_dvl_measures_velocity_at_5_hz(void)
{
    begin_with("hull", 0);
    watch(SIM_DVL, 200);
    TEST_ASSERT_EQUAL(1000, seen.samples);
    compare(false, 0);
    for (int k = 0; k < 3; ++k) {
        TEST_ASSERT_DOUBLE_WITHIN(0.001, 0, mean[k]);
        TEST_ASSERT_DOUBLE_WITHIN(0.0006, 0.007, rms[k]);
    }
    TEST_ASSERT_EQUAL_UINT8(7, seen.sample[0].axes);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 30, seen.sample[0].value[3]);
    TEST_ASSERT_EQUAL_UINT64(200000, seen.sample[0].t_us);
}

static void test_depth_arrives_at_10_hz_and_gps_never(void)
{
    double square = 0;
    int samples = 0;
    begin_with("hull", 0);
    for (int tick = 0; tick < 5000; ++tick) {
        field_step(&field, force, &out);
        TEST_ASSERT_FALSE(out.sensor[SIM_GPS].has);
        if (out.sensor[SIM_DEPTH].has) {
            square += pow(out.sensor[SIM_DEPTH].value[0] - field.truth.position[2], 2);
            ++samples;
        }
    }
    TEST_ASSERT_EQUAL(1000, samples);
    TEST_ASSERT_DOUBLE_WITHIN(0.0015, 0.015, sqrt(square / samples));
}

/* ---- IMU ---- */

static void test_a_rotated_imu_measures_its_own_attitude(void)
{
    static const char *const name[3] = {"imu_roll", "imu_pitch", "imu_yaw"};
    for (int k = 0; k < 3; ++k) {
        setUp();
        begin_with(name[k], 2);
        for (int j = 0; j < 6; ++j) {
            force[j % 5] = 0;
        }
        double sum[3] = {0};
        for (int tick = 0; tick < 2500; ++tick) {
            field_step(&field, force, &out);
            for (int j = 0; j < 3; ++j) {
                sum[j] += out.sensor[SIM_IMU].value[j] / 2500;
            }
        }
        for (int j = 0; j < 3; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(0.03 * DEGREE, j == k ? 2 * DEGREE : 0, sum[j]);
        }
    }
}

static void test_an_imu_pitched_by_30_degrees_has_yaw_rate_in_its_roll(void)
{
    double nu[6], euler[3], product = 0, square = 0;
    begin_with("imu_pitch", 30);
    watch(SIM_IMU, 60);
    for (int i = 0; i < seen.samples; ++i) {
        truth_at(1e-6 * (double)seen.sample[i].t_us, nu, euler);
        product += (seen.sample[i].value[3] - cos(30 * DEGREE) * nu[K]) * nu[N];
        square += nu[N] * nu[N];
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01, -sin(30 * DEGREE), product / square);
}

static void test_gyro_biases_have_their_rms(void)
{
    double square = 0;
    for (cfg.seed = 1; cfg.seed <= 200; ++cfg.seed) {
        begin_with("gyro_bias", 0.1);
        for (int k = 0; k < 3; ++k) {
            square += field.sensing.gyro_bias[k] * field.sensing.gyro_bias[k] / 600;
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * DEGREE, 0.1 * DEGREE, sqrt(square));
    cfg.seed = 3;
    begin_with("gyro_bias", 1);
    watch(SIM_IMU, 40);
    compare(true, 0);
    for (int k = 0; k < 3; ++k) {
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * DEGREE, field.sensing.gyro_bias[k], mean[3 + k]);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * DEGREE, 0, mean[k]);
    }
}

static void test_attitude_is_older_than_its_timestamp(void)
{
    static const double delay[] = {0.03, 0.013, 0.1};
    for (int i = 0; i < 3; ++i) {
        begin_with("attitude_delay", delay[i]);
        watch(SIM_IMU, 60);
        TEST_ASSERT_EQUAL_UINT64(0, seen.sample[9].t_us % SIM_TICK_US);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, seen.arrived_s[9], 1e-6 * (double)seen.sample[9].t_us);
        compare(true, delay[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * DEGREE, 0.2 * DEGREE, rms[2]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * DEGREE, 0.1 * DEGREE, rms[5]);
    }
    compare(true, 0);
    TEST_ASSERT_TRUE(rms[2] > 0.5 * DEGREE);
}

/* ---- DVL ---- */

static void test_a_displaced_dvl_moves_with_the_rotation_of_the_vehicle(void)
{
    static const char *const name[3] = {"dvl_arm_x", "dvl_arm_y", "dvl_arm_z"};
    for (int k = 0; k < 3; ++k) {
        double max = 0, nu[6], euler[3];
        begin_with(name[k], 2);
        watch(SIM_DVL, 60);
        for (int i = 0; i < seen.samples; ++i) {
            truth_at(1e-6 * (double)seen.sample[i].t_us, nu, euler);
            double arm[3] = {k == 0 ? 2 : 0, k == 1 ? 2 : 0, k == 2 ? 2 : 0};
            double moved[3] = {nu[M] * arm[2] - nu[N] * arm[1], nu[N] * arm[0] - nu[K] * arm[2],
                               nu[K] * arm[1] - nu[M] * arm[0]};
            for (int j = 0; j < 3; ++j) {
                TEST_ASSERT_DOUBLE_WITHIN(0.03, nu[j] + moved[j], seen.sample[i].value[j]);
                max = fmax(max, fabs(moved[j]));
            }
        }
        TEST_ASSERT_TRUE(max > 0.06);
    }
}

static void test_a_rotated_dvl_measures_velocity_in_its_own_axes(void)
{
    static const struct {
        const char *name;
        int from, to;
        double sign;
    } turn[3] = {{"dvl_yaw", X, Y, -1}, {"dvl_pitch", X, Z, 1}, {"dvl_roll", Y, Z, -1}};
    for (int k = 0; k < 3; ++k) {
        double product = 0, square = 0, nu[6], euler[3];
        begin_with(turn[k].name, 20);
        watch(SIM_DVL, 60);
        for (int i = 0; i < seen.samples; ++i) {
            truth_at(1e-6 * (double)seen.sample[i].t_us, nu, euler);
            double to = nu[turn[k].to], from = nu[turn[k].from];
            product += (seen.sample[i].value[turn[k].to] - cos(20 * DEGREE) * to) * from;
            square += from * from;
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.02, turn[k].sign * sin(20 * DEGREE), product / square);
    }
}

static void test_scale_makes_velocity_larger(void)
{
    double product = 0, square = 0, nu[6], euler[3];
    begin_with("dvl_scale", 0.1);
    watch(SIM_DVL, 120);
    for (int i = 0; i < seen.samples; ++i) {
        truth_at(1e-6 * (double)seen.sample[i].t_us, nu, euler);
        product += seen.sample[i].value[0] * nu[X] + seen.sample[i].value[1] * nu[Y];
        square += nu[X] * nu[X] + nu[Y] * nu[Y];
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.004, 1.1, product / square);
}

static void test_with_latency_the_dvl_timestamp_is_the_arrival(void)
{
    static const double late[] = {0.1, 0.033, 0.3};
    for (int i = 0; i < 3; ++i) {
        begin_with("dvl_latency", late[i]);
        watch(SIM_DVL, 60);
        TEST_ASSERT_EQUAL_UINT64(200000 + (uint64_t)(late[i] * 1e6 + 0.5), seen.sample[0].t_us);
        double waited = seen.arrived_s[0] - 1e-6 * (double)seen.sample[0].t_us;
        TEST_ASSERT_TRUE(waited > -1e-9 && waited < 0.02);
        compare(false, late[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.001, 0.007, rms[0]);
    }
}

static void test_lost_samples_never_arrive(void)
{
    begin_with("dvl_lost", 0.3);
    watch(SIM_DVL, 240);
    TEST_ASSERT_INT_WITHIN(60, 840, seen.samples);
}

static void test_outliers_have_errors_of_half_a_metre_per_second(void)
{
    int off = 0;
    double nu[6], euler[3];
    begin_with("dvl_outliers", 0.1);
    watch(SIM_DVL, 240);
    TEST_ASSERT_EQUAL(1200, seen.samples);
    for (int i = 0; i < seen.samples; ++i) {
        truth_at(1e-6 * (double)seen.sample[i].t_us, nu, euler);
        double max = 0;
        for (int k = 0; k < 3; ++k) {
            max = fmax(max, fabs(seen.sample[i].value[k] - nu[k]));
        }
        off += max > 0.05;
    }
    TEST_ASSERT_INT_WITHIN(35, 120, off);
}

static void test_partial_samples_lack_one_or_two_axes(void)
{
    int partial = 0, kinds[8] = {0};
    begin_with("dvl_partial", 0.3);
    watch(SIM_DVL, 240);
    TEST_ASSERT_EQUAL(1200, seen.samples);
    for (int i = 0; i < seen.samples; ++i) {
        ++kinds[seen.sample[i].axes];
        partial += seen.sample[i].axes != 7;
        for (int k = 0; k < 3; ++k) {
            bool has = (seen.sample[i].axes >> k & 1) != 0;
            TEST_ASSERT_TRUE(has == (seen.sample[i].value[k] != 0));
        }
    }
    TEST_ASSERT_INT_WITHIN(50, 360, partial);
    TEST_ASSERT_EQUAL(0, kinds[0]);
    for (int axes = 1; axes < 7; ++axes) {
        TEST_ASSERT_INT_WITHIN(35, 60, kinds[axes]);
    }
}

/* ---- an autopilot's velocity ---- */

static void test_an_autopilots_velocity_lags(void)
{
    begin_with("filter_tau", 0.2);
    watch(SIM_DVL, 120);
    compare(false, 0);
    double now = rms[1];
    compare(false, 0.2);
    TEST_ASSERT_TRUE(now > 0.012 && rms[1] < 0.8 * now);
    for (int tick = 0; tick < 2000; ++tick) { /* at a constant velocity it is correct */
        field_step(&field, NULL, &out);
    }
    TEST_ASSERT_TRUE(out.sensor[SIM_DVL].has);
    TEST_ASSERT_DOUBLE_WITHIN(0.035, field.truth.nu[0], out.sensor[SIM_DVL].value[0]);
}

static void test_an_autopilots_velocity_jumps_and_recovers(void)
{
    int jumps = 0;
    double nu[6], euler[3];
    begin_with("filter_resets", 6);
    watch(SIM_DVL, 240);
    for (int i = 0; i < seen.samples; ++i) {
        truth_at(1e-6 * (double)seen.sample[i].t_us, nu, euler);
        double max = 0;
        for (int k = 0; k < 3; ++k) {
            max = fmax(max, fabs(seen.sample[i].value[k] - nu[k]));
        }
        jumps += max > 0.04;
    }
    TEST_ASSERT_TRUE(jumps > 10 && jumps < 60); /* 24, most of them visible in one or two samples */
}

/* ---- clocks ---- */

static void test_a_slow_clock_of_dvl_and_depth_falls_behind(void)
{
    for (int fast = 0; fast < 2; ++fast) {
        begin_with("clock_drift", fast ? -500 : 500);
        watch(SIM_DVL, 200);
        const sim_measurement_t *last = &seen.sample[seen.samples - 1];
        TEST_ASSERT_INT_WITHIN(1, fast ? 1000 : 1000, seen.samples + fast);
        double at = 0.2 * seen.samples; /* time of measurement */
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, at * (fast ? 1.0005 : 0.9995), 1e-6 * (double)last->t_us);
        TEST_ASSERT_TRUE(last->t_us <= 200000000);
        compare(false, fast ? 0.05 : -0.05); /* exact in the middle of the run */
        TEST_ASSERT_TRUE(rms[1] > 0.007);
    }
}

static void test_a_clock_jumps_forward_and_back_by_50_ms(void)
{
    int jumps = 0;
    begin_with("clock_jumps", 6);
    watch(SIM_DVL, 240);
    for (int i = 1; i < seen.samples; ++i) {
        double step = 1e-6 * ((double)seen.sample[i].t_us - (double)seen.sample[i - 1].t_us) - 0.2;
        TEST_ASSERT_TRUE(fabs(step) < 1e-9 || fabs(fabs(step) - 0.05) < 1e-9);
        jumps += fabs(step) > 0.01;
        TEST_ASSERT_TRUE(seen.arrived_s[i] > 0.2 * (i + 1) - 1e-9); /* not before it is measured */
    }
    TEST_ASSERT_INT_WITHIN(14, 24, jumps);
}

static void test_the_imus_clock_is_the_identifiers(void)
{
    begin_with("clock_drift", 1000);
    watch(SIM_IMU, 60);
    TEST_ASSERT_EQUAL_UINT64(60000000, seen.sample[seen.samples - 1].t_us);
}

static void test_late_samples_arrive_in_order_and_never_before_their_measurement(void)
{
    uint64_t before[SIM_SENSORS] = {0}, reported = 0;
    for (cfg.seed = 1; cfg.seed <= 10; ++cfg.seed) {
        field_defaults(&cfg, FIELD_ROV20, FIELD_JOYSTICK, cfg.seed);
        field_draw(&cfg, 2);
        TEST_ASSERT_TRUE(field_set(&cfg, "clock_drift", -100));
        TEST_ASSERT_TRUE(field_set(&cfg, "clock_jumps", 2));
        TEST_ASSERT_TRUE(field_init(&field, &cfg));
        memset(before, 0, sizeof before);
        reported = 0;
        for (int tick = 1; tick <= 3000; ++tick) {
            field_step(&field, NULL, &out);
            TEST_ASSERT_EQUAL_UINT64((uint64_t)tick * SIM_TICK_US, out.t_us);
            for (int i = 0; i < SIM_SENSORS; ++i) {
                const sim_measurement_t *m = &out.sensor[i];
                TEST_ASSERT_TRUE(!m->has || (m->t_us <= out.t_us && m->t_us > before[i]));
                before[i] = m->has ? m->t_us : before[i];
            }
            TEST_ASSERT_TRUE(!out.reported || tick < 10 || out.reported_us > reported);
            reported = out.reported ? out.reported_us : reported;
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_imu_measures_attitude_and_rates_at_50_hz);
    RUN_TEST(test_the_dvl_measures_velocity_at_5_hz);
    RUN_TEST(test_depth_arrives_at_10_hz_and_gps_never);
    RUN_TEST(test_a_rotated_imu_measures_its_own_attitude);
    RUN_TEST(test_an_imu_pitched_by_30_degrees_has_yaw_rate_in_its_roll);
    RUN_TEST(test_gyro_biases_have_their_rms);
    RUN_TEST(test_attitude_is_older_than_its_timestamp);
    RUN_TEST(test_a_displaced_dvl_moves_with_the_rotation_of_the_vehicle);
    RUN_TEST(test_a_rotated_dvl_measures_velocity_in_its_own_axes);
    RUN_TEST(test_scale_makes_velocity_larger);
    RUN_TEST(test_with_latency_the_dvl_timestamp_is_the_arrival);
    RUN_TEST(test_lost_samples_never_arrive);
    RUN_TEST(test_outliers_have_errors_of_half_a_metre_per_second);
    RUN_TEST(test_partial_samples_lack_one_or_two_axes);
    RUN_TEST(test_an_autopilots_velocity_lags);
    RUN_TEST(test_an_autopilots_velocity_jumps_and_recovers);
    RUN_TEST(test_a_slow_clock_of_dvl_and_depth_falls_behind);
    RUN_TEST(test_a_clock_jumps_forward_and_back_by_50_ms);
    RUN_TEST(test_the_imus_clock_is_the_identifiers);
    RUN_TEST(test_late_samples_arrive_in_order_and_never_before_their_measurement);
    return UNITY_END();
}
