/**
 * @file field_hull.h
 * Shared by the tests of the field simulator: the true force on the hull [N, Nm] minus Eq. 12-15,
 * as in the library, with the true parameters of the vehicle.
 */
#ifndef FIELD_HULL_H
#define FIELD_HULL_H

#include <string.h>

#include "auvid/vehicle.h"
#include "field.h"

static inline void field_hull_residual(const field_t *field, double left[6])
{
    const field_truth_t *t = field_truth(field);
    field_built_t built;
    auvid_regressor_t y;
    auvid_sample_t s = {.phi = (auvid_real_t)t->euler[0], .theta = (auvid_real_t)t->euler[1]};
    for (int i = 0; i < 6; ++i) {
        s.nu[i] = (auvid_real_t)t->nu[i];
        s.nu_dot[i] = (auvid_real_t)t->nu_dot[i];
    }
    memset(&y, 0, sizeof y);
    auvid_girona500.regressor(auvid_girona500.context, &s, NULL, &y);
    field_built(field, &built);
    for (int i = 0; i < 6; ++i) {
        left[i] = t->hull[i];
        for (int k = 0; k < SIM_PARAMETERS; ++k) {
            left[i] -= y.row[i][k] * built.parameter[k];
        }
    }
}

#endif
