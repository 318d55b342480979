#include "options_reader.h"

#include <string.h>

#include "../base/report_error.h"

static int demo_option(reader_t *r, options_t *options)
{
    if (option_is(r, "--disturbance")) {
        return take_number(r, 1000.0, &options->disturbance_N);
    }
    if (option_is(r, "--lag")) {
        return take_number(r, 10.0, &options->lag_s);
    }
    if (option_is(r, "--sets")) {
        return take_count32(r, 1, 1000, &options->sets);
    }
    if (option_is(r, "--runs")) {
        return take_count32(r, 1, 100000, &options->runs);
    }
    if (option_is(r, "--budget")) {
        return take_budget(r, &options->budget);
    }
    if (option_is(r, "--csv")) {
        return take_value(r, &options->csv);
    }
    if (option_is(r, "--vehicle")) {
        return take_vehicle(r, options, true);
    }
    if (option_is(r, "--report")) {
        return take_value(r, &options->report);
    }
    if (option_is(r, "--adaptive")) {
        return take_flag(r, &options->adaptive);
    }
    if (option_is(r, "--scenario")) {
        return take_value(r, &options->scenario);
    }
    int status = options_field_take(r, options);
    return status >= 0 ? status
                       : report_error("demo: unknown option %s (see auvid --help)", r->name);
}

/* A scenario has a plan of its own and a single run. */
static int check_scenario(const options_t *options)
{
    const char *other = options->runs > 0                       ? "--runs"
                        : options->sets > 0                     ? "--sets"
                        : options->csv != NULL                  ? "--csv"
                        : options->budget > 0                   ? "--budget"
                        : options->literal                      ? "--literal"
                        : options->adaptive                     ? "--adaptive"
                        : options->vehicle != vehicle_default() ? "--vehicle"
                                                                : NULL;
    if (options->scenario != NULL && other != NULL) {
        return report_error("demo: --scenario and %s cannot be combined", other);
    }
    const char *many = options->scenario != NULL ? "--scenario"
                       : options->runs > 0       ? "--runs"
                                                 : NULL;
    if (options->report != NULL && many != NULL) {
        return report_error("demo: --report and %s cannot be combined: it is of one run", many);
    }
    if (options->adaptive && options->literal) {
        return report_error("demo: --adaptive and --literal cannot be combined");
    }
    if (options->literal && options->vehicle->calibrations > 0) {
        return report_error("demo: --literal has no known force: remove [calibration.1] from the "
                            "vehicle file");
    }
    return 0;
}

int options_demo(options_t *options, int count, char **argument)
{
    int status = options_read(options, count, argument, "demo", demo_option, NULL);
    status = status != 0 ? status : check_scenario(options);
    status = status != 0 ? status : options_field_check(options);
    status = status != 0 ? status : options_check_excitation(options, true);
    status = status != 0 ? status : options_check_truth(options, "demo");
    if (options->disturbance_N < 0.0) {
        options->disturbance_N = options->scenario != NULL ? 1.0 : 0.0;
    }
    options->sets = options->sets > 0 ? options->sets : options->adaptive ? 16 : 8;
    options->budget = options->budget > 0 ? options->budget : AUVID_DEFAULT_BUDGET;
    if (status == 0 && options->adaptive && options->sets > 120) {
        return report_error("demo: --adaptive takes at most 120 sets");
    }
    return status;
}

static int check_option(reader_t *r, options_t *options)
{
    if (option_is(r, "--header")) {
        return take_flag(r, &options->header);
    }
    if (option_is(r, "--vehicle")) {
        options->whole = true;
        return take_vehicle(r, options, false);
    }
    if (option_is(r, "--hold-inputs")) {
        return take_flag(r, &options->hold_inputs);
    }
    return report_error("check: unknown option %s (see auvid --help)", r->name);
}

int options_check(options_t *options, int count, char **argument)
{
    words_t file = {.room = 1};
    int status = options_read(options, count, argument, "check", check_option, &file);
    options->file = file.word[0];
    if (status == 0 && file.count == 0) {
        return report_error("check: no LOG.csv or FILE.ini given");
    }
    if (status == 0 && options->json && options->header) {
        return report_error("check: --json and --header cannot be combined");
    }
    return status;
}
