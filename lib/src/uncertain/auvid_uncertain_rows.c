/*
 * Uncertain inputs: rows, from cells to two R factors for each DoF.
 *
 * The columns pass the metric's smoother. Sums and differences of successive rows are the low and
 * the high band, as in auvid_metric_regressor.c. The work of a tick stays small: a cell is stored;
 * its channels are formed in a later tick, and added to the rows in another one, before the next
 * cell. A row is rotated in while the next one is formed, one band of a DoF in each call that has
 * nothing to do with a cell, or adds one that completes no row. Where there are none, cells do all
 * of it.
 */
#include <string.h>

#include "../identifier/auvid_actuation_internal.h"
#include "auvid_uncertain_parts_internal.h"
#include "../metric/auvid_metric_rows_internal.h"

/* How far is the last cell? auvid_uncertain_rows_t.waits */
enum { UNCERTAIN_NONE, UNCERTAIN_CELL, UNCERTAIN_FORMED };

void auvid_uncertain_restart(auvid_uncertain_t *u)
{
    auvid_zero(u->factor, sizeof u->factor);
    auvid_zero(u->forgotten, sizeof u->forgotten);
    memset(u->rows, 0, sizeof u->rows);
    u->begin_us = 0;
    u->recorded.pending = 0;
    u->recorded.waits = UNCERTAIN_NONE;
    u->recorded.wrench = u->recorded.difference = AUVID_C(0.0);
    memset(u->recorded.successive, 0, sizeof u->recorded.successive);
}

/* Are rows taken now? Those of a passive vehicle count until the first excitation; then they are
 * dropped, and only the excitation gives rows. If it ends before it has given a set, as one that is
 * aborted, its rows are the first of a passive vehicle. */
static bool uncertain_takes_rows(auvid_uncertain_t *u)
{
    bool excites = auvid_actuation_excites(u->id);
    if (excites && !u->excited && !u->work.solving) {
        auvid_uncertain_restart(u);
        u->excited = true;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        u->gave_set = u->gave_set || (u->excited && u->rows[j] >= u->id->metric.cfg.set_rows);
    }
    u->excited = u->excited && (excites || u->gave_set);
    return excites || !u->excited;
}

/* Rotate rows that wait into the factors, at most this many. */
static void uncertain_rotate_rows(auvid_uncertain_t *u, int most)
{
    for (int k = 0; u->recorded.pending >> k != 0 && most > 0; ++k) {
        if ((u->recorded.pending >> k & 1) != 0 && !auvid_uncertain_reads(u, k / 2)) {
            const auvid_uncertain_equation_t *e = &u->equation[k / 2];
            auvid_qr_update(u->factor[k % 2] + e->factor_at, e->order, 0,
                            u->recorded.band[k % 2] + e->row_at);
            u->recorded.pending = (uint16_t)(u->recorded.pending & ~(1u << k));
            u->fresh = true;
            --most;
        }
    }
}

static void uncertain_accumulate(void *context, uint32_t slot, bool begins,
                                 const auvid_real_t motion[2], const auvid_real_t thrust[2])
{
    auvid_uncertain_t *u = context;
    auvid_real_t *row = u->recorded.accumulator[slot];
    if (begins) {
        auvid_clear(row, AUVID_UNCERTAIN_CHANNELS);
    }
    for (int k = 0; k < 4; ++k) {
        int at = u->section[k], moment = k / 2;
        auvid_real_t weight = k % 2 > 0 ? thrust[moment] : motion[moment];
        if (moment == 0 || auvid_abs(weight) > AUVID_C(0.0)) { /* their kernel is shorter */
            auvid_metric_add_scaled(row + at, weight, u->recorded.channel + at,
                                    u->section[k + 1] - at);
        }
    }
}

/* Take DoF j's row; regressor: NULL if it has none; fixed: wrench that fixed parameters explain. */
static void uncertain_take_row(auvid_uncertain_t *u, int j, const auvid_real_t *regressor,
                               auvid_real_t fixed, uint32_t lag)
{
    auvid_uncertain_rows_t *r = &u->recorded;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    int at = e->row_at;
    const auvid_real_t *channel = r->accumulator[r->complete];
    auvid_real_t row[AUVID_UNCERTAIN_ORDER];
    if (regressor == NULL || e->order == 0 || r->begun_before > 0) {
        r->successive[j] = 0;
        return;
    }
    for (int k = 0; k < e->inputs; ++k) {
        row[k] = channel[auvid_uncertain_channel(u, e, k)];
    }
    memcpy(row + e->inputs, regressor, (size_t)(e->order - 1 - e->inputs) * sizeof *row);
    for (int k = e->inputs + 1; k < e->channels; ++k) {
        row[k - 1] += channel[auvid_uncertain_channel(u, e, k)];
    }
    row[e->order - 1] = channel[auvid_uncertain_channel(u, e, e->inputs)] - fixed;
    if (auvid_all_within(row, e->order, METRIC_LARGEST_ENTRY) != AUVID_OK) {
        r->successive[j] = 0;
        return;
    }
    auvid_real_t *last = r->previous[r->since_gap % AUVID_METRIC_LAGS] + at;
    const auvid_real_t *other =
        r->previous[(r->since_gap + AUVID_METRIC_LAGS - lag) % AUVID_METRIC_LAGS] + at;
    bool busy = (r->pending >> 2 * j & 3) != 0; /* the solution has not yet read the last one */
    if (r->successive[j] >= lag && !busy && r->takes_rows) {
        for (int k = 0; k < e->order; ++k) {
            r->band[0][at + k] = AUVID_C(0.5) * (row[k] + other[k]);
            r->band[1][at + k] = AUVID_C(0.5) * (row[k] - other[k]);
        }
        r->pending = (uint16_t)(r->pending | 3u << 2 * j);
        u->rows[j] += AUVID_C(1.0);
    }
    memcpy(last, row, e->order * sizeof *row);
    r->successive[j] = (uint8_t)(r->successive[j] + (r->successive[j] < AUVID_METRIC_LAGS));
}

/* Form the channels of the last cell, if it waits. */
static void uncertain_form_channels(auvid_uncertain_t *u, const auvid_metric_t *m)
{
    if (u->recorded.waits == UNCERTAIN_CELL) {
        auvid_uncertain_channels(u, m, &u->cell);
        u->recorded.waits = UNCERTAIN_FORMED;
    }
}

/* Add the last cell to the rows, and take the one that it completes. */
static void uncertain_finish(void *context, const auvid_metric_t *m)
{
    auvid_uncertain_t *u = context;
    auvid_uncertain_rows_t *r = &u->recorded;
    if (r->waits == UNCERTAIN_NONE) {
        return;
    }
    uncertain_form_channels(u, m);
    r->waits = UNCERTAIN_NONE;
    auvid_metric_add_extra(m, &(auvid_metric_place_t){r->n, r->slot, r->spread},
                           uncertain_accumulate, u);
    for (int j = 0; j < AUVID_DOF_COUNT && r->completes; ++j) {
        bool has = (r->dofs >> j & 1) != 0;
        uncertain_take_row(u, j, has ? auvid_metric_complete_row(m, r->complete, j) : NULL,
                           auvid_metric_fixed_wrench(m, r->complete, j),
                           m->cfg.lag[j >= AUVID_ROLL]);
    }
    if (r->completes && r->counts) {
        ++r->since_gap;
        r->begun_before = (uint8_t)(r->begun_before - (r->begun_before > 0));
    }
}

/* How many rows may wait at cell n, the k-th one after a row was complete: none at the next row. */
static int uncertain_may_wait(const auvid_metric_t *m, uint32_t n)
{
    uint32_t step = m->cfg.row_cells, last = m->layout.taps - 1u;
    uint32_t k = (n % step + step - last % step) % step;
    return k > 0 ? 2 * (int)(step - k) : 0;
}

static void uncertain_cell(void *context, const auvid_metric_t *m, const auvid_sample_t *cell,
                           const auvid_metric_place_t *place)
{
    auvid_uncertain_t *u = context;
    auvid_uncertain_rows_t *r = &u->recorded;
    uncertain_rotate_rows(u, (int)auvid_count_bits(r->pending) - uncertain_may_wait(m, place->n));
    r->takes_rows = uncertain_takes_rows(u);
    if (place->n == 0) {
        memset(r->successive, 0, sizeof r->successive);
    }
    if (u->begin_us == 0) { /* after a restart, or that of the program */
        u->begin_us = cell->t_us;
        r->begun_before = (uint8_t)(place->n == 0 ? 0 : AUVID_MAX_OVERLAP);
    }
    /* in units of 1024 us: 50 days fit */
    uint32_t elapsed = (uint32_t)((cell->t_us - u->begin_us) >> 10);
    r->elapsed = AUVID_C(1.024e-3) / AUVID_UNCERTAIN_SAG_S * (auvid_real_t)elapsed;
    u->cell = *cell;
    auvid_uncertain_take_forces(u);
    auvid_uncertain_compare(u, m, cell);
    r->n = place->n;
    r->slot = (uint8_t)place->slot;
    r->spread = place->spread;
    r->waits = UNCERTAIN_CELL;
    r->completes = false;
}

static void uncertain_take(void *context, const auvid_metric_t *m, uint32_t slot, bool counts,
                           uint8_t dofs)
{
    auvid_uncertain_rows_t *r = &((auvid_uncertain_t *)context)->recorded;
    (void)m;
    r->complete = (uint8_t)slot;
    r->dofs = dofs;
    r->counts = counts;
    r->completes = true;
}

bool auvid_uncertain_add_cell(auvid_identifier_t *id)
{
    auvid_uncertain_t *u = id->attached.uncertain;
    const auvid_metric_t *m = &id->metric;
    int waits = u->recorded.waits;
    if (waits == UNCERTAIN_CELL) {
        uncertain_form_channels(u, m);
    } else if (waits == UNCERTAIN_FORMED) {
        uncertain_rotate_rows(u, u->recorded.completes ? 0 : 1);
        m->extra->finish(m->extra_context, m);
    }
    return waits != UNCERTAIN_NONE;
}

void auvid_uncertain_rotate(auvid_identifier_t *id)
{
    uncertain_rotate_rows(id->attached.uncertain, 1);
}

const struct auvid_metric_extra auvid_uncertain_extra = {uncertain_finish, uncertain_cell,
                                                         uncertain_take};
