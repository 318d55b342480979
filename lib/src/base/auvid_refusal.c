/*
 * Checks of configurations that name what they refuse.
 */
#include "auvid_refusal_internal.h"

#include <string.h>

#include "auvid_math_internal.h"

void auvid_check_begin(auvid_refusal_t *why)
{
    *why = (auvid_refusal_t){.part = "", .field = "", .element = -1};
}

void auvid_check_part(auvid_refusal_t *why, const char *part)
{
    if (why->status == AUVID_OK) {
        why->part = part;
        why->element = -1;
    }
}

void auvid_check_element(auvid_refusal_t *why, int element)
{
    if (why->status == AUVID_OK) {
        why->element = (int16_t)element;
    }
}

void auvid_check_limit(auvid_refusal_t *why, bool met, auvid_status_t status, const char *field,
                       auvid_real_t value, auvid_real_t limit)
{
    if (!met && why->status == AUVID_OK) {
        why->status = status;
        why->field = field;
        why->value = value;
        why->limit = limit;
    }
}

void auvid_check_that(auvid_refusal_t *why, bool met, auvid_status_t status, const char *field)
{
    auvid_check_limit(why, met, status, field, AUVID_C(0.0), AUVID_C(0.0));
}

void auvid_check_count(auvid_refusal_t *why, auvid_status_t status, const char *field,
                       uint32_t count, uint32_t max)
{
    auvid_check_limit(why, count - 1u < max, status, field, (auvid_real_t)count,
                      (auvid_real_t)(count < 1 ? 1 : max));
}

void auvid_check_in(auvid_refusal_t *why, const char *field, auvid_real_t value, auvid_real_t low,
                    auvid_real_t high)
{
    bool in_low = value >= low;
    auvid_check_limit(why, in_low && value <= high,
                      auvid_is_finite(value) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE, field, value,
                      in_low ? high : low);
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

void auvid_check_fields(auvid_refusal_t *why, const void *cfg, const auvid_field_t *field, size_t n)
{
    for (; n > 0; --n, ++field) {
        size_t size = field->size >= FIELD_REAL ? sizeof(auvid_real_t) : field->size;
        for (int i = 0; i < field->n; ++i) {
            auvid_real_t value, limit;
            bool met =
                refusal_in_range((const unsigned char *)cfg + field->offset + (size_t)i * size,
                                 field, &value, &limit);
            if (!met && field->n > 1 && why->element < 0) {
                auvid_check_element(why, i);
            }
            auvid_check_limit(why, met,
                              auvid_is_finite(value) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE,
                              field->name, value, limit);
        }
    }
}
