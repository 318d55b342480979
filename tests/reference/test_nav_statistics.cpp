// Consistency of the navigation filter. Worlds drawn from its own model: accelerations
// Gaussian and constant over each tick, Gaussian sensors, attitude known. Then NEES must be
// chi-square of 6 degrees of freedom, NIS of 3 (DVL), 1 (depth), 2 (GPS).
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "auvid/nav.h"

extern "C" {
#include "unity.h"
}

using Eigen::Matrix3d;
using Eigen::Vector3d;
typedef Eigen::Matrix<double, 6, 1> Vector6d;
typedef Eigen::Matrix<double, 6, 6> Matrix6d;

void setUp()
{
}

void tearDown()
{
}

// A thousand runs: of any hundred, one mean in twenty is outside its band (seeds 1000 to 1099: NIS
// of the GPS, 1.93), and the band of a hundred would let a fault of 2 % pass.
static const int runs = 1000, seconds = 60;

struct Sum {
    double sum = 0, squares = 0;
    long n = 0;
    void add(double x)
    {
        sum += x;
        squares += x * x;
        ++n;
    }
    double mean() const
    {
        return sum / double(n);
    }
    double standard_error() const
    {
        double m = mean();
        return std::sqrt((squares / double(n) - m * m) / double(n - 1));
    }
};

struct Result {
    Sum nees_of_run;          // one entry a run: its average over time
    std::vector<Sum> nees_at; // one a second, over the runs
    Sum nis[AUVID_NAV_SENSOR_COUNT];
};

static Matrix3d rotation(const auvid_real_t e[3])
{
    return (Eigen::AngleAxisd(e[2], Vector3d::UnitZ()) *
            Eigen::AngleAxisd(e[1], Vector3d::UnitY()) * Eigen::AngleAxisd(e[0], Vector3d::UnitX()))
        .toRotationMatrix();
}

static double nees(const auvid_nav_t &nav, const Vector6d &truth)
{
    auvid_real_t p[6][6];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
    Vector6d e;
    Matrix6d P;
    for (int i = 0; i < 6; ++i) {
        double x = i < 3 ? double(nav.ekf.position[i]) + double(nav.ekf.position_lo[i])
                         : double(nav.ekf.velocity[i - 3]);
        e[i] = truth[i] - x;
        for (int j = 0; j < 6; ++j) {
            P(i, j) = p[i][j];
        }
    }
    return e.dot(P.ldlt().solve(e));
}

// One run; the filter assumes `belief` times the true accelerations.
class Run
{
  public:
    Run(unsigned seed, double belief, Result *r) : generator(seed), result(r)
    {
        auvid_nav_defaults(&c);
        c.gate = 0;
        c.gps_start = 0;
        c.surface_depth = 10000;
        c.speed_limit = 0;
        c.sigma_position = 2;
        for (int i = 0; i < 3; ++i) {
            double sigma = 0.3 * (i + 1);
            q[i] = sigma * sigma * double(c.reference_tick);
            c.sigma_acceleration[i] = auvid_real_t(belief * sigma);
        }
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &c));
        for (int i = 0; i < 6; ++i) {
            truth[i] = (i < 3 ? 2.0 : 1.0) * normal(generator);
            phase[i] = 6.28 * double(generator() % 1000) / 1000;
        }
    }

    void go()
    {
        const uint64_t start_us = t_us, end_us = t_us + 1000000u * seconds;
        // NEES is evaluated midway between DVL samples, where the process noise shows
        uint64_t look_us = start_us + 1100000;
        Sum over_time;
        for (; t_us <= end_us; t_us += 10000 + generator() % 20001) {
            move();
            for (int s = 0; s < 4; ++s) {
                sample(s);
            }
            if (t_us >= look_us) {
                double e = nees(nav, truth);
                size_t k = size_t((look_us - start_us) / 1000000) - 1;
                result->nees_at.resize(std::max(result->nees_at.size(), k + 1));
                result->nees_at[k].add(e);
                over_time.add(e);
                look_us += 1000000;
            }
        }
        result->nees_of_run.add(over_time.mean());
    }

  private:
    std::mt19937_64 generator;
    std::normal_distribution<double> normal{0, 1};
    Result *result;
    auvid_nav_config_t c;
    auvid_nav_t nav;
    Vector3d q;
    Vector6d truth;
    double phase[6];
    uint64_t t_us = 1000000, last_us = 0, due[4] = {1000001, 0, 1000001, 1000001};

    void move()
    {
        double time = 1e-6 * double(t_us);
        auvid_real_t attitude[3], rates[3] = {0, 0, 0};
        for (int i = 0; i < 3; ++i) {
            double size = i < 2 ? 0.5 : 3.0;
            attitude[i] = auvid_real_t(size * std::sin((0.3 + 0.2 * i) * time + phase[i]));
        }
        if (last_us > 0) { // Eq. 5
            double t = 1e-6 * double(t_us - last_us);
            Vector3d n;
            for (int i = 0; i < 3; ++i) {
                n[i] = std::sqrt(q[i] / t) * normal(generator);
            }
            truth.head<3>() += rotation(attitude) * (truth.tail<3>() * t + n * t * t / 2);
            truth.tail<3>() += n * t;
        }
        last_us = t_us;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, t_us, attitude, rates));
    }

    void sample(int s)
    {
        static const uint64_t period[4] = {200000, 0, 100000, 1000000};
        if (period[s] == 0 || t_us < due[s]) {
            return;
        }
        due[s] += period[s];
        bool sets_only = s == AUVID_NAV_DEPTH && nav.diagnostics[s].accepted == 0;
        auvid_status_t status;
        if (s == AUVID_NAV_DEPTH) {
            status = auvid_nav_depth(&nav, t_us, measured(2, c.sigma_depth));
        } else if (s == AUVID_NAV_GPS) {
            auvid_real_t x = measured(0, c.sigma_gps), y = measured(1, c.sigma_gps);
            status = auvid_nav_gps(&nav, t_us, x, y);
        } else {
            auvid_dvl_sample_t d = {t_us, {0, 0, 0}, AUVID_DVL_BOTTOM, AUVID_DVL_ALL};
            for (int i = 0; i < 3; ++i) {
                d.velocity[i] = measured(3 + i, c.sigma_dvl);
            }
            status = auvid_nav_dvl(&nav, &d);
        }
        TEST_ASSERT_EQUAL_INT(AUVID_OK, status);
        if (!sets_only) { // the first depth sets the state and is no test of it
            result->nis[s].add(nav.diagnostics[s].nis);
        }
    }

    auvid_real_t measured(int i, auvid_real_t sigma)
    {
        return auvid_real_t(truth[i] + double(sigma) * normal(generator));
    }
};

static Result campaign(double belief)
{
    Result result;
    for (int i = 0; i < runs; ++i) {
        Run(1000u + unsigned(i), belief, &result).go();
    }
    return result;
}

// Is the mean of n chi-square variables of k degrees of freedom inside its 95 % band? n k is large
// enough for the normal approximation.
static bool in_band(const char *what, double mean, double k, long n)
{
    double half = 1.96 * std::sqrt(2 * k / double(n));
    std::printf("%s: mean %.4f, 95 %% band %.4f .. %.4f (n = %ld)\n", what, mean, k - half,
                k + half, n);
    return std::abs(mean - k) <= half;
}

static void test_nees_is_that_of_a_consistent_filter()
{
    Result r = campaign(1);
    double mean = r.nees_of_run.mean();
    // the runs are independent, the instants of one run are not: interval from the runs' spread
    double half = 1.984 * r.nees_of_run.standard_error();
    std::printf("NEES averaged over time and %d runs: %.3f +- %.3f (95 %%)\n", runs, mean, half);
    TEST_ASSERT_DOUBLE_WITHIN(half, 6, mean);
    // and at each second over the runs: 95 % of the instants within the band of all runs
    int inside = 0;
    double band = 1.96 * std::sqrt(2 * 6.0 / runs);
    for (const Sum &s : r.nees_at) {
        inside += std::abs(s.mean() - 6) <= band;
    }
    std::printf("instants within 6 +- %.3f: %d of %d\n", band, inside, int(r.nees_at.size()));
    TEST_ASSERT_TRUE(inside >= 53); // of 59; 56 expected, fewer than 53 by chance in 3 % of seeds
}

static void test_nis_is_that_of_a_consistent_filter()
{
    Result r = campaign(1);
    TEST_ASSERT_TRUE(in_band("NIS, DVL", r.nis[0].mean(), 3, r.nis[0].n));
    TEST_ASSERT_TRUE(in_band("NIS, depth", r.nis[2].mean(), 1, r.nis[2].n));
    TEST_ASSERT_TRUE(in_band("NIS, GPS", r.nis[3].mean(), 2, r.nis[3].n));
}

// The bands are narrow enough to detect a filter that is wrong by a fifth.
static void test_a_filter_with_wrong_process_noise_is_detected()
{
    for (double belief : {0.8, 1.25}) {
        Result r = campaign(belief);
        double half = 1.984 * r.nees_of_run.standard_error();
        std::printf("NEES, wrong belief: %.3f +- %.3f\n", r.nees_of_run.mean(), half);
        TEST_ASSERT_TRUE(std::abs(r.nees_of_run.mean() - 6) > half);
        TEST_ASSERT_FALSE(in_band("NIS, DVL, wrong belief", r.nis[0].mean(), 3, r.nis[0].n));
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_nees_is_that_of_a_consistent_filter);
    RUN_TEST(test_nis_is_that_of_a_consistent_filter);
    RUN_TEST(test_a_filter_with_wrong_process_noise_is_detected);
    return UNITY_END();
}
