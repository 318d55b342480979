/**
 * @file recorder_streams.h
 * Shared by the tests of the recorder: its streams, and cells as the header of the recorder defines
 * them (linear or held between the samples), integrated in double. A test program includes it once.
 */
#ifndef RECORDER_STREAMS_H
#define RECORDER_STREAMS_H

#include <math.h>
#include <string.h>

#include "auvid/detail/recorder.h"
#include "unity.h"

enum { ATTITUDE, VELOCITY, INPUT, MOST = 4000 };
#define T0 1000000000ull

static auvid_recorder_t recorder;
static auvid_recorder_config_t cfg;

/* ---- signals and their means by definition ---- */

typedef struct {
    size_t samples;
    uint64_t t_us[MOST];
    double value[MOST];
} track_t;

static track_t track[3];

static inline auvid_real_t scaled(double x, int channel)
{
    return (auvid_real_t)(x * (channel + 1));
}

/* Channel i of a stream has (i + 1) times the track's value. */
static inline auvid_status_t feed(int stream, uint64_t t_us, double x)
{
    auvid_real_t a[6], b[AUVID_MAX_COMMANDS];
    for (int i = 0; i < 6; ++i) {
        a[i] = scaled(x, i);
    }
    for (int i = 0; i < AUVID_MAX_COMMANDS; ++i) {
        b[i] = scaled(x, 6 + i);
    }
    switch (stream) {
    case ATTITUDE:
        return auvid_recorder_attitude(&recorder, t_us, a, a + 3);
    case VELOCITY:
        return auvid_recorder_velocity(&recorder, t_us, a, 7u);
    default:
        return auvid_recorder_input(&recorder, t_us, a, b);
    }
}

static inline auvid_status_t feed_noted(int stream, uint64_t t_us, double x)
{
    track_t *t = &track[stream];
    t->t_us[t->samples] = t_us;
    t->value[t->samples++] = (double)(auvid_real_t)x;
    return feed(stream, t_us, x);
}

/* Integral from `from` to `to`, segment by segment. */
static inline double mean_of(const track_t *t, bool hold, uint64_t from, uint64_t to)
{
    double sum = 0;
    for (size_t i = 0; i + 1 < t->samples; ++i) {
        double a = (double)t->t_us[i] - (double)from, b = (double)t->t_us[i + 1] - (double)from;
        double low = fmax(a, 0), high = fmin(b, (double)(to - from));
        if (low < high) {
            double at_low = t->value[i] + (t->value[i + 1] - t->value[i]) * (low - a) / (b - a);
            double at_high = t->value[i] + (t->value[i + 1] - t->value[i]) * (high - a) / (b - a);
            sum += (high - low) * (hold ? t->value[i] : 0.5 * (at_low + at_high));
        }
    }
    return sum / (double)(to - from);
}

static inline double slope_of(const track_t *t, uint64_t middle)
{
    double m[5];
    for (int k = -2; k <= 2; ++k) {
        uint64_t at = middle + (uint64_t)(int64_t)(k * (int64_t)cfg.cell_us) - cfg.cell_us / 2;
        m[k + 2] = mean_of(t, false, at, at + cfg.cell_us);
    }
    return (8 * (m[3] - m[1]) - (m[4] - m[0])) / (12 * cfg.cell_us * 1e-6);
}

/* 40 roundings of a value, each eps / 2; slopes carry 18 / 12 cell times that. */
static inline void assert_cell(const auvid_sample_t *s)
{
    uint64_t from = s->t_us - cfg.cell_us / 2, to = from + cfg.cell_us;
    double attitude = mean_of(&track[ATTITUDE], false, from, to);
    double velocity = mean_of(&track[VELOCITY], false, from, to);
    double input = mean_of(&track[INPUT], cfg.input == AUVID_INPUT_HOLD, from, to);
    double slope[2] = {slope_of(&track[VELOCITY], s->t_us), slope_of(&track[ATTITUDE], s->t_us)};
    double tiny = 20 * (double)AUVID_EPSILON * 14 * 2; /* values reach 2, the largest scale is 14 */
    double per_s = 1.5 / (cfg.cell_us * 1e-6);
    TEST_ASSERT_DOUBLE_WITHIN(tiny, attitude, (double)s->phi);
    TEST_ASSERT_DOUBLE_WITHIN(tiny, 2 * attitude, (double)s->theta);
    TEST_ASSERT_DOUBLE_WITHIN(tiny, 3 * attitude, (double)s->psi);
    for (int j = 0; j < 3; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(tiny, (j + 1) * velocity, (double)s->nu[j]);
        TEST_ASSERT_DOUBLE_WITHIN(tiny, (j + 4) * attitude, (double)s->nu[3 + j]);
        TEST_ASSERT_DOUBLE_WITHIN(tiny * per_s, (j + 1) * slope[0], (double)s->nu_dot[j]);
        TEST_ASSERT_DOUBLE_WITHIN(tiny * per_s, (j + 4) * slope[1], (double)s->nu_dot[3 + j]);
    }
    for (int j = 0; j < 6; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(tiny, (j + 1) * input, (double)s->tau[j]);
    }
    for (int i = 0; i < AUVID_MAX_COMMANDS; ++i) {
        TEST_ASSERT_DOUBLE_WITHIN(tiny * (i > 7 ? i : 1), (i + 7) * input, (double)s->command[i]);
    }
}

#endif
