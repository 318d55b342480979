/**
 * @file types.h
 * The words every module shares: the real number, the status, degrees of freedom, the sample.
 *
 * Conventions, everywhere in auvid:
 * - World frame: NED, x north, y east, z down [m]. Depth and heave velocity are positive down.
 * - Body frame: x forward, y starboard, z down. Velocity nu = [u v w p q r] in the body frame,
 *   wrench tau = [X Y Z K M N] on the body [N, Nm] (Fossen 2011).
 * - Attitude: ZYX Euler angles phi, theta, psi [rad].
 * - Parameters carry the paper's signs: X_u, X_uu < 0 dissipate; W-B > 0 sinks; masses are total
 *   (rigid body and added mass).
 * - Time is an unsigned 64-bit count of microseconds that comes in with the data; differences are
 *   formed in integers. auvid reads no clock.
 *
 * Calling rules: the caller owns every struct; no function keeps a pointer unless it says so; two
 * instances never interact; nothing here may be called from an interrupt.
 */
#ifndef AUVID_TYPES_H
#define AUVID_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "auvid/config.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The real number of all interfaces. float by default; double with AUVID_REAL_DOUBLE. */
#ifdef AUVID_REAL_DOUBLE
typedef double auvid_real_t;
#define AUVID_C(literal) literal
#define AUVID_EPSILON 2.220446049250313e-16
#define AUVID_LARGEST 1.7976931348623157e308
#else
typedef float auvid_real_t;
/** A literal in auvid_real_t: AUVID_C(0.5). */
#define AUVID_C(literal) literal##f
/** Distance from 1 to the next larger number. */
#define AUVID_EPSILON 1.1920929e-7f
/** Largest finite number. */
#define AUVID_LARGEST 3.4028235e38f
#endif

#define AUVID_PI AUVID_C(3.14159265358979323846)

/** Degrees of freedom, the index into every nu, tau and per-DoF array. */
typedef enum {
    AUVID_SURGE = 0, /**< u [m/s], X [N] */
    AUVID_SWAY = 1,  /**< v [m/s], Y [N] */
    AUVID_HEAVE = 2, /**< w [m/s], Z [N] */
    AUVID_ROLL = 3,  /**< p [rad/s], K [Nm] */
    AUVID_PITCH = 4, /**< q [rad/s], M [Nm] */
    AUVID_YAW = 5,   /**< r [rad/s], N [Nm] */
    AUVID_DOF_COUNT = 6
} auvid_dof_t;

/**
 * What a function did. 0: done. > 0: done, with news. < 0: refused, and nothing was changed: state
 * and outputs are as before the call, unless the function says otherwise. Each function lists the
 * exact set it returns.
 */
typedef enum {
    AUVID_OK = 0,               /**< done */
    AUVID_PENDING = 1,          /**< more work remains: call again */
    AUVID_FINISHED = 2,         /**< the procedure has come to its end */
    AUVID_EMPTY = 3,            /**< there is nothing to take */
    AUVID_GAP = 4,              /**< the record was broken here and starts anew */
    AUVID_SET_COMPLETE = 5,     /**< a data set was closed by this sample */
    AUVID_GATED = 6,            /**< measurement refused by the innovation gate */
    AUVID_UNUSED = 7,           /**< measurement valid but not usable now (GPS under water, ...) */
    AUVID_SATURATED = 8,        /**< limited to what the thrusters can give, or a frame can carry */
    AUVID_EVALUATION_LIMIT = 9, /**< stopped at a cap before its own criterion was met */
    AUVID_TICK = 10,            /**< a control tick has opened: step */
    AUVID_SET_IDLE = 11,       /**< a data set was closed and left out: no DoF with a free parameter
                                  was driven in it */
    AUVID_ERR_NULL = -1,       /**< a required pointer is null */
    AUVID_ERR_NOT_FINITE = -2, /**< a value is NaN or infinite */
    AUVID_ERR_TIME_BACK = -3,  /**< time went back */
    AUVID_ERR_TIME_SAME = -4,  /**< time did not advance (zero dt) */
    AUVID_ERR_STALE = -5,      /**< sample older than the stated age, or from the future */
    AUVID_ERR_RANGE = -6,      /**< a value or configuration field is outside its stated range */
    AUVID_ERR_BOUNDS = -7,     /**< lower bound not below upper bound */
    AUVID_ERR_POPULATION = -8, /**< m < n + 1, or m > AUVID_MAX_POPULATION */
    AUVID_ERR_PARAMETERS = -9, /**< no parameter, or more than AUVID_MAX_PARAMETERS */
    AUVID_ERR_SIZE = -10,      /**< something else exceeds a size in config.h */
    AUVID_ERR_STATE = -11,     /**< call out of order (tell without ask, not initialised, ...) */
    AUVID_ERR_NO_DATA = -12,   /**< no rows to work on: empty set, no DoF driven */
    AUVID_ERR_SINGULAR = -13,  /**< the data or the matrix do not determine the answer */
    AUVID_ERR_LIMIT = -14,     /**< more is asked for than the thrusters can give, a limit of the
                                     guard allows, or a queue can take */
    AUVID_ERR_ARITHMETIC = -15, /**< selftest: this machine's arithmetic is not auvid's */
    AUVID_ERR_MODEL = -16,      /**< the vehicle model lacks what is asked of it */
    AUVID_ERR_LENGTH = -17,     /**< a frame has not the length of its message */
    AUVID_ERR_CHECKSUM = -18,   /**< a frame's checksum is wrong */
    AUVID_ERR_DRY_MASS = -19    /**< the dry mass is not below the upper bound of a mass */
} auvid_status_t;

/** Short English sentence for a status; never null. "unknown status" for others. Cost: constant. */
const char *auvid_status_str(auvid_status_t status);

/**
 * One grid cell of the record: the motion and the wrench, averaged over the same interval. This is
 * what vehicle models see. Written by the recorder (recorder.h) or by the user's own code.
 */
typedef struct {
    uint64_t t_us;                             /**< middle of the interval [us] */
    auvid_real_t phi, theta, psi;              /**< roll, pitch, yaw [rad]; yaw unwrapped */
    auvid_real_t nu[AUVID_DOF_COUNT];          /**< u v w [m/s] p q r [rad/s], through the water */
    auvid_real_t nu_dot[AUVID_DOF_COUNT];      /**< their time derivatives [m/s2, rad/s2] */
    auvid_real_t tau[AUVID_DOF_COUNT];         /**< applied wrench X Y Z [N] K M N [Nm] */
    auvid_real_t command[AUVID_MAX_COMMANDS];  /**< applied thruster commands, user's unit */
    uint8_t missing; /**< bit j: nu[j] and nu_dot[j] were not measured here; 0: all were */
} auvid_sample_t;

/** Is x neither NaN nor infinite? Needs no library; not defeated by compiler flags we accept. */
static inline bool auvid_is_finite(auvid_real_t x)
{
    return x - x <= AUVID_C(0.0); /* else NaN */
}

#ifdef __cplusplus
}
#endif

#endif
