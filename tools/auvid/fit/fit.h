/**
 * @file fit.h
 * The parts of auvid fit: logs (fit_logs.c), models (fit_model.c), and the command itself (fit.c).
 */
#ifndef PROGRAM_FIT_H
#define PROGRAM_FIT_H

#include "../vehicle/decoupled.h"
#include "literal.h"
#include "../options/options.h"
#include "replay.h"
#include "../log/survey.h"
#include "../report/trace.h"

/** A model identified from the logs. */
typedef struct {
    auvid_identifier_t id;
    auvid_validation_t prediction;
    auvid_change_detector_t change;
    replay_inputs_t inputs; /**< if the thrusters are known, or there is a reference */
    literal_t literal;      /**< if chosen */
    decoupled_t six;        /**< the model, if it has six DoF without coupling */
} fitted_t;

/** A fit: logs, options and models. */
typedef struct {
    const options_t *options;
    log_t log[OPTIONS_LOGS], test_log;
    log_set_t train, test;
    survey_t survey; /**< of the training logs */
    log_use_t use;
    auvid_real_t tau_max[AUVID_DOF_COUNT];
    uint32_t cell_us;                         /**< length of the cells; 0: not chosen yet */
    uint32_t free;                            /**< bit i: parameter i is identified */
    auvid_real_t fixed[AUVID_MAX_PARAMETERS]; /**< values of the other parameters */
    const char *why[AUVID_DOF_COUNT];         /**< why a DoF cannot be identified, or NULL */
    fitted_t *coupled, *decoupled;            /**< NULL: not fitted */
    trace_t trace;                            /**< of the held-out log */
    double error[2];                          /**< cross-validation errors of the two; < 0: none */
} job_t;

/** Are the parameters in units of command? */
static inline bool fit_in_commands(const job_t *job)
{
    return job->use.kind == INPUT_COMMAND && !job->options->has_gain;
}

/** Opens and surveys all logs, and finds the DoF that can be identified. Returns 0, or EXIT_REFUSED
 * after one line on stderr. */
int fit_read_logs(job_t *job);
void fit_close_logs(job_t *job);

/** Applies --fix, --free and --bias. Returns 0, or EXIT_REFUSED after one line on stderr. */
int fit_choose_free(job_t *job);

/** Identifies the selected models. Returns the one to report, or NULL after a message. */
const fitted_t *fit_choose_model(job_t *job);

#endif
