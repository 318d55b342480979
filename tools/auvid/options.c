#include "options.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "decoupled.h"
#include "report_error.h"
#include "options_reader.h"

/* Takes the next argument: an option with its value split off, or a plain word (name NULL). */
static bool next(reader_t *r)
{
    if (r->next >= r->count) {
        return false;
    }
    const char *word = r->argument[r->next++];
    r->name = NULL;
    r->value = word;
    if (word[0] == '-' && word[1] != '\0') {
        const char *equals = strchr(word, '=');
        size_t length = equals == NULL ? strlen(word) : (size_t)(equals - word);
        length = length < sizeof r->name_text ? length : sizeof r->name_text - 1;
        memcpy(r->name_text, word, length);
        r->name_text[length] = '\0';
        r->name = r->name_text;
        r->value = equals == NULL ? NULL : equals + 1;
    }
    return true;
}

static bool is(const reader_t *r, const char *name)
{
    return strcmp(r->name, name) == 0;
}

int take_value(reader_t *r, const char **value)
{
    if (r->value == NULL && r->next < r->count) {
        r->value = r->argument[r->next++];
    }
    if (r->value == NULL || r->value[0] == '\0') {
        return report_error("%s needs a value", r->name);
    }
    *value = r->value;
    return 0;
}

int take_flag(const reader_t *r, bool *flag)
{
    if (r->value != NULL) {
        return report_error("%s takes no value", r->name);
    }
    *flag = true;
    return 0;
}

static int take_count(reader_t *r, uint64_t low, uint64_t high, uint64_t *out)
{
    const char *text = NULL;
    char *end = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    errno = 0;
    unsigned long long x = strtoull(text, &end, 10);
    if (text[strspn(text, "0123456789")] != '\0' || errno != 0 || x < low || x > high) {
        return report_error("%s: '%s' is not a whole number from %llu to %llu", r->name, text,
                            (unsigned long long)low, (unsigned long long)high);
    }
    *out = x;
    return 0;
}

int take_count32(reader_t *r, uint32_t low, uint32_t high, uint32_t *out)
{
    uint64_t x = 0;
    int status = take_count(r, low, high, &x);
    *out = status == 0 ? (uint32_t)x : *out;
    return status;
}

/* Reads a plain decimal number at the start of text; *end is what follows it. */
static bool number(const char *text, const char **end, double *out)
{
    char *stop = NULL;
    size_t plain = strspn(text, "0123456789+-.eE");
    *out = strtod(text, &stop);
    *end = stop;
    return stop != text && stop <= text + plain && isfinite(*out);
}

int take_number(reader_t *r, double high, double *out)
{
    const char *text = NULL, *end = NULL;
    double x = 0.0;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    if (!number(text, &end, &x) || *end != '\0' || !(x >= 0.0 && x <= high)) {
        return report_error("%s: '%s' is not a number from 0 to %g", r->name, text, high);
    }
    *out = x;
    return 0;
}

static int take_bounds(reader_t *r, options_t *options)
{
    const char *text = NULL, *end = NULL;
    double low = 0.0, high = 0.0;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    if (!number(text, &end, &low) || *end != ',' || !number(end + 1, &end, &high) || *end != '\0' ||
        fabs(low) > 1e6 || fabs(high) > 1e6) {
        return report_error("%s: '%s' is not LO,HI within +-1e6", r->name, text);
    }
    if (!(low < high)) {
        return report_error("%s: '%s': the lower bound is not below the upper bound", r->name,
                            text);
    }
    options->lower = low;
    options->upper = high;
    return 0;
}

/* Takes one of several words; *out is its index. */
static int take_word(reader_t *r, const char *const *words, int count, int *out)
{
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    for (int i = 0; i < count; ++i) {
        if (strcmp(text, words[i]) == 0) {
            *out = i;
            return 0;
        }
    }
    return report_error("%s: '%s' is not one of %s, %s%s%s", r->name, text, words[0], words[1],
                        count > 2 ? ", " : "", count > 2 ? words[2] : "");
}

/* Reads an option that all commands share. Returns -1 if it is another one. */
static int common_option(reader_t *r, options_t *options)
{
    if (is(r, "--seed")) {
        return take_count(r, 0, UINT64_MAX, &options->seed);
    }
    if (is(r, "--json")) {
        return take_flag(r, &options->json);
    }
    if (is(r, "--literal")) {
        return take_flag(r, &options->literal);
    }
    if (is(r, "--thrust-scale")) {
        return take_number(r, 1.0, &options->thrust_scale);
    }
    if (is(r, "--plain")) {
        return take_flag(r, &options->plain);
    }
    if (is(r, "--dvl-scale")) {
        return take_number(r, 1.0, &options->dvl_scale);
    }
    if (is(r, "--delay")) {
        return take_number(r, 1.0, &options->delay_s);
    }
    return -1;
}

/* in_field: the vehicles of the field simulator are also accepted. */
static int take_vehicle(reader_t *r, options_t *options, bool in_field)
{
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    if (in_field && strcmp(text, "rov20") == 0) {
        options->field.vehicle = FIELD_ROV20;
        options->field.chosen = "--vehicle rov20";
        return 0;
    }
    options->vehicle = vehicle_chosen(r->name, text);
    return options->vehicle != NULL ? 0 : EXIT_REFUSED;
}

static int take_thrusters(reader_t *r, options_t *options)
{
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    options->thrusters = vehicle_chosen(r->name, text);
    return options->thrusters != NULL ? 0 : EXIT_REFUSED;
}

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
    if ((strchr(text, '=') != NULL) != is(r, "--fix")) {
        return report_error("%s: '%s' is not %s", r->name, text,
                            is(r, "--fix") ? "NAME=VALUE" : "NAME,NAME,..");
    }
    options->choice[options->choices++] = text;
    return 0;
}

static int take_model(reader_t *r, options_t *options)
{
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    options->model = vehicle_model(r->name, text);
    return options->model != NULL ? 0 : EXIT_REFUSED;
}

static int demo_option(reader_t *r, options_t *options)
{
    if (is(r, "--disturbance")) {
        return take_number(r, 1000.0, &options->disturbance_N);
    }
    if (is(r, "--lag")) {
        return take_number(r, 10.0, &options->lag_s);
    }
    if (is(r, "--sets")) {
        return take_count32(r, 1, 1000, &options->sets);
    }
    if (is(r, "--runs")) {
        return take_count32(r, 1, 100000, &options->runs);
    }
    if (is(r, "--budget")) {
        return take_budget(r, &options->budget);
    }
    if (is(r, "--csv")) {
        return take_value(r, &options->csv);
    }
    if (is(r, "--vehicle")) {
        return take_vehicle(r, options, true);
    }
    if (is(r, "--report")) {
        return take_value(r, &options->report);
    }
    if (is(r, "--adaptive")) {
        return take_flag(r, &options->adaptive);
    }
    if (is(r, "--scenario")) {
        return take_value(r, &options->scenario);
    }
    int status = options_field_take(r, options);
    return status >= 0 ? status
                       : report_error("demo: unknown option %s (see auvid --help)", r->name);
}

/* AXIS=NEWTONS: of one unit of this axis' command. */
static int take_gain(reader_t *r, options_t *options)
{
    static const char *const axes[AUVID_DOF_COUNT] = {"surge", "sway",  "heave",
                                                      "roll",  "pitch", "yaw"};
    const char *text = NULL, *end = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    size_t length = strcspn(text, "=");
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double x = 0.0;
        if (strlen(axes[j]) == length && strncmp(text, axes[j], length) == 0 &&
            text[length] == '=' && number(text + length + 1, &end, &x) && *end == '\0' && x > 0.0 &&
            x <= 1e6) {
            options->gain[j] = x;
            options->has_gain = true;
            return 0;
        }
    }
    return report_error("--gain: '%s' is not AXIS=NEWTONS, as in surge=40; newtons above 0, at "
                        "most 1e6",
                        text);
}

/* Largest gap that the cells of the recorder span [s]. */
#define MAX_GAP_S 1.0

static int take_max_gap(reader_t *r, options_t *options)
{
    int status = take_number(r, MAX_GAP_S, &options->max_gap_s);
    return status == 0 && options->max_gap_s < 0.1
               ? report_error("--max-gap: %g s is shorter than a cell of 0.1 s", options->max_gap_s)
               : status;
}

static int fit_option(reader_t *r, options_t *options)
{
    static const char *const inputs[] = {"hold", "linear"};
    static const char *const couplings[] = {"auto", "on", "off"};
    int choice = 0, status = 0;
    if (is(r, "--validate")) {
        return take_value(r, &options->validate);
    }
    if (is(r, "--report")) {
        return take_value(r, &options->report);
    }
    if (is(r, "--bounds")) {
        return take_bounds(r, options);
    }
    if (is(r, "--bias")) {
        return take_flag(r, &options->bias);
    }
    if (is(r, "--input")) {
        status = take_word(r, inputs, 2, &choice);
        options->linear_input = choice == 1;
        return status;
    }
    if (is(r, "--coupling")) {
        status = take_word(r, couplings, 3, &choice);
        options->coupling = (coupling_t)choice;
        return status;
    }
    if (is(r, "--model")) {
        return take_model(r, options);
    }
    if (is(r, "--thrusters")) {
        return take_thrusters(r, options);
    }
    if (is(r, "--dry-mass")) {
        return take_number(r, 1e6, &options->dry_mass_kg);
    }
    if (is(r, "--max-gap")) {
        return take_max_gap(r, options);
    }
    if (is(r, "--gain")) {
        return take_gain(r, options);
    }
    if (is(r, "--vehicle")) {
        return take_whole_vehicle(r, options);
    }
    if (is(r, "--fix") || is(r, "--free")) {
        return take_choice(r, options);
    }
    return report_error("fit: unknown option %s (see auvid --help)", r->name);
}

/* Reads an option that node and vehicle share. Returns -1 if it is another one. */
static int bus_option(reader_t *r, options_t *options)
{
    if (is(r, "--bus")) {
        return take_value(r, &options->bus);
    }
    if (is(r, "--lag")) {
        return take_number(r, 10.0, &options->lag_s);
    }
    if (is(r, "--lock-step")) {
        return take_flag(r, &options->lock_step);
    }
    if (is(r, "--realtime")) {
        return take_flag(r, &options->realtime);
    }
    if (is(r, "--vehicle")) {
        return take_vehicle(r, options, false);
    }
    return -1;
}

static int node_option(reader_t *r, options_t *options)
{
    static const char *const clocks[] = {"bus", "own"};
    int choice = 0, status = bus_option(r, options);
    if (status >= 0) {
        return status;
    }
    if (is(r, "--clock")) {
        status = take_word(r, clocks, 2, &choice);
        options->clock_own = choice == 1;
        return status;
    }
    if (is(r, "--excite")) {
        return take_flag(r, &options->excite);
    }
    if (is(r, "--log")) {
        return take_value(r, &options->log);
    }
    if (is(r, "--prior")) {
        return take_value(r, &options->prior);
    }
    if (is(r, "--save")) {
        return take_value(r, &options->save);
    }
    if (is(r, "--sets")) {
        return take_count32(r, 1, 1000, &options->sets);
    }
    return report_error("node: unknown option %s (see auvid --help)", r->name);
}

static int vehicle_option(reader_t *r, options_t *options)
{
    int status = bus_option(r, options);
    if (status >= 0) {
        return status;
    }
    if (is(r, "--disturbance")) {
        return take_number(r, 1000.0, &options->disturbance_N);
    }
    if (is(r, "--no-arm")) {
        return take_flag(r, &options->no_arm);
    }
    if (is(r, "--arm-again")) {
        return take_flag(r, &options->arm_again);
    }
    if (is(r, "--speed")) {
        return take_count32(r, 1, 20, &options->speed);
    }
    return report_error("vehicle: unknown option %s (see auvid --help)", r->name);
}

static int replay_option(reader_t *r, options_t *options)
{
    if (is(r, "--vehicle")) {
        return take_vehicle(r, options, false);
    }
    if (is(r, "--prior")) {
        return take_value(r, &options->prior);
    }
    if (is(r, "--csv")) {
        return take_value(r, &options->csv);
    }
    if (is(r, "--report")) {
        return take_value(r, &options->report);
    }
    if (is(r, "--sets")) {
        return take_count32(r, 1, 1000, &options->sets);
    }
    return report_error("replay: unknown option %s (see auvid --help)", r->name);
}

/* Arguments that are no options. */
typedef struct {
    const char *word[OPTIONS_LOGS];
    int count, room;
} words_t;

static int read_all(options_t *options, int count, char **argument, const char *command,
                    int (*own_option)(reader_t *, options_t *), words_t *words)
{
    reader_t r = {.count = count, .argument = argument};
    *options = (options_t){.command = command,
                           .arguments = count,
                           .argument = argument,
                           .seed = 1,
                           .vehicle = vehicle_default(),
                           .model = &auvid_girona500,
                           .speed = 1,
                           .disturbance_N = -1.0,
                           .thrust_scale = -1.0,
                           .dvl_scale = -1.0,
                           .delay_s = -1.0,
                           .max_gap_s = 0.5,
                           .lower = -1000.0,
                           .upper = 1000.0};
    while (next(&r)) {
        if (r.name == NULL) {
            if (words == NULL || words->count == words->room) {
                return report_error("%s: unexpected argument '%s'", command, r.value);
            }
            words->word[words->count++] = r.value;
            continue;
        }
        int status = common_option(&r, options);
        if (status < 0) {
            status = own_option(&r, options);
        }
        if (status != 0) {
            return status;
        }
    }
    return 0;
}

/* Can the vehicle of this command be simulated? */
static int check_truth(const options_t *options, const char *command)
{
    return options->vehicle->has_truth
               ? 0
               : report_error("%s: the vehicle '%s' has no section [truth]: without its parameters "
                              "it cannot be simulated",
                              command, options->vehicle->word);
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
    return 0;
}

int options_demo(options_t *options, int count, char **argument)
{
    int status = read_all(options, count, argument, "demo", demo_option, NULL);
    status = status != 0 ? status : check_scenario(options);
    status = status != 0 ? status : options_field_check(options);
    status = status != 0 ? status : check_truth(options, "demo");
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

int options_fit(options_t *options, int count, char **argument)
{
    words_t train = {.room = OPTIONS_LOGS};
    int status = read_all(options, count, argument, "fit", fit_option, &train);
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
    if (status == 0 && options->dry_mass_kg > 0.0 && !(options->dry_mass_kg < options->upper)) {
        return report_error("fit: --dry-mass %g is not below the upper bound of the masses, %g: "
                            "see --bounds",
                            options->dry_mass_kg, options->upper);
    }
    if (status == 0 && options->whole && options->thrusters == NULL && !options->plain &&
        !options->literal) {
        options->thrusters = options->vehicle;
    } else if (status == 0 && options->thrusters != NULL && (options->plain || options->literal)) {
        return report_error("fit: --thrusters and %s cannot be combined",
                            options->plain ? "--plain" : "--literal");
    }
    return status;
}

static int check_option(reader_t *r, options_t *options)
{
    if (is(r, "--header")) {
        return take_flag(r, &options->header);
    }
    return report_error("check: unknown option %s (see auvid --help)", r->name);
}

int options_check(options_t *options, int count, char **argument)
{
    words_t file = {.room = 1};
    int status = read_all(options, count, argument, "check", check_option, &file);
    options->file = file.word[0];
    if (status == 0 && file.count == 0) {
        return report_error("check: no LOG.csv or FILE.ini given");
    }
    if (status == 0 && options->json && options->header) {
        return report_error("check: --json and --header cannot be combined");
    }
    return status;
}

/* Checks for combinations that are not allowed, and for missing options. */
static int check_bus(options_t *options, const char *command)
{
    options->sets = options->sets > 0 ? options->sets : 8;
    options->disturbance_N = options->disturbance_N < 0.0 ? 0.0 : options->disturbance_N;
    if (options->literal) {
        return report_error("%s: unknown option --literal (auvid --help lists them)", command);
    }
    if (options->bus == NULL) {
        return report_error("%s: no --bus given: use --bus can0 or --bus vcan0, for example",
                            command);
    }
    if (options->clock_own && options->lock_step) {
        return report_error("%s: --clock own and --lock-step cannot be combined", command);
    }
    return 0;
}

int options_node(options_t *options, int count, char **argument)
{
    int status = read_all(options, count, argument, "node", node_option, NULL);
    status = status != 0 ? status : check_bus(options, "node");
    if (status == 0 && options->clock_own && strcmp(options->bus, "memory") == 0) {
        return report_error(
            "node: --bus memory does not allow --clock own: its vehicle sends the ticks");
    }
    if (status == 0 && strcmp(options->bus, "memory") == 0) {
        return check_truth(options, "node");
    }
    if (status == 0 && options->lag_s > 0.0) {
        return report_error("node: --lag needs --bus memory: it is of the simulated vehicle");
    }
    return status;
}

int options_vehicle(options_t *options, int count, char **argument)
{
    int status = read_all(options, count, argument, "vehicle", vehicle_option, NULL);
    status = status != 0 ? status : check_bus(options, "vehicle");
    const char *other = options->json                  ? "--json"
                        : options->thrust_scale >= 0.0 ? "--thrust-scale"
                        : options->plain               ? "--plain"
                        : options->dvl_scale >= 0.0    ? "--dvl-scale"
                        : options->delay_s >= 0.0      ? "--delay"
                                                       : NULL;
    if (status == 0 && other != NULL) {
        return report_error("vehicle: unknown option %s (see auvid --help)", other);
    }
    return status != 0 ? status : check_truth(options, "vehicle");
}

int options_replay(options_t *options, int count, char **argument)
{
    words_t log = {.room = 1};
    int status = read_all(options, count, argument, "replay", replay_option, &log);
    options->log = log.word[0];
    options->bus = "";
    status = status != 0 ? status : check_bus(options, "replay");
    return status == 0 && log.count == 0 ? report_error("replay: no FILE.log given") : status;
}
