/*
 * Init refuses a machine with different arithmetic, and the status text tells what to change. The
 * control register sets the arithmetic, on x86-64 and on Cortex-M with an FPU. test_selftest.c
 * tests the self-test itself, tests/program/test_hostile_builds.sh the compiler flags.
 */
#include <string.h>

#include "auvid/node.h"
#include "unity.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#define SETTABLE 1
#define FLUSH_TO_ZERO 0x8000u
#define ROUNDING_SHIFT 13
static uint32_t control(void)
{
    return _mm_getcsr();
}
static void set_control(uint32_t bits)
{
    _mm_setcsr(bits);
}
#elif defined(__ARM_FP)
#define SETTABLE 1
#define FLUSH_TO_ZERO (1u << 24)
#define ROUNDING_SHIFT 22
static uint32_t control(void)
{
    uint32_t bits;
    __asm__ volatile("vmrs %0, fpscr" : "=r"(bits));
    return bits;
}
static void set_control(uint32_t bits)
{
    __asm__ volatile("vmsr fpscr, %0" ::"r"(bits) : "memory");
}
#endif

static auvid_identifier_config_t cfg;
static auvid_node_config_t bus;
static auvid_node_t node;

void setUp(void)
{
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    auvid_node_defaults(&bus);
}

void tearDown(void)
{
}

static void test_init_accepts_this_machine(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&node.id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &bus, &auvid_allocation_girona500, &cfg));
}

#if defined(SETTABLE)
static void check_refused(uint32_t bits)
{
    auvid_input_t in;
    auvid_output_t out;
    uint32_t before = control();
    set_control(before | bits);
    auvid_status_t identifier = auvid_identifier_init(&node.id, &cfg);
    auvid_status_t step = (memset(&in, 0, sizeof in), auvid_identifier_step(&node.id, &in, &out));
    auvid_status_t whole = auvid_node_init(&node, &bus, &auvid_allocation_girona500, &cfg);
    set_control(before);
    TEST_ASSERT_EQUAL(AUVID_ERR_ARITHMETIC, identifier);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, step);
    TEST_ASSERT_EQUAL(AUVID_ERR_ARITHMETIC, whole);
    test_init_accepts_this_machine(); /* init keeps no state of the refusal */
}

static void test_init_refuses_a_machine_that_flushes_to_zero(void)
{
    check_refused(FLUSH_TO_ZERO);
}

static void test_init_refuses_other_rounding_modes(void)
{
    for (uint32_t mode = 1; mode < 4; ++mode) {
        check_refused(mode << ROUNDING_SHIFT);
    }
}
#endif

static void test_the_status_text_tells_what_to_change(void)
{
    const char *text = auvid_status_str(AUVID_ERR_ARITHMETIC);
    TEST_ASSERT_NOT_NULL(strstr(text, "flush"));
    TEST_ASSERT_NOT_NULL(strstr(text, "round to nearest"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_init_accepts_this_machine);
#if defined(SETTABLE)
    RUN_TEST(test_init_refuses_a_machine_that_flushes_to_zero);
    RUN_TEST(test_init_refuses_other_rounding_modes);
#endif
    RUN_TEST(test_the_status_text_tells_what_to_change);
    return UNITY_END();
}
