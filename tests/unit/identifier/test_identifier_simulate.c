/*
 * The simulated velocity of each set is attached by one call, and changes nothing else.
 */
#include <string.h>

#include "chain.h"
#include "unity.h"

enum { SETS = 3 };

static chain_config_t cfg;
static chain_t with, without;
static auvid_identifier_t id, before;
static auvid_validation_t storage;

void setUp(void)
{
    chain_defaults(&cfg, 1, SETS, 0.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg.id));
    before = id;
}

void tearDown(void)
{
}

static void test_null_and_an_identifier_that_is_not_initialised_are_refused(void)
{
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_prediction(NULL, &storage));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_prediction(&id, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof id);
    memset(&id, 0, sizeof id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_attach_prediction(&id, &storage));
}

static void test_it_attaches_once(void)
{
    static auvid_validation_t second, unchanged;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prediction(&id, &storage));
    unchanged = second;
    before = id;
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, auvid_identifier_attach_prediction(&id, &second));
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof id);
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &second, sizeof second);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg.id)); /* detaches it */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prediction(&id, &second));
}

static void test_it_attaches_before_the_first_step_only(void)
{
    const auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
    before = id;
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, auvid_identifier_attach_prediction(&id, &storage));
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof id);
}

static void test_without_it_nothing_is_simulated_and_the_estimates_are_the_same(void)
{
    chain_set_driver(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&with, &cfg, SETS));
    TEST_ASSERT_TRUE(with.id.change_test.simulated != 0);
    TEST_ASSERT_TRUE(with.id.change_test.r2_velocity[AUVID_SURGE] > AUVID_C(0.9));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&without, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&without.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&without.id, &without.change));
    chain_run(&without, SETS * CHAIN_SET_S + 6.0);
    TEST_ASSERT_NULL(without.id.attached.prediction);
    TEST_ASSERT_EQUAL(0, without.id.change_test.simulated);
    TEST_ASSERT_TRUE(with.id.estimate.number > 1);
    uint64_t with_us = with.id.estimate.t_us, without_us = without.id.estimate.t_us;
    TEST_ASSERT_TRUE(with_us >= without_us && with_us <= without_us + 2 * 20000);
    with.id.estimate.t_us = without_us; /* a cell waits until the one before is simulated */
    TEST_ASSERT_EQUAL_MEMORY(&with.id.estimate, &without.id.estimate, sizeof with.id.estimate);
    TEST_ASSERT_EQUAL_MEMORY(with.id.change_test.variance_ratio,
                             without.id.change_test.variance_ratio,
                             sizeof with.id.change_test.variance_ratio);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_null_and_an_identifier_that_is_not_initialised_are_refused);
    RUN_TEST(test_it_attaches_once);
    RUN_TEST(test_it_attaches_before_the_first_step_only);
    RUN_TEST(test_without_it_nothing_is_simulated_and_the_estimates_are_the_same);
    return UNITY_END();
}
