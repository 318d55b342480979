/*
 * Metric, residual path: means of motion and inputs are stored, and the model's residual is called
 * on each at every evaluation.
 */
#include "auvid_metric_evaluator_internal.h"

#include <string.h>

#include "../base/auvid_refusal_internal.h"
#include "auvid_metric_rows_internal.h"

#if AUVID_MAX_COMMANDS == 0

static void metric_refuse(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    (void)cfg;
    auvid_check_part(why, "vehicle");
    auvid_check_limit(why, false, AUVID_ERR_SIZE, "path", AUVID_C(0.0), AUVID_C(1.0));
}

const auvid_path_t auvid_path_residual = {.check = metric_refuse};

#else

/* Channels of a row. */
enum {
    MOTION_NU = 3,
    MOTION_NU_DOT = MOTION_NU + AUVID_DOF_COUNT,
    MOTION_TAU = MOTION_NU_DOT + AUVID_DOF_COUNT,
    MOTION_COMMAND = MOTION_TAU + AUVID_DOF_COUNT,
    MOTION_LATE = MOTION_COMMAND + AUVID_MAX_COMMANDS /* wrench and commands at the other delays */
};

/* Numbers of thrusts, before they begin again. */
#define MAX_THRUST AUVID_C(16000000.0)

/* Standard deviation of the weights that smooth the residuals. */
#define RESIDUAL_SMOOTHING_S AUVID_C(0.6)

static void metric_check_residual(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    auvid_check_part(why, "vehicle");
    auvid_check_that(why, cfg->vehicle->residual != NULL, AUVID_ERR_MODEL, "residual");
    auvid_check_part(why, "metric");
    auvid_check_that(why, cfg->rows != NULL, AUVID_ERR_MODEL, "rows");
    const uint32_t rows = (cfg->sets + 1u) * cfg->set_rows;
    auvid_check_limit(why, cfg->row_slots >= rows, AUVID_ERR_SIZE, "row_slots",
                      (auvid_real_t)cfg->row_slots, (auvid_real_t)rows);
}

/* Make binomial weights over an odd number of rows: n weights have a variance of (n - 1) / 4. */
static void metric_make_window(auvid_metric_t *m)
{
    auvid_metric_layout_t *layout = &m->layout;
    auvid_real_t rows = RESIDUAL_SMOOTHING_S * AUVID_C(1e6) /
                        ((auvid_real_t)m->cfg.cell_us * (auvid_real_t)m->cfg.row_cells);
    int pairs = (int)auvid_min(AUVID_C(2.0) * rows * rows + AUVID_C(0.5),
                               (auvid_real_t)AUVID_METRIC_WINDOW);
    pairs = pairs < AUVID_METRIC_WINDOW / 2 ? pairs : AUVID_METRIC_WINDOW / 2;
    layout->window_length = (uint8_t)(2 * pairs + 1);
    layout->window_weight[0] = AUVID_C(1.0);
    for (int n = 1; n < layout->window_length; ++n) {
        for (int k = n; k >= 0; --k) { /* Pascal's triangle, each line halved */
            auvid_real_t left = k > 0 ? layout->window_weight[k - 1] : AUVID_C(0.0);
            layout->window_weight[k] = AUVID_C(0.5) * (layout->window_weight[k] + left);
        }
    }
}

/* Rows are means over the row time. */
static void metric_make_mean(auvid_metric_t *m)
{
    auvid_metric_layout_t *layout = &m->layout;
    for (int i = 0; i < layout->taps; ++i) {
        layout->kernel[0][i] = layout->kernel[1][i] = AUVID_C(1.0) / (auvid_real_t)layout->taps;
    }
    metric_make_window(m);
}

/* Add motion and inputs at all delays to the row under construction `slot`, which has `age` cells.
 */
static void metric_accumulate_motion(auvid_metric_t *m, uint32_t slot, uint32_t age,
                                     const auvid_sample_t *s)
{
    auvid_real_t *row = m->rows.accumulator[slot];
    auvid_real_t weight = m->layout.kernel[0][age];
    auvid_metric_record_missing(m, slot, age, s->missing);
    row[0] += weight * s->phi;
    row[1] += weight * s->theta;
    row[2] += weight * s->psi;
    auvid_metric_add_scaled(row + MOTION_NU, weight, s->nu, AUVID_DOF_COUNT);
    auvid_metric_add_scaled(row + MOTION_NU_DOT, weight, s->nu_dot, AUVID_DOF_COUNT);
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        auvid_metric_add_scaled(row + MOTION_TAU + d * METRIC_INPUTS, weight,
                                auvid_metric_delayed_inputs(m, d), METRIC_INPUTS);
    }
}

static void metric_sample_from_channels(const auvid_real_t *channel, uint64_t t_us,
                                        auvid_sample_t *s)
{
    memset(s, 0, sizeof *s);
    s->t_us = t_us;
    s->phi = channel[0];
    s->theta = channel[1];
    s->psi = channel[2];
    memcpy(s->nu, channel + MOTION_NU, sizeof s->nu);
    memcpy(s->nu_dot, channel + MOTION_NU_DOT, sizeof s->nu_dot);
    memcpy(s->tau, channel + MOTION_TAU, sizeof s->tau);
    memcpy(s->command, channel + MOTION_COMMAND, sizeof s->command);
}

/* Store a row if there is room. It is counted if an equation of the model can use it. */
static void metric_store_row(auvid_metric_t *m, uint64_t t_us, uint32_t slot)
{
    if (!auvid_metric_takes_row(m, t_us)) {
        ++m->sets.rows_dropped;
        return;
    }
    const auvid_real_t *channel = m->rows.accumulator[slot];
    auvid_row_t *store = auvid_metric_rows(m, -1) + m->rows.set.rows;
    uint8_t excluded = auvid_metric_dofs_without_row(m, slot);
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool has_row = (excluded >> j & 1) == 0;
        any = any || (has_row && m->cfg.vehicle->columns[j] != 0);
        if (has_row) {
            auvid_metric_update_wrench_moments(&m->rows.set, j, channel[MOTION_TAU + j]);
        }
    }
    metric_sample_from_channels(channel, t_us, &store->sample);
    store->sample.missing = m->rows.missing[slot][0];
    memcpy(store->late, channel + MOTION_LATE, sizeof store->late);
    if (m->cfg.vehicle->thrust != NULL) {
        store->late[0][0] = AUVID_C(0.0); /* of none */
    }
    auvid_metric_count_row(&m->rows.set, any);
}

/* Add the motion in cell n of the record to all rows under construction. The newest, begun
 * n % row_cells cells ago, is at `slot`. */
static void metric_add_motion(auvid_metric_t *m, const auvid_sample_t *sample, uint32_t n,
                              uint32_t slot)
{
    uint32_t step = m->cfg.row_cells;
    for (uint32_t age = n % step; age < m->layout.taps && age <= n; age += step) {
        metric_accumulate_motion(m, slot, age, sample);
        slot = auvid_metric_earlier_slot(m, slot);
    }
}

/* Put the residuals of one stored row into the window. @return true if the window is full of
 * successive rows */
static bool metric_push_residual(auvid_metric_t *m, auvid_row_t *row)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    uint8_t excluded = auvid_vehicle_unmeasured(m->cfg.vehicle, row->sample.missing);
    auvid_sample_t delayed;
    if (!auvid_metric_succeeds(m, row->sample.t_us)) {
        ev->window_rows = 0;
        memset(ev->window_of, 0, sizeof ev->window_of);
    }
    ev->window_us = row->sample.t_us;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int rows = ev->window_of[j] + (ev->window_of[j] < m->layout.window_length);
        ev->window_of[j] = (uint8_t)((excluded >> j & 1) != 0 ? 0 : rows);
    }
    auvid_metric_residual(m, row, auvid_metric_delayed_sample(m, row, &delayed), -1,
                          ev->window[ev->window_rows % m->layout.window_length]);
    ++ev->window_rows;
    return ev->window_rows >= m->layout.window_length;
}

/* Smooth the residuals of all DoF in one pass over the window, a ring that is full, the oldest row
 * first; those of roll and pitch only if they are modelled. The sums are spelled out: then
 * compilers keep them in registers. */
static void metric_smooth_residuals(const auvid_metric_t *m, auvid_real_t smoothed[AUVID_DOF_COUNT])
{
    const auvid_metric_evaluator_t *ev = &m->evaluator;
    uint32_t length = m->layout.window_length;
    const auvid_real_t *weight = m->layout.window_weight, *end = weight + length;
    const auvid_real_t(*row)[AUVID_DOF_COUNT] = ev->window + ev->window_rows % length;
    const uint32_t *columns = m->cfg.vehicle->columns;
    bool tilts = (columns[AUVID_ROLL] | columns[AUVID_PITCH]) != 0;
    auvid_real_t u = AUVID_C(0.0), v = u, w = u, p = u, q = u, r = u;
    for (; weight < end; ++weight) {
        const auvid_real_t c = *weight, *e = *row;
        u += c * e[AUVID_SURGE];
        v += c * e[AUVID_SWAY];
        w += c * e[AUVID_HEAVE];
        r += c * e[AUVID_YAW];
        if (tilts) {
            p += c * e[AUVID_ROLL];
            q += c * e[AUVID_PITCH];
        }
        row = row + 1 < ev->window + length ? row + 1 : ev->window;
    }
    smoothed[AUVID_SURGE] = u;
    smoothed[AUVID_SWAY] = v;
    smoothed[AUVID_HEAVE] = w;
    smoothed[AUVID_ROLL] = p;
    smoothed[AUVID_PITCH] = q;
    smoothed[AUVID_YAW] = r;
}

/* What DoF j's prior adds to the cost: with P its squared distance, N log(SSE) + P is least where
 * SSE (1 + P / N) is, for P << N independent residuals. The noise need not be known. */
static auvid_real_t metric_prior_cost(const auvid_metric_t *m, int j)
{
    const auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_real_t squares = AUVID_C(0.0), mean;
    if (m->prior == NULL || !auvid_metric_is_excited(m, j)) {
        return AUVID_C(0.0);
    }
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        auvid_real_t weight = m->prior->weight(m, j, i, &mean);
        auvid_real_t off = weight > AUVID_C(0.0) ? weight * (ev->pi[i] - mean) : AUVID_C(0.0);
        squares += off * off;
    }
    return ev->weight[j] * ev->band_sse[0][j] * squares / auvid_metric_merged_rows(m, j);
}

/* J = sum over stored rows, oldest set first. The sum is compensated because it contains the
 * constant part. */
static auvid_status_t metric_sample_cost(auvid_metric_t *m, uint32_t *budget)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_metric_cursor_t *at = &ev->at;
    int sets = auvid_metric_sets(m);
    for (; at->set < sets; ++at->set, at->row = 0) {
        int age = sets - 1 - at->set;
        const auvid_set_t *set = auvid_metric_set(m, age);
        for (; set->excited != 0 && at->row < set->rows; ++at->row) {
            auvid_row_t *row = &auvid_metric_rows(m, age)[at->row];
            bool follows = auvid_metric_succeeds(m, row->sample.t_us);
            auvid_real_t e[AUVID_DOF_COUNT], squares = AUVID_C(0.0);
            if (!auvid_metric_spend_model(m, budget,
                                          auvid_metric_residual_work(m, row, follows))) {
                return AUVID_PENDING;
            }
            if (!metric_push_residual(m, row)) {
                continue;
            }
            metric_smooth_residuals(m, e);
            for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
                if ((set->excited >> j & 1) != 0 && ev->window_of[j] == m->layout.window_length) {
                    squares += ev->weight[j] * e[j] * e[j];
                    ev->band_sse[0][j] += e[j] * e[j];
                }
            }
            auvid_real_t term = squares - ev->compensation, total = ev->sum + term;
            ev->compensation = (total - ev->sum) - term;
            ev->sum = total;
        }
    }
    m->result.cost = ev->sum;
    for (int j = 0; j < AUVID_DOF_COUNT && at->pass == PASS_COST; ++j) {
        m->result.cost += metric_prior_cost(m, j);
    }
    return AUVID_OK;
}

static void metric_begin_samples(auvid_metric_t *m, const auvid_real_t *pi, auvid_real_t delay_s)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_metric_delay_weights(delay_s / auvid_metric_node_s(m), false, ev->delay_weight);
    bool same_thrust = ev->thrust > AUVID_C(0.0);
    for (int i = 0; i < m->cfg.vehicle->parameters; ++i) {
        auvid_real_t of = m->cfg.free == 0 || (m->cfg.free >> i & 1u) ? pi[i] : m->cfg.fixed[i];
        bool same = !(of < ev->pi[i]) && !(of > ev->pi[i]); /* false for NaN */
        same_thrust = same_thrust && (same || (m->cfg.vehicle->thrust_parameters >> i & 1u) == 0);
        ev->pi[i] = of;
    }
    if (!same_thrust) { /* whole numbers, exact in single precision */
        ev->thrust = ev->thrust < MAX_THRUST ? ev->thrust + AUVID_C(1.0) : AUVID_C(1.0);
    }
    memset(ev->band_sse, 0, sizeof ev->band_sse);
    ev->at.spent = 0;
}

const auvid_path_t auvid_path_residual = {.check = metric_check_residual,
                                          .make_filter = metric_make_mean,
                                          .add_cell = metric_add_motion,
                                          .finish_row = metric_store_row,
                                          .begin = metric_begin_samples,
                                          .evaluate = metric_sample_cost,
                                          .linearise = auvid_metric_linearise_sets,
                                          .start = &auvid_start_newton};

#endif
