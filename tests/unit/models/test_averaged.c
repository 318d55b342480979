/*
 * The averaged model: its rows compared with those of the wrapped model. For its effect on
 * estimates see tests/vehicles/test_bluerov2.c.
 */
#include <math.h>
#include <string.h>

#include "auvid/vehicle.h"
#include "unity.h"

enum { CELL_US = 100000, VELOCITY_US = 200000 };

static auvid_averaged_t model;
static auvid_sample_t sample;
static auvid_vehicle_t vehicle;

void setUp(void)
{
    static const double nu[6] = {0.5, -0.75, 1, 0.375, -0.25, 0.5};
    static const double nu_dot[6] = {0.5, 1, -1.5, 0.25, 0.5, -1};
    memset(&sample, 0, sizeof sample);
    sample.phi = AUVID_C(0.3);
    sample.theta = AUVID_C(-0.2);
    for (int j = 0; j < 6; ++j) {
        sample.nu[j] = (auvid_real_t)nu[j];
        sample.nu_dot[j] = (auvid_real_t)nu_dot[j];
    }
    vehicle = auvid_girona500;
    memset(&model, 0, sizeof model);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_averaged_init(&model, &vehicle, CELL_US, VELOCITY_US));
}

void tearDown(void)
{
}

static auvid_regressor_t rows_of(const auvid_vehicle_t *v)
{
    auvid_regressor_t y;
    memset(&y, 0, sizeof y);
    v->regressor(v->context, &sample, NULL, &y);
    return y;
}

/* Mean of x |x| for x with constant slope. The weights are a triangle of half-width `velocity_s`
 * (interpolation) convolved with a rectangle of width `cell_s` (cell mean). */
static double mean_square(double x, double slope, double velocity_s, double cell_s)
{
    enum { STEPS = 200 };
    double sum = 0, weights = 0;
    for (int i = 0; i < STEPS; ++i) {
        double part = (2.0 * i + 1) / STEPS - 1;
        for (int k = 0; k < STEPS; ++k) {
            double t = part * velocity_s + ((k + 0.5) / STEPS - 0.5) * cell_s;
            double there = x + slope * t, weight = 1 - fabs(part);
            sum += weight * fabs(there) * there;
            weights += weight;
        }
    }
    return sum / weights;
}

static void test_quadratic_drag_is_the_mean_over_the_averaging_time_of_the_velocity(void)
{
    static const int column[3] = {AUVID_G500_X_UU, AUVID_G500_Y_VV, AUVID_G500_Z_WW};
    auvid_regressor_t y = rows_of(&model.vehicle), plain = rows_of(&vehicle);
    for (int j = 0; j < 3; ++j) {
        double drag = mean_square((double)sample.nu[j], (double)sample.nu_dot[j], 0.2, 0.1);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, -drag, (double)y.row[j][column[j]]);
        TEST_ASSERT_TRUE(fabs(drag + (double)plain.row[j][column[j]]) > 1e-3);
    }
    double turn = mean_square(0.5, -1, 0, 0.1); /* a gyroscope has samples in every cell */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -turn, (double)y.row[AUVID_YAW][AUVID_G500_N_RR]);
}

static void test_terms_linear_in_motion_equal_the_wrapped_models(void)
{
    static const int column[5] = {AUVID_G500_M_U, AUVID_G500_W_B, AUVID_G500_X_U, AUVID_G500_Y_V,
                                  AUVID_G500_N_R};
    auvid_regressor_t y = rows_of(&model.vehicle), plain = rows_of(&vehicle);
    for (int k = 0; k < 5; ++k) {
        int j = (int)vehicle.parameter[column[k]].dof;
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, (double)plain.row[j][column[k]],
                                  (double)y.row[j][column[k]]);
    }
}

static void test_rows_of_steady_motion_equal_the_wrapped_models(void)
{
    memset(sample.nu_dot, 0, sizeof sample.nu_dot);
    auvid_regressor_t y = rows_of(&model.vehicle), plain = rows_of(&vehicle);
    TEST_ASSERT_EQUAL_MEMORY(&plain, &y, sizeof y);
}

static void test_forward_dynamics_equal_the_wrapped_models(void)
{
    auvid_real_t ours[6] = {0}, theirs[6] = {0};
    TEST_ASSERT_TRUE(
        model.vehicle.acceleration(model.vehicle.context, &sample, auvid_girona500_paper, ours));
    TEST_ASSERT_TRUE(vehicle.acceleration(vehicle.context, &sample, auvid_girona500_paper, theirs));
    TEST_ASSERT_EQUAL_MEMORY(theirs, ours, sizeof ours);
}

static void test_table_and_masks_equal_the_wrapped_models(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&model.vehicle));
    TEST_ASSERT_EQUAL_STRING(vehicle.name, model.vehicle.name);
    TEST_ASSERT_EQUAL_UINT8(vehicle.parameters, model.vehicle.parameters);
    TEST_ASSERT_EQUAL_PTR(vehicle.parameter, model.vehicle.parameter);
    TEST_ASSERT_EQUAL_HEX32(vehicle.free, model.vehicle.free);
    TEST_ASSERT_EQUAL_MEMORY(vehicle.columns, model.vehicle.columns, sizeof vehicle.columns);
}

static void test_without_the_models_forward_dynamics_there_are_none(void)
{
    vehicle.acceleration = NULL;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_averaged_init(&model, &vehicle, CELL_US, VELOCITY_US));
    TEST_ASSERT_NULL(model.vehicle.acceleration);
}

static void never(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                  auvid_real_t residual[AUVID_DOF_COUNT])
{
    (void)context, (void)s, (void)pi, (void)residual;
    TEST_FAIL();
}

static void refuses(auvid_status_t status, const auvid_vehicle_t *v, uint32_t cell,
                    uint32_t velocity)
{
    auvid_averaged_t before = model;
    TEST_ASSERT_EQUAL(status, auvid_averaged_init(&model, v, cell, velocity));
    TEST_ASSERT_EQUAL_MEMORY(&before, &model, sizeof before);
}

static void test_init_refuses_what_it_cannot_average(void)
{
    auvid_vehicle_t other = vehicle;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_averaged_init(NULL, &vehicle, CELL_US, VELOCITY_US));
    refuses(AUVID_ERR_NULL, NULL, CELL_US, VELOCITY_US);
    refuses(AUVID_ERR_RANGE, &vehicle, 999, VELOCITY_US);
    refuses(AUVID_ERR_RANGE, &vehicle, 1000001, VELOCITY_US);
    refuses(AUVID_ERR_RANGE, &vehicle, CELL_US, 1000001);
    other.built_for = NULL;
    refuses(AUVID_ERR_SIZE, &other, CELL_US, VELOCITY_US);
    other = vehicle;
    other.parameters = 0;
    refuses(AUVID_ERR_PARAMETERS, &other, CELL_US, VELOCITY_US);
    refuses(AUVID_ERR_MODEL, &model.vehicle, CELL_US, VELOCITY_US); /* it would call itself */
    other = vehicle;
    other.regressor = NULL; /* the residual is not called */
    other.residual = never;
    refuses(AUVID_ERR_MODEL, &other, CELL_US, VELOCITY_US);
    other.regressor = vehicle.regressor; /* nor if it has one for its derivatives */
    other.path = &auvid_path_residual;
    refuses(AUVID_ERR_MODEL, &other, CELL_US, VELOCITY_US);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_quadratic_drag_is_the_mean_over_the_averaging_time_of_the_velocity);
    RUN_TEST(test_terms_linear_in_motion_equal_the_wrapped_models);
    RUN_TEST(test_rows_of_steady_motion_equal_the_wrapped_models);
    RUN_TEST(test_forward_dynamics_equal_the_wrapped_models);
    RUN_TEST(test_table_and_masks_equal_the_wrapped_models);
    RUN_TEST(test_without_the_models_forward_dynamics_there_are_none);
    RUN_TEST(test_init_refuses_what_it_cannot_average);
    return UNITY_END();
}
