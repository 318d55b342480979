/**
 * @file estimate.h
 * What comes out: the estimate, its covariance, the drag force at a speed, what is identifiable,
 * and what is missing; and how a known force calibrates the thrust, so that it is in SI.
 *
 * auvid_identifier_estimate returns the estimate of the last search. Its `confidence` says how
 * accurate it is. The standard errors hold for correlated residuals. They contain the bias of the
 * masses by noise of the acceleration, the uncertainty of the delay, and what the user supplies
 * without knowing it exactly (auvid_uncertainty_t). They do not contain errors of the model itself,
 * nor disturbances whose time scale is longer than a set. detail/confidence.h has the method.
 *
 * A parameter is *identifiable* if its DoF was excited, and the 95 % half-width is at most 20 % of
 * the value. For a constant force the limit is 2 % of tau_max. The half-width includes all of the
 * above. Otherwise a note gives the reason (auvid_note_t).
 *
 * *Plausibility* (the paper's own check): masses are above the dry mass, drags are negative. An
 * estimate is impossible if it violates this by more than its half-width. The same holds if the
 * violating part explains more than a tenth of the wrench that is left to its equation, both as
 * rms over the rows. An impossible estimate makes the whole equation untrusted, two impossible
 * masses the whole result. The result must also explain the force at all.
 *
 * What an estimate promises, the most reliable first:
 *
 * 1. the drag force at speeds that were seen (auvid_estimate_drag, auvid_causes_drag);
 * 2. the acceleration in a run that it was not made from (validation.h, auvid_change_test_t);
 * 3. masses;
 * 4. a single coefficient of drag, only if it is identifiable. Otherwise only the force of linear
 *    and quadratic drag together is known.
 *
 * All functions only read. Memory: sizeof(auvid_estimate_t), of which an identifier has two.
 */
#ifndef AUVID_ESTIMATE_H
#define AUVID_ESTIMATE_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Finding about a parameter: why it is not identifiable or not plausible. */
typedef enum {
    AUVID_NOTE_NONE = 0,     /**< identifiable and plausible */
    AUVID_NOTE_FIXED,        /**< not free: the value is the configuration's */
    AUVID_NOTE_NOT_EXCITED,  /**< its degree of freedom was not excited, and coupling does not
                                  determine its equation. If its wrench was constant (it is
                                  unactuated), `partner` is 1, or 2 on the residual path, which
                                  does not try coupling; else 0 */
    AUVID_NOTE_COMBINATION,  /**< only a combination with parameter `partner` is known */
    AUVID_NOTE_SMALL,        /**< known to be too small to matter: its force is, with 95 %
                                 confidence, below AUVID_CONFIDENCE_SMALL of the rms force in every
                                 DoF */
    AUVID_NOTE_NOISE,        /**< a mass that the noise of the measured acceleration may bias */
    AUVID_NOTE_UNCERTAIN,    /**< `partner` 0: too little or too short motion for the present
                                  disturbance. 1: less than AUVID_CONFIDENCE_EXPLAINED of its
                                  equation's force is explained, and more motion does not help;
                                  `bound` is the share explained */
    AUVID_NOTE_IMPLAUSIBLE,  /**< identifiable, but the result explains the force of its DoF worse
                                 than the mean does: a sign, a unit, a bound or the model is
                                 wrong */
    AUVID_NOTE_AT_BOUND,     /**< the search ended at its `bound`: `partner` is 0 for the lower one,
                                 1 for the upper one. The value is within a thousandth of the
                                 distance of the two bounds, and within its half-width */
    AUVID_NOTE_BESIDE_BOUND, /**< its value depends on parameter `partner`, which is at its bound:
                                  without that bound it would differ by more than its half-width */
    AUVID_NOTE_NOT_CONVERGED, /**< the search has not converged (auvid_estimate_t.not_converged) */
    AUVID_NOTE_DISCREDITED,   /**< parameter `partner` of the same equation (possibly this one) is
                                 impossible: a mass not above the dry mass, or a drag that
                                 accelerates. It is so by more than its half-width, or its
                                 impossible part makes more than a tenth of the equation's rms
                                 wrench. Or two masses are impossible, and `partner` is one of
                                 them: thrust or velocity is wrong */
    AUVID_NOTE_THRUST_SCALE,  /**< identifiable relative to the supplied thrust; only the
                                 uncertainty of the thrust scale makes the half-width too large */
    AUVID_NOTE_FEEDBACK,  /**< closed loop: the wrench answers the motion, so motion by the thrust
                              cannot be told from motion by a disturbance. Its sigma does not hold.
                              `partner` 0: no parameter is identifiable, except by the reference of
                              the controller (auvid_instruments_t); 1: none of this DoF, which is
                              so by the configuration (closed_loop), or is roll or pitch */
    AUVID_NOTE_UNCHECKED, /**< identifiable if thrust and sensors are exact. They were not examined
                               for errors, or have too large ones: see auvid_confidence_t.unchecked.
                               `partner` 1: uncertain inputs are attached, but have too few rows for
                               a solution; 2: their errors are larger than configured; else 0 */
    AUVID_NOTE_INPUTS,    /**< known only if thrust and sensors are exact: errors of the inputs
                            (uncertain.h) look like it. More motion shows these, too */
    AUVID_NOTE_COUNT
} auvid_note_t;

/** Number of standard errors in a 95 % half-width; more than 1.96 because eight sets are few. */
#define AUVID_CONFIDENCE_HALF_WIDTH AUVID_C(2.1)
/** Half-width (95 %) up to which a parameter is identifiable, relative to its value. */
#define AUVID_CONFIDENCE_IDENTIFIABLE AUVID_C(0.2)
/** The same for an AUVID_PARAMETER_FORCE, relative to its DoF's tau_max. */
#define AUVID_CONFIDENCE_FORCE AUVID_C(0.02)
/** Part of a DoF's rms wrench below which the force of a parameter is small. */
#define AUVID_CONFIDENCE_SMALL AUVID_C(0.01)

/** Share of an equation's force (R2) below which no advice is given on its motion. */
#define AUVID_CONFIDENCE_EXPLAINED AUVID_C(0.5)

/** Number of entries of a covariance of all parameters, packed. */
#define AUVID_COVARIANCE (AUVID_MAX_PARAMETERS * (AUVID_MAX_PARAMETERS + 1) / 2)

/** Standard deviations of what the user supplies, does not know exactly, and no motion shows. */
typedef struct {
    auvid_real_t thrust_scale; /**< of the common scale of the supplied thrust, relative; 0..1 */
    auvid_real_t dvl_scale;    /**< of the scale of the DVL's velocity, relative; 0..1 */
    auvid_real_t delay_s;      /**< of the delay between supplied thrust and motion, where the data
                                    do not determine it [s]; 0..1. Above 0 the metric also estimates
                                    negative delays (late time stamps) */
} auvid_uncertainty_t;

/** The confidence in one estimate. Written by auvid_confidence_work. */
typedef struct {
    auvid_real_t sigma[AUVID_MAX_PARAMETERS]; /**< standard error, bias included [parameter's unit];
                                                   AUVID_LARGEST: not known, also that of a fixed
                                                   parameter (bit not in `identified`) */
    /** Signed change of each parameter by one standard deviation of the thrust scale, and of the
     * DVL's [parameter's unit]. The square of sigma contains their squares. */
    auvid_real_t thrust_error[AUVID_MAX_PARAMETERS];
    auvid_real_t dvl_error[AUVID_MAX_PARAMETERS];
    auvid_real_t bound[AUVID_MAX_PARAMETERS]; /**< depends on the note. AUVID_NOTE_AT_BOUND: the
                                                   bound [parameter's unit]; _DISCREDITED: the
                                                   impossible value [partner's unit]; _THRUST_SCALE:
                                                   the largest thrust_scale with which the parameter
                                                   is identifiable; _UNCERTAIN: the share of the
                                                   force that is explained, if
                                                   `partner` is 1 */
    /** effective noise: rms of white noise that gives the same standard errors [N, Nm];
     * 0: DoF not excited */
    auvid_real_t effective_noise[AUVID_DOF_COUNT];
    auvid_real_t residual_rms[AUVID_DOF_COUNT]; /**< rms residual, bands weighted [N, Nm] */
    auvid_uncertainty_t uncertainty;            /**< as passed to auvid_confidence_begin */
    uint32_t identifiable;                      /**< bit i: parameter i is identifiable */
    uint32_t implausible;                       /**< bit i: parameter i is impossible (then no
                                                     parameter of its equation is identifiable), or
                                                     has AUVID_NOTE_IMPLAUSIBLE */
    uint8_t note[AUVID_MAX_PARAMETERS];         /**< auvid_note_t */
    uint8_t partner[AUVID_MAX_PARAMETERS];      /**< see auvid_note_t; 0 for other notes */
    uint8_t sets; /**< number of data sets whose scatter the errors contain: those of the estimate
                       that were still in the ring when its search ended */
    uint8_t lost[AUVID_DOF_COUNT]; /**< rows of these sets lost to gaps in the record, or in a
                                        velocity that the DoF's equation reads [%]; 0 for DoF that
                                        are not excited */
    bool unchecked; /**< thrust and sensors were taken as exact, but for `uncertainty`, without
                         auvid_identifier_config_t.exact_inputs, or beside uncertain inputs; or
                         these have errors of more than twice their priors. Then no parameter and no
                         drag force is identifiable */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), 2 * AUVID_MAX_PARAMETERS + 8)];
} auvid_confidence_t;

/** Result of a search. */
typedef struct {
    uint64_t t_us;                         /**< last tick before it was ready */
    auvid_real_t pi[AUVID_MAX_PARAMETERS]; /**< parameters, in the model's order */
    /** Covariance of the n parameters if thrust and DVL scale are exact. Packed rows of the upper
     * triangle, the first of n entries; 0 if not known. For the total covariance, add the products
     * of confidence.thrust_error and of .dvl_error. */
    auvid_real_t covariance[AUVID_COVARIANCE];
    auvid_real_t speed[AUVID_DOF_COUNT][2]; /**< largest speed, >= 0, forward and backward, in the
                                                 sets in which the DoF was excited [m/s, rad/s] */
    auvid_real_t cost;                      /**< J, Eq. 11, in the metric's units */
    auvid_real_t delay_s[AUVID_DOF_COUNT];  /**< between wrench and response; negative: the wrench's
                                                time stamps are late */
    auvid_real_t r2_force[AUVID_DOF_COUNT]; /**< of the smoothed wrench; see auvid_metric_r2 */
    auvid_confidence_t confidence;          /**< its uncertainty; see auvid_confidence_t */
    uint32_t number;                        /**< from 1, incremented with each estimate */
    uint32_t sets;                          /**< data sets completed when its search was prepared */
    uint32_t identified; /**< bit i: parameter i was free, and its DoF excited or coupled. Others
                              have their fixed value, or the one that fits the excited DoF best
                              (auvid_metric_searched) */
    uint32_t evaluations_crs;  /**< cost evaluations of this search, global phase */
    uint32_t evaluations_line; /**< local phase */
    uint8_t excited;           /**< bit j: DoF j was excited */
    uint8_t coupled;           /**< bit j: DoF j was not excited, but coupling with those that were
                                    determined the parameters of its equation */
    uint8_t first_order_lag; /**< bit j: DoF j's delay is that of a first-order lag, not a shift */
    /** The search has not converged: a cap ended the local phase, or no point had a finite cost.
     * Regressor path also: the cost exceeds the minimum within the bounds by more than a
     * thousandth of it (including the part that no parameters explain). There nothing
     * is identifiable then. Residual path: the minimum is not known, and a search may end above it
     * unnoticed. A search ended by a cap keeps its flags: treat them with care. */
    bool not_converged;
    bool accepted; /**< it predicted a set that it had not seen, about as well as the last accepted
                        estimate, or better */
    uint8_t reserved[AUVID_GAP(8, 1 + sizeof(auvid_confidence_t) +
                                      (AUVID_MAX_PARAMETERS + AUVID_COVARIANCE + 25) *
                                          sizeof(auvid_real_t))];
} auvid_estimate_t;

/** Drag force at a speed. */
typedef struct {
    auvid_real_t speed;      /**< as requested; < 0: backward [m/s, rad/s] */
    auvid_real_t force;      /**< of the water on the hull [N, Nm]; opposite in sign to the speed if
                                  it dissipates */
    auvid_real_t sigma;      /**< standard error [N, Nm]; AUVID_LARGEST: not known */
    auvid_real_t half_width; /**< of the 95 % interval: AUVID_CONFIDENCE_HALF_WIDTH sigma;
                                  AUVID_LARGEST: not known */
    bool identifiable; /**< the half-width is at most AUVID_CONFIDENCE_IDENTIFIABLE of the force,
                            the force opposes the motion, the DoF was excited up to this speed in
                            this direction, no parameter of its equation is implausible, and the
                            search converged */
} auvid_drag_t;

/** Largest speed of an identifiable drag force, relative to the largest speed in the data. */
#define AUVID_DRAG_REACH AUVID_C(1.05)

/** How well the last estimate predicted the newest set, before that set was used; and how far the
 * last accepted estimate is from the first one. A change within a set or two shows in the sets, a
 * slow one only in the estimates, which follow it. */
typedef struct {
    auvid_real_t variance_ratio[AUVID_DOF_COUNT]; /**< mean square of the force residual over that
                            of the estimate's own data; about 1, more while there are few sets */
    auvid_real_t change[AUVID_DOF_COUNT]; /**< evidence for other parameters in this DoF: Chow's F
                            less 1, over its threshold, with the noise of the newest sets if they
                            are noisier. In the DoF with the most evidence, at least that of the sum
                            over the sum's threshold. Above 1: the vehicle has changed, or, if auvid
                            has not excited the set, may have: the next set decides. 0: none, or
                            fewer than six sets, or an estimate of fewer than five */
    auvid_real_t r2_velocity[AUVID_DOF_COUNT]; /**< of the velocity simulated through the set, from
                            the time of the estimate on; see validation.h */
    auvid_real_t drift[AUVID_DOF_COUNT]; /**< evidence that mass or drag force of this DoF differ
                            between the first accepted estimate and the last one: the difference
                            over its standard error if thrust and DVL scale are exact, over its
                            threshold 6. In the DoF with the most evidence, at least that for a
                            common relative difference of all drag forces. Above 1: the vehicle has
                            drifted. 0: none, or no estimate of five sets that knew them was
                            accepted before, or the DoF is in closed loop: its parameters are
                            biased. Kept while none is accepted, or all are in closed loop */
    uint32_t set;      /**< number of the set, from 1; 0: none was validated yet */
    uint32_t estimate; /**< number of the estimate that predicted it */
    uint8_t excited;   /**< bit j: DoF j was excited in it and in the estimate's data */
    uint8_t changed;   /**< bit j: the vehicle has changed, most clearly in this DoF; 0: no change,
                            or too few sets for a test */
    uint8_t simulated; /**< bit j: r2_velocity[j] is valid; 0 unless
                            auvid_identifier_attach_prediction was called */
    uint8_t drifted;   /**< bit j: the vehicle has drifted since the first accepted estimate, most
                            clearly in this DoF; 0: no drift, or see drift */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), 12)];
} auvid_change_test_t;

#define auvid_estimate_covariance AUVID_SIZED(auvid_estimate_covariance)
/** Covariance of two parameters if thrust and DVL scale are exact; i = k: a variance. For the total
 * add thrust_error[i] thrust_error[k] + dvl_error[i] dvl_error[k] of the confidence.
 * @param vehicle the estimate's model
 * @param i, k numbers of parameters, in either order
 * @return in the product of their units; 0 if one of them is not known, a pointer is NULL or a
 * number is out of range. Cost: O(1). */
auvid_real_t auvid_estimate_covariance(const auvid_estimate_t *estimate,
                                       const auvid_vehicle_t *vehicle, int i, int k);

#define auvid_estimate_drag AUVID_SIZED(auvid_estimate_drag)
/** Drag force of one degree of freedom at a speed, of one curve for both directions, with its
 * uncertainty. With uncertain inputs auvid_causes_drag (uncertain.h) has that of each direction.
 *
 *     F = a' pi,  a = (v, |v| v),  sigma^2 = a' C a + (a' d_thrust)^2 + (a' d_dvl)^2
 *
 * over the parameters of the kinds AUVID_PARAMETER_LINEAR_DRAG and _QUADRATIC_DRAG of this `dof`.
 * C, d_thrust and d_dvl are the estimate's covariance, confidence.thrust_error and .dvl_error.
 * Linear and quadratic drag are correlated: F may be known although neither of them is. It is the
 * force of a motion like the recorded one: where other DoF moved, too, it contains the cross-flow
 * drag that they added. If the model has a current, the speed is that through the water, but the
 * largest speed in the data is the recorded one.
 * @param vehicle the estimate's model; averaged models, current.h and thrusters.h keep the
 * hull's drag
 * @param speed [m/s, rad/s], < 0: backward; up to +-AUVID_RECORDER_LARGEST. Reliable from 0.3 to 1
 * of estimate->speed
 * @param drag written if AUVID_OK. A fixed parameter is exact; an unknown standard error makes
 * sigma and half_width AUVID_LARGEST
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NO_DATA (no estimate yet); AUVID_ERR_NOT_FINITE
 * (speed); AUVID_ERR_RANGE (speed; the model has no drag in this DoF). Cost: O(n), at most 0.8
 * thousand instructions of a Cortex-M4F for Girona500. */
auvid_status_t auvid_estimate_drag(const auvid_estimate_t *estimate, const auvid_vehicle_t *vehicle,
                                   auvid_dof_t dof, auvid_real_t speed, auvid_drag_t *drag);

/** Returns a short English phrase for a note; never NULL; empty for AUVID_NOTE_NONE. It cannot name
 * the partner: auvid_confidence_note does. */
const char *auvid_note_str(auvid_note_t note);

#define auvid_confidence_note AUVID_SIZED(auvid_confidence_note)
/** Write the note of parameter i as auvid_note_str does, but with the name of its partner: "only a
 * combination with X_uu". Cost: O(size).
 * @param vehicle the model of the estimate
 * @param text [size] written, truncated to size and always zero-terminated; empty for
 * AUVID_NOTE_NONE
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (size 0, or the model has no parameter i). */
auvid_status_t auvid_confidence_note(const auvid_confidence_t *confidence,
                                     const auvid_vehicle_t *vehicle, int i, char *text,
                                     size_t size);

/** Share of rows lost to gaps from which auvid_confidence_missing reports it [%]. */
#define AUVID_CONFIDENCE_LOST_PERCENT 20

#define auvid_confidence_missing AUVID_SIZED(auvid_confidence_missing)
/** Write one sentence on what is wrong or missing: "yaw: not excited; apply steps held 4-8 s and
 * sines of 0.1-0.3 Hz". Equations whose force is not explained, or whose estimate is impossible,
 * come first; for these no sentence asks for motion. With uncertain inputs, ask first
 * auvid_causes_sentence (uncertain.h), which names causes. If at least
 * AUVID_CONFIDENCE_LOST_PERCENT of the rows of a DoF were lost to gaps, the last sentence gives the
 * largest share and its DoF. Cost: O(n).
 * @param confidence of an estimate, or NULL if there is none yet: then each DoF is called not
 * excited, also where nothing is recorded (look at auvid_output_t.events)
 * @param vehicle its model
 * @param free bit i: parameter i was to be identified (0: all)
 * @param which 0, 1, ... : sentence number
 * @param text [size] written, truncated to size and always zero-terminated; empty if there is no
 * such sentence
 * @return AUVID_OK; AUVID_FINISHED (there are not so many sentences); AUVID_ERR_NULL (vehicle or
 * text); AUVID_ERR_RANGE (size 0). */
auvid_status_t auvid_confidence_missing(const auvid_confidence_t *confidence,
                                        const auvid_vehicle_t *vehicle, uint32_t free,
                                        unsigned which, char *text, size_t size);

/* ---- known force ---- */

/**
 * A force on the vehicle that is known exactly: a weight hung on it, or the pull of a rope with a
 * spring scale. All zeros: none.
 */
typedef struct {
    auvid_real_t world[3]; /**< north, east, down [N]: of a weight in water, down */
    auvid_real_t body[3];  /**< ahead, to starboard, down, in the vehicle's axes [N] */
    auvid_real_t at[3];    /**< where both act, in the vehicle's axes, from its origin [m] */
    auvid_real_t mass_kg;  /**< of what moves with the vehicle there, with its added mass; 0..1e4 */
} auvid_known_force_t;

/** Changes of the known force that are kept for cells of an earlier time; changes closer together
 * replace each other [us]. */
#define AUVID_KNOWN_CHANGES 32
#define AUVID_KNOWN_SPACING_US 50000u

/** A change. Private. */
typedef struct {
    uint64_t t_us;
    auvid_known_force_t force;
} auvid_known_change_t;

/**
 * A model with a known force, which calibrates the thrust.
 *
 * No motion shows a common scale of the supplied thrust: supplied thrust that is 20 % too strong
 * gives masses and drags that are 20 % too large, and equations that fit as well. A known force
 * shows it. With tau the supplied wrench, k its ratio to the true one, and f the known wrench,
 *
 *     tau / k + f = Y pi,    so    tau = Y (k pi) - f k,
 *
 * which is linear in k pi and k. This model wraps another one and has k, named k_tau, as a further
 * parameter, with the column -f in each equation. auvid_calibrated_estimate divides by k. Where the
 * model has AUVID_MAX_PARAMETERS already, k_tau takes the place of the last one that is not free by
 * default, which is then 0.
 *
 *     static auvid_calibrated_t model;
 *     (void)auvid_calibrated_init(&model, &auvid_girona500, AUVID_HEAVE);
 *     auvid_identifier_defaults(&cfg, &model.vehicle);
 *     cfg.metric.fixed[model.k] = 1;                      // until the force has shown it
 *     auvid_known_force_t weight = {.world = {0, 0, 8.6f}, .mass_kg = 1};
 *     (void)auvid_calibrated_force(&model, now_us, &weight);  // hung on; NULL: taken off
 *     (void)auvid_calibrated_estimate(&model, auvid_identifier_estimate(&id), &si);
 *
 * The force must be on for a part of the data and off for another, both with excitation, best for
 * about half of them. A weight that never changes is not separable from W-B
 * (AUVID_NOTE_COMBINATION). All thrusters have one k. With uncertain inputs (uncertain.h) each may
 * deviate from it by its gain, so a weight says more of the vertical thrusters than of the others.
 * A weight that turns with the vehicle (mass_kg) has its own inertia, and its moments follow from
 * `at`. Its drag is neglected. Without mass_kg the mean mass is too large by the weight's, times
 * the part of the time that it was on.
 *
 * The applied wrench (auvid_input_t.applied) is that of the thrusters, without the known force. A
 * checkpoint does not contain the force: give it again after a restore.
 *
 * Regressor path only. k_tau has a column in each equation, also of the uncertain inputs: a
 * BlueROV2 Heavy in six degrees of freedom then needs AUVID_MAX_UNCERTAIN 146, Girona500 the
 * default. An equation gives no rows while any velocity is unmeasured. Cost of the
 * regressor: the wrapped one's, a rotation matrix and five cross products. Memory:
 * sizeof(auvid_calibrated_t), 2 KiB. None of it is in the paper. Unused code is not linked. It must
 * not move while `vehicle` is in use.
 */
typedef struct {
    auvid_vehicle_t vehicle;      /**< model for identifier, metric and validation */
    const auvid_vehicle_t *other; /* the wrapped model */
    auvid_parameter_t parameter[AUVID_MAX_PARAMETERS]; /**< parameters of `vehicle` */
    /** Dry mass [kg], >= 0; 0: not known. It may be set after auvid_calibrated_init, instead
     * of that of auvid_identifier_config_t, which is in the unit of the supplied thrust. */
    auvid_real_t dry_mass_kg;
    auvid_known_change_t change[AUVID_KNOWN_CHANGES];
    uint32_t changes; /* so far */
    uint8_t k;        /**< number of k_tau */
} auvid_calibrated_t;

#define auvid_calibrated_init AUVID_SIZED(auvid_calibrated_init)
/** Makes c->vehicle, the model of a vehicle with a known force, which is zero at first.
 * @param c out; unchanged if refused
 * @param vehicle the model to wrap, on the regressor path; must outlive *c; must not be &c->vehicle
 * @param dof in which the force acts most, AUVID_HEAVE of a weight: k is known only if this one is
 * excited
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_PARAMETERS (AUVID_MAX_PARAMETERS are free);
 * AUVID_ERR_MODEL (it is not on the regressor path, is &c->vehicle, or does not model `dof`); the
 * errors of auvid_vehicle_check. Cost: O(n). */
auvid_status_t auvid_calibrated_init(auvid_calibrated_t *c, const auvid_vehicle_t *vehicle,
                                     auvid_dof_t dof);

#define auvid_calibrated_force AUVID_SIZED(auvid_calibrated_force)
/** Sets the known force from t_us on. Call it when the force changes, before the data of that time.
 * A change less than AUVID_KNOWN_SPACING_US after the last one replaces it. A force that changes
 * all the time is taken as constant in between.
 * @param t_us in the time of the identifier [us]; 0 as the first one
 * @param force copied; NULL: none. Each component within +-1e5 N, `at` within +-100 m
 * @return AUVID_OK; AUVID_ERR_NULL (c); AUVID_ERR_STATE (not initialised); AUVID_ERR_NOT_FINITE;
 * AUVID_ERR_RANGE; AUVID_ERR_TIME_BACK (before the last change). Refused: nothing has changed.
 * Cost: O(1). */
auvid_status_t auvid_calibrated_force(auvid_calibrated_t *c, uint64_t t_us,
                                      const auvid_known_force_t *force);

#define auvid_calibrated_clear AUVID_SIZED(auvid_calibrated_clear)
/** Forgets all changes: the force is zero, and time may begin again. NULL is a no-op. */
void auvid_calibrated_clear(auvid_calibrated_t *c);

#define auvid_calibrated_estimate AUVID_SIZED(auvid_calibrated_estimate)
/** Converts an estimate of c->vehicle to SI: divides parameters and errors by k, and replaces the
 * considered scale of the thrust by the error of k. k combines the data with the prior, 1 with
 * confidence.uncertainty.thrust_scale; a prior that the data contradict is widened to what was
 * found. Parameters whose only fault was the thrust scale become identifiable. What is not
 * converted: fixed parameters, cost, residuals and noise; a parameter's plausibility.
 *
 * Use the converted estimate for masses, drag and W-B in SI. Prediction, aiding and feed-forward
 * take the one of the identifier, whose unit is the supplied thrust.
 * @param estimate the identifier's
 * @param si written if >= 0; may be `estimate`. pi[c->k] is k: above 1 the supplied thrust is too
 * strong. It is identifiable if the data say more of it than the prior
 * @return AUVID_OK; AUVID_UNUSED (the data hardly show k, their standard error of it is more than
 * twice the prior's: *si is *estimate with k = 1 of unknown error, and after any change of the
 * force no constant force is identifiable); AUVID_ERR_NULL (also `estimate`, if there is none);
 * AUVID_ERR_STATE (not initialised); AUVID_ERR_NO_DATA (no estimate yet); AUVID_ERR_RANGE (k is not
 * within 1/3..3, or a mass in SI is below dry_mass_kg by more than its half-width: the force has
 * another sign, size or unit than it was given, and no number is known in SI). Cost: O(n^2). */
auvid_status_t auvid_calibrated_estimate(const auvid_calibrated_t *c,
                                         const auvid_estimate_t *estimate, auvid_estimate_t *si);

#ifdef __cplusplus
}
#endif

#endif
