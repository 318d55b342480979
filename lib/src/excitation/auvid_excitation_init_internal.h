/**
 * @file auvid_excitation_init_internal.h
 * Private: functions shared by the files of the excitation.
 */
#ifndef AUVID_EXCITATION_INIT_INTERNAL_H
#define AUVID_EXCITATION_INIT_INTERNAL_H

#include "auvid/excitation.h"

#include "../base/auvid_math_internal.h"

/** Return whether x is in low..high; false if one of them is NaN. */
bool auvid_excitation_in(auvid_real_t x, auvid_real_t low, auvid_real_t high);

/** Check a configuration, and compute the length of the sequence. *why names what is refused; NULL:
 * not wanted. @return the statuses of auvid_excitation_init */
auvid_status_t auvid_excitation_check(const auvid_excitation_config_t *cfg, uint64_t *sequence_us,
                                      auvid_refusal_t *why);

/** Convert s [s], 0..86400, to microseconds. */
uint64_t auvid_excitation_us(auvid_real_t s);

#endif
