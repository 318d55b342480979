/* Are the numbers of port/cortex_m/optional/soft_float.c those of this processor, bit for bit? Run
 * by test_soft_float.sh. usage: soft_float PAIRS */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

float __aeabi_fmul(float x, float y);
float __aeabi_fadd(float x, float y);
float __aeabi_fsub(float x, float y);
float __aeabi_frsub(float x, float y);

#define MANTISSA 0x807fffffu /* and sign */

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float number_of(uint32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Pairs that rarely occur by chance. */
static void make_special(uint32_t kind, uint32_t *a, uint32_t *b)
{
    switch (kind % 8) {
    case 1: /* a is small */
        *a = (*a & MANTISSA) | (1 + (*a >> 8) % 40) << 23;
        break;
    case 2: /* products between two numbers */
        *a = ((*a & 0x80ffffffu) | 0x3f000000u) & ~0xfffu;
        *b = (*b & 0x80ffff00u) | 0x3f000000u;
        break;
    case 3: /* a is subnormal */
        *a &= MANTISSA;
        break;
    case 4: /* exponents that differ by at most 26 */
        *b = (*b & MANTISSA) | ((*a >> 23) + (*b >> 23) % 53 + 230) % 256 << 23;
        break;
    case 5: /* almost the same, or the opposite */
        *b = *a ^ (*b & 0x80000007u);
        break;
    case 6: /* sums between two numbers, and next to a power of two */
        *a &= 0xff80000fu;
        *b = (*b & 0x80000007u) | ((*a >> 23) - (*b >> 8) % 30) % 256 << 23;
        break;
    case 7: /* both are tiny */
        *a &= 0x81ffffffu;
        *b &= 0x81ffffffu;
        break;
    default: /* powers of two, infinite numbers, zeros */
        *a &= kind & 8 ? 0xff800000u : 0xffffffffu;
        *b &= kind & 16 ? 0xff800000u : 0xffffffffu;
        *b &= kind & 32 ? 0x80000000u : 0xffffffffu;
        *a |= kind & 64 ? 0x7f800000u : 0;
        break;
    }
}

static int is_same(const char *operation, float x, float y, float expected, float found)
{
    if (expected != expected ? found != found : bits_of(expected) == bits_of(found)) {
        return 1;
    }
    printf("%08x %s %08x: %08x, not %08x\n", (unsigned)bits_of(x), operation, (unsigned)bits_of(y),
           (unsigned)bits_of(found), (unsigned)bits_of(expected));
    return 0;
}

int main(int count, char **argument)
{
    long pairs = count > 1 ? strtol(argument[1], NULL, 10) : 0, good = 0;
    uint64_t random = 88172645463325252u;
    for (long i = 0; i < pairs && good == i; ++i) {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        uint32_t a = (uint32_t)random, b = (uint32_t)(random >> 32);
        make_special((uint32_t)i, &a, &b);
        float x = number_of(a), y = number_of(b);
        good += is_same("times", x, y, x * y, __aeabi_fmul(x, y)) &&
                is_same("plus", x, y, x + y, __aeabi_fadd(x, y)) &&
                is_same("minus", x, y, x - y, __aeabi_fsub(x, y)) &&
                is_same("from", x, y, y - x, __aeabi_frsub(x, y));
    }
    printf("%ld of %ld pairs\n", good, pairs);
    return pairs > 0 && good == pairs ? 0 : 1;
}
