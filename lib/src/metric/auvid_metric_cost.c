/*
 * Metric, evaluation (Karras et al. 2013, Eq. 10-11): cost and residuals of a candidate.
 */
#include "auvid_metric_evaluator_internal.h"

#include <string.h>

extern auvid_equation_t auvid_metric_equation(const auvid_metric_t *m, int j);
extern bool auvid_metric_set_counts(const auvid_metric_t *m, const auvid_set_t *set, int j);
extern auvid_real_t auvid_metric_node_s(const auvid_metric_t *m);

auvid_real_t auvid_metric_longest_delay(const auvid_metric_t *metric)
{
    return metric == NULL ? AUVID_C(0.0)
                          : auvid_metric_node_s(metric) * (auvid_real_t)(AUVID_METRIC_DELAYS - 1);
}

/* Set pi and the common delay as the candidate of the next evaluation. */
static void metric_take_candidate(auvid_metric_t *m, const auvid_real_t *pi, auvid_real_t delay_s)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    if (auvid_metric_stores_rows(m)) {
        auvid_metric_path(m)->begin(m, pi, delay_s);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        for (int k = 0; k < e.count; ++k) {
            ev->candidate[e.at + k] = pi[m->layout.index[e.at + k]];
        }
    }
    ev->at.set = ev->at.dof = 0;
    ev->at.row = 0;
    ev->window_rows = 0;
    memset(ev->window_of, 0, sizeof ev->window_of);
    ev->sum = ev->compensation = ev->squares = AUVID_C(0.0);
}

void auvid_metric_cost_begin(auvid_metric_t *metric, const auvid_real_t *pi, auvid_real_t delay_s)
{
    if (metric != NULL && pi != NULL) {
        metric->evaluator.at.pass = PASS_COST;
        metric_take_candidate(metric, pi, delay_s);
    }
}

auvid_status_t auvid_metric_cost(auvid_metric_t *metric, uint32_t *budget)
{
    if (metric == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    return auvid_metric_path(metric)->evaluate(metric, budget);
}

void auvid_metric_measure_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                auvid_real_t delay_s)
{
    if (metric != NULL && pi != NULL) {
        auvid_metric_restart_pass(metric, PASS_MEASURE);
        metric_take_candidate(metric, pi, delay_s);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            auvid_equation_t e = auvid_metric_equation(metric, j);
            auvid_real_t l[AUVID_METRIC_DELAYS];
            bool lag;
            auvid_real_t delay = auvid_metric_delay(metric, j, &lag);
            auvid_metric_delay_weights(delay, lag, l);
            for (int d = 0; d < AUVID_METRIC_DELAYS && e.order > 0; ++d) {
                metric->evaluator.candidate[e.at + e.count + d] = -l[d];
            }
        }
    }
}

void auvid_metric_predict_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                auvid_real_t delay_s)
{
    if (metric != NULL && pi != NULL) {
        auvid_metric_measure_begin(metric, pi, delay_s);
        auvid_metric_cursor_t *at = &metric->evaluator.at;
        int oldest = auvid_metric_sets(metric) - 1;
        at->to_set = 1; /* regressor path by age, residual path from the oldest set on */
        at->set = auvid_metric_stores_rows(metric) ? (uint8_t)oldest : 0;
    }
}

auvid_status_t auvid_metric_measure(auvid_metric_t *metric, uint32_t *budget)
{
    if (metric == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_metric_t *m = metric;
    if (auvid_metric_path(m)->evaluate(m, budget) != AUVID_OK) {
        return AUVID_PENDING;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        m->result.sse[j] = m->evaluator.band_sse[0][j] + m->evaluator.band_sse[1][j];
    }
    return AUVID_OK;
}

auvid_real_t auvid_metric_predicted(const auvid_metric_t *metric, int j)
{
    const auvid_metric_evaluator_t *ev = &metric->evaluator;
    return ev->band_weight[0][j] * ev->band_sse[0][j] + ev->band_weight[1][j] * ev->band_sse[1][j];
}

void auvid_metric_linearise_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                  auvid_real_t delay_s, uint8_t sets)
{
    auvid_metric_t *m = metric;
    if (m == NULL || pi == NULL || !auvid_metric_stores_rows(m)) {
        return;
    }
    auvid_metric_restart_pass(m, PASS_LINEAR);
    metric_take_candidate(m, pi, delay_s);
    m->evaluator.linear_delay_s = delay_s;
    m->evaluator.at.to_set = sets < m->cfg.sets ? sets : m->cfg.sets;
}

auvid_status_t auvid_metric_linearise(auvid_metric_t *metric, auvid_metric_windows_t *windows,
                                      uint32_t *budget)
{
    if (metric == NULL || windows == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    return auvid_metric_stores_rows(metric)
               ? auvid_metric_path(metric)->linearise(metric, windows, budget)
               : AUVID_OK;
}

uint32_t auvid_metric_active(const auvid_metric_t *metric)
{
    return metric == NULL ? 0 : auvid_metric_free_of(metric, metric->result.excited);
}

uint32_t auvid_metric_searched(const auvid_metric_t *metric)
{
    const auvid_metric_t *m = metric;
    uint32_t searched = auvid_metric_active(m);
    auvid_real_t scale[AUVID_MAX_PARAMETERS];
    if (searched == 0) {
        return 0;
    }
    auvid_metric_scale(m, scale);
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        bool free = m->cfg.free == 0 || (m->cfg.free >> i & 1u) != 0;
        bool known = m->cfg.fixed[i] < AUVID_C(0.0) || m->cfg.fixed[i] > AUVID_C(0.0);
        searched |= (uint32_t)(free && !known && scale[i] > AUVID_C(0.0)) << i;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        for (int k = 0; k < e.rows && auvid_metric_is_coupled(m, j); ++k) {
            searched |= 1u << e.index[k];
        }
    }
    return searched;
}

void auvid_metric_scale(const auvid_metric_t *metric, auvid_real_t *scale)
{
    const auvid_metric_t *m = metric;
    auvid_real_t square[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)};
    if (m == NULL || scale == NULL) {
        return;
    }
    for (int j = 0; j < AUVID_DOF_COUNT && !auvid_metric_stores_rows(m); ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        const auvid_real_t *r = e.factor; /* row i */
        for (int i = 0; i < e.count && auvid_metric_is_excited(m, j); r += e.order - i++) {
            for (int k = i; k < e.count; ++k) {
                square[e.index[k]] += m->evaluator.weight[j] * r[k - i] * r[k - i];
            }
        }
    }
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        scale[i] = square[i] > AUVID_C(0.0) ? AUVID_C(1.0) / auvid_sqrt(square[i]) : AUVID_C(0.0);
    }
}

auvid_real_t auvid_metric_force_squares(const auvid_metric_t *m, int j, auvid_real_t *rows)
{
    *rows = (auvid_real_t)m->result.dof_rows[j];
    return auvid_metric_is_coupled(m, j) ? m->evaluator.coupled_squares[j]
                                         : auvid_metric_wrench_squares(m, j, rows);
}

void auvid_metric_r2(const auvid_metric_t *metric, auvid_real_t *r2)
{
    for (int j = 0; j < AUVID_DOF_COUNT && metric != NULL && r2 != NULL; ++j) {
        auvid_real_t rows, total = auvid_metric_force_squares(metric, j, &rows);
        r2[j] = auvid_r2(metric->result.sse[j], total);
    }
}

bool auvid_metric_joint_row(const auvid_metric_t *m, int j, int i, uint32_t active,
                            const auvid_real_t *pi, auvid_real_t *row)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    if (i >= e.count || !auvid_metric_is_excited(m, j)) {
        return false;
    }
    int8_t column[AUVID_MAX_PARAMETERS] = {0}, n = 0;
    for (int p = 0; p < m->cfg.vehicle->parameters; ++p) {
        row[p] = AUVID_C(0.0);
        column[p] = (active >> p & 1u) ? n++ : -1;
    }
    const auvid_real_t *r = e.factor + auvid_qr_row(e.order, i);
    auvid_real_t scale = auvid_sqrt(m->evaluator.weight[j]);
    row[n] = scale * e.z[i];
    for (int k = i; k < e.count; ++k, ++r) {
        int p = e.index[k];
        if (column[p] >= 0) {
            row[column[p]] = scale * *r;
        } else {
            row[n] -= scale * *r * pi[p];
        }
    }
    return true;
}

auvid_status_t auvid_metric_least_squares(const auvid_metric_t *metric, uint32_t active,
                                          auvid_real_t *pi)
{
    if (metric == NULL || pi == NULL) {
        return AUVID_ERR_NULL;
    }
    const auvid_metric_t *m = metric;
    if (auvid_metric_stores_rows(m)) {
        return AUVID_ERR_MODEL;
    }
    /* one R factor for all DoF: active parameters in order, then the wrench */
    auvid_real_t joint[AUVID_QR_FACTOR(AUVID_MAX_PARAMETERS + 1)] = {AUVID_C(0.0)};
    auvid_real_t x[AUVID_MAX_PARAMETERS + 1]; /* a row, and finally the solution */
    int8_t column[AUVID_MAX_PARAMETERS] = {0}, n = 0;
    active &= m->cfg.free == 0 ? UINT32_MAX : m->cfg.free;
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        column[i] = (active >> i & 1u) ? n++ : -1;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; auvid_metric_joint_row(m, j, i, active, pi, x); ++i) {
            auvid_qr_update(joint, n + 1, 0, x);
        }
    }
    for (int i = 0; i < n && i < AUVID_MAX_PARAMETERS; ++i) {
        x[i] = joint[auvid_qr_row(n + 1, i) + n - i];
    }
    int undetermined = auvid_qr_solve(joint, n + 1, n, AUVID_C(1e-6), x);
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        pi[i] = column[i] >= 0 ? x[column[i]] : pi[i];
    }
    return undetermined > 0 ? AUVID_ERR_SINGULAR : AUVID_OK;
}
