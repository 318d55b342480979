/**
 * @file identifier.h
 * The identifier: the complete scheme of Fig. 2. Two calls, from one task:
 *
 *     auvid_identifier_step   in every control tick: sense, navigate, record, excite. Short.
 *     auvid_identifier_work   whenever there is time left: a given number of units of optimization.
 *
 * Data flow: sensors -> navigation (nav.h) -> recorder -> metric <-> optimizer -> estimate. Each
 * completed data set starts a search, in which the last estimate is one of the first points. The
 * search uses the sets that were complete when it began. Sets completed meanwhile wait: on the
 * regressor path up to (sets - 1) / 2 of them, then the oldest is lost; on the residual path one,
 * and while it waits no rows are recorded. The next search takes them all. Before a set is used,
 * the last estimate predicts it, the oldest set first. This reveals a changed vehicle, and an
 * estimate worse than the one before.
 *
 * On the regressor path the cost is convex, and the R factor gives its minimum within the bounds.
 * The search confirms it: it evaluates the first population of Algorithm 1, and one step of
 * Algorithm 2 in each direction. With search.paper (types.h) both algorithms run to their ends. On
 * the residual path the delay is one more parameter of the search.
 *
 * Cost of step: one prediction of the filter, the updates that arrived, and a cell of the recorder.
 * What the cell leaves to do follows in the next steps, a part in each: rows of two degrees of
 * freedom, the end of a set, the simulation of velocity. If cells pile up, a step takes up to
 * AUVID_CELLS_PER_STEP as a whole. Cost of work: at most `budget` units. A unit is about
 * 250 instructions of a Cortex-M4F: a row of an R factor, or a trial point (rejected ones count
 * too). A stored sample evaluated by the user's model takes vehicle.work units. If the budget is
 * smaller, several calls save up for it, and the last of them evaluates the sample as a whole.
 * The start of a search takes 25 units.
 * Memory: only sizeof(auvid_identifier_t).
 *
 * An identifier is passive: the user or a controller drives. auvid_identifier_attach_actuation
 * (actuation.h) adds excitation and guard. On any status < 0 of step the excitation is zero.
 */
#ifndef AUVID_IDENTIFIER_H
#define AUVID_IDENTIFIER_H

#include "auvid/detail/confidence.h"
#include "auvid/detail/metric.h"
#include "auvid/detail/optimizer.h"
#include "auvid/detail/recorder.h"
#include "auvid/estimate.h"
#include "auvid/guard.h"
#include "auvid/metric_config.h"
#include "auvid/nav.h"
#include "auvid/types.h"
#include "auvid/validation.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Largest number of cells taken from the recorder in one step. A tick must not be longer than this
 * many cells, or the record breaks repeatedly. */
#define AUVID_CELLS_PER_STEP 2

/** A work budget for a Cortex-M4 at a 50 Hz tick: a result three seconds after a set (Girona500,
 * one set or eight), seven with uncertain inputs, eight with eight thrusters. */
#define AUVID_DEFAULT_BUDGET 150u

/** The DVL lock that supplies the velocity of the dynamics, which is that through the water. */
typedef enum {
    AUVID_VELOCITY_GROUND = 0, /**< bottom lock: correct if there is no current */
    AUVID_VELOCITY_WATER = 1   /**< water lock only */
} auvid_velocity_source_t;

/** A listener that keeps a log of commands (thrusters.h). `command` and `set` are required. */
typedef struct {
    /** A command is valid from t_us on; NULL: zeros. Called from step and applied. */
    void (*command)(void *context, uint64_t t_us, const auvid_real_t *command);
    /** New sets are complete, and the ring is about to be evaluated: the listener may drop sets.
     * Called from work. */
    void (*set)(void *context, auvid_metric_t *metric);
    /** Residual path: `command` is not called while a search under way causes rows to be dropped.
     * Returns how long before the middle of the next row commands must resume [us]; NULL: 0. Called
     * from work. */
    uint64_t (*lead_us)(void *context);
} auvid_listener_t;

/** Configuration; copied at init. Pointers within must outlive the identifier. */
typedef struct auvid_identifier_config {
    const auvid_vehicle_t *vehicle;   /**< required; set by defaults */
    auvid_nav_config_t nav;           /**< see nav.h */
    auvid_recorder_config_t recorder; /**< see nav.h; its cell is also the metric's */
    auvid_metric_config_t metric;     /**< see metric_config.h; init sets vehicle and cell. In the
                                                  residual path with estimate_delay off, delay_s[0]
                                                  is the delay of all DoF */
    auvid_velocity_source_t velocity; /**< default AUVID_VELOCITY_GROUND */
    auvid_search_config_t search;     /**< see types.h: bounds, good point, options; init sets n */
    auvid_real_t dry_mass_kg; /**< a smaller mass is implausible [kg], >= 0, below the upper bounds
                                   of all free masses; default 0: not known */
    auvid_uncertainty_t uncertainty; /**< see estimate.h; default 0.05 of the thrust, 0.005 of
                                          the DVL, 0.1 s of the delay; 0: known exactly */
    bool exact_inputs; /**< thrust and sensors have no errors but `uncertainty`. In the field they
                            have: attach uncertain inputs (uncertain.h) instead. With neither,
                            nothing is identifiable (AUVID_NOTE_UNCHECKED). Default false; where
                            uncertain inputs are attached, read only if all of them are exact */
    const auvid_listener_t *listener; /**< default NULL: none */
    void *listener_context;           /**< its context */
} auvid_identifier_config_t;

/** Sizes that a configuration needs: the least value of each macro AUVID_MAX_... of config.h. */
typedef struct {
    uint32_t parameters; /**< also of the delay, if it is searched (residual path) */
    uint32_t population; /**< as configured, or else n + 1; 4 n, the default, is better. 0 if the
                              search consists of the local phase (regressor path) */
    uint32_t sets;
    uint32_t commands; /**< 0: the model needs no memory for them. 1: the residual path; your model
                            may read more */
    uint32_t taps, overlap, half_width;
    uint32_t factor, columns;
} auvid_needs_t;

/** What arrived since the last tick. Members of what did not arrive are zero. */
typedef struct {
    uint64_t t_us; /**< this tick [us]; must advance from step to step */
    struct {
        bool present;
        uint64_t t_us;              /**< time of the sample */
        auvid_real_t attitude[3];   /**< phi theta psi [rad]; not read if by_quaternion */
        auvid_real_t rates[3];      /**< p q r [rad/s] */
        auvid_real_t quaternion[4]; /**< w x y z, see auvid_nav_imu_quaternion */
        bool by_quaternion;         /**< the attitude is `quaternion` */
    } imu;
    struct {
        bool present;
        auvid_dvl_sample_t sample; /**< nav.h */
    } dvl;
    struct {
        bool present;
        auvid_dvl_sample_t sample; /**< of the other lock, if the DVL has both at once */
    } dvl_water;
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t depth_m; /**< positive down */
    } depth;
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t pressure_pa; /**< absolute; see auvid_nav_pressure */
    } pressure;                   /**< instead of depth: both are samples of the same sensor */
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t x_m, y_m; /**< north, east of the origin */
    } gps;
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t altitude_m; /**< above the bottom, 0..1e9, e.g. of the DVL; for the guard.
                                     Not read if passive */
    } altitude;
    struct {
        bool present;
        /** Only if the wrench from t_us of this tick on is known before the step: the vehicle is
         * never excited by auvid, or a measurement of the thrust is of this time. Sum of all
         * sources [N, Nm]. Otherwise leave it out here, and call auvid_identifier_applied once it
         * is known: after the step with the time of this tick, since the step returns the
         * excitation; or with the earlier time of a measurement. */
        auvid_real_t wrench[AUVID_DOF_COUNT];
        auvid_real_t command[AUVID_COMMAND_SLOTS]; /**< thruster commands, if the
                        model uses them; with uncertain inputs the thrusters' forces [N], in the
                        order of the allocation. All are read: 0 for thrusters that do not exist */
    } applied;
    bool saturated; /**< a thruster is at its limit now, for any reason; for the guard. Saturation
                         by the excitation itself is detected internally */
} auvid_input_t;

/** Event flags; several may be set at once. */
enum {
    AUVID_EVENT_TIME = 1u << 0,              /**< the tick's time did not advance: step rejected */
    AUVID_EVENT_IMU_DROPPED = 1u << 1,       /**< sample rejected; counted in nav.imu.stale or
                                              nav.imu.invalid. Not counted if it is ahead of the
                                              tick by more than nav.future_us */
    AUVID_EVENT_DVL_DROPPED = 1u << 2,       /**< sample rejected now, or later if it waited for an
                                              IMU sample of its time (nav.h). The reason is in
                                              nav.diagnostics; `stale` if it is ahead of the tick
                                              by more than nav.future_us. A sample lost because
                                              another one waits sets no event: `unused` */
    AUVID_EVENT_DEPTH_DROPPED = 1u << 3,     /**< likewise: depth or pressure */
    AUVID_EVENT_GPS_DROPPED = 1u << 4,       /**< likewise */
    AUVID_EVENT_INPUT_DROPPED = 1u << 5,     /**< wrench or commands of `applied` rejected: not
                                              finite, beyond AUVID_RECORDER_LARGEST, or a wrench
                                              of this time was given before */
    AUVID_EVENT_VELOCITY_STALE = 1u << 6,    /**< no DVL sample accepted for nav.stale_us */
    AUVID_EVENT_GAP = 1u << 7,               /**< the record was broken and restarted */
    AUVID_EVENT_SET = 1u << 8,               /**< a data set was completed */
    AUVID_EVENT_NOT_EXCITED = 1u << 9,       /**< no DoF with a free parameter was excited in
                                              the set: the set is left out, the estimate stays */
    AUVID_EVENT_ESTIMATE = 1u << 10,         /**< a search has ended, and what
                                                  auvid_identifier_estimate returns is new. With
                                                  uncertain inputs the last one may stay */
    AUVID_EVENT_EXCITATION_DONE = 1u << 11,  /**< the excitation's run is complete */
    AUVID_EVENT_ALTITUDE_DROPPED = 1u << 12, /**< sample rejected: not finite, negative, not newer
                                                  than the previous one, or ahead of the tick by
                                                  more than nav.future_us */
    AUVID_EVENT_ABORTED = 1u << 13,          /**< the guard aborted; why is in guard.trip */
    AUVID_EVENT_SETTLED = 1u << 14,   /**< the guard is DONE: the run is over, and the vehicle is at
                                         rest or the settling timeout has passed */
    AUVID_EVENT_VALIDATED = 1u << 16, /**< a set was predicted before it was used; see
                                         change_test */
    AUVID_EVENT_CHANGED = 1u << 17,   /**< the vehicle has changed: older sets are dropped, and a
                                          search begins without the last estimate */
    AUVID_EVENT_RESTORED = 1u << 18,  /**< the last estimate predicted a new set worse than the last
                                          accepted one, which replaces it. Not if other DoF were
                                          excited in the accepted one. With uncertain inputs: the
                                          estimates without them; the one with them stays, and
                                          waits for the next search to be accepted */
    AUVID_EVENT_ROWS_DROPPED = 1u << 19, /**< a search took so long that complete rows were dropped;
                                          counted in metric.sets.rows_dropped. Regressor path: a
                                          waiting set. Residual path: rows of the next set */
    AUVID_EVENT_LONGER_CELLS = 1u << 20, /**< with an estimate: its rows contained mostly noise, and
                                              the vehicle is slow. The sets are dropped, and the
                                              record begins again with cells of twice the length,
                                              recorder.cell_us. See metric.max_cell_us */
    AUVID_EVENT_DRIFTED = 1u << 21,      /**< the vehicle has drifted since the first accepted
                                              estimate: fouling, a sagging battery. Estimate and
                                              sets stay, they follow the vehicle; what was derived
                                              from earlier estimates is out of date. Set once until
                                              change_test.drifted is 0 again */
    AUVID_EVENT_END                      /**< the last event + 1; no event */
};

/** Output of a step. */
typedef struct {
    uint32_t events;                              /**< AUVID_EVENT_... since the last step */
    auvid_real_t excitation[AUVID_DOF_COUNT];     /**< body wrench to add to the controller's [N,
                                                      Nm]; zero if not exciting, and on any
                                                      status < 0 */
    auvid_real_t thruster_N[AUVID_MAX_THRUSTERS]; /**< the excitation as thruster forces [N] */
    auvid_guard_state_t guard;                    /**< after this step; DISARMED if passive */
    auvid_guard_cause_t cause; /**< why ABORTED; value, limit and time are in guard.trip */
} auvid_output_t;

/** Mass and drag force of each DoF in the first accepted estimate that knew it. Private. */
typedef struct {
    auvid_real_t speed[AUVID_DOF_COUNT];       /* of the drag force */
    auvid_real_t value[2][AUVID_DOF_COUNT];    /* mass; drag force */
    auvid_real_t variance[2][AUVID_DOF_COUNT]; /* if thrust and DVL scale are exact; 0: not known */
} auvid_drift_reference_t;

/** The memory of the change test. Private. */
typedef struct {
    auvid_estimate_t accepted;           /* the last accepted estimate */
    auvid_drift_reference_t first;       /* of the first accepted estimates since the last change */
    auvid_metric_change_t statistic;     /* of the newest sets */
    auvid_real_t noise[AUVID_DOF_COUNT]; /* largest effective noise of late */
    auvid_real_t predicted;              /* cost of the last estimate on the new set */
    uint32_t passive_cells;              /* since the excitation, or since init */
    bool straddles_change;               /* the set before may be from before and after a change */
    uint8_t suspected;                   /* bit j: a set that is deleted was evidence for a change,
                                            most clearly in this DoF; 0: none, or the next one has
                                            been tested */
    uint8_t reserved[AUVID_GAP(sizeof(uint64_t), (AUVID_DOF_COUNT + 2) * sizeof(auvid_real_t) + 6)];
} auvid_change_detector_t;

/** Phase of auvid_identifier_work. */
typedef enum {
    AUVID_WORK_IDLE,        /**< nothing to do until a set completes */
    AUVID_WORK_PREPARE,     /**< residual path: prepares the new set */
    AUVID_WORK_PREDICT,     /**< compares the prediction of the last estimate with the new set */
    AUVID_WORK_COMPARE,     /**< the same with the last accepted estimate */
    AUVID_WORK_CHANGE_TEST, /**< tests new sets against older ones */
    AUVID_WORK_MERGE,       /**< merges the sets; finds the start of the search; begins it */
    AUVID_WORK_ASK,         /**< asks the optimizer for a point */
    AUVID_WORK_COST,        /**< evaluates its cost */
    AUVID_WORK_MEASURE,     /**< measures the residuals of the result */
    AUVID_WORK_LINEARISE,   /**< residual path: differentiates the residuals; regressor path: solves
                                 with uncertain inputs (uncertain.h) */
    AUVID_WORK_CONFIDENCE,  /**< computes standard errors and findings */
    AUVID_WORK_PHASE_COUNT
} auvid_work_phase_t;

/** The minimum of a cost within the bounds. Private. */
typedef struct {
    auvid_real_t cost;
    auvid_real_t allowed; /* excess of a search that has found it */
} auvid_minimum_t;

/** Residual path: the sets are linearised, and Gauss-Newton steps are made. Private. */
typedef struct {
    auvid_metric_windows_t windows;
    auvid_gauss_newton_t newton;
} auvid_linear_work_t;

/** The optimization under way. Private where it says nothing else. */
typedef struct {
    auvid_real_t candidate[AUVID_MAX_PARAMETERS]; /* all parameters of the point under evaluation */
    auvid_real_t delay_s;                         /* its delay, if the search includes it */
    auvid_real_t cost;                            /* of the search's result */
    auvid_minimum_t minimum; /* what the search has to confirm; of neighbours: the best end */
    auvid_optimizer_work_t searched; /* of the search that has ended */
    uint32_t active;                 /* parameters in the present search */
    uint32_t sets;                   /* completed when the current sets were taken up */
    uint32_t searches;               /**< begun so far */
    uint32_t last_units;             /**< used by the last call of work */
    uint32_t max_units;              /**< most units used by any call of work so far */
    uint8_t phase;                   /**< auvid_work_phase_t */
    uint8_t spent;      /* 0: merges; 1: finds the minimum; then units of the start cost + 2 */
    uint8_t untested;   /* completed sets still to be validated before the merge */
    uint8_t refuted;    /* polls of this search that found a better point than its start */
    uint8_t neighbours; /* searches of neighbouring minima that began; 0 after the last one */
    uint8_t sides_left; /* of the best end: 2: the longer delay is next; 1: the shorter one */
    bool set_pending, searching, not_converged;
    bool cold_start;                            /* search without the last estimate */
    bool seeks_optimum;                         /* in `optimum` */
    uint8_t parameter_of[AUVID_MAX_PARAMETERS]; /* parameter number of the optimizer's i-th */
} auvid_identifier_work_t;

/** What was attached to the identifier; NULL: it was not. Private. */
typedef struct {
    auvid_validation_t *prediction; /* of the set being recorded, by the last estimate */
    auvid_validation_t *validation; /* receives every cell */
    const struct auvid_simulate_functions *simulate; /* for these two */
    auvid_change_detector_t *change;
    const struct auvid_change_functions *change_functions; /* for it */
    struct auvid_uncertain *uncertain;
    const struct auvid_uncertain_functions *uncertain_functions; /* for it */
    const auvid_listener_t *listener;                            /* as configured */
    void *listener_context;
} auvid_identifier_attached_t;

/** The identifier. Its modules are public to read; only the functions write. */
typedef struct auvid_identifier {
    auvid_search_config_t search; /**< as configured; the modules hold the rest */
    auvid_real_t dry_mass_kg;
    auvid_uncertainty_t uncertainty;
    bool exact_inputs;
    uint8_t velocity;                  /**< auvid_velocity_source_t */
    uint8_t default_scale;             /* bit j: metric.cfg.tau_max[j] is auvid's choice */
    struct auvid_actuation *actuation; /**< the acting half (actuation.h); NULL: passive */
    auvid_identifier_attached_t attached;
    /* state: from here on, see checkpoint.h */
    uint64_t t_us;                   /**< last tick, or last sample of motion */
    auvid_guard_seen_t applied;      /* last wrench recorded */
    auvid_estimate_t estimate;       /* the last result: read auvid_identifier_estimate */
    auvid_change_test_t change_test; /**< of the newest set */
    uint32_t last_sample;            /* sequence of the last velocity recorded */
    uint32_t events;                 /* since the last step */
    bool started;
    uint8_t reserved[7];
    auvid_identifier_work_t work;
    /* the modules; what is above is reached by short instructions */
    auvid_recorder_t recorder;
    auvid_metric_t metric;
    auvid_nav_t nav;
    union { /* one after the other: the search is over when its result is assessed */
        auvid_identifier_config_t cfg; /**< may be filled here for init; undefined afterwards */
        auvid_refusal_t refusal;       /**< what init was refused for; not after AUVID_OK */
        auvid_optimizer_t optimizer;
        auvid_bounded_ls_t optimum;
        auvid_linear_work_t linear;
        auvid_confidence_job_t confidence;
    };
} auvid_identifier_t;

#define auvid_identifier_estimate AUVID_SIZED(auvid_identifier_estimate)
/** Read the last estimate.
 * With uncertain inputs it is that of their last solution. After a change of the vehicle, or with
 * longer cells, it is the one without them until the next solution, in which nothing is
 * identifiable; its number is that of the same sets.
 * @return it, valid until the next call of work or restore; NULL: there is none yet (or `id` is
 * NULL). Its numbers are zero until then, so do not read them otherwise. Cost: O(1). */
const auvid_estimate_t *auvid_identifier_estimate(const auvid_identifier_t *id);

#define auvid_identifier_defaults AUVID_SIZED(auvid_identifier_defaults)
/** Fill *cfg for a vehicle: every module's defaults, all parameters of the model free (Girona500:
 * the 13 of Eq. 12-15), bounds +-1000, passive. NULL is a no-op. */
void auvid_identifier_defaults(auvid_identifier_config_t *cfg, const auvid_vehicle_t *vehicle);

#define auvid_identifier_needs AUVID_SIZED(auvid_identifier_needs)
/** Compute the sizes that a configuration needs. Call it if auvid_identifier_init returns
 * AUVID_ERR_SIZE, AUVID_ERR_PARAMETERS or AUVID_ERR_POPULATION, or to save memory. The model need
 * not fit; other fields are not checked. Cost: O(n). It is linked only if it is called.
 * @param cfg not id->cfg after init
 * @param needs written if AUVID_OK or AUVID_ERR_SIZE
 * @return AUVID_OK (config.h has room); AUVID_ERR_SIZE (it has not); AUVID_ERR_NULL (also the
 * vehicle and its path); AUVID_ERR_PARAMETERS (the model has none, or more than 32). */
auvid_status_t auvid_identifier_needs(const auvid_identifier_config_t *cfg, auvid_needs_t *needs);

#define auvid_identifier_init AUVID_SIZED(auvid_identifier_init)
/** Check the arithmetic (auvid_selftest) and the configuration, and start. Nothing is attached
 * afterwards. After an error, and if *id is all zeros, every other function returns
 * AUVID_ERR_STATE. After an error id->refusal names the field, its value and its limit
 * (AUVID_ERR_ARITHMETIC: "selftest"; not after AUVID_ERR_NULL of id or cfg).
 * @param cfg may be id->cfg, to save memory; then its contents are undefined afterwards.
 * @return AUVID_OK; AUVID_ERR_NULL (also a listener without its functions); AUVID_ERR_ARITHMETIC
 * (the self-test failed); AUVID_ERR_NOT_FINITE (also of the good point and the uncertainty);
 * AUVID_ERR_RANGE (velocity: unknown; dry mass below zero, or no number; an uncertainty below zero
 * or above 1); AUVID_ERR_DRY_MASS (not below the upper bound of a free mass, which could not be
 * plausible); for the search over the free parameters the errors of auvid_search_check; the errors
 * of auvid_vehicle_check, the errors of auvid_nav_init, the errors of auvid_recorder_init, the
 * errors of auvid_metric_init. */
auvid_status_t auvid_identifier_init(auvid_identifier_t *id, const auvid_identifier_config_t *cfg);

#define auvid_identifier_init_motion AUVID_SIZED(auvid_identifier_init_motion)
/** As auvid_identifier_init, for your own navigation (auvid_identifier_motion): the filter is not
 * linked, unless auvid_identifier_step is called. cfg->nav is not read, and auvid_identifier_step
 * drops every sensor sample.
 * @return as auvid_identifier_init, without the errors of auvid_nav_init. */
auvid_status_t auvid_identifier_init_motion(auvid_identifier_t *id,
                                            const auvid_identifier_config_t *cfg);

#define auvid_identifier_step AUVID_SIZED(auvid_identifier_step)
/** Run one control tick. A bad sensor sample is dropped and flagged in out->events; the tick
 * continues.
 * @param out always written as a whole (unless NULL)
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_TIME_BACK,
 * AUVID_ERR_TIME_SAME (in->t_us did not advance: nothing done, excitation zero, AUVID_EVENT_TIME).
 * On any status < 0 an armed guard aborts. */
auvid_status_t auvid_identifier_step(auvid_identifier_t *id, const auvid_input_t *in,
                                     auvid_output_t *out);

#define auvid_identifier_motion AUVID_SIZED(auvid_identifier_motion)
/** Record motion from another source (the user's own navigation, a log) instead of sensors through
 * step. Takes every complete cell of the record, up to AUVID_RECORDER_CELLS. A time far ahead is
 * not noticed: until it has come, samples are AUVID_ERR_TIME_BACK.
 * @param attitude [3] rad, psi unwrapped
 * @param nu [6] m/s, rad/s
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_NOT_FINITE;
 * AUVID_ERR_RANGE (beyond AUVID_RECORDER_LARGEST); AUVID_ERR_TIME_BACK; AUVID_ERR_TIME_SAME. A
 * rejected sample changes nothing. */
auvid_status_t auvid_identifier_motion(auvid_identifier_t *id, uint64_t t_us,
                                       const auvid_real_t *attitude, const auvid_real_t *nu);

#define auvid_identifier_attitude AUVID_SIZED(auvid_identifier_attitude)
/** As auvid_identifier_motion, for attitude and rates that have a rate of their own, beside
 * auvid_identifier_velocity.
 * @param attitude [3] rad, psi unwrapped
 * @param rates [3] rad/s
 * @return as auvid_identifier_motion. */
auvid_status_t auvid_identifier_attitude(auvid_identifier_t *id, uint64_t t_us,
                                         const auvid_real_t *attitude, const auvid_real_t *rates);

#define auvid_identifier_velocity AUVID_SIZED(auvid_identifier_velocity)
/** As auvid_identifier_motion, for the velocity through the water. Call it only for new samples: a
 * held value is not one.
 * @param velocity [3] m/s
 * @param measured bit i: velocity[i] was measured, 0..7; the others are not read
 * @return as auvid_identifier_motion; AUVID_ERR_RANGE also if `measured` exceeds 7; AUVID_UNUSED if
 * it is 0. */
auvid_status_t auvid_identifier_velocity(auvid_identifier_t *id, uint64_t t_us,
                                         const auvid_real_t *velocity, unsigned measured);

/** A wrench further ahead of the last step, or of the last sample of motion, than this is refused
 * [us]: recorded, it would end the record until its time has come. */
#define AUVID_INPUT_AHEAD_US 1000000u

#define auvid_identifier_applied AUVID_SIZED(auvid_identifier_applied)
/** Record the applied wrench from t_us on. Call it in every tick after auvid_identifier_step, when
 * the sum of pilot, controller and excitation is known; each time is recorded once, here or in the
 * step's input. The next step takes the cells that it completes.
 * @param t_us of the tick, or of the measurement [us]; later than that of the last wrench
 * @param wrench [AUVID_DOF_COUNT] sum of all sources [N, Nm]
 * @param command [AUVID_MAX_COMMANDS] as in auvid_input_t; NULL: none
 * @return as auvid_identifier_motion; AUVID_ERR_STALE (more than AUVID_INPUT_AHEAD_US ahead of the
 * last step or sample of motion). No event is set: check the status */
auvid_status_t auvid_identifier_applied(auvid_identifier_t *id, uint64_t t_us,
                                        const auvid_real_t *wrench, const auvid_real_t *command);

#define auvid_identifier_close AUVID_SIZED(auvid_identifier_close)
/** Complete the current data set at the end of a dive or log.
 * @return AUVID_SET_COMPLETE; AUVID_SET_IDLE (left out: see AUVID_EVENT_NOT_EXCITED);
 * AUVID_PENDING (residual path: the set is kept until the search has ended); AUVID_ERR_NULL;
 * AUVID_ERR_STATE (not initialised); AUVID_ERR_NO_DATA (it is empty). */
auvid_status_t auvid_identifier_close(auvid_identifier_t *id);

#define auvid_identifier_attach AUVID_SIZED(auvid_identifier_attach)
/** Feed every subsequent cell to a validation, which is not copied. NULL detaches it. It ends at
 * AUVID_EVENT_LONGER_CELLS: its cells have another length. */
void auvid_identifier_attach(auvid_identifier_t *id, auvid_validation_t *validation);

#define auvid_identifier_attach_prediction AUVID_SIZED(auvid_identifier_attach_prediction)
/** Simulate the velocity of each set with the last estimate, and compare it with the measured one:
 * change_test.r2_velocity. Call it once, between auvid_identifier_init and the first step. Without
 * it the program does not contain the simulation. Cost: see validation.h.
 * @param storage written; must outlive the identifier
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_ATTACHED (one is
 * attached already); AUVID_ERR_STARTED (it has stepped, or recorded a wrench). After an error
 * nothing has changed. */
auvid_status_t auvid_identifier_attach_prediction(auvid_identifier_t *id,
                                                  auvid_validation_t *storage);

#define auvid_identifier_attach_change_test AUVID_SIZED(auvid_identifier_attach_change_test)
/** Test each completed set before it is used: compare how the last estimate and the last accepted
 * one predict it, and decide whether the vehicle has changed: change_test. An estimate that
 * predicts worse than the last accepted one is replaced by it (AUVID_EVENT_RESTORED). After a
 * change the older sets are dropped and the search starts cold (AUVID_EVENT_CHANGED). If auvid has
 * not excited a set with evidence, that set is deleted and the next one decides: the vehicle has
 * changed if it is evidence, too, or does not excite the same DoF. Evidence does not count if a sag
 * of the thrust explains it, of which the uncertain inputs (uncertain.h) are certain. A slow change
 * shows in no set: each accepted estimate of at least five sets is also compared with the first one
 * since init or the last change (AUVID_EVENT_DRIFTED); a checkpoint keeps that one. Call it once,
 * between auvid_identifier_init and the first step. Without it every set is merged as it comes, no
 * estimate is `accepted`, and the program does not contain the test.
 * @param storage written; must outlive the identifier
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_ATTACHED (one is
 * attached already); AUVID_ERR_STARTED (it has stepped, or recorded a wrench). After an error
 * nothing has changed. */
auvid_status_t auvid_identifier_attach_change_test(auvid_identifier_t *id,
                                                   auvid_change_detector_t *storage);

#define auvid_identifier_work AUVID_SIZED(auvid_identifier_work)
/** Optimize for the time that is left. The first call after a set is complete only begins: the step
 * before it has taken longer.
 * @param budget units of work; 0 does nothing
 * @return AUVID_OK (nothing to do until the next set completes); AUVID_PENDING (call again);
 * AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_NO_DATA (no degree of freedom moved
 * in the stored sets; the search ends, the last estimate stays). */
auvid_status_t auvid_identifier_work(auvid_identifier_t *id, uint32_t budget);

/** Costs of a core, in instructions of the full example of port/cortex_m (-Os): a node on a CAN
 * bus, 13 parameters, excitation, guard, change test, simulation of velocity. For another core or
 * firmware fill it from `make bench-firmware`. */
typedef struct {
    const char *name; /**< as in port/cortex_m/boards.txt, e.g. "m4f"; not read by auvid_budget */
    uint32_t tick;    /**< reserved: most of a tick without work, > 0. The sum of what step, report
                           and 16 received frames take at most, although these do not coincide. A
                           passive identifier takes less, uncertain inputs a third more (m4f) */
    uint32_t unit;    /**< most of a unit of work, > 0: of the largest call at a budget of 150 */
    auvid_real_t cycles; /**< of an instruction, > 0. Assumed, not measured: 1.33 on ARMv6-M, else
                              1.5; flash without wait states */
} auvid_core_t;

/** The cores of `auvid_cores`. */
typedef enum {
    AUVID_CORE_M0PLUS,  /**< Cortex-M0+ */
    AUVID_CORE_M3,      /**< Cortex-M3 */
    AUVID_CORE_M4F,     /**< Cortex-M4 with FPU of single precision, likewise M7 and M33 */
    AUVID_CORE_M7,      /**< Cortex-M7 */
    AUVID_CORE_M33,     /**< Cortex-M33 */
    AUVID_CORE_RV32IMC, /**< RISC-V without floating point */
    AUVID_CORE_COUNT
} auvid_core_number_t;

#define auvid_cores AUVID_SIZED0(auvid_cores)
/** The cores, by auvid_core_number_t. */
extern const auvid_core_t auvid_cores[AUVID_CORE_COUNT];

/** Largest budget that auvid_budget returns. */
#define AUVID_BUDGET_LARGEST 1000000u

#define auvid_budget AUVID_SIZED0(auvid_budget)
/** Returns the largest budget of work with which no tick takes longer than time_s, as far as `core`
 * tells: (frequency_hz time_s / cycles - tick) / unit. Write the number into the firmware: a log
 * replays bit for bit only with the same budget.
 * @param frequency_hz of the core [Hz]
 * @param time_s what auvid may take of each tick [s]
 * @return 1..AUVID_BUDGET_LARGEST. 0: not one unit fits, and the tick may be too short even without
 * work; or core is NULL, or a member or an argument is not finite or not above 0. */
uint32_t auvid_budget(const auvid_core_t *core, auvid_real_t frequency_hz, auvid_real_t time_s);

#ifdef __cplusplus
}
#endif

#endif
