#include "survey.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../base/report_error.h"
#include "units.h"

enum { LONGEST_US = 1000000 }; /* longer times between velocities count as this */

/* A velocity is held if most of its steps follow a repetition. Only steps that are large against
 * its resolution count: a slow velocity of coarse resolution repeats itself, but does not jump. */
#define LARGE_STEP 3.0
#define MIN_STEPS 20

/* Time between logs, which is a gap for every cell length. */
#define BETWEEN_US 10000000u

#define IRREGULAR 0.05 /* times between velocities that differ by less are regular */

/* Velocities of one log. */
typedef struct {
    double last[3], resolution[3]; /* smallest step of each so far */
    double row_s, new_s;           /* times of the last velocity and of the last that was new */
    size_t repeated;               /* rows since that one */
    size_t steps, after_repeated;  /* large steps; those after a repetition */
    size_t rows;
    uint32_t *every, *changed; /* counts of the times between rows, and between changes [us] */
} held_t;

static void count(uint32_t *counts, double us)
{
    ++counts[(size_t)fmin(us, LONGEST_US)];
}

static double median(const uint32_t *counts)
{
    uint64_t all = 0, below = 0;
    double middle[2] = {0.0, 0.0};
    for (int i = 0; i <= LONGEST_US; ++i) {
        all += counts[i];
    }
    for (int i = 0; i <= LONGEST_US && all > 0; ++i) {
        for (int k = 0; k < 2; ++k) {
            uint64_t rank = (all - 1 + (uint64_t)k) / 2;
            middle[k] = below <= rank && rank < below + counts[i] ? i : middle[k];
        }
        below += counts[i];
    }
    return middle[0] + 0.5 * (middle[1] - middle[0]);
}

/* Compares a velocity with the one before. Returns whether it differs. */
static bool step(held_t *h, const csv_row_t *row)
{
    bool changed = false, large = false;
    for (int i = 0; i < 3; ++i) {
        double now = csv_has(row, CSV_NU + i) ? row->value[CSV_NU + i] : h->last[i];
        double size = fabs(now - h->last[i]);
        h->last[i] = now;
        if (h->rows > 0 && size > 0.0) {
            changed = true;
            large = large || (h->resolution[i] > 0.0 && size > LARGE_STEP * h->resolution[i]);
            h->resolution[i] = h->resolution[i] > 0.0 ? fmin(size, h->resolution[i]) : size;
        }
    }
    h->steps += large;
    h->after_repeated += large && h->repeated > 0;
    return changed;
}

static void take_velocity(held_t *h, const csv_row_t *row, double t_us)
{
    if (!csv_has(row, CSV_NU) && !csv_has(row, CSV_NU + 1) && !csv_has(row, CSV_NU + 2)) {
        return;
    }
    bool changed = step(h, row);
    if (h->rows > 0) {
        count(h->every, t_us - h->row_s);
    }
    if (h->rows > 0 && changed) {
        count(h->changed, t_us - h->new_s);
    }
    h->repeated = changed || h->rows == 0 ? 0 : h->repeated + 1;
    h->new_s = changed || h->rows == 0 ? t_us : h->new_s;
    h->row_s = t_us;
    ++h->rows;
}

/* Decides whether the velocity is held, and adds the times between its samples. */
static void decide_held(survey_t *survey, const held_t *h, log_t *log)
{
    bool held = h->steps >= MIN_STEPS && 2 * h->after_repeated > h->steps;
    if (held) {
        log->held_s = 1e-6 * median(h->changed);
        report_error_line("%s: the velocity is held between samples: a new one each %.3g s, rows "
                          "each %.3g s: repeated values are not taken as samples",
                          log->csv.path, log->held_s, 1e-6 * median(h->every));
    }
    for (int i = 0; i <= LONGEST_US; ++i) {
        survey->intervals[i] += held ? h->changed[i] : h->every[i];
    }
}

int survey_begin(survey_t *survey, double gap_s)
{
    *survey = (survey_t){.gap_s = gap_s};
    survey->intervals = calloc(LONGEST_US + 1, sizeof survey->intervals[0]);
    return survey->intervals != NULL ? 0 : report_error("fit: not enough memory");
}

void survey_end(survey_t *survey)
{
    free(survey->intervals);
    survey->intervals = NULL;
}

double survey_velocity_us(const survey_t *survey)
{
    return median(survey->intervals);
}

double survey_bridged_us(const survey_t *survey, double gap_us)
{
    double usual = median(survey->intervals), time = 0.0, cubes = 0.0;
    for (int i = 0; i <= LONGEST_US && i <= gap_us; ++i) {
        double us = i, times = survey->intervals[i];
        time += times * us;
        cubes += times * us * us * us;
    }
    double bridged = time > 0.0 ? sqrt(cubes / time) : usual;
    return fabs(bridged - usual) > IRREGULAR * usual ? bridged : usual;
}

/* Inputs and voltage that came last. */
typedef struct {
    double input[AUVID_MAX_THRUSTERS], voltage_V;
} inputs_t;

static void take_inputs(survey_t *survey, const csv_row_t *row, const log_use_t *use,
                        inputs_t *last)
{
    double wrench[AUVID_DOF_COUNT];
    auvid_real_t force_N[AUVID_MAX_THRUSTERS] = {0};
    for (int k = 0; k < log_inputs(use); ++k) {
        int column = log_input(use, k);
        last->input[k] = csv_has(row, column) ? row->value[column] : last->input[k];
    }
    last->voltage_V = csv_has(row, CSV_VOLTAGE) ? row->value[CSV_VOLTAGE] : last->voltage_V;
    survey->voltage_V = fmax(survey->voltage_V, last->voltage_V);
    log_wrench(use, last->input, last->voltage_V, wrench, force_N);
    for (int k = 0; k < AUVID_MAX_THRUSTERS; ++k) {
        survey->largest_thrust = fmax(survey->largest_thrust, fabs((double)force_N[k]));
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        survey->largest[j] = fmax(survey->largest[j], fabs(wrench[j]));
    }
}

int survey_inputs(survey_t *survey, log_t *log, const log_use_t *use)
{
    csv_row_t row;
    inputs_t last = {{0}, 0.0};
    int status = csv_rewind(&log->csv);
    while (status == 0 && (status = csv_next(&log->csv, &row)) == 0) {
        take_inputs(survey, &row, use, &last);
    }
    return status == CSV_END ? 0 : status;
}

/* Measures the time between rows with an input. *at_s: of the last one. */
static void time_inputs(survey_t *survey, const csv_row_t *row, const log_use_t *use, double *at_s)
{
    bool any = false;
    for (int k = 0; k < log_inputs(use); ++k) {
        any = any || csv_has(row, log_input(use, k));
    }
    if (any) {
        double since = row->value[CSV_T] - *at_s;
        survey->input_gaps += since > survey->gap_s;
        survey->input_s = fmax(survey->input_s, since);
        *at_s = row->value[CSV_T];
    }
}

static int read_rows(survey_t *survey, log_t *log, const log_use_t *use, held_t *held)
{
    csv_row_t row;
    units_t units = {0};
    inputs_t last = {{0}, 0.0};
    uint64_t t_us = 0, before_us = 0;
    double input_at_s = log->csv.first_s;
    bool present[CSV_COLUMNS] = {false};
    int status = csv_rewind(&log->csv);
    while (status == 0 && (status = csv_next(&log->csv, &row)) == 0) {
        double since = row.value[CSV_T] - log->csv.first_s;
        t_us = (uint64_t)(1e6 * since + 0.5);
        survey->gaps += (double)(t_us - before_us) > 1e6 * survey->gap_s;
        before_us = t_us;
        for (int c = 0; c < CSV_COLUMNS; ++c) {
            present[c] = present[c] || csv_has(&row, c);
        }
        take_velocity(held, &row, (double)t_us);
        take_inputs(survey, &row, use, &last);
        time_inputs(survey, &row, use, &input_at_s);
        units_row(&units, &row);
    }
    if (status != CSV_END) {
        return status;
    }
    for (int c = 0; c < CSV_COLUMNS; ++c) {
        if (log->csv.has[c] && !present[c]) {
            return report_error("%s:%zu:1: the column %s has no value in any row: remove it",
                                log->csv.path, log->csv.header, csv_name[c]);
        }
    }
    log->start_us = survey->end_us + (survey->end_us > 0 ? BETWEEN_US : 1000000u);
    survey->end_us = log->start_us + t_us;
    survey->span_s += log->csv.last_s - log->csv.first_s;
    survey->rows += log->csv.rows;
    return units_check(&units, log->csv.path);
}

int survey_read(survey_t *survey, log_t *log, const log_use_t *use)
{
    held_t held = {.every = calloc(LONGEST_US + 1, sizeof(uint32_t)),
                   .changed = calloc(LONGEST_US + 1, sizeof(uint32_t))};
    int status = held.every == NULL || held.changed == NULL
                     ? report_error("%s: not enough memory", log->csv.path)
                     : read_rows(survey, log, use, &held);
    if (status == 0) {
        csv_notes(&log->csv);
        decide_held(survey, &held, log);
    }
    free(held.every);
    free(held.changed);
    return status;
}
