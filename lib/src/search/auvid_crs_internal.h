/**
 * @file auvid_crs_internal.h
 * Private: the states of a global search.
 */
#ifndef AUVID_CRS_INTERNAL_H
#define AUVID_CRS_INTERNAL_H

#include "auvid/crs.h"

/** auvid_crs_t.state */
enum { CRS_NONE = 0, CRS_FRESH, CRS_FILL, CRS_SEARCH, CRS_FINISHED, CRS_CAPPED };

#endif
