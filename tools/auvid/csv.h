/**
 * @file csv.h
 * Logs as comma-separated values. Errors of the reader name line and column; a log is written
 * completely or not at all.
 */
#ifndef PROGRAM_CSV_H
#define PROGRAM_CSV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/** Columns of a log, identified by their names in the header. */
enum {
    CSV_T,
    CSV_ATTITUDE,
    CSV_NU = CSV_ATTITUDE + 3,
    CSV_WRENCH = CSV_NU + 6,
    CSV_COMMAND = CSV_WRENCH + 6,
    CSV_REFERENCE = CSV_COMMAND + 6,
    CSV_COLUMNS = CSV_REFERENCE + 6
};

/** Their names. */
extern const char *const csv_name[CSV_COLUMNS];

/** One row. Columns missing in the file are zero. */
typedef struct {
    double value[CSV_COLUMNS];
} csv_row_t;

/** Names separated by commas, with "..." at the end if not all fit. */
typedef char csv_list_t[200];

/** A log in memory. */
typedef struct {
    const char *path;
    bool has[CSV_COLUMNS];
    char like[CSV_COLUMNS][24]; /* an ignored column whose name resembles this missing one, or "" */
    csv_list_t columns, ignored;
    size_t header; /* line number of the header, from 1 */
    size_t cut;    /* line number of a truncated last line, which is ignored; else 0 */
    csv_row_t *row;
    size_t rows;
} csv_log_t;

/** Reads a log. The column t_s must exist and increase. At least two rows are needed. Every number
 * must be finite and within +-1e6. Unknown columns are ignored, as is a last line without a line
 * end, which may be truncated. Returns 0, or EXIT_REFUSED after one line on stderr; then there is
 * nothing to free. */
int csv_read(csv_log_t *log, const char *path);

/** Reports a missing column. why: the rest of the sentence. Returns EXIT_REFUSED. */
int csv_missing(const csv_log_t *log, int column, const char *why);

/** Marks a column of the log as ignored. */
void csv_ignore(csv_log_t *log, int column);

/** Reports on stderr a truncated line and ignored columns, with the columns that they resemble. */
void csv_notes(const csv_log_t *log);

/** Frees the memory of the log. */
void csv_free(csv_log_t *log);

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
