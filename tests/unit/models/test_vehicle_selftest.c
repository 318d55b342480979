/*
 * The self-test of models accepts consistent ones, and names what disagrees. Models with larger
 * sizes: tests/vehicles/test_selftests.c.
 */
#include <math.h>
#include <string.h>

#include "auvid/vehicle.h"
#include "unity.h"

static auvid_vehicle_t vehicle;
static auvid_vehicle_fault_t fault;
static const auvid_real_t *const pi = auvid_girona500_paper;

void setUp(void)
{
    vehicle = auvid_girona500;
    memset(&fault, 0xFF, sizeof fault);
}

void tearDown(void)
{
}

static void test_the_three_models_of_girona500_are_consistent(void)
{
    const auvid_vehicle_t *const model[] = {&auvid_girona500, &auvid_girona500_printed,
                                            &auvid_girona500_decoupled};
    for (int k = 0; k < 3; ++k) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_selftest(model[k], pi, 0, 0, &fault));
        TEST_ASSERT_NULL(fault.what);
    }
}

static void test_an_averaged_model_is_consistent_but_for_its_acceleration(void)
{
    static auvid_averaged_t model;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_averaged_init(&model, &auvid_girona500, 100000, 200000));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_vehicle_selftest(&model.vehicle, pi, 0, AUVID_C(0.01), &fault));
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_selftest(&model.vehicle, pi, 0, 0, &fault));
    TEST_ASSERT_EQUAL_STRING("acceleration", fault.what);
}

static void expect(const char *what, int dof, int parameter)
{
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_selftest(&vehicle, pi, 0, 0, &fault));
    TEST_ASSERT_EQUAL_STRING(what, fault.what);
    TEST_ASSERT_EQUAL_INT(dof, fault.dof);
    TEST_ASSERT_EQUAL_INT(parameter, fault.parameter);
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_selftest(&vehicle, pi, 0, 0, NULL));
    setUp();
}

/* ---- wrong functions ---- */

static void right_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                           auvid_real_t *e)
{
    (void)context;
    auvid_vehicle_residual(&auvid_girona500, s, p, e);
}

static void wrong_drag(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                       auvid_real_t *e)
{
    right_residual(context, s, p, e);
    e[AUVID_SWAY] += AUVID_C(0.01) * p[AUVID_G500_Y_VV] * s->nu[1];
}

static void wrong_constant(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                           auvid_real_t *e)
{
    right_residual(context, s, p, e);
    e[AUVID_YAW] += 1;
}

static void wrong_sign(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                       auvid_real_t *e)
{
    right_residual(context, s, p, e);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        e[j] += auvid_girona500.columns[j] != 0 ? 2 * s->tau[j] : 0;
    }
}

static void not_finite(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                       auvid_real_t *e)
{
    right_residual(context, s, p, e);
    e[AUVID_HEAVE] = (auvid_real_t)NAN;
}

static void reads_tau(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                      auvid_regressor_t *y)
{
    auvid_girona500.regressor(context, s, p, y);
    y->row[AUVID_SURGE][AUVID_G500_X_U] += s->tau[0];
}

static bool heavy(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                  auvid_real_t *nu_dot)
{
    bool any = auvid_girona500.acceleration(auvid_girona500.context, s, p, nu_dot);
    (void)context;
    nu_dot[AUVID_YAW] *= AUVID_C(0.99);
    return any;
}

static bool none(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                 auvid_real_t *nu_dot)
{
    (void)context;
    (void)s;
    (void)p;
    (void)nu_dot;
    return false;
}

static void test_a_residual_that_differs_from_the_regressor_is_named_with_its_parameter(void)
{
    vehicle.residual = right_residual;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_selftest(&vehicle, pi, 0, 0, NULL));
    vehicle.residual = wrong_drag;
    expect("residual", AUVID_SWAY, AUVID_G500_Y_VV);
    vehicle.residual = wrong_constant;
    expect("residual", AUVID_YAW, -1);
}

static void test_a_row_that_reads_the_wrench_is_named(void)
{
    vehicle.regressor = reads_tau; /* with the same context */
    expect("regressor", AUVID_SURGE, AUVID_G500_X_U);
}

static void test_a_missing_column_is_named(void)
{
    vehicle.columns[AUVID_SURGE] &= ~(1u << AUVID_G500_M_V);
    expect("columns", AUVID_SURGE, AUVID_G500_M_V);
    vehicle.regressor = NULL; /* the same by the residual */
    vehicle.residual = right_residual;
    vehicle.columns[AUVID_YAW] &= ~(1u << AUVID_G500_M_U);
    expect("columns", AUVID_YAW, AUVID_G500_M_U);
}

static void test_a_wrench_of_the_wrong_sign_is_named(void)
{
    vehicle.regressor = NULL;
    vehicle.residual = wrong_sign;
    expect("wrench", AUVID_SURGE, -1);
    vehicle.own_thrust = true; /* and a wrench that is read although the model has its own */
    vehicle.regressor = NULL;
    vehicle.residual = right_residual;
    expect("wrench", AUVID_SURGE, -1);
}

static void test_a_velocity_that_is_read_in_secret_is_named(void)
{
    vehicle.reads[AUVID_YAW] = 1u << AUVID_SURGE | 1u << AUVID_YAW; /* not v */
    expect("reads", AUVID_YAW, -1);
}

static void test_an_acceleration_of_another_model_is_named(void)
{
    vehicle.acceleration = heavy;
    expect("acceleration", AUVID_YAW, -1);
    vehicle.acceleration = none;
    expect("acceleration", -1, -1);
}

static void test_a_residual_that_is_not_finite_is_named(void)
{
    vehicle.regressor = NULL;
    vehicle.residual = not_finite;
    expect("not finite", AUVID_HEAVE, -1);
}

static void test_wrong_arguments_are_refused(void)
{
    auvid_real_t bad[AUVID_G500_COUNT] = {0};
    bad[3] = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_vehicle_selftest(NULL, pi, 0, 0, &fault));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_vehicle_selftest(&vehicle, NULL, 0, 0, &fault));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_vehicle_selftest(&vehicle, bad, 0, 0, &fault));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE,
                      auvid_vehicle_selftest(&vehicle, pi, 0, (auvid_real_t)NAN, &fault));
    vehicle.parameters = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_PARAMETERS, auvid_vehicle_selftest(&vehicle, pi, 0, 0, &fault));
    vehicle.built_for = NULL;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_vehicle_selftest(&vehicle, pi, 0, 0, &fault));
    TEST_ASSERT_NULL(fault.what);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_three_models_of_girona500_are_consistent);
    RUN_TEST(test_an_averaged_model_is_consistent_but_for_its_acceleration);
    RUN_TEST(test_a_residual_that_differs_from_the_regressor_is_named_with_its_parameter);
    RUN_TEST(test_a_row_that_reads_the_wrench_is_named);
    RUN_TEST(test_a_missing_column_is_named);
    RUN_TEST(test_a_wrench_of_the_wrong_sign_is_named);
    RUN_TEST(test_a_velocity_that_is_read_in_secret_is_named);
    RUN_TEST(test_an_acceleration_of_another_model_is_named);
    RUN_TEST(test_a_residual_that_is_not_finite_is_named);
    RUN_TEST(test_wrong_arguments_are_refused);
    return UNITY_END();
}
