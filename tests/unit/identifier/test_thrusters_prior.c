/*
 * The data sheet of the thrusters as a prior of their parameters, beside the data of hull and
 * thrusters.
 */
#include <math.h>
#include <string.h>

#include "auvid/prior.h"
#include "auvid/thrusters.h"
#include "surge_thrusters.h"
#include "unity.h"

void setUp(void)
{
    surge_thrusters_defaults();
}

void tearDown(void)
{
}

static void test_the_sheet_is_a_prior_of_the_free_parameters(void)
{
    const double nominal[] = {80, 64, 0.05, 0.15}, sigma[] = {4, 64 * sqrt(0.005), 0.012, 0.06};
    cfg.sheet[0].gain = 80;
    cfg.sheet[0].backward = (auvid_real_t)0.8;
    cfg.sheet[0].dead_band = (auvid_real_t)0.05;
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL_HEX32(15u << HULL, prior.known);
    for (int k = 0; k < AUVID_THRUSTERS_PER_GROUP; ++k) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * nominal[k], nominal[k], (double)prior.pi[HULL + k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5 * sigma[k], sigma[k], (double)prior.sigma[HULL + k]);
    }
    TEST_ASSERT_TRUE(thrusters.vehicle.own_thrust);
    cfg.sheet[0].gain = 0;
    cfg.sheet[0].lag_sigma_s = 0;
    begin();
    id_config.metric.free &= ~(1u << FORWARD);
    id_config.metric.fixed[FORWARD] = 50; /* known: the backward gain follows */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL_HEX32(1u << BACKWARD | 1u << DEAD_BAND, prior.known);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 40.0, (double)prior.pi[BACKWARD]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 2.0, (double)prior.sigma[BACKWARD]);
    TEST_ASSERT_FALSE(thrusters.vehicle.own_thrust);
}

static void test_a_prior_is_attached_to_the_identifier_of_its_thrusters_before_it_steps(void)
{
    auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    auvid_identifier_config_t plain;
    memset(&thrusters, 0, sizeof thrusters);
    memset(&id, 0, sizeof id);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_attach_prior(NULL, &id, &prior));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_attach_prior(&thrusters, NULL, &prior));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_thrusters_attach_prior(&thrusters, &id, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    begin();
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    auvid_identifier_defaults(&plain, &hull);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &plain));
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
}

static void test_a_sharp_prior_fixes_a_parameter_and_one_that_the_data_contradict_is_discarded(void)
{
    identify(1, 1.0, 30, 5, 0);
    auvid_real_t sigma = id.estimate.confidence.sigma[LAG];
    use_sheet(1.02, 1e-4);
    identify(1, 1.0, 30, 5, 0);
    TEST_ASSERT_EQUAL_UINT32(2 * 6 + 1, id.estimate.evaluations_line); /* the steps end there */
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, 1.02 * truth[LAG], (double)id.estimate.pi[LAG]);
    TEST_ASSERT_TRUE(id.estimate.confidence.sigma[LAG] < sigma / 2);
    TEST_ASSERT_EQUAL_HEX32(15u << HULL, prior.known);
    use_sheet(2.0, 1e-4);
    identify(1, 1.0, 30, 5, 0);
    TEST_ASSERT_EQUAL_HEX32(0, prior.known);
    TEST_ASSERT_TRUE(fabs(error_of(LAG)) < 0.1);
}

/* All deviations 0. */
static void test_a_sheet_without_deviations_changes_no_bit(void)
{
    static auvid_estimate_t without;
    identify(1, 1.0, 30, 5, 0);
    without = id.estimate;
    use_sheet(2.0, 0.0);
    cfg.sheet[0].gain_sigma = cfg.sheet[0].backward_sigma = cfg.sheet[0].dead_band_sigma = 0;
    identify(1, 1.0, 30, 5, 0);
    TEST_ASSERT_EQUAL_HEX32(0, prior.known);
    TEST_ASSERT_EQUAL_MEMORY(&without, &id.estimate, sizeof without);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_sheet_is_a_prior_of_the_free_parameters);
    RUN_TEST(test_a_prior_is_attached_to_the_identifier_of_its_thrusters_before_it_steps);
    RUN_TEST(test_a_sharp_prior_fixes_a_parameter_and_one_that_the_data_contradict_is_discarded);
    RUN_TEST(test_a_sheet_without_deviations_changes_no_bit);
    return UNITY_END();
}
