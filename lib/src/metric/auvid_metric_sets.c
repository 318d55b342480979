/*
 * Metric, sets: the ring of completed sets, and their R factors in half the memory.
 *
 * An entry is an integer times 2^e. The exponent e is common to its column in both bands, and is
 * the smallest for which the largest entry stays below 2^15. Columns differ by orders of magnitude,
 * and the parameters that multiply them differ inversely. So the rounding error of the force of
 * each parameter is 2^-16 of its largest value in each row, independently. Measured with Girona500,
 * its sensors' noise and no disturbance: estimates change by 0.009 standard errors (rms); with a
 * disturbance of 1 N by 0.004. With one e for each row instead of each column it would be 0.7.
 */
#include "auvid_metric_sets_internal.h"

#include <string.h>

#include "../base/auvid_checksum_internal.h"
#include "../base/auvid_linalg_internal.h"

enum { DIGITS = AUVID_METRIC_DIGITS };

/* Smallest variance of a set's wrench relative to that of the residual, for a DoF to count as
 * excited. A controller that only holds still answers the disturbance with a wrench as large: the
 * motion is then that of the residual, and such rows bias the parameters (Ljung 1999, 13.4).
 * Simulated station keeping in field mixtures: 2431 of 2432 sets and DoF have at most 1.7, one has
 * 2.7; a BlueROV2's stabiliser 2.8. Excitation and joystick have more in 99 % in mixtures of usual
 * size, in 73 to 84 % in those twice as large. */
#define MIN_EXCITATION AUVID_C(3.0)

int auvid_metric_sets(const auvid_metric_t *m)
{
    return m->sets.from < m->cfg.sets ? m->cfg.sets - m->sets.from : 0;
}

const auvid_set_t *auvid_metric_set(const auvid_metric_t *m, int age)
{
    uint32_t back = m->sets.from + (uint32_t)age;
    return &m->sets.set[auvid_metric_ring_index(m->sets.stored, m->cfg.sets, back)];
}

int auvid_metric_slot(const auvid_metric_t *m, int age)
{
    return (int)(auvid_metric_set(m, age) - m->sets.set);
}

/* ---- storage ---- */

/* 2^e, -126 <= e <= 126. */
static auvid_real_t metric_power_of_two(int e)
{
    return auvid_from_single_bits((uint32_t)(e + 127) << 23);
}

/* Returns the smallest e >= -126 with 1.0001 x < 2^(e + DIGITS); the margin is for rounding. */
static int metric_exponent(auvid_real_t x)
{
    int e = (int)(auvid_single_bits(AUVID_C(1.0001) * x) >> 23) - 126 - DIGITS;
    return e < -126 ? -126 : e;
}

/* Pack column k of DoF j's R factor, of order n. Rows were within bounds, so all is finite. */
static void metric_pack_column(const auvid_metric_t *m, auvid_set_t *set, int j, int n, int k)
{
    const auvid_real_t *low = m->rows.set.factor[0], *high = m->rows.set.factor[1];
    int top = m->layout.factor_at[j] + k;
    auvid_real_t largest = AUVID_C(0.0);
    for (int i = 0, at = top; i <= k; at += n - ++i) {
        largest = auvid_abs(low[at]) > largest ? auvid_abs(low[at]) : largest;
        largest = auvid_abs(high[at]) > largest ? auvid_abs(high[at]) : largest;
    }
    int e = metric_exponent(largest);
    auvid_real_t scale = metric_power_of_two(-e);
    set->exponent[m->layout.channel_at[j] + k] = (int8_t)e;
    for (int i = 0, at = top; i <= k; at += n - ++i) {
        set->factor[0][at] = (auvid_packed_t)auvid_half_further(scale * low[at]);
        set->factor[1][at] = (auvid_packed_t)auvid_half_further(scale * high[at]);
    }
}

void auvid_metric_pack(const auvid_metric_t *m, auvid_set_t *set)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int n = auvid_metric_order(m, j);
        for (int k = 0; k < n; ++k) {
            metric_pack_column(m, set, j, n, k);
        }
    }
}

void auvid_metric_unpack_row(const auvid_metric_t *m, const auvid_set_t *set, int band, int j,
                             int i, auvid_real_t *row)
{
    int n = auvid_metric_order(m, j);
    const auvid_packed_t *packed =
        set->factor[band] + m->layout.factor_at[j] + auvid_qr_row(n, i) - i;
    const int8_t *exponent = set->exponent + m->layout.channel_at[j];
    for (int k = i; k < n; ++k) {
        row[k] = (auvid_real_t)packed[k] * metric_power_of_two(exponent[k]);
    }
}

int auvid_metric_read_row(const auvid_metric_t *m, const auvid_set_t *set, int band, int j, int i,
                          auvid_real_t *row)
{
    auvid_real_t stored[AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS];
    const uint8_t *index = m->layout.index + m->layout.channel_at[j];
    const uint8_t *merged = m->layout.merged_index + m->layout.channel_at[j];
    int count = m->layout.count[j], order = auvid_metric_order(m, j);
    if (!auvid_metric_may_be_coupled(m, j)) {
        auvid_metric_unpack_row(m, set, band, j, i, row);
        return i;
    }
    auvid_clear(stored, AUVID_MAX_PARAMETERS + AUVID_METRIC_DELAYS);
    auvid_metric_unpack_row(m, set, band, j, i, stored);
    for (int to = 0; to < order; ++to) {
        int from = to;
        for (int k = 0; k < count && to < count && index[from] != merged[to]; ++k) {
            from = (from + 1) % count;
        }
        row[to] = stored[from]; /* zero before column i */
    }
    return 0;
}

/* ---- the ring ---- */

/* Returns the slot of the set stored `back` - 1 sets before the last one; 0: of the next set. */
static AUVID_NOINLINE auvid_set_t *metric_set_slot(auvid_metric_t *m, uint32_t back)
{
    return &m->sets.set[(m->sets.stored + m->cfg.sets - back) % m->cfg.sets];
}

/* Returns true if the next set would overwrite one that is still needed. */
static bool metric_slot_is_needed(auvid_metric_t *m)
{
    uint32_t max_waiting = m->cfg.sets > 4 ? (m->cfg.sets - 1u) / 2u : 1u;
    if (!m->sets.held) {
        return m->sets.waiting >= m->cfg.sets;
    }
    return metric_set_slot(m, 0)->rows > 0 &&
           (m->sets.waiting >= max_waiting || auvid_metric_sets(m) <= m->sets.least);
}

/* Make room for a set. While the ring is held, the sets that count keep more than half of it: the
 * oldest waiting set is then lost and the others move up. @return its slot; NULL: the new set is
 * lost */
static auvid_set_t *metric_make_room(auvid_metric_t *m)
{
    auvid_metric_sets_t *sets = &m->sets;
    bool full = metric_slot_is_needed(m);
    if (full) {
        sets->rows_dropped +=
            sets->waiting > 0 ? metric_set_slot(m, sets->waiting)->rows : m->rows.set.rows;
    } else {
        ++sets->waiting;
    }
    if (sets->waiting == 0) {
        return NULL;
    }
    if (full && sets->held) {
        for (uint32_t back = sets->waiting; back > 1; --back) {
            *metric_set_slot(m, back) = *metric_set_slot(m, back - 1u);
        }
    } else {
        ++sets->stored;
        sets->from = (uint8_t)(sets->from + sets->held);
        sets->changed = sets->held;
    }
    return metric_set_slot(m, 1);
}

/* Store the set being recorded in the ring, in place of the oldest; `excited`: bit j, DoF j. */
static void metric_store_set(auvid_metric_t *m, uint8_t excited)
{
    const auvid_partial_set_t *recorded = &m->rows.set;
    auvid_set_t *set = metric_make_room(m);
    if (set == NULL) {
        return;
    }
    auvid_zero(set, sizeof *set);
    set->number = m->sets.recorded + 1u;
    set->rows = recorded->rows;
    memcpy(set->rows_of, recorded->rows_of, sizeof set->rows_of);
    set->lost = recorded->lost;
    memcpy(set->fastest, recorded->fastest, sizeof set->fastest);
    set->excited = excited;
    memcpy(set->tau_m2, recorded->tau_m2, sizeof set->tau_m2);
    if (!auvid_metric_stores_rows(m)) {
        auvid_metric_pack(m, set);
    }
}

auvid_status_t auvid_metric_close(auvid_metric_t *metric)
{
    auvid_metric_t *m = metric;
    if (m == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_partial_set_t *set = &m->rows.set;
    if (set->rows == 0) {
        return AUVID_ERR_NO_DATA;
    }
    auvid_metric_rotate_rows(m);
    uint8_t excited = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t min_rms = m->cfg.excitation_threshold * m->cfg.tau_max[j],
                     min_m2 = auvid_max(min_rms * min_rms, m->sets.min_wrench_m2[j]);
        bool is_excited = m->cfg.vehicle->columns[j] != 0 &&
                          set->tau_m2[j] > min_m2 * (auvid_real_t)set->rows_of[j];
        excited = (uint8_t)(excited | (unsigned)is_excited << j);
    }
    bool kept = auvid_metric_free_of(m, excited) != 0;
    if (kept && m->sets.held && auvid_metric_stores_rows(m)) {
        m->sets.full = true;
        return AUVID_PENDING;
    }
    if (kept) {
        metric_store_set(m, excited);
    }
    ++m->sets.recorded;
    auvid_zero(set, sizeof *set);
    return kept ? AUVID_SET_COMPLETE : AUVID_SET_IDLE;
}

void auvid_metric_hold(auvid_metric_t *metric, uint64_t until_us)
{
    if (metric != NULL) {
        metric->sets.held = true;
        metric->sets.waiting = 0;
        metric->sets.until_us = auvid_metric_stores_rows(metric) ? until_us : UINT64_MAX;
    }
}

auvid_status_t auvid_metric_release(auvid_metric_t *metric, uint64_t resume_us)
{
    if (metric == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_metric_sets_t *sets = &metric->sets;
    bool full = sets->full;
    sets->held = sets->full = sets->changed = false;
    sets->from = sets->least = 0;
    if (!full) {
        return AUVID_OK;
    }
    sets->resume_us = resume_us;
    return metric->rows.set.rows > 0 ? auvid_metric_close(metric) : AUVID_OK;
}

auvid_status_t auvid_metric_drop(auvid_metric_t *metric, uint8_t age)
{
    if (metric == NULL) {
        return AUVID_ERR_NULL;
    }
    if (age >= auvid_metric_sets(metric) || age >= metric->sets.recorded) {
        return AUVID_ERR_RANGE;
    }
    auvid_set_t *set = &metric->sets.set[auvid_metric_slot(metric, age)];
    if (set->rows == 0) {
        return AUVID_ERR_RANGE; /* already deleted */
    }
    auvid_zero(set, sizeof *set);
    return AUVID_OK;
}

/* ---- what the sets show ---- */

const auvid_set_t *auvid_metric_newest(const auvid_metric_t *metric)
{
    int age = 0;
    while (age + 1 < auvid_metric_sets(metric) && auvid_metric_set(metric, age)->rows == 0) {
        ++age;
    }
    return auvid_metric_set(metric, age);
}

int auvid_metric_excited_sets(const auvid_metric_t *metric, int j, int newest)
{
    int sets = 0;
    for (int age = newest; age < auvid_metric_sets(metric); ++age) {
        sets += auvid_metric_set(metric, age)->excited >> j & 1;
    }
    return sets;
}

auvid_real_t auvid_metric_wrench_squares(const auvid_metric_t *m, int j, auvid_real_t *rows)
{
    auvid_real_t squares = AUVID_C(0.0);
    *rows = AUVID_C(0.0);
    for (int age = 0; age < auvid_metric_sets(m); ++age) {
        const auvid_set_t *set = auvid_metric_set(m, age);
        if (set->excited >> j & 1) {
            squares += set->tau_m2[j];
            *rows += (auvid_real_t)set->rows_of[j];
        }
    }
    return squares;
}

void auvid_metric_set_residual(auvid_metric_t *m, const auvid_real_t rms[AUVID_DOF_COUNT])
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t rows, squares = auvid_metric_wrench_squares(m, j, &rows),
                           min_m2 = MIN_EXCITATION * rms[j] * rms[j];
        m->sets.min_wrench_m2[j] = squares > min_m2 * rows ? min_m2 : AUVID_C(0.0);
    }
}
