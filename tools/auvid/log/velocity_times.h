/**
 * @file velocity_times.h
 * The times between the velocities of a log: which of them break the record, and how much of the
 * log is lost by that.
 */
#ifndef PROGRAM_VELOCITY_TIMES_H
#define PROGRAM_VELOCITY_TIMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "csv.h"

enum { VELOCITY_TIMES_CLASSES = 2000 }; /* of a millisecond; the last one holds all longer times */

/** Times between rows with a velocity. Memory: 8 KB. */
typedef struct {
    uint32_t count[VELOCITY_TIMES_CLASSES + 1];
    double longer_s;        /* sum of the times in the last class */
    double longest_s;       /**< the longest one; 0: none */
    double first_s, last_s; /* of the rows */
    double velocity_s;      /* time of the last velocity */
    double no_rows_s;       /* since then, the sum of the gaps in the rows */
    size_t rows, times;     /* rows; times between velocities */
    bool any;               /* there was a velocity */
} velocity_times_t;

/** What the gaps between velocities do to a log. */
typedef struct {
    size_t gaps;     /**< times above the limit */
    double usual_s;  /**< median of all times */
    double lost;     /**< part of the log that is lost, 0 to 1 */
    double bridge_s; /**< --max-gap that bridges most of the gaps; 0: none does */
} velocity_gaps_t;

/** The shortest and the longest --max-gap [s]. */
#define VELOCITY_SHORTEST_GAP_S 0.1
#define VELOCITY_LONGEST_GAP_S 1.0
/** Time between rows without a gap, unless --max-gap says otherwise [s]. */
#define VELOCITY_ROW_GAP_S 0.5

/** Takes a row. *times begins as all zeros. Times without rows are not counted: these are gaps of
 * the log, not of the velocities. */
void velocity_times_row(velocity_times_t *times, const csv_row_t *row);

/** Median time between velocities [s]; 0: there are none. */
double velocity_times_usual(const velocity_times_t *times);

/** Longest time between rows in one record [s]. max_gap_s: of --max-gap; 0: not given */
static inline double velocity_row_gap_s(double max_gap_s)
{
    return max_gap_s > 0.0 ? max_gap_s : VELOCITY_ROW_GAP_S;
}

/** Longest time between velocities in one record [s]: --max-gap; without it that of the filter on
 * board (auvid_recorder_gap), if there are rows between the velocities. A velocity that usually
 * comes as late as that, or nearly so, must not break the record each time.
 * @param usual_s median time between velocities
 * @param row_s mean time between rows
 * @param max_gap_s of --max-gap; 0: not given */
double velocity_gap_s(double usual_s, double row_s, double max_gap_s);

/** Mean time between rows [s]. */
double velocity_times_row_s(const velocity_times_t *times);

/** Counts the gaps above a limit. */
void velocity_times_gaps(const velocity_times_t *times, double gap_s, velocity_gaps_t *gaps);

#endif
