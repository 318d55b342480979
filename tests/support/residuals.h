/**
 * @file residuals.h
 * Residual path: the smoothed residuals behind the cost, one by one, for least-squares solvers.
 */
#ifndef RESIDUALS_H
#define RESIDUALS_H

#include "auvid/identifier.h"

/** Evaluate the merged sets at a point. The squares of the residuals sum to the cost, without a
 * prior.
 * @param residual [size]
 * @return number of residuals; -1: more than `size` */
int residuals_at(auvid_metric_t *metric, const auvid_real_t *pi, auvid_real_t delay_s,
                 double *residual, int size);

#endif
