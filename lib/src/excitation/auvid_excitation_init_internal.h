/**
 * @file auvid_excitation_init_internal.h
 * Private: what checking a configuration shares with the other files of the excitation.
 */
#ifndef AUVID_EXCITATION_INIT_INTERNAL_H
#define AUVID_EXCITATION_INIT_INTERNAL_H

#include "auvid/excitation.h"

#include "../base/auvid_math_internal.h"

/** Is x in low..high? Not when one of them is NaN. */
bool auvid_excitation_in(auvid_real_t x, auvid_real_t low, auvid_real_t high);

/** Microseconds of s [s], 0..86400. */
uint64_t auvid_excitation_us(auvid_real_t s);

#endif
