/**
 * @file nav.h
 * Navigation: an extended Kalman filter for position and body velocity from IMU, DVL, depth, GPS.
 *
 * The filter is that of the paper's section II-B. Its state is [x y z u v w]: position in the world
 * frame, velocity in the body frame. The model is constant velocity with white accelerations.
 * Attitude and rates are taken from the IMU without filtering. For real sensors it adds:
 * - irregular and late samples, and any subset of the sensors;
 * - an innovation gate with re-initialisation after repeated rejections;
 * - DVL mounting, bottom lock and water lock as separate sensors;
 * - GPS at the surface only;
 * - counters of rejected samples by cause.
 *
 * Call auvid_nav_imu() once a tick, then one function for each sample received since, in any order.
 * Then read auvid_nav_state(). Identification uses the velocity samples `ground` and `water`, at
 * the DVL's own times: between DVL updates a constant-velocity filter lags by a tenth of a second.
 *
 * Cost: constant, no iteration. Instructions on a Cortex-M4F at -O2: a tick 0.58k, a depth 0.34k, a
 * complete DVL sample at the filter's time 0.52k. Late samples: a depth 0.9k, a DVL sample 1.9k,
 * or 4.4k if no update was applied since its timestamp. Memory: auvid_nav_t, AUVID_NAV_BYTES in
 * float.
 *
 * Numerics: position is a sum of two floats (plain float32 drifts by 1 mm at 120 m). The covariance
 * is stored as three 3x3 blocks; the two symmetric ones hold only their upper half, so symmetry
 * cannot be lost. Measurements are applied one scalar at a time; a complete DVL sample at the
 * filter's time is applied at once.
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

/** Largest number of GPS fixes whose median initialises the position. */
#define AUVID_NAV_GPS_START_MAX 8

/** Upper bound of sizeof(auvid_nav_t) when auvid_real_t is float; a test checks it. */
#define AUVID_NAV_BYTES 1024

/** Largest difference of a quaternion's length from 1. */
#define AUVID_NAV_QUATERNION_TOLERANCE AUVID_C(0.01)

/** Number of past ticks whose rates are stored for late DVL samples, a power of two. */
#define AUVID_NAV_PAST 8

/** The sensors that correct the filter; index into auvid_nav_t.diagnostics. */
typedef enum {
    AUVID_NAV_DVL_BOTTOM = 0, /**< DVL, velocity over ground */
    AUVID_NAV_DVL_WATER = 1,  /**< DVL, velocity through the water */
    AUVID_NAV_DEPTH = 2,      /**< depth or pressure */
    AUVID_NAV_GPS = 3,        /**< horizontal position */
    AUVID_NAV_SENSOR_COUNT = 4
} auvid_nav_sensor_t;

/** Reference of a DVL sample. */
typedef enum {
    AUVID_DVL_BOTTOM = 0, /**< the sea bottom: velocity over ground */
    AUVID_DVL_WATER = 1   /**< a layer of water: velocity through the water */
} auvid_dvl_lock_t;

/** Bits of auvid_dvl_sample_t.valid, one for each axis of the instrument. */
enum { AUVID_DVL_X = 1, AUVID_DVL_Y = 2, AUVID_DVL_Z = 4, AUVID_DVL_ALL = 7 };

/** One DVL sample as output by the instrument. Written by the caller. */
typedef struct {
    uint64_t t_us;            /**< time of measurement (not of arrival) [us] */
    auvid_real_t velocity[3]; /**< in the instrument's frame [m/s]; axes without their bit in
                                   `valid` are not read and may be NaN */
    auvid_dvl_lock_t lock;    /**< bottom or water */
    uint8_t valid;            /**< AUVID_DVL_X | AUVID_DVL_Y | AUVID_DVL_Z; 0: no lock */
} auvid_dvl_sample_t;

/** How the instruments are mounted. */
typedef struct {
    auvid_real_t imu_euler[3]; /**< phi theta psi of the rotation from the body frame to the IMU's
        frame [rad]; |.| <= 10 */
    auvid_real_t dvl_euler[3]; /**< phi theta psi of the rotation from the body frame to the DVL's
        frame [rad]; |.| <= 10 */
    auvid_real_t dvl_lever[3]; /**< position of the DVL from the body's origin, body frame [m];
        |.| <= 1e3 */
} auvid_nav_mount_t;

/** Configuration. Fill with auvid_nav_defaults(), then change individual fields. Within the stated
 * ranges single precision keeps all variances positive, if sigma_position is at least 1e-3 s times
 * sigma_velocity, and ticks are at most a second apart (with the default sigma_acceleration: at any
 * interval). */
typedef struct {
    auvid_real_t sigma_acceleration[3]; /**< process noise n_u n_v n_w of Eq. 5 at ticks of
        `reference_tick` [m/s2]; default 1 (gain of a DVL update >= 0.96); 1e-4..100 */
    auvid_real_t reference_tick; /**< tick to which sigma_acceleration refers [s]; default 0.02;
        1e-4..10. The velocity variance grows by sigma^2 reference_tick per second at any tick. */
    auvid_real_t sigma_dvl;      /**< noise of each DVL axis [m/s]; default 0.007; 1e-4..1e3 */
    auvid_real_t sigma_current;  /**< standard deviation of the current, added when water lock
        replaces bottom lock [m/s]; default 0.3; 0..1e3, 0: still water */
    auvid_real_t sigma_depth;    /**< noise of depth [m]; default 0.015; 1e-3..1e3 */
    auvid_real_t sigma_gps;      /**< noise of each GPS axis [m]; default 1.5; 1e-3..1e3 */
    auvid_real_t position[3];    /**< initial position, NED [m]; default 0; |.| <= 1e5 */
    auvid_real_t sigma_position; /**< its standard deviation [m]; default 1; 1e-4..1e3 */
    auvid_real_t sigma_velocity; /**< standard deviation of the initial velocity, which is 0 [m/s];
        default 1, so that no first sample within `speed_limit` is gated; 1e-4..10 */
    auvid_real_t gate;           /**< largest nu^2/S of one scalar; default 16 (4 sigma); 0..1e6,
        0: no gate */
    auvid_real_t max_acceleration; /**< largest acceleration of the vehicle, including rotation
        (v r, u r), in addition to the process noise [m/s2]. The DVL gate widens by
        max_acceleration dt, dt since its last accepted sample. Default 3; 0..100 */
    auvid_real_t speed_limit;      /**< largest |velocity| of a DVL sample [m/s]; default 3; 0..100,
        0: 100 m/s, above which samples are always rejected */
    auvid_nav_mount_t mount;       /**< of the IMU and the DVL; default 0 (aligned) */
    auvid_real_t density;          /**< of the water [kg/m3]; default 1025; 1..1e5 */
    auvid_real_t gravity;          /**< [m/s2]; default 9.80665; 0.1..100 */
    auvid_real_t surface_pressure; /**< pressure at depth 0 [Pa]; default 101325; 0..1e6 */
    auvid_real_t surface_depth;    /**< once a depth was measured, GPS is used only if the filter's
        depth is at most this [m]; default 0.5; |.| <= 1e5 */
    uint32_t dvl_max_age_us;   /**< age of the oldest accepted DVL sample, and longest time ahead of
        the last tick for which a sample is held [us]; default 500000; <= 2e6, 0: no late sample is
        accepted, none is held */
    uint32_t depth_max_age_us; /**< the same for depth */
    uint32_t gps_max_age_us;   /**< the same for GPS */
    uint32_t future_us;        /**< largest time of a sample ahead of the last tick; the sample is
        then used as if it were of that tick [us]; default 20000; <= 2e6, 0: none */
    uint32_t stale_us;         /**< time without an accepted sample after which a sensor is stale
        [us]; default 1000000; >= 1 */
    uint32_t gap_us;           /**< tick above which auvid_nav_imu() returns AUVID_GAP [us]; default
        1000000; 0: never */
    /** After this many consecutive rejections by the gate the sample is applied and the components
     * that it measures are re-initialised from it; default 10; 0: never. */
    uint16_t max_consecutive_rejections;
    uint8_t gps_start; /**< number of fixes whose median initialises the position; default
        4; <= AUVID_NAV_GPS_START_MAX, 0: the first fix is an ordinary update */
} auvid_nav_config_t;

/** Statistics of one sensor. Written by the filter, read by anyone. Each call that does not return
 * AUVID_ERR_NULL or AUVID_ERR_STATE increments exactly one of the counters `accepted` to
 * `not_finite`; a held sample is counted when it is used. The 16-bit counters saturate. */
typedef struct {
    uint64_t seen_us; /**< time of the last sample tested by the gate, accepted or not [us] */
    uint64_t good_us; /**< time of the last accepted sample [us] */
    auvid_real_t innovation[3]; /**< nu = z - H x of the last sample tested by the gate [m/s or m]:
        body axes for a complete DVL sample, the valid axes of the instrument in order for a partial
        one */
    auvid_real_t variance[3];   /**< S = H P H' + R of each, before any of them is applied */
    auvid_real_t nis;  /**< nu' S^-1 nu of that sample, all axes together; largest nu^2/S of an axis
        if the sample was not applied, or was applied as a re-initialisation */
    uint32_t accepted; /**< AUVID_OK and AUVID_PENDING (of a fix stored for the median) */
    uint16_t unused;   /**< AUVID_UNUSED */
    uint16_t gated;    /**< AUVID_GATED */
    uint16_t stale;    /**< AUVID_ERR_STALE, AUVID_ERR_TIME_SAME, AUVID_ERR_TIME_BACK */
    uint16_t invalid;  /**< AUVID_ERR_RANGE */
    uint16_t not_finite;             /**< AUVID_ERR_NOT_FINITE */
    uint16_t resets;                 /**< re-initialisations after max_consecutive_rejections */
    uint16_t consecutive_rejections; /**< current number of consecutive rejections by the gate */
    uint8_t innovation_count;        /**< values in innovation and variance, 1..3; 0: no sample was
                                          tested by the gate yet */
    bool has_sample;                 /**< a sample was accepted: good_us is valid */
#ifdef AUVID_REAL_DOUBLE
    uint8_t reserved[4];
#endif
} auvid_nav_diagnostics_t;

/** Sine of the largest angle between a body axis and the span of the valid DVL axes at which the
 * axis counts as measured. At most this fraction of the velocity is then missing. */
#define AUVID_NAV_MEASURED_SINE AUVID_C(0.02)

/** Velocity sample: velocity at the time of a DVL sample, the input of a recorder. Written by the
 * filter. */
typedef struct {
    uint64_t t_us;            /**< time of the DVL sample [us], strictly increasing */
    auvid_real_t velocity[3]; /**< u v w, body frame, of the body's origin [m/s] */
    uint32_t sequence;        /**< number of velocity samples so far; 0: none yet */
    uint8_t measured;         /**< bit i: velocity[i] was measured; else it is predicted */
    uint8_t reserved[AUVID_GAP(8, 3 * sizeof(auvid_real_t) + 5)]; /**< 0 */
} auvid_nav_velocity_sample_t;

/** Bit of auvid_nav_state_t.flags: a sample of this sensor was accepted within stale_us. Sensors
 * from the fifth on have the bits from 16 on, which the frame nav_position does not carry. */
#define AUVID_NAV_FRESH(sensor) (1u << ((sensor) < 4 ? (sensor) : (sensor) + 12))

/** Bits of auvid_nav_state_t.flags. */
enum {
    AUVID_NAV_FRESH_BOTTOM = 1 << AUVID_NAV_DVL_BOTTOM, /**< accepted within stale_us */
    AUVID_NAV_FRESH_WATER = 1 << AUVID_NAV_DVL_WATER,   /**< the same, applied or not */
    AUVID_NAV_FRESH_DEPTH = 1 << AUVID_NAV_DEPTH,
    AUVID_NAV_FRESH_GPS = 1 << AUVID_NAV_GPS,
    AUVID_NAV_VELOCITY_KNOWN = 1 << 4, /**< a DVL sample was applied */
    AUVID_NAV_DEPTH_KNOWN = 1 << 5,    /**< a depth sample was applied */
    AUVID_NAV_POSITION_KNOWN = 1 << 6, /**< a GPS fix was applied; until then x y are dead
                                            reckoned from the start */
    AUVID_NAV_WATER_AIDED = 1 << 7,    /**< the last applied velocity was from water lock */
    AUVID_NAV_IN_GAP = 1 << 8,         /**< the last tick was longer than gap_us */
    AUVID_NAV_FLAG_END                 /**< the last flag + 1; no flag */
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

/** The configuration, prepared. Private. */
typedef struct {
    auvid_real_t q[3];                      /* sigma^2 reference_tick [m2/s3] */
    auvid_real_t r[AUVID_NAV_SENSOR_COUNT]; /* measurement variances; water: with current */
    auvid_real_t gate;
    auvid_real_t max_acceleration;
    auvid_real_t speed_limit;
    auvid_real_t metres_per_pascal;
    auvid_real_t surface_pressure;
    auvid_real_t surface_depth;
    auvid_real_t mount[3][3];     /* DVL frame to body frame */
    auvid_real_t imu_mount[3][3]; /* IMU frame to body frame */
    auvid_real_t lever[3];
    uint32_t max_age_us[AUVID_NAV_SENSOR_COUNT];
    uint32_t future_us;
    uint32_t stale_us;
    uint32_t gap_us;
    uint16_t max_consecutive_rejections;
    bool imu_turned; /* imu_mount is not the identity */
} auvid_nav_prepared_t;

/** Samples ahead of the filter, one for each sensor. */
typedef struct {
    uint64_t t_us[AUVID_NAV_SENSOR_COUNT];
    uint64_t until_us;                             /* none after this is held; 0: no such limit */
    auvid_real_t value[AUVID_NAV_SENSOR_COUNT][3]; /* velocity, or depth, or x y */
    uint8_t valid[AUVID_NAV_SENSOR_COUNT];         /* valid axes, if of a DVL */
    uint8_t sensors;                               /* bit i: a sample of sensor i is held */
    uint8_t rejected; /**< bit i: the last accepted auvid_nav_imu() released the sample of sensor i,
                           and the filter rejected it (AUVID_GATED or < 0) */
    uint8_t reserved[AUVID_GAP(8, 3 * AUVID_NAV_SENSOR_COUNT * sizeof(auvid_real_t) +
                                      AUVID_NAV_SENSOR_COUNT + 2)];
} auvid_nav_held_t;

/** What auvid_nav_imu() supplied: the last tick, and the rates of past ticks. */
typedef struct {
    uint64_t t_us;                              /* time of the last tick */
    auvid_real_t rotation[3][3];                /* R(phi, theta, psi) at t_us */
    auvid_real_t attitude[3];                   /* as measured, not unwrapped */
    auvid_real_t rates[3];                      /* p q r */
    auvid_real_t past_rates[AUVID_NAV_PAST][3]; /* ring: p q r of past ticks */
    int32_t revolutions[3];           /* revolutions to add to phi and psi; theta has none */
    uint32_t past_us[AUVID_NAV_PAST]; /* times of the ring, lower halves */
    uint16_t stale;                   /**< rejected: time not increasing */
    uint16_t invalid;                 /**< rejected: not finite or out of range */
    uint16_t gaps;                    /**< ticks longer than gap_us */
    uint8_t past_next; /* index of the next stored rates; plus AUVID_NAV_PAST once all are filled */
    uint8_t ready;     /* 0 not initialised, 1 no tick yet, 2 running */
#ifdef AUVID_REAL_DOUBLE
    uint8_t reserved[4];
#endif
} auvid_nav_ticks_t;

/** State and covariance of the filter. Private. */
typedef struct {
    uint64_t updated_us;         /* tick at which a measurement was last applied */
    auvid_real_t position[3];    /* the position is position + position_lo */
    auvid_real_t position_lo[3]; /* compensation term, and corrections of this tick */
    auvid_real_t velocity[3];    /* body */
    auvid_real_t pp[6];          /* covariance of position: xx xy xz yy yz zz */
    auvid_real_t pv[3][3];       /* of position (row) and velocity (column) */
    auvid_real_t vv[6];          /* of velocity: uu uv uw vv vw ww */
} auvid_nav_ekf_t;

/** The first GPS fixes, whose median initialises the position. Private. */
typedef struct {
    auvid_real_t offset[2][AUVID_NAV_GPS_START_MAX]; /* fix - filter, x and y, each sorted */
    uint8_t start; /* as configured; 0 once the position is initialised */
    uint8_t count; /* fixes collected so far */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), 2)];
} auvid_nav_gps_start_t;

/** The filter. The caller owns it; only the functions below write it. `ground`, `water`,
 * `horizontal`, `complete` and their times, `diagnostics`, `held.rejected` and the counters of
 * `imu` may be read at any time. All other fields are private. */
typedef struct {
    auvid_nav_prepared_t cfg;
    /* state: from here on, see checkpoint.h */
    auvid_nav_velocity_sample_t ground; /**< the filter's velocity just after the last accepted
                                             bottom lock */
    auvid_nav_velocity_sample_t water;  /**< velocity of the last accepted water lock with all axes
                                             valid */
    auvid_nav_diagnostics_t diagnostics[AUVID_NAV_SENSOR_COUNT]; /**< by auvid_nav_sensor_t */
    uint64_t horizontal_us; /**< last accepted bottom lock that measured u and v [us] */
    uint64_t complete_us;   /**< last accepted bottom lock that measured u, v and w [us] */
    auvid_nav_held_t held;
    auvid_nav_ticks_t imu;
    auvid_nav_ekf_t ekf;
    uint16_t flags;            /* all of auvid_nav_state_t.flags but FRESH */
    bool horizontal, complete; /**< horizontal_us, complete_us are valid */
#ifdef AUVID_REAL_DOUBLE
    uint8_t reserved[4];
#endif
    auvid_nav_gps_start_t gps;
} auvid_nav_t;

#define auvid_nav_defaults AUVID_SIZED0(auvid_nav_defaults)
/** Fill *cfg with the defaults stated at its fields.
 * @param cfg written whole; NULL is a no-op. */
void auvid_nav_defaults(auvid_nav_config_t *cfg);

#define auvid_nav_init AUVID_SIZED0(auvid_nav_init)
/** Initialise or restart *nav: velocity 0, position as configured, no time yet.
 * @param nav written whole.
 * @param cfg copied; need not outlive the call.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE or AUVID_ERR_RANGE if a field is outside
 *         its stated range. On an error *nav is unchanged. */
auvid_status_t auvid_nav_init(auvid_nav_t *nav, const auvid_nav_config_t *cfg);

#define auvid_nav_imu AUVID_SIZED0(auvid_nav_imu)
/** Predict to a new time with a new attitude (Eq. 5). The first call sets time and attitude only.
 * If mount.imu_euler is not zero, attitude and rates are turned to the body frame first:
 * R = R_imu M', omega = M omega_imu, M the rotation from the IMU's frame to the body's.
 *
 * Deviation from the paper: Q is scaled by reference_tick / t, so that the tuning does not depend
 * on the tick. After the prediction the function applies the held samples whose time is reached,
 * see below.
 * @param t_us time of the IMU sample [us], later than that of the previous call. The prediction
 *        covers the whole step; a step beyond 2147 s counts as 2147 s.
 * @param attitude phi theta psi of the IMU, ZYX Euler [rad], together of length <= 1e4; phi
 *        and psi wrapped anywhere, or continuous.
 * @param rates p q r, the IMU's frame [rad/s], together of length <= 100.
 * @return AUVID_OK; AUVID_GAP if the step was predicted and was longer than gap_us; AUVID_ERR_NULL;
 *         AUVID_ERR_STATE if not initialised; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE;
 *         AUVID_ERR_TIME_BACK; AUVID_ERR_TIME_SAME. On an error only imu.stale or imu.invalid
 *         changes. Cost: see the top of the file. */
auvid_status_t auvid_nav_imu(auvid_nav_t *nav, uint64_t t_us, const auvid_real_t attitude[3],
                             const auvid_real_t rates[3]);

#define auvid_nav_imu_quaternion AUVID_SIZED0(auvid_nav_imu_quaternion)
/** auvid_nav_imu() with the attitude as a quaternion. An IMU whose x axis is near the vertical
 * while the body is level has no usable Euler angles: use this function for it.
 * @param quaternion w x y z (w the scalar part), of the rotation from the IMU's frame to NED;
 *        length 1 within AUVID_NAV_QUATERNION_TOLERANCE, normalised here. Its sign has no meaning.
 * @return as auvid_nav_imu(); AUVID_ERR_RANGE also for another length. Cost: three arctangents
 *         more than auvid_nav_imu(). */
auvid_status_t auvid_nav_imu_quaternion(auvid_nav_t *nav, uint64_t t_us,
                                        const auvid_real_t quaternion[4],
                                        const auvid_real_t rates[3]);

/* The measurements (Eq. 6-8). All of them share these rules.
 *
 * Time: a sample up to max_age older than the filter is used at its own time. The filter
 * extrapolates its position back along its current velocity: H = [e_i, -age R_i]. For a velocity it
 * removes from the covariances the process noise since the sample (algorithm B1), if no update was
 * applied since the sample's timestamp; this is exact while the attitude is constant. Otherwise it
 * removes a fraction of the covariance, which keeps it positive. It also does so if B1 would make
 * the covariance indefinite (a sample from inside a long tick). A sample up to future_us ahead of
 * the filter is used as if it were of the last tick. Samples of one sensor must come in order.
 *
 * IMU later than the sensor: a sample more than future_us ahead, but at most max_age, is held until
 * auvid_nav_imu() reaches its time; the function returns AUVID_PENDING. The sample is then applied
 * and counted like any late sample; held.rejected is set if the filter rejects it. One sample of
 * each sensor is held, and a newer one does not replace it. If samples come more often than the IMU
 * is late, a replaced sample would never be reached. While one is held, other samples ahead of the
 * filter are AUVID_UNUSED, which counts the loss.
 *
 * Gate: a sample is rejected as a whole if |nu| > sqrt(gate S) for any of its scalars. For a
 * velocity the limit is sqrt(gate S) + max_acceleration dt, dt since the last accepted sample of
 * that sensor: the filter does not know the thrust, so a manoeuvre looks like an outlier. After
 * max_consecutive_rejections rejections the last sample is applied. Its scalars outside the gate
 * then re-initialise what they measure: value and variance R (for a late velocity plus the noise
 * since), correlations 0.
 *
 * A sample that is not applied changes only the diagnostics of its sensor. AUVID_ERR_NULL and
 * AUVID_ERR_STATE change nothing. */

#define auvid_nav_update AUVID_SIZED0(auvid_nav_update)
/** Correct with a sample of any sensor. The functions below call it.
 * @param sensor DVL: see auvid_nav_dvl(); DEPTH, GPS: see auvid_nav_depth(), auvid_nav_gps().
 * @param t_us time of measurement [us].
 * @param value the sensor's axes: velocity [3] of a DVL [m/s], depth [1], north and east [2] of a
 *        GPS [m], |.| <= 1e5.
 * @param valid of a DVL: its axes, AUVID_DVL_X | ...; else not read.
 * @return as auvid_nav_depth, as auvid_nav_dvl, as auvid_nav_gps; AUVID_ERR_RANGE, not counted, if
 *         there is no such sensor. Cost: see the top of the file. */
auvid_status_t auvid_nav_update(auvid_nav_t *nav, auvid_nav_sensor_t sensor, uint64_t t_us,
                                const auvid_real_t *value, unsigned valid);

#define auvid_nav_dvl AUVID_SIZED0(auvid_nav_dvl)
/** Correct with a DVL sample, with any subset of its axes. The function rotates it into the body
 * frame and subtracts omega x lever, with the rates at the sample's time.
 *
 * The rates of a late sample are interpolated linearly between stored ones: those of the last tick
 * and of AUVID_NAV_PAST earlier ticks. The stored ones are at least
 * dvl_max_age_us / (AUVID_NAV_PAST - 1) apart (72 ms by default), so that they reach back to
 * dvl_max_age_us. A sample older than all of them (soon after the start, or after a tick longer
 * than 2 s) uses the oldest. The velocity is along the body axes of the sample's time. In the model
 * a velocity is constant along the rotating body axes (Eq. 5), so no sample is rotated to the
 * current attitude. A velocity sample is thus along the axes of its own time.
 *
 * A body axis is measured if it lies in the span of the valid axes of the instrument, to within
 * AUVID_NAV_MEASURED_SINE: an instrument turned by 45 degrees with one valid axis measures none.
 *
 * Bottom lock is applied and sets the velocity sample `ground`. Water lock with all axes valid sets
 * the velocity sample `water`. Water lock is not applied while bottom lock is fresh: AUVID_UNUSED.
 * If no bottom lock was accepted for stale_us, water lock is applied with R + sigma_current^2, so
 * that dead reckoning continues: AUVID_OK and flag AUVID_NAV_WATER_AIDED. In both cases it must
 * pass the gate with that variance.
 * @param sample velocity: |velocity| over the valid axes <= speed_limit.
 * @return as auvid_nav_depth; AUVID_ERR_RANGE: too fast, or lock or valid outside its enumeration;
 *         AUVID_UNUSED also if valid == 0 or water lock is not applied.
 * Cost: see the top of the file. */
auvid_status_t auvid_nav_dvl(auvid_nav_t *nav, const auvid_dvl_sample_t *sample);

#define auvid_nav_depth AUVID_SIZED0(auvid_nav_depth)
/** Correct with a depth. The first sample sets z.
 * @param t_us time of measurement [us].
 * @param depth_m positive down [m], |.| <= 1e5.
 * @return AUVID_OK: applied; AUVID_PENDING: held; AUVID_UNUSED: ahead of the filter while another
 *         sample is held; AUVID_GATED: outside the gate, not applied; AUVID_ERR_NULL;
 *         AUVID_ERR_STATE: not initialised, or no auvid_nav_imu() yet; AUVID_ERR_NOT_FINITE;
 *         AUVID_ERR_RANGE; AUVID_ERR_STALE: older than max_age, or further ahead than both max_age
 *         and future_us; AUVID_ERR_TIME_SAME, AUVID_ERR_TIME_BACK: not newer than the previous
 *         sample of this sensor. */
auvid_status_t auvid_nav_depth(auvid_nav_t *nav, uint64_t t_us, auvid_real_t depth_m);

#define auvid_nav_pressure AUVID_SIZED0(auvid_nav_pressure)
/** Correct with a pressure: auvid_nav_depth() of (pressure - surface_pressure) / (density gravity).
 * @param t_us time of measurement [us].
 * @param pressure_pa absolute [Pa].
 * @return as auvid_nav_depth. */
auvid_status_t auvid_nav_pressure(auvid_nav_t *nav, uint64_t t_us, auvid_real_t pressure_pa);

#define auvid_nav_gps AUVID_SIZED0(auvid_nav_gps)
/** Correct with a GPS fix, at the surface only. The median of the first gps_start fixes initialises
 * the position. Each of them is compared with the dead-reckoned position at its time, so the
 * vehicle may move meanwhile.
 * @param t_us time of measurement [us].
 * @param x_m, y_m north and east of the origin [m], |.| <= 1e5.
 * @return as auvid_nav_depth; AUVID_UNUSED also if a depth was measured and the filter's depth
 *         exceeds surface_depth; AUVID_PENDING also if the fix is stored for the median. */
auvid_status_t auvid_nav_gps(auvid_nav_t *nav, uint64_t t_us, auvid_real_t x_m, auvid_real_t y_m);

#define auvid_nav_state AUVID_SIZED0(auvid_nav_state)
/** Read the state.
 * @param state written whole; untouched on an error.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE: no auvid_nav_imu() yet. */
auvid_status_t auvid_nav_state(const auvid_nav_t *nav, auvid_nav_state_t *state);

#define auvid_nav_covariance AUVID_SIZED0(auvid_nav_covariance)
/** Read the covariance of [x y z u v w].
 * @param p 6 x 6, written whole, exactly symmetric; untouched on an error.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE: not initialised. */
auvid_status_t auvid_nav_covariance(const auvid_nav_t *nav, auvid_real_t p[6][6]);

/* Configuration of the recorder, which follows the filter (detail/recorder.h). */

/** Largest accepted magnitude, in any unit. A larger value is a fault; in single precision its
 * square would dominate the data set. */
#define AUVID_RECORDER_LARGEST AUVID_C(1e9)

/** velocity_us: the period of the velocity samples is observed, see detail/recorder.h. */
#define AUVID_VELOCITY_OBSERVED UINT32_MAX

/** Interpolation of the applied wrench between its samples. */
typedef enum {
    AUVID_INPUT_HOLD = 0,  /**< constant until the next sample (command, thrust of a tick) */
    AUVID_INPUT_LINEAR = 1 /**< linear between samples (a measured force) */
} auvid_input_mode_t;

/** Configuration; copied by auvid_recorder_init(). */
typedef struct {
    uint32_t cell_us;     /**< cell length [us]; 1000..1000000, default 100000 */
    uint32_t gap_us;      /**< longest time between samples of a stream [us]; >= cell_us,
                                 <= 1e9. Default 0: auvid_recorder_gap() of velocity_us, 1 s for a
                                 DVL at 5 Hz, 1.5 s for one at 1 Hz */
    uint32_t velocity_us; /**< period of the velocity samples [us], or AUVID_VELOCITY_OBSERVED;
                                 only gap_us depends on it. Default 0; in the identifier the
                                 metric's */
    uint8_t input;        /**< auvid_input_mode_t; default AUVID_INPUT_HOLD */
} auvid_recorder_config_t;

#ifdef __cplusplus
}
#endif

#endif
