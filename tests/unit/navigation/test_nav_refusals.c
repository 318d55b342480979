/* Navigation filter: late samples, and rejections: their status, with the filter unchanged. */
#include "navigation/auvid_nav_internal.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static auvid_nav_config_t cfg;
static auvid_nav_t nav, before;
static uint64_t now;

static const auvid_real_t zero[3] = {0, 0, 0};

static auvid_real_t real(double x)
{
    return (auvid_real_t)x;
}

static void tick(uint32_t dt_us)
{
    now += dt_us;
    TEST_ASSERT_TRUE(auvid_nav_imu(&nav, now, zero, zero) >= 0);
}

static auvid_status_t bottom_at(uint64_t t_us, double u)
{
    auvid_dvl_sample_t s = {t_us, {real(u), 0, 0}, AUVID_DVL_BOTTOM, AUVID_DVL_ALL};
    return auvid_nav_dvl(&nav, &s);
}

/* A filter with a sample of every sensor; its time is one tick after them. */
void setUp(void)
{
    auvid_nav_defaults(&cfg);
    cfg.gps_start = 0;
    now = 5000000;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &cfg));
    tick(20000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom_at(now, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, real(0.2)));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_gps(&nav, now, 0, 0));
    tick(20000);
    before = nav;
}

void tearDown(void)
{
}

/* The counter has increased by one, and nothing else has changed, bit for bit. */
static void assert_counted_only(uint16_t *counter)
{
    TEST_ASSERT_TRUE(*counter > 0);
    --*counter;
    TEST_ASSERT_TRUE(memcmp(&before, &nav, sizeof nav) == 0);
}

static auvid_nav_diagnostics_t *of(int sensor)
{
    return &nav.diagnostics[sensor];
}

static void test_time_that_goes_back_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, auvid_nav_imu(&nav, now - 1, zero, zero));
    assert_counted_only(&nav.imu.stale);
}

static void test_time_that_stands_still_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, auvid_nav_imu(&nav, now, zero, zero));
    assert_counted_only(&nav.imu.stale);
}

static void test_attitude_or_rate_that_is_not_finite_is_refused(void)
{
    const auvid_real_t bad[3] = {NAN, INFINITY, -INFINITY};
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) {
            auvid_real_t v[3] = {0, 0, 0};
            v[i] = bad[k];
            TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_nav_imu(&nav, now + 9, v, zero));
            assert_counted_only(&nav.imu.invalid);
            TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_nav_imu(&nav, now + 9, zero, v));
            assert_counted_only(&nav.imu.invalid);
        }
    }
}

static void test_attitude_or_rate_out_of_range_is_refused(void)
{
    const auvid_real_t angle[3] = {0, 10001, 0}, rate[3] = {0, 0, -101};
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_imu(&nav, now + 9, angle, zero));
    assert_counted_only(&nav.imu.invalid);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_imu(&nav, now + 9, zero, rate));
    assert_counted_only(&nav.imu.invalid);
}

static void test_measurements_that_are_not_finite_are_refused(void)
{
    const auvid_real_t bad[3] = {NAN, INFINITY, -INFINITY};
    for (int k = 0; k < 3; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, bottom_at(now, (double)bad[k]));
        assert_counted_only(&of(AUVID_NAV_DVL_BOTTOM)->not_finite);
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_nav_depth(&nav, now, bad[k]));
        assert_counted_only(&of(AUVID_NAV_DEPTH)->not_finite);
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_nav_pressure(&nav, now, bad[k]));
        assert_counted_only(&of(AUVID_NAV_DEPTH)->not_finite);
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_nav_gps(&nav, now, bad[k], 0));
        assert_counted_only(&of(AUVID_NAV_GPS)->not_finite);
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_nav_gps(&nav, now, 0, bad[k]));
        assert_counted_only(&of(AUVID_NAV_GPS)->not_finite);
    }
}

static void test_measurements_out_of_range_are_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, bottom_at(now, 1e6));
    assert_counted_only(&of(AUVID_NAV_DVL_BOTTOM)->invalid);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_depth(&nav, now, 100001));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->invalid);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_gps(&nav, now, 0, -100001));
    assert_counted_only(&of(AUVID_NAV_GPS)->invalid);
}

static void test_dvl_with_an_unknown_lock_or_axis_is_refused(void)
{
    auvid_dvl_sample_t s = {now, {1, 0, 0}, (auvid_dvl_lock_t)3, AUVID_DVL_ALL};
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_dvl(&nav, &s));
    assert_counted_only(&of(AUVID_NAV_DVL_BOTTOM)->invalid);
    s.lock = AUVID_DVL_BOTTOM;
    s.valid = 8;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_dvl(&nav, &s));
    assert_counted_only(&of(AUVID_NAV_DVL_BOTTOM)->invalid);
}

static void test_sample_given_twice_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, bottom_at(now - 20000, 1));
    assert_counted_only(&of(AUVID_NAV_DVL_BOTTOM)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, auvid_nav_depth(&nav, now - 20000, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, auvid_nav_gps(&nav, now - 20000, 0, 0));
    assert_counted_only(&of(AUVID_NAV_GPS)->stale);
}

static void test_sample_older_than_the_last_of_its_sensor_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, bottom_at(now - 20001, 1));
    assert_counted_only(&of(AUVID_NAV_DVL_BOTTOM)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, auvid_nav_depth(&nav, now - 20001, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, auvid_nav_gps(&nav, now - 20001, 0, 0));
    assert_counted_only(&of(AUVID_NAV_GPS)->stale);
}

static auvid_real_t pressure_of(double depth_m)
{
    return real((double)cfg.surface_pressure + (double)cfg.density * (double)cfg.gravity * depth_m);
}

static void test_a_pressure_is_refused_like_its_depth(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_pressure(&nav, now, real(2e9)));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->invalid);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, auvid_nav_pressure(&nav, now - 20000, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, auvid_nav_pressure(&nav, now - 20001, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STALE, auvid_nav_pressure(&nav, UINT64_MAX, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_GATED, auvid_nav_pressure(&nav, now, pressure_of(3)));
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, auvid_nav_pressure(&nav, now + 100000, pressure_of(0.2)));
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, auvid_nav_pressure(&nav, now + 120000, pressure_of(0.2)));
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, auvid_nav_depth(&nav, now + 140000, real(0.2)));
}

static void test_a_fix_far_away_is_gated(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_GATED, auvid_nav_gps(&nav, now, 1000, 0));
    TEST_ASSERT_EQUAL_UINT(1, of(AUVID_NAV_GPS)->gated);
}

static void test_sample_is_taken_up_to_its_greatest_age_and_no_older(void)
{
    for (int old = 0; old < 2; ++old) {
        setUp();
        tick(700000);
        before = nav;
        uint64_t t = now - 500000 - (unsigned)old;
        TEST_ASSERT_EQUAL_INT(old ? AUVID_ERR_STALE : AUVID_OK, bottom_at(t, 1));
        TEST_ASSERT_EQUAL_INT(old ? AUVID_ERR_STALE : AUVID_OK,
                              auvid_nav_depth(&nav, t, real(0.2)));
        TEST_ASSERT_EQUAL_INT(old ? AUVID_ERR_STALE : AUVID_OK, auvid_nav_gps(&nav, t, 0, 0));
        for (int s = 0; s < AUVID_NAV_SENSOR_COUNT; ++s) {
            bool given = s == AUVID_NAV_DVL_BOTTOM || s == AUVID_NAV_DEPTH || s == AUVID_NAV_GPS;
            TEST_ASSERT_EQUAL_UINT(old && given, of(s)->stale);
            of(s)->stale = 0;
        }
        TEST_ASSERT_TRUE((memcmp(&before, &nav, sizeof nav) == 0) == (old == 1));
    }
}

static void test_sample_is_taken_a_little_ahead_and_refused_far_ahead(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STALE, bottom_at(now + 500001, 1));
    assert_counted_only(&of(AUVID_NAV_DVL_BOTTOM)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STALE, auvid_nav_depth(&nav, UINT64_MAX, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom_at(now + 20000, 1));
    TEST_ASSERT_EQUAL_UINT64(now + 20000, nav.ground.t_us);
}

static void test_sample_slightly_ahead_is_used_as_of_the_last_tick(void)
{
    auvid_nav_t other = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now + 15000, real(0.21)));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&other, now, real(0.21)));
    TEST_ASSERT_TRUE(memcmp(nav.ekf.pp, other.ekf.pp, sizeof nav.ekf.pp) == 0);
    TEST_ASSERT_TRUE(
        memcmp(nav.ekf.position_lo, other.ekf.position_lo, sizeof nav.ekf.position_lo) == 0);
}

/* While sinking at 0.5 m/s, a correct depth 0.4 s old must not change z. */
static void test_late_depth_is_compared_with_the_depth_of_its_time(void)
{
    auvid_dvl_sample_t s = {now, {1, 0, real(0.5)}, AUVID_DVL_BOTTOM, AUVID_DVL_ALL};
    nav.ekf.velocity[2] = real(0.5);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_dvl(&nav, &s));
    uint64_t taken = now;
    double depth = (double)nav.ekf.position[2] + (double)nav.ekf.position_lo[2];
    for (int k = 0; k < 20; ++k) {
        tick(20000);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, taken, real(depth)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, (double)of(AUVID_NAV_DEPTH)->innovation[0]);
}

/* An older velocity has less information on the current one. */
static void test_late_velocity_leaves_the_noise_since_in_the_variance(void)
{
    uint64_t taken = now + 20000;
    for (int k = 0; k < 20; ++k) {
        tick(20000);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom_at(taken, 1.05));
    double since = 1e-6 * (double)(now - taken) * 0.02; /* sigma^2 reference_tick age */
    double prior = 4.9e-5 + 0.02 * 0.04, r = 4.9e-5;    /* at `taken`, roughly */
    TEST_ASSERT_DOUBLE_WITHIN(2e-5, since + prior * r / (prior + r), (double)nav.ekf.vv[0]);
    TEST_ASSERT_DOUBLE_WITHIN(5e-3, 1.05, (double)nav.ekf.velocity[0]);
}

static void test_late_velocity_after_another_measurement_still_shrinks_the_variance(void)
{
    uint64_t taken = now + 20000;
    for (int k = 0; k < 20; ++k) {
        tick(20000);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, real(0.2)));
    double was = (double)nav.ekf.vv[0];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom_at(taken, 1.05));
    TEST_ASSERT_TRUE((double)nav.ekf.vv[0] < was && nav.ekf.vv[0] > 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, 1.05, (double)nav.ekf.velocity[0]);
}

static void test_first_calls_must_come_in_their_order(void)
{
    auvid_nav_t blank;
    memset(&blank, 0, sizeof blank);
    nav = blank;
    auvid_nav_state_t state;
    auvid_real_t p[6][6];
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_nav_imu(&nav, now, zero, zero));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_nav_covariance(&nav, p));
    TEST_ASSERT_TRUE(memcmp(&blank, &nav, sizeof nav) == 0);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &cfg));
    before = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, bottom_at(now, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_nav_depth(&nav, now, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_nav_pressure(&nav, now, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_nav_gps(&nav, now, 1, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_nav_state(&nav, &state));
    TEST_ASSERT_TRUE(memcmp(&before, &nav, sizeof nav) == 0);
}

static void test_null_is_refused_everywhere(void)
{
    auvid_nav_state_t state;
    auvid_dvl_sample_t s = {now, {1, 0, 0}, AUVID_DVL_BOTTOM, AUVID_DVL_ALL};
    auvid_real_t p[6][6];
    auvid_nav_defaults(NULL);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_init(NULL, &cfg));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_init(&nav, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_imu(NULL, now, zero, zero));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_imu(&nav, now, NULL, zero));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_imu(&nav, now, zero, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_dvl(NULL, &s));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_dvl(&nav, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_depth(NULL, now, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_pressure(NULL, now, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_gps(NULL, now, 1, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_update(NULL, AUVID_NAV_GPS, now, zero, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_update(&nav, AUVID_NAV_GPS, now, NULL, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_state(NULL, &state));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_state(&nav, NULL));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_covariance(NULL, p));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_covariance(&nav, NULL));
    TEST_ASSERT_TRUE(memcmp(&before, &nav, sizeof nav) == 0);
}

static void refuse(auvid_status_t status)
{
    TEST_ASSERT_EQUAL_INT(status, auvid_nav_init(&nav, &cfg));
    TEST_ASSERT_TRUE(memcmp(&before, &nav, sizeof nav) == 0);
    auvid_nav_defaults(&cfg);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &cfg));
    nav = before;
}

static void test_a_sensor_that_does_not_exist_is_refused_and_not_counted(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE,
                          auvid_nav_update(&nav, AUVID_NAV_SENSOR_COUNT, now, zero, 0));
    TEST_ASSERT_TRUE(memcmp(&before, &nav, sizeof nav) == 0);
}

static void test_update_by_number_is_that_of_the_sensor_s_function(void)
{
    const auvid_real_t value[3] = {real(0.9), real(0.1), real(0.2)};
    auvid_dvl_sample_t water = {now, {value[0], value[1], value[2]}, AUVID_DVL_WATER, 3};
    auvid_nav_t other = nav;
    TEST_ASSERT_EQUAL_INT(auvid_nav_dvl(&other, &water),
                          auvid_nav_update(&nav, AUVID_NAV_DVL_WATER, now, value, 3));
    TEST_ASSERT_EQUAL_INT(auvid_nav_depth(&other, now, value[0]),
                          auvid_nav_update(&nav, AUVID_NAV_DEPTH, now, value, 0));
    TEST_ASSERT_EQUAL_INT(auvid_nav_gps(&other, now, value[0], value[1]),
                          auvid_nav_update(&nav, AUVID_NAV_GPS, now, value, 0));
    TEST_ASSERT_TRUE(memcmp(&other, &nav, sizeof nav) == 0);
}

static auvid_status_t depth_by_number(uint64_t t_us, double depth_m)
{
    const auvid_real_t value[1] = {real(depth_m)};
    return auvid_nav_update(&nav, AUVID_NAV_DEPTH, t_us, value, 0);
}

static void test_a_depth_by_number_is_refused_like_a_depth(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, depth_by_number(now, NAN));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->not_finite);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, depth_by_number(now - 20000, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, depth_by_number(now - 20001, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STALE, depth_by_number(UINT64_MAX, 0));
    assert_counted_only(&of(AUVID_NAV_DEPTH)->stale);
    TEST_ASSERT_EQUAL_INT(AUVID_GATED, depth_by_number(now, 3));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, depth_by_number(now + 1, 0.2));
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, depth_by_number(now + 100000, 0.2));
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, depth_by_number(now + 120000, 0.2));
    memset(&nav, 0, sizeof nav);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, depth_by_number(now, 0.2));
}

static void test_every_real_of_the_configuration_must_be_finite(void)
{
    auvid_real_t *field[] = {&cfg.sigma_acceleration[0],
                             &cfg.sigma_acceleration[2],
                             &cfg.reference_tick,
                             &cfg.sigma_dvl,
                             &cfg.sigma_current,
                             &cfg.sigma_depth,
                             &cfg.sigma_gps,
                             &cfg.position[1],
                             &cfg.sigma_position,
                             &cfg.sigma_velocity,
                             &cfg.gate,
                             &cfg.speed_limit,
                             &cfg.mount.dvl_euler[2],
                             &cfg.mount.dvl_lever[0],
                             &cfg.density,
                             &cfg.gravity,
                             &cfg.surface_pressure,
                             &cfg.surface_depth};
    for (size_t i = 0; i < sizeof field / sizeof field[0]; ++i) {
        auvid_nav_defaults(&cfg);
        *field[i] = NAN;
        refuse(AUVID_ERR_NOT_FINITE);
        *field[i] = INFINITY;
        refuse(AUVID_ERR_NOT_FINITE);
        *field[i] = real(2e6);
        refuse(AUVID_ERR_RANGE);
    }
}

static void test_settings_outside_their_range_are_refused(void)
{
    auvid_real_t *positive[] = {&cfg.sigma_acceleration[1], &cfg.reference_tick, &cfg.sigma_dvl,
                                &cfg.sigma_depth,           &cfg.sigma_gps,      &cfg.density,
                                &cfg.sigma_position,        &cfg.sigma_velocity, &cfg.gravity};
    for (size_t i = 0; i < sizeof positive / sizeof positive[0]; ++i) {
        auvid_nav_defaults(&cfg);
        *positive[i] = 0;
        refuse(AUVID_ERR_RANGE);
    }
    cfg.gate = -1;
    refuse(AUVID_ERR_RANGE);
    cfg.dvl_max_age_us = 2000001;
    refuse(AUVID_ERR_RANGE);
    cfg.depth_max_age_us = 2000001;
    refuse(AUVID_ERR_RANGE);
    cfg.gps_max_age_us = 2000001;
    refuse(AUVID_ERR_RANGE);
    cfg.future_us = 2000001;
    refuse(AUVID_ERR_RANGE);
    cfg.stale_us = 0;
    refuse(AUVID_ERR_RANGE);
    cfg.gps_start = AUVID_NAV_GPS_START_MAX + 1;
    refuse(AUVID_ERR_RANGE);
}

/* Every row of the table of sensors. */
static void test_noise_and_age_of_every_sensor_are_checked(void)
{
    const auvid_real_t bad[] = {(auvid_real_t)NAN, 0, real(1.001e3), real(9e-5)};
    const uint32_t age_us = 2000001;
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        const auvid_nav_row_t *row = &auvid_nav_rows[i];
        for (int k = 0; k < 4; ++k) {
            auvid_nav_defaults(&cfg);
            memcpy((char *)&cfg + row->sigma, &bad[k], sizeof bad[k]);
            refuse(k == 0 ? AUVID_ERR_NOT_FINITE : AUVID_ERR_RANGE);
        }
        auvid_nav_defaults(&cfg);
        memcpy((char *)&cfg + row->max_age, &age_us, sizeof age_us);
        refuse(AUVID_ERR_RANGE);
    }
}

static void test_counters_stop_at_their_largest_value(void)
{
    for (long k = 0; k < 70000; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_nav_depth(&nav, now, NAN));
    }
    TEST_ASSERT_EQUAL_UINT(UINT16_MAX, of(AUVID_NAV_DEPTH)->not_finite);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_time_that_goes_back_is_refused);
    RUN_TEST(test_time_that_stands_still_is_refused);
    RUN_TEST(test_attitude_or_rate_that_is_not_finite_is_refused);
    RUN_TEST(test_attitude_or_rate_out_of_range_is_refused);
    RUN_TEST(test_measurements_that_are_not_finite_are_refused);
    RUN_TEST(test_measurements_out_of_range_are_refused);
    RUN_TEST(test_dvl_with_an_unknown_lock_or_axis_is_refused);
    RUN_TEST(test_sample_given_twice_is_refused);
    RUN_TEST(test_sample_older_than_the_last_of_its_sensor_is_refused);
    RUN_TEST(test_a_pressure_is_refused_like_its_depth);
    RUN_TEST(test_a_fix_far_away_is_gated);
    RUN_TEST(test_sample_is_taken_up_to_its_greatest_age_and_no_older);
    RUN_TEST(test_sample_is_taken_a_little_ahead_and_refused_far_ahead);
    RUN_TEST(test_sample_slightly_ahead_is_used_as_of_the_last_tick);
    RUN_TEST(test_late_depth_is_compared_with_the_depth_of_its_time);
    RUN_TEST(test_late_velocity_leaves_the_noise_since_in_the_variance);
    RUN_TEST(test_late_velocity_after_another_measurement_still_shrinks_the_variance);
    RUN_TEST(test_first_calls_must_come_in_their_order);
    RUN_TEST(test_null_is_refused_everywhere);
    RUN_TEST(test_a_sensor_that_does_not_exist_is_refused_and_not_counted);
    RUN_TEST(test_update_by_number_is_that_of_the_sensor_s_function);
    RUN_TEST(test_a_depth_by_number_is_refused_like_a_depth);
    RUN_TEST(test_every_real_of_the_configuration_must_be_finite);
    RUN_TEST(test_settings_outside_their_range_are_refused);
    RUN_TEST(test_noise_and_age_of_every_sensor_are_checked);
    RUN_TEST(test_counters_stop_at_their_largest_value);
    return UNITY_END();
}
