/**
 * @file auvid_line_search_internal.h
 * Private: the local phase of the optimizer, Algorithm 2.
 */
#ifndef AUVID_LINE_SEARCH_INTERNAL_H
#define AUVID_LINE_SEARCH_INTERNAL_H

#include "auvid/detail/optimizer.h"

/** Begin at o->trial; its cost is that of the best point until it has been evaluated. */
void auvid_line_search_begin(auvid_optimizer_t *o, auvid_real_t cost);

/** Make the next point, in o->trial. @return as auvid_optimizer_ask. */
auvid_status_t auvid_line_search_next(auvid_optimizer_t *o);

/** Take the finite cost of o->trial. */
void auvid_line_search_take(auvid_optimizer_t *o, auvid_real_t cost);

#endif
