/**
 * @file csv.h
 * Logs as comma-separated values: reading them with errors that name line and column, and writing
 * them whole or not at all.
 */
#ifndef PROGRAM_CSV_H
#define PROGRAM_CSV_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/** Columns of a log, found by name in its header. */
enum {
    CSV_T,
    CSV_ATTITUDE,
    CSV_NU = CSV_ATTITUDE + 3,
    CSV_WRENCH = CSV_NU + 6,
    CSV_COMMAND = CSV_WRENCH + 6,
    CSV_COLUMNS = CSV_COMMAND + 6
};

/** Their names. */
extern const char *const csv_name[CSV_COLUMNS];

/** One row; columns that the file does not have are zero. */
typedef struct {
    double value[CSV_COLUMNS];
} csv_row_t;

/** Names with commas between; "..." at the end if there is no room for all. */
typedef char csv_list_t[200];

/** A log in memory. */
typedef struct {
    const char *path;
    bool has[CSV_COLUMNS];
    char like[CSV_COLUMNS][24]; /* an ignored column whose name resembles this missing one; or "" */
    csv_list_t columns, ignored;
    size_t header; /* number of its line, from 1 */
    size_t cut;    /* number of the last line if it was cut off and is left out; else 0 */
    csv_row_t *row;
    size_t rows;
} csv_log_t;

/** Read a log: t_s must be there and increase, there must be two rows at least, every number must
 * be finite and within +-1e6. Other columns are ignored. A last line without a line end may be cut
 * off and is left out. Returns 0, or EXIT_REFUSED after one line on stderr (nothing to free then).
 */
int csv_read(csv_log_t *log, const char *path);

/** Complain that a column is missing. `why`: the rest of the sentence. Returns EXIT_REFUSED. */
int csv_missing(const csv_log_t *log, int column, const char *why);

/** Count a column of the log among the ignored ones. */
void csv_ignore(csv_log_t *log, int column);

/** Tell on stderr what was left out: a line cut off, ignored columns and what they resemble. */
void csv_notes(const csv_log_t *log);

/** Give the memory back. */
void csv_free(csv_log_t *log);

/** A file being written under a temporary name. */
typedef struct {
    const char *path;
    char *temporary; /* null: written in place (a device) */
    FILE *file;
} csv_writer_t;

/** Open. Returns 0, or EXIT_REFUSED after one line on stderr. */
int csv_create(csv_writer_t *writer, const char *path);
/** Write the header: time, attitude, velocities, wrench. */
void csv_write_header(csv_writer_t *writer);
/** Write a row of those columns. */
void csv_write_row(csv_writer_t *writer, const csv_row_t *row);
/** Finish and give the file its name. Returns 0, or EXIT_REFUSED after one line on stderr. */
int csv_commit(csv_writer_t *writer);
/** Remove what was written. */
void csv_discard(csv_writer_t *writer);

#endif
