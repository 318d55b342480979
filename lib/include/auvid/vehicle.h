/**
 * @file vehicle.h
 * Vehicle models: tau = Y(eta, nu, nu_dot, pi) (Eq. 2), as a table of functions.
 *
 * A model is one constant struct: the names of its parameters, the parameters of each equation, and
 * up to four functions. The struct begins with `.built_for = AUVID_BUILD`. This header has the
 * Girona500 model of the paper (Eq. 12-15). For any other vehicle, the user writes a table of terms
 * (auvid_terms_init), or a struct and a function.
 *
 * - `path` names how the metric uses the model. `&auvid_path_regressor`: the model is linear in its
 *   parameters and gives `regressor`. A cost evaluation is about thirty times cheaper.
 *   `&auvid_path_residual`: any model, linear or not, differentiable or not, gives `residual`, and
 *   the configuration gives memory for rows (metric_config.h). Only the model names a path, so the
 *   linker drops the other one.
 * - `regressor` writes the rows d residual / d pi. On the regressor path they do not depend on pi,
 *   and pi is NULL. On the residual path the function is optional: it replaces the central
 *   differences by exact derivatives.
 * - `acceleration` is for simulation only (validation.h).
 *
 * Three examples: Girona500 has `regressor` and `acceleration`. A hull with its thrusters
 * (thrusters.h) or in a current (current.h) wraps another model: its `residual` calls that of the
 * hull at a changed sample. A user's model with a dead band has `residual`, and may add `regressor`
 * for Gauss-Newton steps.
 *
 * The functions must be pure: same input, same output, no state. auvid_identifier_step calls the
 * regressor of the regressor path, auvid_identifier_work calls the functions of the residual path.
 *
 * Cost of the Girona500 regressor: two sincos and about 40 multiplications. Memory: constants only.
 */
#ifndef AUVID_VEHICLE_H
#define AUVID_VEHICLE_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Kind of a parameter: determines which values are plausible and which motion it needs. */
typedef enum {
    AUVID_PARAMETER_OTHER = 0,   /**< unspecified. Taken to scale with the thrust, as a mass does:
                                         an error of its scale of 5 % makes this one 5 % wrong */
    AUVID_PARAMETER_MASS,        /**< rigid body and added mass [kg]: above the dry mass */
    AUVID_PARAMETER_INERTIA,     /**< rigid body and added inertia [kg m2]: positive */
    AUVID_PARAMETER_LINEAR_DRAG, /**< negative if it dissipates */
    AUVID_PARAMETER_QUADRATIC_DRAG, /**< negative if it dissipates */
    AUVID_PARAMETER_FORCE,          /**< constant force or moment, W-B: identifiable if its standard
                                         error is small against tau_max (metric_config.h) */
    AUVID_PARAMETER_UNSCALED        /**< residual path: does not scale with the thrust, as an
                                         exponent, a lag or a current. One that does scale has too
                                         small a half-width as this */
} auvid_parameter_kind_t;

/** One parameter of a model. */
typedef struct {
    const char *name;            /**< e.g. "m_u" */
    const char *unit;            /**< e.g. "kg" */
    auvid_dof_t dof;             /**< the DoF that must be excited to identify the parameter */
    auvid_parameter_kind_t kind; /**< default (zero): other */
} auvid_parameter_t;

/** The rows of the equations, one for each DoF: wrench = row . pi. Written by a regressor. */
typedef struct {
    auvid_real_t row[AUVID_DOF_COUNT][AUVID_MAX_PARAMETERS];
} auvid_regressor_t;

#define auvid_build AUVID_SIZED(auvid_build)
/** The object to which AUVID_BUILD points; its value has no meaning. Its link-time name contains
 * all sizes of config.h, so a model compiled with other sizes does not link. */
extern const uint8_t auvid_build;
#define AUVID_BUILD (&auvid_build)

/** A path of the metric; its members are private. */
typedef struct auvid_path auvid_path_t;
#define auvid_path_regressor AUVID_SIZED(auvid_path_regressor)
/** Rows of equations linear in pi become R factors, and the cost follows from these. */
extern const auvid_path_t auvid_path_regressor;
#define auvid_path_residual AUVID_SIZED(auvid_path_residual)
/** Samples are stored, and the model's residual is called on each. If AUVID_MAX_COMMANDS is 0 there
 * is no memory for it: auvid_metric_init returns AUVID_ERR_SIZE. */
extern const auvid_path_t auvid_path_residual;

/** A vehicle model. All pointers must outlive every user of the model. */
typedef struct {
    const uint8_t *built_for; /**< AUVID_BUILD */
    const auvid_path_t *path; /**< required: &auvid_path_regressor or &auvid_path_residual */
    const char *name;         /**< display name */
    uint8_t parameters;       /**< n, 1..AUVID_MAX_PARAMETERS */
    const auvid_parameter_t *parameter; /**< [n] */

    /** Bit i: parameter i may be in this DoF's equation. 0: the DoF is not modelled. An extra bit
     * costs memory; a missing bit loses the term. */
    uint32_t columns[AUVID_DOF_COUNT];

    uint32_t free; /**< bit i: parameter i is free by default; 0: all are */

    /** Writes predicted minus applied wrench at `sample` for the parameters pi[n], for every
     * modelled DoF. residual[] is zero-initialised. The function may read sample->command to model
     * thrusters. Finite for each finite sample and all pi within the bounds: if it is not for one
     * sample of the sets, the cost of pi is AUVID_COST_FAILED, and if that is so for all pi, the
     * estimate has AUVID_NOTE_NOT_CONVERGED. Required on the residual path; NULL on the other. */
    void (*residual)(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                     auvid_real_t residual[AUVID_DOF_COUNT]);

    /** Writes the rows d residual / d pi. *y is zero-initialised. The function must not read
     * sample->tau. Required on the regressor path, where predicted wrench = row . pi, and pi is
     * NULL. Optional on the residual path: there pi[n] is the point of the derivatives. */
    void (*regressor)(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                      auvid_regressor_t *y);

    /** Writes nu_dot[] of the modelled DoF from the sample's phi, theta, nu, tau and command.
     * nu_dot[] is zero-initialised. It is not finite in a DoF without solution for pi (a mass not
     * > 0). Returns false if no DoF has a solution. NULL if not provided. */
    bool (*acceleration)(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                         auvid_real_t nu_dot[AUVID_DOF_COUNT]);

    const void *context; /**< context argument of the functions; may be NULL */
    uint16_t work; /**< cost of one call of `residual` in units of work, each about 250 instructions
                        of a Cortex-M4F; default (zero): 1. If this exceeds a tick's budget, auvid
                        adds up the budgets of several ticks and calls in the last one */

    /** Bit i of reads[j]: the equation of DoF j reads nu[i] or nu_dot[i]; 0: all six. An equation
     * gives no rows while one of them is not measured. An extra bit costs rows; with a missing bit,
     * unmeasured values enter the rows. */
    uint8_t reads[AUVID_DOF_COUNT];

    /** True if `residual` computes the thrust from commands and does not read sample->tau
     * (thrusters.h). Then the parameters do not depend on the scale of the supplied thrust. Default
     * false. */
    bool own_thrust;

    /** Residual path: true if `residual` reads neither sample->tau nor sample->command, as that of
     * thrusters.h. Then derivatives by their delay are left out. Default false. */
    bool ignores_inputs;

    /** Residual path: true if `residual` has no kinks in the parameters that matter beside the
     * noise, and the cost no second minimum in the box. Then a search ends once a step of Algorithm
     * 2 in each direction confirms the end of the Gauss-Newton steps; the first one also evaluates
     * the population. A wrong true may give a wrong estimate without any sign: no step along a
     * single parameter may lead out of a kink or a local minimum
     * (tests/unit/search/test_optimizer_minima.c). If in doubt, leave it false, the default: the
     * steps' end is only one of the first points, both algorithms run and, if the delay is
     * searched, Algorithm 2 runs again from both sides of its end, at most six times
     * (auvid_identifier_neighbour.c). */
    bool smooth;

    /** Residual path: cost of one call of `regressor` in the same units; default (zero): as work.
     */
    uint16_t regressor_work;

    /** Residual path: writes the applied wrench tau[6] from time and commands, before `residual`
     * gets the sample with it. Returns false if the sample gives no row. It may read pi[i] only of
     * bits i of `thrust_parameters`: auvid keeps its wrench until one of them changes. Such a model
     * also sets ignores_inputs. NULL (default): the wrench is the recorded one. */
    bool (*thrust)(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                   auvid_real_t tau[AUVID_DOF_COUNT]);
    uint32_t thrust_parameters;
    uint16_t thrust_work; /**< cost of `thrust` in the same units; contained in `work` */

    /** Residual path: additional cost, in the same units, of a call of `thrust` or `regressor` at a
     * row that does not follow that of the last call with the same pi; of a model that carries a
     * state from row to row (thrusters.h). Default (zero): none. */
    uint16_t lead_work;

    /** Residual path: bit i: given all other parameters, and the delay, `residual` is an affine
     * function of these together. A search starts with their minimum in closed form. A wrong bit
     * costs time. Default (zero): none. */
    uint32_t affine;
} auvid_vehicle_t;

/** Checks the counts, masks and pointers of a model.
 * @return AUVID_OK; AUVID_ERR_NULL (vehicle or its parameter table is NULL); AUVID_ERR_SIZE
 * (built_for is NULL or not AUVID_BUILD: the model may have been compiled with other sizes);
 * AUVID_ERR_PARAMETERS (n out of range); AUVID_ERR_MODEL (no path; neither residual nor regressor;
 * `thrust` without residual or ignores_inputs; no DoF modelled; a mask or `affine` has a parameter
 * >= n; a parameter's dof is not modelled, or it is in other equations only;
 * `reads` of a DoF has a velocity >= 6 or lacks the DoF's own). Cost: O(n). */
auvid_status_t auvid_vehicle_check(const auvid_vehicle_t *vehicle);

/** Returns the DoF whose equations read a velocity that is not measured: bit j for DoF j. The
 * arguments are not checked. Cost: O(1).
 * @param missing bit i: nu[i] is not measured */
uint8_t auvid_vehicle_unmeasured(const auvid_vehicle_t *vehicle, uint8_t missing);

#define auvid_vehicle_residual AUVID_SIZED(auvid_vehicle_residual)
/** Computes predicted minus applied wrench (Eq. 2, Eq. 11) with the residual, or else with the
 * regressor. For inner loops: the arguments are not checked. Cost: one call of the model.
 * @param sample motion and applied wrench
 * @param pi [n] parameters
 * @param residual out, [6] N, Nm; 0 in DoF that are not modelled */
void auvid_vehicle_residual(const auvid_vehicle_t *vehicle, const auvid_sample_t *sample,
                            const auvid_real_t *pi, auvid_real_t residual[AUVID_DOF_COUNT]);

/** A disagreement within a model. Written by auvid_vehicle_selftest. */
typedef struct {
    /** "regressor": a row depends on sample->tau; "residual": on the regressor path, it differs
     * from the regressor; "columns": an equation has a parameter that is not in its columns;
     * "wrench": the residual is not predicted minus applied wrench; "reads": an equation depends
     * on a velocity that `reads` leaves out; "acceleration": with it the residual is not zero,
     * or there is none; "not finite": the residual */
    const char *what;
    int8_t dof;                   /**< its equation; -1: none */
    int8_t parameter;             /**< the parameter; -1: none, or the part without parameters */
    auvid_real_t value, expected; /**< row entry or residual [N, Nm] */
} auvid_vehicle_fault_t;

#define auvid_vehicle_selftest AUVID_SIZED(auvid_vehicle_selftest)
/** Compares regressor, residual, acceleration, columns and reads of a model with each other, at
 * 100 random samples: angles to 0.5 rad, velocities to 1 m/s and 1 rad/s, accelerations to 0.5, and
 * parameters of half to one and a half times pi. For a unit test of your model; not for the control
 * tick: it takes some thousand calls of the model, and 2 KiB of stack beside the model's.
 * @param pi [n] typical parameters, with which `acceleration` has a solution in every DoF
 * @param t_us time of all samples [us], for a model that reads it (thrusters.h)
 * @param tolerance largest difference, relative to the largest predicted wrench of the DoF; 0:
 * 1e-4. An averaged model needs 0.01, because its acceleration is that of the mean motion
 * @param fault written: the first disagreement, or all zero; NULL: not wanted
 * @return AUVID_OK; AUVID_ERR_MODEL (see *fault); AUVID_ERR_NULL (pi); AUVID_ERR_NOT_FINITE (pi,
 * tolerance); those of auvid_vehicle_check (fault->what is NULL). */
auvid_status_t auvid_vehicle_selftest(const auvid_vehicle_t *vehicle, const auvid_real_t *pi,
                                      uint64_t t_us, auvid_real_t tolerance,
                                      auvid_vehicle_fault_t *fault);

/**
 * A model for vehicles whose velocity changes faster than their DVL samples it.
 *
 * The recorder interpolates velocity between DVL samples and averages it over a cell. The mean of
 * the drag over that time is not the drag of the mean velocity:
 *
 *     mean |u|u = |u|u + sign(u) u'^2 s^2,   s^2 = T^2 / 6 + cell^2 / 12,
 *
 * T is the time between DVL samples. s^2 is the second moment of interpolation and cell mean. At
 * 5 Hz and 0.5 m/s^2 the difference is a force of 0.3 N in a BlueROV2, always along the motion.
 * Interpreted as linear drag, it makes X_u 2 % too large, for any amount of data. For a Girona500,
 * which needs seconds to change its velocity, the effect is negligible.
 *
 * This model averages the wrapped model's rows at two times, s before and s after the sample. The
 * mean is correct for quadratic drag and a good approximation for products of velocities. Angular
 * rates (s^2 = cell^2 / 12) are treated in the same way. The angles in the restoring terms are not
 * averaged.
 *
 *     static auvid_averaged_t model;
 *     (void)auvid_averaged_init(&model, &auvid_bluerov2_heavy, 100000, 200000);
 *     auvid_identifier_defaults(&cfg, &model.vehicle);
 *     cfg.metric.max_cell_us = 0;  // the average is over cells of this length
 *
 * The metric calls the regressor once for each cell. Cost: two calls of the wrapped regressor and n
 * means for each degree of freedom, 2.3k instructions of a Cortex-M4F for BlueROV2; 0.7 KiB of
 * stack with 22 parameters. Memory: sizeof(auvid_averaged_t), 108 bytes on a Cortex-M. The model is
 * not part of the paper. Unused code is not linked.
 *
 * It must not move while `vehicle`, which points back to it, is in use.
 */
typedef struct {
    auvid_vehicle_t vehicle;      /**< model for identifier, metric and validation */
    const auvid_vehicle_t *other; /* the wrapped model */
    auvid_real_t spread_s[2];     /* s of velocities and of angular rates [s] */
} auvid_averaged_t;

#define auvid_averaged_init AUVID_SIZED(auvid_averaged_init)
/** Makes a->vehicle, the averaged version of a model.
 * @param a out; unchanged if refused
 * @param vehicle the model to wrap, with regressor; must outlive *a; must not be &a->vehicle
 * @param cell_us the recorder's cell [us], 1000..1000000; the recorder's default is 100000
 * @param velocity_us time between velocity samples [us], 0..1000000, as in metric_config.h
 * @return AUVID_OK; AUVID_ERR_NULL; the errors of auvid_vehicle_check; AUVID_ERR_MODEL (the model
 * is not of the regressor path, or is &a->vehicle); AUVID_ERR_RANGE (a time). Cost: constant. */
auvid_status_t auvid_averaged_init(auvid_averaged_t *a, const auvid_vehicle_t *vehicle,
                                   uint32_t cell_us, uint32_t velocity_us);

/** A factor of a term. Velocities, their absolute values and accelerations are in the order of
 * auvid_dof_t: AUVID_FACTOR_U + j is nu[j]. */
typedef enum {
    AUVID_FACTOR_ONE = 0, /**< no factor */
    AUVID_FACTOR_U,       /**< velocity [m/s, rad/s] */
    AUVID_FACTOR_V,
    AUVID_FACTOR_W,
    AUVID_FACTOR_P,
    AUVID_FACTOR_Q,
    AUVID_FACTOR_R,
    AUVID_FACTOR_ABS_U, /**< absolute value of the velocity */
    AUVID_FACTOR_ABS_V,
    AUVID_FACTOR_ABS_W,
    AUVID_FACTOR_ABS_P,
    AUVID_FACTOR_ABS_Q,
    AUVID_FACTOR_ABS_R,
    AUVID_FACTOR_U_DOT, /**< acceleration [m/s2, rad/s2], at most one in a term */
    AUVID_FACTOR_V_DOT,
    AUVID_FACTOR_W_DOT,
    AUVID_FACTOR_P_DOT,
    AUVID_FACTOR_Q_DOT,
    AUVID_FACTOR_R_DOT,
    AUVID_FACTOR_SIN_PHI, /**< attitude */
    AUVID_FACTOR_COS_PHI,
    AUVID_FACTOR_SIN_THETA,
    AUVID_FACTOR_COS_THETA,
    AUVID_FACTOR_SIN_PSI,
    AUVID_FACTOR_COS_PSI,
    AUVID_FACTOR_TIME, /**< time since auvid_terms_t.begin_us [s], within +-24 days, to 1 ms */
    AUVID_FACTOR_COUNT
} auvid_factor_t;

/** A term of an equation: wrench[dof] = ... + sign * factors * pi[parameter]. Terms of the same
 * parameter and equation add up. */
typedef struct {
    uint8_t parameter; /**< index of the parameter */
    uint8_t dof;       /**< auvid_dof_t of the equation */
    int8_t sign;       /**< 1 or -1 */
    uint8_t factor[3]; /**< auvid_factor_t, in any order; 0: none */
} auvid_term_t;

/** A model as a table. */
typedef struct {
    const char *name;                   /**< display name */
    const auvid_parameter_t *parameter; /**< [parameters] */
    const auvid_term_t *term;           /**< [terms] */
    uint16_t terms;
    uint8_t parameters; /**< 1..AUVID_MAX_PARAMETERS */
} auvid_term_table_t;

/**
 * A model made from a table of terms: its rows, masks and acceleration follow from the table.
 *
 *     static const auvid_term_t term[] = { // X = m_u u' - X_uu |u| u
 *         {M_U, AUVID_SURGE, 1, {AUVID_FACTOR_U_DOT}},
 *         {X_UU, AUVID_SURGE, -1, {AUVID_FACTOR_ABS_U, AUVID_FACTOR_U}}};
 *
 * The acceleration solves M nu' = rest. M contains the terms with an acceleration, and need not be
 * symmetric. Where its symmetric part is not positive definite, the acceleration is not finite. The
 * acceleration of a DoF that is not modelled is read from the sample, as its velocity is.
 *
 * The applied wrench is no factor: a row must not read it. A column that contains it explains the
 * wrench by itself, and shrinks the parameters: of a loss of thrust with time, as a parameter, only
 * a quarter was found. Errors of the thrust are uncertain inputs (uncertain.h).
 *
 * `vehicle` points back to this struct, which must not move while it is in use. The table and what
 * it points to stay where they are, and may be in flash. Members of `vehicle` such as `free` may be
 * changed before it is used.
 *
 * Cost of the regressor: with Girona500's 27 terms, 960 instructions of a Cortex-M4F; the
 * hand-written one takes 210. It is called once for each cell. 200 bytes of stack, 400 for the
 * acceleration. Memory: sizeof(auvid_terms_t), 112 bytes on a Cortex-M; in flash 6 bytes for a
 * term, and 1.8 KiB of code. Unused code is not linked.
 */
typedef struct {
    auvid_vehicle_t vehicle; /**< model for identifier, metric and validation */
    uint64_t begin_us;       /**< where AUVID_FACTOR_TIME is 0 [us]; 0 after init; set it before the
                                  first sample */
    const auvid_term_table_t *table; /* as given */
    uint32_t factors;                /* bit f: factor f is in the table */
} auvid_terms_t;

#define auvid_terms_init AUVID_SIZED(auvid_terms_init)
/** Makes terms->vehicle, the model of a table, on the regressor path.
 * @param terms out; unchanged if refused
 * @param table must outlive *terms, as must what it points to
 * @param refusal written: what is refused, e.g. part "term", field "factor", element 3; NULL: not
 * wanted
 * @return AUVID_OK; AUVID_ERR_NULL (terms, the table, its parameters or terms);
 * AUVID_ERR_PARAMETERS (n out of range); AUVID_ERR_SIZE (no term); AUVID_ERR_RANGE (a term's
 * parameter, dof or factor does not exist; its sign is not 1 or -1); AUVID_ERR_MODEL (a term has
 * two accelerations, or repeats another one; the dof of a parameter does not exist, or its equation
 * has no term of the parameter). Cost: O(terms^2). */
auvid_status_t auvid_terms_init(auvid_terms_t *terms, const auvid_term_table_t *table,
                                auvid_refusal_t *refusal);

#define auvid_kinematics AUVID_SIZED0(auvid_kinematics)
/** Computes eta_dot = J(eta) nu (Eq. 1; Fossen 2011, Eq. 2.53).
 * @param phi, theta, psi attitude [rad], each within +-1e4
 * @param nu [6] body velocity [m/s, rad/s]
 * @param eta_dot out, [6] x y z [m/s], phi theta psi [rad/s]; must not alias nu
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (an angle beyond 1e4);
 * AUVID_ERR_SINGULAR (theta within 1e-3 rad of +-90 deg, where the angular part of J is singular).
 * Cost: three sincos. */
auvid_status_t auvid_kinematics(auvid_real_t phi, auvid_real_t theta, auvid_real_t psi,
                                const auvid_real_t *nu, auvid_real_t *eta_dot);

/** Parameters of the Girona500 model, in the order of the paper's results. X_0 .. N_0 are constant
 * forces and a moment on the hull [N, Nm] (a biased thruster, a trailing cable); the paper does not
 * have them. Z_0 and W-B are almost indistinguishable: free only one of them. If
 * AUVID_MAX_PARAMETERS is below 17, the model has only the paper's parameters. */
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

/** Bits of the 13 parameters of Eq. 12-15: the default of the free parameters. */
#define AUVID_G500_FREE 0x1FFFu
/** The same with X_0, Y_0, N_0; the constant of heave is W-B. */
#define AUVID_G500_FREE_BIAS (0x1FFFu | 1u << 13 | 1u << 14 | 1u << 16)

#if AUVID_MAX_PARAMETERS >= 13
/** Eq. 12-15, with Fossen's m_w w p in Eq. 13. */
extern const auvid_vehicle_t auvid_girona500;
/** Eq. 12-15 exactly as printed: m_w w q in Eq. 13. */
extern const auvid_vehicle_t auvid_girona500_printed;
/** Eq. 12-15 without the coupling terms of C(nu) nu: each DoF is independent. */
extern const auvid_vehicle_t auvid_girona500_decoupled;
#define auvid_girona500_paper AUVID_SIZED(auvid_girona500_paper)
/** The paper's 13 estimates (Section IV); the biases are 0. [AUVID_G500_COUNT] */
extern const auvid_real_t auvid_girona500_paper[AUVID_G500_COUNT];
#endif

#ifdef __cplusplus
}
#endif

#endif
