/*
 * Random numbers: xoshiro256** (Blackman & Vigna 2018), seeded by splitmix64; Gaussian by the polar
 * method.
 */
#include "simulator.h"

#include <math.h>

static uint64_t rotated(uint64_t x, int k)
{
    return (x << k) | (x >> (64 - k));
}

/* splitmix64's finaliser. */
static uint64_t mixed(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

void sim_rng_seed(sim_rng_t *rng, uint64_t seed, uint64_t stream)
{
    uint64_t z = mixed(seed + 0x9e3779b97f4a7c15u) ^ mixed(~stream);
    for (int i = 0; i < 4; ++i) {
        z += 0x9e3779b97f4a7c15u;
        rng->s[i] = mixed(z);
    }
    rng->has_spare = false;
    rng->spare = 0.0;
}

double sim_rng_uniform(sim_rng_t *rng)
{
    uint64_t *s = rng->s, bits = rotated(s[1] * 5, 7) * 9, t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotated(s[3], 45);
    return (double)(bits >> 11) * 0x1p-53;
}

double sim_rng_gauss(sim_rng_t *rng)
{
    double x, y, r2;
    if (rng->has_spare) {
        rng->has_spare = false;
        return rng->spare;
    }
    do {
        x = 2.0 * sim_rng_uniform(rng) - 1.0;
        y = 2.0 * sim_rng_uniform(rng) - 1.0;
        r2 = x * x + y * y;
    } while (r2 >= 1.0 || r2 <= 0.0);
    double scale = sqrt(-2.0 * log(r2) / r2);
    rng->spare = y * scale;
    rng->has_spare = true;
    return x * scale;
}
