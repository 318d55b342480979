/*
 * The self-test of models accepts all models of the library at the sizes of the program.
 */
#include <string.h>

#include "auvid/allocation.h"
#include "auvid/vehicle.h"
#include "auvid/current.h"
#include "auvid/fossen.h"
#include "auvid/identifier.h"
#include "auvid/thrusters.h"
#include "unity.h"

static auvid_vehicle_fault_t fault;
static auvid_real_t pi[AUVID_MAX_PARAMETERS];

void setUp(void)
{
    memset(pi, 0, sizeof pi);
    memcpy(pi, auvid_girona500_paper, sizeof auvid_girona500_paper);
}

void tearDown(void)
{
}

static void accept(const auvid_vehicle_t *vehicle, uint64_t t_us, double tolerance)
{
    auvid_status_t status =
        auvid_vehicle_selftest(vehicle, pi, t_us, (auvid_real_t)tolerance, &fault);
    TEST_ASSERT_EQUAL_STRING_MESSAGE(NULL, fault.what, vehicle->name);
    TEST_ASSERT_EQUAL(AUVID_OK, status);
}

static void test_girona500(void)
{
    accept(&auvid_girona500, 0, 0);
    accept(&auvid_girona500_printed, 0, 0);
    accept(&auvid_girona500_decoupled, 0, 0);
}

static void test_six_degrees_of_freedom(void)
{
    memcpy(pi, auvid_bluerov2_heavy_benzon, sizeof auvid_bluerov2_heavy_benzon);
    accept(&auvid_fossen, 0, 0);
    accept(&auvid_bluerov2_heavy, 0, 0);
}

static void test_averaged_models(void)
{
    static auvid_averaged_t model;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_averaged_init(&model, &auvid_girona500, 100000, 200000));
    accept(&model.vehicle, 0, 0.01);
    memcpy(pi, auvid_bluerov2_heavy_benzon, sizeof auvid_bluerov2_heavy_benzon);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_averaged_init(&model, &auvid_bluerov2_heavy, 100000, 200000));
    accept(&model.vehicle, 0, 0.01);
}

static void test_hulls_in_a_current(void)
{
    static auvid_current_t model;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_current_init(&model, &auvid_girona500, true));
    pi[AUVID_G500_COUNT] = AUVID_C(0.3);
    pi[AUVID_G500_COUNT + 1] = AUVID_C(-0.2);
    accept(&model.vehicle, 0, 0);
}

/* The log holds commands up to a second after the samples' time. */
static void test_a_hull_with_thrusters(void)
{
    enum { SLOTS = AUVID_THRUSTERS_SLOTS(1u, 30000000u, 20000u), SETS = 1, ROWS = 60 };
    static auvid_thrusters_t model;
    static auvid_thrusters_config_t own;
    static auvid_identifier_config_t cfg;
    static int16_t log[SLOTS * 5];
    static auvid_row_t rows[(SETS + 1) * ROWS];
    auvid_thrusters_defaults(&own);
    own.hull = &auvid_girona500;
    own.thrusters = auvid_allocation_girona500.thrusters;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int k = 0; k < own.thrusters; ++k) {
            own.matrix[j][k] = auvid_allocation_girona500.thruster[k].wrench[j];
        }
    }
    own.log = log;
    own.slots = SLOTS;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&model, &own, NULL));
    auvid_identifier_defaults(&cfg, &model.vehicle);
    cfg.metric.rows = rows;
    cfg.metric.row_slots = sizeof rows / sizeof rows[0];
    cfg.metric.sets = SETS;
    cfg.metric.set_rows = ROWS;
    cfg.metric.free &= ~(1u << AUVID_G500_M_U);
    cfg.metric.fixed[AUVID_G500_M_U] = pi[AUVID_G500_M_U];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&model, &cfg));
    for (uint64_t k = 0; k < 500; ++k) {
        auvid_real_t command[AUVID_MAX_COMMANDS] = {0};
        for (int i = 0; i < own.thrusters; ++i) {
            command[i] = AUVID_C(0.2) * (auvid_real_t)(i - 2) + (k % 100 < 50 ? AUVID_C(0.3) : 0);
        }
        auvid_thrusters_command(&model, 20000 * (k + 1), command);
    }
    auvid_real_t *group = pi + AUVID_G500_COUNT;
    group[AUVID_THRUSTERS_FORWARD] = group[AUVID_THRUSTERS_BACKWARD] = 150;
    group[AUVID_THRUSTERS_DEAD_BAND] = AUVID_C(0.05);
    group[AUVID_THRUSTERS_LAG] = AUVID_C(0.1);
    accept(&model.vehicle, 8000000, 0);
    auvid_real_t e[AUVID_DOF_COUNT];
    const auvid_sample_t now = {.t_us = 8000000};
    auvid_vehicle_residual(&model.vehicle, &now, pi, e); /* the thrust is in the log there */
    TEST_ASSERT_TRUE(e[AUVID_SURGE] < -10 || e[AUVID_SURGE] > 10);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_girona500);
    RUN_TEST(test_six_degrees_of_freedom);
    RUN_TEST(test_averaged_models);
    RUN_TEST(test_hulls_in_a_current);
    RUN_TEST(test_a_hull_with_thrusters);
    return UNITY_END();
}
