/*
 * Configurations that the identifier refuses.
 */
#include <fenv.h>
#include <math.h>
#include <string.h>

#include "auvid/node.h"
#include "two_sets.h"
#include "unity.h"

void setUp(void)
{
    two_sets_defaults();
}

void tearDown(void)
{
}

/* A node refuses the same, */
static void check_init(auvid_status_t status)
{
    static auvid_node_t node;
    auvid_node_config_t passive;
    auvid_node_defaults(&passive);
    TEST_ASSERT_EQUAL(status,
                      auvid_node_init(&node, &passive, &auvid_allocation_girona500, &cfg.id));
    TEST_ASSERT_EQUAL(status, auvid_identifier_init(&chain.id, &cfg.id));
    /* and an identifier for another navigation, which does not read cfg.nav. */
    bool of_nav = status < 0 && strcmp(chain.id.refusal.part, "nav") == 0;
    TEST_ASSERT_EQUAL(of_nav ? AUVID_OK : status, auvid_identifier_init_motion(&chain.id, &cfg.id));
    chain_defaults(&cfg, 11, SETS, 0.0);
}

static void test_bounds_reversed_or_equal_are_refused(void)
{
    cfg.id.search.lower[3] = 10;
    cfg.id.search.upper[3] = -10;
    check_init(AUVID_ERR_BOUNDS);
    cfg.id.search.lower[3] = cfg.id.search.upper[3];
    check_init(AUVID_ERR_BOUNDS);
    cfg.id.search.lower[3] = (auvid_real_t)NAN;
    check_init(AUVID_ERR_NOT_FINITE);
    cfg.id.search.upper[3] = (auvid_real_t)INFINITY;
    check_init(AUVID_ERR_NOT_FINITE);
    cfg.id.search.upper[3] = AUVID_C(1e30);
    check_init(AUVID_ERR_RANGE);
    cfg.id.search.lower[AUVID_G500_X_0] = 10; /* not free: not checked */
    cfg.id.search.upper[AUVID_G500_X_0] = -10;
    check_init(AUVID_OK);
}

static void test_a_dry_mass_that_no_mass_within_the_bounds_exceeds_is_refused(void)
{
    cfg.id.dry_mass_kg = 300;
    cfg.id.search.upper[AUVID_G500_M_V] = 301;
    check_init(AUVID_OK);
    cfg.id.dry_mass_kg = 300;
    cfg.id.search.upper[AUVID_G500_M_V] = 300;
    check_init(AUVID_ERR_DRY_MASS);
    cfg.id.dry_mass_kg = 300;
    cfg.id.search.upper[AUVID_G500_M_R] = 100; /* an inertia */
    check_init(AUVID_OK);
    cfg.id.dry_mass_kg = 300;
    cfg.id.search.upper[AUVID_G500_M_W] = 200;
    cfg.id.metric.free &= ~(1u << AUVID_G500_M_W); /* not free: not checked */
    check_init(AUVID_OK);
    cfg.id.search.upper[AUVID_G500_M_U] = -1; /* no dry mass is known */
    check_init(AUVID_OK);
}

static void test_a_dry_mass_below_zero_or_not_finite_is_refused(void)
{
    cfg.id.dry_mass_kg = -1;
    check_init(AUVID_ERR_RANGE);
    cfg.id.dry_mass_kg = (auvid_real_t)NAN;
    check_init(AUVID_ERR_RANGE);
    cfg.id.dry_mass_kg = (auvid_real_t)INFINITY;
    check_init(AUVID_ERR_DRY_MASS);
}

static void test_a_population_too_small_or_too_large_is_refused(void)
{
    cfg.id.search.population = 13; /* 13 parameters need 14 */
    check_init(AUVID_ERR_POPULATION);
    cfg.id.search.population = AUVID_MAX_POPULATION + 1;
    check_init(AUVID_ERR_POPULATION);
    cfg.id.search.population = 14;
    check_init(AUVID_OK);
    cfg.id.search.population = AUVID_MAX_POPULATION;
    check_init(AUVID_OK);
}

static void test_an_impossible_omega_or_good_point_is_refused(void)
{
    cfg.id.search.omega = (auvid_real_t)NAN;
    check_init(AUVID_ERR_NOT_FINITE);
    cfg.id.search.omega = AUVID_C(1e12);
    check_init(AUVID_ERR_RANGE);
    cfg.id.search.omega = -1;
    check_init(AUVID_ERR_RANGE);
    cfg.id.search.has_good = true;
    cfg.id.search.good[12] = (auvid_real_t)NAN;
    check_init(AUVID_ERR_NOT_FINITE);
    cfg.id.search.good[12] = (auvid_real_t)NAN; /* not used */
    check_init(AUVID_OK);
}

static void no_residual(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                        auvid_real_t *e)
{
    (void)context;
    (void)sample;
    (void)pi;
    (void)e;
}

static void test_too_many_parameters_or_none_are_refused(void)
{
    static auvid_row_t row[2 * 60];
    static auvid_parameter_t parameter[AUVID_MAX_PARAMETERS + 1];
    auvid_vehicle_t vehicle = {.built_for = AUVID_BUILD,
                               .path = &auvid_path_residual,
                               .name = "large",
                               .parameters = AUVID_MAX_PARAMETERS + 1,
                               .parameter = parameter,
                               .columns = {[AUVID_SURGE] = (1u << AUVID_MAX_PARAMETERS) - 1},
                               .residual = no_residual};
    auvid_identifier_defaults(&cfg.id, &vehicle);
    check_init(AUVID_ERR_PARAMETERS);
    for (int delay = 0; delay < 2; ++delay) { /* the delay is one more parameter */
        vehicle.parameters = AUVID_MAX_PARAMETERS;
        auvid_identifier_defaults(&cfg.id, &vehicle);
        cfg.id.metric.sets = 1;
        cfg.id.metric.rows = row;
        cfg.id.metric.row_slots = sizeof row / sizeof row[0];
        cfg.id.metric.estimate_delay = delay;
        check_init(delay ? AUVID_ERR_PARAMETERS : AUVID_OK);
    }
    cfg.id.metric.free = 1u << 31;
    check_init(AUVID_ERR_PARAMETERS);
    cfg.id.vehicle = NULL;
    check_init(AUVID_ERR_NULL);
}

static void test_what_the_modules_refuse_is_refused(void)
{
    cfg.id.nav.sigma_dvl = 0;
    check_init(AUVID_ERR_RANGE);
    cfg.id.recorder.cell_us = 10;
    check_init(AUVID_ERR_RANGE);
    cfg.id.metric.passes = 0;
    check_init(AUVID_ERR_RANGE);
    static const auvid_listener_t deaf = {.command = NULL};
    cfg.id.listener = &deaf;
    check_init(AUVID_ERR_NULL);
    cfg.id.metric.half_width[0] = AUVID_MAX_TAPS; /* more taps */
    check_init(AUVID_ERR_SIZE);
    static auvid_vehicle_t no_model;
    no_model = auvid_girona500;
    no_model.regressor = NULL;
    cfg.id.vehicle = &no_model;
    check_init(AUVID_ERR_MODEL);
}

static void test_another_arithmetic_is_refused(void)
{
    TEST_ASSERT_EQUAL_INT(0, fesetround(FE_UPWARD));
    auvid_status_t status = auvid_identifier_init(&chain.id, &cfg.id);
    int failed = fesetround(FE_TONEAREST);
    TEST_ASSERT_EQUAL(AUVID_ERR_ARITHMETIC, status);
    TEST_ASSERT_EQUAL_INT(0, failed);
    TEST_ASSERT_EQUAL_INT(0, fesetround(FE_UPWARD));
    status = auvid_identifier_init_motion(&chain.id, &cfg.id);
    failed = fesetround(FE_TONEAREST);
    TEST_ASSERT_EQUAL(AUVID_ERR_ARITHMETIC, status);
    TEST_ASSERT_EQUAL_INT(0, failed);
}

static void test_an_impossible_velocity_source_is_refused(void)
{
    cfg.id.velocity = (auvid_velocity_source_t)2;
    check_init(AUVID_ERR_RANGE);
}

static void check_refuses_all(void)
{
    auvid_real_t x[AUVID_DOF_COUNT] = {0};
    auvid_input_t in;
    auvid_output_t out;
    memset(&in, 0, sizeof in);
    in.t_us = 1;
    in.applied.present = true;
    other = chain;
    memset(&out, 0xFF, sizeof out);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL_HEX32(0, out.events);
    TEST_ASSERT_TRUE(is_zero(&out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_stop(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_abort(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_disarm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_motion(&chain.id, 1, x, x));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_applied(&chain.id, 1, x, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_close(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_work(&chain.id, 1));
    TEST_ASSERT_EQUAL_MEMORY(&other.id, &chain.id, sizeof chain.id);
}

static void test_an_identifier_that_is_not_initialised_refuses_everything(void)
{
    memset(&chain.id, 0, sizeof chain.id);
    check_refuses_all();
    memset(&chain.id, 0xFF, sizeof chain.id);
    cfg.id.search.omega = -1; /* the first check */
    check_init(AUVID_ERR_RANGE);
    check_refuses_all();
    memset(&chain.id, 0xFF, sizeof chain.id);
    cfg.id.metric.passes = 0; /* the last check */
    check_init(AUVID_ERR_RANGE);
    check_refuses_all();
}

static void test_the_metric_has_the_recorders_cell(void)
{
    cfg.id.recorder.cell_us = 50000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL_UINT32(50000, chain.id.metric.cfg.cell_us);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bounds_reversed_or_equal_are_refused);
    RUN_TEST(test_a_dry_mass_that_no_mass_within_the_bounds_exceeds_is_refused);
    RUN_TEST(test_a_dry_mass_below_zero_or_not_finite_is_refused);
    RUN_TEST(test_a_population_too_small_or_too_large_is_refused);
    RUN_TEST(test_an_impossible_omega_or_good_point_is_refused);
    RUN_TEST(test_too_many_parameters_or_none_are_refused);
    RUN_TEST(test_what_the_modules_refuse_is_refused);
    RUN_TEST(test_another_arithmetic_is_refused);
    RUN_TEST(test_an_impossible_velocity_source_is_refused);
    RUN_TEST(test_an_identifier_that_is_not_initialised_refuses_everything);
    RUN_TEST(test_the_metric_has_the_recorders_cell);
    return UNITY_END();
}
