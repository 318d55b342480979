/*
 * A flood of random frames with the identifiers of thruster commands. How many are good for the
 * receiver? By the rules in can.h
 *     p = 2^-8 (checksum) * (8002 / 8192)^4 (four thrusts in range, or not available) * 3 / 16
 * and such a command acts until the next good command, or for 150 ms.
 */
#include <stdio.h>
#include <string.h>

#include "auvid/can.h"
#include "base/auvid_math_internal.h"
#include "binomial.h"
#include "unity.h"

#define TICK_US 20000u

void setUp(void)
{
}

void tearDown(void)
{
}

static void random_frame(auvid_rng_t *rng, auvid_can_frame_t *frame)
{
    uint32_t low = auvid_rng_next(rng), high = auvid_rng_next(rng);
    frame->length = 8;
    memcpy(frame->data, &low, 4);
    memcpy(frame->data + 4, &high, 4);
}

static void test_forged_commands_are_good_at_the_rate_of_the_rules(void)
{
    const uint32_t frames = campaign_is_long() ? 100000000u : 10000000u;
    const double part = 8002.0 / 8192.0;
    const double p = part * part * part * part * 3.0 / 16.0 / 256.0;
    auvid_can_command_t command;
    auvid_rng_t rng;
    auvid_can_frame_t frame;
    uint32_t good = 0;
    memset(&frame, 0, sizeof frame);
    auvid_rng_seed(&rng, 4);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_init(&command, 4, NULL));
    frame.id = auvid_can_id(&command.half[0].ids, AUVID_CAN_THRUSTER_COMMAND_A);
    for (uint32_t i = 0; i < frames; ++i) {
        frame.t_us += 10; /* so that no time-out restarts the count */
        random_frame(&rng, &frame);
        good += auvid_can_command_take(&command, &frame) == AUVID_OK;
    }
    /* 99.9 %; the seed is not chosen: 1e9 frames of ten seeds gave 6.656e-4, 665552 good ones. */
    double low = binomial_lower(good, frames, 5e-4), high = binomial_upper(good, frames, 5e-4);
    printf("%u of %u forged commands good: %.3g [%.3g, %.3g] a frame, 1 in %.0f; expected %.3g\n",
           (unsigned)good, (unsigned)frames, (double)good / frames, low, high,
           frames / (double)good, p);
    TEST_ASSERT_TRUE(low < p && p < high);
}

/* Genuine commands of zero in each tick, with 100 forged frames between two of them: more than a
 * bus of 500 kbit/s can carry. Forged counters also make genuine commands jump, so recovery takes a
 * few.
 */
static void test_no_forged_command_acts_for_150_ms_on_a_flooded_bus(void)
{
    auvid_can_command_t command;
    auvid_can_sender_t sender;
    auvid_rng_t rng;
    auvid_can_frame_t frame;
    auvid_can_message_t zero = {.kind = AUVID_CAN_THRUSTER_COMMAND_A};
    auvid_real_t thrust[AUVID_CAN_THRUSTERS];
    uint32_t acted = 0, lasted = 0, longest = 0, silent = 0;
    auvid_rng_seed(&rng, 5);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_init(&command, 4, NULL));
    memset(&frame, 0, sizeof frame);
    for (uint64_t tick = 1; tick <= 20000; ++tick) {
        TEST_ASSERT_TRUE(auvid_can_pack(&sender, &zero, &frame) >= 0);
        frame.t_us = tick * TICK_US;
        (void)auvid_can_command_take(&command, &frame);
        auvid_status_t status = auvid_can_command_thrust(&command, frame.t_us, thrust);
        silent += tick > 2 && status != AUVID_OK;
        bool forged = thrust[0] != 0;
        lasted = forged ? lasted + 1 : 0;
        longest = lasted > longest ? lasted : longest;
        for (int i = 0; i < 100; ++i) {
            random_frame(&rng, &frame);
            acted += auvid_can_command_take(&command, &frame) == AUVID_OK;
        }
    }
    printf("%u forged commands acted; one outlasted at most %u good ones; %u ticks silent\n",
           (unsigned)acted, (unsigned)longest, (unsigned)silent);
    TEST_ASSERT_TRUE(acted > 1000);
    TEST_ASSERT_LESS_OR_EQUAL_UINT32(AUVID_CAN_COMMAND_TIMEOUT_US / TICK_US, longest);
    TEST_ASSERT_EQUAL_UINT32(0, silent);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_forged_commands_are_good_at_the_rate_of_the_rules);
    RUN_TEST(test_no_forged_command_acts_for_150_ms_on_a_flooded_bus);
    return UNITY_END();
}
