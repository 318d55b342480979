/**
 * @file csv.h
 * Logs as comma-separated values. A log is read row by row, in constant memory, as often as needed.
 * Errors of the reader name line and column. A log is written completely or not at all.
 *
 *     csv_log_t log;
 *     csv_row_t row;
 *     int status = csv_open(&log, path);
 *     while (status == 0 && (status = csv_next(&log, &row)) == 0) {
 *         if (csv_has(&row, CSV_NU)) ...
 *     }
 *     csv_close(&log);                     status: CSV_END, or EXIT_REFUSED after a message
 */
#ifndef PROGRAM_CSV_H
#define PROGRAM_CSV_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "csv_lines.h"

/** Largest number of thrusters in a log. */
enum { CSV_THRUSTERS = 8 };

/** Columns of a log, identified by their names in the header. */
enum {
    CSV_T,
    CSV_ATTITUDE,
    CSV_NU = CSV_ATTITUDE + 3,
    CSV_WRENCH = CSV_NU + 6,
    CSV_COMMAND = CSV_WRENCH + 6,
    CSV_REFERENCE = CSV_COMMAND + 6,
    CSV_QUATERNION = CSV_REFERENCE + 6,    /* instead of the attitude, which the reader computes */
    CSV_POSITION = CSV_QUATERNION + 4,     /* north, east, depth */
    CSV_SPECIFIC_FORCE = CSV_POSITION + 3, /* of an accelerometer, in body axes */
    CSV_THRUSTER = CSV_SPECIFIC_FORCE + 3, /* commands */
    CSV_THRUSTER_N = CSV_THRUSTER + CSV_THRUSTERS, /* newtons */
    CSV_RPM = CSV_THRUSTER_N + CSV_THRUSTERS,
    CSV_VOLTAGE = CSV_RPM + CSV_THRUSTERS,
    CSV_WEIGHT, /* in water, of what hangs on the vehicle */
    CSV_COLUMNS
};

/** Their names. */
extern const char *const csv_name[CSV_COLUMNS];

/** One row. A value is absent if its column is missing, or its cell empty: no new sample. */
typedef struct {
    double value[CSV_COLUMNS]; /**< absent: NAN */
    size_t line;               /**< line number in the file, from 1 */
} csv_row_t;

/** Is the value of a column present? */
static inline bool csv_has(const csv_row_t *row, int column)
{
    return !isnan(row->value[column]);
}

/** Names separated by commas, with "..." at the end if not all fit. */
typedef char csv_list_t[200];

/** Computes the attitude from a quaternion of length 1 from body to world axes. */
void csv_attitude(double w, double x, double y, double z, double angle[3]);

/** A log that is being read. */
typedef struct {
    const char *path;
    bool has[CSV_COLUMNS];      /* attitude: also if it is computed from a quaternion */
    char like[CSV_COLUMNS][24]; /* an ignored column whose name resembles this missing one, or "" */
    csv_list_t columns, ignored;
    size_t header; /* line number of the header, from 1 */
    size_t cut;  /* line number of a truncated last line, which is ignored; else 0. After a pass */
    size_t rows; /* rows read in this pass */
    double first_s, last_s; /* t_s of the first row and of the last one read */
    bool hold_inputs; /* set after csv_open: empty cells of inputs keep the last value: the log has
                         them only where they change */

    /* private */
    csv_lines_t lines;
    int fields;      /* number of fields in the header */
    int *column;     /* [fields] column of the log, or -1 */
    bool quaternion; /* the attitude is computed from it */
    uint64_t filled; /* bit c: the last row has a value of column c */
    double held[CSV_COLUMNS]; /* last value of each input in this pass; NAN: none yet */
} csv_log_t;

/** csv_next: there are no more rows. */
enum { CSV_END = 1 };

/** Opens a log and reads its header, past comments: lines that begin with #, unless the first
 * column after it is t_s. The column t_s must exist. Unknown columns are ignored. What
 * cannot be read twice (a pipe) is copied to a temporary file. Returns 0, or EXIT_REFUSED after one
 * line on stderr; then there is nothing to close. */
int csv_open(csv_log_t *log, const char *path);

/** Reads the next row. Time must increase. Every number must be finite and within +-1e6. A last
 * line without a line end may be truncated and is ignored. Returns 0; CSV_END after the last of at
 * least two rows; EXIT_REFUSED after one line on stderr. */
int csv_next(csv_log_t *log, csv_row_t *row);

/** Begins a further pass: the next row is the first one. Returns 0, or EXIT_REFUSED after one line
 * on stderr. */
int csv_rewind(csv_log_t *log);

/** Closes a log. One that is all zeros is not open. */
void csv_close(csv_log_t *log);

/** Reports a missing column. why: the rest of the sentence. Returns EXIT_REFUSED. */
int csv_missing(const csv_log_t *log, int column, const char *why);

/** Marks a column of the log as ignored. */
void csv_ignore(csv_log_t *log, int column);

/** Reports on stderr a truncated line and ignored columns, with the columns that they resemble.
 * Call it after a pass. */
void csv_notes(const csv_log_t *log);

/** Reads the header; csv_open calls it. */
int csv_read_header(csv_log_t *log);

/** A file that is written under a temporary name. */
typedef struct {
    const char *path;
    char *temporary; /* NULL: written in place (a device) */
    FILE *file;
} csv_writer_t;

/** Opens the file. Returns 0, or EXIT_REFUSED after one line on stderr. */
int csv_create(csv_writer_t *writer, const char *path);
/** Writes the header: time, attitude, velocities, wrench. */
void csv_write_header(csv_writer_t *writer);
/** Writes a row of these columns. */
void csv_write_row(csv_writer_t *writer, const csv_row_t *row);
/** Closes and renames the file. Returns 0, or EXIT_REFUSED after one line on stderr. */
int csv_commit(csv_writer_t *writer);
/** Deletes the temporary file. */
void csv_discard(csv_writer_t *writer);

#endif
