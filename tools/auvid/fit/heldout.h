/**
 * @file heldout.h
 * Validation on held-out data: cross-validation on the training log, and R2 of simulated velocity
 * on another log.
 */
#ifndef PROGRAM_HELDOUT_H
#define PROGRAM_HELDOUT_H

#include "replay.h"
#include "../report/report.h"

/** Mean squared force residual, relative to tau_max, of each set of the ring under the
 * least-squares parameters of all others. Negative if there are fewer than two sets. */
double heldout_cross_validation(const auvid_metric_t *metric);

/** Simulates the logs with the estimate and fills the validation in *result, and the trace. Returns
 * 0, or EXIT_REFUSED after one line on stderr. */
int heldout_r2(const log_set_t *logs, const log_use_t *use, const auvid_recorder_config_t *recorder,
               uint64_t seed, trace_t *trace, result_t *result);

#endif
