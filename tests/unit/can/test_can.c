/*
 * The codec through its header. tests/can compares it with cantools and an independent CRC.
 */
#include <math.h>
#include <string.h>

#include "auvid/can.h"
#include "unity.h"

static auvid_can_sender_t sender;
static auvid_can_message_t message, back;
static auvid_can_frame_t frame;

void setUp(void)
{
    memset(&message, 0, sizeof message);
    memset(&frame, 0, sizeof frame);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
}

void tearDown(void)
{
}

/* A frame of each kind, with zeros where they are valid. */
static void pack_plain(auvid_can_kind_t kind)
{
    memset(&message, 0, sizeof message);
    message.kind = kind;
    if (kind == AUVID_CAN_ARM) {
        message.as.arm.key = AUVID_CAN_ARM_KEY;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &message, &frame));
}

static auvid_status_t unpack(void)
{
    return auvid_can_unpack(NULL, &frame, &back);
}

static void seal(uint8_t data_id)
{
    frame.data[0] = auvid_can_crc(frame.data, data_id);
}

/* Packs and unpacks one command. @return thrust[1] as unpacked */
static auvid_real_t thrust_there_and_back(auvid_real_t asked, auvid_status_t expected)
{
    memset(&message, 0, sizeof message);
    message.kind = AUVID_CAN_THRUSTER_COMMAND_A;
    message.as.thruster_command_a.thrust[1] = asked;
    TEST_ASSERT_EQUAL(expected, auvid_can_pack(&sender, &message, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    TEST_ASSERT_EQUAL(AUVID_CAN_THRUSTER_COMMAND_A, back.kind);
    TEST_ASSERT_TRUE(back.as.thruster_command_a.thrust[0] == 0);
    TEST_ASSERT_TRUE(back.as.thruster_command_a.thrust[2] == 0);
    return back.as.thruster_command_a.thrust[1];
}

static void test_a_command_of_one_and_a_half_is_sent_as_one(void)
{
    TEST_ASSERT_TRUE(thrust_there_and_back(AUVID_C(1.5), AUVID_SATURATED) == 1);
    TEST_ASSERT_EQUAL_UINT32(1, sender.saturated);
}

static void test_a_command_of_minus_two_is_sent_as_minus_one(void)
{
    TEST_ASSERT_TRUE(thrust_there_and_back(-2, AUVID_SATURATED) == -1);
}

static void test_infinity_and_the_largest_numbers_are_saturated(void)
{
    const auvid_real_t large[] = {(auvid_real_t)INFINITY, AUVID_LARGEST,         AUVID_C(1e30),
                                  AUVID_C(2147483648.0),  AUVID_C(4294967296.0), AUVID_C(1.00013)};
    for (size_t i = 0; i < sizeof large / sizeof large[0]; ++i) {
        TEST_ASSERT_TRUE(thrust_there_and_back(large[i], AUVID_SATURATED) == 1);
        TEST_ASSERT_TRUE(thrust_there_and_back(-large[i], AUVID_SATURATED) == -1);
    }
}

static void test_a_command_of_one_is_not_saturated(void)
{
    TEST_ASSERT_TRUE(thrust_there_and_back(1, AUVID_OK) == 1);
    TEST_ASSERT_TRUE(thrust_there_and_back(-1, AUVID_OK) == -1);
    TEST_ASSERT_EQUAL_UINT32(0, sender.saturated);
}

static void test_no_message_is_sent_out_of_range(void)
{
    /* Every real of every message is far beyond its range: the packed value is in range and
     * available. The comparison with cantools checks that it is at the right end. */
    for (int kind = 0; kind < AUVID_CAN_KINDS; ++kind) {
        for (int side = -1; side <= 1; side += 2) {
            auvid_real_t huge = (auvid_real_t)side * AUVID_C(3e38);
            memset(&message, 0, sizeof message);
            message.kind = (auvid_can_kind_t)kind;
            for (size_t i = 0; i + sizeof huge <= sizeof message.as; i += sizeof huge) {
                memcpy((char *)&message.as + i, &huge, sizeof huge);
            }
            TEST_ASSERT_TRUE(auvid_can_pack(&sender, &message, &frame) >= 0);
            TEST_ASSERT_EQUAL(AUVID_OK, unpack());
            TEST_ASSERT_EQUAL(0, back.absent);
        }
    }
}

static void test_nan_is_not_sent(void)
{
    auvid_can_frame_t before;
    memset(&frame, 0x5A, sizeof frame);
    before = frame;
    message.kind = AUVID_CAN_THRUSTER_COMMAND_A;
    message.as.thruster_command_a.thrust[3] = (auvid_real_t)NAN;
    message.as.thruster_command_a.thrust[0] = 7;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_can_pack(&sender, &message, &frame));
    message.kind = AUVID_CAN_ESTIMATE;
    message.as.estimate.value = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, auvid_can_pack(&sender, &message, &frame));
    TEST_ASSERT_EQUAL_MEMORY(&before, &frame, sizeof frame);
    TEST_ASSERT_EQUAL_UINT32(2, sender.refused);
    TEST_ASSERT_EQUAL_UINT32(0, sender.saturated);
    TEST_ASSERT_EQUAL_UINT8(0, sender.counter[AUVID_CAN_THRUSTER_COMMAND_A]);
}

static void test_an_absent_value_arrives_as_absent_and_nan(void)
{
    message.kind = AUVID_CAN_DVL_BOTTOM;
    message.absent = AUVID_CAN_DVL_BOTTOM_NO_V;
    message.as.dvl_bottom.u = AUVID_C(0.25);
    message.as.dvl_bottom.v = (auvid_real_t)NAN; /* not read */
    message.as.dvl_bottom.w = AUVID_C(-0.5);
    message.as.dvl_bottom.age = AUVID_CAN_AGE_UNKNOWN;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &message, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    TEST_ASSERT_EQUAL_UINT32(AUVID_CAN_DVL_BOTTOM_NO_V, back.absent);
    TEST_ASSERT_TRUE(isnan(back.as.dvl_bottom.v));
    TEST_ASSERT_TRUE(back.as.dvl_bottom.u == AUVID_C(0.25));
    TEST_ASSERT_TRUE(back.as.dvl_bottom.w == AUVID_C(-0.5));
    TEST_ASSERT_EQUAL_UINT32(AUVID_CAN_AGE_UNKNOWN, back.as.dvl_bottom.age);
}

static void test_an_absent_float_arrives_as_absent(void)
{
    message.kind = AUVID_CAN_ESTIMATE_SIGMA;
    message.absent = AUVID_CAN_ESTIMATE_SIGMA_NO_SIGMA;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &message, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    TEST_ASSERT_EQUAL_UINT32(AUVID_CAN_ESTIMATE_SIGMA_NO_SIGMA, back.absent);
    TEST_ASSERT_TRUE(isnan(back.as.estimate_sigma.sigma));
}

static void test_a_float_arrives_bit_for_bit(void)
{
    message.kind = AUVID_CAN_ESTIMATE;
    message.as.estimate.index = 16;
    message.as.estimate.number = 127;
    message.as.estimate.value = (auvid_real_t)-249.5384f;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &message, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    TEST_ASSERT_EQUAL_UINT32(16, back.as.estimate.index);
    TEST_ASSERT_EQUAL_UINT32(127, back.as.estimate.number);
    TEST_ASSERT_TRUE(back.as.estimate.value == (auvid_real_t)-249.5384f);
}

static void test_integers_saturate_too(void)
{
    message.kind = AUVID_CAN_IMU_RATES;
    message.as.imu_rates.age = 5000;
    TEST_ASSERT_EQUAL(AUVID_SATURATED, auvid_can_pack(&sender, &message, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    TEST_ASSERT_EQUAL_UINT32(AUVID_CAN_AGE_UNKNOWN, back.as.imu_rates.age);
}

static void test_the_tick_carries_all_bits(void)
{
    message.kind = AUVID_CAN_TICK;
    message.as.tick.sequence = 0xFEDCBu;
    message.as.tick.time = 0x89ABCDEFu;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &message, &frame));
    TEST_ASSERT_EQUAL_HEX8(0xB0, frame.data[1]);
    TEST_ASSERT_EQUAL_HEX8(0xEF, frame.data[4]);
    TEST_ASSERT_EQUAL_HEX8(0x89, frame.data[7]);
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    TEST_ASSERT_EQUAL_HEX32(0xFEDCBu, back.as.tick.sequence);
    TEST_ASSERT_EQUAL_HEX32(0x89ABCDEFu, back.as.tick.time);
}

static void test_an_arm_frame_needs_the_key(void)
{
    message.kind = AUVID_CAN_ARM;
    message.as.arm.action = AUVID_CAN_ACTION_ARM;
    message.as.arm.key = AUVID_CAN_ARM_KEY;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &message, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    frame.data[2] ^= 1u;
    seal(AUVID_CAN_ARM + 1);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, unpack());
}

static void test_each_message_unpacks_and_packs_to_the_same_frame(void)
{
    for (int kind = 0; kind < AUVID_CAN_KINDS; ++kind) {
        pack_plain((auvid_can_kind_t)kind);
        auvid_can_frame_t first = frame;
        TEST_ASSERT_EQUAL_UINT16(auvid_can_id(NULL, (auvid_can_kind_t)kind), frame.id);
        TEST_ASSERT_EQUAL(AUVID_OK, unpack());
        TEST_ASSERT_EQUAL(kind, back.kind);
        TEST_ASSERT_EQUAL_UINT8(0, back.counter);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &back, &frame));
        TEST_ASSERT_EQUAL_MEMORY(&first, &frame, sizeof frame);
    }
}

static void test_each_message_has_its_own_counter_modulo_16(void)
{
    for (int i = 0; i < 40; ++i) {
        pack_plain(AUVID_CAN_DEPTH);
        TEST_ASSERT_EQUAL(AUVID_OK, unpack());
        TEST_ASSERT_EQUAL_UINT8(i % 16, back.counter);
    }
    pack_plain(AUVID_CAN_GPS);
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    TEST_ASSERT_EQUAL_UINT8(0, back.counter);
}

/* Bits in the order of sending: 0..63 data, 64..67 length code. */
static void flip(int bit)
{
    frame.data[bit / 8] ^= (uint8_t)(1u << bit % 8);
}

static void test_every_error_of_one_or_two_bits_is_detected_in_each_message(void)
{
    int found = 0;
    for (int kind = 0; kind < AUVID_CAN_KINDS; ++kind) {
        for (int content = 0; content < 2; ++content) {
            pack_plain((auvid_can_kind_t)kind); /* a frame of zeros, and one with many ones */
            for (int i = 2; content != 0 && i < 8; ++i) {
                frame.data[i] = (uint8_t)(0xFF - 37 * i);
            }
            seal((uint8_t)(kind + 1));
            for (int a = 0; a < 64; ++a) {
                for (int b = a; b < 64; ++b) {
                    flip(a);
                    if (b != a) {
                        flip(b);
                    }
                    found += unpack() == AUVID_ERR_CHECKSUM;
                    flip(a);
                    if (b != a) {
                        flip(b);
                    }
                }
            }
        }
    }
    TEST_ASSERT_EQUAL(AUVID_CAN_KINDS * 2 * (64 + 64 * 63 / 2), found);
}

static void test_every_error_of_three_bits_is_detected(void)
{
    int missed = 0;
    pack_plain(AUVID_CAN_THRUSTER_COMMAND_A);
    for (int a = 0; a < 64; ++a) {
        for (int b = a + 1; b < 64; ++b) {
            for (int c = b + 1; c < 64; ++c) {
                flip(a);
                flip(b);
                flip(c);
                missed += unpack() != AUVID_ERR_CHECKSUM;
                flip(a);
                flip(b);
                flip(c);
            }
        }
    }
    TEST_ASSERT_EQUAL(0, missed);
}

static void test_a_frame_under_another_message_s_identifier_is_detected(void)
{
    for (int kind = 0; kind < AUVID_CAN_KINDS; ++kind) {
        for (int other = 0; other < AUVID_CAN_KINDS; ++other) {
            pack_plain((auvid_can_kind_t)kind);
            frame.id = auvid_can_id(NULL, (auvid_can_kind_t)other);
            TEST_ASSERT_EQUAL(other == kind ? AUVID_OK : AUVID_ERR_CHECKSUM, unpack());
        }
    }
}

static void test_the_checksum_is_crc_8h2f(void)
{
    /* The catalogue's check value is over "123456789"; here the first 8 of these 9 bytes are
     * data[1..7] and the data id, and the ninth is put in by hand: the CRC over nine bytes is not
     * reachable. So: over eight, by the definition, a bit at a time. */
    const uint8_t data[8] = {0, '1', '2', '3', '4', '5', '6', '7'};
    unsigned crc = 0xFF;
    for (int i = 1; i <= 8; ++i) {
        crc ^= i < 8 ? data[i] : (unsigned)'8';
        for (int bit = 0; bit < 8; ++bit) {
            crc = (crc & 0x80u) != 0 ? (crc << 1 ^ 0x2Fu) & 0xFFu : crc << 1;
        }
    }
    TEST_ASSERT_EQUAL_HEX8(crc ^ 0xFFu, auvid_can_crc(data, '8'));
}

static void test_a_wrong_length_and_a_foreign_identifier_have_their_statuses(void)
{
    pack_plain(AUVID_CAN_GPS);
    memset(&back, 0x77, sizeof back);
    auvid_can_message_t before = back;
    for (int length = 0; length < 256; ++length) {
        frame.length = (uint8_t)length;
        TEST_ASSERT_EQUAL(length == 8 ? AUVID_OK : AUVID_ERR_LENGTH,
                          length == 8 ? AUVID_OK : unpack());
    }
    frame.length = 8;
    frame.id = 0x123;
    TEST_ASSERT_EQUAL(AUVID_UNUSED, unpack());
    frame.id = 0xFFFF;
    TEST_ASSERT_EQUAL(AUVID_UNUSED, unpack());
    TEST_ASSERT_EQUAL_MEMORY(&before, &back, sizeof back);
}

static void test_a_value_out_of_range_is_refused_despite_a_right_checksum(void)
{
    pack_plain(AUVID_CAN_THRUSTER_COMMAND_A);
    /* thrust 1: bits 12..24, 4001 = 0xFA1 */
    frame.data[1] = (uint8_t)((frame.data[1] & 0x0Fu) | 0x10u);
    frame.data[2] = 0xFA;
    seal(AUVID_CAN_THRUSTER_COMMAND_A + 1);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, unpack());
    frame.data[1] = (uint8_t)(frame.data[1] & 0x0Fu); /* 4000 */
    seal(AUVID_CAN_THRUSTER_COMMAND_A + 1);
    TEST_ASSERT_EQUAL(AUVID_OK, unpack());
    TEST_ASSERT_TRUE(back.as.thruster_command_a.thrust[0] == 1);
}

static void test_a_float_that_is_not_finite_is_refused(void)
{
    const uint32_t bad[] = {0x7F800000u, 0xFF800000u, 0x7FC00001u,
                            0xFFC00000u, 0x7F800001u, 0x7F7FFFFFu};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        pack_plain(AUVID_CAN_ESTIMATE);
        for (int j = 0; j < 4; ++j) {
            frame.data[4 + j] = (uint8_t)(bad[i] >> 8 * j);
        }
        seal(AUVID_CAN_ESTIMATE + 1);
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, unpack());
    }
}

static void test_both_blocks_can_be_moved(void)
{
    const auvid_can_ids_t ids = {0x100, 0x800 - AUVID_CAN_SLOW_KINDS};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, &ids));
    pack_plain(AUVID_CAN_TICK);
    TEST_ASSERT_EQUAL_HEX16(0x101, frame.id);
    TEST_ASSERT_EQUAL(AUVID_UNUSED, unpack());
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(&ids, &frame, &back));
    pack_plain(AUVID_CAN_KINDS - 1);
    TEST_ASSERT_EQUAL_HEX16(0x7FF, frame.id);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(&ids, &frame, &back));
    TEST_ASSERT_EQUAL(AUVID_CAN_KINDS - 1, back.kind);
}

static void test_blocks_that_overlap_or_do_not_fit_are_refused(void)
{
    enum { FAST = AUVID_CAN_FAST_KINDS, SLOW = AUVID_CAN_SLOW_KINDS };
    const auvid_can_ids_t bad[] = {{0, 0},
                                   {0x40, 0x40 + FAST - 1},
                                   {0x40 + SLOW - 1, 0x40},
                                   {0x801 - FAST, 0},
                                   {0, 0x801 - SLOW}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_sender_init(&sender, &bad[i]));
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_ids_check(&bad[i]));
    }
    const auvid_can_ids_t good = {0x40 + SLOW, 0x40};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_ids_check(&good));
}

static void test_every_identifier_maps_to_its_message_and_back(void)
{
    int known = 0;
    for (int id = 0; id < 0x10000; ++id) {
        auvid_can_kind_t kind = auvid_can_kind(NULL, (uint16_t)id);
        known += kind != AUVID_CAN_KINDS;
        TEST_ASSERT_TRUE(kind == AUVID_CAN_KINDS || auvid_can_id(NULL, kind) == id);
    }
    TEST_ASSERT_EQUAL(AUVID_CAN_KINDS, known);
    TEST_ASSERT_EQUAL_HEX16(0xFFFF, auvid_can_id(NULL, AUVID_CAN_KINDS));
}

static void test_wrong_calls_return_their_statuses(void)
{
    message.kind = AUVID_CAN_KINDS;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_can_pack(&sender, &message, &frame));
    message.kind = AUVID_CAN_TICK;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_pack(NULL, &message, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_pack(&sender, NULL, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_pack(&sender, &message, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_unpack(NULL, NULL, &back));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_unpack(NULL, &frame, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_sender_init(NULL, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_can_ids_check(NULL));
    auvid_can_ids_defaults(NULL);
    memset(&sender, 0, sizeof sender);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_can_pack(&sender, &message, &frame));
}

static void test_a_wrapped_time_is_extended_forwards_and_backwards(void)
{
    const uint64_t t = 0x500000000ull;
    TEST_ASSERT_EQUAL_UINT64(t + 20000, auvid_can_extend_us(t, 20000));
    TEST_ASSERT_EQUAL_UINT64(t - 20000, auvid_can_extend_us(t, (uint32_t)-20000));
    TEST_ASSERT_EQUAL_UINT64(t + 20000, auvid_can_extend_us(t - 1, 20000));
    TEST_ASSERT_EQUAL_UINT64(t, auvid_can_extend_us(t, 0));
}

static void test_a_wrapped_time_is_not_extended_to_before_zero(void)
{
    TEST_ASSERT_EQUAL_UINT64(2400000000u, auvid_can_extend_us(60000000u, 2400000000u));
    TEST_ASSERT_EQUAL_UINT64(0, auvid_can_extend_us(60000000u, 0));
    TEST_ASSERT_EQUAL_UINT64(UINT32_MAX, auvid_can_extend_us(0, UINT32_MAX));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_command_of_one_and_a_half_is_sent_as_one);
    RUN_TEST(test_a_command_of_minus_two_is_sent_as_minus_one);
    RUN_TEST(test_infinity_and_the_largest_numbers_are_saturated);
    RUN_TEST(test_a_command_of_one_is_not_saturated);
    RUN_TEST(test_no_message_is_sent_out_of_range);
    RUN_TEST(test_nan_is_not_sent);
    RUN_TEST(test_an_absent_value_arrives_as_absent_and_nan);
    RUN_TEST(test_an_absent_float_arrives_as_absent);
    RUN_TEST(test_a_float_arrives_bit_for_bit);
    RUN_TEST(test_integers_saturate_too);
    RUN_TEST(test_the_tick_carries_all_bits);
    RUN_TEST(test_an_arm_frame_needs_the_key);
    RUN_TEST(test_each_message_unpacks_and_packs_to_the_same_frame);
    RUN_TEST(test_each_message_has_its_own_counter_modulo_16);
    RUN_TEST(test_every_error_of_one_or_two_bits_is_detected_in_each_message);
    RUN_TEST(test_every_error_of_three_bits_is_detected);
    RUN_TEST(test_a_frame_under_another_message_s_identifier_is_detected);
    RUN_TEST(test_the_checksum_is_crc_8h2f);
    RUN_TEST(test_a_wrong_length_and_a_foreign_identifier_have_their_statuses);
    RUN_TEST(test_a_value_out_of_range_is_refused_despite_a_right_checksum);
    RUN_TEST(test_a_float_that_is_not_finite_is_refused);
    RUN_TEST(test_both_blocks_can_be_moved);
    RUN_TEST(test_blocks_that_overlap_or_do_not_fit_are_refused);
    RUN_TEST(test_every_identifier_maps_to_its_message_and_back);
    RUN_TEST(test_wrong_calls_return_their_statuses);
    RUN_TEST(test_a_wrapped_time_is_extended_forwards_and_backwards);
    RUN_TEST(test_a_wrapped_time_is_not_extended_to_before_zero);
    return UNITY_END();
}
