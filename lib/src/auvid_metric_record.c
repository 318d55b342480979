/*
 * Metric, recording (Karras et al. 2013, III-B): cells to rows to sets.
 *
 * The filter runs in transposed form: each cell is added, with the right coefficient, to the few
 * rows under construction, so no window of cells is kept.
 */
#include "auvid/metric.h"

#include <string.h>

#include "auvid_linalg.h"
#include "auvid_metric.h"

/* Larger entries of a row are taken for a fault: the squares of 60000 such rows are still finite in
 * single precision. */
#define LARGEST_ENTRY AUVID_C(1e15)

/* Wrench and commands at node `delay`, each AUVID_METRIC_DELAY_CELLS cells. */
static const auvid_real_t *delayed(const auvid_metric_t *m, int delay)
{
    enum { PAST = sizeof m->past_tau / sizeof m->past_tau[0] };
    uint32_t ago = (uint32_t)(delay * AUVID_METRIC_DELAY_CELLS), now = m->cells % PAST;
    return m->past_tau[now >= ago ? now - ago : now + PAST - ago];
}

/* Channels of the path that smooths motion: attitude, nu, nu_dot, wrench and commands at all
 * delays. The literal reading makes its accelerations of nu. */
static void motion_channels(const auvid_metric_t *m, const auvid_sample_t *s, auvid_real_t *channel)
{
    enum { INPUTS = AUVID_DOF_COUNT + AUVID_MAX_COMMANDS };
    bool literal = auvid_metric_is_literal(&m->cfg);
    channel[0] = s->phi;
    channel[1] = s->theta;
    channel[2] = s->psi;
    memcpy(channel + MOTION_NU, s->nu, sizeof s->nu);
    memcpy(channel + MOTION_NU_DOT, literal ? s->nu : s->nu_dot, sizeof s->nu_dot);
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        memcpy(channel + MOTION_TAU + d * INPUTS, delayed(m, d), INPUTS * sizeof channel[0]);
    }
}

/* Channels of the regressor path stand in sections of one weight each: of the forces what their
 * parameters are multiplied by, then their wrench at three delays; then the same of the moments.
 * Where section i of these four begins: */
static int section(const auvid_metric_t *m, int i)
{
    int j = i < 2 ? AUVID_SURGE : AUVID_ROLL;
    return m->channel_at[j] + (i % 2 ? m->count[j] + m->count[j + 1] + m->count[j + 2] : 0);
}

/* What fixed parameters explain of DoF j's wrench. */
static auvid_real_t explained(const auvid_metric_t *m, int j, const auvid_real_t *row)
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

/* Fill the sections. @return do fixed parameters explain anything? */
static bool row_channels(const auvid_metric_t *m, const auvid_sample_t *s, auvid_real_t *channel,
                         auvid_real_t known[AUVID_DOF_COUNT])
{
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    const auvid_real_t *late[AUVID_METRIC_DELAYS];
    auvid_real_t *motion = channel, *wrench = channel + section(m, 1);
    bool any = false;
    auvid_regressor_t y;
    auvid_clear(y.row[0], sizeof y / sizeof y.row[0][0]);
    vehicle->regressor(vehicle->context, s, &y);
    for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
        late[d] = delayed(m, d);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (j == AUVID_ROLL) {
            motion = channel + section(m, 2);
            wrench = channel + section(m, 3);
        }
        known[j] = AUVID_C(0.0);
        if (vehicle->columns[j] == 0) {
            continue;
        }
        known[j] = explained(m, j, y.row[j]);
        any = any || auvid_abs(known[j]) > AUVID_C(0.0);
        const uint8_t *index = m->index + m->channel_at[j];
        for (int k = m->count[j]; k > 0; --k) {
            *motion++ = y.row[j][*index++];
        }
        for (int d = 0; d < AUVID_METRIC_DELAYS; ++d) {
            *wrench++ = late[d][j];
        }
    }
    return any;
}

/* What is left to explain of the wrench. */
static void part_known(const auvid_metric_t *m, auvid_real_t *channel,
                       const auvid_real_t known[AUVID_DOF_COUNT])
{
    auvid_real_t *wrench = channel + section(m, 1);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench = j == AUVID_ROLL ? channel + section(m, 3) : wrench;
        for (int d = 0; d < AUVID_METRIC_DELAYS && m->cfg.vehicle->columns[j] != 0; ++d) {
            *wrench++ -= known[j];
        }
    }
}

/* Weight of the wrench of forces besides kernel[age], which motion has too: see auvid_metric.c. */
static auvid_real_t spread_weight(const auvid_metric_t *m, uint32_t age)
{
    const auvid_real_t *kernel = m->kernel[0];
    auvid_real_t before = age > 0 ? kernel[age - 1] : AUVID_C(0.0);
    auvid_real_t after = age + 1u < m->taps ? kernel[age + 1u] : AUVID_C(0.0);
    return m->spread * (before - AUVID_C(2.0) * kernel[age] + after);
}

/* y += a x; four at a time, which halves its cost */
AUVID_INLINE void add_scaled(auvid_real_t *y, auvid_real_t a, const auvid_real_t *x, int n)
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

/* Add weight * channel to row under construction `slot`; `age` cells have gone into it before.
 * known: null, where it is zero. */
static void accumulate_rows(auvid_metric_t *m, uint32_t slot, uint32_t age,
                            const auvid_real_t *channel, const auvid_real_t *known)
{
    const auvid_real_t force = m->kernel[0][age], moment = m->kernel[1][age];
    int wrench = section(m, 1), moments = section(m, 2), end = m->channel_at[AUVID_DOF_COUNT];
    auvid_real_t *row = m->accumulator[slot];
    add_scaled(row, force, channel, wrench);
    add_scaled(row + wrench, force + spread_weight(m, age), channel + wrench, moments - wrench);
    if (auvid_abs(moment) > AUVID_C(0.0)) { /* its kernel is shorter */
        add_scaled(row + moments, moment, channel + moments, end - moments);
    }
    for (int j = 0; known != NULL && j < AUVID_DOF_COUNT; ++j) {
        m->known[slot][j] += (j < AUVID_ROLL ? force : moment) * known[j];
    }
}

/* The same for channels of motion. */
static void accumulate_motion(auvid_metric_t *m, uint32_t slot, uint32_t age,
                              const auvid_real_t *channel)
{
    auvid_real_t *row = m->accumulator[slot];
    bool literal = auvid_metric_is_literal(&m->cfg);
    auvid_real_t smooth = m->kernel[0][age];
    auvid_real_t derivative = literal ? m->kernel[1][age] : smooth;
    auvid_real_t raw = literal ? (age == m->taps / 2u ? AUVID_C(1.0) : AUVID_C(0.0)) : smooth;
    for (int i = 0; i < AUVID_METRIC_MOTION_CHANNELS; ++i) {
        row[i] += (i < MOTION_NU_DOT ? smooth : (i < MOTION_TAU ? derivative : raw)) * channel[i];
    }
}

/* Mean and sum of squares about it, one value at a time (Welford). */
static void watch_wrench(auvid_set_t *set, int j, auvid_real_t tau)
{
    auvid_real_t off = tau - set->tau_mean[j];
    set->tau_mean[j] += off / (auvid_real_t)set->rows;
    set->tau_m2[j] += off * (tau - set->tau_mean[j]);
}

static void sample_from_channels(const auvid_real_t *channel, auvid_sample_t *s)
{
    memset(s, 0, sizeof *s);
    s->phi = channel[0];
    s->theta = channel[1];
    s->psi = channel[2];
    memcpy(s->nu, channel + MOTION_NU, sizeof s->nu);
    memcpy(s->nu_dot, channel + MOTION_NU_DOT, sizeof s->nu_dot);
    memcpy(s->tau, channel + MOTION_TAU, sizeof s->tau);
    memcpy(s->command, channel + MOTION_COMMAND, sizeof s->command);
}

/* Rows of the literal reading: of the smoothed sample, with the raw wrench in the middle of the
 * window instead of the newest. */
static void literal_channels(const auvid_metric_t *m, const auvid_sample_t *s,
                             const auvid_real_t *motion, auvid_real_t *channel)
{
    enum { INPUTS = AUVID_DOF_COUNT + AUVID_MAX_COMMANDS };
    auvid_real_t known[AUVID_DOF_COUNT];
    (void)row_channels(m, s, channel, known);
    auvid_real_t *wrench = channel + section(m, 1);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench = j == AUVID_ROLL ? channel + section(m, 3) : wrench;
        for (int d = 0; d < AUVID_METRIC_DELAYS && m->cfg.vehicle->columns[j] != 0; ++d) {
            *wrench++ = motion[MOTION_TAU + d * INPUTS + j];
        }
    }
    part_known(m, channel, known);
}

/* row = a / 2 + half b */
static inline void half_sum(auvid_real_t *row, const auvid_real_t *a, auvid_real_t half,
                            const auvid_real_t *b, int n)
{
    for (int i = 0; i < n; ++i) {
        row[i] = AUVID_C(0.5) * a[i] + half * b[i];
    }
}

/* Sums and differences of this row and the last go into the triangles. The factor 1/2 makes the two
 * bands together weigh as much as the rows themselves:
 *     ||a + b||^2 / 4 + ||a - b||^2 / 4 = (||a||^2 + ||b||^2) / 2                              */
static void rotate_row(auvid_metric_t *m, const auvid_real_t *channel)
{
    auvid_set_t *set = &m->set[m->current];
    int wrench = section(m, 1), motion = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench = j == AUVID_ROLL ? section(m, 3) : wrench;
        motion = j == AUVID_ROLL ? section(m, 2) : motion;
        int count = m->count[j], n = auvid_metric_order(m, j);
        uint32_t lag = m->cfg.lag[j >= AUVID_ROLL];
        const auvid_real_t *previous =
            m->previous[(m->since_gap + AUVID_METRIC_LAGS - lag) % AUVID_METRIC_LAGS];
        for (int band = 0; band < AUVID_METRIC_BANDS && n > 0 && m->since_gap >= lag; ++band) {
            auvid_real_t row[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
            auvid_real_t half = band == 0 ? AUVID_C(0.5) : AUVID_C(-0.5);
            half_sum(row, channel + motion, half, previous + motion, count);
            half_sum(row + count, channel + wrench, half, previous + wrench, n - count);
            auvid_triangle_add(set->factor[band] + m->factor_at[j], n, 0, row);
        }
        motion += count;
        wrench += n - count;
    }
    memcpy(m->previous[m->since_gap % AUVID_METRIC_LAGS], channel,
           m->channel_at[AUVID_DOF_COUNT] * sizeof channel[0]);
    ++m->since_gap;
}

static void store_row(auvid_metric_t *m, const auvid_sample_t *sample, const auvid_real_t *channel)
{
    uint32_t rows = m->set[m->current].rows;
    auvid_row_t *store = &m->cfg.rows[(uint32_t)m->current * m->cfg.set_rows + rows - 1u];
    store->sample = *sample;
    memcpy(store->late, channel + MOTION_LATE, sizeof store->late);
}

/* A row is complete: into the triangles, or into the store. One in which the regressor failed does
 * not count: its wrench would pass for explained. */
static AUVID_APART void finish_row(auvid_metric_t *m, uint64_t t_us, uint32_t slot)
{
    auvid_real_t *channel = m->accumulator[slot], *equations = channel;
    auvid_real_t literal[AUVID_MAX_COLUMNS];
    auvid_set_t *set = &m->set[m->current];
    const auvid_vehicle_t *vehicle = m->cfg.vehicle;
    bool motion = auvid_metric_smooths_motion(m);
    auvid_sample_t sample;
    if (!motion) {
        part_known(m, channel, m->known[slot]);
    } else {
        sample_from_channels(channel, &sample);
        sample.t_us = t_us;
        if (auvid_metric_has_regressor(m)) {
            literal_channels(m, &sample, channel, literal);
            equations = literal;
        }
    }
    size_t n = !auvid_metric_has_regressor(m) ? 0u : m->channel_at[AUVID_DOF_COUNT];
    if (auvid_all_within(equations, n, LARGEST_ENTRY) != AUVID_OK) {
        m->since_gap = 0;
        return;
    }
    ++set->rows;
    const auvid_real_t *wrench = channel + section(m, 1);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench = j == AUVID_ROLL ? channel + section(m, 3) : wrench;
        if (vehicle->columns[j] != 0) {
            watch_wrench(set, j, motion ? channel[MOTION_TAU + j] : wrench[0] + m->known[slot][j]);
            wrench += AUVID_METRIC_DELAYS;
        }
    }
    if (!auvid_metric_has_regressor(m)) {
        store_row(m, &sample, channel);
    } else {
        rotate_row(m, equations);
    }
}

auvid_status_t auvid_metric_close(auvid_metric_t *metric)
{
    if (metric == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_set_t *set = &metric->set[metric->current];
    if (set->rows == 0) {
        return AUVID_ERR_NO_DATA;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t least = metric->cfg.driven * metric->cfg.tau_max[j];
        bool driven = metric->cfg.vehicle->columns[j] != 0 &&
                      set->tau_m2[j] > least * least * (auvid_real_t)set->rows;
        set->driven = (uint8_t)(set->driven | (unsigned)driven << j);
    }
    bool kept = auvid_metric_free_of(metric, set->driven) != 0;
    ++metric->sets_recorded;
    metric->current = (uint8_t)((metric->current + kept) % (metric->cfg.sets + 1));
    memset(&metric->set[metric->current], 0, sizeof metric->set[0]);
    return kept ? AUVID_SET_COMPLETE : AUVID_SET_IDLE;
}

/* Add a cell to the rows under construction. @return slot of the row that it completes, or -1 */
static AUVID_APART int add_to_rows(auvid_metric_t *m, const auvid_sample_t *sample)
{
    enum { PAST = sizeof m->past_tau / sizeof m->past_tau[0] };
    if (m->cells + 1 < PAST) { /* the wrench is not yet known at all delays */
        return -1;
    }
    auvid_real_t channel[AUVID_MAX_COLUMNS], known[AUVID_DOF_COUNT];
    uint32_t n = m->cells + 1 - PAST, step = m->cfg.row_cells;
    bool motion = auvid_metric_smooths_motion(m), any = false;
    if (motion) {
        motion_channels(m, sample, channel);
    } else {
        any = row_channels(m, sample, channel, known);
    }
    uint32_t age = n % step, slot = n / step % m->overlap;
    if (age == 0) {
        auvid_clear(m->accumulator[slot], AUVID_MAX_COLUMNS);
        auvid_clear(m->known[slot], AUVID_DOF_COUNT);
    }
    int complete = -1;
    for (; age < m->taps && age <= n; age += step) {
        if (motion) {
            accumulate_motion(m, slot, age, channel);
        } else {
            accumulate_rows(m, slot, age, channel, any ? known : NULL);
        }
        complete = age + 1u == m->taps ? (int)slot : -1;
        slot = slot > 0 ? slot - 1u : m->overlap - 1u;
    }
    return complete;
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
    enum { PAST = sizeof m->past_tau / sizeof m->past_tau[0] };
    memcpy(m->past_tau[m->cells % PAST], sample->tau, sizeof sample->tau);
    memcpy(m->past_tau[m->cells % PAST] + AUVID_DOF_COUNT, sample->command, sizeof sample->command);
    auvid_status_t status = AUVID_OK;
    int slot = add_to_rows(m, sample);
    if (slot >= 0) {
        uint64_t middle = sample->t_us - (uint64_t)(m->taps - 1u) * m->cfg.cell_us / 2u;
        finish_row(m, middle, (uint32_t)slot);
        if (m->set[m->current].rows >= m->cfg.set_rows) {
            status = auvid_metric_close(m);
        }
    }
    ++m->cells;
    return status;
}

void auvid_metric_gap(auvid_metric_t *metric)
{
    if (metric != NULL) {
        metric->cells = 0;
        metric->since_gap = 0;
    }
}

auvid_status_t auvid_metric_drop(auvid_metric_t *metric, uint8_t age)
{
    if (metric == NULL) {
        return AUVID_ERR_NULL;
    }
    if (age >= metric->cfg.sets || age >= metric->sets_recorded) {
        return AUVID_ERR_RANGE;
    }
    auvid_set_t *set = &metric->set[auvid_metric_slot(metric, age)];
    if (set->rows == 0) {
        return AUVID_ERR_RANGE; /* dropped before */
    }
    memset(set, 0, sizeof *set);
    return AUVID_OK;
}
