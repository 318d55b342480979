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

/** auvid_excitation_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_excitation_set_up(auvid_excitation_t *e, const auvid_excitation_config_t *cfg,
                             auvid_refusal_t *why);

/** Convert s [s], 0..86400, to microseconds. */
uint64_t auvid_excitation_us(auvid_real_t s);

#endif
