/**
 * @file detail/metric.h
 * No stability promised: for the structs that contain it, for tests and tools.
 *
 * Metric: how badly does a parameter vector explain the recorded data? (III-B, Eq. 9-11)
 *
 * Cells from the recorder pass a smoother, which forms one row every half second. Rows are
 * collected in data sets. Completed sets form a ring, which is evaluated while the next set is
 * recorded.
 *
 * Two paths share one interface:
 * - *Regressor path*, for models linear in pi. The rows of Y are formed from unsmoothed cells. The
 *   rows and the wrench of each DoF pass the same smoother, so it attenuates both sides alike. (The
 *   paper smooths the states and names no filter for tau; that leaves a bias which more data does
 *   not cure.) The sums and the differences of successive rows are the low and the high band. They
 *   are stored as R factors [R | Z] for each DoF, where Z holds the wrench at three delays. When
 *   sets are merged, each band is weighted by the inverse of its residual, which whitens the
 *   residual whatever disturbs the vehicle. The cost is
 *       J(pi) = sum_j ||R_j pi - z_j||^2 / (tau_max_j^2 rows_j),
 *   without the part that no pi explains. That part is stored in `constant`: in float32 it would
 *   swamp the differences that the optimizer needs.
 * - *Residual path*, for any other model. Means over each row's time are stored. The user's
 *   function is called on each. Binomial weights of about 0.6 s standard deviation smooth the
 *   residuals. J(pi) = sum_j sum_k smoothed_jk^2 / (tau_max_j^2 rows_j). A model that is
 *   not linear in the commands, for example one with a dead band, needs commands that are not
 *   averaged: use rows of two cells for such a model.
 *
 * Delay between command and response, for each DoF: z_j(d) = Z_j l(d). The weights l have sum one
 * and mean d. Their second moment is d^2 for a shift (they are Lagrange polynomials then). It is
 * 2 d^2 for a first-order lag, as of a thruster. The metric searches d_j and its kind from 0 to 6
 * cells, over all sets in the ring. It minimises the part of the wrench that no pi explains. The
 * delay is zero unless the data determine it. If the configuration gives an uncertainty of the
 * delay, shifts from -2 cells on are also tried. Thrust with late time stamps seems to follow the
 * motion. The uncertainty of the delay enters the standard errors (confidence.h). In the
 * residual path one shift, common to wrench and commands, is searched together with the parameters.
 *
 * Width of the smoother, in the regressor path: it is a number of cells, so it follows their
 * length, as do the distance of the rows, the range of the delays and the duration of a set. If in
 * some DoF the residual of the high band exceeds the wrench there, these rows are mostly noise, of
 * sensors or of waves. Then, after the estimate, the cells are doubled and the sets are dropped,
 * provided that the new cell is at most a fifth of this DoF's time constant. The length does not
 * change any more once three sets are without such noise. A slow ship gets cells of 0.2 to 0.8 s.
 * A vehicle that is quick, or has good sensors, keeps 0.1 s.
 *
 * If a velocity that a DoF's equation reads (vehicle.h) was not measured within the smoother's
 * window, that equation has no row; the other equations have theirs. Each DoF counts its own rows.
 *
 * A DoF whose wrench hardly varies within a set is not excited. Its rows of that set are left out
 * of the search, because they would pull its parameters to zero with a small formal error. A set in
 * which no DoF with a free parameter is excited does not enter the ring: an idle vehicle keeps its
 * estimate.
 *
 * In the regressor path an equation can be *informative* although its DoF is excited in no set: if
 * coupling with excited DoF moves it, as turns move the sway of a vehicle without lateral thruster.
 * After a search, auvid_metric_solve_coupled solves such equations for their own parameters, given
 * those of the excited DoF. They change nothing about the others (auvid_metric_coupled.c).
 *
 * The identifier calls `add` and `gap` from the control tick, the rest from work().
 * Cost, Girona500: add takes 0.4k multiplications a cell, and four rows of Givens rotations every
 * half second; a cost evaluation takes 78 multiplications. Memory: sizeof(auvid_metric_t), 17 KiB
 * with default sizes. Each completed set takes 1.0 KiB of it, at 16 bits a number. Completing a set
 * costs 11k instructions of a Cortex-M4F.
 */
#ifndef AUVID_METRIC_H
#define AUVID_METRIC_H

#include "auvid/metric_config.h"
#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Bands into which the rows are split: sums and differences of successive rows. */
#define AUVID_METRIC_BANDS 2
/** Rows stored to form them. */
#define AUVID_METRIC_LAGS 2
/** Largest number of rows whose residuals are averaged in the residual path. */
#define AUVID_METRIC_WINDOW (AUVID_MAX_COMMANDS > 0 ? 31 : 1)

/** An entry of a stored R factor, in units of 2^exponent of its column. */
#ifdef AUVID_REAL_DOUBLE
typedef int64_t auvid_packed_t;
#else
typedef int16_t auvid_packed_t;
#endif

/** One completed data set. All fields are private except `rows`, `fastest` and `excited`. */
typedef struct {
    auvid_real_t tau_m2[AUVID_DOF_COUNT]; /* sum of squares of the rows' wrench about its mean */
    auvid_packed_t factor[AUVID_METRIC_BANDS][AUVID_MAX_FACTOR]; /* [R_j | Z_j], DoF after DoF */
    uint32_t number;                                             /* number of the set, from 1 */
    uint16_t rows;                        /**< rows in the set; 0: there is no such set */
    uint16_t rows_of[AUVID_DOF_COUNT];    /**< rows of each DoF: all that it reads was measured */
    uint16_t lost;                        /**< rows of all DoF lost to gaps, not in `rows` */
    uint16_t windows[AUVID_DOF_COUNT];    /* residual path: rows of its R factors; see
                                             auvid_metric_linearise */
    uint16_t fastest[AUVID_DOF_COUNT][2]; /**< largest speed measured, forward [0] and backward [1]
                                               [mm/s, mrad/s] */
    int8_t exponent[AUVID_FILLED(AUVID_MAX_COLUMNS + 1) - 1]; /* by channel, and spare ones */
    uint8_t excited;                                          /**< bit j: DoF j is excited */
} auvid_set_t;

/** What follows from the configuration. Private: written by auvid_metric_init. */
typedef struct {
    auvid_real_t window_weight[AUVID_METRIC_WINDOW];
    /* spreads the wrench of forces as interpolation does velocity: see auvid_metric_regressor.c */
    auvid_real_t interpolation_spread;
    auvid_real_t kernel[2][AUVID_MAX_TAPS];   /* ends in zeros, see interpolation_spread */
    uint32_t columns[AUVID_DOF_COUNT];        /* free parameters in each equation */
    uint16_t factor_at[AUVID_DOF_COUNT];      /* where each DoF's R factor starts */
    uint16_t channel_at[AUVID_DOF_COUNT + 1]; /* where each DoF's channels start */
    uint8_t count[AUVID_DOF_COUNT];           /* number of free parameters in each equation */
    uint8_t taps, overlap;                    /* of the kernel */
    uint8_t window_length;
    uint8_t interpolation_step;       /* [cells], likewise */
    uint8_t half_width;               /* of the kernel of forces */
    uint8_t index[AUVID_MAX_COLUMNS]; /* parameter numbers, DoF after DoF */
    /* of the merged R factors, see auvid_metric_order_columns: */
    uint8_t merged_index[AUVID_MAX_COLUMNS]; /* parameter numbers, DoF after DoF */
    uint8_t leading[AUVID_DOF_COUNT];        /* columns that the DoF's equation determines */
} auvid_metric_layout_t;

/** The set being recorded. Private except `rows`. */
typedef struct {
    uint16_t rows;                        /**< so far */
    uint16_t lost;                        /* rows of all DoF lost to gaps in the record or in
                                             velocities */
    uint16_t rows_of[AUVID_DOF_COUNT];    /* see auvid_set_t */
    uint16_t fastest[AUVID_DOF_COUNT][2]; /* see auvid_set_t */
    auvid_real_t tau_mean[AUVID_DOF_COUNT], tau_m2[AUVID_DOF_COUNT];
    auvid_real_t factor[AUVID_METRIC_BANDS][AUVID_MAX_FACTOR]; /* its [R_j | Z_j]; also used by
                                                                  auvid_metric_linearise */
} auvid_partial_set_t;

/** Rows: cells become smoothed rows, rows become a set. Private. */
typedef struct {
    uint32_t cells;                        /* since the record began */
    uint32_t since_gap;                    /* rows; the last of `previous` */
    uint8_t successive[AUVID_DOF_COUNT];   /* rows without a gap of the DoF, ..AUVID_METRIC_LAGS */
    uint8_t missing[AUVID_MAX_OVERLAP][2]; /* bit i: velocity i was not measured in a cell of a row
                                              under construction, of forces and of moments */
    uint8_t waiting; /* bit j: the last row of DoF j is not yet in its R factors */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), 7 + 2 * AUVID_MAX_OVERLAP)];
    auvid_partial_set_t set; /* being recorded */
    auvid_real_t accumulator[AUVID_MAX_OVERLAP][AUVID_MAX_COLUMNS];
    auvid_real_t fixed_wrench[AUVID_MAX_OVERLAP][AUVID_DOF_COUNT]; /* explained by fixed pi */
    auvid_real_t past_tau[AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1) + 1] /* inputs */
                         [AUVID_DOF_COUNT + AUVID_MAX_COMMANDS];
    auvid_real_t previous[AUVID_METRIC_LAGS][AUVID_MAX_COLUMNS]; /* the last rows */
} auvid_metric_rows_t;

/** Sets: the ring of completed sets. See auvid_metric_hold. */
typedef struct {
    uint64_t until_us;     /* residual path: no row is stored after this while the ring is held */
    uint64_t resume_us;    /* residual path: no row is stored whose middle is before this */
    uint32_t recorded;     /**< sets completed since init */
    uint32_t rows_dropped; /**< complete rows lost to every evaluation because the ring was held */
    uint32_t stored;       /* sets stored in the ring so far */
    uint8_t from;          /* number of newest sets of the ring that do not count */
    uint8_t waiting;       /**< number of newest sets completed since the ring was last held */
    uint8_t least;         /* sets that count are not overwritten if there are so many or fewer */
    bool held, full;
    bool changed; /* a set has entered since it is held */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), 18)];
    auvid_set_t set[AUVID_MAX_SETS];
    auvid_real_t min_wrench_m2[AUVID_DOF_COUNT]; /* [N2, N2 m2]; see auvid_metric_set_residual */
} auvid_metric_sets_t;

/** Columns of the test for feedback: one, four of the wrench's past, the residual, the wrench. */
#define AUVID_FEEDBACK_ORDER 7

/** Is the wrench feedback? Private: see auvid_metric_feedback.c. */
typedef struct {
    uint32_t stored; /* sets stored in the ring at the last row */
    uint32_t cells;  /* without a gap */
    auvid_real_t factor[AUVID_DOF_COUNT][AUVID_FEEDBACK_ORDER * (AUVID_FEEDBACK_ORDER + 1) / 2];
    auvid_real_t rows[AUVID_DOF_COUNT];        /* in the factors; old ones count less */
    auvid_real_t sum[AUVID_DOF_COUNT];         /* of residuals, of the block under way */
    auvid_real_t residual[4][AUVID_DOF_COUNT]; /* means over blocks of cells, the newest first */
    auvid_real_t wrench[3][AUVID_DOF_COUNT];   /* likewise, relative to tau_max */
} auvid_metric_feedback_t;

/** Where a pass over the rows of the sets stands. Private; whoever begins a pass owns it. */
typedef struct {
    uint16_t row, part, spent;
    uint8_t set, to_set, band, dof;
    uint8_t pass; /* its purpose */
    bool plain;   /* without rows from outside */
} auvid_metric_cursor_t;

/** Largest number of windows of residuals that contain a row, in the residual path. */
#define AUVID_METRIC_WINDOWS (AUVID_MAX_COMMANDS > 0 ? 16 : 1)

/** Windows of residuals under way, each with the sums of its rows' derivatives. Private; memory
 * for auvid_metric_linearise, which need not be initialised. */
typedef struct {
    auvid_real_t z[AUVID_METRIC_WINDOWS][AUVID_MAX_COLUMNS]; /* e_i, e and e_d, by channel */
    uint8_t missing[16]; /* bit i: velocity i was not measured in a row; always 16: no gap */
} auvid_metric_windows_t;

/** Evaluator: the ring's merged R factors, and the candidate under evaluation. Private. */
typedef struct {
    uint64_t window_us; /* time of the window's last row */
    auvid_real_t sum, compensation, squares;
    auvid_real_t linear_delay_s;          /* delay at which the residual path was linearised */
    auvid_real_t weight[AUVID_DOF_COUNT]; /* 1 / (tau_max^2 rows) */
    auvid_real_t band_weight[AUVID_METRIC_BANDS][AUVID_DOF_COUNT];
    auvid_real_t band_sse[AUVID_METRIC_BANDS][AUVID_DOF_COUNT];
    auvid_real_t high_wrench[AUVID_DOF_COUNT];     /* sum of squares of the high band's wrench */
    auvid_real_t coupled_squares[AUVID_DOF_COUNT]; /* sum of squares of the force of coupling */
    auvid_real_t disagreement[AUVID_DOF_COUNT]; /* relative, of the parameters shared with excited
                                                   DoF: see auvid_metric_coupled.c */
    auvid_real_t delay_weight[AUVID_METRIC_DELAYS]; /* of the residual path's common delay */
    auvid_real_t thrust; /* number of the candidate's thrust, if the model computes its own */
    auvid_real_t pi[AUVID_MAX_PARAMETERS];     /* pi by parameter */
    auvid_real_t candidate[AUVID_MAX_COLUMNS]; /* pi by channel, then minus the delay's weights */
    auvid_real_t z[AUVID_MAX_COLUMNS];         /* wrench at the delay, by channel */
    auvid_real_t merged[AUVID_MAX_FACTOR];     /* the ring's [R_j | Z_j], bands weighted */
    uint32_t window_rows;                      /* rows since a gap */
    uint16_t coupled_rows[AUVID_DOF_COUNT];    /* merged rows of the DoF that are not excited */
    auvid_metric_cursor_t at;
    uint8_t window_of[AUVID_DOF_COUNT]; /* rows of each DoF since a gap of it, ..window_length */
    uint8_t sets_merged;                /* sets with an excited DoF at the last merge */
    uint8_t noise;                      /* what the high bands show: auvid_metric_width.c */
    union {
        auvid_real_t window[AUVID_METRIC_WINDOW][AUVID_DOF_COUNT]; /* residuals of the last rows */
#if AUVID_MAX_COMMANDS > 0
        auvid_regressor_t regressor; /* of a cell */
#endif
    };
} auvid_metric_evaluator_t;

/** Results of the evaluator. */
typedef struct {
    auvid_real_t cost;                     /**< J of the last finished evaluation */
    auvid_real_t constant;                 /**< part of the cost that no pi explains; 0 in the
                                                residual path */
    auvid_real_t delay_s[AUVID_DOF_COUNT]; /**< delays in use [s]; estimated at each merge */
    auvid_real_t sse[AUVID_DOF_COUNT];     /**< sums of squared residuals of the last finished
                                                measurement [N^2, Nm^2] */
    uint16_t dof_rows[AUVID_DOF_COUNT];    /**< rows of each DoF in sets in which it is excited */
    uint8_t excited;                       /**< bit j: DoF j is excited in some merged set */
    uint8_t first_order_lag;               /**< bit j: DoF j's delay is that of a first-order lag,
                                               not a shift */
    uint8_t doublings;                     /**< of the cell, see auvid_metric_cell_us */
    bool width_chosen;                     /**< the length of the cells does not change any more */
    uint8_t coupled; /**< bit j: DoF j is excited in no merged set, and coupling with excited DoF
                          makes its equation informative: see auvid_metric_solve_coupled */
} auvid_metric_result_t;

/** Result of the change test. */
typedef struct {
    auvid_real_t change[2][AUVID_DOF_COUNT];      /**< Chow statistic: pooled minus separate sum of
                                                  squared residuals of the older sets and the newest
                                                  set [0], or the newest two [1] [N^2, Nm^2] */
    auvid_real_t unexplained[2][AUVID_DOF_COUNT]; /**< sum of squared residuals of the newest set
                                                       [0], or the newest two [1], fitted without
                                                       the older ones [N^2, Nm^2] */
    auvid_real_t sag; /* share of the thrust from set to set, see auvid_metric_change_begin */
    uint8_t rank[AUVID_DOF_COUNT]; /**< number of parameters tested */
    uint8_t reserved[2];
} auvid_metric_change_t;

/** The metric. Read `result`; the rest is private where it says so. */
typedef struct auvid_metric {
    auvid_metric_config_t cfg;
    /* What is known of the parameters before the sets (prior.h). NULL: nothing */
    const struct auvid_metric_prior *prior;
    void *prior_context;
    /* More columns of the regressor path's rows, outside of the metric (uncertain.h). NULL: none */
    const struct auvid_metric_extra *extra;
    void *extra_context;
    auvid_metric_layout_t layout;
    /* state: from here on, see checkpoint.h */
    auvid_metric_result_t result;
    auvid_metric_evaluator_t evaluator;
    auvid_metric_rows_t rows;
    auvid_metric_sets_t sets;
    auvid_metric_feedback_t feedback;
} auvid_metric_t;

#define auvid_metric_defaults AUVID_SIZED(auvid_metric_defaults)
/** Fill *cfg with the defaults, which suit the Girona500 model. auvid_metric_regressor.c and
 * auvid_metric_width.c give the reasons for the choice of the filter. NULL is a no-op.
 * @param cfg written
 * @param vehicle must outlive the metric; gives `free`. NULL: `free` is 0 */
void auvid_metric_defaults(auvid_metric_config_t *cfg, const auvid_vehicle_t *vehicle);

#define auvid_metric_init AUVID_SIZED(auvid_metric_init)
/** Start with an empty ring.
 * @param cfg copied; may be metric->cfg
 * @return AUVID_OK; AUVID_ERR_NULL; those of auvid_vehicle_check; AUVID_ERR_RANGE (a field is out
 * of its range); AUVID_ERR_NOT_FINITE; AUVID_ERR_PARAMETERS (no parameter is free); AUVID_ERR_SIZE
 * (sets, columns, factor, taps, overlap or half-width exceed config.h; residual path with
 * AUVID_MAX_COMMANDS 0, or with fewer row_slots than rows); AUVID_ERR_MODEL (the path lacks its
 * function of the model, or the residual path its storage). */
auvid_status_t auvid_metric_init(auvid_metric_t *metric, const auvid_metric_config_t *cfg);

#define auvid_metric_add AUVID_SIZED(auvid_metric_add)
/** Add the next cell of an unbroken record. A row whose regressor is not finite, or has an entry
 * beyond 1e15, is left out and not counted. Cost: see above.
 * @return AUVID_OK; AUVID_SET_COMPLETE (a set entered the ring: merge before the next evaluation;
 * the result of an evaluation in progress is undefined); AUVID_SET_IDLE (a set was completed and
 * not stored: no DoF with a free parameter is excited in it); AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE
 * (the cell is ignored and the record has a gap: call auvid_metric_gap). */
auvid_status_t auvid_metric_add(auvid_metric_t *metric, const auvid_sample_t *sample);

#define auvid_metric_gap AUVID_SIZED(auvid_metric_gap)
/** Report a break in the record. Rows under construction are dropped; the set continues. NULL is a
 * no-op. */
void auvid_metric_gap(auvid_metric_t *metric);

#define auvid_metric_close AUVID_SIZED(auvid_metric_close)
/** Complete the set early.
 * @return AUVID_SET_COMPLETE or AUVID_SET_IDLE (see auvid_metric_add); AUVID_PENDING (residual
 * path, ring held: the set enters the ring at auvid_metric_release); AUVID_ERR_NULL;
 * AUVID_ERR_NO_DATA (the set has no row: nothing was done). */
auvid_status_t auvid_metric_close(auvid_metric_t *metric);

#define auvid_metric_hold AUVID_SIZED(auvid_metric_hold)
/** Hold the ring for a search: until auvid_metric_release, only the sets that are in it now count.
 * NULL is a no-op.
 *
 * Regressor path: a set completed meanwhile enters the ring at once, replaces the oldest, and does
 * not count. At most (sets - 1) / 2 such sets (at least one) are kept, or as many as the ring has
 * free slots. If there are more, the oldest waiting set is lost and its rows are counted in
 * `sets.rows_dropped`. When a set has entered, a pass over the sets that is in progress must
 * restart. A search needs no such pass: it reads the merged sets.
 *
 * Residual path: no set enters the ring. The set being recorded takes rows until it is full;
 * further rows are dropped and counted.
 * @param until_us residual path: the set takes no rows after this time; UINT64_MAX: no such limit
 */
void auvid_metric_hold(auvid_metric_t *metric, uint64_t until_us);

#define auvid_metric_release AUVID_SIZED(auvid_metric_release)
/** End the hold: all sets count again, and a set that waits in the residual path enters the ring.
 * @param resume_us residual path: where rows were dropped, rows whose middle is before this time
 * are also dropped
 * @return AUVID_OK; AUVID_SET_COMPLETE (the set that waited entered the ring); AUVID_ERR_NULL. */
auvid_status_t auvid_metric_release(auvid_metric_t *metric, uint64_t resume_us);

#define auvid_metric_drop AUVID_SIZED(auvid_metric_drop)
/** Delete a completed set from the ring. Merge afterwards.
 * @param age 0: the newest set that counts; 1: the one before it, and so on
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_RANGE (there is no such set in the ring, or it was
 * already deleted). */
auvid_status_t auvid_metric_drop(auvid_metric_t *metric, uint8_t age);

#define auvid_metric_merge_begin AUVID_SIZED(auvid_metric_merge_begin)
/** Begin to merge the completed sets. Call auvid_metric_merge next, until it returns AUVID_OK. NULL
 * is a no-op. */
void auvid_metric_merge_begin(auvid_metric_t *metric);

#define auvid_metric_merge AUVID_SIZED(auvid_metric_merge)
/** Continue the merge started by auvid_metric_merge_begin.
 * @param budget units of work left, reduced by those used. The merge makes three passes over all
 * rows of excited DoF, of all sets and bands, and one over those of DoF that are not excited in any
 * set and have parameters of their own. A row costs four units, in the second pass one; each DoF
 * costs eight in each pass
 * @return AUVID_OK (ready for evaluations); AUVID_PENDING (budget used up); AUVID_ERR_NO_DATA (the
 * ring is empty, or no DoF is excited in any set); AUVID_ERR_NULL. */
auvid_status_t auvid_metric_merge(auvid_metric_t *metric, uint32_t *budget);

#define auvid_metric_cost_begin AUVID_SIZED(auvid_metric_cost_begin)
/** Begin to evaluate the cost of pi. NULL is a no-op.
 * @param pi [n] candidate; values of parameters that are not free are ignored
 * @param delay_s residual path: the common delay, 0..6 cells [s]; not read in the regressor path */
void auvid_metric_cost_begin(auvid_metric_t *metric, const auvid_real_t *pi, auvid_real_t delay_s);

#define auvid_metric_cost AUVID_SIZED(auvid_metric_cost)
/** Continue the cost evaluation started by auvid_metric_cost_begin.
 * @param budget units of work left, reduced by those used: one for each row of R, or vehicle->work
 * for each stored sample
 * @return AUVID_OK (result.cost is written); AUVID_PENDING (budget used up); AUVID_ERR_NULL. A
 * cost that is not finite is returned as it is; the optimizer treats it as very bad. */
auvid_status_t auvid_metric_cost(auvid_metric_t *metric, uint32_t *budget);

#define auvid_metric_measure_begin AUVID_SIZED(auvid_metric_measure_begin)
/** Begin to measure the residuals of pi for each DoF, without weights (for R2). NULL is a no-op.
 * @param pi [n]
 * @param delay_s as in auvid_metric_cost_begin */
void auvid_metric_measure_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                auvid_real_t delay_s);

#define auvid_metric_predict_begin AUVID_SIZED(auvid_metric_predict_begin)
/** Begin to predict the newest set before it is merged: measure the residuals of pi on that set
 * only. auvid_metric_measure continues it; then read auvid_metric_predicted. The bands have the
 * weights of the last merge. NULL is a no-op.
 * @param pi [n]
 * @param delay_s as in auvid_metric_cost_begin */
void auvid_metric_predict_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                auvid_real_t delay_s);

#define auvid_metric_predicted AUVID_SIZED(auvid_metric_predicted)
/** Returns the band-weighted sum of squares of the newest set's residuals, DoF j, after a finished
 * prediction [N^2, Nm^2]. */
auvid_real_t auvid_metric_predicted(const auvid_metric_t *metric, int j);

#define auvid_metric_change_begin AUVID_SIZED(auvid_metric_change_begin)
/** Begin to test the newest sets against the others, before they are merged: does each DoF's
 * equation hold for both with the same parameters (Chow 1960)? Bands and delays are those of the
 * last merge. The test overwrites the merged sets: merge afterwards. NULL is a no-op.
 * @param change written
 * @param sag share of the thrust that each set has lost since the one before; 0: none */
void auvid_metric_change_begin(auvid_metric_t *metric, auvid_metric_change_t *change,
                               auvid_real_t sag);

#define auvid_metric_change AUVID_SIZED(auvid_metric_change)
/** Continue the change test started by auvid_metric_change_begin. `change` is U(all sets) -
 * U(older sets) - U(newest sets), with U the part of the wrench that no pi explains.
 * @param change as it was left; complete if AUVID_OK: with fewer than three sets it is zero
 * @param budget units of work left, reduced by those used: four for each row of each set, and four
 * more for each row of the newest two
 * @return AUVID_OK; AUVID_PENDING (budget used up); AUVID_ERR_NULL. */
auvid_status_t auvid_metric_change(auvid_metric_t *metric, auvid_metric_change_t *change,
                                   uint32_t *budget);

#define auvid_metric_linearise_begin AUVID_SIZED(auvid_metric_linearise_begin)
/** Residual path: begin to linearise the model at pi. The result is, for each of the newest sets,
 * the R factors of a linear model with the same derivatives; auvid_metric_change and confidence.h
 * read them. The derivatives are central differences over 10 ms of delay, and over 1 % of each
 * parameter (at least 1e-4, and 1e-3 where it is zero); if the model has a regressor, its rows take
 * the place of the latter. A window of smoothed residuals is left out if a residual or a derivative
 * is not finite or beyond 1e15. A no-op on the regressor path, and for NULL.
 * @param pi [n]
 * @param delay_s as in auvid_metric_cost_begin
 * @param sets number of sets, from the newest on */
void auvid_metric_linearise_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                  auvid_real_t delay_s, uint8_t sets);

#define auvid_metric_linearise AUVID_SIZED(auvid_metric_linearise)
/** Continue the linearisation started by auvid_metric_linearise_begin. If it covers all sets of the
 * ring, their R factors are then merged.
 * @param windows left as it is between the calls
 * @param budget units of work left, reduced by those used: vehicle->work for each of the 2 n + 3
 * calls of the model (three and one of its regressor, if it has one) at each row of the sets, and
 * at as many rows before them as a window has less one. Windows are about one standard deviation of
 * their weights apart
 * @return AUVID_OK; AUVID_PENDING (budget used up); AUVID_EMPTY (the sets contradict the prior,
 * which is discarded: search again); AUVID_ERR_NULL. */
auvid_status_t auvid_metric_linearise(auvid_metric_t *metric, auvid_metric_windows_t *windows,
                                      uint32_t *budget);

#define auvid_metric_longest_delay AUVID_SIZED(auvid_metric_longest_delay)
/** Returns the longest delay of the residual path [s], 6 cells; 0 for NULL. */
auvid_real_t auvid_metric_longest_delay(const auvid_metric_t *metric);

#define auvid_metric_measure AUVID_SIZED(auvid_metric_measure)
/** Continue the measurement started by auvid_metric_measure_begin or auvid_metric_predict_begin.
 * @param budget units of work left, reduced by those used: one for each row of each set, or
 * vehicle->work for each stored sample
 * @return AUVID_OK (result.sse is written); AUVID_PENDING (budget used up); AUVID_ERR_NULL. */
auvid_status_t auvid_metric_measure(auvid_metric_t *metric, uint32_t *budget);

#define auvid_metric_newest AUVID_SIZED(auvid_metric_newest)
/** Returns the newest set that counts and is not deleted; never NULL. If there is none it has no
 * rows. */
const auvid_set_t *auvid_metric_newest(const auvid_metric_t *metric);

#define auvid_metric_excited_sets AUVID_SIZED(auvid_metric_excited_sets)
/** Returns the number of sets of the ring that excite DoF j, not counting the newest `newest`. */
int auvid_metric_excited_sets(const auvid_metric_t *metric, int j, int newest);

#define auvid_metric_active AUVID_SIZED(auvid_metric_active)
/** Returns the free parameters whose own DoF is excited (bit i); 0 for NULL. Valid after merge. */
uint32_t auvid_metric_active(const auvid_metric_t *metric);

#define auvid_metric_searched AUVID_SIZED(auvid_metric_searched)
/** Returns the parameters to search for (bit i): the active ones and, in the regressor path, some
 * of DoF that are not excited. These are free, have `fixed` zero, and appear in the equation of an
 * excited DoF. (A vehicle that yaws while moving forward drifts sideways: m_v v r acts on surge,
 * whether or not sway is excited.) If they stayed at zero, they would bias the others; their own
 * values are by-products, often poor. After auvid_metric_solve_coupled also the parameters that it
 * has solved for. Valid after merge. */
uint32_t auvid_metric_searched(const auvid_metric_t *metric);

#define auvid_metric_solve_coupled AUVID_SIZED(auvid_metric_solve_coupled)
/** Regressor path: find the DoF that only coupling moves, and solve their equations given the
 * result of a search. Writes result.coupled, and the parameters that no equation of an excited DoF
 * contains. Call it after a search, before the residuals are measured. NULL is a no-op.
 * Cost: O(n^2).
 * @param pi [n] in: the result of the search; out: with these parameters */
void auvid_metric_solve_coupled(auvid_metric_t *metric, auvid_real_t *pi);

#define auvid_metric_scale AUVID_SIZED(auvid_metric_scale)
/** Compute the scale of each parameter, 1 / sqrt(sum_j w_j ||column i of R_j||^2): a step of one
 * scale changes the dimensionless rms force by one. NULL is a no-op.
 * @param scale [n] written [parameter's unit]; 0 where the column is empty, and everywhere in the
 * residual path */
void auvid_metric_scale(const auvid_metric_t *metric, auvid_real_t *scale);

#define auvid_metric_r2 AUVID_SIZED(auvid_metric_r2)
/** Compute the coefficient of determination of the smoothed wrench after a finished measurement,
 * 1 - sse / (sum of squares about each set's mean); of a DoF that only coupling moves, that of the
 * force of coupling, 1 - sse / (sum of its squares). NULL is a no-op.
 * @param r2 [6] written; 0 where the equation is not informative, and where the residuals of the
 * model are not finite */
void auvid_metric_r2(const auvid_metric_t *metric, auvid_real_t *r2);

#define auvid_metric_least_squares AUVID_SIZED(auvid_metric_least_squares)
/** Compute the least-squares optimum in closed form. It is a reference for tests and a diagnostic
 * for users of linear models; the identifier does not use it. Stack: (n + 1)(n + 2) / 2 numbers.
 * @param active parameters to solve for (bit i), of the free ones; others keep their value in pi
 * @param pi [n] in and out
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_MODEL (residual path); AUVID_ERR_SINGULAR (some
 * parameter is not determined; it is set to zero). */
auvid_status_t auvid_metric_least_squares(const auvid_metric_t *metric, uint32_t active,
                                          auvid_real_t *pi);

#ifdef __cplusplus
}
#endif

#endif
