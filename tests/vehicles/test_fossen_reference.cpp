// Compares the 6-DoF model with the textbook in double. The 6 x 6 matrices follow from mass,
// inertia, added mass, weight, buoyancy and their centres. C(nu) follows from cross products of
// M nu (Fossen 2011, Eq. 3.46), and restoring moments follow from the two forces. Only
// parameters_of() uses the parameters' sums.
#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>

extern "C" {
#include "auvid/fossen.h"
#include "unity.h"
}

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

static const double eps = double(AUVID_EPSILON);
// Relative to the sum of the terms' absolute values: ten products and sums, each with half an eps.
static const double bound = 4 * eps; // 4.8e-7 in float32

static uint32_t seed;

void setUp()
{
    seed = 1;
}

void tearDown()
{
}

// Uniform in +-size, rounded to auvid_real_t.
static double draw(double size)
{
    seed = seed * 1664525u + 1013904223u;
    return double(auvid_real_t(size * (double(seed >> 8) / 8388608.0 - 1)));
}

static Matrix3 cross(const Vector3 &a)
{
    Matrix3 s;
    s << 0, -a(2), a(1), a(2), 0, -a(0), -a(1), a(0), 0;
    return s;
}

// A vehicle with the textbook's coefficients.
struct Textbook {
    double m, W, B;
    Vector3 inertia, r_G, r_B; // r_G has no y: port-starboard symmetry
    Vector6 added;             // -X_udot, -Y_vdot, ...: positive
    double X_qdot, Y_pdot, Y_rdot, Z_qdot;
    Vector6 linear, quadratic; // X_u, X_uu, ...: negative
    Vector6 constant;
};

static Textbook random_vehicle(bool coupled)
{
    Textbook t;
    t.m = 20 + draw(10);
    t.W = 200 + draw(50);
    t.B = 200 + draw(50);
    for (int i = 0; i < 3; ++i) {
        t.inertia(i) = 2 + draw(1);
        t.r_B(i) = draw(0.1);
        t.r_G(i) = i == 1 ? 0 : draw(coupled ? 0.1 : 0);
    }
    for (int j = 0; j < 6; ++j) {
        double size = j < 3 ? 1 : 0.05;
        t.added(j) = size * (15 + draw(14));
        t.linear(j) = size * draw(30);
        t.quadratic(j) = size * draw(200);
        t.constant(j) = size * draw(10);
    }
    double size = coupled ? 1 : 0;
    t.X_qdot = draw(size);
    t.Y_pdot = draw(size);
    t.Y_rdot = draw(size);
    t.Z_qdot = draw(size);
    return t;
}

static Matrix6 inertia_of(const Textbook &t)
{
    Matrix6 m = Matrix6::Zero();
    m.topLeftCorner<3, 3>() = t.m * Matrix3::Identity();
    m.topRightCorner<3, 3>() = -t.m * cross(t.r_G);
    m.bottomLeftCorner<3, 3>() = t.m * cross(t.r_G);
    m.bottomRightCorner<3, 3>() = t.inertia.asDiagonal();
    m += Matrix6(t.added.asDiagonal());
    m(0, 4) -= t.X_qdot;
    m(4, 0) -= t.X_qdot;
    m(1, 3) -= t.Y_pdot;
    m(3, 1) -= t.Y_pdot;
    m(1, 5) -= t.Y_rdot;
    m(5, 1) -= t.Y_rdot;
    m(2, 4) -= t.Z_qdot;
    m(4, 2) -= t.Z_qdot;
    return m;
}

static Matrix6 coriolis(const Matrix6 &m, const Vector6 &nu)
{
    Vector6 momentum = m * nu;
    Matrix6 c = Matrix6::Zero();
    c.topRightCorner<3, 3>() = -cross(momentum.head<3>());
    c.bottomLeftCorner<3, 3>() = -cross(momentum.head<3>());
    c.bottomRightCorner<3, 3>() = -cross(momentum.tail<3>());
    return c;
}

static Matrix3 rotation(double phi, double theta, double psi)
{
    return (Eigen::AngleAxisd(psi, Vector3::UnitZ()) * Eigen::AngleAxisd(theta, Vector3::UnitY()) *
            Eigen::AngleAxisd(phi, Vector3::UnitX()))
        .toRotationMatrix();
}

// g(eta), on the left-hand side.
static Vector6 restoring(const Textbook &t, const Matrix3 &r)
{
    Vector3 weight = r.transpose() * Vector3(0, 0, t.W);
    Vector3 buoyancy = r.transpose() * Vector3(0, 0, -t.B);
    Vector6 g;
    g << -weight - buoyancy, -t.r_G.cross(weight) - t.r_B.cross(buoyancy);
    return g;
}

static void parameters_of(const Textbook &t, auvid_real_t *pi)
{
    double exact[AUVID_FOSSEN_COUNT] = {0};
    for (int i = 0; i < 3; ++i) {
        exact[AUVID_FOSSEN_M_U + i] = t.m + t.added(i);
        exact[AUVID_FOSSEN_M_P + i] = t.inertia(i) + t.added(3 + i);
        exact[AUVID_FOSSEN_X_G + i] = t.r_G(i) * t.W - t.r_B(i) * t.B;
    }
    for (int j = 0; j < 6; ++j) {
        exact[AUVID_FOSSEN_X_U + j] = t.linear(j);
        exact[AUVID_FOSSEN_X_UU + j] = t.quadratic(j);
        exact[AUVID_FOSSEN_X_0 + j] = t.constant(j);
    }
    exact[AUVID_FOSSEN_W_B] = t.W - t.B;
    exact[AUVID_FOSSEN_M_UQ] = t.m * t.r_G(2) - t.X_qdot;
    exact[AUVID_FOSSEN_M_VP] = -t.m * t.r_G(2) - t.Y_pdot;
    exact[AUVID_FOSSEN_M_VR] = t.m * t.r_G(0) - t.Y_rdot;
    exact[AUVID_FOSSEN_M_WQ] = -t.m * t.r_G(0) - t.Z_qdot;
    for (int i = 0; i < AUVID_FOSSEN_COUNT; ++i) {
        pi[i] = auvid_real_t(exact[i]);
    }
}

static auvid_sample_t random_motion()
{
    auvid_sample_t s = auvid_sample_t();
    s.phi = auvid_real_t(draw(3));
    s.theta = auvid_real_t(draw(1.5));
    s.psi = auvid_real_t(draw(10));
    for (int j = 0; j < 6; ++j) {
        s.nu[j] = auvid_real_t(draw(2));
        s.nu_dot[j] = auvid_real_t(draw(1));
        s.tau[j] = auvid_real_t(draw(j < 3 ? 100 : 10));
    }
    return s;
}

static Vector6 vector_of(const auvid_real_t *x)
{
    Vector6 v;
    for (int j = 0; j < 6; ++j) {
        v(j) = double(x[j]);
    }
    return v;
}

// All terms except M nu' and tau, and the sum of the terms' absolute values.
static Vector6 forces(const Textbook &t, const auvid_sample_t &s, Vector6 *size)
{
    Vector6 nu = vector_of(s.nu), magnitude = nu.cwiseAbs();
    Matrix6 m = inertia_of(t);
    Matrix3 r = rotation(double(s.phi), double(s.theta), double(s.psi));
    Vector6 drag =
        t.linear.cwiseProduct(nu) + t.quadratic.cwiseProduct(magnitude.cwiseProduct(nu));
    *size = coriolis(m.cwiseAbs(), magnitude).cwiseAbs() * magnitude;
    size->head<3>().array() += std::fabs(t.W - t.B);
    size->tail<3>().array() += (t.r_G * t.W - t.r_B * t.B).cwiseAbs().sum();
    *size += t.linear.cwiseAbs().cwiseProduct(magnitude) +
             t.quadratic.cwiseAbs().cwiseProduct(magnitude.cwiseAbs2()) + t.constant.cwiseAbs() +
             vector_of(s.tau).cwiseAbs();
    return coriolis(m, nu) * nu - drag + restoring(t, r) - t.constant;
}

static void test_residual_is_the_textbooks()
{
    double worst = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        Textbook t = random_vehicle(trial % 2 == 0);
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0}, residual[6];
        parameters_of(t, pi);
        auvid_sample_t s = random_motion();
        Vector6 size, rest = forces(t, s, &size), nu_dot = vector_of(s.nu_dot);
        Vector6 exact = inertia_of(t) * nu_dot + rest - vector_of(s.tau);
        size += inertia_of(t).cwiseAbs() * nu_dot.cwiseAbs();
        auvid_vehicle_residual(&auvid_fossen, &s, pi, residual);
        worst = std::max(
            worst, (vector_of(residual) - exact).cwiseAbs().cwiseQuotient(size).maxCoeff());
    }
    std::printf("residual: worst error %.1e of the sum of its terms\n", worst);
    TEST_ASSERT_TRUE(worst <= bound);
}

static void test_forward_dynamics_are_the_textbooks()
{
    double worst = 0, relative = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        Textbook t = random_vehicle(trial % 2 == 0);
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0}, nu_dot[6] = {0};
        parameters_of(t, pi);
        auvid_sample_t s = random_motion();
        Matrix6 m = inertia_of(t), inverse = m.inverse();
        TEST_ASSERT_TRUE(m.llt().info() == Eigen::Success);
        Vector6 size, rest = forces(t, s, &size);
        Vector6 exact = inverse * (vector_of(s.tau) - rest);
        // effect of an error in each force, and in each entry of M, on the acceleration
        Vector6 allowed = inverse.cwiseAbs() * (size + m.cwiseAbs() * exact.cwiseAbs());
        TEST_ASSERT_TRUE(auvid_fossen.acceleration(auvid_fossen.context, &s, pi, nu_dot));
        Vector6 error = (vector_of(nu_dot) - exact).cwiseAbs();
        worst = std::max(worst, error.cwiseQuotient(allowed).maxCoeff());
        relative = std::max(relative, error.norm() / exact.norm());
    }
    std::printf("forward dynamics: worst error %.1e of the sum of its terms, %.1e of |nu_dot|\n",
                worst, relative);
    TEST_ASSERT_TRUE(worst <= bound);
}

// The power of inertia, nu' M nu_dot, equals the power of all other forces: C(nu) nu has none.
static void test_coriolis_forces_do_no_work()
{
    for (int trial = 0; trial < 2000; ++trial) {
        Textbook t = random_vehicle(true);
        t.linear.setZero();
        t.quadratic.setZero();
        t.constant.setZero();
        t.B = t.W;
        t.r_B = t.r_G;
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0}, residual[6];
        parameters_of(t, pi);
        auvid_sample_t s = random_motion();
        std::memset(s.nu_dot, 0, sizeof s.nu_dot);
        std::memset(s.tau, 0, sizeof s.tau);
        Vector6 size;
        (void)forces(t, s, &size);
        auvid_vehicle_residual(&auvid_fossen, &s, pi, residual);
        double power = vector_of(residual).dot(vector_of(s.nu));
        double largest = size.dot(vector_of(s.nu).cwiseAbs());
        TEST_ASSERT_TRUE(vector_of(residual).norm() > 0.1);
        TEST_ASSERT_DOUBLE_WITHIN(bound * largest, 0, power);
    }
}

struct Motion {
    Vector3 position, angles;
    Vector6 nu;
    double work; // of thrust and drag
};

static Motion rate_of(const Motion &x, const Textbook &t, const auvid_real_t *pi,
                      const Vector6 &tau)
{
    auvid_sample_t s = auvid_sample_t();
    auvid_real_t nu_dot[6], eta_dot[6];
    s.phi = auvid_real_t(x.angles(0));
    s.theta = auvid_real_t(x.angles(1));
    s.psi = auvid_real_t(x.angles(2));
    for (int j = 0; j < 6; ++j) {
        s.nu[j] = auvid_real_t(x.nu(j));
        s.tau[j] = auvid_real_t(tau(j));
    }
    TEST_ASSERT_TRUE(auvid_fossen.acceleration(auvid_fossen.context, &s, pi, nu_dot));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_kinematics(s.phi, s.theta, s.psi, s.nu, eta_dot));
    Motion d;
    d.nu = vector_of(nu_dot);
    d.position = vector_of(eta_dot).head<3>();
    d.angles = vector_of(eta_dot).tail<3>();
    Vector6 drag = t.linear.cwiseProduct(x.nu) +
                   t.quadratic.cwiseProduct(x.nu.cwiseAbs().cwiseProduct(x.nu));
    d.work = x.nu.dot(tau + drag + t.constant);
    return d;
}

static Motion after(const Motion &x, double h, const Motion &d)
{
    return Motion{x.position + h * d.position, x.angles + h * d.angles, x.nu + h * d.nu,
                  x.work + h * d.work};
}

static double energy_of(const Motion &x, const Textbook &t)
{
    Matrix3 r = rotation(x.angles(0), x.angles(1), x.angles(2));
    double lift = t.B * (x.position + r * t.r_B)(2) - t.W * (x.position + r * t.r_G)(2);
    return 0.5 * x.nu.dot(inertia_of(t) * x.nu) + lift;
}

// Ten seconds of motion with thrust: only the work of thrust and drag changes the sum of kinetic
// energy and potential energy of weight and buoyancy.
static void test_energy_changes_by_the_work_of_thrust_and_drag()
{
    for (int trial = 0; trial < 5; ++trial) {
        Textbook t = random_vehicle(true);
        t.r_B = Vector3(0.01, -0.005, -0.1); // upright
        t.r_G = Vector3(0.01, 0, 0.05);
        t.B = t.W + draw(2);
        t.linear = -t.linear.cwiseAbs();
        t.quadratic = -t.quadratic.cwiseAbs();
        t.constant.setZero();
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
        parameters_of(t, pi);
        Motion x{Vector3::Zero(), Vector3(draw(0.5), draw(0.5), draw(3)), Vector6::Zero(), 0};
        for (int j = 0; j < 6; ++j) {
            x.nu(j) = draw(j < 3 ? 1 : 0.5);
        }
        const double h = 0.005;
        double before = energy_of(x, t), moved = 0;
        for (int step = 0; step < 2000; ++step) {
            Vector6 tau;
            for (int j = 0; j < 6; ++j) {
                tau(j) = (j < 3 ? 20 : 2) * std::sin(0.5 * (j + 1) * (step / 20));
            }
            Motion a = rate_of(x, t, pi, tau);
            Motion b = rate_of(after(x, h / 2, a), t, pi, tau);
            Motion c = rate_of(after(x, h / 2, b), t, pi, tau);
            Motion d = rate_of(after(x, h, c), t, pi, tau);
            x = after(after(after(after(x, h / 6, a), h / 3, b), h / 3, c), h / 6, d);
            moved += h * (std::fabs(a.work) + t.W * a.position.norm());
        }
        double allowed = (sizeof(auvid_real_t) == 4 ? 1e-6 : 1e-8) * moved;
        TEST_ASSERT_DOUBLE_WITHIN(allowed, before + x.work, energy_of(x, t));
    }
}

// Without roll and pitch rates and without couplings in M, the equations of surge, sway, heave and
// yaw are Girona500's.
static void test_girona500_is_the_special_case_without_roll_and_pitch()
{
    for (int trial = 0; trial < 2000; ++trial) {
        Textbook t = random_vehicle(false);
        t.r_B = Vector3(0, 0, t.r_B(2)); // Eq. 15 has no restoring moment
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0}, girona[AUVID_MAX_PARAMETERS] = {0};
        parameters_of(t, pi);
        static const int map[AUVID_G500_COUNT] = {
            AUVID_FOSSEN_M_U, AUVID_FOSSEN_M_V,  AUVID_FOSSEN_M_W, AUVID_FOSSEN_M_R,
            AUVID_FOSSEN_W_B, AUVID_FOSSEN_X_U,  AUVID_FOSSEN_X_UU, AUVID_FOSSEN_Y_V,
            AUVID_FOSSEN_Y_VV, AUVID_FOSSEN_Z_W, AUVID_FOSSEN_Z_WW, AUVID_FOSSEN_N_R,
            AUVID_FOSSEN_N_RR, AUVID_FOSSEN_X_0, AUVID_FOSSEN_Y_0, AUVID_FOSSEN_Z_0,
            AUVID_FOSSEN_N_0};
        for (int i = 0; i < AUVID_G500_COUNT; ++i) {
            girona[i] = pi[map[i]];
        }
        auvid_sample_t s = random_motion();
        s.nu[AUVID_ROLL] = s.nu[AUVID_PITCH] = 0;
        Vector6 size;
        (void)forces(t, s, &size);
        size += inertia_of(t).cwiseAbs() * vector_of(s.nu_dot).cwiseAbs();
        auvid_real_t ours[6], theirs[6];
        auvid_vehicle_residual(&auvid_fossen, &s, pi, ours);
        auvid_vehicle_residual(&auvid_girona500, &s, girona, theirs);
        for (int j : {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW}) {
            TEST_ASSERT_DOUBLE_WITHIN(bound * size(j), double(theirs[j]), double(ours[j]));
        }
    }
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_residual_is_the_textbooks);
    RUN_TEST(test_forward_dynamics_are_the_textbooks);
    RUN_TEST(test_coriolis_forces_do_no_work);
    RUN_TEST(test_energy_changes_by_the_work_of_thrust_and_drag);
    RUN_TEST(test_girona500_is_the_special_case_without_roll_and_pitch);
    return UNITY_END();
}
