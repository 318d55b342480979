/**
 * @file report.h
 * What is printed at the end: tables for people, one JSON object for programs.
 */
#ifndef PROGRAM_REPORT_H
#define PROGRAM_REPORT_H

#include "auvid/identifier.h"
#include "vehicle_sim.h"
#include "event_log.h"

/** Standard errors in the 95 % half-width that is shown: sets are few (see confidence.h). */
#define HALF_WIDTH 2.1

/** When searches ended, and of how many sets. */
typedef struct {
    uint32_t count;
    struct {
        double t_s;
        uint32_t sets;
    } at[1024]; /**< the first so many */
} estimates_t;

/** One identification. */
typedef struct {
    uint64_t seed;
    const auvid_vehicle_t *vehicle;
    uint32_t free;       /**< bit i: parameter i was to be identified */
    uint32_t budget;     /**< of work in a tick [units] */
    uint32_t max_work;  /**< units in any call of work */
    const estimates_t *estimates; /**< null: they were not listed */
    double truth[AUVID_MAX_PARAMETERS];
    auvid_guard_trip_t trip; /**< why the guard is ABORTED */
    auvid_estimate_t estimate;
    auvid_change_test_t change_test; /**< of the newest set */
    double excited_s; /**< adaptive excitation: how long; 0: it was not */
    uint32_t given_up, still_missing; /**< by it; bit i: parameter i */
    auvid_guard_state_t guard;
    uint32_t validated; /**< bit j: r2 of DoF j is there */
    double r2[AUVID_DOF_COUNT];
    double r2_low[AUVID_DOF_COUNT], r2_high[AUVID_DOF_COUNT]; /**< 95 % interval */
    double r2_truth[AUVID_DOF_COUNT];                         /**< of the true parameters */
    const char *why[AUVID_DOF_COUNT]; /**< why the log cannot tell of DoF j; null: it can */
    bool has_truth;                   /**< the vehicle is simulated */
    bool has_guard;                   /**< something was excited */
    bool in_commands;                 /**< inputs were commands: units are those of the command */
    bool has_validation, has_interval, has_r2_truth;
} result_t;

/** Many runs. Errors are relative to the truth; of a parameter whose truth is 0 they are absolute,
 * and in no rms over parameters. */
typedef struct {
    uint32_t runs;
    int parameters; /**< identified; those of a truth that is not 0 */
    int relative;
    double rms_percent, interval[2], worst_percent;
    uint32_t failed;
    double parameter_rms[AUVID_MAX_PARAMETERS];   /**< [%], or [unit] */
    double parameter_worst[AUVID_MAX_PARAMETERS]; /**< likewise */
    double evaluations_median, evaluations_p95;
    double r2_median[AUVID_DOF_COUNT], r2_truth_median[AUVID_DOF_COUNT];
    uint32_t known, covered[2]; /**< parameters with a standard error; within one of it, and two */
    /** flagged; of those, more than 20 % off, or four standard errors where the truth is 0 */
    uint32_t identifiable, wrong;
    uint32_t max_work;
    bool not_converged; /**< some run did not converge */
} campaign_t;

/** The degrees of freedom that a model has. @return how many */
int report_dofs(const auvid_vehicle_t *model, auvid_dof_t dof[AUVID_DOF_COUNT]);

/** Another result beside or after the first one. */
typedef struct {
    const char *key; /**< in JSON */
    const result_t *result;
    const campaign_t *campaign; /**< null: one run */
} beside_t;

/** "ok", "not_converged" or "not_excited" (no estimate). */
const char *report_status(const result_t *result);

/** Exit status that goes with it: 0 or 1. */
int report_exit(const result_t *result);

/** What an identifier has found: all of *result but truth and validation. */
void report_gather(result_t *result, const auvid_identifier_t *id, uint64_t seed);

/** What the simulated vehicle knows: the truth, and the estimate as it came in frames. */
void report_add_truth(result_t *result, const vehicle_sim_t *vehicle_sim);

/** Root mean square relative error of the parameters that are identified and whose truth is not 0
 * [%]; 0 when none is. @param truth [AUVID_MAX_PARAMETERS] */
double report_rms_percent(const auvid_estimate_t *estimate, const double *truth);

/** How many parameters are identifiable. */
int report_identifiable(const auvid_estimate_t *estimate);

/** What is to be said about parameter i, in a few words; empty: nothing. */
void report_note(const result_t *result, int i, char *text, size_t size);

/** Sentence number `which` on what is missing. False: there are not so many. */
bool report_missing(const result_t *result, unsigned which, char *text, size_t size);

/** Name of a degree of freedom ("surge"); has the model parameters in it? */
extern const char *const report_dof_name[AUVID_DOF_COUNT];
bool report_is_modelled(const result_t *result, auvid_dof_t j);

/** Unit of a cause's value and limit; empty where they have none. */
const char *report_cause_unit(auvid_guard_cause_t cause);

/** Drag force of degree of freedom j at a part of the largest speed seen in a direction. False: the
 * model has no drag there, or there was no motion in that direction. */
enum { REPORT_DRAG_PARTS = 3 };
extern const double report_drag_part[REPORT_DRAG_PARTS];
bool report_drag(const result_t *result, auvid_dof_t j, bool backward, int part,
                 auvid_drag_t *drag);

/** What it is in truth, where that is known. */
double report_true_drag(const result_t *result, auvid_dof_t j, double speed);

/** Smaller questions that tables and JSON have in common. */
const char *report_unit(const result_t *result, int i);
bool report_is_identified(const result_t *result, int i);
bool report_is_driven(const result_t *result, auvid_dof_t j);
bool report_is_at_bound(const result_t *result, int i);
double report_sigma(const result_t *result, int i); /**< infinite: not known */
double report_sigma_told(const result_t *result, int i); /**< with thrust and DVL scale as told */

/** Table of one identification. last: that of the last set only, beside it; may be null. */
void report_result(const result_t *result, const result_t *last);

/** Table of many runs; last as above. */
void report_campaign(const result_t *first, const campaign_t *campaign, const campaign_t *last);

/** The JSON object; campaign, beside and events may be null. */
void report_json(const result_t *result, const campaign_t *campaign, const beside_t *beside,
                 const event_log_t *events);

/** Flush stdout; EXIT_REFUSED after one line on stderr if it could not be written, else status. */
int report_finish(int status);

#endif
