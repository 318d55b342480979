/*
 * The known forces of a fit: [calibration.N] of the vehicle file, or the column weight_N of a log.
 */
#include <string.h>

#include "fit.h"
#include "../base/report_error.h"

/* The training logs, and behind them the held-out one; NULL: there is no further log. */
static log_t *log_of(job_t *job, int i)
{
    return i < job->train.logs                    ? &job->log[i]
           : i < job->train.logs + job->test.logs ? &job->test_log
                                                  : NULL;
}

/* A force of the file that names a log which is not given has no effect: says so. And of several
 * logs it says which is the first. */
static void note_names(job_t *job)
{
    const vehicle_t *v = job->options->vehicle;
    for (int k = 0; k < v->calibrations; ++k) {
        const vehicle_calibration_t *c = &v->calibration[k];
        bool acts = false;
        for (int i = 0; log_of(job, i) != NULL; ++i) {
            const log_t *log = log_of(job, i);
            for (int n = 0; n < log->calibrations; ++n) {
                acts = acts || log->calibration[n].number == c->number;
            }
        }
        if (!acts) {
            report_error_line("[calibration.%d] of the vehicle file is of %s, which is not fitted: "
                              "it has no effect",
                              c->number, c->log);
        } else if (c->log[0] == '\0' && job->train.logs > 1) {
            report_error_line("[calibration.%d] of the vehicle file acts in the first log, %s: a "
                              "key log = FILE names another one",
                              c->number, job->log[0].csv.path);
        }
    }
}

/* Takes those of one log. first: its file may have forces that name no log */
static int take(job_t *job, log_t *log, bool first)
{
    const options_t *options = job->options;
    const char *path = log->csv.path;
    bool column = log->csv.has[CSV_WEIGHT];
    if (options->whole) {
        log->calibrations =
            vehicle_calibrations_of(options->vehicle, path, first, log->calibration);
    }
    if (!column && log->calibrations == 0) {
        return 0;
    }
    job->known_force = true;
    if (column && log->calibrations > 0) {
        return report_error("%s: the weight is known twice: by weight_N and by [calibration.%d] of "
                            "the vehicle file; remove one",
                            path, log->calibration[0].number);
    }
    if (fit_in_commands(job)) {
        return report_error("%s: a known force needs thrust in newtons: give --gain, or log the "
                            "forces",
                            path);
    }
    const char *without = options->literal ? "--literal" : options->current ? "--current" : NULL;
    return without != NULL ? report_error("%s: %s has no known force: remove %s", path, without,
                                          column ? "weight_N" : "[calibration.1]")
                           : 0;
}

int fit_take_known_forces(job_t *job)
{
    int status = 0;
    for (int i = 0; log_of(job, i) != NULL && status == 0; ++i) {
        status = take(job, log_of(job, i), i == 0);
    }
    if (status == 0 && job->options->whole) {
        note_names(job);
    }
    return status;
}

int fit_check_known_forces(job_t *job)
{
    char text[300];
    for (int i = 0; log_of(job, i) != NULL; ++i) {
        const log_t *log = log_of(job, i);
        if (vehicle_calibrations_miss(log->calibration, log->calibrations, log->csv.first_s,
                                      log->csv.last_s, text, sizeof text)) {
            return report_error("%s: %s", log->csv.path, text);
        }
    }
    return 0;
}

/* A force of the logs; down, if they have columns. */
static auvid_known_force_t any_force(const job_t *job)
{
    auvid_known_force_t force = {.world = {0, 0, 1}};
    for (int i = 0; i < job->train.logs; ++i) {
        if (job->log[i].calibrations > 0) {
            return job->log[i].calibration[0].force;
        }
    }
    return force;
}

bool fit_add_known_force(const job_t *job, auvid_calibrated_t *calibrated,
                         auvid_identifier_config_t *cfg)
{
    const auvid_known_force_t force = any_force(job);
    auvid_status_t status = vehicle_use_known_force(cfg, &force, calibrated);
    if (status < 0) {
        (void)report_error("fit: known force: %s", auvid_status_str(status));
        return false;
    }
    if ((job->free >> calibrated->k & 1u) != 0) {
        (void)report_error("fit: %s cannot be identified beside a known force",
                           calibrated->other->parameter[calibrated->k].name);
        return false;
    }
    return true;
}
