/**
 * @file doctor_report.h
 * The log doctor (doctor.h) on a file.
 */
#ifndef PROGRAM_DOCTOR_REPORT_H
#define PROGRAM_DOCTOR_REPORT_H

#include "../log/csv.h"
#include "../options/options.h"

/** auvid check LOG.csv: prints all findings and the verdict. Returns 0: usable; 1: not usable;
 * EXIT_REFUSED after one line on stderr. */
int doctor_check(const char *file, const options_t *options);

/** Reads an open log from its beginning and prints errors and warnings on stderr, a line each.
 * Returns 0, or EXIT_REFUSED if the log cannot be read. */
int doctor_warn(csv_log_t *log);

#endif
