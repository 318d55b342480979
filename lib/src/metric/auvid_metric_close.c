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
    if (m->rows == 0) {
        return AUVID_ERR_NO_DATA;
    }
    uint8_t excited = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t min_rms = m->cfg.excitation_threshold * m->cfg.tau_max[j];
        bool is_excited = m->cfg.vehicle->columns[j] != 0 &&
                          m->tau_m2[j] > min_rms * min_rms * (auvid_real_t)m->rows_of[j];
        excited = (uint8_t)(excited | (unsigned)is_excited << j);
    }
    bool kept = auvid_metric_free_of(m, excited) != 0;
    if (kept && m->held && auvid_metric_stores_rows(m)) {
        m->full = true;
        return AUVID_PENDING;
    }
    if (kept) {
        auvid_metric_store_set(m, excited);
    }
    ++m->sets_recorded;
    m->rows = 0;
    memset(m->rows_of, 0, sizeof m->rows_of);
    m->lost = 0;
    memset(m->fastest, 0, sizeof m->fastest);
    memset(m->factor, 0, sizeof m->factor);
    memset(m->tau_mean, 0, sizeof m->tau_mean);
    memset(m->tau_m2, 0, sizeof m->tau_m2);
    return kept ? AUVID_SET_COMPLETE : AUVID_SET_IDLE;
}

void auvid_metric_hold(auvid_metric_t *metric, uint64_t until_us)
{
    if (metric != NULL) {
        metric->held = true;
        metric->waiting = 0;
        metric->until_us = auvid_metric_stores_rows(metric) ? until_us : UINT64_MAX;
    }
}

auvid_status_t auvid_metric_release(auvid_metric_t *metric, uint64_t resume_us)
{
    auvid_metric_t *m = metric;
    if (m == NULL) {
        return AUVID_ERR_NULL;
    }
    bool full = m->full;
    m->held = m->full = m->ring_changed = false;
    m->from = m->least = 0;
    if (!full) {
        return AUVID_OK;
    }
    m->resume_us = resume_us;
    return m->rows > 0 ? auvid_metric_close(m) : AUVID_OK;
}

auvid_status_t auvid_metric_drop(auvid_metric_t *metric, uint8_t age)
{
    if (metric == NULL) {
        return AUVID_ERR_NULL;
    }
    if (age >= auvid_metric_sets(metric) || age >= metric->sets_recorded) {
        return AUVID_ERR_RANGE;
    }
    auvid_set_t *set = &metric->set[auvid_metric_slot(metric, age)];
    if (set->rows == 0) {
        return AUVID_ERR_RANGE; /* already deleted */
    }
    memset(set, 0, sizeof *set);
    return AUVID_OK;
}
