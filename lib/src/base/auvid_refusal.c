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

static void refusal_check_whole(auvid_refusal_t *why, const auvid_field_t *field,
                                const unsigned char *element)
{
    uint32_t whole = *element;
    uint16_t half;
    if (field->size == sizeof whole) {
        memcpy(&whole, element, sizeof whole);
    } else if (field->size == sizeof half) {
        memcpy(&half, element, sizeof half);
        whole = half;
    }
    bool in_low = whole >= (uint32_t)field->low;
    /* 2^32: no upper limit */
    bool in_high = field->high >= AUVID_C(4294967296.0) || whole <= (uint32_t)field->high;
    auvid_check_limit(why, in_low && in_high, AUVID_ERR_RANGE, field->name, (auvid_real_t)whole,
                      in_low ? field->high : field->low);
}

static void refusal_check_real(auvid_refusal_t *why, const auvid_field_t *field,
                               const unsigned char *element)
{
    auvid_real_t value;
    memcpy(&value, element, sizeof value);
    auvid_check_in(why, field->name, value, field->low, field->high);
    auvid_check_limit(why, field->size == FIELD_REAL || value > field->low, AUVID_ERR_RANGE,
                      field->name, value, field->low);
}

void auvid_check_fields(auvid_refusal_t *why, const void *cfg, const auvid_field_t *field, size_t n)
{
    int named = why->element;
    for (; n > 0; --n, ++field) {
        const unsigned char *element = (const unsigned char *)cfg + field->offset;
        for (int i = 0; i < field->n; ++i) {
            auvid_check_element(why, field->n > 1 && named < 0 ? i : named);
            if (field->size >= FIELD_REAL) {
                refusal_check_real(why, field, element + (size_t)i * sizeof(auvid_real_t));
            } else {
                refusal_check_whole(why, field, element + (size_t)i * field->size);
            }
        }
    }
    auvid_check_element(why, named);
}
