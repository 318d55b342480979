/*
 * Confidence, phase SCATTER: scores and influences, set by set. auvid_confidence.c gives the
 * equations.
 */
#include <string.h>

#include "../base/auvid_linalg_internal.h"
#include "auvid_confidence_notes_internal.h"
#include "auvid_metric_evaluator_internal.h"

typedef auvid_confidence_job_t job_t;

/* Add a row of one band of a set to the scores at both points, and, whitened by w R_j = r, to the
 * sum of w'w. */
void auvid_confidence_take_row(job_t *c, const auvid_set_t *set, int j, int band, int i)
{
    const auvid_metric_t *m = c->metric;
    auvid_equation_t e = auvid_metric_equation(m, j);
    const auvid_real_t *optimum = c->single_dof_optimum + e.at;
    auvid_real_t w[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS] = {AUVID_C(0.0)};
    auvid_real_t dof_residual = AUVID_C(0.0), residual = AUVID_C(0.0),
                 weight = auvid_metric_band_weight(m, band, j);
    bool coupled = auvid_metric_is_coupled(m, j); /* its scores are added when it is complete */
    int first = auvid_metric_read_row(m, set, band, j, i, w);
    for (int k = first; k < e.order; ++k) {
        dof_residual += w[k] * optimum[k];
        residual += w[k] * (k < e.count ? c->pi[e.index[k]] : optimum[k]);
    }
    for (int k = first; k < e.count; ++k) {
        int column = c->column_of[e.index[k]];
        c->score[k] += weight * dof_residual * w[k];
        if (column != NOWHERE && !coupled) {
            c->influence.set[column] += auvid_metric_weight(m, j) * weight * residual * w[k];
        }
    }
    auvid_qr_solve_transposed(e.factor, e.order, e.rows, w);
    for (int a = 0; a < e.rows; ++a) {
        auvid_real_t *to = c->part + auvid_qr_row(e.rows, a);
        for (int b = a; b < e.rows; ++b) {
            to[b - a] += weight * w[a] * w[b];
        }
    }
}

/* Complete DoF j of a set: add g' H^-1 g, and subtract tr (H^-1 H_s)^2 from the degrees of freedom.
 * */
void auvid_confidence_finish_dof(job_t *c, int j)
{
    auvid_equation_t e = auvid_metric_equation(c->metric, j);
    int count = e.rows;
    auvid_qr_solve_transposed(e.factor, e.order, count, c->score);
    if (auvid_metric_is_coupled(c->metric, j)) {
        auvid_confidence_add_scores(c, j);
    }
    for (int a = 0; a < count; ++a) {
        const auvid_real_t *row = c->part + auvid_qr_row(count, a);
        c->spread.scatter[j] += c->score[a] * c->score[a];
        c->spread.degrees_of_freedom[j] += row[0]; /* sums to the rank */
        for (int b = a; b < count; ++b) {
            c->spread.degrees_of_freedom[j] -=
                (b == a ? AUVID_C(1.0) : AUVID_C(2.0)) * row[b - a] * row[b - a];
        }
    }
    memset(c->score, 0, sizeof c->score);
    memset(c->part, 0, sizeof c->part);
}

void auvid_confidence_finish_set(job_t *c)
{
    auvid_qr_solve_transposed(c->joint_factor, c->n, c->n, c->influence.set);
    (void)auvid_qr_solve(c->joint_factor, c->n, c->n, AUVID_C(0.0), c->influence.set);
    for (int i = 0; i < c->n; ++i) {
        c->influence.sum[i] += c->influence.set[i];
        c->influence.squares[i] += c->influence.set[i] * c->influence.set[i];
    }
    memset(c->influence.set, 0, sizeof c->influence.set);
}
