/**
 * @file auvid_guard_repeats_internal.h
 * Private: sensors that repeat their values.
 */
#ifndef AUVID_GUARD_REPEATS_INTERNAL_H
#define AUVID_GUARD_REPEATS_INTERNAL_H

#include "auvid/guard.h"

/** Updates values and repeat_us of the guard in a tick at t_us, before g->t_us is set. */
void auvid_guard_track_repeats(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in);

#endif
