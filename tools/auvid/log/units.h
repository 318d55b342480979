/**
 * @file units.h
 * Checks whether attitude and rates of a log are in radians, and velocities in m/s.
 */
#ifndef PROGRAM_UNITS_H
#define PROGRAM_UNITS_H

#include "csv.h"

enum { UNITS_TEXT = 240 }; /* longest sentence */

/** Change of an angle and integral of its rate, in windows of a second. */
typedef struct {
    double span, turned, expected; /* of the window that began last */
    double angle2, rate2, both;    /* sums of products of the changes in windows */
    int windows, fast;             /* fast: more than one and a half turns a second */
} units_change_t;

/** One axis of attitude and rates. */
typedef struct {
    bool known;            /* an angle was seen */
    double t, angle, rate; /* last angle, and the rate at its time */
    double latest_rate;    /* last rate */
    double step, step_t;   /* first jump that no angle in radians makes, and its time; or 0 */
    units_change_t radians, degrees; /* of an angle that wraps at a revolution in either unit */
    size_t rates, beyond;            /* rates; those beyond a revolution per second */
} units_axis_t;

/** One velocity, first all zeros: samples that no vehicle is as fast as. */
typedef struct {
    double n, fast, last, same; /* samples; fast ones, the last of these, and its repeats */
    double largest, largest_s;  /* the largest, and its time */
} units_speed_t;

/** What fast samples are. */
typedef enum {
    UNITS_SPEED_OK,
    UNITS_SPEED_MARKED, /**< one value again and again: a mark of missing samples */
    UNITS_SPEED_SCALE,  /**< many: another unit */
    UNITS_SPEED_OUTLIER /**< few */
} units_speed_kind_t;

/** Judges all samples. Unless they are UNITS_SPEED_OK, writes a sentence with the remedy. */
units_speed_kind_t units_speed_judge(const units_speed_t *w, const char *name, char *text,
                                     size_t size);

/** Statistics of a log, first all zeros. */
typedef struct {
    units_axis_t axis[3];
    size_t pitches, beyond; /* values of pitch; those that no pitch in radians takes */
    units_speed_t speed[3];
} units_t;

/** Takes a row. */
void units_row(units_t *units, const csv_row_t *row);

/** Judges angles and rates. Returns the column that shows another unit, and writes a sentence with
 * the remedy; -1: none. */
int units_angle_judge(const units_t *units, char *text, size_t size);

/** Looks for values that no angle in radians, no rate in rad/s and no velocity in m/s of a vehicle
 * takes. Call it after the last row. Returns 0, or EXIT_REFUSED after one line on stderr with the
 * column, its value and the remedy. A slow log with both in degrees passes if pitch is small and
 * yaw does not wrap. */
int units_check(const units_t *units, const char *path);

#endif
