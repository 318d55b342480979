/**
 * @file auvid_allocation_internal.h
 * Private: the init that names what it refuses, for the identifier.
 */
#ifndef AUVID_ALLOCATION_INTERNAL_H
#define AUVID_ALLOCATION_INTERNAL_H

#include "auvid/allocation.h"

/** auvid_allocation_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_allocation_set_up(auvid_allocation_t *a, const auvid_allocation_config_t *cfg,
                             auvid_refusal_t *why);

#endif
