/*
 * Least squares within bounds. With P the permutation that puts the free columns first, the rows of
 * [R P | z - R x] are rotated into
 *
 *     [ A B | a ]          f rows: the free columns' step d solves A d = a and gains ||a||^2
 *     [ 0 C | c ]          of the others, column k alone gains (C_k'c)^2 / ||C_k||^2
 *
 * so that what a change gains is known before it is made, free of the rounding of the columns that
 * are free already.
 */
#include "auvid_bounded_ls.h"

#include <string.h>

#include "auvid_linalg.h"

#define RESOLVED AUVID_C(1e-4) /* smallest pivot, relative to its column: stored rows have 15 bits */
#define GAIN AUVID_C(1e-7)     /* smallest, relative to the cost, */
#define ROUNDED AUVID_C(1e-11) /* and to ||z||^2 */

void auvid_bounded_ls_begin(auvid_bounded_ls_t *ls, int n)
{
    memset(ls, 0, sizeof *ls);
    ls->n = (uint8_t)n;
}

void auvid_bounded_ls_add(auvid_bounded_ls_t *ls, auvid_real_t *row)
{
    auvid_triangle_add(ls->triangle, ls->n + 1, 0, row);
}

/* The columns' order: free ones first. Free at the start is what is not at a bound. */
static void sort(auvid_bounded_ls_t *ls)
{
    int n = ls->n, f = 0, b = n;
    for (int i = n - 1; i >= 0; --i) {
        if (ls->changes == 0 && ls->x[i] > ls->lower[i] && ls->x[i] < ls->upper[i]) {
            ls->free |= 1u << i;
        }
        if (!(ls->free >> i & 1u)) {
            ls->order[--b] = (uint8_t)i;
        }
    }
    for (int i = 0; i < n; ++i) {
        if (ls->free >> i & 1u) {
            ls->order[f++] = (uint8_t)i;
        }
    }
    ls->fixed_from = (uint8_t)f;
    memset(ls->work, 0, sizeof ls->work);
}

/* Row i of [R P | z - R x]. */
static void rotate(auvid_bounded_ls_t *ls, int i)
{
    auvid_real_t row[AUVID_MAX_PARAMETERS + 1];
    const auvid_real_t *r = ls->triangle + auvid_triangle_row(ls->n + 1, i);
    int n = ls->n;
    row[n] = r[n - i];
    for (int k = 0; k < n; ++k) {
        int column = ls->order[k];
        row[k] = column < i ? AUVID_C(0.0) : r[column - i];
        row[n] -= row[k] * ls->x[column];
    }
    auvid_triangle_add(ls->work, n + 1, 0, row);
}

/* Entry of the work triangle's last column. */
static auvid_real_t rest(const auvid_bounded_ls_t *ls, int i)
{
    return ls->work[auvid_triangle_row(ls->n + 1, i) + ls->n - i];
}

/* Is the pivot, or what is left of column k, more than rounding? */
static bool is_resolved(const auvid_bounded_ls_t *ls, int k, auvid_real_t pivot)
{
    return pivot > RESOLVED * auvid_triangle_norm(ls->work, ls->n + 1, k);
}

/* Free columns that are not resolved stay where they are. @return there are some */
static bool hold_unresolved(auvid_bounded_ls_t *ls)
{
    uint32_t before = ls->free;
    for (int k = 0; k < ls->fixed_from; ++k) {
        if (!is_resolved(ls, k, ls->work[auvid_triangle_row(ls->n + 1, k)])) {
            ls->free &= ~(1u << ls->order[k]);
        }
    }
    return ls->free != before;
}

/* The free columns' step, as far as the first bound. @return it gains more than `least` */
static bool move(auvid_bounded_ls_t *ls, auvid_real_t least)
{
    auvid_real_t d[AUVID_MAX_PARAMETERS], gain = AUVID_C(0.0), part = AUVID_C(1.0);
    int n = ls->n, f = ls->fixed_from;
    for (int k = 0; k < f; ++k) {
        d[k] = rest(ls, k);
        gain += d[k] * d[k];
    }
    if (!(gain > least)) {
        return false;
    }
    (void)auvid_triangle_solve(ls->work, n + 1, f, AUVID_C(0.0), d);
    for (int k = 0; k < f; ++k) {
        int i = ls->order[k];
        auvid_real_t room = (d[k] > AUVID_C(0.0) ? ls->upper[i] : ls->lower[i]) - ls->x[i];
        if (auvid_abs(room) < part * auvid_abs(d[k])) {
            part = room / d[k];
        }
    }
    for (int k = 0; k < f; ++k) {
        int i = ls->order[k];
        auvid_real_t bound = d[k] > AUVID_C(0.0) ? ls->upper[i] : ls->lower[i];
        auvid_real_t room = bound - ls->x[i];
        ls->x[i] += part * d[k];
        if (auvid_abs(room) <= part * auvid_abs(d[k])) {
            ls->x[i] = bound;
            ls->free &= ~(1u << i);
        }
    }
    return true;
}

/* Free the column that gains most by it. @return one gains more than `least` */
static bool release(auvid_bounded_ls_t *ls, auvid_real_t least)
{
    int best = -1;
    for (int k = ls->fixed_from; k < ls->n; ++k) {
        int i = ls->order[k];
        auvid_real_t slope = AUVID_C(0.0), square = AUVID_C(0.0);
        for (int row = ls->fixed_from; row <= k; ++row) {
            auvid_real_t r = ls->work[auvid_triangle_row(ls->n + 1, row) + k - row];
            slope += r * rest(ls, row);
            square += r * r;
        }
        bool room = slope > AUVID_C(0.0) ? ls->x[i] < ls->upper[i] : ls->x[i] > ls->lower[i];
        auvid_real_t pivot = AUVID_C(0.5) * auvid_sqrt(square); /* not held again at once */
        if (room && slope * slope > least * square && is_resolved(ls, k, pivot)) {
            least = slope * slope / square;
            best = i;
        }
    }
    if (best >= 0) {
        ls->free |= 1u << best;
    }
    return best >= 0;
}

auvid_status_t auvid_bounded_ls_step(auvid_bounded_ls_t *ls, auvid_real_t constant)
{
    if (ls->at == 0) {
        sort(ls);
    }
    if (ls->at <= ls->n) {
        rotate(ls, ls->at++);
        return AUVID_PENDING;
    }
    ls->cost = AUVID_C(0.0);
    for (int i = 0; i <= ls->n; ++i) {
        ls->cost += rest(ls, i) * rest(ls, i);
    }
    if (ls->changes == 0) {
        auvid_real_t z = auvid_triangle_norm(ls->triangle, ls->n + 1, ls->n);
        ls->start = ls->cost;
        ls->zero = z * z;
    }
    ls->at = 0;
    auvid_real_t least = GAIN * (ls->cost + constant) + ROUNDED * ls->zero;
    if (!hold_unresolved(ls) && !move(ls, least) && !release(ls, least)) {
        return AUVID_OK;
    }
    return ++ls->changes < 4 * (ls->n + 1) ? AUVID_PENDING : AUVID_CAPPED;
}
