/**
 * @file types.h
 * Types that every module uses: the real number, the status, degrees of freedom, the sample.
 *
 * Conventions, everywhere in auvid:
 * - World frame: NED, x north, y east, z down [m]. Depth and heave velocity are positive down.
 * - Body frame: x forward, y starboard, z down. Velocity nu = [u v w p q r] in the body frame,
 *   wrench tau = [X Y Z K M N] on the body [N, Nm] (Fossen 2011).
 * - Attitude: ZYX Euler angles phi, theta, psi [rad].
 * - Parameters have the paper's signs: drag with X_u, X_uu < 0 dissipates; a vehicle with W-B > 0
 *   sinks. Masses are total: rigid body plus added mass.
 * - Time is an unsigned 64-bit count of microseconds that the caller passes with the data. auvid
 *   reads no clock. It forms differences of times in integers.
 *
 * Calling rules: The caller owns every struct. No function keeps a pointer unless it says so. Two
 * instances never interact. Only the functions that can.h lists may be called from an interrupt.
 */
#ifndef AUVID_TYPES_H
#define AUVID_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "auvid/config.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The real number type of all interfaces: float, or double with AUVID_REAL_DOUBLE. */
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

/** Bytes that fill up a multiple of `unit` after this many bytes: 1..unit. State has no gaps that a
 * compiler leaves (checkpoint.h), so reserved bytes fill it. */
#define AUVID_GAP(unit, bytes) ((unit) - (bytes) % (unit))

/** So many bytes, or a few more, fill up whole reals. */
#define AUVID_FILLED(bytes)                                                                        \
    (((bytes) + sizeof(auvid_real_t) - 1) / sizeof(auvid_real_t) * sizeof(auvid_real_t))

#define AUVID_PI AUVID_C(3.14159265358979323846)

/** Degrees of freedom (DoF): the index into every nu, tau and per-DoF array. */
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
 * Result of a call. 0: done. > 0: done, and the value tells what happened. < 0: refused; state and
 * outputs are as before the call unless the function says otherwise. Each function lists exactly
 * the statuses that it returns.
 */
typedef enum {
    AUVID_OK = 0,                 /**< done */
    AUVID_PENDING = 1,            /**< more work remains: call again */
    AUVID_FINISHED = 2,           /**< the procedure is complete */
    AUVID_EMPTY = 3,              /**< nothing is available */
    AUVID_GAP = 4,                /**< gap in the data: the record restarts here */
    AUVID_SET_COMPLETE = 5,       /**< this sample completed a data set */
    AUVID_GATED = 6,              /**< the innovation gate rejected the measurement */
    AUVID_UNUSED = 7,             /**< valid measurement, not usable now (GPS under water, ...) */
    AUVID_SATURATED = 8,          /**< limited to the thrusters' capacity or a frame's range */
    AUVID_EVALUATION_LIMIT = 9,   /**< stopped at the evaluation limit, not converged */
    AUVID_TICK = 10,              /**< a control tick is due: call the step function */
    AUVID_SET_IDLE = 11,          /**< a data set was completed and discarded: no DoF with a free
                                  parameter was excited in it (excitation_threshold) */
    AUVID_ERR_NULL = -1,          /**< a required pointer is NULL */
    AUVID_ERR_NOT_FINITE = -2,    /**< a value is NaN or infinite */
    AUVID_ERR_TIME_BACK = -3,     /**< time went backwards */
    AUVID_ERR_TIME_SAME = -4,     /**< time did not advance (zero dt) */
    AUVID_ERR_STALE = -5,         /**< sample older than allowed, or from the future */
    AUVID_ERR_RANGE = -6,         /**< a value or configuration field is outside its stated range */
    AUVID_ERR_BOUNDS = -7,        /**< lower bound not below upper bound */
    AUVID_ERR_POPULATION = -8,    /**< m < n + 1, or m > AUVID_MAX_POPULATION; Algorithm 1 with
                                  AUVID_MAX_POPULATION 0 */
    AUVID_ERR_PARAMETERS = -9,    /**< no parameter, or more than AUVID_MAX_PARAMETERS */
    AUVID_ERR_SIZE = -10,         /**< another count exceeds its size in config.h */
    AUVID_ERR_STATE = -11,        /**< call out of order (tell before ask, not initialised, ...) */
    AUVID_ERR_NO_DATA = -12,      /**< no rows to work on: empty set, no DoF excited */
    AUVID_ERR_SINGULAR = -13,     /**< the data or the matrix do not determine the result */
    AUVID_ERR_LIMIT = -14,        /**< a limit of the guard is exceeded */
    AUVID_ERR_ARITHMETIC = -15,   /**< selftest: this machine's arithmetic gives other bits */
    AUVID_ERR_MODEL = -16,        /**< the vehicle model does not support the request */
    AUVID_ERR_LENGTH = -17,       /**< the frame's length is not that of its message */
    AUVID_ERR_CHECKSUM = -18,     /**< the frame's checksum is wrong */
    AUVID_ERR_DRY_MASS = -19,     /**< the dry mass is not below the upper bound of a mass */
    AUVID_ERR_CAPACITY = -20,     /**< the thrusters cannot give so much */
    AUVID_ERR_FULL = -21,         /**< the queue is full */
    AUVID_ERR_REPEATED = -22,     /**< the frame's counter is that of the last one */
    AUVID_ERR_COUNTER_JUMP = -23, /**< the frame's counter jumped: too many frames are missing */
    AUVID_ERR_ATTACHED = -24,     /**< such a part is attached already */
    AUVID_ERR_DETACHED = -25,     /**< the function needs a part that is not attached */
    AUVID_ERR_STARTED = -26,      /**< too late: the identifier has stepped or recorded */
    AUVID_ERR_CONFIGURATION = -27 /**< saved with another configuration */
} auvid_status_t;

/** Returns a short English text for a status, never NULL; "unknown status" for any other value.
 * The text is static and read-only. Cost: constant. */
const char *auvid_status_str(auvid_status_t status);

/** Tests that this machine's arithmetic gives the bits that auvid expects: runs a short computation
 * and compares the hash of all its bits with the known hash. A replayed log repeats the
 * identification of the dive exactly only if every operation gives the same bits on both machines.
 * The init of the identifier calls it and refuses to start if it fails. Call it yourself if you use
 * modules without the identifier. It detects:
 * - flush-to-zero or denormals-are-zero, and another rounding mode;
 * - contraction into fused multiply-add, and excess precision (x87);
 * - reassociation or reciprocals by compiler flags;
 * - comparisons that ignore NaN;
 * - a soft-float library or conversions that round differently.
 *
 * It tests the flags with which auvid_selftest.c was compiled: compile all of auvid with the same
 * flags. Cost: 1.3k instructions (x86-64, -O2).
 * @return AUVID_OK; AUVID_ERR_ARITHMETIC (at least one bit differs) */
auvid_status_t auvid_selftest(void);

/**
 * What a configuration was refused for. Written by auvid_identifier_init and
 * auvid_identifier_init_motion, auvid_node_init (to its identifier),
 * auvid_identifier_attach_actuation (to its storage), auvid_terms_init, auvid_thrusters_init and
 * auvid_adaptive_begin.
 * To print it: "cfg.<part>.<field>[<element>] is <value>, limit <limit>";
 * without "<part>." if part is empty, without "[<element>]" if element is -1. An empty field: all
 * of the part.
 */
typedef struct {
    auvid_status_t status; /**< what was returned */
    const char *part;   /**< member of the configuration, e.g. "nav"; "": the configuration itself.
                              Static, as `field` */
    const char *field;  /**< e.g. "sigma_dvl" */
    int16_t element;    /**< element of an array, or number of the parameter, DoF, segment or
                              thruster; -1: none */
    auvid_real_t value; /**< as configured, or what follows from it; 0 of a pointer or a model */
    auvid_real_t limit; /**< the limit that it exceeds, or falls below; if value is not finite, one
                              of them; 0 of a pointer or a model */
} auvid_refusal_t;

/**
 * One cell of the record: motion and wrench, averaged over the same interval. It is the input of
 * vehicle models. The recorder (detail/recorder.h) or the user's own code writes it.
 */
typedef struct {
    uint64_t t_us;                             /**< middle of the interval [us] */
    auvid_real_t phi, theta, psi;              /**< roll, pitch, yaw [rad]; yaw unwrapped */
    auvid_real_t nu[AUVID_DOF_COUNT];          /**< u v w [m/s] p q r [rad/s], through the water */
    auvid_real_t nu_dot[AUVID_DOF_COUNT];      /**< their time derivatives [m/s2, rad/s2] */
    auvid_real_t tau[AUVID_DOF_COUNT];         /**< applied wrench X Y Z [N] K M N [Nm] */
    auvid_real_t command[AUVID_COMMAND_SLOTS]; /**< applied thruster commands [user's unit] */
    uint8_t missing; /**< bit j: nu[j] and nu_dot[j] are not measured; 0: all are */
    uint8_t reserved[AUVID_GAP(8, (21 + AUVID_COMMAND_SLOTS) * sizeof(auvid_real_t) + 1)]; /**< 0 */
} auvid_sample_t;

/** The phases that a search consists of. */
typedef enum {
    AUVID_SEARCH_BOTH = 0,   /**< the local phase begins at the best point of the global one */
    AUVID_SEARCH_GLOBAL = 1, /**< Algorithm 1 only */
    AUVID_SEARCH_LOCAL = 2   /**< Algorithm 2 only, from `good`, or from the middle of the box */
} auvid_search_phases_t;

/**
 * Where and how the optimizer searches (detail/optimizer.h): a global phase, Algorithm 1 of Karras
 * et al. 2013, and a local one, Algorithm 2. The identifier's has an element for each parameter of
 * the model, in the parameter's unit, and its `n` is not read. auvid_identifier_defaults fills it.
 */
typedef struct {
    uint64_t seed;       /**< of the random numbers; any value; default 1 */
    uint16_t population; /**< m of Algorithm 1, n + 1..AUVID_MAX_POPULATION; 0: 4 n (at least n + 2,
                              at most AUVID_MAX_POPULATION) */
    uint8_t n;           /**< parameters, 1..AUVID_MAX_PARAMETERS */
    uint8_t phases;      /**< auvid_search_phases_t; default AUVID_SEARCH_BOTH. With
                              AUVID_MAX_POPULATION 0 only AUVID_SEARCH_LOCAL, which is then the
                              default */
    uint8_t restarts; /**< of the local phase, with alpha0 / 10, the first along the axes; default
                              1 */
    bool has_good;    /**< use `good`, clipped to the bounds; default false */
    bool scale_by_bounds; /**< the identifier's units of the steps follow from the bounds, not from
                               the data; default false */
    bool paper; /**< Algorithms 1 and 2 to the letter, never ended by a known minimum; default
                     false */
    auvid_real_t lower[AUVID_MAX_PARAMETERS]; /**< lower < upper, both of magnitude <= 1e18; default
                                                   -1000 */
    auvid_real_t upper[AUVID_MAX_PARAMETERS]; /**< default 1000 */
    auvid_real_t good[AUVID_MAX_PARAMETERS];  /**< one of the first points: a known good one */
    /* Algorithm 1 */
    auvid_real_t epsilon_crs; /**< ends if J_max - J_min <= this [cost]; >= 0; default 1e-2 */
    auvid_real_t reduction;   /**< ends also if J_max - J_min is at most this fraction of that of
                                   the first population; 0 <= reduction < 1; default 0: only by
                                   epsilon_crs, as in the paper */
    auvid_real_t omega;       /**< factor of phi, 0..1e9; 0: 2, `paper` n. Larger (1e6 n) keeps the
                                   population from collapsing, at more evaluations */
    /* Algorithm 2; a step alpha moves a parameter by alpha times its unit */
    auvid_real_t alpha0;       /**< first steps, > epsilon_line, <= 1e3; 0: 0.35, `paper` 0.05 */
    auvid_real_t sigma;        /**< contraction, 0 < sigma < 1; 0: 0.09, `paper` 0.5. The last step
                                    tried is this much longer than epsilon_line */
    auvid_real_t delta;        /**< expansion, 1 < delta <= 100; default 2 */
    auvid_real_t gamma;        /**< least decrease over alpha^2 [cost], 0 <= gamma < 1; default
                                    1e-6 */
    auvid_real_t epsilon_line; /**< ends if all steps <= this, 0 < epsilon_line <= 1e-3; 0: 3e-6,
                                    `paper` 3e-5 (1e-5 is recommended) */
    uint32_t max_evaluations_crs;  /**< cap on evaluations of the global phase; the first population
                                        is always evaluated; 0: 40 m */
    uint32_t max_evaluations_line; /**< cap on those of a local phase; 0: 1000 n */
    uint32_t max_rejections;       /**< cap on consecutive trials outside the box; 0: 50 m */
#if defined(AUVID_REAL_DOUBLE) || AUVID_MAX_PARAMETERS % 2 == 0
    uint8_t reserved[4];
#endif
} auvid_search_config_t;

/** Returns true if x is neither NaN nor infinite: not all bits of its exponent are set. Needs no
 * library. No accepted compiler flag breaks it. */
static inline bool auvid_is_finite(auvid_real_t x)
{
#ifdef AUVID_REAL_DOUBLE
    const uint64_t exponent = (uint64_t)0x7FF << 52;
    uint64_t bits;
#else
    const uint32_t exponent = (uint32_t)0xFF << 23;
    uint32_t bits;
#endif
    memcpy(&bits, &x, sizeof bits);
    return (bits & exponent) != exponent;
}

#ifdef __cplusplus
}
#endif

#endif
