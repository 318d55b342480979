/**
 * @file auvid_linalg_internal.h
 * Private: packed R factors by Givens rotations (Golub & Van Loan 2013, 5.2.5).
 *
 * A factor R of order n is upper triangular and has n (n + 1) / 2 numbers, stored row by row. Row i
 * holds columns i..n-1. Givens rotations add one row at a time, so R'R is the sum of all row'row.
 * The normal matrix is never formed: in float32 it loses the optimum. Right-hand sides are the last
 * columns.
 */
#ifndef AUVID_LINALG_INTERNAL_H
#define AUVID_LINALG_INTERNAL_H

#include "auvid_math_internal.h"

/** Number of entries of a factor of order n. */
#define AUVID_QR_FACTOR(n) ((n) * ((n) + 1) / 2)

/** Returns the index of row i's first entry, the diagonal, in a factor of order n. */
static inline int auvid_qr_row(int n, int i)
{
    return (int)((uint32_t)(i * (2 * n + 1 - i)) / 2u);
}

/** Rotates row[n] into rows first..end-1 of the factor; the contents of row[] are undefined
 * afterwards. The entries before column `first` must be zero. Rows from `end` on are not read: they
 * need not be stored. Cost: about 6 flops for each remaining pair of entries, and one square root
 * for each column. */
void auvid_qr_update_rows(auvid_real_t *factor, int n, int first, int end, auvid_real_t *row);

/** Rotates row[n] into all rows of the factor, likewise. */
static inline void auvid_qr_update(auvid_real_t *factor, int n, int first, auvid_real_t *row)
{
    auvid_qr_update_rows(factor, n, first, n, row);
}

/** Returns the norm of column i of R. It equals the norm of column i of all rows rotated in. */
auvid_real_t auvid_qr_column_norm(const auvid_real_t *factor, int n, int i);

/** Solves R x = b with the leading m columns (m <= n). x[m] is b on entry and the solution on
 * return. A pivot that is not above `tiny` times the norm of its column sets its x to zero, because
 * the data do not determine it.
 * @return number of such pivots */
int auvid_qr_solve(const auvid_real_t *factor, int n, int m, auvid_real_t tiny, auvid_real_t *x);

/** The same for x[from..m-1] only. The others are undefined afterwards. */
int auvid_qr_solve_from(const auvid_real_t *factor, int n, int from, int m, auvid_real_t tiny,
                        auvid_real_t *x);

/** Solves R' x = b with the leading m columns (m <= n). x[m] is b on entry and the solution on
 * return. A zero pivot sets its x to zero; there is no other test of the pivots. */
void auvid_qr_solve_transposed(const auvid_real_t *factor, int n, int m, auvid_real_t *x);

#endif
