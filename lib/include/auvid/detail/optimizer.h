/**
 * @file detail/optimizer.h
 * No stability promised: for the structs that contain it, for tests and tools.
 *
 * The optimizer of the identification: controlled random search, then coordinate line search.
 *
 * Purpose: find the parameters of minimum cost in a box, without a starting point, without
 * derivatives and without calling the cost function. The optimizer returns a point; the caller
 * evaluates it, in one tick or several, and passes the cost back.
 *
 * Who calls it, when: the identifier, between ticks; or the user, with another cost:
 *
 *     auvid_optimizer_defaults(&cfg, 13);          then set the box
 *     auvid_optimizer_init(&optimizer, &cfg);
 *     for (;;) {
 *         status = auvid_optimizer_ask(&optimizer, theta);
 *         if (status == AUVID_OK) {
 *             auvid_optimizer_tell(&optimizer, my_cost(theta));
 *         } else if (status != AUVID_PENDING) {
 *             break;                                  finished, or evaluation limit
 *         }
 *     }
 *
 * Cost: one ask makes at most one trial (crs.h, line_search.h). Memory: 5.5 KiB by default, for
 * the larger of the two. Evaluations until it ends, for 13 parameters of a Girona500, box
 * [-1000, 1000], float32, 1000 simulated records: median 466, p95 492; with line_search.paper 5070.
 * All results are within 1 % of the least-squares parameters
 * (tests/unit/search/test_optimizer_figures.c, tests/bench).
 *
 * Scale the cost so that J(0) ~ 1, and omit constant terms: epsilon of the global phase is
 * absolute, and in float32 a constant hides the differences.
 *
 * Sources: Section III-C of Karras et al., IROS 2013; Leonetti et al. 2012 for the composition.
 * Deviations: those of crs.h and line_search.h. The local phase begins at the best point even if
 * the global phase reached its limit. If crs.omega is 0, the global phase is short, omega = 2 and
 * crs.reduction >= 0.05, because it only has to find the region. Not with line_search.paper.
 */
#ifndef AUVID_OPTIMIZER_H
#define AUVID_OPTIMIZER_H

#include "auvid/detail/crs.h"
#include "auvid/detail/line_search.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The search that is active. */
typedef enum {
    AUVID_OPTIMIZER_GLOBAL = 0, /**< controlled random search */
    AUVID_OPTIMIZER_LOCAL = 1,  /**< line search */
    AUVID_OPTIMIZER_DONE = 2    /**< ended; auvid_optimizer_reevaluate continues from here */
} auvid_optimizer_phase_t;

/** Configuration; copied at init. */
typedef struct {
    auvid_crs_config_t crs; /**< global phase; its n, lower, upper define the problem; omega 0:
                                 see above */
    auvid_line_search_config_t line_search;   /**< local phase; its n, lower, upper, scale and start
                                                 are not read */
    auvid_real_t scale[AUVID_MAX_PARAMETERS]; /**< unit of the local steps [parameter's unit], > 0;
                                                   0 (default): half the width of the box */
} auvid_optimizer_config_t;

/** State; private except through the accessors. Only this module writes it. */
typedef struct {
    union { /* one after the other: the global phase leaves its best point, counts and the box */
        auvid_crs_t crs;
        auvid_line_search_t line_search;
    };
    auvid_line_search_config_t local; /* of the local phase; its start: the global phase's best */
    auvid_real_t cost;                /* of that point */
    uint32_t evaluations, attempts;   /* of the global phase, once it has ended */
    uint8_t phase;                    /**< auvid_optimizer_phase_t */
} auvid_optimizer_t;

#define auvid_optimizer_defaults AUVID_SIZED(auvid_optimizer_defaults)
/** Fill *cfg with the defaults of both phases for n parameters; the box is set to zeros.
 * NULL is a no-op. Cost: a memset. */
void auvid_optimizer_defaults(auvid_optimizer_config_t *cfg, uint8_t n);

#define auvid_optimizer_init AUVID_SIZED(auvid_optimizer_init)
/**
 * Check and copy the configuration; draw the first population.
 * @param optimizer  state to start; need not be zeroed.
 * @param cfg     copied.
 * @return AUVID_OK; the errors of auvid_crs_init, the errors of auvid_line_search_init, in that
 *         order. After an error *optimizer is unchanged.
 * Cost: that of auvid_crs_init. Stack: 0.9 KiB.
 */
auvid_status_t auvid_optimizer_init(auvid_optimizer_t *optimizer,
                                    const auvid_optimizer_config_t *cfg);

#define auvid_optimizer_add_point AUVID_SIZED(auvid_optimizer_add_point)
/** Put a known good point into the first population. Parameters of auvid_crs_add_point.
 * @return as auvid_crs_add_point. */
auvid_status_t auvid_optimizer_add_point(auvid_optimizer_t *optimizer, const auvid_real_t *theta);

#define auvid_optimizer_ask AUVID_SIZED(auvid_optimizer_ask)
/**
 * Return the next point to evaluate. A second ask before tell returns the same point.
 * @param theta  n values in the box, written only on AUVID_OK [parameter's unit].
 * @return AUVID_OK: evaluate theta, then tell;
 *         AUVID_PENDING: work was done, but there is no point yet: ask again;
 *         AUVID_FINISHED: converged;
 *         AUVID_EVALUATION_LIMIT: the local phase was ended by its cap on evaluations;
 *         AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_RANGE: memory is damaged,
 *         the search is over, and the best point is that of the global phase.
 * Cost: at most one trial point.
 */
auvid_status_t auvid_optimizer_ask(auvid_optimizer_t *optimizer, auvid_real_t *theta);

#define auvid_optimizer_tell AUVID_SIZED(auvid_optimizer_tell)
/**
 * Supply the cost of the point last asked for.
 * @param cost  any value; NaN, infinities and values beyond +-AUVID_CRS_COST_FAILED count as
 *              AUVID_CRS_COST_FAILED.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (nothing was asked for).
 */
auvid_status_t auvid_optimizer_tell(auvid_optimizer_t *optimizer, auvid_real_t cost);

#define auvid_optimizer_reevaluate AUVID_SIZED(auvid_optimizer_reevaluate)
/**
 * Mark all costs as stale, because the data have changed. The global phase evaluates its population
 * again; the local phase evaluates its iterate and lengthens its steps. The active phase continues;
 * a local phase that had ended is resumed.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised). Cost: O(n).
 */
auvid_status_t auvid_optimizer_reevaluate(auvid_optimizer_t *optimizer);

#define auvid_optimizer_phase AUVID_SIZED(auvid_optimizer_phase)
/** The search that is active; AUVID_OPTIMIZER_GLOBAL for NULL. */
auvid_optimizer_phase_t auvid_optimizer_phase(const auvid_optimizer_t *optimizer);

#define auvid_optimizer_best AUVID_SIZED(auvid_optimizer_best)
/**
 * The best point so far. Its cost rises only after auvid_optimizer_reevaluate.
 * @param cost  its cost; may be NULL.
 * @return n values, owned by *optimizer, valid until the next call; NULL if no cost is known.
 */
const auvid_real_t *auvid_optimizer_best(const auvid_optimizer_t *optimizer, auvid_real_t *cost);

/** Work done so far. */
typedef struct {
    uint32_t crs;         /**< costs received in the global phase */
    uint32_t line_search; /**< costs received in the local phase */
    uint32_t attempts;    /**< points made in both, also rejected ones and those without room */
} auvid_optimizer_work_t;

#define auvid_optimizer_work AUVID_SIZED(auvid_optimizer_work)
/** Work done since init; zeros for NULL. Cost: constant. */
auvid_optimizer_work_t auvid_optimizer_work(const auvid_optimizer_t *optimizer);

/** Linear least squares within bounds. Private. */
typedef struct {
    auvid_real_t lower[AUVID_MAX_PARAMETERS], upper[AUVID_MAX_PARAMETERS];
    auvid_real_t x[AUVID_MAX_PARAMETERS]; /* the start, then the best point */
    auvid_real_t start, cost, zero;       /* costs of the two, and of x = 0 */
    auvid_real_t qr_factor[(AUVID_MAX_PARAMETERS + 1) * (AUVID_MAX_PARAMETERS + 2) / 2]; /* R z */
    auvid_real_t work[(AUVID_MAX_PARAMETERS + 1) * (AUVID_MAX_PARAMETERS + 2) / 2]; /* permuted */
    uint32_t free;                       /* bit i: x_i is not fixed */
    uint8_t order[AUVID_MAX_PARAMETERS]; /* of the columns: free ones first */
    uint8_t n, fixed_from, at, changes, spent;
    uint8_t dof, row; /* of the metric: read so far */
} auvid_bounded_ls_t;

#ifdef __cplusplus
}
#endif

#endif
