/*
 * A complete Girona500 with five equal thrusters: dead band, a gain in each direction, lag. Hull
 * and thrusters are identified together; the mass in surge is known.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/current.h"
#include "binomial.h"
#include "own_thrusters.h"
#include "unity.h"

void setUp(void)
{
    own_thrusters_defaults();
}

void tearDown(void)
{
}

/* Returns the relative error of parameter i; prints it in a campaign. */
static double error_of(int i)
{
    double error = (double)id.estimate.pi[i] / truth[i] - 1.0;
    if (campaign_is_long()) {
        printf("seed %u %-10s %6.2f +- %.2f %%\n", (unsigned)world.seed,
               thrusters.parameter[i].name, 100.0 * error,
               196.0 * fabs((double)id.estimate.confidence.sigma[i] / truth[i]));
    }
    return error;
}

/* The rms error over the 16 parameters is below 2.5 %, each error of the thrusters' below 5 %. */
static void test_hull_and_thrusters_are_identified_together(void)
{
    for (uint64_t seed = 1; seed <= (campaign_is_long() ? 10 : 1); ++seed) {
        double squares = 0.0;
        identify(seed);
        TEST_ASSERT_EQUAL_HEX32(FREE, id.estimate.identified);
        TEST_ASSERT_EQUAL_HEX32(FREE, id.estimate.confidence.identifiable);
        TEST_ASSERT_FALSE(id.estimate.not_converged);
        for (int i = 0; i < PARAMETERS; ++i) {
            double error = FREE >> i & 1u ? error_of(i) : 0.0;
            TEST_ASSERT_TRUE(i < OWN || fabs(error) < 0.05);
            squares += error * error / 16.0;
        }
        TEST_ASSERT_TRUE(sqrt(squares) < 0.025);
    }
}

/* Two nested models: thrusters around a hull in a current. */
static void test_thrusters_can_wrap_a_hull_in_a_current(void)
{
    static auvid_current_t current;
    auvid_thrusters_config_t config;
    auvid_identifier_config_t cfg;
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0}, e[AUVID_DOF_COUNT], expected[AUVID_DOF_COUNT];
    const auvid_real_t ahead[AUVID_MAX_COMMANDS] = {1};
    auvid_sample_t sample;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_current_init(&current, &auvid_girona500, false));
    auvid_thrusters_defaults(&config);
    config.hull = &current.vehicle;
    config.thrusters = 1;
    config.matrix[AUVID_SURGE][0] = 1;
    config.log = commands;
    config.slots = SLOTS;
    config.period_us = PERIOD_US;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &config, NULL));
    TEST_ASSERT_EQUAL_UINT8(OWN + 2 + 4, thrusters.vehicle.parameters);
    auvid_identifier_defaults(&cfg, &thrusters.vehicle);
    cfg.exact_inputs = true;
    cfg.metric.rows = store;
    cfg.metric.row_slots = sizeof store / sizeof store[0];
    cfg.metric.free &= ~(1u << AUVID_G500_M_U);
    cfg.metric.fixed[AUVID_G500_M_U] = (auvid_real_t)truth[AUVID_G500_M_U];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    for (uint64_t t_us = 0; t_us < 20000000; t_us += PERIOD_US) {
        auvid_thrusters_command(&thrusters, t_us, ahead);
    }
    for (int i = 0; i < PARAMETERS; ++i) {
        pi[i < OWN ? i : i + 2] = (auvid_real_t)truth[i];
    }
    pi[OWN] = (auvid_real_t)0.3;
    memset(&sample, 0, sizeof sample);
    sample.t_us = 15000000;
    sample.nu[AUVID_SURGE] = (auvid_real_t)0.5;
    sample.psi = (auvid_real_t)0.4;
    auvid_vehicle_residual(&thrusters.vehicle, &sample, pi, e);
    sample.tau[AUVID_SURGE] = (auvid_real_t)(80.0 * (1.0 - 0.1)); /* steady state */
    auvid_vehicle_residual(&current.vehicle, &sample, pi, expected);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(0.01, (double)expected[j], (double)e[j]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_hull_and_thrusters_are_identified_together);
    RUN_TEST(test_thrusters_can_wrap_a_hull_in_a_current);
    return UNITY_END();
}
