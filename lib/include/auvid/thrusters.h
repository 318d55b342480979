/**
 * @file thrusters.h
 * Thrusters identified together with the hull: dead band, a gain for each direction, first-order
 * lag.
 *
 * A model that wraps another one. Its parameters are the hull's, then four for each group of like
 * thrusters. A thruster's force x follows its command c by
 *
 *     T x' = g(c) - x,   g(c) = k_forward (c - d)  for c > d,
 *                               k_backward (c + d) for c < -d,   0 in between,
 *
 * and the hull's equations hold for tau = B x. (A thruster whose force goes with the square of its
 * speed: give c |c| as its command.) Which commands pass the dead band, and how far the force has
 * followed, cannot be told from means over a row: the commands of every tick are kept in a log, and
 * each row's thrust is formed anew for each candidate, from commands on.
 *
 *     auvid_thrusters_defaults(&cfg);                     then hull, matrix, group, log
 *     auvid_thrusters_init(&thrusters, &cfg);
 *     auvid_identifier_defaults(&id_cfg, &thrusters.vehicle);
 *     id_cfg.metric.rows = rows;                          then free and fixed
 *     auvid_thrusters_configure(&thrusters, &id_cfg);
 *     auvid_identifier_init(&id, &id_cfg);
 *
 * From there on the identifier hands over what it is told of commands (auvid_identifier_step,
 * auvid_identifier_applied). The wrench that it is told beside them is read for what is driven and
 * for R2 only: give what you think the commands make.
 *
 * Rows of two cells (metric.row_cells) are best: over longer ones drag is not that of the mean
 * velocity; with the usual five, linear drag comes out 1 to 2 % too large.
 *
 * Scale. Only ratios of masses, drags and gains can be seen. Something that says how large a force
 * is must be known (metric.fixed, and not free in metric.free): a mass, or a gain. A parameter that
 * matters little will do for auvid_thrusters_configure, not for good estimates.
 *
 * A restart (checkpoint.h) needs the log, too: save `state` and the log's bytes at the same time as
 * the checkpoint, and put them back after auvid_thrusters_configure.
 *
 * Cost: of a tick 155 instructions of a Cortex-M4F for one thruster, 320 for five (10k in the tick
 * after a silence); of a row of 0.5 s of one candidate 6.6k and 18k, half of that with slots of
 * 40 ms, most of it for following the lag from three times `lag_max_s` before the row on. work()
 * pays for it in full (vehicle.work), and works a row in one piece: where a row costs more than the
 * budget of a tick, several ticks pay, and the last of them takes longer than its budget. With
 * eight thrusters, a lag of up to 2 s and slots of 1 ms that are 4500 units at once, a million
 * instructions; with slots of 20 ms 230. A search takes some 340 evaluations for the six parameters
 * of one axis, 1150 for a Girona500 and its thrusters. At AUVID_DEFAULT_BUDGET one
 * outlasts a set by far. When the next set is full, neither rows nor commands are kept until the
 * search has ended. What then leads in to the next rows may cost the oldest set: 3 s more of slots
 * for each set keep it.
 * Memory: sizeof(auvid_thrusters_t), 0.7 KiB; and the log, two bytes for each thruster and slot:
 * 3000 bytes for a thruster and a set of 30 s at 50 Hz, beside the 240 bytes of each row. Nothing
 * is linked where it is not used. Not with AUVID_REGRESSOR_ONLY.
 */
#ifndef AUVID_THRUSTERS_H
#define AUVID_THRUSTERS_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

struct auvid_identifier_config; /* identifier.h */

/** Groups of like thrusters, at most. */
#define AUVID_THRUSTERS_GROUPS 4

/** Parameters of a group g: number hull->parameters + AUVID_THRUSTERS_PER_GROUP g + these. */
typedef enum {
    AUVID_THRUSTERS_FORWARD,   /**< gain for commands > 0 [N per unit of command] */
    AUVID_THRUSTERS_BACKWARD,  /**< and < 0, a positive number, too */
    AUVID_THRUSTERS_DEAD_BAND, /**< half its width [units of command] */
    AUVID_THRUSTERS_LAG,       /**< time constant [s] */
    AUVID_THRUSTERS_PER_GROUP
} auvid_thrusters_parameter_t;

/** Slots that the log needs for `sets` data sets of set_us, the one being recorded, and a margin
 * of 9 s for the lag and what the recorder is behind. */
#define AUVID_THRUSTERS_SLOTS(sets, set_us, period_us)                                             \
    ((((sets) + 1u) * (set_us) + 9000000u) / (period_us))

/** Configuration; copied at init. */
typedef struct {
    const auvid_vehicle_t *hull; /**< required; must outlive the thrusters. Any model */
    auvid_real_t matrix[AUVID_DOF_COUNT][AUVID_MAX_COMMANDS]; /**< body wrench per newton of each
                                                       thruster [-, m] */
    uint8_t thrusters;                 /**< how many: the first so many commands; 1.. */
    uint8_t group[AUVID_MAX_COMMANDS]; /**< of each, from 0 on without holes; default all 0 */
    auvid_real_t command_max;   /**< largest command of any source (hover thrust too) [units],
                                     1e-6..AUVID_RECORDER_LARGEST; the log keeps steps of a 32767th
                                     of it, larger ones count as it (state.clipped counts them);
                                     default 1 */
    auvid_real_t gain_max;      /**< the box of the search: gains 0.. this [N per unit], within the
                                     same; default 1000 */
    auvid_real_t dead_band_max; /**< likewise [units]; default 0.5. Twice what you expect is better:
                                     wide dead bands, low masses and long lags are a worse optimum.
                                     With a gain known instead of the mass, 4 of 30 searches ended
                                     there (and said not identifiable), with 0.25 none */
    auvid_real_t lag_max_s;     /**< likewise; 0.01..2, default 0.5. Rows cost the more, the longer
                                     it is */
    uint32_t delay_us;  /**< known transport delay of commands [us], ..1e6; default 0 */
    uint32_t period_us; /**< a slot of the log [us]: the control tick; 1000..100000, default 20000.
                             Slots hold the mean command; longer ones take less memory and time */
    int16_t *log;       /**< [slots * thrusters], owned by the caller, must outlive the thrusters */
    uint32_t slots;     /**< see AUVID_THRUSTERS_SLOTS; slots * period_us <= 4e9 */
} auvid_thrusters_config_t;

/** How rows stand in the log. Private. */
typedef struct {
    uint32_t row_us;    /* length of a row */
    uint32_t spread_us; /* by which its ends are spread, see the .c file */
    uint32_t lead;      /* slots before it from which the lag is followed */
    uint32_t bridged;   /* slots filled after a silence, at most */
} auvid_thrusters_grid_t;

/** A stretch of time that the log leaves out. Private. */
typedef struct {
    uint64_t end_us;  /* the log goes on from here */
    uint64_t long_us; /* its length */
} auvid_thrusters_pause_t;

/** What is in the log. Written by the thrusters; a restart takes it along, see above. */
typedef struct {
    uint64_t end_us;                          /* up to here slots are complete */
    uint64_t held_us;                         /* up to here the next one is filled */
    uint32_t head, filled;                    /* where the next slot goes; slots kept */
    uint32_t clipped; /**< commands beyond command_max so far: not 0, then the log has them wrong,
                           and so are all estimates; make command_max larger */
    auvid_real_t held[AUVID_MAX_COMMANDS];    /* last command */
    auvid_real_t filling[AUVID_MAX_COMMANDS]; /* integral of the slot under way */
    auvid_thrusters_pause_t pause[AUVID_MAX_SETS + 2]; /* the newest first */
    uint8_t pauses;                                    /* how many */
    bool started;
} auvid_thrusters_state_t;

/** The thrusters. Fields are private but for `vehicle` and `state`. Must stay where it was
 * initialised. */
typedef struct {
    auvid_thrusters_config_t cfg;
    auvid_vehicle_t vehicle; /**< the model for the identifier */
    auvid_parameter_t parameter[AUVID_MAX_PARAMETERS];
    auvid_thrusters_grid_t grid;
    auvid_thrusters_state_t state; /**< of the log */
} auvid_thrusters_t;

#define auvid_thrusters_defaults                                                                   \
    AUVID_SIZED2(auvid_thrusters_defaults, AUVID_MAX_PARAMETERS, AUVID_MAX_COMMANDS)
/** Fill *cfg with the defaults. Null is ignored. */
void auvid_thrusters_defaults(auvid_thrusters_config_t *cfg);

#define auvid_thrusters_init AUVID_SIZED(auvid_thrusters_init)
/** Make the model; the log is empty.
 * @return AUVID_OK; AUVID_ERR_NULL (log, hull too); those of auvid_vehicle_check; AUVID_ERR_RANGE
 * (a field out of its range, groups with holes); AUVID_ERR_NOT_FINITE (matrix);
 * AUVID_ERR_PARAMETERS (more than AUVID_MAX_PARAMETERS together); AUVID_ERR_MODEL (a group acts on
 * no DoF that the hull models, or the hull is thrusters->vehicle). Refused: *thrusters is
 * unchanged. */
auvid_status_t auvid_thrusters_init(auvid_thrusters_t *thrusters,
                                    const auvid_thrusters_config_t *cfg);

#define auvid_thrusters_configure AUVID_SIZED(auvid_thrusters_configure)
/** Make the identifier's configuration that of this model: after auvid_identifier_defaults for
 * &thrusters->vehicle, and after metric (rows, sets, free, fixed) and recorder are as they shall
 * be. Sets cfg->listener, the box of the thrusters' parameters (change it afterwards where you know
 * better) and metric.estimate_delay (off: a lag is not told from a delay).
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_MODEL (cfg is for
 * another vehicle; or nothing that is known says how large a force is, in some DoF);
 * AUVID_ERR_RANGE (a row longer than 4294 s or dearer than 65535 units of work,
 * metric.velocity_us); AUVID_ERR_SIZE (the log is too short for so many sets). Refused: nothing is
 * changed. */
auvid_status_t auvid_thrusters_configure(auvid_thrusters_t *thrusters,
                                         struct auvid_identifier_config *cfg);

#define auvid_thrusters_command AUVID_SIZED(auvid_thrusters_command)
/** The commands hold from t_us on; nothing is done before configure. For users of the metric alone:
 * the identifier calls it.
 * @param command [AUVID_MAX_COMMANDS]; null: zeros. What is not finite counts as zero, times that
 * do not advance are ignored. */
void auvid_thrusters_command(auvid_thrusters_t *thrusters, uint64_t t_us,
                             const auvid_real_t *command);

#define auvid_thrusters_wrench AUVID_SIZED(auvid_thrusters_wrench)
/** Mean wrench B x over a row, as the model has it.
 * @param t_us middle of the row
 * @param pi [n] of thrusters->vehicle
 * @param wrench [6] N, Nm
 * @return AUVID_OK; AUVID_ERR_NO_DATA (not in the log: wrench is zero). */
auvid_status_t auvid_thrusters_wrench(const auvid_thrusters_t *thrusters, uint64_t t_us,
                                      const auvid_real_t *pi, auvid_real_t *wrench);

#ifdef __cplusplus
}
#endif

#endif
