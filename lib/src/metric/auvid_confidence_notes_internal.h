/**
 * @file auvid_confidence_notes_internal.h
 * Private: what the files of the confidence share.
 */
#ifndef AUVID_CONFIDENCE_NOTES_INTERNAL_H
#define AUVID_CONFIDENCE_NOTES_INTERNAL_H

#include "auvid/confidence.h"

/** Place, or index, of what is not there. */
enum { NOWHERE = 255 };

/** auvid_confidence_job_t.phase: see auvid_confidence.c */
enum { OWN, ROTATE, BOUND, INVERT, SCATTER, BIAS, JUDGE, CONCLUDE, DONE };

/** DoF j's rows of all sets, rotated together. */
static inline const auvid_real_t *confidence_merged(const auvid_confidence_job_t *c, int j)
{
    return c->metric->merged + c->metric->factor_at[j];
}

/** SCATTER: row i of one band of a set, DoF j. */
void auvid_confidence_take_row(auvid_confidence_job_t *c, const auvid_set_t *set, int j, int band,
                               int i);

/** SCATTER: DoF j of a set is complete; then the set. */
void auvid_confidence_finish_dof(auvid_confidence_job_t *c, int j);
void auvid_confidence_finish_set(auvid_confidence_job_t *c);

/** Add DoF j's share of the right-hand side of the masses' bias to the influences. */
void auvid_confidence_bias(auvid_confidence_job_t *c, int j);

/** The note of parameter i when nothing is found out about it. */
void auvid_confidence_note_idle(auvid_confidence_job_t *c, int i);

/** What is found out about a parameter. */
typedef struct {
    auvid_real_t sigma, bias; /**< bias >= 0 */
    auvid_real_t moved;       /**< so far is it from where it would be without bounds */
    uint8_t partner;          /**< the parameter with which it is correlated, or NOWHERE */
    uint8_t beside;           /**< of those at their bounds the most correlated one, or NOWHERE */
} auvid_finding_t;

#define AUVID_HALF_WIDTH AUVID_CONFIDENCE_HALF_WIDTH

/** Largest standard error and considered error: squares are finite. */
#define AUVID_LARGEST_SIGMA AUVID_C(1e18)

/** Standard error, bias and note of the joint triangle's column i; row i of the covariance, to be
 * scaled. */
void auvid_confidence_judge(auvid_confidence_job_t *c, int i);

/** Scale row i of the covariance so that its diagonal is that of the standard errors. */
void auvid_confidence_scale(auvid_confidence_job_t *c, int i);

/** Note on the parameter of the joint triangle's column i. */
void auvid_confidence_conclude(auvid_confidence_job_t *c, int i, const auvid_finding_t *found);

/** All are judged: if an estimate of DoF j's equation is impossible, none of it is identifiable. */
void auvid_confidence_discredit(auvid_confidence_job_t *c, int j);

/** Norm of the column that parameter i has in DoF j's merged triangle; 0: it is not in it. */
auvid_real_t auvid_confidence_column(const auvid_confidence_job_t *c, int j, int i);

/** Half-width up to which parameter i is identifiable, if it is `value`. */
auvid_real_t auvid_confidence_allowed(const auvid_metric_config_t *cfg, int i, auvid_real_t value);

/** Degree of a parameter in the thrust scale and in the DVL's: it is proportional to that power. */
auvid_real_t auvid_confidence_thrust_degree(const auvid_vehicle_t *vehicle, int i);
auvid_real_t auvid_confidence_dvl_degree(const auvid_vehicle_t *vehicle, int i);

#endif
