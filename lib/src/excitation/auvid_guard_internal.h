/**
 * @file auvid_guard_internal.h
 * Private: the init that names what it refuses, for the identifier.
 */
#ifndef AUVID_GUARD_INTERNAL_H
#define AUVID_GUARD_INTERNAL_H

#include "auvid/guard.h"

/** auvid_guard_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_guard_set_up(auvid_guard_t *g, const auvid_guard_config_t *cfg, auvid_refusal_t *why);

#endif
