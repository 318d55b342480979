/*
 * Damped Gauss-Newton steps within bounds. See the header for the equations.
 */
#include "auvid_gauss_newton_internal.h"

#include <string.h>

#include "../base/auvid_linalg_internal.h"
#include "auvid_bounded_ls_internal.h"

#define DAMPING AUVID_C(1e-3)     /* of the first step */
#define MIN_DAMPING AUVID_C(1e-7) /* smaller ones are only rounding */
#define DAMPING_FACTOR AUVID_C(10.0)
/* The steps end when one lowers the cost by less than this part: the next one gains even less. */
#define NEWTON_GAIN AUVID_C(1e-4)

void auvid_gauss_newton_begin(auvid_gauss_newton_t *gn, int n, const auvid_real_t *x,
                              uint32_t affine)
{
    memset(gn, 0, sizeof *gn);
    auvid_bounded_ls_begin(&gn->ls, n);
    memcpy(gn->x, x, (size_t)n * sizeof *x);
    memcpy(gn->ls.x, x, (size_t)n * sizeof *x);
    gn->cost = AUVID_COST_FAILED;
    gn->damping = DAMPING;
    gn->affine = affine;
    gn->state = NEWTON_COST;
}

/* The trial is the best point: linearise there, unless little was gained. */
static void gauss_newton_accept(auvid_gauss_newton_t *gn, auvid_real_t cost)
{
    bool closed_form = gn->rows > 0 && gn->affine != 0;
    bool settled = gn->rows > 0 && !closed_form && gn->cost - cost <= NEWTON_GAIN * gn->cost;
    if (gn->rows > 0 && !closed_form) {
        gn->damping = auvid_max(gn->damping / DAMPING_FACTOR, MIN_DAMPING);
    }
    gn->affine = closed_form ? 0 : gn->affine;
    gn->rejected = 0;
    gn->cost = cost;
    memcpy(gn->x, gn->ls.x, sizeof gn->x);
    gn->state = settled || gn->rows == NEWTON_MAX_ROWS ? NEWTON_DONE : NEWTON_ROWS;
}

/* Make the step again with more damping; after the closed form, that of all parameters. */
static void gauss_newton_reject(auvid_gauss_newton_t *gn)
{
    if (gn->rows == 0 || gn->rejected == NEWTON_MAX_REJECTED) {
        gn->state = NEWTON_DONE;
        return;
    }
    ++gn->rejected;
    gn->damping *= gn->affine != 0 ? AUVID_C(1.0) : DAMPING_FACTOR;
    gn->damping = auvid_min(gn->damping, NEWTON_MAX_DAMPING);
    gn->affine = 0;
    auvid_gauss_newton_begin_step(gn);
}

void auvid_gauss_newton_tell(auvid_gauss_newton_t *gn, auvid_real_t cost)
{
    if (cost < gn->cost) { /* false for NaN */
        gauss_newton_accept(gn, cost);
    } else {
        gauss_newton_reject(gn);
    }
}

void auvid_gauss_newton_begin_step(auvid_gauss_newton_t *gn)
{
    auvid_bounded_ls_t *ls = &gn->ls;
    int n = ls->n;
    gn->rows = (uint8_t)(gn->rows + (gn->state == NEWTON_ROWS));
    auvid_bounded_ls_begin(ls, n);
    memcpy(ls->x, gn->x, sizeof ls->x);
    memcpy(ls->lower, gn->affine != 0 ? gn->x : gn->lower, sizeof ls->lower);
    memcpy(ls->upper, gn->affine != 0 ? gn->x : gn->upper, sizeof ls->upper);
    for (int i = 0; i < n && gn->affine != 0; ++i) {
        if ((gn->affine >> i & 1u) != 0) {
            ls->lower[i] = gn->lower[i];
            ls->upper[i] = gn->upper[i];
        }
    }
    gn->damped = gn->affine != 0 ? (uint8_t)n : 0;
    gn->state = NEWTON_STEP;
}

void auvid_gauss_newton_add(auvid_gauss_newton_t *gn, auvid_real_t *row)
{
    auvid_real_t e = row[gn->ls.n];
    for (int i = 0; i < gn->ls.n; ++i) {
        e -= row[i] * gn->x[i];
    }
    gn->squares += e * e;
    auvid_bounded_ls_add(&gn->ls, row);
}

void auvid_gauss_newton_step(auvid_gauss_newton_t *gn)
{
    auvid_bounded_ls_t *ls = &gn->ls;
    int n = ls->n;
    if (gn->damped < n) {
        auvid_real_t row[AUVID_MAX_PARAMETERS + 1] = {AUVID_C(0.0)};
        int i = gn->damped++;
        row[i] = auvid_sqrt(gn->damping) * auvid_qr_column_norm(ls->qr_factor, n + 1, i);
        row[n] = row[i] * gn->x[i];
        auvid_bounded_ls_add(ls, row);
    } else if (auvid_bounded_ls_step(ls, AUVID_C(0.0)) != AUVID_PENDING) {
        gn->state = NEWTON_COST;
    }
}

auvid_real_t auvid_gauss_newton_scale(const auvid_gauss_newton_t *gn, int i)
{
    auvid_real_t norm = auvid_qr_column_norm(gn->ls.qr_factor, gn->ls.n + 1, i);
    return norm > AUVID_C(0.0) ? AUVID_C(1.0) / norm : AUVID_C(0.0);
}
