/*
 * The self-test accepts this machine's arithmetic and refuses it in other modes. For contraction,
 * the test compiles a copy of the source with it.
 */
#include <fenv.h>
#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

#include "auvid/types.h"
#include "unity.h"

#if defined(__x86_64__)
/* auvid_math_internal.h disables contraction; the test enables it again afterwards, with FMA. */
#include "base/auvid_math_internal.h"
#if defined(__clang__)
#pragma STDC FP_CONTRACT ON
#pragma clang attribute push(__attribute__((target("fma"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC optimize("O2", "fp-contract=fast")
#pragma GCC target("fma")
#endif
#pragma push_macro("auvid_selftest")
#undef auvid_selftest
#define auvid_selftest contracted_selftest
#include "base/auvid_selftest.c"
#pragma pop_macro("auvid_selftest")
#if defined(__clang__)
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif
#endif

#if defined(__x86_64__)
#define FLUSH_TO_ZERO 0x8000u /* bits of the control register MXCSR */
#define DENORMALS_ARE_ZERO 0x0040u
#endif

void setUp(void)
{
}

void tearDown(void)
{
    fesetround(FE_TONEAREST);
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() & ~(FLUSH_TO_ZERO | DENORMALS_ARE_ZERO));
#endif
}

static void test_this_machine_is_accepted(void)
{
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_selftest());
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_selftest()); /* it keeps no state */
}

static void test_other_rounding_modes_are_refused(void)
{
    const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    for (int i = 0; i < 3; ++i) {
        fesetround(modes[i]);
        auvid_status_t status = auvid_selftest();
        fesetround(FE_TONEAREST);
        TEST_ASSERT_EQUAL_INT(AUVID_ERR_ARITHMETIC, status);
    }
}

static void test_flush_to_zero_is_refused(void)
{
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() | FLUSH_TO_ZERO);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_ARITHMETIC, auvid_selftest());
#else
    TEST_IGNORE_MESSAGE("set on x86-64 only");
#endif
}

static void test_denormals_are_zero_is_refused(void)
{
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() | DENORMALS_ARE_ZERO);
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_ARITHMETIC, auvid_selftest());
#else
    TEST_IGNORE_MESSAGE("set on x86-64 only");
#endif
}

static void test_contraction_is_refused(void)
{
#if defined(__x86_64__)
    if (!__builtin_cpu_supports("fma")) {
        TEST_IGNORE_MESSAGE("no fused multiply-add on this machine");
    }
    TEST_ASSERT_EQUAL_INT(AUVID_ERR_ARITHMETIC, contracted_selftest());
#else
    TEST_IGNORE_MESSAGE("compiled for x86-64 only");
#endif
}

static void test_the_machine_is_accepted_after_the_mode_is_restored(void)
{
    fesetround(FE_UPWARD);
    (void)auvid_selftest();
    fesetround(FE_TONEAREST);
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_selftest());
}

static void test_each_status_has_its_own_text(void)
{
    for (int i = AUVID_ERR_CONFIGURATION; i <= AUVID_SET_IDLE; ++i) {
        const char *text = auvid_status_str((auvid_status_t)i);
        TEST_ASSERT_TRUE(text[0] != '\0' && text != auvid_status_str((auvid_status_t)1000));
        for (int j = AUVID_ERR_CONFIGURATION; j < i; ++j) {
            TEST_ASSERT_TRUE(text != auvid_status_str((auvid_status_t)j));
        }
    }
    const int unknown[] = {-1000, AUVID_ERR_CONFIGURATION - 1, AUVID_SET_IDLE + 1, 1000};
    for (int i = 0; i < 4; ++i) {
        TEST_ASSERT_EQUAL_STRING("unknown status", auvid_status_str((auvid_status_t)unknown[i]));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_this_machine_is_accepted);
    RUN_TEST(test_other_rounding_modes_are_refused);
    RUN_TEST(test_flush_to_zero_is_refused);
    RUN_TEST(test_denormals_are_zero_is_refused);
    RUN_TEST(test_contraction_is_refused);
    RUN_TEST(test_the_machine_is_accepted_after_the_mode_is_restored);
    RUN_TEST(test_each_status_has_its_own_text);
    return UNITY_END();
}
