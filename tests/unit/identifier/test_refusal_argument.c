/*
 * What is refused is named in the caller's auvid_refusal_t, by functions whose storage has no room
 * for it: the adaptive excitation and the model of thrusters.
 */
#include <math.h>
#include <string.h>

#include "auvid/adaptive.h"
#include "auvid/thrusters.h"
#include "refusal.h"
#include "unity.h"

enum { SLOTS = 100 };

static auvid_refusal_t why;
static auvid_identifier_t id;
static auvid_identifier_config_t id_cfg;
static auvid_actuation_t actuation;
static auvid_actuation_config_t acting;
static auvid_allocation_t allocation;
static auvid_adaptive_t storage;
static auvid_adaptive_config_t adaptive;
static auvid_thrusters_t thrusters;
static auvid_thrusters_config_t two;
static int16_t commands[2 * SLOTS];

static void regressor(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                      auvid_regressor_t *y)
{
    (void)context;
    (void)pi;
    y->row[AUVID_SURGE][0] = s->nu_dot[AUVID_SURGE];
}

static const auvid_parameter_t mass[] = {{"m_u", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS}};
static const auvid_vehicle_t surge = {.built_for = AUVID_BUILD,
                                      .path = &auvid_path_regressor,
                                      .name = "surge",
                                      .parameters = 1,
                                      .parameter = mass,
                                      .columns = {[AUVID_SURGE] = 1},
                                      .regressor = regressor};

void setUp(void)
{
    static const auvid_real_t girona500[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    memset(&why, 0xFF, sizeof why);
    auvid_identifier_defaults(&id_cfg, &auvid_girona500);
    auvid_actuation_defaults(&acting);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &auvid_allocation_girona500));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_cfg));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_actuation(&id, &actuation, &acting, &allocation));
    auvid_adaptive_defaults(&adaptive);
    memcpy(adaptive.amplitude, girona500, sizeof adaptive.amplitude);
    auvid_thrusters_defaults(&two);
    two.hull = &surge;
    two.thrusters = 2;
    two.matrix[AUVID_SURGE][0] = two.matrix[AUVID_SURGE][1] = 1;
    two.log = commands;
    two.slots = SLOTS;
}

void tearDown(void)
{
}

static void check(auvid_status_t expected, auvid_status_t status, const char *part,
                  const char *field, int element, double value, double limit)
{
    TEST_ASSERT_EQUAL(expected, status);
    TEST_ASSERT_EQUAL(expected, why.status);
    assert_why(&why, part, field, element, value, limit);
    setUp();
}

/* ---- the adaptive excitation ---- */

#define ADAPTIVE(expected, field, element, value, limit)                                           \
    check(AUVID_ERR_##expected, auvid_adaptive_begin(&id, &storage, &adaptive, &why), "", field,   \
          element, value, limit)

static void test_a_field_of_the_adaptive_excitation_is_named(void)
{
    adaptive.amplitude[AUVID_SWAY] = -1;
    ADAPTIVE(RANGE, "amplitude", AUVID_SWAY, -1, 0);
    adaptive.amplitude[AUVID_YAW] = (auvid_real_t)NAN;
    ADAPTIVE(NOT_FINITE, "amplitude", AUVID_YAW, (double)NAN, 0);
    adaptive.excursion_limit[AUVID_HEAVE] = -2;
    ADAPTIVE(RANGE, "excursion_limit", AUVID_HEAVE, -2, 0);
    adaptive.max_s = 29;
    ADAPTIVE(RANGE, "max_s", -1, 29, 30);
    adaptive.max_s = 3601;
    ADAPTIVE(RANGE, "max_s", -1, 3601, (double)AUVID_EXCITATION_LONGEST_S);
}

static void test_an_amplitude_that_the_thrusters_cannot_give_is_named_with_what_they_can(void)
{
    auvid_real_t least, most;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_capacity(&allocation, AUVID_SWAY, &least, &most));
    adaptive.amplitude[AUVID_SWAY] = 2 * most;
    TEST_ASSERT_EQUAL(AUVID_ERR_CAPACITY, auvid_adaptive_begin(&id, &storage, &adaptive, &why));
    TEST_ASSERT_EQUAL(AUVID_SWAY, why.element);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * (double)most, (double)most, (double)why.limit);
    assert_why(&why, "", "amplitude", AUVID_SWAY, 2 * (double)most, (double)why.limit);
    memset(adaptive.amplitude, 0, sizeof adaptive.amplitude);
    ADAPTIVE(RANGE, "amplitude", -1, 0, 1);
}

static void test_an_identifier_that_cannot_begin_is_no_field(void)
{
    check(AUVID_ERR_NULL, auvid_adaptive_begin(&id, NULL, &adaptive, &why), "", "", -1, 0, 0);
    id.actuation = NULL;
    ADAPTIVE(DETACHED, "", -1, 0, 0);
}

/* ---- the model of thrusters ---- */

#define THRUSTERS(expected, part, field, element, value, limit)                                    \
    check(AUVID_ERR_##expected, auvid_thrusters_init(&thrusters, &two, &why), part, field,         \
          element, value, limit)

static void test_a_field_of_the_thrusters_is_named(void)
{
    two.log = NULL;
    THRUSTERS(NULL, "", "log", -1, 0, 0);
    two.hull = NULL;
    THRUSTERS(NULL, "hull", "", -1, 0, 0);
    two.matrix[AUVID_SURGE][1] = (auvid_real_t)NAN;
    THRUSTERS(NOT_FINITE, "", "matrix", 1, (double)NAN, (double)-AUVID_LARGEST);
    two.command_max = 0;
    THRUSTERS(RANGE, "", "command_max", -1, 0, 1e-6);
    two.gain_max = -1;
    THRUSTERS(RANGE, "", "gain_max", -1, -1, 1e-6);
    two.dead_band_max = -1;
    THRUSTERS(RANGE, "", "dead_band_max", -1, -1, 1e-6);
    two.lag_max_s = 3;
    THRUSTERS(RANGE, "", "lag_max_s", -1, 3, 2);
    two.thrusters = AUVID_MAX_COMMANDS + 1;
    THRUSTERS(RANGE, "", "thrusters", -1, AUVID_MAX_COMMANDS + 1, AUVID_MAX_COMMANDS);
    two.delay_us = 1000001;
    THRUSTERS(RANGE, "", "delay_us", -1, 1000001, 1000000);
    two.period_us = 999;
    THRUSTERS(RANGE, "", "period_us", -1, 999, 1000);
    two.slots = 0;
    THRUSTERS(RANGE, "", "slots", -1, 0, 1);
    two.slots = 200001;
    THRUSTERS(RANGE, "", "slots", -1, 200001, 200000);
}

static void test_a_field_of_a_data_sheet_is_named_with_its_group(void)
{
    two.sheet[1].gain = 1001;
    THRUSTERS(RANGE, "sheet", "gain", 1, 1001, 1000);
    two.sheet[0].backward = -1;
    THRUSTERS(RANGE, "sheet", "backward", 0, -1, 0);
    two.sheet[0].dead_band = 1;
    THRUSTERS(RANGE, "sheet", "dead_band", 0, 1, 0.5);
    two.sheet[3].lag_s = 3;
    THRUSTERS(RANGE, "sheet", "lag_s", 3, 3, 2);
    two.sheet[2].gain_sigma = 2;
    THRUSTERS(RANGE, "sheet", "gain_sigma", 2, 2, 1);
    two.sheet[2].backward_sigma = 2;
    THRUSTERS(RANGE, "sheet", "backward_sigma", 2, 2, 1);
    two.sheet[2].dead_band_sigma = -1;
    THRUSTERS(RANGE, "sheet", "dead_band_sigma", 2, -1, 1e-4);
    two.sheet[2].lag_sigma_s = (auvid_real_t)NAN;
    THRUSTERS(NOT_FINITE, "sheet", "lag_sigma_s", 2, (double)NAN, 1e-4);
}

static void test_a_hull_or_a_group_that_does_not_fit_is_named(void)
{
    static auvid_parameter_t many[AUVID_MAX_PARAMETERS];
    auvid_vehicle_t hull = surge;
    two.hull = &hull;
    hull.built_for = NULL;
    THRUSTERS(SIZE, "hull", "built_for", -1, 0, 0);
    hull.built_for = AUVID_BUILD;
    two.hull = &thrusters.vehicle;
    thrusters.vehicle = surge;
    THRUSTERS(MODEL, "", "hull", -1, 0, 0);
    two.group[0] = two.group[1] = 1; /* and none is 0 */
    THRUSTERS(RANGE, "", "group", -1, 0, 0);
    two.group[1] = 1;
    two.matrix[AUVID_SURGE][1] = 0; /* the second acts on nothing */
    THRUSTERS(MODEL, "", "group", 1, 0, 0);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        many[i] = mass[0];
    }
    hull.parameter = many;
    hull.parameters = AUVID_MAX_PARAMETERS - 3;
    hull.columns[AUVID_SURGE] = (1u << hull.parameters) - 1u;
    two.hull = &hull;
    THRUSTERS(PARAMETERS, "hull", "parameters", -1, AUVID_MAX_PARAMETERS + 1, AUVID_MAX_PARAMETERS);
}

static void test_what_is_accepted_is_not_named_and_nothing_need_be(void)
{
    check(AUVID_OK, auvid_thrusters_init(&thrusters, &two, &why), "", "", -1, 0, 0);
    check(AUVID_OK, auvid_adaptive_begin(&id, &storage, &adaptive, &why), "", "", -1, 0, 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &two, NULL));
    two.slots = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_thrusters_init(&thrusters, &two, NULL));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_field_of_the_adaptive_excitation_is_named);
    RUN_TEST(test_an_amplitude_that_the_thrusters_cannot_give_is_named_with_what_they_can);
    RUN_TEST(test_an_identifier_that_cannot_begin_is_no_field);
    RUN_TEST(test_a_field_of_the_thrusters_is_named);
    RUN_TEST(test_a_field_of_a_data_sheet_is_named_with_its_group);
    RUN_TEST(test_a_hull_or_a_group_that_does_not_fit_is_named);
    RUN_TEST(test_what_is_accepted_is_not_named_and_nothing_need_be);
    return UNITY_END();
}
