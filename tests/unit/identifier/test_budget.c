/*
 * Units of work that fit into a tick.
 */
#include <math.h>

#include "auvid/identifier.h"
#include "unity.h"

static const auvid_core_t core = {"mine", 1000, 100, 2};

void setUp(void)
{
}

void tearDown(void)
{
}

/* 1 MHz, 10 ms, 2 cycles: 5000 instructions, of which 1000 are reserved. */
static void test_the_time_less_the_reserve_is_divided_into_units(void)
{
    TEST_ASSERT_EQUAL_UINT32(40, auvid_budget(&core, 1000000, AUVID_C(0.01)));
    TEST_ASSERT_EQUAL_UINT32(90, auvid_budget(&core, 2000000, AUVID_C(0.01)));
}

static void test_a_part_of_a_unit_is_not_given(void)
{
    TEST_ASSERT_EQUAL_UINT32(1, auvid_budget(&core, 239000, AUVID_C(0.01)));
    TEST_ASSERT_EQUAL_UINT32(0, auvid_budget(&core, 219000, AUVID_C(0.01)));
}

static void test_a_tick_without_time_gives_no_unit(void)
{
    TEST_ASSERT_EQUAL_UINT32(0, auvid_budget(&core, 100000, AUVID_C(0.01)));
    TEST_ASSERT_EQUAL_UINT32(0, auvid_budget(&core, 1, AUVID_C(1e-9)));
}

static void test_a_budget_has_a_limit(void)
{
    TEST_ASSERT_EQUAL_UINT32(AUVID_BUDGET_LARGEST, auvid_budget(&core, AUVID_C(1e9), 3600));
    TEST_ASSERT_EQUAL_UINT32(AUVID_BUDGET_LARGEST, auvid_budget(&core, 1e15f, 1e15f));
}

static void test_wrong_arguments_give_no_unit(void)
{
    static const auvid_core_t wrong[] = {{"no tick", 0, 100, 2},
                                         {"no unit", 1000, 0, 2},
                                         {"no cycles", 1000, 100, 0},
                                         {"negative", 1000, 100, -2},
                                         {"NaN", 1000, 100, (auvid_real_t)NAN}};
    const auvid_real_t bad[] = {0, -1, (auvid_real_t)NAN, (auvid_real_t)INFINITY};
    TEST_ASSERT_EQUAL_UINT32(0, auvid_budget(NULL, 1000000, AUVID_C(0.01)));
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        TEST_ASSERT_EQUAL_UINT32(0, auvid_budget(&wrong[i], 1000000, AUVID_C(0.01)));
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        TEST_ASSERT_EQUAL_UINT32(0, auvid_budget(&core, bad[i], AUVID_C(0.01)));
        TEST_ASSERT_EQUAL_UINT32(0, auvid_budget(&core, 1000000, bad[i]));
    }
}

static uint32_t budget_of(auvid_core_number_t number, double frequency_hz, double time_s)
{
    return auvid_budget(&auvid_cores[number], (auvid_real_t)frequency_hz, (auvid_real_t)time_s);
}

static void test_the_cores_give_what_the_guide_says(void)
{
    TEST_ASSERT_EQUAL_UINT32(3289, budget_of(AUVID_CORE_M4F, 168e6, 0.01));
    TEST_ASSERT_GREATER_THAN_UINT32(AUVID_DEFAULT_BUDGET, budget_of(AUVID_CORE_M4F, 48e6, 0.01));
    TEST_ASSERT_EQUAL_UINT32(36, budget_of(AUVID_CORE_M0PLUS, 48e6, 0.02));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_time_less_the_reserve_is_divided_into_units);
    RUN_TEST(test_a_part_of_a_unit_is_not_given);
    RUN_TEST(test_a_tick_without_time_gives_no_unit);
    RUN_TEST(test_a_budget_has_a_limit);
    RUN_TEST(test_wrong_arguments_give_no_unit);
    RUN_TEST(test_the_cores_give_what_the_guide_says);
    return UNITY_END();
}
