/**
 * @file options.h
 * The command line of the program.
 */
#ifndef PROGRAM_OPTIONS_H
#define PROGRAM_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "field.h"
#include "../vehicle/vehicles.h"

/** Are the terms between degrees of freedom part of the model? */
typedef enum { COUPLING_AUTO, COUPLING_ON, COUPLING_OFF } coupling_t;

/** The map from commands to forces: that of vehicle or log, by comparison, or this one. */
typedef enum { MAP_AS_TOLD, MAP_AUTO, MAP_LINEAR, MAP_SIGNED_SQUARE } options_map_t;

/** Largest number of --fix and --free options. */
enum { OPTIONS_CHOICES = 64 };
/** Largest number of training logs. */
enum { OPTIONS_LOGS = 64 };

/** Names of field_driver_t on the command line. */
extern const char *const options_drivers[FIELD_DRIVERS];

/** Names of field_vehicle_t on the command line. */
extern const char *const options_field_vehicles[FIELD_VEHICLES];

/** Options of field statistics (field.h). */
typedef struct {
    bool wanted;         /**< field statistics are run */
    bool mixture;        /**< mismatches are drawn at random */
    double strength;     /**< factor of their usual sizes */
    bool matched;        /**< only the scales of thrust and DVL are drawn, as configured */
    bool perfect_thrust; /**< no mismatch of the thrust is drawn */
    bool perfect_inputs; /**< every uncertainty is zero */
    bool shifts;         /**< rank the classes of causes (field_causes.h) */
    bool reference;      /**< give the reference of the driver (uncertain.h) */
    double alternate_m;  /**< see field_config_t */
    const char *mismatch[FIELD_MISMATCHES]; /**< NAME=SIZE, as given */
    int mismatches;
    field_vehicle_t vehicle;
    field_driver_t driver;
    field_driver_t then; /**< after the excitation; FIELD_EXCITED: nothing */
    double hours;        /**< length of each run; 0: of --sets, or 600 s */
    const char *chosen;  /**< an option that needs field statistics, or NULL */
} options_field_t;

/** All options. */
typedef struct {
    const char *command;   /**< the sub-command */
    char *const *argument; /**< [arguments] after it, as given */
    int arguments;
    bool json;
    bool literal;
    bool plain;    /**< no uncertain inputs (uncertain.h): all are exact but for those below */
    bool adaptive; /**< demo: excite until all is identified, for at most `sets` sets */
    uint64_t seed; /**< default 1 */
    /** Uncertainties that the identifier is given. Negative: the library's default. */
    double thrust_scale, dvl_scale, delay_s;
    const vehicle_t *vehicle; /**< default Girona500 */

    /* demo */
    double disturbance_N; /**< rms of the unmodelled force; default 0, in scenarios 1 */
    double lag_s;         /**< of the thrusters; default 0 */
    uint32_t sets;        /**< of 30 s; default 8 */
    uint32_t runs;        /**< 0: one run, reported in full */
    uint32_t budget;      /**< of work in a tick [units]; default AUVID_DEFAULT_BUDGET */
    const char *csv;      /**< file to write; NULL: none */
    const char *report;   /**< demo, fit, replay: page to write (html.h); NULL: none */
    const char *scenario; /**< NULL: none */
    options_field_t field;

    /* fit */
    const char *train[OPTIONS_LOGS];
    const char *validate; /**< NULL: none */
    double lower, upper;  /**< bounds of every parameter, if has_bounds */
    bool bias;
    bool has_gain; /**< commands are converted to newtons */
    bool whole;    /**< --vehicle was given: model, thrusters, all else */
    bool linear_input;
    coupling_t coupling;
    options_map_t map;
    bool current;                        /**< a constant current is identified, too */
    bool has_bounds;                     /**< --bounds; else those of vehicle_bounds */
    const vehicle_t *thrusters;          /**< of this vehicle; NULL: not known */
    const auvid_vehicle_t *model;        /**< default Girona500 */
    double dry_mass_kg;                  /**< 0: not known */
    double max_gap_s;                    /**< 0: not given */
    bool hold_inputs;                    /**< fit, check: empty cells of inputs keep their value */
    uint8_t closed_loop;                 /**< bit j: DoF j is in closed loop */
    uint8_t open_loop;                   /**< bit j: DoF j is in open loop */
    double gain[AUVID_DOF_COUNT];        /**< newtons per unit of command; 0: not given */
    const char *choice[OPTIONS_CHOICES]; /**< NAME=VALUE (--fix) or NAME,.. (--free), as given */
    int choices;
    int trains; /**< number of training logs */

    /* check */
    const char *file; /**< the vehicle file, or the log */
    bool header;      /**< print C for firmware */

    /* node, vehicle, replay; seed, sets, disturbance and csv as above */
    const char *bus;   /**< interface */
    const char *log;   /**< node: log to write, or NULL; replay: log to read */
    const char *prior; /**< node, replay: prior record to start with, or NULL */
    const char *save;  /**< node: prior record to write, or NULL */
    bool clock_own;    /**< the node sends the tick frames */
    bool excite;
    bool lock_step;
    bool realtime;
    bool no_arm;
    bool arm_again;
    uint32_t speed; /**< vehicle: speed of simulated time; default 1 */
} options_t;

/** Reads the arguments after the sub-command. Returns 0, or EXIT_REFUSED after one line on stderr.
 */
int options_demo(options_t *options, int count, char **argument);
int options_fit(options_t *options, int count, char **argument);
int options_check(options_t *options, int count, char **argument);
int options_node(options_t *options, int count, char **argument);
int options_vehicle(options_t *options, int count, char **argument);
int options_replay(options_t *options, int count, char **argument);

/** Writes the uncertainties of thrust, DVL and delay that are given into *cfg. */
static inline void options_uncertainty(const options_t *options, auvid_uncertainty_t *cfg)
{
    if (options->thrust_scale >= 0.0) {
        cfg->thrust_scale = (auvid_real_t)options->thrust_scale;
    }
    if (options->dvl_scale >= 0.0) {
        cfg->dvl_scale = (auvid_real_t)options->dvl_scale;
    }
    if (options->delay_s >= 0.0) {
        cfg->delay_s = (auvid_real_t)options->delay_s;
    }
}

#endif
