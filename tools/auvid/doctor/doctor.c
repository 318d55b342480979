/*
 * The log doctor: rows in, findings and verdict out.
 */
#include "doctor.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GAP_S 0.500001 /* rows each 0.5 s, as decimals, have no gap */
#define CLASSES_PER_OCTAVE 6.0
#define SHORTEST_S 0.001 /* of the classes of intervals */
#define EMPTY_S 1.5      /* longer empty: no samples; velocities may come once a second */
#define STILL_S 1.0      /* velocities that stand still for longer are counted */

void doctor_init(doctor_t *d, const bool has[CSV_COLUMNS])
{
    memset(d, 0, sizeof *d);
    memcpy(d->has, has, sizeof d->has);
    d->inputs = -1;
    d->depth_scale = 1.0;
    for (int j = 5; j >= 0; --j) {
        d->inputs = has[CSV_WRENCH + j]                     ? CSV_WRENCH
                    : has[CSV_COMMAND + j] && d->inputs < 0 ? CSV_COMMAND
                                                            : d->inputs;
    }
    for (int c = CSV_THRUSTER; c < CSV_VOLTAGE; ++c) {
        d->thrusters = d->thrusters || has[c];
    }
    doctor_cells_init(d);
}

double doctor_interval(int k)
{
    return SHORTEST_S * exp2(((double)k + 0.5) / CLASSES_PER_OCTAVE);
}

/* Counts the time since the last row. */
static void time_row(doctor_t *d, double t)
{
    double interval = t - d->last_s;
    double k = floor(CLASSES_PER_OCTAVE * log2(interval / SHORTEST_S));
    d->interval[(int)fmax(0.0, fmin(k, DOCTOR_INTERVALS - 1.0))] += 1.0;
    if (interval > GAP_S) {
        d->gaps += 1.0;
        d->gap_total_s += interval;
        if (interval > d->longest_gap_s) {
            d->longest_gap_s = interval;
            d->gap_at_s = d->last_s;
        }
        d->record_s = t;
    }
    d->longest_record_s = fmax(d->longest_record_s, t - d->record_s);
}

/* Watches for velocities that stand still together. Where cells are empty for longer than between
 * samples, nothing stands still: fit knows that there was no sample. */
static void watch_velocity(doctor_t *d, const csv_row_t *row)
{
    const double *v = &row->value[CSV_NU];
    bool moved = false, all = true, sampled = false;
    for (int i = 0; i < 3; ++i) {
        if (d->has[CSV_NU + i] && isfinite(v[i])) {
            bool changed = fabs(v[i] - d->still[i]) > 0.0;
            sampled = true;
            moved = moved || changed;
            all = all && changed;
        }
    }
    double t = row->value[CSV_T], empty = t - d->sampled_s;
    if (!sampled) {
        return;
    }
    double last_s = d->sampled_s;
    d->sampled_s = t;
    d->still_since_s += empty > EMPTY_S ? empty : 0.0;
    double still = t - d->still_since_s;
    if (moved) {
        d->any_moves += 1.0;
        d->all_move += all ? 1.0 : 0.0;
        d->still_total_s += d->still_counted ? last_s - d->still_since_s : 0.0;
        d->still_since_s = t;
        d->still_counted = false;
        for (int i = 0; i < 3; ++i) {
            d->still[i] = isfinite(v[i]) ? v[i] : d->still[i];
        }
        return;
    }
    bool zero = !(fabs(d->still[0]) + fabs(d->still[1]) + fabs(d->still[2]) > 0.0);
    bool at_start = zero && !(d->column[CSV_NU].changes > 0.0); /* a vehicle at rest */
    if (still > STILL_S && !at_start && d->column[CSV_NU].n > 0.0) {
        d->still_counted = true;
        if (still > d->still_s) {
            d->still_s = still;
            d->still_at_s = d->still_since_s;
            d->still_at_zero = zero;
        }
    }
}

void doctor_feed(doctor_t *d, const csv_row_t *row)
{
    double t = row->value[CSV_T], value[CELL_SIGNALS], force_N[AUVID_MAX_THRUSTERS] = {0};
    if (d->rows < 1.0) {
        d->start_s = d->last_s = d->still_since_s = d->sampled_s = d->record_s = t;
    } else if (!(t > d->last_s)) {
        d->back_at_s = d->back < 1.0 ? d->last_s : d->back_at_s;
        d->back += 1.0;
        return;
    } else {
        time_row(d, t);
    }
    watch_velocity(d, row);
    doctor_velocity_add(d, row);
    units_row(&d->units, row); /* after it: whether there was a velocity before */
    d->rows += 1.0;
    d->last_s = t;
    csv_row_t with_wrench = *row;
    if (d->use != NULL) {
        doctor_thrusters_row(d, &with_wrench, force_N);
        row = &with_wrench;
    }
    for (int c = CSV_ATTITUDE; c < CSV_COLUMNS; ++c) {
        if (d->has[c]) {
            doctor_column_add(d, c, t - d->start_s, row->value[c]);
        }
    }
    memcpy(value + CELL_THRUST, force_N, sizeof force_N);
    for (int i = 0; i < CELL_THRUST; ++i) {
        int column = i < CELL_DEGREE     ? CSV_ATTITUDE + i
                     : i < CELL_NU       ? CSV_ATTITUDE + i % 3
                     : i < CELL_INPUT    ? CSV_NU + i - CELL_NU
                     : i < CELL_POSITION ? (d->inputs < 0 ? -1 : d->inputs + i - CELL_INPUT)
                     : i < CELL_FORCE    ? CSV_POSITION + i - CELL_POSITION
                                         : CSV_SPECIFIC_FORCE + i - CELL_FORCE;
        value[i] = column >= 0 && d->has[column] ? row->value[column] : 0.0;
    }
    if (d->has[CSV_QUATERNION]) {
        const double *q = row->value + CSV_QUATERNION;
        double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        csv_attitude(q[3], q[0], q[1], q[2], value + CELL_ORDER);
        csv_attitude(q[0] / norm, -q[1] / norm, -q[2] / norm, -q[3] / norm, value + CELL_CONJUGATE);
        /* fmax, fmin in the pitch pass over NaN */
        value[CELL_ORDER + 1] = isfinite(q[0]) ? value[CELL_ORDER + 1] : NAN;
        value[CELL_CONJUGATE + 1] = isfinite(norm) ? value[CELL_CONJUGATE + 1] : NAN;
    }
    doctor_cells_add(d, t - d->start_s, value);
}

/* ---- findings ---- */

const char *doctor_where(const doctor_t *d, const doctor_range_t *r, char text[48])
{
    text[0] = '\0';
    if (r->first > 0 || r->last < d->blocks - 1) {
        (void)snprintf(text, 48, ", from t_s %.0f to %.0f", d->start_s + d->block[r->first].from_s,
                       d->start_s + d->block[r->last].to_s);
    }
    return text;
}

doctor_finding_t *doctor_add(doctor_t *d, doctor_severity_t severity, doctor_code_t code,
                             int column, int other, const doctor_range_t *range, const char *format,
                             ...)
{
    if (d->findings == DOCTOR_FINDINGS) {
        return NULL;
    }
    doctor_finding_t *f = &d->finding[d->findings++];
    va_list arguments;
    *f = (doctor_finding_t){.severity = severity,
                            .code = code,
                            .column = column,
                            .other = other,
                            .from_s = d->start_s,
                            .to_s = d->last_s};
    if (range != NULL && d->blocks > 0) {
        f->from_s = d->start_s + d->block[range->first].from_s;
        f->to_s = fmin(d->start_s + d->block[range->last].to_s, d->last_s);
    }
    va_start(arguments, format);
    (void)vsnprintf(f->text, sizeof f->text, format, arguments);
    va_end(arguments);
    return f;
}

bool doctor_has_finding(const doctor_t *d, doctor_code_t code, int column)
{
    for (int i = 0; i < d->findings; ++i) {
        if (d->finding[i].code == code && d->finding[i].column == column) {
            return true;
        }
    }
    return false;
}

/* Sorts by severity; the order within one is kept. */
static void sort_findings(doctor_t *d)
{
    for (int i = 1; i < d->findings; ++i) {
        doctor_finding_t f = d->finding[i];
        int k = i;
        for (; k > 0 && d->finding[k - 1].severity < f.severity; --k) {
            d->finding[k] = d->finding[k - 1];
        }
        d->finding[k] = f;
    }
}

static void judge(doctor_t *d)
{
    static const char *const name[6] = {"surge", "sway", "heave", "roll", "pitch", "yaw"};
    int errors = 0;
    char axes[64] = "";
    for (int i = 0; i < d->findings; ++i) {
        errors += d->finding[i].severity == DOCTOR_ERROR;
    }
    for (int j = 0; j < 6; ++j) {
        if (d->answers[j] && !(d->left_out >> j & 1u)) {
            size_t used = strlen(axes);
            (void)snprintf(axes + used, sizeof axes - used, "%s%s", used > 0 ? ", " : "", name[j]);
        }
    }
    bool unchecked = d->thrusters && d->use == NULL, no_inputs = d->inputs < 0 && d->thrusters;
    d->usable = errors == 0 && (no_inputs || axes[0] != '\0') && !d->sparse_inputs;
    if (d->usable) {
        (void)snprintf(d->verdict, sizeof d->verdict, "usable for identification%s%s%s",
                       no_inputs ? "" : ": ", no_inputs ? "" : axes,
                       unchecked ? "; thruster columns are not checked without --vehicle" : "");
    } else if (errors > 0) {
        (void)snprintf(d->verdict, sizeof d->verdict,
                       "not usable for identification: %d error%s to correct", errors,
                       errors == 1 ? "" : "s");
    } else if (d->sparse_inputs) {
        (void)snprintf(d->verdict, sizeof d->verdict,
                       "not usable for identification as it is: the inputs are too far apart");
    } else {
        (void)snprintf(d->verdict, sizeof d->verdict,
                       "not usable for identification: no velocity %svisibly follows its input",
                       d->left_out != 0 ? "that can be used " : "");
    }
}

void doctor_finish(doctor_t *d)
{
    doctor_cells_flush(d);
    d->still_total_s += d->still_counted ? d->sampled_s - d->still_since_s : 0.0;
    doctor_attitude_scan(d);
    doctor_travel_scan(d);
    doctor_inputs_scan(d);
    doctor_mirror_scan(d);
    doctor_time(d);
    doctor_columns(d);
    doctor_velocity(d);
    int before = d->findings;
    doctor_attitude(d);
    if (d->findings == before) {
        doctor_force(d);
    }
    doctor_inputs(d);
    doctor_world(d);
    doctor_travel(d);
    doctor_scale(d);
    doctor_offset(d);
    sort_findings(d);
    judge(d);
}
