/*
 * The models of a fit: configuration, replay, search, choice by cross-validation.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fit.h"
#include "heldout.h"
#include "../report/report.h"
#include "../base/report_error.h"

/* Shortest set [rows of half a second]. Cross-validation leaves out one set at a time. */
#define SHORTEST_SET 20
/* Capacity of the ring in rows (metric_config.h). */
#define MAX_ROWS 60000u
/* Largest component of a current [m/s]. */
#define MAX_CURRENT AUVID_C(1.5)

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

int fit_choose_free(job_t *job)
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

double fit_velocity_gap_s(const job_t *job)
{
    const survey_t *survey = &job->survey;
    return velocity_gap_s(1e-6 * survey_velocity_us(survey),
                          survey->span_s / fmax((double)survey->rows, 1.0),
                          job->options->max_gap_s);
}

/* Velocity is sampled at the times of the rows. Only if these are further apart than the cells is
 * it interpolated. */
static void set_velocity_time(const job_t *job, auvid_identifier_config_t *cfg)
{
    double gap_us = 1e6 * fit_velocity_gap_s(job);
    double interval = fmin(survey_bridged_us(&job->survey, gap_us), fmin(gap_us, 1e6));
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
    if (job->coupled != NULL || job->same_cells) {
        cfg->metric.max_cell_us = 0;
    }
}

/* Puts the hull into a current. Its rows are means over row_cells. Returns the library's status. */
static auvid_status_t add_current(fitted_t *fitted, auvid_identifier_config_t *cfg)
{
    auvid_metric_config_t *metric = &cfg->metric;
    size_t rows = ((size_t)metric->sets + 1) * metric->set_rows;
    auvid_status_t status = auvid_current_init(&fitted->current, cfg->vehicle, false);
    free(fitted->rows);
    fitted->rows = status == AUVID_OK ? calloc(rows, sizeof *fitted->rows) : NULL;
    if (status != AUVID_OK) {
        return status;
    }
    int hull = cfg->vehicle->parameters;
    cfg->vehicle = metric->vehicle = &fitted->current.vehicle;
    metric->free |= UINT32_C(3) << hull;
    metric->rows = fitted->rows;
    metric->row_slots = (uint32_t)rows;
    return auvid_current_bounds(&fitted->current, MAX_CURRENT, cfg->search.lower,
                                cfg->search.upper);
}

double fit_dry_mass_kg(const job_t *job)
{
    const options_t *options = job->options;
    return options->dry_mass_kg > 0.0 ? options->dry_mass_kg
           : fit_in_commands(job)     ? 0.0
                                      : (double)options->vehicle->dry_mass_kg;
}

int fit_check_bounds(const job_t *job)
{
    double dry_kg = fit_dry_mass_kg(job), upper = job->options->upper;
    return job->options->has_bounds && dry_kg > 0.0 && !(dry_kg < upper)
               ? report_error("fit: the dry mass, %g kg, is not below the upper bound of the "
                              "masses, %g: widen --bounds, or leave it out",
                              dry_kg, upper)
               : 0;
}

static void set_bounds(const job_t *job, auvid_identifier_config_t *cfg)
{
    const options_t *options = job->options;
    vehicle_bounds(fit_dry_mass_kg(job), cfg);
    for (int i = 0; i < AUVID_MAX_PARAMETERS && options->has_bounds; ++i) {
        cfg->search.lower[i] = (auvid_real_t)options->lower;
        cfg->search.upper[i] = (auvid_real_t)options->upper;
    }
}

static void configure(const job_t *job, const auvid_vehicle_t *vehicle, decoupled_t *six,
                      auvid_identifier_config_t *cfg)
{
    const options_t *options = job->options;
    double span_us = (double)(job->survey.end_us - job->log[0].start_us);
    auvid_identifier_defaults(cfg, vehicle);
    set_cells(job, span_us, cfg);
    vehicle_use_averaged_model(cfg, options->current);
    if (job->options->coupling == COUPLING_OFF && decoupled_exists(vehicle)) {
        decoupled_init(six, cfg->vehicle, vehicle);
        cfg->vehicle = cfg->metric.vehicle = &six->vehicle;
    }
    cfg->search.seed = options->seed;
    cfg->dry_mass_kg = (auvid_real_t)fit_dry_mass_kg(job);
    cfg->uncertainty = options->vehicle->uncertainty;
    if (fit_in_commands(job)) {
        cfg->uncertainty.thrust_scale = 0; /* the unit of a command has no scale error */
    }
    options_uncertainty(options, &cfg->uncertainty);
    cfg->exact_inputs = options->plain || options->literal;
    cfg->metric.closed_loop = options->closed_loop;
    cfg->metric.open_loop = options->open_loop;
    cfg->recorder.gap_us =
        (uint32_t)fmax(cfg->recorder.cell_us, 1e6 * fit_velocity_gap_s(job) + 0.5);
    cfg->recorder.input = options->linear_input ? AUVID_INPUT_LINEAR : AUVID_INPUT_HOLD;
    memcpy(cfg->metric.tau_max, job->tau_max, sizeof job->tau_max);
    cfg->metric.free = job->free;
    memcpy(cfg->metric.fixed, job->fixed, sizeof job->fixed);
    set_bounds(job, cfg);
    set_velocity_time(job, cfg);
    /* make the whole log fit the ring */
    double row_s = 1e-6 * cfg->recorder.cell_us * cfg->metric.row_cells;
    double rows = ceil((1e-6 * span_us / row_s + 1.0) / cfg->metric.sets);
    double max_rows = floor((double)MAX_ROWS / cfg->metric.sets);
    cfg->metric.set_rows = (uint16_t)fmin(fmax(rows, SHORTEST_SET), max_rows);
}

/* Where cells with literal smoothing go. */
typedef struct {
    literal_t *literal;
    auvid_identifier_t *id;
} literal_cells_t;

static void take_literal(void *context, const auvid_sample_t *cell, bool after_gap)
{
    const literal_cells_t *to = context;
    if (after_gap) {
        literal_cell(to->literal, to->id, NULL);
    }
    literal_cell(to->literal, to->id, cell);
}

/* Feeds the logs to an identifier with literal smoothing. */
static int replay_literal(const job_t *job, fitted_t *fitted)
{
    literal_cells_t to = {&fitted->literal, &fitted->id};
    int status = replay_cells(&job->train, &job->use, &fitted->id.recorder.cfg, take_literal, &to);
    (void)auvid_identifier_close(&fitted->id);
    return status;
}

/* Replays the logs with a model, from a solution unless it is NULL. watches: there are estimates on
 * the way, and no set is given up for a change. Returns false after a message. */
static bool record(const job_t *job, const auvid_vehicle_t *vehicle, const auvid_uncertain_t *known,
                   bool watches, fitted_t *fitted)
{
    auvid_identifier_config_t cfg;
    bool literal = job->options->literal;
    auvid_status_t status = AUVID_OK;
    log_use_t use = job->use;
    configure(job, vehicle, &fitted->six, &cfg);
    if (job->options->current) {
        status = add_current(fitted, &cfg);
    }
    if (job->known_force) {
        use.calibrated = &fitted->calibrated;
        if (!fit_add_known_force(job, use.calibrated, &cfg)) {
            return false;
        }
    }
    if (literal && status == AUVID_OK) {
        status = literal_identifier(&fitted->literal, &cfg);
        literal_attach(&fitted->literal, &fitted->id.metric);
    }
    if (status < 0) {
        (void)report_error("fit: %s: %s", vehicle->name, auvid_status_str(status));
        return false;
    }
    status = auvid_identifier_init(&fitted->id, &cfg);
    if (status < 0) {
        (void)report_refused("fit", status, &fitted->id.refusal, &cfg);
        return false;
    }
    (void)auvid_identifier_attach_prediction(&fitted->id, &fitted->prediction);
    if (!watches) {
        (void)auvid_identifier_attach_change_test(&fitted->id, &fitted->change);
    }
    status = replay_attach(&use, &fitted->inputs, &fitted->id);
    if (status >= 0 && known != NULL) {
        status = auvid_uncertain_start(&fitted->inputs.uncertain, known);
    }
    if (status < 0) {
        (void)report_error("fit: uncertain inputs: %s", auvid_status_str(status));
        return false;
    }
    watches = watches || fitted->id.attached.uncertain != NULL;
    return (literal
                ? replay_literal(job, fitted)
                : replay_identify(&job->train, &use, &fitted->inputs, watches, &fitted->id)) == 0;
}

static void forget(fitted_t *fitted)
{
    if (fitted != NULL) {
        free(fitted->rows);
        free(fitted);
    }
}

/* Replays the logs with a model and searches. If the metric asks for longer cells, the logs are
 * replayed again. Returns NULL after a message. */
static fitted_t *search(job_t *job, const auvid_vehicle_t *vehicle, const auvid_uncertain_t *known,
                        bool watches)
{
    bool literal = job->options->literal;
    auvid_status_t status;
    fitted_t *fitted = calloc(1, sizeof *fitted);
    if (fitted == NULL) {
        (void)report_error("fit: not enough memory");
        return NULL;
    }
    do {
        if (!record(job, vehicle, known, watches, fitted)) {
            forget(fitted);
            return NULL;
        }
        do {
            status = literal ? literal_work(&fitted->id, AUVID_DEFAULT_BUDGET)
                             : auvid_identifier_work(&fitted->id, AUVID_DEFAULT_BUDGET);
        } while (status == AUVID_PENDING);
        replay_note_change(&fitted->inputs, &fitted->id, job->survey.end_us);
        job->cell_us = fitted->id.recorder.cell_us;
    } while (fitted->id.metric.result.doublings > 0);
    return fitted;
}

/* Does the estimate contain uncertain inputs? */
static bool is_solved(const fitted_t *fitted)
{
    return fitted->inputs.uncertain.estimate.number > 0;
}

/* Does this result show feedback that the other one does not? */
static bool shows_feedback(const fitted_t *watched, const fitted_t *other)
{
    const uint8_t *note = watched->id.estimate.confidence.note,
                  *others = other->id.estimate.confidence.note;
    bool shows = false;
    for (int i = 0; i < watched->id.metric.cfg.vehicle->parameters; ++i) {
        shows = shows || (note[i] == AUVID_NOTE_FEEDBACK && others[i] != AUVID_NOTE_FEEDBACK);
    }
    return shows;
}

/* Identifies with a model, twice. Without uncertain inputs the second time has estimates on the
 * way; it is the result if these show feedback. With them the columns of motion are formed with the
 * last solution, so the first sets of the first time lack one. Returns NULL after a message. */
static fitted_t *identify(job_t *job, const auvid_vehicle_t *vehicle)
{
    fitted_t *first = search(job, vehicle, NULL, false);
    if (first == NULL || job->options->literal) {
        return first;
    }
    bool solved = is_solved(first);
    fitted_t *second = search(job, vehicle, solved ? &first->inputs.uncertain : NULL, !solved);
    if (second != NULL && !(solved ? is_solved(second) : shows_feedback(second, first))) {
        forget(second);
        return first;
    }
    forget(first);
    return second;
}

void fit_forget_models(job_t *job)
{
    forget(job->coupled);
    forget(job->decoupled);
    job->coupled = job->decoupled = NULL;
    job->error[0] = job->error[1] = -1.0;
}

/* Identifies the selected models. Returns the one to report, or NULL after a message. */
fitted_t *fit_choose_model(job_t *job)
{
    coupling_t coupling = job->options->coupling;
    bool alternative = job->options->model == &auvid_girona500 && coupling != COUPLING_ON &&
                       !job->options->current; /* cross-validation needs a linear model */
    if (coupling != COUPLING_OFF) {
        job->coupled = identify(job, job->options->model);
        if (job->coupled == NULL || !alternative) {
            return job->coupled;
        }
    }
    bool six = decoupled_exists(job->options->model);
    job->decoupled = identify(job, six ? job->options->model : &auvid_girona500_decoupled);
    if (job->decoupled == NULL || coupling == COUPLING_OFF) {
        return job->decoupled;
    }
    job->error[0] = heldout_cross_validation(&job->coupled->id.metric);
    job->error[1] = heldout_cross_validation(&job->decoupled->id.metric);
    bool decoupled = job->error[1] >= 0.0 && !(job->error[0] < job->error[1]);
    return decoupled ? job->decoupled : job->coupled;
}
