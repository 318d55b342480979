/*
 * auvid: identifies the dynamics of an underwater vehicle that is simulated (demo), recorded (fit)
 * or on a CAN bus (node, vehicle, replay: only with the Linux port).
 */
#ifdef __linux__
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#endif
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "auvid/config.h"
#include "commands.h"
#include "base/report_error.h"
#include "options/options.h"
#include "report/report.h"

static const char about[] =
    "auvid " AUVID_VERSION_STRING ": identify the dynamics of an underwater vehicle\n\n";

static const struct {
    const char *name, *usage;
} command_help[] = {
    {"demo", "[options]             identify a simulated vehicle and check the result"},
    {"fit", "TRAIN.csv .. [options] identify a vehicle from recorded logs"},
    {"check", "LOG.csv [--json]     find slips in a log before a vehicle is identified from it"},
    {"check", "FILE.ini [options]   what a vehicle file says, and what it lacks"},
#ifdef __linux__
    {"node", "--bus IF [options]    identify a vehicle on a CAN bus"},
    {"vehicle", "--bus IF [options] simulate a vehicle on a CAN bus"},
    {"replay", "FILE.log [options]  identify from a log of the bus (candump -L)"},
#endif
};

static const char demo_fit_help[] =
    "options of demo and fit\n"
    "  --seed N           seed of all random numbers; default 1\n"
    "  --literal          the literal smoothing of the paper: smoothed states, raw wrench\n"
    "  --json             print one JSON object instead of tables\n"
    "  --report FILE.html  also write a page with plots, which needs no network (one run)\n"
    "  --thrust-scale S   relative standard deviation of the common scale error of the supplied\n"
    "                     thrust, which no motion reveals; default 0.05 (5 %), for commands 0\n"
    "  --dvl-scale S      relative standard deviation of the scale error of the DVL's velocity;\n"
    "                     default 0.005\n"
    "  --delay S          standard deviation of the delay from supplied thrust to motion [s],\n"
    "                     used where the data do not determine the delay; default 0.1\n"
    "\n";
static const char demo_help[] =
    "options of demo: the identifier knows that thrust and sensors are exact, but for their "
    "scales\n"
    "and the delay\n"
    "  --vehicle NAME     girona500 (default), or bluerov2: a BlueROV2 Heavy in six degrees of\n"
    "                     freedom that stabilises roll and pitch; bluerov2_standard, torpedo,\n"
    "                     surface; or FILE.ini, a vehicle of yours (tools/auvid/README.md)\n"
    "  --sets K           data sets of 30 s of excitation; default 8\n"
    "  --disturbance N    rms of an unmodelled force on X, Y, Z [N], and 0.4 times this as a\n"
    "                     moment [Nm] on N (bluerov2: on K, M, N); default 0\n"
    "  --lag S            first-order lag of the thrusters [s], unknown to the identifier\n"
    "  --runs R           error statistics over seeds N .. N+R-1 (all other JSON values are those\n"
    "                     of the first run)\n"
    "  --budget UNITS     work units per tick of 20 ms; default 150. auto, or auto:CORE:MHZ: what\n"
    "                     a microcontroller can do in half of a tick, e.g. auto:m4f:168\n"
    "  --csv FILE         write the (first) run as a log for fit\n"
    "  --adaptive         excite until every parameter is identified, for at most K sets\n"
    "                     (default 16)\n"
    "  --scenario NAME    run a scenario and print its events, by default with a disturbance of\n"
    "                     1 N: payload (the vehicle changes), heave-idle (heave is never "
    "excited),\n"
    "                     operator-abort, current (0.3 m/s, with DVL bottom and water lock),\n"
    "                     dvl-lost (no DVL samples from some time on)\n"
    "\n";
static const char field_help[] =
    "options of demo for field statistics: a vehicle with small mismatches of usual size, drawn\n"
    "again in each run, and how often the results are right; also --seed, --runs (default 20),\n"
    "--sets, --budget and --json as above\n"
    "  --field F          draw all mismatches, F times as large as usual; 0: none\n"
    "  --mismatch NAME=SIZE  set one mismatch, in its unit; repeatable, with or without --field\n"
    "  --mismatch list    list names, units and usual sizes\n"
    "  --perfect-thrust   no mismatch of the thrust\n"
    "  --matched          only the scale errors of thrust and DVL, drawn with the standard\n"
    "                     deviations that the identifier is given\n"
    "  --vehicle NAME     girona500 (default), or rov20: an ROV of 20 kg; or any: another vehicle\n"
    "                     in each run, of 8 to 450 kg, drawn from its seed, with the thrusters\n"
    "                     of one of these; forces of mixtures are in proportion to it\n"
    "  --driver NAME      excited (default); or 600 s without excitation: joystick; assisted, a\n"
    "                     joystick with depth and heading held; lawnmower (PID), station\n"
    "  --hours H          length of each run; an excited vehicle repeats its plan\n"
    "  --plain            estimate no errors of thrust and sensors (uncertain inputs), except the\n"
    "                     scales of thrust and DVL, and the delay\n"
    "  --perfect-inputs   set --thrust-scale, --dvl-scale and --delay to zero;\n"
    "                     no input is uncertain\n"
    "  --then NAME        joystick, assisted, lawnmower or station for 600 s after the excitation\n"
    "  --reference        give the reference of lawnmower or station to the identifier, whose\n"
    "                     instruments use it in closed loop\n"
    "  --alternate A      let their set points alternate by A metres and A / 2 radians each way\n"
    "  --shifts           for each run: how far does each class of causes alone move the\n"
    "                     estimate? Ten times as long\n"
    "\n";
static const char fit_help[] =
    "options of fit\n"
    "  --validate TEST.csv   simulate this log with the estimate: R2 of the velocities\n"
    "  --bounds=LO,HI        bounds of every parameter; default -1000,1000, wider for a vehicle\n"
    "                        with more than 250 kg of dry mass\n"
    "  --model NAME          girona500 (default), fossen (six degrees of freedom), bluerov2 (the\n"
    "                        same, for a vehicle that is faster than its DVL of 5 Hz)\n"
    "  --vehicle NAME        model, thrusters and uncertainties of this vehicle, or of FILE.ini\n"
    "  --thrusters NAME      the log is from the thrusters of girona500 or bluerov2: their errors\n"
    "                        are estimated, too. Without it nothing is identifiable, or --plain\n"
    "  --plain               estimate no errors of thrust and sensors (uncertain inputs), except "
    "the\n"
    "                        scales of thrust and DVL, and the delay\n"
    "  --dry-mass KG         a smaller mass is marked as physically impossible\n"
    "  --gain AXIS=NEWTONS   of one unit of this axis' command (roll, pitch, yaw: newton metres),\n"
    "                        as in surge=40; repeatable, for all axes in use. Then units are SI\n"
    "  --current             also identify a constant current, of a DVL that measures velocity "
    "over\n"
    "                        ground; needs --plain and psi_rad\n"
    "  --map auto|linear|signed-square   force of a command, instead of the vehicle's map; for\n"
    "                        commands of the axes instead of linear. auto: compares them by the\n"
    "                        error of held-out velocity, and takes another one only if it is\n"
    "                        better beyond doubt\n"
    "  --closed-loop AXIS,AXIS,..   a controller holds these, as in heave,yaw, while a pilot "
    "drives\n"
    "                        the others: parameters of these are not identifiable, those of the\n"
    "                        others can be; repeatable\n"
    "  --open-loop AXIS,AXIS,..   an excitation of your own drove these, as of sines or\n"
    "                        triangles: they are not tested for feedback; repeatable\n"
    "  --max-gap S           rows or velocities further apart begin a new record, 0.1 to 1;\n"
    "                        default 0.5, between velocities five of their usual intervals, at\n"
    "                        most 1 (of a DVL with 1 Hz: 1.5)\n"
    "  --hold-inputs         empty cells of inputs keep the last value: the log has inputs only\n"
    "                        where they change, and no row without one was lost\n"
    "  --fix NAME=VALUE      fix this parameter; repeatable\n"
    "  --free NAME,NAME,..   also identify these parameters\n"
    "  --bias                also identify a constant force on X and Y and a moment on N (six\n"
    "                        degrees of freedom: on K and M too)\n"
    "  --input hold|linear   an input is held until the next row (default), or interpolated\n"
    "                        linearly: better where rows sample an input that varies between them\n"
    "  --coupling auto|on|off  terms between degrees of freedom; auto: chosen by cross-validation\n"
    "                        for girona500, on for all other models\n"
    "\n";

static const char check_help[] =
    "options of check\n"
    "  --json             print findings, or what was read, as one JSON object\n"
    "  --header           print C for firmware: the configuration of this vehicle\n"
    "  --vehicle NAME     the log has the inputs of this vehicle's thrusters (or FILE.ini): they "
    "are\n"
    "                     compared with the motion, as forces and moments are\n"
    "  --hold-inputs      as of fit: the log has inputs only where they change\n"
    "  check LOG.csv compares, over the whole log and over parts of it, attitude with rates,\n"
    "  depth and position with velocity, the specific force of an accelerometer (fx_mps2 ..) with\n"
    "  both, acceleration with inputs; then it looks at columns and times.\n"
    "exit status of check: 0 usable; 1 a log is not usable, for the errors listed; 2 bad usage or\n"
    "file\n"
    "\n";

#ifdef __linux__
static const char node_help[] =
    "options of node\n"
    "  --bus IF           interface (can0, vcan0); memory: a simulated vehicle in this process\n"
    "  --excite           obey arm frames and command the thrusters; default: listen only\n"
    "  --clock bus|own    follow the tick frames of the bus (default), or send them\n"
    "  --closed-loop, --open-loop AXIS,AXIS,..   as for fit\n"
    "  --sets K           end after K identified sets; default 8\n"
    "  --log FILE         write every frame received or sent in the format of candump -L\n"
    "  --save FILE        write a prior record of the final estimate, for --prior\n"
    "  --prior FILE       start with this prior record; a message says if it cannot be used\n"
    "  --lock-step        tell the simulated vehicle when the work of each tick is done\n"
    "  --realtime         request SCHED_FIFO and locked memory; with memory: tick by the clock\n"
    "  --lag S            with memory: as for demo\n"
    "  --seed N, --vehicle NAME, --json, --plain, --thrust-scale S, --dvl-scale S   as for\n"
    "                     demo\n"
    "\n";
static const char vehicle_help[] =
    "options of vehicle\n"
    "  --bus IF, --seed N, --vehicle NAME, --disturbance N, --lag S, --realtime   as for node and\n"
    "                     demo\n"
    "  --lock-step        wait for the node's tick instead of 20 ms\n"
    "  --no-arm           never arm the node; default: one second after it navigates\n"
    "  --arm-again        after an abort, disarm the node and arm it a second later\n"
    "  --speed K          simulated time runs K times as fast as the clock; default 1\n"
    "  It ends after 2 s without a frame of the node.\n"
    "\n";
static const char replay_help[] =
    "options of replay\n"
    "  --seed N, --sets K, --vehicle NAME, --prior FILE, --closed-loop AXIS,..,\n"
    "  --open-loop AXIS,..   as for the node that wrote the log\n"
    "  --csv FILE         write the motion and thrust of the log as a log for fit; times from the\n"
    "                     first tick\n"
    "  --json, --report FILE.html, --thrust-scale S, --dvl-scale S   as for demo\n"
    "\n";
#endif
static const char columns_help[] =
    "columns of a log, in any order: t_s; phi_rad theta_rad psi_rad, or a quaternion qw qx qy qz\n"
    "from body to world axes; u_mps v_mps w_mps p_radps q_radps r_radps; inputs X_N Y_N Z_N K_Nm\n"
    "M_Nm N_Nm, or commands cmd_surge cmd_sway cmd_heave cmd_roll cmd_pitch cmd_yaw. With\n"
    "--thrusters or --vehicle also thruster_1 .. and voltage_V, or rpm_1 .., for its thrust map,\n"
    "or forces thruster_1_N .. An input needs its velocity or rate; other missing columns count\n"
    "as zero. Angles are in radians. A degree of freedom whose input does not vary is ignored.\n"
    "ref_surge ref_sway ref_heave ref_roll ref_pitch ref_yaw: velocity or rate of the\n"
    "reference of a controller along its own axes, which identifies a vehicle in closed loop.\n"
    "Lines before the header that begin with # are comments.\n"
    "An empty cell is no new sample, so each sensor may have its own rate. Velocities that are\n"
    "held between samples are recognised. Several logs are records of their own. weight_N: a\n"
    "weight in water that hangs on the vehicle for a part of the log calibrates the thrust.\n"
    "check and fit compare more columns with these: north_m east_m depth_m, and fx_mps2 fy_mps2\n"
    "fz_mps2, the specific force of an accelerometer in body axes (fz_mps2 is -9.8 at rest).\n"
    "\n";
static const char fit_exit_help[] =
    "exit status of fit: 0 at least one parameter or drag force is identifiable; 1 a log is\n"
    "refused; 2 bad usage; 3 nothing can be trusted. The first line of the tables says the same\n"
    "in words.\n";
static const char exit_help[] =
    "exit status of other commands: 0 identified; 1 not converged, or nothing to identify; 2 bad\n"
    "usage or data\n";

static const struct {
    const char *of, *text; /* of: the commands that it describes */
} section[] = {{"demo fit", demo_fit_help}, {"demo", demo_help},
               {"demo", field_help},        {"fit", fit_help},
#ifdef __linux__
               {"node", node_help},         {"vehicle", vehicle_help},
               {"replay", replay_help},
#endif
               {"fit check", columns_help}, {"fit", fit_exit_help},
               {"check", check_help},       {"demo node vehicle replay", exit_help}};

static bool is_command(const char *name)
{
    for (size_t i = 0; i < sizeof command_help / sizeof command_help[0]; ++i) {
        if (strcmp(name, command_help[i].name) == 0) {
            return true;
        }
    }
    return false;
}

/* Prints the help of a command. NULL: of all commands. */
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

/* Runs a command on a bus. Returns its exit status, or -1 if it is not one of them. */
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

/* A file that is opened later must not take the number of a closed stdin, stdout or stderr. What is
 * written there fails, as before. */
static void fill_closed_descriptors(void)
{
#ifdef __linux__
    for (int fd = 0; fd < 3; ++fd) {
        if (fcntl(fd, F_GETFD) < 0) {
            (void)open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
        }
    }
#endif
}

int main(int count, char **argument)
{
    options_t options;
    const char *command = count > 1 ? argument[1] : "";
    fill_closed_descriptors();
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
    } else if (strcmp(command, "check") == 0) {
        status = options_check(&options, count - 2, argument + 2);
        status = status != 0 ? status : check(&options);
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
