/*
 * Vehicle models: the rows of Eq. 12-15 term by term, functions based on them, and the checks.
 * tests/reference/test_vehicle.cpp compares them with Fossen's matrices.
 */
#include <math.h>
#include <string.h>

#include "auvid/vehicle.h"
#include "unity.h"

enum { N = AUVID_G500_COUNT };

static auvid_sample_t sample;
static auvid_real_t pi[AUVID_MAX_PARAMETERS];
static auvid_vehicle_t model;

/* The numbers are exact in float32 and all different, so that a wrong factor is detected. */
void setUp(void)
{
    static const double nu[6] = {1.5, -0.75, 0.5, 0.375, -0.25, 1.25};
    static const double nu_dot[6] = {0.125, -0.625, 0.875, 9, 10, -0.1875};
    memset(&sample, 0, sizeof sample);
    sample.phi = AUVID_C(0.3);
    sample.theta = AUVID_C(-0.2);
    sample.psi = AUVID_C(5.0);
    for (int j = 0; j < 6; ++j) {
        sample.nu[j] = (auvid_real_t)nu[j];
        sample.nu_dot[j] = (auvid_real_t)nu_dot[j];
        sample.tau[j] = (auvid_real_t)(10 * (j + 1));
    }
    memset(pi, 0, sizeof pi);
    memcpy(pi, auvid_girona500_paper, sizeof auvid_girona500_paper);
    pi[AUVID_G500_X_0] = 1;
    pi[AUVID_G500_Y_0] = -2;
    pi[AUVID_G500_Z_0] = 3;
    pi[AUVID_G500_N_0] = -4;
    model = auvid_girona500;
}

void tearDown(void)
{
}

/* ---- the rows ---- */

static auvid_regressor_t rows_of(const auvid_vehicle_t *vehicle)
{
    auvid_regressor_t y;
    memset(&y, 0, sizeof y);
    vehicle->regressor(vehicle->context, &sample, NULL, &y);
    return y;
}

/* Expects Eq. 12-15 with `other` instead of p in Eq. 13; all other entries are zero. */
static void assert_rows(const auvid_vehicle_t *vehicle, bool coupled, double other)
{
    double u = 1.5, v = -0.75, w = 0.5, p = 0.375, q = -0.25, r = 1.25;
    double phi = (double)sample.phi, theta = (double)sample.theta;
    double expected[6][AUVID_MAX_PARAMETERS] = {{0}};
    double c = coupled ? 1 : 0;
    expected[AUVID_SURGE][AUVID_G500_M_U] = 0.125;
    expected[AUVID_SURGE][AUVID_G500_M_V] = -c * v * r;
    expected[AUVID_SURGE][AUVID_G500_M_W] = c * w * q;
    expected[AUVID_SURGE][AUVID_G500_W_B] = sin(theta);
    expected[AUVID_SURGE][AUVID_G500_X_U] = -u;
    expected[AUVID_SURGE][AUVID_G500_X_UU] = -fabs(u) * u;
    expected[AUVID_SURGE][AUVID_G500_X_0] = -1;
    expected[AUVID_SWAY][AUVID_G500_M_V] = -0.625;
    expected[AUVID_SWAY][AUVID_G500_M_W] = -c * w * other;
    expected[AUVID_SWAY][AUVID_G500_M_U] = c * u * r;
    expected[AUVID_SWAY][AUVID_G500_W_B] = -cos(theta) * sin(phi);
    expected[AUVID_SWAY][AUVID_G500_Y_V] = -v;
    expected[AUVID_SWAY][AUVID_G500_Y_VV] = -fabs(v) * v;
    expected[AUVID_SWAY][AUVID_G500_Y_0] = -1;
    expected[AUVID_HEAVE][AUVID_G500_M_W] = 0.875;
    expected[AUVID_HEAVE][AUVID_G500_M_U] = -c * u * q;
    expected[AUVID_HEAVE][AUVID_G500_M_V] = c * v * p;
    expected[AUVID_HEAVE][AUVID_G500_W_B] = -cos(theta) * cos(phi);
    expected[AUVID_HEAVE][AUVID_G500_Z_W] = -w;
    expected[AUVID_HEAVE][AUVID_G500_Z_WW] = -fabs(w) * w;
    expected[AUVID_HEAVE][AUVID_G500_Z_0] = -1;
    expected[AUVID_YAW][AUVID_G500_M_R] = -0.1875;
    expected[AUVID_YAW][AUVID_G500_M_U] = -c * u * v;
    expected[AUVID_YAW][AUVID_G500_M_V] = c * u * v;
    expected[AUVID_YAW][AUVID_G500_N_R] = -r;
    expected[AUVID_YAW][AUVID_G500_N_RR] = -fabs(r) * r;
    expected[AUVID_YAW][AUVID_G500_N_0] = -1;
    auvid_regressor_t y = rows_of(vehicle);
    for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
            TEST_ASSERT_DOUBLE_WITHIN(2 * (double)AUVID_EPSILON, expected[j][i],
                                      (double)y.row[j][i]);
        }
    }
}

static void test_rows_are_eq_12_to_15_with_fossens_w_p(void)
{
    assert_rows(&auvid_girona500, true, 0.375);
}

static void test_printed_rows_are_eq_12_to_15_with_w_q(void)
{
    assert_rows(&auvid_girona500_printed, true, -0.25);
}

static void test_decoupled_rows_are_eq_12_to_15_without_the_coupling(void)
{
    assert_rows(&auvid_girona500_decoupled, false, 0);
}

static void test_rows_reverse_with_the_velocity(void)
{
    auvid_regressor_t ahead = rows_of(&auvid_girona500_decoupled), astern;
    for (int j = 0; j < 6; ++j) {
        sample.nu[j] = -sample.nu[j];
    }
    astern = rows_of(&auvid_girona500_decoupled);
    for (int i = AUVID_G500_X_U; i <= AUVID_G500_N_RR; ++i) {
        for (int j = 0; j < 6; ++j) {
            TEST_ASSERT_EQUAL_DOUBLE((double)ahead.row[j][i], -(double)astern.row[j][i]);
        }
    }
}

static void test_rows_do_not_depend_on_wrench_heading_or_commands(void)
{
    auvid_regressor_t y = rows_of(&auvid_girona500), again;
    memset(sample.tau, 0, sizeof sample.tau);
    sample.psi = 0;
    sample.command[0] = 1;
    sample.t_us = 77;
    again = rows_of(&auvid_girona500);
    TEST_ASSERT_EQUAL_MEMORY(&y, &again, sizeof y);
}

/* The metric would lose a column that is missing in the masks. */
static void test_masks_contain_exactly_the_columns_that_are_not_zero(void)
{
    static const auvid_vehicle_t *all[] = {&auvid_girona500, &auvid_girona500_printed};
    for (size_t k = 0; k < 2; ++k) {
        auvid_regressor_t y = rows_of(all[k]);
        for (int j = 0; j < 6; ++j) {
            for (int i = 0; i < N; ++i) {
                bool named = (all[k]->columns[j] >> i & 1u) != 0;
                TEST_ASSERT_EQUAL(named, y.row[j][i] != 0);
            }
        }
    }
}

/* ---- residual and acceleration ---- */

static void test_residual_is_rows_times_parameters_minus_the_wrench(void)
{
    auvid_real_t residual[6] = {9, 9, 9, 9, 9, 9};
    auvid_regressor_t y = rows_of(&auvid_girona500);
    auvid_vehicle_residual(&auvid_girona500, &sample, pi, residual);
    for (int j = 0; j < 6; ++j) {
        double sum = 0, size = fabs((double)sample.tau[j]);
        for (int i = 0; i < N; ++i) {
            sum += (double)y.row[j][i] * (double)pi[i];
            size += fabs((double)y.row[j][i] * (double)pi[i]);
        }
        bool modelled = auvid_girona500.columns[j] != 0;
        double expected = modelled ? sum - (double)sample.tau[j] : 0;
        TEST_ASSERT_DOUBLE_WITHIN(8 * (double)AUVID_EPSILON * size, expected, (double)residual[j]);
    }
}

static void user_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *p,
                          auvid_real_t *residual)
{
    for (int j = 0; j < 6; ++j) {
        TEST_ASSERT_EQUAL_DOUBLE(0, (double)residual[j]);
    }
    residual[AUVID_SURGE] = p[0] * s->command[0] + *(const auvid_real_t *)context;
}

static void test_residual_is_the_users_if_there_is_no_regressor(void)
{
    const auvid_real_t seven = 7;
    auvid_real_t residual[6] = {9, 9, 9, 9, 9, 9};
    model.path = &auvid_path_residual;
    model.regressor = NULL;
    model.residual = user_residual;
    model.context = &seven;
    sample.command[0] = 2;
    pi[0] = 3;
    auvid_vehicle_residual(&model, &sample, pi, residual);
    TEST_ASSERT_EQUAL_DOUBLE(13, (double)residual[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)residual[5]);
}

static void assert_acceleration_inverts_residual(const auvid_vehicle_t *vehicle)
{
    auvid_real_t nu_dot[6] = {0}, residual[6];
    TEST_ASSERT_TRUE(vehicle->acceleration(vehicle->context, &sample, pi, nu_dot));
    memcpy(sample.nu_dot, nu_dot, sizeof nu_dot);
    auvid_vehicle_residual(vehicle, &sample, pi, residual);
    for (int j = 0; j < 6; ++j) { /* terms of up to 1000 N, a dozen roundings */
        TEST_ASSERT_DOUBLE_WITHIN(6 * 2000 * (double)AUVID_EPSILON, 0, (double)residual[j]);
    }
}

static void test_acceleration_inverts_the_residual(void)
{
    assert_acceleration_inverts_residual(&auvid_girona500);
    assert_acceleration_inverts_residual(&auvid_girona500_printed);
    assert_acceleration_inverts_residual(&auvid_girona500_decoupled);
}

static void test_acceleration_does_not_depend_on_the_recorded_one(void)
{
    auvid_real_t one[6] = {0}, other[6] = {0};
    TEST_ASSERT_TRUE(model.acceleration(model.context, &sample, pi, one));
    for (int j = 0; j < 6; ++j) {
        sample.nu_dot[j] = (auvid_real_t)NAN;
    }
    TEST_ASSERT_TRUE(model.acceleration(model.context, &sample, pi, other));
    TEST_ASSERT_EQUAL_MEMORY(one, other, sizeof one);
}

static void test_acceleration_is_not_finite_only_in_a_dof_whose_mass_is_not_positive(void)
{
    static const int mass[] = {AUVID_G500_M_U, AUVID_G500_M_V, AUVID_G500_M_W, AUVID_G500_M_R};
    static const double bad[] = {0, -1, NAN};
    static const int dof[] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    for (int k = 0; k < 4; ++k) {
        for (int b = 0; b < 3; ++b) {
            auvid_real_t nu_dot[6] = {0};
            setUp();
            pi[mass[k]] = (auvid_real_t)bad[b];
            TEST_ASSERT_TRUE(model.acceleration(model.context, &sample, pi, nu_dot));
            for (int other = 0; other < 4 && bad[b] <= 0; ++other) {
                TEST_ASSERT_EQUAL(other != k, auvid_is_finite(nu_dot[dof[other]]));
            }
            TEST_ASSERT_FALSE(auvid_is_finite(nu_dot[dof[k]]));
        }
    }
}

static void test_acceleration_without_any_mass_has_no_solution(void)
{
    auvid_real_t nu_dot[6];
    pi[AUVID_G500_M_U] = pi[AUVID_G500_M_V] = pi[AUVID_G500_M_W] = pi[AUVID_G500_M_R] = 0;
    TEST_ASSERT_FALSE(model.acceleration(model.context, &sample, pi, nu_dot));
}

static void test_hull_that_is_too_heavy_sinks_and_drag_slows_down(void)
{
    auvid_real_t nu_dot[6] = {0};
    memset(&sample, 0, sizeof sample);
    memset(&pi[AUVID_G500_X_0], 0, 4 * sizeof pi[0]);
    pi[AUVID_G500_W_B] = 66;
    TEST_ASSERT_TRUE(model.acceleration(model.context, &sample, pi, nu_dot));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 66 / 659.9799, (double)nu_dot[AUVID_HEAVE]);
    pi[AUVID_G500_W_B] = 0;
    for (int j = 0; j < 6; ++j) {
        sample.nu[j] = AUVID_C(0.5);
    }
    model = auvid_girona500_decoupled;
    TEST_ASSERT_TRUE(model.acceleration(model.context, &sample, pi, nu_dot));
    TEST_ASSERT_TRUE(nu_dot[0] < 0 && nu_dot[1] < 0 && nu_dot[2] < 0 && nu_dot[5] < 0);
}

static void test_every_parameter_has_a_name_a_unit_and_the_dof_of_its_letter(void)
{
    for (int i = 0; i < N; ++i) {
        const auvid_parameter_t *p = &auvid_girona500.parameter[i];
        TEST_ASSERT_NOT_NULL(p->name);
        TEST_ASSERT_NOT_NULL(p->unit);
        char axis = p->name[0] == 'm' ? p->name[2] : p->name[0];
        auvid_dof_t dof = strchr("uX", axis)   ? AUVID_SURGE
                          : strchr("vY", axis) ? AUVID_SWAY
                          : strchr("rN", axis) ? AUVID_YAW
                                               : AUVID_HEAVE;
        TEST_ASSERT_EQUAL(dof, p->dof);
        TEST_ASSERT_TRUE(auvid_girona500.columns[dof] >> i & 1u);
    }
}

static void test_parameters_of_the_paper_have_their_indices(void)
{
    static const double paper[13] = {249.5384,  367.7126,  659.9799, 74.9024,   -37.3058,
                                     -42.4181,  -125.3578, -75.7673, -447.6195, -44.0561,
                                     -325.0138, -20.5833,  -60.9373};
    for (int i = 0; i < N; ++i) {
        double expected = i < 13 ? paper[i] : 0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, expected, (double)auvid_girona500_paper[i]);
    }
}

/* ---- check ---- */

static void test_check_accepts_the_models_of_the_library(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&auvid_girona500));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&auvid_girona500_printed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&auvid_girona500_decoupled));
    model.acceleration = NULL;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&model));
}

static void test_check_accepts_a_model_with_the_largest_number_of_parameters(void)
{
    static auvid_parameter_t parameter[AUVID_MAX_PARAMETERS];
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        parameter[i] = (auvid_parameter_t){"p", "1", AUVID_PITCH, AUVID_PARAMETER_OTHER};
    }
    memset(model.columns, 0, sizeof model.columns);
    model.parameter = parameter;
    model.parameters = AUVID_MAX_PARAMETERS;
    model.columns[AUVID_PITCH] = (uint32_t)(((uint64_t)1 << AUVID_MAX_PARAMETERS) - 1);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&model));
}

static void test_check_refuses_null_pointers(void)
{
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_vehicle_check(NULL));
    model.parameter = NULL;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_vehicle_check(&model));
}

static void test_check_refuses_a_model_built_for_other_sizes(void)
{
    static const uint8_t foreign = 1;
    model.built_for = NULL;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_vehicle_check(&model));
    model.built_for = &foreign;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_vehicle_check(&model));
    model.built_for = AUVID_BUILD;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&model));
}

static void test_check_refuses_no_parameter_or_too_many(void)
{
    model.parameters = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_PARAMETERS, auvid_vehicle_check(&model));
    model.parameters = AUVID_MAX_PARAMETERS + 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_PARAMETERS, auvid_vehicle_check(&model));
}

static void test_check_refuses_a_model_without_function(void)
{
    model.regressor = NULL;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
    model.residual = user_residual;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&model));
    model.path = NULL;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
}

static void test_check_refuses_a_model_without_dof(void)
{
    memset(model.columns, 0, sizeof model.columns);
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
}

static void test_check_refuses_a_mask_with_an_undefined_parameter(void)
{
    model.columns[AUVID_ROLL] = 1u << N;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
}

/* Each row depends on exactly the velocities that it reads, and reads its own. */
static void check_reads(const auvid_vehicle_t *vehicle)
{
    auvid_regressor_t as_is = rows_of(vehicle);
    for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
        auvid_sample_t keep = sample;
        sample.nu[i] += 3;
        sample.nu_dot[i] += 5;
        auvid_regressor_t moved = rows_of(vehicle);
        sample = keep;
        uint8_t without = auvid_vehicle_unmeasured(vehicle, (uint8_t)(1u << i));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            bool same = memcmp(as_is.row[j], moved.row[j], sizeof moved.row[j]) == 0;
            bool modelled = vehicle->columns[j] != 0;
            TEST_ASSERT_TRUE(!modelled || same || (without >> j & 1) != 0);
            TEST_ASSERT_TRUE(!modelled || i != j || (without >> j & 1) != 0);
        }
    }
    TEST_ASSERT_EQUAL_HEX8(0, auvid_vehicle_unmeasured(vehicle, 0));
}

static void test_models_declare_all_velocities_that_each_equation_reads(void)
{
    check_reads(&auvid_girona500);
    check_reads(&auvid_girona500_printed);
    check_reads(&auvid_girona500_decoupled);
    TEST_ASSERT_EQUAL_HEX8(7, auvid_vehicle_unmeasured(&auvid_girona500, 1u << AUVID_HEAVE) & 0x27);
    TEST_ASSERT_EQUAL_HEX8(
        4, auvid_vehicle_unmeasured(&auvid_girona500_decoupled, 1u << AUVID_HEAVE) & 0x27);
    memset(model.reads, 0, sizeof model.reads);
    TEST_ASSERT_EQUAL_HEX8(0x3F, auvid_vehicle_unmeasured(&model, 1u << AUVID_HEAVE)); /* all */
}

static void test_check_refuses_reads_with_an_undefined_velocity_or_without_the_dofs_own(void)
{
    model.reads[AUVID_SURGE] = 1u << AUVID_SURGE;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&model));
    model.reads[AUVID_SURGE] = 1u << AUVID_SURGE | 1u << 6;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
    model.reads[AUVID_SURGE] = 1u << AUVID_SWAY;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
}

static void test_check_refuses_a_parameter_of_a_dof_that_is_not_modelled(void)
{
    model.columns[AUVID_YAW] = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
    auvid_parameter_t parameter[N];
    model = auvid_girona500;
    memcpy(parameter, model.parameter, sizeof parameter);
    model.parameter = parameter;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&model));
    parameter[3].dof = AUVID_SURGE; /* whose equation does not have it */
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
    parameter[3].dof = AUVID_DOF_COUNT;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
    parameter[3].dof = (auvid_dof_t)-1;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_vehicle_check(&model));
}

/* ---- kinematics ---- */

static void test_level_vehicle_heading_east_moves_east(void)
{
    const auvid_real_t nu[6] = {2, 1, 3, 4, 5, 6};
    auvid_real_t eta_dot[6];
    static const double expected[6] = {-1, 2, 3, 4, 5, 6};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_kinematics(0, 0, AUVID_PI / 2, nu, eta_dot));
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(8 * (double)AUVID_EPSILON, expected[i], (double)eta_dot[i]);
    }
}

static void test_vehicle_with_its_nose_up_climbs_and_rolls_by_its_yaw_rate(void)
{
    const auvid_real_t nu[6] = {1, 0, 0, 0, 0, 1};
    auvid_real_t eta_dot[6];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_kinematics(0, AUVID_C(0.5), 0, nu, eta_dot));
    TEST_ASSERT_DOUBLE_WITHIN(4 * (double)AUVID_EPSILON, -sin(0.5), (double)eta_dot[2]);
    TEST_ASSERT_DOUBLE_WITHIN(4 * (double)AUVID_EPSILON, tan(0.5), (double)eta_dot[3]);
    TEST_ASSERT_DOUBLE_WITHIN(4 * (double)AUVID_EPSILON, 1 / cos(0.5), (double)eta_dot[5]);
}

static void assert_pitch(auvid_status_t expected, double theta)
{
    const auvid_real_t nu[6] = {1, 1, 1, 1, 1, 1};
    auvid_real_t eta_dot[6] = {9, 9, 9, 9, 9, 9};
    TEST_ASSERT_EQUAL(expected, auvid_kinematics(0, (auvid_real_t)theta, 0, nu, eta_dot));
    for (int i = 0; i < 6 && expected < 0; ++i) {
        TEST_ASSERT_EQUAL_DOUBLE(9, (double)eta_dot[i]);
    }
}

static void test_kinematics_refuse_the_singular_pitch_and_write_nothing(void)
{
    for (int sign = -1; sign <= 1; sign += 2) {
        double right = sign * 1.57079632679489662;
        assert_pitch(AUVID_ERR_SINGULAR, right);
        assert_pitch(AUVID_ERR_SINGULAR, right - 0.99e-3);
        assert_pitch(AUVID_ERR_SINGULAR, right + 0.99e-3);
        assert_pitch(AUVID_OK, right - 1.01e-3);
        assert_pitch(AUVID_OK, right + 1.01e-3);
    }
}

static void test_kinematics_refuse_null_and_values_that_are_not_finite(void)
{
    auvid_real_t nu[6] = {1, 1, 1, 1, 1, 1}, eta_dot[6], nan = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_kinematics(0, 0, 0, NULL, eta_dot));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_kinematics(0, 0, 0, nu, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_kinematics(nan, 0, 0, nu, eta_dot));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_kinematics(0, nan, 0, nu, eta_dot));
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_kinematics(0, 0, nan, nu, eta_dot));
    nu[5] = (auvid_real_t)INFINITY;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_kinematics(0, 0, 0, nu, eta_dot));
}

/* Angles beyond the range of sin and cos are finite numbers, but not an attitude. */
static void test_kinematics_refuse_angles_out_of_range_and_write_nothing(void)
{
    static const double angle[3][3] = {{1e5, 0, 0}, {0, 1e5, 0}, {0, 0, 1e5}};
    const auvid_real_t nu[6] = {1, 1, 1, 1, 1, 1};
    for (int k = 0; k < 3; ++k) {
        auvid_real_t eta_dot[6] = {0};
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                          auvid_kinematics((auvid_real_t)angle[k][0], (auvid_real_t)angle[k][1],
                                           (auvid_real_t)angle[k][2], nu, eta_dot));
        for (int i = 0; i < 6; ++i) {
            TEST_ASSERT_EQUAL_DOUBLE(0, (double)eta_dot[i]);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_rows_are_eq_12_to_15_with_fossens_w_p);
    RUN_TEST(test_printed_rows_are_eq_12_to_15_with_w_q);
    RUN_TEST(test_decoupled_rows_are_eq_12_to_15_without_the_coupling);
    RUN_TEST(test_rows_reverse_with_the_velocity);
    RUN_TEST(test_rows_do_not_depend_on_wrench_heading_or_commands);
    RUN_TEST(test_masks_contain_exactly_the_columns_that_are_not_zero);
    RUN_TEST(test_residual_is_rows_times_parameters_minus_the_wrench);
    RUN_TEST(test_residual_is_the_users_if_there_is_no_regressor);
    RUN_TEST(test_acceleration_inverts_the_residual);
    RUN_TEST(test_acceleration_does_not_depend_on_the_recorded_one);
    RUN_TEST(test_acceleration_is_not_finite_only_in_a_dof_whose_mass_is_not_positive);
    RUN_TEST(test_acceleration_without_any_mass_has_no_solution);
    RUN_TEST(test_hull_that_is_too_heavy_sinks_and_drag_slows_down);
    RUN_TEST(test_every_parameter_has_a_name_a_unit_and_the_dof_of_its_letter);
    RUN_TEST(test_parameters_of_the_paper_have_their_indices);
    RUN_TEST(test_check_accepts_the_models_of_the_library);
    RUN_TEST(test_check_accepts_a_model_with_the_largest_number_of_parameters);
    RUN_TEST(test_check_refuses_null_pointers);
    RUN_TEST(test_check_refuses_a_model_built_for_other_sizes);
    RUN_TEST(test_check_refuses_no_parameter_or_too_many);
    RUN_TEST(test_check_refuses_a_model_without_function);
    RUN_TEST(test_check_refuses_a_model_without_dof);
    RUN_TEST(test_check_refuses_a_mask_with_an_undefined_parameter);
    RUN_TEST(test_models_declare_all_velocities_that_each_equation_reads);
    RUN_TEST(test_check_refuses_reads_with_an_undefined_velocity_or_without_the_dofs_own);
    RUN_TEST(test_check_refuses_a_parameter_of_a_dof_that_is_not_modelled);
    RUN_TEST(test_level_vehicle_heading_east_moves_east);
    RUN_TEST(test_vehicle_with_its_nose_up_climbs_and_rolls_by_its_yaw_rate);
    RUN_TEST(test_kinematics_refuse_the_singular_pitch_and_write_nothing);
    RUN_TEST(test_kinematics_refuse_null_and_values_that_are_not_finite);
    RUN_TEST(test_kinematics_refuse_angles_out_of_range_and_write_nothing);
    return UNITY_END();
}
