/*
 * Metric, evaluation (Karras et al. 2013, Eq. 11): sets to one weighted triangle, cost, residuals.
 *
 * Three passes bring the ring together. (1) All rows of all sets and bands into one triangle for
 * each DoF, bands weighted as before; from it the delay and the DoF's own least-squares parameters.
 * (2) Each band's residual at those parameters; the new weights are the inverse of its mean square.
 * (3) As (1), with the new weights. Successive rows a, b have residual variance (1 +- rho) sigma^2
 * / 2 in their sum and difference when their correlation is rho, so this is the whitening of a
 * first-order autoregression, chosen after the fact.
 */
#include "auvid/metric.h"

#include <string.h>

#include "auvid_linalg.h"
#include "auvid_metric.h"

/* No band is trusted more than this times the other (in variance). */
#define LARGEST_RATIO AUVID_C(1e3)

/* A delay is taken when it is known this well [s] and is this many standard deviations from none.
 * The thrusters' delays are (lag 0.05 s, disturbance 3 N, 240 s: +-0.006 s); what a model that
 * misses something, a thruster's curve, say, makes look like a delay is not: it fits a little
 * better with it and predicts worse. */
#define DELAY_PRECISION_S AUVID_C(0.0125)
#define DELAY_SIGMAS AUVID_C(4.0)

/* Delays tried, in units of the nodes' distance: 0 .. 2. No response precedes its command. */
enum { DELAY_STEPS = 20 };
#define DELAY_STEP AUVID_C(0.1)

enum { PASS_FIRST, PASS_RESIDUAL, PASS_LAST, PASS_COST, PASS_MEASURE };

static int order_of(const auvid_metric_t *m, int j)
{
    return m->channel_at[j + 1] - m->channel_at[j];
}

static bool has_regressor(const auvid_metric_t *m)
{
    return m->cfg.vehicle->regressor != NULL;
}

/* Weights of the wrench at the delays 0, 1, 2 with sum one, mean s and second moment b: s^2 for a
 * delay (they are the Lagrange polynomials then), 2 s^2 for a first-order lag. */
static void delay_weights(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS])
{
    auvid_real_t b = lag ? AUVID_C(2.0) * s * s : s * s;
    l[0] = AUVID_C(1.0) - AUVID_C(1.5) * s + AUVID_C(0.5) * b;
    l[1] = AUVID_C(2.0) * s - b;
    l[2] = AUVID_C(0.5) * (b - s);
}

static auvid_real_t node_s(const auvid_metric_t *m)
{
    return (auvid_real_t)m->cfg.cell_us * AUVID_C(1e-6) * (auvid_real_t)AUVID_METRIC_DELAY_CELLS;
}

/* ||T l||^2, T the last 3 x 3 block of DoF j's triangle: what no pi explains at delay or lag s. */
static auvid_real_t unexplained(const auvid_metric_t *m, int j, auvid_real_t s, bool lag)
{
    int n = order_of(m, j);
    const auvid_real_t *t =
        m->merged + m->factor_at[j] + auvid_triangle_row(n, n - AUVID_METRIC_DELAYS);
    auvid_real_t l[AUVID_METRIC_DELAYS];
    delay_weights(s, lag, l);
    auvid_real_t a = t[0] * l[0] + t[1] * l[1] + t[2] * l[2];
    auvid_real_t b = t[3] * l[1] + t[4] * l[2], c = t[5] * l[2];
    return a * a + b * b + c * c;
}

/* The delay (or lag) of least unexplained wrench: on a grid, then the vertex of the parabola
 * through the best point and its neighbours. */
static auvid_real_t best_delay(const auvid_metric_t *m, int j, bool lag)
{
    auvid_real_t least = unexplained(m, j, AUVID_C(0.0), lag), best = AUVID_C(0.0);
    for (int i = 0; i <= DELAY_STEPS; ++i) {
        auvid_real_t s = DELAY_STEP * (auvid_real_t)i, e = unexplained(m, j, s, lag);
        if (e < least) {
            least = e;
            best = s;
        }
    }
    auvid_real_t left = unexplained(m, j, best - DELAY_STEP, lag);
    auvid_real_t right = unexplained(m, j, best + DELAY_STEP, lag);
    auvid_real_t bend = left - AUVID_C(2.0) * least + right;
    auvid_real_t off = bend > AUVID_C(0.0) ? AUVID_C(0.5) * (left - right) / bend : AUVID_C(0.0);
    best += DELAY_STEP * auvid_clamp(off, AUVID_C(-0.5), AUVID_C(0.5));
    return auvid_clamp(best, AUVID_C(0.0), DELAY_STEP * (auvid_real_t)DELAY_STEPS);
}

/* Shift or first-order lag, whichever leaves less unexplained; none without evidence. With E(s) the
 * unexplained part, N rows and E nearly a parabola: sigma^2 = s^2 / (N (E(0) / E(s) - 1)). */
static auvid_real_t estimate_delay(const auvid_metric_t *m, int j, bool *lag)
{
    auvid_real_t as_shift = best_delay(m, j, false), as_lag = best_delay(m, j, true);
    auvid_real_t shift_leaves = unexplained(m, j, as_shift, false);
    auvid_real_t lag_leaves = unexplained(m, j, as_lag, true);
    *lag = as_lag > AUVID_C(0.0) && lag_leaves < shift_leaves;
    auvid_real_t s = *lag ? as_lag : as_shift, leaves = *lag ? lag_leaves : shift_leaves;
    auvid_real_t gain =
        (auvid_real_t)m->dof_rows[j] * (unexplained(m, j, AUVID_C(0.0), false) - leaves);
    auvid_real_t precise = s * node_s(m) / DELAY_PRECISION_S;
    bool sure = gain > DELAY_SIGMAS * DELAY_SIGMAS * leaves && gain > precise * precise * leaves;
    *lag = *lag && sure;
    return sure ? s : AUVID_C(0.0);
}

/* A column that depends on those before it (yaw: m_u and m_v stand there as -u v and u v) leaves a
 * pivot of rounding, and in its row whatever direction of the others' rows rounding chose. That row
 * goes back to where it can be explained, or not. */
static void clear_dependent(auvid_metric_t *m, int j)
{
    int n = order_of(m, j);
    auvid_real_t *triangle = m->merged + m->factor_at[j];
    for (int i = 0; i < m->count[j]; ++i) {
        auvid_real_t *r = triangle + auvid_triangle_row(n, i), column = AUVID_C(0.0);
        for (int k = 0; k <= i; ++k) {
            auvid_real_t above = triangle[auvid_triangle_row(n, k) + i - k];
            column += above * above;
        }
        if (auvid_abs(r[0]) > AUVID_C(100.0) * AUVID_EPSILON * auvid_sqrt(column)) {
            continue;
        }
        auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
        memcpy(row + i, r, (size_t)(n - i) * sizeof *r);
        memset(r, 0, (size_t)(n - i) * sizeof *r);
        auvid_triangle_add(triangle, n, i + 1, row);
    }
}

/* After a merge pass: delay, z, and candidate = [pi_j, -l] of the DoF's own least squares. */
static void settle_dof(auvid_metric_t *m, int j)
{
    int n = order_of(m, j), count = m->count[j], at = m->channel_at[j];
    const auvid_real_t *triangle = m->merged + m->factor_at[j];
    auvid_real_t l[AUVID_METRIC_DELAYS], single[AUVID_TRIANGLE(AUVID_MAX_PARAMETERS + 1)];
    auvid_real_t s = m->cfg.delay_s[j] / node_s(m);
    bool driven = (m->driven >> j & 1) != 0;
    bool lag = false;
    clear_dependent(m, j);
    if (m->cfg.estimate_delay) {
        s = driven ? estimate_delay(m, j, &lag) : AUVID_C(0.0);
    }
    m->delay_s[j] = s * node_s(m);
    m->lagged = (uint8_t)((m->lagged & ~(1u << j)) | (unsigned)lag << j);
    delay_weights(s, lag, l);
    for (int i = 0; i < count; ++i) {
        const auvid_real_t *r = triangle + auvid_triangle_row(n, i);
        m->z[at + i] = r[count - i] * l[0] + r[count - i + 1] * l[1] + r[count - i + 2] * l[2];
        auvid_real_t *to = single + auvid_triangle_row(count + 1, i);
        memcpy(to, r, (size_t)(count - i) * sizeof *r);
        to[count - i] = m->z[at + i];
    }
    auvid_triangle_solve(single, count + 1, count, AUVID_C(1e-4), m->candidate + at);
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        m->candidate[at + count + d] = -l[d];
    }
    if (driven) {
        m->constant += m->weight[j] * unexplained(m, j, s, lag);
    }
}

/* One row of one band of one set: rotate it in, or add its residual at the candidate. */
static void visit_row(auvid_metric_t *m, const auvid_set_t *set, int band, int j, int i)
{
    int n = order_of(m, j);
    const auvid_real_t *r = set->factor[band] + m->factor_at[j] + auvid_triangle_row(n, i);
    if (m->pass == PASS_RESIDUAL || m->pass == PASS_MEASURE) {
        const auvid_real_t *x = m->candidate + m->channel_at[j] + i;
        auvid_real_t e = AUVID_C(0.0);
        for (int k = 0; k < n - i; ++k) {
            e += r[k] * x[k];
        }
        m->band_sse[band][j] += e * e;
        return;
    }
    auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
    auvid_real_t scale = auvid_sqrt(m->band_weight[band][j]);
    for (int k = 0; k < n - i; ++k) {
        row[i + k] = scale * r[k];
    }
    auvid_triangle_add(m->merged + m->factor_at[j], n, i, row);
}

static void rewind_rows(auvid_metric_t *m, uint8_t pass)
{
    m->pass = pass;
    m->at_set = m->at_band = m->at_dof = 0;
    m->at_row = 0;
    memset(m->band_sse, 0, sizeof m->band_sse);
    if (pass == PASS_FIRST || pass == PASS_LAST) {
        memset(m->merged, 0, sizeof m->merged);
        m->constant = AUVID_C(0.0);
    }
}

/* Visit rows until the budget or the sets are at an end. Each unit of the budget is one step of the
 * loop at least. @return all visited */
static bool visit_rows(auvid_metric_t *m, uint32_t *budget)
{
    while (m->at_set < m->cfg.sets) {
        const auvid_set_t *set = &m->set[auvid_metric_slot(m, m->at_set)];
        int j = m->at_dof;
        bool inside = (set->driven >> j & 1) != 0 && m->at_row < order_of(m, j);
        if (inside) {
            if (*budget == 0) {
                return false;
            }
            --*budget;
            visit_row(m, set, m->at_band, j, m->at_row++);
            continue;
        }
        m->at_row = 0;
        if (++m->at_dof == AUVID_DOF_COUNT) {
            m->at_dof = 0;
            if (++m->at_band == AUVID_METRIC_BANDS) {
                m->at_band = 0;
                ++m->at_set;
            }
        }
    }
    return true;
}

/* weight_b ~ 1 / sse_b, geometric mean one. */
static void weigh_bands(auvid_metric_t *m, int j)
{
    auvid_real_t low = m->band_sse[0][j], high = m->band_sse[1][j];
    auvid_real_t ratio = AUVID_C(1.0);
    if (low > AUVID_C(0.0) && high > AUVID_C(0.0)) {
        ratio = auvid_clamp(high / low, AUVID_C(1.0) / LARGEST_RATIO, LARGEST_RATIO);
    }
    m->band_weight[0][j] = auvid_sqrt(ratio);
    m->band_weight[1][j] = AUVID_C(1.0) / m->band_weight[0][j];
}

/* After a pass, one DoF at a time: four units each. @return all done */
static bool settle(auvid_metric_t *m, uint32_t *budget)
{
    while (m->at_dof < AUVID_DOF_COUNT) {
        int j = m->at_dof;
        if (order_of(m, j) > 0) {
            if (*budget == 0) {
                return false;
            }
            --*budget;
            if (m->at_row++ < 3) {
                continue; /* the work of four rows: let it cost four units */
            }
            if (m->pass == PASS_RESIDUAL) {
                weigh_bands(m, j);
            } else {
                settle_dof(m, j);
            }
        }
        m->at_row = 0;
        ++m->at_dof;
    }
    return true;
}

void auvid_metric_merge_begin(auvid_metric_t *metric)
{
    auvid_metric_t *m = metric;
    if (m == NULL) {
        return;
    }
    m->driven = 0;
    memset(m->dof_rows, 0, sizeof m->dof_rows);
    for (int age = 0; age < m->cfg.sets; ++age) {
        const auvid_set_t *set = &m->set[auvid_metric_slot(m, age)];
        m->driven |= set->driven;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            unsigned rows = (set->driven >> j & 1) ? set->rows : 0u;
            m->dof_rows[j] = (uint16_t)(m->dof_rows[j] + rows);
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        m->weight[j] = m->dof_rows[j] == 0 ? AUVID_C(0.0)
                                           : AUVID_C(1.0) / (m->cfg.tau_max[j] * m->cfg.tau_max[j] *
                                                             (auvid_real_t)m->dof_rows[j]);
    }
    rewind_rows(m, m->cfg.smoothing == AUVID_SMOOTH_STATES ? PASS_LAST : PASS_FIRST);
}

auvid_status_t auvid_metric_merge(auvid_metric_t *metric, uint32_t *budget)
{
    if (metric == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_metric_t *m = metric;
    if (m->driven == 0) {
        return AUVID_ERR_NO_DATA;
    }
    while (has_regressor(m)) {
        if (!visit_rows(m, budget) || !settle(m, budget)) {
            return AUVID_PENDING;
        }
        if (m->pass == PASS_LAST) {
            break;
        }
        rewind_rows(m, (uint8_t)(m->pass + 1));
    }
    return AUVID_OK;
}

auvid_real_t auvid_metric_longest_delay(const auvid_metric_t *metric)
{
    return node_s(metric) * (auvid_real_t)(AUVID_METRIC_DELAYS - 1);
}

static void take_candidate(auvid_metric_t *m, const auvid_real_t *pi, auvid_real_t delay_s)
{
    delay_weights(delay_s / node_s(m), false, m->delay_weight);
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        m->pi[i] = m->cfg.free == 0 || (m->cfg.free >> i & 1u) ? pi[i] : m->cfg.fixed[i];
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int k = m->channel_at[j]; k < m->channel_at[j] + m->count[j]; ++k) {
            if (order_of(m, j) > 0) {
                m->candidate[k] = m->pi[m->index[k]];
            }
        }
    }
    m->at_set = m->at_dof = 0;
    m->at_row = 0;
    m->window_rows = 0;
    m->sum = m->compensation = m->squares = AUVID_C(0.0);
}

void auvid_metric_cost_begin(auvid_metric_t *metric, const auvid_real_t *pi, auvid_real_t delay_s)
{
    if (metric != NULL && pi != NULL) {
        metric->pass = PASS_COST;
        take_candidate(metric, pi, delay_s);
    }
}

/* J = sum_j weight_j ||R_j pi - z_j||^2, row by row. */
static auvid_status_t triangle_cost(auvid_metric_t *m, uint32_t *budget)
{
    for (; m->at_dof < AUVID_DOF_COUNT; ++m->at_dof, m->at_row = 0) {
        int j = m->at_dof, count = m->count[j], n = count + AUVID_METRIC_DELAYS;
        if (!(m->driven >> j & 1)) {
            continue;
        }
        const auvid_real_t *x = m->candidate + m->channel_at[j], *z = m->z + m->channel_at[j];
        for (; m->at_row<count && * budget> 0; ++m->at_row, --*budget) {
            int i = m->at_row;
            const auvid_real_t *r = m->merged + m->factor_at[j] + auvid_triangle_row(n, i);
            auvid_real_t e = -z[i];
            for (int k = i; k < count; ++k) {
                e += r[k - i] * x[k];
            }
            m->squares += e * e;
        }
        if (m->at_row < count) {
            return AUVID_PENDING;
        }
        m->sum += m->weight[j] * m->squares;
        m->squares = AUVID_C(0.0);
    }
    m->cost = m->sum;
    return AUVID_OK;
}

/* The stored sample with wrench and commands at the candidate's delay. */
static auvid_sample_t delayed_sample(const auvid_metric_t *m, const auvid_row_t *row)
{
    const auvid_real_t *l = m->delay_weight;
    auvid_sample_t s = row->sample;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s.tau[j] = l[0] * s.tau[j] + l[1] * row->late[0][j] + l[2] * row->late[1][j];
    }
    for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
        int k = AUVID_DOF_COUNT + i;
        s.command[i] = l[0] * s.command[i] + l[1] * row->late[0][k] + l[2] * row->late[1][k];
    }
    return s;
}

/* Residuals of one stored row into the window; rows are successive when their times are, to half a
 * cell. @return the window is full of successive rows */
static bool push_residual(auvid_metric_t *m, const auvid_row_t *row)
{
    uint64_t row_us = (uint64_t)m->cfg.cell_us * m->cfg.row_cells;
    auvid_sample_t sample = delayed_sample(m, row);
    if (sample.t_us - m->window_us + m->cfg.cell_us / 2 - row_us > m->cfg.cell_us) {
        m->window_rows = 0;
    }
    m->window_us = sample.t_us;
    auvid_vehicle_residual(m->cfg.vehicle, &sample, m->pi,
                           m->window[m->window_rows % m->window_length]);
    ++m->window_rows;
    return m->window_rows >= m->window_length;
}

static auvid_real_t smoothed_residual(const auvid_metric_t *m, int j)
{
    auvid_real_t e = AUVID_C(0.0);
    for (uint32_t k = 0; k < m->window_length; ++k) {
        e += m->share[k] * m->window[(m->window_rows + k) % m->window_length][j];
    }
    return e;
}

/* J = sum over stored rows, oldest set first; compensated, since the constant part is in it. */
static auvid_status_t sample_cost(auvid_metric_t *m, uint32_t *budget)
{
    for (; m->at_set < m->cfg.sets; ++m->at_set, m->at_row = 0) {
        int slot = auvid_metric_slot(m, m->cfg.sets - 1 - m->at_set);
        const auvid_set_t *set = &m->set[slot];
        for (; set->driven != 0 && m->at_row < set->rows; ++m->at_row, --*budget) {
            if (*budget == 0) {
                return AUVID_PENDING;
            }
            auvid_real_t squares = AUVID_C(0.0);
            if (!push_residual(m, &m->cfg.rows[(uint32_t)slot * m->cfg.set_rows + m->at_row])) {
                continue;
            }
            for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
                if (set->driven >> j & 1) {
                    auvid_real_t e = smoothed_residual(m, j);
                    squares += m->weight[j] * e * e;
                    m->band_sse[0][j] += m->pass == PASS_MEASURE ? e * e : AUVID_C(0.0);
                }
            }
            auvid_real_t term = squares - m->compensation, total = m->sum + term;
            m->compensation = (total - m->sum) - term;
            m->sum = total;
        }
    }
    m->cost = m->sum;
    return AUVID_OK;
}

auvid_status_t auvid_metric_cost(auvid_metric_t *metric, uint32_t *budget)
{
    if (metric == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    return has_regressor(metric) ? triangle_cost(metric, budget) : sample_cost(metric, budget);
}

void auvid_metric_measure_begin(auvid_metric_t *metric, const auvid_real_t *pi,
                                auvid_real_t delay_s)
{
    if (metric != NULL && pi != NULL) {
        rewind_rows(metric, PASS_MEASURE);
        take_candidate(metric, pi, delay_s);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            auvid_real_t l[AUVID_METRIC_DELAYS];
            delay_weights(metric->delay_s[j] / node_s(metric), metric->lagged >> j & 1, l);
            for (int d = 0; d < AUVID_METRIC_DELAYS && order_of(metric, j) > 0; ++d) {
                metric->candidate[metric->channel_at[j] + metric->count[j] + d] = -l[d];
            }
        }
    }
}

auvid_status_t auvid_metric_measure(auvid_metric_t *metric, uint32_t *budget)
{
    if (metric == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_metric_t *m = metric;
    bool done = has_regressor(m) ? visit_rows(m, budget) : sample_cost(m, budget) == AUVID_OK;
    if (!done) {
        return AUVID_PENDING;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        m->sse[j] = m->band_sse[0][j] + m->band_sse[1][j];
    }
    return AUVID_OK;
}

uint32_t auvid_metric_active(const auvid_metric_t *metric)
{
    uint32_t active = 0;
    for (int i = 0; metric != NULL && i < metric->cfg.vehicle->parameters; ++i) {
        bool free = metric->cfg.free == 0 || (metric->cfg.free >> i & 1u) != 0;
        if (free && (metric->driven >> metric->cfg.vehicle->parameter[i].dof & 1)) {
            active |= 1u << i;
        }
    }
    return active;
}

void auvid_metric_scale(const auvid_metric_t *metric, auvid_real_t *scale)
{
    const auvid_metric_t *m = metric;
    auvid_real_t square[AUVID_MAX_PARAMETERS] = {AUVID_C(0.0)};
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int n = order_of(m, j);
        for (int k = 0; k < m->count[j] && n > 0 && (m->driven >> j & 1); ++k) {
            for (int i = 0; i <= k; ++i) {
                auvid_real_t r = m->merged[m->factor_at[j] + auvid_triangle_row(n, i) + k - i];
                square[m->index[m->channel_at[j] + k]] += m->weight[j] * r * r;
            }
        }
    }
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        scale[i] = square[i] > AUVID_C(0.0) ? AUVID_C(1.0) / auvid_sqrt(square[i]) : AUVID_C(0.0);
    }
}

void auvid_metric_r2(const auvid_metric_t *metric, auvid_real_t *r2)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t total = AUVID_C(0.0);
        for (int age = 0; age < metric->cfg.sets; ++age) {
            const auvid_set_t *set = &metric->set[auvid_metric_slot(metric, age)];
            total += (set->driven >> j & 1) ? set->tau_m2[j] : AUVID_C(0.0);
        }
        r2[j] = total > AUVID_C(0.0) ? AUVID_C(1.0) - metric->sse[j] / total : AUVID_C(0.0);
    }
}

auvid_status_t auvid_metric_least_squares(const auvid_metric_t *metric, uint32_t active,
                                          auvid_real_t *pi)
{
    if (metric == NULL || pi == NULL) {
        return AUVID_ERR_NULL;
    }
    const auvid_metric_t *m = metric;
    if (!has_regressor(m)) {
        return AUVID_ERR_MODEL;
    }
    /* one triangle for all DoF: active parameters in order, then the wrench */
    auvid_real_t joint[AUVID_TRIANGLE(AUVID_MAX_PARAMETERS + 1)] = {AUVID_C(0.0)};
    auvid_real_t x[AUVID_MAX_PARAMETERS];
    int place[AUVID_MAX_PARAMETERS] = {0}, n = 0;
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        bool free = m->cfg.free == 0 || (m->cfg.free >> i & 1u) != 0;
        place[i] = free && (active >> i & 1u) ? n++ : -1;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int order = order_of(m, j), at = m->channel_at[j];
        auvid_real_t scale = auvid_sqrt(m->weight[j]);
        for (int i = 0; i < m->count[j] && order > 0 && (m->driven >> j & 1); ++i) {
            const auvid_real_t *r = m->merged + m->factor_at[j] + auvid_triangle_row(order, i);
            auvid_real_t row[AUVID_MAX_PARAMETERS + 1] = {AUVID_C(0.0)};
            row[n] = scale * m->z[at + i];
            for (int k = i; k < m->count[j]; ++k) {
                int p = m->index[at + k];
                if (place[p] >= 0) {
                    row[place[p]] = scale * r[k - i];
                } else {
                    row[n] -= scale * r[k - i] * pi[p];
                }
            }
            auvid_triangle_add(joint, n + 1, 0, row);
        }
    }
    int lost = auvid_triangle_solve(joint, n + 1, n, AUVID_C(1e-6), x);
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        pi[i] = place[i] >= 0 ? x[place[i]] : pi[i];
    }
    return lost > 0 ? AUVID_ERR_SINGULAR : AUVID_OK;
}
