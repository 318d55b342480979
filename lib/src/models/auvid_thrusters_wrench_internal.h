/**
 * @file auvid_thrusters_wrench_internal.h
 * Private: times in the log of the thrusters.
 */
#ifndef AUVID_THRUSTERS_WRENCH_INTERNAL_H
#define AUVID_THRUSTERS_WRENCH_INTERNAL_H

#include "auvid/thrusters.h"

/** Returns a time on the log's time scale: t_us plus all intervals that the log skipped later.
 * Cost: AUVID_MAX_SETS + 2 comparisons at most. */
static inline uint64_t auvid_thrusters_in_log(const auvid_thrusters_t *th, uint64_t t_us)
{
    uint64_t in_log_us = t_us;
    for (int i = 0; i < th->state.pauses && t_us < th->state.pause[i].end_us; ++i) {
        in_log_us += th->state.pause[i].long_us;
    }
    return in_log_us;
}

/** Writes the derivatives of -B x by the parameters of each group, at pi[n], into their columns of
 * *y. Returns false if the log does not contain the row. */
bool auvid_thrusters_slopes(const auvid_thrusters_t *th, uint64_t t_us, const auvid_real_t *pi,
                            auvid_regressor_t *y);

#endif
