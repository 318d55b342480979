/* Navigation filter: prediction, depth, pressure, GPS, the gate, re-initialisation, flags. */
#include "auvid/nav.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static auvid_nav_config_t cfg;
static auvid_nav_t nav;
static auvid_nav_state_t state;
static uint64_t now; /* the last tick */

static const auvid_real_t zero[3] = {0, 0, 0};

static auvid_real_t real(double x)
{
    return (auvid_real_t)x;
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
    start();
}

void tearDown(void)
{
}

static auvid_status_t tick(uint32_t dt_us)
{
    now += dt_us;
    return auvid_nav_imu(&nav, now, zero, zero);
}

static void read_state(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_state(&nav, &state));
}

static double variance(int i)
{
    auvid_real_t p[6][6];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
    return (double)p[i][i];
}

static auvid_status_t bottom(double u, double v, double w)
{
    auvid_dvl_sample_t s = {now, {real(u), real(v), real(w)}, AUVID_DVL_BOTTOM, AUVID_DVL_ALL};
    return auvid_nav_dvl(&nav, &s);
}

static void test_first_tick_sets_time_and_attitude_only(void)
{
    const auvid_real_t attitude[3] = {real(0.1), real(0.2), real(0.3)};
    const auvid_real_t rates[3] = {real(0.4), real(0.5), real(0.6)};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &cfg));
    double before = variance(3);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, 77, attitude, rates));
    read_state();
    TEST_ASSERT_EQUAL_UINT64(77, state.t_us);
    TEST_ASSERT_TRUE(memcmp(attitude, state.attitude, sizeof attitude) == 0);
    TEST_ASSERT_TRUE(memcmp(rates, state.rates, sizeof rates) == 0);
    TEST_ASSERT_EQUAL_DOUBLE(before, variance(3));
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)state.velocity[0]);
}

/* Heading east and nose up: surge carries the vehicle east and up (z down). */
static void test_position_moves_along_the_attitude_of_the_new_tick(void)
{
    const auvid_real_t attitude[3] = {0, real(0.5), AUVID_PI / 2};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    read_state();
    double u = (double)state.velocity[0];
    now += 500000;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, attitude, zero));
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0, (double)state.position[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.5 * u * cos(0.5), (double)state.position[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.5 * u * sin(0.5), (double)state.position[2]);
}

static void test_velocity_variance_grows_equally_at_any_tick(void)
{
    double start_variance = variance(3), grown[3];
    const uint32_t dt_us[3] = {5000, 20000, 250000};
    for (int k = 0; k < 3; ++k) {
        start();
        for (uint32_t t = 0; t < 1000000; t += dt_us[k]) {
            TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(dt_us[k]));
        }
        grown[k] = variance(3) - start_variance;
        TEST_ASSERT_DOUBLE_WITHIN(2e-5, 0.02, grown[k]); /* sigma^2 reference_tick 1 s */
    }
}

static void check_unwrapped(int angle)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int convention = 0; convention < 2; ++convention) { /* (-pi, pi] and [0, 2 pi) */
            start();
            for (int k = 1; k <= 200; ++k) {
                double psi = sign * 0.1 * k, half = 3.14159265358979;
                double wrapped = psi - 2 * half * floor((psi + (convention ? 0 : half)) / 2 / half);
                auvid_real_t attitude[3] = {0, 0, 0};
                attitude[angle] = real(wrapped);
                now += 20000;
                TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, attitude, zero));
                read_state();
                TEST_ASSERT_DOUBLE_WITHIN(1e-5, psi, (double)state.attitude[angle]);
            }
        }
    }
}

static void test_yaw_is_unwrapped_through_several_turns(void)
{
    check_unwrapped(2);
}

static void test_roll_is_unwrapped_through_several_turns(void)
{
    check_unwrapped(0);
}

static void test_unwrapped_yaw_is_unchanged(void)
{
    for (int k = 1; k <= 200; ++k) {
        const auvid_real_t attitude[3] = {0, 0, real(0.1 * k)};
        now += 20000;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, attitude, zero));
        read_state();
        TEST_ASSERT_TRUE(state.attitude[2] == attitude[2]);
    }
}

static void test_long_tick_is_predicted_in_full_and_reported(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    double before = variance(3);
    TEST_ASSERT_EQUAL_INT(AUVID_GAP, tick(5000000));
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 5, (double)state.position[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, before + 0.02 * 5, variance(3));
    TEST_ASSERT_EQUAL_UINT(1, nav.imu.gaps);
    TEST_ASSERT_TRUE((state.flags & AUVID_NAV_IN_GAP) != 0);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
    read_state();
    TEST_ASSERT_TRUE((state.flags & AUVID_NAV_IN_GAP) == 0);
}

static void test_clock_jump_to_the_last_time_leaves_large_variances(void)
{
    const uint64_t leaps[] = {4000000000u, UINT64_C(1) << 62, (UINT64_C(1) << 63) + 2,
                              UINT64_MAX - 1000000};
    for (int i = 0; i < 4; ++i) {
        start();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
        double before = variance(3);
        TEST_ASSERT_EQUAL_INT(AUVID_GAP, auvid_nav_imu(&nav, now + leaps[i], zero, zero));
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, before + 0.02 * 2147.483647, variance(3));
        read_state();
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, 2147.483647 * (double)state.velocity[0],
                                  (double)state.position[0]);
        TEST_ASSERT_EQUAL_HEX32(0, state.flags & AUVID_NAV_FRESH_BOTTOM);
    }
}

static void test_gap_of_zero_never_reports_one(void)
{
    cfg.gap_us = 0;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(2000000));
    now += UINT64_C(5000000000); /* more than 32 bits of microseconds */
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(1));
    TEST_ASSERT_EQUAL_UINT(0, nav.imu.gaps);
}

/* 1 mm/s for ten hours at 100 Hz: each step is far below the last digit of 2000 m. */
static void test_position_far_away_sums_steps_that_plain_single_precision_loses(void)
{
    cfg.position[0] = 2000;
    start();
    nav.ekf.velocity[0] = real(0.001);
    for (int k = 0; k < 360000; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(10000));
    }
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(2.5e-4, 2003.6, (double)state.position[0]);
}

static void test_first_depth_sets_z_and_its_variance(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 300));
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 300, (double)state.position[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.015 * 0.015, variance(2));
    TEST_ASSERT_TRUE((state.flags & AUVID_NAV_DEPTH_KNOWN) != 0);
}

static void test_later_depth_pulls_z_by_the_gain(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 2));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
    double p = variance(2), r = 0.015 * 0.015;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, real(2.05)));
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2 + 0.05 * p / (p + r), (double)state.position[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * p, p * r / (p + r), variance(2));
    const auvid_nav_diagnostics_t *d = &nav.diagnostics[AUVID_NAV_DEPTH];
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.05, (double)d->innovation[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6 * p, p + r, (double)d->variance[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.05 * 0.05 / (p + r), (double)d->nis);
    TEST_ASSERT_EQUAL_UINT(1, d->innovation_count);
}

static void test_pressure_becomes_depth_by_density_and_surface_pressure(void)
{
    cfg.density = 1000;
    cfg.gravity = real(9.8);
    cfg.surface_pressure = 100000;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_pressure(&nav, now, 100000 + 9800 * 7));
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 7, (double)state.position[2]);
}

static void test_gps_starts_from_the_median_of_the_first_fixes(void)
{
    const double x[4] = {100, 900, 104, 102}, y[4] = {-50, -54, 700, -52};
    for (int k = 0; k < 4; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(1000000));
        TEST_ASSERT_EQUAL_INT(k < 3 ? AUVID_PENDING : AUVID_OK,
                              auvid_nav_gps(&nav, now, real(x[k]), real(y[k])));
        read_state();
        TEST_ASSERT_TRUE(((state.flags & AUVID_NAV_POSITION_KNOWN) != 0) == (k == 3));
        TEST_ASSERT_TRUE(k == 3 || state.position[0] == 0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 103, (double)state.position[0]); /* of 100 102 104 900 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, -51, (double)state.position[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.5 * 1.5, variance(0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.5 * 1.5, variance(1));
}

static void test_a_fix_after_the_start_is_an_ordinary_update(void)
{
    for (int k = 0; k < 4; ++k) {
        (void)tick(20000);
        TEST_ASSERT_EQUAL_INT(k < 3 ? AUVID_PENDING : AUVID_OK, auvid_nav_gps(&nav, now, 10, 20));
    }
    double before = variance(0);
    (void)tick(20000);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_gps(&nav, now, 10, 20));
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * before, before / 2, variance(0));
}

static void test_depth_and_fix_make_known_only_what_they_measure(void)
{
    cfg.gps_start = 1;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, real(0.1)));
    read_state();
    TEST_ASSERT_EQUAL_HEX32(AUVID_NAV_DEPTH_KNOWN,
                            state.flags & (AUVID_NAV_DEPTH_KNOWN | AUVID_NAV_POSITION_KNOWN));
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_gps(&nav, now, 1, 1));
    read_state();
    TEST_ASSERT_EQUAL_HEX32(AUVID_NAV_POSITION_KNOWN,
                            state.flags & (AUVID_NAV_DEPTH_KNOWN | AUVID_NAV_POSITION_KNOWN));
}

static void test_gps_start_allows_for_motion_between_the_fixes(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    for (int k = 0; k < 4; ++k) {
        TEST_ASSERT_TRUE(tick(1000000) >= 0);
        read_state();
        TEST_ASSERT_TRUE(auvid_nav_gps(&nav, now, 50 + state.position[0], 20) >= 0);
    }
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(1e-2, 54, (double)state.position[0]);
}

static void test_gps_without_a_median_start_is_an_ordinary_update(void)
{
    cfg.gps_start = 0;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_gps(&nav, now, 2, 0));
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2 * 1 / (1 + 2.25), (double)state.position[0]);
}

static void test_gps_under_water_is_not_used(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, real(0.6)));
    auvid_nav_t before = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, auvid_nav_gps(&nav, now, 1, 1));
    TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_GPS].unused);
    nav.diagnostics[AUVID_NAV_GPS].unused = 0;
    TEST_ASSERT_TRUE(memcmp(&before, &nav, sizeof nav) == 0);
}

/* A surface craft has no depth sensor. Its depth is dead reckoned, here to 30 m. */
static void test_gps_is_used_at_any_depth_that_was_never_measured(void)
{
    cfg.gps_start = 0;
    cfg.position[2] = 30;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_gps(&nav, now, 1, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 30));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, auvid_nav_gps(&nav, now, 1, 1));
}

static void test_gps_at_the_surface_is_used_again_after_a_dive(void)
{
    cfg.gps_start = 0;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 5));
    TEST_ASSERT_EQUAL_INT(AUVID_UNUSED, auvid_nav_gps(&nav, now, 1, 1));
    TEST_ASSERT_EQUAL_INT(AUVID_GAP, tick(10000000)); /* uncertain enough to accept it */
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, real(0.2)));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_gps(&nav, now, 1, 1));
}

static void test_one_depth_outside_the_gate_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 2));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
    auvid_nav_t before = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_GATED, auvid_nav_depth(&nav, now, 3));
    TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_DEPTH].gated);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1, (double)nav.diagnostics[AUVID_NAV_DEPTH].innovation[0]);
    TEST_ASSERT_TRUE(nav.diagnostics[AUVID_NAV_DEPTH].nis > cfg.gate);
    memcpy(nav.diagnostics, before.diagnostics, sizeof nav.diagnostics);
    TEST_ASSERT_TRUE(memcmp(&before, &nav, sizeof nav) == 0);
}

/* The same innovation on both sides of the gate. */
static void test_gate_is_the_square_of_the_innovation_over_its_variance(void)
{
    for (int inside = 0; inside < 2; ++inside) {
        start();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 2));
        TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
        double s = variance(2) + 0.015 * 0.015;
        double nu = (inside ? 3.99 : 4.01) * sqrt(s);
        TEST_ASSERT_EQUAL_INT(inside ? AUVID_OK : AUVID_GATED,
                              auvid_nav_depth(&nav, now, real(2 + nu)));
    }
}

static void test_gate_of_zero_accepts_everything(void)
{
    cfg.gate = 0;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 2));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 2000));
}

/* A filter with a large error and small variances must recover. */
static void test_filter_reinitialises_after_max_consecutive_rejections(void)
{
    cfg.max_consecutive_rejections = 5;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0, 0, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 2));
    for (int k = 1; k <= 5; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
        TEST_ASSERT_EQUAL_INT(k < 5 ? AUVID_GATED : AUVID_OK, auvid_nav_depth(&nav, now, 9));
    }
    read_state();
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 9, (double)state.position[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 0.015 * 0.015, variance(2));
    TEST_ASSERT_EQUAL_UINT(1, nav.diagnostics[AUVID_NAV_DEPTH].resets);
    TEST_ASSERT_EQUAL_UINT(0, nav.diagnostics[AUVID_NAV_DEPTH].consecutive_rejections);
}

static void test_rejections_that_are_not_consecutive_do_not_reinitialise(void)
{
    cfg.max_consecutive_rejections = 3;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0, 0, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 2));
    for (int k = 0; k < 30; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
        bool good = k % 3 == 2;
        TEST_ASSERT_EQUAL_INT(good ? AUVID_OK : AUVID_GATED,
                              auvid_nav_depth(&nav, now, good ? 2 : 9));
    }
    TEST_ASSERT_EQUAL_UINT(0, nav.diagnostics[AUVID_NAV_DEPTH].resets);
}

static void test_max_consecutive_rejections_of_zero_never_reinitialises(void)
{
    cfg.max_consecutive_rejections = 0;
    start();
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0, 0, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 2));
    for (int k = 0; k < 50; ++k) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(20000));
        TEST_ASSERT_EQUAL_INT(AUVID_GATED, auvid_nav_depth(&nav, now, 9));
    }
}

static void test_each_sensor_becomes_stale_independently(void)
{
    const uint32_t all = AUVID_NAV_FRESH_BOTTOM | AUVID_NAV_FRESH_WATER | AUVID_NAV_FRESH_DEPTH |
                         AUVID_NAV_FRESH_GPS;
    read_state();
    TEST_ASSERT_EQUAL_UINT32(0, state.flags & all);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(0, 0, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(500000));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_PENDING, auvid_nav_gps(&nav, now, 0, 0));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(500000));
    read_state();
    TEST_ASSERT_EQUAL_UINT32(AUVID_NAV_FRESH_BOTTOM | AUVID_NAV_FRESH_DEPTH | AUVID_NAV_FRESH_GPS,
                             state.flags & all);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(1));
    read_state();
    TEST_ASSERT_EQUAL_UINT32(AUVID_NAV_FRESH_DEPTH | AUVID_NAV_FRESH_GPS, state.flags & all);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, tick(500000));
    read_state();
    TEST_ASSERT_EQUAL_UINT32(0, state.flags & all);
}

static void test_covariance_is_that_of_the_configuration_at_the_start(void)
{
    cfg.sigma_position = 3;
    cfg.sigma_velocity = real(0.5);
    start();
    auvid_real_t p[6][6];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            TEST_ASSERT_EQUAL_DOUBLE(i != j ? 0 : i < 3 ? 9 : 0.25, (double)p[i][j]);
        }
    }
}

static void test_two_filters_do_not_interact(void)
{
    auvid_nav_t other = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, bottom(1, 0, 0));
    auvid_nav_t mine = nav;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&other, now, 4));
    TEST_ASSERT_TRUE(memcmp(&mine, &nav, sizeof nav) == 0);
}

static void test_memory_is_what_the_header_says(void)
{
    if (sizeof(auvid_real_t) == 4) {
        TEST_ASSERT_TRUE(sizeof(auvid_nav_t) <= AUVID_NAV_BYTES);
        TEST_ASSERT_TRUE(sizeof(auvid_nav_t) > AUVID_NAV_BYTES - 16);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_first_tick_sets_time_and_attitude_only);
    RUN_TEST(test_position_moves_along_the_attitude_of_the_new_tick);
    RUN_TEST(test_velocity_variance_grows_equally_at_any_tick);
    RUN_TEST(test_yaw_is_unwrapped_through_several_turns);
    RUN_TEST(test_roll_is_unwrapped_through_several_turns);
    RUN_TEST(test_unwrapped_yaw_is_unchanged);
    RUN_TEST(test_long_tick_is_predicted_in_full_and_reported);
    RUN_TEST(test_clock_jump_to_the_last_time_leaves_large_variances);
    RUN_TEST(test_gap_of_zero_never_reports_one);
    RUN_TEST(test_position_far_away_sums_steps_that_plain_single_precision_loses);
    RUN_TEST(test_first_depth_sets_z_and_its_variance);
    RUN_TEST(test_later_depth_pulls_z_by_the_gain);
    RUN_TEST(test_pressure_becomes_depth_by_density_and_surface_pressure);
    RUN_TEST(test_gps_starts_from_the_median_of_the_first_fixes);
    RUN_TEST(test_a_fix_after_the_start_is_an_ordinary_update);
    RUN_TEST(test_depth_and_fix_make_known_only_what_they_measure);
    RUN_TEST(test_gps_start_allows_for_motion_between_the_fixes);
    RUN_TEST(test_gps_without_a_median_start_is_an_ordinary_update);
    RUN_TEST(test_gps_under_water_is_not_used);
    RUN_TEST(test_gps_is_used_at_any_depth_that_was_never_measured);
    RUN_TEST(test_gps_at_the_surface_is_used_again_after_a_dive);
    RUN_TEST(test_one_depth_outside_the_gate_is_refused);
    RUN_TEST(test_gate_is_the_square_of_the_innovation_over_its_variance);
    RUN_TEST(test_gate_of_zero_accepts_everything);
    RUN_TEST(test_filter_reinitialises_after_max_consecutive_rejections);
    RUN_TEST(test_rejections_that_are_not_consecutive_do_not_reinitialise);
    RUN_TEST(test_max_consecutive_rejections_of_zero_never_reinitialises);
    RUN_TEST(test_each_sensor_becomes_stale_independently);
    RUN_TEST(test_covariance_is_that_of_the_configuration_at_the_start);
    RUN_TEST(test_two_filters_do_not_interact);
    RUN_TEST(test_memory_is_what_the_header_says);
    return UNITY_END();
}
