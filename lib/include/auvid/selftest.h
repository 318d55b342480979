/**
 * @file selftest.h
 * Is this machine's arithmetic auvid's? A log replayed on a desk steps through the very
 * identification of the dive only if every operation gives the same bits on both machines.
 *
 * Who calls it: the init of the identifier, which refuses to start on anything else; call it
 * yourself when you use modules alone. What it finds: flush-to-zero or denormals-are-zero, another
 * rounding mode, contraction into fused multiply-add, excess precision (x87), reassociation or
 * reciprocals by compiler flags, comparisons that ignore NaN, a soft-float library or conversions
 * that round otherwise. It sees the flags auvid_selftest.c was compiled with: compile all of auvid
 * with the same ones.
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
 * Run a short computation over + - * / square root, sin, cos, atan2, denormals, rounding and
 * conversions, and compare the hash of all its bits with the known one.
 *
 * @return AUVID_OK; AUVID_ERR_ARITHMETIC: at least one bit differs
 */
auvid_status_t auvid_selftest(void);

#ifdef __cplusplus
}
#endif

#endif
