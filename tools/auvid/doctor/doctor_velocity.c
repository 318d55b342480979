/*
 * Velocities that no vehicle has: another unit, marks of missing samples (units.h), outliers, and
 * zeros where the sensor had no lock. A few of them spoil a fit.
 */
#include <math.h>
#include <stdio.h>

#include "doctor.h"

#define JUMP 3.0   /* a change in one row [m/s] .. */
#define STEEP 50.0 /* .. within less time than this [m/s2] allows */
#define MOVES 0.1  /* a vehicle does not stop at once from faster [m/s] */
#define MIN_DROPS 3.0

/* Returns the last speed; 0 if it is the smallest of the log, a step of coarse values. */
static double moved(const doctor_velocity_t *w)
{
    double last = fabs(w->last);
    return last > 1.5 * w->least ? last : 0.0;
}

static void watch(doctor_t *d, int i, double t, double v)
{
    doctor_velocity_t *w = &d->velocity[i];
    bool less = fabs(v) > 0.0 && (fabs(v) < w->least || !(w->least > 0.0));
    w->least = less ? fabs(v) : w->least;
    double change = fabs(v - w->last);
    if (d->units.speed[i].n > 0.0 && change > JUMP && change > STEEP * (t - w->last_s)) {
        w->at_s = w->jumps > 0.0 ? w->at_s : t;
        w->jump = fmax(w->jump, change);
        w->jumps += 1.0;
    }
    w->last = v;
    w->last_s = t;
}

void doctor_velocity_add(doctor_t *d, const csv_row_t *row)
{
    double before = 0.0, now = 0.0;
    bool all = true;
    for (int i = 0; i < 3; ++i) {
        double v = row->value[CSV_NU + i];
        if (d->has[CSV_NU + i]) {
            all = all && isfinite(v);
            before = fmax(before, moved(&d->velocity[i]));
            now = fmax(now, isfinite(v) ? fabs(v) : 0.0);
        }
        if (d->has[CSV_NU + i] && isfinite(v)) {
            watch(d, i, row->value[CSV_T], v);
        }
    }
    if (all) {
        bool zero = !(now > 0.0), drops = zero && before > MOVES;
        d->drops += drops ? 1.0 : 0.0;
        d->dropped = zero && (drops || d->dropped);
        d->zeros += d->dropped ? 1.0 : 0.0;
    }
}

bool doctor_velocity_drops(const doctor_t *d)
{
    return d->drops >= MIN_DROPS;
}

void doctor_velocity(doctor_t *d)
{
    for (int i = 0; i < 3; ++i) {
        const doctor_velocity_t *w = &d->velocity[i];
        const char *name = csv_name[CSV_NU + i];
        char text[UNITS_TEXT];
        units_speed_kind_t kind = units_speed_judge(&d->units.speed[i], name, text, sizeof text);
        bool few = kind == UNITS_SPEED_OK || kind == UNITS_SPEED_OUTLIER;
        if (few && w->jumps > 0.0) {
            doctor_add(d, DOCTOR_ERROR, DOCTOR_OUTLIER, CSV_NU + i, -1, NULL,
                       "%s jumps %.0f time%s by up to %.3g m/s from row to row, first at t_s %.2f: "
                       "leave cells of outliers empty",
                       name, w->jumps, w->jumps > 1.0 ? "s" : "", w->jump, w->at_s);
        } else if (kind != UNITS_SPEED_OK) {
            doctor_add(d, DOCTOR_ERROR, kind == UNITS_SPEED_SCALE ? DOCTOR_SCALE : DOCTOR_OUTLIER,
                       CSV_NU + i, -1, NULL, "%s", text);
        }
    }
    if (doctor_velocity_drops(d)) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_OUTLIER, CSV_NU, -1, NULL,
                   "the velocities drop from motion to exactly 0 %.0f times, for %.0f rows in all, "
                   "as if the sensor had no lock: leave these cells empty",
                   d->drops, d->zeros);
    }
}
