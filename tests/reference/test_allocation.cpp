// Allocation against Eigen in double: the pseudo-inverse against CompleteOrthogonalDecomposition,
// the actuated degrees of freedom against the projector onto the range, saturation against a
// straightforward search.
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "auvid/allocation.h"

extern "C" {
#include "unity.h"
}

using Eigen::MatrixXd;
using Eigen::VectorXd;

static std::mt19937_64 generator;

void setUp()
{
    generator.seed(20130613);
}

void tearDown()
{
}

static double uniform(double low, double high)
{
    return std::uniform_real_distribution<double>(low, high)(generator);
}

// Entries as auvid_real_t holds them, so that both sides invert the same matrix.
static MatrixXd rounded(const MatrixXd &m)
{
    return m.unaryExpr([](double x) { return double(auvid_real_t(x)); });
}

static MatrixXd random_matrix(int rows, int columns)
{
    return rounded(MatrixXd::NullaryExpr(rows, columns, [] { return uniform(-1, 1); }));
}

static auvid_allocation_t initialised(const MatrixXd &t)
{
    auvid_allocation_config_t cfg;
    auvid_allocation_t a;
    auvid_allocation_defaults(&cfg);
    cfg.thrusters = uint8_t(t.cols());
    for (int j = 0; j < t.cols(); ++j) {
        for (int i = 0; i < 6; ++i) {
            cfg.thruster[j].wrench[i] = auvid_real_t(t(i, j));
        }
        cfg.thruster[j].min_N = auvid_real_t(-uniform(5, 100));
        cfg.thruster[j].max_N = auvid_real_t(uniform(5, 100));
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_allocation_init(&a, &cfg));
    return a;
}

static MatrixXd inverse_of(const auvid_allocation_t &a)
{
    MatrixXd m(a.cfg.thrusters, 6);
    for (int j = 0; j < m.rows(); ++j) {
        for (int i = 0; i < 6; ++i) {
            m(j, i) = double(a.inverse[j][i]);
        }
    }
    return m;
}

static Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposed(const MatrixXd &t)
{
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> cod;
    cod.setThreshold(1e-4);
    cod.compute(t);
    return cod;
}

// Ratio of the largest to the smallest singular value that counts.
static double condition(const MatrixXd &t, int rank)
{
    VectorXd s = Eigen::JacobiSVD<MatrixXd>(t).singularValues();
    return s(0) / s(rank - 1);
}

static double relative_error(const MatrixXd &t, const auvid_allocation_t &a)
{
    MatrixXd expected = decomposed(t).pseudoInverse();
    return (inverse_of(a) - expected).norm() / expected.norm();
}

static void test_pseudo_inverse_is_eigens_within_1e_5_on_random_matrices()
{
    int compared = 0;
    double worst = 0, worst_in_eps = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        int n = 1 + trial % AUVID_MAX_THRUSTERS;
        MatrixXd t = random_matrix(6, n);
        double k = condition(t, std::min(6, n));
        if (k > 200) { // of a measured T it is below 20
            continue;
        }
        double error = relative_error(t, initialised(t));
        worst_in_eps = std::max(worst_in_eps, error / (k * AUVID_EPSILON));
        if (k <= 50) {
            worst = std::max(worst, error);
            ++compared;
        }
    }
    TEST_ASSERT_TRUE(compared > 3000);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, worst);
    TEST_ASSERT_DOUBLE_WITHIN(4.0, 0.0, worst_in_eps); // error <= 4 epsilon condition
}

static void test_pseudo_inverse_is_eigens_on_matrices_of_lower_rank()
{
    int compared = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        int n = 2 + trial % (AUVID_MAX_THRUSTERS - 1);
        int rank = 1 + (trial / 16) % std::min(5, n - 1);
        MatrixXd t = rounded(random_matrix(6, rank) * random_matrix(rank, n));
        if (condition(t, rank) > 20) {
            continue;
        }
        auvid_allocation_t a = initialised(t);
        TEST_ASSERT_EQUAL_INT(rank, a.rank);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0.0, relative_error(t, a));
        ++compared;
    }
    TEST_ASSERT_TRUE(compared > 1500);
}

// Some rows of T zero, some a multiple of another: what is actuated is what the projector says.
static void test_actuated_dofs_are_those_in_the_range()
{
    for (int trial = 0; trial < 2000; ++trial) {
        int n = 3 + trial % (AUVID_MAX_THRUSTERS - 2);
        MatrixXd t = random_matrix(6, n);
        t.row(trial % 6).setZero();
        t.row((trial / 6) % 6) = rounded(0.3 * t.row((trial / 36) % 6));
        if (t.norm() == 0 || condition(t, int(decomposed(t).rank())) > 100) {
            continue;
        }
        auvid_allocation_t a = initialised(t);
        MatrixXd projector = t * decomposed(t).pseudoInverse();
        for (int i = 0; i < 6; ++i) {
            bool in_range = projector(i, i) > 0.9999;
            if (!in_range && projector(i, i) > 0.99) {
                continue; // by chance nearly in it
            }
            TEST_ASSERT_EQUAL_INT(in_range, (a.actuated >> i) & 1);
        }
    }
}

// The range of k in 0..1 with low <= base + k f <= high.
static std::pair<double, double> range_of_scale(const auvid_allocation_t &a, const VectorXd &base,
                                                const VectorXd &f)
{
    std::pair<double, double> range(0, 1);
    for (int j = 0; j < f.size(); ++j) {
        double k[2] = {(double(a.cfg.thruster[j].min_N) - base(j)) / f(j),
                       (double(a.cfg.thruster[j].max_N) - base(j)) / f(j)};
        range.first = std::max(range.first, std::min(k[0], k[1]));
        range.second = std::min(range.second, std::max(k[0], k[1]));
    }
    return range;
}

// The largest scale in 0..1 of `first` that leaves a range for that of `rest`, by bisection.
static double largest_first(const auvid_allocation_t &a, const VectorXd &first,
                            const VectorXd &rest)
{
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
        double k = i == 0 ? 1 : 0.5 * (low + high);
        auto range = range_of_scale(a, k * first, rest);
        (range.first <= range.second ? low : high) = k;
        if (low == high) {
            break;
        }
    }
    return low;
}

static void test_saturation_is_the_largest_scale_with_yaw_first()
{
    int saturated = 0, helped = 0;
    for (int trial = 0; trial < 4000; ++trial) {
        MatrixXd t = random_matrix(6, std::max(6, AUVID_MAX_THRUSTERS));
        if (condition(t, 6) > 20) {
            continue;
        }
        auvid_allocation_t a = initialised(t);
        VectorXd wrench = VectorXd::NullaryExpr(6, [] { return uniform(-60, 60); });
        auvid_real_t asked[6];
        for (int i = 0; i < 6; ++i) {
            asked[i] = auvid_real_t(wrench(i));
        }
        auvid_allocation_result_t out;
        auvid_status_t status = auvid_allocation_solve(&a, asked, &out);

        MatrixXd inverse = decomposed(t).pseudoInverse();
        VectorXd yaw = inverse.col(5) * wrench(5), rest = inverse * wrench - yaw;
        double first = largest_first(a, yaw, rest);
        double second = range_of_scale(a, first * yaw, rest).second;
        VectorXd force = first * yaw + second * rest, applied = t * force;
        TEST_ASSERT_EQUAL_INT(first < 1 || second < 1 ? AUVID_SATURATED : AUVID_OK, status);
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, first, double(out.scale_priority));
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, second, double(out.scale));
        for (int i = 0; i < 6; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN(0.02, applied(i), double(out.wrench[i]));
        }
        saturated += status == AUVID_SATURATED;
        helped += first > range_of_scale(a, VectorXd::Zero(yaw.size()), yaw).second + 1e-3;
    }
    TEST_ASSERT_TRUE(saturated > 500);
    TEST_ASSERT_TRUE(helped > 20); // yaw alone would be scaled more
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_pseudo_inverse_is_eigens_within_1e_5_on_random_matrices);
    RUN_TEST(test_pseudo_inverse_is_eigens_on_matrices_of_lower_rank);
    RUN_TEST(test_actuated_dofs_are_those_in_the_range);
    RUN_TEST(test_saturation_is_the_largest_scale_with_yaw_first);
    return UNITY_END();
}
