/**
 * @file detail/line_search.h
 * No stability promised: for the structs that contain it, for tests and tools.
 *
 * Coordinate search with line-search expansions: the local phase of the optimizer, ask / tell.
 *
 * Purpose: from a starting point, go to the minimum of its region without derivatives. Each of the
 * 2n directions +d_i, -d_i has its own step. If a step lowers the cost enough, it is multiplied by
 * delta repeatedly until that no longer helps; otherwise it is multiplied by sigma. The search ends
 * when all steps are short.
 *
 * Who calls it, when: the optimizer (optimizer.h) with the best point of the global phase, or the
 * user directly: with a good starting point no global phase is needed.
 *
 * Steps are in units of scale[i]: a step alpha along e_i moves parameter i by alpha * scale[i].
 * Half the width of the box is one choice of scale. Another is the inverse norm of the parameter's
 * column in a least-squares problem. Scale the cost so that J(0) ~ 1: gamma defines what counts as
 * a gain.
 *
 * Cost: one ask makes at most one trial. For n = 13 about 490 instructions on a Cortex-M4F (at most
 * 900), tell 390 (1400). Memory: 1.4 KiB by default.
 *
 * Sources: Algorithm 2 of Karras et al., IROS 2013 ("the paper"); Lucidi, Sciandrone, Computational
 * Optimization and Applications 21 (2002): steps are cut at the box, and any better point may
 * replace the iterate without harm to the convergence theory. Conjugate directions: Smith 1962,
 * Powell, The Computer Journal 7 (1964).
 *
 * Deviations from the paper. `paper` switches off the first four:
 * - directions: the first sweep makes d_1 .. d_n conjugate with respect to the cost's curvature, by
 *   one trial for each pair, and minimizes along each of them. A quadratic is at its minimum after
 *   n^2 / 2 + 5 n evaluations. When the steps are a tenth of alpha0 the search continues along
 *   e_1 .. e_n, as in the paper, where no kink can stop it. If a later sweep still gains more than
 *   gamma, the cost is not that quadratic, and the directions are made again;
 * - -d_i is left out of a sweep in which +d_i has moved;
 * - pattern step: after a sweep of all directions that lowered the cost, the same search follows
 *   the line through the sweep's two ends, with step 1 (Hooke, Jeeves 1961);
 * - parabola: each line search tries the lowest point of the parabola through its points (or with
 *   the curvature that an earlier search along d_i found). Pattern step and parabola are accepted
 *   only if better than the iterate, and shorten no step, so the polling that the convergence proof
 *   relies on is unchanged. Together they reduce this phase of a recorded 13-parameter
 *   identification from 4550 evaluations to 290;
 * - restarts: float32 may end falsely early, so the search starts again with a tenth of alpha0;
 * - a cap on evaluations; a cost that is not finite or above AUVID_LINE_SEARCH_COST_FAILED counts
 *   as AUVID_LINE_SEARCH_COST_FAILED (the model failed there).
 */
#ifndef AUVID_LINE_SEARCH_H
#define AUVID_LINE_SEARCH_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The cost of a point at which the model failed. Larger costs, infinities and NaN count as this
 * one. It is so small that no product with it overflows. */
#define AUVID_LINE_SEARCH_COST_FAILED AUVID_C(1e24)

/** Configuration; copied at init. */
typedef struct {
    uint8_t n;            /**< parameters, 1..AUVID_MAX_PARAMETERS; no default */
    uint8_t restarts;     /**< number of restarts with alpha0 / 10, the first along e_i;
                                default 1 */
    bool paper;           /**< only Algorithm 2, along e_i; default false */
    auvid_real_t alpha0;  /**< first steps [scale], > epsilon, <= 1e3; 0: 0.35, paper 0.05 */
    auvid_real_t sigma;   /**< contraction, 0 < sigma < 1; 0: 0.09, paper 0.5. The last step tried
                                is this much longer than epsilon */
    auvid_real_t delta;   /**< expansion, 1 < delta <= 100; default 2 */
    auvid_real_t gamma;   /**< minimum decrease over alpha^2 [cost], 0 <= gamma < 1; default 1e-6 */
    auvid_real_t epsilon; /**< ends if all steps <= epsilon [scale], 0 < epsilon <= 1e-3;
                                0: 3e-6, paper 3e-5 (1e-5 is recommended) */
    uint32_t max_evaluations;                 /**< cap on evaluations; 0: 1000 n */
    auvid_real_t lower[AUVID_MAX_PARAMETERS]; /**< the box [parameter's unit]; first n used; */
    auvid_real_t upper[AUVID_MAX_PARAMETERS]; /**< lower < upper, both of magnitude <= 1e18 */
    auvid_real_t scale[AUVID_MAX_PARAMETERS]; /**< unit of the steps [parameter's unit], > 0,
                                                   <= 1e18; 0: half the width of the box */
    auvid_real_t start[AUVID_MAX_PARAMETERS]; /**< theta^0, in the box [parameter's unit] */
} auvid_line_search_config_t;

/** State; private except through the accessors. Only this module writes it. */
typedef struct {
    auvid_line_search_config_t cfg;               /**< as given, zeros replaced by their values */
    auvid_real_t theta[AUVID_MAX_PARAMETERS];     /**< the best point, x [parameter's unit] */
    auvid_real_t base[AUVID_MAX_PARAMETERS];      /**< y_i, where the current line starts */
    auvid_real_t previous[AUVID_MAX_PARAMETERS];  /**< theta^k, where the current sweep started */
    auvid_real_t trial[AUVID_MAX_PARAMETERS];     /**< the point last asked for */
    auvid_real_t alpha[2 * AUVID_MAX_PARAMETERS]; /**< steps by direction [scale] */
    auvid_real_t curvature[AUVID_MAX_PARAMETERS]; /**< half second derivative along d_i
                                                       [cost/scale^2]; <= 0: not known */
    auvid_real_t slope[AUVID_MAX_PARAMETERS];     /**< along d_i, at the end of its line */
    /** d_i = e_i + sum of shear[i (i - 1) / 2 + k] e_k, k < i [scale] */
    auvid_real_t shear[AUVID_MAX_PARAMETERS * (AUVID_MAX_PARAMETERS - 1) / 2 + 1];
    auvid_real_t axis_cost, axis_step; /**< cost of base + axis_step e_i, where d_i is made */
    auvid_real_t cost, base_cost, previous_cost; /**< of theta, base, previous */
    auvid_real_t t;                              /**< step of the trial along the line [scale] */
    auvid_real_t t_best;                         /**< step accepted last, 0: none */
    auvid_real_t t_near, cost_near;              /**< the line's last point */
    auvid_real_t t_far, cost_far;                /**< the point before that; t_far 0: none */
    uint32_t evaluations;                        /**< costs received, 0.. */
    uint32_t attempts;     /**< points made, including those without room to move */
    uint8_t direction;     /**< 0..2n-1; 2n: the pattern step */
    uint8_t built;         /**< d_i with i < built have been made conjugate */
    bool plain;            /**< no d_i has been made in this sweep */
    uint8_t probe;         /**< k of the d_k that is probed */
    uint8_t move;          /**< private enum: purpose of the trial */
    uint8_t state;         /**< private enum */
    uint8_t restarts_left; /**< 0..restarts */
    bool asked;            /**< a point was returned, its cost is not yet received */
} auvid_line_search_t;

#define auvid_line_search_defaults AUVID_SIZED(auvid_line_search_defaults)
/** Fill *cfg with the defaults for n parameters; box, scale and start are set to zeros.
 * NULL is a no-op. Cost: a memset. */
void auvid_line_search_defaults(auvid_line_search_config_t *cfg, uint8_t n);

#define auvid_line_search_init AUVID_SIZED(auvid_line_search_init)
/**
 * Check and copy the configuration; the search begins at cfg->start.
 * @param ls      state to start; need not be zeroed.
 * @param cfg  copied; may not be part of *ls.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_PARAMETERS (n); AUVID_ERR_NOT_FINITE (any real);
 *         AUVID_ERR_BOUNDS (lower >= upper); AUVID_ERR_RANGE (another field out of range, or start
 *         outside the box). After an error *ls is unchanged.
 * Cost: O(n).
 */
auvid_status_t auvid_line_search_init(auvid_line_search_t *ls,
                                      const auvid_line_search_config_t *cfg);

#define auvid_line_search_ask AUVID_SIZED(auvid_line_search_ask)
/**
 * Return the next point to evaluate; the first is the start itself. A second ask before tell
 * returns the same point and counts nothing.
 * @param theta  n values in the box, written only on AUVID_OK [parameter's unit].
 * @return AUVID_OK: evaluate theta, then tell;
 *         AUVID_PENDING: a step had no room (bound, or below the arithmetic's resolution): ask
 *         again. It counts as work;
 *         AUVID_FINISHED: all steps <= epsilon, restarts included;
 *         AUVID_EVALUATION_LIMIT: ended by max_evaluations;
 *         AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised).
 * Cost: 2n multiply-adds and comparisons.
 */
auvid_status_t auvid_line_search_ask(auvid_line_search_t *ls, auvid_real_t *theta);

#define auvid_line_search_tell AUVID_SIZED(auvid_line_search_tell)
/**
 * Supply the cost of the point last asked for (Algorithm 2, lines 7-21).
 * @param cost  any value; NaN, infinities and values beyond +-AUVID_LINE_SEARCH_COST_FAILED count
 *              as AUVID_LINE_SEARCH_COST_FAILED.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (nothing was asked for).
 * Cost: at most 3 n copies, n multiply-adds and, at the end of a sweep, 2n comparisons; n^2 / 2
 * stores when the directions are reset.
 */
auvid_status_t auvid_line_search_tell(auvid_line_search_t *ls, auvid_real_t cost);

#define auvid_line_search_reevaluate AUVID_SIZED(auvid_line_search_reevaluate)
/**
 * Mark the iterate's cost as stale, because the data have changed. The next ask returns the
 * iterate; then a sweep begins with all steps at least alpha0 / 10. A point without its cost is
 * dropped. A search that had finished continues; one that reached its evaluation limit does not.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). Cost: O(n).
 */
auvid_status_t auvid_line_search_reevaluate(auvid_line_search_t *ls);

#define auvid_line_search_best AUVID_SIZED(auvid_line_search_best)
/**
 * The best point so far.
 * @param cost  its cost, after auvid_line_search_reevaluate the old one until tell; may be NULL.
 * @return n values, owned by *ls, valid until the next call; NULL if no cost is known or ls is
 *         NULL.
 */
const auvid_real_t *auvid_line_search_best(const auvid_line_search_t *ls, auvid_real_t *cost);

#ifdef __cplusplus
}
#endif

#endif
