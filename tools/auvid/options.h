/**
 * @file options.h
 * The command line.
 */
#ifndef PROGRAM_OPTIONS_H
#define PROGRAM_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "field.h"
#include "vehicles.h"

/** Is the coupling between the degrees of freedom part of the model? */
typedef enum { COUPLING_AUTO, COUPLING_ON, COUPLING_OFF } coupling_t;

/** Most --fix and --free together. */
enum { OPTIONS_CHOICES = 64 };

/** Words of field_driver_t. */
extern const char *const options_drivers[FIELD_DRIVERS];

/** Runs in the field (field.h). */
typedef struct {
    bool wanted;         /**< the run is one in the field */
    bool mixture;        /**< mismatches are drawn, */
    double strength;     /**< times this */
    bool matched;        /**< nothing but the scales of thrust and DVL are drawn, as configured */
    bool perfect_thrust; /**< of the mixture, what is wrong with the thrust is left out */
    bool perfect_inputs; /**< every uncertainty is zero */
    const char *mismatch[FIELD_MISMATCHES]; /**< NAME=SIZE, as given */
    int mismatches;
    field_vehicle_t vehicle;
    field_driver_t driver;
    const char *chosen; /**< an option that needs the field, or null */
} options_field_t;

/** Everything that can be chosen. */
typedef struct {
    bool json;
    bool literal;
    uint64_t seed; /**< default 1 */
    /** Uncertainties that the identifier is told; negative: the library's default. */
    double thrust_scale, dvl_scale, delay_s;
    const vehicle_t *vehicle; /**< demo and bus; default Girona500 */

    /* demo */
    double disturbance_N; /**< rms of the unmodelled force; default 0, in scenarios 1 */
    double lag_s;         /**< of the thrusters; default 0 */
    uint32_t sets;        /**< of 30 s; default 8 */
    uint32_t runs;        /**< 0: one run, reported in full */
    uint32_t budget;      /**< of work in a tick [units]; default AUVID_DEFAULT_BUDGET */
    bool adaptive;        /**< excite what is not known yet, for as long as `sets` at most */
    const char *csv;      /**< file to write; null: none */
    const char *scenario; /**< null: none */
    options_field_t field;

    /* fit */
    const char *train;
    const char *validate; /**< null: none */
    double lower, upper;  /**< bounds of every parameter; default +-1000 */
    bool bias;
    bool linear_input;
    coupling_t coupling;
    const auvid_vehicle_t *model;        /**< default Girona500 */
    const char *choice[OPTIONS_CHOICES]; /**< NAME=VALUE (--fix) or NAME,.. (--free), as given */
    int choices;

    /* node, vehicle, replay; seed, sets, disturbance and csv as above */
    const char *bus;  /**< interface */
    const char *log;  /**< node: to be written, null: none; replay: to be read */
    const char *prior; /**< node, replay: record to begin with; null: none */
    const char *save; /**< node: record to be written; null: none */
    bool clock_own;   /**< the node gives the tick */
    bool excite;
    bool lock_step;
    bool realtime;
    bool no_arm;
    bool arm_again;
    uint32_t speed; /**< vehicle: its time goes so many times as fast; default 1 */
} options_t;

/** Read the arguments after the sub-command. Returns 0, or EXIT_REFUSED after one line on stderr.
 */
int options_demo(options_t *options, int count, char **argument);
int options_fit(options_t *options, int count, char **argument);
int options_node(options_t *options, int count, char **argument);
int options_vehicle(options_t *options, int count, char **argument);
int options_replay(options_t *options, int count, char **argument);

/** What was told of the uncertainty of thrust, DVL and delay, into *cfg. */
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
