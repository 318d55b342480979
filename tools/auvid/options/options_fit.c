#include "options_reader.h"

#include <string.h>

#include "../base/report_error.h"
#include "../vehicle/decoupled.h"

/* fit --vehicle: its model, thrusters and uncertainties. */
static int take_whole_vehicle(reader_t *r, options_t *options)
{
    int status = take_vehicle(r, options, false);
    if (status == 0) {
        options->model = options->vehicle->model;
        options->whole = true;
    }
    return status;
}

/* --fix or --free: kept as given, because only the model knows its parameter names. */
static int take_choice(reader_t *r, options_t *options)
{
    if (options->choices == OPTIONS_CHOICES) {
        return report_error("fit: more than %d options --fix and --free", OPTIONS_CHOICES);
    }
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    if ((strchr(text, '=') != NULL) != option_is(r, "--fix")) {
        return report_error("%s: '%s' is not %s", r->name, text,
                            option_is(r, "--fix") ? "NAME=VALUE" : "NAME,NAME,..");
    }
    options->choice[options->choices++] = text;
    return 0;
}

/* AXIS=NEWTONS: of one unit of this axis' command. */
static int take_gain(reader_t *r, options_t *options)
{
    const char *text = NULL, *end = NULL;
    double x = 0.0;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    size_t length = strcspn(text, "=");
    int axis = take_axis(text, length);
    if (axis >= 0 && text[length] == '=' && to_real(text + length + 1, &end, &x) && *end == '\0' &&
        x > 0.0 && x <= 1e6) {
        options->gain[axis] = x;
        options->has_gain = true;
        return 0;
    }
    return report_error("--gain: '%s' is not AXIS=NEWTONS, as in surge=40; newtons above 0, at "
                        "most 1e6",
                        text);
}

/* Gaps that the cells of the recorder span [s]. */
static int take_max_gap(reader_t *r, options_t *options)
{
    const char *text = NULL, *end = NULL;
    double *gap_s = &options->max_gap_s;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    return to_real(text, &end, gap_s) && *end == '\0' && *gap_s >= 0.1 && *gap_s <= 1.0
               ? 0
               : report_error("--max-gap: '%s' is not a number of seconds from 0.1 to 1", text);
}

static int fit_option(reader_t *r, options_t *options)
{
    static const char *const inputs[] = {"hold", "linear"};
    static const char *const couplings[] = {"auto", "on", "off"};
    static const char *const maps[] = {"auto", "linear", "signed-square"};
    int choice = 0, status = 0;
    if (option_is(r, "--validate")) {
        return take_value(r, &options->validate);
    }
    if (option_is(r, "--report")) {
        return take_value(r, &options->report);
    }
    if (option_is(r, "--bounds")) {
        return take_bounds(r, options);
    }
    if (option_is(r, "--bias") || option_is(r, "--hold-inputs")) {
        return take_flag(r, option_is(r, "--bias") ? &options->bias : &options->hold_inputs);
    }
    if (option_is(r, "--input")) {
        status = take_word(r, inputs, 2, &choice);
        options->linear_input = choice == 1;
        return status;
    }
    if (option_is(r, "--coupling")) {
        status = take_word(r, couplings, 3, &choice);
        options->coupling = (coupling_t)choice;
        return status;
    }
    if (option_is(r, "--current")) {
        return take_flag(r, &options->current);
    }
    if (option_is(r, "--map")) {
        status = take_word(r, maps, 3, &choice);
        options->map = (options_map_t)(choice + MAP_AUTO);
        return status;
    }
    if (option_is(r, "--model")) {
        return take_model(r, options);
    }
    if (option_is(r, "--thrusters")) {
        return take_thrusters(r, options);
    }
    if (option_is(r, "--dry-mass")) {
        return take_number(r, 1e6, &options->dry_mass_kg);
    }
    if (option_is(r, "--max-gap")) {
        return take_max_gap(r, options);
    }
    if (option_is(r, "--gain")) {
        return take_gain(r, options);
    }
    if (option_is(r, "--closed-loop") || option_is(r, "--open-loop")) {
        return take_loop(r, options);
    }
    if (option_is(r, "--vehicle")) {
        return take_whole_vehicle(r, options);
    }
    if (option_is(r, "--fix") || option_is(r, "--free")) {
        return take_choice(r, options);
    }
    return report_error("fit: unknown option %s (see auvid --help)", r->name);
}

static int check_current(const options_t *options)
{
    int parameters = options->model->parameters;
    if (!options->plain) {
        return report_error("fit: --current needs --plain: with thrusters a current is already "
                            "estimated, among the errors of the inputs");
    }
    return parameters + 2 > AUVID_MAX_PARAMETERS
               ? report_error(
                     "fit: --current adds two parameters, but the model %s has %d already, "
                     "and the program has room for %d",
                     options->model->name, parameters, AUVID_MAX_PARAMETERS)
               : 0;
}

int options_fit(options_t *options, int count, char **argument)
{
    words_t train = {.room = OPTIONS_LOGS};
    int status = options_read(options, count, argument, "fit", fit_option, &train);
    memcpy(options->train, train.word, sizeof options->train);
    options->trains = train.count;
    if (status == 0 && train.count == 0) {
        return report_error("fit: no TRAIN.csv given");
    }
    if (status == 0 && options->coupling == COUPLING_OFF && options->model != &auvid_girona500 &&
        !decoupled_exists(options->model)) {
        return report_error("fit: --coupling off needs the model of Girona500 or of Fossen: the "
                            "model %s has no form without coupling",
                            options->model->name);
    }
    if (status == 0 && options->whole && options->thrusters == NULL && !options->plain &&
        !options->literal) {
        options->thrusters = options->vehicle;
    } else if (status == 0 && options->thrusters != NULL && (options->plain || options->literal)) {
        return report_error("fit: --thrusters and %s cannot be combined",
                            options->plain ? "--plain" : "--literal");
    }
    return status == 0 && options->current ? check_current(options) : status;
}
