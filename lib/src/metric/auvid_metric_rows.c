/*
 * Metric, rows (Karras et al. 2013, III-B): cells to rows. auvid_metric_sets.c completes sets.
 * What a cell adds to a row, and where a complete row goes, is the path's: see
 * auvid_metric_regressor.c and auvid_metric_residual.c. The rotation of a complete row, and the end
 * of a complete set, are parts of their own: the control tick spreads them (auvid_metric_continue).
 *
 * The filter runs in transposed form: each cell is added, with the right coefficient, to the few
 * rows under construction, so no window of cells is stored.
 */
#include "auvid_metric_rows_internal.h"

#include <string.h>

#include "auvid_metric_sets_internal.h"

/* Add a cell to the rows under construction. @return slot of the row that it completes; -1: none */
static int metric_add_to_rows(auvid_metric_t *m, const auvid_sample_t *sample)
{
    auvid_metric_rows_t *rows = &m->rows;
    if (rows->cells + 1 < METRIC_PAST) { /* the wrench is not yet known at all delays */
        return -1;
    }
    uint32_t n = rows->cells + 1 - METRIC_PAST, step = m->cfg.row_cells, last = m->layout.taps - 1u;
    uint32_t slot = n / step % m->layout.overlap;
    if (m->extra != NULL) {
        m->extra->finish(m->extra_context, m);
    }
    if (n % step == 0) {
        auvid_clear(rows->accumulator[slot], AUVID_MAX_COLUMNS);
        auvid_clear(rows->fixed_wrench[slot], AUVID_DOF_COUNT);
        memset(rows->missing[slot], 0, sizeof rows->missing[slot]);
    }
    auvid_metric_path(m)->add_cell(m, sample, n, slot);
    return n >= last && (n - last) % step == 0 ? (int)auvid_metric_slot_of_complete(m, n) : -1;
}

/* Update the largest speed in each direction, in thousandths. */
static void metric_update_max_speed(auvid_partial_set_t *set, const auvid_sample_t *sample)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t speed = AUVID_C(1000.0) * auvid_abs(sample->nu[j]);
        uint16_t *fastest = &set->fastest[j][sample->nu[j] < AUVID_C(0.0)];
        if ((sample->missing >> j & 1) == 0 && speed > (auvid_real_t)*fastest) {
            *fastest = (uint16_t)auvid_min(speed, (auvid_real_t)UINT16_MAX);
        }
    }
}

auvid_status_t auvid_metric_take_cell(auvid_metric_t *m, const auvid_sample_t *sample)
{
    if (!auvid_metric_is_finite(sample) || !auvid_all_finite(sample->nu_dot, AUVID_DOF_COUNT)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (auvid_metric_takes_cell(m, sample->t_us)) {
        metric_update_max_speed(&m->rows.set, sample);
    }
    auvid_real_t *inputs = m->rows.past_tau[m->rows.cells % METRIC_PAST];
    memcpy(inputs, sample->tau, sizeof sample->tau);
    memcpy(inputs + AUVID_DOF_COUNT, sample->command,
           AUVID_MAX_COMMANDS * sizeof sample->command[0]);
    auvid_metric_rotate_rows(m);
    int slot = metric_add_to_rows(m, sample);
    if (slot >= 0) {
        uint64_t middle =
            sample->t_us - (uint64_t)(m->layout.taps - 1u) * auvid_metric_cell_us(m) / 2u;
        auvid_metric_path(m)->finish_row(m, middle, (uint32_t)slot);
    }
    ++m->rows.cells;
    return AUVID_OK;
}

auvid_status_t auvid_metric_continue(auvid_metric_t *m)
{
    auvid_status_t status = AUVID_OK;
    if (m->rows.waiting != 0) {
        auvid_metric_path(m)->rotate_row(m);
    } else if (auvid_metric_waits(m)) {
        status = auvid_metric_close(m);
    }
    return status == AUVID_PENDING ? AUVID_OK : status;
}

auvid_status_t auvid_metric_add(auvid_metric_t *metric, const auvid_sample_t *sample)
{
    if (metric == NULL || sample == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_metric_take_cell(metric, sample);
    while (status >= 0 && auvid_metric_waits(metric)) {
        status = auvid_metric_continue(metric);
    }
    return status;
}

uint32_t auvid_metric_rows_begun(const auvid_metric_t *m)
{
    uint32_t cells = METRIC_PAST - 1u + m->layout.taps - 1u; /* before the first row */
    return (m->rows.cells < cells ? m->rows.cells : cells) / m->cfg.row_cells;
}

void auvid_metric_gap(auvid_metric_t *metric)
{
    if (metric != NULL) {
        auvid_metric_rotate_rows(metric);
        auvid_metric_count_lost_rows(&metric->rows.set, auvid_metric_rows_begun(metric));
        metric->rows.cells = 0;
        memset(metric->rows.successive, 0, sizeof metric->rows.successive);
    }
}
