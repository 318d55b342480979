/*
 * auvid fit: identifies a vehicle from recorded logs, with the recorder, metric and optimizer that
 * run on board.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../commands.h"
#include "fit.h"
#include "heldout.h"
#include "../report/html.h"
#include "../report/report.h"
#include "../base/report_error.h"

/* Exit statuses beside 0, at least one parameter or drag force is identifiable, and EXIT_REFUSED,
 * bad usage. */
enum { EXIT_LOG_REFUSED = 1, EXIT_NOTHING = 3 };

/* The first error of the logs that are used, or NULL. */
static const char *first_error(const job_t *job)
{
    const report_findings_t *findings = &job->findings;
    for (int i = 0; i < findings->count && job->logs_left_out == 0; ++i) {
        if (findings->at[i].error) {
            return findings->at[i].sentence;
        }
    }
    return NULL;
}

/* The sentence on the gaps between velocities, if most of a log is lost to them; else NULL. */
static const char *velocity_gaps(const job_t *job)
{
    const report_findings_t *findings = &job->findings;
    for (int i = 0; i < findings->count && job->velocity_gaps; ++i) {
        if (strcmp(findings->at[i].code, "velocity_gaps") == 0) {
            return findings->at[i].sentence;
        }
    }
    return NULL;
}

/* Are the logs that are used wrong? If one is, all are: see fit_read_logs. */
static bool has_wrong_log(const job_t *job)
{
    return job->log[0].wrong;
}

/* Is nothing left to identify, because of velocities that are left out? */
static bool has_no_velocity(const job_t *job)
{
    return job->use.dofs == 0 && job->left_out != 0;
}

/* Why nothing can be trusted. */
static const char *why_nothing(const job_t *job, const result_t *result,
                               const auvid_identifier_t *id)
{
    const char *error = first_error(job);
    if (error != NULL) {
        return error;
    }
    if (has_no_velocity(job)) {
        return "the velocities are too coarse, or stuck";
    }
    if (result->estimate.number == 0 || result->estimate.identified == 0) {
        return job->velocity_gaps ? "velocities are too far apart: see missing"
                                  : "no input varies enough in an unbroken part of the log";
    }
    if (result->estimate.not_converged) {
        return "the search did not converge";
    }
    if (report_is_contradicted(result)) {
        return "the motion contradicts the inputs: see wrong inputs";
    }
    if (result->calibration == REPORT_CONTRADICTED) {
        return "the known force contradicts the motion: see thrust";
    }
    if (!id->exact_inputs && id->attached.uncertain == NULL) {
        return "the errors of thrust and sensors are not examined: see --thrusters, --plain";
    }
    return "no parameter meets its limit: see missing";
}

/* Writes the exit status in words. Returns the status. */
static int conclude(job_t *job, const result_t *result, const auvid_identifier_t *id)
{
    size_t size = sizeof job->verdict;
    char drag[64];
    bool converged = !result->estimate.not_converged;
    int sure = converged ? report_identifiable(&result->estimate) : 0, all = 0;
    int drags = converged ? report_known_drag(result, drag, sizeof drag) : 0;
    for (int i = 0; i < result->vehicle->parameters; ++i) {
        all += (int)(result->free >> i & 1u);
    }
    if (sure > 0) {
        (void)snprintf(job->verdict, size, "%d of %d parameters identified", sure, all);
    } else if (drags > 0) {
        (void)snprintf(job->verdict, size,
                       "no single parameter identified, but the drag force in %s", drag);
    } else {
        (void)snprintf(job->verdict, size, "nothing identified: %s", why_nothing(job, result, id));
    }
    return sure + drags > 0 ? 0 : EXIT_NOTHING;
}

/* The degrees of freedom in which the estimate predicts a held-out log worse than its mean does. */
static void print_unpredicted(const result_t *result)
{
    const char *before = "does not predict the held-out log in ";
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT && result->has_interval; ++j) {
        if ((result->validated >> j & 1u) != 0 && result->r2_high[j] < 0.0) {
            printf("%s%s", before, report_dof_name[j]);
            before = ", ";
            any = true;
        }
    }
    fputs(any ? " (R2 of the velocity below 0)\n" : "", stdout);
}

static const char *input_words(const job_t *job)
{
    static const char *const words[] = {"forces and moments", "commands (cmd_*)",
                                        "forces of the thrusters", "commands of the thrusters"};
    return job->use.kind == INPUT_COMMAND && job->options->has_gain
               ? "commands (cmd_*), in newtons by --gain"
               : words[job->use.kind];
}

static void print_inputs(const job_t *job, const auvid_identifier_t *id)
{
    printf("  inputs   %s, %s\n", input_words(job),
           job->options->linear_input ? "interpolated linearly between rows"
                                      : "held until the next row");
    for (int i = 0; i < job->train.logs + job->test.logs; ++i) {
        if (fabs(job->shift_s[i]) > 0.0) {
            printf("           %s: they act %.1f s %s than logged\n",
                   (i < job->train.logs ? &job->log[i] : &job->test_log)->csv.path,
                   fabs(job->shift_s[i]), job->shift_s[i] > 0.0 ? "later" : "earlier");
        }
    }
    if (fit_in_commands(job)) {
        printf("           Parameters are in units of command (cmd). Multiply them by the newtons\n"
               "           (yaw: newton metres) of one unit of command to get SI units.\n");
        if (job->options->coupling != COUPLING_OFF) {
            printf("           Coupling terms assume the same unit in all degrees of freedom.\n");
        }
    }
    fit_print_maps(&job->maps);
    if (!id->exact_inputs && id->attached.uncertain == NULL) {
        printf("           Their errors are not examined: see --thrusters, --plain\n");
    }
}

/* The current in words, if it is identified. */
static void print_current(const job_t *job, const result_t *result)
{
    int north = result->vehicle->parameters - 2;
    if (!job->options->current || !report_is_identified(result, north) ||
        !report_is_identified(result, north + 1)) {
        return;
    }
    const double degrees = 57.29577951308232;
    double c[2] = {(double)result->estimate.pi[north], (double)result->estimate.pi[north + 1]};
    printf(
        "  current  %.3f m/s, flows towards %.0f degrees (+- 95 %%: c_north %.3f, c_east %.3f)\n",
        hypot(c[0], c[1]), fmod(degrees * atan2(c[1], c[0]) + 360.0, 360.0),
        HALF_WIDTH * report_sigma(result, north), HALF_WIDTH * report_sigma(result, north + 1));
}

static void print_heading(const job_t *job, const auvid_identifier_t *id, const result_t *result)
{
    const survey_t *survey = &job->survey;
    double set_s =
        1e-6 * id->recorder.cfg.cell_us * id->metric.cfg.row_cells * id->metric.cfg.set_rows;
    printf("auvid %s fit: %s", AUVID_VERSION_STRING, job->log[0].csv.path);
    for (int i = 1; i < job->train.logs; ++i) {
        printf(", %s", job->log[i].csv.path);
    }
    printf("\n  log      %zu rows in %.0f s, %zu gap%s over %g s\n", survey->rows, survey->span_s,
           survey->gaps, survey->gaps == 1 ? "" : "s", survey->gap_s);
    if (job->logs_left_out > 0) {
        printf("           left out, because of errors: %d more\n", job->logs_left_out);
    }
    if (result->log.changed_path != NULL) {
        printf("           the vehicle changed: only what follows t_s %.1f of %s is in the "
               "estimate\n",
               result->log.changed_s, result->log.changed_path);
    }
    print_inputs(job, id);
    printf("  metric   %s, %u set%s of at most %.0f s\n",
           job->options->literal ? "literal smoothing of the paper: smoothed states, raw wrench"
                                 : "states and wrench smoothed with the same filter",
           (unsigned)id->metric.sets.recorded, id->metric.sets.recorded == 1 ? "" : "s", set_s);
    printf("  model    %s\n", id->metric.cfg.vehicle->name);
    if (job->error[0] >= 0.0 && job->error[1] >= 0.0) {
        printf("           chosen by cross-validation: rms residual %.4f coupled, %.4f decoupled,\n"
               "           relative to the largest input\n",
               sqrt(job->error[0]), sqrt(job->error[1]));
    }
    print_current(job, result);
    putchar('\n');
}

/* The ring of sets holds the newest part of very long logs. */
static void warn_too_long(const job_t *job, const auvid_identifier_t *id)
{
    const auvid_metric_config_t *cfg = &id->metric.cfg;
    double row_s = 1e-6 * id->recorder.cell_us * cfg->row_cells;
    if (id->metric.sets.recorded > cfg->sets) {
        report_warning("%s: only about the last %.1f of %.1f hours are in the estimate, which "
                       "holds %u rows of %g s: fit parts of the log",
                       job->log[job->train.logs - 1].csv.path,
                       row_s * cfg->sets * cfg->set_rows / 3600.0, job->survey.span_s / 3600.0,
                       (unsigned)cfg->sets * cfg->set_rows, row_s);
    }
}

/* What the report says of the logs. */
static void gather_logs(const job_t *job, const replay_inputs_t *inputs, result_t *result)
{
    const survey_t *survey = &job->survey, *held_out = &job->test_survey;
    const csv_log_t *test = &job->test_log.csv;
    result->log = (report_log_t){.path = job->path,
                                 .paths = job->train.logs,
                                 .shift_s = job->shift_s,
                                 .rows = survey->rows,
                                 .duration_s = survey->span_s,
                                 .velocity_s = 1e-6 * survey_velocity_us(survey),
                                 .gaps = survey->gaps,
                                 .gap_s = survey->gap_s};
    for (int i = 0; i < job->train.logs && inputs->changed_us > 0; ++i) {
        const log_t *log = &job->log[i];
        if (log->start_us <= inputs->changed_us) { /* the last one that began before */
            result->log.changed_path = log->csv.path;
            result->log.changed_s =
                log->csv.first_s + 1e-6 * (double)(inputs->changed_us - log->start_us);
        }
    }
    if (job->options->validate != NULL) {
        result->held_out = (report_log_t){.path = &job->options->validate,
                                          .paths = 1,
                                          .shift_s = job->shift_s + job->train.logs,
                                          .rows = test->rows,
                                          .duration_s = test->last_s - test->first_s,
                                          .velocity_s = 1e-6 * survey_velocity_us(held_out),
                                          .gaps = held_out->gaps,
                                          .gap_s = held_out->gap_s};
    }
    result->wrong_log = has_wrong_log(job);
    result->trace = &job->trace;
    result->findings = &job->findings;
    result->maps = job->maps.count > 0 ? &job->maps : NULL;
    result->remedy = job->remedy[0] != '\0' ? job->remedy : NULL;
}

/* A lever arm in [mount] does not cure a log: the filter on board subtracts it, fit does not. */
static void warn_lever_arm(const job_t *job, const result_t *result)
{
    char text[300];
    for (unsigned k = 0; report_cause(result, k, text, sizeof text); ++k) {
        if (strstr(text, "lever arm") != NULL) {
            report_warning("%s: for a lever arm of the DVL, subtract omega x arm from the "
                           "velocities of the log ([mount] is for the filter on board)",
                           job->log[0].csv.path);
            return;
        }
    }
}

/* What must be done before any other advice. */
static void find_remedy(job_t *job, const auvid_identifier_t *id)
{
    const survey_t *survey = &job->survey;
    const auvid_estimate_t *e = auvid_identifier_estimate(id);
    bool empty = id->metric.sets.recorded == 0 && job->use.dofs != 0;
    const char *words = "", *velocity = velocity_gaps(job);
    if (empty && survey->gaps == 0 && survey->input_gaps > 0) {
        (void)snprintf(job->remedy, sizeof job->remedy,
                       "the log: inputs are up to %.2f s apart, %g s are bridged: log them at 5 Hz "
                       "or faster%s, or give --hold-inputs if the log has them only where they "
                       "change",
                       survey->input_s, survey->gap_s,
                       survey->input_s < 1.0 ? ", give a longer --max-gap" : "");
        return;
    }
    if (empty && velocity != NULL) {
        (void)snprintf(job->remedy, sizeof job->remedy, "the log: %s", velocity);
        return;
    }
    if (has_no_velocity(job)) {
        words = "the log: log the measured velocities, with all digits";
    } else if (empty) {
        words = survey->gaps > 0 ? "the log: record a row every 0.2 s or more often, without gaps"
                                 : "the log: record for longer";
    } else if (has_wrong_log(job) ||
               (first_error(job) != NULL && (e == NULL || report_identifiable(e) == 0))) {
        words = "the log: correct its errors first";
    }
    (void)snprintf(job->remedy, sizeof job->remedy, "%s", words);
}

/* Where the motion contradicts the inputs, no number is worth other advice. */
static void ask_for_inputs(const job_t *job, result_t *result)
{
    bool maps = job->options->map == MAP_AS_TOLD && fit_has_maps(job);
    if (report_is_contradicted(result) && result->remedy == NULL) {
        result->remedy = maps ? "the inputs: correct them first; compare thrust maps: --map auto"
                              : "the inputs: correct them first";
    }
}

static void gather(const job_t *job, const fitted_t *fitted, result_t *result)
{
    const auvid_identifier_t *id = &fitted->id;
    report_gather(result, id, job->options->seed);
    gather_logs(job, &fitted->inputs, result);
    result->in_commands = fit_in_commands(job);
    result->has_loop_option = true;
    result->left_out = job->left_out;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool excited = (id->estimate.excited >> j & 1u) != 0;
        result->why[j] = job->why[j];
        if (!excited && job->why[j] == NULL) {
            result->why[j] = id->metric.sets.recorded > 0 ? "input hardly varies"
                             : job->velocity_gaps         ? "velocities are too far apart"
                             : job->survey.gaps > 0       ? "no 6 s without a gap in the log"
                             : job->survey.input_gaps > 0 ? "inputs are too far apart"
                                                          : "the log is too short";
        }
    }
}

/* Nothing was identified: the error is the result. Returns the status. */
static int refuse(const job_t *job, int status)
{
    if (job->options->json) {
        report_error_json();
    }
    return status;
}

static int run(job_t *job)
{
    const options_t *options = job->options;
    result_t result;
    if (fit_choose_free(job) != 0) {
        return refuse(job, EXIT_REFUSED);
    }
    int refused = fit_read_logs(job);
    refused = refused != 0 ? refused : fit_check_bounds(job);
    refused = refused != 0 ? refused : fit_choose_map(job);
    fitted_t *fitted = refused == 0 ? fit_choose_model(job) : NULL;
    if (fitted == NULL) {
        return refuse(job, EXIT_LOG_REFUSED);
    }
    const auvid_identifier_t *id = &fitted->id;
    find_remedy(job, id);
    gather(job, fitted, &result);
    ask_for_inputs(job, &result);
    warn_too_long(job, id);
    warn_lever_arm(job, &result);
    if (job->known_force) { /* before the model gets the forces of the held-out log */
        report_calibrate(&result, &fitted->calibrated);
        job->use.calibrated = &fitted->calibrated;
    }
    if (options->validate != NULL && result.estimate.number > 0 &&
        heldout_r2(&job->test, &job->use, id, options->seed, &job->trace, &result) != 0) {
        return refuse(job, EXIT_LOG_REFUSED);
    }
    if (result.wrong_log) { /* last: report_calibrate judges again */
        result.estimate.confidence.identifiable = 0;
    }
    int status = conclude(job, &result, id);
    result.verdict = job->verdict;
    if (options->json) {
        report_json(stdout, &result, NULL, NULL, NULL);
    } else {
        puts(job->verdict);
        print_unpredicted(&result);
        print_heading(job, id, &result);
        report_result(&result, NULL);
    }
    return report_html(options, &result, NULL) == 0 ? status : EXIT_REFUSED;
}

int fit(const options_t *options)
{
    job_t *job = calloc(1, sizeof *job);
    if (job == NULL) {
        return report_error("fit: not enough memory");
    }
    job->options = options;
    fit_forget_models(job);
    int status = run(job);
    fit_close_logs(job);
    fit_forget_models(job);
    report_free_findings(&job->findings);
    free(job);
    return status;
}
