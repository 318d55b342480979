/*
 * Least squares within bounds. With P the permutation that puts the free columns first, the rows of
 * [R P | z - R x] are rotated into
 *
 *     [ A B | a ]          f rows: the free columns' step d solves A d = a and gains ||a||^2
 *     [ 0 C | c ]          of the fixed columns, column k by itself gains (C_k'c)^2 / ||C_k||^2
 *
 * So the gain of a change is known before the change is made, without the rounding errors of the
 * columns that are already free.
 */
#include "auvid_bounded_ls_internal.h"

#include <string.h>

#include "../base/auvid_linalg_internal.h"

#define RESOLVED AUVID_C(1e-4) /* smallest pivot, relative to its column: rows have 15 bits */
#define RELEASED AUVID_C(2e-4) /* smallest pivot to free a column again: larger, as hysteresis */
#define GAIN AUVID_C(1e-7)     /* smallest gain, relative to the cost, */
#define BOUNDED_LS_ROUNDED AUVID_C(1e-11) /* plus this part of ||z||^2 */

void auvid_bounded_ls_begin(auvid_bounded_ls_t *ls, int n)
{
    memset(ls, 0, sizeof *ls);
    ls->n = (uint8_t)n;
}

void auvid_bounded_ls_add(auvid_bounded_ls_t *ls, auvid_real_t *row)
{
    auvid_qr_update(ls->qr_factor, ls->n + 1, 0, row);
}

/* Order the columns, the free ones first. At the start a column not at a bound is free. */
static void bounded_ls_sort(auvid_bounded_ls_t *ls)
{
    int f = 0, b = ls->n;
    for (int i = 0; i < ls->n; ++i) {
        if (ls->changes == 0 && ls->x[i] > ls->lower[i] && ls->x[i] < ls->upper[i]) {
            ls->free |= 1u << i;
        }
        ls->order[(ls->free >> i & 1u) ? f++ : --b] = (uint8_t)i;
    }
    ls->fixed_from = (uint8_t)f;
    memset(ls->work, 0, sizeof ls->work);
}

/* Rotate row i of [R P | z - R x] into the work array. */
static void bounded_ls_rotate(auvid_bounded_ls_t *ls, int i)
{
    auvid_real_t row[AUVID_MAX_PARAMETERS + 1];
    const auvid_real_t *r = ls->qr_factor + auvid_qr_row(ls->n + 1, i);
    int n = ls->n;
    row[n] = r[n - i];
    for (int k = 0; k < n; ++k) {
        int column = ls->order[k];
        row[k] = column < i ? AUVID_C(0.0) : r[column - i];
        row[n] -= row[k] * ls->x[column];
    }
    auvid_qr_update(ls->work, n + 1, 0, row);
}

/* The bound of the k-th column in the direction of d. */
static AUVID_NOINLINE auvid_real_t bounded_ls_bound(const auvid_bounded_ls_t *ls, int k,
                                                    auvid_real_t d)
{
    return (d > AUVID_C(0.0) ? ls->upper : ls->lower)[ls->order[k]];
}

/* Move the free columns along their step d (in: a) up to the first bound. If some of them are not
 * resolved, fix these instead. */
static void bounded_ls_move(auvid_bounded_ls_t *ls, auvid_real_t *d)
{
    int f = ls->fixed_from, stop = f;
    int lost = auvid_qr_solve(ls->work, ls->n + 1, f, RESOLVED, d);
    auvid_real_t fraction = lost > 0 ? AUVID_C(0.0) : AUVID_C(1.0);
    for (int k = 0; k < f; ++k) {
        auvid_real_t room = bounded_ls_bound(ls, k, d[k]) - ls->x[ls->order[k]];
        if (auvid_abs(room) < fraction * auvid_abs(d[k])) {
            fraction = room / d[k];
            stop = k;
        }
    }
    for (int k = 0; k < f; ++k) {
        int i = ls->order[k];
        auvid_real_t x = k == stop ? bounded_ls_bound(ls, k, d[k]) : ls->x[i] + fraction * d[k];
        bool fixed = k == stop || !(auvid_abs(d[k]) > AUVID_C(0.0));
        ls->x[i] = auvid_clamp(x, ls->lower[i], ls->upper[i]);
        ls->free &= ~((uint32_t)fixed << i);
    }
}

/* Free the column that gains most. @return whether one gains more than `min_gain` */
static bool bounded_ls_release(auvid_bounded_ls_t *ls, const auvid_real_t *c, auvid_real_t min_gain)
{
    uint32_t before = ls->free, best = 0;
    for (int k = ls->fixed_from; k < ls->n; ++k) {
        int i = ls->order[k];
        auvid_real_t slope = AUVID_C(0.0), square = AUVID_C(0.0);
        for (int row = ls->fixed_from; row <= k; ++row) {
            auvid_real_t r = ls->work[auvid_qr_row(ls->n + 1, row) + k - row];
            slope += r * c[row];
            square += r * r;
        }
        auvid_real_t pivot = RELEASED * auvid_qr_column_norm(ls->work, ls->n + 1, k);
        bool room = auvid_abs(bounded_ls_bound(ls, k, slope) - ls->x[i]) > AUVID_C(0.0);
        if (room && square > pivot * pivot && slope * slope > min_gain * square) {
            min_gain = slope * slope / square;
            best = 1u << i;
        }
    }
    ls->free |= best;
    return ls->free != before;
}

auvid_status_t auvid_bounded_ls_step(auvid_bounded_ls_t *ls, auvid_real_t constant)
{
    int n = ls->n;
    if (ls->at == 0) {
        bounded_ls_sort(ls);
    }
    if (ls->at <= n) {
        bounded_ls_rotate(ls, ls->at++);
        return AUVID_PENDING;
    }
    auvid_real_t c[AUVID_MAX_PARAMETERS + 1], gain = AUVID_C(0.0);
    ls->cost = AUVID_C(0.0);
    for (int i = 0; i <= n; ++i) {
        c[i] = ls->work[auvid_qr_row(n + 1, i) + n - i];
        ls->cost += c[i] * c[i];
        gain = i < ls->fixed_from ? ls->cost : gain;
    }
    if (ls->changes == 0) {
        auvid_real_t z = auvid_qr_column_norm(ls->qr_factor, n + 1, n);
        ls->zero = z * z;
    }
    ls->at = 0;
    auvid_real_t min_gain = GAIN * (ls->cost + constant) + BOUNDED_LS_ROUNDED * ls->zero;
    if (gain > min_gain) {
        bounded_ls_move(ls, c);
    } else if (!bounded_ls_release(ls, c, min_gain)) {
        return AUVID_OK;
    }
    return ++ls->changes < 4 * (n + 1) ? AUVID_PENDING : AUVID_EVALUATION_LIMIT;
}
