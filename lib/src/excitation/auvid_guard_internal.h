/**
 * @file auvid_guard_internal.h
 * Private: the check of a configuration, shared with the identifier.
 */
#ifndef AUVID_GUARD_INTERNAL_H
#define AUVID_GUARD_INTERNAL_H

#include "auvid/guard.h"

/** Check a configuration. *why names what is refused; NULL: not wanted. @return the statuses of
 * auvid_guard_init */
auvid_status_t auvid_guard_check(const auvid_guard_config_t *cfg, auvid_refusal_t *why);

#endif
