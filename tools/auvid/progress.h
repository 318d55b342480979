/**
 * @file progress.h
 * How far a long run has come: a bar on a terminal, plain lines otherwise, both on stderr.
 */
#ifndef PROGRAM_PROGRESS_H
#define PROGRAM_PROGRESS_H

#include <stdbool.h>

typedef struct {
    bool quiet, terminal;
    double started_s; /* wall clock */
    int shown;        /* hundredths shown last */
} progress_t;

/** Begin. lines: may plain lines be written when stderr is no terminal? */
void progress_begin(progress_t *progress, bool lines);

/** On a terminal, redraw the bar: part 0..1 is done; note stands behind it. */
void progress_bar(progress_t *progress, double part, const char *format, ...);

/** Where there is no bar, a line. */
void progress_line(const progress_t *progress, const char *format, ...);

/** Remove the bar. Returns the wall time since begin [s]. */
double progress_end(const progress_t *progress);

#endif
