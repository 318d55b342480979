/*
 * libFuzzer: a random frame through auvid_can_unpack and back.
 */
#include "fuzz_frames.h"

/* An unpacked frame must pack to a frame that unpacks to the same message. */
static void check_round_trip(const auvid_can_frame_t *frame)
{
    auvid_can_message_t message, again;
    auvid_can_sender_t sender;
    auvid_can_frame_t copy;
    auvid_status_t status = auvid_can_unpack(NULL, frame, &message);
    REQUIRE(status == AUVID_OK || status == AUVID_UNUSED || status == AUVID_ERR_LENGTH ||
            status == AUVID_ERR_CHECKSUM || status == AUVID_ERR_RANGE);
    if (status != AUVID_OK) {
        return;
    }
    REQUIRE(auvid_can_kind(NULL, frame->id) == message.kind);
    auvid_can_sender_init(&sender, NULL);
    sender.counter[message.kind] = message.counter;
    REQUIRE(auvid_can_pack(&sender, &message, &copy) == AUVID_OK);
    REQUIRE(copy.id == frame->id);
    REQUIRE(auvid_can_unpack(NULL, &copy, &again) == AUVID_OK);
    REQUIRE(again.absent == message.absent && again.counter == message.counter);
    REQUIRE(memcmp(&again.as, &message.as, sizeof again.as) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    auvid_can_frame_t frame;
    uint64_t now_us = 0;
    if (size >= RECORD) {
        read_record(data, &frame, &now_us);
        check_round_trip(&frame);
    }
    return 0;
}
