/**
 * @file can.h
 * The bus: the codec (messages of can_messages.h to classic CAN frames of 8 bytes and back), the
 * receiver that checks the sequence of messages, and the queue from an interrupt.
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
 * auvid_can_pack. A receiver calls auvid_can_unpack, or auvid_can_receiver_take, which also checks
 * counters and time. From an interrupt call only auvid_can_fifo_push or auvid_can_fifo_pop (one
 * of them, see there), auvid_can_kind and auvid_can_node_kind.
 *
 * Cost on a Cortex-M4F (-Os): packing takes 590 to 1020 instructions, unpacking 650 to 1160. The
 * CRC is nearly half of the smaller figure. Memory: sizeof(auvid_can_sender_t), 40 bytes. Code and
 * tables: 1.6 kB together.
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
/** Unpacks a frame into a message. It checks this frame only: auvid_can_receiver_take checks the
 * sequence of counters. Bits that no signal uses are ignored.
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
 * node does not receive it, or there is no such message. */
auvid_can_node_kind_t auvid_can_node_kind(auvid_can_kind_t kind);

/** Returns the identifier of a message, or 0xFFFF if there is no such message.
 * @param ids NULL: defaults */
uint16_t auvid_can_id(const auvid_can_ids_t *ids, auvid_can_kind_t kind);

/** Returns the CRC of a frame: CRC-8H2F (polynomial 0x2F, initial value 0xFF, inverted at the end)
 * over data[1..7] and the message's data id. */
uint8_t auvid_can_crc(const uint8_t data[AUVID_CAN_BYTES], uint8_t data_id);

/** Returns the full time [us] whose lower 32 bits are wrapped_us, as in a tick frame. Of all such
 * times, none of which is before 0, it is the one nearest to last_us: at most 35 minutes away, but
 * for a last_us below that. */
uint64_t auvid_can_extend_us(uint64_t last_us, uint32_t wrapped_us);

/*
 * The receiver: does a message arrive, intact, in sequence and in time?
 *
 * Use one auvid_can_receiver_t for each message to be supervised. A program that drives thrusters
 * uses one auvid_can_command_t. It answers one question: which thrust is commanded now? The answer
 * is zero unless good commands keep arriving.
 *
 * Counter rules (AUTOSAR E2E profile 2, at most 3 steps). d is the difference to the counter of the
 * last authentic frame, modulo 16:
 *     d = 0      repeated       not good
 *     d = 1..3   good           d - 1 frames were lost
 *     d > 3      counter jump   not good; the next frame is compared with this one
 * A frame is authentic if its length, its checksum and the range of its values are right. The first
 * frame, and the first after a time-out, has no predecessor. It is good, but the first frame of a
 * command only starts the count.
 *
 * A random frame with one of our identifiers passes the checksum with probability 2^-8. It passes
 * the counter as well with 3/16 of that. All thrusts of a command must also be in range. A frame
 * that fails the checksum or the range changes only the counts.
 *
 * Timestamps may be ahead of the clock that a call uses: "now = clock(); drain; thrust(now)" is the
 * usual order. A timestamp ahead by less than the time-out counts as age 0. One further ahead comes
 * from a wrong clock and counts as silence.
 *
 * Cost: that of auvid_can_unpack and 100 instructions. Memory: 64 bytes per receiver; 328 bytes per
 * command in float.
 */
/** The commanded thrust is zero if no good command arrives for this time [us]. */
#define AUVID_CAN_COMMAND_TIMEOUT_US 150000u

/** Maximum step of the counter between two good frames. */
#define AUVID_CAN_LARGEST_STEP 3u

/** Receiver of one message. Only the functions write it. Counts wrap. */
typedef struct {
    auvid_can_ids_t ids;
    uint8_t kind;           /* auvid_can_kind_t */
    bool strict;            /* the first frame only starts the count */
    uint8_t counter;        /* of the last authentic frame */
    bool started;           /* `counter` is valid: the next frame is compared with it */
    bool is_fresh;          /**< a good frame arrived within the time-out, as of the last call */
    int8_t status;          /**< see auvid_can_receiver_status, as of the last call */
    uint32_t timeout_us;    /* 0: none */
    uint64_t seen_us;       /* arrival of the last authentic frame [us] */
    uint64_t good_us;       /**< arrival of the last good frame [us] */
    uint32_t good;          /**< good frames */
    uint32_t lost;          /**< frames missing between good ones */
    uint32_t repeated;      /**< repeated frames */
    uint32_t counter_jumps; /**< frames whose counter jumped */
    uint32_t checksum;      /**< frames with a wrong checksum */
    uint32_t invalid;       /**< frames of another length, or with a value out of range */
    uint32_t timeouts;      /**< time-outs of the message */
    uint32_t ahead;         /**< of a command: refusals of frames with a timestamp too far ahead */
} auvid_can_receiver_t;

#define auvid_can_receiver_init AUVID_SIZED0(auvid_can_receiver_init)
/** Initialises the receiver of one message.
 * @param timeout_us the message times out after this time without a good frame [us]; 0: never (for
 * messages sent on event)
 * @param ids copied; NULL: defaults
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (no such kind; identifiers). */
auvid_status_t auvid_can_receiver_init(auvid_can_receiver_t *receiver, auvid_can_kind_t kind,
                                       uint32_t timeout_us, const auvid_can_ids_t *ids);

#define auvid_can_receiver_take AUVID_SIZED0(auvid_can_receiver_take)
/** Checks a frame and unpacks it. Use the message only if the function returns AUVID_OK. An abort
 * is the exception: obey every authentic one.
 * @param frame with its time of arrival. If its timestamp is earlier than the last one by the
 * time-out or more, it counts as the first frame after a time-out
 * @param message written if the frame is authentic: good, repeated or counter jump
 * @return AUVID_OK (good); AUVID_UNUSED (a frame of another message: no-op); AUVID_ERR_NULL
 * (no-op); AUVID_ERR_REPEATED and AUVID_ERR_COUNTER_JUMP (authentic, not good; the first frame of a
 * command counts as a jump); AUVID_ERR_LENGTH, AUVID_ERR_CHECKSUM, AUVID_ERR_RANGE (not authentic,
 * see auvid_can_unpack). */
auvid_status_t auvid_can_receiver_take(auvid_can_receiver_t *receiver,
                                       const auvid_can_frame_t *frame,
                                       auvid_can_message_t *message);

/** Returns the verdict on the last frame, or that the message has timed out. Each time-out is
 * counted once, by the first call that detects it. It is a time-out, too, if the timestamp of the
 * last good frame is ahead of now_us by the time-out or more.
 * @return AUVID_OK (the last frame was good); AUVID_EMPTY (no frame has arrived yet);
 * AUVID_ERR_STALE (no good frame within the time-out); AUVID_ERR_REPEATED, AUVID_ERR_COUNTER_JUMP,
 * AUVID_ERR_LENGTH, AUVID_ERR_CHECKSUM, AUVID_ERR_RANGE (see auvid_can_receiver_take);
 * AUVID_ERR_NULL. */
auvid_status_t auvid_can_receiver_status(auvid_can_receiver_t *receiver, uint64_t now_us);

/** Receiver of the thruster commands. Only the functions write it. */
typedef struct {
    auvid_can_receiver_t half[2];             /**< thruster_command_a, thruster_command_b */
    auvid_real_t thrust[AUVID_CAN_THRUSTERS]; /* of the last good frames */
    uint8_t halves;                           /* 1 or 2 in use; 0: not initialised */
    /* as they were at the end of the last auvid_can_command_thrust */
    auvid_can_receiver_t half_before[2];
    auvid_real_t thrust_before[AUVID_CAN_THRUSTERS];
} auvid_can_command_t;

#define auvid_can_command_init AUVID_SIZED0(auvid_can_command_init)
/** Initialises the receiver of the thruster commands: the commanded thrust is zero.
 * @param thrusters number of thrusters of this vehicle, 1..AUVID_CAN_THRUSTERS. Up to four need
 * thruster_command_a only; more need thruster_command_b, too
 * @param ids copied; NULL: defaults
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE. */
auvid_status_t auvid_can_command_init(auvid_can_command_t *command, uint8_t thrusters,
                                      const auvid_can_ids_t *ids);

#define auvid_can_command_take AUVID_SIZED0(auvid_can_command_take)
/** Takes a frame with any identifier.
 * @return as auvid_can_receiver_take. AUVID_UNUSED also if the half is not in use, or *command is
 * not initialised. */
auvid_status_t auvid_can_command_take(auvid_can_command_t *command, const auvid_can_frame_t *frame);

#define auvid_can_command_thrust AUVID_SIZED0(auvid_can_command_thrust)
/** Gets the thrust commanded at now_us, for the thruster drivers. It is zero unless each half in
 * use had a good frame within AUVID_CAN_COMMAND_TIMEOUT_US. After a lost frame the halves may come
 * from neighbouring ticks. If a timestamp is ahead of now_us by AUVID_CAN_COMMAND_TIMEOUT_US or
 * more, all frames of that half since the last call are discarded. The last good frame of that call
 * and its counter then remain valid.
 * @param thrust [AUVID_CAN_THRUSTERS], each -1..1; always written; zero if not commanded
 * @return AUVID_OK; AUVID_ERR_STALE (no good command: all zero); AUVID_ERR_STATE (not initialised:
 * all zero); AUVID_ERR_NULL (thrust is zero unless it is itself NULL). */
auvid_status_t auvid_can_command_thrust(auvid_can_command_t *command, uint64_t now_us,
                                        auvid_real_t thrust[AUVID_CAN_THRUSTERS]);

/*
 * A queue of frames with one producer and one consumer: from the receive interrupt to the task.
 *
 * The interrupt pushes and the task pops, or the other way round; each side calls from one context
 * only. There are no locks and
 * no atomic read-modify-write operations: each index has one writer. Neither side ever waits. A
 * frame that finds the queue full is dropped and counted.
 *
 * An abort (right length and checksum) is never dropped and uses no slot. Push stores it apart from
 * the queue, and the next pop returns it before any queued frame. Pop then discards the arm frames
 * that were queued before the abort: an older order must not outlast it. Several aborts may become
 * one.
 *
 * AUVID_CAN_BARRIER() orders the accesses to a frame and to the index that publishes it. It binds
 * the compiler and, between two cores, the memory. With gcc and clang it is a full fence that needs
 * no library (dmb on ARM). For other compilers the user must define it. A compiler barrier suffices
 * if producer and consumer run on one core. An aligned 32-bit load or store must be one access, as
 * it is on every 32-bit target with a CAN controller.
 *
 * Cost: push and pop each copy 24 bytes and take 20 instructions; an abort adds its checksum.
 * Memory: the caller's storage, one frame per slot.
 */
/** Maximum number of frames in a queue. */
#define AUVID_CAN_FIFO_LARGEST 0x8000u

/** The queue. Only the functions write it, except `ids`. All counts wrap. */
typedef struct {
    auvid_can_frame_t *frame;  /* the caller's storage */
    uint32_t size;             /* power of two; 0: not initialised */
    volatile uint32_t pushed;  /* total of frames pushed. Written by the producer */
    volatile uint32_t popped;  /* total of frames popped. Written by the consumer */
    volatile uint32_t dropped; /**< frames that found it full. Written by the producer */
    auvid_can_ids_t ids;      /**< init sets the defaults; change it before the first push or pop */
    auvid_can_frame_t abort;  /* valid while `aborts` and `aborted` differ */
    volatile uint32_t aborts; /* total of aborts stored. Written by the producer */
    volatile uint32_t aborted; /* total of aborts popped. Written by the consumer */
    volatile uint32_t before;  /* `pushed` at the last abort. Written by the producer */
    uint32_t older;            /* queued frames from before the last popped abort. The consumer's */
} auvid_can_fifo_t;

/** Initialises an empty queue. Call it before the first push or pop.
 * @param storage array of `size` frames; it must outlive the queue
 * @param size a power of two, 2..AUVID_CAN_FIFO_LARGEST
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (size). */
auvid_status_t auvid_can_fifo_init(auvid_can_fifo_t *fifo, auvid_can_frame_t *storage,
                                   uint32_t size);

/** Copies *frame to the end of the queue. Only the producer calls it.
 * @return AUVID_OK (always for an abort); AUVID_ERR_FULL (queue full: the frame is dropped and
 * counted); AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_can_fifo_push(auvid_can_fifo_t *fifo, const auvid_can_frame_t *frame);

/** Removes the stored abort, or else the oldest frame. Only the consumer calls it.
 * @param frame the frame removed. It may be overwritten although the queue is AUVID_EMPTY
 * @return AUVID_OK; AUVID_EMPTY; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_can_fifo_pop(auvid_can_fifo_t *fifo, auvid_can_frame_t *frame);

#ifdef __cplusplus
}
#endif

#endif
