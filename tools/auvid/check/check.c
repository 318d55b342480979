/*
 * auvid check: what is in a file, and what is wrong with it.
 *
 * One function for each kind of file, which is known by its name.
 */
#include <stdio.h>
#include <string.h>

#include "../commands.h"
#include "../doctor/doctor_report.h"
#include "../base/report_error.h"
#include "vehicle_output.h"
#include "../vehicle/vehicles.h"

static int check_vehicle(const char *file, const options_t *options)
{
    const vehicle_t *vehicle = vehicle_chosen("check", file);
    if (vehicle == NULL) {
        if (options->json) {
            report_error_json();
        }
        return EXIT_REFUSED;
    }
    bool wrong = vehicle->excitation_refusal[0] != '\0';
    if (wrong && !options->json && vehicle->has_excitation) {
        return report_error("%s", vehicle->excitation_refusal);
    }
    if (options->header) {
        vehicle_header(vehicle);
        return 0;
    }
    if (options->json) {
        vehicle_json(vehicle, file);
        return 0;
    }
    return vehicle_report(vehicle, file);
}

static bool ends_in(const char *file, const char *end)
{
    size_t length = strlen(file), of_end = strlen(end);
    return length >= of_end && strcmp(file + length - of_end, end) == 0;
}

int check(const options_t *options)
{
    const char *file = options->file;
    if (ends_in(file, ".ini") || vehicle_named(file) != NULL) {
        if (options->whole) {
            return report_error("check: --vehicle is for a log, but %s is a vehicle", file);
        }
        if (options->hold_inputs) {
            return report_error("check: --hold-inputs is for a log, but %s is a vehicle", file);
        }
        return check_vehicle(file, options);
    }
    if (options->header) {
        return report_error("check: --header needs a vehicle file (FILE.ini), or one of %s",
                            vehicle_words());
    }
    return doctor_check(file, options);
}
