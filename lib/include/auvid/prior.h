/**
 * @file prior.h
 * What is known of the vehicle, in 236 bytes: saved at the end of a dive, the next one starts with
 * it.
 *
 * The record holds the parameters, their standard errors with thrust and DVL scale as told (the
 * next dive has the same thrusters), and the noise of the forces. Started warm, the identifier
 * has them as its first estimate (not identifiable yet: the vehicle may have been changed ashore),
 * and as one data set that was recorded before. The first set that is recorded is held against it:
 * when the two do not belong to the same vehicle, the record is dropped, and all is as after a cold
 * start.
 *
 * A model without regressor takes the record's parameters as a point to search from, no more.
 *
 * Called from the control task, between ticks. Cost: checksums over the record and the names of the
 * model. Memory: the record, the caller's. The bytes are the same on every machine: little-endian,
 * IEEE 754, single precision in double too.
 */
#ifndef AUVID_PRIOR_H
#define AUVID_PRIOR_H

#include "auvid/identifier.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes of a record. */
enum { AUVID_PRIOR_BYTES = 236 };

#define auvid_prior_save AUVID_SIZED(auvid_prior_save)
/**
 * Write the last estimate.
 * @param record [AUVID_PRIOR_BYTES] written when AUVID_OK
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_NO_DATA (there is
 * no estimate yet, or only that of the record which was begun with: keep that record).
 */
auvid_status_t auvid_prior_save(const auvid_identifier_t *id, uint8_t *record);

#define auvid_prior_load AUVID_SIZED(auvid_prior_load)
/**
 * Begin with a record instead of nothing: after init, before the first set is complete.
 * @param record [bytes]
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or a set has been completed);
 * AUVID_ERR_SIZE (not AUVID_PRIOR_BYTES); AUVID_ERR_CHECKSUM (damaged, or of another version);
 * AUVID_ERR_MODEL (of another model, of other free parameters, or of other fixed values);
 * AUVID_ERR_NOT_FINITE, AUVID_ERR_RANGE (its checksum is right, and yet a value in it is not finite
 * or not one that auvid_metric_set_prior takes). Refused ones change nothing.
 */
auvid_status_t auvid_prior_load(auvid_identifier_t *id, const uint8_t *record, uint32_t bytes);

#define auvid_prior_set AUVID_SIZED(auvid_prior_set)
/**
 * Begin with parameters known from elsewhere (a towing tank, a calculation, a sister vehicle), as
 * with a record: after init, before the first set is complete. What is known wrongly is dropped
 * like a record of another vehicle; the more often the smaller the errors that are claimed. Later
 * estimates are taken to scale with the thrust all the same: fix what is known better than that.
 * @param pi [n] parameters in the model's order, within +-1e18; fixed ones are not read
 * @param sigma [n] their standard errors, above 5e-31, below 1e30; a large one for a mere guess
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (as above); AUVID_ERR_NOT_FINITE;
 * AUVID_ERR_RANGE (a value or a sigma out of its range). Refused ones change nothing.
 */
auvid_status_t auvid_prior_set(auvid_identifier_t *id, const auvid_real_t *pi,
                               const auvid_real_t *sigma);

#ifdef __cplusplus
}
#endif

#endif
