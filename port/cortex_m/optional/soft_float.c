/* Multiplication, addition and subtraction in single precision for cores that have neither a
 * floating-point unit nor a long multiplication (ARMv6-M: Cortex-M0, M0+, M1). An image that this
 * object is linked into uses them in place of the compiler's: fewer instructions, the same bits
 * (IEEE 754, to nearest even, with subnormal numbers). Only a NaN may differ: here it is always the
 * same quiet one.
 *
 * The names are those of ARM's run-time ABI (IHI 0043, table 4). The compiler writes the calls,
 * some only after link-time optimization has dropped what is not called; hence "used". */
#include <stdbool.h>
#include <stdint.h>

#define SIGN 0x80000000u
#define INFINITE 0x7f800000u
#define NOT_A_NUMBER 0x7fc00000u

__attribute__((used)) float __aeabi_fmul(float x, float y);
__attribute__((used)) float __aeabi_fadd(float x, float y);
__attribute__((used)) float __aeabi_fsub(float x, float y);
__attribute__((used)) float __aeabi_frsub(float x, float y);

typedef union {
    float number;
    uint32_t bits;
} single_t;

static inline uint32_t exponent(uint32_t a)
{
    return a << 1 >> 24;
}

/* The mantissa of a normal number: its leading one is bit 30. */
static inline uint32_t mantissa(uint32_t a)
{
    return (a << 8 | SIGN) >> 1;
}

/* The mantissa of any finite number: 0 and subnormal numbers have no leading one. */
static inline uint32_t any_mantissa(uint32_t a)
{
    return exponent(a) == 0 ? a << 9 >> 2 : mantissa(a);
}

/* Of the bits that are shifted out, the last one tells whether any was set. */
static inline uint32_t shifted(uint32_t m, uint32_t by)
{
    uint32_t high = by < 32 ? m >> by : 0;
    return high | ((by < 32 ? high << by : 0) != m);
}

/* The nearest number. m < 2^31 has its leading one in bit 30; less only with exponent e = 1. */
static inline uint32_t rounded(uint32_t sign, uint32_t e, uint32_t m)
{
    uint32_t r = ((e - 1) << 23) + ((m + 0x3fu + (m >> 7 & 1u)) >> 7);
    return sign | (r < INFINITE ? r : INFINITE);
}

/* Product of two mantissas. e is the sum of their exponents. */
static inline uint32_t product(uint32_t sign, uint32_t e, uint32_t a, uint32_t b)
{
    uint32_t a_low = a >> 7 & 0xffffu, a_high = a >> 23;
    uint32_t b_low = b >> 7 & 0xffffu, b_high = b >> 23;
    uint32_t low = a_low * b_low;
    uint32_t m = (a_high * b_high << 16) + a_low * b_high + a_high * b_low + (low >> 16);
    m |= (low & 0xffffu) != 0;
    if (m & SIGN) {
        m = m >> 1 | (m & 1u);
        ++e;
    }
    if (e <= 127) {
        m = shifted(m, 128 - e);
        e = 128;
    }
    return rounded(sign, e - 127, m);
}

/* Exponent 127 more than that of a, which is not 0, and a mantissa with its leading one: a
 * subnormal number too. */
static uint32_t leading(uint32_t a, uint32_t *m)
{
    uint32_t e = 127 + exponent(a) + (exponent(a) == 0);
    *m = any_mantissa(a);
    while (*m < 1u << 30) { /* 23 times at most */
        *m <<= 1;
        --e;
    }
    return e;
}

/* One of the factors is 0, subnormal, infinite or no number. */
static __attribute__((noinline)) uint32_t special_product(uint32_t a, uint32_t b)
{
    uint32_t sign = (a ^ b) & SIGN, a_mantissa, b_mantissa;
    a &= ~SIGN;
    b &= ~SIGN;
    uint32_t largest = a > b ? a : b, smallest = a > b ? b : a;
    if (largest >= INFINITE) {
        return largest > INFINITE || smallest == 0 ? NOT_A_NUMBER : sign | INFINITE;
    }
    if (smallest == 0) {
        return sign;
    }
    uint32_t e = leading(a, &a_mantissa) + leading(b, &b_mantissa);
    /* 127 twice. Below 127 - 31 nothing but the last bit is left. */
    return product(sign, e > 254 + 96 ? e - 254 : 96, a_mantissa, b_mantissa);
}

float __aeabi_fmul(float x, float y)
{
    single_t a = {x}, b = {y};
    uint32_t a_exponent = exponent(a.bits), b_exponent = exponent(b.bits);
    if (a_exponent - 1u >= 254u || b_exponent - 1u >= 254u) {
        a.bits = special_product(a.bits, b.bits);
    } else {
        a.bits = product((a.bits ^ b.bits) & SIGN, a_exponent + b_exponent, mantissa(a.bits),
                         mantissa(b.bits));
    }
    return a.number;
}

/* Sum of two finite numbers with |a| >= |b|: their mantissas, and the larger exponent e. */
static inline uint32_t sum(uint32_t a, uint32_t b, uint32_t e, uint32_t a_mantissa,
                           uint32_t b_mantissa)
{
    if (!((a ^ b) & SIGN)) {
        uint32_t m = a_mantissa + b_mantissa;
        return m & SIGN ? rounded(a & SIGN, e + 1, m >> 1 | (m & 1u)) : rounded(a & SIGN, e, m);
    }
    uint32_t m = a_mantissa - b_mantissa;
    if (m == 0) {
        return 0;
    }
    if (m < 1u << 29) {
        for (uint32_t by = 16; by != 0; by >>= 1) {
            if (m < 1u << (31 - by) && e > by) {
                m <<= by;
                e -= by;
            }
        }
    } else if (m < 1u << 30 && e > 1) {
        m <<= 1;
        --e;
    }
    return rounded(a & SIGN, e, m);
}

/* The smaller one is 0 or subnormal, or the larger one infinite or no number. */
static __attribute__((noinline)) uint32_t special_sum(uint32_t a, uint32_t b)
{
    if (exponent(a) == 255) {
        bool none = a << 1 > INFINITE << 1 || (a ^ b) == SIGN;
        return none ? NOT_A_NUMBER : a;
    }
    if (b << 1 == 0 && a << 1 != 0) {
        return a;
    }
    uint32_t e = exponent(a) == 0 ? 1 : exponent(a);
    return sum(a, b, e, any_mantissa(a), shifted(any_mantissa(b), e - 1));
}

static inline uint32_t added(uint32_t a, uint32_t b)
{
    if (a << 1 < b << 1) {
        uint32_t larger = b;
        b = a;
        a = larger;
    }
    uint32_t e = exponent(a), less = e - exponent(b);
    if (e == 255 || e == less) {
        return special_sum(a, b);
    }
    if (less > 25) { /* below half of the last bit, also next to a power of two */
        return a;
    }
    return sum(a, b, e, mantissa(a), shifted(mantissa(b), less));
}

float __aeabi_fadd(float x, float y)
{
    single_t a = {x}, b = {y};
    a.bits = added(a.bits, b.bits);
    return a.number;
}

float __aeabi_fsub(float x, float y)
{
    single_t a = {x}, b = {y};
    a.bits = added(a.bits, b.bits ^ SIGN);
    return a.number;
}

float __aeabi_frsub(float x, float y)
{
    return __aeabi_fsub(y, x);
}
