/**
 * @file auvid_checksum_internal.h
 * Private: functions for records in non-volatile memory (prior.h, checkpoint.h).
 */
#ifndef AUVID_CHECKSUM_INTERNAL_H
#define AUVID_CHECKSUM_INTERNAL_H

#include "auvid/types.h"

/** Continues a CRC-32 (ISO-HDLC) with n bytes. Start with c = UINT32_MAX. The final inversion is
 * not applied. The CRC detects every error within 32 adjacent bits, for any length.
 * @return the CRC so far */
uint32_t auvid_checksum(uint32_t c, const uint8_t *bytes, uint32_t n);

/** Continues the CRC-32 with a word, little-endian. */
uint32_t auvid_checksum_word(uint32_t c, uint32_t word);

/** Writes a word to bytes[4], little-endian. */
static inline void auvid_put_word(uint8_t *bytes, uint32_t word)
{
    for (int k = 0; k < 4; ++k) {
        bytes[k] = (uint8_t)(word >> 8 * k);
    }
}

/** Reads a word from bytes[4], little-endian. */
static inline uint32_t auvid_get_word(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

/** Returns the bits of x in single precision. */
static inline uint32_t auvid_single_bits(auvid_real_t x)
{
    float single = (float)x;
    uint32_t bits;
    memcpy(&bits, &single, sizeof bits);
    return bits;
}

/** Returns the number that has these bits in single precision. */
static inline auvid_real_t auvid_from_single_bits(uint32_t bits)
{
    float single;
    memcpy(&single, &bits, sizeof single);
    return (auvid_real_t)single;
}

#endif
