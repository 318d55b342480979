#include "options_reader.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../base/report_error.h"
#include "../vehicle/vehicle_keys.h"

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

bool option_is(const reader_t *r, const char *name)
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

int take_count(reader_t *r, uint64_t low, uint64_t high, uint64_t *out)
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
bool to_real(const char *text, const char **end, double *out)
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
    if (!to_real(text, &end, &x) || *end != '\0' || !(x >= 0.0 && x <= high)) {
        return report_error("%s: '%s' is not a number from 0 to %g", r->name, text, high);
    }
    *out = x;
    return 0;
}

/* Takes one of several words; *out is its index. */
int take_word(reader_t *r, const char *const *words, int count, int *out)
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

int take_axis(const char *text, size_t length)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (strlen(vehicle_dofs[j]) == length && strncmp(text, vehicle_dofs[j], length) == 0) {
            return j;
        }
    }
    return -1;
}

/* Take AXIS,AXIS,.. of this option. */
static int take_axes(reader_t *r, const char *option, uint8_t *axes)
{
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    for (const char *name = text;; name += strcspn(name, ",") + 1) {
        int axis = take_axis(name, strcspn(name, ","));
        if (axis < 0) {
            return report_error("%s: '%s' is not AXIS,AXIS,.., as in heave,yaw", option, text);
        }
        *axes |= AUVID_DOF_BIT(axis);
        if (strchr(name, ',') == NULL) {
            return 0;
        }
    }
}

int take_loop(reader_t *r, options_t *options)
{
    int status = option_is(r, "--open-loop") ? take_axes(r, "--open-loop", &options->open_loop)
                                             : take_axes(r, "--closed-loop", &options->closed_loop);
    if (status == 0 && (options->open_loop & options->closed_loop) != 0) {
        return report_error("%s: an axis is in closed loop or in open loop, not both", r->name);
    }
    return status;
}

int take_bounds(reader_t *r, options_t *options)
{
    const char *text = NULL, *end = NULL;
    double low = 0.0, high = 0.0;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    if (!to_real(text, &end, &low) || *end != ',' || !to_real(end + 1, &end, &high) ||
        *end != '\0' || fabs(low) > 1e6 || fabs(high) > 1e6) {
        return report_error("%s: '%s' is not LO,HI within +-1e6", r->name, text);
    }
    if (!(low < high)) {
        return report_error("%s: '%s': the lower bound is not below the upper bound", r->name,
                            text);
    }
    options->has_bounds = true;
    options->lower = low;
    options->upper = high;
    return 0;
}

/* in_field: the vehicles of the field simulator are also accepted. */
int take_vehicle(reader_t *r, options_t *options, bool in_field)
{
    static const char *const chosen[FIELD_VEHICLES] = {
        [FIELD_ROV20] = "--vehicle rov20", [FIELD_ANY] = "--vehicle any"};
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    for (int v = 0; v < FIELD_VEHICLES; ++v) {
        if (in_field && chosen[v] != NULL && strcmp(text, options_field_vehicles[v]) == 0) {
            options->field.vehicle = (field_vehicle_t)v;
            options->field.chosen = chosen[v];
            return 0;
        }
    }
    options->field.vehicle = FIELD_GIRONA500;
    options->vehicle = vehicle_chosen(r->name, text);
    return options->vehicle != NULL ? 0 : EXIT_REFUSED;
}

int take_thrusters(reader_t *r, options_t *options)
{
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    options->thrusters = vehicle_chosen(r->name, text);
    return options->thrusters != NULL ? 0 : EXIT_REFUSED;
}

int take_model(reader_t *r, options_t *options)
{
    const char *text = NULL;
    if (take_value(r, &text) != 0) {
        return EXIT_REFUSED;
    }
    options->model = vehicle_model(r->name, text);
    return options->model != NULL ? 0 : EXIT_REFUSED;
}

/* Reads an option that all commands share. Returns -1 if it is another one. */
static int common_option(reader_t *r, options_t *options)
{
    if (option_is(r, "--seed")) {
        return take_count(r, 0, UINT64_MAX, &options->seed);
    }
    if (option_is(r, "--json")) {
        return take_flag(r, &options->json);
    }
    if (option_is(r, "--literal")) {
        return take_flag(r, &options->literal);
    }
    if (option_is(r, "--thrust-scale")) {
        return take_number(r, 1.0, &options->thrust_scale);
    }
    if (option_is(r, "--plain")) {
        return take_flag(r, &options->plain);
    }
    if (option_is(r, "--dvl-scale")) {
        return take_number(r, 1.0, &options->dvl_scale);
    }
    if (option_is(r, "--delay")) {
        return take_number(r, 1.0, &options->delay_s);
    }
    return -1;
}

int options_read(options_t *options, int count, char **argument, const char *command,
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
                           .delay_s = -1.0};
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

int options_check_excitation(const options_t *options, bool excites)
{
    const vehicle_t *v = options->vehicle;
    return v->excitation_refusal[0] == '\0' || !excites ? 0
                                                        : report_error("%s", v->excitation_refusal);
}

/* Can the vehicle of this command be simulated? */
int options_check_truth(const options_t *options, const char *command)
{
    return options->vehicle->has_truth
               ? 0
               : report_error("%s: the vehicle '%s' has no section [truth]: without its parameters "
                              "it cannot be simulated",
                              command, options->vehicle->word);
}
