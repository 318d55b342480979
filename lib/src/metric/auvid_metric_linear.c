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
#include "auvid/detail/metric.h"

#include <string.h>

#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_internal.h"

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
        r = m->sets.set[auvid_metric_slot(m, ++age)].rows - 1;
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
    int i = (v - 1) / 2, n = m->cfg.vehicle->parameters;
    auvid_real_t sign = v % 2 == 1 ? AUVID_C(0.5) : AUVID_C(-0.5), step = AUVID_C(1.0);
    auvid_real_t node = auvid_metric_node_s(m), s = m->evaluator.linear_delay_s / node;
    if (v > 0 && i < n) {
        auvid_real_t pi = m->evaluator.pi[i];
        step = auvid_abs(pi) > AUVID_C(0.0) ? auvid_max(PARAMETER_STEP * auvid_abs(pi), MIN_STEP)
                                            : ZERO_STEP;
        m->evaluator.pi[i] = pi + sign * step;
        auvid_sample_t sample = auvid_metric_delayed_sample(m, row);
        auvid_vehicle_residual(m->cfg.vehicle, &sample, m->evaluator.pi, residual);
        m->evaluator.pi[i] = pi;
    } else {
        step = v > 0 ? DELAY_STEP_S : step;
        auvid_metric_delay_weights(v > 0 ? s + sign * step / node : s, false,
                                   m->evaluator.delay_weight);
        auvid_sample_t sample = auvid_metric_delayed_sample(m, row);
        auvid_vehicle_residual(m->cfg.vehicle, &sample, m->evaluator.pi, residual);
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
        auvid_real_t *z = m->evaluator.z + m->layout.channel_at[j];
        if (auvid_metric_order(m, j) == 0) {
            continue;
        }
        for (int k = 0; k < m->layout.count[j] && v > 0; ++k) {
            z[k] += m->layout.index[m->layout.channel_at[j] + k] == i ? weight * residual[j]
                                                                      : AUVID_C(0.0);
        }
        z[m->layout.count[j]] += v == 0 ? weight * residual[j] : AUVID_C(0.0);
        z[m->layout.count[j] + 1] += v > 0 && i == n ? weight * residual[j] : AUVID_C(0.0);
    }
}

/* Add the model's own derivatives by its parameters to z. */
static void metric_add_derivatives(auvid_metric_t *m, const auvid_row_t *row, auvid_real_t tap)
{
    auvid_sample_t sample = auvid_metric_delayed_sample(m, row);
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    memset(&m->evaluator.regressor, 0, sizeof m->evaluator.regressor);
    vehicle->regressor(vehicle->context, &sample, m->evaluator.pi, &m->evaluator.regressor);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int k = 0, at = m->layout.channel_at[j]; k < m->layout.count[j]; ++k) {
            m->evaluator.z[at + k] += tap * m->evaluator.regressor.row[j][m->layout.index[at + k]];
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
    auvid_real_t node = auvid_metric_node_s(m), s = m->evaluator.linear_delay_s / node;
    /* replace e by sum e_i pi_i - e */
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t *z = m->evaluator.z + m->layout.channel_at[j];
        int count = m->layout.count[j];
        if (auvid_metric_order(m, j) == 0) {
            continue;
        }
        if ((excluded >> j & 1) != 0) {
            auvid_clear(z, (size_t)auvid_metric_order(m, j));
            continue;
        }
        z[count] = -z[count];
        for (int k = 0; k < count; ++k) {
            z[count] += z[k] * m->evaluator.pi[m->layout.index[m->layout.channel_at[j] + k]];
        }
    }
    if (auvid_all_within(m->evaluator.z, m->layout.channel_at[AUVID_DOF_COUNT],
                         METRIC_LARGEST_ENTRY) != AUVID_OK) {
        return;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const auvid_real_t *z = m->evaluator.z + m->layout.channel_at[j];
        auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
        int count = m->layout.count[j];
        if (auvid_metric_order(m, j) == 0 || (excluded >> j & 1) != 0) {
            continue;
        }
        ++set->windows[j];
        memcpy(row, z, (size_t)count * sizeof *row);
        for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
            row[count + d] = z[count] - ((auvid_real_t)d - s) * node * z[count + 1];
        }
        auvid_qr_update(m->rows.set.factor[0] + m->layout.factor_at[j], auvid_metric_order(m, j), 0,
                        row);
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
    int values = 2 * m->cfg.vehicle->parameters + 3, stride = auvid_metric_stride(m);
    for (; m->evaluator.at.row < set->rows;
         m->evaluator.at.row = (uint16_t)(m->evaluator.at.row + stride), m->evaluator.at.part = 0) {
        if (m->evaluator.at.part == 0) {
            if (!metric_has_window(m, m->evaluator.at.set, m->evaluator.at.row)) {
                continue;
            }
            memset(m->evaluator.z, 0, sizeof m->evaluator.z);
        }
        for (; m->evaluator.at.part < values * m->layout.window_length; ++m->evaluator.at.part) {
            int k = m->evaluator.at.part / values, v = m->evaluator.at.part % values;
            if (!metric_is_perturbed(m, v)) {
                continue;
            }
            if (!auvid_metric_spend_model(m, budget)) {
                return false;
            }
            const auvid_row_t *row =
                metric_row_before(m, m->evaluator.at.set, m->evaluator.at.row, k);
            if (v == 1 && m->cfg.vehicle->regressor != NULL) {
                metric_add_derivatives(m, row, m->layout.window_weight[k]);
            } else {
                metric_add_evaluation(m, row, m->layout.window_weight[k], v);
            }
        }
        metric_finish_window(
            m, set, metric_dofs_without_window(m, m->evaluator.at.set, m->evaluator.at.row));
    }
    return true;
}

auvid_status_t auvid_metric_linearise_sets(auvid_metric_t *m, uint32_t *budget)
{
    for (; m->evaluator.at.pass == PASS_LINEAR && m->evaluator.at.set < m->evaluator.at.to_set;
         ++m->evaluator.at.set, m->evaluator.at.row = 0) {
        auvid_set_t *set = &m->sets.set[auvid_metric_slot(m, m->evaluator.at.set)];
        if (m->evaluator.at.row == 0 && m->evaluator.at.part == 0) {
            memset(m->rows.set.factor, 0, sizeof m->rows.set.factor);
            memset(set->windows, 0, sizeof set->windows);
        }
        if (!metric_linearise_set(m, set, budget)) {
            return AUVID_PENDING;
        }
        auvid_metric_pack(m, set);
    }
    if (m->evaluator.at.pass == PASS_LINEAR) {
        if (m->evaluator.at.to_set < m->cfg.sets) {
            return AUVID_OK;
        }
        auvid_metric_restart_pass(m, PASS_LAST);
    }
    if (!auvid_metric_merge_sets(m, budget)) {
        return AUVID_PENDING;
    }
    m->result.constant = AUVID_C(0.0); /* the cost of this path contains it */
    return AUVID_OK;
}

#endif
