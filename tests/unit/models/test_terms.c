/*
 * Tables of terms: a Girona500 compared with the hand-written one, couplings in M, refused tables.
 * tests/vehicles/test_terms.c identifies a vehicle with couplings.
 */
#include <math.h>
#include <string.h>

#include "auvid/current.h"
#include "chain.h"
#include "finish.h"
#include "terms_girona500.h"
#include "unity.h"

static auvid_terms_t model;
static auvid_sample_t sample;
static auvid_refusal_t refusal;
static auvid_term_table_t girona500;
static uint32_t state;

void setUp(void)
{
    state = 1;
    girona500 = terms_girona500();
    memset(&model, 0, sizeof model);
    memset(&sample, 0, sizeof sample);
}

void tearDown(void)
{
}

static auvid_real_t draw(double largest)
{
    state = 1664525u * state + 1013904223u;
    return (auvid_real_t)(largest * ((double)(state >> 8) / 8388608.0 - 1.0));
}

static void draw_sample(void)
{
    sample.phi = draw(0.6);
    sample.theta = draw(0.6);
    sample.psi = draw(9);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        sample.nu[j] = draw(2);
        sample.nu_dot[j] = draw(1);
        sample.tau[j] = draw(100);
    }
}

static auvid_regressor_t rows_of(const auvid_vehicle_t *vehicle)
{
    auvid_regressor_t y;
    memset(&y, 0, sizeof y);
    vehicle->regressor(vehicle->context, &sample, NULL, &y);
    return y;
}

/* ---- Girona500 ---- */

static void test_a_table_has_the_rows_of_the_hand_written_model(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &girona500, NULL));
    for (int k = 0; k < 1000; ++k) {
        draw_sample();
        auvid_regressor_t ours = rows_of(&model.vehicle), theirs = rows_of(&auvid_girona500);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) { /* exact, but zeros have no sign */
                TEST_ASSERT_TRUE(ours.row[j][i] == theirs.row[j][i]);
            }
        }
    }
}

static void test_a_table_has_the_acceleration_of_the_hand_written_model(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &girona500, NULL));
    for (int k = 0; k < 1000; ++k) {
        auvid_real_t ours[AUVID_DOF_COUNT] = {0}, theirs[AUVID_DOF_COUNT] = {0};
        draw_sample();
        TEST_ASSERT_TRUE(model.vehicle.acceleration(model.vehicle.context, &sample,
                                                    auvid_girona500_paper, ours));
        TEST_ASSERT_TRUE(auvid_girona500.acceleration(auvid_girona500.context, &sample,
                                                      auvid_girona500_paper, theirs));
        TEST_ASSERT_EQUAL_MEMORY(theirs, ours, sizeof ours);
    }
}

static void test_masks_follow_from_the_table(void)
{
    const auvid_vehicle_t *made = &model.vehicle;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &girona500, &refusal));
    TEST_ASSERT_EQUAL(AUVID_OK, refusal.status);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(made));
    TEST_ASSERT_EQUAL_MEMORY(auvid_girona500.columns, made->columns, sizeof made->columns);
    /* By hand, one mask serves Eq. 13 as printed, too. */
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        unsigned more = j == AUVID_SWAY ? 1u << AUVID_PITCH : 0u;
        TEST_ASSERT_EQUAL_HEX8(auvid_girona500.reads[j] & ~more, made->reads[j]);
    }
    TEST_ASSERT_EQUAL_STRING(girona500.name, made->name);
    TEST_ASSERT_EQUAL_HEX32(0, made->free);
}

static void test_a_table_gives_the_same_estimate_and_simulated_velocity(void)
{
    static chain_t ours, theirs;
    chain_config_t cfg;
    chain_defaults(&cfg, 3, 2, 1.0);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&theirs, &cfg, 2));
    finish_work(&theirs.id, UINT32_MAX);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &girona500, NULL));
    model.vehicle.free = AUVID_G500_FREE;
    cfg.id.vehicle = cfg.id.metric.vehicle = &model.vehicle;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&ours, &cfg, 2));
    finish_work(&ours.id, UINT32_MAX);
    TEST_ASSERT_EQUAL_UINT32(2, ours.id.estimate.sets);
    TEST_ASSERT_EQUAL_MEMORY(&theirs.id.estimate, &ours.id.estimate, sizeof ours.id.estimate);
    TEST_ASSERT_EQUAL_MEMORY(&theirs.id.change_test, &ours.id.change_test,
                             sizeof ours.id.change_test);
    TEST_ASSERT_TRUE(ours.id.change_test.simulated != 0);
}

static void test_a_table_can_be_averaged_and_stand_in_a_current(void)
{
    static auvid_averaged_t averaged;
    static auvid_current_t current;
    static auvid_real_t pi[AUVID_MAX_PARAMETERS];
    auvid_term_table_t few = girona500; /* room for the current */
    few.parameters = AUVID_G500_X_0;
    few.terms -= 4;
    memcpy(pi, auvid_girona500_paper, sizeof auvid_girona500_paper);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &few, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_selftest(&model.vehicle, pi, 0, 0, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_averaged_init(&averaged, &model.vehicle, 100000, 200000));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_vehicle_selftest(&averaged.vehicle, pi, 0, AUVID_C(0.01), NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_current_init(&current, &model.vehicle, false));
    pi[AUVID_G500_X_0] = AUVID_C(0.2);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_selftest(&current.vehicle, pi, 0, 0, NULL));
}

/* ---- a small vehicle: surge, sway and yaw, coupled by accelerations ---- */

enum { M_U, M_V, M_R, M_VR, M_RV, X_T, COUPLED };
static const auvid_parameter_t coupled_parameter[COUPLED] = {
    {"m_u", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"m_v", "kg", AUVID_SWAY, AUVID_PARAMETER_MASS},
    {"m_r", "kg m2", AUVID_YAW, AUVID_PARAMETER_INERTIA},
    {"m_vr", "kg m", AUVID_SWAY, AUVID_PARAMETER_OTHER},
    {"m_rv", "kg m", AUVID_YAW, AUVID_PARAMETER_OTHER},
    {"X_t", "N/s", AUVID_SURGE, AUVID_PARAMETER_OTHER},
};
static const auvid_term_t coupled_term[] = {
    {M_U, AUVID_SURGE, 1, {AUVID_FACTOR_U_DOT}},
    {M_V, AUVID_SWAY, 1, {AUVID_FACTOR_V_DOT}},
    {M_R, AUVID_YAW, 1, {AUVID_FACTOR_R_DOT}},
    {M_VR, AUVID_SWAY, 1, {AUVID_FACTOR_R_DOT}},
    {M_RV, AUVID_YAW, -1, {AUVID_FACTOR_COS_PHI, AUVID_FACTOR_V_DOT}}, /* M depends on phi */
    {M_VR, AUVID_SURGE, -1, {AUVID_FACTOR_R, AUVID_FACTOR_R}},
    {M_VR, AUVID_SURGE, 1, {AUVID_FACTOR_Q_DOT}}, /* pitch is not modelled */
    {X_T, AUVID_SURGE, -1, {AUVID_FACTOR_TIME, AUVID_FACTOR_COS_THETA, AUVID_FACTOR_SIN_PSI}},
};
static const auvid_term_table_t coupled = {"coupled", coupled_parameter, coupled_term,
                                           sizeof coupled_term / sizeof coupled_term[0], COUPLED};
static const auvid_real_t coupled_pi[COUPLED] = {20, 30, 5, 4, -6, 2};

static bool accelerate(const auvid_real_t *pi, auvid_real_t *nu_dot)
{
    memset(nu_dot, 0, AUVID_DOF_COUNT * sizeof *nu_dot);
    return model.vehicle.acceleration(model.vehicle.context, &sample, pi, nu_dot);
}

static void test_the_residual_is_zero_with_the_acceleration_of_an_unsymmetric_mass_matrix(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &coupled, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_selftest(&model.vehicle, coupled_pi, 0, 0, NULL));
    for (int k = 0; k < 100; ++k) {
        auvid_real_t nu_dot[AUVID_DOF_COUNT], residual[AUVID_DOF_COUNT];
        draw_sample();
        sample.t_us = 5000000;
        TEST_ASSERT_TRUE(accelerate(coupled_pi, nu_dot));
        TEST_ASSERT_EQUAL_DOUBLE(0, nu_dot[AUVID_PITCH]);
        nu_dot[AUVID_PITCH] = sample.nu_dot[AUVID_PITCH]; /* as measured */
        memcpy(sample.nu_dot, nu_dot, sizeof nu_dot);
        auvid_vehicle_residual(&model.vehicle, &sample, coupled_pi, residual);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0, (double)residual[j]);
        }
    }
}

static void test_the_acceleration_is_not_finite_where_the_mass_matrix_is_not_positive(void)
{
    auvid_real_t pi[COUPLED], nu_dot[AUVID_DOF_COUNT];
    draw_sample();
    sample.phi = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &coupled, NULL));
    memcpy(pi, coupled_pi, sizeof pi);
    pi[M_VR] = 25; /* 25^2 > 30 * 5 */
    pi[M_RV] = -25;
    TEST_ASSERT_TRUE(accelerate(pi, nu_dot));
    TEST_ASSERT_TRUE(auvid_is_finite(nu_dot[AUVID_SURGE]));
    TEST_ASSERT_FALSE(auvid_is_finite(nu_dot[AUVID_SWAY]) || auvid_is_finite(nu_dot[AUVID_YAW]));
    pi[M_V] = AUVID_C(0.1); /* singular but for the rounding of m_r */
    pi[M_R] = 10 * (1 + AUVID_EPSILON);
    pi[M_VR] = 1;
    pi[M_RV] = -1;
    TEST_ASSERT_TRUE(accelerate(pi, nu_dot));
    TEST_ASSERT_FALSE(auvid_is_finite(nu_dot[AUVID_SWAY]) || auvid_is_finite(nu_dot[AUVID_YAW]));
    memcpy(pi, coupled_pi, sizeof pi);
    pi[M_U] = -20;
    TEST_ASSERT_TRUE(accelerate(pi, nu_dot));
    TEST_ASSERT_FALSE(auvid_is_finite(nu_dot[AUVID_SURGE]));
    TEST_ASSERT_TRUE(auvid_is_finite(nu_dot[AUVID_SWAY]) && auvid_is_finite(nu_dot[AUVID_YAW]));
    pi[M_V] = 0;
    TEST_ASSERT_FALSE(accelerate(pi, nu_dot));
}

static void test_time_counts_from_its_beginning(void)
{
    static const struct {
        uint64_t t_us, begin_us;
        double s;
    } at[] = {{0, 0, 0},
              {1500000, 0, 1.5},
              {1000000, 3000000, -2},
              {86400000000u * 20, 1000000, 86400.0 * 20 - 1},
              {5000000000000000u, 4999999000000000u, 1000}};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &coupled, NULL));
    draw_sample();
    double direction = cos((double)sample.theta) * sin((double)sample.psi);
    for (size_t k = 0; k < sizeof at / sizeof at[0]; ++k) {
        sample.t_us = at[k].t_us;
        model.begin_us = at[k].begin_us;
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 + 1e-6 * fabs(at[k].s), -at[k].s * direction,
                                  (double)rows_of(&model.vehicle).row[AUVID_SURGE][X_T]);
    }
}

/* ---- refused tables ---- */

static void expect(const auvid_term_table_t *table, auvid_status_t status, const char *part,
                   const char *field, int element)
{
    auvid_terms_t before;
    memset(&model, 0x5A, sizeof model);
    before = model;
    TEST_ASSERT_EQUAL(status, auvid_terms_init(&model, table, &refusal));
    TEST_ASSERT_EQUAL(status, auvid_terms_init(&model, table, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &model, sizeof model);
    TEST_ASSERT_EQUAL(status, refusal.status);
    TEST_ASSERT_EQUAL_STRING(part, refusal.part);
    TEST_ASSERT_EQUAL_STRING(field, refusal.field);
    TEST_ASSERT_EQUAL_INT(element, refusal.element);
}

static void test_incomplete_tables_are_refused(void)
{
    auvid_term_table_t bad = coupled;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_terms_init(NULL, &coupled, NULL));
    expect(NULL, AUVID_ERR_NULL, "", "", -1);
    bad.parameter = NULL;
    expect(&bad, AUVID_ERR_NULL, "", "parameter", -1);
    bad = coupled;
    bad.term = NULL;
    expect(&bad, AUVID_ERR_NULL, "", "term", -1);
    bad = coupled;
    bad.terms = 0;
    expect(&bad, AUVID_ERR_SIZE, "", "terms", -1);
    bad = coupled;
    bad.parameters = 0;
    expect(&bad, AUVID_ERR_PARAMETERS, "", "parameters", -1);
    bad.parameters = AUVID_MAX_PARAMETERS + 1;
    expect(&bad, AUVID_ERR_PARAMETERS, "", "parameters", -1);
}

/* The coupled table with another term 4. */
static void expect_term(auvid_term_t term, auvid_status_t status, const char *field)
{
    auvid_term_t changed[sizeof coupled_term / sizeof coupled_term[0]];
    auvid_term_table_t bad = coupled;
    memcpy(changed, coupled_term, sizeof changed);
    changed[4] = term;
    bad.term = changed;
    expect(&bad, status, "term", field, 4);
}

static void test_a_wrong_term_is_named(void)
{
    expect_term((auvid_term_t){COUPLED, AUVID_YAW, 1, {AUVID_FACTOR_R}}, AUVID_ERR_RANGE,
                "parameter");
    expect_term((auvid_term_t){M_RV, AUVID_DOF_COUNT, 1, {AUVID_FACTOR_R}}, AUVID_ERR_RANGE, "dof");
    expect_term((auvid_term_t){M_RV, AUVID_YAW, 0, {AUVID_FACTOR_R}}, AUVID_ERR_RANGE, "sign");
    expect_term((auvid_term_t){M_RV, AUVID_YAW, 2, {AUVID_FACTOR_R}}, AUVID_ERR_RANGE, "sign");
    expect_term((auvid_term_t){M_RV, AUVID_YAW, 1, {0, 0, AUVID_FACTOR_COUNT}}, AUVID_ERR_RANGE,
                "factor");
    expect_term((auvid_term_t){M_RV, AUVID_YAW, 1, {AUVID_FACTOR_V_DOT, 0, AUVID_FACTOR_R_DOT}},
                AUVID_ERR_MODEL, "factor");
}

static void test_a_repeated_term_is_refused_in_any_order_of_its_factors(void)
{
    expect_term((auvid_term_t){M_V, AUVID_SWAY, -1, {0, AUVID_FACTOR_V_DOT}}, AUVID_ERR_MODEL, "");
    auvid_term_t some[] = {
        {M_U, AUVID_SURGE, 1, {AUVID_FACTOR_U_DOT}},
        {M_U, AUVID_SWAY, 1, {AUVID_FACTOR_U_DOT}},
        {M_U, AUVID_SURGE, 1, {AUVID_FACTOR_U, AUVID_FACTOR_U}},
        {M_U, AUVID_SURGE, 1, {AUVID_FACTOR_ABS_U, AUVID_FACTOR_U}},
        {M_U, AUVID_SURGE, 1, {AUVID_FACTOR_ABS_U, AUVID_FACTOR_U, AUVID_FACTOR_U}},
        {M_U, AUVID_SURGE, 1, {AUVID_FACTOR_ABS_U, AUVID_FACTOR_ABS_U, AUVID_FACTOR_U}},
        {M_U, AUVID_SURGE, 1, {AUVID_FACTOR_U, 0, AUVID_FACTOR_ABS_U}}};
    auvid_term_table_t table = {"some", coupled_parameter, some, 6, 1};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &table, NULL));
    table.terms = 7; /* the last is the fourth */
    expect(&table, AUVID_ERR_MODEL, "term", "", 6);
}

/* 0 would mean that it reads all. */
static void test_an_equation_without_motion_reads_its_own_velocity(void)
{
    static const auvid_parameter_t weight = {"W-B", "N", AUVID_HEAVE, AUVID_PARAMETER_FORCE};
    static const auvid_term_t restoring = {
        0, AUVID_HEAVE, -1, {AUVID_FACTOR_COS_THETA, AUVID_FACTOR_COS_PHI}};
    static const auvid_term_table_t table = {"weight", &weight, &restoring, 1, 1};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_terms_init(&model, &table, NULL));
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_HEAVE, model.vehicle.reads[AUVID_HEAVE]);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_vehicle_check(&model.vehicle));
}

/* Its DoF is what must be excited to identify it. */
static void test_a_parameter_without_a_term_in_the_equation_of_its_dof_is_refused(void)
{
    auvid_parameter_t changed[COUPLED];
    auvid_term_table_t bad = coupled;
    memcpy(changed, coupled_parameter, sizeof changed);
    bad.parameter = changed;
    changed[M_R].dof = AUVID_SURGE;
    expect(&bad, AUVID_ERR_MODEL, "parameter", "dof", M_R);
    changed[M_R].dof = AUVID_DOF_COUNT;
    expect(&bad, AUVID_ERR_MODEL, "parameter", "dof", M_R);
    bad = coupled;
    bad.terms -= 1; /* X_t has none */
    expect(&bad, AUVID_ERR_MODEL, "parameter", "dof", X_T);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_table_has_the_rows_of_the_hand_written_model);
    RUN_TEST(test_a_table_has_the_acceleration_of_the_hand_written_model);
    RUN_TEST(test_masks_follow_from_the_table);
    RUN_TEST(test_a_table_gives_the_same_estimate_and_simulated_velocity);
    RUN_TEST(test_a_table_can_be_averaged_and_stand_in_a_current);
    RUN_TEST(test_the_residual_is_zero_with_the_acceleration_of_an_unsymmetric_mass_matrix);
    RUN_TEST(test_the_acceleration_is_not_finite_where_the_mass_matrix_is_not_positive);
    RUN_TEST(test_time_counts_from_its_beginning);
    RUN_TEST(test_incomplete_tables_are_refused);
    RUN_TEST(test_a_wrong_term_is_named);
    RUN_TEST(test_a_repeated_term_is_refused_in_any_order_of_its_factors);
    RUN_TEST(test_an_equation_without_motion_reads_its_own_velocity);
    RUN_TEST(test_a_parameter_without_a_term_in_the_equation_of_its_dof_is_refused);
    return UNITY_END();
}
