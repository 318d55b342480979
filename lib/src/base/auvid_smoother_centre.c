/*
 * Savitzky-Golay weights for the middle of the window (Madden 1978). With h the half-width, an even
 * order has the same weights as the next odd one:
 *
 *     c_k = 1 / (2h+1)                                                        order 0, 1
 *     c_k = 3 (3h^2 + 3h - 1 - 5 k^2) / ((2h-1)(2h+1)(2h+3))                  order 2, 3
 *     c_k = 15/4 (15h^4 + 30h^3 - 35h^2 - 50h + 12 - 35 (2h^2 + 2h - 3) k^2 + 63 k^4)
 *           / ((2h-3)(2h-1)(2h+1)(2h+3)(2h+5))                                order 4, 5
 *
 * For h <= 127 numerator and denominator of the first two are below 2^24: they are exact.
 */
#include "auvid_smoother_centre_internal.h"

#include "auvid_math_internal.h"

void auvid_smoother_centre(int half_width, int order, auvid_real_t *c)
{
    auvid_real_t h = (auvid_real_t)half_width, n = AUVID_C(2.0) * h, a = AUVID_C(1.0),
                 b = AUVID_C(0.0), d = AUVID_C(0.0), under = n + AUVID_C(1.0);
    if (order >= 2) {
        a = AUVID_C(9.0) * (h * h + h) - AUVID_C(3.0);
        b = AUVID_C(-15.0);
        under *= (n - AUVID_C(1.0)) * (n + AUVID_C(3.0));
    }
    if (order >= 4) {
        auvid_real_t cubic = (AUVID_C(15.0) * h + AUVID_C(30.0)) * h - AUVID_C(35.0);
        a = AUVID_C(3.75) * ((cubic * h - AUVID_C(50.0)) * h + AUVID_C(12.0));
        b = AUVID_C(-131.25) * (AUVID_C(2.0) * (h * h + h) - AUVID_C(3.0));
        d = AUVID_C(236.25);
        under *= (n - AUVID_C(3.0)) * (n + AUVID_C(5.0));
    }
    for (int k = -half_width; k <= half_width; ++k) {
        auvid_real_t square = (auvid_real_t)(k * k);
        *c++ = (a + (b + d * square) * square) / under;
    }
}
