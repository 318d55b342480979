/**
 * @file line_search.h
 * Coordinate search with line-search expansions: the local phase of the optimizer, ask / tell.
 *
 * Purpose: from a starting point, go to the minimum of its region without derivatives. Each of the
 * 2n directions +d_i, -d_i has its own step. A step that lowers the cost enough is lengthened by
 * delta for as long as that pays; one that does not is shortened by sigma. It ends when all steps
 * are short.
 *
 * Who calls it, when: the optimizer (optimizer.h) with the best point of the global phase, or you
 * on your own: a warm start needs no global phase.
 *
 * Steps are in units of scale[i]: along e_i by alpha moves parameter i by alpha * scale[i]. Half
 * the width of the box is a scale; the inverse norm of the parameter's column in a least-squares
 * problem is another. Scale the cost so that J(0) ~ 1: gamma is what counts as a gain.
 *
 * Cost: one ask makes at most one trial. For n = 13 about 490 instructions on a Cortex-M4F (at most
 * 900), tell 390 (1400). Memory: 1.4 KiB by default.
 *
 * Sources: Algorithm 2 of Karras et al., IROS 2013 ("the paper"); Lucidi, Sciandrone, Computational
 * Optimization and Applications 21 (2002): steps are cut at the box, and any better point may
 * replace the iterate without harm to the convergence theory. Conjugate directions: Smith 1962,
 * Powell, The Computer Journal 7 (1964).
 *
 * Deviations from the paper. `literal` switches off the first four:
 * - directions: the first sweep makes d_1 .. d_n conjugate, as the cost bends, by a trial for each
 *   pair, and minimizes along each as it is made: a quadratic is at its minimum after n^2 / 2 + 5 n
 *   evaluations. When the steps are a tenth of alpha0 the search goes on along e_1 .. e_n, as in
 *   the paper, where no kink can hold it. A later sweep that still gains more than gamma begins all
 *   of this anew: the cost is not that quadratic;
 * - -d_i is left out of a sweep in which +d_i has moved;
 * - pattern step: after a sweep of all directions that lowered the cost, the line through the
 *   sweep's two ends is searched in the same way, with step 1 (Hooke, Jeeves 1961);
 * - parabola: in each line search the lowest point of the parabola through its points (or with the
 *   curvature that an earlier search along d_i found) is tried. Pattern step and parabola are taken
 *   only when better than the iterate, and shorten no step, so the polling that the convergence
 *   proof rests on remains as it is. Together they bring a recorded 13-parameter identification
 *   from 4550 evaluations in this phase to 290;
 * - restarts: float32 may end falsely early, so the search begins again with a tenth of alpha0;
 * - a cap on evaluations; a cost that is not finite or above AUVID_LINE_SEARCH_COST_FAILED counts
 *   as that (the model failed there).
 */
#ifndef AUVID_LINE_SEARCH_H
#define AUVID_LINE_SEARCH_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The cost that stands for "the model failed at this point". Larger costs, infinities and NaN are
 * taken as this one. Small enough that no product formed with it overflows. */
#define AUVID_LINE_SEARCH_COST_FAILED AUVID_C(1e24)

/** Configuration; copied at init. */
typedef struct {
    uint8_t n;            /**< parameters, 1..AUVID_MAX_PARAMETERS; no default */
    uint8_t restarts;     /**< times to begin again with alpha0 / 10, the first along e_i;
                                default 1 */
    bool paper;           /**< Algorithm 2 alone, along e_i; default false */
    auvid_real_t alpha0;  /**< first steps [scale], > epsilon, <= 1e3; 0: 0.35, literal 0.05 */
    auvid_real_t sigma;   /**< contraction, 0 < sigma < 1; 0: 0.09, literal 0.5. A step this much
                                longer than epsilon is the last that is tried */
    auvid_real_t delta;   /**< expansion, 1 < delta <= 100; default 2 */
    auvid_real_t gamma;   /**< least decrease over alpha^2 [cost], 0 <= gamma < 1; default 1e-6 */
    auvid_real_t epsilon; /**< ends when all steps <= epsilon [scale], 0 < epsilon <= 1e-3;
                                0: 3e-6, literal 3e-5 (1e-5 is advised) */
    uint32_t max_evaluations;                 /**< cap on evaluations; 0: 1000 n */
    auvid_real_t lower[AUVID_MAX_PARAMETERS]; /**< the box [parameter's unit]; first n used; */
    auvid_real_t upper[AUVID_MAX_PARAMETERS]; /**< lower < upper, both of magnitude <= 1e18 */
    auvid_real_t scale[AUVID_MAX_PARAMETERS]; /**< unit of the steps [parameter's unit], > 0,
                                                   <= 1e18; 0: half the width of the box */
    auvid_real_t start[AUVID_MAX_PARAMETERS]; /**< theta^0, in the box [parameter's unit] */
} auvid_line_search_config_t;

/** State; private but for what the accessors give. Written by this module alone. */
typedef struct {
    auvid_line_search_config_t config;            /**< as given, zeros replaced by their meaning */
    auvid_real_t theta[AUVID_MAX_PARAMETERS];     /**< the best point, x [parameter's unit] */
    auvid_real_t base[AUVID_MAX_PARAMETERS];      /**< y_i, where the current line starts */
    auvid_real_t previous[AUVID_MAX_PARAMETERS];  /**< theta^k, where the current sweep started */
    auvid_real_t trial[AUVID_MAX_PARAMETERS];     /**< the point last asked for */
    auvid_real_t alpha[2 * AUVID_MAX_PARAMETERS]; /**< steps by direction [scale] */
    auvid_real_t curvature[AUVID_MAX_PARAMETERS]; /**< half second derivative along d_i
                                                       [cost/scale^2]; <= 0: not known */
    auvid_real_t slope[AUVID_MAX_PARAMETERS];     /**< along d_i, where its line ended */
    /** d_i = e_i + sum of shear[i (i - 1) / 2 + k] e_k, k < i [scale] */
    auvid_real_t shear[AUVID_MAX_PARAMETERS * (AUVID_MAX_PARAMETERS - 1) / 2 + 1];
    auvid_real_t axis_cost, axis_step; /**< cost of base + axis_step e_i, where d_i is sought */
    auvid_real_t cost, base_cost, previous_cost;  /**< of theta, base, previous */
    auvid_real_t t;                 /**< step of the trial along the line [scale] */
    auvid_real_t t_best;            /**< step accepted last, 0: none */
    auvid_real_t t_near, cost_near; /**< the line's last point */
    auvid_real_t t_far, cost_far;   /**< the point before that; t_far 0: there is none */
    uint32_t evaluations;           /**< costs told, 0.. */
    uint32_t attempts;              /**< points made, those without room to move too */
    uint8_t direction;              /**< 0..2n-1; 2n: the pattern step */
    uint8_t built;                  /**< d_i with i < built have been made conjugate */
    bool plain;                     /**< no d_i has been made in this sweep */
    uint8_t probe;                  /**< k of the d_k that is probed */
    uint8_t move;                   /**< private enum: what the trial is for */
    uint8_t state;                  /**< private enum */
    uint8_t restarts_left;          /**< 0..restarts */
    bool asked;                     /**< a point is out, its cost not yet told */
} auvid_line_search_t;

#define auvid_line_search_defaults AUVID_SIZED1(auvid_line_search_defaults, AUVID_MAX_PARAMETERS)
/** Fill *config with the defaults for n parameters; box, scale and start are set to zeros.
 * Null is ignored. Cost: a memset. */
void auvid_line_search_defaults(auvid_line_search_config_t *config, uint8_t n);

/**
 * Check and copy the configuration; the search begins at config->start.
 * @param ls      state to start; need not be zeroed.
 * @param config  copied; may not be part of *ls.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_PARAMETERS (n); AUVID_ERR_NOT_FINITE (any real);
 *         AUVID_ERR_BOUNDS (lower >= upper); AUVID_ERR_RANGE (another field out of range, or start
 *         outside the box); AUVID_ERR_MODEL (literal, with AUVID_REGRESSOR_ONLY). On an error *ls
 *         is untouched.
 * Cost: O(n).
 */
#define auvid_line_search_init AUVID_SIZED1(auvid_line_search_init, AUVID_MAX_PARAMETERS)
auvid_status_t auvid_line_search_init(auvid_line_search_t *ls,
                                      const auvid_line_search_config_t *config);

#define auvid_line_search_ask AUVID_SIZED1(auvid_line_search_ask, AUVID_MAX_PARAMETERS)
/**
 * The next point whose cost is wanted; first the start itself. Asking again before telling gives
 * the same point and counts nothing.
 * @param theta  n values are written on AUVID_OK, none otherwise [parameter's unit]; in the box.
 * @return AUVID_OK: evaluate theta, then tell;
 *         AUVID_PENDING: a step had no room (bound, or below the arithmetic's resolution): ask
 *         again. Counts as work;
 *         AUVID_FINISHED: all steps <= epsilon, restarts included;
 *         AUVID_EVALUATION_LIMIT: ended by max_evaluations;
 *         AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised).
 * Cost: 2n multiply-adds and comparisons.
 */
auvid_status_t auvid_line_search_ask(auvid_line_search_t *ls, auvid_real_t *theta);

#define auvid_line_search_tell AUVID_SIZED1(auvid_line_search_tell, AUVID_MAX_PARAMETERS)
/**
 * The cost of the point last asked for (Algorithm 2, lines 7-21).
 * @param cost  any value; NaN, infinities and values beyond +-AUVID_LINE_SEARCH_COST_FAILED count
 *              as AUVID_LINE_SEARCH_COST_FAILED.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (nothing was asked for).
 * Cost: at most 3 n copies, n multiply-adds and, at the end of a sweep, 2n comparisons; where the
 * directions begin anew n^2 / 2 stores.
 */
auvid_status_t auvid_line_search_tell(auvid_line_search_t *ls, auvid_real_t cost);

#define auvid_line_search_reevaluate                                                               \
    AUVID_SIZED1(auvid_line_search_reevaluate, AUVID_MAX_PARAMETERS)
/**
 * The data have changed: the iterate's cost is stale. The next ask returns the iterate; then a
 * sweep begins with all steps at least alpha0 / 10. A point asked for and not told is dropped. A
 * search that had finished goes on; one that was capped stays so.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). Cost: O(n).
 */
auvid_status_t auvid_line_search_reevaluate(auvid_line_search_t *ls);

#define auvid_line_search_best AUVID_SIZED1(auvid_line_search_best, AUVID_MAX_PARAMETERS)
/**
 * The best point so far.
 * @param cost  may be null; its cost (after auvid_line_search_reevaluate the old one, until told).
 * @return n values, owned by *ls, valid until the next call; null if no cost is known or ls is
 *         null.
 */
const auvid_real_t *auvid_line_search_best(const auvid_line_search_t *ls, auvid_real_t *cost);

#ifdef __cplusplus
}
#endif

#endif
