/*
 * Checks of configurations that name what they refuse.
 */
#include "auvid_refusal_internal.h"

#include <string.h>

#include "auvid_math_internal.h"

auvid_status_t auvid_refuse(auvid_refusal_t *why, auvid_status_t status, const char *field,
                            auvid_real_t value, auvid_real_t limit)
{
    if (why != NULL) {
        why->part = NULL;
        why->field = field;
        why->element = -1;
        why->value = value;
        why->limit = limit;
    }
    return status;
}

/* Set *value to an element, and *limit to the end of the range beyond which it is. @return whether
 * it is within the range */
static bool refusal_in_range(const unsigned char *element, const auvid_field_t *field,
                             auvid_real_t *value, auvid_real_t *limit)
{
    bool in_low, in_high;
    if (field->size >= FIELD_REAL) {
        memcpy(value, element, sizeof *value);
        in_low = field->size == FIELD_REAL ? *value >= field->low : *value > field->low;
        in_high = *value <= field->high;
    } else {
        uint32_t whole = *element;
        uint16_t half;
        if (field->size == sizeof whole) {
            memcpy(&whole, element, sizeof whole);
        } else if (field->size == sizeof half) {
            memcpy(&half, element, sizeof half);
            whole = half;
        }
        *value = (auvid_real_t)whole;
        in_low = whole >= (uint32_t)field->low;
        /* 2^32: no upper limit */
        in_high = field->high >= AUVID_C(4294967296.0) || whole <= (uint32_t)field->high;
    }
    *limit = in_low ? field->high : field->low;
    return in_low && in_high;
}

auvid_status_t auvid_check_fields(const void *cfg, const auvid_field_t *field, size_t n,
                                  auvid_refusal_t *why)
{
    for (; n > 0; --n, ++field) {
        size_t size = field->size >= FIELD_REAL ? sizeof(auvid_real_t) : field->size;
        for (int i = 0; i < field->n; ++i) {
            auvid_real_t value, limit;
            if (!refusal_in_range((const unsigned char *)cfg + field->offset + (size_t)i * size,
                                  field, &value, &limit)) {
                auvid_status_t status =
                    auvid_is_finite(value) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
                (void)auvid_refuse(why, status, field->name, value, limit);
                return auvid_refuse_element(why, status, field->n > 1 ? i : -1);
            }
        }
    }
    return AUVID_OK;
}
