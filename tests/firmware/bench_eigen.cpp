/*
 * The navigation step and two filters that do the same arithmetic with Eigen, in float, of fixed
 * size. They have 6 states (position, velocity in the body), a prediction with the attitude of an
 * IMU, an update by a DVL's velocity and one by a depth. tests/firmware/bench_eigen.sh counts them.
 *
 * The filters in Eigen do nothing else. auvid also checks every sample: is it finite, is its time
 * valid, does it pass the gate, which sensor timed out? It sums the position with compensation,
 * removes the DVL's lever arm, and records innovations.
 */
#include <Eigen/Dense>
#include <cmath>

extern "C" {
#include "auvid/nav.h"
#include "machine.h"
}

extern "C" void *__dso_handle; /* for the C++ library; start-up has none */
void *__dso_handle;

#define COUNTED extern "C" __attribute__((noipa))

using Vector3 = Eigen::Vector3f;
using Matrix3 = Eigen::Matrix3f;

static const float dt = 0.02f, accel = 1.0f, dvl_variance = 4.9e-5f, depth_variance = 2.25e-4f;

/* Body to NED. */
static Matrix3 rotation(const float *attitude)
{
    float sf = std::sin(attitude[0]), cf = std::cos(attitude[0]);
    float st = std::sin(attitude[1]), ct = std::cos(attitude[1]);
    float sp = std::sin(attitude[2]), cp = std::cos(attitude[2]);
    Matrix3 r;
    r << cp * ct, cp * st * sf - sp * cf, cp * st * cf + sp * sf, sp * ct, sp * st * sf + cp * cf,
        sp * st * cf - cp * sf, -st, ct * sf, ct * cf;
    return r;
}

/* ---- plain ---- */

using Vector6 = Eigen::Matrix<float, 6, 1>;
using Matrix6 = Eigen::Matrix<float, 6, 6>;
using Matrix36 = Eigen::Matrix<float, 3, 6>;
using Row6 = Eigen::Matrix<float, 1, 6>;

static struct {
    Vector6 x = Vector6::Zero();
    Matrix6 p = Matrix6::Identity();
} natural;

COUNTED void natural_imu(const float *attitude)
{
    Matrix3 r = rotation(attitude);
    Matrix6 f = Matrix6::Identity();
    f.block<3, 3>(0, 3) = r * dt;
    Eigen::Matrix<float, 6, 3> g;
    g << r * (0.5f * dt * dt), Matrix3::Identity() * dt;
    natural.x = f * natural.x;
    natural.p = f * natural.p * f.transpose() + g * g.transpose() * (accel * accel);
}

template <bool LDLT> static inline void natural_velocity(const float *velocity)
{
    Matrix36 h = Matrix36::Zero();
    h.block<3, 3>(0, 3) = Matrix3::Identity();
    Matrix3 s = h * natural.p * h.transpose() + Matrix3::Identity() * dvl_variance;
    Eigen::Matrix<float, 6, 3> k;
    if (LDLT) {
        k = s.ldlt().solve(h * natural.p).transpose();
    } else {
        k = natural.p * h.transpose() * s.inverse();
    }
    natural.x += k * (Eigen::Map<const Vector3>(velocity) - h * natural.x);
    natural.p = (Matrix6::Identity() - k * h) * natural.p;
}

COUNTED void natural_dvl(const float *velocity)
{
    natural_velocity<false>(velocity);
}

COUNTED void natural_dvl_ldlt(const float *velocity)
{
    natural_velocity<true>(velocity);
}

COUNTED void natural_depth(float depth)
{
    Row6 h = Row6::Zero();
    h(2) = 1.0f;
    float s = (h * natural.p * h.transpose())(0) + depth_variance;
    Vector6 k = natural.p * h.transpose() / s;
    natural.x += k * (depth - (h * natural.x)(0));
    natural.p = (Matrix6::Identity() - k * h) * natural.p;
}

/* ---- in blocks by hand: position, velocity and their covariance ---- */

static struct {
    Vector3 x = Vector3::Zero(), v = Vector3::Zero();
    Matrix3 xx = Matrix3::Identity(), xv = Matrix3::Zero(), vv = Matrix3::Identity();
} blocks;

COUNTED void blocks_imu(const float *attitude)
{
    Matrix3 r = rotation(attitude) * dt;
    Matrix3 rv = r * blocks.vv;               /* dt R Pvv */
    Matrix3 half = blocks.xv * r.transpose(); /* Pxv R' dt */
    const float q = accel * accel * dt * dt;
    blocks.x += r * blocks.v;
    blocks.xx += half + half.transpose() + rv * r.transpose();
    blocks.xx.diagonal().array() += 0.25f * q * dt * dt;
    blocks.xv += rv + r * (0.5f * q);
    blocks.vv.diagonal().array() += q;
}

/* Component by component: the noise is independent, so no matrix is inverted. */
COUNTED void blocks_dvl(const float *velocity)
{
    for (int i = 0; i < 3; ++i) {
        float s = 1.0f / (blocks.vv(i, i) + dvl_variance), e = velocity[i] - blocks.v(i);
        Vector3 hx = blocks.xv.col(i), hv = blocks.vv.col(i);
        Vector3 kx = hx * s, kv = hv * s;
        blocks.x += kx * e;
        blocks.v += kv * e;
        blocks.xx -= kx * hx.transpose();
        blocks.xv -= kx * hv.transpose();
        blocks.vv -= kv * hv.transpose();
    }
}

COUNTED void blocks_depth(float depth)
{
    float s = 1.0f / (blocks.xx(2, 2) + depth_variance), e = depth - blocks.x(2);
    Vector3 hx = blocks.xx.col(2), hv = blocks.xv.row(2).transpose();
    Vector3 kx = hx * s, kv = hv * s;
    blocks.x += kx * e;
    blocks.v += kv * e;
    blocks.xx -= kx * hx.transpose();
    blocks.xv -= kx * hv.transpose();
    blocks.vv -= kv * hv.transpose();
}

/* ---- the comparison ---- */

int main()
{
    static auvid_nav_t nav;
    auvid_nav_config_t cfg;
    auvid_nav_defaults(&cfg);
    if (auvid_nav_init(&nav, &cfg) != AUVID_OK) {
        return 1;
    }
    for (int tick = 1; tick <= 200; ++tick) {
        float t = 0.02f * (float)tick, depth = 5.0f + 0.1f * t;
        float attitude[3] = {0.05f * t, -0.03f * t, 0.2f * t}, rates[3] = {0.05f, -0.03f, 0.2f};
        float v[3] = {0.5f, 0.1f * t, 0.1f};
        auvid_dvl_sample_t dvl = {};
        dvl.t_us = 20000u * (uint64_t)tick;
        dvl.valid = AUVID_DVL_ALL;
        dvl.lock = AUVID_DVL_BOTTOM;
        for (int i = 0; i < 3; ++i) {
            dvl.velocity[i] = v[i];
        }
        if (auvid_nav_imu(&nav, dvl.t_us, attitude, rates) < 0 || auvid_nav_dvl(&nav, &dvl) < 0 ||
            auvid_nav_depth(&nav, dvl.t_us, depth) < 0) {
            return 2;
        }
        natural_imu(attitude);
        (tick % 2 ? natural_dvl : natural_dvl_ldlt)(v);
        natural_depth(depth);
        blocks_imu(attitude);
        blocks_dvl(v);
        blocks_depth(depth);
        /* They are the same filter. */
        if ((natural.p.topLeftCorner<3, 3>() - blocks.xx).norm() > 1e-3f * blocks.xx.norm() ||
            (natural.x.tail<3>() - blocks.v).norm() > 1e-3f) {
            return 3;
        }
    }
    return 0;
}
