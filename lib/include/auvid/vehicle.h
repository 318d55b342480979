/**
 * @file vehicle.h
 * Vehicle models: tau = Y(eta, nu, nu_dot, pi) (Eq. 2), as a table the other modules call.
 *
 * A model is one constant struct: names of its parameters, which parameters stand in which
 * equation, and up to three functions. The Girona500 model of the paper (Eq. 12-15) is here;
 * any other vehicle is a struct and a function of the user's. The struct begins with
 * `.built_for = AUVID_BUILD`.
 *
 * - `residual` is enough for any model, linear in its parameters or not, differentiable or not.
 * - `regressor`, for models linear in their parameters, makes a cost evaluation some thirty times
 *   cheaper. A model needs at least one of the two; the regressor is preferred where both are.
 * - `acceleration` is for simulation only (validation.h).
 *
 * The functions must be pure: same input, same output, no state. They are called from
 * auvid_identifier_step (regressor) and auvid_identifier_work (residual), within the control tick.
 *
 * Cost of the Girona500 regressor: two sincos and about 40 multiplications. Memory: constants only.
 */
#ifndef AUVID_VEHICLE_H
#define AUVID_VEHICLE_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What a parameter is: decides which values are plausible and which motion it needs. */
typedef enum {
    AUVID_PARAMETER_OTHER = 0,      /**< nothing is known of it */
    AUVID_PARAMETER_MASS,           /**< rigid body and added mass [kg]: above the dry mass */
    AUVID_PARAMETER_INERTIA,        /**< moment of inertia, likewise: positive */
    AUVID_PARAMETER_LINEAR_DRAG,    /**< negative when it dissipates */
    AUVID_PARAMETER_QUADRATIC_DRAG, /**< negative when it dissipates */
    AUVID_PARAMETER_FORCE           /**< constant force or moment, weight less buoyancy:
                                         identifiable by its size in newtons */
} auvid_parameter_kind_t;

/** One parameter of a model. */
typedef struct {
    const char *name; /**< e.g. "m_u" */
    const char *unit; /**< e.g. "kg" */
    auvid_dof_t dof;  /**< the DoF that must be driven for the parameter to be identified */
    auvid_parameter_kind_t kind; /**< default (zero): other */
} auvid_parameter_t;

/** The equations' left-hand sides, one row for each DoF; written by a model's regressor. */
typedef struct {
    auvid_real_t row[AUVID_DOF_COUNT][AUVID_MAX_PARAMETERS];
} auvid_regressor_t;

#define auvid_build AUVID_SIZED(auvid_build)
/** What AUVID_BUILD points to; its value says nothing. Its link-time name has all of config.h in
 * it, so a model that was compiled with other sizes does not link. */
extern const uint8_t auvid_build;
#define AUVID_BUILD (&auvid_build)

/** A vehicle model. All pointers must outlive every user of the model. */
typedef struct {
    const uint8_t *built_for;           /**< AUVID_BUILD */
    const char *name;                   /**< for people */
    uint8_t parameters;                 /**< n, 1..AUVID_MAX_PARAMETERS */
    const auvid_parameter_t *parameter; /**< [n] */

    /** Bit i set: parameter i may stand in this DoF's equation. 0: the DoF is not modelled. A bit
     * too many costs memory, a bit missing loses the term. */
    uint32_t columns[AUVID_DOF_COUNT];

    uint32_t free; /**< bit i: parameter i is estimated unless the user chooses; 0: all are */

    /** Predicted minus applied wrench at `sample` for parameters pi[n], for every modelled DoF;
     * residual[] comes zeroed. May read sample->command for models of the thrusters. Null when
     * there is a regressor. */
    void (*residual)(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                     auvid_real_t residual[AUVID_DOF_COUNT]);

    /** The rows with predicted wrench = row . pi; *y comes zeroed; does not read sample->tau. Null
     * when the model is not linear in pi. */
    void (*regressor)(const void *context, const auvid_sample_t *sample, auvid_regressor_t *y);

    /** nu_dot[] of the modelled DoF from sample's phi, theta, nu, tau, command; nu_dot[] comes
     * zeroed, and goes as not finite in a DoF for which pi allows none (a mass not > 0). False when
     * pi allows none at all. Null when not offered. */
    bool (*acceleration)(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                         auvid_real_t nu_dot[AUVID_DOF_COUNT]);

    const void *context; /**< handed to the three functions; may be null */
    uint16_t work; /**< units of work that one call of `residual` costs, each about 250 instructions
                        of a Cortex-M4F; default (zero): 1. Where that is more than the budget of a
                        tick, several pay for a call, which the last of them makes */

    /** Bit i of reads[j]: the equation of DoF j reads nu[i] or nu_dot[i]; 0: all six. Where one of
     * them is not measured, the equation gives no rows; others do. A bit too many costs rows, a bit
     * missing lets guesses in. */
    uint8_t reads[AUVID_DOF_COUNT];

    /** `residual` forms the thrust from commands and does not read sample->tau (thrusters.h): the
     * parameters do not depend on the scale of the thrust as told. Default false. */
    bool own_thrust;
} auvid_vehicle_t;

/** Is the model usable? Checks counts, masks and pointers.
 * @return AUVID_OK; AUVID_ERR_NULL (vehicle or its table null); AUVID_ERR_SIZE (built_for is null,
 * or not AUVID_BUILD: the model may have been compiled with other sizes); AUVID_ERR_PARAMETERS (n
 * out of range); AUVID_ERR_MODEL (neither residual nor regressor, no DoF modelled, a mask names a
 * parameter >= n, a parameter's dof is not modelled; `reads` of a DoF names a velocity >= 6, or not
 * the DoF's own). Cost: O(n). */
auvid_status_t auvid_vehicle_check(const auvid_vehicle_t *vehicle);

/** The DoF whose equations read one of the velocities `missing` (bit i: nu[i]): bit j. No check of
 * its argument. Cost: O(1). */
uint8_t auvid_vehicle_unmeasured(const auvid_vehicle_t *vehicle, uint8_t missing);

#define auvid_vehicle_residual AUVID_SIZED1(auvid_vehicle_residual, AUVID_MAX_COMMANDS)
/** Predicted minus applied wrench (Eq. 2, Eq. 11) by whichever function the model has.
 * @param residual [6] N, Nm; 0 in DoF that are not modelled
 * No check of its arguments: for inner loops. Cost: one call of the model. */
void auvid_vehicle_residual(const auvid_vehicle_t *vehicle, const auvid_sample_t *sample,
                            const auvid_real_t *pi, auvid_real_t residual[AUVID_DOF_COUNT]);

#define auvid_kinematics AUVID_SIZED0(auvid_kinematics)
/** eta_dot = J(eta) nu (Eq. 1; Fossen 2011, Eq. 2.53).
 * @param phi, theta, psi attitude [rad], each up to +-1e4
 * @param nu [6] body velocity
 * @param eta_dot [6] x y z [m/s], phi theta psi [rad/s]; may not be nu
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (an angle beyond
 * 1e4); AUVID_ERR_SINGULAR within 1e-3 rad of
 * theta = +-90 deg, where J has no angular part. Cost: three sincos. */
auvid_status_t auvid_kinematics(auvid_real_t phi, auvid_real_t theta, auvid_real_t psi,
                                const auvid_real_t *nu, auvid_real_t *eta_dot);

/** Parameters of the Girona500 model, in the order of the paper's results; X_0 .. N_0 are constant
 * forces and a moment on the hull [N, Nm] (a biased thruster, a trailing cable), which the paper
 * does not have. Z_0 and W-B can hardly be told apart: free only one of them. Where
 * AUVID_MAX_PARAMETERS has no room for them, the model has only the paper's. */
typedef enum {
    AUVID_G500_M_U,
    AUVID_G500_M_V,
    AUVID_G500_M_W,
    AUVID_G500_M_R,
    AUVID_G500_W_B,
    AUVID_G500_X_U,
    AUVID_G500_X_UU,
    AUVID_G500_Y_V,
    AUVID_G500_Y_VV,
    AUVID_G500_Z_W,
    AUVID_G500_Z_WW,
    AUVID_G500_N_R,
    AUVID_G500_N_RR,
#if AUVID_MAX_PARAMETERS >= 17
    AUVID_G500_X_0,
    AUVID_G500_Y_0,
    AUVID_G500_Z_0,
    AUVID_G500_N_0,
#endif
    AUVID_G500_COUNT
} auvid_girona500_parameter_t;

/** Bits of the 13 parameters of Eq. 12-15: the usual choice of free parameters. */
#define AUVID_G500_FREE 0x1FFFu
/** The same with X_0, Y_0, N_0 free; heave's constant is W-B. */
#define AUVID_G500_FREE_BIAS (0x1FFFu | 1u << 13 | 1u << 14 | 1u << 16)

#if AUVID_MAX_PARAMETERS >= 13
/** Eq. 12-15 with Fossen's m_w w p in Eq. 13. */
extern const auvid_vehicle_t auvid_girona500;
/** Eq. 12-15 exactly as printed: m_w w q in Eq. 13. */
extern const auvid_vehicle_t auvid_girona500_printed;
/** Without the coupling terms of C(nu) nu: each DoF by itself. */
extern const auvid_vehicle_t auvid_girona500_decoupled;
#define auvid_girona500_paper AUVID_SIZED1(auvid_girona500_paper, AUVID_MAX_PARAMETERS)
/** The paper's 13 estimates (Section IV), biases 0. [AUVID_G500_COUNT] */
extern const auvid_real_t auvid_girona500_paper[AUVID_G500_COUNT];
#endif

#ifdef __cplusplus
}
#endif

#endif
