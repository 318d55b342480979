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

/** Sums over a block of at least 10 s of held-out motion, for one DoF. */
typedef struct {
    double count, y, yy, ee; /**< cells; measured velocity; error of the simulated one */
} heldout_sums_t;

/** The blocks. When they are full, they become twice as long. */
enum { HELDOUT_BLOCKS = 8192 };
typedef struct {
    heldout_sums_t block[HELDOUT_BLOCKS][AUVID_DOF_COUNT];
    size_t used;     /**< number of blocks */
    double block_us; /**< their length */
    uint32_t dofs;   /**< bit j: DoF j is simulated; else it is taken from the log */
    bool impossible; /**< an estimate cannot be simulated: a mass is not positive */
} heldout_blocks_t;

/** No blocks yet. @return to be freed by free(); NULL after a message */
heldout_blocks_t *heldout_blocks(void);

/** Simulates the logs with an estimate and adds the errors to *blocks.
 * @param trace NULL: none is wanted
 * @return 0, or EXIT_REFUSED after one line on stderr */
int heldout_simulate(const log_set_t *logs, const log_use_t *use,
                     const auvid_recorder_config_t *recorder, const auvid_vehicle_t *vehicle,
                     const auvid_estimate_t *estimate, trace_t *trace, heldout_blocks_t *blocks);

/** Simulates the logs with the estimate of *id and fills the validation in *result, and the trace.
 * Returns 0, or EXIT_REFUSED after one line on stderr. */
int heldout_r2(const log_set_t *logs, const log_use_t *use, const auvid_identifier_t *id,
               uint64_t seed, trace_t *trace, result_t *result);

#endif
