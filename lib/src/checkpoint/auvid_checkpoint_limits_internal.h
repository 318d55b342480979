/**
 * @file auvid_checkpoint_limits_internal.h
 * Private: how the ranges of members are written, a row for adjacent scalars of one type.
 */
#ifndef AUVID_CHECKPOINT_LIMITS_INTERNAL_H
#define AUVID_CHECKPOINT_LIMITS_INTERNAL_H

#include "auvid_checkpoint_layout_internal.h"
#include "../base/auvid_math_internal.h"

#define BYTES(type, first, last)                                                                   \
    (offsetof(type, last) + sizeof(((type *)0)->last) - offsetof(type, first))
/* A negative size, which does not compile, unless there are whole units. */
#define UNITS(bytes, unit) ((bytes) / sizeof(char[(bytes) % sizeof(unit) ? -1 : sizeof(unit)]))
/* `first` .. `last`, scalars of type `unit`. */
#define LIMIT(table, kind, unit, first, last, low, high)                                           \
    {                                                                                              \
        TABLE_##table, kind, sizeof(unit), (uint32_t)offsetof(auvid_##table##_t, first),           \
            (uint32_t)UNITS(BYTES(auvid_##table##_t, first, last), unit), (auvid_real_t)(low),     \
            (auvid_real_t)(high)                                                                   \
    }
/* Reals: low .. high; -max .. max; 0 .. max; any finite one. */
#define RANGE(table, first, last, low, high)                                                       \
    LIMIT(table, KIND_REAL, auvid_real_t, first, last, low, high)
#define WITHIN(table, first, last, max) RANGE(table, first, last, -(max), max)
#define UP_TO(table, first, last, max) RANGE(table, first, last, AUVID_C(0.0), max)
#define FINITE(table, first, last) WITHIN(table, first, last, AUVID_LARGEST)
/* Integers of a type: low .. high; 0 .. max. */
#define SIGNED(table, unit, first, last, low, high)                                                \
    LIMIT(table, KIND_SIGNED, unit, first, last, low, high)
#define WHOLE(table, unit, first, last, low, high)                                                 \
    LIMIT(table, KIND_UNSIGNED, unit, first, last, low, high)
#define COUNT(table, unit, first, last, max) WHOLE(table, unit, first, last, 0, max)
#define BYTE(table, first, last, max) COUNT(table, uint8_t, first, last, max)
#define FLAG(table, first, last) BYTE(table, first, last, 1)
/* Bit j: DoF j; bit i: velocity i. */
#define DOF_BITS(table, first, last) BYTE(table, first, last, ALL_DOF)
#define AXES(table, member) BYTE(table, member, member, AUVID_DVL_ALL)

/* Parameters, bounds, steps: their squares are finite. Costs. Sums of squares of rows, which are
 * within 1e15. Lengths and speeds. Counts of evaluations: they do not wrap around. Delays: six of
 * the longest cells. */
#define VALUE(table, first, last) WITHIN(table, first, last, AUVID_C(1e18))
#define COST(table, first, last) WITHIN(table, first, last, AUVID_COST_FAILED)
#define SQUARES(table, first, last) UP_TO(table, first, last, AUVID_C(1e35))
#define LENGTH(table, first, last) WITHIN(table, first, last, AUVID_C(1e9))
#define EVALUATIONS(table, member) COUNT(table, uint32_t, member, member, 1 << 30)
#define DELAY(table, first, last) RANGE(table, first, last, AUVID_C(-2.01), AUVID_C(6.01))

enum { ALL_DOF = (1 << AUVID_DOF_COUNT) - 1, MAX_OVERLAP = AUVID_MAX_OVERLAP };

#endif
