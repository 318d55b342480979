/*
 * The identifier: simulated velocity. The rest of the identifier names none of these functions: it
 * calls those of simulate_functions, once something is attached that needs them.
 */
#include <string.h>

#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"

/* The prediction of a cell has a tick of its own. */
static bool simulate_advance(auvid_identifier_t *id)
{
    auvid_validation_t *prediction = id->attached.prediction;
    bool waits = prediction != NULL && prediction->waits;
    if (waits) {
        prediction->waits = false;
        (void)auvid_validation_add(prediction, &prediction->next);
    }
    return waits;
}

static void simulate_cell(auvid_identifier_t *id, const auvid_sample_t *cell)
{
    auvid_validation_t *validation = id->attached.validation;
    auvid_validation_t *prediction = id->attached.prediction;
    (void)simulate_advance(id);
    if (cell == NULL) {
        auvid_validation_gap(validation);
        auvid_validation_gap(prediction);
        return;
    }
    if (validation != NULL && validation->vehicle != NULL) {
        (void)auvid_validation_add(validation, cell);
    }
    if (prediction != NULL && prediction->vehicle != NULL) {
        prediction->next = *cell;
        prediction->waits = true;
    }
}

static void simulate_restart(auvid_identifier_t *id)
{
    const auvid_estimate_t *e = &id->estimate;
    auvid_real_t cell_s = AUVID_C(1e-6) * (auvid_real_t)id->recorder.cell_us;
    if (id->attached.prediction == NULL) {
        return;
    }
    auvid_zero(id->attached.prediction, sizeof *id->attached.prediction);
    if (e->number > 0) { /* no simulation without acceleration, or if the masses forbid it */
        (void)auvid_validation_init(id->attached.prediction, identifier_vehicle(id), e->pi,
                                    (uint8_t)(e->excited | e->coupled), e->delay_s,
                                    e->first_order_lag, cell_s);
    }
}

static void simulate_finish(auvid_identifier_t *id)
{
    auvid_change_test_t *test = &id->change_test;
    (void)simulate_advance(id);
    bool simulated = id->attached.prediction != NULL && id->attached.prediction->vehicle != NULL &&
                     id->metric.sets.waiting == 1 &&
                     auvid_validation_r2(id->attached.prediction, test->r2_velocity) == AUVID_OK;
    test->simulated = simulated ? (uint8_t)id->attached.prediction->dofs : 0u;
    simulate_restart(id);
}

static const auvid_simulate_functions_t simulate_functions = {simulate_cell, simulate_advance,
                                                              simulate_restart, simulate_finish};

void auvid_identifier_attach(auvid_identifier_t *id, auvid_validation_t *validation)
{
    if (id != NULL) {
        id->attached.validation = validation;
        id->attached.simulate = &simulate_functions;
    }
}

auvid_status_t auvid_identifier_attach_prediction(auvid_identifier_t *id,
                                                  auvid_validation_t *storage)
{
    if (id == NULL || storage == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_identifier_check_attach(id, id->attached.prediction);
    if (status == AUVID_OK) {
        id->attached.prediction = storage;
        id->attached.simulate = &simulate_functions;
        simulate_restart(id); /* of a prior record, if there is one */
    }
    return status;
}
