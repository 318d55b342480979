/*
 * Metric, recording: completion of a set, and rows that arrive while the ring is held.
 */
#include "auvid/detail/metric.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "auvid_metric_internal.h"

auvid_status_t auvid_metric_close(auvid_metric_t *metric)
{
    auvid_metric_t *m = metric;
    if (m == NULL) {
        return AUVID_ERR_NULL;
    }
    if (m->rows.set.rows == 0) {
        return AUVID_ERR_NO_DATA;
    }
    uint8_t excited = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t min_rms = m->cfg.excitation_threshold * m->cfg.tau_max[j];
        bool is_excited =
            m->cfg.vehicle->columns[j] != 0 &&
            m->rows.set.tau_m2[j] > min_rms * min_rms * (auvid_real_t)m->rows.set.rows_of[j];
        excited = (uint8_t)(excited | (unsigned)is_excited << j);
    }
    bool kept = auvid_metric_free_of(m, excited) != 0;
    if (kept && m->sets.held && auvid_metric_stores_rows(m)) {
        m->sets.full = true;
        return AUVID_PENDING;
    }
    if (kept) {
        auvid_metric_store_set(m, excited);
    }
    ++m->sets.recorded;
    m->rows.set.rows = 0;
    memset(m->rows.set.rows_of, 0, sizeof m->rows.set.rows_of);
    m->rows.set.lost = 0;
    memset(m->rows.set.fastest, 0, sizeof m->rows.set.fastest);
    memset(m->rows.set.factor, 0, sizeof m->rows.set.factor);
    memset(m->rows.set.tau_mean, 0, sizeof m->rows.set.tau_mean);
    memset(m->rows.set.tau_m2, 0, sizeof m->rows.set.tau_m2);
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
    auvid_metric_t *m = metric;
    if (m == NULL) {
        return AUVID_ERR_NULL;
    }
    bool full = m->sets.full;
    m->sets.held = m->sets.full = m->sets.changed = false;
    m->sets.from = m->sets.least = 0;
    if (!full) {
        return AUVID_OK;
    }
    m->sets.resume_us = resume_us;
    return m->rows.set.rows > 0 ? auvid_metric_close(m) : AUVID_OK;
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
    memset(set, 0, sizeof *set);
    return AUVID_OK;
}
