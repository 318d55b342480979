/* The checkpoint of an identifier with adaptive excitation. */
#include <string.h>

#include "adaptive_run.h"
#include "auvid/checkpoint.h"
#include "unity.h"

void setUp(void)
{
    make_world(1, 1.0);
}

void tearDown(void)
{
}

static chain_t other;
static uint8_t bytes[AUVID_CHECKPOINT_MAX(0)];

/* @return bytes of a checkpoint of chain. */
static uint32_t save(void)
{
    auvid_checkpoint_t cursor;
    uint32_t count = sizeof bytes;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, &chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_next(&cursor, bytes, &count));
    return count;
}

/* Restore into other, where an adaptive excitation has been begun; both continue equally. */
static void restore_and_continue(uint32_t count, int seconds)
{
    other = chain;
    memset(&other.id, 0xA5, sizeof other.id);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&other, &config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&other.id, &other.adaptive, &cfg, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_resume(&other.id, bytes, count));
    for (int k = 0; k < seconds * 50; ++k) {
        chain_tick(&chain);
        chain_tick(&other);
        TEST_ASSERT_EQUAL_MEMORY(chain.out.excitation, other.out.excitation,
                                 sizeof chain.out.excitation);
    }
}

static void test_a_checkpoint_continues_bit_for_bit(void)
{
    begin();
    chain_run(&chain, 65);
    restore_and_continue(save(), 60);
    TEST_ASSERT_TRUE(chain.id.estimate.number > 2);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, other.out.guard);
    TEST_ASSERT_EQUAL_MEMORY(chain.id.estimate.pi, other.id.estimate.pi,
                             sizeof chain.id.estimate.pi);
}

/* As a sequence its plan would excite all degrees of freedom together, at full amplitude. */
static void test_a_checkpoint_of_it_is_refused_where_it_has_not_been_begun(void)
{
    static auvid_identifier_t before;
    begin();
    uint32_t count = save();
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_DETACHED, auvid_checkpoint_resume(&chain.id, bytes, count));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
}

static void test_a_checkpoint_of_a_sequence_is_refused_where_it_has_been_begun(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    chain_run(&chain, 5);
    uint32_t count = save();
    begin();
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, auvid_checkpoint_restore(&chain.id, bytes, count));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_checkpoint_continues_bit_for_bit);
    RUN_TEST(test_a_checkpoint_of_it_is_refused_where_it_has_not_been_begun);
    RUN_TEST(test_a_checkpoint_of_a_sequence_is_refused_where_it_has_been_begun);
    return UNITY_END();
}
