/*
 * The logs of a fit: which inputs they have, and which degrees of freedom these excite.
 */
#define _POSIX_C_SOURCE 200112L /* stat */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "fit.h"
#include "../base/report_error.h"
#include "../doctor/doctor_report.h"

/* Relative to the largest of all inputs. An input that stays below this value is rounding noise of
 * zero and does not count as excited. */
#define NEGLIGIBLE 1e-3

/* ---- inputs ---- */

/* Has the log inputs of the model in these six columns? */
static bool has_dofs(const csv_log_t *log, const auvid_vehicle_t *model, int first)
{
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        any = any || (model->columns[j] != 0 && log->has[first + j]);
    }
    return any;
}

static bool has_thrusters(const csv_log_t *log, int first)
{
    bool any = false;
    for (int k = 0; k < CSV_THRUSTERS; ++k) {
        any = any || log->has[first + k];
    }
    return any;
}

/* Has the log inputs of the kind in use? */
static bool has_inputs(const csv_log_t *log, const job_t *job)
{
    const log_use_t *use = &job->use;
    return log_has_thrusters(use) ? log->has[log_input(use, 0)]
                                  : has_dofs(log, job->options->model, log_input(use, 0));
}

/* Does the input act in this DoF? Thrusters may act where nothing is controlled, as fins do in
 * sway; there the log need not have the velocity. */
static bool acts(const job_t *job, const csv_log_t *log, int j)
{
    const log_use_t *use = &job->use;
    const auvid_allocation_config_t *cfg = &use->allocation.cfg;
    bool any = false;
    if (!log_has_thrusters(use)) {
        return log->has[log_input(use, j)];
    }
    for (int k = 0; k < cfg->thrusters; ++k) {
        any = any || fabs((double)cfg->thruster[k].wrench[j]) > 0.0;
    }
    bool controlled = cfg->dofs == 0 || (cfg->dofs >> j & 1u) != 0;
    return any && (controlled || log->has[CSV_NU + j]);
}

static int no_inputs(const job_t *job, const csv_log_t *log)
{
    bool six = job->options->model->columns[AUVID_ROLL] != 0;
    return job->use.vehicle != NULL
               ? log_no_thrusters(&job->use, log)
               : report_error("%s:%zu:1: no input column (X_N Y_N Z_N %sN_Nm, or cmd_surge "
                              "cmd_sway cmd_heave %scmd_yaw) in the header; if another file has "
                              "them, merge the files by t_s",
                              log->path, log->header, six ? "K_Nm M_Nm " : "",
                              six ? "cmd_roll cmd_pitch " : "");
}

/* All thrusters have one delay, because the recorder has one stream of inputs. */
static int take_delay(job_t *job)
{
    const vehicle_t *vehicle = job->use.vehicle;
    double delay_s = vehicle->map[vehicle->thruster[0].map].delay_s;
    for (int k = 1; k < log_inputs(&job->use); ++k) {
        if (fabs(vehicle->map[vehicle->thruster[k].map].delay_s - delay_s) > 0.0) {
            return report_error("fit: the thrusters of %s have different delays: fit takes one",
                                vehicle->word);
        }
    }
    job->use.delay_us = job->use.kind == INPUT_THRUST ? 0u : (uint32_t)(1e6 * delay_s + 0.5);
    return 0;
}

/* Has the log the commands or speeds of the vehicle's thrusters? */
static bool has_commands(const job_t *job, const csv_log_t *log)
{
    const log_use_t use = {.kind = INPUT_THRUSTER_COMMAND,
                           .vehicle = job->use.vehicle,
                           .allocation = job->use.allocation};
    bool any = false;
    for (int k = 0; k < log_inputs(&use); ++k) {
        any = any || log->has[log_input(&use, k)];
    }
    return any;
}

/* Takes the vehicle of the thrusters. Their own forces or commands come before the wrench. */
static int take_vehicle(job_t *job, const csv_log_t *log)
{
    const options_t *options = job->options;
    log_use_t *use = &job->use;
    bool newtons = has_thrusters(log, CSV_THRUSTER_N);
    use->uncertain = options->thrusters != NULL;
    use->vehicle = options->thrusters != NULL ? options->thrusters
                   : options->whole           ? options->vehicle
                                              : NULL;
    if (use->vehicle == NULL) {
        return 0;
    }
    if (auvid_allocation_init(&use->allocation, use->vehicle->allocation) != AUVID_OK) {
        return report_error("fit: the thrusters of %s cannot be used", use->vehicle->word);
    }
    if (newtons || has_commands(job, log)) {
        use->kind = newtons ? INPUT_THRUST : INPUT_THRUSTER_COMMAND;
        return take_delay(job);
    }
    return use->kind == INPUT_COMMAND && use->uncertain
               ? report_error("fit: --%s needs forces and moments (X_N ..), or thruster_1 .., not "
                              "commands of the axes (cmd_*)%s",
                              options->whole ? "vehicle" : "thrusters",
                              options->whole ? "; --model takes the vehicle's model alone" : "")
               : 0;
}

/* Finds the inputs of the first log. */
static int find_inputs(job_t *job)
{
    const csv_log_t *log = &job->log[0].csv;
    const auvid_vehicle_t *model = job->options->model;
    bool wrench = has_dofs(log, model, CSV_WRENCH), command = has_dofs(log, model, CSV_COMMAND);
    bool thrusters = has_thrusters(log, CSV_THRUSTER) || has_thrusters(log, CSV_THRUSTER_N);
    job->use.kind = wrench || !command ? INPUT_WRENCH : INPUT_COMMAND;
    int status = take_vehicle(job, log);
    if (status != 0 || log_has_thrusters(&job->use)) {
        return status;
    }
    if (!wrench && !command) {
        return thrusters ? report_error("%s:%zu:1: the inputs are those of thrusters: name their "
                                        "vehicle (--thrusters, --vehicle)",
                                        log->path, log->header)
                         : no_inputs(job, log);
    }
    return job->options->has_gain && job->use.kind != INPUT_COMMAND
               ? report_error("%s:%zu:1: --gain needs commands (cmd_*), but the log has forces",
                              log->path, log->header)
               : 0;
}

/* ---- columns ---- */

/* Checks that the log has the velocity of each force, and the rate of each moment. */
static int check_velocities(const job_t *job, const csv_log_t *log)
{
    const char *of = log_has_thrusters(&job->use) ? "the thrusters" : NULL;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (job->options->model->columns[j] != 0 && acts(job, log, j) && !log->has[CSV_NU + j]) {
            char why[80];
            (void)snprintf(why, sizeof why, ", but %s: a %s needs its %s",
                           of != NULL ? of : csv_name[log_input(&job->use, j)],
                           j <= AUVID_HEAVE ? "force" : "moment",
                           j <= AUVID_HEAVE ? "velocity" : "rate");
            return csv_missing(log, CSV_NU + j, why);
        }
    }
    return 0;
}

/* Marks the known columns that are not used. Position and specific force are: examine_logs compares
 * them with the rest. */
static void ignore_unused(const job_t *job, csv_log_t *log)
{
    bool used[CSV_COLUMNS] = {[CSV_WEIGHT] = true};
    for (int c = CSV_REFERENCE; c < CSV_THRUSTER; ++c) { /* and the quaternion */
        used[c] = true;
    }
    for (int k = 0; k < log_inputs(&job->use); ++k) {
        used[log_input(&job->use, k)] = true;
    }
    used[CSV_VOLTAGE] = job->use.kind == INPUT_THRUSTER_COMMAND;
    for (int c = CSV_WRENCH; c < CSV_COLUMNS; ++c) {
        if (log->has[c] && !used[c]) {
            csv_ignore(log, c);
        }
    }
}

static int check_columns(const job_t *job, csv_log_t *log)
{
    if (fit_in_commands(job) && job->options->dry_mass_kg > 0.0) {
        return report_error("%s: --dry-mass needs forces, or commands with --gain: masses are in "
                            "units of command",
                            log->path);
    }
    int status = log_has_thrusters(&job->use) ? log_check_thrusters(&job->use, log) : 0;
    if (status == 0 && job->options->current && !log->has[CSV_ATTITUDE + 2]) {
        status = csv_missing(log, CSV_ATTITUDE + 2, ": --current needs the heading");
    }
    status = status != 0 ? status : check_velocities(job, log);
    ignore_unused(job, log);
    if (!job->options->plain) {
        vehicle_warn_mount(job->options->vehicle, log->path);
    }
    return status;
}

/* Opens a log after the first one: its inputs must be of the same kind. */
static int open_further(job_t *job, log_t *log, const char *path)
{
    int status = csv_open(&log->csv, path);
    log->csv.hold_inputs = job->options->hold_inputs;
    if (status == 0 && !has_inputs(&log->csv, job)) {
        status = report_error("%s:%zu:1: no input column of the same kind as in %s (%s ..); if "
                              "it is of other sensors, merge the files by t_s",
                              path, log->csv.header, job->log[0].csv.path,
                              csv_name[log_input(&job->use, 0)]);
    }
    return status != 0 ? status : check_columns(job, &log->csv);
}

/* ---- what is excited ---- */

static int check_thrust(job_t *job)
{
    job->use.voltage_V = job->survey.voltage_V;
    char text[LOG_THRUST_TEXT];
    bool right = !log_has_thrusters(&job->use) ||
                 log_thrust_judge(&job->use, job->survey.largest_thrust, text, sizeof text) == 0;
    return right ? 0 : report_error("%s: %s", job->log[0].csv.path, text);
}

/* Finds the DoF that can be identified, and the largest values of their inputs. */
static void find_excited(job_t *job)
{
    const double *largest = job->survey.largest;
    double max_input = 0.0;
    memset(job->why, 0, sizeof job->why);
    job->use.dofs = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        max_input = fmax(max_input, largest[j]);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool all = true, reference = !job->options->literal;
        for (int i = 0; i < job->train.logs; ++i) {
            all = all && acts(job, &job->log[i].csv, j);
            reference = reference && job->log[i].csv.has[CSV_REFERENCE + j];
        }
        job->use.reference = job->use.reference || reference;
        if (job->options->model->columns[j] != 0 && !all) {
            job->why[j] = "no input column";
        } else if (job->options->model->columns[j] != 0 && (job->left_out >> j & 1u)) {
            job->why[j] = "velocity is too coarse, or stuck";
        } else if (job->options->model->columns[j] != 0 && !(largest[j] > NEGLIGIBLE * max_input)) {
            job->why[j] = "input is always zero";
        } else if (job->options->model->columns[j] != 0) {
            job->use.dofs = (uint8_t)(job->use.dofs | 1u << j);
        }
        bool used = (job->use.dofs >> j & 1u) != 0;
        job->tau_max[j] = used ? (auvid_real_t)largest[j] : AUVID_C(1.0);
    }
}

/* Each command in use needs its gain. One that is zero in all logs so far is not in use. */
static int check_gains(const job_t *job, const survey_t *survey, const csv_log_t *log)
{
    for (int j = 0; j < AUVID_DOF_COUNT && job->options->has_gain; ++j) {
        if (job->options->model->columns[j] != 0 && survey->largest[j] > 0.0 &&
            !(job->options->gain[j] > 0.0)) {
            return report_error("%s: %s has no gain: give it too, as in --gain %s=40", log->path,
                                csv_name[CSV_COMMAND + j], csv_name[CSV_COMMAND + j] + 4);
        }
    }
    return 0;
}

static int survey_log(const job_t *job, survey_t *survey, log_t *log)
{
    int status = survey_read(survey, log, &job->use);
    return status != 0 ? status : check_gains(job, survey, &log->csv);
}

static int survey_all(job_t *job)
{
    double row_gap_s = velocity_row_gap_s(job->options->max_gap_s);
    int status = survey_begin(&job->survey, row_gap_s);
    job->use.gap_us = (uint32_t)(1e6 * row_gap_s + 0.5);
    for (int i = 0; i < job->train.logs && status == 0; ++i) {
        status = survey_log(job, &job->survey, &job->log[i]);
    }
    status = status != 0 ? status : check_thrust(job);
    if (status == 0 && job->test.logs > 0) {
        status = survey_begin(&job->test_survey, row_gap_s);
        status = status != 0 ? status : survey_log(job, &job->test_survey, &job->test_log);
    }
    return status;
}

/* Leaves out wrong training logs, if there are others. */
static void keep_right_logs(job_t *job)
{
    int right = 0, kept = 0;
    for (int i = 0; i < job->train.logs; ++i) {
        right += !job->log[i].wrong;
    }
    for (int i = 0; i < job->train.logs; ++i) {
        log_t log = job->log[i];
        job->log[i] = (log_t){0};
        if (log.wrong && right > 0) {
            report_warning("%s: left out, because of its errors", log.csv.path);
            csv_close(&log.csv);
            continue;
        }
        job->path[kept] = log.csv.path;
        job->shift_s[kept] = 1e-6 * (double)log.shift_us;
        job->left_out |= log.left_out;
        job->log[kept++] = log;
    }
    job->logs_left_out = job->train.logs - kept;
    job->train.logs = kept;
    job->shift_s[kept] = 1e-6 * (double)job->test_log.shift_us;
}

/* Looks for slips in the logs. */
static int examine_logs(job_t *job)
{
    log_use_t *thrusters = log_has_thrusters(&job->use) ? &job->use : NULL;
    int status = 0;
    for (int i = 0; i < job->train.logs + job->test.logs && status == 0; ++i) {
        log_t *log = i < job->train.logs ? &job->log[i] : &job->test_log;
        log->gap_s = fit_velocity_gap_s(job);
        status =
            doctor_warn(log, thrusters, fit_dry_mass_kg(job), job->known_force, &job->findings);
        job->velocity_gaps = job->velocity_gaps || (i < job->train.logs && log->lost > 0.5);
    }
    if (status == 0) {
        keep_right_logs(job);
    }
    return status;
}

/* Have two files the same bytes? */
static bool is_copy(const char *a, const char *b)
{
    FILE *one = fopen(a, "rb"), *other = fopen(b, "rb");
    bool same = one != NULL && other != NULL;
    int c = 0;
    while (same && c != EOF) {
        c = getc(one);
        same = c == getc(other);
    }
    if (one != NULL) {
        (void)fclose(one);
    }
    if (other != NULL) {
        (void)fclose(other);
    }
    return same;
}

/* Are two paths of one file, or of a file and its copy? */
static bool is_same_file(const char *a, const char *b)
{
    struct stat x, y;
    if (stat(a, &x) != 0 || stat(b, &y) != 0) {
        return false;
    }
    return (x.st_dev == y.st_dev && x.st_ino == y.st_ino) ||
           (S_ISREG(x.st_mode) && S_ISREG(y.st_mode) && x.st_size == y.st_size && is_copy(a, b));
}

/* The same rows twice would only make the intervals too small. */
static int check_twice(const options_t *options)
{
    for (int i = 1; i < options->trains; ++i) {
        for (int k = 0; k < i; ++k) {
            if (is_same_file(options->train[k], options->train[i])) {
                return report_error("%s: the estimate is from this log already (%s): this is no "
                                    "further log; give it once",
                                    options->train[i], options->train[k]);
            }
        }
    }
    return 0;
}

static int open_test_log(job_t *job)
{
    const options_t *options = job->options;
    for (int i = 0; i < options->trains; ++i) {
        if (is_same_file(options->train[i], options->validate)) {
            report_warning("%s: the estimate is from this log: this is no validation; give "
                           "--validate another log",
                           options->validate);
            break;
        }
    }
    return open_further(job, &job->test_log, options->validate);
}

int fit_read_logs(job_t *job)
{
    const options_t *options = job->options;
    job->train = (log_set_t){.log = job->log, .logs = options->trains};
    job->test = (log_set_t){.log = &job->test_log, .logs = options->validate != NULL};
    memcpy(job->use.gain, options->gain, sizeof job->use.gain);
    int status = csv_open(&job->log[0].csv, options->train[0]);
    job->log[0].csv.hold_inputs = options->hold_inputs;
    status = status != 0 ? status : check_twice(options);
    status = status != 0 ? status : find_inputs(job);
    status = status != 0 ? status : check_columns(job, &job->log[0].csv);
    (void)log_use_map(&job->use, THRUST_MAP_NEWTON);
    for (int i = 1; i < options->trains && status == 0; ++i) {
        status = open_further(job, &job->log[i], options->train[i]);
    }
    if (status == 0 && options->validate != NULL) {
        status = open_test_log(job);
    }
    status = status != 0 ? status : fit_take_known_forces(job);
    status = status != 0 ? status : survey_all(job);
    status = status != 0 ? status : fit_check_known_forces(job);
    status = status != 0 ? status : examine_logs(job);
    if (status == 0 && job->logs_left_out > 0) {
        survey_end(&job->survey);
        survey_end(&job->test_survey);
        status = survey_all(job);
    }
    if (status == 0) {
        find_excited(job);
    }
    return status;
}

int fit_use_map(job_t *job, thrust_map_kind_t kind)
{
    int status = 0;
    (void)log_use_map(&job->use, kind);
    memset(job->survey.largest, 0, sizeof job->survey.largest);
    for (int i = 0; i < job->train.logs && status == 0; ++i) {
        status = survey_inputs(&job->survey, &job->log[i], &job->use);
    }
    find_excited(job);
    return status;
}

void fit_close_logs(job_t *job)
{
    for (int i = 0; i < OPTIONS_LOGS; ++i) {
        csv_close(&job->log[i].csv);
    }
    csv_close(&job->test_log.csv);
    survey_end(&job->survey);
    survey_end(&job->test_survey);
}
