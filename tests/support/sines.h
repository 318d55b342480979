/**
 * @file sines.h
 * Shared by the tests of the confidence: a Girona500 whose motion is a sum of sines, at the cells
 * of the recorder, with the wrench of known parameters, and approximately Gaussian noise.
 */
#ifndef SINES_H
#define SINES_H

#include <math.h>
#include <string.h>

#include "auvid/vehicle.h"

/** Approximately Gaussian with rms 1, the same in every build. */
static inline double sines_gauss(uint64_t *state)
{
    double sum = -6.0;
    for (int k = 0; k < 12; ++k) {
        *state = *state * 6364136223846793005u + 1442695040888963407u;
        sum += (double)(*state >> 11) / 9007199254740992.0;
    }
    return sum;
}

/** White noise of force_N rms on DoF j; for moments 0.4 times that in Nm. */
static inline double sines_noise(double force_N, int j, uint64_t *state)
{
    return force_N * (j == AUVID_YAW ? 0.4 : 1.0) * sines_gauss(state);
}

/** Motion at time t [s]: sines that do not repeat, in the DoF of the mask, and a little pitch. */
static inline void sines_motion(double t, uint32_t dofs, auvid_sample_t *s)
{
    static const double hertz[3] = {0.031, 0.083, 0.171};
    memset(s, 0, sizeof *s);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double u = 0.0, a = 0.0;
        for (int k = 0; k < 3 && (dofs >> j & 1u); ++k) {
            double w = 6.283185307 * hertz[k] * (1.0 + 0.07 * j), part = 0.25 / (1.0 + k);
            u += part * sin(w * t + j + k);
            a += part * w * cos(w * t + j + k);
        }
        s->nu[j] = (auvid_real_t)u;
        s->nu_dot[j] = (auvid_real_t)a;
    }
    s->theta = (auvid_real_t)(0.02 * sin(0.41 * t));
}

/** The wrench of Eq. 12-15 for the sample's motion, with the 13 parameters of `truth`. */
static inline void sines_wrench(const auvid_sample_t *s, const auvid_real_t *truth,
                                double tau[AUVID_DOF_COUNT])
{
    auvid_regressor_t y;
    memset(&y, 0, sizeof y);
    auvid_girona500.regressor(auvid_girona500.context, s, NULL, &y);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        tau[j] = 0.0;
        for (int i = 0; i < AUVID_G500_COUNT; ++i) {
            tau[j] += (double)y.row[j][i] * (double)truth[i];
        }
    }
}

#endif
