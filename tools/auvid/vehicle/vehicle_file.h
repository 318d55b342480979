/**
 * @file vehicle_file.h
 * A vehicle, as a file describes it (README.md in this folder): its model, thrusters, limits,
 * instruments, uncertainties, and the truth of its simulation.
 */
#ifndef PROGRAM_VEHICLE_FILE_H
#define PROGRAM_VEHICLE_FILE_H

#include "auvid/actuation.h"
#include "auvid/uncertain.h"
#include "../base/ini.h"
#include "simulator.h"
#include "thrust_map.h"

/** Largest time of a log, which may be that of the day [s]. */
#define VEHICLE_TIME_S 1e10

/** Kinds of models in a file. */
typedef enum { VEHICLE_GIRONA500, VEHICLE_FOSSEN, VEHICLE_TERMS } vehicle_model_t;

/** Sizes of a file's contents. */
enum {
    VEHICLE_WORD = 32,
    VEHICLE_TITLE = 64,
    VEHICLE_UNIT = 16,
    VEHICLE_MAX_TERMS = 128,
    VEHICLE_CALIBRATIONS = 4
};

/** [thruster.N] */
typedef struct {
    double position_m[3], direction[3]; /**< of forward thrust, any length */
    double forward_N, backward_N;       /**< largest forces, both positive */
    char group[VEHICLE_WORD];           /**< "": none */
    int map;                            /**< of its group, in vehicle_t.map */
} vehicle_thruster_t;

/** [calibration.N]: a force that is known exactly */
typedef struct {
    auvid_known_force_t force;
    double from_s, to_s;     /**< when it acts, in the time of the log [s] */
    char log[VEHICLE_TITLE]; /**< name of the only log in which it acts; "": the first one */
    int number;              /**< N of the section */
} vehicle_calibration_t;

/** [parameters] and [terms]: a model as a table of terms. */
typedef struct {
    char name[AUVID_MAX_PARAMETERS][VEHICLE_WORD], unit[AUVID_MAX_PARAMETERS][VEHICLE_UNIT];
    auvid_parameter_t parameter[AUVID_MAX_PARAMETERS];
    auvid_term_t term[VEHICLE_MAX_TERMS];
    auvid_term_table_t table;
    auvid_terms_t terms;
} vehicle_terms_t;

/** Points into itself: it must not move. */
typedef struct {
    char word[VEHICLE_WORD];   /**< name in C and on the command line */
    char title[VEHICLE_TITLE]; /**< name in reports */
    int kind;                  /**< vehicle_model_t */
    const auvid_vehicle_t *model;
    bool fast;                /**< faster than its DVL, mainly in roll, pitch and yaw */
    auvid_real_t dry_mass_kg; /**< 0: not known */

    vehicle_thruster_t thruster[AUVID_MAX_THRUSTERS];
    thrust_map_t map[AUVID_MAX_THRUSTERS]; /**< of the groups */
    char group[AUVID_MAX_THRUSTERS][VEHICLE_WORD];
    int maps;
    const auvid_allocation_config_t *allocation; /**< of these thrusters */

    auvid_real_t amplitude[AUVID_DOF_COUNT]; /**< of the excitation [N, Nm] */
    bool has_excitation;                     /**< one of them is above 0 */
    char excitation_refusal[INI_MESSAGE]; /**< why it cannot be excited with them; "": it can be */
    auvid_guard_config_t guard;
    auvid_nav_mount_t mount;
    auvid_uncertainty_t uncertainty;
    auvid_uncertain_config_t uncertain;
    vehicle_calibration_t calibration[VEHICLE_CALIBRATIONS];
    int calibrations;
    bool has_truth;   /**< it can be simulated */
    sim_config_t sim; /**< configuration of the simulator */

    /** Ticks in which a node reports every estimate twice: one estimate in five ticks. */
    uint32_t linger_ticks;

    /* storage of what `allocation` and `model` point to */
    auvid_allocation_config_t allocation_cfg;
    auvid_vehicle_t fossen;
    vehicle_terms_t table;
} vehicle_t;

/** Reads a vehicle file. @return the vehicle, to be freed by free(); NULL after a message */
vehicle_t *vehicle_file_read(const char *path);

/** The same from a text in memory. @param path its name in messages
 * @param message [size] why it was refused */
vehicle_t *vehicle_file_parse(const char *path, const char *text, size_t length, char *message,
                              size_t size);

/** The force of thruster i, counted from 0 [N], by the map of its group.
 * @param map of the groups: vehicle->map, or others in their place
 * @param voltage_V of the supply now; not above 0: as in the map */
double vehicle_file_thrust(const vehicle_t *vehicle, const thrust_map_t *map, int i, double command,
                           double voltage_V);

/** Warns that [mount] is not applied to a log, if there is one: a user may take the lever arm for
 * corrected. */
void vehicle_warn_mount(const vehicle_t *vehicle, const char *log);

#endif
