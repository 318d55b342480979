/*
 * The rows of a log.
 */
#include "csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../base/report_error.h"

#define LARGEST 1e6      /* largest value: its square must fit a float */
#define LARGEST_TIME 1e9 /* largest time since the first row [s] */
#define SET_BACK_S 1.0   /* rows in disorder are closer together [s] */
#define NORM_ERROR 0.05  /* largest error of a quaternion's norm */

_Static_assert(CSV_COLUMNS <= 64, "a bit for each column: filled()");

static void forget_inputs(csv_log_t *log)
{
    for (int c = 0; c < CSV_COLUMNS; ++c) {
        log->held[c] = NAN;
    }
}

int csv_open(csv_log_t *log, const char *path)
{
    *log = (csv_log_t){.path = path};
    forget_inputs(log);
    int status = csv_lines_open(&log->lines, path);
    if (status == 0 && (status = csv_read_header(log)) != 0) {
        csv_close(log);
    }
    return status;
}

void csv_close(csv_log_t *log)
{
    csv_lines_close(&log->lines);
    free(log->column);
    log->column = NULL;
}

int csv_rewind(csv_log_t *log)
{
    log->rows = 0;
    forget_inputs(log);
    int status = csv_lines_rewind(&log->lines);
    while (status == 0 && log->lines.line < log->header) { /* comments, and the header */
        status = csv_lines_next(&log->lines);
    }
    return status;
}

/* Converts a plain decimal number, as strtod does but faster. A mantissa and a power of ten that
 * are both exact give the nearest number in one operation (Clinger 1990). Returns false for all
 * others. */
static bool quick_number(const char *text, double *value)
{
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *c = text + (*text == '-');
    uint64_t mantissa = 0;
    int digits = 0, after_point = 0;
    for (bool point = false; (*c >= '0' && *c <= '9') || (*c == '.' && !point); ++c) {
        if (*c == '.') {
            point = true;
        } else {
            mantissa = 10 * mantissa + (uint64_t)(*c - '0');
            after_point += point;
            ++digits;
        }
        if (digits > 15) {
            return false;
        }
    }
    if (*c != '\0' || digits == 0) {
        return false;
    }
    double size = (double)mantissa / power[after_point];
    *value = *text == '-' ? -size : size;
    return true;
}

/* Reports what is wrong with a field. */
static int refuse(const csv_log_t *log, const char *field, int column, const char *trouble)
{
    return report_error("%s:%zu:%zu: %s: '%.24s' %s", log->path, log->lines.line,
                        csv_field_column(&log->lines, field), csv_name[column], field, trouble);
}

/* Is a text a date with a time, as 2026-05-01T12:00:00Z? */
static bool is_date(const char *text)
{
    const char *colon = strchr(text, ':');
    return colon != NULL && colon[strspn(colon, "0123456789:.,+-Z ")] == '\0' && text[0] >= '0' &&
           text[0] <= '9';
}

/* Converts a field. Returns what is wrong with it, or NULL. */
static const char *convert(const char *field, double *value)
{
    char *end = NULL;
    if (quick_number(field, value)) {
        return NULL;
    }
    *value = strtod(field, &end);
    bool plain = field[strspn(field, "0123456789+-.eE")] == '\0';
    if (end == field || *end != '\0' || (!plain && isfinite(*value))) {
        return "is not a number";
    }
    return isfinite(*value) ? NULL
           : isnan(*value)  ? "is not a finite number; a cell without sample is empty"
                            : "is not a finite number";
}

/* Reads a field into the row. An empty one is no new sample, except for the time. */
static int read_value(const csv_log_t *log, const char *field, int column, csv_row_t *row)
{
    if (field[0] == '\0') {
        return column == CSV_T ? refuse(log, field, column, "is empty") : 0;
    }
    const char *trouble = convert(field, &row->value[column]);
    if (trouble != NULL && column == CSV_T && is_date(field)) {
        trouble = "is a date, not seconds: auvid-log --map converts it (unit = ISO 8601)";
    }
    if (trouble == NULL && column != CSV_T && fabs(row->value[column]) > LARGEST) {
        trouble = "is beyond +-1e6";
    }
    return trouble == NULL ? 0 : refuse(log, field, column, trouble);
}

/* The columns that a row fills, but for the time: bit c. */
static uint64_t filled(const csv_row_t *row)
{
    uint64_t mask = 0;
    for (int c = CSV_T + 1; c < CSV_COLUMNS; ++c) {
        mask |= (uint64_t)csv_has(row, c) << c;
    }
    return mask;
}

/* Checks the time of the row and keeps it. */
static int take_time(csv_log_t *log, const char *field, const csv_row_t *row)
{
    double t = row->value[CSV_T];
    uint64_t before = log->filled;
    const char *trouble = NULL;
    log->filled = filled(row);
    if (log->rows > 0 && t <= log->last_s) {
        /* after a clock that was set, or a second recording, sorting would mix the rows of both */
        trouble = t < log->last_s - SET_BACK_S ? "goes back by more than a second: split the log "
                                                 "here"
                  : t < log->last_s ? "goes back: sort the rows by time, or split the log here"
                  : (log->filled & before) == 0
                      ? "is that of the row before, which fills other columns: merge the rows of "
                        "one time, as auvid-log --map does"
                      : "does not advance: remove repeated rows, or log more "
                        "digits of the time";
    } else if (log->rows > 0 && t - log->first_s > LARGEST_TIME) {
        trouble = "is more than 1e9 s after the first row, as if it were not in seconds";
    }
    log->first_s = log->rows == 0 ? t : log->first_s;
    log->last_s = t;
    ++log->rows;
    return trouble == NULL ? 0 : refuse(log, field, CSV_T, trouble);
}

void csv_attitude(double w, double x, double y, double z, double angle[3])
{
    angle[0] = atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
    angle[1] = asin(fmax(-1.0, fmin(1.0, 2.0 * (w * y - z * x))));
    angle[2] = atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
}

static int take_quaternion(const csv_log_t *log, csv_row_t *row)
{
    const double *q = row->value + CSV_QUATERNION;
    int components = 0;
    for (int k = 0; k < 4; ++k) {
        components += csv_has(row, CSV_QUATERNION + k);
    }
    if (components == 0) {
        return 0;
    }
    if (components < 4) {
        return report_error("%s:%zu:1: the quaternion is incomplete: qw, qx, qy and qz must be "
                            "given together",
                            log->path, row->line);
    }
    double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(fabs(norm - 1.0) <= NORM_ERROR)) {
        return report_error("%s:%zu:1: the quaternion qw qx qy qz has the norm %.4g, not 1",
                            log->path, row->line, norm);
    }
    csv_attitude(q[0] / norm, q[1] / norm, q[2] / norm, q[3] / norm, row->value + CSV_ATTITUDE);
    return 0;
}

static int read_row(csv_log_t *log, csv_row_t *row)
{
    char *rest = log->lines.start;
    const char *time_field = rest;
    *row = (csv_row_t){.line = log->lines.line};
    for (int c = 0; c < CSV_COLUMNS; ++c) {
        row->value[c] = NAN;
    }
    for (int i = 0; i < log->fields; ++i) {
        char *field = csv_field(&rest);
        if (field == NULL) {
            return report_error("%s:%zu:%zu: the row ends after %d of %d columns", log->path,
                                row->line, log->lines.length + 1, i, log->fields);
        }
        int column = log->column[i];
        if (column >= 0 && read_value(log, field, column, row) != 0) {
            return EXIT_REFUSED;
        }
        time_field = column == CSV_T ? field : time_field;
    }
    if (rest != NULL) {
        return report_error("%s:%zu:%zu: the row has more than %d columns", log->path, row->line,
                            csv_field_column(&log->lines, rest), log->fields);
    }
    int status = take_time(log, time_field, row);
    return status == 0 && log->quaternion ? take_quaternion(log, row) : status;
}

static bool is_input(int column)
{
    return (column >= CSV_WRENCH && column < CSV_REFERENCE) ||
           (column >= CSV_THRUSTER && column < CSV_VOLTAGE);
}

static void hold_inputs(csv_log_t *log, csv_row_t *row)
{
    for (int c = 0; c < CSV_COLUMNS; ++c) {
        if (is_input(c)) {
            log->held[c] = csv_has(row, c) ? row->value[c] : log->held[c];
            row->value[c] = log->held[c];
        }
    }
}

int csv_next(csv_log_t *log, csv_row_t *row)
{
    int status = csv_lines_next(&log->lines);
    if (status == 0 && log->lines.whole) {
        status = read_row(log, row);
        if (status == 0 && log->hold_inputs) {
            hold_inputs(log, row);
        }
        return status;
    }
    if (status == 0) {
        log->cut = log->lines.line;
        status = CSV_END;
    }
    if (status == CSV_END && log->rows < 2) {
        return report_error("%s:%zu:1: %s", log->path, log->lines.line,
                            log->rows == 0 ? "no row after the header"
                                           : "only one row: at least two are needed");
    }
    return status;
}
