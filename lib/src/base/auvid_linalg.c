/*
 * Packed R factors by Givens rotations.
 *
 *   rho = sqrt(r_ii^2 + a_i^2), c = r_ii / rho, s = a_i / rho
 *   r_ij <- c r_ij + s a_j,  a_j <- c a_j - s r_ij          for j >= i
 */
#include "auvid_linalg_internal.h"

/* A rotation: c, s. */
typedef struct {
    auvid_real_t c, s;
} linalg_rotation_t;

/* Form the rotation of a into the diagonal *r. @return false: there is none */
static inline bool linalg_rotation(auvid_real_t *r, auvid_real_t a, linalg_rotation_t *g)
{
    if (auvid_is_zero(a)) {
        return false;
    }
    auvid_real_t rho = auvid_sqrt_here(*r * *r + a * a);
    if (!(rho > AUVID_C(0.0))) {
        return false; /* both squares underflow to zero, or one is not a number */
    }
    auvid_real_t inverse = AUVID_C(1.0) / rho;
    g->c = *r * inverse;
    g->s = a * inverse;
    *r = rho;
    return true;
}

/* Rotate an entry of the row, a, with the one above it; returns what is left of a. */
static inline auvid_real_t linalg_turn(linalg_rotation_t g, auvid_real_t *r, auvid_real_t a)
{
    auvid_real_t above = *r;
    *r = g.c * above + g.s * a;
    return g.c * a - g.s * above;
}

/* Two rows of the factor at a time: then row[] is read and written half as often. */
void auvid_qr_update_rows(auvid_real_t *factor, int n, int first, int end, auvid_real_t *row)
{
    for (int i = first; i < end; ++i) {
        linalg_rotation_t g, h;
        auvid_real_t *r = factor + auvid_qr_row(n, i), *next = r + n - i;
        auvid_real_t *a = row + i + 1, *stop = row + n;
        if (!linalg_rotation(r++, row[i], &g)) {
            continue;
        }
        if (i + 1 < end) {
            *a = linalg_turn(g, r++, *a);
            if (linalg_rotation(next++, *a++, &h)) {
                for (++i; a < stop; ++a) {
                    *a = linalg_turn(h, next++, linalg_turn(g, r++, *a));
                }
            }
        }
        for (; a < stop; ++a) {
            *a = linalg_turn(g, r++, *a);
        }
    }
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

int auvid_qr_solve_from(const auvid_real_t *factor, int n, int from, int m, auvid_real_t tiny,
                        auvid_real_t *x)
{
    int lost = 0;
    for (int i = m - 1; i >= from; --i) {
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

int auvid_qr_solve(const auvid_real_t *factor, int n, int m, auvid_real_t tiny, auvid_real_t *x)
{
    return auvid_qr_solve_from(factor, n, 0, m, tiny, x);
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
