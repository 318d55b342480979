/**
 * @file auvid_recorder_internal.h
 * Private: the init that names what it refuses, for the identifier.
 */
#ifndef AUVID_RECORDER_INTERNAL_H
#define AUVID_RECORDER_INTERNAL_H

#include "auvid/detail/recorder.h"

/** auvid_recorder_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_recorder_set_up(auvid_recorder_t *recorder, const auvid_recorder_config_t *cfg,
                           auvid_refusal_t *why);

#endif
