/*
 * auvid: identify the dynamics of an underwater vehicle, simulated (demo), recorded (fit), or on
 * a CAN bus (node, vehicle, replay: where there is the Linux port).
 */
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "auvid/config.h"
#include "commands.h"
#include "report_error.h"
#include "options.h"
#include "report.h"

static const char about[] =
    "auvid " AUVID_VERSION_STRING ": identify the dynamics of an underwater vehicle\n\n";

static const struct {
    const char *name, *usage;
} command_help[] = {
    {"demo", "[options]             identify a simulated vehicle, and check the result"},
    {"fit", "TRAIN.csv [options]    identify a vehicle from a recorded log"},
#ifdef __linux__
    {"node", "--bus IF [options]    identify a vehicle on a CAN bus"},
    {"vehicle", "--bus IF [options] be a simulated vehicle on a CAN bus"},
    {"replay", "FILE.log [options]  identify from a log of the bus (candump -L)"},
#endif
};

static const char demo_fit_help[] =
    "options of demo and fit\n"
    "  --seed N           of all that is random; default 1\n"
    "  --literal          our reading of the paper's metric: smoothed states, raw wrench\n"
    "  --json             print one JSON object instead of tables\n"
    "  --thrust-scale S   standard deviation of the common scale of the thrust as told, relative;\n"
    "                     default 0.05 (5 %), of a log of commands 0: no motion shows it\n"
    "  --dvl-scale S      the same of the DVL's velocity; default 0.005\n"
    "  --delay S          the same of the delay between thrust as told and motion [s], where the\n"
    "                     data do not determine it; default 0.1\n"
    "\n";
static const char demo_help[] =
    "options of demo\n"
    "  --vehicle NAME     girona500 (default), or bluerov2: a BlueROV2 Heavy in six degrees of\n"
    "                     freedom, which holds roll and pitch\n"
    "  --sets K           sets of 30 s of excitation; default 8\n"
    "  --disturbance N    rms of an unknown force on X, Y, Z [N], 0.4 of it [Nm] on N\n"
    "                     (bluerov2: K, M, N); default 0\n"
    "  --lag S            first-order lag of the thrusters [s], which nobody tells the identifier\n"
    "  --runs R           seeds N .. N+R-1: error statistics over the runs (JSON: the other "
    "values\n"
    "                     are those of the first run)\n"
    "  --budget UNITS     of work in a tick of 20 ms; default 150\n"
    "  --csv FILE         write the (first) run as a log that fit reads\n"
    "  --adaptive         excite what is not known yet, and end when everything is, after K sets\n"
    "                     (default 16) at the latest\n"
    "  --scenario NAME    tell a story instead, with a disturbance of 1 N unless another is "
    "given:\n"
    "                     payload (the vehicle changes under way), yaw-idle (yaw is never "
    "excited),\n"
    "                     operator-abort, current (0.3 m/s, seen by bottom and by water lock),\n"
    "                     dvl-lost (for good, under way)\n"
    "\n";
static const char field_help[] =
    "options of demo in the field: a vehicle with the small mismatches that are usual, drawn in\n"
    "each run, and statistics of what was right; with --seed, --runs (default 20), --sets,\n"
    "--budget and --json as above\n"
    "  --field F          all mismatches of the mixture, F times as large as usual; 0: none\n"
    "  --mismatch NAME=SIZE  this one, in its unit; as often as needed. Alone or beside --field\n"
    "  --mismatch list    names, units and usual sizes\n"
    "  --perfect-thrust   the thrust alone has no mismatch\n"
    "  --matched          no mismatch but in the scales of thrust and DVL, drawn as the\n"
    "                     identifier is told that they are uncertain\n"
    "  --vehicle NAME     girona500 (default), or rov20: a ROV of 20 kg\n"
    "  --driver NAME      excited (default); or, in 600 s without excitation, joystick, lawnmower\n"
    "                     (PID), station\n"
    "  --perfect-inputs   --thrust-scale, --dvl-scale and --delay are zero\n"
    "\n";
static const char fit_help[] =
    "options of fit\n"
    "  --validate TEST.csv   simulate this log with the estimate: R2 of the velocities\n"
    "  --bounds=LO,HI        of every parameter; default -1000,1000\n"
    "  --model NAME          girona500 (default), fossen (six degrees of freedom), bluerov2 (the\n"
    "                        same, for a vehicle that is quicker than its DVL of 5 Hz)\n"
    "  --fix NAME=VALUE      this parameter is known; as often as needed\n"
    "  --free NAME,NAME,..   these are identified too\n"
    "  --bias                also a constant force on X and Y and a moment on N (six degrees of\n"
    "                        freedom: on K and M too)\n"
    "  --input hold|linear   an input holds until the next row (default), or runs straight to it:\n"
    "                        better where rows sample an input that changes between them\n"
    "  --coupling auto|on|off  terms between degrees of freedom; auto: by cross-validation where\n"
    "                        there is a model without them (girona500)\n"
    "\n";

#ifdef __linux__
static const char node_help[] =
    "options of node\n"
    "  --bus IF           interface (can0, vcan0); memory: a simulated vehicle in this process\n"
    "  --excite           obey arm frames and command the thrusters; default: listen only\n"
    "  --clock bus|own    follow the tick frames of the bus (default), or send them\n"
    "  --sets K           end when K sets are identified; default 8\n"
    "  --log FILE         write every frame as candump -L does\n"
    "  --save FILE        write what is known of the vehicle in the end, for --prior\n"
    "  --prior FILE        begin with it; where it cannot be used, a line says so\n"
    "  --lock-step        tell a simulated vehicle when each tick's work is done\n"
    "  --realtime         ask for SCHED_FIFO and locked memory; memory: tick by the clock\n"
    "  --seed N, --vehicle NAME, --json, --thrust-scale S, --dvl-scale S   as for demo\n"
    "\n";
static const char vehicle_help[] =
    "options of vehicle\n"
    "  --bus IF, --seed N, --vehicle NAME, --disturbance N, --realtime   as for node and demo\n"
    "  --lock-step        go on when the node has done its tick, not after 20 ms\n"
    "  --no-arm           nobody arms the node; default: a second after it navigates\n"
    "  --arm-again        after an abort it is disarmed, and armed a second later\n"
    "  --speed K          simulated time goes K times as fast as the clock; default 1\n"
    "  It ends when the node has been silent for 2 s.\n"
    "\n";
static const char replay_help[] =
    "options of replay\n"
    "  --seed N, --sets K, --vehicle NAME, --prior FILE   those of the node that wrote the log\n"
    "  --csv FILE         write its motion and thrust as a log that fit reads\n"
    "  --json, --thrust-scale S, --dvl-scale S   as for demo\n"
    "\n";
#endif
static const char columns_help[] =
    "columns of a log, in any order: t_s; phi_rad theta_rad psi_rad; u_mps v_mps w_mps p_radps\n"
    "q_radps r_radps; inputs X_N Y_N Z_N K_Nm M_Nm N_Nm, or commands cmd_surge cmd_sway cmd_heave\n"
    "cmd_roll cmd_pitch cmd_yaw. An input needs its velocity or rate; other missing columns count\n"
    "as zero. Angles are in radians. A degree of freedom without a varying input is left out.\n"
    "\n";
static const char exit_help[] =
    "exit status: 0 identified; 1 not converged, or nothing to identify; 2 bad usage or data\n";

static const struct {
    const char *of, *text; /* the commands that it is about */
} section[] = {{"demo fit", demo_fit_help},
               {"demo", demo_help},
               {"demo", field_help},
               {"fit", fit_help},
#ifdef __linux__
               {"node", node_help},
               {"vehicle", vehicle_help},
               {"replay", replay_help},
#endif
               {"fit", columns_help},
               {"demo fit node vehicle replay", exit_help}};

static bool is_command(const char *name)
{
    for (size_t i = 0; i < sizeof command_help / sizeof command_help[0]; ++i) {
        if (strcmp(name, command_help[i].name) == 0) {
            return true;
        }
    }
    return false;
}

/* The help of a command; null: of all. */
static int print_help(const char *command)
{
    const char *head = "usage:";
    if (command == NULL) {
        fputs(about, stdout);
    }
    for (size_t i = 0; i < sizeof command_help / sizeof command_help[0]; ++i) {
        if (command == NULL || strcmp(command, command_help[i].name) == 0) {
            printf("%-6s auvid %s %s\n", head, command_help[i].name, command_help[i].usage);
            head = "";
        }
    }
    fputs(command == NULL ? "       auvid help [COMMAND] | --help | --version\n\n" : "\n", stdout);
    for (size_t i = 0; i < sizeof section / sizeof section[0]; ++i) {
        if (command == NULL || strstr(section[i].of, command) != NULL) {
            fputs(section[i].text, stdout);
        }
    }
    return report_finish(0);
}

/* auvid help [COMMAND] */
static int help(int count, char **argument)
{
    if (count > 1) {
        return report_error("help: unexpected argument '%s'", argument[1]);
    }
    if (count == 1 && !is_command(argument[0])) {
        return report_error("help: unknown command '%s': use 'auvid help' for the list, or "
                            "'auvid help demo'",
                            argument[0]);
    }
    return print_help(count == 1 ? argument[0] : NULL);
}

/* The commands on a bus; -1: not one of them. */
static int on_bus(const char *command, int count, char **argument)
{
#ifdef __linux__
    static const struct {
        const char *name;
        int (*read)(options_t *options, int count, char **argument);
        int (*run)(const options_t *options);
    } commands[] = {{"node", options_node, bus_node},
                    {"vehicle", options_vehicle, bus_vehicle},
                    {"replay", options_replay, bus_replay}};
    options_t options;
    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; ++i) {
        if (strcmp(command, commands[i].name) == 0) {
            int status = commands[i].read(&options, count, argument);
            return status != 0 ? status : commands[i].run(&options);
        }
    }
#else
    (void)command;
    (void)count;
    (void)argument;
#endif
    return -1;
}

int main(int count, char **argument)
{
    options_t options;
    const char *command = count > 1 ? argument[1] : "";
    for (int i = 1; i < count; ++i) {
        if (strcmp(argument[i], "--help") == 0 || strcmp(argument[i], "-h") == 0) {
            return print_help(is_command(command) ? command : NULL);
        }
    }
    if (strcmp(command, "--version") == 0) {
        puts("auvid " AUVID_VERSION_STRING);
        return report_finish(0);
    }
    if (strcmp(command, "help") == 0) {
        return help(count - 2, argument + 2);
    }
    int status = EXIT_REFUSED;
    if (strcmp(command, "demo") == 0) {
        status = options_demo(&options, count - 2, argument + 2);
        if (status == 0) {
            status = options.scenario != NULL ? scenario(&options)
                     : options.field.wanted   ? field_demo(&options)
                                              : demo(&options);
        }
    } else if (strcmp(command, "fit") == 0) {
        status = options_fit(&options, count - 2, argument + 2);
        status = status != 0 ? status : fit(&options);
    } else if (count > 1 && (status = on_bus(command, count - 2, argument + 2)) >= 0) {
        return status == EXIT_REFUSED ? status : report_finish(status);
    } else if (command[0] == '\0') {
        return report_error(
            "no command: use 'auvid demo', 'auvid fit TRAIN.csv' or 'auvid --help'");
    } else {
        return report_error("unknown command '%s': use 'auvid demo', 'auvid fit TRAIN.csv' or "
                            "'auvid --help'",
                            command);
    }
    return status == EXIT_REFUSED ? status : report_finish(status);
}
