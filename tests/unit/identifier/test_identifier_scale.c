/* The scale of the wrench follows the thrusters, once they are known and unless it is set. */
#include "auvid/node.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static auvid_identifier_config_t cfg;
static auvid_allocation_config_t thrusters;
static auvid_actuation_config_t acting;
static auvid_identifier_t id;
static auvid_allocation_t allocation;
static auvid_actuation_t actuation;
static auvid_node_t node;

void setUp(void)
{
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    auvid_actuation_defaults(&acting);
    thrusters = auvid_allocation_girona500;
}

void tearDown(void)
{
}

static void check(const auvid_identifier_t *of, auvid_dof_t dof, double expected)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-4 * expected, expected, (double)of->metric.cfg.tau_max[dof]);
}

static auvid_status_t attach(const auvid_allocation_t *to)
{
    return auvid_identifier_attach_actuation(&id, &actuation, &acting, to);
}

static auvid_status_t attach_uncertain(double backward)
{
    static auvid_uncertain_t uncertain;
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
    inputs.backward = (auvid_real_t)backward;
    return auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &allocation);
}

/* The same of an identifier with an acting half, of one with uncertain inputs, and of a passive
 * node. */
static void assert_scale(auvid_dof_t dof, double expected)
{
    auvid_node_config_t bus;
    auvid_node_defaults(&bus);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &bus, &thrusters, &cfg));
    check(&node.id, dof, expected);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&node, &actuation, &acting));
    check(&node.id, dof, expected);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, attach(&allocation));
    check(&id, dof, expected);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, attach_uncertain(0.05));
    check(&id, dof, expected);
}

static void test_the_default_is_what_the_thrusters_give(void)
{
    assert_scale(AUVID_SURGE, 2 * 153.8);
    assert_scale(AUVID_SWAY, 153.8);
    assert_scale(AUVID_YAW, 2 * 0.4 * 153.8);
}

static void test_the_larger_direction_counts(void)
{
    thrusters.thruster[4].min_N = -200;
    assert_scale(AUVID_SWAY, 200);
    thrusters.thruster[4].min_N = -100;
    assert_scale(AUVID_SWAY, 153.8);
}

static void test_a_scale_that_is_set_stays(void)
{
    cfg.metric.tau_max[AUVID_SURGE] = 60;
    assert_scale(AUVID_SURGE, 60);
    assert_scale(AUVID_SWAY, 153.8);
}

static void test_in_a_dof_without_thruster_it_is_100_and_40(void)
{
    assert_scale(AUVID_ROLL, 40);
    thrusters.thruster[4].min_N = thrusters.thruster[4].max_N = 0;
    assert_scale(AUVID_SWAY, 100);
}

static void test_of_a_light_vehicle_it_is_that_of_another_dof_there(void)
{
    for (int i = 0; i < thrusters.thrusters; ++i) {
        thrusters.thruster[i].max_N = i == 4 ? 0 : i < 2 ? 3 : 4;
        thrusters.thruster[i].min_N = -thrusters.thruster[i].max_N;
    }
    assert_scale(AUVID_SURGE, 3 + 3);
    assert_scale(AUVID_SWAY, 4 + 4);
    assert_scale(AUVID_HEAVE, 4 + 4);
    assert_scale(AUVID_ROLL, 0.35 * (4 + 4)); /* of pitch: more than in yaw */
}

static void test_without_thrusters_it_is_100_and_40(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    check(&id, AUVID_SURGE, 100);
    check(&id, AUVID_YAW, 40);
    TEST_ASSERT_EQUAL(AUVID_OK, attach(NULL));
    check(&id, AUVID_SURGE, 100);
    check(&id, AUVID_YAW, 40);
}

static void test_a_thruster_without_limit_gives_no_scale(void)
{
    thrusters.thruster[4].max_N = AUVID_C(2e9);
    assert_scale(AUVID_SWAY, 100);
    thrusters.thruster[4].max_N = AUVID_RECORDER_LARGEST;
    assert_scale(AUVID_SWAY, (double)AUVID_RECORDER_LARGEST);
}

/* The scale of recorded sets cannot change any more. */
static void test_after_a_wrench_is_recorded_it_does_not_change(void)
{
    const auvid_real_t wrench[AUVID_DOF_COUNT] = {0};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, 1, wrench, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, attach(&allocation));
    check(&id, AUVID_SURGE, 100);
    TEST_ASSERT_NULL(id.actuation);
}

static void test_a_refused_excitation_leaves_it(void)
{
    acting.excitation.segments = AUVID_MAX_SEGMENTS + 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, attach(&allocation));
    check(&id, AUVID_SURGE, 100);
}

static void test_refused_uncertain_inputs_leave_it(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, attach_uncertain(-1));
    check(&id, AUVID_SURGE, 100);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_default_is_what_the_thrusters_give);
    RUN_TEST(test_the_larger_direction_counts);
    RUN_TEST(test_a_scale_that_is_set_stays);
    RUN_TEST(test_in_a_dof_without_thruster_it_is_100_and_40);
    RUN_TEST(test_of_a_light_vehicle_it_is_that_of_another_dof_there);
    RUN_TEST(test_without_thrusters_it_is_100_and_40);
    RUN_TEST(test_a_thruster_without_limit_gives_no_scale);
    RUN_TEST(test_after_a_wrench_is_recorded_it_does_not_change);
    RUN_TEST(test_a_refused_excitation_leaves_it);
    RUN_TEST(test_refused_uncertain_inputs_leave_it);
    return UNITY_END();
}
