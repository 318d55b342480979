/*
 * Metric, storage: the R factors of completed sets in half the memory.
 *
 * An entry is an integer times 2^e. The exponent e is common to its column in both bands, and is
 * the smallest for which the largest entry stays below 2^15. Columns differ by orders of magnitude,
 * and the parameters that multiply them differ inversely. So the rounding error of the force of
 * each parameter is 2^-16 of its largest value in each row, independently. Measured with Girona500,
 * its sensors' noise and no disturbance: estimates change by 0.009 standard errors (rms); with a
 * disturbance of 1 N by 0.004. With one e for each row instead of each column it would be 0.7.
 */
#include "auvid/detail/metric.h"

#include <string.h>

#include "../base/auvid_checksum_internal.h"
#include "../base/auvid_linalg_internal.h"
#include "auvid_metric_internal.h"

enum { DIGITS = AUVID_METRIC_DIGITS };

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
    int top = m->layout.factor_at[j] + k;
    auvid_real_t largest = AUVID_C(0.0);
    for (int i = 0, at = top; i <= k; at += n - ++i) {
        auvid_real_t low = auvid_abs(m->rows.set.factor[0][at]),
                     high = auvid_abs(m->rows.set.factor[1][at]);
        largest = low > largest ? low : largest;
        largest = high > largest ? high : largest;
    }
    int e = metric_exponent(largest);
    auvid_real_t scale = metric_power_of_two(-e);
    set->exponent[m->layout.channel_at[j] + k] = (int8_t)e;
    for (int i = 0, at = top; i <= k; at += n - ++i) {
        set->factor[0][at] = (auvid_packed_t)auvid_half_further(scale * m->rows.set.factor[0][at]);
        set->factor[1][at] = (auvid_packed_t)auvid_half_further(scale * m->rows.set.factor[1][at]);
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

/* Returns the slot of the set stored `back` - 1 sets before the last one; 0: of the next set. */
static auvid_set_t *metric_set_slot(auvid_metric_t *m, uint32_t back)
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
    bool full = metric_slot_is_needed(m);
    if (full) {
        m->sets.rows_dropped +=
            m->sets.waiting > 0 ? metric_set_slot(m, m->sets.waiting)->rows : m->rows.set.rows;
    } else {
        ++m->sets.waiting;
    }
    if (m->sets.waiting == 0) {
        return NULL;
    }
    if (full && m->sets.held) {
        for (uint32_t back = m->sets.waiting; back > 1; --back) {
            *metric_set_slot(m, back) = *metric_set_slot(m, back - 1u);
        }
    } else {
        ++m->sets.stored;
        m->sets.from = (uint8_t)(m->sets.from + m->sets.held);
        m->sets.changed = m->sets.held;
    }
    return metric_set_slot(m, 1);
}

void auvid_metric_store_set(auvid_metric_t *m, uint8_t excited)
{
    auvid_set_t *set = metric_make_room(m);
    if (set == NULL) {
        return;
    }
    memset(set, 0, sizeof *set);
    set->number = m->sets.recorded + 1u;
    set->rows = m->rows.set.rows;
    memcpy(set->rows_of, m->rows.set.rows_of, sizeof set->rows_of);
    set->lost = m->rows.set.lost;
    memcpy(set->fastest, m->rows.set.fastest, sizeof set->fastest);
    set->excited = excited;
    memcpy(set->tau_m2, m->rows.set.tau_m2, sizeof set->tau_m2);
    if (!auvid_metric_stores_rows(m)) {
        auvid_metric_pack(m, set);
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
