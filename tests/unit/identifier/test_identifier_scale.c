/* The scale of the wrench follows the thrusters, unless it is set. */
#include "auvid/identifier.h"

#include <math.h>
#include <string.h>

#include "unity.h"

static auvid_identifier_config_t cfg;
static auvid_identifier_t id;

void setUp(void)
{
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    cfg.allocation = auvid_allocation_girona500;
}

void tearDown(void)
{
}

static void assert_scale(auvid_dof_t dof, double expected)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_TRUE(fabs((double)id.metric.cfg.tau_max[dof] - expected) < 1e-4 * expected);
}

static void test_the_default_is_what_the_thrusters_give(void)
{
    assert_scale(AUVID_SURGE, 2 * 153.8);
    assert_scale(AUVID_SWAY, 153.8);
    assert_scale(AUVID_YAW, 2 * 0.4 * 153.8);
}

static void test_the_larger_direction_counts(void)
{
    cfg.allocation.thruster[4].min_N = -200;
    assert_scale(AUVID_SWAY, 200);
    cfg.allocation.thruster[4].min_N = -100;
    assert_scale(AUVID_SWAY, 153.8);
}

static void test_a_scale_that_is_set_stays(void)
{
    cfg.metric.tau_max[AUVID_SURGE] = 60;
    assert_scale(AUVID_SURGE, 60);
    assert_scale(AUVID_SWAY, 153.8);
}

static void test_without_thrusters_or_in_a_dof_without_one_it_is_100_and_40(void)
{
    assert_scale(AUVID_ROLL, 40);
    cfg.allocation.thruster[4].min_N = cfg.allocation.thruster[4].max_N = 0;
    assert_scale(AUVID_SWAY, 100);
    auvid_allocation_defaults(&cfg.allocation);
    assert_scale(AUVID_SURGE, 100);
    assert_scale(AUVID_YAW, 40);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_default_is_what_the_thrusters_give);
    RUN_TEST(test_the_larger_direction_counts);
    RUN_TEST(test_a_scale_that_is_set_stays);
    RUN_TEST(test_without_thrusters_or_in_a_dof_without_one_it_is_100_and_40);
    return UNITY_END();
}
