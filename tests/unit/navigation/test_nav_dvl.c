/* Navigation filter: DVL samples, and the velocity samples that it stores for a recorder. */
#include "auvid/nav.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static auvid_nav_config_t cfg;
static auvid_nav_t nav;
static uint64_t now;
static auvid_real_t rates[3];

static auvid_real_t real(double x)
{
    return (auvid_real_t)x;
}

static void tick(uint32_t dt_us)
{
    static const auvid_real_t level[3] = {0, 0, 0};
    now += dt_us;
    TEST_ASSERT_TRUE(auvid_nav_imu(&nav, now, level, rates) >= 0);
}

static void start(void)
{
    now = 1000000;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &cfg));
    tick(20000);
}

void setUp(void)
{
    memset(rates, 0, sizeof rates);
    auvid_nav_defaults(&cfg);
    start();
}

void tearDown(void)
{
}

static auvid_status_t give(auvid_dvl_lock_t lock, unsigned valid, double x, double y, double z)
{
    auvid_dvl_sample_t s = {now, {real(x), real(y), real(z)}, lock, (uint8_t)valid};
    return auvid_nav_dvl(&nav, &s);
}

static auvid_status_t bottom(double x, double y, double z)
{
    return give(AUVID_DVL_BOTTOM, AUVID_DVL_ALL, x, y, z);
}

static auvid_status_t water(double x, double y, double z)
{
    return give(AUVID_DVL_WATER, AUVID_DVL_ALL, x, y, z);
}

static void assert_velocity(double u, double v, double w)
{
    const double expected[3] = {u, v, w};
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, expected[i], (double)nav.ekf.velocity[i]);
    }
}

/* Nothing but the diagnostics may differ. */
static void assert_unmoved(const auvid_nav_t *before)
{
    auvid_nav_t after = nav;
    memcpy(after.diagnostics, before->diagnostics, sizeof after.diagnostics);
    TEST_ASSERT_TRUE(memcmp(before, &after, sizeof after) == 0);
}

static void test_first_bottom_sample_sets_the_velocity(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1.5, -0.2, 0.1));
    assert_velocity(1.5, -0.2, 0.1);
    TEST_ASSERT_TRUE((nav.flags & AUVID_NAV_VELOCITY_KNOWN) != 0);
    TEST_ASSERT_EQUAL_UINT32(1, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].accepted);
}

static void test_default_tuning_takes_at_least_96_percent_of_each_sample(void)
{
    for (int k = 0; k < 20; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
        for (int j = 0; j < 10; ++j) {
            tick(20000);
        }
    }
    auvid_real_t before = nav.ekf.velocity[0];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1.1, 0, 0));
    TEST_ASSERT_TRUE(nav.ekf.velocity[0] - before > real(0.096));
}

/* An instrument yawed by 90 degrees measures surge on its -y axis. */
static void test_mounting_turns_the_sample_into_the_body_frame(void)
{
    cfg.mount.dvl_euler[2] = AUVID_PI / 2;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0.3, -1, 0.2));
    assert_velocity(1, 0.3, 0.2);
}

static void test_instrument_upside_down_reads_sway_and_heave_negated(void)
{
    cfg.mount.dvl_euler[0] = AUVID_PI;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0.3, 0.2));
    assert_velocity(1, -0.3, -0.2);
}

/* Rotation on the spot with the DVL 2 m ahead and 1 m below. */
static void test_lever_arm_of_a_current_sample_is_removed_with_the_current_rates(void)
{
    cfg.mount.dvl_lever[0] = 2;
    cfg.mount.dvl_lever[2] = 1;
    start();
    rates[1] = real(0.1);
    rates[2] = real(0.2);
    tick(20000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0.1 * 1, 0.2 * 2, -0.1 * 2)); /* omega x r */
    assert_velocity(0, 0, 0);
}

static void test_partial_sample_changes_only_what_it_measures(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, give(AUVID_DVL_BOTTOM, AUVID_DVL_X | AUVID_DVL_Z, 1, NAN, 0.2));
    assert_velocity(1, 0, 0.2);
    TEST_ASSERT_EQUAL_UINT(2, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].innovation_count);
    TEST_ASSERT_EQUAL_UINT32(1, nav.ground.sequence);
}

/* The body axes that the valid axes measure of an instrument turned by `yaw` and `roll`. */
static unsigned measured_by(unsigned valid, double roll, double yaw)
{
    cfg.mount.dvl_euler[0] = real(roll);
    cfg.mount.dvl_euler[2] = real(yaw);
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, give(AUVID_DVL_BOTTOM, (uint8_t)valid, 0.1, 0.2, 0.3));
    return nav.ground.measured;
}

static void test_a_sample_measures_the_body_axes_within_the_span_of_its_valid_ones(void)
{
    const double eighth = 3.14159265358979 / 4;
    for (unsigned valid = 1; valid <= 7; ++valid) {
        TEST_ASSERT_EQUAL_HEX8(valid, measured_by(valid, 0, 0));
        /* turned by a quarter: its x is the body's y; or rolled: its z is the body's -y */
        unsigned swapped = (valid >> 1 & 1) | (valid << 1 & 2) | (valid & 4);
        TEST_ASSERT_EQUAL_HEX8(swapped, measured_by(valid, 0, 2 * eighth));
        unsigned rolled = (valid & 1) | (valid << 1 & 4) | (valid >> 1 & 2);
        TEST_ASSERT_EQUAL_HEX8(rolled, measured_by(valid, 2 * eighth, 0));
        /* by an eighth: x and y only together */
        unsigned both = ((valid & 3) == 3 ? 3u : 0u) | (valid & 4);
        TEST_ASSERT_EQUAL_HEX8(both, measured_by(valid, 0, eighth));
        both = (valid & 1) | ((valid & 6) == 6 ? 6u : 0u);
        TEST_ASSERT_EQUAL_HEX8(both, measured_by(valid, eighth, 0));
    }
    /* with one degree of error it still measures its axis, with three degrees it does not */
    TEST_ASSERT_EQUAL_HEX8(1, measured_by(AUVID_DVL_X, 0, 0.0174));
    TEST_ASSERT_EQUAL_HEX8(0, measured_by(AUVID_DVL_X, 0, 0.0523));
}

static void test_time_of_horizontal_and_of_complete_velocity_over_ground_is_kept(void)
{
    start();
    TEST_ASSERT_FALSE(nav.horizontal || nav.complete);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, give(AUVID_DVL_BOTTOM, AUVID_DVL_X | AUVID_DVL_Z, 0, 0, 0));
    TEST_ASSERT_FALSE(nav.horizontal || nav.complete);
    tick(20000);
    uint64_t first = now;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, give(AUVID_DVL_BOTTOM, AUVID_DVL_X | AUVID_DVL_Y, 0, 0, 0));
    TEST_ASSERT_TRUE(nav.horizontal && !nav.complete);
    tick(20000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, give(AUVID_DVL_BOTTOM, AUVID_DVL_Z, 0, 0, 0));
    TEST_ASSERT_EQUAL_UINT64(first, nav.horizontal_us);
    tick(20000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0, 0, 0));
    TEST_ASSERT_TRUE(nav.complete);
    TEST_ASSERT_EQUAL_UINT64(now, nav.horizontal_us);
    TEST_ASSERT_EQUAL_UINT64(now, nav.complete_us);
    tick(20000);
    (void)give(AUVID_DVL_WATER, AUVID_DVL_ALL, 0, 0, 0);
    TEST_ASSERT_EQUAL_UINT64(now - 20000, nav.complete_us);
    TEST_ASSERT_EQUAL_HEX8(AUVID_DVL_ALL, nav.water.measured);
}

static void test_partial_samples_of_a_turned_instrument_equal_a_complete_one(void)
{
    const double v[3] = {0.8, -0.3, 0.4};
    cfg.mount.dvl_euler[0] = real(0.3);
    cfg.mount.dvl_euler[1] = real(-0.5);
    cfg.mount.dvl_euler[2] = real(2.0);
    cfg.mount.dvl_lever[0] = real(0.7);
    rates[2] = real(0.3);
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(v[0], v[1], v[2]));
    auvid_nav_t whole = nav;
    start();
    for (unsigned j = 0; j < 3; ++j) {
        auvid_dvl_sample_t s = {now + j, {NAN, NAN, NAN}, AUVID_DVL_BOTTOM, (uint8_t)(1u << j)};
        s.velocity[j] = real(v[j]);
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_dvl(&nav, &s));
    }
    auvid_real_t p[6][6], q[6][6];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&whole, p));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, q));
    for (int i = 0; i < 3; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, (double)whole.ekf.velocity[i], (double)nav.ekf.velocity[i]);
        for (int j = 0; j < 3; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, (double)p[3 + i][3 + j], (double)q[3 + i][3 + j]);
        }
    }
}

static void test_no_valid_axis_is_no_sample(void)
{
    auvid_nav_t before = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, give(AUVID_DVL_BOTTOM, 0, NAN, NAN, NAN));
    TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].unused);
    assert_unmoved(&before);
}

static void test_sample_faster_than_the_limit_is_refused(void)
{
    auvid_nav_t before = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, bottom(2, 2, 1.1)); /* |v| = 3.03 */
    TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].invalid);
    assert_unmoved(&before);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(2, 2, 0.9)); /* |v| = 2.97 */
}

static void test_speed_limit_does_not_look_at_invalid_axes(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, give(AUVID_DVL_BOTTOM, AUVID_DVL_X, 1, 50, INFINITY));
}

static void test_sample_with_one_axis_outside_the_gate_is_refused_whole(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    tick(200000);
    auvid_nav_t before = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_GATED, bottom(1.02, 0.95, 0));
    TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].gated);
    TEST_ASSERT_EQUAL_UINT(3, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].innovation_count);
    assert_unmoved(&before);
}

/* 4 sigma is 0.25 m/s after 0.2 s; max_acceleration 3 m/s2 adds 0.6 m/s and grows with time. */
static void test_what_a_manoeuvre_explains_is_no_outlier(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    tick(200000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0.75, 0));
    tick(400000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, -0.5, 0));
}

static void test_without_max_acceleration_only_the_gate_decides(void)
{
    cfg.max_acceleration = 0;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    tick(200000);
    TEST_ASSERT_EQUAL_INT(AUVID_GATED, bottom(1.02, 0.5, 0));
}

static void test_velocity_is_reinitialised_without_changing_the_other_axes(void)
{
    cfg.max_consecutive_rejections = 3;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0.1, 0));
    for (int k = 1; k <= 3; ++k) {
        tick(20000);
        TEST_ASSERT_EQUAL_INT(k < 3 ? AUVID_GATED : AUVID_OK, bottom(1, -0.9, 0));
    }
    assert_velocity(1, -0.9, 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, 4.9e-5, (double)nav.ekf.vv[3]);
    TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].resets);
}

/* The variance of an exact DVL is below the resolution of that which it replaces. */
static void test_a_reinitialised_velocity_has_a_positive_variance(void)
{
    cfg.sigma_velocity = 10;
    cfg.sigma_dvl = real(1e-4);
    cfg.max_acceleration = 0;
    cfg.speed_limit = 0;
    cfg.max_consecutive_rejections = 1;
    for (int turn = 0; turn < 60; ++turn) {
        cfg.mount.dvl_euler[0] = real(0.11 * turn);
        cfg.mount.dvl_euler[1] = real(0.07 * turn);
        cfg.mount.dvl_euler[2] = real(0.16 * turn);
        start();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, give(AUVID_DVL_BOTTOM, AUVID_DVL_X, 90, 0, 0));
        TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].resets);
        double along = 0;
        auvid_real_t p[6][6];
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
        for (int k = 0; k < 9; ++k) {
            along += (double)p[3 + k / 3][3 + k % 3] * (double)nav.cfg.mount[k / 3][0] *
                     (double)nav.cfg.mount[k % 3][0];
        }
        TEST_ASSERT_TRUE(along > 5e-9 && along < 1e-3);
    }
}

/* Two axes of a turned instrument make the velocity known in a plane; in the third direction its
 * variance is a million times larger, and correlated with that of the position. A complete sample
 * removes both. */
static void test_the_first_complete_sample_after_partial_ones_leaves_no_negative_variance(void)
{
    for (int i = 0; i < 3; ++i) {
        cfg.sigma_acceleration[i] = real(1e-4);
        cfg.mount.dvl_euler[i] = real(0.7);
    }
    cfg.sigma_velocity = 5;
    cfg.sigma_dvl = real(1.5e-4);
    cfg.sigma_position = real(0.04);
    for (int ticks = 1; ticks <= 25; ++ticks) {
        start();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, give(AUVID_DVL_BOTTOM, AUVID_DVL_X | AUVID_DVL_Z, 0, 0, 0));
        for (int k = 0; k < ticks; ++k) {
            tick(20000);
        }
        TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0, 0, 0));
        for (int i = 0; i < 6; i += i == 0 ? 3 : 2) { /* xx yy zz */
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.6e-3, (double)nav.ekf.pp[i]);
        }
    }
}

static void test_ground_sample_is_the_velocity_just_after_a_bottom_lock(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, nav.ground.sequence);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    tick(200000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1.05, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(2, nav.ground.sequence);
    TEST_ASSERT_EQUAL_UINT64(now, nav.ground.t_us);
    TEST_ASSERT_TRUE(memcmp(nav.ground.velocity, nav.ekf.velocity, sizeof nav.ekf.velocity) == 0);
    auvid_nav_velocity_sample_t before = nav.ground;
    tick(200000);
    TEST_ASSERT_EQUAL_INT(AUVID_GATED, bottom(-1, 0, 0));
    TEST_ASSERT_TRUE(memcmp(&before, &nav.ground, sizeof before) == 0);
}

static void test_ground_sample_of_a_late_dvl_sample_has_its_time(void)
{
    uint64_t taken = now;
    tick(20000);
    tick(20000);
    auvid_dvl_sample_t s = {taken, {1, 0, 0}, AUVID_DVL_BOTTOM, AUVID_DVL_ALL};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_dvl(&nav, &s));
    TEST_ASSERT_EQUAL_UINT64(taken, nav.ground.t_us);
}

static void test_water_lock_is_not_applied_while_bottom_lock_is_fresh(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    tick(1000000); /* the last moment */
    auvid_nav_t before = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, water(0.7, 0.2, 0));
    TEST_ASSERT_EQUAL_UINT32(1, nav.water.sequence);
    TEST_ASSERT_EQUAL_UINT64(now, nav.water.t_us);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, (double)nav.water.velocity[0]);
    before.water = nav.water;
    assert_unmoved(&before);
}

static void test_water_sample_has_mounting_and_lever_arm_removed(void)
{
    cfg.mount.dvl_euler[2] = AUVID_PI / 2;
    cfg.mount.dvl_lever[0] = 2;
    rates[2] = real(0.2);
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, water(0.3 + 0.4, -1, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1, (double)nav.water.velocity[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.3, (double)nav.water.velocity[1]);
}

static void test_partial_water_lock_stores_no_velocity_sample(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    auvid_nav_t before = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, give(AUVID_DVL_WATER, AUVID_DVL_X, 0.8, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(0, nav.water.sequence);
    assert_unmoved(&before);
}

static void test_water_lock_is_applied_when_bottom_lock_is_stale(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    tick(1000001);
    double p = (double)nav.ekf.vv[0], r = 0.007 * 0.007 + 0.3 * 0.3;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, water(0.7, 0, 0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1 - 0.3 * p / (p + r), (double)nav.ekf.velocity[0]);
    TEST_ASSERT_TRUE((nav.flags & AUVID_NAV_WATER_AIDED) != 0);
    TEST_ASSERT_EQUAL_UINT32(1, nav.water.sequence);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.7, (double)nav.water.velocity[0]);
    TEST_ASSERT_EQUAL_UINT32(1, nav.ground.sequence); /* water lock stores no sample over ground */
}

static void test_bottom_lock_that_returns_takes_over_again(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, water(0.7, 0, 0));
    tick(200000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0.9, 0, 0));
    assert_velocity(0.9, 0, 0);
    TEST_ASSERT_TRUE((nav.flags & AUVID_NAV_WATER_AIDED) == 0);
    tick(200000);
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, water(0.7, 0, 0));
}

static void test_water_lock_far_from_the_ground_velocity_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    tick(200000);
    TEST_ASSERT_EQUAL_INT(AUVID_GATED, water(-1, 0, 0));
    TEST_ASSERT_EQUAL_UINT32(0, nav.water.sequence);
    TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_DVL_WATER].gated);
    TEST_ASSERT_EQUAL_UINT(0, nav.diagnostics[AUVID_NAV_DVL_BOTTOM].gated);
}

static void test_both_locks_of_one_ping_are_used(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, water(0.8, 0, 0));
    TEST_ASSERT_EQUAL_UINT64(nav.ground.t_us, nav.water.t_us);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_first_bottom_sample_sets_the_velocity);
    RUN_TEST(test_default_tuning_takes_at_least_96_percent_of_each_sample);
    RUN_TEST(test_mounting_turns_the_sample_into_the_body_frame);
    RUN_TEST(test_instrument_upside_down_reads_sway_and_heave_negated);
    RUN_TEST(test_lever_arm_of_a_current_sample_is_removed_with_the_current_rates);
    RUN_TEST(test_partial_sample_changes_only_what_it_measures);
    RUN_TEST(test_a_sample_measures_the_body_axes_within_the_span_of_its_valid_ones);
    RUN_TEST(test_time_of_horizontal_and_of_complete_velocity_over_ground_is_kept);
    RUN_TEST(test_partial_samples_of_a_turned_instrument_equal_a_complete_one);
    RUN_TEST(test_no_valid_axis_is_no_sample);
    RUN_TEST(test_sample_faster_than_the_limit_is_refused);
    RUN_TEST(test_speed_limit_does_not_look_at_invalid_axes);
    RUN_TEST(test_sample_with_one_axis_outside_the_gate_is_refused_whole);
    RUN_TEST(test_what_a_manoeuvre_explains_is_no_outlier);
    RUN_TEST(test_without_max_acceleration_only_the_gate_decides);
    RUN_TEST(test_velocity_is_reinitialised_without_changing_the_other_axes);
    RUN_TEST(test_a_reinitialised_velocity_has_a_positive_variance);
    RUN_TEST(test_the_first_complete_sample_after_partial_ones_leaves_no_negative_variance);
    RUN_TEST(test_ground_sample_is_the_velocity_just_after_a_bottom_lock);
    RUN_TEST(test_ground_sample_of_a_late_dvl_sample_has_its_time);
    RUN_TEST(test_water_lock_is_not_applied_while_bottom_lock_is_fresh);
    RUN_TEST(test_water_sample_has_mounting_and_lever_arm_removed);
    RUN_TEST(test_partial_water_lock_stores_no_velocity_sample);
    RUN_TEST(test_water_lock_is_applied_when_bottom_lock_is_stale);
    RUN_TEST(test_bottom_lock_that_returns_takes_over_again);
    RUN_TEST(test_water_lock_far_from_the_ground_velocity_is_refused);
    RUN_TEST(test_both_locks_of_one_ping_are_used);
    return UNITY_END();
}
