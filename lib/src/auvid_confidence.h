/**
 * @file auvid_confidence.h
 * Private: what the files of the confidence share.
 */
#ifndef AUVID_CONFIDENCE_PRIVATE_H
#define AUVID_CONFIDENCE_PRIVATE_H

#include "auvid/confidence.h"

/** Place, or index, of what is not there. */
enum { NOWHERE = 255 };

/** auvid_confidence_job_t.phase: see auvid_confidence.c */
enum { OWN, ROTATE, BOUND, INVERT, SCATTER, BIAS, JUDGE, DONE };

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

/** Verdict on the parameter of the joint triangle's column i. */
void auvid_confidence_conclude(auvid_confidence_job_t *c, int i, const auvid_finding_t *found);

#endif
