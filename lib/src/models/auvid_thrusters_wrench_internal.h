/**
 * @file auvid_thrusters_wrench_internal.h
 * Private: times as the log of the thrusters counts them.
 */
#ifndef AUVID_THRUSTERS_WRENCH_INTERNAL_H
#define AUVID_THRUSTERS_WRENCH_INTERNAL_H

#include "auvid/thrusters.h"

/** A time as the log counts it, from its end on: later by what it has left out since. */
static inline uint64_t auvid_thrusters_in_log(const auvid_thrusters_t *th, uint64_t t_us)
{
    uint64_t in_log_us = t_us;
    for (int i = 0; i < th->state.pauses && t_us < th->state.pause[i].end_us; ++i) {
        in_log_us += th->state.pause[i].long_us;
    }
    return in_log_us;
}

#endif
