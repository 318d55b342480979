/*
 * The logs of a fit: which inputs they have, and which degrees of freedom these excite.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "fit.h"
#include "report_error.h"

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

/* Has the log inputs of this kind? */
static bool has_inputs(const csv_log_t *log, const job_t *job, input_kind_t kind)
{
    const log_use_t use = {.kind = kind};
    int first = log_inputs(&use);
    return log_has_thrusters(&use) ? has_thrusters(log, first)
                                   : has_dofs(log, job->options->model, first);
}

/* Does the input act in this DoF? */
static bool acts(const job_t *job, const csv_log_t *log, int j)
{
    const log_use_t *use = &job->use;
    if (!log_has_thrusters(use)) {
        return log->has[log_inputs(use) + j];
    }
    bool any = false;
    for (int k = 0; k < use->thrusters->cfg.thrusters; ++k) {
        any = any || fabs((double)use->thrusters->cfg.thruster[k].wrench[j]) > 0.0;
    }
    return any && (use->thrusters->cfg.dofs == 0 || (use->thrusters->cfg.dofs >> j & 1u) != 0);
}

static int no_inputs(const job_t *job, const csv_log_t *log)
{
    bool six = job->options->model->columns[AUVID_ROLL] != 0;
    return report_error("%s:1:1: no input column (X_N Y_N Z_N %sN_Nm, or cmd_surge cmd_sway "
                        "cmd_heave %scmd_yaw) in the header",
                        log->path, six ? "K_Nm M_Nm " : "", six ? "cmd_roll cmd_pitch " : "");
}

/* Each thruster of the vehicle needs its column, and there may be no other. */
static int check_thrusters(const job_t *job, const csv_log_t *log)
{
    const vehicle_t *vehicle = job->options->thrusters;
    int first = log_inputs(&job->use), thrusters = job->allocation.cfg.thrusters;
    char why[80];
    (void)snprintf(why, sizeof why, ": %s has %d thrusters", vehicle->word, thrusters);
    for (int k = 0; k < CSV_THRUSTERS; ++k) {
        if (k < thrusters && !log->has[first + k]) {
            return csv_missing(log, first + k, why);
        }
        if (k >= thrusters && log->has[first + k]) {
            return report_error("%s:%zu:1: there is a column %s%s", log->path, log->header,
                                csv_name[first + k], why);
        }
    }
    return 0;
}

/* Takes the chosen thrusters. Their own forces or commands come before the wrench. */
static int take_thrusters(job_t *job, const csv_log_t *log)
{
    const vehicle_t *vehicle = job->options->thrusters;
    bool newtons = has_thrusters(log, CSV_THRUSTER_N);
    bool thrusters = newtons || has_thrusters(log, CSV_THRUSTER);
    if (vehicle == NULL) {
        return 0;
    }
    if (auvid_allocation_init(&job->allocation, vehicle->allocation) != AUVID_OK) {
        return report_error("fit: the thrusters of %s cannot be used", vehicle->word);
    }
    job->use.thrusters = &job->allocation;
    if (thrusters) {
        job->use.kind = newtons ? INPUT_THRUST : INPUT_THRUSTER_COMMAND;
        return 0;
    }
    return job->use.kind == INPUT_COMMAND
               ? report_error("fit: --thrusters needs forces and moments (X_N ..), or thruster_1 "
                              ".., not commands of the axes (cmd_*)")
               : 0;
}

/* Finds the inputs of the first log. */
static int find_inputs(job_t *job)
{
    const csv_log_t *log = &job->log[0].csv;
    bool wrench = has_inputs(log, job, INPUT_WRENCH), command = has_inputs(log, job, INPUT_COMMAND);
    bool thrusters = has_thrusters(log, CSV_THRUSTER) || has_thrusters(log, CSV_THRUSTER_N);
    job->use.kind = wrench || !command ? INPUT_WRENCH : INPUT_COMMAND;
    int status = take_thrusters(job, log);
    if (status != 0 || log_has_thrusters(&job->use)) {
        return status;
    }
    if (!wrench && !command) {
        return thrusters ? report_error("%s: the inputs are those of thrusters: name the vehicle "
                                        "with --thrusters (%s)",
                                        log->path, vehicle_words)
                         : no_inputs(job, log);
    }
    return job->options->has_gain && job->use.kind != INPUT_COMMAND
               ? report_error("%s: --gain needs commands (cmd_*), but the log has forces",
                              log->path)
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
                           of != NULL ? of : csv_name[log_inputs(&job->use) + j],
                           j <= AUVID_HEAVE ? "force" : "moment",
                           j <= AUVID_HEAVE ? "velocity" : "rate");
            return csv_missing(log, CSV_NU + j, why);
        }
    }
    return 0;
}

/* Each command in use needs its gain. */
static int check_gains(const job_t *job, const csv_log_t *log)
{
    for (int j = 0; j < AUVID_DOF_COUNT && job->options->has_gain; ++j) {
        if (job->options->model->columns[j] != 0 && acts(job, log, j) &&
            !(job->options->gain[j] > 0.0)) {
            return report_error("%s: %s has no gain: give it too, as in --gain %s=40", log->path,
                                csv_name[CSV_COMMAND + j], csv_name[CSV_COMMAND + j] + 4);
        }
    }
    return 0;
}

/* Marks the known columns that are not used. */
static void ignore_unused(const job_t *job, csv_log_t *log)
{
    int inputs = log_inputs(&job->use);
    for (int c = CSV_WRENCH; c < CSV_COLUMNS; ++c) {
        bool used = (c >= inputs && c < inputs + log_input_count(&job->use)) ||
                    (c >= CSV_REFERENCE && c < CSV_REFERENCE + AUVID_DOF_COUNT) ||
                    (c >= CSV_QUATERNION && c < CSV_POSITION);
        if (log->has[c] && !used) {
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
    int status = log_has_thrusters(&job->use) ? check_thrusters(job, log) : 0;
    status = status != 0 ? status : check_velocities(job, log);
    status = status != 0 ? status : check_gains(job, log);
    ignore_unused(job, log);
    return status;
}

/* Opens a log after the first one: its inputs must be of the same kind. */
static int open_further(job_t *job, log_t *log, const char *path)
{
    int status = csv_open(&log->csv, path);
    if (status == 0 && !has_inputs(&log->csv, job, job->use.kind)) {
        status = report_error("%s:1:1: no input column of the same kind as in %s (%s ..)", path,
                              job->log[0].csv.path, csv_name[log_inputs(&job->use)]);
    }
    return status != 0 ? status : check_columns(job, &log->csv);
}

/* ---- what is excited ---- */

/* Commands that never exceed a newton, or forces of the wrong unit. */
static int check_thrust(const job_t *job, const survey_t *survey)
{
    double most = 0.0;
    for (int k = 0; k < job->allocation.cfg.thrusters; ++k) {
        most = fmax(most, (double)job->allocation.cfg.thruster[k].max_N);
    }
    if (job->use.kind == INPUT_THRUST && survey->largest_thrust > 2.0 * most) {
        return report_error("%s: a thruster has %.4g N, but those of %s have at most %.4g N",
                            job->log[0].csv.path, survey->largest_thrust,
                            job->options->thrusters->word, most);
    }
    if (job->use.kind == INPUT_THRUSTER_COMMAND && survey->largest_thrust > 1.0 + 1e-6) {
        return report_error("%s: a command of a thruster is %.4g, but they are parts of the "
                            "largest one, within +-1. Name columns in newtons thruster_1_N ..",
                            job->log[0].csv.path, survey->largest_thrust);
    }
    return 0;
}

/* Finds the DoF that can be identified, and the largest values of their inputs. */
static void find_excited(job_t *job)
{
    const double *largest = job->survey.largest;
    double max_input = 0.0;
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
        } else if (job->options->model->columns[j] != 0 && !(largest[j] > NEGLIGIBLE * max_input)) {
            job->why[j] = "input is always zero";
        } else if (job->options->model->columns[j] != 0) {
            job->use.dofs = (uint8_t)(job->use.dofs | 1u << j);
        }
        bool used = (job->use.dofs >> j & 1u) != 0;
        job->tau_max[j] = used ? (auvid_real_t)largest[j] : AUVID_C(1.0);
    }
}

static int survey_all(job_t *job)
{
    survey_t test;
    int status = survey_begin(&job->survey, job->options->max_gap_s);
    for (int i = 0; i < job->train.logs && status == 0; ++i) {
        status = survey_read(&job->survey, &job->log[i], &job->use);
    }
    status = status != 0 ? status : check_thrust(job, &job->survey);
    if (status == 0 && job->test.logs > 0) {
        status = survey_begin(&test, job->options->max_gap_s);
        status = status != 0 ? status : survey_read(&test, &job->test_log, &job->use);
        survey_end(&test);
    }
    return status;
}

int fit_read_logs(job_t *job)
{
    const options_t *options = job->options;
    job->train = (log_set_t){job->log, options->trains};
    job->test = (log_set_t){&job->test_log, options->validate != NULL};
    memcpy(job->use.gain, options->gain, sizeof job->use.gain);
    int status = csv_open(&job->log[0].csv, options->train[0]);
    status = status != 0 ? status : find_inputs(job);
    status = status != 0 ? status : check_columns(job, &job->log[0].csv);
    for (int i = 1; i < options->trains && status == 0; ++i) {
        status = open_further(job, &job->log[i], options->train[i]);
    }
    if (status == 0 && options->validate != NULL) {
        status = open_further(job, &job->test_log, options->validate);
    }
    status = status != 0 ? status : survey_all(job);
    if (status == 0) {
        find_excited(job);
    }
    return status;
}

void fit_close_logs(job_t *job)
{
    for (int i = 0; i < OPTIONS_LOGS; ++i) {
        csv_close(&job->log[i].csv);
    }
    csv_close(&job->test_log.csv);
    survey_end(&job->survey);
}
