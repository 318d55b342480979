/*
 * Confidence: standard errors, on data for which they are known, and the job that computes them.
 * Coverage is measured in tests/reference/test_coverage.cpp.
 * tests/reference/test_confidence_reference.cpp computes the formulas again.
 */
#include <math.h>
#include <string.h>

#include "auvid/detail/confidence.h"
#include "chain.h"
#include "confidence_data.h"
#include "finish.h"
#include "unity.h"

void setUp(void)
{
    confidence_data_defaults();
}

void tearDown(void)
{
}

/* The predicted bias grows with the square of the noise. The rounding of stored sets acts like a
 * noise of 0.02 N. Both are small here. */
static void test_standard_errors_are_proportional_to_the_noise(void)
{
    auvid_real_t sigma[COUNT];
    observe(&(world_t){ALL, SETS, 0.4, 0.0});
    memcpy(sigma, result->sigma, sizeof sigma);
    observe(&(world_t){ALL, SETS, 0.8, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 2.0, (double)result->sigma[i] / (double)sigma[i]);
    }
}

static void test_standard_errors_fall_as_sets_come_in(void)
{
    auvid_real_t sigma[COUNT];
    double ratio = 0.0;
    observe(&(world_t){ALL, 2, 1.0, 0.0});
    memcpy(sigma, result->sigma, sizeof sigma);
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_TRUE(result->sigma[i] < sigma[i]);
        ratio += log((double)sigma[i] / (double)result->sigma[i]) / COUNT;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.35, log(2.0), ratio); /* a quarter of the data */
}

static void test_one_set_is_enough_for_standard_errors(void)
{
    observe(&(world_t){ALL, 1, 1.0, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        double error = fabs((double)estimate[i] - (double)truth[i]);
        TEST_ASSERT_TRUE(result->sigma[i] > AUVID_C(0.0));
        TEST_ASSERT_TRUE(result->sigma[i] < AUVID_LARGEST);
        TEST_ASSERT_TRUE(error < 5.0 * (double)result->sigma[i]);
    }
}

/* The numbers are those of the build in double. In float, with sets stored in 16 bits, the results
 * were within 4e-3 of them; with sets in float, within 4e-5. */
static void test_float_and_double_give_the_same_standard_errors(void)
{
    static const double expected[COUNT] = {0.16674,  0.170391, 0.205302, 0.0743761, 0.0231826,
                                           0.282209, 1.01882,  0.321731, 1.04528,   0.312877,
                                           1.11128,  0.165562, 0.513716};
    double tolerance = sizeof(auvid_real_t) == sizeof(double) ? 1e-5 : 5e-3;
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    for (int i = 0; i < COUNT; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(tolerance * expected[i], expected[i], (double)result->sigma[i]);
    }
}

static void test_any_budget_gives_the_same_bits(void)
{
    static const uint32_t pieces[] = {1, 2, 7, 100};
    static auvid_confidence_t whole;
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    whole = *result;
    for (size_t k = 0; k < sizeof pieces / sizeof pieces[0]; ++k) {
        auvid_status_t status = AUVID_PENDING;
        uint32_t turns = 0;
        auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), NULL);
        while (status == AUVID_PENDING) {
            finish_turn(&turns, 1000000);
            uint32_t budget = pieces[k];
            status = auvid_confidence_work(&job, &metric, &budget);
            TEST_ASSERT_TRUE(status != AUVID_PENDING || budget == 0);
        }
        TEST_ASSERT_EQUAL(AUVID_OK, status);
        TEST_ASSERT_EQUAL_MEMORY(&whole, result, sizeof whole);
    }
}

static void test_a_job_copied_half_way_with_its_metric_continues(void)
{
    static auvid_metric_t other;
    static auvid_confidence_job_t copy;
    static auvid_confidence_t whole;
    uint32_t budget = 400;
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    whole = *result;
    auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), NULL);
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_confidence_work(&job, &metric, &budget));
    other = metric;
    copy = job;
    memset(&metric, 0xA5, sizeof metric);
    budget = UINT32_MAX;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&copy, &other, &budget));
    TEST_ASSERT_EQUAL_MEMORY(&whole, &copy.result, sizeof whole);
}

static void test_the_cost_of_eight_sets_is_what_the_header_says(void)
{
    uint32_t budget = UINT32_MAX;
    observe(&(world_t){ALL, SETS, 1.0, 0.0});
    auvid_confidence_begin(&job, &metric, estimate, AUVID_C(0.0), NULL);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
    TEST_ASSERT_UINT32_WITHIN(50, 7700, UINT32_MAX - budget);
}

/* An unmodelled lag of the thrusters: the errors of the masses contain the cost of its estimate. */
static void test_an_estimated_delay_widens_the_masses(void)
{
    static chain_t chain;
    static chain_config_t cfg;
    double widened[2][COUNT];
    for (int known = 0; known < 2; ++known) {
        chain_defaults(&cfg, 3, 4, 1.0);
        cfg.sim.lag_s = 0.15;
        cfg.budget = 0;
        cfg.id.uncertainty.delay_s = 0; /* a given delay has none */
        if (known) {                    /* as it was estimated */
            memcpy(cfg.id.metric.delay_s, chain.id.estimate.delay_s, sizeof cfg.id.metric.delay_s);
            cfg.id.metric.first_order_lag = chain.id.estimate.first_order_lag;
            cfg.id.metric.estimate_delay = false;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 4));
        TEST_ASSERT_TRUE(chain_finish(&chain, UINT32_MAX, 10) <= 10);
        for (int i = 0; i < COUNT; ++i) {
            widened[known][i] = (double)chain.id.estimate.confidence.sigma[i];
        }
    }
    for (int i = 0; i < COUNT; ++i) {
        double ratio = widened[0][i] / widened[1][i];
        TEST_ASSERT_TRUE(ratio > 0.999);
        TEST_ASSERT_TRUE(ratio < 2.0);
        TEST_ASSERT_TRUE(i > AUVID_G500_M_R || ratio > 1.03);
    }
}

static void test_wrong_arguments_are_refused(void)
{
    static const auvid_real_t lower[AUVID_MAX_PARAMETERS], upper[AUVID_MAX_PARAMETERS];
    static const auvid_confidence_t notes;
    char text[160];
    uint32_t budget = 1;
    observe(&(world_t){SURGE, 1, 1.0, 0.0});
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_work(NULL, &metric, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_work(&job, NULL, &budget));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_confidence_work(&job, &metric, NULL));
    TEST_ASSERT_EQUAL_UINT32(1, budget);
    auvid_confidence_begin(NULL, &metric, estimate, AUVID_C(0.0), NULL);
    auvid_confidence_begin(&job, NULL, estimate, AUVID_C(0.0), NULL);
    auvid_confidence_begin(&job, &metric, NULL, AUVID_C(0.0), NULL);
    auvid_confidence_limits(NULL, lower, upper, true);
    auvid_confidence_limits(&job, NULL, upper, true);
    auvid_confidence_limits(&job, lower, NULL, true);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_confidence_missing(&notes, NULL, 0, 0, text, sizeof text));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_confidence_missing(&notes, &auvid_girona500, 0, 0, NULL, 10));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_confidence_missing(&notes, &auvid_girona500, 0, 0, text, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_standard_errors_are_proportional_to_the_noise);
    RUN_TEST(test_standard_errors_fall_as_sets_come_in);
    RUN_TEST(test_one_set_is_enough_for_standard_errors);
    RUN_TEST(test_float_and_double_give_the_same_standard_errors);
    RUN_TEST(test_any_budget_gives_the_same_bits);
    RUN_TEST(test_a_job_copied_half_way_with_its_metric_continues);
    RUN_TEST(test_the_cost_of_eight_sets_is_what_the_header_says);
    RUN_TEST(test_an_estimated_delay_widens_the_masses);
    RUN_TEST(test_wrong_arguments_are_refused);
    return UNITY_END();
}
