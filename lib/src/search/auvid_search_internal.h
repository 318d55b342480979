/**
 * @file auvid_search_internal.h
 * Private: the configuration of a search.
 */
#ifndef AUVID_SEARCH_INTERNAL_H
#define AUVID_SEARCH_INTERNAL_H

#include "auvid/detail/optimizer.h"

/** Largest bound, and largest step of a parameter: widths, trials and products are finite. */
#define SEARCH_BOUND_MAX AUVID_C(1e18)

/** auvid_search_check of a configuration that is not NULL; *why names what is refused. */
void auvid_search_check_fields(const auvid_search_config_t *cfg, auvid_refusal_t *why);

/** Replace zeros by the values that they stand for. */
void auvid_search_resolve(auvid_search_config_t *cfg);

/** Is this the cost of the certificate? */
bool auvid_search_is_certified(const auvid_optimizer_t *o, auvid_real_t cost);

/** Is the point in the box? */
bool auvid_search_inside(const auvid_search_config_t *cfg, const auvid_real_t *theta);

/** Write the nearest point in the box. @param to may be theta */
void auvid_search_clip(const auvid_search_config_t *cfg, const auvid_real_t *theta,
                       auvid_real_t *to);

#endif
