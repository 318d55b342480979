/**
 * @file doctor_report.h
 * The log doctor (doctor.h) on a file.
 */
#ifndef PROGRAM_DOCTOR_REPORT_H
#define PROGRAM_DOCTOR_REPORT_H

#include "../log/log_samples.h"
#include "../options/options.h"
#include "../report/report.h"
#include "doctor.h"

/** auvid check LOG.csv: prints all findings and the verdict. Returns 0: usable; 1: not usable;
 * EXIT_REFUSED after one line on stderr. */
int doctor_check(const char *file, const options_t *options);

/** Prints errors and warnings of a finished doctor on stderr, a line each, and adds them to
 * *findings. path: the log. Returns 0, or EXIT_REFUSED after one line on stderr. */
int doctor_tell(const doctor_t *doctor, const char *path, report_findings_t *findings);

/** The same for an open log, which is read from its beginning. Sets its wrong, shift_us and
 * left_out, and the voltage_V of use. use: see doctor_use, or NULL. dry_mass_kg, known_force:
 * see doctor_dry_mass. */
int doctor_warn(log_t *log, log_use_t *use, double dry_mass_kg, bool known_force,
                report_findings_t *findings);

#endif
