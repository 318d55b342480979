/**
 * @file detail/confidence.h
 * No stability promised: for the structs that contain it, for tests and tools.
 *
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
 *   path, parameters of kind UNSCALED do not; with vehicle.own_thrust no parameter scales.
 * - What is identifiable, and what is plausible, and in which order to rely on the results: drag
 *   force at speeds that were seen, held-out acceleration, masses, single coefficients. See
 *   estimate.h.
 * - An equation whose force is mostly unexplained gets no advice on motion.
 *
 * If a delay was estimated, its uncertainty is part of the standard errors. With
 * uncertainty.delay_s > 0 the delay of every excited DoF is uncertain, whether it was estimated,
 * given or zero. Its standard deviation about the value in use is delay_s. That of half its second
 * moment (a lag of another shape, such as that of a propeller's speed) is 2 delay_s^2. The standard
 * errors contain the widening by both, and the step of the parameters to the most probable delay
 * and shape. In the residual path this holds if the delay is searched.
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

#include "auvid/detail/metric.h"
#include "auvid/estimate.h"
#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Influences of the sets on the estimate. Private. */
typedef struct {
    auvid_real_t set[AUVID_MAX_PARAMETERS];                                /* of one set */
    auvid_real_t sum[AUVID_MAX_PARAMETERS], squares[AUVID_MAX_PARAMETERS]; /* of all */
} auvid_confidence_influence_t;

/** Spread of the scores of each DoF. Private. */
typedef struct {
    auvid_real_t scatter[AUVID_DOF_COUNT], degrees_of_freedom[AUVID_DOF_COUNT];
    auvid_real_t rows[AUVID_DOF_COUNT];
} auvid_confidence_spread_t;

/** Where the computation is. Private. */
typedef struct {
    uint8_t set, dof, row;
} auvid_confidence_place_t;

/** The computation. Private. */
typedef struct {
    const auvid_metric_t *metric; /* during a call only */
    /* state: from here on, see checkpoint.h */
    auvid_real_t dry_mass_kg;
    uint8_t n, spent, phase;
    auvid_confidence_place_t at;
    bool not_converged; /* the search has not converged */
    bool delayed;       /* the widening by estimated or uncertain delays is being computed */
    uint32_t at_bound;  /* bit i: parameter i is near a bound */
    uint8_t column_of[AUVID_MAX_PARAMETERS];    /* of parameter i in the joint factor; or NOWHERE */
    uint8_t parameter_of[AUVID_MAX_PARAMETERS]; /* of column k */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), 2 * AUVID_MAX_PARAMETERS + 12)];
    auvid_confidence_t result;
    auvid_real_t score[AUVID_MAX_PARAMETERS]; /* of one DoF of one set, at its optimum */
    auvid_confidence_influence_t influence;
    auvid_real_t variance[AUVID_MAX_PARAMETERS]; /* diagonal of (J'J)^-1 */
    auvid_real_t widening[AUVID_MAX_PARAMETERS]; /* of it, for estimated and uncertain delays */
    /* step of the parameters to the most probable delays */
    auvid_real_t delay_step[AUVID_MAX_PARAMETERS];
    auvid_confidence_spread_t spread;
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

/** Findings about a parameter. Its partner is one with which it is strongly correlated, that at a
 * bound the most correlated one of those at their bound; 255: none. */
typedef struct {
    auvid_real_t sigma, bias; /**< bias >= 0 */
    bool exact;               /**< known if the inputs are exact */
    auvid_real_t bound_shift; /**< distance from where it would be without bounds */
    uint8_t partner, bound_partner;
} auvid_finding_t;

#define auvid_confidence_revise AUVID_SIZED(auvid_confidence_revise)
/** After the computation: begin to assess other values of the same parameters, from another
 * estimator. Call auvid_confidence_limits and auvid_confidence_revise_parameter for each column
 * then.
 * @param pi [n] */
void auvid_confidence_revise(auvid_confidence_job_t *job, const auvid_real_t *pi);

#define auvid_confidence_revise_parameter AUVID_SIZED(auvid_confidence_revise_parameter)
/** Assess the next parameter, parameter_of[i], i = 0 .. n - 1.
 * @param found its standard error, given thrust and DVL scale, 0: not known; bias 0 */
void auvid_confidence_revise_parameter(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                                       int i, const auvid_finding_t *found);

#ifdef __cplusplus
}
#endif

#endif
