/**
 * @file auvid_recorder_internal.h
 * Private: what only the identifier calls.
 */
#ifndef AUVID_RECORDER_INTERNAL_H
#define AUVID_RECORDER_INTERNAL_H

#include "auvid/detail/recorder.h"

/** auvid_recorder_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_recorder_set_up(auvid_recorder_t *recorder, const auvid_recorder_config_t *cfg,
                           auvid_refusal_t *why);

/** Change the length of the cells: the record is broken, and the next one has the new length.
 * @param cell_us 1000..1000000 */
void auvid_recorder_set_cell(auvid_recorder_t *rec, uint32_t cell_us);

#endif
