/*
 * A run of the adaptive excitation aboard the simulated vehicle, and what was observed of it.
 */
#ifndef ADAPTIVE_RUN_H
#define ADAPTIVE_RUN_H

#include <math.h>
#include <string.h>

#include "auvid/adaptive.h"
#include "chain.h"
#include "unity.h"

enum { N = 13, ALL = 0x1FFF };

static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};

static chain_config_t config;
static chain_t chain;
static auvid_adaptive_config_t cfg;

/* Observations of a run. */
static struct {
    bool over;     /* a wrench exceeded an amplitude or the thrusters */
    bool outside;  /* a wrench while the guard was not EXCITING */
    double done_s; /* when everything was known; 0: not yet */
    double square; /* mean square error at that time */
    double rest_s; /* when the excitation had faded out: SETTLING; 0: not yet */
    double end_s;  /* when the guard was DONE; 0: not yet */
    uint32_t changed;
} seen;

static inline void watch(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    (void)status;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double f = fabs((double)out->excitation[j]);
        seen.over = seen.over || !(f <= (double)cfg.amplitude[j] * 1.000001);
        seen.outside = seen.outside || (f > 0.0 && out->guard != AUVID_GUARD_EXCITING);
    }
    seen.over = seen.over || c->actuation.saturated;
    seen.changed += (out->events & AUVID_EVENT_CHANGED) != 0;
    if (seen.done_s <= 0.0 && c->id.estimate.confidence.identifiable == ALL) {
        seen.done_s = 1e-6 * (double)c->t_us;
        seen.square = chain_mean_square(c);
    }
    if (seen.rest_s <= 0.0 && out->guard == AUVID_GUARD_SETTLING) {
        seen.rest_s = 1e-6 * (double)c->t_us;
    }
    if (seen.end_s <= 0.0 && out->guard == AUVID_GUARD_DONE) {
        seen.end_s = 1e-6 * (double)c->t_us;
    }
}

/* A world with bounds for vehicles of all sizes. */
static inline void make_world(uint64_t seed, double disturbance_N)
{
    chain_defaults(&config, seed, 16, disturbance_N);
    for (int i = 0; i < N; ++i) {
        config.id.search.lower[i] = -4000;
        config.id.search.upper[i] = 4000;
    }
    config.after = watch;
    memset(&seen, 0, sizeof seen);
    auvid_adaptive_defaults(&cfg);
    memcpy(cfg.amplitude, amplitude, sizeof cfg.amplitude);
    cfg.seed = seed;
}

static inline void begin(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
}

/* Run until the guard is DONE or ABORTED, at most max_s. */
static inline void run(double max_s)
{
    while (1e-6 * (double)chain.t_us < max_s && chain.out.guard != AUVID_GUARD_DONE &&
           chain.out.guard != AUVID_GUARD_ABORTED) {
        chain_tick(&chain);
    }
}

#endif
