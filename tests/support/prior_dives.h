/**
 * @file prior_dives.h
 * Shared by the tests of the prior: a simulated vehicle with an identifier, and its parameters as
 * known from a towing tank. A test program includes it once.
 */
#ifndef PRIOR_DIVES_H
#define PRIOR_DIVES_H

#include <math.h>

#include "chain.h"

enum { N = 13 };

static chain_config_t cfg;
static chain_t chain;

/** For setUp: a dive of two sets at 1 N. */
static inline void prior_dives_defaults(void)
{
    chain_defaults(&cfg, 1, 2, 1.0);
}

/* The paper's vehicle, as measured in a towing tank. */
static inline void tank(auvid_real_t *pi, auvid_real_t *sigma)
{
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        pi[i] = i < N ? auvid_girona500_paper[i] : (auvid_real_t)NAN; /* fixed ones: not read */
        sigma[i] = i < N ? (auvid_real_t)(0.05 * fabs((double)pi[i])) : 0;
    }
}

#endif
