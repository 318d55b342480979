/*
 * Packed R factors by Givens rotations.
 *
 *   rho = sqrt(r_ii^2 + a_i^2), c = r_ii / rho, s = a_i / rho
 *   r_ij <- c r_ij + s a_j,  a_j <- c a_j - s r_ij          for j >= i
 */
#include "auvid_linalg_internal.h"

/* Rotate the row into rows first..end-1 of the factor. */
static inline void linalg_rotate(auvid_real_t *factor, int n, int first, int end, auvid_real_t *row)
{
    for (int i = first; i < end; ++i) {
        auvid_real_t *r = factor + auvid_qr_row(n, i);
        if (auvid_is_zero(row[i])) {
            continue;
        }
        auvid_real_t rho = auvid_sqrt(r[0] * r[0] + row[i] * row[i]);
        if (!(rho > AUVID_C(0.0))) {
            continue; /* both squares underflow to zero */
        }
        auvid_real_t inverse = AUVID_C(1.0) / rho;
        auvid_real_t c = r[0] * inverse, s = row[i] * inverse;
        r[0] = rho;
        for (int j = i + 1; j < n; ++j) {
            auvid_real_t old = r[j - i], a = row[j];
            r[j - i] = c * old + s * a;
            row[j] = c * a - s * old;
        }
    }
}

void auvid_qr_update(auvid_real_t *factor, int n, int first, auvid_real_t *row)
{
    linalg_rotate(factor, n, first, n, row);
}

void auvid_qr_update_top(auvid_real_t *factor, int n, int rows, auvid_real_t *row)
{
    linalg_rotate(factor, n, 0, rows, row);
}

auvid_real_t auvid_qr_column_norm(const auvid_real_t *factor, int n, int i)
{
    auvid_real_t squares = AUVID_C(0.0);
    for (int k = 0; k <= i; ++k) {
        auvid_real_t above = factor[auvid_qr_row(n, k) + i - k];
        squares += above * above;
    }
    return auvid_sqrt(squares);
}

int auvid_qr_solve(const auvid_real_t *factor, int n, int m, auvid_real_t tiny, auvid_real_t *x)
{
    int lost = 0;
    for (int i = m - 1; i >= 0; --i) {
        const auvid_real_t *r = factor + auvid_qr_row(n, i);
        for (int j = i + 1; j < m; ++j) {
            x[i] -= r[j - i] * x[j];
        }
        bool usable = auvid_abs(r[0]) > tiny * auvid_qr_column_norm(factor, n, i);
        lost += !usable;
        x[i] = usable ? x[i] / r[0] : AUVID_C(0.0);
    }
    return lost;
}

void auvid_qr_solve_transposed(const auvid_real_t *factor, int n, int m, auvid_real_t *x)
{
    for (int i = 0; i < m; ++i) {
        const auvid_real_t *r = factor + auvid_qr_row(n, i);
        if (auvid_is_zero(x[i])) {
            continue;
        }
        x[i] = auvid_abs(r[0]) > AUVID_C(0.0) ? x[i] / r[0] : AUVID_C(0.0);
        for (int j = i + 1; j < m; ++j) {
            x[j] -= r[j - i] * x[i];
        }
    }
}
