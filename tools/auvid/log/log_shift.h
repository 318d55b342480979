/**
 * @file log_shift.h
 * Inputs of a log whose clock is not that of the rest: its samples in the order of time.
 */
#ifndef PROGRAM_LOG_SHIFT_H
#define PROGRAM_LOG_SHIFT_H

#include "log_samples.h"

/** What waits: the inputs of rows, or all else. All zeros: nothing. log_shift_end releases it. */
typedef struct {
    log_sample_t *waiting; /* [room] */
    size_t room, first, count;
} log_shift_t;

/** Splits the samples of a row: what is shifted waits, the rest stays in *now. Returns 0, or
 * EXIT_REFUSED after one line on stderr.
 * @param shift_us of the log; not 0 */
int log_shift_split(log_shift_t *shift, int64_t shift_us, log_sample_t *now);

/** Takes what has waited and comes at or before t_us, the oldest first. Returns false if there is
 * none. */
bool log_shift_due(log_shift_t *shift, uint64_t t_us, log_sample_t *out);

void log_shift_end(log_shift_t *shift);

#endif
