/* Navigation filter: samples before or after the time of the filter. */
#include <math.h>
#include <string.h>

#include "auvid/nav.h"
#include "unity.h"

static auvid_nav_config_t cfg;
static auvid_nav_t nav;
static uint64_t now;
static double (*yaw_rate)(double t_s); /* of the vehicle */

static const auvid_real_t zero[3] = {0, 0, 0};
static const double none[3] = {0, 0, 0};

enum { TICK_US = 20000 };

static auvid_real_t real(double x)
{
    return (auvid_real_t)x;
}

static double still(double t_s)
{
    (void)t_s;
    return 0;
}

static void start(void)
{
    now = 1000000;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, zero, zero));
}

void setUp(void)
{
    auvid_nav_defaults(&cfg);
    cfg.gate = 0;
    cfg.gps_start = 0;
    cfg.mount.dvl_lever[0] = 2;
    yaw_rate = still;
    start();
}

void tearDown(void)
{
}

static void tick(uint32_t dt_us)
{
    now += dt_us;
    const auvid_real_t rates[3] = {0, 0, real(yaw_rate(1e-6 * (double)now))};
    TEST_ASSERT_TRUE(auvid_nav_imu(&nav, now, zero, rates) >= 0);
}

static void run(double seconds)
{
    for (int k = 0; k < (int)(seconds * 50 + 0.5); ++k) {
        tick(TICK_US);
    }
}

static auvid_status_t dvl(auvid_dvl_lock_t lock, uint64_t t_us, const double v[3])
{
    const auvid_dvl_sample_t s = {t_us, {real(v[0]), real(v[1]), real(v[2])}, lock, AUVID_DVL_ALL};
    return auvid_nav_dvl(&nav, &s);
}

static const auvid_nav_diagnostics_t *of(int sensor)
{
    return &nav.diagnostics[sensor];
}

/* ---- rates at the sample's time ---- */

/* A DVL 2 m ahead of a vehicle that rotates on the spot measures sway of 2 r. @return sway of the
 * filter after a sample of that age [m/s]; 0 is correct */
static double spin(uint32_t age_us)
{
    const double v[3] = {0, 2 * yaw_rate(1e-6 * (double)(now - age_us)), 0};
    nav.diagnostics[AUVID_NAV_DVL_BOTTOM].innovation_count =
        0; /* samples may come in any order here */
    memset(nav.ekf.velocity, 0, sizeof nav.ekf.velocity);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, dvl(AUVID_DVL_BOTTOM, now - age_us, v));
    return (double)of(AUVID_NAV_DVL_BOTTOM)->innovation[1];
}

static double growing(double t_s)
{
    return 0.3 * (t_s - 1);
}

static void test_lever_arm_is_removed_with_the_rates_of_the_samples_time(void)
{
    yaw_rate = growing;
    run(3);
    for (uint32_t age_us = 0; age_us <= 500000; age_us += 7000) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, spin(age_us));
    }
}

static void test_the_largest_age_and_slow_or_quick_ticks_make_no_difference(void)
{
    static const uint32_t ticks_us[] = {2000, 5000, 33000, 100000};
    yaw_rate = growing;
    cfg.dvl_max_age_us = 2000000;
    for (int k = 0; k < 4; ++k) {
        start();
        for (uint32_t t = 0; t < 3000000; t += ticks_us[k]) {
            tick(ticks_us[k]);
        }
        for (uint32_t age_us = 0; age_us <= 2000000; age_us += 31000) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, spin(age_us));
        }
    }
}

static double swinging(double t_s)
{
    return 0.5 * sin(3 * t_s);
}

/* Linear between rates at most h = 72 + 20 ms apart: h^2 / 8 of 4.5 rad/s3, times 2 m. */
static void test_between_stored_rates_they_are_interpolated_linearly(void)
{
    double max_error = 0;
    yaw_rate = swinging;
    run(3);
    for (int k = 0; k < 50; ++k) {
        tick(TICK_US);
        for (uint32_t age_us = 0; age_us <= 500000; age_us += 11000) {
            max_error = fmax(max_error, fabs(spin(age_us)));
        }
    }
    TEST_ASSERT_TRUE(max_error <= 2 * 4.5 * 0.092 * 0.092 / 8);
    TEST_ASSERT_TRUE(max_error >= 0.25 * 2 * 4.5 * 0.072 * 0.072 / 8);
}

static void test_before_the_oldest_rates_the_oldest_are_used(void)
{
    yaw_rate = growing;
    run(0.2);
    uint64_t oldest = 1000000; /* the first tick, without rotation */
    const double v[3] = {0, 0, 0};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, dvl(AUVID_DVL_BOTTOM, oldest - 100000, v));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, (double)of(AUVID_NAV_DVL_BOTTOM)->innovation[1]);
    tick(2000001); /* longer than any sample may be late */
    auvid_real_t r = real(growing(1e-6 * (double)now));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, dvl(AUVID_DVL_BOTTOM, now - 400000, v));
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, -2 * (double)r,
                              (double)of(AUVID_NAV_DVL_BOTTOM)->innovation[1]);
}

/* Straight in the world at 1 m/s, rotating at 0.5 rad/s: u and v change with the heading. */
static void test_velocity_of_a_late_sample_is_along_the_axes_of_its_time(void)
{
    const double rate = 0.5;
    double late_s = 0.15, max_error = 0;
    cfg.mount.dvl_lever[0] = 0;
    start();
    for (int k = 1; k <= 500; ++k) {
        double t = 0.02 * k;
        const auvid_real_t attitude[3] = {0, 0, real(rate * t)}, rates[3] = {0, 0, real(rate)};
        now += TICK_US;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, attitude, rates));
        if (k % 5 == 0) {
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 0));
        }
        if (k % 10 == 8) {
            double psi = rate * (t - late_s);
            const double v[3] = {cos(psi), -sin(psi), 0};
            TEST_ASSERT_EQUAL_INT(AUVID_OK, dvl(AUVID_DVL_BOTTOM, now - 150000, v));
            TEST_ASSERT_EQUAL_UINT64(now - 150000, nav.ground.t_us);
            double off =
                hypot((double)nav.ground.velocity[0] - v[0], (double)nav.ground.velocity[1] - v[1]);
            max_error = k > 50 ? fmax(max_error, off) : max_error;
        }
    }
    TEST_ASSERT_TRUE(max_error < 0.01); /* it changes by 0.1 m/s from sample to sample */
}

/* ---- an IMU that is later than the other sensors ---- */

static void test_a_sample_ahead_waits_for_the_imu_and_is_applied_as_a_late_one(void)
{
    const double v[3] = {0.5, 0, 0};
    uint64_t taken = now + 90000;
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, dvl(AUVID_DVL_BOTTOM, taken, v));
    TEST_ASSERT_EQUAL_UINT32(0, of(AUVID_NAV_DVL_BOTTOM)->accepted);
    run(0.08);
    TEST_ASSERT_FALSE(of(AUVID_NAV_DVL_BOTTOM)->has_sample); /* the guard has none yet */
    TEST_ASSERT_EQUAL_UINT32(0, nav.ground.sequence);
    auvid_nav_t other = nav;
    tick(TICK_US);
    TEST_ASSERT_EQUAL_UINT32(1, of(AUVID_NAV_DVL_BOTTOM)->accepted);
    TEST_ASSERT_EQUAL_UINT64(taken, of(AUVID_NAV_DVL_BOTTOM)->good_us);
    TEST_ASSERT_EQUAL_UINT64(taken, nav.ground.t_us);
    TEST_ASSERT_EQUAL_UINT32(1, nav.ground.sequence);
    auvid_nav_t held = nav;
    nav = other; /* the same sample arrives after the IMU passed its time */
    nav.held.sensors = 0;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, zero, zero));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, dvl(AUVID_DVL_BOTTOM, taken, v));
    TEST_ASSERT_EQUAL_MEMORY(&held, &nav, sizeof nav);
}

static void test_a_sample_of_every_sensor_can_be_held(void)
{
    const double v[3] = {0.5, 0.1, 0};
    uint64_t taken = now + 50000;
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, dvl(AUVID_DVL_BOTTOM, taken, v));
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, dvl(AUVID_DVL_WATER, taken, v));
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, auvid_nav_depth(&nav, taken, real(0.25)));
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, auvid_nav_gps(&nav, taken, 3, -4));
    run(0.06);
    TEST_ASSERT_EQUAL_UINT32(1, of(AUVID_NAV_DVL_BOTTOM)->accepted);
    TEST_ASSERT_EQUAL_UINT(1, of(AUVID_NAV_DVL_WATER)->unused); /* bottom lock is fresh */
    TEST_ASSERT_EQUAL_UINT32(1, nav.water.sequence);
    TEST_ASSERT_EQUAL_UINT32(1, of(AUVID_NAV_DEPTH)->accepted);
    TEST_ASSERT_EQUAL_UINT32(1, of(AUVID_NAV_GPS)->accepted);
    TEST_ASSERT_EQUAL_UINT(0, nav.held.rejected);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.25, (double)(nav.ekf.position[2] + nav.ekf.position_lo[2]));
}

/* Samples every 40 ms and an IMU 100 ms late: if the newest replaced the held one, the IMU would
 * never reach any. */
static void test_the_first_held_sample_stays_and_lost_ones_are_counted(void)
{
    const double v[3] = {0.5, 0, 0};
    int held = 0, lost = 0;
    for (int k = 0; k < 100; ++k) {
        tick(TICK_US);
        if (k % 2 == 0) {
            auvid_status_t status = dvl(AUVID_DVL_BOTTOM, now + 100000, v);
            TEST_ASSERT_TRUE(status == AUVID_PENDING || status == AUVID_UNUSED);
            held += status == AUVID_PENDING;
            lost += status == AUVID_UNUSED;
        }
    }
    run(0.2);
    TEST_ASSERT_TRUE(held >= 16); /* of 50, one every 100 or 120 ms */
    TEST_ASSERT_EQUAL_UINT32(held, of(AUVID_NAV_DVL_BOTTOM)->accepted);
    TEST_ASSERT_EQUAL_UINT(lost, of(AUVID_NAV_DVL_BOTTOM)->unused);
    TEST_ASSERT_EQUAL_UINT(0, of(AUVID_NAV_DVL_BOTTOM)->stale);
}

static void test_a_sample_slightly_ahead_does_not_overtake_the_held_one(void)
{
    const double v[3] = {0.5, 0, 0};
    uint64_t first = now + 30000;
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, dvl(AUVID_DVL_BOTTOM, first, v));
    tick(TICK_US);
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, dvl(AUVID_DVL_BOTTOM, first + 5000, v));
    tick(TICK_US);
    TEST_ASSERT_EQUAL_UINT64(first, nav.ground.t_us);
}

static void test_no_sample_is_held_longer_than_its_largest_age(void)
{
    const double v[3] = {0.5, 0, 0};
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STALE, dvl(AUVID_DVL_BOTTOM, now + 500001, v));
    TEST_ASSERT_EQUAL_UINT(1, of(AUVID_NAV_DVL_BOTTOM)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, dvl(AUVID_DVL_BOTTOM, now + 500000, v));
    tick(1000001); /* the IMU returns when the sample is too old */
    TEST_ASSERT_EQUAL_UINT(2, of(AUVID_NAV_DVL_BOTTOM)->stale);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_NAV_DVL_BOTTOM, nav.held.rejected);
    TEST_ASSERT_EQUAL_UINT32(0, nav.ground.sequence);
    tick(TICK_US);
    TEST_ASSERT_EQUAL_UINT(0, nav.held.rejected); /* reported once */
}

static void test_without_a_largest_age_no_sample_is_held(void)
{
    cfg.depth_max_age_us = 0;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STALE, auvid_nav_depth(&nav, now + 20001, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now + 20000, 1));
}

static void test_a_held_sample_is_gated_when_it_is_used(void)
{
    cfg.gate = 16;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, dvl(AUVID_DVL_BOTTOM, now, none));
    const double v[3] = {2.5, 0, 0};
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, dvl(AUVID_DVL_BOTTOM, now + 50000, v));
    run(0.06);
    TEST_ASSERT_EQUAL_UINT(1, of(AUVID_NAV_DVL_BOTTOM)->gated);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_NAV_DVL_BOTTOM, nav.held.rejected);
    TEST_ASSERT_EQUAL_UINT32(1, nav.ground.sequence);
}

static void test_a_sample_out_of_range_is_not_held(void)
{
    const double v[3] = {50, 0, 0};
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, dvl(AUVID_DVL_BOTTOM, now + 50000, v));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE,
                          auvid_nav_depth(&nav, now + 50000, (auvid_real_t)NAN));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_gps(&nav, now + 50000, 1, real(2e5)));
    TEST_ASSERT_EQUAL_UINT(0, nav.held.sensors);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_lever_arm_is_removed_with_the_rates_of_the_samples_time);
    RUN_TEST(test_the_largest_age_and_slow_or_quick_ticks_make_no_difference);
    RUN_TEST(test_between_stored_rates_they_are_interpolated_linearly);
    RUN_TEST(test_before_the_oldest_rates_the_oldest_are_used);
    RUN_TEST(test_velocity_of_a_late_sample_is_along_the_axes_of_its_time);
    RUN_TEST(test_a_sample_ahead_waits_for_the_imu_and_is_applied_as_a_late_one);
    RUN_TEST(test_a_sample_of_every_sensor_can_be_held);
    RUN_TEST(test_the_first_held_sample_stays_and_lost_ones_are_counted);
    RUN_TEST(test_a_sample_slightly_ahead_does_not_overtake_the_held_one);
    RUN_TEST(test_no_sample_is_held_longer_than_its_largest_age);
    RUN_TEST(test_without_a_largest_age_no_sample_is_held);
    RUN_TEST(test_a_held_sample_is_gated_when_it_is_used);
    RUN_TEST(test_a_sample_out_of_range_is_not_held);
    return UNITY_END();
}
