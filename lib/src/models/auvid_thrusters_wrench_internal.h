/**
 * @file auvid_thrusters_wrench_internal.h
 * Private: forces of the thrusters from their log, and times in it.
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

/** auvid_thrusters_wrench, of arguments that are not checked. Returns false if the log does not
 * contain the row.
 * @param resume the lag may continue from the row before: see auvid_thrusters_carry_t */
bool auvid_thrusters_force(const auvid_thrusters_t *th, uint64_t t_us, const auvid_real_t *pi,
                           bool resume, auvid_real_t *wrench);

/** Writes the derivatives of -B x by the parameters of each group, at pi[n], into their columns of
 * *y. The lag continues from the row before. Returns false if the log does not contain the row. */
bool auvid_thrusters_slopes(const auvid_thrusters_t *th, uint64_t t_us, const auvid_real_t *pi,
                            auvid_regressor_t *y);

#endif
