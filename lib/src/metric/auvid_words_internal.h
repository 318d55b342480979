/**
 * @file auvid_words_internal.h
 * Private: sentences of limited size, without the C library.
 */
#ifndef AUVID_WORDS_INTERNAL_H
#define AUVID_WORDS_INTERNAL_H

#include "auvid/vehicle.h"

/** A text under construction, always zero-terminated. */
typedef struct {
    char *text;
    size_t size, used;
} auvid_words_t;

/** Appends words, truncated to the size of the text. */
void auvid_words_append(auvid_words_t *w, const char *words);

/** Appends "surge: ". */
void auvid_words_append_dof(auvid_words_t *w, auvid_dof_t dof);

/** Appends a number with up to three decimals, or nothing if it needs more space or more decimals.
 * @return true if it is appended */
bool auvid_words_append_number(auvid_words_t *w, auvid_real_t x);

/** Appends a number in whole steps, or nothing if it is 1e9 steps or more. */
void auvid_words_append_steps(auvid_words_t *w, auvid_real_t x, auvid_real_t step, bool up);

/** Appends |x| with one digit. */
void auvid_words_append_rough(auvid_words_t *w, auvid_real_t x);

#endif
