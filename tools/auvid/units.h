/**
 * @file units.h
 * Are attitude and rates of a log in radians?
 */
#ifndef PROGRAM_UNITS_H
#define PROGRAM_UNITS_H

#include "csv.h"

/** Look for what no angle in radians and no rate in rad/s of a vehicle does. Returns 0, or
 * EXIT_REFUSED after one line on stderr that names the column, what it does, and what to do. A slow
 * log in which both are in degrees, pitch is small and yaw does not wrap passes. */
int units_check(const csv_log_t *log);

#endif
