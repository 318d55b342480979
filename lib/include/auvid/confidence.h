/**
 * @file confidence.h
 * Confidence: how accurate is an estimate, which parameters can it not determine, and which motion
 * is missing?
 *
 * After a search the residuals at its result are examined again, set by set:
 * - *Standard errors* that hold for correlated residuals. The smoothing and the disturbances of the
 *   vehicle correlate the residuals of neighbouring rows, so the inverse of the normal matrix is
 *   too small. With g_s the score (gradient of half the cost) of set s, the covariance is the
 *   sandwich P (sum_s g_s g_s') P. Eight sets are few, so the size of the scores is pooled over the
 *   parameters of each DoF. It is combined with what the smoothing makes of white noise, and with
 *   the scatter of the scores for each parameter.
 * - *Bias* of the masses: noise of the measured acceleration makes them smaller. The size of the
 *   bias is predicted from the high band of the residuals and added to the uncertainty. The
 *   estimate is not corrected.
 * - *Considered parameters*: the common scale of the supplied thrust, and that of the DVL. No
 *   motion shows them, so they are not estimated. The change of the estimate by one standard
 *   deviation of each is added to the uncertainty (auvid_confidence_judge.c). With the thrust scale
 *   all parameters change in proportion, thrust_error = thrust_scale pi, unless some are fixed:
 *   fixed drags are accounted for, fixed masses are assumed orthogonal to the rest. On the residual
 *   path, parameters of kind OTHER are assumed not to scale; with vehicle.own_thrust
 *   no parameter scales.
 * - *Identifiable*: the DoF was excited, and the 95 % half-width is at most 20 % of the value. For
 * a
 *   constant force the limit is 2 % of tau_max. The half-width includes all of the above. Otherwise
 *   a note gives the reason. The DoF was not excited. Only a combination with another parameter is
 *   known. The force is too small to matter. There is too little motion. The search has not
 *   converged. The parameter is at its bound. It changes by more than its half-width if another
 *   parameter is released from its bound. Only the thrust scale prevents it.
 * - *Plausibility* (the paper's own check): masses are above the dry mass, drags are negative. An
 *   estimate is impossible if it violates this by more than its half-width. The same holds if the
 *   violating part explains more than a tenth of the wrench that is left to its equation, both as
 *   rms over the rows. An impossible estimate makes the whole equation untrusted.
 *   The result must also explain the force at all.
 * If a delay was estimated, its uncertainty is part of the standard errors. With
 * uncertainty.delay_s > 0 the delay of every excited DoF is uncertain, whether it was estimated,
 * given or zero. Its standard deviation about the value in use is delay_s. That of half its second
 * moment (a lag of another shape, such as that of a propeller's speed) is 2 delay_s^2. The standard
 * errors contain the widening by both, and the step of the parameters to the most probable delay
 * and shape. In the residual path this holds if the delay is searched.
 * The standard errors do not contain errors of the model itself, nor disturbances whose time scale
 * is longer than a set.
 *
 * The identifier calls it after the measurement of a result and before the metric's next merge.
 * Cost, Girona500 and eight sets: 7.7k units of work (8.3k with uncertain delays), 0.26 million
 * multiplications. Memory: sizeof(auvid_confidence_job_t), 2.7 KiB, and the result.
 *
 * Sources: White 1980 (sandwich); Bell & McCaffrey 2002 (few clusters);
 * Fuller 1987, 1.2 (errors in variables). None of it is in the paper.
 */
#ifndef AUVID_CONFIDENCE_H
#define AUVID_CONFIDENCE_H

#include "auvid/metric.h"
#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Finding about a parameter: why it is not identifiable or not plausible. */
typedef enum {
    AUVID_NOTE_NONE = 0,     /**< identifiable and plausible */
    AUVID_NOTE_FIXED,        /**< not free: the value is the configuration's */
    AUVID_NOTE_NOT_EXCITED,  /**< its degree of freedom was not excited */
    AUVID_NOTE_COMBINATION,  /**< only a combination with parameter `partner` is known */
    AUVID_NOTE_SMALL,        /**< known to be too small to matter: its force is, with 95 %
                                 confidence, below AUVID_CONFIDENCE_SMALL of the rms force in every
                                 DoF */
    AUVID_NOTE_NOISE,        /**< a mass that the noise of the measured acceleration may bias */
    AUVID_NOTE_UNCERTAIN,    /**< too little or too short motion for the present disturbance */
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
                                 wrench */
    AUVID_NOTE_THRUST_SCALE,  /**< identifiable relative to the supplied thrust; only the
                                 uncertainty of the thrust scale makes the half-width too large */
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
                                                   AUVID_LARGEST: not known */
    /** Signed change of each parameter by one standard deviation of the thrust scale, and of the
     * DVL's [parameter's unit]. The square of sigma contains their squares. */
    auvid_real_t thrust_error[AUVID_MAX_PARAMETERS];
    auvid_real_t dvl_error[AUVID_MAX_PARAMETERS];
    auvid_real_t bound[AUVID_MAX_PARAMETERS]; /**< depends on the note. AUVID_NOTE_AT_BOUND: the
                                                   bound [parameter's unit]; _DISCREDITED: the
                                                   impossible value [partner's unit]; _THRUST_SCALE:
                                                   the largest thrust_scale with which the parameter
                                                   is identifiable */
    uint32_t identifiable;                    /**< bit i: parameter i is identifiable */
    uint32_t implausible;                     /**< bit i: parameter i is impossible (then no
                                                   parameter of its equation is identifiable), or
                                                   has AUVID_NOTE_IMPLAUSIBLE */
    uint8_t note[AUVID_MAX_PARAMETERS];       /**< auvid_note_t */
    uint8_t partner[AUVID_MAX_PARAMETERS];    /**< see auvid_note_t; 0 for other notes */
    uint8_t sets; /**< number of data sets whose scatter the errors contain: those of the estimate
                       that were still in the ring when its search ended */
    uint8_t lost[AUVID_DOF_COUNT]; /**< rows of these sets lost to gaps in the record, or in a
                                        velocity that the DoF's equation reads [%]; 0 for DoF that
                                        are not excited */
    /** effective noise: rms of white noise that gives the same standard errors [N, Nm];
     * 0: DoF not excited */
    auvid_real_t effective_noise[AUVID_DOF_COUNT];
    auvid_real_t residual_rms[AUVID_DOF_COUNT]; /**< rms residual, bands weighted [N, Nm] */
    auvid_uncertainty_t uncertainty;            /**< as passed to auvid_confidence_begin */
} auvid_confidence_t;

/** The computation. Private. */
typedef struct {
    const auvid_metric_t *metric; /* during a call only */
    auvid_confidence_t result;
    auvid_real_t dry_mass_kg;
    auvid_real_t pi[AUVID_MAX_PARAMETERS]; /* the estimate */
    /* the optimum of each DoF's equation, then minus the weights of its delay */
    auvid_real_t single_dof_optimum[AUVID_MAX_COLUMNS];
    /* joint R factor J: J'J = sum w H */
    auvid_real_t joint_factor[AUVID_MAX_PARAMETERS * (AUVID_MAX_PARAMETERS + 1) / 2];
    union {
        /* of one DoF of one set, whitened; or one DoF's R factor with its delay first */
        auvid_real_t part[(AUVID_MAX_PARAMETERS + 3) * (AUVID_MAX_PARAMETERS + 4) / 2];
        auvid_regressor_t regressor;               /* between the phases SCATTER and JUDGE */
        auvid_real_t covariance[AUVID_COVARIANCE]; /* from JUDGE on; copied to the estimate */
    };
    auvid_real_t score[AUVID_MAX_PARAMETERS];     /* of one DoF of one set, at its optimum */
    auvid_real_t influence[AUVID_MAX_PARAMETERS]; /* of one set on the estimate */
    auvid_real_t sum[AUVID_MAX_PARAMETERS], squares[AUVID_MAX_PARAMETERS]; /* of influences */
    auvid_real_t variance[AUVID_MAX_PARAMETERS]; /* diagonal of (J'J)^-1 */
    auvid_real_t widening[AUVID_MAX_PARAMETERS]; /* of it, for estimated and uncertain delays */
    /* step of the parameters to the most probable delays */
    auvid_real_t delay_step[AUVID_MAX_PARAMETERS];
    auvid_real_t scatter[AUVID_DOF_COUNT], degrees_of_freedom[AUVID_DOF_COUNT]; /* of the scores */
    auvid_real_t rows[AUVID_DOF_COUNT];
    uint8_t column_of[AUVID_MAX_PARAMETERS];    /* of parameter i in the joint factor; or NOWHERE */
    uint8_t parameter_of[AUVID_MAX_PARAMETERS]; /* of column k */
    uint32_t at_bound;                          /* bit i: parameter i is near a bound */
    uint8_t n, spent, phase, at_set, at_dof, at_row;
    bool not_converged; /* the search has not converged */
    bool delayed;       /* the widening by estimated or uncertain delays is being computed */
} auvid_confidence_job_t;

#define auvid_confidence_begin AUVID_SIZED(auvid_confidence_begin)
/** Begin the computation. The metric must not change until it is complete. NULL is a no-op.
 * @param metric merged; pi must be its last measurement (regressor path), or the point at which it
 * is linearised (residual path)
 * @param pi [n] the result of a search over the parameters auvid_metric_searched
 * @param dry_mass_kg plausible masses are above it [kg]; 0: above zero
 * @param uncertainty of the supplied thrust and DVL; NULL: none */
void auvid_confidence_begin(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                            const auvid_real_t *pi, auvid_real_t dry_mass_kg,
                            const auvid_uncertainty_t *uncertainty);

#define auvid_confidence_limits AUVID_SIZED(auvid_confidence_limits)
/** Set what limited the search. Call it after auvid_confidence_begin; without it no limit is
 * assumed. NULL is a no-op.
 * @param lower, upper [n] bounds of the search
 * @param not_converged the search has not converged: no parameter is identifiable */
void auvid_confidence_limits(auvid_confidence_job_t *job, const auvid_real_t *lower,
                             const auvid_real_t *upper, bool not_converged);

#define auvid_confidence_work AUVID_SIZED(auvid_confidence_work)
/** Continue the computation started by auvid_confidence_begin.
 * @param metric the same as in auvid_confidence_begin
 * @param budget units of work left, reduced by those used: 6 to 80 for each row of an R factor
 * @return AUVID_OK (job->result is written); AUVID_PENDING (budget used up); AUVID_ERR_NULL. */
auvid_status_t auvid_confidence_work(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                                     uint32_t *budget);

/** Returns a short English phrase for a note; never NULL; empty for AUVID_NOTE_NONE. It cannot name
 * the partner: auvid_confidence_note does. */
const char *auvid_note_str(auvid_note_t note);

#define auvid_confidence_note AUVID_SIZED1(auvid_confidence_note, AUVID_MAX_PARAMETERS)
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

#define auvid_confidence_missing AUVID_SIZED1(auvid_confidence_missing, AUVID_MAX_PARAMETERS)
/** Write one sentence on the motion, or setting, that is missing: "yaw: not excited; apply steps
 * held 4-8 s and sines of 0.1-0.3 Hz". If at least AUVID_CONFIDENCE_LOST_PERCENT of the rows of a
 * DoF were lost to gaps, the last sentence gives the largest share and its DoF. Cost:
 * O(n).
 * @param confidence of an estimate, or NULL if there is none yet
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

#ifdef __cplusplus
}
#endif

#endif
