/**
 * @file can_receiver.h
 * What a receiver knows about a message: does it arrive, whole, in order and in time?
 *
 * One auvid_can_receiver_t for each message that matters, and, in whatever drives thrusters, one
 * auvid_can_command_t, which answers the only question there: what thrust is commanded now? It is
 * zero unless good commands keep arriving.
 *
 * Counter rules (AUTOSAR E2E profile 2, at most 3 steps): with d the difference to the last
 * authentic frame's counter, modulo 16,
 *     d = 0      repeated   not good
 *     d = 1..3   good       d - 1 frames were lost
 *     d > 3      jumped     not good; the count goes on from here
 * The first frame, and the first after a time-out, has nothing to follow: it is good, but for a
 * command it only starts the count.
 *
 * A frame of chance with our identifier passes the checksum with probability 2^-8, and the counter
 * with 3/16 of that; a command must also lie in the range of all its thrusts. A frame that fails
 * the checksum or the range changes nothing but its count.
 *
 * Stamps may be ahead of the clock that is asked: "now = clock(); drain; thrust(now)" is the usual
 * order. One ahead by less than the time-out has age 0; one further ahead comes from a wrong clock
 * and counts as silence.
 *
 * Cost: that of auvid_can_unpack and 100 instructions. Memory: 64 bytes a receiver, 328 bytes a
 * command in float.
 */
#ifndef AUVID_CAN_RECEIVER_H
#define AUVID_CAN_RECEIVER_H

#include "auvid/can.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Silence after which the commanded thrust is zero [us]. */
#define AUVID_CAN_COMMAND_TIMEOUT_US 150000u

/** Largest step of the counter. */
#define AUVID_CAN_LARGEST_STEP 3u

/** State of a message, and what became of a frame. */
typedef enum {
    AUVID_CAN_SILENT = 0,   /**< none has arrived yet */
    AUVID_CAN_GOOD = 1,     /**< the last frame was good */
    AUVID_CAN_REPEATED = 2, /**< authentic, but its counter is the last one's */
    AUVID_CAN_COUNTER_JUMP =
        3,                   /**< authentic, but too many are missing; or the first of a command */
    AUVID_CAN_BAD = 4,       /**< wrong checksum or length, or a value out of range */
    AUVID_CAN_TIMED_OUT = 5, /**< no good frame for the time-out */
    AUVID_CAN_FOREIGN = 6    /**< another message's frame: only as an answer of take */
} auvid_can_state_t;

/** Written by the functions; all but the first line is for reading. Counts wrap. */
typedef struct {
    auvid_can_ids_t ids;
    uint8_t kind;        /* auvid_can_kind_t */
    bool strict;         /* the first frame only starts the count */
    uint8_t counter;     /* of the last authentic frame */
    bool started;        /* there is one to follow */
    bool is_fresh;       /**< a good frame has come within the time-out, as of the last call */
    uint8_t state;       /**< auvid_can_state_t as of the last call */
    uint32_t timeout_us; /* 0: none */
    uint64_t seen_us;    /* arrival of the last authentic frame [us] */
    uint64_t good_us;    /**< arrival of the last good frame [us] */
    uint32_t good;       /**< frames that were good */
    uint32_t lost;       /**< frames missing between good ones */
    uint32_t repeated;   /**< frames repeated */
    uint32_t counter_jumps; /**< frames that did not follow */
    uint32_t checksum;   /**< frames with a wrong checksum */
    uint32_t invalid;    /**< frames of another length, or with a value out of range */
    uint32_t timeouts;   /**< times the message fell silent */
    uint32_t ahead;      /**< of a command: times that frames stamped too far ahead were refused */
} auvid_can_receiver_t;

#define auvid_can_receiver_init AUVID_SIZED0(auvid_can_receiver_init)
/** Start. @param ids copied; null: defaults. @param timeout_us silence after which the message
 * counts as timed out [us]; 0: never (messages sent on event).
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (no such kind; identifiers). */
auvid_status_t auvid_can_receiver_init(auvid_can_receiver_t *receiver, auvid_can_kind_t kind,
                                       uint32_t timeout_us, const auvid_can_ids_t *ids);

#define auvid_can_receiver_take AUVID_SIZED0(auvid_can_receiver_take)
/** Take a frame. Use the message only when the answer is AUVID_CAN_GOOD (an abort: on any
 * authentic frame).
 * @param frame with its time of arrival. A frame stamped by the time-out or more before the last
 * one counts as one after a time-out
 * @param message written when the frame is authentic: good, repeated, jumped
 * @return AUVID_CAN_GOOD, _REPEATED, _JUMPED, _BAD; AUVID_CAN_FOREIGN (another message's, or a null
 * pointer: nothing done). */
auvid_can_state_t auvid_can_receiver_take(auvid_can_receiver_t *receiver,
                                          const auvid_can_frame_t *frame,
                                          auvid_can_message_t *message);

/** What the last frame was, or that it is too long ago. Counts a time-out once, when it is first
 * seen. A last good frame that is stamped by the time-out or more ahead of now_us is one too.
 * @return all but AUVID_CAN_FOREIGN; null: AUVID_CAN_SILENT. */
auvid_can_state_t auvid_can_receiver_state(auvid_can_receiver_t *receiver, uint64_t now_us);

/** The thrust that is commanded. */
typedef struct {
    auvid_can_receiver_t half[2];             /**< thruster_command_a, thruster_command_b */
    auvid_real_t thrust[AUVID_CAN_THRUSTERS]; /* of the last good frames */
    uint8_t halves;                           /* 1, 2; 0: not initialised */
    /* as they were at the end of the last auvid_can_command_thrust */
    auvid_can_receiver_t half_before[2];
    auvid_real_t thrust_before[AUVID_CAN_THRUSTERS];
} auvid_can_command_t;

#define auvid_can_command_init AUVID_SIZED0(auvid_can_command_init)
/** Start: thrust zero. @param thrusters of this vehicle, 1..AUVID_CAN_THRUSTERS. Up to four: only
 * thruster_command_a is needed. More: both are.
 * @param ids copied; null: defaults. @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE. */
auvid_status_t auvid_can_command_init(auvid_can_command_t *command, uint8_t thrusters,
                                      const auvid_can_ids_t *ids);

#define auvid_can_command_take AUVID_SIZED0(auvid_can_command_take)
/** Take a frame, any of the bus. @return as auvid_can_receiver_take. */
auvid_can_state_t auvid_can_command_take(auvid_can_command_t *command,
                                         const auvid_can_frame_t *frame);

#define auvid_can_command_thrust AUVID_SIZED0(auvid_can_command_thrust)
/** Thrust commanded at now_us, for the thruster drivers. All are zero unless each half that this
 * vehicle needs has had a good frame within AUVID_CAN_COMMAND_TIMEOUT_US. The halves may be of
 * neighbouring ticks when a frame is lost. A stamp ahead of now_us by AUVID_CAN_COMMAND_TIMEOUT_US
 * or more refuses the frames since the last call, as if they had not come: the last good frame of
 * that call stays valid, and so does the count.
 * @param thrust [AUVID_CAN_THRUSTERS], each -1..1; always written; what is not commanded is zero
 * @return AUVID_OK; AUVID_ERR_STALE (no good command: all zero); AUVID_ERR_STATE (not initialised:
 * all zero); AUVID_ERR_NULL (thrust is zero unless it is itself null). */
auvid_status_t auvid_can_command_thrust(auvid_can_command_t *command, uint64_t now_us,
                                        auvid_real_t thrust[AUVID_CAN_THRUSTERS]);

#ifdef __cplusplus
}
#endif

#endif
