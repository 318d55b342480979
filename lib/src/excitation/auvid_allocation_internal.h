/**
 * @file auvid_allocation_internal.h
 * Private: the check of a configuration, shared with the identifier.
 */
#ifndef AUVID_ALLOCATION_INTERNAL_H
#define AUVID_ALLOCATION_INTERNAL_H

#include "auvid/allocation.h"

/** Check a configuration. *why names what is refused; NULL: not wanted. @return the statuses of
 * auvid_allocation_init */
auvid_status_t auvid_allocation_check_config(const auvid_allocation_config_t *cfg,
                                             auvid_refusal_t *why);

#endif
