/* The last estimate is read through a function; the wrench is given in the tick or after it. */
#include "two_sets.h"
#include "unity.h"

void setUp(void)
{
    two_sets_defaults();
    cfg.budget = AUVID_DEFAULT_BUDGET;
}

void tearDown(void)
{
}

static void test_there_is_no_estimate_before_the_first(void)
{
    TEST_ASSERT_NULL(auvid_identifier_estimate(NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_NULL(auvid_identifier_estimate(&chain.id));
    while (chain.estimates == 0) {
        TEST_ASSERT_NULL(auvid_identifier_estimate(&chain.id));
        chain_run(&chain, 1.0);
    }
    const auvid_estimate_t *estimate = auvid_identifier_estimate(&chain.id);
    TEST_ASSERT_EQUAL_PTR(&chain.id.estimate, estimate);
    TEST_ASSERT_EQUAL_UINT32(1, estimate->number);
    TEST_ASSERT_TRUE(estimate->pi[0] > 0);
}

/* Leave the wrench out of the step's input, and record it afterwards with the tick's time. */
static auvid_input_t given;

static void leave_out(chain_t *c, auvid_input_t *in)
{
    (void)c;
    given = *in;
    in->applied.present = false;
}

static void record_afterwards(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    (void)out;
    TEST_ASSERT_EQUAL(AUVID_OK, status);
    if (given.applied.present) {
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_identifier_applied(&c->id, given.t_us, given.applied.wrench, NULL));
    }
}

static void test_a_wrench_recorded_after_the_step_gives_the_same_estimate(void)
{
    chain_set_driver(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 40.0);
    cfg.before = leave_out;
    cfg.after = record_afterwards;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&other, &cfg));
    chain_run(&other, 40.0);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    for (int i = 0; i < 13; ++i) {
        TEST_ASSERT_TRUE(chain.id.estimate.pi[i] == other.id.estimate.pi[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_there_is_no_estimate_before_the_first);
    RUN_TEST(test_a_wrench_recorded_after_the_step_gives_the_same_estimate);
    return UNITY_END();
}
