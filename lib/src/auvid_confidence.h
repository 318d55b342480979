/**
 * @file auvid_confidence.h
 * Private: what the files of the confidence share.
 */
#ifndef AUVID_CONFIDENCE_PRIVATE_H
#define AUVID_CONFIDENCE_PRIVATE_H

#include "auvid/confidence.h"

/** Place, or index, of what is not there. */
enum { NOWHERE = 255 };

/** Add DoF j's share of the right-hand side of the masses' bias to the influences. */
void auvid_confidence_bias(auvid_confidence_job_t *c, int j);

/** The note of parameter i when nothing is found out about it. */
void auvid_confidence_note_idle(auvid_confidence_job_t *c, int i);

/** Verdict on the parameter of the joint triangle's column i.
 * @param partner column of the parameter with which it is correlated, or NOWHERE */
void auvid_confidence_conclude(auvid_confidence_job_t *c, int i, auvid_real_t sigma,
                               auvid_real_t bias, int partner);

#endif
