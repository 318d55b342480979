/**
 * @file auvid_refusal_internal.h
 * Private: checks of configurations that name what they refuse.
 */
#ifndef AUVID_REFUSAL_INTERNAL_H
#define AUVID_REFUSAL_INTERNAL_H

#include "auvid/types.h"

/** Range of a field of a configuration, or of each element of an array of them. */
typedef struct {
    const char *name;
    uint16_t offset;        /* in the configuration */
    uint8_t n;              /* elements */
    uint8_t size;           /* of an unsigned integer [bytes], or one of the next two */
    auvid_real_t low, high; /* of integers: whole; high may be 2^32 */
} auvid_field_t;

/** auvid_field_t.size of reals: low..high, or above low..high. */
enum { FIELD_REAL = 16, FIELD_REAL_ABOVE };

#define FIELD_AT(type, name, n, size, low, high)                                                   \
    {                                                                                              \
#name, (uint16_t)offsetof(type, name), n, (uint8_t)(size), low, high                       \
    }
#define REALS_IN(type, name, n, low, high) FIELD_AT(type, name, n, FIELD_REAL, low, high)
#define REALS_ABOVE(type, name, n, low, high) FIELD_AT(type, name, n, FIELD_REAL_ABOVE, low, high)
/** n elements of unsigned integers, flags or an enumeration. */
#define WHOLE_IN(type, name, n, low, high)                                                         \
    FIELD_AT(type, name, n, sizeof(((type *)0)->name) / (n), low, high)

/** Begin the checks of a configuration. Each check below does nothing after one that failed: *why
 * keeps the first. */
void auvid_check_begin(auvid_refusal_t *why);

/** Name the part of the configuration, without an element, that is checked next. */
void auvid_check_part(auvid_refusal_t *why, const char *part);

/** Name the element that is checked next; -1: none. */
void auvid_check_element(auvid_refusal_t *why, int element);

/** Check a condition on a field that has no number. */
void auvid_check_that(auvid_refusal_t *why, bool met, auvid_status_t status, const char *field);

/** Check a condition on a number and its limit. */
void auvid_check_limit(auvid_refusal_t *why, bool met, auvid_status_t status, const char *field,
                       auvid_real_t value, auvid_real_t limit);

/** Check that a number is in low..high: AUVID_ERR_RANGE, or AUVID_ERR_NOT_FINITE. The limit of a
 * refused number is the end beyond which it is; low if it is NaN. */
void auvid_check_in(auvid_refusal_t *why, const char *field, auvid_real_t value, auvid_real_t low,
                    auvid_real_t high);

/** Check that a number is in 1..max. */
void auvid_check_count(auvid_refusal_t *why, auvid_status_t status, const char *field,
                       uint32_t count, uint32_t max);

/** Check n fields of the configuration at cfg: AUVID_ERR_RANGE or AUVID_ERR_NOT_FINITE, and limits
 * as above. An array names its element, unless one is named already. */
void auvid_check_fields(auvid_refusal_t *why, const void *cfg, const auvid_field_t *field,
                        size_t n);

/** All fields of a table. */
#define AUVID_CHECK_TABLE(why, cfg, table)                                                         \
    auvid_check_fields(why, cfg, table, sizeof(table) / sizeof(table)[0])

#endif
