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
 *     auvid_search_defaults(&cfg, 13);             then set the box
 *     auvid_optimizer_init(&optimizer, &cfg, NULL);
 *     for (;;) {
 *         status = auvid_optimizer_ask(&optimizer, theta);
 *         if (status == AUVID_OK) {
 *             auvid_optimizer_tell(&optimizer, my_cost(theta));
 *         } else if (status != AUVID_PENDING) {
 *             break;                                  finished, or evaluation limit
 *         }
 *     }
 *
 * Cost: one ask makes at most one trial. For n = 13, m = 52 a trial of the global phase is 1.8k
 * instructions on a Cortex-M4F (-O2); tell adds 0.5-0.7k if it is accepted, else 0.1k. In the local
 * phase ask takes 490 (at most 900), tell 390 (1400). Memory: 5.4 KiB by default, for the larger of
 * the two. Evaluations until it ends, for 13 parameters of a Girona500, box [-1000, 1000], float32,
 * 1000 simulated records: median 466, p95 492; with `paper` 5070. All results are within 1 % of the
 * least-squares parameters (tests/unit/search/test_optimizer_figures.c, tests/bench).
 *
 * Scale the cost so that J(0) ~ 1, and omit constant terms: epsilon_crs is absolute, gamma defines
 * what counts as a gain, and in float32 a constant hides the differences.
 *
 * Sources: Section III-C of Karras et al., IROS 2013; Leonetti et al. 2012 for the composition.
 * Algorithm 1 after Brachetti, De Felice Ciccoli, Di Pillo, Lucidi, J. Global Optimization 10
 * (1997). Algorithm 2 after Lucidi, Sciandrone, Computational Optimization and Applications 21
 * (2002): steps are cut at the box, and any better point may replace the iterate without harm to
 * the convergence theory. Conjugate directions: Smith 1962, Powell, The Computer Journal 7 (1964).
 *
 * Deviations from the paper; `paper` switches off the first two:
 * - the global phase is short, omega = 2 and reduction >= 0.05, unless omega is given: it only has
 *   to find the region;
 * - the local phase searches along conjugate directions, with pattern steps and parabolas
 *   (auvid_line_search.c). A recorded 13-parameter problem takes 290 evaluations instead of 4550;
 * - the box is also searched from points that are known to be good;
 * - with a certificate (auvid_optimizer_certify) both phases only confirm it; with a goal
 *   (auvid_optimizer_set_goal) the local one ends if it will not reach that;
 * - both phases have caps on evaluations, the global one also on consecutive trials outside the box
 *   (the paper's loops are unbounded; with m = n + 1, or an optimum in a corner, they do not end);
 * - the local phase restarts with a tenth of alpha0: in float32 it may end too early;
 * - phi is at least AUVID_EPSILON (J_max - J_min), so that no weight divides by zero, and its ratio
 *   (J_max - J_min) / (J0_max - J0_min) is below 1000; J0 is of points that did not fail;
 * - a population whose spread is below the resolution of the arithmetic has converged. A cost that
 *   is not finite, or above AUVID_COST_FAILED, counts as AUVID_COST_FAILED.
 */
#ifndef AUVID_OPTIMIZER_H
#define AUVID_OPTIMIZER_H

#include "auvid/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The cost of a point at which the model failed. Larger costs, infinities and NaN count as this
 * one. It is so small that no product with it overflows. */
#define AUVID_COST_FAILED AUVID_C(1e24)

/** Progress of a search. What stands before AUVID_OPTIMIZER_START is the global phase. */
typedef enum {
    AUVID_OPTIMIZER_NONE = 0,         /**< not initialised */
    AUVID_OPTIMIZER_FRESH,            /**< before the first point */
    AUVID_OPTIMIZER_FILL,             /**< points of the first population are drawn, evaluated */
    AUVID_OPTIMIZER_GLOBAL,           /**< controlled random search */
    AUVID_OPTIMIZER_GLOBAL_CONVERGED, /**< ended by its spread */
    AUVID_OPTIMIZER_GLOBAL_CAPPED,    /**< ended by a cap, or no point has a cost */
    AUVID_OPTIMIZER_START,            /**< the starting point of the line search is evaluated */
    AUVID_OPTIMIZER_LOCAL,            /**< line search */
    AUVID_OPTIMIZER_LOCAL_CONVERGED,  /**< all steps are short, restarts included, or the goal is
                                           out of reach */
    AUVID_OPTIMIZER_LOCAL_CAPPED,     /**< ended by the cap on evaluations */
    AUVID_OPTIMIZER_STATE_COUNT
} auvid_optimizer_state_t;

/** Work done so far. */
typedef struct {
    uint32_t crs;         /**< costs received in the global phase */
    uint32_t line_search; /**< costs received in the local phase */
    uint32_t attempts;    /**< points made in both, also rejected ones and those without room */
} auvid_optimizer_work_t;

/** State of the global phase: the population S of m points. */
typedef struct {
    auvid_real_t initial_spread; /**< J0_max - J0_min over the points that did not fail */
    auvid_real_t last_spread;    /**< J_max - J_min at which the search ends */
    uint32_t rng[4];             /**< state of the random numbers */
    uint32_t rejections;         /**< consecutive trials outside the box, now */
    uint16_t known;              /**< points added by auvid_optimizer_add_point, 0..m */
    uint16_t best, worst;        /**< indices of theta_min and theta_max */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), 26)];
    auvid_real_t cost[AUVID_POPULATION_SLOTS]; /**< J of each point, once evaluated */
    auvid_real_t theta[AUVID_POPULATION_SLOTS][AUVID_MAX_PARAMETERS]; /**< S [parameter's unit] */
    uint16_t order[AUVID_POPULATION_SLOTS]; /**< a permutation of 0..m-1; draws shuffle it */
} auvid_crs_t;

/** State of the local phase. */
typedef struct {
    uint8_t direction;     /**< 0..2n-1; 2n: the pattern step */
    uint8_t built;         /**< d_i with i < built have been made conjugate */
    uint8_t probe;         /**< k of the d_k that is probed */
    uint8_t move;          /**< private enum: purpose of the trial */
    uint8_t restarts_left; /**< 0..restarts */
    bool plain;            /**< no d_i has been made in this sweep */
    uint8_t reserved[2];
    auvid_real_t axis_cost, axis_step; /**< cost of base + axis_step e_i, where d_i is made */
    auvid_real_t cost, base_cost, previous_cost;  /**< of theta, base, previous */
    auvid_real_t t;                               /**< step of the trial along the line [scale] */
    auvid_real_t t_best;                          /**< step accepted last, 0: none */
    auvid_real_t t_near, cost_near;               /**< the line's last point */
    auvid_real_t t_far, cost_far;                 /**< the point before that; t_far 0: none */
    auvid_real_t theta[AUVID_MAX_PARAMETERS];     /**< the best point, x [parameter's unit] */
    auvid_real_t base[AUVID_MAX_PARAMETERS];      /**< y_i, where the current line starts */
    auvid_real_t previous[AUVID_MAX_PARAMETERS];  /**< theta^k, where the current sweep started */
    auvid_real_t alpha[2 * AUVID_MAX_PARAMETERS]; /**< steps by direction [scale] */
    auvid_real_t curvature[AUVID_MAX_PARAMETERS]; /**< half second derivative along d_i
                                                       [cost/scale^2]; <= 0: not known */
    auvid_real_t slope[AUVID_MAX_PARAMETERS];     /**< along d_i, at the end of its line */
    /** d_i = e_i + sum of shear[i (i - 1) / 2 + k] e_k, k < i [scale] */
    auvid_real_t shear[AUVID_MAX_PARAMETERS * (AUVID_MAX_PARAMETERS - 1) / 2 + 1];
} auvid_line_search_t;

/** State; private except through the accessors. Only this module writes it. */
typedef struct {
    auvid_optimizer_work_t work; /**< since init */
    uint8_t state;               /**< auvid_optimizer_state_t */
    bool asked;                  /**< a point was returned, its cost is not yet received */
    bool certified;              /**< there is a certificate, and no cost has refuted it */
    bool has_goal;               /**< auvid_optimizer_set_goal */
    auvid_search_config_t cfg; /**< as given, zeros replaced by their values. May be filled in here
                                    for init */
    auvid_real_t scale[AUVID_MAX_PARAMETERS]; /**< unit of the steps [parameter's unit] */
    auvid_real_t trial[AUVID_MAX_PARAMETERS]; /**< the point last asked for */
    auvid_real_t least, allowed; /**< least: of the certificate, or the goal; allowed: of the
                                      certificate [cost] */
    union { /* one after the other: the global phase leaves its best point and its cost */
        auvid_crs_t crs;
        auvid_line_search_t line_search;
    };
} auvid_optimizer_t;

#define auvid_search_defaults AUVID_SIZED(auvid_search_defaults)
/** Fill *cfg with the defaults for n parameters. NULL is a no-op. Cost: O(AUVID_MAX_PARAMETERS). */
void auvid_search_defaults(auvid_search_config_t *cfg, uint8_t n);

#define auvid_search_check AUVID_SIZED(auvid_search_check)
/** Check a configuration.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_PARAMETERS (n); AUVID_ERR_POPULATION (m);
 *         AUVID_ERR_NOT_FINITE (any real that is used); AUVID_ERR_BOUNDS (lower >= upper);
 *         AUVID_ERR_RANGE (another field out of range). Cost: O(n). */
auvid_status_t auvid_search_check(const auvid_search_config_t *cfg);

#define auvid_optimizer_init AUVID_SIZED(auvid_optimizer_init)
/**
 * Check and copy the configuration; begin the global phase, whose m points of S are drawn uniformly
 * in the box as they are asked for (Algorithm 1, line 3), or the local phase.
 * @param optimizer  state to start; need not be zeroed.
 * @param cfg    copied; may be optimizer->cfg.
 * @param scale  n units of the local steps [parameter's unit], >= 0, <= 1e18: a step alpha moves
 *               parameter i by alpha scale[i]. One choice is the inverse norm of the parameter's
 *               column in a least-squares problem. 0, and all of them if NULL: half the width of
 *               the box.
 * @return AUVID_OK; AUVID_ERR_NULL (but scale); the errors of auvid_search_check;
 *         AUVID_ERR_NOT_FINITE, AUVID_ERR_RANGE (scale). After an error *optimizer is unchanged.
 * Cost: ~4k instructions for n = 13, m = 52 on a Cortex-M4F.
 */
auvid_status_t auvid_optimizer_init(auvid_optimizer_t *optimizer, const auvid_search_config_t *cfg,
                                    const auvid_real_t *scale);

#define auvid_optimizer_add_point AUVID_SIZED(auvid_optimizer_add_point)
/**
 * Put a known good point into the first population, clipped to the box. It replaces a random one. A
 * bad point does no harm: it is one of m.
 * @param theta  n values [parameter's unit].
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, a point was already asked
 *         for, or there is no global phase); AUVID_ERR_POPULATION (all m are known points);
 *         AUVID_ERR_NOT_FINITE. Cost: n copies.
 */
auvid_status_t auvid_optimizer_add_point(auvid_optimizer_t *optimizer, const auvid_real_t *theta);

#define auvid_optimizer_certify AUVID_SIZED(auvid_optimizer_certify)
/**
 * Supply a certificate: theta has the least cost in the box, to `allowed`. It becomes the last of
 * the known points. Each phase ends when its points confirm the certificate: the global phase once
 * its population is evaluated and the best cost is `least`, the local phase after one poll of its
 * 2n directions, with step sqrt(allowed), that gains no more than `allowed`. So a search takes
 * m + 2n + 1 evaluations. A cost that differs from `least` by more than `allowed` refutes the
 * certificate, and the search goes on without it.
 * @param theta  n values, clipped to the box [parameter's unit].
 * @param least  its cost, as the caller of tell will compute it.
 * @param allowed  >= 0.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, or a point was already asked
 *         for); AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (allowed). After an error nothing has
 *         changed. Cost: n copies.
 */
auvid_status_t auvid_optimizer_certify(auvid_optimizer_t *optimizer, const auvid_real_t *theta,
                                       auvid_real_t least, auvid_real_t allowed);

#define auvid_optimizer_set_goal AUVID_SIZED(auvid_optimizer_set_goal)
/**
 * Set the cost that the local phase has to fall below, as that of another minimum: it also ends,
 * as converged, after a sweep that has gained less than a third of what is missing.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised, a point was already asked
 *         for, there is a global phase or a certificate); AUVID_ERR_NOT_FINITE. After an error
 *         nothing has changed. Cost: constant.
 */
auvid_status_t auvid_optimizer_set_goal(auvid_optimizer_t *optimizer, auvid_real_t cost);

#define auvid_optimizer_ask AUVID_SIZED(auvid_optimizer_ask)
/**
 * Return the next point to evaluate (Algorithm 1, lines 4, 9-15; Algorithm 2, lines 3-6). A second
 * ask before tell returns the same point and counts nothing.
 * @param theta  n values in the box, written only on AUVID_OK [parameter's unit].
 * @return AUVID_OK: evaluate theta, then tell;
 *         AUVID_PENDING: a trial was outside the box, or a step had no room: ask again. It counts
 *         as work;
 *         AUVID_FINISHED: converged;
 *         AUVID_EVALUATION_LIMIT: the last phase was ended by a cap;
 *         AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised).
 * Cost: at most one trial point, or n random numbers. Stack: ~0.3 KiB.
 */
auvid_status_t auvid_optimizer_ask(auvid_optimizer_t *optimizer, auvid_real_t *theta);

#define auvid_optimizer_tell AUVID_SIZED(auvid_optimizer_tell)
/**
 * Supply the cost of the point last asked for (Algorithm 1, lines 5, 17-20; Algorithm 2, 7-21).
 * @param cost  any value, since a model may fail at a point; NaN, infinities and values beyond
 *              +-AUVID_COST_FAILED count as AUVID_COST_FAILED.
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (nothing was asked for).
 * Cost: n copies and m comparisons, or 3 n copies, n multiply-adds and 2n comparisons; n^2 / 2
 * stores when the directions are reset.
 */
auvid_status_t auvid_optimizer_tell(auvid_optimizer_t *optimizer, auvid_real_t cost);

#define auvid_optimizer_best AUVID_SIZED(auvid_optimizer_best)
/**
 * The best point so far.
 * @param cost  its cost; may be NULL.
 * @return n values, owned by *optimizer, valid until the next call; NULL if no cost is known.
 */
const auvid_real_t *auvid_optimizer_best(const auvid_optimizer_t *optimizer, auvid_real_t *cost);

/** Linear least squares within bounds. Private. */
typedef struct {
    uint32_t free; /* bit i: x_i is not fixed */
    uint8_t n, fixed_from, at, changes, spent;
    uint8_t dof, row;                    /* of the metric: read so far */
    uint8_t order[AUVID_MAX_PARAMETERS]; /* of the columns: free ones first */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), AUVID_MAX_PARAMETERS + 11)];
    auvid_real_t lower[AUVID_MAX_PARAMETERS], upper[AUVID_MAX_PARAMETERS];
    auvid_real_t x[AUVID_MAX_PARAMETERS]; /* the start, then the best point */
    auvid_real_t cost, zero;              /* of it, and of x = 0 */
    auvid_real_t qr_factor[(AUVID_MAX_PARAMETERS + 1) * (AUVID_MAX_PARAMETERS + 2) / 2]; /* R z */
    auvid_real_t work[(AUVID_MAX_PARAMETERS + 1) * (AUVID_MAX_PARAMETERS + 2) / 2]; /* permuted */
} auvid_bounded_ls_t;

/** Gauss-Newton steps within bounds. Private. */
typedef struct {
    auvid_bounded_ls_t ls; /* of the step; ls.x is the trial */
    auvid_real_t lower[AUVID_MAX_PARAMETERS], upper[AUVID_MAX_PARAMETERS];
    auvid_real_t x[AUVID_MAX_PARAMETERS]; /* the best point; the rows are linearised there */
    auvid_real_t cost;                    /* of it */
    auvid_real_t damping;                 /* relative to the squared norm of each column */
    auvid_real_t squares;                 /* of the residuals of a DoF's rows, so far */
    uint32_t affine;                      /* columns of the closed-form step; 0: it is over */
    uint8_t state;                        /* private enum */
    uint8_t rows;                         /* linearisations so far */
    uint8_t rejected;                     /* trials at this point */
    uint8_t damped;                       /* columns whose damping is in ls */
} auvid_gauss_newton_t;

#ifdef __cplusplus
}
#endif

#endif
