/**
 * @file report.h
 * The final report: tables or a page for people, one JSON object for programs.
 */
#ifndef PROGRAM_REPORT_H
#define PROGRAM_REPORT_H

#include <stdio.h>

#include "auvid/actuation.h"
#include "auvid/uncertain.h"
#include "vehicle_sim.h"
#include "event_log.h"
#include "trace.h"

/** Standard errors in the printed 95 % half-width, for few sets (see estimate.h). */
#define HALF_WIDTH 2.1

/** Times at which searches ended, and their numbers of sets. */
typedef struct {
    uint32_t count;
    struct {
        double t_s;
        uint32_t sets;
    } at[1024]; /**< only the first are stored */
} estimates_t;

/** What was read: one log, or several together. Zero: not known. */
typedef struct {
    const char *const *path; /**< [paths] */
    int paths;               /**< 0: no log */
    const double *shift_s; /**< [paths] inputs act so much later than logged; NULL: not examined */
    size_t rows;           /**< of a log of the bus: tick frames */
    double duration_s;     /**< sum of the logs' lengths */
    double velocity_s;     /**< time between velocities: the median */
    size_t gaps;           /**< intervals of more than gap_s */
    double gap_s;
    const char *changed_path; /**< the vehicle changed: log that has the start of what is in the
                                   estimate; NULL: it did not */
    double changed_s;         /**< that start, in the log's time */
} report_log_t;

/** What is wrong with a log (doctor.h). */
typedef struct {
    const char *log;    /**< its path */
    const char *code;   /**< one word, for programs */
    bool error;         /**< else a warning */
    char sentence[360]; /**< what is wrong, where, what to do */
} report_finding_t;

/** What is wrong with all logs. Zero: nothing yet. report_free_findings releases it. */
typedef struct {
    report_finding_t *at; /**< [count] */
    int count;
} report_findings_t;

/** A map from commands to forces that was tried. */
typedef struct {
    const char *name;
    bool judged;                  /**< it predicts the held-out motion at all */
    double error;                 /**< 1 - R2 of held-out velocity, mean of the DoF */
    double difference, low, high; /**< from the first one, and its 95 % interval */
} report_map_t;

/** Comparison of maps. Zero: there was none. */
enum { REPORT_MAPS = 3 };
typedef struct {
    report_map_t map[REPORT_MAPS]; /**< [count], the first one as configured */
    int count, best, used;
    size_t blocks;  /**< of 10 s, that were compared */
    bool other_log; /**< held out is another log, not parts of the same */
} report_maps_t;

/** What a known force has shown of the thrust (report_calibrate). */
typedef enum {
    REPORT_UNCALIBRATED, /**< no force is known */
    REPORT_CALIBRATED,
    REPORT_UNSEEN,
    REPORT_CONTRADICTED
} report_calibration_t;

/** One identification. */
typedef struct {
    uint64_t seed;
    const auvid_vehicle_t *vehicle;
    uint32_t free;                     /**< bit i: parameter i is free */
    uint32_t budget;                   /**< work units per tick */
    uint32_t max_work;                 /**< largest number of units in a call of work */
    const estimates_t *estimates;      /**< NULL: not listed */
    const trace_t *trace;              /**< of the held-out run; NULL: none */
    report_log_t log, held_out;        /**< identified from, and validated on */
    const report_maps_t *maps;         /**< NULL: none were compared */
    const report_findings_t *findings; /**< in log; NULL: no log was examined */
    double truth[AUVID_MAX_PARAMETERS];
    auvid_guard_trip_t trip; /**< cause of ABORTED */
    auvid_estimate_t estimate;
    auvid_causes_t causes; /**< what is wrong with the inputs; none: they are not uncertain */
    auvid_change_test_t change_test;  /**< of the newest set */
    uint8_t closed_loop, open_loop;   /**< bit j: DoF j, as configured */
    double cell_s;                    /**< length of the recorder's cells */
    double excited_s;                 /**< duration of the adaptive excitation; 0: none */
    uint32_t given_up, still_missing; /**< by adaptive excitation; bit i: parameter i */
    auvid_guard_state_t guard;
    uint32_t validated; /**< bit j: r2 of DoF j is valid */
    double r2[AUVID_DOF_COUNT];
    double r2_low[AUVID_DOF_COUNT], r2_high[AUVID_DOF_COUNT]; /**< 95 % interval */
    double r2_truth[AUVID_DOF_COUNT];                         /**< of the true parameters */
    const char *why[AUVID_DOF_COUNT]; /**< why the log does not identify DoF j, or NULL */
    const char *verdict;              /**< what the result is worth, in words; NULL: not said */
    const char *remedy;               /**< NULL, or the only advice: what to correct first */
    uint8_t left_out;                 /**< bit j: because of the log: no advice on motion */
    bool wrong_log;                   /**< its errors would be in every number: none is known */
    bool has_truth;                   /**< the vehicle is simulated */
    bool has_guard;                   /**< something was excited */
    bool inputs_estimated;            /**< errors of thrust and sensors, with the parameters */
    double over_priors;   /**< these, relative to their standard deviations; 0: not estimated */
    bool has_loop_option; /**< the command has --open-loop */
    bool in_commands;     /**< the inputs are commands, which set the units */
    bool has_validation, has_interval, has_r2_truth;
    report_calibration_t calibration;
    int k_tau; /**< its parameter, if a force is known */
} result_t;

/** Results of many runs. Errors are relative to the truth. If the truth is 0, the errors are
 * absolute and enter no rms over parameters. */
typedef struct {
    uint32_t runs;
    int parameters; /**< identified; those whose truth is not 0 */
    int relative;
    double rms_percent, interval[2], worst_percent;
    uint32_t failed;
    double parameter_rms[AUVID_MAX_PARAMETERS];   /**< [%], or [unit] */
    double parameter_worst[AUVID_MAX_PARAMETERS]; /**< likewise */
    double evaluations_median, evaluations_p95;
    double r2_median[AUVID_DOF_COUNT], r2_truth_median[AUVID_DOF_COUNT];
    uint32_t known, covered[2]; /**< parameters with a standard error; within one of it, and two */
    /** flagged; of these, errors above 20 %, or four standard errors where the truth is 0 */
    uint32_t identifiable, wrong;
    uint32_t max_work;
    bool not_converged; /**< at least one run did not converge */
} campaign_t;

/** Lists the degrees of freedom of a model. Returns their number. */
int report_dofs(const auvid_vehicle_t *model, auvid_dof_t dof[AUVID_DOF_COUNT]);

/** A second result, reported with the first one. */
typedef struct {
    const char *key; /**< in JSON */
    const result_t *result;
    const campaign_t *campaign; /**< NULL: one run */
} second_result_t;

/** "ok", "not_converged" or "not_excited" (no estimate). */
const char *report_status(const result_t *result);

/** Exit status of the result: 0 or 1. */
int report_exit(const result_t *result);

/** Copies the results of an identifier: all of *result except truth and validation. */
void report_gather(result_t *result, const auvid_identifier_t *id, uint64_t seed);

/** Adds what the simulated vehicle knows: the truth, and estimate and wrong inputs as received in
 * frames. */
void report_add_truth(result_t *result, const vehicle_sim_t *vehicle_sim);

/** Converts the estimate of a model with a known force to SI (auvid_calibrated_estimate). Call it
 * after the validation, which needs the estimate in units of the supplied thrust. */
void report_calibrate(result_t *result, const auvid_calibrated_t *calibrated);

/** Writes what a known force says of the thrust; returns false if no force is known. */
bool report_thrust(const result_t *result, char *text, size_t size);

/** Root mean square relative error of the parameters that are identified and whose truth is not 0
 * [%]; 0 when none is. @param truth [AUVID_MAX_PARAMETERS] */
double report_rms_percent(const auvid_estimate_t *estimate, const double *truth);

/** Number of identifiable parameters. */
int report_identifiable(const auvid_estimate_t *estimate);

/** Writes a short note on parameter i; empty: none. */
void report_note(const result_t *result, int i, char *text, size_t size);

/** Writes sentence number `which` on what is wrong with the inputs. Returns false after them. */
bool report_cause(const result_t *result, unsigned which, char *text, size_t size);

/** The parameters, a bit each, whose estimates with exact inputs would differ by more than both
 * half-widths. */
uint32_t report_differs(const result_t *result);

/** Writes sentence number `which` on what is missing. Returns false after the last one. */
bool report_missing(const result_t *result, unsigned which, char *text, size_t size);

/** Name of a degree of freedom ("surge"). Has the model parameters in it? */
extern const char *const report_dof_name[AUVID_DOF_COUNT];
bool report_is_modelled(const result_t *result, auvid_dof_t j);

/** Unit of the value and limit of a cause; empty: none. */
const char *report_cause_unit(auvid_guard_cause_t cause);

/** Drag force of degree of freedom j at a fraction of the largest speed in a direction. Returns
 * false if the model has no drag there, or if there was no motion in that direction. */
enum { REPORT_DRAG_PARTS = 3 };
extern const double report_drag_part[REPORT_DRAG_PARTS];
bool report_drag(const result_t *result, auvid_dof_t j, bool backward, int part,
                 auvid_drag_t *drag);

/** Number of degrees of freedom in which a drag force is identifiable, and their names ("surge,
 * yaw"). */
int report_known_drag(const result_t *result, char *text, size_t size);

/** True drag force, where the truth is known. */
double report_true_drag(const result_t *result, auvid_dof_t j, double speed);

/** Functions that tables and JSON share. */
const char *report_unit(const result_t *result, int i);
/** Does the motion contradict the inputs? Not if a controller drives: its answers to disturbances
 * do. */
bool report_is_contradicted(const result_t *result);
bool report_is_identified(const result_t *result, int i);
bool report_is_driven(const result_t *result, auvid_dof_t j);
bool report_is_at_bound(const result_t *result, int i);
double report_sigma(const result_t *result, int i);      /**< infinite: not known */
double report_sigma_told(const result_t *result, int i); /**< with exact scales of thrust and DVL */

/** Prints the table of one identification, with that of the last set only if `last` is not NULL. */
void report_result(const result_t *result, const result_t *last);

/** Prints the table of many runs; last as above. */
void report_campaign(const result_t *first, const campaign_t *campaign, const campaign_t *last);

/** Writes the JSON object. campaign, second and events may be NULL. */
void report_json(FILE *out, const result_t *result, const campaign_t *campaign,
                 const second_result_t *second, const event_log_t *events);

/** Adds a finding. Returns 0, or EXIT_REFUSED after one line on stderr: no memory. */
int report_add_finding(report_findings_t *findings, const char *log, const char *code, bool error,
                       const char *sentence);
void report_free_findings(report_findings_t *findings);

/** Flushes stdout. Returns status, or EXIT_REFUSED after one line on stderr if it cannot. */
int report_finish(int status);

#endif
