/**
 * @file identifier.h
 * The identifier: the scheme of Fig. 2, composed. Two calls, from one task:
 *
 *     auvid_identifier_step   in every control tick: sense, navigate, record, excite. Short.
 *     auvid_identifier_work   whenever there is time left: so many units of optimizing.
 *
 * Data flow: sensors -> navigation (nav.h) -> recorder (recorder.h) -> metric (metric.h) <->
 * optimizer (optimizer.h) -> estimate. Each completed data set starts a global search with the last
 * estimate as a known good point. A search ends on the sets that it began with. Sets that complete
 * during a search wait until it has ended; then one search takes them all. Before it is used, each
 * set is predicted by the last estimate, the oldest first: that is how a changed vehicle, and an
 * estimate worse than the one before, are noticed. For a model without regressor the delay is one
 * more parameter of the search, and one set can wait: while it does, no rows are recorded. In the
 * regressor path (sets - 1) / 2 sets can wait; of more, the oldest is lost.
 *
 * Cost of step: one prediction of the filter, the updates that arrived, at most
 * AUVID_CELLS_PER_STEP cells of the recorder. Cost of work: never more than `budget` units, each of
 * about 250 instructions of a Cortex-M4F: a row of a triangle, a trial point (rejected ones count
 * too), a stored sample put through the user's model (vehicle.work units, paid by several calls
 * where the budget is less, and done in one piece by the last of them). To begin a search, m n
 * random numbers, is 100.
 * Memory: sizeof(auvid_identifier_t), all there is.
 *
 * The excitation acts only while the guard (guard.h) permits it: auvid_identifier_arm, then
 * auvid_identifier_excite. A breach of a limit, a sensor gone silent, a refused step: excitation
 * zero in that very tick, latched until auvid_identifier_disarm. Recording and searching go on.
 * What comes through auvid_identifier_motion the guard does not see: exciting needs sensors.
 */
#ifndef AUVID_IDENTIFIER_H
#define AUVID_IDENTIFIER_H

#include "auvid/allocation.h"
#include "auvid/confidence.h"
#include "auvid/excitation.h"
#include "auvid/guard.h"
#include "auvid/metric.h"
#include "auvid/nav.h"
#include "auvid/optimizer.h"
#include "auvid/recorder.h"
#include "auvid/types.h"
#include "auvid/validation.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Cells taken from the recorder in one step at most. So a tick must not be longer than this many
 * cells, or the record breaks again and again. */
#define AUVID_CELLS_PER_STEP 2

/** A budget of work that suits a Cortex-M4 at a 50 Hz tick: a result three seconds after a set
 * (Girona500, one set or eight). */
#define AUVID_DEFAULT_BUDGET 150u

/** Which DVL lock the dynamics are taken from. They need velocity through the water. */
typedef enum {
    AUVID_VELOCITY_GROUND = 0, /**< bottom lock: right where there is no current */
    AUVID_VELOCITY_WATER = 1   /**< water lock only */
} auvid_velocity_source_t;

/** Where and how the optimizer searches. */
typedef struct {
    auvid_real_t lower[AUVID_MAX_PARAMETERS]; /**< the box [parameter's unit]; default
                                                   -1000 */
    auvid_real_t upper[AUVID_MAX_PARAMETERS]; /**< default 1000 */
    auvid_real_t good[AUVID_MAX_PARAMETERS];  /**< a known good point */
    bool has_good;                            /**< use it; default false. Clipped to the bounds */
    uint16_t population;  /**< m of Algorithm 1; 0: four times the number of parameters, as far as
                                AUVID_MAX_POPULATION allows */
    auvid_real_t omega;   /**< of Algorithm 1; 0: the number of parameters, as in the paper */
    bool scale_by_bounds; /**< steps of the line search relative to the bounds, not to the data */
    bool paper;           /**< Algorithm 2 without pattern steps; default false */
    uint64_t seed;        /**< of the search; default 1 */
} auvid_search_config_t;

/** Somebody who keeps a log of commands (thrusters.h). */
typedef struct {
    /** A command holds from t_us on; null: zeros. From step and applied. */
    void (*command)(void *context, uint64_t t_us, const auvid_real_t *command);
    /** Sets are complete, and those of the ring are about to be evaluated: time to drop some. From
     * work. */
    void (*set)(void *context, auvid_metric_t *metric);
    /** Residual path: while rows are dropped because a search is under way, `command` is not
     * called. How long commands must have been given again before the middle of the next row [us];
     * null: 0. From work. */
    uint64_t (*lead_us)(void *context);
} auvid_listener_t;

/** Configuration; copied at init. Pointers within must outlive the identifier. */
typedef struct auvid_identifier_config {
    const auvid_vehicle_t *vehicle;       /**< required; set by defaults */
    auvid_nav_config_t nav;               /**< see nav.h */
    auvid_recorder_config_t recorder;     /**< see recorder.h; its cell is the metric's too */
    auvid_metric_config_t metric;         /**< see metric.h; vehicle and cell are set at init.
                                                  Residual path with estimate_delay off: the delay
                                                  of all is delay_s[0] */
    auvid_allocation_config_t allocation; /**< see allocation.h; no thrusters: the excitation is
                                                  not limited by them */
    auvid_excitation_config_t excitation; /**< see excitation.h; no segments: passive */
    auvid_guard_config_t guard;           /**< see guard.h: the limits; set them for your site */
    auvid_velocity_source_t velocity;     /**< default AUVID_VELOCITY_GROUND */
    bool velocity_every_tick; /**< record the filter's velocity in every tick, not at DVL updates:
                                   for our literal reading of the paper. Not with water lock.
                                   Default false */
    auvid_search_config_t search; /**< bounds, good point and options of the search */
    auvid_real_t dry_mass_kg; /**< a mass below is implausible [kg], >= 0, below the upper bounds of
                                   all free masses; default 0: not known */
    auvid_uncertainty_t uncertainty; /**< see confidence.h; default 0.05 of the thrust, 0.005 of
                                          the DVL, 0.1 s of the delay; 0: all is as told */
    const auvid_listener_t *listener; /**< default null: nobody */
    void *listener_context;           /**< its context */
} auvid_identifier_config_t;

/** What arrived since the last tick. Zero what did not. */
typedef struct {
    uint64_t t_us; /**< this tick [us]; must advance from step to step */
    struct {
        bool present;
        uint64_t t_us;            /**< time of the sample */
        auvid_real_t attitude[3]; /**< phi theta psi [rad] */
        auvid_real_t rates[3];    /**< p q r [rad/s] */
    } imu;
    struct {
        bool present;
        auvid_dvl_sample_t sample; /**< nav.h */
    } dvl;
    struct {
        bool present;
        auvid_dvl_sample_t sample; /**< the other lock's, of a DVL that has both at once */
    } dvl_water;
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t depth_m; /**< positive down */
    } depth;
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t x_m, y_m; /**< north, east of the origin */
    } gps;
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t altitude_m; /**< above the bottom, >= 0; of the DVL, say. For the guard only */
    } altitude;
    struct {
        bool present;
        /** Applied from t_us of this tick on, of all sources: pilot, controller, excitation [N,
         * Nm]. Who learns of it later (the excitation is an answer of this very step; feedback
         * tells of the tick gone by) leaves it out here and calls auvid_identifier_applied with its
         * time. */
        auvid_real_t wrench[AUVID_DOF_COUNT];
        auvid_real_t command[AUVID_MAX_COMMANDS]; /**< thruster commands, for models that use them
                                                        */
    } applied;
    bool saturated; /**< the thrusters are at a limit now, for whatever reason; for the guard. That
                         the excitation alone is too much is known without */
} auvid_input_t;

/** News, a bit each; several at once. */
enum {
    AUVID_EVENT_TIME = 1u << 0,              /**< the tick's time did not advance: step refused */
    AUVID_EVENT_IMU_DROPPED = 1u << 1,       /**< sample refused: counted in nav.imu_time or
                                              nav.imu_invalid; not counted when ahead of
                                              the tick by more than nav.future_us */
    AUVID_EVENT_DVL_DROPPED = 1u << 2,       /**< sample refused, now or, where it had to wait for
                                              a later IMU, when the IMU came to its time (nav.h);
                                              why is in nav.diagnostics. Ahead of the tick by more
                                              than nav.future_us is `stale` there. One that is lost
                                              because another one waits is no event: `unused` */
    AUVID_EVENT_DEPTH_DROPPED = 1u << 3,     /**< likewise */
    AUVID_EVENT_GPS_DROPPED = 1u << 4,       /**< likewise */
    AUVID_EVENT_INPUT_DROPPED = 1u << 5,     /**< applied wrench refused: not finite, beyond
                                              AUVID_RECORDER_LARGEST, or one was given for this
                                              time before */
    AUVID_EVENT_VELOCITY_STALE = 1u << 6,    /**< no DVL sample accepted for nav.stale_us */
    AUVID_EVENT_GAP = 1u << 7,               /**< the record was broken and started anew */
    AUVID_EVENT_SET = 1u << 8,               /**< a data set was completed */
    AUVID_EVENT_NOT_EXCITED = 1u << 9,       /**< no DoF with a free parameter was driven in
                                              the set: it is left out, the estimate stays */
    AUVID_EVENT_ESTIMATE = 1u << 10,         /**< a search has ended: there is a new estimate */
    AUVID_EVENT_EXCITATION_DONE = 1u << 11,  /**< the excitation's run came to its end */
    AUVID_EVENT_ALTITUDE_DROPPED = 1u << 12, /**< sample refused: not finite, negative, not newer
                                                  than the one before, or ahead of the tick by more
                                                  than nav.future_us */
    AUVID_EVENT_ABORTED = 1u << 13,          /**< the guard aborted; why is in guard.trip */
    AUVID_EVENT_SETTLED = 1u << 14,   /**< the run is over and the vehicle calm (or the guard has
                                         given up waiting): the guard is DONE */
    AUVID_EVENT_VALIDATED = 1u << 16, /**< a set was predicted before it was used: see judgement */
    AUVID_EVENT_CHANGED = 1u << 17,   /**< the vehicle has changed: older sets are dropped, a search
                                          begins without the last estimate */
    AUVID_EVENT_RESTORED = 1u << 18,  /**< the last estimate predicted a new set worse than the one
                                          accepted before, which is the estimate again. Not where
                                          other DoF were driven in that one */
    AUVID_EVENT_ROWS_DROPPED = 1u << 19 /**< a search has taken so long that complete rows were
                                          dropped; counted in metric.rows_dropped. Regressor path:
                                          a waiting set. Residual path: rows of the next one */
};

/** Answer of a step. */
typedef struct {
    uint32_t events;                              /**< AUVID_EVENT_... since the last step */
    auvid_real_t excitation[AUVID_DOF_COUNT];     /**< body wrench to add to the controller's [N,
                                                      Nm]; zero unless exciting, and on any status <
                                                      0 */
    auvid_real_t thruster_N[AUVID_MAX_THRUSTERS]; /**< the same as thruster forces [N] */
    auvid_guard_state_t guard;                    /**< after this step */
    auvid_guard_cause_t cause; /**< why ABORTED; value, limit and time are in guard.trip */
} auvid_output_t;

/** Result of a search. */
typedef struct {
    uint32_t number;     /**< 0: none yet; raised by one with each */
    uint64_t t_us;       /**< last tick before it was ready */
    uint32_t sets;       /**< data sets completed when its search was prepared */
    uint32_t identified; /**< bit i: parameter i was free and its DoF driven; others hold `fixed`,
                              or what serves the driven DoF best (auvid_metric_searched) */
    uint8_t excited;     /**< bit j: DoF j was driven */
    auvid_real_t pi[AUVID_MAX_PARAMETERS]; /**< parameters, in the model's order */
    /** Covariance of the n parameters with thrust and DVL scale as told, packed: rows of the upper
     * triangle, the first has n entries; 0 where it is not known. The total has the products of
     * confidence.thrust_error and of .dvl_error added. */
    auvid_real_t covariance[AUVID_COVARIANCE];
    auvid_real_t speed[AUVID_DOF_COUNT][2]; /**< largest speed, >= 0, forward and backward, in the
                                                 sets in which the DoF was driven [m/s, rad/s] */
    auvid_real_t cost;                     /**< J, Eq. 11, in the metric's units */
    auvid_real_t delay_s[AUVID_DOF_COUNT]; /**< between wrench and response; negative: the wrench's
                                                stamps are late */
    uint8_t first_order_lag; /**< bit j: DoF j's delay is that of a first-order lag, not a shift */
    auvid_real_t r2_force[AUVID_DOF_COUNT]; /**< of the smoothed wrench; see auvid_metric_r2 */
    uint32_t evaluations_crs;               /**< cost evaluations of this search, global phase */
    uint32_t evaluations_line;              /**< local phase */
    /** the search has not converged: a cap ended the local phase, no point had a finite cost, or,
     * for a model with regressor, the cost exceeds the least one within the bounds by more than a
     * thousandth of that (with the part that no parameters explain). With a regressor nothing is
     * identifiable then. Without one the least cost is not known: a search may end above it
     * unnoticed, and one that a cap ended keeps its flags: treat them with care */
    bool not_converged;
    bool accepted; /**< it has predicted a set that it had not seen, about as well as the estimate
                        accepted before, or better */
    auvid_confidence_t confidence; /**< how sure it is; see confidence.h */
} auvid_estimate_t;

/** Drag force at a speed. */
typedef struct {
    auvid_real_t speed;      /**< as asked for; < 0: backward [m/s, rad/s] */
    auvid_real_t force;      /**< of the water on the hull [N, Nm]; its sign is not that of speed
                                  where it dissipates */
    auvid_real_t sigma;      /**< standard error [N, Nm]; AUVID_LARGEST: not known */
    auvid_real_t half_width; /**< 95 %: AUVID_CONFIDENCE_HALF_WIDTH of them; AUVID_LARGEST: not
                                  known */
    bool identifiable; /**< the half-width is at most AUVID_CONFIDENCE_IDENTIFIABLE of the force,
                            the force opposes the motion, the DoF was driven up to this speed in
                            this direction, no parameter of its equation is implausible, and the
                            search converged */
} auvid_drag_t;

/** Speed up to which a drag force may be identifiable, relative to the largest seen. */
#define AUVID_DRAG_REACH AUVID_C(1.05)

/** How well the last estimate foretold the newest set, before that set was used. */
typedef struct {
    uint32_t set;      /**< number of the set, from 1; 0: none was judged yet */
    uint32_t estimate; /**< number of the estimate that foretold it */
    uint8_t excited;   /**< bit j: DoF j was driven in it and in the estimate's data */
    uint8_t changed;   /**< bit j: the vehicle has changed, most clearly in this DoF; 0: it has not,
                            or there are too few sets to tell */
    auvid_real_t
        variance_ratio[AUVID_DOF_COUNT];  /**< mean square of the force residual over that of
                            the estimate's own data; about 1, more while there are few sets */
    auvid_real_t change[AUVID_DOF_COUNT]; /**< evidence for other parameters in this DoF (Chow's F
                            less 1) over its threshold; in the DoF that shows it most, the sum's
                            over that of the sum, if that is more: above 1, the vehicle has
                            changed. 0: none, or fewer than six sets, or an estimate of fewer
                            than five */
    auvid_real_t r2_velocity[AUVID_DOF_COUNT]; /**< of the velocity simulated through the set, from
                            when the estimate was there; see validation.h */
    uint8_t simulated;                         /**< bit j: r2_velocity is there */
} auvid_change_test_t;

/** Where work() is. */
typedef enum {
    AUVID_WORK_IDLE,        /**< nothing to do until a set completes */
    AUVID_WORK_PREPARE,     /**< residual path: the new set is made ready for what follows */
    AUVID_WORK_PREDICT,     /**< the last estimate is held against the new set */
    AUVID_WORK_COMPARE,     /**< so is the one accepted before */
    AUVID_WORK_CHANGE_TEST, /**< new sets are held against older ones */
    AUVID_WORK_MERGE,       /**< sets are brought together, and a search is begun */
    AUVID_WORK_ASK,         /**< the optimizer is to give a point */
    AUVID_WORK_COST,        /**< its cost is being evaluated */
    AUVID_WORK_MEASURE,     /**< the result's residuals are measured */
    AUVID_WORK_LINEARISE, /**< residual path: so are their derivatives; else: the least cost within
                               the bounds is found */
    AUVID_WORK_CONFIDENCE /**< standard errors and notes */
} auvid_work_phase_t;

/** State of the adaptive excitation (adaptive.h). */
typedef struct {
    uint32_t missing;  /**< bit i: parameter i is excited for, and not known yet */
    uint32_t abandoned; /**< bit i: parameter i is not known, and nothing is done about it: its DoF
                            is not excited, or all data within the run would not do */
    uint8_t playing;    /**< bit j: DoF j is excited at present */
    uint8_t tried[AUVID_DOF_COUNT];         /* sets recorded while it was, 255: that or more */
    uint16_t close_rows;                    /* complete the set at so many rows; 0: when full */
    uint32_t estimate;                      /* number of the one looked at last */
    uint32_t sets;                          /* recorded by then */
    uint32_t rng[4];                        /* state of the random generator */
    uint64_t run_us;                        /* start of the run that all this belongs to */
    uint32_t from_us[AUVID_DOF_COUNT];      /* beginning of the hold, since then */
    uint32_t hold_us[AUVID_DOF_COUNT];      /* its length */
    auvid_real_t before[AUVID_DOF_COUNT];   /* factor of the amplitude from which it fades */
    auvid_real_t level[AUVID_DOF_COUNT];    /* to this one */
    auvid_real_t factor[AUVID_DOF_COUNT];   /* in the last tick */
    auvid_real_t low_owed[AUVID_DOF_COUNT]; /* time that low levels are behind their part [s] */
    auvid_real_t excursion_limit[AUVID_DOF_COUNT]; /* of the configuration */
} auvid_adaptive_t;

/** The identifier. Modules are public to read; write only through the functions. */
typedef struct auvid_identifier {
    auvid_search_config_t search; /**< as configured; the modules hold the rest */
    auvid_velocity_source_t velocity;
    bool velocity_every_tick;
    auvid_real_t dry_mass_kg;
    auvid_uncertainty_t uncertainty;
    auvid_nav_t nav;
    auvid_recorder_t recorder;
    auvid_metric_t metric;
    auvid_allocation_t allocation;
    auvid_excitation_t excitation;
    auvid_adaptive_t adaptive; /**< missing and given_up are public to read */
    void (*adapt)(struct auvid_identifier *id, auvid_real_t *wrench); /* null: play the sequence; so
                                                       that its code is linked only where used */
    /** state, trip and refused are public; auvid_guard_heartbeat may be called */
    auvid_guard_t guard;
    auvid_estimate_t estimate;   /**< the last result */
    auvid_estimate_t accepted_estimate;  /* the last accepted one */
    auvid_change_test_t change_test;     /**< of the newest set */
    auvid_validation_t prediction;       /* of the set being recorded, by the last estimate */
    auvid_real_t predicted;              /* cost of the last estimate on the new set */
    auvid_validation_t *validation;      /* fed with every cell, if attached */
    const auvid_listener_t *listener;    /* as configured */
    void *listening;
    uint64_t t_us;                       /* last tick */
    uint32_t last_sample;                /* sequence of the last velocity recorded */
    uint32_t events;                     /* since the last step */
    uint32_t searches;                   /**< begun so far */
    uint32_t sets;                       /* completed when the sets at hand were taken up */
    uint32_t work_last;                  /**< units used by the last call of work */
    uint32_t max_work;                   /**< most units used by any call of work */
    uint8_t phase;                       /**< auvid_work_phase_t */
    uint8_t parameter_of[AUVID_MAX_PARAMETERS]; /* parameter that the optimizer's i-th is */
    uint32_t active;                     /* parameters in the present search */
    auvid_real_t candidate[AUVID_MAX_PARAMETERS]; /* all parameters of the point out */
    auvid_real_t delay_s;                         /* its delay, where that is searched too */
    bool started;
    bool starting;               /* the excitation: with the next step */
    bool saturated;              /* the excitation's own allocation was, in the last step */
    auvid_guard_seen_t altitude; /* last sample taken */
    auvid_guard_seen_t applied;  /* last wrench recorded */
    auvid_real_t altitude_m;
    auvid_real_t home[AUVID_DOF_COUNT]; /* position and attitude where the excitation began */
    auvid_optimizer_work_t searched;    /* by the search that has ended */
    auvid_real_t cost;                  /* its result's */
    uint8_t spent;    /* 1 and more: all is merged; of what the search costs to begin */
    uint8_t untested; /* completed sets that are still to be judged before the merge */
    bool set_pending, searching, not_converged;
    bool straddles_change; /* the set before may be from before and after a change */
    bool cold_start;       /* search without the last estimate */
    union { /* in turn: the search is over when its result is assessed */
        auvid_identifier_config_t config; /**< may be filled here for init; void afterwards */
        auvid_optimizer_t optimizer;
        auvid_bounded_ls_t optimum;
        auvid_confidence_job_t confidence;
    };
} auvid_identifier_t;

#define auvid_estimate_covariance AUVID_SIZED(auvid_estimate_covariance)
/** Covariance of two parameters with thrust and DVL scale as told; i = k: a variance. For the total
 * add thrust_error[i] thrust_error[k] + dvl_error[i] dvl_error[k] of the confidence.
 * @param vehicle the estimate's model
 * @param i, k numbers of parameters, in either order
 * @return in the product of their units; 0 if one of them is not known, or for null or a number out
 * of range. Cost: O(1). */
auvid_real_t auvid_estimate_covariance(const auvid_estimate_t *estimate,
                                       const auvid_vehicle_t *vehicle, int i, int k);

#define auvid_identifier_defaults AUVID_SIZED(auvid_identifier_defaults)
/** Fill *cfg for a vehicle: every module's defaults, all parameters of the model free (Girona500:
 * the 13 of Eq. 12-15), bounds +-1000, passive. Null is ignored. */
void auvid_identifier_defaults(auvid_identifier_config_t *cfg, const auvid_vehicle_t *vehicle);

#define auvid_identifier_literal AUVID_SIZED(auvid_identifier_literal)
/** Change *cfg to our reading of the paper's metric: states smoothed, every tick, wrench raw. */
void auvid_identifier_literal(auvid_identifier_config_t *cfg);

#define auvid_identifier_init AUVID_SIZED(auvid_identifier_init)
/** Check the arithmetic (selftest.h) and the configuration, and start.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_ARITHMETIC; for the search over the free parameters
 * those of auvid_crs_check (AUVID_ERR_BOUNDS, AUVID_ERR_POPULATION, AUVID_ERR_PARAMETERS, ...);
 * AUVID_ERR_NOT_FINITE (the good point, the uncertainty, too); AUVID_ERR_LIMIT (the excitation asks
 * for more than the thrusters give); AUVID_ERR_RANGE (velocity: unknown, or water lock in every
 * tick; dry mass below zero; an uncertainty below zero or above 1); AUVID_ERR_DRY_MASS (not below
 * the upper bound of a free mass, which could not be plausible); and the errors of the modules'
 * init. On error every other function refuses *id with AUVID_ERR_STATE; so it does one that is all
 * zeros.
 * @param cfg may be id->config: no memory besides. It is void afterwards. */
auvid_status_t auvid_identifier_init(auvid_identifier_t *id, const auvid_identifier_config_t *cfg);

#define auvid_identifier_arm AUVID_SIZED(auvid_identifier_arm)
/** Let the guard watch: from now on a breach aborts. Needs a step with fresh sensors behind it, so
 * call it until it is done, and then auvid_identifier_excite; nothing acts by itself later.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, no excitation configured, or
 * the guard is neither DISARMED nor DONE); AUVID_ERR_STALE, AUVID_ERR_LIMIT (see auvid_guard_arm;
 * why is in guard.refused). */
auvid_status_t auvid_identifier_arm(auvid_identifier_t *id);

#define auvid_identifier_excite AUVID_SIZED(auvid_identifier_excite)
/** Begin the excitation with the next step.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (the guard is not ARMED). */
auvid_status_t auvid_identifier_excite(auvid_identifier_t *id);

#define auvid_identifier_stop AUVID_SIZED(auvid_identifier_stop)
/** The normal end: the excitation fades out, then the guard is SETTLING and at last DONE.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not exciting). */
auvid_status_t auvid_identifier_stop(auvid_identifier_t *id);

#define auvid_identifier_abort AUVID_SIZED(auvid_identifier_abort)
/** The emergency stop: zero from the next step on, without a fade, latched; from any state.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_identifier_abort(auvid_identifier_t *id);

#define auvid_identifier_disarm AUVID_SIZED(auvid_identifier_disarm)
/** Back to DISARMED, from any state: clears the latch. An excitation under way ends without a fade.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). */
auvid_status_t auvid_identifier_disarm(auvid_identifier_t *id);

#define auvid_identifier_step AUVID_SIZED(auvid_identifier_step)
/** One control tick. Bad sensor samples are dropped and named in out->events; the tick goes on.
 * @param out always written whole (unless null)
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_TIME_BACK,
 * AUVID_ERR_TIME_SAME (in->t_us did not advance: nothing done, excitation zero, AUVID_EVENT_TIME).
 * On any status < 0 a guard that is watching aborts. */
auvid_status_t auvid_identifier_step(auvid_identifier_t *id, const auvid_input_t *in,
                                     auvid_output_t *out);

#define auvid_identifier_motion AUVID_SIZED(auvid_identifier_motion)
/** Record motion that is known from elsewhere (a navigation of one's own, a log) instead of sensors
 * through step. Takes every complete cell of the record, up to AUVID_RECORDER_CELLS.
 * @param attitude [3] rad, psi unwrapped; @param nu [6]
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_NOT_FINITE;
 * AUVID_ERR_RANGE (beyond AUVID_RECORDER_LARGEST); AUVID_ERR_TIME_BACK; AUVID_ERR_TIME_SAME;
 * refused samples change nothing. */
auvid_status_t auvid_identifier_motion(auvid_identifier_t *id, uint64_t t_us,
                                       const auvid_real_t *attitude, const auvid_real_t *nu);

#define auvid_identifier_applied AUVID_SIZED(auvid_identifier_applied)
/** Record the applied wrench from t_us on (command may be null). Statuses as above; at most
 * AUVID_CELLS_PER_STEP cells. */
auvid_status_t auvid_identifier_applied(auvid_identifier_t *id, uint64_t t_us,
                                        const auvid_real_t *wrench, const auvid_real_t *command);

#define auvid_identifier_close AUVID_SIZED(auvid_identifier_close)
/** Complete the data set under way, at the end of a dive or log.
 * @return AUVID_SET_COMPLETE; AUVID_SET_IDLE (left out: see AUVID_EVENT_NOT_EXCITED);
 * AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_NO_DATA (it is empty). */
auvid_status_t auvid_identifier_close(auvid_identifier_t *id);

#define auvid_identifier_attach AUVID_SIZED(auvid_identifier_attach)
/** Hand every further cell of the record to a comparison (null: no more). It is not copied. */
void auvid_identifier_attach(auvid_identifier_t *id, auvid_validation_t *validation);

#define auvid_estimate_drag AUVID_SIZED(auvid_estimate_drag)
/** Drag force of one degree of freedom at a speed, with its uncertainty:
 *
 *     F = a' pi,  a = (v, |v| v),  sigma^2 = a' C a + (a' d_thrust)^2 + (a' d_dvl)^2
 *
 * over the parameters of the kinds AUVID_PARAMETER_LINEAR_DRAG and _QUADRATIC_DRAG whose `dof` it
 * is; C, d_thrust and d_dvl are the estimate's covariance, confidence.thrust_error and .dvl_error.
 * Linear and quadratic drag move against each other: F is known where neither of them is. Drag by
 * other velocities than the DoF's own is not part of it. Where the model has a current, the speed
 * is that through the water, but the largest speed seen is that which was recorded.
 * @param vehicle the estimate's model; averaged.h, current.h and thrusters.h keep the hull's drag
 * @param speed [m/s, rad/s], < 0: backward; up to +-AUVID_RECORDER_LARGEST. What users rely on is
 * 0.3 to 1 of estimate->speed
 * @param drag written if AUVID_OK. A parameter that is fixed is exact; one whose standard error is
 * not known makes sigma and half_width AUVID_LARGEST
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NO_DATA (no estimate yet); AUVID_ERR_NOT_FINITE
 * (speed); AUVID_ERR_RANGE (speed; the model has no drag in this DoF). Cost: O(n); Girona500 560
 * instructions of a Cortex-M4F. */
auvid_status_t auvid_estimate_drag(const auvid_estimate_t *estimate, const auvid_vehicle_t *vehicle,
                                   auvid_dof_t dof, auvid_real_t speed, auvid_drag_t *drag);

#define auvid_identifier_work AUVID_SIZED(auvid_identifier_work)
/** Optimize with what time is left.
 * @param budget units of work; 0 does nothing
 * @return AUVID_OK (nothing left to do until the next set completes); AUVID_PENDING (budget used
 * up); AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_NO_DATA (no degree of freedom
 * moved in the sets that are kept; the search ends, the last estimate stays). */
auvid_status_t auvid_identifier_work(auvid_identifier_t *id, uint32_t budget);

#ifdef __cplusplus
}
#endif

#endif
