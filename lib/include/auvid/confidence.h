/**
 * @file confidence.h
 * Confidence: how sure is an estimate, what can it not know, and which motion is missing?
 *
 * After a search the residuals at its result are taken apart again, set by set:
 * - *Standard errors* that are right for correlated residuals. The residual of neighbouring rows is
 *   correlated by the smoothing and by whatever disturbs the vehicle, so the inverse of the normal
 *   matrix is too small. With g_s the score (gradient of half the cost) of set s, the covariance is
 *   the sandwich P (sum_s g_s g_s') P. Eight sets are few: the scores' size is pooled over the
 *   parameters of each DoF, held against what the smoothing alone makes of white noise, and mixed
 *   with the scores' own scatter for each parameter.
 * - *Bias* of the masses: noise of the measured acceleration makes them smaller. Its size is
 *   predicted from the high band of the residuals and added to the uncertainty, not corrected.
 * - *Considered*: the common scale of the thrust as told, and that of the DVL. No motion shows
 *   them, so they are not estimated. What one standard deviation of them moves the parameters by is
 *   added to the uncertainty (auvid_confidence_judge.c). With the thrust scale all move alike,
 *   thrust_error = thrust_scale pi, unless parameters are fixed: known drags are allowed for, known
 *   masses are taken as orthogonal to the rest. Of a model without regressor, parameters of kind
 *   OTHER are taken not to scale; with vehicle.own_thrust none does.
 * - *Identifiable*: the DoF was driven, and the 95 % half-width, all of this included, is at most
 *   20 % of the value; of a constant force, 2 % of tau_max. Else a note says why not: the DoF was
 *   not driven; only a combination with another parameter is known; its force is too small to
 *   matter; too little motion; the search has not converged; it is at its bound, or moves by more
 *   than its half-width when another one that is at its bound is released; the thrust scale
 *   alone prevents it.
 * - *Plausibility* (the paper's own check): masses above the dry mass, drags negative. An estimate
 *   that is impossible by more than its half-width, or whose impossible part makes more than a
 *   tenth of the rms wrench that its equation has left to explain, discredits the whole equation.
 *   (Both are rms over the rows.) And the force is explained at all.
 * Where a delay was estimated, its uncertainty is part of the standard errors. With
 * uncertainty.delay_s > 0 that of every driven DoF's delay is, estimated, given or taken for none:
 * the delay has that standard deviation about the value in use, half its second moment (a lag of
 * another shape, such as that of a propeller's speed) twice its square. The standard errors
 * contain the widening by both, and the step that the parameters would take to the most probable
 * delay and shape. In the residual path this holds where the delay is searched.
 * Disturbances whose time scale is longer than a set, and errors of the model itself, are not in
 * them.
 *
 * Called by the identifier, after the measurement of a result and before the metric's next merge.
 * Cost, Girona500 and eight sets: 7.7k units of work (8.3k with uncertain delays), 0.26
 * million multiplications. Memory:
 * sizeof(auvid_confidence_job_t), 2.5 KiB, and the result.
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

/** What is to be said about a parameter. */
typedef enum {
    AUVID_NOTE_NONE = 0,     /**< identifiable and plausible */
    AUVID_NOTE_FIXED,        /**< not free: the value is the configuration's */
    AUVID_NOTE_NOT_EXCITED,  /**< its degree of freedom was not driven */
    AUVID_NOTE_COMBINATION,  /**< only a combination with parameter `partner` is known */
    AUVID_NOTE_SMALL,        /**< too small to tell from zero, and known to be: with certainty its
                                 force is below AUVID_CONFIDENCE_SMALL of the rms force, in every
                                 DoF */
    AUVID_NOTE_NOISE,        /**< a mass that the noise of the measured acceleration may bias */
    AUVID_NOTE_UNCERTAIN,    /**< too little motion, or too short, for the disturbance there is */
    AUVID_NOTE_IMPLAUSIBLE,  /**< identifiable, but in a DoF whose force the result explains worse
                                 than its mean does: a sign, a unit, a bound or the model is
                                 wrong */
    AUVID_NOTE_AT_BOUND,     /**< the search stopped it at its `bound`: `partner` is 0 for the lower
                                 one, 1 for the upper one. Within a thousandth of the distance of
                                 the two, and not further from it than its half-width */
    AUVID_NOTE_BESIDE_BOUND, /**< its value depends on parameter `partner`, which is at its bound:
                                  without that bound it would differ by more than its half-width */
    AUVID_NOTE_NOT_CONVERGED, /**< the search has not converged (auvid_estimate_t.capped) */
    AUVID_NOTE_DISCREDITED, /**< parameter `partner` of the same equation (maybe this one itself) is
                                 impossible: a mass not above the dry mass, a drag that drives.
                                 It is so by more than its half-width, or its impossible part makes
                                 more than a tenth of the equation's rms wrench */
    AUVID_NOTE_THRUST_SCALE, /**< identifiable with the thrust as told; the uncertainty of its scale
                                 alone makes the half-width too large */
    AUVID_NOTE_COUNT
} auvid_note_t;

/** Standard errors in a 95 % half-width: eight sets are few. */
#define AUVID_CONFIDENCE_HALF_WIDTH AUVID_C(2.1)
/** Half-width (95 %) up to which a parameter is identifiable, relative to its value. */
#define AUVID_CONFIDENCE_IDENTIFIABLE AUVID_C(0.2)
/** The same of an AUVID_PARAMETER_FORCE, relative to its DoF's tau_max. */
#define AUVID_CONFIDENCE_FORCE AUVID_C(0.02)
/** Part of a DoF's rms wrench below which a parameter's share is small. */
#define AUVID_CONFIDENCE_SMALL AUVID_C(0.01)

/** Entries of a covariance of all parameters, packed. */
#define AUVID_COVARIANCE (AUVID_MAX_PARAMETERS * (AUVID_MAX_PARAMETERS + 1) / 2)

/** What the user supplies but does not know exactly, and no motion shows: standard deviations. */
typedef struct {
    auvid_real_t thrust_scale; /**< of the common scale of the thrust as told, relative; 0..1 */
    auvid_real_t dvl_scale;    /**< of the scale of the DVL's velocity, relative; 0..1 */
    auvid_real_t delay_s;      /**< of the delay between thrust as told and motion, where the data
                                    do not determine it [s]; 0..1. Above 0 the metric estimates
                                    negative delays, too (late stamps) */
} auvid_uncertainty_t;

/** The verdict on one estimate. Written by auvid_confidence_work. */
typedef struct {
    auvid_real_t sigma[AUVID_MAX_PARAMETERS]; /**< standard error, bias included [parameter's unit];
                                                   AUVID_LARGEST: not known */
    /** What one standard deviation of the thrust scale, and of the DVL's, moves each parameter by,
     * with its sign [parameter's unit]. Their squares are part of that of sigma. */
    auvid_real_t thrust_error[AUVID_MAX_PARAMETERS];
    auvid_real_t dvl_error[AUVID_MAX_PARAMETERS];
    auvid_real_t bound[AUVID_MAX_PARAMETERS]; /**< AUVID_NOTE_AT_BOUND: which [parameter's unit];
                                                   _DISCREDITED: the impossible value [partner's
                                                   unit]; _THRUST_SCALE: the largest thrust_scale
                                                   with which it is identifiable */
    uint32_t identifiable;                    /**< bit i: parameter i is identifiable */
    uint32_t implausible;                     /**< bit i: parameter i is impossible (its equation
                                                   has no identifiable parameter then), or has
                                                   AUVID_NOTE_IMPLAUSIBLE */
    uint8_t note[AUVID_MAX_PARAMETERS];       /**< auvid_note_t */
    uint8_t partner[AUVID_MAX_PARAMETERS];    /**< what the note says of it; else 0 */
    uint8_t sets; /**< data sets whose scatter the errors are of: those of the estimate that were
                       still in the ring when its search ended */
    uint8_t lost[AUVID_DOF_COUNT];            /**< rows of these that gaps in the record, or in a
                                                   velocity that the DoF's equation reads, cost [%];
                                                   0 for DoF that are not driven */
    /** effective noise: rms of white noise that gives the same standard errors [N, Nm];
     * 0: DoF not driven */
    auvid_real_t effective_noise[AUVID_DOF_COUNT];
    auvid_real_t residual_rms[AUVID_DOF_COUNT]; /**< rms residual, bands weighted [N, Nm] */
    auvid_uncertainty_t uncertainty;        /**< that it was told */
} auvid_confidence_t;

/** The computation. Private. */
typedef struct {
    const auvid_metric_t *metric; /* during a call only */
    auvid_confidence_t result;
    auvid_real_t dry_mass_kg;
    auvid_real_t pi[AUVID_MAX_PARAMETERS]; /* the estimate */
    auvid_real_t single_dof_optimum
        [AUVID_MAX_COLUMNS]; /* each DoF's own optimum, then minus the weights of its
                                               delay */
    auvid_real_t
        joint_factor[AUVID_MAX_PARAMETERS * (AUVID_MAX_PARAMETERS + 1) / 2]; /* J'J = sum w H */
    union {
        /* of one DoF of one set, whitened; or one DoF's triangle with its delay first */
        auvid_real_t part[(AUVID_MAX_PARAMETERS + 3) * (AUVID_MAX_PARAMETERS + 4) / 2];
        auvid_regressor_t regressor; /* between the last set and the verdict */
        auvid_real_t covariance[AUVID_COVARIANCE]; /* from the verdict on; goes to the estimate */
    };
    auvid_real_t score[AUVID_MAX_PARAMETERS];     /* of one DoF of one set, at its own optimum */
    auvid_real_t influence[AUVID_MAX_PARAMETERS]; /* of one set on the estimate */
    auvid_real_t sum[AUVID_MAX_PARAMETERS], squares[AUVID_MAX_PARAMETERS]; /* of influences */
    auvid_real_t variance[AUVID_MAX_PARAMETERS]; /* diagonal of (J'J)^-1 */
    auvid_real_t widening[AUVID_MAX_PARAMETERS]; /* of it, for estimated and uncertain delays */
    /* by the delays that the data and their priors say */
    auvid_real_t delay_step[AUVID_MAX_PARAMETERS];
    auvid_real_t scatter[AUVID_DOF_COUNT], degrees_of_freedom[AUVID_DOF_COUNT]; /* of the scores */
    auvid_real_t rows[AUVID_DOF_COUNT];
    uint8_t column_of[AUVID_MAX_PARAMETERS]; /* of parameter i in the joint triangle, or NOWHERE */
    uint8_t parameter_of[AUVID_MAX_PARAMETERS]; /* and back */
    uint32_t at_bound; /* bit i: parameter i is near a bound */
    uint8_t n, spent, phase, at_set, at_dof, at_row;
    bool not_converged; /* the search has not converged */
    bool delayed; /* some delay was estimated: what it costs is being found */
} auvid_confidence_job_t;

#define auvid_confidence_begin AUVID_SIZED(auvid_confidence_begin)
/** Begin. The metric must stay as it is until it is done.
 * @param metric merged, and measured at pi last (regressor path) or linearised there
 * (residual path)
 * @param pi [n] the result of a search over the parameters auvid_metric_searched
 * @param dry_mass_kg masses must be above; 0: above zero
 * @param uncertainty of what is told; null: none
 * Null is ignored. */
void auvid_confidence_begin(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                            const auvid_real_t *pi, auvid_real_t dry_mass_kg,
                            const auvid_uncertainty_t *uncertainty);

#define auvid_confidence_limits AUVID_SIZED(auvid_confidence_limits)
/** Tell, after begin, what limited the search; else there was nothing. Null is ignored.
 * @param lower, upper [n] its bounds
 * @param capped it has not converged: nothing is identifiable */
void auvid_confidence_limits(auvid_confidence_job_t *job, const auvid_real_t *lower,
                             const auvid_real_t *upper, bool capped);

#define auvid_confidence_work AUVID_SIZED(auvid_confidence_work)
/** Go on with it.
 * @param metric as at begin
 * @param budget units of work left, reduced by those used: 6 to 80 for each row of a triangle
 * @return AUVID_OK (job->result written); AUVID_PENDING; AUVID_ERR_NULL. */
auvid_status_t auvid_confidence_work(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                                     uint32_t *budget);

/** Short English phrase for a note; never null; empty for AUVID_NOTE_NONE. */
const char *auvid_note_str(auvid_note_t note);

/** Rows lost to gaps from which on auvid_confidence_missing says so [%]. */
#define AUVID_CONFIDENCE_LOST_PERCENT 20

#define auvid_confidence_missing AUVID_SIZED1(auvid_confidence_missing, AUVID_MAX_PARAMETERS)
/** What motion, or choice, is missing, in words: "yaw: nothing moved it; excite it with steps held
 * 4-8 s and sines of 0.1-0.3 Hz". The last sentence, where there is reason for it, says which part
 * of the rows was lost to gaps, in the DoF with the largest.
 * @param confidence of an estimate, or null when there is none yet
 * @param vehicle its model
 * @param free bit i: parameter i was to be identified (0: all)
 * @param which 0, 1, ... : sentence number
 * @param text [size] written, cut to size and always ended by zero; empty when finished
 * @return AUVID_OK; AUVID_FINISHED (there are not so many sentences); AUVID_ERR_NULL (vehicle or
 * text); AUVID_ERR_RANGE (size 0). Cost: O(n). */
auvid_status_t auvid_confidence_missing(const auvid_confidence_t *confidence,
                                        const auvid_vehicle_t *vehicle, uint32_t free,
                                        unsigned which, char *text, size_t size);

#ifdef __cplusplus
}
#endif

#endif
