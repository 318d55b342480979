/**
 * @file auvid_sqrt_soft_internal.h
 * Private: correctly rounded square root in integer arithmetic, for cores without the instruction.
 *
 * auvid_math.c includes it if the core has no square root instruction. The tests include it on
 * every target and compare it with the instruction.
 *
 * The root is computed bit by bit. With the remainder r and the root q so far, the next bit b
 * belongs to the root if 2 q b + b^2 <= r. One extra bit rounds the mantissa. A square root is
 * never half-way between two numbers, so this is round to nearest.
 */
#ifndef AUVID_SQRT_SOFT_INTERNAL_H
#define AUVID_SQRT_SOFT_INTERNAL_H

#include "auvid/types.h"

/** Returns the bits of the square root of the single-precision number with bits x; 0 for x <= 0 and
 * NaN; 25 iterations. */
static inline uint32_t auvid_sqrt_soft_32(uint32_t x)
{
    if (x - 1u >= 0x7f800000u - 1u) { /* 0, infinity, NaN, negative */
        return x == 0x7f800000u ? x : 0u;
    }
    int32_t e = (int32_t)(x >> 23);
    uint32_t m = x & 0x7fffffu;
    if (e == 0) { /* denormal: normalise */
        for (e = 1; m < 0x800000u; --e) {
            m <<= 1;
        }
    }
    m |= 0x800000u; /* x = m 2^(e - 150) */
    e -= 127;
    m <<= 1 + (e & 1); /* root of m in [2^24, 2^26), exponent even */
    uint32_t q = 0u;
    uint32_t s = 0u; /* 2 q, scaled to the current bit */
    for (uint32_t b = 1u << 24; b != 0u; b >>= 1) {
        if (s + b <= m) {
            m -= s + b;
            s += 2u * b;
            q += b;
        }
        m <<= 1;
    }
    q = (q + 1u) >> 1; /* 25 bits to 24, to nearest */
    return q + (uint32_t)((e - (e & 1)) / 2 + 126) * 0x800000u;
}

/** Returns the same for double precision; 54 iterations. */
static inline uint64_t auvid_sqrt_soft_64(uint64_t x)
{
    const uint64_t infinity = (uint64_t)0x7ff << 52;
    const uint64_t hidden = (uint64_t)1 << 52;
    if (x - 1u >= infinity - 1u) {
        return x == infinity ? x : 0u;
    }
    int32_t e = (int32_t)(x >> 52);
    uint64_t m = x & (hidden - 1u);
    if (e == 0) {
        for (e = 1; m < hidden; --e) {
            m <<= 1;
        }
    }
    m |= hidden;
    e -= 1023;
    m <<= 1 + (e & 1);
    uint64_t q = 0u;
    uint64_t s = 0u;
    for (uint64_t b = hidden << 1; b != 0u; b >>= 1) {
        if (s + b <= m) {
            m -= s + b;
            s += 2u * b;
            q += b;
        }
        m <<= 1;
    }
    q = (q + 1u) >> 1;
    return q + (uint64_t)((e - (e & 1)) / 2 + 1022) * hidden;
}

#endif
