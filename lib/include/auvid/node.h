/**
 * @file node.h
 * The node: the identifier on the bus. Frames in, frames out; no driver, no clock.
 *
 *     auvid_node_take     for every frame that came, in its order
 *     auvid_node_step     when take says AUVID_TICK, or at one's own ticks: thruster commands
 *     auvid_node_work     with the time that is left: optimizing
 *     auvid_node_report   navigation, estimates, progress, health, heartbeat
 *
 * Passive by default: it listens, identifies and reports, and never sends a thruster command. With
 * `excite` it obeys arm frames: it arms the guard and excites, with a command in every tick from
 * that of the order on; it sends none when it does not excite. An abort frame, or whatever the
 * guard trips over, ends that with one command of zero in the same tick; the receiver's time-out
 * does so when the node itself has died. Up to four thrusters have thruster_command_a only.
 *
 * What takes thrust away is obeyed on every authentic frame (right length, checksum and range),
 * whatever its counter says: abort, disarm and stop. So a console that was restarted, and counts
 * from 0 again, is obeyed with its first frame. Of these only a disarm with a good counter
 * (can_receiver.h) clears an abort; one that is repeated or jumped aborts what runs, and leaves the
 * guard ABORTED. All of them cancel an order to arm that waits for its tick.
 *
 * Two nodes must not command the same thrusters. While armed or exciting a node aborts, with the
 * cause AUVID_GUARD_FOREIGN_COMMAND, on an authentic command frame that is not, byte for byte, one
 * of its own last four of that half. Those four may come back late, merged or twice, from a driver
 * that echoes what was sent. The node does not notice another one that sends the very same bytes
 * (same configuration, seed and start), nor one that sends them up to three ticks later; but the
 * later one notices the earlier one, and its zero is foreign to that. While the bytes are the same,
 * receivers obey one of the two: the other's counters are repeated or jumped.
 *
 * Time is the tick's: what came since the tick before counts as sent at this one, less the age it
 * carries. So a log of the frames replays bit for bit, however fast it is read. A sender that knows
 * the tick gives its samples' age at the tick; one that does not is up to a tick late.
 *
 * A tick whose number is up to 15 behind the last one's is a copy or comes late, and is refused.
 * One further behind comes from a clock that was started again. A clock that was set, stands still
 * or goes ahead by more than a second is taken to have gone ahead by a second: the record has a gap
 * there, and time never goes back.
 *
 * The attitude and the rates of the IMU are one sample when they are at most 30 ms apart; its time
 * is the later one's. Further apart, the earlier one is dropped and the later one waits for its
 * other half. One with an axis or its age missing counts as not sent.
 *
 * Thrust feedback holds for the time between the tick before and this one. It must be the thrust of
 * all sources. Without it nothing can be identified: commands may not have been obeyed.
 *
 * Cost: take is one auvid_can_unpack; step and work as in identifier.h; report packs at most
 * AUVID_NODE_FRAMES frames. Memory: sizeof(auvid_node_t): the identifier and 1.4 KiB.
 */
#ifndef AUVID_NODE_H
#define AUVID_NODE_H

#include "auvid/can.h"
#include "auvid/can_receiver.h"
#include "auvid/identifier.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Most frames from one call of report. */
#define AUVID_NODE_FRAMES 12
/** Most frames from one call of step or halt. */
#define AUVID_NODE_COMMANDS 3

/** Messages that a node listens to: the first ones of auvid_can_kind_t. */
#define AUVID_NODE_KINDS (AUVID_CAN_GPS + 1)

/** Configuration; copied at init. Written by the user. */
typedef struct {
    bool excite;         /**< obey arm frames and command thrusters; default false: passive */
    bool answer;         /**< send tick_done after the work of each tick: who waits for it runs in
                              lock step, faster than real time; default false */
    auvid_can_ids_t ids; /**< see can.h */
} auvid_node_config_t;

/** Counters; all wrap. */
typedef struct {
    uint32_t ticks;           /**< tick frames obeyed, or own ticks */
    uint32_t ticks_missed;    /**< that the sequence shows to be missing */
    uint32_t clock_steps;     /**< times the tick's clock went back, stood still, or went ahead by
                                   more than 1 s */
    uint32_t frames;          /**< good frames taken */
    uint32_t refused;         /**< frames of ours with a bad checksum, length, range or counter, and
                                   ticks of which a later one has come */
    uint32_t samples_dropped; /**< samples that navigation or the recorder refused */
    uint32_t unknown_age;     /**< samples without an age: not used */
    uint32_t foreign_commands; /**< command frames of another node, whether armed or not */
} auvid_node_counters_t;

/** The node. Public to read; write only through the functions. */
typedef struct {
    auvid_identifier_t id;
    auvid_node_config_t cfg;
    auvid_node_counters_t counters;
    auvid_can_sender_t sender;
    auvid_can_receiver_t receiver[AUVID_NODE_KINDS];
    auvid_input_t in;               /* gathered since the last tick */
    uint64_t attitude_us, rates_us; /* of the halves of the IMU's sample: ages, then times */
    auvid_real_t thrust[AUVID_CAN_THRUSTERS]; /* fed back */
    uint64_t t_us;                            /**< last tick */
    uint64_t tick_us;             /* of the tick under way: bus time with steps taken out */
    uint64_t bus_us;              /* the bus's own time of the last tick */
    uint64_t sent[2][4];          /* data of the last commands of each half, by counter */
    uint32_t sequence;            /* of the last tick frame */
    uint32_t reports;             /* calls of report */
    uint32_t events;              /**< AUVID_EVENT_... of the last step */
    uint32_t load;                /* largest since the last health */
    uint8_t index;                /* of the parameter to be reported next */
    uint8_t point;                /* of the drag force to be reported next */
    bool started;                 /* there was a tick */
    bool attitude, rates;         /* that half has come since the last sample */
    bool new_attitude, new_rates; /* in this tick: its time is an age still */
    bool feedback;                /* thrust has been fed back since the last tick */
    bool arming;                  /* an arm frame has come: arm at the next step */
    bool commanding;              /* the last step commanded thrust */
    bool ready;                   /* initialised */
} auvid_node_t;

/** Passive, default identifiers. Null is ignored. */
void auvid_node_defaults(auvid_node_config_t *cfg);

#define auvid_node_init AUVID_SIZED(auvid_node_init)
/** Start.
 * @param identifier its configuration, with allocation: the bus knows thrusters, not wrenches. May
 * be node->id.config: no memory besides; void afterwards
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (identifiers overlap; velocity source);
 * AUVID_ERR_SIZE (no thrusters, or more than AUVID_CAN_THRUSTERS); those of auvid_identifier_init.
 * On error every other function refuses *node with AUVID_ERR_STATE. */
auvid_status_t auvid_node_init(auvid_node_t *node, const auvid_node_config_t *cfg,
                               const auvid_identifier_config_t *identifier);

#define auvid_node_take AUVID_SIZED(auvid_node_take)
/** Take a frame off the bus. Its time of arrival is not read.
 * @return AUVID_OK; AUVID_TICK (a tick has opened: call step); AUVID_UNUSED (not a message that a
 * node listens to, or one of its own last four commands of that half); AUVID_ERR_NULL;
 * AUVID_ERR_STATE; AUVID_ERR_CHECKSUM (refused: checksum, length, range, a repeated or jumped
 * counter of what does not take thrust away, or a tick of which a later one has come; counted). */
auvid_status_t auvid_node_take(auvid_node_t *node, const auvid_can_frame_t *frame);

#define auvid_node_step AUVID_SIZED(auvid_node_step)
/** One tick: sense, navigate, record, and what the excitation commands.
 * @param t_us null: the time of the last tick frame, taken or its own; else this node gives the
 * clock, and the first frame is its tick frame
 * @param frame [AUVID_NODE_COMMANDS] written: to be sent at once. @param count written: how many
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or no tick yet: no frames);
 * AUVID_ERR_TIME_BACK, AUVID_ERR_TIME_SAME (no tick, so no tick frame: nothing but a command of
 * zero if it was exciting; an order to arm waits on). */
auvid_status_t auvid_node_step(auvid_node_t *node, const uint64_t *t_us, auvid_can_frame_t *frame,
                               int *count);

#define auvid_node_work AUVID_SIZED(auvid_node_work)
/** Optimize. @param budget as in auvid_identifier_work. @return likewise. */
auvid_status_t auvid_node_work(auvid_node_t *node, uint32_t budget);

#define auvid_node_report AUVID_SIZED(auvid_node_report)
/** What is due to be reported in this tick.
 * @param load of the tick's length that its work took [%], for health and tick_done; saturated at
 * 255
 * @param frame [AUVID_NODE_FRAMES] written: to be sent. @param count written: how many
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE. */
auvid_status_t auvid_node_report(auvid_node_t *node, uint32_t load, auvid_can_frame_t *frame,
                                 int *count);

#define auvid_node_halt AUVID_SIZED(auvid_node_halt)
/** A command of zero for every thruster: to be sent when the program ends or loses its tick.
 * Nothing (count 0) unless the last step commanded thrust. A guard that is armed, exciting or
 * settling aborts; one that is not stays as it is, and an order to arm that waits is cancelled.
 * Statuses as report. */
auvid_status_t auvid_node_halt(auvid_node_t *node, auvid_can_frame_t *frame, int *count);

#ifdef __cplusplus
}
#endif

#endif
