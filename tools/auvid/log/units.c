#include "units.h"

#include <math.h>
#include <stdio.h>

#include "../base/report_error.h"

#define TURN 6.283185307179586
#define DEGREES 57.29577951308232 /* in a radian */
#define FEW 0.01                  /* share of rows that may be outliers */
#define GAP_S 0.5
#define FAST_MPS 30.0 /* no vehicle is faster */
#define MANY 0.1      /* share of the samples beyond: another unit */
#define MARKED 0.9    /* share of those that repeat one value: a mark */
#define WINDOW_S 1.0  /* window in which changes of attitude are compared with rates */
#define WINDOWS 10    /* smallest number of windows for a decision */

#define CONVERT_ANGLES "if the attitude is in degrees, convert it to radians (times pi/180)"
#define CONVERT_RATES "if the rates are in deg/s, convert them to rad/s (times pi/180)"

/* Adds the step of an angle that wraps at `period`, and the integral of its rate. */
static void add_step(units_change_t *c, double dt, double step, double rate_sum, double period)
{
    if (dt > GAP_S) {
        c->span = c->turned = c->expected = 0.0;
        return;
    }
    c->span += dt;
    c->turned += step - period * floor(step / period + 0.5);
    c->expected += 0.5 * dt * rate_sum;
    if (c->span >= WINDOW_S) {
        c->angle2 += c->turned * c->turned;
        c->rate2 += c->expected * c->expected;
        c->both += c->turned * c->expected;
        c->fast += fabs(c->turned) > 1.5 * TURN * c->span;
        ++c->windows;
        c->span = c->turned = c->expected = 0.0;
    }
}

static void take_angle(units_axis_t *a, double t, double angle)
{
    double dt = t - a->t, step = angle - a->angle;
    if (a->known) {
        add_step(&a->radians, dt, step, a->latest_rate + a->rate, TURN);
        add_step(&a->degrees, dt, step, a->latest_rate + a->rate, TURN * DEGREES);
        if (fabs(step) > 1.5 * TURN && dt <= GAP_S && !(a->step > 0.0)) {
            a->step = fabs(step);
            a->step_t = t;
        }
    }
    a->known = true;
    a->t = t;
    a->angle = angle;
    a->rate = a->latest_rate;
}

static void add_speed(units_speed_t *w, double t_s, double value)
{
    w->n += 1.0;
    if (fabs(value) > FAST_MPS) {
        w->same += w->fast > 0.0 && !(fabs(value - w->last) > 0.0) ? 1.0 : 0.0;
        w->last = value;
        w->fast += 1.0;
    }
    if (fabs(value) > fabs(w->largest)) {
        w->largest = value;
        w->largest_s = t_s;
    }
}

units_speed_kind_t units_speed_judge(const units_speed_t *w, const char *name, char *text,
                                     size_t size)
{
    if (!(w->fast > 0.0)) {
        return UNITS_SPEED_OK;
    }
    if (w->fast > 1.0 && w->same > MARKED * (w->fast - 1.0)) {
        (void)snprintf(text, size,
                       "%s is %g in %.0f rows, a mark of missing samples: leave these cells empty",
                       name, w->last, w->fast);
        return UNITS_SPEED_MARKED;
    }
    if (w->fast > MANY * w->n) {
        (void)snprintf(text, size,
                       "%s reaches %.4g m/s, as if it were in mm/s or cm/s: convert it to m/s",
                       name, fabs(w->largest));
        return UNITS_SPEED_SCALE;
    }
    (void)snprintf(text, size,
                   "%s is %.4g at t_s %.9g, and no vehicle is as fast: leave cells of outliers "
                   "empty",
                   name, w->largest, w->largest_s);
    return UNITS_SPEED_OUTLIER;
}

void units_row(units_t *units, const csv_row_t *row)
{
    for (int k = 0; k < 3; ++k) {
        units_axis_t *a = &units->axis[k];
        int angle = CSV_ATTITUDE + k, rate = CSV_NU + 3 + k;
        if (csv_has(row, CSV_NU + k)) {
            add_speed(&units->speed[k], row->value[CSV_T], row->value[CSV_NU + k]);
        }
        if (csv_has(row, rate)) {
            a->latest_rate = row->value[rate];
            a->beyond += fabs(a->latest_rate) > TURN;
            ++a->rates;
        }
        if (csv_has(row, angle)) {
            take_angle(a, row->value[CSV_T], row->value[angle]);
        }
    }
    if (csv_has(row, CSV_ATTITUDE + 1)) {
        units->beyond += fabs(row->value[CSV_ATTITUDE + 1]) > 0.25 * TURN + 0.01;
        ++units->pitches;
    }
}

/* Does the angle change by about `factor` times the integral of its rate? */
static bool follows(const units_change_t *c, double factor)
{
    double slope = c->rate2 > 0.0 ? c->both / c->rate2 : 0.0;
    return c->windows >= WINDOWS && slope > 0.5 * factor && slope < 2.0 * factor &&
           c->both * c->both > 0.81 * c->angle2 * c->rate2;
}

static double share(size_t part, size_t all)
{
    return all > 0 ? (double)part / (double)all : 0.0;
}

/* An angle in radians jumps by at most one revolution. */
static bool judge_steps(const units_axis_t *a, int column, char *text, size_t size)
{
    bool wrong = a->step > 0.0;
    if (wrong) {
        (void)snprintf(text, size,
                       "%s jumps by %.4g at t_s %.9g, but an angle in radians jumps by at most "
                       "6.28, one revolution: " CONVERT_ANGLES,
                       csv_name[column], a->step, a->step_t);
    }
    return wrong;
}

static bool judge_pitch(const units_t *units, char *text, size_t size)
{
    double part = share(units->beyond, units->pitches);
    bool wrong = !(part <= FEW);
    if (wrong) {
        (void)snprintf(text, size,
                       "theta_rad is beyond +-pi/2 in %.0f %% of the rows, which no pitch in "
                       "radians can be: " CONVERT_ANGLES,
                       100.0 * part);
    }
    return wrong;
}

static bool judge_angle(const units_axis_t *a, int axis, char *text, size_t size)
{
    const char *angle = csv_name[CSV_ATTITUDE + axis], *rate = csv_name[CSV_NU + 3 + axis];
    const units_change_t *c = &a->degrees;
    bool follow = follows(c, DEGREES), fast = c->windows >= WINDOWS && c->fast > FEW * c->windows;
    if (follow) {
        (void)snprintf(text, size,
                       "%s changes 57 times as fast as %s says, so the attitude is in degrees: "
                       "convert it to radians (times pi/180)",
                       angle, rate);
    } else if (fast) {
        (void)snprintf(text, size,
                       "%s changes by more than 9.4 per second in %.0f %% of the log, too fast for "
                       "radians: " CONVERT_ANGLES,
                       angle, 100.0 * c->fast / c->windows);
    }
    return follow || fast;
}

static bool judge_rate(const units_axis_t *a, int axis, char *text, size_t size)
{
    const char *angle = csv_name[CSV_ATTITUDE + axis], *rate = csv_name[CSV_NU + 3 + axis];
    double part = share(a->beyond, a->rates);
    bool follow = follows(&a->radians, 1.0 / DEGREES), fast = !(part <= FEW);
    if (follow) {
        (void)snprintf(text, size,
                       "%s is 57 times as large as the change of %s, so the rates are in deg/s: "
                       "convert them to rad/s (times pi/180)",
                       rate, angle);
    } else if (fast) {
        (void)snprintf(text, size,
                       "%s is beyond +-6.28, one revolution per second, in %.0f %% of the "
                       "rows: " CONVERT_RATES,
                       rate, 100.0 * part);
    }
    return follow || fast;
}

int units_angle_judge(const units_t *units, char *text, size_t size)
{
    if (judge_pitch(units, text, size)) {
        return CSV_ATTITUDE + 1;
    }
    for (int axis = 2; axis >= 0; --axis) {
        const units_axis_t *a = &units->axis[axis];
        if (judge_steps(a, CSV_ATTITUDE + axis, text, size) || judge_angle(a, axis, text, size)) {
            return CSV_ATTITUDE + axis;
        }
    }
    for (int axis = 2; axis >= 0; --axis) {
        if (judge_rate(&units->axis[axis], axis, text, size)) {
            return CSV_NU + 3 + axis;
        }
    }
    return -1;
}

int units_check(const units_t *units, const char *path)
{
    char text[UNITS_TEXT];
    bool wrong = false;
    for (int axis = 0; axis < 3 && !wrong; ++axis) {
        wrong = units_speed_judge(&units->speed[axis], csv_name[CSV_NU + axis], text,
                                  sizeof text) != UNITS_SPEED_OK;
    }
    wrong = wrong || units_angle_judge(units, text, sizeof text) >= 0;
    return wrong ? report_error("%s: %s", path, text) : 0;
}
