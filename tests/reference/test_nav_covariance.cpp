// The covariance of the navigation filter stays symmetric and positive definite, in single
// precision, in all operating conditions. 1e5 ticks, 1e6 in long mode.
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "auvid/nav.h"

extern "C" {
#include "unity.h"
}

typedef Eigen::Matrix<double, 6, 6> Matrix6d;

void setUp()
{
}

void tearDown()
{
}

static long ticks()
{
    return std::getenv("AUVID_TEST_LONG") != nullptr ? 1000000 : 100000;
}

// Smallest eigenvalue of the correlations; 0 or less when P is not positive definite.
static double smallest_eigenvalue(const auvid_nav_t &nav)
{
    auvid_real_t p[6][6];
    Matrix6d P;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) {
            TEST_ASSERT_TRUE(p[i][j] == p[j][i]);
            P(i, j) = p[i][j];
        }
        if (!(P(i, i) > 0)) {
            return 0;
        }
    }
    Eigen::Matrix<double, 6, 1> s = P.diagonal().cwiseSqrt().cwiseInverse();
    return Eigen::SelfAdjointEigenSolver<Matrix6d>(s.asDiagonal() * P * s.asDiagonal())
        .eigenvalues()
        .minCoeff();
}

// All sensors, late and punctual, whole and in part, accurate and outlying; drop-outs of minutes,
// dives,
// long ticks; any attitude.
static void stress(const auvid_nav_config_t &c, bool wild, unsigned seed)
{
    std::mt19937 generator(seed);
    auto uniform = [&](double low, double high) {
        return auvid_real_t(std::uniform_real_distribution<double>(low, high)(generator));
    };
    auto chance = [&](double p) { return uniform(0, 1) < p; };
    auvid_nav_t nav;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &c));
    uint64_t t_us = 1000000;
    double worst = 1;
    long gated = 0;
    for (long k = 0; k < ticks(); ++k) {
        t_us += chance(1e-4) ? 5000000 : 20000;
        double t = 1e-6 * double(t_us);
        const auvid_real_t attitude[3] = {auvid_real_t(0.5 * std::sin(0.4 * t)),
                                          auvid_real_t(1.4 * std::sin(0.05 * t)),
                                          auvid_real_t(std::fmod(0.2 * t, 6.28))};
        const auvid_real_t rates[3] = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
        TEST_ASSERT_TRUE(auvid_nav_imu(&nav, t_us, attitude, rates) >= 0);
        bool dropped_out = k % 10000 > 7000, surface = k / 5000 % 2 == 0;
        auto age = [&] { return chance(0.5) ? 0u : unsigned(uniform(0, 450000)); };
        if (!dropped_out && k % 10 == 0) {
            auvid_real_t spread = wild && chance(0.2) ? 2 : auvid_real_t(0.05);
            auvid_dvl_sample_t s = {t_us - age(),
                                    {auvid_real_t(0.5) + uniform(-spread, spread),
                                     uniform(-spread, spread), uniform(-spread, spread)},
                                    chance(0.2) ? AUVID_DVL_WATER : AUVID_DVL_BOTTOM,
                                    uint8_t(chance(0.2) ? generator() % 8 : 7)};
            gated += auvid_nav_dvl(&nav, &s) == AUVID_GATED;
        }
        if (k % 5 == 0 && k % 20000 < 17000) {
            auvid_real_t z = surface ? 0 : 8;
            z += uniform(-0.02, 0.02) + (wild && chance(0.05) ? 300 : 0);
            gated += auvid_nav_depth(&nav, t_us - age(), z) == AUVID_GATED;
        }
        if (k % 50 == 0) {
            auvid_real_t far = wild && chance(0.05) ? 5000 : 3;
            auvid_nav_gps(&nav, t_us - age(), uniform(-far, far), uniform(-far, far));
        }
        if (k % 7 == 0 || k < 1000) {
            worst = std::min(worst, smallest_eigenvalue(nav));
            TEST_ASSERT_TRUE(worst > 0);
        }
    }
    std::printf("%ld ticks: smallest eigenvalue of the correlations %.3g; %ld gated, %u resets\n",
                ticks(), worst, gated,
                unsigned(nav.diagnostics[0].resets + nav.diagnostics[2].resets));
    TEST_ASSERT_TRUE(nav.diagnostics[AUVID_NAV_GPS].accepted > 100);
    TEST_ASSERT_TRUE(nav.diagnostics[AUVID_NAV_GPS].unused > 100);
    TEST_ASSERT_TRUE(nav.diagnostics[AUVID_NAV_DVL_BOTTOM].accepted > 1000);
}

static void test_default_tuning_keeps_the_covariance_positive_definite()
{
    auvid_nav_config_t c;
    auvid_nav_defaults(&c);
    stress(c, false, 1);
}

static void test_outliers_and_reinitialisation_keep_the_covariance_positive_definite()
{
    auvid_nav_config_t c;
    auvid_nav_defaults(&c);
    c.max_consecutive_rejections = 3;
    c.mount.dvl_euler[2] = 1;
    c.mount.dvl_lever[0] = 1;
    stress(c, true, 2);
}

// Accurate sensors, large initial variances: the remaining variance is near its rounding error.
static void test_extreme_tuning_keeps_the_covariance_positive_definite()
{
    auvid_nav_config_t c;
    auvid_nav_defaults(&c);
    c.sigma_velocity = 10;
    c.sigma_position = 1000;
    c.sigma_dvl = auvid_real_t(0.0005);
    c.sigma_depth = auvid_real_t(0.001);
    c.sigma_gps = auvid_real_t(0.01);
    c.gate = 0;
    for (int i = 0; i < 3; ++i) {
        c.sigma_acceleration[i] = auvid_real_t(0.05);
    }
    stress(c, true, 3);
}

static void test_coarse_tuning_keeps_the_covariance_positive_definite()
{
    auvid_nav_config_t c;
    auvid_nav_defaults(&c);
    for (int i = 0; i < 3; ++i) {
        c.sigma_acceleration[i] = 20;
    }
    stress(c, false, 4);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_default_tuning_keeps_the_covariance_positive_definite);
    RUN_TEST(test_outliers_and_reinitialisation_keep_the_covariance_positive_definite);
    RUN_TEST(test_extreme_tuning_keeps_the_covariance_positive_definite);
    RUN_TEST(test_coarse_tuning_keeps_the_covariance_positive_definite);
    return UNITY_END();
}
