/**
 * @file can.h
 * The codec: messages of can_messages.h to classic CAN frames of 8 bytes and back.
 *
 * lib/can/auvid.dbc defines the messages; lib/can/README.md documents them. Every frame is
 * protected as in AUTOSAR E2E profile 2: byte 0 is the CRC-8H2F over bytes 1 to 7 and the message's
 * data id. The low nibble of byte 1 is a counter, 0..15. The CRC detects every error of one, two or
 * three bits in a frame.
 *
 * auvid_can_pack rounds each value to the nearest step of its signal. It saturates and counts a
 * value outside the range: a thruster command of +1.5 is sent as +1. It never sends NaN: the caller
 * marks a value that is not available in `absent`.
 *
 * All functions are pure functions of their arguments: no driver, no clock. A sender calls
 * auvid_can_pack. A receiver calls auvid_can_unpack, or the receiver of can_receiver.h, which also
 * checks counters and time. Only the queue of can_fifo.h may be called from an interrupt.
 *
 * Cost on a Cortex-M4F (-Os): packing takes 590 to 1020 instructions, unpacking 650 to 1160. The
 * CRC is nearly half of the smaller figure. Memory: sizeof(auvid_can_sender_t), 40 bytes. Code and
 * tables: 1.5 KiB together.
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

/** Maximum number of thrusters in the command and feedback messages. */
#define AUVID_CAN_THRUSTERS 8

/** A classic frame with an 11-bit identifier. */
typedef struct {
    uint64_t t_us;  /**< time of arrival [us]; the codec neither reads nor writes it */
    uint16_t id;    /**< 0..0x7FF */
    uint8_t length; /**< number of data bytes; AUVID_CAN_BYTES in every frame of auvid */
    uint8_t data[AUVID_CAN_BYTES];
} auvid_can_frame_t;

/** First identifiers of the two blocks of messages. All nodes of a bus must agree. */
typedef struct {
    uint16_t fast; /**< abort, tick, command, arm; default AUVID_CAN_FAST_BASE */
    uint16_t slow; /**< all others; default AUVID_CAN_SLOW_BASE */
} auvid_can_ids_t;

/** State of a sender. A node uses one sender for all its messages; each message has its counter. */
typedef struct {
    auvid_can_ids_t ids;
    uint8_t counter[AUVID_CAN_KINDS]; /* of the next frame of each message */
    uint32_t saturated;               /**< number of saturated values; wraps */
    uint32_t refused;                 /**< number of refused messages; wraps */
} auvid_can_sender_t;

/** Sets *ids to the identifiers of the DBC. NULL is a no-op. */
void auvid_can_ids_defaults(auvid_can_ids_t *ids);

/** Checks that both blocks fit into 11 bits and do not overlap.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE if they do not fit or overlap. */
auvid_status_t auvid_can_ids_check(const auvid_can_ids_t *ids);

#define auvid_can_sender_init AUVID_SIZED0(auvid_can_sender_init)
/** Initialises a sender: all counters are 0.
 * @param ids copied; NULL: defaults
 * @return AUVID_OK; AUVID_ERR_NULL (sender); AUVID_ERR_RANGE (see auvid_can_ids_check). */
auvid_status_t auvid_can_sender_init(auvid_can_sender_t *sender, const auvid_can_ids_t *ids);

#define auvid_can_pack AUVID_SIZED0(auvid_can_pack)
/** Packs a message into a frame. Infinity saturates like any other value that is too large.
 * @param sender its counter for this message increases by one, unless the message is refused
 * @param frame id, length and data are written; unchanged if the message is refused
 * @return AUVID_OK; AUVID_SATURATED (packed, but at least one value was half a step or more outside
 * its range); AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_NOT_FINITE (a value is
 * NaN and not marked absent); AUVID_ERR_RANGE (no such kind). */
auvid_status_t auvid_can_pack(auvid_can_sender_t *sender, const auvid_can_message_t *message,
                              auvid_can_frame_t *frame);

#define auvid_can_unpack AUVID_SIZED0(auvid_can_unpack)
/** Unpacks a frame into a message. It checks this frame only: can_receiver.h checks the sequence of
 * counters. Bits that no signal uses are ignored.
 * @param ids NULL: defaults. Not checked: use auvid_can_ids_check first
 * @param message written completely if the frame is valid; unchanged otherwise
 * @return AUVID_OK; AUVID_UNUSED (no message has this identifier); AUVID_ERR_NULL; AUVID_ERR_LENGTH
 * (not 8 bytes); AUVID_ERR_CHECKSUM; AUVID_ERR_RANGE (the checksum is right, but a value is outside
 * the range of its signal). */
auvid_status_t auvid_can_unpack(const auvid_can_ids_t *ids, const auvid_can_frame_t *frame,
                                auvid_can_message_t *message);

/** Returns the message with this identifier, or AUVID_CAN_KINDS if there is none.
 * @param ids NULL: defaults */
auvid_can_kind_t auvid_can_kind(const auvid_can_ids_t *ids, uint16_t id);

/** Returns the number of a message among those that a node receives, or AUVID_CAN_NODE_KINDS if a
 * node does not receive it, or there is no such message. May be called from an interrupt. */
auvid_can_node_kind_t auvid_can_node_kind(auvid_can_kind_t kind);

/** Returns the identifier of a message, or 0xFFFF if there is no such message.
 * @param ids NULL: defaults */
uint16_t auvid_can_id(const auvid_can_ids_t *ids, auvid_can_kind_t kind);

/** Returns the time between two frames of a message [us]. Returns 0 if the message is sent on event
 * or does not exist. */
uint32_t auvid_can_cycle_us(auvid_can_kind_t kind);

/** Returns the CRC of a frame: CRC-8H2F (polynomial 0x2F, initial value 0xFF, inverted at the end)
 * over data[1..7] and the message's data id. */
uint8_t auvid_can_crc(const uint8_t data[AUVID_CAN_BYTES], uint8_t data_id);

/** Returns the full time [us] whose lower 32 bits are wrapped_us, as in a tick frame. Of all such
 * times it is the one nearest to last_us, at most 35 minutes away. */
uint64_t auvid_can_extend_us(uint64_t last_us, uint32_t wrapped_us);

#ifdef __cplusplus
}
#endif

#endif
