/**
 * @file metric.h
 * Metric: how badly does a parameter vector explain the recorded data? (III-B, Eq. 9-11)
 *
 * Cells from the recorder pass a smoother, one row every half second; rows gather in data sets; the
 * completed sets form a ring, which is evaluated while the next set is recorded.
 *
 * Two paths behind one interface:
 * - *Regressor path*, for models linear in pi: the rows of Y are formed from unsmoothed cells, and
 *   rows and wrench of each DoF pass the same smoother, so that what the smoother takes from one
 *   side it takes from the other. (The paper smooths the states and names no filter for tau; that
 *   leaves a bias which more data does not cure.) Sums and differences of successive rows, the low
 *   and the high band, are kept as triangular factors [R | Z] for each DoF, where Z holds the
 *   wrench at three delays. When sets are brought together, each band is weighted by how badly it
 *   fits, which whitens the residual whatever disturbs the vehicle. The cost is
 *       J(pi) = sum_j ||R_j pi - z_j||^2 / (tau_max_j^2 rows_j),
 *   without the part that no pi can explain (kept apart in `constant`): in float32 it would swamp
 *   the differences the optimizer lives on.
 * - *Residual path*, for any other model: means over each row's time are stored, the user's
 *   function is called on each, and the residuals are smoothed, by binomial weights of about 0.6 s
 *   standard deviation. (A model that is not linear in the commands, a dead band, say, must see
 *   them as they were: for such a model make rows of two cells.) J(pi) = sum_j sum_k smoothed_jk^2
 *   / (tau_max_j^2 rows_j).
 *
 * Delay between command and response, for each DoF: z_j(d) = Z_j l(d), the weights l with sum one,
 * mean d and second moment d^2 (a shift; they are Lagrange polynomials then) or 2 d^2 (a
 * first-order lag, as of a thruster). d_j and its kind are where the part of the wrench that no pi
 * explains is smallest, over all sets in the ring, from 0 to 6 cells;
 * none is taken unless the data determine it. Where the configuration says how uncertain the delay
 * is, shifts from -2 cells on are looked at, too: thrust whose stamps are late seems to follow the
 * motion. What is not taken enters the standard errors (confidence.h).
 * In the residual path one shift, common to wrench and commands, is searched together with the
 * parameters.
 *
 * Where a velocity that a DoF's equation reads (vehicle.h) was not measured within the smoother's
 * window, the equation has no row; the others have theirs. So each DoF counts its own rows.
 *
 * A DoF whose wrench hardly varies within a set is not driven: its rows of that set are left out
 * (they would pull its parameters to zero with a small formal error). A set in which no DoF with a
 * free parameter is driven does not enter the ring: an idle vehicle keeps what it has learnt.
 *
 * Called by the identifier: `add` and `gap` from the control tick, the rest from work().
 * Cost: add, Girona500: 0.4k multiplications a cell, and four rows of Givens rotations every
 * half second; a cost evaluation: 78 multiplications. Memory: sizeof(auvid_metric_t), 15 KiB
 * with default sizes, of which each completed set, kept in 16 bits a number, takes 0.9 KiB; to
 * complete one costs 11k instructions of a Cortex-M4F.
 */
#ifndef AUVID_METRIC_H
#define AUVID_METRIC_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Delays at which the wrench is kept, and their distance in cells. */
#define AUVID_METRIC_DELAYS 3
#define AUVID_METRIC_DELAY_CELLS 3
/** Most negative delay: the weights of the three nodes are extrapolated [cells]. */
#define AUVID_METRIC_EARLY_CELLS 2

/** Bands into which the rows are split: sums and differences of neighbours. */
#define AUVID_METRIC_BANDS 2
/** Rows kept for them. */
#define AUVID_METRIC_LAGS 2
/** Most rows whose residuals are summed in the residual path. */
#define AUVID_METRIC_WINDOW (AUVID_REGRESSOR_ONLY ? 3 : 31)

/** Which buffers the rows are made of. */
typedef enum {
    AUVID_SMOOTH_ROWS = 0,   /**< rows from unsmoothed cells, rows and wrench smoothed alike */
    AUVID_SMOOTH_STATES = 1, /**< our reading of the paper: Savitzky-Golay on the states and for
                                  the accelerations, wrench raw */
} auvid_smoothing_t;

/** A stored row of the residual path: a smoothed sample, and wrench and commands at the other
 * delays. Written by the metric. */
typedef struct {
    auvid_sample_t sample;
    auvid_real_t late[AUVID_METRIC_DELAYS - 1][AUVID_DOF_COUNT + AUVID_MAX_COMMANDS];
} auvid_row_t;

typedef struct {
    const auvid_vehicle_t *vehicle; /**< required; must outlive the metric */
    uint32_t free; /**< bit i: parameter i is estimated; others stay at `fixed`. 0: all free;
                        default the vehicle's own choice */
    auvid_real_t fixed[AUVID_MAX_PARAMETERS]; /**< values of the others, and of free ones while
                                their DoF is not driven; 0 of the latter: not known, see
                                auvid_metric_searched. Default 0 */
    auvid_real_t tau_max[AUVID_DOF_COUNT];    /**< scale of the wrench [N, Nm], > 0; makes the cost
                                                   dimensionless. Default 100, 40 */
    /** a DoF is driven when its wrench's rms about its mean exceeds this part of tau_max; 0..1,
     * default 0.02 */
    auvid_real_t excitation_threshold;
    uint32_t cell_us;    /**< the recorder's cell [us]; default 100000 */
    uint32_t velocity_us; /**< time between velocity samples [us], interpolated in between; 0: in
                               every cell; ..1e6, default 200000 (DVL at 5 Hz). Not used with
                               AUVID_SMOOTH_STATES; in the residual path by thrusters.h alone */
    uint16_t row_cells;  /**< cells between rows; >= 1, default 5 */
    uint16_t set_rows;   /**< rows in a set; >= 1, default 60 (30 s);
                              sets * set_rows <= 60000 */
    uint8_t sets;        /**< sets in the ring, 1..AUVID_MAX_SETS; default all */
    auvid_smoothing_t smoothing; /**< default AUVID_SMOOTH_ROWS */
    uint8_t half_width[2]; /**< Savitzky-Golay half-width [cells] for forces and for moments; the
                                literal reading uses the first; default 10, 7. Not used in the
                                residual path */
    uint8_t lag[2]; /**< rows between those whose sums and differences are formed, for forces and
                         for moments; 1..AUVID_METRIC_LAGS, default 2, 1 */
    uint8_t order;  /**< of the polynomial, default 2 */
    uint8_t passes; /**< how often the smoother is applied (its derivative once), 1
                                or 2; default 2 */
    bool estimate_delay; /**< default true; must be false with AUVID_SMOOTH_STATES */
    auvid_real_t delay_s[AUVID_DOF_COUNT]; /**< of the wrench, when not estimated [s]; -2..6 cells,
                                                default 0; a shift. Not read in the residual
                                              path: evaluations are told the delay */
    auvid_real_t delay_sigma_s; /**< uncertainty of the delay [s], 0..1; > 0: negative ones are
                                     estimated, too; default 0. The identifier sets its own
                                     uncertainty.delay_s */
    uint8_t first_order_lag;    /**< bit j: DoF j's given delay is that of a first-order
                                                lag, not a shift; default 0 */
    auvid_row_t *rows; /**< residual path: storage for (sets + 1) set_rows rows, owned by the
                            caller, must outlive the metric; null otherwise */
} auvid_metric_config_t;

/** An entry of a stored triangle, in units of 2^exponent of its column. */
#ifdef AUVID_REAL_DOUBLE
typedef int64_t auvid_packed_t;
#else
typedef int16_t auvid_packed_t;
#endif

/** One completed data set. Private but for `rows`, `fastest` and `driven`. */
typedef struct {
    uint32_t number;                      /* of the set, from 1 */
    auvid_real_t tau_m2[AUVID_DOF_COUNT]; /* sum of squares of the rows' wrench about its mean */
    uint16_t rows;                        /**< in it; 0: there is no such set */
    uint16_t rows_of[AUVID_DOF_COUNT];    /**< those of each DoF: all that it reads was measured */
    uint16_t lost;                     /**< rows of all DoF that gaps cost, beside `rows` */
    uint16_t windows[AUVID_DOF_COUNT]; /* residual path: rows of its triangles; see
                                          auvid_metric_linearise */
    uint16_t fastest[AUVID_DOF_COUNT][2]; /**< largest speed measured, forward and backward [mm/s,
                                               mrad/s] */
    auvid_packed_t factor[AUVID_METRIC_BANDS][AUVID_MAX_FACTOR]; /* [R_j | Z_j], DoF after DoF */
    int8_t exponent[AUVID_MAX_COLUMNS];                         /* by channel */
    uint8_t excited;                                            /**< bit j: DoF j is driven */
} auvid_set_t;

/** What was known before the first set. */
typedef struct {
    uint32_t known;                           /**< bit i: parameter i; 0: nothing */
    auvid_real_t pi[AUVID_MAX_PARAMETERS];    /**< in the parameters' units */
    auvid_real_t sigma[AUVID_MAX_PARAMETERS]; /**< standard errors, > 0 */
    /** mean square of the noise that counts over that of the residual (confidence.h), > 0 */
    auvid_real_t variance_inflation[AUVID_DOF_COUNT];
} auvid_prior_t;

/** The metric. Fields are private but for those under "results". */
typedef struct auvid_metric {
    auvid_metric_config_t cfg;
    auvid_status_t (*apply_prior)(struct auvid_metric *m, uint32_t *budget); /* null: no memory; so
                                                       that its code is linked only where used */
    uint64_t window_us; /* time of the window's last row */
    uint64_t until_us;  /* residual path: no row is taken after this while the ring is held */
    uint64_t resume_us; /* residual path: nor one from before this */
    auvid_prior_t prior;
    uint32_t columns[AUVID_DOF_COUNT];        /* free parameters in each equation */
    uint8_t count[AUVID_DOF_COUNT];           /* how many */
    uint8_t taps, overlap;                    /* of the kernel */
    uint8_t index[AUVID_MAX_COLUMNS];         /* their numbers, DoF after DoF */
    uint16_t factor_at[AUVID_DOF_COUNT];      /* where each DoF's triangle starts */
    uint16_t channel_at[AUVID_DOF_COUNT + 1]; /* where each DoF's channels start */
    auvid_real_t kernel[2][AUVID_MAX_TAPS]; /* ends in zeros, see spread */
    auvid_real_t interpolation_spread;      /* of forces, to what interpolated velocity is spread */

    /* recording */
    auvid_real_t accumulator[AUVID_MAX_OVERLAP][AUVID_MAX_COLUMNS];
    auvid_real_t fixed_wrench[AUVID_MAX_OVERLAP]
                             [AUVID_DOF_COUNT]; /* of their wrench, by fixed pi */
    auvid_real_t past_tau[AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1) + 1] /* inputs */
                         [AUVID_DOF_COUNT + AUVID_MAX_COMMANDS];
    auvid_real_t previous[AUVID_METRIC_LAGS][AUVID_MAX_COLUMNS]; /* the last rows */
    uint32_t cells;                                              /* since the record began */
    uint32_t since_gap;                                          /* rows; the last of `previous` */
    uint8_t successive[AUVID_DOF_COUNT];   /* rows without a gap of the DoF, ..AUVID_METRIC_LAGS */
    uint8_t missing[AUVID_MAX_OVERLAP][2]; /* velocities not measured in cells of a row under
                                              construction, of forces and of moments: bit i */
    /* the set being recorded */
    auvid_real_t factor[AUVID_METRIC_BANDS][AUVID_MAX_FACTOR]; /* its [R_j | Z_j]; for
                                                                  auvid_metric_linearise, too */
    auvid_real_t tau_mean[AUVID_DOF_COUNT], tau_m2[AUVID_DOF_COUNT];
    uint16_t rows; /**< so far */
    uint16_t rows_of[AUVID_DOF_COUNT];
    uint16_t lost; /* rows of all DoF that gaps in the record, or in velocities, cost */
    uint16_t fastest[AUVID_DOF_COUNT][2]; /* see auvid_set_t */

    /* evaluation */
    auvid_set_t set[AUVID_MAX_SETS];       /* the ring */
    uint32_t sets_stored;                  /* sets that it has taken in */
    auvid_real_t merged[AUVID_MAX_FACTOR]; /* the ring's [R_j | Z_j], bands weighted */
    auvid_real_t band_weight[AUVID_METRIC_BANDS][AUVID_DOF_COUNT];
    auvid_real_t band_sse[AUVID_METRIC_BANDS][AUVID_DOF_COUNT];
    auvid_real_t z[AUVID_MAX_COLUMNS];         /* wrench at the delay, by channel */
    auvid_real_t candidate[AUVID_MAX_COLUMNS]; /* pi by channel, then minus the delay's weights */
    auvid_real_t pi[AUVID_MAX_PARAMETERS];     /* pi by parameter */
    auvid_real_t delay_weight[AUVID_METRIC_DELAYS]; /* of the residual path's common delay */
    auvid_real_t weight[AUVID_DOF_COUNT];           /* 1 / (tau_max^2 rows) */
    auvid_real_t sum, compensation, squares;
    union {
        auvid_real_t window[AUVID_METRIC_WINDOW][AUVID_DOF_COUNT]; /* residuals of the last rows */
#if !AUVID_REGRESSOR_ONLY
        auvid_regressor_t regressor; /* not in the residual path: of a cell */
#endif
    };
    auvid_real_t window_weight[AUVID_METRIC_WINDOW]; /* weights in the window */
    uint32_t window_rows; /* since a gap */
    uint8_t window_of[AUVID_DOF_COUNT]; /* of each DoF, since a gap of its own, ..window_length */
    uint16_t at_row;      /* progress */
    uint16_t at_part, spent;
    uint8_t window_length;
    uint8_t at_set, to_set, at_band, at_dof, pass;
    /* see auvid_metric_hold */
    uint8_t from;        /* newest sets of the ring that do not count */
    uint8_t waiting;     /* newest sets that were completed since the ring was held last */
    uint8_t least;       /* sets that count are not overwritten when there are so many or fewer */
    uint8_t sets_merged; /* sets with a driven DoF at the last merge */
    bool held, full, ring_changed;
    auvid_real_t linear_delay_s; /* at which the residual path was linearised */

    /** @name results */
    /**@{*/
    uint8_t excited;                       /**< bit j: DoF j is driven in some set merged */
    uint16_t dof_rows[AUVID_DOF_COUNT];    /**< rows of each DoF in sets in which it is driven */
    auvid_real_t delay_s[AUVID_DOF_COUNT]; /**< delays in use [s]; estimated at each merge */
    uint8_t first_order_lag;               /**< bit j: DoF j's delay is that of a first-order lag,
                                                not a shift */
    auvid_real_t constant;                 /**< part of the cost that no pi explains; 0 in the
                                                residual path */
    auvid_real_t cost;                     /**< J of the last finished evaluation */
    auvid_real_t sse[AUVID_DOF_COUNT];     /**< sums of squared residuals of the last finished
                                                measurement [N^2, Nm^2] */
    uint32_t sets_recorded;                /**< sets completed since init */
    uint32_t rows_dropped;                 /**< complete rows that no evaluation will see, because
                                                the ring was held; see auvid_metric_hold */
    auvid_real_t predicted[AUVID_DOF_COUNT]; /**< band-weighted sums of squares of the newest set's
                                                  residuals at the last prediction [N^2, Nm^2] */
    auvid_real_t change[2][AUVID_DOF_COUNT]; /**< what the newest set (0), the newest two (1) and
                                                  the others fit worse together than apart [N^2,
                                                  Nm^2]; see auvid_metric_change */
    uint8_t change_rank[AUVID_DOF_COUNT];    /**< parameters that this was about */
    /**@}*/
} auvid_metric_t;

#define auvid_metric_defaults AUVID_SIZED(auvid_metric_defaults)
/** Fill *cfg for the Girona500 model: how the filter was chosen stands in auvid_metric.c. Null is
 * ignored. */
void auvid_metric_defaults(auvid_metric_config_t *cfg, const auvid_vehicle_t *vehicle);

#define auvid_metric_literal AUVID_SIZED(auvid_metric_literal)
/** Change *cfg to our reading of the paper: order 3, half-width 0.5 s, states smoothed,
 * accelerations by the Savitzky-Golay derivative, one pass, wrench raw, delay not estimated. Null
 * is ignored. */
void auvid_metric_literal(auvid_metric_config_t *cfg);

#define auvid_metric_init AUVID_SIZED(auvid_metric_init)
/** Start empty.
 * @param cfg copied; may be metric->cfg
 * @return AUVID_OK; AUVID_ERR_NULL; those of auvid_vehicle_check; AUVID_ERR_RANGE (a field out of
 * its range); AUVID_ERR_NOT_FINITE; AUVID_ERR_PARAMETERS (nothing free); AUVID_ERR_SIZE (columns,
 * factor, taps, overlap or half-width exceed config.h); AUVID_ERR_SINGULAR (order > 2 half_width);
 * AUVID_ERR_MODEL (residual path without storage; or left out, see AUVID_REGRESSOR_ONLY). */
auvid_status_t auvid_metric_init(auvid_metric_t *metric, const auvid_metric_config_t *cfg);

#define auvid_metric_add AUVID_SIZED(auvid_metric_add)
/** Take the next cell of an unbroken record.
 * @return AUVID_OK; AUVID_SET_COMPLETE (the ring has turned: merge before the next evaluation; one
 * under way is void); AUVID_SET_IDLE (the ring is as before); AUVID_ERR_NULL;
 * AUVID_ERR_NOT_FINITE (cell ignored: the record has a hole now, say `gap`). Rows in which the
 * model's regressor is not finite, or beyond 1e15, are left out and not counted. Cost: above. */
auvid_status_t auvid_metric_add(auvid_metric_t *metric, const auvid_sample_t *sample);

#define auvid_metric_gap AUVID_SIZED(auvid_metric_gap)
/** The record was broken: rows under construction are dropped, the set goes on. Null is ignored. */
void auvid_metric_gap(auvid_metric_t *metric);

#define auvid_metric_close AUVID_SIZED(auvid_metric_close)
/** Complete the set early.
 * @return AUVID_SET_COMPLETE; AUVID_SET_IDLE (see add); AUVID_PENDING (residual path: it enters the
 * ring at auvid_metric_release); AUVID_ERR_NULL; AUVID_ERR_NO_DATA (it has no row: nothing done).
 */
auvid_status_t auvid_metric_close(auvid_metric_t *metric);

#define auvid_metric_hold AUVID_SIZED(auvid_metric_hold)
/** Hold the ring for a search: the sets that are in it now are the ones that count until
 * auvid_metric_release. Sets that are completed meanwhile wait.
 *
 * Regressor path: they enter the ring at once, in the place of the oldest, but do not count. At
 * most (sets - 1) / 2 of them (at least one), or as many as there are free places, are kept, and
 * none that would leave fewer than `least` sets that count. Of more, the oldest waiting one is lost
 * and its rows are counted in `rows_dropped`. `turned` says that a set has entered: begin the walk
 * under way again. A search needs none: it has `merged`.
 *
 * Residual path: none enters. The set being recorded takes rows until it is full; further ones are
 * dropped and counted. NULL is a no-op.
 * @param until_us residual path: nor does it take rows after this time; UINT64_MAX: no such limit
 */
void auvid_metric_hold(auvid_metric_t *metric, uint64_t until_us);

#define auvid_metric_release AUVID_SIZED(auvid_metric_release)
/** The search is over: all sets count again, and a set that waits in the residual path enters the
 * ring.
 * @param resume_us residual path: where rows were dropped, those whose middle is before this time
 * are dropped, too
 * @return AUVID_OK; AUVID_SET_COMPLETE, AUVID_SET_IDLE (such a set; see add); AUVID_ERR_NULL. */
auvid_status_t auvid_metric_release(auvid_metric_t *metric, uint64_t resume_us);

#define auvid_metric_drop AUVID_SIZED(auvid_metric_drop)
/** Forget the completed set recorded `age` sets ago (0: the last that counts). Merge afterwards.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (no such set in the
 * ring, or forgotten before). */
auvid_status_t auvid_metric_drop(auvid_metric_t *metric, uint8_t age);

#define auvid_metric_set_prior AUVID_SIZED(auvid_metric_set_prior)
/** Go on from what is known: rows that say pi = its value within its standard error are merged with
 * those of the sets, weighted with the residual of these. Where the sets contradict them
 * (Chow's F of a DoF above 6), they are forgotten: memory.known is 0 then. Regressor path only.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (a bit of `known` that
 * is no free parameter's, a value beyond 1e18, of a known parameter a standard error or colour that
 * is not > 0 or is beyond 2e30); AUVID_ERR_MODEL (residual path: checked, and not used). Refused:
 * nothing changed. */
auvid_status_t auvid_metric_set_prior(auvid_metric_t *metric, const auvid_prior_t *memory);

#define auvid_metric_merge_begin AUVID_SIZED(auvid_metric_merge_begin)
/** Begin to bring the completed sets together. Must be followed by merge until AUVID_OK. */
void auvid_metric_merge_begin(auvid_metric_t *metric);

#define auvid_metric_merge AUVID_SIZED(auvid_metric_merge)
/** Go on with it.
 * @param budget units of work left, reduced by those used. The whole takes three passes over all
 * rows of all sets and bands, at four units a row, in the second at one, and eight for each DoF
 * @return AUVID_OK (ready for evaluations); AUVID_PENDING (budget used up); AUVID_ERR_NO_DATA (no
 * set, or no DoF driven in any); AUVID_ERR_NULL. */
auvid_status_t auvid_metric_merge(auvid_metric_t *metric, uint32_t *budget);

#define auvid_metric_cost_begin AUVID_SIZED(auvid_metric_cost_begin)
/** Begin to evaluate the cost of pi [n]: values of parameters that are not free are ignored.
 * Null is ignored, too.
 * @param delay_s residual path: the common delay, 0..6 cells; not read in the regressor path. */
void auvid_metric_cost_begin(auvid_metric_t *metric, const auvid_real_t *pi, auvid_real_t delay_s);

#define auvid_metric_cost AUVID_SIZED(auvid_metric_cost)
/** Go on with it.
 * @param budget as in merge: one unit for each row of R, or vehicle->work for each stored sample
 * @return AUVID_OK (metric->cost written); AUVID_PENDING; AUVID_ERR_NULL. A cost that is not finite
 * is returned as such: the optimizer treats it as very bad. */
auvid_status_t auvid_metric_cost(auvid_metric_t *metric, uint32_t *budget);

#define auvid_metric_measure_begin AUVID_SIZED(auvid_metric_measure_begin)
/** Begin to measure the residuals of pi [n] for each DoF, unweighted (for R2). */
void auvid_metric_measure_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                auvid_real_t delay_s);

#define auvid_metric_predict_begin AUVID_SIZED(auvid_metric_predict_begin)
/** Begin to predict the newest set, before it is merged: measure pi's residuals on it alone. Go on
 * with auvid_metric_measure, which then writes `predicted` besides. The bands are weighted as at
 * the last merge. Null is ignored. */
void auvid_metric_predict_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                auvid_real_t delay_s);

#define auvid_metric_change_begin AUVID_SIZED(auvid_metric_change_begin)
/** Begin to compare the newest sets with the others, before they are merged: does each DoF's
 * equation hold for both with the same parameters (Chow 1960)? Bands and delays are those of the
 * last merge. What was merged is lost: merge afterwards. Null is ignored. */
void auvid_metric_change_begin(auvid_metric_t *metric);

#define auvid_metric_change AUVID_SIZED(auvid_metric_change)
/** Go on with it.
 * @param budget four units for each row of each set, and of the newest two once more
 * @return AUVID_OK (`change` and `change_rank` written: U of all sets - U of the others - U of the
 * newest, U the part of the wrench that no pi explains); AUVID_PENDING; AUVID_ERR_NULL. */
auvid_status_t auvid_metric_change(auvid_metric_t *metric, uint32_t *budget);

#define auvid_metric_linearise_begin AUVID_SIZED(auvid_metric_linearise_begin)
/** Residual path: begin to make of each of the newest `sets` sets the triangles that a model with
 * the derivatives of this one at pi would have, for judge and for confidence.h. The derivatives are
 * central differences over 1 % of each parameter (at least 1e-4, 1e-3 where it is zero) and 10 ms
 * of delay. A window of smoothed residuals is left out if a residual or a derivative is not finite,
 * or beyond 1e15.
 * Nothing happens for a model with regressor, and for null. */
void auvid_metric_linearise_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                  auvid_real_t delay_s, uint8_t sets);

#define auvid_metric_linearise AUVID_SIZED(auvid_metric_linearise)
/** Go on with it, and when all sets of the ring are done, merge their triangles.
 * @param budget vehicle->work units for each call of the model: 2 n + 3 for each row and each row
 * of the window over which residuals are smoothed, on rows about one standard deviation of that
 * window apart
 * @return AUVID_OK; AUVID_PENDING; AUVID_ERR_NULL. */
auvid_status_t auvid_metric_linearise(auvid_metric_t *metric, uint32_t *budget);

#define auvid_metric_longest_delay AUVID_SIZED(auvid_metric_longest_delay)
/** Longest delay that can be had in the residual path [s]: 6 cells; 0 for null. */
auvid_real_t auvid_metric_longest_delay(const auvid_metric_t *metric);

#define auvid_metric_measure AUVID_SIZED(auvid_metric_measure)
/** Go on with it: one unit for each row of each set. @return AUVID_OK (metric->sse written);
 * AUVID_PENDING; AUVID_ERR_NULL. */
auvid_status_t auvid_metric_measure(auvid_metric_t *metric, uint32_t *budget);

#define auvid_metric_newest AUVID_SIZED(auvid_metric_newest)
/** The newest set that counts; never null. */
const auvid_set_t *auvid_metric_newest(const auvid_metric_t *metric);

#define auvid_metric_excited_sets AUVID_SIZED(auvid_metric_excited_sets)
/** How many sets of the ring drive DoF j, without the newest `newest`. */
int auvid_metric_excited_sets(const auvid_metric_t *metric, int j, int newest);

#define auvid_metric_active AUVID_SIZED(auvid_metric_active)
/** Free parameters whose own DoF is driven: bit i. Valid after merge. */
uint32_t auvid_metric_active(const auvid_metric_t *metric);

#define auvid_metric_searched AUVID_SIZED(auvid_metric_searched)
/** Parameters to search for: the active ones, and in the regressor path those free ones with
 * `fixed` zero that only the equations of other, driven DoF contain (a vehicle that turns under way
 * drifts sideways: m_v v r acts on surge, whether or not sway is driven). Left at zero, they would
 * bias what is identified; their own values are by-products, often poor. Bits as in active; valid
 * after merge. */
uint32_t auvid_metric_searched(const auvid_metric_t *metric);

#define auvid_metric_scale AUVID_SIZED(auvid_metric_scale)
/** Scale of each parameter, 1 / sqrt(sum_j w_j ||column i of R_j||^2): a step of one changes the
 * dimensionless rms force by one. Regressor path; 0 where the column is empty, and everywhere in
 * the residual path. Null is ignored.
 * @param scale [n] */
void auvid_metric_scale(const auvid_metric_t *metric, auvid_real_t *scale);

#define auvid_metric_r2 AUVID_SIZED(auvid_metric_r2)
/** Coefficient of determination of the smoothed wrench after a finished measurement:
 * 1 - sse / sum of squares about each set's mean; 0 for DoF that are not driven, and where the
 * model's residuals are not finite. Null is ignored.
 * @param r2 [6] */
void auvid_metric_r2(const auvid_metric_t *metric, auvid_real_t *r2);

#define auvid_metric_least_squares AUVID_SIZED(auvid_metric_least_squares)
/** The least-squares optimum in closed form: an oracle for tests and a diagnostic for users of
 * models that are linear; the identifier does not use it.
 * @param active parameters to solve for (bit i), of the free ones; others keep their value in pi
 * @param pi [n] in and out
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_MODEL (residual path); AUVID_ERR_SINGULAR (some
 * parameter is not determined; it is set to zero). Stack: (n + 1)(n + 2) / 2 numbers. */
auvid_status_t auvid_metric_least_squares(const auvid_metric_t *metric, uint32_t active,
                                          auvid_real_t *pi);

#ifdef __cplusplus
}
#endif

#endif
