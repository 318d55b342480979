/*
 * libFuzzer: random frames through the queue into the receivers, and the commanded thrust.
 */
#include "auvid/can.h"
#include "fuzz_frames.h"

enum { PLACES = 4 };

static void check_thrust(auvid_can_command_t *command, uint64_t now_us, uint64_t good_us)
{
    auvid_real_t thrust[AUVID_CAN_THRUSTERS];
    auvid_status_t status = auvid_can_command_thrust(command, now_us, thrust);
    REQUIRE(status == AUVID_OK || status == AUVID_ERR_STALE);
    for (int i = 0; i < AUVID_CAN_THRUSTERS; ++i) {
        REQUIRE(thrust[i] >= -1 && thrust[i] <= 1);
        REQUIRE(status == AUVID_OK || thrust[i] == 0);
    }
    REQUIRE(status != AUVID_OK || now_us - good_us <= AUVID_CAN_COMMAND_TIMEOUT_US);
}

/* Only the receiver of the frame's message changes. */
static void check_receivers(auvid_can_receiver_t *receiver, const auvid_can_frame_t *frame,
                            uint64_t now_us)
{
    auvid_can_message_t message;
    auvid_can_kind_t kind = auvid_can_kind(NULL, frame->id);
    for (int i = 0; i < 2; ++i) {
        int at = ((int)kind + i) % AUVID_CAN_KINDS;
        auvid_status_t status = auvid_can_receiver_take(&receiver[at], frame, &message);
        REQUIRE((status == AUVID_UNUSED) == (at != (int)kind));
        REQUIRE(status == AUVID_UNUSED || status == AUVID_ERR_LENGTH ||
                status == AUVID_ERR_CHECKSUM || status == AUVID_ERR_RANGE || message.kind == kind);
        auvid_can_receiver_status(&receiver[at], now_us);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    auvid_can_receiver_t receiver[AUVID_CAN_KINDS];
    auvid_can_command_t command;
    auvid_can_fifo_t fifo;
    auvid_can_frame_t storage[PLACES], frame;
    uint64_t now_us = 0, good_us = 0;
    for (int kind = 0; kind < AUVID_CAN_KINDS; ++kind) {
        auvid_can_receiver_init(&receiver[kind], (auvid_can_kind_t)kind, 300000, NULL);
    }
    auvid_can_command_init(&command, size % 8 + 1, NULL);
    auvid_can_fifo_init(&fifo, storage, PLACES);
    for (size_t at = 0; at + RECORD <= size && at < (size_t)FRAMES * RECORD; at += RECORD) {
        read_record(data + at, &frame, &now_us);
        auvid_can_fifo_push(&fifo, &frame);
        if ((data[at + 2] & 2u) != 0) {
            continue; /* it remains in the queue */
        }
        while (auvid_can_fifo_pop(&fifo, &frame) == AUVID_OK) {
            check_receivers(receiver, &frame, now_us);
            if (auvid_can_command_take(&command, &frame) == AUVID_OK) {
                good_us = frame.t_us;
            }
            check_thrust(&command, now_us, good_us);
        }
    }
    return 0;
}
