/**
 * @file detail/crs.h
 * No stability promised: for the structs that contain it, for tests and tools.
 *
 * Controlled random search: the global phase of the optimizer, as an ask / tell state machine.
 *
 * Purpose: find the region of the minimum of a cost over a box, without a starting point and
 * without derivatives. A population S of m points is drawn at random. Each iteration draws n + 1 of
 * them and reflects the worst of these through their weighted centroid. If the trial is better than
 * the worst of S, it replaces it.
 *
 * Who calls it, when: the optimizer (optimizer.h), or the user directly. auvid_crs_ask returns a
 * point, the caller computes its cost, in any time, and passes it to auvid_crs_tell. The module
 * never calls the cost function.
 *
 * Cost: one ask makes at most one trial. For n = 13, m = 52 a trial is 1.8k instructions on a
 * Cortex-M4F (-O2). Tell adds 0.5-0.7k if it is accepted, else 0.1k. Memory: about
 * 4 m (n + 1) + 2 m + 12 n bytes at AUVID_MAX_POPULATION and AUVID_MAX_PARAMETERS: 5.2 KiB by
 * default.
 *
 * Sources: Algorithm 1 of Karras et al., IROS 2013 ("the paper"); Brachetti, De Felice Ciccoli,
 * Di Pillo, Lucidi, J. Global Optimization 10 (1997).
 *
 * Deviations from the paper. None changes a run that terminates with the paper's algorithm:
 * - caps on evaluations and on consecutive rejections (both loops of the paper are unbounded; with
 *   m = n + 1, or an optimum in a corner of the box, they do not terminate);
 * - phi is at least AUVID_EPSILON (J_max - J_min), so that no weight divides by zero, and its ratio
 *   (J_max - J_min) / (J0_max - J0_min) is below 1000; J0 is of points that did not fail;
 * - a population whose spread is below the resolution of the arithmetic has converged, whatever
 *   epsilon is (in float32, equal costs would freeze it);
 * - a cost that is not finite, or above AUVID_CRS_COST_FAILED, counts as AUVID_CRS_COST_FAILED.
 */
#ifndef AUVID_CRS_H
#define AUVID_CRS_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The cost of a point at which the model failed. Larger costs, infinities and NaN count as this
 * one. It is so small that no product with it overflows. */
#define AUVID_CRS_COST_FAILED AUVID_C(1e24)

/** Configuration; copied at init. */
typedef struct {
    uint8_t n;              /**< parameters, 1..AUVID_MAX_PARAMETERS; no default */
    uint16_t population;    /**< m, n+1..AUVID_MAX_POPULATION; 0: 4 n (at least n + 2, at most
                                 AUVID_MAX_POPULATION) */
    auvid_real_t epsilon;   /**< ends if J_max - J_min <= epsilon [cost]; >= 0; default 1e-2 */
    auvid_real_t reduction; /**< ends also if J_max - J_min is at most this fraction of that of the
                                 first population; 0 <= reduction < 1; default 0: only by epsilon,
                                 as in the paper */
    auvid_real_t omega;     /**< factor of phi, 0..1e9; 0: n, as in the paper. Larger (1e6 n) keeps
                                 the population from collapsing, at more evaluations */
    uint32_t max_evaluations; /**< cap on evaluations, without those after auvid_crs_reevaluate;
                                   the initial population is always evaluated; 0: 40 m */
    uint32_t max_rejections;  /**< cap on consecutive trials outside the box; 0: 50 m */
    uint64_t seed;            /**< of the random numbers; any value; default 1 */
    auvid_real_t lower[AUVID_MAX_PARAMETERS]; /**< the box D [parameter's unit]; first n used; */
    auvid_real_t upper[AUVID_MAX_PARAMETERS]; /**< lower < upper, both of magnitude <= 1e18 */
} auvid_crs_config_t;

/** State; private except through the accessors. Only this module writes it. */
typedef struct {
    auvid_crs_config_t cfg; /**< as given, zeros replaced by the values they stand for */
    auvid_real_t theta[AUVID_MAX_POPULATION][AUVID_MAX_PARAMETERS]; /**< S [parameter's unit] */
    auvid_real_t cost[AUVID_MAX_POPULATION];  /**< J of each point, once evaluated */
    uint16_t order[AUVID_MAX_POPULATION];     /**< a permutation of 0..m-1; draws shuffle it */
    auvid_real_t trial[AUVID_MAX_PARAMETERS]; /**< the point last asked for */
    auvid_real_t initial_spread;  /**< J0_max - J0_min over the points that did not fail */
    auvid_real_t last_spread;     /**< J_max - J_min at which the search ends */
    uint32_t rng[4];              /**< state of the random numbers */
    uint32_t evaluations;         /**< costs received, 0.. */
    uint32_t extra_evaluations;   /**< of these, after auvid_crs_reevaluate */
    uint32_t attempts;            /**< points made, including rejected ones */
    uint32_t rejections;          /**< consecutive trials outside the box, now */
    uint32_t max_rejections_seen; /**< largest `rejections` so far */
    uint16_t filled;              /**< points of S with a valid cost, 0..m */
    uint16_t known;               /**< points added by auvid_crs_add_point, 0..m */
    uint16_t first;               /**< evaluation of S starts at this point and wraps around */
    uint16_t best, worst;         /**< indices of theta_min and theta_max */
    uint8_t state;                /**< private enum */
    bool asked;                   /**< a point was returned, its cost is not yet received */
    bool reevaluating;            /**< S was complete before: its evaluation is an extra */
} auvid_crs_t;

#define auvid_crs_defaults AUVID_SIZED(auvid_crs_defaults)
/** Fill *cfg with the defaults for n parameters; the box, which has none, is set to zeros.
 * NULL is a no-op. Cost: a memset. */
void auvid_crs_defaults(auvid_crs_config_t *cfg, uint8_t n);

#define auvid_crs_check AUVID_SIZED(auvid_crs_check)
/** Check a configuration without a state.
 * @return as auvid_crs_init. Cost: O(n). */
auvid_status_t auvid_crs_check(const auvid_crs_config_t *cfg);

#define auvid_crs_init AUVID_SIZED(auvid_crs_init)
/**
 * Check and copy the configuration; draw the m points of S uniformly in the box (Algorithm 1,
 * line 3).
 * @param crs     state to start; need not be zeroed.
 * @param cfg  copied.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_PARAMETERS (n); AUVID_ERR_POPULATION (m);
 *         AUVID_ERR_NOT_FINITE (epsilon, reduction, omega or a bound); AUVID_ERR_BOUNDS (lower >=
 *         upper); AUVID_ERR_RANGE (one of these out of range). After an error *crs is unchanged.
 * Cost: m n random numbers, ~60k instructions for n = 13, m = 52 on a Cortex-M4F. Once.
 */
auvid_status_t auvid_crs_init(auvid_crs_t *crs, const auvid_crs_config_t *cfg);

#define auvid_crs_add_point AUVID_SIZED(auvid_crs_add_point)
/**
 * Put a known good point into the initial population. It replaces a random one.
 * @param theta  n values in the box [parameter's unit].
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or a point was already
 *         asked for); AUVID_ERR_POPULATION (all m are known points); AUVID_ERR_NOT_FINITE;
 *         AUVID_ERR_RANGE (outside the box; it is not moved inside).
 * A bad point does no harm: it is one of m. Cost: n copies.
 */
auvid_status_t auvid_crs_add_point(auvid_crs_t *crs, const auvid_real_t *theta);

#define auvid_crs_ask AUVID_SIZED(auvid_crs_ask)
/**
 * Return the next point to evaluate (Algorithm 1, lines 4, 9-15). A second ask before tell returns
 * the same point and counts nothing.
 * @param theta  n values in the box, written only on AUVID_OK [parameter's unit].
 * @return AUVID_OK: evaluate theta, then tell;
 *         AUVID_PENDING: a trial fell outside the box: ask again. It counts as work;
 *         AUVID_FINISHED: J_max - J_min <= epsilon, or reduced enough;
 *         AUVID_EVALUATION_LIMIT: ended by max_evaluations or max_rejections;
 *         AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised).
 * Cost: (n + 1) / 2 random numbers, n + 1 divisions, n (n + 1) multiply-adds. Stack: ~0.3 KiB.
 */
auvid_status_t auvid_crs_ask(auvid_crs_t *crs, auvid_real_t *theta);

#define auvid_crs_tell AUVID_SIZED(auvid_crs_tell)
/**
 * Supply the cost of the point last asked for (Algorithm 1, lines 5 and 17-20).
 * @param cost  any value, since a model may fail at a point; NaN, infinities and values beyond
 *              +-AUVID_CRS_COST_FAILED count as AUVID_CRS_COST_FAILED.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (nothing was asked for).
 * Cost: n copies and m comparisons if the point is accepted; constant otherwise.
 */
auvid_status_t auvid_crs_tell(auvid_crs_t *crs, auvid_real_t cost);

#define auvid_crs_reevaluate AUVID_SIZED(auvid_crs_reevaluate)
/**
 * Mark all costs as stale, because the data have changed. The following asks return the points of S
 * again, the best first; then the search continues. The initial spread in phi is taken again. A
 * point without its cost is dropped. A search that had ended continues too, within its caps.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised).
 * Cost: constant.
 */
auvid_status_t auvid_crs_reevaluate(auvid_crs_t *crs);

#define auvid_crs_best AUVID_SIZED(auvid_crs_best)
/**
 * The best point of S among those of known cost.
 * @param cost  its cost; may be NULL. While S is evaluated again, the old cost of the old best
 *              point until its new cost is received.
 * @return n values, owned by *crs, valid until the next call; NULL if no cost is known or crs is
 *         NULL.
 */
const auvid_real_t *auvid_crs_best(const auvid_crs_t *crs, auvid_real_t *cost);

#ifdef __cplusplus
}
#endif

#endif
