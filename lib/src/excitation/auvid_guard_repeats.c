/*
 * Sensors that repeat their values. A driver that hangs sends its last sample again, with a new
 * time, a good counter and a good checksum. While the vehicle is excited, noise changes the samples
 * of a DVL and a gyroscope in at least one of three axes. Attitude and depth may be rounded more
 * coarsely than their noise, so only the time in which the vehicle turns, or rises or sinks,
 * counts: 0.3 rad and 0.3 m at the defaults, which no rounding hides. Zeros are what sensors
 * without noise have at rest, and what a coarse DVL has where the vehicle only turns.
 */
#include "auvid_guard_repeats_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"

enum { ZEROS = 1, MIN_REPEATS = 8 };

uint32_t auvid_guard_values(const auvid_real_t *x, int n)
{
    uint32_t hash = 0;
    for (int i = 0; x != NULL && i < n; ++i) {
        uint32_t word[sizeof x[0] / sizeof(uint32_t)];
        memcpy(word, &x[i], sizeof word);
        for (unsigned k = 0; k < sizeof word / sizeof word[0]; ++k) {
            hash = (hash ^ word[k]) * 16777619u; /* FNV-1a: a change of one word changes it */
        }
    }
    return hash == 0 ? ZEROS : hash;
}

/* Must the sensor have changed since the last tick? */
static bool guard_must_change(const auvid_guard_t *g, const auvid_guard_input_t *in, int source)
{
    const auvid_real_t *v = in->velocity_ground, *w = in->rates;
    if (source == AUVID_GUARD_ATTITUDE) {
        return w[0] * w[0] + w[1] * w[1] + w[2] * w[2] > g->cfg.rest_rate * g->cfg.rest_rate;
    }
    if (source == AUVID_GUARD_PRESSURE) { /* for small angles */
        return auvid_abs(v[2] + in->roll * v[1] - in->pitch * v[0]) > g->cfg.rest_speed;
    }
    return true;
}

void auvid_guard_track_repeats(auvid_guard_t *g, uint64_t t_us, const auvid_guard_input_t *in)
{
    uint32_t most_us = g->cfg.repeat_us / MIN_REPEATS; /* that counts between two samples */
    uint32_t step_us = t_us - g->t_us < most_us ? (uint32_t)(t_us - g->t_us) : most_us;
    for (int i = 0; i < AUVID_GUARD_SOURCES; ++i) {
        uint32_t values = in->values[i];
        if (g->waited_us[i] < most_us && guard_must_change(g, in, i)) {
            g->waited_us[i] += step_us;
        }
        if (values == 0) {
            continue;
        }
        if (values != g->values[i] || values == ZEROS || g->state != AUVID_GUARD_EXCITING) {
            g->repeat_us[i] = 0;
        } else if (g->repeat_us[i] <= g->cfg.repeat_us) {
            g->repeat_us[i] += g->waited_us[i];
        }
        g->values[i] = values;
        g->waited_us[i] = 0;
    }
}
