#include "options_reader.h"

#include <string.h>

#include "../base/report_error.h"

/* Reads an option that node and vehicle share. Returns -1 if it is another one. */
static int bus_option(reader_t *r, options_t *options)
{
    if (option_is(r, "--bus")) {
        return take_value(r, &options->bus);
    }
    if (option_is(r, "--lag")) {
        return take_number(r, 10.0, &options->lag_s);
    }
    if (option_is(r, "--lock-step")) {
        return take_flag(r, &options->lock_step);
    }
    if (option_is(r, "--realtime")) {
        return take_flag(r, &options->realtime);
    }
    if (option_is(r, "--vehicle")) {
        options->whole = true;
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
    if (option_is(r, "--clock")) {
        status = take_word(r, clocks, 2, &choice);
        options->clock_own = choice == 1;
        return status;
    }
    if (option_is(r, "--closed-loop") || option_is(r, "--open-loop")) {
        return take_loop(r, options);
    }
    if (option_is(r, "--excite")) {
        return take_flag(r, &options->excite);
    }
    if (option_is(r, "--log")) {
        return take_value(r, &options->log);
    }
    if (option_is(r, "--prior")) {
        return take_value(r, &options->prior);
    }
    if (option_is(r, "--save")) {
        return take_value(r, &options->save);
    }
    if (option_is(r, "--sets")) {
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
    if (option_is(r, "--disturbance")) {
        return take_number(r, 1000.0, &options->disturbance_N);
    }
    if (option_is(r, "--no-arm")) {
        return take_flag(r, &options->no_arm);
    }
    if (option_is(r, "--arm-again")) {
        return take_flag(r, &options->arm_again);
    }
    if (option_is(r, "--speed")) {
        return take_count32(r, 1, 20, &options->speed);
    }
    return report_error("vehicle: unknown option %s (see auvid --help)", r->name);
}

static int replay_option(reader_t *r, options_t *options)
{
    if (option_is(r, "--closed-loop") || option_is(r, "--open-loop")) {
        return take_loop(r, options);
    }
    if (option_is(r, "--vehicle")) {
        options->whole = true;
        return take_vehicle(r, options, false);
    }
    if (option_is(r, "--prior")) {
        return take_value(r, &options->prior);
    }
    if (option_is(r, "--csv")) {
        return take_value(r, &options->csv);
    }
    if (option_is(r, "--report")) {
        return take_value(r, &options->report);
    }
    if (option_is(r, "--sets")) {
        return take_count32(r, 1, 1000, &options->sets);
    }
    return report_error("replay: unknown option %s (see auvid --help)", r->name);
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
    int status = options_read(options, count, argument, "node", node_option, NULL);
    status = status != 0 ? status : check_bus(options, "node");
    if (status == 0 && options->clock_own && strcmp(options->bus, "memory") == 0) {
        return report_error(
            "node: --bus memory does not allow --clock own: its vehicle sends the ticks");
    }
    status = status != 0 ? status : options_check_excitation(options, options->excite);
    if (status == 0 && strcmp(options->bus, "memory") == 0) {
        return options_check_truth(options, "node");
    }
    if (status == 0 && options->lag_s > 0.0) {
        return report_error("node: --lag needs --bus memory: it is of the simulated vehicle");
    }
    return status;
}

int options_vehicle(options_t *options, int count, char **argument)
{
    int status = options_read(options, count, argument, "vehicle", vehicle_option, NULL);
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
    status = status != 0 ? status : options_check_excitation(options, true);
    return status != 0 ? status : options_check_truth(options, "vehicle");
}

int options_replay(options_t *options, int count, char **argument)
{
    words_t log = {.room = 1};
    int status = options_read(options, count, argument, "replay", replay_option, &log);
    options->log = log.word[0];
    options->bus = "";
    status = status != 0 ? status : check_bus(options, "replay");
    if (status == 0 && log.count == 0) {
        return report_error("replay: no FILE.log given");
    }
    return status != 0 ? status
                       : options_check_excitation(options, options->vehicle->has_excitation);
}
