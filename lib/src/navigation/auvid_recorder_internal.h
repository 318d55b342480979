/**
 * @file auvid_recorder_internal.h
 * Private: what only the identifier calls.
 */
#ifndef AUVID_RECORDER_INTERNAL_H
#define AUVID_RECORDER_INTERNAL_H

#include "auvid/detail/recorder.h"
#include "../base/auvid_math_internal.h"

/** auvid_recorder_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_recorder_set_up(auvid_recorder_t *recorder, const auvid_recorder_config_t *cfg,
                           auvid_refusal_t *why);

/** Change the length of the cells: the record is broken, and the next one has the new length.
 * @param cell_us 1000..1000000 */
void auvid_recorder_set_cell(auvid_recorder_t *rec, uint32_t cell_us);

/** Attach what takes the input part by part. */
static inline void auvid_recorder_attach(auvid_recorder_t *rec, auvid_recorder_part_t *take_part,
                                         void *context)
{
    rec->take_part = take_part;
    rec->part_context = context;
}

/** Slope of a mean from those of the cells two and one before it, and one and two after it; of
 * fourth order. */
static inline auvid_real_t auvid_recorder_slope(const auvid_recorder_t *rec, auvid_real_t before2,
                                                auvid_real_t before, auvid_real_t after,
                                                auvid_real_t after2)
{
    auvid_real_t per_12t = AUVID_C(1e6) / (AUVID_C(12.0) * (auvid_real_t)rec->cell_us);
    return (AUVID_C(8.0) * (after - before) - (after2 - before2)) * per_12t;
}

/** Its second derivative, likewise. */
static inline auvid_real_t auvid_recorder_curvature(const auvid_recorder_t *rec,
                                                    auvid_real_t before2, auvid_real_t before,
                                                    auvid_real_t mean, auvid_real_t after,
                                                    auvid_real_t after2)
{
    auvid_real_t per_t = AUVID_C(1e6) / (auvid_real_t)rec->cell_us;
    return (AUVID_C(16.0) * (before + after) - AUVID_C(30.0) * mean - (before2 + after2)) /
           AUVID_C(12.0) * per_t * per_t;
}

#endif
