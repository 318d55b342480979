// Late velocities against a Kalman filter that carries the velocity of the sample's time along as
// states of its own.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "nav_reference.h"

void setUp()
{
}

void tearDown()
{
}

typedef Matrix<double, 9, 1> Vector9d;
typedef Matrix<double, 9, 9> Matrix9d;

// Exact: velocity at the sample's time is kept as three more states. Constant attitude, since the
// filter takes R at the present.
class Clone
{
  public:
    Clone(unsigned seed, bool is_directed) : directed(is_directed)
    {
        w.generator.seed(seed);
        auvid_nav_defaults(&c);
        c.gate = 0;
        c.sigma_dvl = auvid_real_t(0.02);
        for (int i = 0; i < 3; ++i) {
            c.sigma_acceleration[i] = auvid_real_t(w.uniform(0.3, 3));
            c.mount.dvl_euler[i] = auvid_real_t(directed ? w.uniform(-1, 1) : 0);
        }
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &c));
        mount =
            rotation(Vector3d(c.mount.dvl_euler[0], c.mount.dvl_euler[1], c.mount.dvl_euler[2]));
    }

    // Largest difference, in standard deviations.
    double run()
    {
        const int since = 1 + int(w.uniform(0, 24));
        tick();
        for (int k = 1; k <= 25; ++k) {
            tick();
            if (k % 5 == 0 && k < 25) {
                auvid_dvl_sample_t s = {now, {1, auvid_real_t(0.2), 0}, AUVID_DVL_BOTTOM, 7};
                TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_dvl(&nav, &s));
                TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_depth(&nav, now, auvid_real_t(2)));
            }
        }
        copy();
        uint64_t taken = now;
        for (int k = 0; k < since; ++k) {
            tick();
            predict();
        }
        update(taken);
        return difference();
    }

  private:
    World w;
    auvid_nav_config_t c;
    auvid_nav_t nav;
    bool directed;
    uint64_t now = 5000000;
    Matrix3d mount;
    Vector9d y; // position, velocity, velocity at the sample's time
    Matrix9d C;
    const auvid_real_t attitude[3] = {auvid_real_t(0.3), auvid_real_t(-0.4), auvid_real_t(2.1)};

    void tick()
    {
        const auvid_real_t still[3] = {0, 0, 0};
        now += 20000;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, attitude, still));
    }

    Vector6d state() const
    {
        Vector6d x;
        for (int i = 0; i < 3; ++i) {
            x[i] = double(nav.ekf.position[i]) + double(nav.ekf.position_lo[i]);
            x[3 + i] = double(nav.ekf.velocity[i]);
        }
        return x;
    }

    Matrix6d covariance() const
    {
        auvid_real_t p[6][6];
        Matrix6d P;
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_covariance(&nav, p));
        for (int i = 0; i < 36; ++i) {
            P(i / 6, i % 6) = p[i / 6][i % 6];
        }
        return P;
    }

    void copy()
    {
        Matrix<double, 9, 6> clone = Matrix<double, 9, 6>::Zero();
        clone.topRows<6>().setIdentity();
        clone.bottomRightCorner<3, 3>().setIdentity();
        y = clone * state();
        C = clone * covariance() * clone.transpose();
    }

    void predict()
    {
        const double t = 0.02;
        Matrix3d R = rotation(Vector3d(attitude[0], attitude[1], attitude[2]));
        Matrix9d F = Matrix9d::Identity();
        Matrix<double, 9, 3> G = Matrix<double, 9, 3>::Zero();
        F.block<3, 3>(0, 3) = t * R;
        G.topRows<3>() = R * t * t / 2;
        G.middleRows<3>(3) = Matrix3d::Identity() * t;
        Vector3d q;
        for (int i = 0; i < 3; ++i) {
            q[i] = std::pow(c.sigma_acceleration[i], 2) * double(c.reference_tick);
        }
        y = F * y;
        C = F * C * F.transpose() + G * Matrix3d(q.asDiagonal()) / t * G.transpose();
    }

    void update(uint64_t taken)
    {
        auvid_dvl_sample_t s = {taken,
                                {auvid_real_t(1.2), auvid_real_t(-0.1), auvid_real_t(0.3)},
                                AUVID_DVL_BOTTOM,
                                uint8_t(directed ? AUVID_DVL_X | AUVID_DVL_Z : AUVID_DVL_ALL)};
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_dvl(&nav, &s));
        for (int j = 0; j < 3; ++j) {
            if (!(s.valid >> j & 1)) {
                continue;
            }
            Vector9d h = Vector9d::Zero();
            h.tail<3>() = mount.col(j);
            Vector9d k = C * h / (h.dot(C * h) + std::pow(c.sigma_dvl, 2));
            y += k * (double(s.velocity[j]) - h.dot(y));
            C -= k * (C * h).transpose();
        }
    }

    double difference() const
    {
        Vector6d x = state(), sigma = C.diagonal().head<6>().cwiseSqrt();
        Matrix6d P = covariance();
        double worst = 0;
        for (int i = 0; i < 6; ++i) {
            worst = std::max(worst, std::abs(x[i] - y[i]) / sigma[i]);
            for (int j = 0; j < 6; ++j) {
                worst = std::max(worst, std::abs(P(i, j) - C(i, j)) / sigma[i] / sigma[j]);
            }
        }
        for (int i = 0; i < 3; ++i) { // the velocity sample is the estimate of the past velocity
            double v = double(nav.ground.velocity[i]);
            worst = std::max(worst, std::abs(v - y[6 + i]) / sigma[3 + i]);
        }
        return worst;
    }
};

static void check_against_clones(bool directed)
{
    double worst = 0;
    for (unsigned seed = 1; seed <= 100; ++seed) {
        worst = std::max(worst, Clone(seed, directed).run());
    }
    std::printf("late velocity%s, 100 runs: within %.2g standard deviations\n",
                directed ? " in part" : "", worst);
    TEST_ASSERT_TRUE(worst < 1e-3);
}

static void test_late_velocity_equals_a_filter_with_the_past_velocity_as_a_state()
{
    check_against_clones(false);
}

static void test_partial_late_velocity_equals_it_too()
{
    check_against_clones(true);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_late_velocity_equals_a_filter_with_the_past_velocity_as_a_state);
    RUN_TEST(test_partial_late_velocity_equals_it_too);
    return UNITY_END();
}
