/**
 * @file auvid_optimizer_internal.h
 * Private: initialisation with less stack.
 */
#ifndef AUVID_OPTIMIZER_INTERNAL_H
#define AUVID_OPTIMIZER_INTERNAL_H

#include "auvid/detail/optimizer.h"

/** As auvid_optimizer_init, without a copy: copies the members that both phases share into
 * cfg->line_search. No pointer may be NULL. */
auvid_status_t auvid_optimizer_begin(auvid_optimizer_t *optimizer, auvid_optimizer_config_t *cfg);

#endif
