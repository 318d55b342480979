/*
 * Metric: merging the sets of the ring into one weighted R factor for each DoF.
 *
 * The merge makes three passes over the rows of the excited DoF.
 * (1) All rows of all sets and bands are rotated into one R factor for each DoF, with equal weights
 *     of the bands. It gives the delay and the DoF's least-squares parameters.
 * (2) The residual of each band at those parameters gives the new weights, the inverse of its mean
 *     square.
 * (3) Pass 1 is repeated with the new weights.
 * If successive rows a, b have the correlation rho, the residual variance of their sum and
 * difference is (1 +- rho) sigma^2 / 2. So the weights whiten a first-order autoregression that is
 * chosen after the fact. A further pass merges the rows of the other DoF, with equal weights
 * (auvid_metric_coupled.c).
 */
#include "auvid_metric_evaluator_internal.h"

#include <string.h>

/* Largest ratio of the weights of the two bands, as inverse variances. */
#define METRIC_LARGEST_RATIO AUVID_C(1e3)

/* A delay is accepted if its standard deviation is at most this [s] and it is at least this many
 * standard deviations from zero. The delays of thrusters pass (lag 0.05 s, disturbance 3 N, 240 s:
 * +-0.006 s). A model error, such as a missing thruster curve, can look like a delay and does not
 * pass: with it the fit is slightly better and the prediction is worse. */
#define DELAY_PRECISION_S AUVID_C(0.0125)
#define DELAY_SIGMAS AUVID_C(4.0)

/* A pivot up to this part of its column norm is rounding, mostly of the stored R factors. */
#define PIVOT_ROUNDING                                                                             \
    (AUVID_METRIC_DIGITS == 15 ? AUVID_C(4.0) / AUVID_C(32768.0) : AUVID_C(100.0) * AUVID_EPSILON)

/* Delays that are tried, in units of the node spacing: 0 .. 2. A response seems to precede its
 * command if time stamps are late: if the delay is uncertain, shifts from -2/3 (two cells) are
 * tried. */
enum { DELAY_STEPS = 20, EARLY_STEPS = 7 };
#define DELAY_STEP AUVID_C(0.1)
#define EARLIEST (-(auvid_real_t)AUVID_METRIC_EARLY_CELLS / (auvid_real_t)AUVID_METRIC_DELAY_CELLS)

const auvid_real_t *auvid_equation_row(const auvid_equation_t *e, int i)
{
    return e->factor + auvid_qr_row(e->order, i);
}

auvid_real_t auvid_metric_delay(const auvid_metric_t *m, int j, bool *lag)
{
    *lag = (m->result.first_order_lag >> j & 1) != 0;
    return m->result.delay_s[j] / auvid_metric_node_s(m);
}

/* Weights of the wrench at the delays 0, 1, 2 with sum one, mean s and second moment b: s^2 for a
 * delay (they are the Lagrange polynomials then), 2 s^2 for a first-order lag. */
void auvid_metric_delay_weights(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS])
{
    auvid_real_t b = lag ? AUVID_C(2.0) * s * s : s * s;
    l[0] = AUVID_C(1.0) - AUVID_C(1.5) * s + AUVID_C(0.5) * b;
    l[1] = AUVID_C(2.0) * s - b;
    l[2] = AUVID_C(0.5) * (b - s);
}

void auvid_metric_delay_slopes(auvid_real_t s, bool lag, auvid_real_t l[AUVID_METRIC_DELAYS])
{
    auvid_real_t b = lag ? AUVID_C(4.0) * s : AUVID_C(2.0) * s;
    l[0] = AUVID_C(0.5) * b - AUVID_C(1.5);
    l[1] = AUVID_C(2.0) - b;
    l[2] = AUVID_C(0.5) * (b - AUVID_C(1.0));
}

/* Returns ||T l||^2, T the last 3 x 3 block of the merged R factor: the squared wrench that no pi
 * explains at a delay, or first-order lag, of s spacings. */
static auvid_real_t metric_unexplained(const auvid_metric_t *m, int j, auvid_real_t s, bool lag)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    const auvid_real_t *t = e.factor + auvid_qr_row(e.order, e.order - AUVID_METRIC_DELAYS);
    auvid_real_t l[AUVID_METRIC_DELAYS];
    auvid_metric_delay_weights(s, lag, l);
    auvid_real_t a = t[0] * l[0] + t[1] * l[1] + t[2] * l[2];
    auvid_real_t b = t[3] * l[1] + t[4] * l[2], c = t[5] * l[2];
    return a * a + b * b + c * c;
}

auvid_real_t auvid_metric_unexplained(const auvid_metric_t *m, int j)
{
    bool lag;
    auvid_real_t s = auvid_metric_delay(m, j, &lag);
    return metric_unexplained(m, j, s, lag);
}

/* Find the delay (or lag) with the smallest unexplained wrench: on a grid, then at the vertex of
 * the parabola through the best point and its neighbours. */
static auvid_real_t metric_best_delay(const auvid_metric_t *m, int j, bool lag)
{
    auvid_real_t smallest = metric_unexplained(m, j, AUVID_C(0.0), lag), best = AUVID_C(0.0);
    bool early = !lag && m->cfg.delay_sigma_s > AUVID_C(0.0);
    for (int i = early ? -EARLY_STEPS : 0; i <= DELAY_STEPS; ++i) {
        auvid_real_t s = DELAY_STEP * (auvid_real_t)i, e = metric_unexplained(m, j, s, lag);
        if (e < smallest) {
            smallest = e;
            best = s;
        }
    }
    auvid_real_t left = metric_unexplained(m, j, best - DELAY_STEP, lag);
    auvid_real_t right = metric_unexplained(m, j, best + DELAY_STEP, lag);
    auvid_real_t bend = left - AUVID_C(2.0) * smallest + right;
    auvid_real_t off = bend > AUVID_C(0.0) ? AUVID_C(0.5) * (left - right) / bend : AUVID_C(0.0);
    best += DELAY_STEP * auvid_clamp(off, AUVID_C(-0.5), AUVID_C(0.5));
    return auvid_clamp(best, early ? EARLIEST : AUVID_C(0.0),
                       DELAY_STEP * (auvid_real_t)DELAY_STEPS);
}

/* Estimate a shift or a first-order lag, whichever leaves less unexplained; zero if it is not
 * significant. With E(s) the unexplained part, N rows and E nearly a parabola:
 * sigma^2 = s^2 / (N (E(0) / E(s) - 1)). */
static auvid_real_t metric_estimate_delay(const auvid_metric_t *m, int j, bool *lag)
{
    auvid_real_t as_shift = metric_best_delay(m, j, false), as_lag = metric_best_delay(m, j, true);
    auvid_real_t e_shift = metric_unexplained(m, j, as_shift, false);
    auvid_real_t e_lag = metric_unexplained(m, j, as_lag, true);
    *lag = as_lag > AUVID_C(0.0) && e_lag < e_shift;
    auvid_real_t s = *lag ? as_lag : as_shift, e_best = *lag ? e_lag : e_shift;
    auvid_real_t gain = (auvid_real_t)m->result.dof_rows[j] *
                        (metric_unexplained(m, j, AUVID_C(0.0), false) - e_best);
    auvid_real_t precise = s * auvid_metric_node_s(m) / DELAY_PRECISION_S;
    bool sure = gain > DELAY_SIGMAS * DELAY_SIGMAS * e_best && gain > precise * precise * e_best;
    *lag = *lag && sure;
    return sure ? s : AUVID_C(0.0);
}

/* A column that depends on those before it (yaw: m_u and m_v have the columns -u v and u v) has a
 * pivot that is only rounding. The rest of its row then has an arbitrary direction. The row is
 * cleared and rotated in again from the next column on. */
void auvid_metric_clear_dependent(auvid_metric_t *m, int j)
{
    int n = auvid_metric_order(m, j);
    auvid_real_t *factor = m->evaluator.merged + m->layout.factor_at[j];
    for (int i = 0; i < m->layout.count[j]; ++i) {
        auvid_real_t *r = factor + auvid_qr_row(n, i);
        auvid_real_t norm = auvid_qr_column_norm(factor, n, i);
        if (auvid_abs(r[0]) > PIVOT_ROUNDING * norm) {
            continue;
        }
        auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
        memcpy(row + i, r, (size_t)(n - i) * sizeof *r);
        memset(r, 0, (size_t)(n - i) * sizeof *r);
        auvid_qr_update(factor, n, i + 1, row);
    }
}

/* candidate = [pi_j, -l]. */
void auvid_metric_solve_dof(auvid_metric_t *m, int j)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_equation_t e = auvid_metric_equation(m, j);
    auvid_real_t *z = ev->z + e.at, *x = ev->candidate + e.at;
    auvid_real_t l[AUVID_METRIC_DELAYS];
    auvid_real_t s = m->cfg.delay_s[j] / auvid_metric_node_s(m);
    bool excited = auvid_metric_is_excited(m, j);
    bool lag = (m->cfg.first_order_lag >> j & 1) != 0;
    auvid_metric_clear_dependent(m, j);
    if (auvid_metric_stores_rows(m)) { /* linearised at one delay */
        s = excited ? ev->linear_delay_s / auvid_metric_node_s(m) : AUVID_C(0.0);
        lag = false;
    } else if (m->cfg.estimate_delay) {
        s = excited ? metric_estimate_delay(m, j, &lag) : AUVID_C(0.0);
    }
    m->result.delay_s[j] = s * auvid_metric_node_s(m);
    m->result.first_order_lag =
        (uint8_t)((m->result.first_order_lag & ~(1u << j)) | (unsigned)lag << j);
    auvid_metric_delay_weights(s, lag, l);
    const auvid_real_t *r = e.factor + e.count; /* row i: the wrench */
    for (int i = 0; i < e.count; r += e.order - 1 - i++) {
        z[i] = r[0] * l[0] + r[1] * l[1] + r[2] * l[2];
        x[i] = z[i];
    }
    (void)auvid_qr_solve(e.factor, e.order, e.count, AUVID_C(1e-4), x);
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        x[e.count + d] = -l[d];
    }
    if (excited) {
        m->result.constant += ev->weight[j] * metric_unexplained(m, j, s, lag);
    }
}

void auvid_metric_rotate(auvid_metric_t *m, const auvid_set_t *set, int band, int j, int i,
                         auvid_real_t more)
{
    int n = auvid_metric_order(m, j), count = m->layout.count[j];
    auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
    auvid_real_t scale = auvid_sqrt(m->evaluator.band_weight[band][j]);
    int first = auvid_metric_read_row(m, set, band, j, i, row);
    for (int k = first; k < n; ++k) {
        row[k] *= scale;
    }
    int wrench = first > count ? first : count;
    for (int k = wrench; k < n && !auvid_is_zero(more); ++k) {
        row[k] += more * row[k];
    }
    auvid_qr_update(m->evaluator.merged + m->layout.factor_at[j], n, first, row);
}

/* Add the residual at the candidate of a row of one band of a set. */
static void metric_add_residual(auvid_metric_t *m, const auvid_set_t *set, int band, int j, int i)
{
    auvid_equation_t equation = auvid_metric_equation(m, j);
    const auvid_real_t *x = m->evaluator.candidate + equation.at;
    auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS], e = AUVID_C(0.0);
    auvid_real_t wrench = AUVID_C(0.0);
    auvid_metric_unpack_row(m, set, band, j, i, row);
    for (int k = i; k < equation.order; ++k) {
        e += row[k] * x[k];
        wrench += k < equation.count ? AUVID_C(0.0) : row[k] * x[k];
    }
    m->evaluator.band_sse[band][j] += e * e;
    m->evaluator.high_wrench[j] += band == 0 ? AUVID_C(0.0) : wrench * wrench;
}

void auvid_metric_restart_pass(auvid_metric_t *m, uint8_t pass)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    ev->at = (auvid_metric_cursor_t){.to_set = (uint8_t)auvid_metric_sets(m),
                                     .pass = pass,
                                     .plain = pass <= PASS_ADDED && ev->at.plain};
    memset(ev->band_sse, 0, sizeof ev->band_sse);
    memset(ev->high_wrench, 0, sizeof ev->high_wrench);
    if (pass == PASS_FIRST || pass == PASS_LAST) {
        auvid_zero(ev->merged, sizeof ev->merged);
        m->result.constant = AUVID_C(0.0);
    }
}

/* Does the present pass read DoF j's rows of a set? */
static bool metric_pass_reads(const auvid_metric_t *m, const auvid_set_t *set, int j)
{
    return m->evaluator.at.pass == PASS_COUPLED
               ? auvid_metric_may_be_coupled(m, j) && set->rows_of[j] > 0
               : auvid_metric_set_counts(m, set, j);
}

/* Process rows until the budget is used or the sets are complete. The loop takes at least one step
 * for each unit of the budget. @return true if all rows are processed */
bool auvid_metric_for_each_row(auvid_metric_t *m, uint32_t *budget)
{
    auvid_metric_cursor_t *at = &m->evaluator.at;
    bool rotates = at->pass != PASS_RESIDUAL && at->pass != PASS_MEASURE;
    for (; at->set < at->to_set; ++at->set, at->band = 0) {
        const auvid_set_t *set = auvid_metric_set(m, at->set);
        for (; at->band < AUVID_METRIC_BANDS; ++at->band, at->dof = 0) {
            for (; at->dof < AUVID_DOF_COUNT; ++at->dof, at->row = 0) {
                int j = at->dof;
                int rows = metric_pass_reads(m, set, j) ? auvid_metric_order(m, j) : 0;
                for (; at->row < rows; ++at->row) {
                    if (!auvid_metric_spend(at, budget, rotates ? AUVID_METRIC_ROTATION : 1)) {
                        return false;
                    }
                    if (rotates) {
                        auvid_metric_rotate(m, set, at->band, j, at->row, AUVID_C(0.0));
                    } else {
                        metric_add_residual(m, set, at->band, j, at->row);
                    }
                }
            }
        }
    }
    return true;
}

/* weight_b ~ 1 / sse_b, geometric mean one. */
static void metric_weigh_bands(auvid_metric_t *m, int j)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_real_t low = ev->band_sse[0][j], high = ev->band_sse[1][j];
    auvid_real_t ratio = AUVID_C(1.0);
    if (low > AUVID_C(0.0) && high > AUVID_C(0.0)) {
        ratio = auvid_clamp(high / low, AUVID_C(1.0) / METRIC_LARGEST_RATIO, METRIC_LARGEST_RATIO);
    }
    ev->band_weight[0][j] = auvid_sqrt(ratio);
    ev->band_weight[1][j] = AUVID_C(1.0) / ev->band_weight[0][j];
}

/* Complete a pass, one DoF at a time, at the cost of five rows each. @return true if all are
 * complete */
static bool metric_finish_dofs(auvid_metric_t *m, uint32_t *budget)
{
    auvid_metric_cursor_t *at = &m->evaluator.at;
    while (at->dof < AUVID_DOF_COUNT) {
        int j = at->dof;
        if (auvid_metric_order(m, j) > 0 &&
            (at->pass != PASS_COUPLED || auvid_metric_may_be_coupled(m, j))) {
            if (!auvid_metric_spend(at, budget, 5 * AUVID_METRIC_ROTATION)) {
                return false;
            }
            if (at->pass == PASS_RESIDUAL) {
                metric_weigh_bands(m, j);
                auvid_metric_judge_width(m, j);
            } else {
                auvid_metric_solve_dof(m, j);
            }
        }
        at->row = 0;
        ++at->dof;
    }
    return true;
}

auvid_status_t auvid_metric_merge_sets(auvid_metric_t *m, uint32_t *budget)
{
    auvid_metric_cursor_t *at = &m->evaluator.at;
    while (at->pass != PASS_ADDED) {
        if (!auvid_metric_for_each_row(m, budget) || !metric_finish_dofs(m, budget)) {
            return AUVID_PENDING;
        }
        auvid_metric_restart_pass(m, (uint8_t)(at->pass + 1));
    }
    return m->prior == NULL || at->plain ? AUVID_OK : m->prior->add_rows(m, budget);
}

void auvid_metric_weigh_dof(auvid_metric_t *m, int j)
{
    auvid_real_t rows = (auvid_real_t)m->result.dof_rows[j];
    m->evaluator.weight[j] = m->result.dof_rows[j] == 0
                                 ? AUVID_C(0.0)
                                 : AUVID_C(1.0) / (m->cfg.tau_max[j] * m->cfg.tau_max[j] * rows);
}

void auvid_metric_merge_begin(auvid_metric_t *metric)
{
    auvid_metric_t *m = metric;
    if (m == NULL) {
        return;
    }
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_metric_result_t *result = &m->result;
    result->excited = result->coupled = ev->sets_merged = ev->noise = 0;
    memset(result->dof_rows, 0, sizeof result->dof_rows);
    memset(ev->coupled_rows, 0, sizeof ev->coupled_rows);
    for (int age = 0; age < auvid_metric_sets(m); ++age) {
        const auvid_set_t *set = auvid_metric_set(m, age);
        result->excited |= set->excited;
        ev->sets_merged = (uint8_t)(ev->sets_merged + (set->excited != 0));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            uint16_t *rows = (set->excited >> j & 1) ? result->dof_rows : ev->coupled_rows;
            rows[j] = (uint16_t)(rows[j] + set->rows_of[j]);
        }
    }
    auvid_metric_order_columns(m);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_metric_weigh_dof(m, j);
        ev->band_weight[0][j] = ev->band_weight[1][j] = AUVID_C(1.0);
    }
    ev->at.plain = false;
    auvid_metric_restart_pass(m, PASS_FIRST);
}

auvid_status_t auvid_metric_merge(auvid_metric_t *metric, uint32_t *budget)
{
    if (metric == NULL || budget == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_metric_t *m = metric;
    if (m->result.excited == 0) {
        return AUVID_ERR_NO_DATA;
    }
    const auvid_path_t *path = auvid_metric_path(m);
    auvid_status_t status = AUVID_OK;
    do {
        status = path->merge == NULL ? AUVID_OK : path->merge(m, budget);
    } while (status == AUVID_EMPTY);
    return status;
}
