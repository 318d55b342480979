/**
 * @file auvid_excitation_private.h
 * Private: what the parts of the excitation share.
 */
#ifndef AUVID_EXCITATION_PRIVATE_H
#define AUVID_EXCITATION_PRIVATE_H

#include "auvid/excitation.h"

#include "auvid_math.h"

static inline bool excitation_in(auvid_real_t x, auvid_real_t low, auvid_real_t high)
{
    return x >= low && x <= high;
}

/* Whole and fraction apart: float holds 3600 s only to 0.2 ms as a product. s >= 0. */
static inline uint64_t excitation_us(auvid_real_t s)
{
    uint32_t whole = (uint32_t)s;
    auvid_real_t fraction = s - (auvid_real_t)whole;
    return (uint64_t)whole * 1000000u + (uint32_t)(fraction * AUVID_C(1000000.0) + AUVID_C(0.5));
}

#endif
