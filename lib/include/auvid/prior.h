/**
 * @file prior.h
 * The prior: what is known of the vehicle, in 236 bytes. A dive saves it at its end, the next dive
 * starts with it.
 *
 * The record holds the parameters, their standard errors and the noise of the forces. The standard
 * errors assume exact thrust and DVL scales, because the next dive has the same thrusters. An
 * identifier started with a record has its parameters as the first estimate, and also as one data
 * set recorded before. They are not identifiable yet: the vehicle may have been changed ashore. The
 * first recorded set is tested against the record. If the two do not belong to the same vehicle,
 * the record is discarded; then the identifier behaves as after a cold start. So it is after a
 * change of the vehicle.
 *
 * With uncertain inputs a record is the first estimate, and the start of searches; their solution
 * does not contain it. A slow vehicle's dive may end with longer cells (metric_config.h,
 * max_cell_us): begin the next one with these (cfg.recorder.cell_us), else the noise of its first
 * set contradicts the record.
 *
 * A model on the residual path uses a record's parameters only as a point to search from. The prior
 * of auvid_prior_set and auvid_thrusters_attach_prior acts there. The search counts it 15 times as
 * much as its standard errors say: errors of the model must not move what is known. It is tested
 * after the search, against 15 times the usual limit; if it is discarded, the identifier searches
 * again without it. At least one mass or gain must be known (metric.fixed): a prior does not keep
 * the scale of all forces from shrinking.
 *
 * Called from the control task, between ticks. Cost: checksums over the record and the names of the
 * model. Memory: the record, which the caller owns. The bytes are the same on every machine:
 * little-endian, IEEE 754, single precision even if auvid_real_t is double.
 */
#ifndef AUVID_PRIOR_H
#define AUVID_PRIOR_H

#include "auvid/identifier.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bytes of a record. */
enum { AUVID_PRIOR_BYTES = 236 };

/** Prior knowledge: parameters estimated before the first set was recorded. */
typedef struct auvid_prior {
    auvid_real_t pi[AUVID_MAX_PARAMETERS];    /**< means, in the parameters' units */
    auvid_real_t sigma[AUVID_MAX_PARAMETERS]; /**< standard errors, > 0 */
    /** mean square of the effective noise divided by that of the residual (estimate.h), > 0 */
    auvid_real_t variance_inflation[AUVID_DOF_COUNT];
    uint32_t known; /**< bit i: parameter i has a prior; 0: none has */
} auvid_prior_t;

#define auvid_prior_save AUVID_SIZED(auvid_prior_save)
/**
 * Save the last estimate, that of auvid_identifier_estimate, as a prior record.
 * @param record [AUVID_PRIOR_BYTES] written if AUVID_OK
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_NO_DATA (there is
 * no estimate yet, or only that of the record loaded at the start: keep that record).
 */
auvid_status_t auvid_prior_save(const auvid_identifier_t *id, uint8_t *record);

#define auvid_identifier_attach_prior AUVID_SIZED(auvid_identifier_attach_prior)
/**
 * Give the identifier memory for a prior. Call it once, between auvid_identifier_init and the first
 * step. Without it auvid_prior_load and auvid_prior_set return AUVID_ERR_STATE.
 *
 * Each merge adds pseudo-measurements to the rows of the sets: the prior mean with its standard
 * error, weighted with the residual of the sets. If the sets contradict them (Chow's F of a DoF is
 * above 6), the prior is discarded and storage->known becomes 0.
 * @param storage written; must outlive the identifier
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_ATTACHED (one is
 * attached already); AUVID_ERR_STARTED (it has stepped, or recorded a wrench). After an error
 * nothing has changed.
 */
auvid_status_t auvid_identifier_attach_prior(auvid_identifier_t *id, auvid_prior_t *storage);

#define auvid_prior_load AUVID_SIZED(auvid_prior_load)
/**
 * Start with a prior record. Call it after auvid_identifier_attach_prior, before the first set is
 * complete.
 * @param record [bytes]
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, no memory
 * is attached, it has a prior already, or a set has been completed);
 * AUVID_ERR_SIZE (not AUVID_PRIOR_BYTES); AUVID_ERR_CHECKSUM (damaged, or of another version);
 * AUVID_ERR_MODEL (of another model, of other free parameters, or of other fixed values);
 * AUVID_ERR_NOT_FINITE, AUVID_ERR_RANGE (the checksum is correct, but a value is not finite or out
 * of the ranges of auvid_prior_set). A rejected record changes nothing.
 */
auvid_status_t auvid_prior_load(auvid_identifier_t *id, const uint8_t *record, uint32_t bytes);

#define auvid_prior_set AUVID_SIZED(auvid_prior_set)
/**
 * Start with parameters from another source (a towing tank, a calculation, a sister vehicle), as
 * with a prior record. Call it when auvid_prior_load may be called. Wrong values are
 * discarded like a record of another vehicle, the more reliably the smaller their sigma. Later
 * estimates are assumed to scale with the thrust even so: fix a parameter that is known better.
 * @param pi [n] parameters in the model's order, within +-1e18; fixed ones are not read
 * @param sigma [n] their standard errors, above 5e-31, below 1e30; a large one for a guess
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, no memory
 * is attached, it has a prior already, or a set has been completed);
 * AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (a value or a sigma out of its range). A rejected call
 * changes nothing.
 */
auvid_status_t auvid_prior_set(auvid_identifier_t *id, const auvid_real_t *pi,
                               const auvid_real_t *sigma);

#ifdef __cplusplus
}
#endif

#endif
