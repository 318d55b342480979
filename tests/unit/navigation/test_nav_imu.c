/* Attitude as a quaternion, and an IMU that is not aligned with the body. */
#include "auvid/nav.h"

#include <math.h>
#include <string.h>

#include "unity.h"

#define PI 3.14159265358979323846

static auvid_nav_config_t cfg;
static auvid_nav_t nav;
static uint64_t now;

typedef struct {
    double m[3][3];
} matrix_t;

void setUp(void)
{
    auvid_nav_defaults(&cfg);
    now = 0;
}

void tearDown(void)
{
}

static matrix_t product(matrix_t a, matrix_t b)
{
    matrix_t c;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            c.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
        }
    }
    return c;
}

/* Rz(psi) Ry(theta) Rx(phi) */
static matrix_t rotation(const double *e)
{
    matrix_t x = {{{1, 0, 0}, {0, cos(e[0]), -sin(e[0])}, {0, sin(e[0]), cos(e[0])}}};
    matrix_t y = {{{cos(e[1]), 0, sin(e[1])}, {0, 1, 0}, {-sin(e[1]), 0, cos(e[1])}}};
    matrix_t z = {{{cos(e[2]), -sin(e[2]), 0}, {sin(e[2]), cos(e[2]), 0}, {0, 0, 1}}};
    return product(z, product(y, x));
}

/* a b of quaternions w x y z */
static void multiply(const double *a, const double *b, double *c)
{
    c[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
    c[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
    c[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
    c[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

static void quaternion(const double *e, double *q)
{
    const double z[4] = {cos(e[2] / 2), 0, 0, sin(e[2] / 2)};
    const double y[4] = {cos(e[1] / 2), 0, sin(e[1] / 2), 0};
    const double x[4] = {cos(e[0] / 2), sin(e[0] / 2), 0, 0};
    double zy[4];
    multiply(z, y, zy);
    multiply(zy, x, q);
}

static void init(double phi, double theta, double psi)
{
    cfg.mount.imu_euler[0] = (auvid_real_t)phi;
    cfg.mount.imu_euler[1] = (auvid_real_t)theta;
    cfg.mount.imu_euler[2] = (auvid_real_t)psi;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_init(&nav, &cfg));
}

static void assert_near(double expected, auvid_real_t value)
{
    TEST_ASSERT_TRUE(fabs(expected - (double)value) < 2e-6);
}

/* The filter's attitude is that of the body, and its rates are `rates`. */
static void assert_body(const double *body, const double *rates)
{
    auvid_nav_state_t state;
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_state(&nav, &state));
    for (int i = 0; i < 3; ++i) {
        double error = (double)state.attitude[i] - body[i];
        assert_near(0, (auvid_real_t)(error - 2 * PI * round(error / (2 * PI))));
        assert_near(rates[i], state.rates[i]);
    }
}

static const double body[][3] = {{0, 0, 0},     {0.3, -0.2, 1},   {-0.4, 0.5, -3.1},
                                 {3.0, 0.1, 2}, {0.1, 1.4, 1},    {-2, -1.3, 0},
                                 {PI, 0, PI},   {0, 0.7, -PI / 2}};
enum { BODIES = sizeof body / sizeof body[0] };
static const double body_rates[3] = {0.1, -0.2, 0.3};

/* Feed what an IMU mounted at `mount` outputs at each attitude of the body. */
static void check_mount(const double *mount, bool by_quaternion)
{
    matrix_t m = rotation(mount);
    double of_mount[4], of_body[4], q[4];
    quaternion(mount, of_mount);
    init(mount[0], mount[1], mount[2]);
    for (int k = 0; k < BODIES; ++k) {
        matrix_t r = product(rotation(body[k]), m); /* IMU to world */
        auvid_real_t attitude[4], rates[3];
        quaternion(body[k], of_body);
        multiply(of_body, of_mount, q);
        for (int i = 0; i < 3; ++i) { /* omega_imu = M' omega */
            rates[i] = (auvid_real_t)(m.m[0][i] * body_rates[0] + m.m[1][i] * body_rates[1] +
                                      m.m[2][i] * body_rates[2]);
        }
        now += 20000;
        if (by_quaternion) {
            for (int i = 0; i < 4; ++i) {
                attitude[i] = (auvid_real_t)(k % 2 == 0 ? q[i] : -q[i]);
            }
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu_quaternion(&nav, now, attitude, rates));
        } else {
            attitude[0] = (auvid_real_t)atan2(r.m[2][1], r.m[2][2]);
            attitude[1] = (auvid_real_t)-asin(r.m[2][0]);
            attitude[2] = (auvid_real_t)atan2(r.m[1][0], r.m[0][0]);
            TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu(&nav, now, attitude, rates));
        }
        assert_body(body[k], body_rates);
    }
}

static void test_a_quaternion_gives_the_attitude_of_its_euler_angles(void)
{
    check_mount((const double[]){0, 0, 0}, true);
}

static void test_attitude_and_rates_of_a_turned_imu_become_those_of_the_body(void)
{
    const double mounts[][3] = {{0, 0, PI / 2}, {PI, 0, 0}, {0.2, 0.3, -1}, {0, 0, -PI}};
    for (size_t i = 0; i < sizeof mounts / sizeof mounts[0]; ++i) {
        check_mount(mounts[i], true);
        check_mount(mounts[i], false);
    }
}

static void test_an_imu_mounted_upright_is_usable_with_quaternions(void)
{
    check_mount((const double[]){0, PI / 2, 0}, true);
    check_mount((const double[]){0.3, -PI / 2, 1}, true);
}

static void test_a_pitch_of_90_degrees_keeps_the_rotation(void)
{
    auvid_nav_state_t state;
    const double up[3] = {0.5, PI / 2, 0.2}; /* psi - phi = -0.3 */
    double q[4];
    auvid_real_t w[4];
    quaternion(up, q);
    for (int i = 0; i < 4; ++i) {
        w[i] = (auvid_real_t)q[i];
    }
    init(0, 0, 0);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu_quaternion(&nav, 1, w, cfg.mount.imu_euler));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_state(&nav, &state));
    assert_near(0, state.attitude[0]);
    TEST_ASSERT_TRUE(fabs((double)state.attitude[1] - PI / 2) < 1e-3);
    assert_near(-0.3, state.attitude[2]);
}

static void assert_refused(auvid_status_t status, double w, double x)
{
    const auvid_real_t q[4] = {(auvid_real_t)w, (auvid_real_t)x, 0, 0}, rates[3] = {0};
    auvid_nav_t before = nav;
    TEST_ASSERT_EQUAL_INT(status, auvid_nav_imu_quaternion(&nav, now + 20000, q, rates));
    ++before.imu.invalid;
    TEST_ASSERT_TRUE(memcmp(&before, &nav, sizeof nav) == 0);
}

static void test_a_quaternion_that_is_not_finite_or_not_of_length_one_is_refused(void)
{
    const double tolerance = (double)AUVID_NAV_QUATERNION_TOLERANCE;
    const auvid_real_t rates[3] = {0}, q[4] = {(auvid_real_t)(1 - 0.99 * tolerance), 0, 0, 0},
                       fast[3] = {101, 0, 0};
    init(0, 0, 0);
    assert_refused(AUVID_ERR_NOT_FINITE, NAN, 0);
    assert_refused(AUVID_ERR_NOT_FINITE, 1, INFINITY);
    assert_refused(AUVID_ERR_RANGE, 0, 0);
    assert_refused(AUVID_ERR_RANGE, 1 + 1.01 * tolerance, 0);
    assert_refused(AUVID_ERR_RANGE, 0, 1 - 1.01 * tolerance);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_imu_quaternion(&nav, now, q, fast));
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu_quaternion(&nav, now, q, rates));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_SAME, auvid_nav_imu_quaternion(&nav, now, q, rates));
    now += cfg.gap_us + 1;
    TEST_ASSERT_EQUAL_INT(AUVID_GAP, auvid_nav_imu_quaternion(&nav, now, q, rates));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_TIME_BACK, auvid_nav_imu_quaternion(&nav, now - 1, q, rates));
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NULL, auvid_nav_imu_quaternion(&nav, now, NULL, rates));
    memset(&nav, 0, sizeof nav);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_STATE, auvid_nav_imu_quaternion(&nav, now, q, rates));
}

static void test_a_quaternion_within_the_tolerance_is_normalised(void)
{
    double q[4];
    auvid_real_t w[4], rates[3] = {0};
    quaternion(body[1], q);
    for (int i = 0; i < 4; ++i) {
        w[i] = (auvid_real_t)(1.009 * q[i]);
    }
    init(0, 0, 0);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_nav_imu_quaternion(&nav, 1, w, rates));
    assert_body(body[1], (const double[]){0, 0, 0});
}

static void test_an_impossible_mounting_of_the_imu_is_refused(void)
{
    cfg.mount.imu_euler[1] = 11;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_RANGE, auvid_nav_init(&nav, &cfg));
    cfg.mount.imu_euler[1] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_NOT_FINITE, auvid_nav_init(&nav, &cfg));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_quaternion_gives_the_attitude_of_its_euler_angles);
    RUN_TEST(test_attitude_and_rates_of_a_turned_imu_become_those_of_the_body);
    RUN_TEST(test_an_imu_mounted_upright_is_usable_with_quaternions);
    RUN_TEST(test_a_pitch_of_90_degrees_keeps_the_rotation);
    RUN_TEST(test_a_quaternion_that_is_not_finite_or_not_of_length_one_is_refused);
    RUN_TEST(test_a_quaternion_within_the_tolerance_is_normalised);
    RUN_TEST(test_an_impossible_mounting_of_the_imu_is_refused);
    return UNITY_END();
}
