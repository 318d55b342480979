/**
 * @file allocation.h
 * Thruster allocation: body wrench to thruster forces and back, within the thrusters' limits.
 *
 * The thruster configuration matrix T gives the body wrench tau = T f of the thruster forces f. At
 * init its pseudo-inverse is computed once; a wrench is then distributed as f = T+ tau, the
 * solution of least effort. When a thruster would exceed its limit, the wrench is scaled down as a
 * whole, so that it keeps its direction; the degrees of freedom in `priority` (yaw) are served
 * first, and the others are scaled to what remains. The wrench really applied, T f, is what an
 * identification must record.
 *
 * Who calls it: the control tick. Cost: 12 n multiplications and at most 4 n divisions for n
 * thrusters; init about 3000 operations for 6 x 8. Memory: sizeof(auvid_allocation_t), 0.6 KiB with
 * 8 thrusters in float. No state: all functions but init take the struct as const.
 *
 * Sources: Karras et al. 2013, III-A ("transformed to thruster commands through the thruster
 * allocator matrix"); Fossen 2011, 12.3 (pseudo-inverse allocation).
 */
#ifndef AUVID_ALLOCATION_H
#define AUVID_ALLOCATION_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bit of a degree of freedom in a mask. */
#define AUVID_DOF_BIT(dof) ((uint8_t)(1u << (dof)))

/** How a thruster's command n makes its force. */
typedef enum {
    AUVID_THRUST_LINEAR = 0, /**< f = gain n; with gain 1 the command is the force */
    AUVID_THRUST_SQUARE = 1  /**< f = gain n |n| (propeller speed) */
} auvid_thrust_law_t;

/** One thruster. Written by the user. */
typedef struct {
    auvid_real_t wrench[AUVID_DOF_COUNT]; /**< X Y Z K M N of one newton: a column of T [-, m] */
    auvid_real_t min_N;                   /**< most negative force [N], <= 0 */
    auvid_real_t
        max_N; /**< most positive force [N], >= 0; min_N = max_N = 0: out of order, unused */
    auvid_thrust_law_t law;     /**< command to force; default (zero): linear */
    auvid_real_t gain_forward;  /**< for n > 0 [N per unit, N per unit^2], > 0; default 1 */
    auvid_real_t gain_backward; /**< for n < 0, likewise; zero means as gain_forward */
} auvid_thruster_t;

/** Configuration; copied at init. */
typedef struct {
    auvid_thruster_t thruster[AUVID_MAX_THRUSTERS];
    uint8_t thrusters; /**< how many are there, 1..AUVID_MAX_THRUSTERS; default 0: not valid yet */
    /** Degrees of freedom that are to be controlled, AUVID_DOF_BIT()s. Default 0: all in which a
     * thruster acts. Leave out what only comes along with another: a side thruster above the
     * centre rolls the vehicle; with roll in the mask it could be used for neither. */
    uint8_t dofs;
    /** Degrees of freedom served first when the thrusters do not suffice. Default yaw; zero: none,
     * the whole wrench is scaled alike. */
    uint8_t priority;
} auvid_allocation_config_t;

/** Written by init; read by all others. */
typedef struct {
    auvid_allocation_config_t config;                           /**< as given */
    auvid_real_t inverse[AUVID_MAX_THRUSTERS][AUVID_DOF_COUNT]; /**< T+ of the controlled rows */
    uint8_t actuated; /**< DoFs in which any wrench can be made without the others in the mask */
    uint8_t rank;     /**< rank of the controlled rows of T, 1..6 */
} auvid_allocation_t;

/** Answer of auvid_allocation_solve. */
typedef struct {
    auvid_real_t force_N[AUVID_MAX_THRUSTERS]; /**< per thruster [N], within its limits */
    auvid_real_t wrench[AUVID_DOF_COUNT];      /**< T force: what really acts [N, Nm] */
    auvid_real_t scale_priority; /**< part of the prioritised wrench that is made, 0..1 */
    auvid_real_t scale;          /**< part of the rest that is made, 0..1 */
    uint8_t dropped;             /**< DoFs in which something was asked that no thruster can make */
} auvid_allocation_result_t;

#define auvid_allocation_init AUVID_SIZED1(auvid_allocation_init, AUVID_MAX_THRUSTERS)

#if AUVID_MAX_THRUSTERS >= 5
#define auvid_allocation_girona500 AUVID_SIZED1(auvid_allocation_girona500, AUVID_MAX_THRUSTERS)
/** Girona500's five thrusters: X = -(f0 + f1), Y = f4, Z = -(f2 + f3), M = 0.35 (f3 - f2),
 * N = 0.4 (f1 - f0); 153.8 N each way; f = 153.8 n |n|, n = -1..1. Yaw before the rest. */
extern const auvid_allocation_config_t auvid_allocation_girona500;
#endif

#if AUVID_MAX_THRUSTERS >= 8
#define auvid_allocation_bluerov2_heavy                                                            \
    AUVID_SIZED1(auvid_allocation_bluerov2_heavy, AUVID_MAX_THRUSTERS)
/** BlueROV2 Heavy's eight T200, as von Benzon et al. 2022 (fossen.h) have them: four at
 * (+-0.156, +-0.111, 0.085) m and 45 degrees to x, of which the front ones push ahead and inwards,
 * the rear ones astern and inwards; four at (+-0.120, +-0.218, 0) m, which push up, down, down, up.
 * In both groups: front starboard, front port, rear starboard, rear port. At 16 V 51.5 n |n|
 * forward and 40.2 n |n| backward [N] (5.25 and 4.1 kgf), n = -1..1. All six DoF; yaw before the
 * rest. */
extern const auvid_allocation_config_t auvid_allocation_bluerov2_heavy;
#endif

#define auvid_allocation_defaults AUVID_SIZED1(auvid_allocation_defaults, AUVID_MAX_THRUSTERS)
/** No thruster, all gains 1, linear, yaw first. config: not null, else nothing is done. */
void auvid_allocation_defaults(auvid_allocation_config_t *config);

/**
 * Check the configuration, copy it, and compute the pseudo-inverse.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_SIZE (thrusters is 0 or > AUVID_MAX_THRUSTERS);
 *         AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (min_N > 0, max_N < 0, gain_forward <= 0,
 *         gain_backward < 0, law unknown, an entry of T above 1e6); AUVID_ERR_SINGULAR (no working
 *         thruster acts in any controlled DoF). On < 0 *a is as before.
 */
auvid_status_t auvid_allocation_init(auvid_allocation_t *a,
                                     const auvid_allocation_config_t *config);

#define auvid_allocation_solve AUVID_SIZED1(auvid_allocation_solve, AUVID_MAX_THRUSTERS)
/**
 * Distribute a wrench over the thrusters.
 * @param wrench 6: asked for [N, Nm], |.| <= 1e9. A part in a DoF that is not in a->actuated is
 *               dropped (and named in result->dropped).
 * @param result written; on < 0 all forces and the wrench are zero (and no `dropped`).
 * @return AUVID_OK; AUVID_SATURATED (scaled or dropped: result->wrench is not what was asked);
 *         AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE.
 */
auvid_status_t auvid_allocation_solve(const auvid_allocation_t *a,
                                      const auvid_real_t wrench[AUVID_DOF_COUNT],
                                      auvid_allocation_result_t *result);

#define auvid_allocation_wrench AUVID_SIZED1(auvid_allocation_wrench, AUVID_MAX_THRUSTERS)
/**
 * The wrench of given thruster forces, tau = T f.
 * @param force_N as many as there are thrusters [N]; need not be within the limits (feedback).
 * @param wrench  6, written [N, Nm]; must not overlap force_N.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE (nothing written).
 */
auvid_status_t auvid_allocation_wrench(const auvid_allocation_t *a, const auvid_real_t *force_N,
                                       auvid_real_t wrench[AUVID_DOF_COUNT]);

#define auvid_allocation_command AUVID_SIZED1(auvid_allocation_command, AUVID_MAX_THRUSTERS)
/**
 * Commands of the thrusters for given forces, the inverse of auvid_allocation_force.
 * @param force_N, command as many as there are thrusters; may be the same array.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE (nothing written).
 */
auvid_status_t auvid_allocation_command(const auvid_allocation_t *a, const auvid_real_t *force_N,
                                        auvid_real_t *command);

#define auvid_allocation_force AUVID_SIZED1(auvid_allocation_force, AUVID_MAX_THRUSTERS)
/**
 * Forces of the thrusters under given commands, by each one's law; limits are not applied.
 * @param command, force_N as many as there are thrusters; may be the same array.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE (a command, or the force it would give;
 *         nothing written).
 */
auvid_status_t auvid_allocation_force(const auvid_allocation_t *a, const auvid_real_t *command,
                                      auvid_real_t *force_N);

#define auvid_allocation_capacity AUVID_SIZED1(auvid_allocation_capacity, AUVID_MAX_THRUSTERS)
/**
 * The largest wrench in one DoF alone that keeps within the limits.
 * @param dof      0..5.
 * @param negative written [N or Nm], <= 0. @param positive written, >= 0. Both are 0 where the DoF
 *                 is not actuated.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (dof).
 */
auvid_status_t auvid_allocation_capacity(const auvid_allocation_t *a, auvid_dof_t dof,
                                         auvid_real_t *negative, auvid_real_t *positive);

#define auvid_allocation_check AUVID_SIZED1(auvid_allocation_check, AUVID_MAX_THRUSTERS)
/**
 * Can the thrusters make every combination of signs of an excitation at once, on top of a standing
 * wrench? For each thruster i: T+_i hold +- sum_j |T+_ij| peak_j within its limits.
 * @param peak 6: largest |wrench| per DoF [N, Nm], >= 0 (auvid_excitation_peak).
 * @param hold 6: standing wrench (hover thrust) [N, Nm], or null for none.
 * @return AUVID_OK; AUVID_ERR_LIMIT (they cannot, or a DoF with peak > 0 is not actuated);
 *         AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (a peak < 0).
 */
auvid_status_t auvid_allocation_check(const auvid_allocation_t *a,
                                      const auvid_real_t peak[AUVID_DOF_COUNT],
                                      const auvid_real_t hold[AUVID_DOF_COUNT]);

#ifdef __cplusplus
}
#endif

#endif
