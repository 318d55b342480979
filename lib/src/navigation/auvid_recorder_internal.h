/**
 * @file auvid_recorder_internal.h
 * Private: the check of a configuration, shared with the identifier.
 */
#ifndef AUVID_RECORDER_INTERNAL_H
#define AUVID_RECORDER_INTERNAL_H

#include "auvid/detail/recorder.h"

/** Check a configuration. *why names what is refused; NULL: not wanted. @return the statuses of
 * auvid_recorder_init */
auvid_status_t auvid_recorder_check(const auvid_recorder_config_t *cfg, auvid_refusal_t *why);

#endif
