/**
 * @file refusal.h
 * What a refused configuration is told.
 */
#ifndef REFUSAL_H
#define REFUSAL_H

#include <math.h>

#include "auvid/types.h"
#include "unity.h"

static inline void assert_why(const auvid_refusal_t *why, const char *part, const char *field,
                              int element, double value, double limit)
{
    TEST_ASSERT_EQUAL_STRING(part, why->part);
    TEST_ASSERT_EQUAL_STRING(field, why->field);
    TEST_ASSERT_EQUAL_INT(element, why->element);
    if (isnan(value)) {
        TEST_ASSERT_TRUE(isnan((double)why->value));
    } else {
        TEST_ASSERT_TRUE((auvid_real_t)value == why->value);
    }
    TEST_ASSERT_TRUE(fabs(limit - (double)why->limit) <= 3e-6 * fabs(limit));
}

#endif
