/**
 * @file units.h
 * Checks whether attitude and rates of a log are in radians.
 */
#ifndef PROGRAM_UNITS_H
#define PROGRAM_UNITS_H

#include "csv.h"

/** Looks for values that no angle in radians and no rate in rad/s of a vehicle takes. Returns 0, or
 * EXIT_REFUSED after one line on stderr with the column, its value and the remedy. A slow log with
 * both in degrees passes if pitch is small and yaw does not wrap. */
int units_check(const csv_log_t *log);

#endif
