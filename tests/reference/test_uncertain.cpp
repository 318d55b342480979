// The solution with uncertain inputs against normal equations in double (Eigen). The reference
// reads the R factors of each band, and knows the equations of auvid_uncertain_solve.c, but
// eliminates nothing: all inputs of all degrees of freedom and all parameters are unknowns of one
// system, and Gauss-Newton runs until it has converged.
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

extern "C" {
#include "field/field_run.h"
#include "unity.h"

// auvid_uncertain_parts_internal.h, which is C
auvid_real_t auvid_uncertain_sigma(const auvid_uncertain_t *u, const auvid_metric_t *m, int code,
                                   int j);
void auvid_uncertain_begin(auvid_uncertain_t *u);
auvid_status_t auvid_uncertain_solve(auvid_uncertain_t *u, const auvid_metric_t *m,
                                     uint32_t *budget);
}

enum { INPUT_DELAY = AUVID_UNCERTAIN_SHARED, INPUT_ASYMMETRY };

using Eigen::Matrix2d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

static field_run_t run;
static field_run_config_t config;
static field_record_t record;

void setUp()
{
}

void tearDown()
{
}

namespace
{

enum { PARAMETERS = 13, PASSES = 30 };

// The joint system: shared inputs, parameters, then the own inputs of all degrees of freedom.
struct Reference {
    const auvid_uncertain_t &u = run.uncertain;
    const auvid_metric_t &m = run.id.metric;
    int n = AUVID_UNCERTAIN_SHARED + PARAMETERS + AUVID_UNCERTAIN_OWN;
    VectorXd x = VectorXd::Zero(n);
    double least = 1.0, most = 1.0; // part of the thrust that is delivered, of all equations
    double smallest_part = 1.0;     // of the residual that accelerates
    MatrixXd normal;

    MatrixXd band(int j, int b) const
    {
        const auvid_uncertain_equation_t &e = u.equation[j];
        MatrixXd r = MatrixXd::Zero(e.order, e.order);
        const auvid_real_t *from = u.factor[b] + e.factor_at;
        for (int i = 0; i < e.order; ++i) {
            for (int k = i; k < e.order; ++k) {
                r(i, k) = double(*from++);
            }
        }
        return r;
    }

    int code(int j, int k) const
    {
        return u.code[u.equation[j].channel_at + k];
    }

    // Where column k of DoF j is among the unknowns.
    int unknown(int j, int k) const
    {
        const auvid_uncertain_equation_t &e = u.equation[j];
        if (k < e.own) {
            return AUVID_UNCERTAIN_SHARED + PARAMETERS + e.own_at + k;
        }
        return k < e.inputs
                   ? code(j, k)
                   : AUVID_UNCERTAIN_SHARED + m.layout.index[m.layout.channel_at[j] + k - e.inputs];
    }

    int mass(int j) const
    {
        return j == AUVID_YAW ? SIM_M_R : SIM_M_U + j;
    }

    // The first of a DoF's two parameters of drag.
    int drag(int j) const
    {
        static const int first[] = {SIM_X_U, SIM_Y_V, SIM_Z_W, 0, 0, SIM_N_R};
        return first[j];
    }

    // Products of both drags with a column, of early rows that are forgotten.
    Vector2d forgotten(int at) const
    {
        return Vector2d(double(u.forgotten[0][at]), double(u.forgotten[1][at]));
    }

    // Columns with the inputs of hull and weight orthogonal to the drag of the DoF, over all rows.
    MatrixXd columns(int j, const MatrixXd &r) const
    {
        const auvid_uncertain_equation_t &e = u.equation[j];
        MatrixXd all(2 * e.order, e.order), d(2 * e.order, 2), out = r;
        all << band(j, 0), band(j, 1);
        MatrixXd chosen(r.rows(), 2);
        for (int k = e.inputs; k < e.order - 1; ++k) {
            int p = unknown(j, k) - AUVID_UNCERTAIN_SHARED - drag(j);
            if (p == 0 || p == 1) {
                d.col(p) = all.col(k);
                chosen.col(p) = r.col(k);
            }
        }
        Matrix2d dd = d.transpose() * d;
        for (int p = 0; p < 2; ++p) {
            dd.col(p) += forgotten(AUVID_UNCERTAIN_OWN + 2 * j + p);
        }
        for (int k = 0; k < e.inputs; ++k) {
            if (code(j, k) >= INPUT_ASYMMETRY) {
                Vector2d dc = d.transpose() * all.col(k) + forgotten(e.own_at + k);
                out.col(k) -= chosen * dd.ldlt().solve(dc);
            }
        }
        return out;
    }

    // Where a unit of the residual is: in the acceleration, in the velocity, and what that adds to
    // the columns of linear and quadratic drag.
    struct Shares {
        double accelerates, moves;
        Vector2d drag;
    };

    Shares shares(int j, const double squares[2], const MatrixXd &first, const MatrixXd &second)
    {
        int linear = 0;
        while (unknown(j, linear) != AUVID_UNCERTAIN_SHARED + drag(j)) {
            ++linear;
        }
        double speed =
            std::sqrt((first.col(linear).squaredNorm() + second.col(linear).squaredNorm()) /
                      double(u.rows[j]));
        double force_per_speed = -x(AUVID_UNCERTAIN_SHARED + drag(j)) -
                                 2.0 * speed * x(AUVID_UNCERTAIN_SHARED + drag(j) + 1);
        double between_s = 1e-6 * (m.cfg.cell_us << m.result.doublings) * m.cfg.row_cells *
                           m.cfg.lag[j == AUVID_YAW];
        double bandwidth = 2.0 * squares[1] / squares[0] / between_s; // [rad/s]
        double m_j = x(AUVID_UNCERTAIN_SHARED + mass(j));
        if (!(m_j > 0.0)) { // in an early pass
            return {0.7, 0.0, Vector2d::Zero()};
        }
        double part = std::sqrt(bandwidth / (bandwidth + std::abs(force_per_speed) / m_j));
        double moves = j == AUVID_YAW || force_per_speed < 0.0 ? 0.0 : 0.5 * (1.0 - part);
        smallest_part = std::min(smallest_part, part);
        // the columns are -v and -v |v|; the noise e moves the vehicle by -e / force_per_speed
        return {0.7 * part, moves, -moves / force_per_speed * Vector2d(1.0, 2.0 * speed)};
    }

    void add(int j, VectorXd &right)
    {
        const auvid_uncertain_equation_t &e = u.equation[j];
        int cols = e.order - 1;
        VectorXd theta(cols);
        for (int k = 0; k < cols; ++k) {
            theta(k) = x(unknown(j, k));
        }
        MatrixXd c[2];
        VectorXd residual[2];
        double squares[2];
        for (int b = 0; b < 2; ++b) {
            c[b] = columns(j, band(j, b));
            residual[b] = c[b].col(cols) - c[b].leftCols(cols) * theta;
            squares[b] = residual[b].squaredNorm();
        }
        double ratio = squares[1] / squares[0], weight[2] = {ratio, 1.0 / ratio};
        double s2 = 2.6 * (weight[0] * squares[0] + weight[1] * squares[1]) / double(u.rows[j]);
        double zz =
            weight[0] * c[0].col(cols).squaredNorm() + weight[1] * c[1].col(cols).squaredNorm();
        double m_j = x(AUVID_UNCERTAIN_SHARED + mass(j));
        Shares of = shares(j, squares, c[0], c[1]);
        MatrixXd jacobian[2] = {c[0].leftCols(cols), c[1].leftCols(cols)};
        VectorXd part = VectorXd::Zero(cols); // of the thrust, each column that is formed from it
        for (int k = 0; k < e.inputs; ++k) {
            if (code(j, k) <= AUVID_UNCERTAIN_LAG ||
                (code(j, k) >= AUVID_UNCERTAIN_DVL_LATE && code(j, k) <= INPUT_DELAY)) {
                part(k) = (weight[0] * c[0].col(k).dot(c[0].col(cols)) +
                           weight[1] * c[1].col(k).dot(c[1].col(cols))) /
                          zz;
            }
        }
        double delivered = 1.0 - part.dot(theta);
        double rows = double(u.rows[j]) / 2.6, d = std::max(delivered, 0.5);
        double pull = (1.0 - d / std::min(d / 0.9, 1.0)) * std::min(150.0 / rows, 1.0);
        double gamma = delivered > 1.0 ? delivered : d / (1.0 - pull);
        least = std::min(least, delivered);
        most = std::max(most, delivered);
        for (int k = 0; k < cols; ++k) {
            double share = 0.0;
            int parameter = unknown(j, k) - AUVID_UNCERTAIN_SHARED;
            if (k < e.inputs && code(j, k) != AUVID_UNCERTAIN_INFLOW &&
                code(j, k) != AUVID_UNCERTAIN_BILINEAR) {
                share = -(1.0 - of.accelerates - of.moves) * part(k) / gamma;
            } else if (k >= e.inputs && parameter == mass(j)) {
                share = m_j > 0.0 ? of.accelerates / m_j : 0.0;
            } else if (k >= e.inputs && (parameter == drag(j) || parameter == drag(j) + 1)) {
                share = of.drag(parameter - drag(j));
            }
            for (int b = 0; b < 2; ++b) {
                jacobian[b].col(k) += share * residual[b];
            }
        }
        for (int b = 0; b < 2; ++b) {
            MatrixXd wide = MatrixXd::Zero(e.order, n);
            for (int k = 0; k < cols; ++k) {
                wide.col(unknown(j, k)) += jacobian[b].col(k);
            }
            normal += weight[b] / s2 * wide.transpose() * wide;
            right += weight[b] / s2 * wide.transpose() * residual[b];
        }
        for (int k = 0; k < e.own; ++k) {
            double sigma = std::max(double(auvid_uncertain_sigma(&u, &m, code(j, k), j)), 1e-6);
            normal(unknown(j, k), unknown(j, k)) += 1.0 / (sigma * sigma);
            right(unknown(j, k)) -= x(unknown(j, k)) / (sigma * sigma);
        }
    }

    void solve()
    {
        for (int i = 0; i < PARAMETERS; ++i) {
            x(AUVID_UNCERTAIN_SHARED + i) = double(run.id.estimate.pi[i]);
        }
        for (int pass = 0; pass < PASSES; ++pass) {
            VectorXd right = VectorXd::Zero(n);
            normal = 1e-12 * MatrixXd::Identity(n, n);
            for (int k = 0; k < AUVID_UNCERTAIN_SHARED; ++k) {
                double sigma = double(auvid_uncertain_sigma(&u, &m, k, 0));
                normal(k, k) += 1.0 / (sigma * sigma);
                right(k) -= x(k) / (sigma * sigma);
            }
            for (int j : {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW}) {
                add(j, right);
            }
            VectorXd scale = normal.diagonal().cwiseSqrt().cwiseInverse();
            MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
            x += scale.asDiagonal() * scaled.ldlt().solve(VectorXd(scale.asDiagonal() * right));
        }
    }
};

void identify(field_vehicle_t vehicle, uint64_t seed, const char *changed, double value)
{
    field_run_defaults(&config);
    field_defaults(&config.field, vehicle, FIELD_EXCITED, seed);
    field_draw(&config.field, 0.3);
    TEST_ASSERT_TRUE(changed == nullptr || field_set(&config.field, changed, value));
    config.budget = 1000000; // the solution is complete before the next cell
    TEST_ASSERT_TRUE(field_run(&run, &config, &record));
    TEST_ASSERT_TRUE(run.uncertain.estimate.number > 0);
}

Reference compare()
{
    Reference reference;
    reference.solve();
    for (int i = 0; i < PARAMETERS; ++i) {
        double expected = reference.x(AUVID_UNCERTAIN_SHARED + i);
        double sigma = double(run.uncertain.estimate.confidence.sigma[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * sigma, expected, double(run.uncertain.pi[i]));
    }
    for (int k = 0; k < AUVID_UNCERTAIN_SHARED; ++k) {
        double sigma = double(auvid_uncertain_sigma(&run.uncertain, &run.id.metric, k, 0));
        TEST_ASSERT_DOUBLE_WITHIN(0.1 * sigma, reference.x(k), double(run.uncertain.shared[k]));
    }
    return reference;
}

Reference check(field_vehicle_t vehicle, uint64_t seed, const char *changed = nullptr,
                double value = 0.0)
{
    identify(vehicle, seed, changed, value);
    return compare();
}

void test_the_solution_is_that_of_the_joint_normal_equations()
{
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        check(FIELD_GIRONA500, seed);
        check(FIELD_ROV20, seed);
    }
}

// Thrust that is much weaker or stronger than supplied: gamma is not 1.
void test_so_it_is_where_much_of_the_thrust_is_not_delivered_or_more_than_all()
{
    for (field_vehicle_t vehicle : {FIELD_GIRONA500, FIELD_ROV20}) {
        double least = check(vehicle, 1, "thrust_exponent", 0.15).least,
               most = check(vehicle, 1, "thrust_exponent", -0.12).most;
        printf("part of the thrust that is delivered: %.2f, %.2f\n", least, most);
        TEST_ASSERT_TRUE(least < 0.87 && most > 1.05);
    }
}

// Waves move a quick vehicle more than they accelerate it.
void test_so_it_is_of_a_quick_vehicle_in_waves()
{
    for (uint64_t seed = 5; seed <= 8; ++seed) {
        double part = check(FIELD_ROV20, seed, "waves", 20.0).smallest_part;
        printf("part that accelerates: %.2f\n", part);
        TEST_ASSERT_TRUE(part < 0.75);
    }
}

// The same rows, as if their cells were longer.
void test_so_it_is_with_longer_cells()
{
    double part = check(FIELD_ROV20, 5, "waves", 20.0).smallest_part;
    run.id.metric.result.doublings = 1;
    for (int pass = 0; pass < PASSES; ++pass) {
        uint32_t budget = 100000000;
        auvid_uncertain_begin(&run.uncertain);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_solve(&run.uncertain, &run.id.metric, &budget));
    }
    double longer = compare().smallest_part;
    printf("part that accelerates: %.2f; if the cells were longer: %.2f\n", part, longer);
    TEST_ASSERT_TRUE(longer < 0.9 * part);
}

} // namespace

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_the_solution_is_that_of_the_joint_normal_equations);
    RUN_TEST(test_so_it_is_of_a_quick_vehicle_in_waves);
    RUN_TEST(test_so_it_is_with_longer_cells);
    RUN_TEST(test_so_it_is_where_much_of_the_thrust_is_not_delivered_or_more_than_all);
    return UNITY_END();
}
