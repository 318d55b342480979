/**
 * @file crs.h
 * Controlled random search: the global phase of the optimizer, as an ask / tell state machine.
 *
 * Purpose: find the region of the minimum of a cost over a box, from no starting point, without
 * derivatives. A population S of m points is drawn at random; then, over and over, n + 1 of them
 * are drawn, the worst of these is reflected through their weighted centroid, and the trial, if
 * better than the worst of S, takes its place.
 *
 * Who calls it, when: the optimizer (optimizer.h), or you on your own. auvid_crs_ask gives a point,
 * the caller computes its cost in whatever time it takes, auvid_crs_tell hands it back. The module
 * never sees the cost function.
 *
 * Cost: one ask makes at most one trial. For n = 13, m = 52 a trial is 1.8k instructions on a
 * Cortex-M4F (-O2), plus 0.5-0.7k in tell when it is accepted, 0.1k when not. Memory: about
 * 4 m (n + 1) + 2 m + 12 n bytes at AUVID_MAX_POPULATION and AUVID_MAX_PARAMETERS: 5.2 KiB by
 * default.
 *
 * Sources: Algorithm 1 of Karras et al., IROS 2013 ("the paper"); Brachetti, De Felice Ciccoli,
 * Di Pillo, Lucidi, J. Global Optimization 10 (1997).
 *
 * Deviations from the paper, none of which changes a run that the paper's algorithm would end:
 * - caps on evaluations and on consecutive rejections (both loops of the paper are unbounded, and
 *   with m = n + 1, or an optimum in a corner of the box, they do not end);
 * - phi is kept above AUVID_EPSILON (J_max - J_min), so that no weight divides by zero, and its
 *   ratio (J_max - J_min) / (J0_max - J0_min) below 1000; J0 is of points that did not fail;
 * - a population whose spread is below the resolution of the arithmetic has converged, whatever
 *   epsilon says (in float32 ties would freeze it);
 * - a cost that is not finite, or above AUVID_CRS_COST_FAILED, counts as AUVID_CRS_COST_FAILED.
 */
#ifndef AUVID_CRS_H
#define AUVID_CRS_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The cost that stands for "the model failed at this point". Larger costs, infinities and NaN are
 * taken as this one. Small enough that no product formed with it overflows. */
#define AUVID_CRS_COST_FAILED AUVID_C(1e24)

/** Configuration; copied at init. */
typedef struct {
    uint8_t n;            /**< parameters, 1..AUVID_MAX_PARAMETERS; no default */
    uint16_t population;  /**< m, n+1..AUVID_MAX_POPULATION; 0: 4 n (at least n + 2, and as many
                                 as AUVID_MAX_POPULATION allows) */
    auvid_real_t epsilon; /**< ends when J_max - J_min <= epsilon [cost]; >= 0; default 1e-2 */
    auvid_real_t reduction; /**< ends, too, when J_max - J_min is this part of what it was over the
                                 first population; 0 <= reduction < 1; default 0: as in the paper,
                                 by epsilon alone */
    auvid_real_t omega;   /**< factor of phi, 0..1e9; 0: n, as in the paper. Larger (1e6 n) keeps
                                 the population from collapsing, at more evaluations */
    uint32_t max_evaluations; /**< cap on evaluations, those after auvid_crs_reevaluate apart; the
                                   initial population is always evaluated; 0: 40 m */
    uint32_t max_rejections;  /**< cap on consecutive trials outside the box; 0: 50 m */
    uint64_t seed;            /**< of the random numbers; any value; default 1 */
    auvid_real_t lower[AUVID_MAX_PARAMETERS]; /**< the box D [parameter's unit]; first n used; */
    auvid_real_t upper[AUVID_MAX_PARAMETERS]; /**< lower < upper, both of magnitude <= 1e18 */
} auvid_crs_config_t;

/** State; private but for what the accessors give. Written by this module alone. */
typedef struct {
    auvid_crs_config_t config; /**< as given, zeros replaced by their meaning */
    auvid_real_t theta[AUVID_MAX_POPULATION][AUVID_MAX_PARAMETERS]; /**< S [parameter's unit] */
    auvid_real_t cost[AUVID_MAX_POPULATION];  /**< J of each point, once evaluated */
    uint16_t order[AUVID_MAX_POPULATION];     /**< a permutation of 0..m-1; draws shuffle it */
    auvid_real_t trial[AUVID_MAX_PARAMETERS]; /**< the point last asked for */
    auvid_real_t initial_spread; /**< J0_max - J0_min over the points that did not fail */
    auvid_real_t last_spread;    /**< J_max - J_min at which the search ends */
    uint32_t rng[4];             /**< state of the random numbers */
    uint32_t evaluations;        /**< costs told, 0.. */
    uint32_t extra_evaluations;  /**< of these, after auvid_crs_reevaluate */
    uint32_t attempts;           /**< points made, rejected ones too */
    uint32_t rejections;         /**< consecutive trials outside the box, now */
    uint32_t max_rejections_seen; /**< the most there have been */
    uint16_t filled;             /**< points of S with a valid cost, 0..m */
    uint16_t known;              /**< points added by auvid_crs_add_point, 0..m */
    uint16_t first;              /**< S is evaluated from this point on, around */
    uint16_t best, worst;        /**< indices of theta_min and theta_max */
    uint8_t state;               /**< private enum */
    bool asked;                  /**< a point is out, its cost not yet told */
    bool reevaluating;           /**< S has been complete: its evaluation is an extra */
} auvid_crs_t;

#define auvid_crs_defaults                                                                         \
    AUVID_SIZED2(auvid_crs_defaults, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION)
/** Fill *config with the defaults for n parameters; the box, which has none, is set to zeros.
 * Null is ignored. Cost: a memset. */
void auvid_crs_defaults(auvid_crs_config_t *config, uint8_t n);

#define auvid_crs_check AUVID_SIZED2(auvid_crs_check, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION)
/** Would auvid_crs_init take this configuration? Its statuses. Cost: O(n). */
auvid_status_t auvid_crs_check(const auvid_crs_config_t *config);

/**
 * Check and copy the configuration, draw the m points of S uniformly in the box (Algorithm 1,
 * line 3).
 * @param crs     state to start; need not be zeroed.
 * @param config  copied.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_PARAMETERS (n); AUVID_ERR_POPULATION (m);
 *         AUVID_ERR_NOT_FINITE (epsilon, reduction, omega or a bound); AUVID_ERR_BOUNDS (lower >=
 *         upper); AUVID_ERR_RANGE (one of these out of range). On an error *crs is untouched.
 * Cost: m n random numbers, ~60k instructions for n = 13, m = 52 on a Cortex-M4F. Once.
 */
#define auvid_crs_init AUVID_SIZED2(auvid_crs_init, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION)
auvid_status_t auvid_crs_init(auvid_crs_t *crs, const auvid_crs_config_t *config);

#define auvid_crs_add_point                                                                        \
    AUVID_SIZED2(auvid_crs_add_point, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION)
/**
 * Put a known good point into the initial population, in the place of a random one.
 * @param theta  n values in the box [parameter's unit].
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or already asked);
 *         AUVID_ERR_POPULATION (all m are known points); AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE
 *         (outside the box: it is not moved there).
 * A bad point does no harm: it is one of m. Cost: n copies.
 */
auvid_status_t auvid_crs_add_point(auvid_crs_t *crs, const auvid_real_t *theta);

#define auvid_crs_ask AUVID_SIZED2(auvid_crs_ask, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION)
/**
 * The next point whose cost is wanted (Algorithm 1, lines 4, 9-15). Asking again before telling
 * gives the same point and counts nothing.
 * @param theta  n values are written on AUVID_OK, none otherwise [parameter's unit]; in the box.
 * @return AUVID_OK: evaluate theta, then tell;
 *         AUVID_PENDING: a trial was made and fell outside the box: ask again. Counts as work;
 *         AUVID_FINISHED: J_max - J_min <= epsilon, or reduced enough;
 *         AUVID_EVALUATION_LIMIT: ended by max_evaluations or max_rejections;
 *         AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised).
 * Cost: (n + 1) / 2 random numbers, n + 1 divisions, n (n + 1) multiply-adds. Stack: ~0.3 KiB.
 */
auvid_status_t auvid_crs_ask(auvid_crs_t *crs, auvid_real_t *theta);

#define auvid_crs_tell AUVID_SIZED2(auvid_crs_tell, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION)
/**
 * The cost of the point last asked for (Algorithm 1, lines 5 and 17-20).
 * @param cost  any value; NaN, infinities and values beyond +-AUVID_CRS_COST_FAILED count as
 *              AUVID_CRS_COST_FAILED: a model may fail at a point.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (nothing was asked for).
 * Cost: n copies and m comparisons when the point is accepted; constant otherwise.
 */
auvid_status_t auvid_crs_tell(auvid_crs_t *crs, auvid_real_t cost);

#define auvid_crs_reevaluate                                                                       \
    AUVID_SIZED2(auvid_crs_reevaluate, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION)
/**
 * The data have changed: all costs are stale. The coming asks return the points of S again, the
 * best first, then the search goes on; the initial spread in phi is taken anew. A point asked for
 * and not told is dropped. A search that had ended goes on too, within its caps.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised).
 * Cost: constant.
 */
auvid_status_t auvid_crs_reevaluate(auvid_crs_t *crs);

#define auvid_crs_best AUVID_SIZED2(auvid_crs_best, AUVID_MAX_PARAMETERS, AUVID_MAX_POPULATION)
/**
 * The best point of S, of those whose cost is known.
 * @param cost  may be null; its cost. While S is evaluated again, the old cost of the old best
 *              until that has been told anew.
 * @return n values, owned by *crs, valid until the next call; null if no cost is known or crs is
 *         null.
 */
const auvid_real_t *auvid_crs_best(const auvid_crs_t *crs, auvid_real_t *cost);

#ifdef __cplusplus
}
#endif

#endif
