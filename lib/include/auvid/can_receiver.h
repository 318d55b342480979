/**
 * @file can_receiver.h
 * Checks of the received messages: does a message arrive, intact, in sequence and in time?
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
#ifndef AUVID_CAN_RECEIVER_H
#define AUVID_CAN_RECEIVER_H

#include "auvid/can.h"

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif

#endif
