/*
 * Metric, residual path: the model linearised at an estimate.
 *
 * With e the smoothed residuals at (pi, d) and e_i, e_d their derivatives, the rows
 *
 *     [ e_1 .. e_n | Z_0 Z_1 Z_2 ],   Z_k = sum_i e_i pi_i - e - (k - s) node e_d,
 *
 * are those of a linear model with these derivatives. For s = d / node the weights l of the wrench
 * at the three delays have sum l_k = 1 and sum k l_k = s, so row [pi, -l(s)] = e. Its
 * derivative by d is e_d. The code that reads the R factors of the regressor path (change test,
 * confidence) also reads these.
 *
 * It is enough to take smoothed residuals one standard deviation of the smoothing apart: closer
 * ones add almost no information. The model is differentiated once at each stored row. The result
 * is added to all windows that contain the row, which are as many as are under way at once.
 */
#include "auvid_metric_evaluator_internal.h"

#include <string.h>

#include "auvid_metric_rows_internal.h"

#if AUVID_MAX_COMMANDS > 0

#define PARAMETER_STEP AUVID_C(0.01) /* relative */
#define MIN_STEP AUVID_C(1e-4)       /* rounding dominates smaller ones */
#define ZERO_STEP AUVID_C(1e-3)      /* of a parameter that is zero */
#define DELAY_STEP_S AUVID_C(0.01)   /* a tenth of a usual cell */

/* x = l[0] x + l[1] late[0] + l[2] late[1] */
static void metric_delay_inputs(const auvid_real_t *l, const auvid_row_t *row, int first,
                                auvid_real_t *x, int n)
{
    const auvid_real_t *middle = row->late[0] + first, *last = row->late[1] + first;
    const auvid_real_t l0 = l[0], l1 = l[1], l2 = l[2];
    for (; n > 0; --n, ++x) {
        *x = l0 * *x + l1 * *middle++ + l2 * *last++;
    }
}

const auvid_sample_t *auvid_metric_delayed_sample(const auvid_metric_t *m, const auvid_row_t *row,
                                                  auvid_sample_t *delayed)
{
    const auvid_real_t *l = m->evaluator.delay_weight;
    if (m->cfg.vehicle->ignores_inputs) {
        return &row->sample;
    }
    *delayed = row->sample;
    metric_delay_inputs(l, row, 0, delayed->tau, AUVID_DOF_COUNT);
    metric_delay_inputs(l, row, AUVID_DOF_COUNT, delayed->command, AUVID_MAX_COMMANDS);
    return delayed;
}

void auvid_metric_residual(const auvid_metric_t *m, auvid_row_t *row, const auvid_sample_t *sample,
                           int perturbed, auvid_real_t residual[AUVID_DOF_COUNT])
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    const auvid_real_t *pi = m->evaluator.pi;
    bool other = perturbed >= 0 && (vehicle->thrust_parameters >> perturbed & 1u) != 0;
    if (vehicle->thrust == NULL || other) {
        auvid_vehicle_residual(vehicle, sample, pi, residual);
        return;
    }
    if (!auvid_metric_has_thrust(m, row)) {
        bool known = vehicle->thrust(vehicle->context, sample, pi, row->sample.tau);
        row->late[0][0] = known ? m->evaluator.thrust : AUVID_C(0.0);
    }
    auvid_clear(residual, AUVID_DOF_COUNT);
    if (auvid_metric_has_thrust(m, row)) {
        vehicle->residual(vehicle->context, sample, pi, residual);
    }
}

/* Evaluate the residuals of a stored row with value (v - 1) / 2 perturbed by half a step: a
 * parameter or, after the last one, the delay; v odd: up, v even: down, v = 0: nothing. @return the
 * weight of the residuals in the central difference */
static auvid_real_t metric_evaluate_perturbed(auvid_metric_t *m, auvid_row_t *row, int v,
                                              auvid_real_t residual[AUVID_DOF_COUNT])
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    int i = (v - 1) / 2, n = m->cfg.vehicle->parameters;
    auvid_real_t sign = v % 2 == 1 ? AUVID_C(0.5) : AUVID_C(-0.5), step = AUVID_C(1.0);
    auvid_real_t node = auvid_metric_node_s(m), s = ev->linear_delay_s / node;
    auvid_sample_t delayed;
    if (v > 0 && i < n) {
        auvid_real_t pi = ev->pi[i];
        step = auvid_abs(pi) > AUVID_C(0.0) ? auvid_max(PARAMETER_STEP * auvid_abs(pi), MIN_STEP)
                                            : ZERO_STEP;
        ev->pi[i] = pi + sign * step;
        auvid_metric_residual(m, row, auvid_metric_delayed_sample(m, row, &delayed), i, residual);
        ev->pi[i] = pi;
    } else {
        step = v > 0 ? DELAY_STEP_S : step;
        auvid_metric_delay_weights(v > 0 ? s + sign * step / node : s, false, ev->delay_weight);
        auvid_metric_residual(m, row, auvid_metric_delayed_sample(m, row, &delayed), -1, residual);
    }
    return v > 0 ? (sign > AUVID_C(0.0) ? AUVID_C(1.0) : AUVID_C(-1.0)) / step : AUVID_C(1.0);
}

/* Add one evaluation to the row's derivatives in z: for each DoF those by its parameters, then e,
 * then e_d. */
static void metric_add_evaluation(auvid_metric_t *m, auvid_row_t *row, int v)
{
    auvid_real_t residual[AUVID_DOF_COUNT];
    auvid_real_t weight = metric_evaluate_perturbed(m, row, v, residual);
    int i = (v - 1) / 2, n = m->cfg.vehicle->parameters;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        auvid_real_t *z = m->evaluator.z + e.at;
        if (e.order == 0) {
            continue;
        }
        for (int k = 0; k < e.count && v > 0; ++k) {
            z[k] += e.index[k] == i ? weight * residual[j] : AUVID_C(0.0);
        }
        z[e.count] += v == 0 ? weight * residual[j] : AUVID_C(0.0);
        z[e.count + 1] += v > 0 && i == n ? weight * residual[j] : AUVID_C(0.0);
    }
}

/* Put the model's own derivatives by its parameters into z. */
static void metric_add_derivatives(auvid_metric_t *m, const auvid_row_t *row)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    auvid_sample_t delayed;
    memset(&ev->regressor, 0, sizeof ev->regressor);
    vehicle->regressor(vehicle->context, auvid_metric_delayed_sample(m, row, &delayed), ev->pi,
                       &ev->regressor);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        for (int k = 0; k < e.count; ++k) {
            ev->z[e.at + k] += ev->regressor.row[j][e.index[k]];
        }
    }
}

/* Returns true if evaluation v is needed: its value is free or the delay. With derivatives of the
 * model, evaluation 1 is that of all parameters. */
static bool metric_is_perturbed(const auvid_metric_t *m, int v)
{
    int i = (v - 1) / 2;
    if (m->cfg.vehicle->regressor != NULL && i < m->cfg.vehicle->parameters) {
        return v <= 1;
    }
    if (i == m->cfg.vehicle->parameters) {
        return !m->cfg.vehicle->ignores_inputs;
    }
    return v == 0 || m->cfg.free == 0 || (m->cfg.free >> i & 1u) != 0;
}

/* Cost of evaluation v at a row [units]. */
static uint32_t metric_evaluation_work(const auvid_metric_t *m, const auvid_row_t *row, int v)
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    int i = (v - 1) / 2;
    bool follows = m->evaluator.window_rows > 0;
    if (v == 1 && vehicle->regressor != NULL) {
        uint32_t work = vehicle->regressor_work > 0 ? vehicle->regressor_work : vehicle->work;
        return work + (follows ? 0u : vehicle->lead_work);
    }
    if (v > 0 && i < vehicle->parameters && (vehicle->thrust_parameters >> i & 1u) != 0) {
        return (uint32_t)vehicle->work + vehicle->lead_work;
    }
    return auvid_metric_residual_work(m, row, follows && vehicle->regressor != NULL);
}

/* Differentiate the model at one row. @return true if z is complete */
static bool metric_differentiate_row(auvid_metric_t *m, auvid_row_t *row, uint32_t *budget)
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    auvid_metric_cursor_t *at = &m->evaluator.at;
    if (at->part == 0) {
        memset(m->evaluator.z, 0, sizeof m->evaluator.z);
    }
    for (; at->part < 2 * vehicle->parameters + 3; ++at->part) {
        bool own = at->part == 1 && vehicle->regressor != NULL;
        if (!metric_is_perturbed(m, at->part)) {
            continue;
        }
        if (!auvid_metric_spend_model(m, budget, metric_evaluation_work(m, row, at->part))) {
            return false;
        }
        if (own) {
            metric_add_derivatives(m, row);
        } else {
            metric_add_evaluation(m, row, at->part);
        }
    }
    return true;
}

/* Add the row in z, the q-th since a gap, to the windows that contain it. Window i ends with row
 * length - 1 + i stride. */
static void metric_add_to_windows(auvid_metric_t *m, auvid_metric_windows_t *windows,
                                  uint8_t missing)
{
    uint32_t q = m->evaluator.window_rows, last = m->layout.window_length - 1u;
    uint32_t stride = (uint32_t)auvid_metric_stride(m), from = 0;
    if (q > last) {
        from = (q - last + stride - 1u) / stride;
    }
    for (uint32_t i = from; i <= q / stride; ++i) {
        uint32_t slot = i % AUVID_METRIC_WINDOWS, later = i * stride + last - q;
        if (later == last) {
            memset(windows->z[slot], 0, sizeof windows->z[slot]);
            windows->missing[slot] = 0;
        }
        auvid_metric_add_scaled(windows->z[slot], m->layout.window_weight[later], m->evaluator.z,
                                m->layout.channel_at[AUVID_DOF_COUNT]);
        windows->missing[slot] |= missing;
    }
}

/* Replace e by sum e_i pi_i - e in a complete window. */
static void metric_make_wrench(const auvid_metric_t *m, auvid_real_t *z, uint8_t excluded)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        auvid_real_t *of = z + e.at;
        if ((excluded >> j & 1) != 0) {
            auvid_clear(of, (size_t)e.order);
        } else if (e.order > 0) {
            of[e.count] = -of[e.count];
            for (int k = 0; k < e.count; ++k) {
                of[e.count] += of[k] * m->evaluator.pi[e.index[k]];
            }
        }
    }
}

/* Rotate a complete window into the R factors of the set in which it ends. A DoF has no row if a
 * velocity that its equation reads is missing somewhere in the window. */
static AUVID_NOINLINE void metric_finish_window(auvid_metric_t *m, auvid_set_t *set,
                                                auvid_real_t *z, uint8_t missing)
{
    auvid_real_t node = auvid_metric_node_s(m), s = m->evaluator.linear_delay_s / node;
    uint8_t excluded = auvid_vehicle_unmeasured(m->cfg.vehicle, missing);
    metric_make_wrench(m, z, excluded);
    if (auvid_all_within(z, m->layout.channel_at[AUVID_DOF_COUNT], METRIC_LARGEST_ENTRY) !=
        AUVID_OK) {
        return;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
        if (e.order == 0 || (excluded >> j & 1) != 0) {
            continue;
        }
        ++set->windows[j];
        memcpy(row, z + e.at, (size_t)e.count * sizeof *row);
        for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
            row[e.count + d] =
                z[e.at + e.count] - ((auvid_real_t)d - s) * node * z[e.at + e.count + 1];
        }
        auvid_qr_update(m->rows.set.factor[0] + m->layout.factor_at[j], e.order, 0, row);
    }
}

/* Linearise the rows of the set of that age. @param set where complete windows count; NULL: before
 * the first set, where none is complete. @return true if the set is complete */
static bool metric_linearise_set(auvid_metric_t *m, auvid_metric_windows_t *windows, int age,
                                 auvid_set_t *set, uint32_t *budget)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_metric_cursor_t *at = &ev->at;
    uint32_t last = m->layout.window_length - 1u, stride = (uint32_t)auvid_metric_stride(m);
    auvid_row_t *row = auvid_metric_rows(m, age) + at->row;
    for (int rows = auvid_metric_set(m, age)->rows; at->row < rows; ++at->row, ++row) {
        if (at->part == 0 && !auvid_metric_succeeds(m, row->sample.t_us)) {
            ev->window_rows = 0;
        }
        if (!metric_differentiate_row(m, row, budget)) {
            return false;
        }
        at->part = 0;
        metric_add_to_windows(m, windows, row->sample.missing);
        uint32_t q = ev->window_rows++;
        ev->window_us = row->sample.t_us;
        if (set != NULL && q >= last && (q - last) % stride == 0) {
            uint32_t slot = (q - last) / stride % AUVID_METRIC_WINDOWS;
            metric_finish_window(m, set, windows->z[slot], windows->missing[slot]);
        }
    }
    return true;
}

/* Returns the first row of a set from which a window reaches into the next set. */
static uint16_t metric_lead_in(const auvid_metric_t *m, int age)
{
    int row = auvid_metric_set(m, age)->rows - (m->layout.window_length - 1);
    return (uint16_t)(row > 0 ? row : 0);
}

/* Linearise the sets, the oldest first; before them the end of the one before. @return true if they
 * are complete */
static bool metric_linearise_rows(auvid_metric_t *m, auvid_metric_windows_t *windows,
                                  uint32_t *budget)
{
    auvid_metric_cursor_t *at = &m->evaluator.at;
    for (; at->set <= at->to_set; ++at->set, at->row = 0) {
        int age = at->to_set - at->set;
        auvid_set_t *set = NULL;
        if (at->set > 0) {
            set = &m->sets.set[auvid_metric_slot(m, age)];
        } else if (age >= auvid_metric_sets(m)) {
            continue;
        }
        if (at->row == 0 && at->part == 0 && set == NULL) {
            at->row = metric_lead_in(m, age);
        } else if (at->row == 0 && at->part == 0) {
            memset(m->rows.set.factor, 0, sizeof m->rows.set.factor);
            memset(set->windows, 0, sizeof set->windows);
        }
        if (!metric_linearise_set(m, windows, age, set, budget)) {
            return false;
        }
        if (set != NULL) {
            auvid_metric_pack(m, set);
        }
    }
    return true;
}

auvid_status_t auvid_metric_linearise_sets(auvid_metric_t *m, auvid_metric_windows_t *windows,
                                           uint32_t *budget)
{
    auvid_metric_cursor_t *at = &m->evaluator.at;
    if (at->pass == PASS_LINEAR) {
        if (!metric_linearise_rows(m, windows, budget)) {
            return AUVID_PENDING;
        }
        if (at->to_set < m->cfg.sets) {
            return AUVID_OK;
        }
        auvid_metric_restart_pass(m, PASS_LAST);
    }
    auvid_status_t status = auvid_metric_merge_sets(m, budget);
    if (status == AUVID_OK) {
        m->result.constant = AUVID_C(0.0); /* the cost of this path contains it */
    }
    return status;
}

bool auvid_metric_newton_row(const auvid_metric_t *m, int j, int i, auvid_real_t delay_s,
                             auvid_real_t *row, auvid_real_t *delay)
{
    auvid_equation_t e = auvid_metric_equation(m, j);
    if (i >= e.order || !auvid_metric_is_excited(m, j)) {
        return false;
    }
    auvid_real_t l[AUVID_METRIC_DELAYS], slope[AUVID_METRIC_DELAYS];
    auvid_real_t node = auvid_metric_node_s(m), scale = auvid_sqrt(m->evaluator.weight[j]);
    auvid_metric_delay_weights(delay_s / node, false, l);
    auvid_metric_delay_slopes(delay_s / node, false, slope);
    auvid_clear(row, (size_t)m->cfg.vehicle->parameters + 1u);
    *delay = AUVID_C(0.0);
    const auvid_real_t *r = auvid_equation_row(&e, i);
    for (int k = i; k < e.order; ++k, ++r) {
        if (k < e.count) {
            row[e.index[k]] = scale * *r;
        } else {
            row[m->cfg.vehicle->parameters] += scale * *r * l[k - e.count];
            *delay -= scale * *r * slope[k - e.count] / node;
        }
    }
    return true;
}

#endif
