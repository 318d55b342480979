/**
 * @file report.h
 * What is printed at the end: tables for people, one JSON object for programs.
 */
#ifndef PROGRAM_REPORT_H
#define PROGRAM_REPORT_H

#include "auvid/identifier.h"

/** One identification. */
typedef struct {
    uint64_t seed;
    const auvid_vehicle_t *vehicle;
    uint32_t free; /**< bit i: parameter i was to be identified */
    auvid_estimate_t estimate;
    uint32_t work_most;  /**< units in any call of work */
    bool has_truth;      /**< the true parameters are the paper's */
    double lower, upper; /**< bounds of all parameters; 0, 0: not of interest */
    bool in_commands;    /**< inputs were commands: units are those of the command */
    bool has_validation;
    uint32_t validated; /**< bit j: r2 of DoF j is there */
    double r2[AUVID_DOF_COUNT];
    double r2_low[AUVID_DOF_COUNT], r2_high[AUVID_DOF_COUNT]; /**< 95 % interval */
    bool has_interval;
    bool has_r2_truth;
    double r2_truth[AUVID_DOF_COUNT]; /**< of the true parameters */
    const char *why[AUVID_DOF_COUNT]; /**< why DoF j was not identified; null: it was */
} result_t;

/** Many runs. */
typedef struct {
    uint32_t runs;
    double rms_percent, interval[2], worst_percent;
    uint32_t failed;
    double parameter_rms[AUVID_G500_COUNT], parameter_worst[AUVID_G500_COUNT]; /**< [%] */
    double evaluations_median, evaluations_p95;
    double r2_median[AUVID_DOF_COUNT], r2_truth_median[AUVID_DOF_COUNT];
    uint32_t work_most;
    bool capped; /**< some run did not converge */
} campaign_t;

/** Four degrees of freedom are modelled. */
enum { MODELLED = 4 };
extern const auvid_dof_t report_dof[MODELLED];

/** "ok", "capped" (ended by a cap, not by its own criterion) or "not_driven" (no estimate). */
const char *report_status(const result_t *result);

/** Exit status that goes with it: 0 or 1. */
int report_exit(const result_t *result);

/** True value of parameter i. */
double report_truth(int i);

/** Root mean square, and largest, relative error of the 13 parameters [%]. */
double report_rms_percent(const auvid_estimate_t *estimate);
double report_worst_percent(const auvid_estimate_t *estimate);

/** Table of one identification. last: that of the last set only, beside it; may be null. */
void report_result(const result_t *result, const result_t *last);

/** Table of many runs; last as above. */
void report_campaign(const campaign_t *campaign, const campaign_t *last);

/** The JSON object; campaign, last and last_campaign may be null. */
void report_json(const result_t *result, const campaign_t *campaign, const result_t *last,
                 const campaign_t *last_campaign);

/** Flush stdout; EXIT_REFUSED after one line on stderr if it could not be written, else status. */
int report_finish(int status);

#endif
