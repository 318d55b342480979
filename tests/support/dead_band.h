/**
 * @file dead_band.h
 * Shared by the tests of a user's own model (dead_band_model.h): its simulation. One test program
 * includes it once.
 */
#ifndef DEAD_BAND_H
#define DEAD_BAND_H

#include "dead_band_model.h"
#include "surge_only.h"

static inline void configure(auvid_identifier_config_t *cfg, uint64_t seed)
{
    surge_configure(cfg, &vehicle, low, high, seed);
}

/** Runs until `sets` of the SETS are complete: see surge_identify. */
static inline void identify(uint64_t seed, uint32_t sets, uint32_t budget, double disturbance_N,
                            double delay_s)
{
    sim_config_t world;
    auvid_identifier_config_t cfg;
    sim_defaults(&world);
    world.seed = seed;
    world.disturbance_N = disturbance_N;
    configure(&cfg, seed);
    surge_identify(&cfg, &world, dead_band_force, sets, budget, delay_s);
}

#endif
