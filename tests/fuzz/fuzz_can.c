/*
 * libFuzzer: frames of chance through everything that takes frames from the bus. 11 bytes of input
 * a frame: one selects the identifier, one the time since the last frame, one whether the checksum
 * is put right (a fuzzer cannot guess it), eight are data.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/can_fifo.h"
#include "auvid/can_receiver.h"
#include "auvid_can_private.h"

enum { RECORD = 11, FRAMES = 32, PLACES = 4 };

#define REQUIRE(condition) ((condition) ? (void)0 : fail(#condition, __LINE__))

static void fail(const char *what, int line)
{
    fprintf(stderr, "fuzz_can: line %d: not %s\n", line, what);
    abort();
}

/* A frame that is unpacked must pack to one that unpacks to the same. */
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
}

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

/* Identifiers near both blocks, so that most are ours. */
static uint16_t choose_id(uint8_t byte)
{
    return (uint16_t)(byte < 8 ? 0x3E + byte : 0x3FD + byte % 24);
}

static void put_right(auvid_can_frame_t *frame, auvid_can_kind_t kind)
{
    if (kind != AUVID_CAN_KINDS) {
        frame->data[0] = auvid_can_crc(frame->data, AUVID_CAN_DATA_ID(kind));
    }
}

/* The message's own receiver judges the frame, another one leaves it alone. */
static void check_receivers(auvid_can_receiver_t *receiver, const auvid_can_frame_t *frame,
                            uint64_t now_us)
{
    auvid_can_message_t message;
    auvid_can_kind_t kind = auvid_can_kind(NULL, frame->id);
    for (int i = 0; i < 2; ++i) {
        int at = ((int)kind + i) % AUVID_CAN_KINDS;
        auvid_can_state_t state = auvid_can_receiver_take(&receiver[at], frame, &message);
        REQUIRE((state == AUVID_CAN_FOREIGN) == (at != (int)kind));
        REQUIRE(state == AUVID_CAN_FOREIGN || state == AUVID_CAN_BAD || message.kind == kind);
        auvid_can_receiver_state(&receiver[at], now_us);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

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
        memset(&frame, 0, sizeof frame);
        frame.id = choose_id(data[at]);
        now_us += data[at + 1] * 1000u;
        frame.t_us = now_us;
        frame.length = (data[at + 2] & 0x80u) != 0 ? data[at + 2] & 0x1Fu : AUVID_CAN_BYTES;
        memcpy(frame.data, data + at + 3, 8);
        if ((data[at + 2] & 1u) != 0) {
            put_right(&frame, auvid_can_kind(NULL, frame.id));
        }
        auvid_can_fifo_push(&fifo, &frame);
        if ((data[at + 2] & 2u) != 0) {
            continue; /* it waits in the queue */
        }
        while (auvid_can_fifo_pop(&fifo, &frame) == AUVID_OK) {
            check_round_trip(&frame);
            check_receivers(receiver, &frame, now_us);
            if (auvid_can_command_take(&command, &frame) == AUVID_CAN_GOOD) {
                good_us = frame.t_us;
            }
            check_thrust(&command, now_us, good_us);
        }
    }
    return 0;
}
