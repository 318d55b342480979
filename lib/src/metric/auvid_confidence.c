/*
 * Confidence: standard errors, bias and notes of an estimate.
 *
 * Per DoF j and set s, with the bands' weights b and the rows R of the sets' triangles,
 *
 *     H_sj = sum_b b R'R,  H_j = sum_s H_sj,  g_sj = sum_b b R'(R pi - z),
 *
 * w_j the weight of the DoF in the cost, H = sum_j w_j H_j, P = H^-1:
 *
 *     sigma_j^2 = ||residual_j||^2 / rows_j                                mean square residual
 *     s_j^2 = (f sigma_j^2 + sum_s g' H_j^-1 g) / (1 + nu_j)               noise that counts
 *     nu_j  = rank_j - sum_s tr (H_j^-1 H_sj)^2                            its degrees of freedom
 *     C     = P (sum_j w_j^2 s_j^2 H_j) P                                  pooled over parameters
 *     psi_s = P sum_j w_j g_sj                                             influence of a set
 *     var_i = m (nu C_ii + S sum_s (psi_si - mean)^2) / (nu + S - 1)       with own scatter, too
 *
 * (in s_j, g is taken at the DoF's own optimum, in psi at the estimate). For white noise the first
 * sum has the expectation nu_j sigma_j^2. f = 2.6 is what the smoothing of the rows makes of it,
 * one observation's worth; nu = 10 and m = 1.3 hold for eight sets and make the coverage right
 * where the disturbance is coloured as slowly as the motion. The noise n of the acceleration of DoF
 * j, a the derivatives of its row by its acceleration, m_j = a pi its mass: the residual has m_j n
 * in it, so
 *
 *     delta = -P sum_j w_j nu_j a / m_j,   nu_j = m_j^2 sum n^2,
 *
 * with nu_j from the high band, in which little else is.
 *
 * Uncertain delay: with the columns D_j = -[Z l', Z (1 -2 1)'] of the delay and of half its second
 * moment in each DoF's rows, the rows diag(n / sigma_d, n / (2 sigma_d^2)) below them, n^2 = f
 * times the mean square that pi and D_j leave, and R~, e~ what D_j leaves of R and of the
 * residual at the estimate,
 *
 *     P~ = (sum_j w_j R~'R~)^-1,  moved = P~ sum_j w_j R~'e~,
 *     var_i <- var_i P~_ii / P_ii + moved_i^2.
 */
#include "auvid/confidence.h"

#include <string.h>

#include "auvid_confidence_internal.h"
#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_internal.h"

#define RIDGE                                                                                      \
    AUVID_C(1e-4)                /* smallest pivot, relative to its column: what the data do not
                                     determine gets an error of 1e4 times the column's own */

typedef auvid_confidence_job_t job_t;

static const auvid_real_t *merged(const job_t *c, int j)
{
    return c->metric->merged + c->metric->factor_at[j];
}

/* Weights of the wrench at DoF j's delay, or their derivatives. */
static void delay_weights(const job_t *c, int j, bool slopes, auvid_real_t l[AUVID_METRIC_DELAYS])
{
    const auvid_metric_t *m = c->metric;
    auvid_real_t s = m->delay_s[j] / auvid_metric_node_s(m);
    bool lag = (m->lagged >> j & 1) != 0;
    (slopes ? auvid_metric_delay_slopes : auvid_metric_delay_weights)(s, lag, l);
}

/* ---- OWN: a DoF's optimum and mean square residual ---- */

void auvid_confidence_find_own(job_t *c, int j)
{
    const auvid_metric_t *m = c->metric;
    int n = auvid_metric_order(m, j), count = m->count[j], at = m->channel_at[j];
    auvid_real_t l[AUVID_METRIC_DELAYS], excess = AUVID_C(0.0);
    auvid_real_t s = m->delay_s[j] / auvid_metric_node_s(m);
    bool linear = auvid_metric_has_regressor(m);
    uint32_t lost = 0, all = 0;
    c->rows[j] = (auvid_real_t)m->dof_rows[j]; /* of the sets merged, some of which may be gone */
    for (int age = 0; age < auvid_metric_sets(m); ++age) {
        const auvid_set_t *set = &m->set[auvid_metric_slot(m, age)];
        uint32_t rows = (set->driven >> j & 1) == 0 ? 0u : set->rows_of[j];
        if (rows > 0) {
            c->rows[j] -= linear ? AUVID_C(0.0) : (auvid_real_t)(rows - set->windows[j]);
            lost += (uint32_t)set->lost + set->rows - rows;
            all += (uint32_t)set->lost + set->rows;
        }
    }
    c->result.lost[j] = (uint8_t)(all > 0 ? 100u * lost / all : 0u);
    for (int i = 0; i < count; ++i) {
        const auvid_real_t *r = merged(c, j) + auvid_triangle_row(n, i);
        auvid_real_t e = -m->z[at + i];
        for (int k = i; k < count; ++k) {
            e += r[k - i] * c->pi[m->index[at + k]];
        }
        excess += e * e;
        c->own[at + i] = m->z[at + i];
    }
    (void)auvid_triangle_solve(merged(c, j), n, count, AUVID_C(1e-4), c->own + at);
    delay_weights(c, j, false, l);
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        c->own[at + count + d] = -l[d];
    }
    auvid_real_t squares = excess + auvid_metric_unexplained(m, j, s, (m->lagged >> j & 1) != 0);
    c->result.residual[j] =
        c->rows[j] > AUVID_C(0.0) ? auvid_sqrt(squares / c->rows[j]) : AUVID_C(0.0);
}

/* ---- ROTATE: the DoF's rows into the joint triangle ---- */

/* Columns of DoF j's delay in `part`. */
static int delay_columns(const job_t *c, int j)
{
    return confidence_is_considered(c, j) ? 2 : 1;
}

/* The priors of DoF j's delay and of half its second moment, as rows: 1 / sigma times the noise,
 * that of what neither parameters nor delay explain. */
static void add_priors(job_t *c, int j, int order)
{
    auvid_real_t sigma = c->result.uncertainty.delay_s / auvid_metric_node_s(c->metric);
    auvid_real_t left = c->part[AUVID_TRIANGLE(order) - 1];
    auvid_real_t noise = auvid_sqrt(CONFIDENCE_SMOOTHED * left * left / c->rows[j]);
    auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS] = {AUVID_C(0.0)};
    row[0] = noise / sigma;
    auvid_triangle_add(c->part, order, 0, row);
    memset(row, 0, sizeof row);
    row[1] = noise / (AUVID_C(2.0) * sigma * sigma);
    auvid_triangle_add(c->part, order, 1, row);
}

/* DoF j's triangle with its delay as the first column, so that the rows below the first are what is
 * left for the parameters. Into part, order count + 1. Where the delay is uncertain: the delay,
 * half its second moment, the parameters, the residual at the estimate. */
static void border(job_t *c, int j)
{
    const auvid_metric_t *m = c->metric;
    int n = auvid_metric_order(m, j), count = m->count[j], at = m->channel_at[j];
    int first = delay_columns(c, j), order = first == 1 ? count + 1 : count + 3;
    auvid_real_t slope[AUVID_METRIC_DELAYS], l[AUVID_METRIC_DELAYS];
    static const auvid_real_t bend[AUVID_METRIC_DELAYS] = {AUVID_C(1.0), AUVID_C(-2.0),
                                                           AUVID_C(1.0)};
    delay_weights(c, j, true, slope);
    delay_weights(c, j, false, l);
    memset(c->part, 0, sizeof c->part);
    for (int i = 0; i < n; ++i) {
        const auvid_real_t *r = merged(c, j) + auvid_triangle_row(n, i);
        auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS] = {AUVID_C(0.0)};
        auvid_real_t residual = AUVID_C(0.0), second = AUVID_C(0.0);
        for (int k = i; k < count && k < AUVID_MAX_PARAMETERS; ++k) {
            row[k + first] = r[k - i];
            residual -= r[k - i] * c->pi[m->index[at + k]];
        }
        for (int d = i < count ? 0 : i - count; d < AUVID_METRIC_DELAYS; ++d) {
            row[0] -= r[count + d - i] * slope[d];
            second -= r[count + d - i] * bend[d];
            residual += r[count + d - i] * l[d];
        }
        if (first == 2) {
            row[1] = second;
            row[order - 1] = residual;
        }
        auvid_triangle_add(c->part, order, 0, row);
    }
    if (first == 2) {
        add_priors(c, j, order);
    }
}

/* Row i of DoF j's triangle into the joint one. */
void auvid_confidence_rotate(job_t *c, int j, int i)
{
    const auvid_metric_t *m = c->metric;
    auvid_real_t row[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)}, residual = AUVID_C(0.0);
    auvid_real_t scale = auvid_sqrt(m->weight[j]);
    int count = m->count[j], first = delay_columns(c, j);
    const auvid_real_t *r = merged(c, j) + auvid_triangle_row(auvid_metric_order(m, j), i);
    if (c->delayed && (confidence_is_considered(c, j) || confidence_is_estimated(c, j))) {
        if (i == 0) {
            border(c, j);
        }
        r = c->part + auvid_triangle_row(first == 1 ? count + 1 : count + 3, i + first);
        residual = first == 1 ? AUVID_C(0.0) : scale * r[count - i];
    }
    for (int k = i; k < count; ++k) {
        int place = c->place[m->index[m->channel_at[j] + k]];
        if (place != NOWHERE) {
            row[place] += scale * r[k - i];
            c->influence[place] += scale * r[k - i] * residual;
        }
    }
    auvid_triangle_add(c->joint, c->n, 0, row);
}

/* ---- BOUND: a smallest pivot for column i; INVERT: (J'J)^-1_ii ---- */

void auvid_confidence_bound_pivot(job_t *c, int i)
{
    auvid_real_t row[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)};
    row[i] = RIDGE * auvid_triangle_norm(c->joint, c->n, i);
    auvid_triangle_add(c->joint, c->n, i, row);
}

void auvid_confidence_invert(job_t *c, int i)
{
    auvid_real_t y[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)}, squares = AUVID_C(0.0);
    if (c->delayed && i == 0) {
        auvid_triangle_solve_left(c->joint, c->n, c->n, c->influence);
    }
    y[i] = AUVID_C(1.0);
    auvid_triangle_solve_left(c->joint, c->n, c->n, y);
    for (int k = i; k < c->n; ++k) {
        squares += y[k] * y[k];
    }
    if (c->delayed) {
        for (int k = i; k < c->n; ++k) {
            c->moved[i] += y[k] * c->influence[k];
        }
        c->widening[i] = squares;
        return;
    }
    c->variance[i] = squares;
    c->widening[i] = c->widening[i] > squares ? c->widening[i] / squares : AUVID_C(1.0);
}

/* ---- SCATTER: scores and influences, set by set ---- */

/* A row of one band of a set: into the scores at both points, and whitened, w R_j = r, into the
 * sum of w'w. */
void auvid_confidence_take_row(job_t *c, const auvid_set_t *set, int j, int band, int i)
{
    const auvid_metric_t *m = c->metric;
    int n = auvid_metric_order(m, j), count = m->count[j], at = m->channel_at[j];
    auvid_real_t w[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS] = {AUVID_C(0.0)};
    auvid_real_t own = AUVID_C(0.0), joint = AUVID_C(0.0), weight = m->band_weight[band][j];
    auvid_metric_unpack_row(m, set, band, j, i, w);
    for (int k = i; k < n; ++k) {
        own += w[k] * c->own[at + k];
        joint += w[k] * (k < count ? c->pi[m->index[at + k]] : c->own[at + k]);
    }
    for (int k = i; k < count; ++k) {
        int place = c->place[m->index[at + k]];
        c->score[k] += weight * own * w[k];
        if (place != NOWHERE) {
            c->influence[place] += m->weight[j] * weight * joint * w[k];
        }
    }
    auvid_triangle_solve_left(merged(c, j), n, count, w);
    for (int a = 0; a < count; ++a) {
        auvid_real_t *to = c->part + auvid_triangle_row(count, a);
        for (int b = a; b < count; ++b) {
            to[b - a] += weight * w[a] * w[b];
        }
    }
}

/* DoF j of a set is complete: sum g' H^-1 g, and the loss of freedom tr (H^-1 H_s)^2. */
void auvid_confidence_finish_dof(job_t *c, int j)
{
    const auvid_metric_t *m = c->metric;
    int count = m->count[j];
    auvid_triangle_solve_left(merged(c, j), auvid_metric_order(m, j), count, c->score);
    for (int a = 0; a < count; ++a) {
        const auvid_real_t *row = c->part + auvid_triangle_row(count, a);
        c->scatter[j] += c->score[a] * c->score[a];
        c->freedom[j] += row[0]; /* sums to the rank */
        for (int b = a; b < count; ++b) {
            c->freedom[j] -= (b == a ? AUVID_C(1.0) : AUVID_C(2.0)) * row[b - a] * row[b - a];
        }
    }
    memset(c->score, 0, sizeof c->score);
    memset(c->part, 0, sizeof c->part);
}

void auvid_confidence_finish_set(job_t *c)
{
    auvid_triangle_solve_left(c->joint, c->n, c->n, c->influence);
    (void)auvid_triangle_solve(c->joint, c->n, c->n, AUVID_C(0.0), c->influence);
    for (int i = 0; i < c->n; ++i) {
        c->sum[i] += c->influence[i];
        c->squares[i] += c->influence[i] * c->influence[i];
    }
    memset(c->influence, 0, sizeof c->influence);
}
