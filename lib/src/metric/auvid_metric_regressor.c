/*
 * Metric, regressor path: rows of equations that are linear in pi, and the cost of a candidate.
 *
 * The smoother is a finite impulse response. A smoother of taps c_i applied to the rows Y and the
 * wrench tau alike,
 *
 *     sum_i c_i Y_i pi = sum_i c_i tau_i,
 *
 * holds for the true pi exactly, so the choice of c is only a matter of noise. Savitzky-Golay of
 * order 2 and half-width 1 s, applied twice, passes the excitation (< 0.3 Hz) and attenuates the
 * noise of the DVL.
 *
 * Velocity that is interpolated between samples T apart has passed a triangular filter. Its
 * variance is T^2 / 6, averaged over the position of the sample within T. At 0.25 Hz and 5 Hz its
 * gain is 0.8 % low, and masses become too large by as much. So the wrench of forces also passes
 * (a, 1 - 2 a, a), of taps k cells apart, a = T^2 / (12 (k cell)^2), which has the same variance.
 * k is 1 for a DVL of 4 Hz or more (cells of 0.1 s). For a slower one the smoother is shorter, so
 * that both fit: what is interpolated over so long a time is smooth. (At 1 Hz, k = 1 makes the
 * heave mass of a BlueROV2 37 % too large instead of 4 %, tests/program/test_fit_columns.sh.)
 */
#include "auvid_metric_evaluator_internal.h"

#include <string.h>

#include "../base/auvid_refusal_internal.h"
#include "auvid_metric_rows_internal.h"

/* Where the regressor is evaluated: in memory that only the residual path needs, or else on the
 * stack. */
#if AUVID_MAX_COMMANDS == 0
#define REGRESSOR(metric) (&(auvid_regressor_t){{{AUVID_C(0.0)}}})
#else
#define REGRESSOR(metric) (&(metric)->evaluator.regressor)
#endif

/* Check the model and the width of the filter. */
static void metric_check_regressor(const auvid_metric_config_t *cfg, auvid_refusal_t *why)
{
    auvid_check_part(why, "vehicle");
    auvid_check_that(why, cfg->vehicle->regressor != NULL, AUVID_ERR_MODEL, "regressor");
    auvid_check_part(why, "metric");
    auvid_check_count(why, AUVID_ERR_SIZE, "half_width", auvid_metric_max_half(cfg),
                      AUVID_MAX_HALF_WIDTH);
}

/* Write Savitzky-Golay, as often as `passes` says, to the middle of the kernel. For n points and
 * order 2 (or 3) the middle has the weights 3 (3 n^2 - 7 - 20 k^2) / (4 n (n^2 - 4)); numerator and
 * denominator are exact in float up to n = 161. */
static void metric_make_kernel(const auvid_metric_t *m, auvid_real_t *kernel, uint8_t half_width)
{
    auvid_real_t *first = kernel + m->layout.taps / 2 - m->cfg.passes * half_width;
    int n = 2 * half_width + 1;
    for (int k = -half_width; k <= half_width; ++k) {
        first[half_width + k] =
            (auvid_real_t)(3 * (3 * n * n - 7 - 20 * k * k)) / (auvid_real_t)(4 * n * (n * n - 4));
    }
    for (int t = 2 * n - 2; m->cfg.passes == 2 && t >= 0; --t) { /* in place, from the end */
        auvid_real_t sum = AUVID_C(0.0);
        for (int i = t < n ? 0 : t - n + 1; i <= t && i < n; ++i) {
            sum += first[i] * first[t - i];
        }
        first[t] = sum;
    }
}

/* Returns the distance of the outer taps of the interpolation [cells], so that a is at most 1/2,
 * and they fit beside the shortest smoother. */
static int metric_interpolation_step(const auvid_metric_t *m, auvid_real_t spread)
{
    int step = 1, most = m->layout.taps / 2 - m->cfg.passes;
    while (step < most && spread > AUVID_C(0.5) * (auvid_real_t)(step * step)) {
        ++step;
    }
    return step;
}

void auvid_metric_set_velocity_us(auvid_metric_t *m, uint32_t velocity_us)
{
    auvid_metric_layout_t *layout = &m->layout;
    auvid_real_t cells = (auvid_real_t)velocity_us / (auvid_real_t)auvid_metric_cell_us(m);
    auvid_real_t spread = cells * cells / AUVID_C(12.0);
    m->cfg.velocity_us = velocity_us;
    if (auvid_metric_stores_rows(m)) {
        return;
    }
    int step = metric_interpolation_step(m, spread), half_width = m->cfg.half_width[0];
    int room = (layout->taps / 2 - step) / m->cfg.passes;
    half_width = velocity_us > 0 && room < half_width ? room : half_width;
    layout->interpolation_step = (uint8_t)step;
    layout->interpolation_spread = auvid_min(spread / (auvid_real_t)(step * step), AUVID_C(0.5));
    if (layout->half_width != half_width) {
        layout->half_width = (uint8_t)half_width;
        auvid_clear(layout->kernel[0], AUVID_MAX_TAPS);
        metric_make_kernel(m, layout->kernel[0], layout->half_width);
    }
}

static void metric_make_smoother(auvid_metric_t *m)
{
    auvid_metric_layout_t *layout = &m->layout;
    const auvid_metric_config_t *cfg = &m->cfg;
    layout->window_length = 1;
    auvid_metric_set_velocity_us(m, cfg->velocity_us);
    metric_make_kernel(m, layout->kernel[1], cfg->half_width[1]);
}

/* The channels of the regressor path form four sections of one weight each. The forces have the
 * factors of their parameters, then their wrench at three delays; the moments have the same.
 * Returns where section i begins. */
static int metric_section(const auvid_metric_t *m, int i)
{
    const auvid_metric_layout_t *layout = &m->layout;
    int j = i < 2 ? AUVID_SURGE : AUVID_ROLL;
    return layout->channel_at[j] +
           (i % 2 ? layout->count[j] + layout->count[j + 1] + layout->count[j + 2] : 0);
}

auvid_real_t auvid_metric_explained_by_fixed(const auvid_metric_t *m, int j,
                                             const auvid_real_t *row)
{
    auvid_real_t sum = AUVID_C(0.0);
    uint32_t fixed = m->cfg.vehicle->columns[j] & ~m->layout.columns[j];
    for (int i = 0; fixed != 0; ++i, fixed >>= 1) {
        for (; (fixed & 15u) == 0; fixed >>= 4) {
            i += 4;
        }
        sum += (fixed & 1u) != 0 ? row[i] * m->cfg.fixed[i] : AUVID_C(0.0);
    }
    return sum;
}

/* Evaluate the regressor into *y. */
static void metric_evaluate(const auvid_metric_t *m, const auvid_sample_t *s, auvid_regressor_t *y)
{
    auvid_clear(y->row[0], sizeof *y / sizeof y->row[0][0]);
    m->cfg.vehicle->regressor(m->cfg.vehicle->context, s, NULL, y);
}

/* Fill the sections. late: inputs at each delay; fixed: wrench explained by fixed parameters.
 * @return true if it is not zero */
static bool metric_row_channels(const auvid_metric_t *m, const auvid_regressor_t *y,
                                const auvid_real_t *const late[AUVID_METRIC_DELAYS],
                                auvid_real_t *channel, auvid_real_t fixed[AUVID_DOF_COUNT])
{
    auvid_real_t *motion = channel, *wrench = channel + metric_section(m, 1);
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (j == AUVID_ROLL) {
            motion = channel + metric_section(m, 2);
            wrench = channel + metric_section(m, 3);
        }
        fixed[j] = AUVID_C(0.0);
        if (m->cfg.vehicle->columns[j] == 0) {
            continue;
        }
        fixed[j] = auvid_metric_explained_by_fixed(m, j, y->row[j]);
        any = any || auvid_abs(fixed[j]) > AUVID_C(0.0);
        const uint8_t *index = m->layout.index + m->layout.channel_at[j];
        for (int k = m->layout.count[j]; k > 0; --k) {
            *motion++ = y->row[j][*index++];
        }
        for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
            *wrench++ = late[d][j];
        }
    }
    return any;
}

/* Returns the weight of the wrench of forces in addition to kernel[age]: see the top. */
static auvid_real_t metric_spread_weight(const auvid_metric_t *m, auvid_real_t spread, uint32_t age)
{
    const auvid_real_t *kernel = m->layout.kernel[0];
    const uint32_t step = m->layout.interpolation_step;
    auvid_real_t before = age >= step ? kernel[age - step] : AUVID_C(0.0);
    auvid_real_t after = age + step < m->layout.taps ? kernel[age + step] : AUVID_C(0.0);
    return spread * (before - AUVID_C(2.0) * kernel[age] + after);
}

void auvid_metric_add_extra(const auvid_metric_t *m, const auvid_metric_place_t *place,
                            auvid_metric_add_t *add, void *context)
{
    uint32_t slot = place->slot, n = place->n, step = m->cfg.row_cells;
    for (uint32_t age = n % step; age < m->layout.taps && age <= n; age += step) {
        const auvid_real_t motion[2] = {m->layout.kernel[0][age], m->layout.kernel[1][age]};
        auvid_real_t spread = metric_spread_weight(m, place->spread, age);
        const auvid_real_t thrust[2] = {motion[0] + spread, motion[1]};
        add(context, slot, age == 0, motion, thrust);
        slot = auvid_metric_earlier_slot(m, slot);
    }
}

const auvid_real_t *auvid_metric_complete_row(const auvid_metric_t *m, uint32_t slot, int j)
{
    int first = j < AUVID_ROLL ? AUVID_SURGE : AUVID_ROLL;
    const auvid_real_t *row = m->rows.accumulator[slot] + metric_section(m, j < AUVID_ROLL ? 0 : 2);
    for (int i = first; i < j; ++i) {
        row += m->layout.count[i];
    }
    return row;
}

/* Returns DoF j's wrench at each delay in the complete row at `slot`. */
static const auvid_real_t *metric_complete_wrench(const auvid_metric_t *m, uint32_t slot, int j)
{
    const auvid_real_t *wrench =
        m->rows.accumulator[slot] + metric_section(m, j < AUVID_ROLL ? 1 : 3);
    for (int i = j < AUVID_ROLL ? AUVID_SURGE : AUVID_ROLL; i < j; ++i) {
        wrench += auvid_metric_order(m, i) - m->layout.count[i];
    }
    return wrench;
}

/* Add weight * channel to the row under construction `slot`, which has `age` cells. fixed: NULL if
 * it is zero. */
static void metric_accumulate_rows(auvid_metric_t *m, uint32_t slot, uint32_t age,
                                   const auvid_real_t *channel, const auvid_real_t *fixed,
                                   uint8_t missing)
{
    const auvid_real_t force = m->layout.kernel[0][age], moment = m->layout.kernel[1][age];
    int wrench = metric_section(m, 1), moments = metric_section(m, 2),
        end = m->layout.channel_at[AUVID_DOF_COUNT];
    auvid_real_t *row = m->rows.accumulator[slot];
    auvid_metric_record_missing(m, slot, age, missing);
    auvid_metric_add_scaled(row, force, channel, wrench);
    auvid_metric_add_scaled(row + wrench,
                            force + metric_spread_weight(m, m->layout.interpolation_spread, age),
                            channel + wrench, moments - wrench);
    if (auvid_abs(moment) > AUVID_C(0.0)) { /* the kernel of moments is shorter */
        auvid_metric_add_scaled(row + moments, moment, channel + moments, end - moments);
    }
    for (int j = 0; fixed != NULL && j < AUVID_DOF_COUNT; ++j) {
        m->rows.fixed_wrench[slot][j] += (j < AUVID_ROLL ? force : moment) * fixed[j];
    }
}

/* Rotate sums and differences of this row and an earlier one into DoF j's R factors. The factor 1/2
 * gives the two bands together the weight of the rows themselves:
 *     ||a + b||^2 / 4 + ||a - b||^2 / 4 = (||a||^2 + ||b||^2) / 2                              */
static void metric_rotate_row(auvid_metric_t *m, int j, const auvid_real_t *row)
{
    auvid_metric_rows_t *rows = &m->rows;
    int at = m->layout.channel_at[j], n = auvid_metric_order(m, j);
    uint32_t lag = m->cfg.lag[j >= AUVID_ROLL], number = rows->since_gap - 1u;
    const auvid_real_t *previous =
        rows->previous[(number + AUVID_METRIC_LAGS - lag) % AUVID_METRIC_LAGS] + at;
    for (int band = 0; band < AUVID_METRIC_BANDS && rows->successive[j] >= lag; ++band) {
        auvid_real_t sum[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
        auvid_real_t other = band == 0 ? AUVID_C(0.5) : AUVID_C(-0.5);
        for (int i = 0; i < n; ++i) {
            sum[i] = AUVID_C(0.5) * row[i] + other * previous[i];
        }
        auvid_qr_update(rows->set.factor[band] + m->layout.factor_at[j], n, 0, sum);
    }
    memcpy(rows->previous[number % AUVID_METRIC_LAGS] + at, row, (size_t)n * sizeof *row);
    rows->successive[j] =
        (uint8_t)(rows->successive[j] + (rows->successive[j] < AUVID_METRIC_LAGS));
}

/* Rotate the row of up to ROTATED_DOFS DoF that wait. The last cell has completed it, so the next
 * one has not yet overwritten it. */
static void metric_rotate_dofs(auvid_metric_t *m)
{
    enum { ROTATED_DOFS = 2 };
    auvid_metric_rows_t *rows = &m->rows;
    uint32_t slot = auvid_metric_slot_of_complete(m, rows->cells - METRIC_PAST);
    int left = ROTATED_DOFS;
    for (int j = 0; rows->waiting >> j != 0 && left > 0; ++j) {
        auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
        int count = m->layout.count[j];
        if ((rows->waiting >> j & 1) == 0) {
            continue;
        }
        rows->waiting = (uint8_t)(rows->waiting & ~(1u << j));
        const auvid_real_t *wrench = metric_complete_wrench(m, slot, j);
        memcpy(row, auvid_metric_complete_row(m, slot, j), (size_t)count * sizeof *row);
        for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
            row[count + d] = wrench[d] - rows->fixed_wrench[slot][j];
        }
        metric_rotate_row(m, j, row);
        --left;
    }
}

/* Pass the complete row to the columns from outside. */
static void metric_take_extra(auvid_metric_t *m, uint32_t slot, bool counts, uint8_t dofs)
{
    if (m->extra != NULL) {
        m->extra->take(m->extra_context, m, slot, counts, dofs);
    }
}

/* Take a row, except for the DoF whose equation reads what was not measured: it waits for its
 * rotation. A row in which the regressor failed does not count: its wrench would seem explained. */
static void metric_take_row(auvid_metric_t *m, uint64_t t_us, uint32_t slot)
{
    auvid_metric_rows_t *rows = &m->rows;
    const auvid_real_t *channel = rows->accumulator[slot], *fixed = rows->fixed_wrench[slot];
    uint8_t excluded = auvid_metric_dofs_without_row(m, slot);
    (void)t_us;
    if (auvid_all_within(channel, m->layout.channel_at[AUVID_DOF_COUNT], METRIC_LARGEST_ENTRY) !=
            AUVID_OK ||
        auvid_all_within(fixed, AUVID_DOF_COUNT, METRIC_LARGEST_ENTRY) != AUVID_OK) {
        memset(rows->successive, 0, sizeof rows->successive);
        metric_take_extra(m, slot, false, 0);
        return;
    }
    uint8_t taken = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (auvid_metric_order(m, j) == 0) {
            continue;
        }
        if ((excluded >> j & 1) != 0) {
            rows->successive[j] = 0;
            continue;
        }
        taken = (uint8_t)(taken | 1u << j);
        auvid_metric_update_wrench_moments(&rows->set, j, *metric_complete_wrench(m, slot, j));
    }
    rows->waiting = taken;
    auvid_metric_count_row(&rows->set, taken != 0);
    ++rows->since_gap;
    metric_take_extra(m, slot, true, taken);
}

/* Add the equations of cell n of the record to all rows under construction. The newest, begun
 * n % row_cells cells ago, is at `slot`. */
static void metric_add_equations(auvid_metric_t *m, const auvid_sample_t *sample, uint32_t n,
                                 uint32_t slot)
{
    auvid_real_t channel[AUVID_MAX_COLUMNS], fixed[AUVID_DOF_COUNT];
    const auvid_real_t *late[AUVID_METRIC_DELAYS];
    auvid_regressor_t *y = REGRESSOR(m);
    uint32_t step = m->cfg.row_cells;
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        late[d] = auvid_metric_delayed_inputs(m, d);
    }
    metric_evaluate(m, sample, y);
    bool any = metric_row_channels(m, y, late, channel, fixed);
    if (m->extra != NULL) {
        m->extra->cell(m->extra_context, m, sample,
                       &(auvid_metric_place_t){n, slot, m->layout.interpolation_spread});
    }
    for (uint32_t age = n % step; age < m->layout.taps && age <= n; age += step) {
        metric_accumulate_rows(m, slot, age, channel, any ? fixed : NULL, sample->missing);
        slot = auvid_metric_earlier_slot(m, slot);
    }
}

/* J = sum_j weight_j ||R_j pi - z_j||^2, row by row. */
static auvid_status_t metric_factor_cost(auvid_metric_t *m, uint32_t *budget)
{
    auvid_metric_evaluator_t *ev = &m->evaluator;
    auvid_metric_cursor_t *at = &ev->at;
    for (; at->dof < AUVID_DOF_COUNT; ++at->dof, at->row = 0) {
        int j = at->dof;
        if (!auvid_metric_is_excited(m, j)) {
            continue;
        }
        auvid_equation_t equation = auvid_metric_equation(m, j);
        const auvid_real_t *x = ev->candidate + equation.at, *z = equation.z;
        const auvid_real_t *r = equation.factor + auvid_qr_row(equation.order, at->row);
        int count = equation.count;
        int i = at->row, left = count - i;
        int to = *budget < (uint32_t)left ? i + (int)*budget : count;
        auvid_real_t squares = ev->squares;
        *budget -= (uint32_t)(to - i);
        for (; i < to; ++i, r += AUVID_METRIC_DELAYS) {
            auvid_real_t e = -z[i];
            for (const auvid_real_t *xk = x + i; xk != x + count; ++xk, ++r) {
                e += *r * *xk;
            }
            squares += e * e;
        }
        ev->squares = squares;
        at->row = (uint16_t)i;
        if (i < count) {
            return AUVID_PENDING;
        }
        ev->sum += ev->weight[j] * ev->squares;
        ev->squares = AUVID_C(0.0);
    }
    m->result.cost = ev->sum;
    return AUVID_OK;
}

static auvid_status_t metric_evaluate_factor(auvid_metric_t *m, uint32_t *budget)
{
    if (m->evaluator.at.pass == PASS_COST) {
        return metric_factor_cost(m, budget);
    }
    return auvid_metric_for_each_row(m, budget) ? AUVID_OK : AUVID_PENDING;
}

const auvid_path_t auvid_path_regressor = {.check = metric_check_regressor,
                                           .make_filter = metric_make_smoother,
                                           .add_cell = metric_add_equations,
                                           .finish_row = metric_take_row,
                                           .rotate_row = metric_rotate_dofs,
                                           .evaluate = metric_evaluate_factor,
                                           .merge = auvid_metric_merge_sets,
                                           .start = &auvid_start_optimum};
