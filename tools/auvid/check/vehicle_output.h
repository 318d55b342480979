/**
 * @file vehicle_output.h
 * What `auvid check` makes of a vehicle file.
 */
#ifndef PROGRAM_VEHICLE_OUTPUT_H
#define PROGRAM_VEHICLE_OUTPUT_H

#include "../vehicle/vehicle_file.h"

/** The shortest decimal number that gives exactly this one. */
typedef char vehicle_digits_t[32];
void vehicle_digits(auvid_real_t x, vehicle_digits_t digits);

/** Prints the parsed file as one JSON object: values in the units of the file. */
void vehicle_json(const vehicle_t *vehicle, const char *path);

/** Prints C for firmware: functions that write the configurations of allocation, identifier,
 * uncertain inputs and actuation, with the bits that this program uses. */
void vehicle_header(const vehicle_t *vehicle);

/** Prints thrusters, allocation, what is missing and what is assumed.
 * @return 0; EXIT_REFUSED after a message */
int vehicle_report(const vehicle_t *vehicle, const char *path);

#endif
