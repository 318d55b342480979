/*
 * The acting half is attached by one call. Without it an identifier is passive, and whoever wants
 * it to act gets a status that says why it does not.
 */
#include <math.h>
#include <string.h>

#include "auvid/adaptive.h"
#include "auvid/node.h"
#include "chain.h"
#include "unity.h"

static chain_config_t cfg;
static chain_t chain;
static auvid_identifier_t before;
static auvid_actuation_t storage, unchanged;

void setUp(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    memset(&chain, 0, sizeof chain);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &cfg.thrusters));
}

void tearDown(void)
{
}

/* The status of attaching; after an error the identifier is as before. */
static auvid_status_t attach(void)
{
    before = chain.id;
    auvid_status_t status =
        auvid_identifier_attach_actuation(&chain.id, &storage, &cfg.acting, &chain.allocation);
    if (status < 0) {
        TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    } else {
        TEST_ASSERT_EQUAL_PTR(&storage, chain.id.actuation);
    }
    return status;
}

static void check_orders(auvid_status_t status)
{
    before = chain.id;
    TEST_ASSERT_EQUAL(status, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(status, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(status, auvid_identifier_stop(&chain.id));
    TEST_ASSERT_EQUAL(status, auvid_identifier_abort(&chain.id));
    TEST_ASSERT_EQUAL(status, auvid_identifier_disarm(&chain.id));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
}

static void test_orders_to_a_passive_identifier_are_refused(void)
{
    auvid_adaptive_config_t adaptive;
    auvid_adaptive_defaults(&adaptive);
    adaptive.amplitude[AUVID_SURGE] = 100;
    check_orders(AUVID_ERR_DETACHED);
    TEST_ASSERT_EQUAL(AUVID_ERR_DETACHED,
                      auvid_adaptive_begin(&chain.id, &chain.adaptive, &adaptive, NULL));
    memset(&chain.id, 0, sizeof chain.id);
    check_orders(AUVID_ERR_STATE); /* not initialised */
}

static void test_a_passive_identifier_excites_nothing_and_its_guard_is_disarmed(void)
{
    static const auvid_real_t none[AUVID_DOF_COUNT];
    cfg.passive = true;
    cfg.driver = cfg.acting.excitation;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_NULL(chain.id.actuation);
    for (int k = 0; k < 500; ++k) {
        chain_tick(&chain);
        TEST_ASSERT_EQUAL(AUVID_OK, chain.status);
        TEST_ASSERT_EQUAL_MEMORY(none, chain.out.excitation, sizeof none);
        TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, chain.out.guard);
        TEST_ASSERT_EQUAL(AUVID_GUARD_NO_CAUSE, chain.out.cause);
    }
    auvid_input_t in = {.t_us = chain.t_us}; /* a rejected step */
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_identifier_step(&chain.id, &in, &chain.out));
    TEST_ASSERT_EQUAL_MEMORY(none, chain.out.excitation, sizeof none);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_step(&chain.id, NULL, &chain.out));
    TEST_ASSERT_EQUAL_HEX32(0, chain.out.events);
}

static void test_null_is_refused(void)
{
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_actuation(NULL, &storage, &cfg.acting,
                                                                        &chain.allocation));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_actuation(
                                          &chain.id, NULL, &cfg.acting, &chain.allocation));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_identifier_attach_actuation(&chain.id, &storage, NULL,
                                                                        &chain.allocation));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    auvid_actuation_defaults(NULL);
}

static void test_an_identifier_that_is_not_initialised_is_refused(void)
{
    memset(&chain.id, 0, sizeof chain.id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, attach());
}

static void test_it_attaches_once(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    unchanged = storage;
    cfg.acting.guard.depth_max_m = 7;
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, attach());
    static const auvid_real_t none[AUVID_DOF_COUNT];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, 1000, none, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, attach());
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &storage, sizeof storage);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id)); /* detaches it */
    TEST_ASSERT_NULL(chain.id.actuation);
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    TEST_ASSERT_EQUAL_FLOAT(7.0f, (float)storage.guard.cfg.depth_max_m);
}

static void test_it_attaches_before_the_first_step_only(void)
{
    auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    unchanged = storage;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, attach());
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &storage, sizeof storage);
}

static void test_thrusters_that_are_not_initialised_are_refused(void)
{
    memset(&chain.allocation, 0, sizeof chain.allocation);
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, attach());
}

/* An identifier and a node refuse the same. */
static void check_refused(auvid_status_t status)
{
    static auvid_node_t node;
    auvid_node_config_t bus;
    auvid_node_defaults(&bus);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &bus, &cfg.thrusters, &cfg.id));
    TEST_ASSERT_EQUAL(status, auvid_node_attach_actuation(&node, &storage, &cfg.acting));
    TEST_ASSERT_TRUE(node.arm == NULL && node.id.actuation == NULL);
    TEST_ASSERT_EQUAL(status, attach());
    chain_defaults(&cfg, 1, 1, 0.0);
}

static void test_errors_of_the_parts_are_passed_on(void)
{
    cfg.acting.guard.depth_max_m = -1;
    check_refused(AUVID_ERR_RANGE);
    cfg.acting.guard.depth_min_m = cfg.acting.guard.depth_max_m + 1;
    check_refused(AUVID_ERR_BOUNDS);
    cfg.acting.guard.speed_max = (auvid_real_t)NAN;
    check_refused(AUVID_ERR_NOT_FINITE);
    cfg.acting.excitation.fade_s = -1;
    check_refused(AUVID_ERR_RANGE);
    cfg.acting.excitation.segments = AUVID_MAX_SEGMENTS + 1;
    check_refused(AUVID_ERR_SIZE);
    cfg.acting.excitation.segment[0].amplitude = 1000; /* more than the thrusters give */
    check_refused(AUVID_ERR_CAPACITY);
    check_orders(AUVID_ERR_DETACHED);
    cfg.acting.excitation.segment[0].amplitude = 1000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&chain.id, &storage, &cfg.acting,
                                                                  NULL)); /* no thruster limits */
}

static void test_without_an_excitation_arming_is_refused(void)
{
    auvid_excitation_defaults(&cfg.acting.excitation);
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, storage.guard.state);
}

static void test_a_node_attaches_once_and_before_its_first_tick_only(void)
{
    static auvid_node_t node;
    const uint64_t t_us = 20000;
    auvid_can_frame_t frame[AUVID_NODE_COMMANDS];
    auvid_node_config_t bus;
    int count;
    auvid_node_defaults(&bus);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_attach_actuation(NULL, &storage, &cfg.acting));
    memset(&node, 0, sizeof node);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_attach_actuation(&node, &storage, &cfg.acting));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &bus, &cfg.thrusters, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&node, &storage, &cfg.acting));
    TEST_ASSERT_EQUAL_PTR(&node.allocation, storage.allocation);
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED,
                      auvid_node_attach_actuation(&node, &storage, &cfg.acting));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &bus, &cfg.thrusters, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, &t_us, frame, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, auvid_node_attach_actuation(&node, &storage, &cfg.acting));
    TEST_ASSERT_TRUE(node.arm == NULL && node.id.actuation == NULL);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_orders_to_a_passive_identifier_are_refused);
    RUN_TEST(test_a_passive_identifier_excites_nothing_and_its_guard_is_disarmed);
    RUN_TEST(test_null_is_refused);
    RUN_TEST(test_an_identifier_that_is_not_initialised_is_refused);
    RUN_TEST(test_it_attaches_once);
    RUN_TEST(test_it_attaches_before_the_first_step_only);
    RUN_TEST(test_thrusters_that_are_not_initialised_are_refused);
    RUN_TEST(test_errors_of_the_parts_are_passed_on);
    RUN_TEST(test_without_an_excitation_arming_is_refused);
    RUN_TEST(test_a_node_attaches_once_and_before_its_first_tick_only);
    return UNITY_END();
}
