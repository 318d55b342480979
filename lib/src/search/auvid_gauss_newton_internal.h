/**
 * @file auvid_gauss_newton_internal.h
 * Private: damped Gauss-Newton steps within bounds (Levenberg 1944, Marquardt 1963).
 *
 *     min J(x) = sum e_k(x)^2,  lower <= x <= upper
 *
 * An ask / tell state machine, like the other phases of a search. It asks for the cost of a point,
 * or for the linear model there, whose rows are [d e / d x | (d e / d x) x - e]. Each step is a
 * least-squares problem within bounds (auvid_bounded_ls_internal.h) with the rows
 * sqrt(damping) ||column i|| (x_i - x_i at the point) = 0 added. If the cost falls, the damping
 * falls; else it rises and the step is made again.
 *
 *     auvid_gauss_newton_begin; fill in lower, upper and x
 *     while state is not NEWTON_DONE:
 *         NEWTON_COST   auvid_gauss_newton_tell with the cost of ls.x
 *         NEWTON_ROWS   linearise at x, then auvid_gauss_newton_begin_step
 *         NEWTON_STEP   auvid_gauss_newton_add for all rows of that linear model, then
 *                       auvid_gauss_newton_step until the state changes
 *
 * The first step moves only the parameters in `affine`, without damping: if the e_k are affine in
 * these, it ends at their minimum, whatever they were.
 *
 * Cost: at most NEWTON_MAX_ROWS linear models, with NEWTON_MAX_REJECTED + 1 costs and steps each. A
 * call of auvid_gauss_newton_step costs at most a rotation of a row of n + 1 numbers.
 */
#ifndef AUVID_GAUSS_NEWTON_INTERNAL_H
#define AUVID_GAUSS_NEWTON_INTERNAL_H

#include "auvid/detail/optimizer.h"

/** What is needed next. */
enum { NEWTON_COST, NEWTON_ROWS, NEWTON_STEP, NEWTON_DONE };

/** Limits of the steps. */
enum { NEWTON_MAX_ROWS = 10, NEWTON_MAX_REJECTED = 8 };
#define NEWTON_MAX_DAMPING AUVID_C(1e6)

/** Begin with n parameters, 1..AUVID_MAX_PARAMETERS, at gn->x; ls.x is a copy of it.
 * @param affine bit i: x_i moves in the first step; 0: there is no such step */
void auvid_gauss_newton_begin(auvid_gauss_newton_t *gn, int n, const auvid_real_t *x,
                              uint32_t affine);

/** Take the cost of ls.x. A cost that is not finite counts as AUVID_COST_FAILED. The search ends if
 * the start has no cost. */
void auvid_gauss_newton_tell(auvid_gauss_newton_t *gn, auvid_real_t cost);

/** Begin a step: the linear model at gn->x is ready. */
void auvid_gauss_newton_begin_step(auvid_gauss_newton_t *gn);

/** Add a row [r_1 .. r_n | z] of it; row[] is overwritten. */
void auvid_gauss_newton_add(auvid_gauss_newton_t *gn, auvid_real_t *row);

/** Continue the step, until NEWTON_COST. */
void auvid_gauss_newton_step(auvid_gauss_newton_t *gn);

/** Returns 1 / ||column i|| of the last linear model: the change of x_i that changes the cost by
 * one; 0 if the column is empty. */
auvid_real_t auvid_gauss_newton_scale(const auvid_gauss_newton_t *gn, int i);

#endif
