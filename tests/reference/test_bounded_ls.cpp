// Least squares within bounds, compared with Eigen in double: the feasible active set of minimum
// cost; if there are too many active sets, the conditions of an optimum.
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

extern "C" {
#include "search/auvid_bounded_ls_internal.h"
#include "unity.h"
}

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

static std::mt19937_64 rng;

void setUp()
{
    rng.seed(1);
}

void tearDown()
{
}

static double gauss()
{
    return std::normal_distribution<double>()(rng);
}

static double uniform(double low, double high)
{
    return std::uniform_real_distribution<double>(low, high)(rng);
}

struct Problem {
    Matrix a;
    Vector b, lower, upper, start;
    Problem(int rows, int n) : a(rows, n), b(rows), lower(n), upper(n), start(n)
    {
        for (int i = 0; i < rows; ++i) {
            for (int j = 0; j < n; ++j) {
                a(i, j) = double(float(gauss()));
            }
            b(i) = double(float(3 * gauss()));
        }
        for (int j = 0; j < n; ++j) {
            lower(j) = double(float(uniform(-1, 0.2)));
            upper(j) = double(float(lower(j) + uniform(0.05, 1)));
            double at = uniform(-0.3, 1.3); // some at their bounds
            start(j) = std::clamp(double(float(lower(j) + at * (upper(j) - lower(j)))), lower(j),
                                  upper(j));
        }
    }
    int n() const
    {
        return int(a.cols());
    }
    double cost(const Vector &x) const
    {
        return (a * x - b).squaredNorm();
    }
    // Similar columns: condition number of about 1 / part.
    void tilt(double part)
    {
        for (int j = 1; j < n(); ++j) {
            a.col(j) = (a.col(0) + part * a.col(j)).cast<float>().cast<double>();
        }
    }
};

static auvid_bounded_ls_t ls;

// Costs and result of the library.
static Vector solve(const Problem &p, auvid_status_t expected = AUVID_OK)
{
    auvid_real_t row[AUVID_MAX_PARAMETERS + 1];
    auvid_bounded_ls_begin(&ls, p.n());
    for (int j = 0; j < p.n(); ++j) {
        ls.lower[j] = auvid_real_t(p.lower(j));
        ls.upper[j] = auvid_real_t(p.upper(j));
        ls.x[j] = auvid_real_t(p.start(j));
    }
    for (int i = 0; i < p.a.rows(); ++i) {
        for (int j = 0; j < p.n(); ++j) {
            row[j] = auvid_real_t(p.a(i, j));
        }
        row[p.n()] = auvid_real_t(p.b(i));
        auvid_bounded_ls_add(&ls, row);
    }
    int steps = 0;
    auvid_status_t status = AUVID_PENDING;
    while (status == AUVID_PENDING) {
        status = auvid_bounded_ls_step(&ls, 0);
        TEST_ASSERT_TRUE(++steps <= 4 * (p.n() + 1) * (p.n() + 2));
    }
    TEST_ASSERT_EQUAL(expected, status);
    Vector x(p.n());
    for (int j = 0; j < p.n(); ++j) {
        x(j) = double(ls.x[j]);
        TEST_ASSERT_TRUE(ls.x[j] >= ls.lower[j] && ls.x[j] <= ls.upper[j]);
    }
    return x;
}

// Minimum cost over all 3^n active sets.
static double minimum_cost(const Problem &p)
{
    double minimum = std::numeric_limits<double>::infinity();
    int ways = int(std::lround(std::pow(3, p.n())));
    for (int way = 0; way < ways; ++way) {
        Vector x = p.lower;
        std::vector<int> free;
        for (int j = 0, w = way; j < p.n(); ++j, w /= 3) {
            x(j) = w % 3 == 0 ? p.lower(j) : w % 3 == 1 ? p.upper(j) : 0;
            if (w % 3 == 2) {
                free.push_back(j);
            }
        }
        if (!free.empty()) {
            Matrix part(p.a.rows(), long(free.size()));
            for (size_t k = 0; k < free.size(); ++k) {
                part.col(long(k)) = p.a.col(free[k]);
            }
            Vector found = part.completeOrthogonalDecomposition().solve(p.b - p.a * x);
            for (size_t k = 0; k < free.size(); ++k) {
                x(free[k]) = found(long(k));
            }
        }
        bool feasible = true;
        for (int j = 0; j < p.n(); ++j) {
            feasible = feasible && x(j) >= p.lower(j) - 1e-12 && x(j) <= p.upper(j) + 1e-12;
        }
        minimum = feasible ? std::min(minimum, p.cost(x)) : minimum;
    }
    return minimum;
}

static void test_the_least_cost_of_all_active_sets_is_found()
{
    double worst = 0;
    int max_changes = 0;
    for (int k = 0; k < 400; ++k) {
        Problem p(12, 1 + k % 6);
        if (k % 2 == 1) {
            p.tilt(0.01);
        }
        double minimum = minimum_cost(p), cost = p.cost(solve(p));
        worst = std::max(worst, cost / minimum - 1);
        max_changes = std::max(max_changes, int(ls.changes));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * minimum, minimum, double(ls.cost));
    }
    std::printf("largest excess %.1e, most changes of the active set %d\n", worst, max_changes);
    TEST_ASSERT_TRUE(worst < 1e-5);
}

// For a convex cost, a point is the optimum if no parameter that may move lowers the cost. By
// duality the cost exceeds the minimum by at most sum |slope| x room.
static void test_many_parameters_satisfy_the_conditions_of_an_optimum()
{
    double worst = 0;
    int max_changes = 0;
    for (int k = 0; k < 200; ++k) {
        Problem p(3 * AUVID_MAX_PARAMETERS, AUVID_MAX_PARAMETERS);
        if (k % 2 == 1) {
            p.tilt(0.03);
        }
        Vector x = solve(p), slope = 2 * p.a.transpose() * (p.a * x - p.b);
        double gap = 0;
        for (int j = 0; j < p.n(); ++j) {
            gap += std::max(slope(j) * (x(j) - p.lower(j)), slope(j) * (x(j) - p.upper(j)));
        }
        worst = std::max(worst, gap / p.cost(x));
        max_changes = std::max(max_changes, int(ls.changes));
    }
    std::printf("largest duality gap %.1e of the cost, most changes %d\n", worst, max_changes);
    TEST_ASSERT_TRUE(worst < 1e-3);
}

static void test_without_a_bound_in_the_way_the_answer_is_that_of_qr()
{
    for (int k = 0; k < 100; ++k) {
        Problem p(60, AUVID_MAX_PARAMETERS);
        p.lower.setConstant(-100);
        p.upper.setConstant(100);
        Vector expected = p.a.householderQr().solve(p.b), x = solve(p);
        TEST_ASSERT_TRUE((x - expected).norm() < 1e-4 * (1 + expected.norm()));
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_the_least_cost_of_all_active_sets_is_found);
    RUN_TEST(test_many_parameters_satisfy_the_conditions_of_an_optimum);
    RUN_TEST(test_without_a_bound_in_the_way_the_answer_is_that_of_qr);
    return UNITY_END();
}
