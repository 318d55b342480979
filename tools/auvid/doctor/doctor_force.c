/*
 * Specific force against attitude and acceleration. Gravity shows the unit and the vertical axis of
 * the accelerometer in each block of the log. Its other axes show in their variation, by
 * concordance, as in doctor_attitude.c.
 */
#include <math.h>
#include <stddef.h>

#include "doctor.h"

#define MIN_LLR 20.0
#define MIN_EACH 8.0
#define MAX_DISCORD 0.6
#define BEST_DISCORD 0.02 /* sensors do not agree better */
#define MIN_WINDOWS 50.0  /* of a block: 5 s */
#define NEAR 1.25         /* gravity is measured within this factor */
#define NONE 0.03         /* part of gravity that is none */
#define VERTICAL 0.8      /* part of gravity along one axis */

enum { UNITS = 3, KINDS = 3 * 3 * 2 + 1, NO_GRAVITY = KINDS - 1, OTHER = -1 };

/* Specific force of one m/s2: as it should be, in g, in thousandths of g. */
static const double unit_of[UNITS] = {1.0, 1.0 / DOCTOR_GRAVITY, 1000.0 / DOCTOR_GRAVITY};

static const char *name(int axis)
{
    return csv_name[CSV_SPECIFIC_FORCE + axis];
}

static int largest(const double v[3])
{
    int i = fabs(v[1]) > fabs(v[0]) ? 1 : 0;
    return fabs(v[2]) > fabs(v[i]) ? 2 : i;
}

/* What gravity shows in a block: (unit, measured axis, sign), relative to the axis that is vertical
 * by the attitude; OTHER: nothing. */
static int kind_of(const doctor_sums_t *s, int *vertical)
{
    double expected[3], measured[3], n = s->force[0][0].n;
    for (int i = 0; i < 3; ++i) {
        expected[i] = s->force[i][0].a / fmax(n, 1.0);
        measured[i] = s->force[0][i].b / fmax(n, 1.0);
    }
    int i = largest(expected), j = largest(measured);
    *vertical = i;
    if (n < MIN_WINDOWS || fabs(expected[i]) < VERTICAL * DOCTOR_GRAVITY) {
        return OTHER;
    }
    double ratio = measured[j] / expected[i];
    for (int k = 0; k < UNITS; ++k) {
        double part = fabs(ratio) / unit_of[k];
        if (part < NEAR && part > 1.0 / NEAR) {
            return 6 * k + 2 * j + (ratio < 0.0);
        }
    }
    return fabs(ratio) < NONE ? NO_GRAVITY : OTHER;
}

/* The most frequent kind of block with a slip, and where it is. Returns it, or OTHER. */
static int most_frequent(const doctor_t *d, doctor_range_t *range, int *vertical)
{
    int count[KINDS] = {0}, best = OTHER;
    for (int k = 0; k < d->blocks; ++k) {
        int kind = kind_of(&d->block[k].sums, vertical);
        if (kind == OTHER || kind == 2 * *vertical) {
            continue;
        }
        best = best == OTHER || count[kind] + 1 > count[best] ? kind : best;
        ++count[kind];
    }
    *range = (doctor_range_t){.llr = 1.0, .last = d->blocks - 1};
    while (best != OTHER && kind_of(&d->block[range->first].sums, vertical) != best) {
        ++range->first;
    }
    while (best != OTHER && kind_of(&d->block[range->last].sums, vertical) != best) {
        --range->last;
    }
    /* blocks that are too short show nothing */
    while (range->first > 0 && d->block[range->first - 1].sums.force[0][0].n < MIN_WINDOWS) {
        --range->first;
    }
    while (range->last + 1 < d->blocks &&
           d->block[range->last + 1].sums.force[0][0].n < MIN_WINDOWS) {
        ++range->last;
    }
    return best;
}

static double ratio(const doctor_pair_t *p, double without, double with)
{
    return doctor_ratio(p->n / DOCTOR_WINDOW, without, fmax(with, BEST_DISCORD));
}

static double sign_score(const doctor_t *d, const doctor_sums_t *s, int axis, int *which)
{
    const doctor_pair_t *p = &s->force[axis][axis];
    double with = doctor_discord(p, -1.0 / d->unit);
    *which = 0;
    return with < MAX_DISCORD ? ratio(p, doctor_discord(p, 1.0 / d->unit), with) : 0.0;
}

/* fx and fy exchanged, whatever their signs. */
static double exchange_score(const doctor_t *d, const doctor_sums_t *s, int unused, int *which)
{
    double each[2];
    (void)unused;
    *which = 0;
    for (int i = 0; i < 2; ++i) {
        const doctor_pair_t *own = &s->force[i][i], *other = &s->force[i][1 - i];
        double gain = 1.0 / d->unit;
        double with = fmin(doctor_discord(other, gain), doctor_discord(other, -gain));
        double without = fmin(doctor_discord(own, gain), doctor_discord(own, -gain));
        each[i] = with < MAX_DISCORD ? ratio(own, without, with) : 0.0;
    }
    return each[0] > MIN_EACH && each[1] > MIN_EACH ? each[0] + each[1] : 0.0;
}

/* Is the sign of roll (0) or pitch (1) known to be right, by its rate? */
static bool angle_is_sure(const doctor_t *d, int axis)
{
    doctor_sums_t all;
    doctor_sum(d, 0, d->blocks - 1, &all);
    const doctor_pair_t *p = &all.turn[0][axis][axis];
    return d->has[CSV_NU + 3 + axis] &&
           ratio(p, doctor_discord(p, -1.0), doctor_discord(p, 1.0)) > MIN_LLR;
}

/* An axis runs against the angle that tilts it. */
static void add_sign(doctor_t *d, int axis, const doctor_range_t *range)
{
    int angle = 1 - axis;
    const char *of = csv_name[CSV_ATTITUDE + angle];
    char where[48];
    doctor_where(d, range, where);
    if (angle_is_sure(d, angle)) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE + axis, -1, range,
                   "%s has the wrong sign: it changes against %s and the acceleration%s: change "
                   "its sign",
                   name(axis), of, where);
    } else {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE + axis,
                   CSV_ATTITUDE + angle, range,
                   "%s changes against %s%s: one of them has the wrong sign: change it", name(axis),
                   of, where);
    }
}

/* Signs of the axes; upside: fz has the wrong sign, by gravity. */
static void find_signs(doctor_t *d, bool upside, const doctor_range_t *range)
{
    doctor_range_t r[2];
    bool wrong[2];
    char where[48];
    for (int i = 0; i < 2; ++i) {
        r[i] = doctor_scan(d, sign_score, i);
        wrong[i] = r[i].llr > MIN_LLR;
    }
    doctor_where(d, range, where);
    if (upside && wrong[1] && !wrong[0]) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_FRAME, CSV_SPECIFIC_FORCE + 1, CSV_SPECIFIC_FORCE + 2,
                   range,
                   "fy_mps2 and fz_mps2 are reversed%s, as in FLU axes (y to port, z up): change "
                   "their signs",
                   where);
    } else if (upside && wrong[0] && wrong[1]) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE, -1, range,
                   "fx_mps2, fy_mps2 and fz_mps2 are reversed%s, as if they were gravity less "
                   "acceleration: change their signs",
                   where);
    } else if (upside) {
        doctor_add(
            d, DOCTOR_WARNING, DOCTOR_FORCE_SIGN, CSV_SPECIFIC_FORCE + 2, -1, range,
            "fz_mps2 is positive at rest%s, but z points down, and it should be -9.8: change "
            "its sign, and see whether other axes of the accelerometer point up or to port",
            where);
    }
    for (int i = 0; i < 2 && !upside; ++i) {
        if (wrong[i]) {
            add_sign(d, i, &r[i]);
        }
    }
}

static bool has_all(const doctor_t *d)
{
    bool all = d->has[CSV_ATTITUDE] && d->has[CSV_ATTITUDE + 1];
    for (int i = 0; i < 3; ++i) {
        all = all && d->has[CSV_SPECIFIC_FORCE + i];
    }
    return all;
}

void doctor_force(doctor_t *d)
{
    doctor_range_t range;
    char where[48];
    int vertical = 2, kind = has_all(d) ? most_frequent(d, &range, &vertical) : OTHER;
    int unit = kind == OTHER || kind == NO_GRAVITY ? 0 : kind / 6;
    int axis = kind == OTHER || kind == NO_GRAVITY ? vertical : kind % 6 / 2;
    if (!has_all(d)) {
        return;
    }
    d->unit = unit_of[unit];
    doctor_where(d, &range, where);
    if (kind == NO_GRAVITY) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_NO_GRAVITY, CSV_SPECIFIC_FORCE + vertical, -1, &range,
                   "%s has no gravity%s: log the specific force that the accelerometer measures, "
                   "which is -9.8 m/s2 in fz_mps2 at rest",
                   name(vertical), where);
        return;
    }
    if (unit > 0) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_FORCE_UNIT, CSV_SPECIFIC_FORCE + axis, -1, &range,
                   "fx_mps2, fy_mps2 and fz_mps2 look like %sg, not m/s2%s: multiply them by %s",
                   unit == 2 ? "thousandths of " : "multiples of ", where,
                   unit == 2 ? "0.00981" : "9.81");
    }
    if (axis != vertical) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_FORCE_EXCHANGED, CSV_SPECIFIC_FORCE + axis,
                   CSV_SPECIFIC_FORCE + vertical, &range,
                   "%s has the gravity that %s should have%s: axes of the accelerometer are "
                   "exchanged: exchange the columns",
                   name(axis), name(vertical), where);
        return;
    }
    doctor_range_t crossed = doctor_scan(d, exchange_score, 0);
    if (crossed.llr > MIN_LLR) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_FORCE_EXCHANGED, CSV_SPECIFIC_FORCE,
                   CSV_SPECIFIC_FORCE + 1, &crossed,
                   "fx_mps2 changes as fy_mps2 should, and fy_mps2 as fx_mps2%s: they are "
                   "exchanged: exchange the columns",
                   doctor_where(d, &crossed, where));
        return;
    }
    find_signs(d, kind != OTHER && kind % 2 == 1, &range);
}
