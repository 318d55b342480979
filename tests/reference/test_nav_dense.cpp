// The navigation filter against one written from the equations as they stand: 6x6 matrices in
// double, F P F' + G Q G', one scalar update H at a time. Same samples, same rules (nav.h), so that
// the two must stay together to rounding.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <vector>

#include "nav_reference.h"

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

class Dense
{
  public:
    struct Sensor {
        int rejections = 0;
        bool has_sample = false;
        uint64_t good_us = 0;
    };
    auvid_nav_config_t c;
    Vector6d x = Vector6d::Zero();
    Matrix6d P = Matrix6d::Zero();
    Matrix3d R = Matrix3d::Identity(), mount;
    Vector3d rates, q, lever;
    std::deque<std::pair<uint64_t, Vector3d>> kept; // rates of past ticks, the newest first
    uint64_t now = 0, touched = 0;
    bool running = false, has_depth = false;
    int to_collect;
    std::vector<double> offset[2];
    Sensor sensor[4];

    explicit Dense(const auvid_nav_config_t &cfg) : c(cfg), to_collect(cfg.gps_start)
    {
        double tick = c.reference_tick;
        for (int i = 0; i < 3; ++i) {
            x[i] = c.position[i];
            q[i] = double(c.sigma_acceleration[i]) * double(c.sigma_acceleration[i]) * tick;
            lever[i] = c.mount.dvl_lever[i];
            P(i, i) = double(c.sigma_position) * double(c.sigma_position);
            P(3 + i, 3 + i) = double(c.sigma_velocity) * double(c.sigma_velocity);
        }
        mount =
            rotation(Vector3d(c.mount.dvl_euler[0], c.mount.dvl_euler[1], c.mount.dvl_euler[2]));
    }

    void imu(uint64_t t_us, const Vector3d &attitude, const Vector3d &omega)
    {
        R = rotation(attitude);
        rates = omega;
        if (t_us - now > 2000000) {
            kept.clear();
        }
        if (kept.empty() || double(t_us - kept[0].first) >= c.dvl_max_age_us / 7.0) {
            kept.push_front({t_us, omega});
            kept.resize(std::min<size_t>(kept.size(), 8));
        }
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
        bool hold_back = water && bottom.has_sample && now <= bottom.good_us + c.stale_us;
        double noise = std::pow(c.sigma_dvl, 2) + (water ? std::pow(c.sigma_current, 2) : 0.0);
        Vector3d v;
        MatrixXd H = MatrixXd::Zero(0, 6);
        VectorXd z(0);
        for (int j = 0; j < 3; ++j) {
            v[j] = s.velocity[j];
        }
        Vector3d turning = rates_at(s.t_us).cross(lever), body = mount * v - turning;
        for (int j = 0; j < 3; ++j) {
            if (s.valid != 7 && !(s.valid >> j & 1)) {
                continue;
            }
            H.conservativeResize(H.rows() + 1, 6);
            z.conservativeResize(z.size() + 1);
            H.bottomRows<1>().setZero();
            Vector3d h = s.valid == 7 ? Vector3d(Vector3d::Unit(j)) : Vector3d(mount.col(j));
            H.bottomRows<1>().rightCols<3>() = h.transpose();
            z[z.size() - 1] = s.valid == 7 ? body[j] : v[j] - mount.col(j).dot(turning);
        }
        return update(water ? AUVID_NAV_DVL_WATER : AUVID_NAV_DVL_BOTTOM, s.t_us, H, z, noise, true,
                      hold_back);
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
        if (has_depth && x[2] > c.surface_depth) {
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
    // Linear between the stored rates and the current ones.
    Vector3d rates_at(uint64_t t_us) const
    {
        std::pair<uint64_t, Vector3d> later(now, rates);
        for (const auto &k : kept) {
            if (k.first <= t_us && t_us < later.first) {
                double part = double(t_us - k.first) / double(later.first - k.first);
                return part * later.second + (1 - part) * k.second;
            }
            later = t_us < k.first ? k : later;
        }
        return later.second;
    }

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
            double beta = std::min(w / hph, 0.8);
            pxz *= 1 - beta;
            S = (1 - beta) * hph + noise;
        }
    }

    auvid_status_t update(int which, uint64_t t_us, const MatrixXd &H, const VectorXd &z,
                          double noise, bool velocity, bool hold_back)
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
            double since = velocity && s.has_sample ? 1e-6 * double(t_us - s.good_us) : 0.0;
            double reach = std::sqrt(c.gate * S) + c.max_acceleration * std::min(since, 10.0);
            outside[size_t(j)] = std::abs(nu) > reach;
        }
        bool any = std::find(outside.begin(), outside.end(), true) != outside.end();
        if (any && ++s.rejections < c.max_consecutive_rejections) {
            return AUVID_GATED;
        }
        s.rejections = 0;
        s.has_sample = true;
        s.good_us = t_us;
        if (hold_back) {
            return AUVID_UNUSED;
        }
        for (int j = 0; j < z.size(); ++j) {
            if (outside[size_t(j)]) { // discard the information along u
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

// A sample in transit to the filter.
struct Event {
    uint64_t due_us;
    int sensor; // auvid_nav_sensor_t
    auvid_dvl_sample_t dvl;
    auvid_real_t a, b;
    uint64_t t_us;
};

// Ten minutes out to more than 2 km with dives, turns, drop-outs, water lock only, parts of the
// axes, late samples, outliers, a depth sensor that jumps, a biased DVL and an irregular tick.
class Ride
{
  public:
    double worst_position = 0, worst_velocity = 0, furthest = 0;
    int statuses[16] = {0};
    auvid_nav_t nav;

    Ride(double max_age, bool gps) : max_age_s(max_age), with_gps(gps), dense(cfg())
    {
        auvid_nav_config_t c = cfg();
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &c));
        mount =
            rotation(Vector3d(c.mount.dvl_euler[0], c.mount.dvl_euler[1], c.mount.dvl_euler[2]));
        lever = Vector3d(c.mount.dvl_lever[0], c.mount.dvl_lever[1], c.mount.dvl_lever[2]);
    }

    void go()
    {
        while (t_us < 601000000) {
            move();
            for (int s = 0; s < 4; ++s) {
                sample(s);
            }
            for (int s = 0; s < 4; ++s) {
                deliver(s);
            }
            compare();
        }
    }

    // Relative to the standard deviations.
    double covariance_error() const
    {
        auvid_real_t p[6][6];
        double worst = 0;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j < 6; ++j) {
                double scale = std::sqrt(dense.P(i, i) * dense.P(j, j));
                worst = std::max(worst, std::abs(dense.P(i, j) - double(p[i][j])) / scale);
            }
        }
        return worst;
    }

  private:
    World w;
    double max_age_s, t = 0;
    bool with_gps;
    Dense dense;
    Matrix3d mount;
    Vector3d lever, velocity, rates, position{3, -4, 0.1};
    std::deque<Event> queue[4];
    uint64_t t_us = 1000000, due[4] = {0, 0, 0, 0};

    static auvid_nav_config_t cfg()
    {
        auvid_nav_config_t c;
        auvid_nav_defaults(&c);
        c.speed_limit = 8;
        c.max_acceleration =
            auvid_real_t(0.1); // so that the biased DVL reaches max_consecutive_rejections
        c.mount.dvl_euler[0] = auvid_real_t(0.05);
        c.mount.dvl_euler[2] = auvid_real_t(3.926990817);
        c.mount.dvl_lever[0] = auvid_real_t(-0.75);
        c.mount.dvl_lever[2] = auvid_real_t(0.2);
        c.sigma_acceleration[1] = auvid_real_t(0.7);
        return c;
    }

    void move()
    {
        uint64_t dt = uint64_t(w.uniform(12000, 28000));
        dt = w.chance(1e-3) ? 300000 : dt;
        t_us += dt;
        t = 1e-6 * double(t_us);
        velocity = Vector3d(3.9 + 0.4 * std::sin(0.3 * t), 0.3 * std::sin(0.5 * t),
                            0.2 * std::cos(0.7 * t));
        Vector3d attitude(0.1 * std::sin(0.9 * t), 0.1 * std::cos(0.6 * t),
                          0.6 + 0.5 * std::sin(0.05 * t));
        rates = Vector3d(0.09 * std::cos(0.9 * t), -0.06 * std::sin(0.6 * t),
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
    }

    void sample(int s)
    {
        static const uint64_t period[4] = {200000, 250000, 100000, 1000000};
        if (t_us < due[s] || (s == AUVID_NAV_GPS && !with_gps)) {
            return;
        }
        due[s] = t_us + period[s];
        Event e = {};
        e.due_us = t_us + (max_age_s > 0 ? uint64_t(1e6 * w.uniform(0, max_age_s)) : 0);
        e.t_us = t_us;
        if (s == AUVID_NAV_DEPTH) {
            e.a = auvid_real_t(position[2] + w.normal(0.015) + (t > 400 ? 2.5 : 0.0) +
                               (w.chance(0.01) ? 5 : 0));
        } else if (s == AUVID_NAV_GPS) {
            e.a = auvid_real_t(position[0] + w.normal(1.5));
            e.b = auvid_real_t(position[1] + w.normal(1.5));
        } else {
            bool water = s == AUVID_NAV_DVL_WATER;
            bool out = (t > 150 && t < 165) || (t > 300 && t < 340);
            e.dvl = ping(water);
            if (out && (!water || t < 310)) {
                return; // no bottom lock, and for a while no lock at all
            }
        }
        queue[s].push_back(e);
    }

    auvid_dvl_sample_t ping(bool water)
    {
        auvid_dvl_sample_t d = {};
        Vector3d current = water ? Vector3d(0.2, -0.1, 0) : Vector3d(0, 0, 0);
        Vector3d v = mount.transpose() * (velocity + rates.cross(lever) + current);
        for (int i = 0; i < 3; ++i) {
            v[i] += w.normal(0.007);
        }
        v[1] += w.chance(0.01) ? 1.5 : t > 500 && t < 530 ? -2.0 : 0;
        d.t_us = t_us;
        d.lock = water ? AUVID_DVL_WATER : AUVID_DVL_BOTTOM;
        d.valid = uint8_t(w.chance(0.1) ? 1 + int(w.uniform(0, 6)) : 7);
        for (int i = 0; i < 3; ++i) {
            d.velocity[i] = auvid_real_t(v[i]);
        }
        return d;
    }

    void deliver(int s)
    {
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

    void compare()
    {
        for (int i = 0; i < 3; ++i) {
            double p = double(nav.ekf.position[i]) + double(nav.ekf.position_lo[i]);
            double v = double(nav.ekf.velocity[i]);
            worst_position = std::max(worst_position, std::abs(p - dense.x[i]));
            worst_velocity = std::max(worst_velocity, std::abs(v - dense.x[3 + i]));
        }
        furthest = std::max(furthest, dense.x.head<2>().norm());
    }
};

static void check_together(double max_age_s, bool with_gps)
{
    Ride r(max_age_s, with_gps);
    r.go();
    std::printf("max age %.2f s, %s: out to %.0f m, position within %.3g mm, velocity within "
                "%.3g mm/s, covariance within %.2g\n",
                max_age_s, with_gps ? "GPS" : "no GPS", r.furthest, 1e3 * r.worst_position,
                1e3 * r.worst_velocity, r.covariance_error());
    TEST_ASSERT_TRUE(r.furthest > 2000);
    TEST_ASSERT_TRUE(r.worst_position < 1e-3);
    TEST_ASSERT_TRUE(r.worst_velocity < 1e-4);
    TEST_ASSERT_TRUE(r.covariance_error() < 1e-4);
    // and all cases occurred
    TEST_ASSERT_TRUE(r.statuses[AUVID_OK] > 5000);
    TEST_ASSERT_TRUE(r.statuses[AUVID_GATED] > 50);
    TEST_ASSERT_TRUE(r.statuses[AUVID_UNUSED] > 500);
    TEST_ASSERT_EQUAL_INT(with_gps ? 3 : 0, r.statuses[AUVID_PENDING]);
    TEST_ASSERT_TRUE(r.nav.diagnostics[AUVID_NAV_DEPTH].resets > 0);
    TEST_ASSERT_TRUE(r.nav.diagnostics[AUVID_NAV_DVL_BOTTOM].resets > 0);
    TEST_ASSERT_TRUE(r.nav.water.sequence > 100 && r.nav.ground.sequence > 1000);
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

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_ten_minutes_with_punctual_samples_agree_with_dense_matrices);
    RUN_TEST(test_ten_minutes_of_dead_reckoning_agree_with_dense_matrices);
    RUN_TEST(test_ten_minutes_with_late_samples_agree_with_dense_matrices);
    RUN_TEST(test_ten_minutes_with_very_late_samples_agree_with_dense_matrices);
    return UNITY_END();
}
