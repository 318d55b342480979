/**
 * @file auvid_bounded_ls_internal.h
 * Private: least squares within bounds, by an active set (Stark & Parker 1995).
 *
 *     min ||R x - z||^2,  lower <= x <= upper
 *
 * The rows of R and z are accumulated in an R factor; the normal matrix is never formed. From a
 * start within the bounds, each change of the active set lowers the cost. A parameter that the rows
 * do not resolve (its pivot is at most RESOLVED times the norm of its column) keeps its value.
 *
 *     auvid_bounded_ls_begin; fill in lower, upper and x; auvid_bounded_ls_add for each row;
 *     auvid_bounded_ls_step while AUVID_PENDING
 *
 * Cost: at most 4 (n + 1) changes of the active set of n + 1 steps each, usually two. A step costs
 * at most a rotation of a row of n + 1 numbers. Memory: sizeof(auvid_bounded_ls_t), declared in
 * detail/optimizer.h.
 */
#ifndef AUVID_BOUNDED_LS_INTERNAL_H
#define AUVID_BOUNDED_LS_INTERNAL_H

#include "auvid/detail/optimizer.h"

/** Begin an empty problem with n parameters, 1..AUVID_MAX_PARAMETERS. */
void auvid_bounded_ls_begin(auvid_bounded_ls_t *ls, int n);

/** Add a row [r_1 .. r_n | z]; row[] is overwritten. */
void auvid_bounded_ls_add(auvid_bounded_ls_t *ls, auvid_real_t *row);

/** Do one step towards the optimum. ls->x is the start on entry, within the bounds, and the best
 * point on return. ls->cost is its cost, ls->zero that of x = 0; bit i of ls->free: x_i is resolved
 * and not at a bound.
 * @param constant further cost, >= 0: a change is not made if it gains less than 1e-7 of the whole
 * or only rounding
 * @return AUVID_OK (the optimum); AUVID_PENDING; AUVID_EVALUATION_LIMIT (too many changes: a good
 * point). */
auvid_status_t auvid_bounded_ls_step(auvid_bounded_ls_t *ls, auvid_real_t constant);

#endif
