/**
 * @file auvid_bounded_ls_internal.h
 * Private: least squares within bounds, by an active set (Stark & Parker 1995).
 *
 *     min ||R x - z||^2,  lower <= x <= upper
 *
 * R and z come row by row and are kept as a triangle; the normal matrix is never formed. From a
 * start within the bounds, each change of the active set lowers the cost. A parameter that the rows
 * cannot resolve (its pivot is not above RESOLVED times the norm of its column) keeps its value.
 *
 *     auvid_bounded_ls_begin; lower, upper and x filled in; auvid_bounded_ls_add for each row;
 *     auvid_bounded_ls_step while AUVID_PENDING
 *
 * Cost: at most 4 (n + 1) changes of the active set of n + 1 steps each, usually two. A step costs
 * at most a rotation of a row of n + 1 numbers. Memory: sizeof(auvid_bounded_ls_t), declared in
 * optimizer.h.
 */
#ifndef AUVID_BOUNDED_LS_INTERNAL_H
#define AUVID_BOUNDED_LS_INTERNAL_H

#include "auvid/optimizer.h"

/** Empty, with n parameters, 1..AUVID_MAX_PARAMETERS. */
void auvid_bounded_ls_begin(auvid_bounded_ls_t *ls, int n);

/** Take a row [r_1 .. r_n | z]; row[] is used up. */
void auvid_bounded_ls_add(auvid_bounded_ls_t *ls, auvid_real_t *row);

/** One step towards the optimum. ls->x comes as the start, within the bounds, and goes as the best
 * point; ls->start and ls->cost become the costs of the two, ls->zero that of x = 0; bit i of
 * ls->free: x_i is neither at a bound nor unresolved.
 * @param constant cost beside this, >= 0: changes that gain less than 1e-7 of the whole, or
 * rounding only, are not made
 * @return AUVID_OK (the optimum); AUVID_PENDING; AUVID_EVALUATION_LIMIT (too many changes: a good
 * point). */
auvid_status_t auvid_bounded_ls_step(auvid_bounded_ls_t *ls, auvid_real_t constant);

#endif
