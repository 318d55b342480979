/**
 * @file progress.h
 * Progress of a long run on stderr: a bar on a terminal, plain lines otherwise.
 */
#ifndef PROGRAM_PROGRESS_H
#define PROGRAM_PROGRESS_H

#include <stdbool.h>

typedef struct {
    bool quiet, terminal;
    double started_s; /* wall clock */
    int shown;        /* percentage shown last */
} progress_t;

/** Starts. lines: write plain lines if stderr is not a terminal. */
void progress_begin(progress_t *progress, bool lines);

/** On a terminal, draws the bar for the fraction `part` 0..1, followed by a note. */
void progress_bar(progress_t *progress, double part, const char *format, ...);

/** If there is no bar, prints a line. */
void progress_line(const progress_t *progress, const char *format, ...);

/** Removes the bar. Returns the wall-clock time since progress_begin [s]. */
double progress_end(const progress_t *progress);

#endif
