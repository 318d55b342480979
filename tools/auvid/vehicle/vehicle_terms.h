/**
 * @file vehicle_terms.h
 * The sections [parameters] and [terms] of a vehicle file: a model as a table of terms.
 */
#ifndef PROGRAM_VEHICLE_TERMS_H
#define PROGRAM_VEHICLE_TERMS_H

#include "../base/ini.h"
#include "vehicle_file.h"

/** Names by auvid_parameter_kind_t and auvid_factor_t; the last one NULL. */
extern const char *const vehicle_kinds[], *const vehicle_factors[];

/** Reads both sections and makes terms->terms.vehicle. @param title name of the model
 * @return false after a message */
bool vehicle_terms_read(ini_t *ini, const char *title, vehicle_terms_t *terms);

/** Reads the true value of each parameter from [truth]. @return false after a message */
bool vehicle_terms_truth(ini_t *ini, const vehicle_terms_t *terms,
                         double value[SIM_VEHICLE_PARAMETERS]);

#endif
