// The accuracy that is possible: a run of the library in the simulator, and its Cramer-Rao bound.
//
// The run: the simulator's Girona500 (Eq. 12-15) under the usual excitation. Known: applied
// wrench, phi, theta, p, q, and the covariance of the unmodelled force (Ornstein-Uhlenbeck, 2 s).
// Unknown: the 13 parameters, the initial velocities, the initial depth. Measured: velocity (DVL),
// yaw rate, depth; each sample as the identifier gets it, until its last set is complete.
//
// The system is linearised about the motion without the unmodelled force. (About the true motion,
// force and acceleration would be correlated.) x = [u v w r depth | unmodelled force X Y Z N]:
//     x(k+1) = Phi(k) x(k) + Gamma(k) pi + w(k),   y = x_i + noise.
// The Kalman filter of this system runs with an assumed pi. The innovation of a measurement has
// variance s and mean E_i (pi - assumed pi); E is the filter's error per unit of each unknown:
//     tick: E <- Phi E + Gamma;   measurement: information += E_i' E_i / s, then E <- E - K E_i.
// The sum is S' Sigma^-1 S of the dense problem, without its matrices. One more column filters the
// measurements of the run. It gives the score, and so the error of the efficient estimate. It also
// gives the sum of squares of the whitened innovations, which shows that the simulator's noise is
// the assumed one.
//
// Left out: the information on pi in the covariance of the measurements (its trace term). Measured
// on a dense case, it lowers the bound by at most 0.5 % of itself at 1 N, 3 % at 3 N.
#ifndef TEST_BOUND_H
#define TEST_BOUND_H

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <vector>

#include "auvid/actuation.h"
#include "simulator.h"

extern "C" {
#include "unity.h"
}

using Eigen::MatrixXd;
using Eigen::Vector4d;
using Eigen::VectorXd;

enum { PARAMETERS = 13, INITIAL = 5, UNKNOWNS = PARAMETERS + INITIAL, DATA = UNKNOWNS, COLUMNS };
enum { YAW_RATE = 3, DEPTH = 4, FORCE = 5, STATES = 9 };
typedef Eigen::Array<double, PARAMETERS, 1> Errors; // one for each parameter, relative to it
typedef Eigen::Matrix<double, PARAMETERS, 1> Parameters;
typedef Eigen::Matrix<double, 4, PARAMETERS> Regressor;
typedef Eigen::Matrix<double, INITIAL, 1> Motion; // u v w r depth
typedef Eigen::Matrix<double, STATES, STATES> Transition;
typedef Eigen::Matrix<double, STATES, PARAMETERS> Input;
typedef Eigen::Matrix<double, STATES, COLUMNS> Deviations;
typedef Eigen::Matrix<double, COLUMNS, COLUMNS> Information;

static const double tick_s = SIM_TICK_US * 1e-6;

struct Measurement {
    int state;
    double value;
};

// True state at the end of a tick, wrench X Y Z N during it, measurements at its end.
struct Tick {
    double phi, theta, p, q;
    Vector4d wrench;
    std::vector<Measurement> measured;
};

struct Run {
    std::vector<Tick> tick;     // the first is the start
    std::vector<Motion> motion; // at each tick, without the unmodelled force
    Errors error;               // of the library
};

struct World {
    double disturbance_N;
    uint32_t sets;
    uint64_t excitation_seed, noise_seed;
};

// Standard deviations; forces of N are 0.4 times those of X, Y, Z.
struct Noise {
    double dvl, rate, depth, disturbance;
    double variance(int state) const
    {
        double deviation = state == DEPTH ? depth : state == YAW_RATE ? rate : dvl;
        return deviation * deviation;
    }
};

static sim_config_t simulator_defaults()
{
    sim_config_t config;
    sim_defaults(&config);
    return config;
}

static const Parameters truth(simulator_defaults().parameter);
static const double correlation_s = simulator_defaults().disturbance_s;
static const double keep = std::exp(-tick_s / correlation_s); // of that force, in a tick
static auvid_identifier_t id;
static auvid_change_detector_t change;

inline Noise noise_of(double disturbance_N)
{
    sim_config_t config = simulator_defaults();
    return {config.dvl_m_s, config.imu_rate_rad_s, config.depth_m, disturbance_N};
}

// ---- the motion without the unmodelled force ----

// The simulator's equations, with attitude, p and q of the run.
static Motion derivative(const sim_config_t &config, const Tick &a, const Tick &b, double part,
                         const Motion &at)
{
    static const int index[INITIAL] = {6, 7, 8, 11, 2};
    const double wrench[6] = {b.wrench(0), b.wrench(1), b.wrench(2), 0, 0, b.wrench(3)};
    double state[12] = {}, change[12];
    state[3] = a.phi + part * (b.phi - a.phi);
    state[4] = a.theta + part * (b.theta - a.theta);
    state[9] = a.p + part * (b.p - a.p);
    state[10] = a.q + part * (b.q - a.q);
    for (int i = 0; i < INITIAL; ++i) {
        state[index[i]] = at(i);
    }
    sim_derivative(&config, state, wrench, change);
    Motion rate;
    for (int i = 0; i < INITIAL; ++i) {
        rate(i) = change[index[i]];
    }
    return rate;
}

static std::vector<Motion> undisturbed(const std::vector<Tick> &tick, const sim_config_t &config,
                                       const Motion &start)
{
    std::vector<Motion> motion(1, start);
    for (size_t k = 1; k < tick.size(); ++k) {
        const Tick &a = tick[k - 1], &b = tick[k];
        Motion x = motion.back();
        Motion k1 = derivative(config, a, b, 0, x);
        Motion k2 = derivative(config, a, b, 0.5, x + tick_s / 2 * k1);
        Motion k3 = derivative(config, a, b, 0.5, x + tick_s / 2 * k2);
        Motion k4 = derivative(config, a, b, 1, x + tick_s * k3);
        motion.push_back(x + tick_s / 6 * (k1 + 2 * k2 + 2 * k3 + k4));
    }
    return motion;
}

// ---- a run of the library in the simulator ----

static auvid_input_t sense(const sim_output_t &out)
{
    const sim_measurement_t &imu = out.sensor[SIM_IMU], &dvl = out.sensor[SIM_DVL];
    const sim_measurement_t &depth = out.sensor[SIM_DEPTH];
    auvid_input_t in = {};
    in.t_us = out.t_us;
    in.imu.present = imu.has;
    in.imu.t_us = imu.t_us;
    in.dvl.present = dvl.has;
    in.dvl.sample.t_us = dvl.t_us;
    in.dvl.sample.lock = AUVID_DVL_BOTTOM;
    in.dvl.sample.valid = AUVID_DVL_ALL;
    in.depth.present = depth.has;
    in.depth.t_us = depth.t_us;
    in.depth.depth_m = auvid_real_t(depth.value[0]);
    for (int i = 0; i < 3; ++i) {
        in.imu.attitude[i] = auvid_real_t(imu.value[i]);
        in.imu.rates[i] = auvid_real_t(imu.value[3 + i]);
        in.dvl.sample.velocity[i] = auvid_real_t(dvl.value[i]);
    }
    return in;
}

static Tick tick_of(const sim_truth_t &t, const sim_output_t &out)
{
    Tick tick = {t.euler[0],
                 t.euler[1],
                 t.nu[3],
                 t.nu[4],
                 {out.wrench[0], out.wrench[1], out.wrench[2], out.wrench[5]},
                 {}};
    for (int i = 0; out.sensor[SIM_DVL].has && i < 3; ++i) {
        tick.measured.push_back({i, out.sensor[SIM_DVL].value[i]});
    }
    if (out.sensor[SIM_IMU].has) {
        tick.measured.push_back({YAW_RATE, out.sensor[SIM_IMU].value[5]});
    }
    if (out.sensor[SIM_DEPTH].has) {
        tick.measured.push_back({DEPTH, out.sensor[SIM_DEPTH].value[0]});
    }
    return tick;
}

// The least-squares optimum of the library's metric; the search reaches it.
static Errors library_error()
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {};
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&id.metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&id.metric, &budget));
    uint32_t active = auvid_metric_active(&id.metric);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, active);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&id.metric, active, pi));
    Errors error;
    for (int i = 0; i < PARAMETERS; ++i) {
        error(i) = double(pi[i]) / truth(i) - 1.0;
    }
    return error;
}

inline Run fly(const World &world)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    auvid_identifier_config_t cfg;
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    static auvid_allocation_t thrusters;
    static auvid_actuation_t actuation;
    auvid_actuation_config_t acting;
    auvid_actuation_defaults(&acting);
    std::copy(amplitude, amplitude + AUVID_DOF_COUNT, cfg.metric.tau_max);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_plan(&acting.excitation, amplitude, 30, world.sets,
                                                      world.excitation_seed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&thrusters, &auvid_allocation_girona500));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_actuation(&id, &actuation, &acting, &thrusters));

    sim_config_t config = simulator_defaults();
    config.seed = world.noise_seed;
    config.disturbance_N = world.disturbance_N;
    config.disturbance_Nm = 0.4 * world.disturbance_N;
    sim_t sim;
    TEST_ASSERT_TRUE(sim_init(&sim, &config));

    sim_output_t seen = {};
    Run run;
    run.tick.push_back(tick_of(sim.truth, seen));
    auvid_output_t out = {};
    bool excited = false;
    while (id.metric.sets.recorded < world.sets) {
        double wrench[6];
        auvid_real_t applied[6];
        for (int i = 0; i < 6; ++i) {
            wrench[i] = double(out.excitation[i]) - (i == 2 ? config.parameter[SIM_WB] : 0.0);
            applied[i] = auvid_real_t(wrench[i]);
        }
        // from the end of the last tick on
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_identifier_applied(&id, sim.truth.t_us, applied, nullptr));
        sim_step(&sim, nullptr, wrench, &seen);
        run.tick.push_back(tick_of(sim.truth, seen));
        auvid_input_t in = sense(seen);
        if (!excited && auvid_identifier_arm(&id) == AUVID_OK) {
            excited = auvid_identifier_excite(&id) == AUVID_OK;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
        TEST_ASSERT_TRUE(run.tick.size() < 1500 * (world.sets + 1));
    }
    Motion start;
    start << 0, 0, 0, 0, config.position[2];
    run.motion = undisturbed(run.tick, config, start);
    run.error = library_error();
    return run;
}

// ---- the linear system ----

// Eq. 12-15: wrench = Y pi.
static Regressor regressor(const Tick &t, const Vector4d &nu, const Vector4d &rate)
{
    double u = nu(0), v = nu(1), w = nu(2), r = nu(3);
    double sf = std::sin(t.phi), cf = std::cos(t.phi), st = std::sin(t.theta);
    double ct = std::cos(t.theta);
    Regressor y = Regressor::Zero();
    y.row(0).head<7>() << rate(0), -v * r, w * t.q, 0, st, -u, -std::fabs(u) * u;
    y.row(1).head<5>() << u * r, rate(1), -w * t.p, 0, -ct * sf;
    y.row(1).segment<2>(7) << -v, -std::fabs(v) * v;
    y.row(2).head<5>() << -u * t.q, v * t.p, rate(2), 0, -ct * cf;
    y.row(2).segment<2>(9) << -w, -std::fabs(w) * w;
    y.row(3).head<4>() << -u * v, u * v, 0, rate(3);
    y.row(3).segment<2>(11) << -r, -std::fabs(r) * r;
    return y;
}

// Transition over the tick that ends at k, at its middle, from x' = A x + B pi by the exponential
// series; parameters relative to their true values.
static void linearise(const Run &run, size_t k, Transition &phi, Input &gamma)
{
    const double difference = 1e-3;
    const Tick &a = run.tick[k - 1], &b = run.tick[k];
    Tick middle = {
        (a.phi + b.phi) / 2, (a.theta + b.theta) / 2, (a.p + b.p) / 2, (a.q + b.q) / 2, {}, {}};
    Vector4d nu = (run.motion[k - 1] + run.motion[k]).head<4>() / 2;
    Vector4d rate = (run.motion[k] - run.motion[k - 1]).head<4>() / tick_s;
    Vector4d mobility = truth.head<4>().cwiseInverse();
    Transition ah = Transition::Zero();
    for (int i = 0; i < 4; ++i) { // nearly all terms are quadratic: the difference is exact
        Vector4d step = difference * Vector4d::Unit(i);
        Vector4d change =
            (regressor(middle, nu + step, rate) - regressor(middle, nu - step, rate)) * truth;
        ah.col(i).head<4>() = -mobility.cwiseProduct(change) / (2 * difference);
        ah(i, FORCE + i) = mobility(i);
        ah(FORCE + i, FORCE + i) = -1 / correlation_s;
    }
    ah.row(DEPTH).head<3>() << -std::sin(middle.theta),
        std::cos(middle.theta) * std::sin(middle.phi),
        std::cos(middle.theta) * std::cos(middle.phi);
    ah *= tick_s;
    Transition series = Transition::Identity() + ah / 2 + ah * ah / 6;
    Input b_pi = Input::Zero();
    b_pi.topRows<4>() = -(mobility.asDiagonal() * regressor(middle, nu, rate) * truth.asDiagonal());
    phi = Transition::Identity() + ah * series;
    gamma = tick_s * series * b_pi;
}

static Vector4d force_variance(const Noise &noise)
{
    double n = noise.disturbance;
    return Vector4d(n * n, n * n, n * n, 0.16 * n * n);
}

// Information of the first `ticks` ticks. Last column: the score; its end: sum of squared
// innovations.
static Information information(const Run &run, const Noise &noise, size_t ticks)
{
    Information sum = Information::Zero();
    Transition covariance = Transition::Zero(), phi;
    Vector4d variance = force_variance(noise);
    covariance.diagonal().tail<4>() = variance;
    Deviations e = Deviations::Zero();
    e.block<INITIAL, INITIAL>(0, PARAMETERS).setIdentity();
    Input gamma;
    for (size_t k = 1; k <= ticks; ++k) {
        linearise(run, k, phi, gamma);
        e = (phi * e).eval();
        e.leftCols<PARAMETERS>() += gamma;
        covariance = (phi * covariance * phi.transpose()).eval();
        covariance.diagonal().tail<4>() += (1 - keep * keep) * variance;
        for (const Measurement &m : run.tick[k].measured) {
            Eigen::Matrix<double, 1, COLUMNS> innovation = e.row(m.state);
            innovation(DATA) += m.value - run.motion[k](m.state);
            double s = covariance(m.state, m.state) + noise.variance(m.state);
            Eigen::Matrix<double, STATES, 1> gain = covariance.col(m.state) / s;
            sum += innovation.transpose() * innovation / s;
            e -= gain * innovation;
            covariance -= (gain * gain.transpose() * s).eval();
        }
    }
    return sum;
}

static Information information(const Run &run, const Noise &noise)
{
    return information(run, noise, run.tick.size() - 1);
}

// Inverse of the information of all unknowns. It is scaled first: initial values are far less
// certain.
static MatrixXd covariance(const MatrixXd &information)
{
    VectorXd scale =
        information.topLeftCorner(UNKNOWNS, UNKNOWNS).diagonal().cwiseSqrt().cwiseInverse();
    MatrixXd scaled =
        scale.asDiagonal() * information.topLeftCorner(UNKNOWNS, UNKNOWNS) * scale.asDiagonal();
    return scale.asDiagonal() * scaled.inverse() * scale.asDiagonal();
}

static Errors bound(const MatrixXd &information)
{
    return covariance(information).diagonal().head<PARAMETERS>().cwiseSqrt();
}

#endif
