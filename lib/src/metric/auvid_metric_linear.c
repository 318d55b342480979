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
 * ones add almost no information.
 */
#include "auvid_metric_evaluator_internal.h"

#include <string.h>

#include "auvid_metric_rows_internal.h"

#if AUVID_MAX_COMMANDS > 0

#define PARAMETER_STEP AUVID_C(0.01) /* relative */
#define MIN_STEP AUVID_C(1e-4)       /* rounding dominates smaller ones */
#define ZERO_STEP AUVID_C(1e-3)      /* of a parameter that is zero */
#define DELAY_STEP_S AUVID_C(0.01)   /* a tenth of a usual cell */

auvid_sample_t auvid_metric_delayed_sample(const auvid_metric_t *m, const auvid_row_t *row)
{
    const auvid_real_t *l = m->evaluator.delay_weight;
    auvid_sample_t s = row->sample;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s.tau[j] = l[0] * s.tau[j] + l[1] * row->late[0][j] + l[2] * row->late[1][j];
    }
    for (int i = 0; i < AUVID_MAX_COMMANDS; ++i) {
        int k = AUVID_DOF_COUNT + i;
        s.command[i] = l[0] * s.command[i] + l[1] * row->late[0][k] + l[2] * row->late[1][k];
    }
    return s;
}

/* Returns the row `back` rows before row r of the set of that age; NULL if it is not stored. */
static const auvid_row_t *metric_row_before(const auvid_metric_t *m, int age, int r, int back)
{
    if (back > r) {
        if (age + 1 >= auvid_metric_sets(m)) {
            return NULL;
        }
        back -= r + 1;
        r = auvid_metric_set(m, ++age)->rows - 1;
    }
    return back > r ? NULL : &auvid_metric_rows(m, age)[r - back];
}

/* Returns true if the rows that end with row r form a complete window. */
static bool metric_has_window(const auvid_metric_t *m, int age, int r)
{
    const auvid_row_t *later = metric_row_before(m, age, r, 0);
    for (int k = 1; k < m->layout.window_length; ++k) {
        const auvid_row_t *row = metric_row_before(m, age, r, k);
        if (row == NULL || !auvid_metric_succeeds(m, row->sample.t_us, later->sample.t_us)) {
            return false;
        }
        later = row;
    }
    return true;
}

/* Evaluate the residuals of a stored row with value (v - 1) / 2 perturbed by half a step: a
 * parameter or, after the last one, the delay; v odd: up, v even: down, v = 0: nothing. @return the
 * weight of the residuals in the central difference */
static auvid_real_t metric_evaluate_perturbed(auvid_metric_t *m, const auvid_row_t *row, int v,
                                              auvid_real_t residual[AUVID_DOF_COUNT])
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    int i = (v - 1) / 2, n = m->cfg.vehicle->parameters;
    auvid_real_t sign = v % 2 == 1 ? AUVID_C(0.5) : AUVID_C(-0.5), step = AUVID_C(1.0);
    auvid_real_t node = auvid_metric_node_s(m), s = ev->linear_delay_s / node;
    if (v > 0 && i < n) {
        auvid_real_t pi = ev->pi[i];
        step = auvid_abs(pi) > AUVID_C(0.0) ? auvid_max(PARAMETER_STEP * auvid_abs(pi), MIN_STEP)
                                            : ZERO_STEP;
        ev->pi[i] = pi + sign * step;
        auvid_sample_t sample = auvid_metric_delayed_sample(m, row);
        auvid_vehicle_residual(m->cfg.vehicle, &sample, ev->pi, residual);
        ev->pi[i] = pi;
    } else {
        step = v > 0 ? DELAY_STEP_S : step;
        auvid_metric_delay_weights(v > 0 ? s + sign * step / node : s, false, ev->delay_weight);
        auvid_sample_t sample = auvid_metric_delayed_sample(m, row);
        auvid_vehicle_residual(m->cfg.vehicle, &sample, ev->pi, residual);
    }
    return v > 0 ? (sign > AUVID_C(0.0) ? AUVID_C(1.0) : AUVID_C(-1.0)) / step : AUVID_C(1.0);
}

/* Add one evaluation to the derivatives in z: for each DoF those by its parameters, then e, then
 * e_d. */
static void metric_add_evaluation(auvid_metric_t *m, const auvid_row_t *row, auvid_real_t tap,
                                  int v)
{
    auvid_real_t residual[AUVID_DOF_COUNT];
    auvid_real_t weight = tap * metric_evaluate_perturbed(m, row, v, residual);
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

/* Add the model's own derivatives by its parameters to z. */
static void metric_add_derivatives(auvid_metric_t *m, const auvid_row_t *row, auvid_real_t tap)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_sample_t sample = auvid_metric_delayed_sample(m, row);
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    memset(&ev->regressor, 0, sizeof ev->regressor);
    vehicle->regressor(vehicle->context, &sample, ev->pi, &ev->regressor);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        for (int k = 0; k < e.count; ++k) {
            ev->z[e.at + k] += tap * ev->regressor.row[j][e.index[k]];
        }
    }
}

/* Returns the DoF (bit j) that have no row: a velocity is missing in the window that ends with row
 * r. */
static uint8_t metric_dofs_without_window(const auvid_metric_t *m, int age, int r)
{
    uint8_t missing = 0;
    for (int k = 0; k < m->layout.window_length; ++k) {
        missing |= metric_row_before(m, age, r, k)->sample.missing;
    }
    return auvid_vehicle_unmeasured(m->cfg.vehicle, missing);
}

/* Rotate the complete derivatives into the R factors, except for the DoF in `excluded`. */
static AUVID_NOINLINE void metric_finish_window(auvid_metric_t *m, auvid_set_t *set,
                                                uint8_t excluded)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_real_t node = auvid_metric_node_s(m), s = ev->linear_delay_s / node;
    /* replace e by sum e_i pi_i - e */
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_equation_t e = auvid_metric_equation(m, j);
        auvid_real_t *z = ev->z + e.at;
        if (e.order == 0) {
            continue;
        }
        if ((excluded >> j & 1) != 0) {
            auvid_clear(z, (size_t)e.order);
            continue;
        }
        z[e.count] = -z[e.count];
        for (int k = 0; k < e.count; ++k) {
            z[e.count] += z[k] * ev->pi[e.index[k]];
        }
    }
    if (auvid_all_within(ev->z, m->layout.channel_at[AUVID_DOF_COUNT], METRIC_LARGEST_ENTRY) !=
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
        memcpy(row, e.z, (size_t)e.count * sizeof *row);
        for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
            row[e.count + d] = e.z[e.count] - ((auvid_real_t)d - s) * node * e.z[e.count + 1];
        }
        auvid_qr_update(m->rows.set.factor[0] + m->layout.factor_at[j], e.order, 0, row);
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
    return v == 0 || i == m->cfg.vehicle->parameters || m->cfg.free == 0 ||
           (m->cfg.free >> i & 1u) != 0;
}

/* Linearise all windows of one set. @return true if they are complete */
static bool metric_linearise_set(auvid_metric_t *m, auvid_set_t *set, uint32_t *budget)
{
    auvid_metric_cursor_t *at = &m->evaluator.at;
    int values = 2 * m->cfg.vehicle->parameters + 3, stride = auvid_metric_stride(m);
    for (; at->row < set->rows; at->row = (uint16_t)(at->row + stride), at->part = 0) {
        if (at->part == 0) {
            if (!metric_has_window(m, at->set, at->row)) {
                continue;
            }
            memset(m->evaluator.z, 0, sizeof m->evaluator.z);
        }
        for (; at->part < values * m->layout.window_length; ++at->part) {
            int k = at->part / values, v = at->part % values;
            if (!metric_is_perturbed(m, v)) {
                continue;
            }
            if (!auvid_metric_spend_model(m, budget)) {
                return false;
            }
            const auvid_row_t *row = metric_row_before(m, at->set, at->row, k);
            if (v == 1 && m->cfg.vehicle->regressor != NULL) {
                metric_add_derivatives(m, row, m->layout.window_weight[k]);
            } else {
                metric_add_evaluation(m, row, m->layout.window_weight[k], v);
            }
        }
        metric_finish_window(m, set, metric_dofs_without_window(m, at->set, at->row));
    }
    return true;
}

auvid_status_t auvid_metric_linearise_sets(auvid_metric_t *m, uint32_t *budget)
{
    auvid_metric_cursor_t *at = &m->evaluator.at;
    for (; at->pass == PASS_LINEAR && at->set < at->to_set; ++at->set, at->row = 0) {
        auvid_set_t *set = &m->sets.set[auvid_metric_slot(m, at->set)];
        if (at->row == 0 && at->part == 0) {
            memset(m->rows.set.factor, 0, sizeof m->rows.set.factor);
            memset(set->windows, 0, sizeof set->windows);
        }
        if (!metric_linearise_set(m, set, budget)) {
            return AUVID_PENDING;
        }
        auvid_metric_pack(m, set);
    }
    if (at->pass == PASS_LINEAR) {
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

#endif
