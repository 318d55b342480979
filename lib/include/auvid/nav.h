/**
 * @file nav.h
 * Navigation: an extended Kalman filter for position and body velocity from IMU, DVL, depth, GPS.
 *
 * The filter of the paper's section II-B: state [x y z u v w], position in the world frame,
 * velocity in the body frame, constant velocity driven by white accelerations; attitude and rates
 * are taken from the IMU as they are. Around it stands what real sensors need: irregular and late
 * samples, any subset of them, a gate and a way out of it, DVL mounting, bottom and water lock kept
 * apart, GPS only at the surface, and a record of what was refused and why.
 *
 * Who calls it, when: once a tick auvid_nav_imu(), then one call for each sample that has come in
 * since, in any order. Then auvid_nav_state() and, for identification, the knots `ground` and
 * `water`: velocity at the DVL's own times, because a constant-velocity filter held between pulses
 * lags by a tenth of a second.
 *
 * Cost: constant, no iteration. Instructions on a Cortex-M4F at -O2: a tick 0.58k, a depth 0.22k, a
 * full DVL sample of the present 0.46k; late: a depth 0.76k, a DVL sample 1.8k, or 4.3k where
 * nothing entered since it was taken. Memory: auvid_nav_t, AUVID_NAV_BYTES in float.
 *
 * Numbers: position is a sum of two floats (plain float32 drifts by 1 mm at 120 m); the covariance
 * is kept as three 3x3 blocks of which the symmetric two hold their upper half only, so it cannot
 * lose symmetry; measurements enter one scalar at a time, a full DVL sample of the present at once.
 *
 * Sources: Karras et al., IROS 2013, Eq. 3-8; late velocities: Bar-Shalom, "Update with
 * out-of-sequence measurements in tracking", IEEE T-AES 38(3), 2002 (algorithm B1).
 */
#ifndef AUVID_NAV_H
#define AUVID_NAV_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Most GPS fixes whose median may start the position. */
#define AUVID_NAV_GPS_START_MAX 8

/** Upper bound of sizeof(auvid_nav_t) when auvid_real_t is float; a test holds it. */
#define AUVID_NAV_BYTES 984

/** Past ticks whose rates are kept for late DVL samples, a power of two. */
#define AUVID_NAV_PAST 8

/** The sensors that correct the filter; index into auvid_nav_t.diagnostics. */
typedef enum {
    AUVID_NAV_DVL_BOTTOM = 0, /**< DVL, velocity over ground */
    AUVID_NAV_DVL_WATER = 1,  /**< DVL, velocity through the water */
    AUVID_NAV_DEPTH = 2,      /**< depth or pressure */
    AUVID_NAV_GPS = 3,        /**< position in the plane */
    AUVID_NAV_SENSOR_COUNT = 4
} auvid_nav_sensor_t;

/** What a DVL sample was measured against. */
typedef enum {
    AUVID_DVL_BOTTOM = 0, /**< the sea bottom: velocity over ground */
    AUVID_DVL_WATER = 1   /**< a layer of water: velocity through the water */
} auvid_dvl_lock_t;

/** Bits of auvid_dvl_sample_t.valid, one for each axis of the instrument. */
enum { AUVID_DVL_X = 1, AUVID_DVL_Y = 2, AUVID_DVL_Z = 4, AUVID_DVL_ALL = 7 };

/** One DVL sample as the instrument gives it. Written by the caller. */
typedef struct {
    uint64_t t_us;            /**< when it was measured (not when it arrived) [us] */
    auvid_real_t velocity[3]; /**< in the instrument's frame [m/s]; axes without their bit in
                                   `valid` are not read and may be NaN */
    auvid_dvl_lock_t lock;    /**< bottom or water */
    uint8_t valid;            /**< AUVID_DVL_X | AUVID_DVL_Y | AUVID_DVL_Z; 0: no lock at all */
} auvid_dvl_sample_t;

/** Configuration. Fill with auvid_nav_defaults(), then change what differs. The ranges keep the
 * covariance within what single precision can hold. */
typedef struct {
    auvid_real_t sigma_acceleration[3]; /**< process noise n_u n_v n_w of Eq. 5 at ticks of
        `reference_tick` [m/s2]; default 1 (gain of a DVL update >= 0.96); 1e-4..100 */
    auvid_real_t reference_tick; /**< tick the above is meant for [s]; default 0.02; 1e-4..10. The
        velocity variance grows by sigma^2 reference_tick per second whatever the tick. */
    auvid_real_t sigma_dvl;      /**< noise of each DVL axis [m/s]; default 0.007; 1e-4..1e3 */
    auvid_real_t sigma_current;  /**< standard deviation of the water's own velocity, added when
        water lock stands in for bottom lock [m/s]; default 0.3; 0..1e3, 0: still water */
    auvid_real_t sigma_depth;    /**< noise of depth [m]; default 0.015; 1e-3..1e3 */
    auvid_real_t sigma_gps;      /**< noise of each GPS axis [m]; default 1.5; 1e-3..1e3 */
    auvid_real_t position[3];    /**< position at the start, NED [m]; default 0; |.| <= 1e5 */
    auvid_real_t sigma_position; /**< its standard deviation [m]; default 1; 1e-4..1e3 */
    auvid_real_t sigma_velocity; /**< of the velocity (0 at the start) [m/s]; default 1, so that no
        first sample within `speed_limit` is gated; 1e-4..10 */
    auvid_real_t gate;           /**< largest nu^2/S of one scalar; default 16 (4 sigma); 0..1e6,
        0: no gate */
    auvid_real_t max_acceleration; /**< acceleration that the vehicle may reach, turns (v r, u r)
        included, beyond what the process noise tells [m/s2]: since its last sample that passed, dt
        ago, the DVL may have changed by agility dt more than the gate has it. Default 3; 0..100 */
    auvid_real_t speed_limit;    /**< largest |velocity| of a DVL sample [m/s]; default 3; 0..100,
        0: the 100 m/s that are refused in any case */
    auvid_real_t dvl_euler[3];   /**< phi theta psi that turn the body frame into the DVL's [rad];
        default 0 (aligned); |.| <= 10 */
    auvid_real_t dvl_lever[3];   /**< where the DVL sits, from the body's origin, body frame [m];
        default 0; |.| <= 1e3 */
    auvid_real_t density;        /**< of the water [kg/m3]; default 1025; 1..1e5 */
    auvid_real_t gravity;        /**< [m/s2]; default 9.80665; 0.1..100 */
    auvid_real_t surface_pressure; /**< pressure at depth 0 [Pa]; default 101325; 0..1e6 */
    auvid_real_t surface_depth;    /**< GPS is used where the filter's depth is at most this [m];
        default 0.5; |.| <= 1e5 */
    uint32_t dvl_max_age_us;   /**< oldest DVL sample taken [us], and furthest ahead of the last
        tick that one is held; default 500000; <= 2e6, 0: none older, none held */
    uint32_t depth_max_age_us; /**< the same for depth */
    uint32_t gps_max_age_us;   /**< the same for GPS */
    uint32_t future_us;        /**< how far a sample may be ahead of the last tick (it is then used
        as if of that tick) [us]; default 20000; <= 2e6, 0: not at all */
    uint32_t stale_us;         /**< silence after which a sensor counts as stale [us]; default
        1000000; >= 1 */
    uint32_t gap_us;           /**< tick above which auvid_nav_imu reports AUVID_GAP [us]; default
        1000000; 0: never */
    /** this many refusals by the gate in a row and the sample is taken after all, what it measures
     * started again from it; default 10; 0: never */
    uint16_t max_consecutive_rejections;
    uint8_t gps_start;         /**< fixes whose median starts the position; default 4; <=
        AUVID_NAV_GPS_START_MAX, 0: none, the first fix is an ordinary update */
} auvid_nav_config_t;

/** What became of one sensor's samples. Written by the filter, read by anyone. Each call that gets
 * past AUVID_ERR_NULL and AUVID_ERR_STATE raises exactly one of the first six counters, for a
 * sample that is held not before it is used; the 16-bit ones stop at their largest value. */
typedef struct {
    uint64_t seen_us;    /**< time of the last sample that met the gate, passed or not [us] */
    uint64_t good_us;    /**< time of the last one that passed [us] */
    uint32_t accepted;   /**< AUVID_OK and AUVID_PENDING (of a fix kept for the median) */
    uint16_t unused;     /**< AUVID_UNUSED */
    uint16_t gated;      /**< AUVID_GATED */
    uint16_t stale;      /**< AUVID_ERR_STALE, AUVID_ERR_TIME_SAME, AUVID_ERR_TIME_BACK */
    uint16_t invalid;    /**< AUVID_ERR_RANGE */
    uint16_t not_finite; /**< AUVID_ERR_NOT_FINITE */
    uint16_t resets;     /**< samples that passed although outside the gate (lockout) */
    uint16_t consecutive_rejections; /**< refused by the gate in a row, now */
    /** values in innovation and variance, 1..3; 0: no sample has met the gate */
    uint8_t innovation_count;
    bool has_sample;      /**< a sample has passed: good_us counts */
    auvid_real_t innovation[3]; /**< nu = z - H x of the last sample that met the gate [m/s or m]:
        body axes for a full DVL sample, the valid axes of the instrument in order for a part */
    auvid_real_t variance[3];   /**< S = H P H' + R of each, before any of them was used */
    auvid_real_t nis; /**< nu' S^-1 nu of that sample, all axes together; largest nu^2/S of an axis
        when it did not enter, or did so by lockout */
} auvid_nav_diagnostics_t;

/** Sine of the largest angle between a body axis and the span of the valid axes of the DVL at which
 * the axis still counts as measured: at most this part of the velocity is missing then. */
#define AUVID_NAV_MEASURED_SINE AUVID_C(0.02)

/** Velocity at a DVL sample's own time: what a recorder should take. Written by the filter. */
typedef struct {
    uint64_t t_us;            /**< the sample's time [us], strictly increasing */
    auvid_real_t velocity[3]; /**< u v w, body frame, of the body's origin [m/s] */
    uint32_t sequence;        /**< 0: none yet; raised by one with each new knot */
    uint8_t measured;         /**< bit i: the sample measured velocity[i]; else that is predicted */
} auvid_nav_velocity_sample_t;

/** Bits of auvid_nav_state_t.flags. */
enum {
    AUVID_NAV_FRESH_BOTTOM = 1 << AUVID_NAV_DVL_BOTTOM, /**< passed within stale_us */
    AUVID_NAV_FRESH_WATER = 1 << AUVID_NAV_DVL_WATER,   /**< the same, kept apart or not */
    AUVID_NAV_FRESH_DEPTH = 1 << AUVID_NAV_DEPTH,
    AUVID_NAV_FRESH_GPS = 1 << AUVID_NAV_GPS,
    AUVID_NAV_VELOCITY_KNOWN = 1 << 4, /**< a DVL sample has entered the filter */
    AUVID_NAV_DEPTH_KNOWN = 1 << 5,    /**< a depth sample has entered the filter */
    AUVID_NAV_POSITION_KNOWN = 1 << 6, /**< GPS has entered; before that x y count from the start */
    AUVID_NAV_WATER_AIDED = 1 << 7,    /**< the last velocity that entered was a water lock's */
    AUVID_NAV_IN_GAP = 1 << 8          /**< the last tick was longer than gap_us */
};

/** The filter's output. Written by auvid_nav_state(). */
typedef struct {
    uint64_t t_us;            /**< time of the last tick [us] */
    auvid_real_t position[3]; /**< x y z, NED [m] */
    auvid_real_t attitude[3]; /**< phi theta psi as measured [rad]; phi and psi unwrapped
                                   (continuous) */
    auvid_real_t velocity[3]; /**< u v w, body frame [m/s] */
    auvid_real_t rates[3];    /**< p q r as measured [rad/s] */
    uint32_t flags;           /**< AUVID_NAV_... */
} auvid_nav_state_t;

/** The filter. Its owner is the caller; `ground`, `water`, `diagnostics`, the imu_ counters and
 * `held_refused` may be read at any time, the rest through the functions; written by the functions
 * only. */
typedef struct {
    /** the filter's velocity just after the last accepted bottom lock */
    auvid_nav_velocity_sample_t ground;
    auvid_nav_velocity_sample_t
        water;               /**< velocity of the last good water lock with all axes valid */
    uint64_t horizontal_us;  /**< last bottom lock that passed and measured u and v [us] */
    uint64_t complete_us;    /**< last bottom lock that passed and measured u, v and w [us] */
    bool horizontal, complete; /**< there was one */
    auvid_nav_diagnostics_t diagnostics[AUVID_NAV_SENSOR_COUNT]; /**< by auvid_nav_sensor_t */
    uint16_t imu_time;    /**< auvid_nav_imu refused: time back or the same */
    uint16_t imu_invalid; /**< auvid_nav_imu refused: not finite or out of range */
    uint16_t imu_gaps;    /**< ticks longer than gap_us */

    uint16_t max_consecutive_rejections; /* from the configuration */
    uint8_t gps_start;           /* from the configuration; 0 once the position has started */
    uint8_t gps_count;           /* fixes collected so far */
    uint16_t flags;              /* all of auvid_nav_state_t.flags but FRESH */
    uint8_t ready;               /* 0 not initialised, 1 no tick yet, 2 running */
    uint8_t held_rejected; /**< bit i: the last accepted auvid_nav_imu() came to the held sample of
                               sensor i, and it was refused (AUVID_GATED or < 0) */
    uint8_t holding;             /* bit i: a sample of sensor i is held */
    uint8_t held_valid[AUVID_NAV_SENSOR_COUNT]; /* axes of each, if of a DVL */
    uint8_t past_next; /* index of the next rates kept; AUVID_NAV_PAST more when all are filled */
    uint64_t held_us[AUVID_NAV_SENSOR_COUNT]; /* time of each */
    uint64_t until_us;           /* no sample after this is held; 0: no such limit */
    uint64_t t_us;               /* time of the last tick */
    uint64_t last_update_us;     /* tick at which a measurement last entered */
    auvid_real_t position[3];    /* position is position + residue */
    auvid_real_t position_lo[3]; /* what position could not hold, and corrections of this tick */
    auvid_real_t velocity[3];    /* body */
    auvid_real_t pp[6];          /* covariance of position: xx xy xz yy yz zz */
    auvid_real_t pv[3][3];       /* of position (row) and velocity (column) */
    auvid_real_t vv[6];          /* of velocity: uu uv uw vv vw ww */
    auvid_real_t rotation[3][3]; /* R(phi, theta, psi) at t_us */
    auvid_real_t attitude[3];    /* as measured, not unwrapped */
    auvid_real_t rates[3];       /* p q r */
    int32_t yaw_revolutions[3];  /* whole turns to add to the attitude; theta has none */
    auvid_real_t q[3];           /* sigma^2 reference_tick [m2/s3] */
    auvid_real_t r[AUVID_NAV_SENSOR_COUNT]; /* measurement variances; water with the current's */
    auvid_real_t gate;
    auvid_real_t max_acceleration;
    auvid_real_t speed_limit;
    auvid_real_t metres_per_pascal;
    auvid_real_t surface_pressure;
    auvid_real_t surface_depth;
    auvid_real_t mount[3][3]; /* DVL frame to body frame */
    auvid_real_t lever[3];
    uint32_t max_age_us[AUVID_NAV_SENSOR_COUNT];
    uint32_t future_us;
    uint32_t stale_us;
    uint32_t gap_us;
    uint32_t past_us[AUVID_NAV_PAST]; /* ring: times of past ticks, lower halves */
    auvid_real_t past_rates[AUVID_NAV_PAST][3];          /* and their p q r */
    auvid_real_t held[AUVID_NAV_SENSOR_COUNT][3];        /* velocity, or depth, or x y */
    auvid_real_t gps_offset[2][AUVID_NAV_GPS_START_MAX]; /* fix - filter, x and y, each sorted */
} auvid_nav_t;

#define auvid_nav_defaults AUVID_SIZED0(auvid_nav_defaults)
/** Fill *config with the defaults named at its fields. Null: nothing is done. */
void auvid_nav_defaults(auvid_nav_config_t *config);

/** Make *nav ready: velocity 0, position as configured, no time yet. Also the way to start anew.
 * @param config copied; need not outlive the call.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE or AUVID_ERR_RANGE: a field is outside the
 *         range it states, *nav unchanged. */
#define auvid_nav_init AUVID_SIZED0(auvid_nav_init)
auvid_status_t auvid_nav_init(auvid_nav_t *nav, const auvid_nav_config_t *config);

#define auvid_nav_imu AUVID_SIZED0(auvid_nav_imu)
/** Predict to a new time with a new attitude (Eq. 5). The first call sets time and attitude only.
 *
 * Deviation from the paper: Q is scaled by reference_tick / t, so that an irregular tick does not
 * change the tuning.
 * @param t_us time of the IMU sample [us], later than the call before. A step is predicted in full
 *        however long it is (beyond 2147 s as 2147 s).
 *        Samples held for this time enter after the prediction, see below.
 * @param attitude phi theta psi, ZYX Euler [rad], |.| <= 1e4; phi and psi wrapped anywhere, or
 *        continuous.
 * @param rates p q r, body frame [rad/s], |.| <= 100.
 * @return AUVID_OK; AUVID_GAP: done, and the step was longer than gap_us; AUVID_ERR_NULL;
 *         AUVID_ERR_STATE: not initialised; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE;
 *         AUVID_ERR_TIME_BACK; AUVID_ERR_TIME_SAME. When refused only imu_time or imu_invalid has
 *         changed. Cost: see the top of the file. */
auvid_status_t auvid_nav_imu(auvid_nav_t *nav, uint64_t t_us, const auvid_real_t attitude[3],
                             const auvid_real_t rates[3]);

/* The measurements (Eq. 6-8). All of them share these rules.
 *
 * Time: a sample up to max_age older than the filter is used at its own time. A position is
 * compared with the filter's, carried back along its present velocity: H = [e_i, -age R_i]. For a
 * velocity the noise that came in since is taken out of the covariances (algorithm B1) where
 * nothing entered the filter since the sample was taken; that is exact while the attitude stands
 * still. Else, and where it would cost the covariance its positivity (a sample from inside a long
 * tick), the noise is taken in proportion to the covariance at hand, which cannot. A sample ahead
 * of the filter by up to future_us is used as if it were of the last tick. Samples of one sensor
 * must come in order.
 *
 * IMU later than the sensor: a sample further ahead than future_us, but by no more than max_age, is
 * held until auvid_nav_imu() reaches its time: AUVID_PENDING. It enters then as any late sample
 * does, and is counted then; held_refused says if it was refused. One sample of each sensor is
 * held. The first one stays, because a newer one in its place would never be reached where samples
 * come more often than the IMU is late: while one is held, others ahead of the filter are
 * AUVID_UNUSED, which counts the loss.
 *
 * Gate: a sample is refused as a whole when |nu| > sqrt(gate S) for any of its scalars; for a
 * velocity, sqrt(gate S) + agility dt, dt since that sensor's last sample that passed. The filter
 * knows no thrust: to it a manoeuvre looks like an outlier. After `lockout`
 * refusals in a row the last one enters all the same: what its scalars outside the gate measure is
 * set to their values with variance R (for a late velocity with the noise since), correlations 0.
 *
 * Common statuses: AUVID_OK: entered; AUVID_PENDING: held; AUVID_UNUSED: ahead, and another one is
 * held; AUVID_GATED: outside the gate, not used; AUVID_ERR_NULL; AUVID_ERR_STATE: not initialised,
 * or no auvid_nav_imu() yet; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE; AUVID_ERR_STALE: older than
 * max_age, or further ahead than both max_age and future_us;
 * AUVID_ERR_TIME_SAME, AUVID_ERR_TIME_BACK: not newer than this sensor's sample before. Whenever a
 * sample does not enter, nothing has changed but the sensor's diagnostics (and nothing at all for
 * AUVID_ERR_NULL and AUVID_ERR_STATE). */

#define auvid_nav_dvl AUVID_SIZED0(auvid_nav_dvl)
/** Correct with a DVL sample: turned into the body frame, omega x lever removed with the rates at
 * the sample's time, any subset of its axes.
 *
 * The rates of a late sample run straight between those kept: the last tick's, and AUVID_NAV_PAST
 * of ticks before, at least dvl_max_age_us / (AUVID_NAV_PAST - 1) apart (72 ms by default), so that
 * they reach back to dvl_max_age_us. For a sample from before the oldest (soon after the start, or
 * after a tick longer than 2 s) the oldest ones count. The velocity is one along the body's axes of
 * the sample's time, and so is the filter's: to it a velocity stays constant along body axes that
 * turn (Eq. 5), and no sample is turned on to the present attitude. A knot is thus along the axes
 * of its own time.
 *
 * A body axis is measured where it lies in the span of the valid axes of the instrument, to
 * AUVID_NAV_MEASURED_SINE: an instrument turned by 45 degrees with one valid axis measures none.
 *
 * Bottom lock enters the filter and sets the knot `ground`. Water lock sets the knot `water` (when
 * all axes are valid) and stays out of the filter while bottom lock is fresh: AUVID_UNUSED. When no
 * bottom lock was accepted for stale_us it enters with R + sigma_current^2, so that dead reckoning
 * goes on: AUVID_OK and flag AUVID_NAV_WATER_AIDED. Either way it must pass the gate with that
 * variance.
 * @param sample velocity: |velocity| over the valid axes <= speed_limit.
 * @return the common statuses (AUVID_ERR_RANGE: too fast, lock or valid not of their enumerations);
 *         AUVID_UNUSED: water lock kept apart, or valid == 0.
 * Cost: see the top of the file. */
auvid_status_t auvid_nav_dvl(auvid_nav_t *nav, const auvid_dvl_sample_t *sample);

#define auvid_nav_depth AUVID_SIZED0(auvid_nav_depth)
/** Correct with a depth. The first sample sets z.
 * @param t_us when it was measured [us]. @param depth_m positive down [m], |.| <= 1e5.
 * @return the common statuses. */
auvid_status_t auvid_nav_depth(auvid_nav_t *nav, uint64_t t_us, auvid_real_t depth_m);

#define auvid_nav_pressure AUVID_SIZED0(auvid_nav_pressure)
/** Correct with a pressure: auvid_nav_depth() of (pressure - surface_pressure) / (density gravity).
 * @param pressure_pa absolute [Pa]. @return as auvid_nav_depth(). */
auvid_status_t auvid_nav_pressure(auvid_nav_t *nav, uint64_t t_us, auvid_real_t pressure_pa);

#define auvid_nav_gps AUVID_SIZED0(auvid_nav_gps)
/** Correct with a GPS fix, at the surface only. Position starts from the median of the first
 * gps_start fixes, each compared with the dead-reckoned position of its time, so the vehicle may
 * move meanwhile.
 * @param x_m, y_m north and east of the origin [m], |.| <= 1e5.
 * @return the common statuses; AUVID_UNUSED: the filter's depth exceeds surface_depth;
 *         AUVID_PENDING: kept for the median. */
auvid_status_t auvid_nav_gps(auvid_nav_t *nav, uint64_t t_us, auvid_real_t x_m, auvid_real_t y_m);

#define auvid_nav_state AUVID_SIZED0(auvid_nav_state)
/** Read the state. @param state written whole.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE: no auvid_nav_imu() yet. */
auvid_status_t auvid_nav_state(const auvid_nav_t *nav, auvid_nav_state_t *state);

#define auvid_nav_covariance AUVID_SIZED0(auvid_nav_covariance)
/** Read the covariance of [x y z u v w]. @param p 6 x 6, written whole, exactly symmetric.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE: not initialised. */
auvid_status_t auvid_nav_covariance(const auvid_nav_t *nav, auvid_real_t p[6][6]);

#ifdef __cplusplus
}
#endif

#endif
