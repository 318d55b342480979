/*
 * Options of demo for field statistics.
 */
#include <math.h>
#include <string.h>

#include "../base/report_error.h"
#include "options_reader.h"

const char *const options_drivers[FIELD_DRIVERS] = {"excited", "joystick", "assisted", "lawnmower",
                                                    "station"};
const char *const options_field_vehicles[FIELD_VEHICLES] = {
    [FIELD_GIRONA500] = "girona500", [FIELD_ROV20] = "rov20", [FIELD_ANY] = "any"};

/* Default number of runs. */
#define RUNS 20
/* Sets of 30 s. */
#define SETS_PER_HOUR 120.0

static int take_driver(reader_t *r, field_driver_t *driver)
{
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    for (int i = 0; i < FIELD_DRIVERS; ++i) {
        if (strcmp(text, options_drivers[i]) == 0) {
            *driver = (field_driver_t)i;
            return 0;
        }
    }
    return report_error("%s: '%s' is not one of excited, joystick, assisted, lawnmower, station",
                        r->name, text);
}

static int take_mismatch(reader_t *r, options_field_t *f)
{
    if (f->mismatches == FIELD_MISMATCHES) {
        return report_error("demo: more than %d options --mismatch", FIELD_MISMATCHES);
    }
    return take_value(r, &f->mismatch[f->mismatches++]);
}

int options_field_take(reader_t *r, options_t *options)
{
    options_field_t *f = &options->field;
    if (strcmp(r->name, "--field") == 0) {
        f->mixture = true;
        return take_number(r, 10.0, &f->strength);
    }
    if (strcmp(r->name, "--mismatch") == 0) {
        return take_mismatch(r, f);
    }
    if (strcmp(r->name, "--driver") == 0) {
        f->chosen = "--driver";
        return take_driver(r, &f->driver);
    }
    if (strcmp(r->name, "--then") == 0) {
        f->chosen = "--then";
        int status = take_driver(r, &f->then);
        return status == 0 && f->then == FIELD_EXCITED
                   ? report_error("--then: 'excited' is the driver until then")
                   : status;
    }
    if (strcmp(r->name, "--hours") == 0) {
        f->chosen = "--hours";
        return take_number(r, 24.0, &f->hours);
    }
    if (strcmp(r->name, "--perfect-inputs") == 0) {
        f->chosen = "--perfect-inputs";
        options->thrust_scale = options->dvl_scale = options->delay_s = 0.0;
        return take_flag(r, &f->perfect_inputs);
    }
    if (strcmp(r->name, "--perfect-thrust") == 0) {
        f->chosen = "--perfect-thrust";
        return take_flag(r, &f->perfect_thrust);
    }
    if (strcmp(r->name, "--reference") == 0) {
        f->chosen = "--reference";
        return take_flag(r, &f->reference);
    }
    if (strcmp(r->name, "--alternate") == 0) {
        f->chosen = "--alternate";
        return take_number(r, 10.0, &f->alternate_m);
    }
    if (strcmp(r->name, "--shifts") == 0) {
        f->chosen = "--shifts";
        return take_flag(r, &f->shifts);
    }
    return strcmp(r->name, "--matched") == 0 ? take_flag(r, &f->matched) : -1;
}

int options_field_check(options_t *options)
{
    options_field_t *f = &options->field;
    bool matched = f->matched && (f->mixture || f->perfect_thrust || f->mismatches > 0);
    const char *other = options->scenario != NULL    ? "--scenario"
                        : options->csv != NULL       ? "--csv"
                        : options->report != NULL    ? "--report"
                        : options->literal           ? "--literal"
                        : options->adaptive          ? "--adaptive"
                        : options->disturbance_N > 0 ? "--disturbance"
                        : options->lag_s > 0         ? "--lag"
                                                     : NULL;
    const char *chosen = options->plain ? "--plain" : f->chosen;
    f->wanted = f->mixture || f->matched || f->mismatches > 0;
    if (!f->wanted) {
        return chosen != NULL
                   ? report_error("demo: %s needs --field, --mismatch or --matched", chosen)
                   : 0;
    }
    if (matched) {
        return report_error("demo: --matched and --field, --mismatch or --perfect-thrust cannot be "
                            "combined");
    }
    if (other != NULL) {
        return report_error("demo: --field and %s cannot be combined", other);
    }
    if (options->vehicle != vehicle_default()) {
        return report_error("demo: the vehicles of --field are girona500, rov20 and any");
    }
    bool controlled = f->driver == FIELD_LAWNMOWER || f->driver == FIELD_STATION;
    if (!controlled && (f->reference || f->alternate_m > 0.0)) {
        return report_error("demo: %s needs --driver lawnmower or station",
                            f->reference ? "--reference" : "--alternate");
    }
    if ((options->sets > 0 || f->then != FIELD_EXCITED) && f->driver != FIELD_EXCITED) {
        return report_error("demo: %s needs --driver excited",
                            options->sets > 0 ? "--sets" : "--then");
    }
    if (f->hours > 0.0) {
        if (options->sets > 0) {
            return report_error("demo: --hours and --sets cannot be combined");
        }
        options->sets = (uint32_t)fmax(f->hours * SETS_PER_HOUR + 0.5, 1.0);
    }
    options->runs = options->runs > 0 ? options->runs : RUNS;
    return 0;
}
