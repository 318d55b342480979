/**
 * @file auvid_confidence_notes_internal.h
 * Private declarations shared by the files of the confidence.
 */
#ifndef AUVID_CONFIDENCE_NOTES_INTERNAL_H
#define AUVID_CONFIDENCE_NOTES_INTERNAL_H

#include "auvid/detail/confidence.h"

/** Column, or parameter, that does not exist. */
enum { NOWHERE = 255 };

/** Factor f of the noise of smoothed rows half a second apart: see auvid_confidence.c. */
#define AUVID_CONFIDENCE_SMOOTHED AUVID_C(2.6)

/** partner of AUVID_NOTE_NOT_EXCITED: see estimate.h */
enum { IDLE, UNACTUATED, UNACTUATED_ROWS };

/** partner of AUVID_NOTE_UNCERTAIN: see estimate.h */
enum { FEW_DATA, UNEXPLAINED };
/** partner of AUVID_NOTE_UNCHECKED: see estimate.h */
enum { NO_INPUTS, TOO_FEW_ROWS, INEXACT_INPUTS };
/** Closed loop: of the vehicle; or of single DoF. */
enum { OF_ALL, OF_SOME };

/** auvid_confidence_job_t.phase: see auvid_confidence.c */
enum { OPTIMUM, ROTATE, BOUND, INVERT, SCATTER, BIAS, JUDGE, CONCLUDE, DONE };

/** SCATTER: take row i of one band of a set, DoF j. */
void auvid_confidence_take_row(auvid_confidence_job_t *c, const auvid_set_t *set, int j, int band,
                               int i);

/** SCATTER: complete DoF j of a set; complete the set. */
void auvid_confidence_finish_dof(auvid_confidence_job_t *c, int j);
void auvid_confidence_finish_set(auvid_confidence_job_t *c);

/** Compute a, the derivatives of DoF j's row by its acceleration: its mass is a pi.
 * @param y memory for the rows */
void auvid_confidence_acceleration_row(const auvid_vehicle_t *vehicle, int j, auvid_regressor_t *y,
                                       auvid_real_t a[AUVID_MAX_PARAMETERS]);

/** Add DoF j's part of the right-hand side of the masses' bias to the influences. */
void auvid_confidence_bias(auvid_confidence_job_t *c, int j);

/** Only coupling moves DoF j: add its part of the influences, from the scores of its own terms,
 * whitened by their R factor. The other columns take part as they do in the joint R factor. */
void auvid_confidence_add_scores(auvid_confidence_job_t *c, int j);

/** Set the note of parameter i for the case that nothing is known about it. */
void auvid_confidence_note_idle(auvid_confidence_job_t *c, int i);

/** Correlation from which the other parameter is named. */
#define AUVID_CORRELATED AUVID_C(0.95)

#define AUVID_HALF_WIDTH AUVID_CONFIDENCE_HALF_WIDTH

/** Largest standard error and considered error; its square is finite. */
#define AUVID_LARGEST_SIGMA AUVID_C(1e18)

/** Compute standard error, bias and note of column i of the joint R factor, and row i of the
 * covariance, still to be scaled. */
void auvid_confidence_judge(auvid_confidence_job_t *c, int i);

/** Scale row i of the covariance so that its diagonal is that of the standard errors. */
void auvid_confidence_scale(auvid_confidence_job_t *c, int i);

/** Returns true if the note of parameter p says that it is known. */
bool auvid_confidence_is_known(const auvid_confidence_t *c, int p);

/** Set the note of the parameter of the joint R factor's column i. */
void auvid_confidence_conclude(auvid_confidence_job_t *c, int i, const auvid_finding_t *found);

/** After all notes: equations of these DoF, a bit each, with an impossible estimate are not
 * identifiable; if two masses are impossible, nothing is. */
void auvid_confidence_discredit(auvid_confidence_job_t *c, uint32_t dofs);

/** After all notes: of the DoF in closed loop, a bit each, only `strong` parameters can be
 * identifiable. */
void auvid_confidence_close_loop(auvid_confidence_job_t *c, const auvid_metric_t *m,
                                 uint32_t feedback, uint32_t strong);

/** Returns the norm of parameter i's column in DoF j's merged R factor; 0: it has none. */
auvid_real_t auvid_confidence_column(const auvid_confidence_job_t *c, int j, int i);

/** Returns the half-width up to which parameter i is identifiable if its value is `value`. */
auvid_real_t auvid_confidence_allowed(const auvid_metric_config_t *cfg, int i, auvid_real_t value);

/** Returns the degree of a parameter in the thrust scale, and in the DVL's: the power of the scale
 * to which it is proportional. */
auvid_real_t auvid_confidence_thrust_degree(const auvid_vehicle_t *vehicle, int i);
auvid_real_t auvid_confidence_dvl_degree(const auvid_vehicle_t *vehicle, int i);

#endif
