/* Forms of a sensor's output that the tick accepts. */
#include "auvid/identifier.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static auvid_identifier_config_t cfg;
static auvid_identifier_t id;
static auvid_input_t in;
static auvid_output_t out;

static void step(void)
{
    in.t_us += 20000;
    in.imu.t_us = in.pressure.t_us = in.depth.t_us = in.t_us;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
}

void setUp(void)
{
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    memset(&in, 0, sizeof in);
    in.imu.present = true;
    step();
}

void tearDown(void)
{
}

static void test_a_quaternion_is_used_instead_of_the_euler_angles(void)
{
    in.imu.by_quaternion = true;
    in.imu.attitude[0] = in.imu.attitude[2] = 1;
    in.imu.quaternion[0] = in.imu.quaternion[3] = (auvid_real_t)sqrt(0.5);
    step();
    TEST_ASSERT_EQUAL_HEX32(0, out.events & AUVID_EVENT_IMU_DROPPED);
    TEST_ASSERT_TRUE(fabs((double)id.nav.imu.attitude[2] - acos(0)) < 1e-6);
    TEST_ASSERT_TRUE(fabs((double)id.nav.imu.attitude[0]) < 1e-6);
}

static void test_a_quaternion_of_zeros_is_dropped(void)
{
    in.imu.by_quaternion = true;
    step();
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_IMU_DROPPED, out.events & AUVID_EVENT_IMU_DROPPED);
    TEST_ASSERT_EQUAL_UINT(1, id.nav.imu.invalid);
}

static void test_a_pressure_is_a_depth(void)
{
    in.pressure.present = true;
    in.pressure.pressure_pa = AUVID_C(101325.0) + 5 * AUVID_C(1025.0) * AUVID_C(9.80665);
    step();
    TEST_ASSERT_EQUAL_HEX32(0, out.events & AUVID_EVENT_DEPTH_DROPPED);
    TEST_ASSERT_TRUE(fabs((double)id.nav.ekf.position[2] + (double)id.nav.ekf.position_lo[2] - 5) <
                     1e-4);
    TEST_ASSERT_TRUE(id.nav.diagnostics[AUVID_NAV_DEPTH].has_sample);
}

static void test_a_pressure_that_is_not_finite_is_dropped(void)
{
    in.pressure.present = true;
    in.pressure.pressure_pa = (auvid_real_t)NAN;
    step();
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_DEPTH_DROPPED, out.events & AUVID_EVENT_DEPTH_DROPPED);
}

static void test_a_depth_and_a_pressure_of_the_same_time_are_one_sample(void)
{
    in.depth.present = in.pressure.present = true;
    in.depth.depth_m = 2;
    in.pressure.pressure_pa = AUVID_C(101325.0);
    step();
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_DEPTH_DROPPED, out.events & AUVID_EVENT_DEPTH_DROPPED);
    TEST_ASSERT_EQUAL_UINT(1, id.nav.diagnostics[AUVID_NAV_DEPTH].accepted);
}

static void test_a_turned_imu_is_configured_in_one_field(void)
{
    const auvid_real_t half = (auvid_real_t)acos(0);
    cfg.nav.mount.imu_euler[2] = half; /* its x axis points to starboard */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    in.imu.attitude[2] = half;
    in.imu.rates[0] = AUVID_C(0.5);
    step();
    TEST_ASSERT_TRUE(fabs((double)id.nav.imu.attitude[2]) < 1e-6);
    TEST_ASSERT_TRUE(fabs((double)id.nav.imu.rates[0]) < 1e-6);
    TEST_ASSERT_TRUE(fabs((double)id.nav.imu.rates[1] - 0.5) < 1e-6);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_quaternion_is_used_instead_of_the_euler_angles);
    RUN_TEST(test_a_quaternion_of_zeros_is_dropped);
    RUN_TEST(test_a_pressure_is_a_depth);
    RUN_TEST(test_a_pressure_that_is_not_finite_is_dropped);
    RUN_TEST(test_a_depth_and_a_pressure_of_the_same_time_are_one_sample);
    RUN_TEST(test_a_turned_imu_is_configured_in_one_field);
    return UNITY_END();
}
