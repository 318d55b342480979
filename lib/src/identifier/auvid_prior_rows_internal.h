/**
 * @file auvid_prior_rows_internal.h
 * Private: the prior as rows of the merged sets.
 */
#ifndef AUVID_PRIOR_ROWS_INTERNAL_H
#define AUVID_PRIOR_ROWS_INTERNAL_H

#include "auvid/prior.h"
#include "../metric/auvid_metric_internal.h"

/** Typical variance inflation: of runs at 0 to 3 N, 1 to 3.5. */
#define AUVID_PRIOR_INFLATION AUVID_C(2.0)

/** Check a prior against the metric's model. @return AUVID_OK; AUVID_ERR_NOT_FINITE;
 * AUVID_ERR_RANGE (`known` has a bit of a parameter that is not free; a value is beyond 1e18; the
 * standard error or variance inflation of a known parameter is not > 0 or is beyond 2e30) */
auvid_status_t auvid_prior_check(const auvid_metric_t *metric, const auvid_prior_t *prior);

/** Of the metric's prior; the context is an auvid_prior_t. */
extern const auvid_metric_prior_t auvid_prior_functions;

#endif
