/**
 * @file auvid_crs_internal.h
 * Private: the global phase of the optimizer, Algorithm 1.
 */
#ifndef AUVID_CRS_INTERNAL_H
#define AUVID_CRS_INTERNAL_H

#include "auvid/detail/optimizer.h"

/** Draw the first population; o->cfg is valid, the rest of *o is zero. */
void auvid_crs_begin(auvid_optimizer_t *o);

/** Make the next point, in o->trial. @return as auvid_optimizer_ask, if no other phase follows. */
auvid_status_t auvid_crs_next(auvid_optimizer_t *o);

/** Take the finite cost of o->trial. */
void auvid_crs_take(auvid_optimizer_t *o, auvid_real_t cost);

#endif
