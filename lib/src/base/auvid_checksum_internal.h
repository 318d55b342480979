/**
 * @file auvid_checksum_internal.h
 * Private: what records that outlive the power have in common (prior.h, checkpoint.h).
 */
#ifndef AUVID_CHECKSUM_INTERNAL_H
#define AUVID_CHECKSUM_INTERNAL_H

#include "auvid/types.h"

/** CRC-32 (ISO-HDLC) of n bytes more, before the last inversion; begin with UINT32_MAX. Every error
 * within 32 neighbouring bits is found, whatever the length. */
uint32_t auvid_checksum(uint32_t c, const uint8_t *bytes, uint32_t n);

/** The same of a word, little-endian. */
uint32_t auvid_checksum_word(uint32_t c, uint32_t word);

static inline void auvid_put_word(uint8_t *bytes, uint32_t word)
{
    for (int k = 0; k < 4; ++k) {
        bytes[k] = (uint8_t)(word >> 8 * k);
    }
}

static inline uint32_t auvid_get_word(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/** Bits of x in single precision. */
static inline uint32_t auvid_single_bits(auvid_real_t x)
{
    union {
        float single;
        uint32_t bits;
    } u = {(float)x};
    return u.bits;
}

#endif
