/**
 * @file guard.h
 * The guard of the excitation: it may act only while this state machine says so.
 *
 *     DISARMED --arm--> ARMED --excite--> EXCITING --finished--> SETTLING --calm--> DONE
 *         ^                |                 |                      |                 | arm: ARMED
 *         |                +-----------------+----------------------+--- breach ---> ABORTED
 *         +-- disarm, from anywhere                                                  (latched)
 *
 * Any breach of a limit in ARMED, EXCITING or SETTLING is ABORTED in the very step that sees it,
 * and the permission is gone in that step, without a fade. It never comes back by itself: only
 * disarm, then arm, lead out. Cause, value, limit and time are kept in `trip`.
 *
 * Who calls it: the control tick, once a tick, before it asks the excitation for its wrench; the
 * identifier does so (identifier.h). A pure state machine: no clock, no sensor, no pointer kept.
 * A guard that is all zeros, or whose init failed, never permits anything.
 *
 * What the guard cannot do: it takes the excitation away and does not brake. The vehicle goes on
 * beyond a limit by what it takes to see the breach and to stop:
 *
 *     depth, altitude, distance:  overshoot <= e + v T + v tau + d t
 *     roll, pitch:                overshoot <= e + rate T + rate tau
 *     speed, yaw rate:            overshoot <= e + a T
 *     run time:                   overshoot <= a tick
 *
 *   e   error of navigation in that quantity (three standard deviations, at least)
 *   v   speed over ground towards the limit at the breach; at most speed_max
 *   T   a tick and the age of the newest sample: the sensor's period and its delay
 *   tau m / D: m the mass (or inertia) with added mass, D the force per speed of all that brakes:
 *       the linear drag |X_u|, and whoever takes over with k N for each m/s over ground. Quadratic
 *       drag only shortens it. Girona500 left alone: 5.9 s in surge, 15 s in heave; with a pilot
 *       who gives 300 N s/m: 0.7 s, 1.9 s.
 *   d   what goes on pushing until a controller holds the position, as a speed; t: that long.
 *       Nobody takes over: the current's speed, and what W-B makes. A pilot as above: the force of
 *       the current on the vehicle held in it, and other forces, over D.
 *   a   greatest acceleration: force over mass, Coriolis forces included
 *
 * These are upper bounds; a vehicle that rights itself rolls on by less. In 1000 worlds of the test
 * campaign (AUVID_TEST_LONG=1 build/release/tests/unit/excitation/test_guard_runs, after
 * `make test`) the largest overshoot was 0.86 of what they allow.
 *
 * So a limit must lie inside the true danger by that much: a Girona500 at 0.7 m/s with DVL at 5 Hz
 * and depth at 10 Hz needs 0.1 + 0.7 * 0.22 + 0.7 * 5.9 = 4.4 m left alone, 0.8 m with the pilot.
 *
 * Cost of a step: about 100 operations and a square root. Memory: sizeof(auvid_guard_t), 0.2 KiB.
 * The paper has no such part; this is auvid's own.
 */
#ifndef AUVID_GUARD_H
#define AUVID_GUARD_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Where the guard is. */
typedef enum {
    AUVID_GUARD_DISARMED = 0, /**< nothing is watched, nothing may act */
    AUVID_GUARD_ARMED,        /**< limits are watched; excite may be called */
    AUVID_GUARD_EXCITING,     /**< the excitation may act */
    AUVID_GUARD_SETTLING,     /**< it has ended; limits are watched until the vehicle is calm */
    AUVID_GUARD_DONE,         /**< calm, or given up waiting for it; as DISARMED */
    AUVID_GUARD_ABORTED,      /**< latched: disarm leads out */
    AUVID_GUARD_STATE_COUNT
} auvid_guard_state_t;

/** Why it was aborted, or arming refused. In this order they are looked at; the first one found is
 * told. The last one no step looks at. */
typedef enum {
    AUVID_GUARD_NO_CAUSE = 0,
    AUVID_GUARD_OPERATOR,        /**< auvid_guard_abort; value and limit 0 */
    AUVID_GUARD_NO_INPUT,        /**< a step without input; value and limit 0 */
    AUVID_GUARD_TIME,            /**< a tick's time did not advance; value: by how much [s], <= 0 */
    AUVID_GUARD_TICK,            /**< a tick longer than max_tick_us [s] */
    AUVID_GUARD_LINK,            /**< no auvid_guard_heartbeat for alive_us [s] */
    AUVID_GUARD_IMU_STALE,       /**< age of the newest sample [s] */
    AUVID_GUARD_VELOCITY_STALE,  /**< likewise: of the newest that measured what is excited */
    AUVID_GUARD_DEPTH_STALE,     /**< likewise; where a depth limit is on */
    AUVID_GUARD_ALTITUDE_STALE,  /**< likewise; where the altitude limit is on and one was known */
    AUVID_GUARD_APPLIED_STALE,   /**< likewise; EXCITING only: the excitation acts unrecorded */
    AUVID_GUARD_DEPTH_MIN,       /**< [m] */
    AUVID_GUARD_DEPTH_MAX,       /**< [m] */
    AUVID_GUARD_ALTITUDE,        /**< [m] */
    AUVID_GUARD_ROLL,            /**< |phi| [rad] */
    AUVID_GUARD_PITCH,           /**< |theta| [rad] */
    AUVID_GUARD_SPEED,           /**< over ground, all three axes [m/s]; AUVID_LARGEST: not known */
    AUVID_GUARD_YAW_RATE,        /**< |r| [rad/s] */
    AUVID_GUARD_DISTANCE,        /**< horizontal, from where it was armed [m]; AUVID_LARGEST: not
                                     known */
    AUVID_GUARD_RUN_TIME,        /**< since excite, EXCITING only [s] */
    AUVID_GUARD_SATURATION,      /**< thrusters saturated without interruption for [s] */
    AUVID_GUARD_FOREIGN_COMMAND, /**< somebody else commands the thrusters (node.h); value and
                                      limit 0 */
    AUVID_GUARD_CAUSE_COUNT
} auvid_guard_cause_t;

/** Bit of a cause in auvid_guard_config_t.off. */
#define AUVID_GUARD_BIT(cause) (UINT32_C(1) << (cause))

/** The causes that may be switched off: all but the first four, AUVID_GUARD_LINK (alive_us) and the
 * last. */
#define AUVID_GUARD_SWITCHABLE                                                                     \
    ((AUVID_GUARD_BIT(AUVID_GUARD_FOREIGN_COMMAND) - AUVID_GUARD_BIT(AUVID_GUARD_TICK)) &          \
     ~AUVID_GUARD_BIT(AUVID_GUARD_LINK))

/** Configuration; copied at init. Written by the user. A limit is switched off by its bit in `off`
 * and by nothing else: zero is a limit of zero, not none. All must be finite and not negative, the
 * times at most what 32 bits hold. Defaults suit vehicles like Girona500 and BlueROV in open water;
 * depth_max_m, altitude_min_m and distance_max_m are the site's: set them. */
typedef struct {
    auvid_real_t depth_min_m;    /**< navigation's depth is not less [m]; default 1 */
    auvid_real_t depth_max_m;    /**< nor more [m], >= depth_min_m; default 100 */
    auvid_real_t altitude_min_m; /**< above the bottom, not less [m]; default 2 */
    auvid_real_t roll_max_rad;   /**< |phi| is not more [rad]; default 0.6 */
    auvid_real_t pitch_max_rad;  /**< |theta| is not more [rad]; default 0.6 */
    auvid_real_t speed_max;      /**< speed over ground is not more [m/s]; default 1.5. Needs bottom
                                      lock, see velocity_stale_us */
    auvid_real_t yaw_rate_max;   /**< |r| is not more [rad/s]; default 1.5 */
    auvid_real_t distance_max_m; /**< nor the horizontal distance from where it was armed [m];
                                      default 30. A GPS fix that moves the position counts. Needs
                                      bottom lock, too */
    uint32_t run_max_s;          /**< nor the time since excite [s]; default 1800 */
    uint32_t imu_stale_us;       /**< silence of the IMU [us]; default 200000 */
    uint32_t velocity_stale_us;  /**< no velocity measured [us]; default 1000000. After as long
                                      without a measurement of horizontal velocity over ground,
                                      speed and distance are not known: a breach of these limits */
    uint32_t depth_stale_us;     /**< no depth accepted [us]; default 1000000 */
    uint32_t altitude_stale_us;  /**< no altitude [us]; default 1000000 */
    uint32_t applied_stale_us;   /**< no applied wrench recorded [us]; default 1000000 */
    uint32_t saturation_us;      /**< saturated without interruption [us]; default 1000000 */
    uint32_t max_tick_us;    /**< longest tick [us]; default 250000: a loop that stalled must not
                                     come back exciting */
    /** dead man's switch: longest silence of auvid_guard_heartbeat [us]; default 0: none (the one
     * field where zero is off) */
    uint32_t heartbeat_timeout_us;
    auvid_real_t rest_speed;  /**< SETTLING ends when not faster over ground than this [m/s], */
    auvid_real_t rest_rate;   /**< nor turning faster than this, all axes together [rad/s], */
    uint32_t rest_dwell_us;   /**< for so long [us]; defaults 0.1, 0.1, 2000000 */
    uint32_t settle_timeout_us; /**< or at the latest after this [us]; default 30000000. In a
                                     current the vehicle is never calm over ground */
    uint32_t off;            /**< AUVID_GUARD_BIT() of the limits switched off; default 0 */
    /** Default false: where no altitude was known since arming (deep water, no altimeter) its limit
     * is not watched; once one was known, losing it is a breach. True: without one arming is
     * refused. */
    bool altitude_required;
    /** Velocity through the water, of all three axes, counts for velocity_stale_us, too. Default
     * false: there must be bottom lock. Speed and distance over ground are not known without:
     * switch these limits off (AUVID_GUARD_SPEED, AUVID_GUARD_DISTANCE) where it may be lost. */
    bool water_lock;
} auvid_guard_config_t;

/** Time of the newest accepted sample. */
typedef struct {
    uint64_t t_us; /**< [us]; ahead of the tick counts as old by as much */
    bool known;    /**< there was one */
} auvid_guard_seen_t;

/** What a step looks at. Written by the caller. Not finite where a limit is on: a breach of it. */
typedef struct {
    auvid_guard_seen_t imu, depth, altitude, applied;
    auvid_guard_seen_t velocity; /**< newest sample that measured the velocities that count */
    auvid_guard_seen_t ground;   /**< newest that measured horizontal velocity over ground */
    auvid_real_t position[3];        /**< north, east, down [m] */
    auvid_real_t roll, pitch;        /**< [rad] */
    auvid_real_t velocity_ground[3]; /**< u v w over ground [m/s] */
    auvid_real_t rates[3];           /**< p q r [rad/s] */
    auvid_real_t altitude_m;         /**< newest one [m]; not read while unknown or stale */
    bool saturated;                  /**< the thrusters are, now */
} auvid_guard_input_t;

/** A breach. */
typedef struct {
    auvid_guard_cause_t cause;
    /** measured, in the unit of the cause. AUVID_LARGEST: age of what was never known, speed or
     * distance that is not known now */
    auvid_real_t value;
    auvid_real_t limit; /**< that it breaks */
    uint64_t t_us;      /**< of the step that saw it */
} auvid_guard_trip_t;

/** The guard. Written by the functions below; public to read are the first three. */
typedef struct {
    auvid_guard_state_t state;
    auvid_guard_trip_t trip;    /**< why ABORTED; else all zero */
    auvid_guard_trip_t refused; /**< why the last arm was refused as STALE or LIMIT; zeroed by one
                                     that is not */

    auvid_guard_config_t cfg;
    uint64_t t_us;         /* last step, or arm */
    uint64_t excite_us;    /* time of excite */
    uint64_t settling_us;  /* SETTLING since */
    uint64_t at_rest_us;   /* calm since */
    uint64_t saturated_us; /* saturated since */
    uint64_t heartbeat_us; /* last sign of life */
    auvid_real_t home[2];  /* where it was armed */
    bool stepped;          /* since arm */
    bool at_rest, saturated; /* the times above count */
    bool altitude_known;   /* since arm */
    bool ready;            /* initialised */
} auvid_guard_t;

#define auvid_guard_defaults AUVID_SIZED0(auvid_guard_defaults)
/** Fill *cfg with the defaults named at its fields. Null is ignored. */
void auvid_guard_defaults(auvid_guard_config_t *cfg);

#define auvid_guard_init AUVID_SIZED0(auvid_guard_init)
/** Check the configuration, copy it, and be DISARMED.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (a negative limit; a bit
 * in `off` that is not in AUVID_GUARD_SWITCHABLE); AUVID_ERR_BOUNDS (depth_min_m > depth_max_m).
 * On < 0 *g is as before. */
auvid_status_t auvid_guard_init(auvid_guard_t *g, const auvid_guard_config_t *cfg);

#define auvid_guard_arm AUVID_SIZED0(auvid_guard_arm)
/** DISARMED or DONE -> ARMED, here and now: home is where the vehicle is. A sign of life, too.
 * @param t_us now [us]: the next step must not be before. @param in as it is now
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or in another state: stays
 * there); AUVID_ERR_STALE (a sensor is silent, or has not spoken yet); AUVID_ERR_LIMIT (a limit is
 * broken already). For the last two g->refused tells which; nothing else has changed. */
auvid_status_t auvid_guard_arm(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in);

#define auvid_guard_excite AUVID_SIZED0(auvid_guard_excite)
/** ARMED -> EXCITING. @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not ARMED). */
auvid_status_t auvid_guard_excite(auvid_guard_t *g, uint64_t t_us);

#define auvid_guard_finished AUVID_SIZED0(auvid_guard_finished)
/** EXCITING -> SETTLING: the excitation has come to its end, by itself or faded out (the operator's
 * normal end: the excitation fades, still EXCITING and watched, and then this is called).
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not EXCITING). */
auvid_status_t auvid_guard_finished(auvid_guard_t *g, uint64_t t_us);

#define auvid_guard_abort AUVID_SIZED0(auvid_guard_abort)
/** Operator's abort: -> ABORTED from anywhere, also from DISARMED, so that an arm on its way is
 * refused. An earlier cause stays. @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not
 * initialised). */
auvid_status_t auvid_guard_abort(auvid_guard_t *g, uint64_t t_us);

#define auvid_guard_abort_for AUVID_SIZED0(auvid_guard_abort_for)
/** The same for another cause than the operator. @param cause told in `trip`, value and limit 0
 * @return likewise; AUVID_ERR_RANGE (no cause: nothing is done). */
auvid_status_t auvid_guard_abort_for(auvid_guard_t *g, uint64_t t_us, auvid_guard_cause_t cause);

#define auvid_guard_disarm AUVID_SIZED0(auvid_guard_disarm)
/** -> DISARMED from anywhere; clears the latch and the cause.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_guard_disarm(auvid_guard_t *g);

#define auvid_guard_heartbeat AUVID_SIZED0(auvid_guard_heartbeat)
/** A sign of life from the operator. @param t_us when [us]; an earlier one than the last is
 * ignored. @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_TIME_BACK. */
auvid_status_t auvid_guard_heartbeat(auvid_guard_t *g, uint64_t t_us);

#define auvid_guard_step AUVID_SIZED0(auvid_guard_step)
/** One tick. Does nothing in DISARMED, DONE and ABORTED.
 * @param t_us later than the step before, not before arm; else a breach.
 * @param in null is a breach.
 * @return may the excitation act in this tick? True in EXCITING without a breach only. */
bool auvid_guard_step(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in);

/** Short English name of a state; never null. */
const char *auvid_guard_state_str(auvid_guard_state_t state);

/** Short English sentence for a cause; never null. */
const char *auvid_guard_cause_str(auvid_guard_cause_t cause);

#ifdef __cplusplus
}
#endif

#endif
