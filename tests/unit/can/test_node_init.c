/*
 * auvid_node_init: what it accepts, and the state in which it leaves the node.
 */
#include "node_frames.h"

static void test_after_an_init_that_fails_every_function_refuses_the_node(void)
{
    uint64_t t_us = 1000000;
    auvid_can_message_t m = {.kind = AUVID_CAN_DEPTH};
    begin();
    cfg.ids.slow = cfg.ids.fast;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_node_init(&node, &cfg, &thrusters, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, give(&m));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_step(&node, &t_us, sent, &count));
    TEST_ASSERT_EQUAL(0, count);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_work(&node, 1));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_report(&node, 0, sent, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_halt(&node, AUVID_GUARD_OPERATOR, sent, &count));
}

static void test_one_to_eight_thrusters_are_accepted(void)
{
    for (uint8_t count_of = 0; count_of <= AUVID_CAN_THRUSTERS + 1; ++count_of) {
        for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
            thrusters.thruster[i] = auvid_allocation_girona500.thruster[i % 5];
        }
        thrusters.thrusters = count_of;
        bool some = count_of >= 1 && count_of <= AUVID_CAN_THRUSTERS;
        TEST_ASSERT_EQUAL(some ? AUVID_OK : AUVID_ERR_SIZE,
                          auvid_node_init(&node, &cfg, &thrusters, &identifier));
        TEST_ASSERT_EQUAL(some, node.ready);
    }
}

static void test_null_and_overlapping_identifiers_are_refused(void)
{
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_init(NULL, &cfg, &thrusters, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_init(&node, NULL, &thrusters, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_init(&node, &cfg, NULL, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_init(&node, &cfg, &thrusters, NULL));
    cfg.ids.slow = cfg.ids.fast;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_node_init(&node, &cfg, &thrusters, &identifier));
    TEST_ASSERT_FALSE(node.ready);
    memset(&cfg, 0xFF, sizeof cfg);
    auvid_node_defaults(&cfg);
    TEST_ASSERT_FALSE(cfg.answer);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &cfg, &thrusters, &identifier));
}

static void test_init_accepts_its_own_configuration(void)
{
    cfg.answer = true;
    cfg.ids.slow = 0x480;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &cfg, &thrusters, &identifier));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &node.cfg, &thrusters, &identifier));
    TEST_ASSERT_TRUE(node.cfg.answer && node.cfg.ids.slow == 0x480);
}

static auvid_status_t init_with_identifiers(int fast, int slow)
{
    cfg.ids.fast = (uint16_t)fast;
    cfg.ids.slow = (uint16_t)slow;
    return auvid_node_init(&node, &cfg, &thrusters, &identifier);
}

static void test_all_frames_must_have_identifiers_of_11_bits(void)
{
    enum { LAST_FAST = 0x800 - AUVID_CAN_FAST_KINDS, LAST_SLOW = 0x800 - AUVID_CAN_SLOW_KINDS };
    TEST_ASSERT_EQUAL(AUVID_OK, init_with_identifiers(0, 0x400));
    TEST_ASSERT_EQUAL(AUVID_OK, init_with_identifiers(0x400, 0));
    TEST_ASSERT_EQUAL(AUVID_OK, init_with_identifiers(LAST_FAST, 0x400));
    TEST_ASSERT_EQUAL(AUVID_OK, init_with_identifiers(0x400, LAST_SLOW));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, init_with_identifiers(LAST_FAST + 1, 0x400));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, init_with_identifiers(0x400, LAST_SLOW + 1));
    TEST_ASSERT_FALSE(node.ready);
}

static void assert_refused(const char *part, const char *field, double value, double limit)
{
    const auvid_refusal_t *why = &node.id.refusal;
    TEST_ASSERT_EQUAL_STRING(part, why->part);
    TEST_ASSERT_EQUAL_STRING(field, why->field);
    TEST_ASSERT_TRUE((double)why->value == value && (double)why->limit == limit);
}

static void test_a_refusal_names_the_identifier_and_its_limit(void)
{
    enum { LAST_FAST = 0x800 - AUVID_CAN_FAST_KINDS, LAST_SLOW = 0x800 - AUVID_CAN_SLOW_KINDS };
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, init_with_identifiers(LAST_FAST + 1, 0x400));
    assert_refused("ids", "fast", LAST_FAST + 1, LAST_FAST);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, init_with_identifiers(0x400, LAST_SLOW + 1));
    assert_refused("ids", "slow", LAST_SLOW + 1, LAST_SLOW);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, init_with_identifiers(0x400, 0x401));
    assert_refused("ids", "slow", 0x401, 0x400 + AUVID_CAN_FAST_KINDS);
}

/* Thrusters, identifiers of the bus, the rest. */
static void test_of_several_faults_the_first_is_named(void)
{
    identifier.nav.sigma_dvl = -1;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, init_with_identifiers(0x400, 0x400));
    assert_refused("ids", "slow", 0x400, 0x400 + AUVID_CAN_FAST_KINDS);
    thrusters.thrusters = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, init_with_identifiers(0x400, 0x400));
    assert_refused("allocation", "thrusters", 0, 1);
}

static void test_after_init_there_is_no_sample(void)
{
    static const auvid_input_t none;
    memset(&node, 0xFF, sizeof node);
    begin();
    TEST_ASSERT_EQUAL_MEMORY(&none, &node.in, sizeof none);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_after_an_init_that_fails_every_function_refuses_the_node);
    RUN_TEST(test_one_to_eight_thrusters_are_accepted);
    RUN_TEST(test_null_and_overlapping_identifiers_are_refused);
    RUN_TEST(test_init_accepts_its_own_configuration);
    RUN_TEST(test_all_frames_must_have_identifiers_of_11_bits);
    RUN_TEST(test_a_refusal_names_the_identifier_and_its_limit);
    RUN_TEST(test_of_several_faults_the_first_is_named);
    RUN_TEST(test_after_init_there_is_no_sample);
    return UNITY_END();
}
