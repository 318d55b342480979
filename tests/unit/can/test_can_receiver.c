/*
 * Receiver states and the commanded thrust, by the rules in can.h.
 */
#include <string.h>

#include "auvid/can.h"
#include "unity.h"

#define TICK 20000u
#define TIMEOUT AUVID_CAN_COMMAND_TIMEOUT_US

static auvid_can_sender_t sender;
static auvid_can_receiver_t receiver;
static auvid_can_command_t command;
static auvid_can_message_t got;
static uint64_t now;

void setUp(void)
{
    now = 1000000000000ull;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_receiver_init(&receiver, AUVID_CAN_DEPTH, 300000, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_init(&command, 5, NULL));
}

void tearDown(void)
{
}

static auvid_can_frame_t depth_frame(uint8_t counter)
{
    auvid_can_frame_t frame;
    auvid_can_message_t message;
    memset(&message, 0, sizeof message);
    message.kind = AUVID_CAN_DEPTH;
    message.as.depth.depth = 12;
    sender.counter[AUVID_CAN_DEPTH] = counter;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &message, &frame));
    frame.t_us = now;
    return frame;
}

static auvid_status_t depth(uint8_t counter)
{
    now += TICK;
    auvid_can_frame_t frame = depth_frame(counter);
    return auvid_can_receiver_take(&receiver, &frame, &got);
}

static auvid_can_frame_t half_frame(int half, auvid_real_t thrust)
{
    auvid_can_frame_t frame;
    auvid_can_message_t message;
    memset(&message, 0, sizeof message);
    message.kind = half == 0 ? AUVID_CAN_THRUSTER_COMMAND_A : AUVID_CAN_THRUSTER_COMMAND_B;
    for (int i = 0; i < 4; ++i) {
        message.as.thruster_command_a.thrust[i] = thrust; /* both halves have the same layout */
    }
    TEST_ASSERT_TRUE(auvid_can_pack(&sender, &message, &frame) >= 0);
    frame.t_us = now;
    return frame;
}

static void drive(auvid_real_t thrust)
{
    for (int half = 0; half < 2; ++half) {
        auvid_can_frame_t frame = half_frame(half, thrust);
        auvid_can_command_take(&command, &frame);
    }
}

/* All thrusts must have this value; those of an unused half must be zero. */
static auvid_status_t thrust_is(auvid_real_t expected)
{
    auvid_real_t thrust[AUVID_CAN_THRUSTERS];
    memset(thrust, 0x7F, sizeof thrust);
    auvid_status_t status = auvid_can_command_thrust(&command, now, thrust);
    for (int i = 0; i < 4 * command.halves; ++i) {
        TEST_ASSERT_TRUE(thrust[i] == expected);
    }
    for (int i = 4 * command.halves; i < AUVID_CAN_THRUSTERS; ++i) {
        TEST_ASSERT_TRUE(thrust[i] == 0);
    }
    return status;
}

static void start_driving(void)
{
    drive(AUVID_C(0.5));
    now += TICK;
    drive(AUVID_C(0.5));
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.5)));
}

static void test_steps_of_one_to_three_are_good_and_others_are_not(void)
{
    for (int step = 0; step < 16; ++step) {
        setUp();
        TEST_ASSERT_EQUAL(AUVID_OK, depth(9));
        auvid_status_t expected = step == 0  ? AUVID_ERR_REPEATED
                                  : step > 3 ? AUVID_ERR_COUNTER_JUMP
                                             : AUVID_OK;
        TEST_ASSERT_EQUAL(expected, depth((uint8_t)((9 + step) % 16)));
        TEST_ASSERT_EQUAL(expected, auvid_can_receiver_status(&receiver, now));
        TEST_ASSERT_EQUAL_UINT32(expected == AUVID_OK ? step - 1 : 0, receiver.lost);
        TEST_ASSERT_EQUAL_UINT32(expected == AUVID_OK ? 2 : 1, receiver.good);
        TEST_ASSERT_EQUAL_UINT32(step == 0, receiver.repeated);
        TEST_ASSERT_EQUAL_UINT32(step > 3, receiver.counter_jumps);
    }
}

static void test_after_a_jump_the_next_in_sequence_is_good(void)
{
    depth(0);
    TEST_ASSERT_EQUAL(AUVID_ERR_COUNTER_JUMP, depth(8));
    TEST_ASSERT_EQUAL(AUVID_OK, depth(9));
}

static void test_a_bad_checksum_is_counted_and_the_sequence_continues(void)
{
    depth(3);
    auvid_can_frame_t frame = depth_frame(4);
    frame.data[3] ^= 0x10u;
    memset(&got, 0x33, sizeof got);
    auvid_can_message_t before = got;
    TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_can_receiver_take(&receiver, &frame, &got));
    TEST_ASSERT_EQUAL_MEMORY(&before, &got, sizeof got);
    TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_can_receiver_status(&receiver, now));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.checksum);
    TEST_ASSERT_EQUAL(AUVID_OK, depth(5));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.lost);
}

static void test_a_wrong_length_or_range_counts_as_invalid(void)
{
    auvid_can_frame_t frame = depth_frame(0);
    frame.length = 7;
    TEST_ASSERT_EQUAL(AUVID_ERR_LENGTH, auvid_can_receiver_take(&receiver, &frame, &got));
    TEST_ASSERT_EQUAL(AUVID_ERR_LENGTH, auvid_can_receiver_status(&receiver, now));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.invalid);
    TEST_ASSERT_EQUAL_UINT32(0, receiver.checksum);
    TEST_ASSERT_EQUAL_UINT32(0, receiver.good);
}

static void test_a_time_out_is_counted_once(void)
{
    TEST_ASSERT_EQUAL(AUVID_EMPTY, auvid_can_receiver_status(&receiver, now));
    depth(0);
    uint64_t last = now;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_receiver_status(&receiver, last + 300000));
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_can_receiver_status(&receiver, last + 300001));
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_can_receiver_status(&receiver, last + 900000));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.timeouts);
}

static void test_repeated_and_bad_frames_do_not_prevent_a_time_out(void)
{
    depth(0);
    for (int i = 0; i < 20; ++i) {
        depth(0);
    }
    TEST_ASSERT_EQUAL_UINT32(1, receiver.timeouts);
    TEST_ASSERT_EQUAL_UINT32(1, receiver.good);
    TEST_ASSERT_FALSE(receiver.is_fresh);
}

static void test_after_a_time_out_any_counter_is_good(void)
{
    depth(0);
    now += 1000000;
    TEST_ASSERT_EQUAL(AUVID_OK, depth(0));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.timeouts);
    TEST_ASSERT_EQUAL_UINT32(0, receiver.repeated);
}

static void test_without_a_time_out_silence_has_no_effect(void)
{
    auvid_can_receiver_init(&receiver, AUVID_CAN_DEPTH, 0, NULL);
    depth(0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_receiver_status(&receiver, now + 1000000000000ull));
    now += 1000000000000ull;
    TEST_ASSERT_EQUAL(AUVID_ERR_REPEATED, depth(0));
}

static void test_a_timestamp_ahead_is_a_time_out_from_the_time_out_on(void)
{
    depth(0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_receiver_status(&receiver, now - 1));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_receiver_status(&receiver, now - 299999));
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_can_receiver_status(&receiver, now - 300000));
    TEST_ASSERT_EQUAL_UINT32(1, receiver.timeouts);
}

static void test_a_timestamp_slightly_behind_does_not_restart_the_count(void)
{
    depth(0);
    now -= 300000 - 1 + TICK;
    TEST_ASSERT_EQUAL(AUVID_ERR_REPEATED, depth(0)); /* 299999 us old */
    setUp();
    depth(0);
    now -= 300000 + TICK;
    TEST_ASSERT_EQUAL(AUVID_OK, depth(0)); /* a new start */
}

static void test_frames_of_other_messages_change_nothing(void)
{
    depth(0);
    auvid_can_receiver_t before = receiver;
    auvid_can_frame_t frame = half_frame(0, 0);
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_can_receiver_take(&receiver, &frame, &got));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_receiver_take(&receiver, NULL, &got));
    frame = depth_frame(1);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_receiver_take(&receiver, &frame, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_receiver_take(NULL, &frame, &got));
    TEST_ASSERT_EQUAL_MEMORY(&before, &receiver, sizeof receiver);
}

static void test_thrust_is_zero_until_two_commands_in_sequence(void)
{
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
    drive(1);
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
    now += TICK;
    drive(1);
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(1));
}

static void test_thrust_is_zero_150_ms_after_the_last_good_command(void)
{
    start_driving();
    now += TIMEOUT;
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.5)));
    now += 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
}

static void test_thrust_resumes_after_a_time_out_that_was_polled_often(void)
{
    start_driving();
    now += 10 * TIMEOUT;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
    drive(AUVID_C(0.25));
    now += TICK / 2;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
    now += TICK / 2;
    drive(AUVID_C(0.25));
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.25)));
    TEST_ASSERT_EQUAL_UINT32(1, command.half[0].timeouts);
}

static void test_a_first_command_that_is_too_old_does_not_start_the_count(void)
{
    drive(1);
    now += TIMEOUT + 1;
    drive(1);
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
}

static void test_repeated_commands_time_out(void)
{
    start_driving();
    for (int i = 0; i < 8; ++i) {
        now += TICK;
        memset(sender.counter, 1, sizeof sender.counter);
        drive(1);
    }
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
    TEST_ASSERT_EQUAL_UINT32(8, command.half[0].repeated);
}

static void test_a_repeated_command_is_not_obeyed(void)
{
    start_driving();
    memset(sender.counter, 1, sizeof sender.counter);
    drive(1);
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.5)));
}

static void test_up_to_two_lost_commands_do_not_interrupt(void)
{
    start_driving();
    for (int i = 0; i < 50; ++i) {
        now += 3 * TICK;
        for (int lost = 0; lost < 2; ++lost) {
            (void)half_frame(0, 0);
            (void)half_frame(1, 0);
        }
        drive(AUVID_C(-0.5));
        TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(-0.5)));
    }
    TEST_ASSERT_EQUAL_UINT32(100, command.half[1].lost);
}

static void test_all_thrust_is_zero_when_one_half_times_out(void)
{
    for (int half = 0; half < 2; ++half) {
        setUp();
        start_driving();
        for (int i = 0; i < 9; ++i) {
            now += TICK;
            auvid_can_frame_t frame = half_frame(half, 1);
            auvid_can_command_take(&command, &frame);
        }
        TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
    }
}

static void test_four_thrusters_need_the_first_half_only(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_init(&command, 4, NULL));
    start_driving();
    auvid_can_frame_t frame = half_frame(1, 1);
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_can_command_take(&command, &frame));
}

static void test_a_thruster_that_is_not_commanded_has_zero_thrust(void)
{
    start_driving();
    auvid_can_message_t message;
    auvid_can_frame_t frame;
    auvid_real_t thrust[AUVID_CAN_THRUSTERS];
    memset(&message, 0, sizeof message);
    message.kind = AUVID_CAN_THRUSTER_COMMAND_B;
    message.absent = AUVID_CAN_THRUSTER_COMMAND_B_NO_THRUST_6;
    message.as.thruster_command_b.thrust[0] = 1;
    message.as.thruster_command_b.thrust[1] = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &message, &frame));
    frame.t_us = now;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_take(&command, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_thrust(&command, now, thrust));
    TEST_ASSERT_TRUE(thrust[4] == 1);
    TEST_ASSERT_TRUE(thrust[5] == 0);
}

/* The usual order: read the clock, take the frames, get the thrust. */
static void test_frames_that_arrive_after_the_clock_was_read_have_age_0(void)
{
    start_driving();
    for (int i = 0; i < 50; ++i) {
        uint64_t clock = now += TICK;
        now += 3000;
        drive(AUVID_C(0.25));
        now = clock;
        TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.25)));
    }
    TEST_ASSERT_EQUAL_UINT32(52 - 1, command.half[0].good); /* the first starts the count */
    TEST_ASSERT_EQUAL_UINT32(0, command.half[0].timeouts + command.half[0].ahead);
}

/* Commands with timestamps this far ahead of the clock. */
static void drive_ahead(uint64_t by_us, int frames)
{
    now += by_us;
    for (int i = 0; i < frames; ++i) {
        drive(1);
        now += TICK;
    }
    now -= by_us + (uint64_t)frames * TICK;
}

static void test_a_command_ahead_by_less_than_the_time_out_has_age_0(void)
{
    start_driving();
    drive_ahead(TIMEOUT - 1, 1);
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(1));
    now += TIMEOUT - 1 + TIMEOUT;
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(1));
    now += 1;
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
}

static void test_commands_further_ahead_are_refused_and_the_last_good_one_stays(void)
{
    for (int frames = 1; frames <= 5; ++frames) {
        setUp();
        start_driving();
        uint32_t good = command.half[0].good;
        drive_ahead(frames % 2 ? TIMEOUT : 100000000000ull, frames);
        TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.5)));
        TEST_ASSERT_EQUAL_UINT32(good, command.half[0].good);
        TEST_ASSERT_EQUAL_UINT32(1, command.half[0].ahead);
        TEST_ASSERT_EQUAL_UINT32(0, command.half[0].timeouts);
        now += TIMEOUT;
        TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.5)));
        now += 1;
        TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
    }
}

static void test_the_command_after_one_from_the_future_is_good_at_once(void)
{
    start_driving();
    drive_ahead(10 * TIMEOUT, 1);
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.5)));
    now += TICK;
    drive(AUVID_C(0.75));
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.75)));
}

static void test_a_refused_command_from_the_future_keeps_the_last_good_one(void)
{
    start_driving();
    drive_ahead(10 * TIMEOUT, 2);
    now += TICK;
    drive(AUVID_C(0.75)); /* only starts the count again */
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.5)));
    for (int i = 0; i < 3; ++i) {
        now += TICK;
        drive(AUVID_C(0.75));
    }
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.75)));
}

static void test_one_half_from_the_future_is_refused_like_both(void)
{
    start_driving();
    now += 10 * TIMEOUT;
    auvid_can_frame_t frame = half_frame(1, 1);
    now -= 10 * TIMEOUT;
    auvid_can_command_take(&command, &frame);
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.5)));
    TEST_ASSERT_EQUAL_UINT32(0, command.half[0].ahead);
    TEST_ASSERT_EQUAL_UINT32(1, command.half[1].ahead);
}

static void test_commands_only_from_the_future_give_no_thrust(void)
{
    drive_ahead(TIMEOUT, 4);
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
    drive(1);
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0)); /* the first one with a valid timestamp */
    now += TICK;
    drive(1);
    TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(1));
}

static void test_frames_from_the_future_are_counted_once(void)
{
    start_driving();
    now -= 100 * TIMEOUT; /* all earlier frames are now from the future */
    for (int i = 0; i < 5; ++i) {
        TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
        TEST_ASSERT_EQUAL_UINT32(1, command.half[0].ahead);
    }
}

/* Whether the thrust is read at once, or only after frames with the new time. */
static void test_thrust_resumes_after_the_clock_was_set_back(void)
{
    for (int asked = 0; asked < 2; ++asked) {
        int frames = 0;
        setUp();
        start_driving();
        now -= 100 * TIMEOUT;
        if (asked) {
            TEST_ASSERT_EQUAL(AUVID_ERR_STALE, thrust_is(0));
        }
        auvid_real_t thrust[AUVID_CAN_THRUSTERS];
        do {
            now += TICK;
            drive(AUVID_C(0.25));
            ++frames;
        } while (auvid_can_command_thrust(&command, now, thrust) != AUVID_OK && frames < 10);
        TEST_ASSERT_LESS_THAN_INT(4, frames);
        TEST_ASSERT_EQUAL(AUVID_OK, thrust_is(AUVID_C(0.25)));
    }
}

static void test_one_to_eight_thrusters_need_one_half_per_four(void)
{
    for (uint8_t thrusters = 1; thrusters <= AUVID_CAN_THRUSTERS; ++thrusters) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_init(&command, thrusters, NULL));
        auvid_can_frame_t frame = half_frame(1, 1);
        TEST_ASSERT_EQUAL(thrusters <= 4 ? AUVID_UNUSED : AUVID_ERR_COUNTER_JUMP,
                          auvid_can_command_take(&command, &frame));
    }
}

static void test_random_frames_are_good_at_the_expected_rate(void)
{
    /* 2^-8 by the checksum, 3/16 by the counter, (8002/8192)^4 by the range. 2e6 frames: 1332
     * expected; six standard deviations are 219. */
    const double p = 1.0 / 256 * 3 / 16 * 0.9768 * 0.9768 * 0.9768 * 0.9768;
    const uint32_t frames = 2000000;
    uint64_t x = 88172645463325252ull;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_init(&command, 1, NULL));
    auvid_can_frame_t frame = half_frame(0, 0);
    for (uint32_t i = 0; i < frames; ++i) {
        x ^= x << 13;
        x ^= x >> 7;
        x ^= x << 17;
        memcpy(frame.data, &x, 8);
        frame.t_us = now + i * 10ull;
        auvid_can_command_take(&command, &frame);
    }
    TEST_ASSERT_UINT32_WITHIN(219, (uint32_t)(p * frames), command.half[0].good);
}

static void test_wrong_calls_return_their_statuses_and_no_thrust(void)
{
    auvid_real_t thrust[AUVID_CAN_THRUSTERS] = {1, 1, 1, 1, 1, 1, 1, 1};
    const auvid_can_ids_t overlap = {0x40, 0x40};
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_command_init(&command, 0, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_command_init(&command, 9, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_command_init(&command, 1, &overlap));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_command_init(NULL, 1, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_command_thrust(&command, now, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_command_thrust(NULL, now, thrust));
    TEST_ASSERT_TRUE(thrust[7] == 0);
    thrust[7] = 1;
    memset(&command, 0, sizeof command);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_can_command_thrust(&command, now, thrust));
    TEST_ASSERT_TRUE(thrust[7] == 0);
    auvid_can_frame_t frame = half_frame(0, 0);
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_can_command_take(&command, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_command_take(NULL, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_command_take(&command, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_receiver_init(NULL, AUVID_CAN_TICK, 0, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE,
                      auvid_can_receiver_init(&receiver, AUVID_CAN_KINDS, 0, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_receiver_status(NULL, 0));
}

static void test_a_bad_command_is_refused_with_its_cause(void)
{
    auvid_can_frame_t frame = half_frame(0, 0);
    start_driving();
    auvid_can_message_t m = {.kind = AUVID_CAN_THRUSTER_COMMAND_A};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &m, &frame));
    frame.t_us = now;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_command_take(&command, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_REPEATED, auvid_can_command_take(&command, &frame));
    frame.length = 7;
    TEST_ASSERT_EQUAL(AUVID_ERR_LENGTH, auvid_can_command_take(&command, &frame));
    frame.length = AUVID_CAN_BYTES;
    frame.data[7] ^= 1u;
    TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_can_command_take(&command, &frame));
    memset(frame.data + 2, 0xFE, 6); /* thrusts out of range, with a right checksum */
    frame.data[0] = auvid_can_crc(frame.data, AUVID_CAN_THRUSTER_COMMAND_A + 1);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_command_take(&command, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_can_receiver_init(&receiver, AUVID_CAN_THRUSTER_COMMAND_A, 0, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_receiver_take(&receiver, &frame, &got));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_receiver_status(&receiver, now));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_steps_of_one_to_three_are_good_and_others_are_not);
    RUN_TEST(test_after_a_jump_the_next_in_sequence_is_good);
    RUN_TEST(test_a_bad_checksum_is_counted_and_the_sequence_continues);
    RUN_TEST(test_a_wrong_length_or_range_counts_as_invalid);
    RUN_TEST(test_a_time_out_is_counted_once);
    RUN_TEST(test_repeated_and_bad_frames_do_not_prevent_a_time_out);
    RUN_TEST(test_after_a_time_out_any_counter_is_good);
    RUN_TEST(test_without_a_time_out_silence_has_no_effect);
    RUN_TEST(test_a_timestamp_ahead_is_a_time_out_from_the_time_out_on);
    RUN_TEST(test_a_timestamp_slightly_behind_does_not_restart_the_count);
    RUN_TEST(test_frames_of_other_messages_change_nothing);
    RUN_TEST(test_thrust_is_zero_until_two_commands_in_sequence);
    RUN_TEST(test_thrust_is_zero_150_ms_after_the_last_good_command);
    RUN_TEST(test_thrust_resumes_after_a_time_out_that_was_polled_often);
    RUN_TEST(test_a_first_command_that_is_too_old_does_not_start_the_count);
    RUN_TEST(test_repeated_commands_time_out);
    RUN_TEST(test_a_repeated_command_is_not_obeyed);
    RUN_TEST(test_up_to_two_lost_commands_do_not_interrupt);
    RUN_TEST(test_all_thrust_is_zero_when_one_half_times_out);
    RUN_TEST(test_four_thrusters_need_the_first_half_only);
    RUN_TEST(test_a_thruster_that_is_not_commanded_has_zero_thrust);
    RUN_TEST(test_frames_that_arrive_after_the_clock_was_read_have_age_0);
    RUN_TEST(test_a_command_ahead_by_less_than_the_time_out_has_age_0);
    RUN_TEST(test_commands_further_ahead_are_refused_and_the_last_good_one_stays);
    RUN_TEST(test_the_command_after_one_from_the_future_is_good_at_once);
    RUN_TEST(test_a_refused_command_from_the_future_keeps_the_last_good_one);
    RUN_TEST(test_one_half_from_the_future_is_refused_like_both);
    RUN_TEST(test_commands_only_from_the_future_give_no_thrust);
    RUN_TEST(test_frames_from_the_future_are_counted_once);
    RUN_TEST(test_thrust_resumes_after_the_clock_was_set_back);
    RUN_TEST(test_one_to_eight_thrusters_need_one_half_per_four);
    RUN_TEST(test_random_frames_are_good_at_the_expected_rate);
    RUN_TEST(test_wrong_calls_return_their_statuses_and_no_thrust);
    RUN_TEST(test_a_bad_command_is_refused_with_its_cause);
    return UNITY_END();
}
