/**
 * @file selftest.h
 * Tests that this machine's arithmetic gives the bits that auvid expects. A replayed log repeats
 * the identification of the dive exactly only if every operation gives the same bits on both
 * machines.
 *
 * The init of the identifier calls it and refuses to start if it fails. Call it yourself if you use
 * modules without the identifier. It detects:
 * - flush-to-zero or denormals-are-zero, and another rounding mode;
 * - contraction into fused multiply-add, and excess precision (x87);
 * - reassociation or reciprocals by compiler flags;
 * - comparisons that ignore NaN;
 * - a soft-float library or conversions that round differently.
 *
 * It tests the flags with which auvid_selftest.c was compiled: compile all of auvid with the same
 * flags.
 *
 * Cost: 1.3k instructions (x86-64, -O2). Memory: none kept.
 */
#ifndef AUVID_SELFTEST_H
#define AUVID_SELFTEST_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/**
 * Runs a short computation and compares the hash of all its bits with the known hash. The
 * computation uses + - * /, square root, sin, cos, atan2, denormals, rounding and conversions.
 *
 * @return AUVID_OK; AUVID_ERR_ARITHMETIC (at least one bit differs)
 */
auvid_status_t auvid_selftest(void);

#ifdef __cplusplus
}
#endif

#endif
