/**
 * @file auvid_metric_rows_internal.h
 * Private: rows under construction and the set being recorded.
 */
#ifndef AUVID_METRIC_ROWS_INTERNAL_H
#define AUVID_METRIC_ROWS_INTERNAL_H

#include "auvid_metric_internal.h"

/** Number of cells whose inputs are stored; inputs are the wrench and the commands. */
enum {
    METRIC_PAST = AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1) + 1,
    METRIC_INPUTS = AUVID_DOF_COUNT + AUVID_MAX_COMMANDS
};

/** Returns wrench and commands at delay number `delay`, in steps of AUVID_METRIC_DELAY_CELLS. */
static inline const auvid_real_t *auvid_metric_delayed_inputs(const auvid_metric_t *m, int delay)
{
    uint32_t ago = (uint32_t)(delay * AUVID_METRIC_DELAY_CELLS), now = m->rows.cells % METRIC_PAST;
    return m->rows.past_tau[now >= ago ? now - ago : now + METRIC_PAST - ago];
}

/** Returns the part of DoF j's wrench that fixed parameters explain. row: of the regressor */
auvid_real_t auvid_metric_explained_by_fixed(const auvid_metric_t *m, int j,
                                             const auvid_real_t *row);

/** y += a x; four entries at a time, which halves the cost. */
AUVID_INLINE void auvid_metric_add_scaled(auvid_real_t *y, auvid_real_t a, const auvid_real_t *x,
                                          int n)
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

/** Record the velocities that were not measured in a cell with a weight in the row. */
static inline void auvid_metric_record_missing(auvid_metric_t *m, uint32_t slot, uint32_t age,
                                               uint8_t missing)
{
    for (int moment = 0; moment <= 1 && missing != 0; ++moment) {
        bool counts = auvid_abs(m->layout.kernel[moment][age]) > AUVID_C(0.0);
        m->rows.missing[slot][moment] |= counts ? missing : 0u;
    }
}

/** Returns the DoF (bit j) that have no row, because the model reads a missing velocity. */
static inline uint8_t auvid_metric_dofs_without_row(const auvid_metric_t *m, uint32_t slot)
{
    unsigned forces = auvid_vehicle_unmeasured(m->cfg.vehicle, m->rows.missing[slot][0]);
    unsigned moments = auvid_vehicle_unmeasured(m->cfg.vehicle, m->rows.missing[slot][1]);
    return (uint8_t)((forces & 7u) | (moments & ~7u));
}

/** Slot of the row whose last cell is cell n of the record. */
static inline uint32_t auvid_metric_slot_of_complete(const auvid_metric_t *m, uint32_t n)
{
    return (n - (m->layout.taps - 1u)) / m->cfg.row_cells % m->layout.overlap;
}

/** The slot of the row that began before the one at `slot`. */
static inline uint32_t auvid_metric_earlier_slot(const auvid_metric_t *m, uint32_t slot)
{
    return slot > 0 ? slot - 1u : m->layout.overlap - 1u;
}

/** auvid_metric_add in parts, one for each tick: take the cell, checked; then, while something
 * waits, continue. @return as auvid_metric_add */
auvid_status_t auvid_metric_take_cell(auvid_metric_t *m, const auvid_sample_t *sample);
auvid_status_t auvid_metric_continue(auvid_metric_t *m);

/** Does a complete row wait for its rotation, or a complete set for its end? */
static inline bool auvid_metric_waits(const auvid_metric_t *m)
{
    return m->rows.waiting != 0 || (m->rows.set.rows >= m->cfg.set_rows && !m->sets.full);
}

/** Number of rows under construction: a gap costs them. */
uint32_t auvid_metric_rows_begun(const auvid_metric_t *m);

/** Update the mean of the wrench and the sum of squares about it by one value (Welford). */
static inline void auvid_metric_update_wrench_moments(auvid_partial_set_t *set, int j,
                                                      auvid_real_t tau)
{
    auvid_real_t off = tau - set->tau_mean[j];
    set->tau_mean[j] += off / (auvid_real_t)++set->rows_of[j];
    set->tau_m2[j] += off * (tau - set->tau_mean[j]);
}

static inline void auvid_metric_count_lost_rows(auvid_partial_set_t *set, uint32_t rows)
{
    uint32_t lost = set->lost + rows;
    set->lost = (uint16_t)(lost < UINT16_MAX ? lost : UINT16_MAX);
}

/** Count a row: taken if some DoF has taken it, else lost. */
static inline void auvid_metric_count_row(auvid_partial_set_t *set, bool taken)
{
    set->rows = (uint16_t)(set->rows + taken);
    auvid_metric_count_lost_rows(set, !taken);
}

#endif
