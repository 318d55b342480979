/**
 * @file guard.h
 * The guard of the excitation: a state machine that permits it or not.
 *
 *     DISARMED --arm--> ARMED --excite--> EXCITING --finished--> SETTLING --at rest-> DONE
 *         ^                |                 |                      |                 | arm: ARMED
 *         |                +-----------------+----------------------+--- breach ---> ABORTED
 *         +-- disarm, from any state                                                 (latched)
 *
 * A breach of a limit in ARMED, EXCITING or SETTLING leads to ABORTED in the same step. That step
 * already withdraws the permission, without a fade. ABORTED is latched: only disarm, then arm,
 * leave it. `trip` holds cause, value, limit and time.
 *
 * The control tick calls it once a tick, before it computes the excitation wrench; the identifier
 * does so (identifier.h). A pure state machine: no clock, no sensor, no pointer kept. A guard that
 * is all zeros, or whose init failed, never permits the excitation.
 *
 * Limits of the guard: it removes the excitation but does not brake. The overshoot beyond a limit
 * is the motion until the breach is detected and the vehicle stops:
 *
 *     depth, altitude, distance:  overshoot <= e + v T + v tau + d t
 *     roll, pitch:                overshoot <= e + rate T + rate tau
 *     speed, yaw rate:            overshoot <= e + a T
 *     run time:                   overshoot <= a tick
 *
 *   e   error of navigation in that quantity (three standard deviations, at least)
 *   v   speed over ground towards the limit at the breach; at most speed_max
 *   T   a tick plus the age of the newest sample: the sensor's period and its delay
 *   tau m / D: m the mass (or inertia) with added mass, D the total braking force per speed: the
 *       linear drag |X_u|, plus k N for each m/s over ground from a pilot or controller. Quadratic
 *       drag only shortens it. Girona500 without control: 5.9 s in surge, 15 s in heave; with a
 *       pilot who applies 300 N s/m: 0.7 s, 1.9 s.
 *   d   drift speed until a controller holds the position, for the time t. Without control: the
 *       speed of the current, and that caused by W-B. With a pilot as above: the force of the
 *       current on the vehicle at rest over ground, and other forces, divided by D.
 *   a   largest acceleration: force over mass, Coriolis forces included
 *
 * These are upper bounds; restoring moments reduce the overshoot in roll and pitch. In 1000 worlds
 * of the test campaign (AUVID_TEST_LONG=1 build/release/tests/unit/excitation/test_guard_runs,
 * after `make test`) the largest overshoot was 0.86 of what they allow.
 *
 * Set each limit inside the true danger by that margin. Girona500 at 0.7 m/s with DVL at 5 Hz and
 * depth at 10 Hz: 0.1 + 0.7 * 0.22 + 0.7 * 5.9 = 4.4 m without control, 0.8 m with the pilot.
 *
 * Cost of a step: about 150 operations and a square root. Memory: sizeof(auvid_guard_t), 0.3 KiB.
 * Source: auvid's own; the paper has no guard.
 */
#ifndef AUVID_GUARD_H
#define AUVID_GUARD_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** State of the guard. */
typedef enum {
    AUVID_GUARD_DISARMED = 0, /**< no limit is watched, no excitation */
    AUVID_GUARD_ARMED,        /**< limits are watched; excite may be called */
    AUVID_GUARD_EXCITING,     /**< the excitation may act */
    AUVID_GUARD_SETTLING,     /**< it has ended; limits are watched until the vehicle is at rest */
    AUVID_GUARD_DONE,         /**< at rest, or settle_timeout_us over; as DISARMED */
    AUVID_GUARD_ABORTED,      /**< latched until disarm */
    AUVID_GUARD_STATE_COUNT
} auvid_guard_state_t;

/** Why the guard aborted, or refused to arm. A step tests the causes in this order and reports the
 * first one found. No step tests the last one. Unit of value and limit in brackets. */
typedef enum {
    AUVID_GUARD_NO_CAUSE = 0,
    AUVID_GUARD_OPERATOR,        /**< auvid_guard_abort; value and limit 0 */
    AUVID_GUARD_NO_INPUT,        /**< a step without input; of the identifier, also one without
                                      memory for the output. Value and limit 0 */
    AUVID_GUARD_TIME,            /**< the time of a tick did not advance; value: step [s], <= 0 */
    AUVID_GUARD_TICK,            /**< a tick longer than max_tick_us [s] */
    AUVID_GUARD_LINK,            /**< no auvid_guard_heartbeat for heartbeat_timeout_us [s] */
    AUVID_GUARD_IMU_STALE,       /**< age of the newest sample, or time of repetition [s] */
    AUVID_GUARD_VELOCITY_STALE,  /**< likewise: of the newest that measured the excited DoFs */
    AUVID_GUARD_DEPTH_STALE,     /**< likewise; if a depth limit is on, see `surface` */
    AUVID_GUARD_ALTITUDE_STALE,  /**< likewise; if the altitude limit is on and one was known */
    AUVID_GUARD_APPLIED_STALE,   /**< likewise; EXCITING only: the wrench is not recorded */
    AUVID_GUARD_DEPTH_MIN,       /**< [m] */
    AUVID_GUARD_DEPTH_MAX,       /**< [m] */
    AUVID_GUARD_ALTITUDE,        /**< [m] */
    AUVID_GUARD_ROLL,            /**< |phi| [rad] */
    AUVID_GUARD_PITCH,           /**< |theta| [rad] */
    AUVID_GUARD_SPEED,           /**< over ground, all three axes [m/s]; AUVID_LARGEST: unknown */
    AUVID_GUARD_YAW_RATE,        /**< |r| [rad/s] */
    AUVID_GUARD_DISTANCE,        /**< horizontal, from the position at arming [m]; AUVID_LARGEST:
                                     unknown */
    AUVID_GUARD_RUN_TIME,        /**< since excite, EXCITING only [s] */
    AUVID_GUARD_SATURATION,      /**< time of uninterrupted thruster saturation [s] */
    AUVID_GUARD_FOREIGN_COMMAND, /**< another node commands the thrusters (node.h); value and
                                      limit 0 */
    AUVID_GUARD_CAUSE_COUNT
} auvid_guard_cause_t;

/** Sensors whose samples are compared: one that hangs may repeat its last values, with good times.
 * Index into auvid_guard_input_t.values. */
typedef enum {
    AUVID_GUARD_ATTITUDE = 0, /**< phi theta psi, or a quaternion */
    AUVID_GUARD_RATES,        /**< p q r */
    AUVID_GUARD_BOTTOM,       /**< velocity over ground */
    AUVID_GUARD_PRESSURE,     /**< depth, or pressure */
    AUVID_GUARD_SOURCES
} auvid_guard_source_t;

/** Bit of a cause in auvid_guard_config_t.off. */
#define AUVID_GUARD_BIT(cause) (UINT32_C(1) << (cause))

/** The causes that may be switched off: all but the first four, AUVID_GUARD_LINK (see
 * heartbeat_timeout_us) and the last. */
#define AUVID_GUARD_SWITCHABLE                                                                     \
    ((AUVID_GUARD_BIT(AUVID_GUARD_FOREIGN_COMMAND) - AUVID_GUARD_BIT(AUVID_GUARD_TICK)) &          \
     ~AUVID_GUARD_BIT(AUVID_GUARD_LINK))

/** Configuration; copied at init. Written by the user. Only its bit in `off` switches a limit off:
 * zero is a limit of zero, not none. All values must be finite and not negative. The defaults suit
 * vehicles like Girona500 and BlueROV in open water. depth_max_m, altitude_min_m and distance_max_m
 * depend on the site: set them. */
typedef struct {
    auvid_real_t depth_min_m;    /**< smallest depth of navigation [m]; default 1 */
    auvid_real_t depth_max_m;    /**< largest depth [m], >= depth_min_m; default 100 */
    auvid_real_t altitude_min_m; /**< smallest altitude above the bottom [m]; default 2 */
    auvid_real_t roll_max_rad;   /**< largest |phi| [rad]; default 0.6 */
    auvid_real_t pitch_max_rad;  /**< largest |theta| [rad]; default 0.6 */
    auvid_real_t speed_max;      /**< largest speed over ground [m/s]; default 1.5. Needs bottom
                                      lock, see velocity_stale_us */
    auvid_real_t yaw_rate_max;   /**< largest |r| [rad/s]; default 1.5 */
    auvid_real_t distance_max_m; /**< largest horizontal distance from the position at arming [m];
                                      default 30. A GPS fix that moves the position counts. Needs
                                      bottom lock, too */
    uint32_t run_max_s;          /**< longest time since excite [s]; default 1800 */
    uint32_t imu_stale_us;       /**< longest time without an IMU sample [us]; default 200000 */
    uint32_t velocity_stale_us;  /**< the same for a measured velocity [us]; default 1000000, too
                                      short for a DVL at 1 Hz. After the same time without a
                                      horizontal velocity over ground, speed and distance are
                                      unknown: a breach of these limits */
    uint32_t depth_stale_us;     /**< the same for an accepted depth [us]; default 1000000 */
    uint32_t altitude_stale_us;  /**< the same for an altitude [us]; default 1000000 */
    /** the same for the applied wrench [us]; default 1000000. It counts from the wrench's own time:
     * if that is ahead of the tick, the loss is noticed later by as much, at most by this time
     * again */
    uint32_t applied_stale_us;
    uint32_t saturation_us;      /**< longest uninterrupted saturation [us]; default 1000000 */
    uint32_t repeat_us; /**< longest time in which a sensor repeats the same values, bit for bit,
                             while exciting [us]; default 3000000; 0: off. Longer is a breach as if
                             it had no sample: noise changes real ones. Zeros are no repetition.
                             Attitude: only time with rates above rest_rate counts; depth: with a
                             vertical velocity above rest_speed. It takes eight samples at least.
                             Set 0 if the DVL rounds far more coarsely than its noise */
    uint32_t max_tick_us;        /**< longest tick [us]; default 250000: after a stall the control
                                      loop must not resume the excitation. By the time of the
                                      ticks: of those that wait in a queue the caller must judge
                                      (auvid_node_halt) */
    uint32_t heartbeat_timeout_us; /**< dead man's switch: longest time without
                                        auvid_guard_heartbeat() [us]; default 0: off (only here and
                                        in repeat_us zero switches off) */
    auvid_real_t rest_speed;       /**< at rest: largest speed over ground [m/s]; default 0.1 */
    auvid_real_t rest_rate;        /**< at rest: largest norm of the rates [rad/s]; default 0.1 */
    uint32_t rest_dwell_us;     /**< SETTLING ends after the vehicle is at rest for this time [us];
                                      default 2000000 */
    uint32_t settle_timeout_us; /**< SETTLING ends at the latest after this time [us]; default
                                      30000000. In a current the vehicle is never at rest over
                                      ground */
    uint32_t off;               /**< AUVID_GUARD_BIT() of the limits switched off; default 0 */
    /** False (default): the altitude limit is not watched until an altitude is known (deep water,
     * no altimeter); losing it then is a breach. True: arming is refused without an altitude. */
    bool altitude_required;
    /** True: a surface craft, which needs no depth. Its depth is not watched until one is known.
     * Then depth_max_m holds, and losing the depth is a breach. depth_min_m has no meaning. The
     * altitude is that of the craft above the bottom, watched as above. While the excitation acts
     * in heave, the craft counts as submerged: all limits hold. False (default): submerged. */
    bool surface;
    /** True: velocity through the water of all three axes also counts for velocity_stale_us. False
     * (default): bottom lock is required. Speed and distance over ground are unknown without bottom
     * lock: where it may be lost, switch AUVID_GUARD_SPEED and AUVID_GUARD_DISTANCE off. */
    bool water_lock;
} auvid_guard_config_t;

/** Time of the newest accepted sample. */
typedef struct {
    uint64_t t_us; /**< [us]; a time ahead of the tick counts as an age of the same length */
    bool known;    /**< t_us is valid */
    uint8_t reserved[7];
} auvid_guard_seen_t;

/** Input of a step. Written by the caller. A value that is not finite breaks its limit if that is
 * on. */
typedef struct {
    auvid_guard_seen_t imu, depth, altitude, applied;
    auvid_guard_seen_t velocity;     /**< newest sample that measured the required velocities */
    auvid_guard_seen_t ground;       /**< newest sample of the horizontal velocity over ground */
    /** By auvid_guard_source_t: auvid_guard_values() of the sample that this tick has; 0: none. */
    uint32_t values[AUVID_GUARD_SOURCES];
    auvid_real_t position[3];        /**< north, east, down [m] */
    auvid_real_t roll, pitch;        /**< [rad] */
    auvid_real_t velocity_ground[3]; /**< u v w over ground [m/s] */
    auvid_real_t rates[3];           /**< p q r [rad/s] */
    auvid_real_t altitude_m;         /**< newest one [m]; not read if unknown or stale */
    bool saturated;                  /**< the thrusters are saturated in this tick */
    bool heaves;                     /**< the excitation acts in heave */
} auvid_guard_input_t;

/** A breach. */
typedef struct {
    uint64_t t_us;      /**< time of the step that detected it [us] */
    auvid_real_t value; /**< measured, in the unit of the cause. AUVID_LARGEST: age of a source that
                             never had a sample, or unknown speed or distance */
    auvid_real_t limit; /**< the limit, in the same unit */
    uint8_t cause;      /**< auvid_guard_cause_t */
    uint8_t reserved[7];
} auvid_guard_trip_t;

/** The guard. Only the functions below write it; `state`, `trip` and `refused` may be read. */
typedef struct {
    auvid_guard_config_t cfg;
    bool ready; /* initialised */
    /* state: from here on, see checkpoint.h */
    uint64_t t_us;              /* last step, or arm */
    uint64_t excite_us;         /* time of excite */
    uint64_t settling_us;       /* start of SETTLING */
    uint64_t at_rest_us;        /* start of being at rest */
    uint64_t saturated_us;      /* start of saturation */
    uint64_t heartbeat_us;      /* last heartbeat */
    uint32_t values[AUVID_GUARD_SOURCES];    /* of the last sample of each source */
    uint32_t repeat_us[AUVID_GUARD_SOURCES]; /* time in which samples repeated them */
    uint32_t waited_us[AUVID_GUARD_SOURCES]; /* since the last sample, at most an eighth */
    auvid_guard_trip_t trip;    /**< why it is ABORTED; else all zero */
    auvid_guard_trip_t refused; /**< why the last arm returned STALE or LIMIT; all zero after a
                                     successful one */
    auvid_real_t home[2];       /* north and east at arming */
    uint8_t state;              /**< auvid_guard_state_t */
    bool stepped;               /* a step since arm */
    bool at_rest, saturated;    /* the times above are valid */
    bool altitude_known;        /* an altitude was fresh since arm */
    bool depth_known;           /* the same for a depth */
    uint8_t reserved[2];
} auvid_guard_t;

#define auvid_guard_defaults AUVID_SIZED0(auvid_guard_defaults)
/** Fill *cfg with the defaults stated at its fields.
 * @param cfg written whole; NULL is a no-op. */
void auvid_guard_defaults(auvid_guard_config_t *cfg);

#define auvid_guard_init AUVID_SIZED0(auvid_guard_init)
/** Check the configuration and copy it; the guard is then DISARMED.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE if a limit is negative or
 *         a bit of `off` is not in AUVID_GUARD_SWITCHABLE; AUVID_ERR_BOUNDS if
 *         depth_min_m > depth_max_m. On an error *g is unchanged. */
auvid_status_t auvid_guard_init(auvid_guard_t *g, const auvid_guard_config_t *cfg);

#define auvid_guard_arm AUVID_SIZED0(auvid_guard_arm)
/** DISARMED or DONE -> ARMED. The current position becomes the origin of the distance limit. Counts
 * as a heartbeat.
 * @param t_us now [us]; the next step must not be before it.
 * @param in   current values.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE if not initialised or in another state, which
 *         remains; AUVID_ERR_STALE if a sensor is stale or had no sample yet; AUVID_ERR_LIMIT if a
 *         limit is already exceeded. For the last two g->refused holds the cause; nothing else
 *         changes. */
auvid_status_t auvid_guard_arm(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in);

#define auvid_guard_excite AUVID_SIZED0(auvid_guard_excite)
/** ARMED -> EXCITING.
 * @param t_us now [us].
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE if not ARMED. */
auvid_status_t auvid_guard_excite(auvid_guard_t *g, uint64_t t_us);

#define auvid_guard_finished AUVID_SIZED0(auvid_guard_finished)
/** EXCITING -> SETTLING: the excitation has ended by itself or has faded out. An operator's stop
 * fades the excitation while the guard stays EXCITING; call this function after the fade.
 * @param t_us now [us].
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE if not EXCITING. */
auvid_status_t auvid_guard_finished(auvid_guard_t *g, uint64_t t_us);

#define auvid_guard_abort AUVID_SIZED0(auvid_guard_abort)
/** Operator's abort: -> ABORTED from any state. This includes DISARMED, so that an arm command that
 * is already under way is refused. If already ABORTED, the earlier cause remains.
 * @param t_us now [us].
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE if not initialised. */
auvid_status_t auvid_guard_abort(auvid_guard_t *g, uint64_t t_us);

#define auvid_guard_abort_for AUVID_SIZED0(auvid_guard_abort_for)
/** Abort like auvid_guard_abort(), for a given cause.
 * @param t_us  now [us].
 * @param cause stored in `trip` with value and limit 0.
 * @return as auvid_guard_abort; AUVID_ERR_RANGE if `cause` is AUVID_GUARD_NO_CAUSE or outside its
 *         enumeration: nothing changes. */
auvid_status_t auvid_guard_abort_for(auvid_guard_t *g, uint64_t t_us, auvid_guard_cause_t cause);

#define auvid_guard_disarm AUVID_SIZED0(auvid_guard_disarm)
/** -> DISARMED from any state; clears the latch and the cause.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE if not initialised. */
auvid_status_t auvid_guard_disarm(auvid_guard_t *g);

#define auvid_guard_heartbeat AUVID_SIZED0(auvid_guard_heartbeat)
/** Heartbeat of the operator.
 * @param t_us its time [us].
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_TIME_BACK if t_us is before the last heartbeat:
 *         nothing changes. */
auvid_status_t auvid_guard_heartbeat(auvid_guard_t *g, uint64_t t_us);

#define auvid_guard_values AUVID_SIZED0(auvid_guard_values)
/** Return a number that stands for the values of a sample: never 0, 1 if all are zero.
 * @param x n values, read bit for bit; NULL counts as n = 0. */
uint32_t auvid_guard_values(const auvid_real_t *x, int n);

#define auvid_guard_step AUVID_SIZED0(auvid_guard_step)
/** Test all limits in one tick. A no-op in DISARMED, DONE and ABORTED.
 * @param t_us time of the tick [us], later than the previous step and not before arm; else a
 * breach.
 * @param in   current values; NULL is a breach.
 * @return true if the excitation may act in this tick: EXCITING without a breach. False if g is
 *         NULL or not initialised. */
bool auvid_guard_step(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in);

/** Return a short English name of a state; never NULL. */
const char *auvid_guard_state_str(auvid_guard_state_t state);

/** Return a short English sentence for a cause; never NULL. */
const char *auvid_guard_cause_str(auvid_guard_cause_t cause);

#ifdef __cplusplus
}
#endif

#endif
