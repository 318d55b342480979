/*
 * Velocities to the north, east and down, or to the east, north and up, instead of those of body
 * axes. Turned into body axes by the attitude they follow their inputs, and as logged they are the
 * rates of the position.
 */
#include <math.h>
#include <stddef.h>

#include "doctor.h"

#define MIN_LLR 20.0                 /* as in doctor_inputs.c */
#define MAX_DISCORD 0.3              /* of the rates of the position */
#define SECOND (2.0 * DOCTOR_WINDOW) /* cells */

/* Sum of squares of surge and sway that is left by their own inputs, whatever their signs and
 * lags, or by each other's. */
static double best_as_logged(const doctor_sums_t *s)
{
    double own = 0.0, crossed = 0.0;
    for (int j = 0; j < 2; ++j) {
        doctor_gain_t g;
        double best = HUGE_VAL;
        for (int lag = 0; lag <= DOCTOR_EARLY + DOCTOR_LATE; ++lag) {
            doctor_regress(s, j, s->own[j][lag], &g);
            best = fmin(best, g.with);
        }
        own += best;
        doctor_regress(s, j, s->cross[j][1 - j], &g);
        crossed += g.with;
    }
    return fmin(own, crossed);
}

static double input_score(const doctor_sums_t *s, int first)
{
    double turned = 0.0, unused;
    for (int j = first; j < first + 2; ++j) {
        double clean;
        doctor_gain_t g;
        doctor_usual(s, j, &clean, &unused, &g);
        turned += clean;
    }
    return doctor_ratio(2.0 * s->count[first] / DOCTOR_WINDOW, best_as_logged(s), turned);
}

static double position_score(const doctor_sums_t *s, int first)
{
    double sum = 0.0;
    for (int i = 0; i < 2; ++i) {
        const doctor_pair_t *p = &s->world[first == DOCTOR_ENU][i];
        double discord = doctor_discord(p, 1.0);
        if (!doctor_is_fast(p) || discord > MAX_DISCORD) {
            return 0.0;
        }
        sum += doctor_ratio(p->n / SECOND, doctor_discord(&s->ground[0][i][i], 1.0), discord);
    }
    return sum;
}

/* Of the whole log: columns do not change during it. */
void doctor_world_scan(doctor_t *d)
{
    bool has = d->has[CSV_ATTITUDE + 2] && d->has[CSV_NU] && d->has[CSV_NU + 1];
    bool sound = !d->reordered && !d->degrees && !(d->turned[2].llr > 0.0);
    bool inputs = d->inputs >= 0 && d->has[d->inputs] && d->has[d->inputs + 1];
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    for (int first = DOCTOR_WORLD; has && sound && first < DOCTOR_AXES; first += 2) {
        double llr = fmax(position_score(&all, first), inputs ? input_score(&all, first) : 0.0);
        if (llr > fmax(d->world_llr, MIN_LLR)) {
            d->world_llr = llr;
            d->in_world = true;
            d->in_enu = first == DOCTOR_ENU;
        }
    }
    if (d->in_world) {
        d->sunk.llr = 0.0; /* depth was compared with velocities of the body */
    }
}

void doctor_world(doctor_t *d)
{
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    if (d->in_world && (d->left_out & 3u) == 0) {
        bool position = position_score(&all, d->in_enu ? DOCTOR_ENU : DOCTOR_WORLD) > MIN_LLR;
        doctor_add(
            d, DOCTOR_ERROR, DOCTOR_WORLD_FRAME, CSV_NU, CSV_NU + 1, NULL,
            "%s: %s: turn them into body axes, u ahead and v to starboard%s",
            d->in_enu ? "u_mps, v_mps and w_mps look like velocities to the east, north and up"
                      : "u_mps and v_mps look like velocities to the north and east",
            !position   ? "they follow the forces ahead and to starboard only if psi_rad turns them"
            : d->in_enu ? "they are the rates of east_m and north_m"
                        : "they are the rates of north_m and east_m",
            d->in_enu ? ", w down" : "");
    }
}
