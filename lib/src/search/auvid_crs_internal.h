/**
 * @file auvid_crs_internal.h
 * Private: the states of a global search.
 */
#ifndef AUVID_CRS_INTERNAL_H
#define AUVID_CRS_INTERNAL_H

#include "auvid/detail/crs.h"

/** auvid_crs_t.state */
enum { CRS_NONE = 0, CRS_FRESH, CRS_FILL, CRS_SEARCH, CRS_FINISHED, CRS_CAPPED };

/** auvid_crs_check of a configuration that is not NULL. *why names what is refused; NULL: not
 * wanted. */
auvid_status_t auvid_crs_check_fields(const auvid_crs_config_t *cfg, auvid_refusal_t *why);

#endif
