/*
 * What a column shows by itself: missing, stuck, held, coarse, at its limit.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "doctor.h"
#include "../log/columns.h"

#define HELD 0.25      /* share of the samples that repeat the one before */
#define TOGETHER 0.8   /* share of the changes of a velocity that all make together */
#define OUTAGE_S 1.5   /* velocities that stand still for longer are no samples */
#define COARSE 0.3     /* step of a column, relative to its standard deviation */
#define TOO_COARSE 1.1 /* .. from which its errors are no noise, but follow the motion */
#define SATURATED 0.3  /* share of the samples at the limit */
#define SAG 0.1
#define MIN_SAMPLES 200.0
#define STEEP 1.65    /* no pitch in radians is beyond */
#define PWM_MIN 500.0 /* pulse widths [us] */
#define PWM_MAX 2500.0

static void note_distinct(doctor_column_t *c, double value)
{
    for (int i = 0; i < c->distincts; ++i) {
        if (!(fabs(c->distinct[i] - value) > 0.0)) {
            return;
        }
    }
    if (c->distincts < DOCTOR_DISTINCT) {
        c->distinct[c->distincts] = value;
    }
    ++c->distincts;
}

static void note_extremes(doctor_column_t *c, double value)
{
    if (c->n < 1.0 || value > c->max) {
        c->max = value;
    }
    if (c->n < 1.0 || value < c->min) {
        c->min = value;
    }
    double limit = fmax(fabs(c->max), fabs(c->min));
    if (fabs(value) >= limit && c->limit < limit) {
        c->limit = limit;
        c->at_limit = 0.0;
    }
    c->at_limit += fabs(value) >= limit ? 1.0 : 0.0;
}

void doctor_column_add(doctor_t *d, int column, double t, double value)
{
    doctor_column_t *c = &d->column[column];
    if (!isfinite(value)) {
        return;
    }
    double since = t - (c->n > 0.0 ? c->sample_s : 0.0);
    if (since > c->absent_s) {
        c->absent_s = since;
        c->absent_at_s = t - since;
    }
    c->sample_s = t;
    note_extremes(c, value);
    bool same = c->n > 0.0 && !(fabs(value - c->last) > 0.0);
    if (c->n < 1.0) {
        c->first = value;
        c->changed_s = t;
    }
    c->held += same ? 1.0 : 0.0;
    if (!same && c->n > 0.0) {
        c->changes += 1.0;
        c->changed_s = t;
    } else if (t - c->changed_s > c->longest_s) {
        c->longest_s = t - c->changed_s;
        c->longest_at_s = c->changed_s;
    }
    if (c->distincts <= DOCTOR_DISTINCT) {
        note_distinct(c, value);
    }
    c->beyond += fabs(value) > STEEP ? 1.0 : 0.0;
    c->n += 1.0;
    c->sum += value;
    c->square += value * value;
    c->last = value;
}

static double deviation(const doctor_column_t *c)
{
    double n = fmax(c->n, 1.0), mean = c->sum / n;
    return sqrt(fmax(c->square / n - mean * mean, 0.0));
}

static bool varies(const doctor_t *d, int column)
{
    return d->has[column] && d->column[column].changes > 0.0;
}

/* ---- missing and stuck ---- */

/* What to do about a missing column that another one resembles. Returns false if none does. */
static bool resembling(const doctor_t *d, int column, char *remedy, size_t size)
{
    const char *like = d->log != NULL ? d->log->like[column] : "";
    (void)snprintf(remedy, size, "make it of %s%s", like,
                   columns_degrees(like) != NULL ? ", which is in degrees" : "");
    return like[0] != '\0';
}

static void find_missing(doctor_t *d)
{
    static const struct {
        int column;
        const char *why;
    } needed[] = {
        {CSV_ATTITUDE, "weight less buoyancy acts along a wrong axis if the vehicle rolls"},
        {CSV_ATTITUDE + 1, "weight less buoyancy acts along a wrong axis if it pitches"},
        {CSV_NU, "the coupling of surge with yaw is left out"},
        {CSV_NU + 1, "the coupling of sway with yaw is left out"},
        {CSV_NU + 2, "the coupling of heave with pitch is left out"},
        {CSV_NU + 5, "the coupling of surge and sway in turns is left out"}};
    for (size_t k = 0; k < sizeof needed / sizeof needed[0]; ++k) {
        int j = needed[k].column - CSV_NU;
        char remedy[80];
        bool renames = resembling(d, needed[k].column, remedy, sizeof remedy);
        if (!d->has[needed[k].column] && j >= 0 && d->inputs >= 0 && d->has[d->inputs + j]) {
            doctor_add(d, DOCTOR_ERROR, DOCTOR_MISSING, needed[k].column, d->inputs + j, NULL,
                       "%s is missing, but %s is there: fit needs both: %s%s",
                       csv_name[needed[k].column], doctor_input_name(d, j),
                       renames ? remedy : "add the velocity",
                       d->use == NULL ? ", or leave out the input" : "");
        } else if (!d->has[needed[k].column]) {
            doctor_add(d, DOCTOR_WARNING, DOCTOR_MISSING, needed[k].column, -1, NULL,
                       "%s is missing and counts as zero: %s: %s", csv_name[needed[k].column],
                       needed[k].why, renames ? remedy : "add the column");
        }
    }
}

/* fit does not take a column without values for one that is missing. */
static void find_empty(doctor_t *d)
{
    for (int column = CSV_ATTITUDE; column < CSV_COLUMNS; ++column) {
        if (d->has[column] && d->column[column].n < 1.0) {
            doctor_add(d, DOCTOR_ERROR, DOCTOR_MISSING, column, -1, NULL,
                       "%s has no value in any row: remove the column", csv_name[column]);
        }
    }
}

static bool always(const doctor_t *d, int column)
{
    return d->has[column] && d->column[column].n > 1.0 && !(d->column[column].changes > 0.0);
}

static void find_stuck(doctor_t *d)
{
    bool turns = false;
    for (int j = 3; j < 6; ++j) {
        turns = turns || varies(d, CSV_NU + j);
    }
    bool all =
        always(d, CSV_ATTITUDE) && always(d, CSV_ATTITUDE + 1) && always(d, CSV_ATTITUDE + 2);
    if (all && turns) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_STUCK, CSV_ATTITUDE, -1, NULL,
                   "the attitude never changes, but the rates do: log the measured attitude");
    }
    for (int i = 0; i < 3 && !all; ++i) {
        if (always(d, CSV_ATTITUDE + i) && varies(d, CSV_NU + 3 + i)) {
            doctor_add(d, DOCTOR_WARNING, DOCTOR_STUCK, CSV_ATTITUDE + i, CSV_NU + 3 + i, NULL,
                       "%s is always %g, but %s changes: log the measured angle",
                       csv_name[CSV_ATTITUDE + i], d->column[CSV_ATTITUDE + i].first + 0.0,
                       csv_name[CSV_NU + 3 + i]);
        }
    }
    for (int j = 0; j < 6; ++j) {
        bool driven = d->inputs >= 0 && varies(d, d->inputs + j);
        if (always(d, CSV_NU + j) && driven) {
            d->left_out |= 1u << j;
            doctor_add(d, DOCTOR_WARNING, DOCTOR_STUCK, CSV_NU + j, d->inputs + j, NULL,
                       "%s is always %g, but %s acts: both are left out: log the measured %s",
                       csv_name[CSV_NU + j], d->column[CSV_NU + j].first + 0.0,
                       doctor_input_name(d, j), j < 3 ? "velocity" : "rate");
        } else if (always(d, CSV_NU + j) && j >= 3 && varies(d, CSV_ATTITUDE + j - 3)) {
            doctor_add(d, DOCTOR_WARNING, DOCTOR_STUCK, CSV_NU + j, CSV_ATTITUDE + j - 3, NULL,
                       "%s is always %g, but %s changes: log the measured rate",
                       csv_name[CSV_NU + j], d->column[CSV_NU + j].first + 0.0,
                       csv_name[CSV_ATTITUDE + j - 3]);
        }
    }
}

/* ---- held values and outages ---- */

/* Are some velocities fine enough that they change with each sample? */
static bool is_fine(const doctor_t *d)
{
    bool fine = false;
    for (int j = 0; j < 3; ++j) {
        fine = fine || (d->has[CSV_NU + j] && d->column[CSV_NU + j].distincts > DOCTOR_DISTINCT);
    }
    return fine;
}

/* Held between samples: all velocities repeat their values, and change in the same rows. Coarse
 * steps repeat, too, but each at its own time. */
static void find_held(doctor_t *d)
{
    const doctor_column_t *c = &d->column[CSV_NU];
    bool repeat = c->held > HELD * c->n && c->changes > 20.0;
    if (repeat && is_fine(d) && d->all_move > TOGETHER * d->any_moves) {
        doctor_add(
            d, DOCTOR_WARNING, DOCTOR_HELD, CSV_NU, -1, NULL,
            "the velocity repeats each value for about %.2f s, as if held between samples: it "
            "trails by half of that: leave its cells empty in rows without a new sample",
            (d->last_s - d->start_s) / d->any_moves);
    }
}

static void find_outage(doctor_t *d)
{
    double usual = 0.0;
    const doctor_column_t *c = &d->column[CSV_NU];
    usual = (d->last_s - d->start_s) / (c->changes + 1.0);
    if (!varies(d, CSV_NU) || !is_fine(d) || d->still_s < fmax(OUTAGE_S, 5.0 * usual)) {
        return;
    }
    bool zero = d->still_at_zero;
    doctor_finding_t *f = doctor_add(
        d, d->still_total_s > 0.25 * (d->last_s - d->start_s) ? DOCTOR_ERROR : DOCTOR_WARNING,
        DOCTOR_OUTAGE, CSV_NU, -1, NULL,
        "u_mps, v_mps and w_mps %s for up to %.1f s (first at t_s %.1f, %.1f s in total) while the "
        "rates change: the velocity sensor had no samples: leave those rows out",
        zero ? "are exactly 0" : "keep their values", d->still_s, d->still_at_s, d->still_total_s);
    if (f != NULL) {
        f->value = d->still_s;
    }
}

/* ---- steps, limits, units ---- */

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void find_steps(doctor_t *d, int column)
{
    doctor_column_t *c = &d->column[column];
    double step = HUGE_VAL, spread = deviation(c);
    if (c->n < MIN_SAMPLES || c->distincts > DOCTOR_DISTINCT || c->distincts < 2) {
        return;
    }
    qsort(c->distinct, (size_t)c->distincts, sizeof c->distinct[0], compare);
    for (int i = 1; i < c->distincts; ++i) {
        step = fmin(step, c->distinct[i] - c->distinct[i - 1]);
    }
    bool too = column >= CSV_NU && step > TOO_COARSE * spread;
    if (step > COARSE * spread) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_QUANTISED, column, -1, NULL,
                   "%s has steps of %.3g, %scoarse against its variation of %.3g (1 sigma)%s: log "
                   "more digits",
                   csv_name[column], step, too ? "too " : "", spread,
                   too ? ", and is left out" : "");
    }
    d->left_out |= too ? 1u << (column - CSV_NU) : 0u;
}

bool doctor_is_pulse(const doctor_column_t *c)
{
    return c->n > 0.0 && c->min > PWM_MIN && c->max < PWM_MAX;
}

/* Is the voltage in the thrust, as the vehicle file says? */
static bool thrust_follows_voltage(const doctor_t *d)
{
    bool follows = false;
    for (int k = 0; d->use != NULL && d->use->vehicle != NULL && k < d->use->vehicle->maps; ++k) {
        follows = follows || d->use->map[k].voltage_exponent > 0.0;
    }
    return follows;
}

static void find_limits(doctor_t *d)
{
    for (int j = 0; j < 6 && d->inputs >= 0; ++j) {
        const doctor_column_t *c = &d->column[d->inputs + j];
        bool many = c->distincts > DOCTOR_DISTINCT;
        if (many && c->at_limit > SATURATED * c->n) {
            doctor_add(d, DOCTOR_NOTE, DOCTOR_SATURATED, d->inputs + j, -1, NULL,
                       "%s is at its limit of %.4g in %.0f %% of the rows: if the thrusters "
                       "saturate, log the thrust that they give",
                       doctor_input_name(d, j), c->limit, 100.0 * c->at_limit / c->n);
        }
        if (d->inputs == CSV_COMMAND && doctor_is_pulse(c)) {
            doctor_add(d, DOCTOR_ERROR, DOCTOR_SCALE, d->inputs + j, -1, NULL,
                       "%s looks like pulse widths in microseconds (%.0f to %.0f): subtract the "
                       "neutral one, 1500, and divide by 400",
                       csv_name[d->inputs + j], c->min, c->max);
        }
    }
    const doctor_column_t *v = &d->column[CSV_VOLTAGE];
    if (d->has[CSV_VOLTAGE] && !thrust_follows_voltage(d) && v->max > 0.0 &&
        v->max - v->min > SAG * v->max) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_VOLTAGE, CSV_VOLTAGE, -1, NULL,
                   "voltage_V falls from %.1f to %.1f: thrust at a command falls with it: log the "
                   "thrust computed with the voltage",
                   v->max, v->min);
    }
}

void doctor_columns(doctor_t *d)
{
    find_missing(d);
    find_empty(d);
    find_stuck(d);
    find_outage(d);
    find_held(d);
    find_limits(d);
    for (int column = CSV_ATTITUDE; column < CSV_NU + 6; ++column) {
        if (varies(d, column)) {
            find_steps(d, column);
        }
    }
}
