/*
 * A user's own model, with public headers only: thrusters with a dead band and a different
 * gain in each direction, acting on the commands. It is neither linear in its parameters nor
 * differentiable. The mass is known (otherwise only the ratio of mass, drag and gain is
 * observable).
 */
#include <math.h>
#include <string.h>

#include "auvid/identifier.h"
#include "binomial.h"
#include "dead_band.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

static double worst_error(void)
{
    double worst = 0.0;
    for (int i = 0; i < PARAMETERS; ++i) {
        worst = fmax(worst, fabs((double)id.estimate.pi[i] / truth[i] - 1.0));
    }
    return worst;
}

/* Every parameter within 5 % of the truth, for each of 20 seeds. */
static void test_dead_band_and_gains_are_identified_within_5_percent_over_20_seeds(void)
{
    for (uint64_t seed = 1; seed <= campaign_runs(20); ++seed) {
        identify(seed, SETS, 2000, 0.0, 0.0);
        TEST_ASSERT_EQUAL_HEX32((1u << PARAMETERS) - 1, id.estimate.identified);
        TEST_ASSERT_FALSE(id.estimate.not_converged);
        TEST_ASSERT_TRUE(worst_error() < 0.05);
    }
}

/* An unmodelled delay is found, and does no harm. */
static void test_a_delay_of_the_thrusters_is_searched_with_the_parameters(void)
{
    for (uint64_t seed = 1; seed <= 5; ++seed) {
        identify(seed, SETS, 2000, 0.0, 0.14);
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.14, (double)id.estimate.delay_s[AUVID_SURGE]);
        TEST_ASSERT_TRUE(worst_error() < 0.05);
    }
}

static void test_a_budget_smaller_than_one_evaluation_gives_the_same_estimate(void)
{
    auvid_real_t pi[PARAMETERS];
    identify(1, SETS, UINT32_MAX, 0.0, 0.0);
    memcpy(pi, id.estimate.pi, sizeof pi);
    TEST_ASSERT_EQUAL_UINT32(SETS, id.estimate.sets);
    TEST_ASSERT_EQUAL_UINT32(SETS, id.metric.sets.recorded);
    TEST_ASSERT_TRUE(id.work.max_units > 1350);
    identify(1, SETS, 700, 0.0, 0.0);
    for (int i = 0; i < PARAMETERS; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * fabs(truth[i]), (double)pi[i], (double)id.estimate.pi[i]);
    }
}

/* At 1 N, at recorded speeds forward and backward. */
static void test_the_drag_force_of_a_model_without_regressor_is_known(void)
{
    identify(3, SETS, 2000, 1.0, 0.0);
    for (int k = 0; k < 6; ++k) {
        double largest = (double)id.estimate.speed[AUVID_SURGE][k % 2];
        double v = (k % 2 ? -1 : 1) * (k < 2 ? 0.3 : k < 4 ? 0.6 : 1.0) * largest;
        double force = truth[X_U] * v + truth[X_UU] * v * fabs(v);
        auvid_drag_t drag;
        TEST_ASSERT_TRUE(largest > 0.3 && largest < 2.0);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(&id.estimate, &vehicle, AUVID_SURGE,
                                                        (auvid_real_t)v, &drag));
        TEST_ASSERT_TRUE(drag.identifiable && drag.sigma > 0);
        TEST_ASSERT_TRUE(fabs((double)drag.force - force) < 2.0 * (double)drag.half_width);
    }
}

static void test_a_model_without_storage_for_its_rows_is_refused(void)
{
    auvid_identifier_config_t cfg;
    configure(&cfg, 1);
    cfg.metric.rows = NULL;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_identifier_init(&id, &cfg));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_dead_band_and_gains_are_identified_within_5_percent_over_20_seeds);
    RUN_TEST(test_a_delay_of_the_thrusters_is_searched_with_the_parameters);
    RUN_TEST(test_a_budget_smaller_than_one_evaluation_gives_the_same_estimate);
    RUN_TEST(test_the_drag_force_of_a_model_without_regressor_is_known);
    RUN_TEST(test_a_model_without_storage_for_its_rows_is_refused);
    return UNITY_END();
}
