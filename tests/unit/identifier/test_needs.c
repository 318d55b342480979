/*
 * The sizes of config.h that a configuration needs.
 */
#include <string.h>

#include "auvid/auvid.h"
#include "unity.h"

static auvid_vehicle_t vehicle;
static auvid_identifier_config_t cfg;
static auvid_identifier_t id;
static auvid_needs_t needs;
static auvid_row_t rows[(AUVID_MAX_SETS + 1) * 60];

void setUp(void)
{
    vehicle = auvid_girona500;
    auvid_identifier_defaults(&cfg, &vehicle);
    memset(&needs, 0xA5, sizeof needs);
}

void tearDown(void)
{
}

static void residual(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                     auvid_real_t *e)
{
    (void)context;
    (void)sample;
    (void)pi;
    (void)e;
}

static void use_residual_path(void)
{
    vehicle.path = &auvid_path_residual;
    vehicle.residual = residual;
    vehicle.regressor = NULL;
    cfg.metric.rows = rows;
    cfg.metric.row_slots = sizeof rows / sizeof rows[0];
}

static void test_of_the_paper_s_thirteen_parameters(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_needs(&cfg, &needs));
    TEST_ASSERT_EQUAL(AUVID_G500_COUNT, needs.parameters);
    TEST_ASSERT_EQUAL(14, needs.population);
    TEST_ASSERT_EQUAL(AUVID_MAX_SETS, needs.sets);
    TEST_ASSERT_EQUAL(0, needs.commands);
    TEST_ASSERT_EQUAL(4 * 10 + 3, needs.taps);
    TEST_ASSERT_EQUAL(9, needs.overlap);
    TEST_ASSERT_EQUAL(10, needs.half_width);
    TEST_ASSERT_EQUAL(171, needs.factor); /* X, Y, Z have six parameters each, N has five */
    TEST_ASSERT_EQUAL(35, needs.columns);
}

static void test_with_all_parameters_free_they_are_the_default_sizes(void)
{
    cfg.metric.free = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_needs(&cfg, &needs));
    TEST_ASSERT_EQUAL(AUVID_MAX_FACTOR, needs.factor);
    TEST_ASSERT_EQUAL(39, needs.columns);
    TEST_ASSERT_EQUAL(18, needs.population);
    cfg.search.population = 50;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_needs(&cfg, &needs));
    TEST_ASSERT_EQUAL(50, needs.population);
}

static void test_residual_path_needs_commands_and_searches_for_the_delay(void)
{
    use_residual_path();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_needs(&cfg, &needs));
    TEST_ASSERT_EQUAL(1, needs.commands);
    TEST_ASSERT_EQUAL(36, needs.columns); /* of a row with one command */
    TEST_ASSERT_EQUAL(15, needs.population);
    TEST_ASSERT_EQUAL(5, needs.taps); /* a mean over five cells */
    TEST_ASSERT_EQUAL(1, needs.overlap);
    TEST_ASSERT_EQUAL(1, needs.half_width);
    cfg.metric.estimate_delay = false;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_needs(&cfg, &needs));
    TEST_ASSERT_EQUAL(14, needs.population);
    cfg.metric.free = 0;
    cfg.metric.estimate_delay = true;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_identifier_needs(&cfg, &needs));
    TEST_ASSERT_EQUAL(AUVID_G500_COUNT + 1, needs.parameters);
    TEST_ASSERT_EQUAL(39, needs.columns);
}

/* A configuration that needs `value` of one size is refused by init, and needs says why. */
#define TOO_LARGE(status, member, value, change)                                                   \
    do {                                                                                           \
        setUp();                                                                                   \
        change;                                                                                    \
        TEST_ASSERT_EQUAL_MESSAGE(AUVID_ERR_SIZE, auvid_identifier_needs(&cfg, &needs), #member);  \
        TEST_ASSERT_EQUAL_MESSAGE(value, needs.member, #member);                                   \
        TEST_ASSERT_EQUAL_MESSAGE(status, auvid_identifier_init(&id, &cfg), #member);              \
    } while (0)

static void test_each_size_that_is_too_small_is_reported(void)
{
    TOO_LARGE(AUVID_ERR_PARAMETERS, parameters, 32, vehicle.parameters = 32);
    TOO_LARGE(AUVID_ERR_POPULATION, population, AUVID_MAX_POPULATION + 1,
              cfg.search.population = AUVID_MAX_POPULATION + 1);
    TOO_LARGE(AUVID_ERR_SIZE, sets, AUVID_MAX_SETS + 1, cfg.metric.sets = AUVID_MAX_SETS + 1);
    TOO_LARGE(AUVID_ERR_SIZE, taps, AUVID_MAX_TAPS + 1,
              (use_residual_path(), cfg.metric.row_cells = AUVID_MAX_TAPS + 1));
    TOO_LARGE(AUVID_ERR_SIZE, overlap, AUVID_MAX_OVERLAP + 2, cfg.metric.row_cells = 4);
    TOO_LARGE(AUVID_ERR_SIZE, half_width, AUVID_MAX_HALF_WIDTH + 1,
              (cfg.metric.passes = 1, cfg.metric.half_width[1] = AUVID_MAX_HALF_WIDTH + 1));
    TOO_LARGE(AUVID_ERR_SIZE, factor, AUVID_MAX_FACTOR + 11, /* from 10 columns to 11 */
              (cfg.metric.free = 0, vehicle.columns[AUVID_SURGE] |= 1u << AUVID_G500_Y_V));
    TOO_LARGE(AUVID_ERR_SIZE, columns, 6 * (AUVID_G500_COUNT + 3),
              (cfg.metric.free = 0, memset(vehicle.columns, 0xFF, sizeof vehicle.columns),
               vehicle.columns[0] = vehicle.columns[1] = vehicle.columns[2] = vehicle.columns[3] =
                   vehicle.columns[4] = vehicle.columns[5] = (1u << AUVID_G500_COUNT) - 1u));
}

static void test_no_cells_between_rows_do_not_divide_by_zero(void)
{
    cfg.metric.row_cells = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_identifier_needs(&cfg, &needs));
    TEST_ASSERT_EQUAL(43, needs.overlap);
}

/* Refused, and *needs as before. */
static void refused(auvid_status_t status, const auvid_identifier_config_t *of)
{
    auvid_needs_t before = needs;
    TEST_ASSERT_EQUAL(status, auvid_identifier_needs(of, &needs));
    TEST_ASSERT_EQUAL_MEMORY(&before, &needs, sizeof needs);
    setUp();
}

static void test_what_is_no_model_is_refused(void)
{
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_needs(&cfg, NULL));
    refused(AUVID_ERR_NULL, NULL);
    cfg.vehicle = NULL;
    refused(AUVID_ERR_NULL, &cfg);
    vehicle.path = NULL;
    refused(AUVID_ERR_NULL, &cfg);
    vehicle.parameters = 0;
    refused(AUVID_ERR_PARAMETERS, &cfg);
    vehicle.parameters = 33;
    refused(AUVID_ERR_PARAMETERS, &cfg);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_of_the_paper_s_thirteen_parameters);
    RUN_TEST(test_with_all_parameters_free_they_are_the_default_sizes);
    RUN_TEST(test_residual_path_needs_commands_and_searches_for_the_delay);
    RUN_TEST(test_each_size_that_is_too_small_is_reported);
    RUN_TEST(test_no_cells_between_rows_do_not_divide_by_zero);
    RUN_TEST(test_what_is_no_model_is_refused);
    return UNITY_END();
}
