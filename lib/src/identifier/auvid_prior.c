/*
 * The prior record. Little-endian words:
 *
 *     byte 0  "avw1"
 *          4  checksum of the model: names, and what is free or fixed at what
 *          8  parameters whose standard error is known, bit i
 *         12  variance inflation of the DoF [6], see auvid_prior_t, single precision
 *         36  parameters [32], single precision
 *        164  standard errors if thrust and DVL scale are exact [32], upper halves of single
 *             precision, not rounded down
 *        228  0
 *        232  CRC-32 of all bytes before
 */
#include "auvid_prior_rows_internal.h"

#include <string.h>

#include "../base/auvid_checksum_internal.h"
#include "../metric/auvid_confidence_notes_internal.h"
#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"

#define RECORD_MAGIC 0x31777661u

/* Factor of the standard errors of the previous dive: it halves their weight. */
#define AGED AUVID_C(1.4142136)

/* Upper bound of the standard errors of known parameters. */
#define MAX_SIGMA AUVID_C(1e30)

enum {
    RECORD_MODEL = 4,
    RECORD_KNOWN = 8,
    RECORD_VARIANCE_INFLATION = 12,
    RECORD_VALUE = 36,
    RECORD_SIGMA = 164,
    RECORD_CHECK = 232
};

_Static_assert(RECORD_VARIANCE_INFLATION + 4 * AUVID_DOF_COUNT <= RECORD_VALUE &&
                   RECORD_VALUE + 4 * AUVID_MAX_PARAMETERS <= RECORD_SIGMA &&
                   RECORD_SIGMA + 2 * AUVID_MAX_PARAMETERS <= RECORD_CHECK,
               "the record has room for all degrees of freedom and parameters");

static uint32_t prior_checksum(const uint8_t *record)
{
    return ~auvid_checksum(UINT32_MAX, record, RECORD_CHECK);
}

/* Variance inflation of a DoF; 0: not known. */
static auvid_real_t prior_variance_inflation(const auvid_confidence_t *confidence, int j)
{
    bool known = confidence->residual_rms[j] > AUVID_C(0.0);
    auvid_real_t ratio =
        known ? confidence->effective_noise[j] / confidence->residual_rms[j] : AUVID_C(0.0);
    return ratio * ratio;
}

auvid_status_t auvid_prior_save(const auvid_identifier_t *id, uint8_t *record)
{
    if (id == NULL || record == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!identifier_is_ready(id)) {
        return AUVID_ERR_STATE;
    }
    const auvid_estimate_t *e = auvid_identifier_estimate(id);
    const auvid_vehicle_t *vehicle = identifier_vehicle(id);
    if (e == NULL || e->sets == 0) {
        return AUVID_ERR_NO_DATA;
    }
    uint32_t known = 0;
    memset(record, 0, AUVID_PRIOR_BYTES);
    auvid_put_word(record, RECORD_MAGIC);
    auvid_put_word(record + RECORD_MODEL, auvid_checksum_of_model(&id->metric.cfg));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_put_word(record + RECORD_VARIANCE_INFLATION + 4 * j,
                       auvid_single_bits(prior_variance_inflation(&e->confidence, j)));
    }
    for (int i = 0; i < vehicle->parameters; ++i) {
        auvid_real_t sigma = auvid_sqrt(auvid_estimate_covariance(e, vehicle, i, i));
        auvid_real_t total = e->confidence.sigma[i];
        bool has =
            (e->identified >> i & 1u) && e->confidence.note[i] != AUVID_NOTE_FEEDBACK &&
            total > AUVID_C(0.0) && total < AUVID_LARGEST && sigma > AUVID_C(0.0) &&
            prior_variance_inflation(&e->confidence, (int)vehicle->parameter[i].dof) > AUVID_C(0.0);
        uint32_t upper = has ? (auvid_single_bits(sigma) + 0xFFFFu) >> 16 : 0u;
        known |= (uint32_t)has << i;
        auvid_put_word(record + RECORD_VALUE + 4 * i, auvid_single_bits(e->pi[i]));
        record[RECORD_SIGMA + 2 * i] = (uint8_t)upper;
        record[RECORD_SIGMA + 2 * i + 1] = (uint8_t)(upper >> 8);
    }
    auvid_put_word(record + RECORD_KNOWN, known);
    auvid_put_word(record + RECORD_CHECK, prior_checksum(record));
    return AUVID_OK;
}

static void prior_read(const uint8_t *record, int parameters, auvid_prior_t *prior)
{
    memset(prior, 0, sizeof *prior);
    prior->known = auvid_get_word(record + RECORD_KNOWN);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        prior->variance_inflation[j] =
            auvid_from_single_bits(auvid_get_word(record + RECORD_VARIANCE_INFLATION + 4 * j));
    }
    for (int i = 0; i < parameters; ++i) {
        uint32_t upper = record[RECORD_SIGMA + 2 * i] | (uint32_t)record[RECORD_SIGMA + 2 * i + 1]
                                                            << 8;
        prior->pi[i] = auvid_from_single_bits(auvid_get_word(record + RECORD_VALUE + 4 * i));
        prior->sigma[i] = AGED * auvid_from_single_bits(upper << 16);
    }
}

/* Add the scale errors of parameter i of a record. The thrusters are those of the last dive. */
static void prior_add_scale_errors(auvid_identifier_t *id, int i)
{
    const auvid_vehicle_t *vehicle = identifier_vehicle(id);
    const auvid_uncertainty_t *uncertainty = &id->uncertainty;
    auvid_confidence_t *c = &id->estimate.confidence;
    auvid_real_t pi = id->estimate.pi[i], sigma = c->sigma[i];
    auvid_real_t thrust =
        uncertainty->thrust_scale * auvid_confidence_thrust_degree(vehicle, i) * pi;
    auvid_real_t dvl = uncertainty->dvl_scale * auvid_confidence_dvl_degree(vehicle, i) * pi;
    c->thrust_error[i] = thrust;
    c->dvl_error[i] = dvl;
    c->sigma[i] = auvid_sqrt(sigma * sigma + thrust * thrust + dvl * dvl);
}

/* Not identifiable: only the first set shows whether the vehicle has been changed since. */
static void prior_publish(auvid_identifier_t *id, const auvid_prior_t *prior, bool scale_errors)
{
    auvid_estimate_t *e = &id->estimate;
    const auvid_vehicle_t *vehicle = identifier_vehicle(id);
    uint32_t free = auvid_metric_free_of(&id->metric, UINT8_MAX);
    e->confidence.uncertainty = id->uncertainty;
    e->confidence.unchecked = !id->exact_inputs;
    e->number = 1;
    e->identified = prior->known;
    memcpy(e->pi, prior->pi, sizeof e->pi);
    for (int i = 0; i < vehicle->parameters; ++i) {
        bool known = (prior->known >> i & 1u) != 0;
        e->excited = (uint8_t)(e->excited | (unsigned)known << vehicle->parameter[i].dof);
        e->confidence.note[i] = (free >> i & 1u) != 0 ? AUVID_NOTE_UNCERTAIN : AUVID_NOTE_FIXED;
        e->confidence.sigma[i] = AUVID_LARGEST;
        if (known && prior->sigma[i] <= AUVID_LARGEST_SIGMA) {
            e->covariance[auvid_qr_row(vehicle->parameters, i)] = prior->sigma[i] * prior->sigma[i];
            e->confidence.sigma[i] = prior->sigma[i];
            if (scale_errors) {
                prior_add_scale_errors(id, i);
            }
        }
    }
    identifier_simulate(id);
    id->events |= AUVID_EVENT_ESTIMATE;
}

auvid_status_t auvid_identifier_attach_prior(auvid_identifier_t *id, auvid_prior_t *storage)
{
    if (id == NULL || storage == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_identifier_check_attach(id, id->metric.prior_context);
    if (status == AUVID_OK) {
        memset(storage, 0, sizeof *storage);
        auvid_metric_attach_prior(&id->metric, &auvid_prior_functions, storage);
    }
    return status;
}

/* Is this before the first set, and is there memory? */
static bool prior_is_allowed(const auvid_identifier_t *id)
{
    return identifier_is_ready(id) && id->metric.prior != NULL && id->metric.sets.recorded == 0 &&
           id->estimate.number == 0;
}

/* scale_errors: sigma does not include the errors of thrust and DVL scale yet. */
static auvid_status_t prior_begin(auvid_identifier_t *id, const auvid_prior_t *prior,
                                  bool scale_errors)
{
    auvid_status_t status = auvid_prior_check(&id->metric, prior);
    if (status == AUVID_OK) {
        if (!scale_errors || !auvid_metric_stores_rows(&id->metric)) { /* else a point only */
            *(auvid_prior_t *)id->metric.prior_context = *prior;
        }
        prior_publish(id, prior, scale_errors);
    }
    return status;
}

auvid_status_t auvid_prior_load(auvid_identifier_t *id, const uint8_t *record, uint32_t bytes)
{
    if (id == NULL || record == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!prior_is_allowed(id)) {
        return AUVID_ERR_STATE;
    }
    if (bytes != AUVID_PRIOR_BYTES) {
        return AUVID_ERR_SIZE;
    }
    if (auvid_get_word(record) != RECORD_MAGIC ||
        auvid_get_word(record + RECORD_CHECK) != prior_checksum(record)) {
        return AUVID_ERR_CHECKSUM;
    }
    if (auvid_get_word(record + RECORD_MODEL) != auvid_checksum_of_model(&id->metric.cfg)) {
        return AUVID_ERR_MODEL;
    }
    auvid_prior_t prior;
    prior_read(record, identifier_vehicle(id)->parameters, &prior);
    return prior_begin(id, &prior, true);
}

auvid_status_t auvid_prior_set(auvid_identifier_t *id, const auvid_real_t *pi,
                               const auvid_real_t *sigma)
{
    if (id == NULL || pi == NULL || sigma == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!prior_is_allowed(id)) {
        return AUVID_ERR_STATE;
    }
    auvid_prior_t prior;
    memset(&prior, 0, sizeof prior);
    prior.known = auvid_metric_free_of(&id->metric, UINT8_MAX);
    memcpy(prior.pi, id->metric.cfg.fixed, sizeof prior.pi);
    for (int i = 0; i < identifier_vehicle(id)->parameters; ++i) {
        if ((prior.known >> i & 1u) == 0) {
            continue;
        }
        if (!auvid_is_finite(sigma[i])) { /* auvid_prior_check checks the rest */
            return AUVID_ERR_NOT_FINITE;
        }
        if (!(sigma[i] < MAX_SIGMA)) {
            return AUVID_ERR_RANGE;
        }
        prior.pi[i] = pi[i];
        prior.sigma[i] = sigma[i];
        prior.variance_inflation[identifier_vehicle(id)->parameter[i].dof] =
            AUVID_PRIOR_INFLATION;
    }
    return prior_begin(id, &prior, false);
}
