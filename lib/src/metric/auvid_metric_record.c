/*
 * Metric, recording (Karras et al. 2013, III-B): cells to rows. auvid_metric_close.c completes
 * sets.
 *
 * The filter runs in transposed form: each cell is added, with the right coefficient, to the few
 * rows under construction, so no window of cells is stored.
 */
#include "auvid/metric.h"

#include <string.h>

#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_internal.h"

/* Number of cells whose inputs are stored. */
enum { PAST = AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1) + 1 };
/* Wrench and commands. */
enum { INPUTS = AUVID_DOF_COUNT + AUVID_MAX_COMMANDS };

/* Where the regressor is evaluated: in memory that only the residual path needs, or else on the
 * stack. */
#if AUVID_REGRESSOR_ONLY
#define REGRESSOR(metric) (&(auvid_regressor_t){{{AUVID_C(0.0)}}})
#else
#define REGRESSOR(metric) (&(metric)->regressor)
#endif

/* Returns wrench and commands at delay number `delay`, in steps of AUVID_METRIC_DELAY_CELLS. */
static const auvid_real_t *metric_delayed_inputs(const auvid_metric_t *m, int delay)
{
    uint32_t ago = (uint32_t)(delay * AUVID_METRIC_DELAY_CELLS), now = m->cells % PAST;
    return m->past_tau[now >= ago ? now - ago : now + PAST - ago];
}

/* The channels of the regressor path form four sections of one weight each. The forces have the
 * factors of their parameters, then their wrench at three delays; the moments have the same.
 * Returns where section i begins. */
static int metric_section(const auvid_metric_t *m, int i)
{
    int j = i < 2 ? AUVID_SURGE : AUVID_ROLL;
    return m->channel_at[j] + (i % 2 ? m->count[j] + m->count[j + 1] + m->count[j + 2] : 0);
}

/* Returns the part of DoF j's wrench that fixed parameters explain. */
static auvid_real_t metric_explained_by_fixed(const auvid_metric_t *m, int j,
                                              const auvid_real_t *row)
{
    auvid_real_t sum = AUVID_C(0.0);
    uint32_t fixed = m->cfg.vehicle->columns[j] & ~m->columns[j];
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
    m->cfg.vehicle->regressor(m->cfg.vehicle->context, s, y);
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
        fixed[j] = metric_explained_by_fixed(m, j, y->row[j]);
        any = any || auvid_abs(fixed[j]) > AUVID_C(0.0);
        const uint8_t *index = m->index + m->channel_at[j];
        for (int k = m->count[j]; k > 0; --k) {
            *motion++ = y->row[j][*index++];
        }
        for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
            *wrench++ = late[d][j];
        }
    }
    return any;
}

/* Returns the weight of the wrench of forces in addition to kernel[age]: see auvid_metric.c. */
static auvid_real_t metric_spread_weight(const auvid_metric_t *m, uint32_t age)
{
    const auvid_real_t *kernel = m->kernel[0];
    auvid_real_t before = age > 0 ? kernel[age - 1] : AUVID_C(0.0);
    auvid_real_t after = age + 1u < m->taps ? kernel[age + 1u] : AUVID_C(0.0);
    return m->interpolation_spread * (before - AUVID_C(2.0) * kernel[age] + after);
}

/* y += a x; four entries at a time, which halves the cost. */
AUVID_INLINE void metric_add_scaled(auvid_real_t *y, auvid_real_t a, const auvid_real_t *x, int n)
{
    for (; n >= 4; n -= 4, x += 4, y += 4) {
        y[0] += a * x[0];
        y[1] += a * x[1];
        y[2] += a * x[2];
        y[3] += a * x[3];
    }
    for (; n > 0; --n) {
        *y++ += a * *x++;
    }
}

/* Record the velocities that were not measured in a cell with a weight in the row. */
static void metric_record_missing(auvid_metric_t *m, uint32_t slot, uint32_t age, uint8_t missing)
{
    for (int moment = 0; moment <= 1 && missing != 0; ++moment) {
        bool counts =
            !auvid_metric_has_regressor(m) || auvid_abs(m->kernel[moment][age]) > AUVID_C(0.0);
        m->missing[slot][moment] |= counts ? missing : 0u;
    }
}

/* Returns the DoF (bit j) that have no row, because the model reads a missing velocity. */
static uint8_t metric_dofs_without_row(const auvid_metric_t *m, uint32_t slot)
{
    unsigned forces = auvid_vehicle_unmeasured(m->cfg.vehicle, m->missing[slot][0]);
    unsigned moments = auvid_vehicle_unmeasured(m->cfg.vehicle, m->missing[slot][1]);
    return (uint8_t)((forces & 7u) | (moments & ~7u));
}

/* Add weight * channel to the row under construction `slot`, which has `age` cells. fixed: NULL if
 * it is zero. */
static void metric_accumulate_rows(auvid_metric_t *m, uint32_t slot, uint32_t age,
                                   const auvid_real_t *channel, const auvid_real_t *fixed,
                                   uint8_t missing)
{
    const auvid_real_t force = m->kernel[0][age], moment = m->kernel[1][age];
    int wrench = metric_section(m, 1), moments = metric_section(m, 2),
        end = m->channel_at[AUVID_DOF_COUNT];
    auvid_real_t *row = m->accumulator[slot];
    metric_record_missing(m, slot, age, missing);
    metric_add_scaled(row, force, channel, wrench);
    metric_add_scaled(row + wrench, force + metric_spread_weight(m, age), channel + wrench,
                      moments - wrench);
    if (auvid_abs(moment) > AUVID_C(0.0)) { /* the kernel of moments is shorter */
        metric_add_scaled(row + moments, moment, channel + moments, end - moments);
    }
    for (int j = 0; fixed != NULL && j < AUVID_DOF_COUNT; ++j) {
        m->fixed_wrench[slot][j] += (j < AUVID_ROLL ? force : moment) * fixed[j];
    }
}

/* The same in the residual path: attitude, nu, nu_dot, inputs at all delays. */
static void metric_accumulate_motion(auvid_metric_t *m, uint32_t slot, uint32_t age,
                                     const auvid_sample_t *s)
{
    auvid_real_t *row = m->accumulator[slot];
    auvid_real_t weight = m->kernel[0][age];
    metric_record_missing(m, slot, age, s->missing);
    row[0] += weight * s->phi;
    row[1] += weight * s->theta;
    row[2] += weight * s->psi;
    metric_add_scaled(row + MOTION_NU, weight, s->nu, AUVID_DOF_COUNT);
    metric_add_scaled(row + MOTION_NU_DOT, weight, s->nu_dot, AUVID_DOF_COUNT);
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        metric_add_scaled(row + MOTION_TAU + d * INPUTS, weight, metric_delayed_inputs(m, d),
                          INPUTS);
    }
}

/* Update the mean of the wrench and the sum of squares about it by one value (Welford). */
static void metric_update_wrench_moments(auvid_metric_t *m, int j, auvid_real_t tau)
{
    auvid_real_t off = tau - m->tau_mean[j];
    m->tau_mean[j] += off / (auvid_real_t)++m->rows_of[j];
    m->tau_m2[j] += off * (tau - m->tau_mean[j]);
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

/* Rotate sums and differences of this row and an earlier one into DoF j's R factors. The factor 1/2
 * gives the two bands together the weight of the rows themselves:
 *     ||a + b||^2 / 4 + ||a - b||^2 / 4 = (||a||^2 + ||b||^2) / 2                              */
static void metric_rotate_row(auvid_metric_t *m, int j, const auvid_real_t *row)
{
    int at = m->channel_at[j], n = auvid_metric_order(m, j);
    uint32_t lag = m->cfg.lag[j >= AUVID_ROLL];
    const auvid_real_t *previous =
        m->previous[(m->since_gap + AUVID_METRIC_LAGS - lag) % AUVID_METRIC_LAGS] + at;
    for (int band = 0; band < AUVID_METRIC_BANDS && m->successive[j] >= lag; ++band) {
        auvid_real_t sum[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
        auvid_real_t other = band == 0 ? AUVID_C(0.5) : AUVID_C(-0.5);
        for (int i = 0; i < n; ++i) {
            sum[i] = AUVID_C(0.5) * row[i] + other * previous[i];
        }
        auvid_qr_update(m->factor[band] + m->factor_at[j], n, 0, sum);
    }
    memcpy(m->previous[m->since_gap % AUVID_METRIC_LAGS] + at, row, (size_t)n * sizeof *row);
    m->successive[j] = (uint8_t)(m->successive[j] + (m->successive[j] < AUVID_METRIC_LAGS));
}

static void metric_count_lost_rows(auvid_metric_t *m, uint32_t rows)
{
    uint32_t lost = m->lost + rows;
    m->lost = (uint16_t)(lost < UINT16_MAX ? lost : UINT16_MAX);
}

/* Count a row: taken if some DoF has taken it, else lost. */
static AUVID_NOINLINE void metric_count_row(auvid_metric_t *m, bool taken)
{
    m->rows = (uint16_t)(m->rows + taken);
    metric_count_lost_rows(m, !taken);
}

/* Take a row of the regressor path into the R factors, except for the DoF in `excluded`. A row in
 * which the regressor failed does not count: its wrench would seem explained. */
static void metric_take_row(auvid_metric_t *m, const auvid_real_t *channel,
                            const auvid_real_t *fixed, uint8_t excluded)
{
    const auvid_real_t *motion = channel, *wrench = channel + metric_section(m, 1);
    if (auvid_all_within(channel, m->channel_at[AUVID_DOF_COUNT], METRIC_LARGEST_ENTRY) !=
            AUVID_OK ||
        auvid_all_within(fixed, AUVID_DOF_COUNT, METRIC_LARGEST_ENTRY) != AUVID_OK) {
        memset(m->successive, 0, sizeof m->successive);
        return;
    }
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
        int count = m->count[j];
        if (j == AUVID_ROLL) {
            motion = channel + metric_section(m, 2);
            wrench = channel + metric_section(m, 3);
        }
        if (auvid_metric_order(m, j) == 0) {
            continue;
        }
        if ((excluded >> j & 1) != 0) {
            m->successive[j] = 0;
            motion += count;
            wrench += AUVID_METRIC_DELAYS;
            continue;
        }
        any = true;
        metric_update_wrench_moments(m, j, *wrench);
        memcpy(row, motion, (size_t)count * sizeof *row);
        motion += count;
        for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
            row[count + d] = *wrench++ - fixed[j];
        }
        metric_rotate_row(m, j, row);
    }
    metric_count_row(m, any);
    ++m->since_gap;
}

/* Store a row of the residual path if there is room. It is counted if an equation of the model can
 * use it. */
static void metric_store_row(auvid_metric_t *m, uint64_t t_us, uint32_t slot)
{
    if (m->full || t_us < m->resume_us) {
        ++m->rows_dropped;
        return;
    }
    const auvid_real_t *channel = m->accumulator[slot];
    auvid_row_t *store = auvid_metric_rows(m, -1) + m->rows;
    uint8_t excluded = metric_dofs_without_row(m, slot);
    bool any = false;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool has_row = (excluded >> j & 1) == 0;
        any = any || (has_row && m->cfg.vehicle->columns[j] != 0);
        if (has_row) {
            metric_update_wrench_moments(m, j, channel[MOTION_TAU + j]);
        }
    }
    metric_sample_from_channels(channel, t_us, &store->sample);
    store->sample.missing = m->missing[slot][0];
    memcpy(store->late, channel + MOTION_LATE, sizeof store->late);
    metric_count_row(m, any);
}

/* Process a complete row. */
static AUVID_NOINLINE void metric_finish_row(auvid_metric_t *m, uint64_t t_us, uint32_t slot)
{
    if (!auvid_metric_has_regressor(m)) {
        metric_store_row(m, t_us, slot);
        return;
    }
    metric_take_row(m, m->accumulator[slot], m->fixed_wrench[slot],
                    metric_dofs_without_row(m, slot));
}

/* Add the motion in cell n of the record to all rows under construction. The newest, begun
 * n % row_cells cells ago, is at `slot`. */
static void metric_add_motion(auvid_metric_t *m, const auvid_sample_t *sample, uint32_t n,
                              uint32_t slot)
{
    uint32_t step = m->cfg.row_cells;
    for (uint32_t age = n % step; age < m->taps && age <= n; age += step) {
        metric_accumulate_motion(m, slot, age, sample);
        slot = slot > 0 ? slot - 1u : m->overlap - 1u;
    }
}

/* The same for the equations of the regressor path. */
static AUVID_NOINLINE void metric_add_equations(auvid_metric_t *m, const auvid_sample_t *sample,
                                                uint32_t n, uint32_t slot)
{
    auvid_real_t channel[AUVID_MAX_COLUMNS], fixed[AUVID_DOF_COUNT];
    const auvid_real_t *late[AUVID_METRIC_DELAYS];
    auvid_regressor_t *y = REGRESSOR(m);
    uint32_t step = m->cfg.row_cells;
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        late[d] = metric_delayed_inputs(m, d);
    }
    metric_evaluate(m, sample, y);
    bool any = metric_row_channels(m, y, late, channel, fixed);
    for (uint32_t age = n % step; age < m->taps && age <= n; age += step) {
        metric_accumulate_rows(m, slot, age, channel, any ? fixed : NULL, sample->missing);
        slot = slot > 0 ? slot - 1u : m->overlap - 1u;
    }
}

/* Add a cell to the rows under construction. @return slot of the row that it completes; -1: none */
static int metric_add_to_rows(auvid_metric_t *m, const auvid_sample_t *sample)
{
    if (m->cells + 1 < PAST) { /* the wrench is not yet known at all delays */
        return -1;
    }
    uint32_t n = m->cells + 1 - PAST, step = m->cfg.row_cells, last = m->taps - 1u;
    uint32_t slot = n / step % m->overlap;
    if (n % step == 0) {
        auvid_clear(m->accumulator[slot], AUVID_MAX_COLUMNS);
        auvid_clear(m->fixed_wrench[slot], AUVID_DOF_COUNT);
        memset(m->missing[slot], 0, sizeof m->missing[slot]);
    }
    if (auvid_metric_has_regressor(m)) {
        metric_add_equations(m, sample, n, slot);
    } else {
        metric_add_motion(m, sample, n, slot);
    }
    return n >= last && (n - last) % step == 0 ? (int)((n - last) / step % m->overlap) : -1;
}

/* Update the largest speed in each direction, in thousandths. */
static void metric_update_max_speed(auvid_metric_t *m, const auvid_sample_t *sample)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t speed = AUVID_C(1000.0) * auvid_abs(sample->nu[j]);
        uint16_t *fastest = &m->fastest[j][sample->nu[j] < AUVID_C(0.0)];
        if ((sample->missing >> j & 1) == 0 && speed > (auvid_real_t)*fastest) {
            *fastest = (uint16_t)auvid_min(speed, (auvid_real_t)UINT16_MAX);
        }
    }
}

auvid_status_t auvid_metric_add(auvid_metric_t *metric, const auvid_sample_t *sample)
{
    if (metric == NULL || sample == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_metric_t *m = metric;
    if (!auvid_is_finite(sample->phi) || !auvid_is_finite(sample->theta) ||
        !auvid_is_finite(sample->psi) || !auvid_all_finite(sample->nu, AUVID_DOF_COUNT) ||
        !auvid_all_finite(sample->nu_dot, AUVID_DOF_COUNT) ||
        !auvid_all_finite(sample->tau, AUVID_DOF_COUNT) ||
        !auvid_all_finite(sample->command, AUVID_MAX_COMMANDS)) {
        return AUVID_ERR_NOT_FINITE;
    }
    m->full = m->full || (m->held && sample->t_us > m->until_us);
    if (!m->full && sample->t_us >= m->resume_us) {
        metric_update_max_speed(m, sample);
    }
    memcpy(m->past_tau[m->cells % PAST], sample->tau, sizeof sample->tau);
    memcpy(m->past_tau[m->cells % PAST] + AUVID_DOF_COUNT, sample->command, sizeof sample->command);
    auvid_status_t status = AUVID_OK;
    int slot = metric_add_to_rows(m, sample);
    if (slot >= 0) {
        uint64_t middle = sample->t_us - (uint64_t)(m->taps - 1u) * m->cfg.cell_us / 2u;
        metric_finish_row(m, middle, (uint32_t)slot);
        if (m->rows >= m->cfg.set_rows) {
            status = auvid_metric_close(m);
        }
    }
    ++m->cells;
    return status == AUVID_PENDING ? AUVID_OK : status;
}

void auvid_metric_gap(auvid_metric_t *metric)
{
    if (metric != NULL) {
        uint32_t cells = PAST - 1u + metric->taps - 1u; /* before the first row */
        cells = metric->cells < cells ? metric->cells : cells;
        metric_count_lost_rows(metric, cells / metric->cfg.row_cells);
        metric->cells = 0;
        memset(metric->successive, 0, sizeof metric->successive);
    }
}
