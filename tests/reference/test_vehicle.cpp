// Compares Girona500's forward dynamics and kinematics with Fossen's matrices in double:
// M nu' + C(nu) nu + D(nu) nu + g = tau. M is diagonal and C(nu) follows from it by cross products
// (Fossen 2011, 3.3). Only the four modelled degrees of freedom are compared.
#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <cmath>
#include <cstdint>

extern "C" {
#include "auvid/vehicle.h"
#include "unity.h"
}

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

static const double eps = double(AUVID_EPSILON);
static const int dofs[4] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};

static uint32_t seed = 1;

// Uniform in +-size, rounded to auvid_real_t.
static double draw(double size)
{
    seed = seed * 1664525u + 1013904223u;
    return double(auvid_real_t(size * (double(seed >> 8) / 8388608.0 - 1)));
}

void setUp()
{
    seed = 1;
}

void tearDown()
{
}

static Eigen::Matrix3d cross(const Eigen::Vector3d &a)
{
    Eigen::Matrix3d s;
    s << 0, -a(2), a(1), a(2), 0, -a(0), -a(1), a(0), 0;
    return s;
}

// C = [0, -S(M11 v); -S(M11 v), -S(M22 omega)]. The model does not contain the effects of roll and
// pitch inertia.
static Matrix6 coriolis(const Vector6 &mass, const Vector6 &nu)
{
    Eigen::Vector3d linear = mass.head<3>().cwiseProduct(nu.head<3>());
    Eigen::Vector3d angular(0, 0, mass(5) * nu(5));
    Matrix6 c = Matrix6::Zero();
    c.topRightCorner<3, 3>() = -cross(linear);
    c.bottomLeftCorner<3, 3>() = -cross(linear);
    c.bottomRightCorner<3, 3>() = -cross(angular);
    return c;
}

struct State {
    double phi, theta;
    Vector6 nu, tau;
    Vector6 mass, linear, quadratic, bias;
    double weight;
    double pi[AUVID_G500_COUNT];
    auvid_sample_t sample;
    auvid_real_t parameter[AUVID_MAX_PARAMETERS];
};

static State random_state()
{
    State s;
    s.sample = auvid_sample_t();
    s.phi = s.sample.phi = auvid_real_t(draw(1.5));
    s.theta = s.sample.theta = auvid_real_t(draw(1.5));
    s.sample.psi = auvid_real_t(draw(10));
    for (int j = 0; j < 6; ++j) {
        s.nu(j) = s.sample.nu[j] = auvid_real_t(draw(2));
        s.tau(j) = s.sample.tau[j] = auvid_real_t(draw(200));
    }
    s.mass.setZero();
    s.linear.setZero();
    s.quadratic.setZero();
    s.bias.setZero();
    static const int mass[4] = {AUVID_G500_M_U, AUVID_G500_M_V, AUVID_G500_M_W, AUVID_G500_M_R};
    static const int drag[4] = {AUVID_G500_X_U, AUVID_G500_Y_V, AUVID_G500_Z_W, AUVID_G500_N_R};
    static const int squared[4] = {AUVID_G500_X_UU, AUVID_G500_Y_VV, AUVID_G500_Z_WW,
                                   AUVID_G500_N_RR};
    static const int bias[4] = {AUVID_G500_X_0, AUVID_G500_Y_0, AUVID_G500_Z_0, AUVID_G500_N_0};
    for (int k = 0; k < 4; ++k) {
        int j = dofs[k];
        s.pi[mass[k]] = s.mass(j) = double(auvid_real_t(400 + draw(300)));
        s.pi[drag[k]] = s.linear(j) = draw(200);
        s.pi[squared[k]] = s.quadratic(j) = draw(500);
        s.pi[bias[k]] = s.bias(j) = draw(20);
    }
    s.pi[AUVID_G500_W_B] = s.weight = draw(50);
    for (int i = 0; i < AUVID_G500_COUNT; ++i) {
        s.parameter[i] = auvid_real_t(s.pi[i]);
    }
    return s;
}

// All terms except M nu' and tau, and the sum of the terms' absolute values.
static Vector6 forces(const State &s, const Matrix6 &c, Vector6 *size)
{
    // restoring force for the weight W - B, as g(eta) on the left-hand side
    Eigen::Matrix3d r = (Eigen::AngleAxisd(s.theta, Eigen::Vector3d::UnitY()) *
                         Eigen::AngleAxisd(s.phi, Eigen::Vector3d::UnitX()))
                            .toRotationMatrix();
    Eigen::Vector3d g = -r.transpose() * Eigen::Vector3d(0, 0, s.weight);
    Vector6 drag =
        s.linear.cwiseProduct(s.nu) + s.quadratic.cwiseProduct(s.nu.cwiseAbs().cwiseProduct(s.nu));
    Vector6 all = c * s.nu - drag - s.bias;
    all.head<3>() += g;
    *size = c.cwiseAbs() * s.nu.cwiseAbs() + s.linear.cwiseAbs().cwiseProduct(s.nu.cwiseAbs()) +
            s.quadratic.cwiseAbs().cwiseProduct(s.nu.cwiseAbs2()) + s.bias.cwiseAbs() +
            s.tau.cwiseAbs();
    size->array() += std::fabs(s.weight);
    return all;
}

// The printed Eq. 13 has m_w w q where the matrix has m_w w p.
static void compare(const auvid_vehicle_t &vehicle, bool coupled, bool printed)
{
    for (int trial = 0; trial < 2000; ++trial) {
        State s = random_state();
        Matrix6 c = coupled ? coriolis(s.mass, s.nu) : Matrix6::Zero();
        Vector6 size, rest = forces(s, c, &size);
        if (printed) {
            rest(1) += s.mass(2) * s.nu(2) * (s.nu(3) - s.nu(4));
            size(1) += s.mass(2) * std::fabs(s.nu(2)) * (std::fabs(s.nu(3)) + std::fabs(s.nu(4)));
        }
        auvid_real_t nu_dot[6] = {0}, residual[6];
        TEST_ASSERT_TRUE(vehicle.acceleration(vehicle.context, &s.sample, s.parameter, nu_dot));
        for (int j : dofs) {
            // 14 products and sums, each with half an eps: 1e-6 of the terms in float32
            double allowed = 8 * eps * size(j) / s.mass(j);
            double exact = (s.tau(j) - rest(j)) / s.mass(j);
            TEST_ASSERT_DOUBLE_WITHIN(allowed, exact, double(nu_dot[j]));
            s.sample.nu_dot[j] = auvid_real_t(draw(1));
        }
        TEST_ASSERT_EQUAL_DOUBLE(0, double(nu_dot[AUVID_ROLL]));
        TEST_ASSERT_EQUAL_DOUBLE(0, double(nu_dot[AUVID_PITCH]));
        auvid_vehicle_residual(&vehicle, &s.sample, s.parameter, residual);
        for (int j : dofs) {
            double inertia = s.mass(j) * double(s.sample.nu_dot[j]);
            double exact = inertia + rest(j) - s.tau(j);
            double allowed = 8 * eps * (size(j) + std::fabs(inertia));
            TEST_ASSERT_DOUBLE_WITHIN(allowed, exact, double(residual[j]));
        }
        TEST_ASSERT_EQUAL_DOUBLE(0, double(residual[AUVID_ROLL]));
        TEST_ASSERT_EQUAL_DOUBLE(0, double(residual[AUVID_PITCH]));
    }
}

static void test_girona500_is_fossens_matrix_equation()
{
    compare(auvid_girona500, true, false);
}

static void test_printed_girona500_differs_in_one_term()
{
    compare(auvid_girona500_printed, true, true);
}

static void test_decoupled_girona500_is_the_matrix_equation_without_c()
{
    compare(auvid_girona500_decoupled, false, false);
}

// nu' C(nu) nu = 0: the coupling terms do no work with Fossen's w p; with the printed w q they do.
static void test_coupling_does_no_work()
{
    for (int trial = 0; trial < 500; ++trial) {
        State s = random_state();
        s.sample.nu[AUVID_ROLL] = s.sample.nu[AUVID_PITCH] = 0; // their equations are not modelled
        auvid_real_t with[6], without[6];
        auvid_vehicle_residual(&auvid_girona500, &s.sample, s.parameter, with);
        auvid_vehicle_residual(&auvid_girona500_decoupled, &s.sample, s.parameter, without);
        double power = 0, size = 0;
        for (int j : dofs) {
            double n = double(s.sample.nu[j]);
            power += n * (double(with[j]) - double(without[j]));
            size += std::fabs(n) * (std::fabs(double(with[j])) + 700 * 4 + 2000);
        }
        TEST_ASSERT_DOUBLE_WITHIN(8 * eps * size, 0, power);
    }
}

// ---- kinematics ----

static Eigen::Matrix3d rotation(double phi, double theta, double psi)
{
    return (Eigen::AngleAxisd(psi, Eigen::Vector3d::UnitZ()) *
            Eigen::AngleAxisd(theta, Eigen::Vector3d::UnitY()) *
            Eigen::AngleAxisd(phi, Eigen::Vector3d::UnitX()))
        .toRotationMatrix();
}

// The derivative of R along the library's Euler rates must be R S(omega). dR/dangle is computed by
// central differences.
static void test_euler_rates_turn_the_rotation_as_the_body_rates_do()
{
    for (int trial = 0; trial < 2000; ++trial) {
        double angle[3] = {draw(3.1), draw(1.5), draw(20)};
        auvid_real_t nu[6], eta_dot[6];
        for (auvid_real_t &x : nu) {
            x = auvid_real_t(draw(2));
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_kinematics(auvid_real_t(angle[0]), auvid_real_t(angle[1]),
                                                     auvid_real_t(angle[2]), nu, eta_dot));
        Eigen::Matrix3d r = rotation(angle[0], angle[1], angle[2]);
        Eigen::Vector3d velocity = r * Eigen::Vector3d(nu[0], nu[1], nu[2]);
        for (int i = 0; i < 3; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN(6 * 4 * eps, velocity(i), double(eta_dot[i]));
        }
        Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
        for (int k = 0; k < 3; ++k) {
            const double h = 1e-5;
            double up[3] = {angle[0], angle[1], angle[2]}, down[3] = {angle[0], angle[1], angle[2]};
            up[k] += h;
            down[k] -= h;
            turned += double(eta_dot[3 + k]) / (2 * h) *
                      (rotation(up[0], up[1], up[2]) - rotation(down[0], down[1], down[2]));
        }
        Eigen::Matrix3d exact = r * cross(Eigen::Vector3d(nu[3], nu[4], nu[5]));
        double steep = 1 / std::cos(angle[1]); // the rates reach 4 times this
        double allowed = 40 * eps * steep * steep + 1e-9 * steep;
        TEST_ASSERT_TRUE((turned - exact).cwiseAbs().maxCoeff() < allowed);
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_girona500_is_fossens_matrix_equation);
    RUN_TEST(test_printed_girona500_differs_in_one_term);
    RUN_TEST(test_decoupled_girona500_is_the_matrix_equation_without_c);
    RUN_TEST(test_coupling_does_no_work);
    RUN_TEST(test_euler_rates_turn_the_rotation_as_the_body_rates_do);
    return UNITY_END();
}
