/**
 * @file csv_lines.h
 * Reads a text file line by line, in constant memory.
 */
#ifndef PROGRAM_CSV_LINES_H
#define PROGRAM_CSV_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/** A file and the line that was read last. */
typedef struct {
    const char *path;
    FILE *file;
    char *block;     /* part of the file */
    size_t at, used; /* start of the next line in the block, end of the block */
    bool ended;      /* the block holds the end of the file */
    size_t line;     /* number of the line, from 1 */
    char *start;     /* the line, without its end */
    size_t length;   /* its length */
    bool whole;      /* it has a line end */
} csv_lines_t;

/** Opens a file. What cannot be read twice (a pipe) is copied to a temporary file. Returns 0, or
 * EXIT_REFUSED after one line on stderr; then there is nothing to close. */
int csv_lines_open(csv_lines_t *lines, const char *path);

/** Reads the next line that is not empty, past a byte order mark. Returns 0, EXIT_REFUSED after one
 * line on stderr, or CSV_END (csv.h). */
int csv_lines_next(csv_lines_t *lines);

/** Returns to the start of the file. Returns 0, or EXIT_REFUSED after one line on stderr. */
int csv_lines_rewind(csv_lines_t *lines);

void csv_lines_close(csv_lines_t *lines);

/** Takes the next field from *rest: the text up to a comma, without blanks and quotes. NULL after
 * the last one. */
char *csv_field(char **rest);

/** Column of a field in the line, from 1. */
size_t csv_field_column(const csv_lines_t *lines, const char *field);

#endif
