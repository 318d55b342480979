/**
 * @file auvid_identifier_internal.h
 * Private: what the files of the identifier share.
 */
#ifndef AUVID_IDENTIFIER_INTERNAL_H
#define AUVID_IDENTIFIER_INTERNAL_H

#include "auvid/identifier.h"

/** Units that it costs to draw a population. */
enum { BEGIN_PRICE = 100 };

/** Null before init. */
static inline const auvid_vehicle_t *identifier_vehicle(const auvid_identifier_t *id)
{
    return id->metric.cfg.vehicle;
}

/** Does the model have no regressor? Its delay is common to all DoF then. */
static inline bool identifier_residual_path(const auvid_identifier_t *id)
{
    return !AUVID_REGRESSOR_ONLY && identifier_vehicle(id)->regressor == NULL;
}

/** Has init succeeded? A firmware that goes on without must not fly blind. */
static inline bool identifier_is_ready(const auvid_identifier_t *id)
{
    return identifier_vehicle(id) != NULL;
}

/** What the metric says of a set. */
static inline void identifier_take_set(auvid_identifier_t *id, auvid_status_t status)
{
    if (status == AUVID_SET_COMPLETE) {
        id->set_pending = true;
        id->events |= AUVID_EVENT_SET;
    } else if (status == AUVID_SET_IDLE) {
        id->events |= AUVID_EVENT_SET | AUVID_EVENT_NOT_EXCITED;
    }
}

/** The last part of a tick: altitude, guard, excitation. out: zeroed; written but its events. */
void auvid_identifier_act(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out);

/** A step is refused: for a watching guard a breach. All may be null. */
void auvid_identifier_refused(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out);

/** Sets have been completed: judge the last estimate by them, oldest first, then merge. */
void auvid_identifier_begin_sets(auvid_identifier_t *id);

/** Judge the last estimate by the oldest set that has not been judged; if there is none, merge. */
void auvid_identifier_begin_change_test(auvid_identifier_t *id);

/** Nothing is left to do for the sets of the ring. */
void auvid_identifier_rest(auvid_identifier_t *id);

/** Bring the sets together, then search. */
void auvid_identifier_begin_merge(auvid_identifier_t *id);

/** One stretch of judging. @return AUVID_OK; AUVID_PENDING */
auvid_status_t auvid_identifier_change_test(auvid_identifier_t *id, uint32_t *budget);

/** Regressor path: begin to look for the least cost within the bounds, from the result that is in
 * `candidate`. What the optimizer held is lost. */
void auvid_identifier_begin_optimum(auvid_identifier_t *id);

/** Continue it; raises `capped` if the result's cost is more than a thousandth above the least.
 * @return AUVID_OK; AUVID_PENDING */
auvid_status_t auvid_identifier_optimum(auvid_identifier_t *id, uint32_t *budget);

/** Simulate further cells with the last estimate. */
void auvid_identifier_simulate(auvid_identifier_t *id);

/** Delay that an estimate of a model without regressor was found with; else 0 [s]. */
auvid_real_t auvid_identifier_common_delay(const auvid_identifier_t *id,
                                           const auvid_estimate_t *estimate);

#endif
