/*
 * Confidence: standard errors, bias and notes of an estimate.
 *
 * Per DoF j and set s, with the bands' weights b and the rows R of the sets' R factors,
 *
 *     H_sj = sum_b b R'R,  H_j = sum_s H_sj,  g_sj = sum_b b R'(R pi - z).
 *
 * With w_j the weight of the DoF in the cost, H = sum_j w_j H_j and P = H^-1:
 *
 *     sigma_j^2 = ||residual_j||^2 / rows_j                                mean square residual
 *     s_j^2 = (f sigma_j^2 + sum_s g' H_j^-1 g) / (1 + nu_j)               effective noise
 *     nu_j  = rank_j - sum_s tr (H_j^-1 H_sj)^2                            its degrees of freedom
 *     C     = P (sum_j w_j^2 s_j^2 H_j) P                                  pooled over parameters
 *     psi_s = P sum_j w_j g_sj                                             influence of a set
 *     var_i = m (nu C_ii + S sum_s (psi_si - mean)^2) / (nu + S - 1)       with i's scatter
 *
 * (s_j takes g at the optimum of the DoF's equation, psi takes it at the estimate.) For white noise
 * the first sum has the expectation nu_j sigma_j^2. f = 2.6 is what the smoothing of the rows makes
 * of it, and counts as one observation. nu = 10 and m = 1.3 hold for eight sets. They make the
 * coverage right where the disturbance is as slow as the motion.
 *
 * Bias: n is the noise of the acceleration of DoF j, a the derivatives of its row by its
 * acceleration, and m_j = a pi its mass. The residual contains m_j n, so
 *
 *     delta = -P sum_j w_j nu_j a / m_j,   nu_j = m_j^2 sum n^2.
 *
 * The high band gives nu_j, because it contains little else.
 *
 * Uncertain delay: D_j = -[Z l', Z (1 -2 1)'] are the columns of the delay and of half its second
 * moment in each DoF's rows. Below them stand the rows diag(n / sigma_d, n / (2 sigma_d^2)), n^2 =
 * f times the mean square that pi and D_j leave. R~ and e~ are what D_j leaves of R and of the
 * residual at the estimate:
 *
 *     P~ = (sum_j w_j R~'R~)^-1,  step = P~ sum_j w_j R~'e~,
 *     var_i <- var_i P~_ii / P_ii + step_i^2.
 */
#include "auvid/detail/confidence.h"

#include <string.h>

#include "auvid_confidence_notes_internal.h"
#include "auvid_metric_feedback_internal.h"
#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_evaluator_internal.h"

#define RIDGE                                                                                      \
    AUVID_C(1e-4)          /* smallest pivot, relative to its column: a parameter that the data do
                                     not determine gets an error of 1e4 times the column's */
#define NEAR AUVID_C(1e-3) /* distance to a bound, relative to that of the two bounds */

typedef auvid_confidence_job_t job_t;

static bool confidence_is_informative(const job_t *c, int j)
{
    return auvid_metric_is_informative(c->metric, j) &&
           auvid_metric_equation(c->metric, j).count > 0;
}

/* Compute the weights of the wrench at DoF j's delay, or their derivatives. */
static void confidence_delay_weights(const job_t *c, int j, bool slopes,
                                     auvid_real_t l[AUVID_METRIC_DELAYS])
{
    bool lag;
    auvid_real_t s = auvid_metric_delay(c->metric, j, &lag);
    (slopes ? auvid_metric_delay_slopes : auvid_metric_delay_weights)(s, lag, l);
}

/* ---- OPTIMUM: the optimum and the mean square residual of a DoF's equation ---- */

/* Count the rows of DoF j in the merged sets, and of those in the ring the part lost to gaps. */
static void confidence_count_rows(job_t *c, int j)
{
    const auvid_metric_t *m = c->metric;
    bool stored = auvid_metric_stores_rows(m);
    uint32_t lost = 0, all = 0;
    c->spread.rows[j] = (auvid_real_t)m->result.dof_rows[j]; /* some sets may have left the ring */
    for (int age = 0; age < auvid_metric_sets(m); ++age) {
        const auvid_set_t *set = auvid_metric_set(m, age);
        uint32_t rows = auvid_metric_set_counts(m, set, j) ? set->rows_of[j] : 0u;
        if (rows > 0) {
            c->spread.rows[j] -= stored ? (auvid_real_t)(rows - set->windows[j]) : AUVID_C(0.0);
            lost += (uint32_t)set->lost + set->rows - rows;
            all += (uint32_t)set->lost + set->rows;
        }
    }
    c->result.lost[j] = (uint8_t)(all > 0 ? 100u * lost / all : 0u);
}

static void confidence_find_single_dof_optimum(job_t *c, int j)
{
    auvid_equation_t equation = auvid_metric_equation(c->metric, j);
    auvid_real_t *optimum = c->single_dof_optimum + equation.at;
    auvid_real_t l[AUVID_METRIC_DELAYS], excess = AUVID_C(0.0);
    confidence_count_rows(c, j);
    for (int i = 0; i < equation.count; ++i) {
        const auvid_real_t *r = auvid_equation_row(&equation, i);
        auvid_real_t e = -equation.z[i];
        for (int k = i; k < equation.count; ++k) {
            e += r[k - i] * c->pi[equation.index[k]];
        }
        excess += e * e;
        optimum[i] = equation.z[i];
    }
    (void)auvid_qr_solve(equation.factor, equation.order, equation.count, AUVID_C(1e-4), optimum);
    for (int i = 0; i < equation.count && auvid_metric_is_coupled(c->metric, j); ++i) {
        optimum[i] = c->pi[equation.index[i]]; /* of its own terms, given the others */
    }
    confidence_delay_weights(c, j, false, l);
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        optimum[equation.count + d] = -l[d];
    }
    auvid_real_t squares = excess + auvid_metric_unexplained(c->metric, j);
    c->result.residual_rms[j] =
        c->spread.rows[j] > AUVID_C(0.0) ? auvid_sqrt(squares / c->spread.rows[j]) : AUVID_C(0.0);
}

/* ---- ROTATE: the DoF's rows into the joint R factor ---- */

/* Returns true if the uncertainty of DoF j's delay, and of its shape, is considered. */
static bool confidence_delay_is_uncertain(const job_t *c, int j)
{
    const auvid_metric_t *m = c->metric;
    return auvid_metric_is_excited(m, j) && confidence_is_informative(c, j) &&
           c->result.uncertainty.delay_s > AUVID_C(0.0) &&
           (!auvid_metric_stores_rows(m) || m->cfg.estimate_delay);
}

/* Returns true if DoF j's delay was estimated. */
static bool confidence_delay_is_estimated(const job_t *c, int j)
{
    const auvid_metric_t *m = c->metric;
    return confidence_is_informative(c, j) && m->cfg.estimate_delay &&
           auvid_abs(m->result.delay_s[j]) > AUVID_C(0.0);
}

/* Number of columns of DoF j's delay in `part`. */
static int confidence_delay_columns(const job_t *c, int j)
{
    return confidence_delay_is_uncertain(c, j) ? 2 : 1;
}

/* Add the priors of DoF j's delay and of half its second moment as rows: 1 / sigma times the noise
 * that neither parameters nor delay explain. */
static void confidence_add_delay_priors(job_t *c, int j, int order)
{
    auvid_real_t sigma = c->result.uncertainty.delay_s / auvid_metric_node_s(c->metric);
    auvid_real_t unexplained = c->part[AUVID_QR_FACTOR(order) - 1];
    auvid_real_t noise =
        auvid_sqrt(AUVID_CONFIDENCE_SMOOTHED * unexplained * unexplained / c->spread.rows[j]);
    auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS] = {AUVID_C(0.0)};
    row[0] = noise / sigma;
    auvid_qr_update(c->part, order, 0, row);
    memset(row, 0, sizeof row);
    row[1] = noise / (AUVID_C(2.0) * sigma * sigma);
    auvid_qr_update(c->part, order, 1, row);
}

/* Write DoF j's R factor with its delay as the first column to part, order count + 1. The rows
 * below the first are what the delay leaves for the parameters. If the delay is uncertain, the
 * columns are the delay, half its second moment, the parameters, and the residual at the estimate.
 * */
static void confidence_border_factor(job_t *c, int j)
{
    auvid_equation_t e = auvid_metric_equation(c->metric, j);
    int count = e.count, first = confidence_delay_columns(c, j);
    int order = first == 1 ? count + 1 : count + 3;
    auvid_real_t slope[AUVID_METRIC_DELAYS], l[AUVID_METRIC_DELAYS];
    static const auvid_real_t bend[AUVID_METRIC_DELAYS] = {AUVID_C(1.0), AUVID_C(-2.0),
                                                           AUVID_C(1.0)};
    confidence_delay_weights(c, j, true, slope);
    confidence_delay_weights(c, j, false, l);
    memset(c->part, 0, sizeof c->part);
    for (int i = 0; i < e.order; ++i) {
        const auvid_real_t *r = auvid_equation_row(&e, i);
        auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS] = {AUVID_C(0.0)};
        auvid_real_t residual = AUVID_C(0.0), second = AUVID_C(0.0);
        for (int k = i; k < count && k < AUVID_MAX_PARAMETERS; ++k) {
            row[k + first] = r[k - i];
            residual -= r[k - i] * c->pi[e.index[k]];
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
        auvid_qr_update(c->part, order, 0, row);
    }
    if (first == 2) {
        confidence_add_delay_priors(c, j, order);
    }
}

/* Rotate row i of DoF j's R factor into the joint one. */
static void confidence_rotate_row(job_t *c, int j, int i)
{
    auvid_equation_t e = auvid_metric_equation(c->metric, j);
    auvid_real_t row[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)}, residual = AUVID_C(0.0);
    auvid_real_t scale = auvid_sqrt(auvid_metric_weight(c->metric, j));
    int count = e.count, first = confidence_delay_columns(c, j);
    const auvid_real_t *r = auvid_equation_row(&e, i);
    if (c->delayed &&
        (confidence_delay_is_uncertain(c, j) || confidence_delay_is_estimated(c, j))) {
        if (i == 0) {
            confidence_border_factor(c, j);
        }
        r = c->part + auvid_qr_row(first == 1 ? count + 1 : count + 3, i + first);
        residual = first == 1 ? AUVID_C(0.0) : scale * r[count - i];
    }
    for (int k = i; k < count; ++k) {
        int column = c->column_of[e.index[k]];
        if (column != NOWHERE) {
            row[column] += scale * r[k - i];
            c->influence.set[column] += scale * r[k - i] * residual;
        }
    }
    auvid_qr_update(c->joint_factor, c->n, 0, row);
}

/* ---- BOUND: add the smallest pivot to column i; INVERT: (J'J)^-1_ii ---- */

static void confidence_bound_pivot(job_t *c, int i)
{
    auvid_real_t row[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)};
    row[i] = RIDGE * auvid_qr_column_norm(c->joint_factor, c->n, i);
    auvid_qr_update(c->joint_factor, c->n, i, row);
}

static void confidence_invert_column(job_t *c, int i)
{
    auvid_real_t y[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)}, squares = AUVID_C(0.0);
    if (c->delayed && i == 0) {
        auvid_qr_solve_transposed(c->joint_factor, c->n, c->n, c->influence.set);
    }
    y[i] = AUVID_C(1.0);
    auvid_qr_solve_transposed(c->joint_factor, c->n, c->n, y);
    for (int k = i; k < c->n; ++k) {
        squares += y[k] * y[k];
    }
    if (c->delayed) {
        for (int k = i; k < c->n; ++k) {
            c->delay_step[i] += y[k] * c->influence.set[k];
        }
        c->widening[i] = squares;
        return;
    }
    c->variance[i] = squares; /* 0: it is not known (auvid_confidence_judge.c) */
    bool widens = squares > AUVID_C(0.0) && c->widening[i] > squares;
    c->widening[i] = widens ? c->widening[i] / squares : AUVID_C(1.0);
}

/* ---- BIAS ---- */

/* After the last set: compute s_j^2, and add DoF j's part of the right-hand side of the bias to
 * influence. */
static void confidence_find_noise(job_t *c, int j)
{
    auvid_real_t residual = c->result.residual_rms[j];
    bool scatters = c->spread.degrees_of_freedom[j] > AUVID_C(1e-4);
    auvid_real_t scatter = scatters ? c->spread.scatter[j] : AUVID_C(0.0);
    auvid_real_t nu = scatters ? c->spread.degrees_of_freedom[j] : AUVID_C(0.0);
    c->result.effective_noise[j] = auvid_sqrt(
        (AUVID_CONFIDENCE_SMOOTHED * residual * residual + scatter) / (AUVID_C(1.0) + nu));
    auvid_confidence_bias(c, j);
}

/* ---- the phases ---- */

/* Go to the first informative equation from j on. @return true if there is one */
static bool confidence_seek_dof(job_t *c, int j)
{
    while (j < AUVID_DOF_COUNT && !confidence_is_informative(c, j)) {
        ++j;
    }
    c->at.dof = (uint8_t)j;
    return j < AUVID_DOF_COUNT;
}

/* Do one step of the present phase. */
static void confidence_step(job_t *c)
{
    int j = c->at.dof, i = c->at.row,
        n = j < AUVID_DOF_COUNT ? auvid_metric_order(c->metric, j) : 1;
    const auvid_set_t *set = auvid_metric_set(c->metric, c->at.set);
    switch (c->phase) {
    case OPTIMUM:
        confidence_find_single_dof_optimum(c, j);
        break;
    case ROTATE:
        confidence_rotate_row(c, j, i);
        break;
    case BOUND:
        confidence_bound_pivot(c, i);
        break;
    case INVERT:
        confidence_invert_column(c, i);
        break;
    case SCATTER:
        if (i == AUVID_METRIC_BANDS * n) {
            auvid_confidence_finish_dof(c, j);
        } else if (c->at.set < auvid_metric_sets(c->metric) &&
                   auvid_metric_set_counts(c->metric, set, j)) {
            auvid_confidence_take_row(c, set, j, i / n, i % n);
        }
        break;
    case BIAS:
        confidence_find_noise(c, j);
        break;
    case JUDGE:
        auvid_confidence_judge(c, i);
        break;
    default:
        auvid_confidence_scale(c, i);
        if (i == c->n - 1) {
            uint32_t dofs = 0;
            for (j = 0; j < AUVID_DOF_COUNT; ++j) {
                dofs |= (uint32_t)confidence_is_informative(c, j) << j;
            }
            auvid_confidence_discredit(c, dofs);
            auvid_confidence_close_loop(c, c->metric, auvid_metric_feedback_dofs(c->metric), 0);
        }
        break;
    }
}

/* Returns the number of steps of the present DoF, or of a phase without DoF. */
static int confidence_steps(const job_t *c)
{
    switch (c->phase) {
    case OPTIMUM:
    case BIAS:
        return 1;
    case ROTATE:
        return auvid_metric_equation(c->metric, c->at.dof).rows;
    case SCATTER:
        return AUVID_METRIC_BANDS * auvid_metric_order(c->metric, c->at.dof) + 1;
    default:
        return c->n;
    }
}

static void confidence_end_phase(job_t *c)
{
    if (c->phase == INVERT && c->delayed) {
        c->delayed = false; /* once more, with the delays given */
        auvid_zero(c->joint_factor, sizeof c->joint_factor);
        memset(c->influence.set, 0, sizeof c->influence.set);
        c->phase = ROTATE;
    } else {
        ++c->phase;
    }
    if (c->phase <= JUDGE) { /* from then on it contains the covariance */
        memset(c->part, 0, sizeof c->part);
    }
    (void)confidence_seek_dof(c, 0);
}

/* Returns the cost of the next step in addition to that of its phase. */
static int confidence_border_cost(const job_t *c)
{
    bool due = c->phase == ROTATE && c->delayed && c->at.row == 0;
    return due ? AUVID_METRIC_ROTATION * (auvid_metric_order(c->metric, c->at.dof) + 2) : 0;
}

/* Advance to the next step. */
static void confidence_next_step(job_t *c)
{
    bool by_dof = c->phase != BOUND && c->phase != INVERT && c->phase < JUDGE;
    if (++c->at.row < confidence_steps(c)) {
        return;
    }
    c->at.row = 0;
    if (by_dof && confidence_seek_dof(c, c->at.dof + 1)) {
        return;
    }
    if (c->phase == SCATTER) {
        auvid_confidence_finish_set(c);
        if (++c->at.set < auvid_metric_sets(c->metric)) {
            (void)confidence_seek_dof(c, 0);
            return;
        }
        c->at.set = 0;
    }
    confidence_end_phase(c);
}

void auvid_confidence_begin(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                            const auvid_real_t *pi, auvid_real_t dry_mass_kg,
                            const auvid_uncertainty_t *uncertainty)
{
    if (job == NULL || metric == NULL || pi == NULL) {
        return;
    }
    job_t *c = job;
    auvid_zero(c, sizeof *c);
    c->metric = metric; /* for this call only: a job may be copied */
    c->dry_mass_kg = dry_mass_kg;
    if (uncertainty != NULL) {
        c->result.uncertainty = *uncertainty;
    }
    uint32_t searched = auvid_metric_searched(metric); /* in the residual path the active ones */
    for (int i = 0; i < metric->cfg.vehicle->parameters; ++i) {
        c->pi[i] = pi[i];
        c->widening[i] = AUVID_C(1.0);
        c->column_of[i] = NOWHERE;
        if (searched >> i & 1u) {
            c->parameter_of[c->n] = (uint8_t)i;
            c->column_of[i] = c->n++;
        }
    }
    for (int age = 0; age < auvid_metric_sets(metric); ++age) {
        bool excited = auvid_metric_set(metric, age)->excited != 0;
        c->result.sets = (uint8_t)(c->result.sets + excited);
    }
    /* estimated or uncertain delays: a first run of ROTATE to INVERT computes the widening, a
     * second one the plain R factor */
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        c->delayed = c->delayed || confidence_delay_is_uncertain(c, j) ||
                     confidence_delay_is_estimated(c, j);
    }
    for (int i = 0; i < metric->cfg.vehicle->parameters; ++i) {
        auvid_confidence_note_idle(c, i);
    }
    (void)confidence_seek_dof(c, 0);
    c->metric = NULL;
}

void auvid_confidence_limits(auvid_confidence_job_t *job, const auvid_real_t *lower,
                             const auvid_real_t *upper, bool not_converged)
{
    if (job == NULL || lower == NULL || upper == NULL) {
        return;
    }
    for (int k = 0; k < job->n; ++k) {
        int p = job->parameter_of[k];
        bool high = job->pi[p] - lower[p] > upper[p] - job->pi[p];
        auvid_real_t bound = high ? upper[p] : lower[p];
        if (auvid_abs(job->pi[p] - bound) < NEAR * (upper[p] - lower[p])) {
            job->at_bound |= 1u << p;
            if (job->result.note[p] != AUVID_NOTE_NOT_EXCITED) {
                job->result.partner[p] = high;
                job->result.bound[p] = bound;
            }
        }
    }
    job->not_converged = not_converged;
}

auvid_status_t auvid_confidence_work(auvid_confidence_job_t *job, const auvid_metric_t *metric,
                                     uint32_t *budget)
{
    static const uint8_t cost[] = {
        [OPTIMUM] = 16, [ROTATE] = 8, [BOUND] = 8,  [INVERT] = 6,
        [SCATTER] = 10, [BIAS] = 45,  [JUDGE] = 80, [CONCLUDE] = 12}; /* [units] */
    if (job == NULL || metric == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    job->metric = metric;
    while (job->phase != DONE && *budget > 0) {
        --*budget;
        if (++job->spent < cost[job->phase] + confidence_border_cost(job)) {
            continue;
        }
        job->spent = 0;
        confidence_step(job);
        confidence_next_step(job);
    }
    job->metric = NULL;
    return job->phase == DONE ? AUVID_OK : AUVID_PENDING;
}
