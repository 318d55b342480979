/*
 * auvid fit: identifies a vehicle from a recorded log, with the recorder, metric and optimizer that
 * run on board.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands.h"
#include "report_error.h"
#include "csv.h"
#include "heldout.h"
#include "literal.h"
#include "replay.h"
#include "report.h"
#include "statistics.h"
#include "units.h"

/* Rows further apart are a gap, after which a new record starts. */
#define GAP_US 500000u

/* Shortest set [rows of half a second]. Cross-validation leaves out one set at a time. */
#define SHORTEST_SET 20
/* Capacity of the ring in rows (metric_config.h). */
#define MAX_ROWS 60000u

/* Relative to the largest of all inputs. An input that stays below this value is rounding noise of
 * zero and does not count as excited. */
#define NEGLIGIBLE 1e-3

/* A model identified from a log. */
typedef struct {
    auvid_identifier_t id;
    auvid_validation_t prediction;
    auvid_change_detector_t change;
    replay_inputs_t inputs; /* if the thrusters are known, or there is a reference */
    literal_t literal;      /* if chosen */
} fitted_t;

/* A fit: logs, options and models. */
typedef struct {
    const options_t *options;
    csv_log_t train, test;
    size_t gaps; /* number of gaps in the training log */
    replay_t replay;
    auvid_real_t tau_max[AUVID_DOF_COUNT];
    uint32_t cell_us;                         /* length of the cells; 0: not chosen yet */
    uint32_t free;                            /* bit i: parameter i is identified */
    auvid_real_t fixed[AUVID_MAX_PARAMETERS]; /* values of the other parameters */
    const char *why[AUVID_DOF_COUNT];         /* why a DoF cannot be identified, or NULL */
    fitted_t *coupled, *decoupled;            /* NULL: not fitted */
    double error[2];                          /* cross-validation errors of the two; < 0: none */
} job_t;

/* ---- parameters to identify ---- */

/* Index of the parameter whose name ends at `end`, or -1 after a message. */
static int parameter_named(const auvid_vehicle_t *model, const char *name, const char *end)
{
    size_t length = (size_t)(end - name);
    for (int i = 0; i < model->parameters; ++i) {
        const char *known = model->parameter[i].name;
        if (strlen(known) == length && strncmp(known, name, length) == 0) {
            return i;
        }
    }
    report_error_line("fit: '%.*s' is not a parameter of the model %s", (int)length, name,
                      model->name);
    return -1;
}

/* Mask of the constant force or moment in each DoF except heave, whose constant is W-B. */
static uint32_t bias_of(const auvid_vehicle_t *model)
{
    uint32_t mask = 0;
    for (int i = 0; i < model->parameters; ++i) {
        const char *name = model->parameter[i].name;
        mask |= (uint32_t)(strcmp(name + 1, "_0") == 0 && name[0] != 'Z') << i;
    }
    return mask;
}

/* Applies one --fix or --free. */
static int take_choice(job_t *job, const char *text)
{
    const char *value = strchr(text, '='), *end = NULL;
    for (const char *name = text; *name != '\0'; name = *end == ',' ? end + 1 : end) {
        end = value != NULL ? value : name + strcspn(name, ",");
        int i = parameter_named(job->options->model, name, end);
        if (i < 0) {
            return EXIT_REFUSED;
        }
        job->free |= 1u << i;
        if (value != NULL) {
            char *rest = NULL;
            double x = strtod(value + 1, &rest);
            if (rest == value + 1 || *rest != '\0' || !(fabs(x) <= 1e6)) {
                return report_error("fit: --fix: '%s' is not a number within +-1e6", value + 1);
            }
            job->free &= ~(1u << i);
            job->fixed[i] = (auvid_real_t)x;
            return 0;
        }
    }
    return 0;
}

static int choose_free(job_t *job)
{
    const options_t *options = job->options;
    int status = 0;
    job->free = options->model->free | (options->bias ? bias_of(options->model) : 0u);
    for (int k = 0; k < options->choices && status == 0; ++k) {
        status = take_choice(job, options->choice[k]);
    }
    return status == 0 && job->free == 0
               ? report_error("fit: no parameter is left to identify: fix fewer of them")
               : status;
}

/* ---- contents of the log ---- */

static bool has_inputs(const csv_log_t *log, const auvid_vehicle_t *model, input_kind_t kind)
{
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        any = any || (model->columns[j] != 0 && log->has[replay_inputs(kind) + j]);
    }
    return any;
}

/* Checks that the log has the velocity of each force, and the rate of each moment. */
static int check_columns(const csv_log_t *log, const job_t *job)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int input = replay_inputs(job->replay.kind) + j;
        if (job->options->model->columns[j] != 0 && log->has[input] && !log->has[CSV_NU + j]) {
            char why[80];
            (void)snprintf(why, sizeof why, ", but %s: a %s needs its %s", csv_name[input],
                           j <= AUVID_HEAVE ? "force" : "moment",
                           j <= AUVID_HEAVE ? "velocity" : "rate");
            return csv_missing(log, CSV_NU + j, why);
        }
    }
    return units_check(log);
}

/* Reports the unused columns of a log. */
static void warn_unused(csv_log_t *log, input_kind_t kind)
{
    int other = replay_inputs(kind == INPUT_WRENCH ? INPUT_COMMAND : INPUT_WRENCH);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (log->has[other + j]) {
            csv_ignore(log, other + j);
        }
    }
    csv_notes(log);
}

static int find_inputs(job_t *job)
{
    const csv_log_t *log = &job->train;
    const auvid_vehicle_t *model = job->options->model;
    bool wrench = has_inputs(log, model, INPUT_WRENCH);
    if (!wrench && !has_inputs(log, model, INPUT_COMMAND)) {
        bool six = model->columns[AUVID_ROLL] != 0;
        return report_error("%s:1:1: no input column (X_N Y_N Z_N %sN_Nm, or cmd_surge cmd_sway "
                            "cmd_heave %scmd_yaw) in the header",
                            log->path, six ? "K_Nm M_Nm " : "", six ? "cmd_roll cmd_pitch " : "");
    }
    job->replay.kind = wrench ? INPUT_WRENCH : INPUT_COMMAND;
    return check_columns(log, job);
}

/* Takes the chosen thrusters. */
static int take_thrusters(job_t *job)
{
    const vehicle_t *vehicle = job->options->thrusters;
    if (vehicle != NULL && job->replay.kind == INPUT_COMMAND) {
        return job->options->whole
                   ? report_error("fit: --vehicle needs forces and moments (X_N ..), not commands; "
                                  "--model takes the vehicle's model alone")
                   : report_error(
                         "fit: --thrusters needs forces and moments (X_N ..), not commands");
    }
    job->replay.thrusters = vehicle;
    return 0;
}

/* Finds the DoF that can be identified, and the largest values of their inputs. */
static void find_excited(job_t *job)
{
    const csv_log_t *log = &job->train;
    double max_input = 0.0, largest[AUVID_DOF_COUNT] = {0};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int input = replay_inputs(job->replay.kind) + j;
        for (size_t i = 0; i < log->rows; ++i) {
            largest[j] = fmax(largest[j], fabs(log->row[i].value[input]));
        }
        max_input = fmax(max_input, largest[j]);
    }
    for (size_t i = 1; i < log->rows; ++i) {
        job->gaps += replay_time_us(log, i) - replay_time_us(log, i - 1) > GAP_US;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (job->options->model->columns[j] == 0) {
            continue;
        }
        if (!log->has[replay_inputs(job->replay.kind) + j]) {
            job->why[j] = "no input column";
        } else if (!(largest[j] > NEGLIGIBLE * max_input)) {
            job->why[j] = "input is always zero";
        } else {
            job->replay.dofs = (uint8_t)(job->replay.dofs | 1u << j);
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        job->replay.reference |= log->has[CSV_REFERENCE + j] && !job->options->literal;
        bool used = (job->replay.dofs >> j & 1u) != 0;
        job->tau_max[j] = used ? (auvid_real_t)largest[j] : AUVID_C(1.0);
    }
}

static int read_logs(job_t *job)
{
    const options_t *options = job->options;
    int status = csv_read(&job->train, options->train);
    status = status != 0 ? status : find_inputs(job);
    status = status != 0 ? status : take_thrusters(job);
    if (status == 0 && options->validate != NULL) {
        status = csv_read(&job->test, options->validate);
        if (status == 0 && !has_inputs(&job->test, options->model, job->replay.kind)) {
            status = report_error("%s:1:1: no input column of the same kind as in %s (%s)",
                                  options->validate, options->train,
                                  job->replay.kind == INPUT_WRENCH ? "X_N .." : "cmd_surge ..");
        }
        status = status != 0 ? status : check_columns(&job->test, job);
    }
    return status;
}

/* ---- identification ---- */

/* Median time between rows [us], or 0 if there is no memory. */
static double row_interval_us(const csv_log_t *log)
{
    double *interval = malloc(log->rows * sizeof *interval);
    double median = 0.0;
    if (interval != NULL) {
        for (size_t i = 1; i < log->rows; ++i) {
            interval[i - 1] = (double)(replay_time_us(log, i) - replay_time_us(log, i - 1));
        }
        median = statistics_quantile(interval, log->rows - 1, 0.5);
        free(interval);
    }
    return median;
}

/* Velocity is sampled at the times of the rows. Only if these are further apart than the cells is
 * it interpolated. */
static void set_velocity_time(const job_t *job, auvid_identifier_config_t *cfg)
{
    double interval = fmin(row_interval_us(&job->train), GAP_US);
    cfg->metric.velocity_us = interval >= cfg->recorder.cell_us ? (uint32_t)interval : 0u;
}

/* Sets the length of the cells. The first model chooses it for both, so that their errors compare.
 * Three of the shortest sets fit in the log. */
static void set_cells(const job_t *job, double span_us, auvid_identifier_config_t *cfg)
{
    double longest = span_us / (3.0 * SHORTEST_SET * cfg->metric.row_cells);
    cfg->metric.max_cell_us = (uint32_t)fmin(longest, cfg->metric.max_cell_us);
    if (job->cell_us > 0) {
        cfg->recorder.cell_us = job->cell_us;
    }
    if (job->coupled != NULL) {
        cfg->metric.max_cell_us = 0;
    }
}

static void configure(const job_t *job, const auvid_vehicle_t *vehicle,
                      auvid_identifier_config_t *cfg)
{
    const options_t *options = job->options;
    double span_us =
        (double)(replay_time_us(&job->train, job->train.rows - 1) - replay_time_us(&job->train, 0));
    auvid_identifier_defaults(cfg, vehicle);
    set_cells(job, span_us, cfg);
    vehicle_use_averaged_model(cfg);
    cfg->search.seed = options->seed;
    cfg->dry_mass_kg = options->vehicle->dry_mass_kg;
    cfg->uncertainty = options->vehicle->uncertainty;
    if (job->replay.kind == INPUT_COMMAND) {
        cfg->uncertainty.thrust_scale = 0; /* the unit of a command has no scale error */
    }
    options_uncertainty(options, &cfg->uncertainty);
    cfg->exact_inputs = options->plain || options->literal;
    cfg->recorder.gap_us = cfg->recorder.cell_us > GAP_US ? cfg->recorder.cell_us : GAP_US;
    cfg->recorder.input = options->linear_input ? AUVID_INPUT_LINEAR : AUVID_INPUT_HOLD;
    memcpy(cfg->metric.tau_max, job->tau_max, sizeof job->tau_max);
    cfg->metric.free = job->free;
    memcpy(cfg->metric.fixed, job->fixed, sizeof job->fixed);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        cfg->search.lower[i] = (auvid_real_t)options->lower;
        cfg->search.upper[i] = (auvid_real_t)options->upper;
    }
    set_velocity_time(job, cfg);
    /* make the whole log fit the ring */
    double row_s = 1e-6 * cfg->recorder.cell_us * cfg->metric.row_cells;
    double rows = ceil((1e-6 * span_us / row_s + 1.0) / cfg->metric.sets);
    double max_rows = floor((double)MAX_ROWS / cfg->metric.sets);
    cfg->metric.set_rows = (uint16_t)fmin(fmax(rows, SHORTEST_SET), max_rows);
}

/* Feeds the log to an identifier with literal smoothing. Returns false if there is no memory. */
static bool replay_literal(const job_t *job, literal_t *literal, auvid_identifier_t *id)
{
    cells_t cells;
    if (!replay_record(&job->train, &job->replay, &id->recorder.cfg, &cells)) {
        return false;
    }
    for (size_t i = 0; i < cells.cells; ++i) {
        if (cells.cell[i].after_gap) {
            literal_cell(literal, id, NULL);
        }
        literal_cell(literal, id, &cells.cell[i].sample);
    }
    cells_free(&cells);
    (void)auvid_identifier_close(id);
    return true;
}

/* Replays the log with a model. Returns false after a message. */
static bool record(const job_t *job, const auvid_vehicle_t *vehicle, fitted_t *fitted)
{
    auvid_identifier_config_t cfg;
    bool literal = job->options->literal;
    auvid_status_t status = AUVID_OK;
    configure(job, vehicle, &cfg);
    if (literal) {
        status = literal_identifier(&fitted->literal, &cfg);
        literal_attach(&fitted->literal, &fitted->id.metric);
    }
    if (status < 0) {
        (void)report_error("fit: %s", auvid_status_str(status));
        return false;
    }
    status = auvid_identifier_init(&fitted->id, &cfg);
    if (status < 0) {
        (void)report_refused("fit", status, &fitted->id.refusal, &cfg);
        return false;
    }
    (void)auvid_identifier_attach_prediction(&fitted->id, &fitted->prediction);
    (void)auvid_identifier_attach_change_test(&fitted->id, &fitted->change);
    status = replay_attach(&job->replay, &fitted->inputs, &fitted->id);
    if (status < 0) {
        (void)report_error("fit: uncertain inputs: %s", auvid_status_str(status));
        return false;
    }
    if (!literal) {
        replay_identify(&job->train, &job->replay, &fitted->inputs, &fitted->id);
    } else if (!replay_literal(job, &fitted->literal, &fitted->id)) {
        (void)report_error("fit: not enough memory");
        return false;
    }
    return true;
}

/* Replays the log with a model and searches. If the metric asks for longer cells, the log is
 * replayed again. Returns NULL after a message. */
static fitted_t *identify(job_t *job, const auvid_vehicle_t *vehicle)
{
    bool literal = job->options->literal;
    auvid_status_t status;
    fitted_t *fitted = malloc(sizeof *fitted);
    if (fitted == NULL) {
        (void)report_error("fit: not enough memory");
        return NULL;
    }
    do {
        if (!record(job, vehicle, fitted)) {
            free(fitted);
            return NULL;
        }
        do {
            status = literal ? literal_work(&fitted->id, AUVID_DEFAULT_BUDGET)
                             : auvid_identifier_work(&fitted->id, AUVID_DEFAULT_BUDGET);
        } while (status == AUVID_PENDING);
        job->cell_us = fitted->id.recorder.cell_us;
    } while (fitted->id.metric.result.doublings > 0);
    return fitted;
}

/* Identifies the selected models. Returns the one to report, or NULL after a message. */
static fitted_t *choose(job_t *job)
{
    coupling_t coupling = job->options->coupling;
    bool alternative = job->options->model == &auvid_girona500 && coupling != COUPLING_ON;
    if (coupling != COUPLING_OFF) {
        job->coupled = identify(job, job->options->model);
        if (job->coupled == NULL || !alternative) {
            return job->coupled;
        }
    }
    job->decoupled = identify(job, &auvid_girona500_decoupled);
    if (job->decoupled == NULL || coupling == COUPLING_OFF) {
        return job->decoupled;
    }
    job->error[0] = heldout_cross_validation(&job->coupled->id.metric);
    job->error[1] = heldout_cross_validation(&job->decoupled->id.metric);
    bool decoupled = job->error[1] >= 0.0 && !(job->error[0] < job->error[1]);
    return decoupled ? job->decoupled : job->coupled;
}

/* ---- report ---- */

static void print_heading(const job_t *job, const auvid_identifier_t *id)
{
    const csv_log_t *log = &job->train;
    bool commands = job->replay.kind == INPUT_COMMAND;
    double span_s = log->row[log->rows - 1].value[CSV_T] - log->row[0].value[CSV_T];
    double set_s =
        1e-6 * id->recorder.cfg.cell_us * id->metric.cfg.row_cells * id->metric.cfg.set_rows;
    printf("auvid %s fit: %s\n", AUVID_VERSION_STRING, log->path);
    printf("  log      %zu rows in %.0f s, %zu gap%s over 0.5 s\n", log->rows, span_s, job->gaps,
           job->gaps == 1 ? "" : "s");
    printf("  inputs   %s, %s\n", commands ? "commands (cmd_*)" : "forces and moments",
           job->options->linear_input ? "interpolated linearly between rows"
                                      : "held until the next row");
    if (commands) {
        printf("           Parameters are in units of command (cmd). Multiply them by the newtons\n"
               "           (yaw: newton metres) of one unit of command to get SI units.\n");
        if (job->options->coupling != COUPLING_OFF) {
            printf("           Coupling terms assume the same unit in all degrees of freedom.\n");
        }
    }
    if (!id->exact_inputs && id->attached.uncertain == NULL) {
        printf("           Their errors are not examined: see --thrusters, --plain\n");
    }
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
    putchar('\n');
}

static void gather(const job_t *job, const auvid_identifier_t *id, result_t *result)
{
    report_gather(result, id, job->options->seed);
    result->in_commands = job->replay.kind == INPUT_COMMAND;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool excited = (id->estimate.excited >> j & 1u) != 0;
        result->why[j] = job->why[j];
        if (!excited && job->why[j] == NULL) {
            result->why[j] = id->metric.sets.recorded > 0 ? "input hardly varies"
                             : job->gaps > 0              ? "no 6 s without a gap in the log"
                                                          : "the log is too short";
        }
    }
}

static int run(job_t *job)
{
    const options_t *options = job->options;
    result_t result;
    int status = choose_free(job);
    status = status != 0 ? status : read_logs(job);
    if (status != 0) {
        return status;
    }
    warn_unused(&job->train, job->replay.kind);
    if (options->validate != NULL) {
        warn_unused(&job->test, job->replay.kind);
    }
    find_excited(job);
    const fitted_t *fitted = choose(job);
    if (fitted == NULL) {
        return EXIT_REFUSED;
    }
    const auvid_identifier_t *id = &fitted->id;
    gather(job, id, &result);
    if (job->options->validate != NULL && result.estimate.number > 0 &&
        !heldout_r2(&job->test, &job->replay, &id->recorder.cfg, job->options->seed, &result)) {
        return report_error("%s: not enough memory", job->options->validate);
    }
    if (job->options->json) {
        report_json(&result, NULL, NULL, NULL);
    } else {
        print_heading(job, id);
        report_result(&result, NULL);
    }
    return report_exit(&result);
}

int fit(const options_t *options)
{
    job_t job = {.options = options, .error = {-1.0, -1.0}};
    int status = run(&job);
    free(job.coupled);
    free(job.decoupled);
    csv_free(&job.train);
    csv_free(&job.test);
    return status;
}
