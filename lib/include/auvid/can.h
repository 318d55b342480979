/**
 * @file can.h
 * The frames on the bus: messages of can_messages.h to classic CAN frames of 8 bytes and back.
 *
 * The contract is lib/can/auvid.dbc; lib/can/README.md documents it. Every frame is protected as in
 * AUTOSAR E2E profile 2: byte 0 is the CRC-8H2F over bytes 1 to 7 and the message's data id, the
 * low nibble of byte 1 counts 0..15. That finds every one-, two- and three-bit error of a frame.
 * Values are rounded to the nearest step of their signal. What does not fit is saturated and
 * counted: a thruster command of +1.5 leaves as +1. NaN does not leave at all; what is not
 * available is said so in `absent`.
 *
 * Pure functions of bytes: no driver, no clock. Who sends calls auvid_can_pack; who receives calls
 * auvid_can_unpack, or the receiver of can_receiver.h, which looks at counters and time too. From
 * an interrupt call only the queue of can_fifo.h.
 *
 * Cost: a frame packed is 590 to 1020 instructions on a Cortex-M4F (-Os), one unpacked 650 to 1160;
 * nearly half of the smaller is the CRC. Memory: sizeof(auvid_can_sender_t), 36 bytes; code and
 * tables, 1.5 KiB together.
 *
 * Sources: AUTOSAR E2E protocol specification, profile 2; Koopman & Chakravarty 2004 (Hamming
 * distance 4 of the polynomial 0x2F up to 119 bits).
 */
#ifndef AUVID_CAN_H
#define AUVID_CAN_H

#include "auvid/can_messages.h"
#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Data bytes of every frame. */
#define AUVID_CAN_BYTES 8

/** Thrusters that the frames of command and feedback have room for. */
#define AUVID_CAN_THRUSTERS 8

/** A classic frame with an 11-bit identifier. */
typedef struct {
    uint64_t t_us;  /**< when it arrived [us]; not read or written by the codec */
    uint16_t id;    /**< 0..0x7FF */
    uint8_t length; /**< data bytes; ours have AUVID_CAN_BYTES */
    uint8_t data[AUVID_CAN_BYTES];
} auvid_can_frame_t;

/** First identifiers of the two blocks of messages. All nodes of a bus must agree. */
typedef struct {
    uint16_t fast; /**< abort, tick, command, arm; default AUVID_CAN_FAST_BASE */
    uint16_t slow; /**< all others; default AUVID_CAN_SLOW_BASE */
} auvid_can_ids_t;

/** Who sends. One for all messages of a node, so that each has its own counter. */
typedef struct {
    auvid_can_ids_t ids;
    uint8_t counter[AUVID_CAN_KINDS]; /* of the next frame, each message its own */
    uint32_t saturated;               /**< values that did not fit; wraps */
    uint32_t refused;                 /**< messages refused; wraps */
} auvid_can_sender_t;

/** Fill *ids with the identifiers of the DBC. Null is ignored. */
void auvid_can_ids_defaults(auvid_can_ids_t *ids);

/** Do the two blocks fit into 11 bits, apart from each other?
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE. */
auvid_status_t auvid_can_ids_check(const auvid_can_ids_t *ids);

#define auvid_can_sender_init AUVID_SIZED0(auvid_can_sender_init)
/** Start: all counters at 0. @param ids copied; null: defaults.
 * @return AUVID_OK; AUVID_ERR_NULL (sender); AUVID_ERR_RANGE (see auvid_can_ids_check). */
auvid_status_t auvid_can_sender_init(auvid_can_sender_t *sender, const auvid_can_ids_t *ids);

#define auvid_can_pack AUVID_SIZED0(auvid_can_pack)
/** Message to frame. Infinity saturates like any number that is too large.
 * @param sender its counter for this message goes up by one, unless the message is refused
 * @param frame id, length and data are written; nothing when the message is refused
 * @return AUVID_OK; AUVID_SATURATED (packed; at least one value lay half a
 * step or more outside its range); AUVID_ERR_NULL;
 * AUVID_ERR_STATE (not initialised); AUVID_ERR_NOT_FINITE (a value is NaN and not marked absent);
 * AUVID_ERR_RANGE (no such kind). */
auvid_status_t auvid_can_pack(auvid_can_sender_t *sender, const auvid_can_message_t *message,
                              auvid_can_frame_t *frame);

#define auvid_can_unpack AUVID_SIZED0(auvid_can_unpack)
/** Frame to message. Looks at this frame alone: whether its counter follows the last one's is the
 * receiver's matter. Bits that no signal uses are not looked at.
 * @param ids null: defaults. Taken as checked
 * @param message written whole when the frame is good; not touched otherwise
 * @return AUVID_OK; AUVID_UNUSED (the identifier is none of ours); AUVID_ERR_NULL; AUVID_ERR_LENGTH
 * (not 8 bytes); AUVID_ERR_CHECKSUM; AUVID_ERR_RANGE (the checksum is right, but some value is
 * outside the range of its signal). */
auvid_status_t auvid_can_unpack(const auvid_can_ids_t *ids, const auvid_can_frame_t *frame,
                                auvid_can_message_t *message);

/** Which message has this identifier? AUVID_CAN_KINDS: none. @param ids null: defaults. */
auvid_can_kind_t auvid_can_kind(const auvid_can_ids_t *ids, uint16_t id);

/** Identifier of a message; 0xFFFF for no message. @param ids null: defaults. */
uint16_t auvid_can_id(const auvid_can_ids_t *ids, auvid_can_kind_t kind);

/** Time between two frames of a message [us]; 0: it is sent on event, or there is no such one. */
uint32_t auvid_can_cycle_us(auvid_can_kind_t kind);

/** CRC of a frame: CRC-8H2F (polynomial 0x2F, start 0xFF, inverted at the end) over data[1..7] and
 * the message's data id. */
uint8_t auvid_can_crc(const uint8_t data[AUVID_CAN_BYTES], uint8_t data_id);

/** The full time of which a tick frame carries the lower 32 bits [us]: the one nearest to last_us,
 * so at most 35 minutes from it. */
uint64_t auvid_can_extend_us(uint64_t last_us, uint32_t wrapped_us);

#ifdef __cplusplus
}
#endif

#endif
