/* The attachment of the change test. What it finds is in test_change_test.c. */
#include <string.h>

#include "chain.h"
#include "unity.h"

enum { SETS = 3 };

static auvid_identifier_t id, before;
static auvid_change_detector_t storage;
static chain_config_t cfg;
static chain_t with, without;

void setUp(void)
{
    chain_defaults(&cfg, 41, SETS, 1.0);
    memset(&storage, 0xFF, sizeof storage);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg.id));
    before = id;
}

void tearDown(void)
{
}

static void test_null_and_an_identifier_that_is_not_initialised_are_refused(void)
{
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_change_test(NULL, &storage));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_change_test(&id, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof id);
    memset(&id, 0, sizeof id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_attach_change_test(&id, &storage));
}

static void test_it_attaches_once_and_begins_without_an_accepted_estimate(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &storage));
    TEST_ASSERT_EQUAL_UINT32(0, storage.accepted.number);
    before = id;
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, auvid_identifier_attach_change_test(&id, &storage));
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof id);
}

static void test_it_attaches_before_the_first_step_only(void)
{
    const auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
    before = id;
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, auvid_identifier_attach_change_test(&id, &storage));
    TEST_ASSERT_EQUAL_MEMORY(&before, &id, sizeof id);
}

/* Two estimates predict the third set equally well: the test changes nothing but what it says. */
static void test_without_it_no_set_is_tested_and_the_estimates_are_the_same(void)
{
    chain_set_driver(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&with, &cfg, SETS));
    TEST_ASSERT_EQUAL_UINT32(SETS, with.id.change_test.set);
    TEST_ASSERT_TRUE(with.change.accepted.number > 0);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&without, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&without.id, &cfg.id));
    chain_run(&without, SETS * CHAIN_SET_S + 6.0);
    TEST_ASSERT_NULL(without.id.attached.change);
    TEST_ASSERT_EQUAL_UINT32(0, without.id.change_test.set);
    TEST_ASSERT_TRUE(without.id.estimate.number > 1 && !without.id.estimate.accepted);
    TEST_ASSERT_EQUAL_UINT32(with.id.estimate.number, without.id.estimate.number);
    TEST_ASSERT_EQUAL_MEMORY(with.id.estimate.pi, without.id.estimate.pi,
                             sizeof with.id.estimate.pi);
    TEST_ASSERT_EQUAL_MEMORY(&with.id.estimate.confidence, &without.id.estimate.confidence,
                             sizeof with.id.estimate.confidence);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_null_and_an_identifier_that_is_not_initialised_are_refused);
    RUN_TEST(test_it_attaches_once_and_begins_without_an_accepted_estimate);
    RUN_TEST(test_it_attaches_before_the_first_step_only);
    RUN_TEST(test_without_it_no_set_is_tested_and_the_estimates_are_the_same);
    return UNITY_END();
}
