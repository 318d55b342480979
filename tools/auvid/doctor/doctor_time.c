/*
 * Times of the rows, and seconds of usable motion.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "doctor.h"

#define GAP_S 0.5         /* as in fit */
#define LONGEST_GAP_S 1.0 /* .. with --max-gap */
#define UNIT_S 5.0        /* rows further apart: t_s is in another unit */
#define RECORD_S 6.0      /* fit needs a record between gaps that is as long */
#define SLOW 0.6          /* interval of rows, relative to the time constant of a DoF */
#define SLOW_S 0.36       /* .. and of any vehicle: linear drag is not told from quadratic */
#define MIN_LENGTH_S 10.0 /* of a log: fit has too few sets below */
#define MIN_MOTION_S 6.0  /* of a DoF, without the first seconds */
#define MOVES 0.1         /* standard deviation of an input in a block, relative to its largest */

double doctor_interval_quantile(const doctor_t *d, double share)
{
    double rows = 0.0;
    for (int k = 0; k < DOCTOR_INTERVALS; ++k) {
        rows += d->interval[k];
        if (rows >= share * (d->rows - 1.0)) {
            return doctor_interval(k);
        }
    }
    return doctor_interval(DOCTOR_INTERVALS - 1);
}

static void find_gaps(doctor_t *d)
{
    double median = doctor_interval_quantile(d, 0.5), total = d->last_s - d->start_s;
    if (d->back > 0.0) {
        doctor_add(
            d, DOCTOR_ERROR, DOCTOR_TIME, CSV_T, -1, NULL,
            "t_s goes back or stands still in %.0f row%s, first after t_s %.3f: sort the rows, "
            "or split the log where the clock was set",
            d->back, d->back > 1.0 ? "s" : "", d->back_at_s);
    }
    if (median > GAP_S) {
        double mean = total / (d->rows - 1.0);
        doctor_add(d, DOCTOR_ERROR, DOCTOR_SLOW, CSV_T, -1, NULL,
                   "the rows are about %.4g s apart, %s log at 5 Hz or faster",
                   mean < UNIT_S ? median : mean,
                   mean < UNIT_S         ? "more than the 0.5 s that fit bridges:"
                   : mean < 1e3 * UNIT_S ? "as if t_s were in milliseconds: give seconds, or"
                   : mean < 1e6 * UNIT_S ? "as if t_s were in microseconds: give seconds, or"
                                         : "as if t_s were in nanoseconds: give seconds, or");
    } else if (d->gaps > 0.0) {
        bool parts = d->longest_record_s < RECORD_S;
        doctor_add(d,
                   parts                          ? DOCTOR_ERROR
                   : d->gap_total_s > 0.2 * total ? DOCTOR_WARNING
                                                  : DOCTOR_NOTE,
                   DOCTOR_GAPS, CSV_T, -1, NULL,
                   "%.0f gap%s over 0.5 s, the longest of %.1f s after t_s %.1f: each one ends a "
                   "record%s",
                   d->gaps, d->gaps > 1.0 ? "s" : "", d->longest_gap_s, d->gap_at_s,
                   parts ? ", and none is 6 s long: log without gaps" : "");
    }
}

/* Rows that fit bridges, but that show too little of the motion. */
static void find_slow_rows(doctor_t *d)
{
    double median = doctor_interval_quantile(d, 0.5);
    bool quick = false;
    for (int j = 0; j < 6 && median <= GAP_S; ++j) {
        double constant = d->time_constant_s[j];
        if (constant > 0.0 && median > SLOW * constant) {
            quick = true;
            doctor_add(d, DOCTOR_WARNING, DOCTOR_SLOW, CSV_T, CSV_NU + j, NULL,
                       "the rows are about %.2f s apart, but %s changes within %.2f s (time "
                       "constant): log "
                       "at %.0f Hz or faster",
                       median, csv_name[CSV_NU + j], constant, ceil(3.0 / constant));
        }
    }
    if (!quick && median > SLOW_S && median <= GAP_S) {
        doctor_add(
            d, DOCTOR_WARNING, DOCTOR_SLOW, CSV_T, -1, NULL,
            "the rows are about %.2f s apart: fit identifies fewer parameters from them: log "
            "at 5 Hz or faster",
            median);
    }
}

/* Inputs may have a rate of their own. */
static void find_slow_inputs(doctor_t *d)
{
    int inputs = d->use != NULL ? log_inputs(d->use) : d->inputs >= 0 ? 6 : 0, most = -1;
    for (int k = 0; k < inputs; ++k) {
        int column = d->use != NULL ? log_input(d->use, k) : d->inputs + k;
        bool more = most < 0 || d->column[column].n > d->column[most].n;
        most = d->has[column] && more ? column : most;
    }
    double n = most >= 0 ? d->column[most].n : 0.0;
    double every = (d->last_s - d->start_s) / fmax(n - 1.0, 1.0);
    if (n > 1.0 && n < d->rows && every > 0.8 * GAP_S) {
        doctor_add(d, DOCTOR_WARNING, DOCTOR_SLOW, most, -1, NULL,
                   "%s comes every %.2f s on average, and fit bridges 0.5 s: log inputs at 5 Hz or "
                   "faster%s, or give --hold-inputs if the log has them only where they change",
                   csv_name[most], every,
                   every < LONGEST_GAP_S ? ", give fit a longer --max-gap" : "");
        d->sparse_inputs = every > GAP_S;
    }
}

static void find_motion(doctor_t *d)
{
    static const char *const name[6] = {"surge", "sway", "heave", "roll", "pitch", "yaw"};
    char list[160] = "";
    double best = 0.0;
    /* then no motion is usable */
    bool slow = d->sparse_inputs || doctor_interval_quantile(d, 0.5) > GAP_S;
    for (int j = 0; j < 6 && d->inputs >= 0; ++j) {
        const doctor_column_t *c = &d->column[d->inputs + j];
        double largest = doctor_is_pulse(c) ? 0.5 * (c->max - c->min) : c->limit;
        if (!d->has[d->inputs + j] || !d->has[CSV_NU + j] || !(largest > 0.0)) {
            continue;
        }
        for (int k = 0; k < d->blocks; ++k) {
            const doctor_sums_t *s = &d->block[k].sums;
            const double *own = s->own[j][DOCTOR_EARLY];
            double n = fmax(s->count[j], 1.0), mean = own[GAIN_TERMS - 2] / n;
            double variance = own[0] / n - mean * mean;
            d->usable_s[j] +=
                variance > MOVES * MOVES * largest * largest ? n * DOCTOR_CELL_S : 0.0;
        }
        best = fmax(best, d->usable_s[j]);
        size_t used = strlen(list);
        (void)snprintf(list + used, sizeof list - used, "%s%s %.0f s", used > 0 ? ", " : "",
                       name[j], d->usable_s[j]);
    }
    if (d->inputs < 0 && d->thrusters) {
        doctor_add(d, DOCTOR_NOTE, DOCTOR_MOTION, -1, -1, NULL,
                   "inputs of single thrusters are compared with the motion only if their vehicle "
                   "is known: --vehicle");
    } else if (d->inputs < 0) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_MISSING, CSV_WRENCH, -1, NULL,
                   "no input column (X_N .. or cmd_surge ..): add forces, moments or commands");
    } else if (doctor_thrust_is_wrong(d)) {
        return; /* how much they vary is not known */
    } else if (!slow && (d->last_s - d->start_s < MIN_LENGTH_S || best < MIN_MOTION_S)) {
        doctor_add(d, DOCTOR_ERROR, DOCTOR_SHORT, -1, -1, NULL,
                   "too little motion: %s of inputs that vary in a log of %.0f s: excite each axis "
                   "for a minute or more",
                   list[0] != '\0' ? list : "0 s", d->last_s - d->start_s);
    } else if (!slow) {
        doctor_add(d, DOCTOR_NOTE, DOCTOR_MOTION, -1, -1, NULL, "usable motion (varying input): %s",
                   list);
    }
}

void doctor_time(doctor_t *d)
{
    find_gaps(d);
    find_slow_rows(d);
    find_slow_inputs(d);
    find_motion(d);
}
