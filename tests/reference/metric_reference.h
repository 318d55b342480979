// The pipeline that the header of the metric describes, implemented in double with Eigen: no R
// factors, no transposed filters, all rows stored, every least-squares problem solved by QR. And
// the synthetic data for it.
#ifndef METRIC_REFERENCE_H
#define METRIC_REFERENCE_H

#include <Eigen/Dense>

#include <cmath>
#include <cstdint>
#include <vector>

extern "C" {
#include "auvid/detail/metric.h"
#include "unity.h"
}

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

static const double eps = double(AUVID_EPSILON), pi_ = 3.14159265358979323846;
// Half a unit of the largest entry of a stored column.
static const double stored = std::ldexp(1.0, 1 - 8 * int(sizeof(auvid_packed_t)));
static const int dofs[4] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};

// ---- synthetic data: smooth motion, wrench by Eq. 12-15 ----

struct Cell {
    double phi, theta, nu[6], nu_dot[6], tau[6];
};

// A sum of three sines and its derivative.
struct Wave {
    double a, f, shift;
    double at(double t) const
    {
        return a * (std::sin(2 * pi_ * f * t + shift) + 0.6 * std::sin(2 * pi_ * 2.3 * f * t + 1) +
                    0.4 * std::cos(2 * pi_ * 0.41 * f * t + 2 * shift));
    }
    double rate(double t) const
    {
        return a * 2 * pi_ * f *
               (std::cos(2 * pi_ * f * t + shift) + 1.38 * std::cos(2 * pi_ * 2.3 * f * t + 1) -
                0.164 * std::sin(2 * pi_ * 0.41 * f * t + 2 * shift));
    }
};

static const Wave wave[6] = {{0.4, 0.050, 0.3}, {0.2, 0.043, 1.1}, {0.15, 0.061, 2.0},
                             {0.02, 0.30, 0.5}, {0.03, 0.25, 1.7}, {0.25, 0.057, 0.9}};

// Small correlated noise that is reproducible.
struct Noise {
    uint32_t s;
    double uniform()
    {
        s = s * 1664525u + 1013904223u;
        return double(s >> 8) / 16777216.0 - 0.5;
    }
};

// The rows of Eq. 12-15 (Fossen's w p in Eq. 13), 17 columns.
static Matrix model_rows(double phi, double theta, const double *nu, const double *nu_dot)
{
    double u = nu[0], v = nu[1], w = nu[2], p = nu[3], q = nu[4], r = nu[5];
    Matrix y = Matrix::Zero(6, AUVID_G500_COUNT);
    y(0, AUVID_G500_M_U) = nu_dot[0];
    y(0, AUVID_G500_M_V) = -v * r;
    y(0, AUVID_G500_M_W) = w * q;
    y(0, AUVID_G500_W_B) = std::sin(theta);
    y(0, AUVID_G500_X_U) = -u;
    y(0, AUVID_G500_X_UU) = -std::fabs(u) * u;
    y(0, AUVID_G500_X_0) = -1;
    y(1, AUVID_G500_M_V) = nu_dot[1];
    y(1, AUVID_G500_M_W) = -w * p;
    y(1, AUVID_G500_M_U) = u * r;
    y(1, AUVID_G500_W_B) = -std::cos(theta) * std::sin(phi);
    y(1, AUVID_G500_Y_V) = -v;
    y(1, AUVID_G500_Y_VV) = -std::fabs(v) * v;
    y(1, AUVID_G500_Y_0) = -1;
    y(2, AUVID_G500_M_W) = nu_dot[2];
    y(2, AUVID_G500_M_U) = -u * q;
    y(2, AUVID_G500_M_V) = v * p;
    y(2, AUVID_G500_W_B) = -std::cos(theta) * std::cos(phi);
    y(2, AUVID_G500_Z_W) = -w;
    y(2, AUVID_G500_Z_WW) = -std::fabs(w) * w;
    y(2, AUVID_G500_Z_0) = -1;
    y(5, AUVID_G500_M_R) = nu_dot[5];
    y(5, AUVID_G500_M_U) = -u * v;
    y(5, AUVID_G500_M_V) = u * v;
    y(5, AUVID_G500_N_R) = -r;
    y(5, AUVID_G500_N_RR) = -std::fabs(r) * r;
    y(5, AUVID_G500_N_0) = -1;
    return y;
}

static Vector paper()
{
    Vector x(AUVID_G500_COUNT);
    for (int i = 0; i < AUVID_G500_COUNT; ++i) {
        x(i) = double(auvid_girona500_paper[i]);
    }
    return x;
}

static Vector wrench_at(double t, const Vector &x)
{
    double nu[6], nu_dot[6];
    for (int j = 0; j < 6; ++j) {
        nu[j] = wave[j].at(t);
        nu_dot[j] = wave[j].rate(t);
    }
    return model_rows(0.05 * std::sin(0.9 * t), 0.04 * std::cos(0.7 * t), nu, nu_dot) * x;
}

// Response to the command: delayed by `shift` seconds, or after a first-order lag of `lag` seconds.
// The command is computed from the response.
struct World {
    double shift = 0, lag = 0, noise = 0;
    bool fine_wrench = false; // noise on the wrench that changes sign from row to row
};

static std::vector<Cell> record(int cells, double cell_s, const World &world, double from = 0)
{
    std::vector<Cell> all;
    Vector x = paper();
    Noise noise{12345};
    double coloured[6] = {0};
    for (int k = 0; k < cells; ++k) {
        double t = from + k * cell_s, h = 1e-4;
        Cell c;
        c.phi = 0.05 * std::sin(0.9 * t);
        c.theta = 0.04 * std::cos(0.7 * t);
        Vector tau = wrench_at(t + world.shift, x) +
                     world.lag * (wrench_at(t + h, x) - wrench_at(t - h, x)) / (2 * h);
        for (int j = 0; j < 6; ++j) {
            coloured[j] = 0.95 * coloured[j] + world.noise * (j < 3 ? 2.0 : 0.8) * noise.uniform();
            c.nu[j] = wave[j].at(t) + world.noise * 0.003 * noise.uniform();
            c.nu_dot[j] = wave[j].rate(t) + world.noise * 0.02 * noise.uniform();
            c.tau[j] = tau(j) + coloured[j];
        }
        all.push_back(c);
    }
    return all;
}

// The library gets rounded numbers; the reference gets the same.
static void round_cell(Cell &c, auvid_sample_t *s)
{
    *s = auvid_sample_t();
    c.phi = s->phi = auvid_real_t(c.phi);
    c.theta = s->theta = auvid_real_t(c.theta);
    for (int j = 0; j < 6; ++j) {
        c.nu[j] = s->nu[j] = auvid_real_t(c.nu[j]);
        c.nu_dot[j] = s->nu_dot[j] = auvid_real_t(c.nu_dot[j]);
        c.tau[j] = s->tau[j] = auvid_real_t(c.tau[j]);
    }
}

// ---- the pipeline of detail/metric.h ----

static Vector savitzky_golay(int h, int order, int derivative, double dt)
{
    Matrix a(2 * h + 1, order + 1);
    for (int i = -h; i <= h; ++i) {
        for (int k = 0; k <= order; ++k) {
            a(i + h, k) = std::pow(double(i), k);
        }
    }
    Matrix inverse = a.householderQr().solve(Matrix::Identity(2 * h + 1, 2 * h + 1));
    return inverse.row(derivative).transpose() / std::pow(dt, derivative);
}

static Vector convolve(const Vector &a, const Vector &b)
{
    Vector c = Vector::Zero(a.size() + b.size() - 1);
    for (int i = 0; i < a.size(); ++i) {
        c.segment(i, b.size()) += a(i) * b;
    }
    return c;
}

static int taps_of(const auvid_metric_config_t &cfg)
{
    int widest = std::max(cfg.half_width[0], cfg.half_width[1]);
    return 2 * widest * cfg.passes + 1 + (cfg.velocity_us > 0 ? 2 : 0);
}

static Vector centred(const Vector &c, int taps)
{
    Vector wide = Vector::Zero(taps);
    wide.segment((taps - c.size()) / 2, c.size()) = c;
    return wide;
}

// Yaw has m_u and m_v in opposite columns: rounding must not restore the lost rank.
static Eigen::CompleteOrthogonalDecomposition<Matrix> solver(const Matrix &a)
{
    Eigen::CompleteOrthogonalDecomposition<Matrix> qr(a.rows(), a.cols());
    qr.setThreshold(1e-10);
    qr.compute(a);
    return qr;
}

static Vector delay_weights(double s, bool lag)
{
    double second = lag ? 2 * s * s : s * s; // sum l = 1, sum l d = s, sum l d^2 = second
    Eigen::Matrix3d moments;
    moments << 1, 1, 1, 0, 1, 2, 0, 1, 4;
    return moments.inverse() * Eigen::Vector3d(1, s, second);
}

// Rows of one DoF: free columns, then the wrench at three delays.
struct Rows {
    std::vector<Vector> row;
};

struct Reference {
    auvid_metric_config_t cfg;
    std::vector<int> column[6];
    std::vector<Rows> set_band[2]; // [band][set * 6 + dof]
    std::vector<int> set_rows;
    std::vector<unsigned> set_excited;
    std::vector<double> set_m2[6];
    unsigned excited = 0;
    int dof_rows[6] = {0};
    double weight[6] = {0}, delay[6] = {0}, constant = 0;
    double band_weight[2][6];
    bool lag[6] = {false}, literal = false;

    explicit Reference(const auvid_metric_config_t &c) : cfg(c)
    {
        uint32_t free = cfg.free == 0 ? ~0u : cfg.free;
        for (int j : dofs) {
            for (int i = 0; i < AUVID_G500_COUNT; ++i) {
                if (auvid_girona500.columns[j] & free & (1u << i)) {
                    column[j].push_back(i);
                }
            }
        }
        for (int j = 0; j < 6; ++j) {
            band_weight[0][j] = band_weight[1][j] = 1;
        }
    }

    double cell_s() const
    {
        return cfg.cell_us * 1e-6;
    }

    // One unbroken record of whole sets.
    void take(const std::vector<Cell> &cells)
    {
        const int late = AUVID_METRIC_DELAY_CELLS, warm = 2 * late;
        int taps = taps_of(cfg);
        Vector kernel[2], derivative, wrench_kernel[2];
        // interpolated velocity has passed a triangular filter of variance T^2 / 6; so must the
        // forces
        double period_s = 1e-6 * cfg.velocity_us, a = period_s * period_s / 12;
        a = std::min(a / (cell_s() * cell_s()), 0.5);
        Vector triangle(3);
        triangle << a, 1 - 2 * a, a;
        for (int k = 0; k < 2; ++k) {
            int order = literal ? 3 : 2;
            Vector once = savitzky_golay(cfg.half_width[k], order, 0, cell_s());
            Vector c = cfg.passes == 2 ? convolve(once, once) : once;
            kernel[k] = centred(c, taps);
            wrench_kernel[k] = k == 1 || literal ? kernel[k] : centred(convolve(c, triangle), taps);
            derivative = savitzky_golay(cfg.half_width[k], order, 1, cell_s());
        }
        std::vector<Vector> row[6];
        std::vector<double> tau[6];
        for (int begin = warm; begin + taps <= int(cells.size()); begin += cfg.row_cells) {
            for (int j : dofs) {
                int n = int(column[j].size());
                Vector r = Vector::Zero(n + 3);
                double smooth_tau = 0;
                Cell state = Cell();
                for (int i = 0; i < taps; ++i) {
                    const Cell &c = cells[begin + i];
                    double k = kernel[j >= 3](i);
                    if (literal) {
                        state.phi += k * c.phi;
                        state.theta += k * c.theta;
                        for (int a = 0; a < 6; ++a) {
                            state.nu[a] += k * c.nu[a];
                            state.nu_dot[a] += derivative(i) * c.nu[a];
                        }
                    } else {
                        const double *wrench[3] = {c.tau, cells[begin + i - late].tau,
                                                   cells[begin + i - 2 * late].tau};
                        double kw = wrench_kernel[j >= 3](i);
                        r += k * one_row(j, c, wrench);
                        for (int d = 0; d < 3; ++d) {
                            r(n + d) += (kw - k) * wrench[d][j];
                        }
                        smooth_tau += kw * c.tau[j];
                    }
                }
                if (literal) {
                    int middle = begin + taps / 2;
                    const double *wrench[3] = {cells[middle].tau, cells[middle - late].tau,
                                               cells[middle - 2 * late].tau};
                    r = one_row(j, state, wrench);
                    smooth_tau = cells[middle].tau[j];
                }
                row[j].push_back(r);
                tau[j].push_back(smooth_tau);
            }
        }
        int sets = int(row[0].size()) / cfg.set_rows;
        for (int s = 0; s < sets; ++s) {
            set_rows.push_back(cfg.set_rows);
            unsigned mask = 0;
            for (int band = 0; band < 2; ++band) {
                set_band[band].resize(set_band[band].size() + 6);
            }
            for (int j = 0; j < 6; ++j) {
                set_m2[j].push_back(0);
                if (row[j].empty()) {
                    continue;
                }
                Vector t = Eigen::Map<Vector>(&tau[j][s * cfg.set_rows], cfg.set_rows);
                double m2 = (t.array() - t.mean()).square().sum();
                set_m2[j].back() = m2;
                mask |= unsigned(
                            m2 >
                            std::pow(double(cfg.excitation_threshold) * double(cfg.tau_max[j]), 2) *
                                cfg.set_rows)
                        << j;
                int lag_rows = cfg.lag[j >= 3];
                for (int k = s * cfg.set_rows; k < (s + 1) * cfg.set_rows; ++k) {
                    if (k >= lag_rows) {
                        set_band[0].end()[-6 + j].row.push_back((row[j][k] + row[j][k - lag_rows]) /
                                                                2);
                        set_band[1].end()[-6 + j].row.push_back((row[j][k] - row[j][k - lag_rows]) /
                                                                2);
                    }
                }
            }
            set_excited.push_back(mask);
        }
    }

    Vector one_row(int j, const Cell &c, const double *const *wrench) const
    {
        Matrix y = model_rows(c.phi, c.theta, c.nu, c.nu_dot);
        int n = int(column[j].size());
        Vector r(n + 3);
        double known = 0;
        for (int i = 0, k = 0; i < AUVID_G500_COUNT; ++i) {
            if (k < n && column[j][k] == i) {
                r(k++) = y(j, i);
            } else {
                known += y(j, i) * double(cfg.fixed[i]);
            }
        }
        for (int d = 0; d < 3; ++d) {
            r(n + d) = wrench[d][j] - known;
        }
        return r;
    }

    // All rows of DoF j in the sets of the ring in which it is excited, times the bands' weights.
    Matrix stack(int j, double low, double high) const
    {
        std::vector<Vector> all;
        int sets = int(set_excited.size());
        for (int s = std::max(0, sets - cfg.sets); s < sets; ++s) {
            for (int band = 0; band < 2 && (set_excited[s] >> j & 1); ++band) {
                for (const Vector &r : set_band[band][s * 6 + j].row) {
                    all.push_back(r * std::sqrt(band == 0 ? low : high));
                }
            }
        }
        Matrix a(all.size(), column[j].size() + 3);
        for (size_t i = 0; i < all.size(); ++i) {
            a.row(i) = all[i].transpose();
        }
        return a;
    }

    Matrix stack(int j) const
    {
        return stack(j, band_weight[0][j], band_weight[1][j]);
    }

    double left(const Matrix &a, const Vector &l) const
    {
        int n = int(a.cols()) - 3;
        Vector z = a.rightCols(3) * l;
        Vector x = solver(a.leftCols(n)).solve(z);
        return (a.leftCols(n) * x - z).squaredNorm();
    }

    // E is a polynomial in s of degree four at most: search on a fine grid, then by golden section.
    double best(const Matrix &a, bool kind, double *smallest) const
    {
        int n = int(a.cols()) - 3;
        auto qr = solver(a.leftCols(n));
        Matrix t = a.rightCols(3) - a.leftCols(n) * qr.solve(a.rightCols(3));
        auto e = [&](double s) { return (t * delay_weights(s, kind)).squaredNorm(); };
        double at = 0;
        for (double s = 0; s <= 2.0 + 1e-9; s += 0.01) {
            at = e(s) < e(at) ? s : at;
        }
        double low = std::max(0.0, at - 0.01), high = std::min(2.0, at + 0.01);
        while (high - low > 1e-9) {
            double m = low + 0.382 * (high - low), k = low + 0.618 * (high - low);
            (e(m) < e(k) ? high : low) = e(m) < e(k) ? k : m;
        }
        *smallest = e(0.5 * (low + high));
        return 0.5 * (low + high);
    }

    void settle(int j)
    {
        Matrix a = stack(j);
        delay[j] = double(cfg.delay_s[j]) / (cell_s() * AUVID_METRIC_DELAY_CELLS);
        lag[j] = false;
        if (cfg.estimate_delay) {
            double with_shift, with_lag, s = best(a, false, &with_shift),
                                         t = best(a, true, &with_lag);
            lag[j] = t > 0 && with_lag < with_shift;
            delay[j] = lag[j] ? t : s;
            // accepted at four standard deviations from zero and a standard deviation of 12.5 ms
            double smallest = lag[j] ? with_lag : with_shift;
            double none = left(a, delay_weights(0, false));
            double sigma = std::fabs(delay[j]) / std::sqrt(dof_rows[j] * (none / smallest - 1));
            double seconds = sigma * cell_s() * AUVID_METRIC_DELAY_CELLS;
            if (!(std::fabs(delay[j]) > 4 * sigma && seconds < 0.0125)) {
                delay[j] = 0;
                lag[j] = false;
            }
        }
    }

    void merge()
    {
        int sets = int(set_excited.size());
        excited = 0;
        for (int s = std::max(0, sets - cfg.sets); s < sets; ++s) {
            excited |= set_excited[s];
            for (int j = 0; j < 6; ++j) {
                dof_rows[j] += set_excited[s] >> j & 1 ? set_rows[s] : 0;
            }
        }
        constant = 0;
        for (int j : dofs) {
            if (!(excited >> j & 1)) {
                continue;
            }
            weight[j] = 1 / (std::pow(double(cfg.tau_max[j]), 2) * dof_rows[j]);
            settle(j);
            if (!literal) {
                int n = int(column[j].size());
                Vector l = delay_weights(delay[j], lag[j]);
                Matrix a = stack(j);
                Vector x = solver(a.leftCols(n)).solve(a.rightCols(3) * l), full(n + 3);
                full << x, -l;
                double low = (stack(j, 1, 0) * full).squaredNorm();
                double high = (stack(j, 0, 1) * full).squaredNorm();
                double ratio = std::min(1e3, std::max(1e-3, high / low));
                band_weight[0][j] = std::sqrt(ratio);
                band_weight[1][j] = 1 / std::sqrt(ratio);
                settle(j);
            }
            constant += weight[j] * left(stack(j), delay_weights(delay[j], lag[j]));
        }
    }

    // sum_j weight ||rows pi - wrench||^2, the constant included
    double whole_cost(const Vector &x) const
    {
        double sum = 0;
        for (int j : dofs) {
            sum += excited >> j & 1 ? weight[j] * (stack(j) * candidate(j, x)).squaredNorm() : 0;
        }
        return sum;
    }

    Vector candidate(int j, const Vector &x) const
    {
        Vector full(column[j].size() + 3);
        for (size_t k = 0; k < column[j].size(); ++k) {
            full(k) = x(column[j][k]);
        }
        full.tail(3) = -delay_weights(delay[j], lag[j]);
        return full;
    }

    double sse(int j, const Vector &x) const
    {
        return (stack(j, 1, 1) * candidate(j, x)).squaredNorm();
    }

    // The bound on the rounding of the cost: entries of R and z have a backward error of c eps of
    // their
    // column's norm, and sets are rounded when they are stored.
    double tolerance(const Vector &x, double cost) const
    {
        double size = 0;
        for (int j : dofs) {
            if (excited >> j & 1) {
                Matrix a = stack(j);
                Vector full = candidate(j, x);
                double norm = 0;
                for (int k = 0; k < a.cols(); ++k) {
                    norm += a.col(k).norm() * std::fabs(full(k));
                }
                size += weight[j] * norm * norm;
            }
        }
        double delta = (30 * eps + stored) * std::sqrt(size);
        return 2 * std::sqrt(cost) * delta + delta * delta;
    }

    Vector least_squares(const std::vector<int> &active, Vector x) const
    {
        Matrix a(0, active.size());
        Vector b(0);
        for (int j : dofs) {
            if (!(excited >> j & 1)) {
                continue;
            }
            Matrix rows = stack(j) * std::sqrt(weight[j]);
            Matrix part = Matrix::Zero(rows.rows(), active.size());
            Vector rest = rows.rightCols(3) * delay_weights(delay[j], lag[j]);
            for (size_t k = 0; k < column[j].size(); ++k) {
                bool found = false;
                for (size_t i = 0; i < active.size(); ++i) {
                    if (active[i] == column[j][k]) {
                        part.col(i) = rows.col(k);
                        found = true;
                    }
                }
                if (!found) {
                    rest -= rows.col(k) * x(column[j][k]);
                }
            }
            Matrix grown(a.rows() + part.rows(), a.cols());
            grown << a, part;
            Vector longer(b.size() + rest.size());
            longer << b, rest;
            a = grown;
            b = longer;
        }
        Vector y = solver(a).solve(b);
        for (size_t i = 0; i < active.size(); ++i) {
            x(active[i]) = y(i);
        }
        return x;
    }
};

#endif
