/**
 * @file log_samples.h
 * Turns the rows of logs into the samples of their streams: attitude with rates, velocity, inputs,
 * reference. Each has its own rate; an empty cell is no new sample.
 */
#ifndef PROGRAM_LOG_SAMPLES_H
#define PROGRAM_LOG_SAMPLES_H

#include "auvid/allocation.h"
#include "csv.h"
#include "../vehicle/vehicle_calibration.h"

/** Kind of the inputs of a log. */
typedef enum {
    INPUT_WRENCH,          /**< X_N .. */
    INPUT_COMMAND,         /**< cmd_* */
    INPUT_THRUST,          /**< thruster_*_N */
    INPUT_THRUSTER_COMMAND /**< thruster_*, or rpm_* if the thruster's map is of the speed */
} input_kind_t;

/** How to use the logs. */
typedef struct {
    input_kind_t kind;
    uint8_t dofs;                   /**< bit j: the input of DoF j is used (its velocity exists) */
    bool reference;                 /**< the log has the reference of a controller (ref_*) */
    const vehicle_t *vehicle;       /**< whose thrusters make the wrench; NULL: not known */
    bool uncertain;                 /**< the errors of its thrusters are estimated */
    auvid_allocation_t allocation;  /**< of its thrusters */
    uint32_t delay_us;              /**< known time from its commands to their forces */
    double gain[AUVID_DOF_COUNT];   /**< of the commands: newtons per unit; 0: not known */
    auvid_calibrated_t *calibrated; /**< model with a known force; NULL: no force is known */
    thrust_map_t map[AUVID_MAX_THRUSTERS]; /**< of the thrusters' groups: log_use_map */
    double voltage_V; /**< largest voltage of the log, for log_voltage_judge; 0: it has none */
    uint32_t gap_us;  /**< longest time between rows with attitude, and with inputs; 0: as between
                          velocities */
    bool square; /**< the force of an axis is the signed square of its command: log_use_map */
} log_use_t;

/** A log, and how it was found to be. */
typedef struct {
    csv_log_t csv;
    uint64_t start_us; /**< time of its first row in the replay */
    double held_s;     /**< time for which a velocity is held in the rows; 0: it is not held */
    bool wrong;        /**< it contradicts itself, or the vehicle; not: it is too short or slow */
    uint8_t left_out;  /**< bit j: the velocity of DoF j is too coarse, or stuck */
    double gap_s;      /**< longest time between its velocities; 0: that of velocity_gap_s */
    double lost;       /**< part that is lost because velocities are further apart, 0 to 1 */
    int64_t shift_us;  /**< inputs act so much later than their rows say; negative: earlier */
    vehicle_calibration_t calibration[VEHICLE_CALIBRATIONS]; /**< known forces of this log */
    int calibrations;
} log_t;

/** Logs, each a record of its own, or a part of them. */
typedef struct {
    log_t *log;
    int logs;
    uint64_t from_us, to_us; /**< a part, by time in the replay; both 0: there is none */
    bool only;               /**< only the part is read; else it is left out */
} log_set_t;

/** Is a time within what is read? */
static inline bool log_set_has(const log_set_t *set, uint64_t t_us)
{
    return set->to_us == 0 || (t_us >= set->from_us && t_us < set->to_us) == set->only;
}

/** The samples of a row. */
typedef struct {
    uint64_t t_us, input_us; /**< time of the row, and from which the inputs act */
    bool has_attitude, has_input, has_reference, has_known;
    unsigned velocity; /**< bit i: u, v, w is a new sample */
    auvid_real_t attitude[3], nu[AUVID_DOF_COUNT], wrench[AUVID_DOF_COUNT];
    auvid_real_t reference[AUVID_DOF_COUNT];
    auvid_real_t force_N[AUVID_MAX_THRUSTERS]; /**< if the log has the thrusters */
    auvid_known_force_t known;                 /**< the known force at t_us */
} log_sample_t;

/** Reader of one log. Private but for the first two. */
typedef struct {
    log_t *log;
    const log_use_t *use;
    double turns[3];            /* whole revolutions that unwrap each angle so far */
    double raw[3], angle[3];    /* last angles; unwrapped and propagated */
    double angle_s, measured_s; /* time of the angles, and when they were measured */
    double nu[AUVID_DOF_COUNT]; /* last velocities and rates */
    double velocity_s;          /* time of the last velocity, if there is one */
    bool has_velocity;
    double input[AUVID_MAX_THRUSTERS]; /* last inputs */
    double voltage_V;                  /* last voltage; 0: none yet */
    double weight_N;                   /* last weight */
    double reference[AUVID_DOF_COUNT];
    bool known[CSV_COLUMNS]; /* the column had a value */
} log_reader_t;

/** Are the inputs those of thrusters? */
bool log_has_thrusters(const log_use_t *use);

/** Takes a vehicle's thrusters as inputs: their forces, or else their commands or speeds. Returns
 * false if the columns of one of them are missing, or its allocation cannot be used. */
bool log_use_thrusters(log_use_t *use, const vehicle_t *vehicle, const bool has[CSV_COLUMNS]);

/** Has the log the columns of the vehicle's thrusters: one for each, and no other? Needs kind,
 * vehicle and allocation. Returns 0, or EXIT_REFUSED after one line on stderr. */
int log_check_thrusters(const log_use_t *use, const csv_log_t *log);

/** Reports that a log has no inputs of the vehicle's thrusters, and which columns are wanted. Needs
 * vehicle. Returns EXIT_REFUSED. */
int log_no_thrusters(const log_use_t *use, const csv_log_t *log);

/** Chooses the map from commands to forces: linear or signed-square; THRUST_MAP_NEWTON: as
 * configured, which is the vehicle's for thrusters, linear for axes. Needs kind and vehicle.
 * Returns false if no map is replaced, because the inputs are forces already. */
bool log_use_map(log_use_t *use, thrust_map_kind_t kind);

/** Number of inputs, and the column of each. */
int log_inputs(const log_use_t *use);
int log_input(const log_use_t *use, int k);

/** Computes the wrench of inputs in every DoF, and the forces of thrusters if these are the inputs.
 * @param voltage_V of the supply; 0: not known
 * @param force_N [AUVID_MAX_THRUSTERS] */
void log_wrench(const log_use_t *use, const double *input, double voltage_V,
                double wrench[AUVID_DOF_COUNT], auvid_real_t *force_N);

enum { LOG_THRUST_TEXT = 400 };

/** Is the voltage of the log (use->voltage_V) what the maps of the vehicle need? Returns 0; or 1 if
 * it is in another unit, -1 if there is none, and writes a sentence with the remedy. */
int log_voltage_judge(const log_use_t *use, char *text, size_t size);

/** Is the largest force of the log's thrusters of the size that the vehicle's have? Returns 0; or 1
 * if it is too large, -1 if it is too small, and writes a sentence with the remedy. Too large is
 * above 110 %; above 200 % where a measured speed or a voltage determines the force. A voltage in
 * another unit is too large, too. */
int log_thrust_judge(const log_use_t *use, double largest_N, char *text, size_t size);

/** Starts at the first row. Returns 0, or EXIT_REFUSED after one line on stderr. */
int log_reader_begin(log_reader_t *reader, log_t *log, const log_use_t *use);

/** Reads the next row. Returns 0, CSV_END, or EXIT_REFUSED after one line on stderr. */
int log_reader_next(log_reader_t *r, log_sample_t *out);

#endif
