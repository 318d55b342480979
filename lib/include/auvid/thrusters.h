/**
 * @file thrusters.h
 * Identifies thrusters together with the hull: dead band, a gain for each direction, first-order
 * lag.
 *
 * This model wraps a hull's model. Its parameters are the hull's, then four for each group of equal
 * thrusters. A thruster's force x follows its command c:
 *
 *     T x' = g(c) - x,   g(c) = k_forward (c - d)  for c > d,
 *                               k_backward (c + d) for c < -d,   0 in between,
 *
 * and the hull's equations hold for tau = B x. If a thruster's force is proportional to the square
 * of its speed, supply c |c| as its command. Mean commands over a row do not show which commands
 * exceed the dead band, nor how far the force has followed. So a log stores the commands of every
 * tick, and the model recomputes each row's thrust from them for each candidate.
 *
 *     auvid_thrusters_defaults(&cfg);                     then hull, matrix, group, log
 *     auvid_thrusters_init(&thrusters, &cfg, NULL);
 *     auvid_identifier_defaults(&id_cfg, &thrusters.vehicle);
 *     id_cfg.metric.rows = rows;                          then row_slots, free and fixed
 *     auvid_thrusters_configure(&thrusters, &id_cfg);
 *     auvid_identifier_init(&id, &id_cfg);
 *
 * From then on the identifier passes the commands that it receives (auvid_identifier_step,
 * auvid_identifier_applied) to the log. It uses the wrench supplied with them only for the
 * excitation test and for R2: supply your best model of the commands' wrench.
 *
 * Rows of two cells (metric.row_cells) are best. Over longer rows, the mean drag differs from the
 * drag of the mean velocity. With the usual five cells, linear drag is 1 to 2 % too large.
 *
 * Scale: Only ratios of masses, drags and gains are identifiable. At least one parameter that
 * scales with the force, a mass or a gain, must be known (metric.fixed, and not free in
 * metric.free). auvid_thrusters_configure also accepts a known parameter with little effect, but
 * then the estimates are poor.
 *
 * Prior: In field mixtures (tests/vehicles/test_thrusters_field.c) free thrusters absorb what the
 * model does not contain, and then masses and drags are wrong. If there is a data sheet, fix the
 * forward gain, fill `sheet`, and call auvid_thrusters_attach_prior.
 *
 * A restart (checkpoint.h) also needs the log. Save `state` and the log's bytes together with the
 * checkpoint, and restore them after auvid_thrusters_configure.
 *
 * Cost:
 * - Of a tick: 155 instructions of a Cortex-M4F for one thruster, 320 for five; 10k in the first
 *   tick after a gap in the commands.
 * - Of a row of 0.5 s for one candidate, with slots of 20 ms: 4.1k for one thruster, 8.6k for five;
 *   with slots of 40 ms 2.8k and 5.3k; 0.6k if only parameters of the hull have changed. The lag
 *   continues from row to row; the first row of a pass, or after a gap, follows it from three times
 *   `lag_max_s` before it.
 * - Work: auvid_identifier_work accounts for the full cost (vehicle.work) and computes a row in one
 *   piece. If a row costs more than a tick's budget, auvid adds up the budgets of several ticks.
 *   The last of them then takes longer than its budget. With eight thrusters, a lag up to 2 s and
 *   slots of 1 ms, a row is 800 units at once, and the first one of a pass 13000, three million
 *   instructions; with slots of 20 ms these are 50 and 660 units.
 * - Of a search, for the 16 parameters of a Girona500 and its five thrusters: Gauss-Newton steps
 *   find a minimum; 97 evaluations confirm it in the first search, 33 in each further one. With
 *   slots of 40 ms and AUVID_DEFAULT_BUDGET a first result from eight sets takes 126 s, a
 *   further one 30 s (median of 100 runs; tests/vehicles/test_search_thrusters.c).
 *
 * When the next set is full, auvid drops rows and commands until the search has ended. The commands
 * before the next rows may then displace the oldest set; 3 s more of slots for each set prevent it.
 *
 * Memory: sizeof(auvid_thrusters_t), 1.2 KiB, and the log, two bytes for each thruster and slot:
 * 3000 bytes for one thruster and a set of 30 s at 50 Hz. In addition, each row takes 240 bytes.
 * Unused code is not linked. Not available with AUVID_MAX_COMMANDS 0.
 */
#ifndef AUVID_THRUSTERS_H
#define AUVID_THRUSTERS_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

struct auvid_identifier_config; /* identifier.h */
struct auvid_identifier;
struct auvid_prior; /* prior.h */

/** Largest number of groups of equal thrusters. */
#define AUVID_THRUSTERS_GROUPS 4

/** Parameters of a group. Parameter k of group g has the index
 * hull->parameters + AUVID_THRUSTERS_PER_GROUP g + k. */
typedef enum {
    AUVID_THRUSTERS_FORWARD,   /**< gain of commands > 0 [N per unit of command], >= 0 */
    AUVID_THRUSTERS_BACKWARD,  /**< gain of commands < 0, same unit, >= 0 */
    AUVID_THRUSTERS_DEAD_BAND, /**< half width of the dead band [units of command] */
    AUVID_THRUSTERS_LAG,       /**< time constant [s] */
    AUVID_THRUSTERS_PER_GROUP
} auvid_thrusters_parameter_t;

/** Number of slots of a log for `sets` data sets of set_us [us] and the set being recorded. It
 * contains a margin of 9 s for the lag and the recorder's delay. period_us: slot length [us]. */
#define AUVID_THRUSTERS_SLOTS(sets, set_us, period_us)                                             \
    ((((sets) + 1u) * (set_us) + 9000000u) / (period_us))

/** What a data sheet says of a group of thrusters, and its standard deviations. Only
 * auvid_thrusters_attach_prior uses it. A deviation of 0: this parameter has no prior; others are
 * 1e-4..1. */
typedef struct {
    auvid_real_t gain;            /**< forward [N per unit], 0..gain_max, if the forward gain is
                                       free; default 0: free gains have no prior */
    auvid_real_t backward;        /**< backward gain over forward gain, 0..100; default 1 */
    auvid_real_t dead_band;       /**< [units], 0..dead_band_max; default 0 */
    auvid_real_t lag_s;           /**< [s], 0..2; default 0.15 */
    auvid_real_t gain_sigma;      /**< relative; default 0.05 */
    auvid_real_t backward_sigma;  /**< relative; default 0.05 */
    auvid_real_t dead_band_sigma; /**< relative to command_max; default 0.012 */
    auvid_real_t lag_sigma_s;     /**< [s]; default 0.06 */
} auvid_thrusters_sheet_t;

/** Configuration; copied at init. */
typedef struct {
    const auvid_vehicle_t *hull; /**< required; must outlive the thrusters. Any model */
    auvid_real_t matrix[AUVID_DOF_COUNT][AUVID_COMMAND_SLOTS]; /**< B: body wrench per newton of
                                                                   each thruster [-, m] */
    uint8_t thrusters;                  /**< their number, 1..AUVID_MAX_COMMANDS */
    uint8_t group[AUVID_COMMAND_SLOTS]; /**< of each; numbers from 0, no gaps; default 0 */
    auvid_real_t command_max;   /**< largest command of any source, hover thrust included [units],
                                     1e-6..AUVID_RECORDER_LARGEST; default 1. The log's
                                     resolution is 1/32767 of it. Larger commands are clipped to it
                                     and counted (state.clipped) */
    auvid_real_t gain_max;      /**< upper search bound of the gains [N per unit],
                                     1e-6..AUVID_RECORDER_LARGEST; default 1000 */
    auvid_real_t dead_band_max; /**< upper search bound of the dead band [units],
                                     1e-6..AUVID_RECORDER_LARGEST; default 0.5. Twice the expected
                                     value is better, because wide dead bands, low masses and long
                                     lags are a second, worse optimum. With a known gain and an
                                     unknown mass, 4 of 30 searches ended there and reported not
                                     identifiable; with 0.25 none did */
    auvid_real_t lag_max_s;     /**< upper search bound of the lag [s], 0.01..2; default 0.5. A
                                     larger bound makes rows more expensive */
    uint32_t delay_us;          /**< known transport delay of commands [us], 0..1e6; default 0 */
    uint32_t period_us; /**< slot length of the log [us]: the control tick; 1000..100000, default
                             20000. A slot holds the mean command; longer ones take less memory and
                             time */
    int16_t *log;       /**< [slots * thrusters], owned by the caller, must outlive the thrusters */
    uint32_t slots;     /**< see AUVID_THRUSTERS_SLOTS; >= 1, slots * period_us <= 4e9 */
    auvid_thrusters_sheet_t sheet[AUVID_THRUSTERS_GROUPS]; /**< by group */
} auvid_thrusters_config_t;

/** Geometry of rows in the log. Private. */
typedef struct {
    uint32_t row_us;    /* length of a row */
    uint32_t spread_us; /* width of the ramps at its ends, see auvid_thrusters_wrench.c */
    uint32_t lead;      /* slots before it, over which the lag settles */
    uint32_t bridged;   /* largest number of slots filled after a gap in the commands */
} auvid_thrusters_grid_t;

/** An interval of time that the log skips. Private. */
typedef struct {
    uint64_t end_us;  /* end of the interval */
    uint64_t long_us; /* its length */
} auvid_thrusters_pause_t;

/** What the last row leaves to the next one of the same candidate: each thruster's force, and its
 * derivatives, at the begin of a slot. So a pass over the rows follows the lag only once. Private.
 */
typedef struct {
    uint64_t t_us[2]; /* middle of the next row; [0] of the forces, [1] of their derivatives */
    uint32_t slot[2]; /* index of the slot */
    auvid_real_t pi[AUVID_THRUSTERS_GROUPS * AUVID_THRUSTERS_PER_GROUP]; /* the candidate */
    auvid_real_t force[AUVID_COMMAND_SLOTS];
    auvid_real_t response[AUVID_COMMAND_SLOTS][AUVID_THRUSTERS_PER_GROUP];
    bool ready[2]; /* has the slot been reached? */
} auvid_thrusters_carry_t;

/** State of the log. Written by the thrusters; save it for a restart, see above. */
typedef struct {
    uint64_t end_us;       /* end of the newest complete slot */
    uint64_t held_us;      /* the next slot is filled up to here */
    uint32_t head, filled; /* index of the next slot; number of slots kept */
    uint32_t clipped; /**< number of commands beyond command_max so far. If not 0, the log and all
                           estimates are wrong: make command_max larger */
    auvid_real_t held[AUVID_COMMAND_SLOTS];            /* last command */
    auvid_real_t filling[AUVID_COMMAND_SLOTS];         /* integral over the incomplete slot */
    auvid_thrusters_pause_t pause[AUVID_MAX_SETS + 2]; /* newest first */
    auvid_thrusters_carry_t carry;                     /* written by the model's functions */
    uint8_t pauses;                                    /* number of pauses */
    bool started;
} auvid_thrusters_state_t;

/** The thrusters. Members are private except `vehicle` and `state`. Must not move after
 * initialisation. */
typedef struct {
    auvid_thrusters_config_t cfg;
    auvid_vehicle_t vehicle; /**< pass this model to the identifier */
    auvid_parameter_t parameter[AUVID_MAX_PARAMETERS];
    auvid_thrusters_grid_t grid;
    auvid_thrusters_carry_t *carry; /* of `state`: the model's functions get a const context */
    auvid_thrusters_state_t state; /**< state of the log */
} auvid_thrusters_t;

#define auvid_thrusters_defaults AUVID_SIZED(auvid_thrusters_defaults)
/** Sets *cfg to the defaults. NULL is a no-op. */
void auvid_thrusters_defaults(auvid_thrusters_config_t *cfg);

#define auvid_thrusters_init AUVID_SIZED(auvid_thrusters_init)
/** Makes the model, with an empty log.
 * @param thrusters out; unchanged if refused
 * @param cfg copied; may be thrusters->cfg; cfg->hull and cfg->log must outlive *thrusters
 * @param refusal written: what is refused, e.g. part "sheet", field "lag_s", element 1, a group;
 * NULL: not wanted
 * @return AUVID_OK; AUVID_ERR_NULL (also log or hull); the errors of auvid_vehicle_check;
 * AUVID_ERR_RANGE (a field out of its range, group numbers with gaps); AUVID_ERR_NOT_FINITE
 * (any real); AUVID_ERR_PARAMETERS (more than AUVID_MAX_PARAMETERS together); AUVID_ERR_MODEL (a
 * group acts on no DoF that the hull models, or the hull is &thrusters->vehicle). */
auvid_status_t auvid_thrusters_init(auvid_thrusters_t *thrusters,
                                    const auvid_thrusters_config_t *cfg, auvid_refusal_t *refusal);

#define auvid_thrusters_configure AUVID_SIZED(auvid_thrusters_configure)
/** Prepares the identifier's configuration for this model. Call it after auvid_identifier_defaults
 * for &thrusters->vehicle, and after setting metric (rows, sets, free, fixed) and recorder.
 *
 * It sets cfg->listener, the search bounds of the thrusters' parameters, and metric.estimate_delay
 * (off, because a lag is not separable from a delay). You may change the bounds afterwards. The
 * log's length depends on metric.velocity_us: AUVID_VELOCITY_OBSERVED (the default) becomes 200000,
 * a DVL at 5 Hz.
 * @param cfg in and out; unchanged if refused
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_MODEL (cfg is for
 * another vehicle, or no known parameter sets the scale of the force in some DoF); AUVID_ERR_RANGE
 * (a row longer than 4294 s or more expensive than 65535 units of work, metric.velocity_us);
 * AUVID_ERR_SIZE (the log is too short for this number of sets). If refused, nothing changes. */
auvid_status_t auvid_thrusters_configure(auvid_thrusters_t *thrusters,
                                         struct auvid_identifier_config *cfg);

#define auvid_thrusters_attach_prior AUVID_SIZED(auvid_thrusters_attach_prior)
/** Attaches the data sheet of each group (auvid_thrusters_config_t.sheet) to the identifier as a
 * prior of the free parameters. Call it once, between auvid_identifier_init and the first step, in
 * place of auvid_identifier_attach_prior; prior.h says what it does on the residual path.
 *
 * The forward gains are best known (metric.fixed), as in the data sheet. Then the hull's
 * parameters scale with the thrust, and their standard errors contain
 * auvid_uncertainty_t.thrust_scale.
 * @param storage written; must outlive the identifier
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (thrusters or identifier not initialised);
 * AUVID_ERR_MODEL (the identifier has another model); AUVID_ERR_ATTACHED (a prior is attached
 * already); AUVID_ERR_STARTED (it has stepped, or recorded a wrench). After an error
 * nothing has changed. */
auvid_status_t auvid_thrusters_attach_prior(auvid_thrusters_t *thrusters,
                                            struct auvid_identifier *id,
                                            struct auvid_prior *storage);

#define auvid_thrusters_command AUVID_SIZED(auvid_thrusters_command)
/** Logs commands that are applied from t_us on. The identifier calls it; call it yourself only if
 * you use the metric without the identifier. A no-op before configure, for NULL thrusters, and for
 * times that do not advance.
 * @param t_us time of the commands [us]
 * @param command [AUVID_MAX_COMMANDS] [units]; NULL: zeros. A command that is not finite counts as
 * zero */
void auvid_thrusters_command(auvid_thrusters_t *thrusters, uint64_t t_us,
                             const auvid_real_t *command);

#define auvid_thrusters_wrench AUVID_SIZED(auvid_thrusters_wrench)
/** Computes the model's mean wrench B x over a row.
 * @param t_us middle of the row [us]
 * @param pi [n] parameters of thrusters->vehicle
 * @param wrench out, [6] N, Nm
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NO_DATA (the row is not in the log, or configure was
 * not called: wrench is zero). */
auvid_status_t auvid_thrusters_wrench(const auvid_thrusters_t *thrusters, uint64_t t_us,
                                      const auvid_real_t *pi, auvid_real_t *wrench);

#ifdef __cplusplus
}
#endif

#endif
