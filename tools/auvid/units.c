#include "units.h"

#include <math.h>

#include "report_error.h"

#define TURN 6.283185307179586
#define DEGREES 57.29577951308232 /* in a radian */
#define FEW 0.01                  /* share of rows that may be outliers */
#define GAP_S 0.5
#define WINDOW_S 1.0 /* window in which changes of attitude are compared with rates */
#define WINDOWS 10   /* smallest number of windows for a decision */

#define CONVERT_ANGLES "if the attitude is in degrees, convert it to radians (times pi/180)"
#define CONVERT_RATES "if the rates are in deg/s, convert them to rad/s (times pi/180)"

/* Statistics of the change of an angle and the integral of its rate. */
typedef struct {
    double angle2, rate2, both; /* sums of products of the changes in windows */
    int windows, fast;          /* fast: more than one and a half turns a second */
} change_t;

static double interval_s(const csv_log_t *log, size_t row)
{
    return log->row[row].value[CSV_T] - log->row[row - 1].value[CSV_T];
}

static change_t changes(const csv_log_t *log, int angle, int rate, double period)
{
    change_t sum = {0};
    double span = 0.0, turned = 0.0, expected = 0.0;
    for (size_t i = 1; i < log->rows; ++i) {
        const double *now = log->row[i].value, *before = log->row[i - 1].value;
        double dt = interval_s(log, i), step = now[angle] - before[angle];
        if (dt > GAP_S) {
            span = turned = expected = 0.0;
            continue;
        }
        span += dt;
        turned += step - period * floor(step / period + 0.5);
        expected += 0.5 * dt * (now[rate] + before[rate]);
        if (span >= WINDOW_S) {
            sum.angle2 += turned * turned;
            sum.rate2 += expected * expected;
            sum.both += turned * expected;
            sum.fast += fabs(turned) > 1.5 * TURN * span;
            ++sum.windows;
            span = turned = expected = 0.0;
        }
    }
    return sum;
}

/* Does the angle change by about `factor` times the integral of its rate? */
static bool follows(const change_t *c, double factor)
{
    double slope = c->rate2 > 0.0 ? c->both / c->rate2 : 0.0;
    return c->windows >= WINDOWS && slope > 0.5 * factor && slope < 2.0 * factor &&
           c->both * c->both > 0.81 * c->angle2 * c->rate2;
}

/* Share of the rows in which a column is beyond +-limit. */
static double share_beyond(const csv_log_t *log, int column, double limit)
{
    size_t count = 0;
    for (size_t i = 0; i < log->rows; ++i) {
        count += fabs(log->row[i].value[column]) > limit;
    }
    return (double)count / (double)log->rows;
}

/* An angle in radians jumps by at most one revolution. */
static int check_steps(const csv_log_t *log, int column)
{
    for (size_t i = 1; i < log->rows; ++i) {
        double step = fabs(log->row[i].value[column] - log->row[i - 1].value[column]);
        if (step > 1.5 * TURN && interval_s(log, i) <= GAP_S) {
            return report_error(
                "%s: %s jumps by %.4g at t_s %.9g, but an angle in radians jumps by at "
                "most 6.28, one revolution: " CONVERT_ANGLES,
                log->path, csv_name[column], step, log->row[i].value[CSV_T]);
        }
    }
    return 0;
}

static int check_pitch(const csv_log_t *log)
{
    double share = share_beyond(log, CSV_ATTITUDE + 1, 0.25 * TURN + 0.01);
    return share <= FEW
               ? 0
               : report_error("%s: theta_rad is beyond +-pi/2 in %.0f %% of the rows, which no "
                              "pitch in radians can be: " CONVERT_ANGLES,
                              log->path, 100.0 * share);
}

static int check_angle(const csv_log_t *log, int axis)
{
    int angle = CSV_ATTITUDE + axis, rate = CSV_NU + 3 + axis;
    change_t c = changes(log, angle, rate, TURN * DEGREES);
    if (follows(&c, DEGREES)) {
        return report_error("%s: %s changes 57 times as fast as %s says, so the attitude is in "
                            "degrees: convert it to radians (times pi/180)",
                            log->path, csv_name[angle], csv_name[rate]);
    }
    return c.windows < WINDOWS || c.fast <= FEW * c.windows
               ? 0
               : report_error(
                     "%s: %s changes by more than 9.4 per second in %.0f %% of the log, too "
                     "fast for radians: " CONVERT_ANGLES,
                     log->path, csv_name[angle], 100.0 * c.fast / c.windows);
}

static int check_rate(const csv_log_t *log, int axis)
{
    int angle = CSV_ATTITUDE + axis, rate = CSV_NU + 3 + axis;
    change_t c = changes(log, angle, rate, TURN);
    if (follows(&c, 1.0 / DEGREES)) {
        return report_error("%s: %s is 57 times as large as the change of %s, so the rates are "
                            "in deg/s: convert them to rad/s (times pi/180)",
                            log->path, csv_name[rate], csv_name[angle]);
    }
    double share = share_beyond(log, rate, TURN);
    return share <= FEW
               ? 0
               : report_error(
                     "%s: %s is beyond +-6.28, one revolution per second, in %.0f %% of the "
                     "rows: " CONVERT_RATES,
                     log->path, csv_name[rate], 100.0 * share);
}

int units_check(const csv_log_t *log)
{
    int status = check_pitch(log);
    for (int axis = 2; axis >= 0 && status == 0; --axis) {
        status = check_steps(log, CSV_ATTITUDE + axis);
        status = status != 0 ? status : check_angle(log, axis);
    }
    for (int axis = 2; axis >= 0 && status == 0; --axis) {
        status = check_rate(log, axis);
    }
    return status;
}
