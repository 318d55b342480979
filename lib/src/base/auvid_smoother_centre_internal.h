/**
 * @file auvid_smoother_centre_internal.h
 * Private: Savitzky-Golay weights for the middle of the window, in closed form.
 */
#ifndef AUVID_SMOOTHER_CENTRE_INTERNAL_H
#define AUVID_SMOOTHER_CENTRE_INTERNAL_H

#include "auvid/types.h"

/** Compute the weights of auvid_smoother_coefficients for derivative 0 and position 0, with much
 * less code.
 * @param half_width h, 1..AUVID_MAX_HALF_WIDTH
 * @param order 0..5 and <= 2 h
 * @param c out, 2 h + 1 values. Error: up to order 3 half a unit in the last place, else 4
 * AUVID_EPSILON of the largest */
void auvid_smoother_centre(int half_width, int order, auvid_real_t *c);

#endif
