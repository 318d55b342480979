/* The sensors of the simulator against statistics, with fixed seeds and intervals of four standard
 * deviations. */
#include <math.h>
#include <string.h>

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

int main(void)
{
    UNITY_BEGIN();
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
    return UNITY_END();
}
