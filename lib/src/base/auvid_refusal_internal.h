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

/** Fill *why, unless it is NULL: the only place that does. @return status */
auvid_status_t auvid_refuse(auvid_refusal_t *why, auvid_status_t status, const char *field,
                            auvid_real_t value, auvid_real_t limit);

/** Check n fields of the configuration at cfg. The limit of a refused value is the end of the range
 * beyond which it is; the low one if it is NaN.
 * @return AUVID_OK; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE: see *why */
auvid_status_t auvid_check_fields(const void *cfg, const auvid_field_t *field, size_t n,
                                  auvid_refusal_t *why);

/** Set the element, if there is a *why. @return status */
static inline auvid_status_t auvid_refuse_element(auvid_refusal_t *why, auvid_status_t status,
                                                  int element)
{
    if (status < 0 && why != NULL) {
        why->element = (int16_t)element;
    }
    return status;
}

/** Set the part of the configuration, if there is a *why that has none. @return status */
static inline auvid_status_t auvid_refuse_part(auvid_refusal_t *why, auvid_status_t status,
                                               const char *part)
{
    if (status < 0 && why != NULL && why->part == NULL) {
        why->part = part;
    }
    return status;
}

#endif
