/**
 * @file node.h
 * The node: the identifier on the CAN bus. Frames in, frames out; no driver, no clock.
 *
 *     auvid_node_take     for every received frame, in order of arrival
 *     auvid_node_step     when take returns AUVID_TICK, or at the node's own ticks
 *     auvid_node_work     in the time that is left: the search for parameters
 *     auvid_node_report   navigation, estimates, wrong inputs, progress, health, heartbeat
 *
 * By default the node is passive: it listens, identifies and reports. It never sends a thruster
 * command. After auvid_node_attach_actuation it obeys arm frames: it arms the guard and excites. It
 * then sends a command in every tick, starting with the tick of the arm frame, and none when it
 * does not excite. An abort frame or a trip of the guard ends this with one command of zero in the
 * same tick. If the node itself fails, the time-out of the receivers ends it. A vehicle with up to
 * four thrusters has thruster_command_a only.
 *
 * The node obeys every authentic frame that takes thrust away: abort, disarm and stop. Authentic
 * means that length, checksum and ranges are right; the counter does not matter. So the node obeys
 * the first frame of a restarted console, which counts from 0 again. Only a disarm with a good
 * counter (can.h) clears an abort. A disarm that is repeated or jumped aborts the
 * excitation and leaves the guard ABORTED. Abort, disarm and stop all cancel a pending arm frame.
 *
 * Two nodes must not command the same thrusters. An armed or exciting node compares each authentic
 * command frame with its own last four frames of that half. It aborts with the cause
 * AUVID_GUARD_FOREIGN_COMMAND if the frame differs from all four in any byte. Those four may come
 * back late, merged or twice, from a driver that echoes what was sent.
 *
 * The node does not detect another node that sends identical bytes (same configuration, seed and
 * start), or sends them up to three ticks later. The later node does detect the earlier one, and
 * its command of zero is foreign to the earlier one. While the bytes are identical, receivers obey
 * one of the two: the other's counters are repeated or jumped.
 *
 * Time is the time of the tick. A sample received since the previous tick counts as sent at this
 * tick; its age is subtracted. So a log of the frames replays bit for bit, at any speed. A sender
 * that knows the tick sends its samples' age at the tick. The samples of other senders are up to a
 * tick late.
 *
 * A tick numbered up to 15 behind the last one is a copy or a late frame, and is refused. A tick
 * further behind comes from a restarted clock. A clock that was set, stands still, or advances by
 * more than a second is taken to advance by one second. The record then has a gap, and time never
 * goes back.
 *
 * The attitude and the rates of the IMU form one sample if they are at most 30 ms apart. Its time
 * is that of the later one. If they are further apart, the earlier one is dropped and the later one
 * waits for its other half. A frame with a missing axis or age is ignored.
 *
 * Thrust feedback applies to the time between the previous tick and this one. It must be the thrust
 * of all sources. Without it nothing can be identified: the thrusters may not have obeyed the
 * commands. It is recorded in the tick in which the frames of all thrusters in use have arrived. A
 * frame without the thrust of one in use ("not available") is dropped and counted, as is a frame
 * that is followed by the next one before the other half has arrived. A thruster that stands still
 * has a thrust of 0.
 *
 * The bus carries thrusts, not wrenches, so every node has an allocation (allocation.h). A passive
 * node only computes the wrench of the feedback with it.
 *
 * Cost: take is one auvid_can_unpack; step and work as in identifier.h; report packs at most
 * AUVID_NODE_FRAMES frames. Memory: sizeof(auvid_node_t): the identifier and 1.4 KiB.
 */
#ifndef AUVID_NODE_H
#define AUVID_NODE_H

#include "auvid/actuation.h"
#include "auvid/can.h"
#include "auvid/identifier.h"
#include "auvid/uncertain.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Maximum number of frames from one call of report. */
#define AUVID_NODE_FRAMES 4
/** Maximum number of frames from one call of step or halt. */
#define AUVID_NODE_COMMANDS 3

/** Configuration, written by the user. auvid_node_init copies it. */
typedef struct {
    bool answer;         /**< send tick_done after the work of each tick, so that a peer that waits
                              for it runs in lock step, faster than real time; default false */
    auvid_can_ids_t ids; /**< see can.h */
} auvid_node_config_t;

/** Counters; all wrap. */
typedef struct {
    uint32_t ticks;           /**< tick frames accepted, or own ticks */
    uint32_t ticks_missed;    /**< ticks missing from the sequence */
    uint32_t clock_steps;     /**< times the clock of the tick went back, stood still, or advanced
                                   by more than 1 s */
    uint32_t frames;          /**< accepted frames */
    uint32_t refused;         /**< refused frames: bad checksum, length, range or counter, or a tick
                                   older than one already accepted */
    uint32_t samples_dropped; /**< samples that navigation or the recorder refused, or of a refused
                                   tick */
    uint32_t unknown_age;     /**< samples without an age; they are not used */
    uint32_t foreign_commands; /**< command frames of another node, counted in every guard state */
} auvid_node_counters_t;

/** The halves of the IMU's sample. Private. */
typedef struct {
    uint64_t attitude_us, rates_us; /* age until the next step */
    bool attitude, rates;           /* this half has arrived since the last sample */
    bool new_attitude, new_rates;   /* this half arrived since the last step: its time is an age */
} auvid_node_imu_t;

/** What a node has received of one message. The counts wrap. */
typedef struct {
    uint32_t good;    /**< accepted frames */
    uint32_t lost;    /**< frames missing between them */
    uint32_t refused; /**< see auvid_node_counters_t */
    uint8_t counter;  /* of the last authentic frame */
    bool started;     /* `counter` is valid */
    uint8_t reserved[2];
} auvid_node_received_t;

/** What to report next. Private. */
typedef struct {
    uint8_t parameter, point, cause; /* point of the drag force; class of causes, by its share */
} auvid_node_next_t;

/** The node. Read it freely; only the functions write it. */
typedef struct auvid_node {
    auvid_node_config_t cfg;
    auvid_allocation_t allocation;
    auvid_status_t (*arm)(auvid_identifier_t *id); /* NULL: passive. A pointer, so that unused code
                                                      is not linked */
    void (*report_causes)(struct auvid_node *node, auvid_can_frame_t *frame,
                          int *count); /* NULL: no uncertain inputs */
    auvid_node_counters_t counters;
    auvid_can_sender_t sender;
    auvid_node_received_t received[AUVID_CAN_NODE_KINDS]; /**< by auvid_can_node_kind_t */
    auvid_input_t in; /* samples since the last tick; a t_us holds the age until the next step */
    auvid_node_imu_t imu;
    auvid_real_t thrust[AUVID_CAN_THRUSTERS]; /* of the last feedback */
    uint64_t t_us;                            /**< time of the last tick */
    uint64_t first_us;                        /**< and of the first one */
    uint64_t tick_us;    /* time of the current tick: bus time less the clock steps */
    uint64_t bus_us;     /* bus time of the last tick */
    uint64_t sent[2][4]; /* data of the last four commands of each half, by counter */
    uint32_t sequence;   /* of the last tick frame */
    uint32_t reports;    /* calls of report */
    uint32_t events;     /**< AUVID_EVENT_... of the last step */
    uint32_t load;       /* maximum since the last health frame */
    auvid_node_next_t next;
    bool started;          /* a tick was received or opened */
    uint8_t feedback;      /* halves of the thrust feedback that wait to be recorded: A 1, B 2 */
    bool arming;           /* an arm frame is pending: the next step arms */
    bool commanding;       /* the last step commanded thrust */
    bool ready;            /* initialised */
    auvid_identifier_t id; /* last: the rest is reached by short instructions */
} auvid_node_t;

/** Sets the defaults: passive, default identifiers. NULL is a no-op. */
void auvid_node_defaults(auvid_node_config_t *cfg);

#define auvid_node_init AUVID_SIZED(auvid_node_init)
/** Initialises the node, which is passive.
 * After an error every other function returns AUVID_ERR_STATE.
 * @param allocation of the thrusters on the bus; copied
 * @param identifier configuration of the identifier. It may be node->id.cfg, which saves memory;
 * its contents are undefined afterwards
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (identifiers overlap, or exceed 11 bits;
 * velocity source); AUVID_ERR_SIZE (no thrusters, or more than AUVID_CAN_THRUSTERS); the errors of
 * auvid_identifier_init, the errors of auvid_allocation_init. After an error node->id.refusal names
 * the field, its value and its limit (part "ids": of *cfg; "allocation": of *allocation). */
auvid_status_t auvid_node_init(auvid_node_t *node, const auvid_node_config_t *cfg,
                               const auvid_allocation_config_t *allocation,
                               const auvid_identifier_config_t *identifier);

#define auvid_node_attach_actuation AUVID_SIZED(auvid_node_attach_actuation)
/** Makes the node obey arm frames and command the thrusters, within the limits of its allocation.
 * Call it once, after auvid_node_init and before the first tick. After an error the node is as
 * before.
 * @param storage, cfg see auvid_identifier_attach_actuation
 * @return as auvid_identifier_attach_actuation. */
auvid_status_t auvid_node_attach_actuation(auvid_node_t *node, auvid_actuation_t *storage,
                                           const auvid_actuation_config_t *cfg);

#define auvid_node_attach_uncertain AUVID_SIZED(auvid_node_attach_uncertain)
/** Attaches uncertain inputs (uncertain.h), with the thrusters of the node. It then reports what is
 * wrong with them. Without them, and without auvid_identifier_config_t.exact_inputs, nothing is
 * reported as identifiable. Call it once, after auvid_node_init and before the first tick. After an
 * error the node is as before.
 * @param storage, cfg see auvid_identifier_attach_uncertain; cfg->fractions is not read
 * @return as auvid_identifier_attach_uncertain. */
auvid_status_t auvid_node_attach_uncertain(auvid_node_t *node, auvid_uncertain_t *storage,
                                           const auvid_uncertain_config_t *cfg);

#define auvid_node_take AUVID_SIZED(auvid_node_take)
/** Takes a received frame. It does not read the time of arrival.
 * @return AUVID_OK; AUVID_TICK (a tick has begun: call auvid_node_step); AUVID_UNUSED (no message
 * that a node receives, or one of its own last four commands of that half); AUVID_ERR_NULL;
 * AUVID_ERR_STATE (not initialised). Refused and counted: AUVID_ERR_LENGTH, AUVID_ERR_CHECKSUM,
 * AUVID_ERR_RANGE (not authentic); AUVID_ERR_REPEATED, AUVID_ERR_COUNTER_JUMP (unless the frame
 * takes thrust away); AUVID_ERR_STALE (a tick older than one already accepted). */
auvid_status_t auvid_node_take(auvid_node_t *node, const auvid_can_frame_t *frame);

#define auvid_node_step AUVID_SIZED(auvid_node_step)
/** Processes one tick: navigates, records, and commands the excitation.
 * @param t_us NULL: the time of the last tick, received or own. Otherwise this node provides the
 * clock, and the first frame written is its tick frame
 * @param frame [AUVID_NODE_COMMANDS] written: frames to send at once
 * @param count written: number of frames
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or no tick yet: no frames);
 * AUVID_ERR_TIME_BACK, AUVID_ERR_TIME_SAME (no tick and no tick frame; a command of zero if the
 * node was exciting; an arm frame remains pending). */
auvid_status_t auvid_node_step(auvid_node_t *node, const uint64_t *t_us, auvid_can_frame_t *frame,
                               int *count);

#define auvid_node_work AUVID_SIZED(auvid_node_work)
/** Runs auvid_identifier_work on the identifier of the node.
 * @param budget as in auvid_identifier_work
 * @return as auvid_identifier_work. */
auvid_status_t auvid_node_work(auvid_node_t *node, uint32_t budget);

#define auvid_node_report AUVID_SIZED(auvid_node_report)
/** Packs the reports that are due in this tick.
 * @param load time spent on this tick, in percent of its length [%], for health and tick_done;
 * saturated at 255
 * @param frame [AUVID_NODE_FRAMES] written: frames to send
 * @param count written: number of frames
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE. */
auvid_status_t auvid_node_report(auvid_node_t *node, uint32_t load, auvid_can_frame_t *frame,
                                 int *count);

#define auvid_causes_take AUVID_SIZED(auvid_causes_take)
/** For a receiver of a node's reports: collects the causes, for auvid_causes_sentence. They are
 * complete after one frame wrong_input of each class.
 * @param causes all zeros before the first message; written: all but sigma and classes that are not
 * named; the number of the estimate is that on the bus: after 127 follows 1
 * @return AUVID_OK; AUVID_UNUSED (another message, or a frame without value, of another estimate or
 * whose predecessor is missing: it comes again); AUVID_ERR_NULL. Cost: O(1). */
auvid_status_t auvid_causes_take(auvid_causes_t *causes, const auvid_can_message_t *message);

#define auvid_node_halt AUVID_SIZED(auvid_node_halt)
/** Packs a command of zero for every thruster. Send it when the program ends, when no tick comes,
 * and before a step with a tick that waited: after a stall ticks stand in a queue, 20 ms apart by
 * their own time, and neither the guard nor the node sees that they are old. An abort may stand
 * behind them. If the bus does not take a frame, send it again: the node commands nothing more.
 * There is no frame (count 0) unless the last step commanded thrust. A guard that is armed,
 * exciting or settling aborts; any other state of the guard remains. A pending arm frame is
 * cancelled.
 * @param cause of the abort: AUVID_GUARD_OPERATOR at the end, AUVID_GUARD_TICK for a late tick; as
 * AUVID_GUARD_OPERATOR if it is none
 * @param frame [AUVID_NODE_COMMANDS] written: frames to send at once
 * @param count written: number of frames
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE. */
auvid_status_t auvid_node_halt(auvid_node_t *node, auvid_guard_cause_t cause,
                               auvid_can_frame_t *frame, int *count);

#ifdef __cplusplus
}
#endif

#endif
