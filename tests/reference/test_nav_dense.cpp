// The navigation filter against one written from the equations as they stand: 6x6 matrices in
// double, F P F' + G Q G', one scalar update H at a time. Same samples, same rules (nav.h), so that
// the two must stay together to rounding. And late velocities against a Kalman filter that carries
// the velocity of the sample's time along as states of its own.
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <random>
#include <vector>

#include "auvid/nav.h"

extern "C" {
#include "unity.h"
}

using Eigen::Matrix;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
typedef Matrix<double, 6, 6> Matrix6d;
typedef Matrix<double, 6, 1> Vector6d;

void setUp()
{
}

void tearDown()
{
}

static double real(double x) // as the filter receives it
{
    return double(auvid_real_t(x));
}

static Matrix3d rotation(const Vector3d &e)
{
    return (Eigen::AngleAxisd(e[2], Vector3d::UnitZ()) *
            Eigen::AngleAxisd(e[1], Vector3d::UnitY()) * Eigen::AngleAxisd(e[0], Vector3d::UnitX()))
        .toRotationMatrix();
}

class Dense
{
  public:
    struct Sensor {
        int refusals = 0;
        bool alive = false;
        uint64_t good_us = 0;
    };
    auvid_nav_config_t c;
    Vector6d x = Vector6d::Zero();
    Matrix6d P = Matrix6d::Zero();
    Matrix3d R = Matrix3d::Identity(), mount;
    Vector3d rates, q, lever;
    uint64_t now = 0, touched = 0;
    bool running = false, has_depth = false;
    int to_collect;
    std::vector<double> offset[2];
    Sensor sensor[4];

    explicit Dense(const auvid_nav_config_t &config) : c(config), to_collect(config.gps_start)
    {
        double tick = c.reference_tick;
        for (int i = 0; i < 3; ++i) {
            x[i] = c.position[i];
            q[i] = double(c.sigma_acceleration[i]) * double(c.sigma_acceleration[i]) * tick;
            lever[i] = c.dvl_lever[i];
            P(i, i) = double(c.sigma_position) * double(c.sigma_position);
            P(3 + i, 3 + i) = double(c.sigma_velocity) * double(c.sigma_velocity);
        }
        mount = rotation(Vector3d(c.dvl_euler[0], c.dvl_euler[1], c.dvl_euler[2]));
    }

    void imu(uint64_t t_us, const Vector3d &attitude, const Vector3d &omega)
    {
        R = rotation(attitude);
        rates = omega;
        if (running) {
            double t = 1e-6 * double(t_us - now);
            Matrix6d F = Matrix6d::Identity();
            Matrix<double, 6, 3> G;
            F.topRightCorner<3, 3>() = t * R;
            G << R * t * t / 2, Matrix3d::Identity() * t;
            x = F * x;
            P = F * P * F.transpose() + G * Matrix3d(q.asDiagonal()) / t * G.transpose();
        } else {
            touched = t_us;
        }
        now = t_us;
        running = true;
    }

    auvid_status_t dvl(const auvid_dvl_sample_t &s)
    {
        bool water = s.lock == AUVID_DVL_WATER;
        Sensor &bottom = sensor[AUVID_NAV_DVL_BOTTOM];
        bool apart = water && bottom.alive && now <= bottom.good_us + c.stale_us;
        double noise = std::pow(c.sigma_dvl, 2) + (water ? std::pow(c.sigma_current, 2) : 0.0);
        Vector3d v;
        MatrixXd H = MatrixXd::Zero(0, 6);
        VectorXd z(0);
        for (int j = 0; j < 3; ++j) {
            v[j] = s.velocity[j];
        }
        Vector3d body = mount * v - rates.cross(lever);
        for (int j = 0; j < 3; ++j) {
            if (s.valid != 7 && !(s.valid >> j & 1)) {
                continue;
            }
            H.conservativeResize(H.rows() + 1, 6);
            z.conservativeResize(z.size() + 1);
            H.bottomRows<1>().setZero();
            Vector3d h = s.valid == 7 ? Vector3d(Vector3d::Unit(j)) : Vector3d(mount.col(j));
            H.bottomRows<1>().rightCols<3>() = h.transpose();
            z[z.size() - 1] = s.valid == 7 ? body[j] : v[j] - mount.col(j).dot(rates.cross(lever));
        }
        return update(water ? AUVID_NAV_DVL_WATER : AUVID_NAV_DVL_BOTTOM, s.t_us, H, z, noise, true,
                      apart);
    }

    auvid_status_t depth(uint64_t t_us, double z)
    {
        double a = age(t_us), noise = std::pow(c.sigma_depth, 2);
        MatrixXd H = position_row(2, a);
        if (!has_depth) {
            restart(2, z - H.row(0).dot(x), noise);
            has_depth = true;
            return AUVID_OK;
        }
        return update(AUVID_NAV_DEPTH, t_us, H, VectorXd::Constant(1, z), noise, false, false);
    }

    auvid_status_t gps(uint64_t t_us, double north, double east)
    {
        double a = age(t_us), noise = std::pow(c.sigma_gps, 2);
        if (x[2] > c.surface_depth) {
            return AUVID_UNUSED;
        }
        MatrixXd H(2, 6);
        H << position_row(0, a), position_row(1, a);
        VectorXd z = Eigen::Vector2d(north, east);
        if (to_collect == 0) {
            return update(AUVID_NAV_GPS, t_us, H, z, noise, false, false);
        }
        for (int j = 0; j < 2; ++j) {
            offset[j].push_back(z[j] - H.row(j).dot(x));
        }
        if (--to_collect > 0) {
            return AUVID_PENDING;
        }
        for (int j = 0; j < 2; ++j) {
            std::sort(offset[j].begin(), offset[j].end());
            size_t n = offset[j].size();
            restart(j, 0.5 * (offset[j][(n - 1) / 2] + offset[j][n / 2]), noise);
        }
        return AUVID_OK;
    }

  private:
    double age(uint64_t t_us) const
    {
        return t_us >= now ? 0.0 : 1e-6 * double(now - t_us);
    }

    MatrixXd position_row(int i, double a) const
    {
        MatrixXd H = MatrixXd::Zero(1, 6);
        H(0, i) = 1;
        H.rightCols<3>() = -a * R.row(i);
        return H;
    }

    void restart(int i, double step, double noise)
    {
        x[i] += step;
        P.row(i).setZero();
        P.col(i).setZero();
        P(i, i) = noise;
        touched = now;
    }

    // Covariance with the state, and variance, of the innovation of one row.
    void innovation(const VectorXd &h, double noise, double a, bool velocity, bool clean,
                    Vector6d &pxz, double &S) const
    {
        double hph = h.dot(P * h);
        pxz = P * h;
        S = hph + noise;
        if (!velocity || a == 0) {
            return;
        }
        Vector6d qx;
        Vector3d m = a * q.cwiseProduct(h.tail<3>());
        qx << a / 2 * R * m, m;
        double w = h.tail<3>().dot(m);
        Vector6d exact = pxz - qx;
        if (clean && exact.dot(P.ldlt().solve(exact)) < hph - w + noise) {
            pxz = exact;
            S = hph - w + noise;
        } else {
            double beta = std::min(w / hph, 0.99);
            pxz *= 1 - beta;
            S = (1 - beta) * hph + noise;
        }
    }

    auvid_status_t update(int which, uint64_t t_us, const MatrixXd &H, const VectorXd &z,
                          double noise, bool velocity, bool apart)
    {
        Sensor &s = sensor[which];
        double a = age(t_us), S;
        bool clean = t_us >= touched;
        Vector6d pxz;
        std::vector<bool> outside(size_t(z.size()), false);
        std::vector<double> nus;
        for (int j = 0; j < z.size(); ++j) {
            innovation(H.row(j), noise, a, velocity, clean, pxz, S);
            double nu = z[j] - H.row(j).dot(x);
            nus.push_back(nu);
            outside[size_t(j)] = nu * nu / S > c.gate;
        }
        bool any = std::find(outside.begin(), outside.end(), true) != outside.end();
        if (any && ++s.refusals < c.lockout) {
            return AUVID_GATED;
        }
        s.refusals = 0;
        s.alive = true;
        s.good_us = t_us;
        if (apart) {
            return AUVID_UNUSED;
        }
        for (int j = 0; j < z.size(); ++j) {
            if (outside[size_t(j)]) { // forget all that was known along u
                Vector6d u = H.row(j).transpose();
                if (!velocity) {
                    u.tail<3>().setZero();
                }
                Matrix6d keep = Matrix6d::Identity() - u * u.transpose();
                double since = velocity ? a * u.tail<3>().dot(q.cwiseProduct(u.tail<3>())) : 0.0;
                x += u * nus[size_t(j)];
                P = keep * P * keep.transpose() + (noise + since) * u * u.transpose();
            }
        }
        for (int j = 0; j < z.size(); ++j) {
            if (outside[size_t(j)]) {
                continue;
            }
            innovation(H.row(j), noise, a, velocity, clean, pxz, S);
            x += pxz / S * (z[j] - H.row(j).dot(x));
            P -= pxz * pxz.transpose() / S;
        }
        touched = now;
        return AUVID_OK;
    }
};

// What is on its way to the filter.
struct Event {
    uint64_t due_us;
    int sensor; // auvid_nav_sensor_t
    auvid_dvl_sample_t dvl;
    auvid_real_t a, b;
    uint64_t t_us;
};

struct World {
    std::mt19937_64 generator{20130613};
    double normal(double sigma)
    {
        return std::normal_distribution<double>(0, sigma)(generator);
    }
    double uniform(double low, double high)
    {
        return std::uniform_real_distribution<double>(low, high)(generator);
    }
    bool chance(double p)
    {
        return uniform(0, 1) < p;
    }
};

// Ten minutes out to more than 2 km with dives, turns, drop-outs, water lock only, parts of the
// axes, late samples, outliers, a depth sensor that jumps and an irregular tick.
static void run_together(double max_age_s, bool with_gps, double *worst_position,
                         double *worst_velocity, double *furthest, int *statuses)
{
    World w;
    auvid_nav_config_t c;
    auvid_nav_defaults(&c);
    c.speed_limit = 8;
    c.dvl_euler[0] = auvid_real_t(0.05);
    c.dvl_euler[2] = auvid_real_t(3.926990817);
    c.dvl_lever[0] = auvid_real_t(-0.75);
    c.dvl_lever[2] = auvid_real_t(0.2);
    c.sigma_acceleration[1] = auvid_real_t(0.7);
    auvid_nav_t nav;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &c));
    Dense dense(c);
    Matrix3d mount = rotation(Vector3d(c.dvl_euler[0], c.dvl_euler[1], c.dvl_euler[2]));
    Vector3d lever(c.dvl_lever[0], c.dvl_lever[1], c.dvl_lever[2]);
    Vector3d position(3, -4, 0.1);
    std::deque<Event> queue[4];
    uint64_t t_us = 1000000, due[4] = {0, 0, 0, 0};
    const uint64_t period[4] = {200000, 250000, 100000, 1000000};
    *worst_position = *worst_velocity = *furthest = 0;
    while (t_us < 601000000) {
        uint64_t dt = uint64_t(w.uniform(12000, 28000));
        dt = w.chance(1e-3) ? 300000 : dt;
        t_us += dt;
        double t = 1e-6 * double(t_us);
        Vector3d velocity(3.9 + 0.4 * std::sin(0.3 * t), 0.3 * std::sin(0.5 * t),
                          0.2 * std::cos(0.7 * t));
        Vector3d attitude(0.1 * std::sin(0.9 * t), 0.1 * std::cos(0.6 * t),
                          0.6 + 0.5 * std::sin(0.05 * t));
        Vector3d rates(0.09 * std::cos(0.9 * t), -0.06 * std::sin(0.6 * t),
                       0.025 * std::cos(0.05 * t));
        attitude = attitude.unaryExpr(&real);
        rates = rates.unaryExpr(&real);
        position += 1e-6 * double(dt) * (rotation(attitude) * velocity);
        // depth on a schedule of its own; the heave above is what the DVL sees
        position[2] = std::max(0.0, 8 * std::sin(0.02 * t));
        auvid_real_t a[3], r[3];
        for (int i = 0; i < 3; ++i) {
            a[i] = auvid_real_t(attitude[i]);
            r[i] = auvid_real_t(rates[i]);
        }
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, t_us, a, r));
        dense.imu(t_us, attitude, rates);
        for (int s = 0; s < 4; ++s) {
            if (t_us < due[s] || (s == AUVID_NAV_GPS && !with_gps)) {
                continue;
            }
            due[s] = t_us + period[s];
            Event e = {};
            uint64_t late = max_age_s > 0 ? uint64_t(1e6 * w.uniform(0, max_age_s)) : 0;
            e.due_us = t_us + late;
            e.t_us = t_us;
            if (s == AUVID_NAV_DEPTH) {
                e.a = auvid_real_t(position[2] + w.normal(0.015) + (t > 400 ? 2.5 : 0.0) +
                                   (w.chance(0.01) ? 5 : 0));
            } else if (s == AUVID_NAV_GPS) {
                e.a = auvid_real_t(position[0] + w.normal(1.5));
                e.b = auvid_real_t(position[1] + w.normal(1.5));
            } else {
                bool water = s == AUVID_NAV_DVL_WATER;
                Vector3d v = velocity + rates.cross(lever);
                v += water ? Vector3d(0.2, -0.1, 0) : Vector3d(0, 0, 0);
                v = mount.transpose() * v +
                    Vector3d(w.normal(0.007), w.normal(0.007), w.normal(0.007));
                v[1] += w.chance(0.01) ? 1.5 : t > 500 && t < 530 ? -2.0 : 0;
                e.dvl.t_us = t_us;
                e.dvl.lock = water ? AUVID_DVL_WATER : AUVID_DVL_BOTTOM;
                e.dvl.valid = uint8_t(w.chance(0.1) ? 1 + int(w.uniform(0, 6)) : 7);
                for (int i = 0; i < 3; ++i) {
                    e.dvl.velocity[i] = auvid_real_t(v[i]);
                }
                bool out = (t > 150 && t < 165) || (t > 300 && t < 340);
                if (out && (!water || t < 310)) {
                    continue; // no bottom lock, and for a while no lock at all
                }
            }
            queue[s].push_back(e);
        }
        for (int s = 0; s < 4; ++s) {
            while (!queue[s].empty() && queue[s].front().due_us <= t_us) {
                Event e = queue[s].front();
                queue[s].pop_front();
                if (t_us - e.t_us > 500000) {
                    continue; // a long tick came in between: stale for both
                }
                auvid_status_t ours, theirs;
                if (s == AUVID_NAV_DEPTH) {
                    ours = auvid_nav_depth(&nav, e.t_us, e.a);
                    theirs = dense.depth(e.t_us, e.a);
                } else if (s == AUVID_NAV_GPS) {
                    ours = auvid_nav_gps(&nav, e.t_us, e.a, e.b);
                    theirs = dense.gps(e.t_us, e.a, e.b);
                } else {
                    ours = auvid_nav_dvl(&nav, &e.dvl);
                    theirs = dense.dvl(e.dvl);
                }
                TEST_ASSERT_EQUAL_INT(theirs, ours);
                ++statuses[ours];
            }
        }
        for (int i = 0; i < 3; ++i) {
            double p = double(nav.position[i]) + double(nav.residue[i]);
            *worst_position = std::max(*worst_position, std::abs(p - dense.x[i]));
            *worst_velocity =
                std::max(*worst_velocity, std::abs(double(nav.velocity[i]) - dense.x[3 + i]));
        }
        *furthest = std::max(*furthest, dense.x.head<2>().norm());
    }
    TEST_ASSERT_TRUE(nav.diagnostics[AUVID_NAV_DEPTH].resets > 0);
    TEST_ASSERT_TRUE(nav.diagnostics[AUVID_NAV_DVL_BOTTOM].resets > 0);
    TEST_ASSERT_TRUE((nav.water.sequence > 100) && (nav.ground.sequence > 1000));
    for (int i = 0; i < 6; ++i) { // and the covariance, relative to the standard deviations
        auvid_real_t p[6][6];
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
        for (int j = 0; j < 6; ++j) {
            double scale = std::sqrt(dense.P(i, i) * dense.P(j, j));
            TEST_ASSERT_DOUBLE_WITHIN(1e-4 * scale, dense.P(i, j), double(p[i][j]));
        }
    }
    std::printf(
        "max age %.2f s, %s: out to %.0f m, position within %.3g mm, velocity within %.3g mm/s\n",
        max_age_s, with_gps ? "GPS" : "no GPS", *furthest, 1e3 * *worst_position,
        1e3 * *worst_velocity);
}

static void check_together(double max_age_s, bool with_gps)
{
    double position, velocity, furthest;
    int statuses[16] = {0};
    run_together(max_age_s, with_gps, &position, &velocity, &furthest, statuses);
    TEST_ASSERT_TRUE(furthest > 2000);
    TEST_ASSERT_TRUE(statuses[AUVID_OK] > 5000);
    TEST_ASSERT_TRUE(statuses[AUVID_GATED] > 50);
    TEST_ASSERT_TRUE(statuses[AUVID_UNUSED] > 500);
    TEST_ASSERT_EQUAL_INT(with_gps ? 3 : 0, statuses[AUVID_PENDING]);
    TEST_ASSERT_TRUE(position < 1e-3);
    TEST_ASSERT_TRUE(velocity < 1e-4);
}

static void test_ten_minutes_with_punctual_samples_agree_with_dense_matrices()
{
    check_together(0, true);
}

static void test_ten_minutes_of_dead_reckoning_agree_with_dense_matrices()
{
    check_together(0.15, false);
}

static void test_ten_minutes_with_late_samples_agree_with_dense_matrices()
{
    check_together(0.15, true);
}

static void test_ten_minutes_with_very_late_samples_agree_with_dense_matrices()
{
    check_together(0.45, true);
}

// Exact: the clone of the velocity at the sample's time is a state. Constant attitude, since the
// filter takes R at the present.
static void run_against_clone(int seed, bool directed, double *worst)
{
    World w;
    w.generator.seed(uint64_t(seed));
    auvid_nav_config_t c;
    auvid_nav_defaults(&c);
    c.gate = 0;
    c.sigma_dvl = auvid_real_t(0.02);
    for (int i = 0; i < 3; ++i) {
        c.sigma_acceleration[i] = auvid_real_t(w.uniform(0.3, 3));
        c.dvl_euler[i] = auvid_real_t(directed ? w.uniform(-1, 1) : 0);
    }
    auvid_nav_t nav;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &c));
    const auvid_real_t still[3] = {0, 0, 0};
    const auvid_real_t attitude[3] = {auvid_real_t(0.3), auvid_real_t(-0.4), auvid_real_t(2.1)};
    const int tick_us = 20000, before = 25, since = 1 + int(w.uniform(0, 24));
    Matrix3d R = rotation(Vector3d(attitude[0], attitude[1], attitude[2]));
    Matrix3d mount = rotation(Vector3d(c.dvl_euler[0], c.dvl_euler[1], c.dvl_euler[2]));
    Vector6d x;
    Matrix6d P;
    Matrix<double, 9, 1> y; // position, velocity, velocity at the sample's time
    Matrix<double, 9, 9> C;
    double t = 1e-6 * tick_us, noise = std::pow(c.sigma_dvl, 2);
    Matrix<double, 9, 9> F = Matrix<double, 9, 9>::Identity();
    Matrix<double, 9, 3> G = Matrix<double, 9, 3>::Zero();
    F.block<3, 3>(0, 3) = t * R;
    G.topRows<3>() = R * t * t / 2;
    G.middleRows<3>(3) = Matrix3d::Identity() * t;
    Vector3d q;
    for (int i = 0; i < 3; ++i) {
        q[i] = std::pow(c.sigma_acceleration[i], 2) * double(c.reference_tick);
    }
    uint64_t now = 5000000;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, attitude, still));
    for (int k = 1; k <= before + since; ++k) {
        now += uint64_t(tick_us);
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, attitude, still));
        if (k < before) {
            if (k % 5 == 0) {
                auvid_dvl_sample_t s = {now, {1, auvid_real_t(0.2), 0}, AUVID_DVL_BOTTOM, 7};
                TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_dvl(&nav, &s));
                TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, auvid_real_t(2)));
            }
            continue;
        }
        if (k == before) { // from here on exact in double, with the clone
            auvid_real_t p[6][6];
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
            Matrix<double, 9, 6> clone = Matrix<double, 9, 6>::Zero();
            clone.topRows<6>().setIdentity();
            clone.bottomRightCorner<3, 3>().setIdentity();
            for (int i = 0; i < 6; ++i) {
                x[i] = i < 3 ? double(nav.position[i]) + double(nav.residue[i])
                             : double(nav.velocity[i - 3]);
                for (int j = 0; j < 6; ++j) {
                    P(i, j) = p[i][j];
                }
            }
            y = clone * x;
            C = clone * P * clone.transpose();
            continue;
        }
        y = F * y;
        C = F * C * F.transpose() + G * Matrix3d(q.asDiagonal()) / t * G.transpose();
    }
    auvid_dvl_sample_t s = {now - uint64_t(since * tick_us),
                            {auvid_real_t(1.2), auvid_real_t(-0.1), auvid_real_t(0.3)},
                            AUVID_DVL_BOTTOM,
                            uint8_t(directed ? AUVID_DVL_X | AUVID_DVL_Z : AUVID_DVL_ALL)};
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_dvl(&nav, &s));
    for (int j = 0; j < 3; ++j) {
        if (!(s.valid >> j & 1)) {
            continue;
        }
        Matrix<double, 9, 1> h = Matrix<double, 9, 1>::Zero();
        h.tail<3>() = mount.col(j);
        Matrix<double, 9, 1> k = C * h / (h.dot(C * h) + noise);
        y += k * (double(s.velocity[j]) - h.dot(y));
        C -= k * (C * h).transpose();
    }
    auvid_real_t p[6][6];
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
    for (int i = 0; i < 6; ++i) {
        double ours =
            i < 3 ? double(nav.position[i]) + double(nav.residue[i]) : double(nav.velocity[i - 3]);
        *worst = std::max(*worst, std::abs(ours - y[i]) / std::sqrt(C(i, i)));
        for (int j = 0; j < 6; ++j) {
            double scale = std::sqrt(C(i, i) * C(j, j));
            *worst = std::max(*worst, std::abs(double(p[i][j]) - C(i, j)) / scale);
        }
    }
    // the knot is the clone's estimate, whichever way it was reached
    for (int i = 0; i < 3; ++i) {
        *worst = std::max(*worst,
                          std::abs(double(nav.ground.velocity[i]) - y[6 + i]) / std::sqrt(C(i, i)));
    }
}

static void test_late_velocity_equals_a_filter_that_carries_the_past_velocity_along()
{
    double worst = 0;
    for (int seed = 1; seed <= 100; ++seed) {
        run_against_clone(seed, false, &worst);
    }
    std::printf("late velocity, 100 runs: within %.3g of the standard deviations\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-3);
}

static void test_part_of_a_late_velocity_does_so_too()
{
    double worst = 0;
    for (int seed = 1; seed <= 100; ++seed) {
        run_against_clone(seed, true, &worst);
    }
    std::printf("late part, 100 runs: within %.3g of the standard deviations\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-3);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_ten_minutes_with_punctual_samples_agree_with_dense_matrices);
    RUN_TEST(test_ten_minutes_of_dead_reckoning_agree_with_dense_matrices);
    RUN_TEST(test_ten_minutes_with_late_samples_agree_with_dense_matrices);
    RUN_TEST(test_ten_minutes_with_very_late_samples_agree_with_dense_matrices);
    RUN_TEST(test_late_velocity_equals_a_filter_that_carries_the_past_velocity_along);
    RUN_TEST(test_part_of_a_late_velocity_does_so_too);
    return UNITY_END();
}
