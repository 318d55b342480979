/**
 * @file auvid_sqrt_internal.h
 * Private: the square root instruction of the core, AUVID_SQRT(r, x): r = sqrt(x). It is not
 * defined where the core has none for auvid_real_t.
 */
#ifndef AUVID_SQRT_INTERNAL_H
#define AUVID_SQRT_INTERNAL_H

#include "auvid/types.h"

/* sqrtf() may be a call or set errno, depending on the user's flags. */
#if defined(__GNUC__) && defined(__AVX__)
#define AUVID_SQRT_32(r, x) __asm__("vsqrtss %1, %1, %0" : "=x"(r) : "x"(x))
#define AUVID_SQRT_64(r, x) __asm__("vsqrtsd %1, %1, %0" : "=x"(r) : "x"(x))
#elif defined(__GNUC__) && defined(__SSE2__)
#define AUVID_SQRT_32(r, x) __asm__("sqrtss %1, %0" : "=x"(r) : "x"(x))
#define AUVID_SQRT_64(r, x) __asm__("sqrtsd %1, %0" : "=x"(r) : "x"(x))
#elif defined(__GNUC__) && defined(__aarch64__)
#define AUVID_SQRT_32(r, x) __asm__("fsqrt %s0, %s1" : "=w"(r) : "w"(x))
#define AUVID_SQRT_64(r, x) __asm__("fsqrt %d0, %d1" : "=w"(r) : "w"(x))
#elif defined(__GNUC__) && defined(__arm__) && defined(__ARM_FP) && !defined(__SOFTFP__)
#if (__ARM_FP & 4)
#define AUVID_SQRT_32(r, x) __asm__("vsqrt.f32 %0, %1" : "=t"(r) : "t"(x))
#endif
#if (__ARM_FP & 8)
#define AUVID_SQRT_64(r, x) __asm__("vsqrt.f64 %P0, %P1" : "=w"(r) : "w"(x))
#endif
#elif defined(__GNUC__) && defined(__riscv_flen)
#define AUVID_SQRT_32(r, x) __asm__("fsqrt.s %0, %1" : "=f"(r) : "f"(x))
#if __riscv_flen >= 64
#define AUVID_SQRT_64(r, x) __asm__("fsqrt.d %0, %1" : "=f"(r) : "f"(x))
#endif
#endif

#if defined(AUVID_REAL_DOUBLE) && defined(AUVID_SQRT_64)
#define AUVID_SQRT AUVID_SQRT_64
#elif !defined(AUVID_REAL_DOUBLE) && defined(AUVID_SQRT_32)
#define AUVID_SQRT AUVID_SQRT_32
#endif

#endif
