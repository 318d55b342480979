/**
 * @file auvid_linalg_internal.h
 * Private: packed upper triangles by Givens rotations (Golub & Van Loan 2013, 5.2.5).
 *
 * A triangle of order n is n (n + 1) / 2 numbers, row after row; row i holds columns i..n-1. Rows
 * are rotated into it one by one: R'R stays the sum of all row'row, and the normal matrix, which in
 * float32 loses the optimum, is never formed. Right-hand sides are simply the last columns.
 */
#ifndef AUVID_LINALG_INTERNAL_H
#define AUVID_LINALG_INTERNAL_H

#include "auvid_math_internal.h"

/** Numbers in a triangle of order n. */
#define AUVID_QR_FACTOR(n) ((n) * ((n) + 1) / 2)

/** Where row i starts in a triangle of order n (its first entry is the diagonal). */
static inline int auvid_qr_row(int n, int i)
{
    return i * n - i * (i - 1) / 2;
}

/** Rotate row[n] into the triangle; row[] is used up. Starts at column `first` (entries before it
 * are zero). Cost: about 6 flops for each remaining pair of entries, one square root a column. */
void auvid_qr_update(auvid_real_t *triangle, int n, int first, auvid_real_t *row);

/** Norm of column i: that of the column of which the rows were rotated in. */
auvid_real_t auvid_qr_column_norm(const auvid_real_t *triangle, int n, int i);

/** Solve the leading m columns (m <= n) for a right-hand side: x[m] comes as that and goes as the
 * solution. A pivot not above `tiny` times the norm of its column makes its x zero (the data say
 * nothing).
 * @return number of such pivots. */
int auvid_qr_solve(const auvid_real_t *triangle, int n, int m, auvid_real_t tiny, auvid_real_t *x);

/** The same for the transposed of the leading m columns: x R = right-hand side, without test of the
 * pivots: a zero one makes its x zero. */
void auvid_qr_solve_transposed(const auvid_real_t *triangle, int n, int m, auvid_real_t *x);

#endif
