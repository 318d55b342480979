/**
 * @file fit.h
 * The parts of auvid fit: logs (fit_logs.c), known forces (fit_known_force.c), models
 * (fit_model.c), and the command itself (fit.c).
 */
#ifndef PROGRAM_FIT_H
#define PROGRAM_FIT_H

#include "auvid/current.h"
#include "../vehicle/decoupled.h"
#include "literal.h"
#include "../options/options.h"
#include "replay.h"
#include "../log/survey.h"
#include "../log/velocity_times.h"
#include "../report/report.h"

/** A model identified from the logs. */
typedef struct {
    auvid_identifier_t id;
    auvid_validation_t prediction;
    auvid_change_detector_t change;
    replay_inputs_t inputs;        /**< if the thrusters are known, or there is a reference */
    literal_t literal;             /**< if chosen */
    decoupled_t six;               /**< the model, if it has six DoF without coupling */
    auvid_calibrated_t calibrated; /**< the model, if a force is known */
    auvid_current_t current;       /**< the model, with --current */
    auvid_row_t *rows;             /**< which needs them; NULL: none */
} fitted_t;

/** A fit: logs, options and models. */
typedef struct {
    const options_t *options;
    log_t log[OPTIONS_LOGS], test_log;
    log_set_t train, test;
    survey_t survey, test_survey; /**< of the training logs, and of the held-out one */
    log_use_t use;
    auvid_real_t tau_max[AUVID_DOF_COUNT];
    uint32_t cell_us;                         /**< length of the cells; 0: not chosen yet */
    bool same_cells;                          /**< it is not changed, so that errors compare */
    uint32_t free;                            /**< bit i: parameter i is identified */
    auvid_real_t fixed[AUVID_MAX_PARAMETERS]; /**< values of the other parameters */
    const char *path[OPTIONS_LOGS];           /**< of the training logs */
    bool velocity_gaps;                       /**< most of a log is lost to them */
    int logs_left_out;                        /**< beside these: they have errors */
    double shift_s[OPTIONS_LOGS + 1]; /**< of the inputs of each log, the held-out one last */
    uint8_t left_out; /**< bit j: the velocity of DoF j is useless in one of the logs */
    const char *why[AUVID_DOF_COUNT]; /**< why a DoF cannot be identified, or NULL */
    bool known_force;                 /**< a force is known, of file or logs */
    fitted_t *coupled, *decoupled;    /**< NULL: not fitted */
    trace_t trace;                    /**< of the held-out log */
    report_maps_t maps;               /**< the comparison of --map auto */
    report_findings_t findings;       /**< what is wrong with the training logs */
    char remedy[400];                 /**< the only advice; empty: none */
    char verdict[400];                /**< the first line of the tables */
    double error[2];                  /**< cross-validation errors of the two; < 0: none */
} job_t;

/** Are the parameters in units of command? */
static inline bool fit_in_commands(const job_t *job)
{
    return job->use.kind == INPUT_COMMAND && !job->options->has_gain;
}

/** Dry mass: that of --dry-mass, or of the vehicle; 0: not known, or of no use for commands. */
double fit_dry_mass_kg(const job_t *job);

/** Longest time between velocities in one record, after the survey [s]. */
double fit_velocity_gap_s(const job_t *job);

/** Refuses bounds that leave no room above the dry mass. Returns 0, or EXIT_REFUSED after one line
 * on stderr. */
int fit_check_bounds(const job_t *job);

/** Opens and surveys all logs, and finds the DoF that can be identified. Returns 0, or EXIT_REFUSED
 * after one line on stderr. */
int fit_read_logs(job_t *job);
void fit_close_logs(job_t *job);

/** Takes the known forces of vehicle file and logs. Returns 0, or EXIT_REFUSED after one line on
 * stderr. */
int fit_take_known_forces(job_t *job);
/** Compares their times with those of the logs, after a survey. Returns 0, or EXIT_REFUSED after
 * one line on stderr. */
int fit_check_known_forces(job_t *job);
/** Selects the model with a known force. Returns false after a message. */
bool fit_add_known_force(const job_t *job, auvid_calibrated_t *calibrated,
                         auvid_identifier_config_t *cfg);

/** Takes another map from commands to forces (log_use_map). Returns 0, or EXIT_REFUSED after one
 * line on stderr. */
int fit_use_map(job_t *job, thrust_map_kind_t kind);

/** Are the inputs commands, whose maps can be compared? */
bool fit_has_maps(const job_t *job);

/** Applies --map: the one that is named, or by comparison (map_choice.c). Returns 0, or
 * EXIT_REFUSED after one line on stderr. */
int fit_choose_map(job_t *job);
/** Prints the comparison of the maps, if there was one. */
void fit_print_maps(const report_maps_t *maps);

/** Applies --fix, --free and --bias. Returns 0, or EXIT_REFUSED after one line on stderr. */
int fit_choose_free(job_t *job);

/** Identifies the selected models. Returns the one to report, or NULL after a message. */
fitted_t *fit_choose_model(job_t *job);
/** Forgets them. */
void fit_forget_models(job_t *job);

#endif
