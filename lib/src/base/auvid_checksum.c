/*
 * Checksums of records in non-volatile memory.
 */
#include "auvid_checksum_internal.h"

#include "auvid_math_internal.h"

uint32_t auvid_checksum(uint32_t c, const uint8_t *bytes, uint32_t n)
{
    /* 64 bytes of table; a third of the time of a bitwise CRC */
    static const uint32_t half[16] = {
        0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4,
        0x4DB26158, 0x5005713C, 0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C,
        0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C,
    };
    for (uint32_t k = 0; k < n; ++k) {
        c ^= bytes[k];
        c = c >> 4 ^ half[c & 15u];
        c = c >> 4 ^ half[c & 15u];
    }
    return c;
}

uint32_t auvid_checksum_word(uint32_t c, uint32_t word)
{
    uint8_t bytes[4];
    auvid_put_word(bytes, word);
    return auvid_checksum(c, bytes, sizeof bytes);
}
