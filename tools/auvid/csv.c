/*
 * The rows of a log.
 */
#include "csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "report_error.h"

#define LARGEST 1e6      /* largest value: its square must fit a float */
#define LARGEST_TIME 1e9 /* largest time since the first row [s] */
#define NORM_ERROR 0.05  /* largest error of a quaternion's norm */

int csv_open(csv_log_t *log, const char *path)
{
    *log = (csv_log_t){.path = path};
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
    int status = csv_lines_rewind(&log->lines);
    return status != 0 ? status : csv_lines_next(&log->lines);
}

/* Reports what is wrong with a field. */
static int refuse(const csv_log_t *log, const char *field, int column, const char *trouble)
{
    return report_error("%s:%zu:%zu: %s: '%.24s' %s", log->path, log->lines.line,
                        csv_field_column(&log->lines, field), csv_name[column], field, trouble);
}

/* Parses a field into the row. An empty one is no new sample, except for the time. */
static int read_value(const csv_log_t *log, const char *field, int column, csv_row_t *row)
{
    char *end = NULL;
    if (field[0] == '\0') {
        return column == CSV_T ? refuse(log, field, column, "is empty") : 0;
    }
    double value = strtod(field, &end);
    bool plain = field[strspn(field, "0123456789+-.eE")] == '\0';
    const char *trouble = NULL;
    if (end == field || *end != '\0' || (!plain && isfinite(value))) {
        trouble = "is not a number";
    } else if (!isfinite(value)) {
        trouble = "is not a finite number";
    } else if (column != CSV_T && fabs(value) > LARGEST) {
        trouble = "is beyond +-1e6";
    }
    row->value[column] = value;
    row->present |= UINT64_C(1) << column;
    return trouble == NULL ? 0 : refuse(log, field, column, trouble);
}

/* Checks the time of the row and keeps it. */
static int take_time(csv_log_t *log, const char *field, double t)
{
    const char *trouble = NULL;
    if (log->rows > 0 && t <= log->last_s) {
        trouble = t < log->last_s ? "time goes back" : "time does not advance";
    } else if (log->rows > 0 && t - log->first_s > LARGEST_TIME) {
        trouble = "more than 1e9 s after the first row";
    }
    log->first_s = log->rows == 0 ? t : log->first_s;
    log->last_s = t;
    ++log->rows;
    return trouble == NULL ? 0
                           : report_error("%s:%zu:%zu: t_s: %s: '%.24s'", log->path,
                                          log->lines.line, csv_field_column(&log->lines, field),
                                          trouble, field);
}

/* Computes the attitude from a quaternion from body to world axes. */
static int take_quaternion(const csv_log_t *log, csv_row_t *row)
{
    const uint64_t all = UINT64_C(15) << CSV_QUATERNION;
    const double *q = row->value + CSV_QUATERNION;
    if ((row->present & all) == 0) {
        return 0;
    }
    if ((row->present & all) != all) {
        return report_error("%s:%zu:1: the quaternion is incomplete: qw, qx, qy and qz must be "
                            "given together",
                            log->path, row->line);
    }
    double norm = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(fabs(norm - 1.0) <= NORM_ERROR)) {
        return report_error("%s:%zu:1: the quaternion qw qx qy qz has the norm %.4g, not 1",
                            log->path, row->line, norm);
    }
    double w = q[0] / norm, x = q[1] / norm, y = q[2] / norm, z = q[3] / norm;
    double *angle = row->value + CSV_ATTITUDE;
    angle[0] = atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
    angle[1] = asin(fmax(-1.0, fmin(1.0, 2.0 * (w * y - z * x))));
    angle[2] = atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    row->present |= UINT64_C(7) << CSV_ATTITUDE;
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
    int status = take_time(log, time_field, row->value[CSV_T]);
    return status == 0 && log->quaternion ? take_quaternion(log, row) : status;
}

int csv_next(csv_log_t *log, csv_row_t *row)
{
    int status = csv_lines_next(&log->lines);
    if (status == 0 && log->lines.whole) {
        return read_row(log, row);
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

static int keep_row(csv_log_t *log, const csv_row_t *row)
{
    size_t i = log->rows - 1;
    if (i == 0 || (i >= 1024 && (i & (i - 1)) == 0)) {
        csv_row_t *more = realloc(log->row, (i < 1024 ? 1024 : 2 * i) * sizeof *more);
        if (more == NULL) {
            return report_error("%s: not enough memory", log->path);
        }
        log->row = more;
    }
    log->row[i] = *row;
    for (int c = 0; c < CSV_COLUMNS; ++c) {
        if (!csv_has(row, c)) {
            log->row[i].value[c] = 0.0;
        }
        if (log->has[c] && !csv_has(row, c)) {
            return report_error("%s:%zu: %s: '' is empty", log->path, row->line, csv_name[c]);
        }
    }
    return 0;
}

int csv_read(csv_log_t *log, const char *path)
{
    csv_row_t row;
    int status = csv_open(log, path);
    while (status == 0 && (status = csv_next(log, &row)) == 0) {
        status = keep_row(log, &row);
    }
    csv_close(log);
    if (status == EXIT_REFUSED) {
        csv_free(log);
    }
    return status == CSV_END ? 0 : status;
}

void csv_free(csv_log_t *log)
{
    free(log->row);
    log->row = NULL;
    log->rows = 0;
}
