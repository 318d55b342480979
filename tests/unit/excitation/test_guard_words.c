/* The guard's causes in words. */
#include <string.h>

#include "auvid/guard.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* auvid_identifier_step(&id, &in, NULL) aborts for this cause, too. */
static void test_the_cause_without_input_also_names_the_output(void)
{
    const char *words = auvid_guard_cause_str(AUVID_GUARD_NO_INPUT);
    TEST_ASSERT_NOT_NULL(strstr(words, "input"));
    TEST_ASSERT_NOT_NULL(strstr(words, "output"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_cause_without_input_also_names_the_output);
    return UNITY_END();
}
