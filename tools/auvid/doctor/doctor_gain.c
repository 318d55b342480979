/*
 * The regression of doctor_inputs.c.
 */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "doctor.h"

#define FIRST_LAG (DOCTOR_EARLY - 1) /* usual lags */
#define LAST_LAG (DOCTOR_EARLY + DOCTOR_MOST_USUAL)

enum { INPUT, SPEED, QUADRATIC };
enum { ACCELERATION = GAIN_TERMS - 1 };

typedef doctor_gain_t gain_t;

void doctor_regress(const doctor_sums_t *s, int j, const double products[GAIN_TERMS],
                    doctor_gain_t *out)
{
    double m[GAIN_TERMS][GAIN_TERMS], diagonal[GAIN_TERMS];
    bool swept[GAIN_TERMS] = {false};
    memcpy(m, s->fixed[j], sizeof m);
    for (int k = 0; k < GAIN_TERMS; ++k) {
        m[0][k] = m[k][0] = products[k];
    }
    for (int k = 0; k < GAIN_TERMS; ++k) {
        diagonal[k] = m[k][k];
    }
    for (int k = ACCELERATION - 1; k >= SPEED; --k) {
        swept[k] = doctor_sweep(&m[0][0], GAIN_TERMS, k, diagonal[k]);
    }
    out->without = m[ACCELERATION][ACCELERATION];
    /* 1e-5 of the input must be left */
    swept[INPUT] = doctor_sweep(&m[0][0], GAIN_TERMS, INPUT, 1e4 * diagonal[INPUT]);
    out->with = swept[INPUT] ? m[ACCELERATION][ACCELERATION] : out->without;
    out->b = swept[INPUT] ? m[INPUT][ACCELERATION] : 0.0;
    double variance = fmax(out->with, 0.0) / s->count[j] * (double)DOCTOR_WINDOW;
    double speed = sqrt(s->fixed[j][SPEED][SPEED] / s->count[j]);
    for (int k = 0; k < GAIN_TERMS; ++k) {
        out->coefficient[k] = swept[k] ? m[k][ACCELERATION] : 0.0;
        out->t[k] = swept[k] && variance * m[k][k] > 0.0
                        ? out->coefficient[k] / sqrt(variance * m[k][k])
                        : 0.0;
    }
    out->drag = -(out->coefficient[SPEED] + 2.0 * out->coefficient[QUADRATIC] * speed);
}

double doctor_gain_ratio(const doctor_sums_t *s, int j, double without, double with)
{
    return doctor_ratio(s->count[j] / DOCTOR_WINDOW, without, with);
}

void doctor_usual(const doctor_sums_t *s, int j, double *clean, double *against, gain_t *best)
{
    gain_t g;
    *clean = *against = HUGE_VAL;
    best->with = HUGE_VAL;
    for (int k = FIRST_LAG; k <= LAST_LAG; ++k) {
        doctor_regress(s, j, s->own[j][k], &g);
        *clean = fmin(*clean, g.b > 0.0 ? g.with : g.without);
        *against = fmin(*against, g.b < 0.0 && g.drag > 0.0 ? g.with : g.without);
        if (g.with < best->with) {
            *best = g;
        }
    }
}

double doctor_reversed(const doctor_sums_t *s, int j, int first, int last)
{
    double sum = HUGE_VAL;
    for (int k = first; k <= last; ++k) {
        gain_t g;
        doctor_regress(s, j, s->own[j][k], &g);
        sum = fmin(sum, g.b < 0.0 && g.drag > 0.0 ? g.with : g.without);
    }
    return sum;
}

int doctor_best_lag(const doctor_t *d, int j)
{
    double best = 0.0;
    int at = FIRST_LAG;
    for (int k = FIRST_LAG; k <= LAST_LAG; ++k) {
        double sum = 0.0;
        for (int i = 0; i < d->blocks; ++i) {
            const doctor_sums_t *s = &d->block[i].sums;
            gain_t g;
            if (s->count[j] > 0.0) {
                doctor_regress(s, j, s->own[j][k], &g);
                sum += doctor_gain_ratio(s, j, g.without, g.with);
            }
        }
        if (sum > best) {
            best = sum;
            at = k;
        }
    }
    return at;
}
