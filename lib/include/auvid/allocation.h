/**
 * @file allocation.h
 * Thruster allocation: body wrench to thruster forces and back, within the thrusters' limits.
 *
 * The thruster configuration matrix T gives the body wrench tau = T f of the thruster forces f. The
 * init computes its pseudo-inverse once; a wrench is then distributed as f = T+ tau, the solution
 * of minimum norm. If a thruster would exceed its limit, the wrench is scaled down: the degrees of
 * freedom in `priority` (yaw) by the largest factor that is possible with any factor of the others,
 * then the others by the largest that remains. So each of the two parts keeps its direction. The
 * thrusters may be able to give more with another distribution: 14 % in surge with BlueROV2 Heavy,
 * and anything at all where two thrusters that work in one direction only push against each other.
 * An identification must record the applied wrench, T f.
 *
 * The control tick calls it. Cost for n thrusters: 18 n multiplications; under saturation also
 * about 6 n multiplications and 4 divisions for each limit that decides, usually one or two. Init:
 * about 3000 operations for 6 x 8. Memory: sizeof(auvid_allocation_t), 0.5 KiB with 8 thrusters in
 * float. After init the struct is read-only.
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

/** Force f of a thruster as a function of its command n. */
typedef enum {
    AUVID_THRUST_LINEAR = 0, /**< f = gain n; with gain 1 the command is the force */
    AUVID_THRUST_SQUARE = 1  /**< f = gain n |n| (propeller speed) */
} auvid_thrust_law_t;

/** One thruster. Written by the user. */
typedef struct {
    auvid_real_t wrench[AUVID_DOF_COUNT]; /**< X Y Z K M N per newton: a column of T [-, m] */
    auvid_real_t min_N;                   /**< most negative force [N], <= 0 */
    auvid_real_t max_N;         /**< most positive force [N], >= 0; min_N = max_N = 0: not used */
    auvid_thrust_law_t law;     /**< command to force; default (zero): linear */
    auvid_real_t gain_forward;  /**< for n > 0 [N per unit, N per unit^2], > 0; default 1 */
    auvid_real_t gain_backward; /**< for n < 0, likewise; zero: equal to gain_forward */
} auvid_thruster_t;

/** Configuration; copied at init. */
typedef struct {
    auvid_thruster_t thruster[AUVID_MAX_THRUSTERS];
    uint8_t thrusters; /**< number of thrusters, 1..AUVID_MAX_THRUSTERS; default 0: rejected */
    /** Controlled degrees of freedom, AUVID_DOF_BIT()s. Default 0: all in which a thruster acts.
     * Omit a DoF that only couples with another. Example: a side thruster above the centre also
     * rolls the vehicle; with roll in the mask it could be used for neither. */
    uint8_t dofs;
    /** Degrees of freedom scaled last if the thrusters do not suffice. Default yaw; zero: none, the
     * whole wrench is scaled by one factor. */
    uint8_t priority;
} auvid_allocation_config_t;

/** The allocation. Written by auvid_allocation_init, read-only for all other functions; all zero
 * (not initialised) it is AUVID_ERR_STATE for them. */
typedef struct {
    auvid_allocation_config_t cfg;                              /**< copy */
    auvid_real_t inverse[AUVID_MAX_THRUSTERS][AUVID_DOF_COUNT]; /**< T+ of the controlled rows */
    /** DoFs in which a wrench is possible without the others in the mask. Not those with less than
     * 0.1 % of the largest force, or the largest moment, per newton (T is not known so well), or
     * less than 1e-6. */
    uint8_t actuated;
    uint8_t rank;     /**< rank of the controlled rows of T, 1..6 */
} auvid_allocation_t;

/** Result of auvid_allocation_solve. */
typedef struct {
    auvid_real_t force_N[AUVID_MAX_THRUSTERS]; /**< per thruster [N], within its limits */
    auvid_real_t wrench[AUVID_DOF_COUNT];      /**< applied wrench, T force [N, Nm] */
    auvid_real_t scale_priority; /**< applied fraction of the prioritised wrench, 0..1 */
    auvid_real_t scale;          /**< applied fraction of the rest, 0..1 */
    uint8_t dropped;             /**< DoFs with a requested wrench that no thruster can produce */
} auvid_allocation_result_t;

/** How an excitation fits the thrusters. Written by auvid_allocation_check. */
typedef struct {
    auvid_real_t factor; /**< 1: it fits. Else the factor, 0..1, to which all peaks must shrink so
                              that it does; 0: it does not fit at any size */
    int8_t dof;          /**< the DoF to shrink first: it takes most of the thruster that limits the
                              factor, or is not actuated; -1: it fits, or `hold` alone does not */
} auvid_allocation_fit_t;

#define auvid_allocation_init AUVID_SIZED(auvid_allocation_init)

#if AUVID_MAX_THRUSTERS >= 5
#define auvid_allocation_girona500 AUVID_SIZED(auvid_allocation_girona500)
/** Girona500's five thrusters: X = -(f0 + f1), Y = f4, Z = -(f2 + f3), M = 0.35 (f3 - f2),
 * N = 0.4 (f1 - f0); +-153.8 N; f = 153.8 n |n|, n = -1..1. Yaw has priority. */
extern const auvid_allocation_config_t auvid_allocation_girona500;
#endif

#if AUVID_MAX_THRUSTERS >= 8
#define auvid_allocation_bluerov2_heavy AUVID_SIZED(auvid_allocation_bluerov2_heavy)
/** BlueROV2 Heavy's eight T200 thrusters, after von Benzon et al. 2022 (fossen.h). Four are at
 * (+-0.156, +-0.111, 0.085) m and 45 degrees to x; the front ones push ahead and inwards, the rear
 * ones astern and inwards. Four are at (+-0.120, +-0.218, 0) m and push up, down, down, up. Order
 * in both groups: front starboard, front port, rear starboard, rear port. At 16 V 51.5 n |n|
 * forward and 40.2 n |n| backward [N] (5.25 and 4.1 kgf), n = -1..1. All six DoF; yaw has priority.
 */
extern const auvid_allocation_config_t auvid_allocation_bluerov2_heavy;
#endif

#define auvid_allocation_defaults AUVID_SIZED(auvid_allocation_defaults)
/** Fill *cfg with the defaults: no thruster, all forward gains 1, linear, priority of yaw.
 * @param cfg written whole; NULL is a no-op. */
void auvid_allocation_defaults(auvid_allocation_config_t *cfg);

/**
 * Check the configuration, copy it, and compute the pseudo-inverse.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_SIZE if thrusters is 0 or > AUVID_MAX_THRUSTERS;
 *         AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE if min_N > 0, max_N < 0, gain_forward <= 0,
 *         gain_backward < 0, the law is unknown, or an entry of T exceeds 1e6; AUVID_ERR_SINGULAR
 *         if no working thruster acts in any controlled DoF. On an error *a is unchanged.
 */
auvid_status_t auvid_allocation_init(auvid_allocation_t *a, const auvid_allocation_config_t *cfg);

#define auvid_allocation_solve AUVID_SIZED(auvid_allocation_solve)
/**
 * Distribute a wrench over the thrusters.
 * @param wrench 6: requested wrench [N, Nm], |.| <= 1e9. A component in a DoF that is not in
 *               a->actuated is dropped and marked in result->dropped.
 * @param result written whole; all zero on an error.
 * @return AUVID_OK; AUVID_SATURATED if the wrench was scaled or a component was dropped: use
 *         result->wrench; AUVID_ERR_NULL; AUVID_ERR_STATE; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE.
 */
auvid_status_t auvid_allocation_solve(const auvid_allocation_t *a,
                                      const auvid_real_t wrench[AUVID_DOF_COUNT],
                                      auvid_allocation_result_t *result);

#define auvid_allocation_wrench AUVID_SIZED(auvid_allocation_wrench)
/**
 * Compute the wrench of given thruster forces, tau = T f.
 * @param force_N one per thruster [N]; may exceed the limits (measured forces).
 * @param wrench  6, written [N, Nm]; must not overlap force_N.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE; AUVID_ERR_NOT_FINITE. On an error nothing is
 *         written.
 */
auvid_status_t auvid_allocation_wrench(const auvid_allocation_t *a, const auvid_real_t *force_N,
                                       auvid_real_t wrench[AUVID_DOF_COUNT]);

#define auvid_allocation_command AUVID_SIZED(auvid_allocation_command)
/**
 * Compute the commands of the thrusters for given forces, the inverse of auvid_allocation_force.
 * @param force_N one per thruster [N].
 * @param command written, one per thruster; may be the same array as force_N.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE; AUVID_ERR_NOT_FINITE. On an error nothing is
 *         written.
 */
auvid_status_t auvid_allocation_command(const auvid_allocation_t *a, const auvid_real_t *force_N,
                                        auvid_real_t *command);

#define auvid_allocation_force AUVID_SIZED(auvid_allocation_force)
/**
 * Compute the forces of the thrusters for given commands, by the law of each; limits are not
 * applied.
 * @param command one per thruster.
 * @param force_N written, one per thruster [N]; may be the same array as command.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE; AUVID_ERR_NOT_FINITE if a command or its force
 *         is not finite. On an error nothing is written.
 */
auvid_status_t auvid_allocation_force(const auvid_allocation_t *a, const auvid_real_t *command,
                                      auvid_real_t *force_N);

#define auvid_allocation_capacity AUVID_SIZED(auvid_allocation_capacity)
/**
 * Compute the largest wrench in a single DoF that auvid_allocation_solve gives without scaling.
 * @param dof      0..5.
 * @param negative written [N or Nm], <= 0; 0 if the DoF is not actuated.
 * @param positive written [N or Nm], >= 0; 0 if the DoF is not actuated.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE; AUVID_ERR_RANGE if dof is outside its range.
 *         On an error nothing is written.
 */
auvid_status_t auvid_allocation_capacity(const auvid_allocation_t *a, auvid_dof_t dof,
                                         auvid_real_t *negative, auvid_real_t *positive);

#define auvid_allocation_check AUVID_SIZED(auvid_allocation_check)
/**
 * Check that the thrusters can produce an excitation in all DoFs at the same time, with every
 * combination of signs, in addition to a constant wrench. For each thruster i,
 * T+_i hold +- sum_j |T+_ij| peak_j must be within its limits.
 * @param peak 6: largest |wrench| per DoF [N, Nm], >= 0 (auvid_excitation_peak).
 * @param hold 6: constant wrench (hover thrust) [N, Nm], or NULL for none.
 * @param fit written whole if AUVID_OK or AUVID_ERR_CAPACITY; NULL: not wanted.
 * @return AUVID_OK; AUVID_ERR_CAPACITY if they cannot, or if a DoF with peak > 0 is not actuated;
 *         AUVID_ERR_NULL; AUVID_ERR_STATE; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE if a peak is < 0.
 */
auvid_status_t auvid_allocation_check(const auvid_allocation_t *a,
                                      const auvid_real_t peak[AUVID_DOF_COUNT],
                                      const auvid_real_t hold[AUVID_DOF_COUNT],
                                      auvid_allocation_fit_t *fit);

#ifdef __cplusplus
}
#endif

#endif
