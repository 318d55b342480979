/**
 * @file auvid_optimizer_internal.h
 * Private: a beginning with less stack.
 */
#ifndef AUVID_OPTIMIZER_INTERNAL_H
#define AUVID_OPTIMIZER_INTERNAL_H

#include "auvid/optimizer.h"

/** As auvid_optimizer_init, without a copy: what the local phase has in common with the global one
 * is filled into *config. None may be null. */
auvid_status_t auvid_optimizer_begin(auvid_optimizer_t *optimizer,
                                     auvid_optimizer_config_t *config);

#endif
