/*
 * Instruments: the rows of uncertain inputs, projected onto columns of the reference.
 *
 * Rows [Z C R z] are rotated into the first rows of an R factor, as many as Z has columns. Their
 * part behind Z is Q_Z'[C R z], so their products are those of the projected rows (two-stage least
 * squares). What is below them is not stored.
 *
 * A lag T of the reference r gives the velocity s' = (r - s) / T, and this as its acceleration, in
 * steps of a cell. An instrument need not be exact.
 *
 * Strength of parameter i in its DoF's equation, with p and w the squares of what the DoF's other
 * parameters leave of its column, projected and whole, and n columns of Z:
 *
 *     F = (p / n) / (2.6 (w - p) / rows)
 */
#include "auvid/uncertain.h"

#include <string.h>

#include "auvid/detail/recorder.h"
#include "../identifier/auvid_identifier_internal.h"
#include "auvid_uncertain_parts_internal.h"

#define INSTRUMENTS_STRONG AUVID_C(10.0)   /* least F */
#define INSTRUMENTS_SMALLEST AUVID_C(1e-5) /* pivot, relative to its column */

/* INSTRUMENTS_OWN: most parameters of a DoF that can be strong */
enum { INSTRUMENTS_LEAST_LAGS = 2, INSTRUMENTS_ROTATED_PER_CELL = 2, INSTRUMENTS_OWN = 8 };

static const auvid_real_t instruments_lag_s[AUVID_INSTRUMENT_LAGS] = {
    AUVID_C(0.3), AUVID_C(1.0), AUVID_C(3.0), AUVID_C(10.0), AUVID_C(30.0)};

typedef auvid_instruments_t instruments_t;

/* ---- rows ---- */

/* Order of the factor of DoF j. */
static int instruments_order(const instruments_t *n, int j)
{
    return n->of[j].count + n->uncertain->equation[j].order;
}

/* The row of DoF j that waits. */
static auvid_real_t *instruments_waiting(instruments_t *n, int j)
{
    return n->wide + n->of[j].column_at + n->uncertain->equation[j].row_at;
}

/* Rotate up to `most` of the rows that wait. */
static void instruments_rotate_waiting(instruments_t *n, int most)
{
    for (int j = 0; j < AUVID_DOF_COUNT && most > 0; ++j) {
        const auvid_instrument_t *of = &n->of[j];
        if ((n->waiting >> j & 1) != 0 && !auvid_uncertain_reads(n->uncertain, j)) {
            auvid_qr_update_rows(n->factor + of->factor_at, instruments_order(n, j), 0, of->count,
                                 instruments_waiting(n, j));
            n->rows[j] += AUVID_C(1.0);
            n->waiting = (uint8_t)(n->waiting & ~(1u << j));
            --most;
        }
    }
}

/* The uncertain inputs have begun their rows again: do the same. */
static void instruments_restart(instruments_t *n)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (n->rows[j] > AUVID_C(0.0) && !(n->uncertain->rows[j] > AUVID_C(0.0))) {
            auvid_clear(n->factor + n->of[j].factor_at,
                        (size_t)auvid_qr_row(instruments_order(n, j), n->of[j].count));
            n->rows[j] = AUVID_C(0.0);
            n->waiting = (uint8_t)(n->waiting & ~(1u << j));
        }
    }
}

/* Returns the reference at that time; NULL: none yet. */
static const auvid_real_t *instruments_at(instruments_t *n, uint64_t t_us)
{
    while (n->taken + 1u < n->given &&
           n->past[(n->taken + 1u) % AUVID_INSTRUMENT_PAST].t_us <= t_us) {
        ++n->taken;
    }
    const auvid_reference_t *r = &n->past[n->taken % AUVID_INSTRUMENT_PAST];
    return n->given > 0 && r->t_us <= t_us ? r->nu : NULL;
}

/* Compute the channels of a cell. */
static void instruments_channels(instruments_t *n, const auvid_metric_t *m,
                                 const auvid_sample_t *cell)
{
    auvid_real_t cell_s = (auvid_real_t)auvid_metric_cell_us(m) * AUVID_C(1e-6);
    const auvid_real_t *reference = instruments_at(n, cell->t_us);
    for (int l = 0; l < n->lags; ++l) {
        auvid_sample_t moves;
        auvid_regressor_t y;
        memset(&moves, 0, sizeof moves);
        memset(&y, 0, sizeof y);
        moves.t_us = cell->t_us;
        for (int i = 0; i < AUVID_DOF_COUNT; ++i) {
            auvid_real_t *lagged = &n->lagged[l][i];
            auvid_real_t r = reference != NULL ? reference[i] : AUVID_C(0.0);
            *lagged += cell_s / (instruments_lag_s[l] + cell_s) * (r - *lagged);
            moves.nu[i] = *lagged;
            moves.nu_dot[i] = (r - *lagged) / instruments_lag_s[l];
        }
        m->cfg.vehicle->regressor(m->cfg.vehicle->context, &moves, NULL, &y);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            const auvid_instrument_t *of = &n->of[j];
            int columns = auvid_metric_equation(m, j).count;
            for (int k = 0; k < columns && of->count > 0; ++k) {
                n->channel[of->column_at + l * columns + k] =
                    y.row[j][auvid_metric_row_parameters(m, j)[k]];
            }
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (n->of[j].count > 0) {
            n->channel[n->of[j].column_at + n->of[j].count - 1] = AUVID_C(1.0);
        }
    }
}

static void instruments_accumulate(void *context, uint32_t slot, bool begins,
                                   const auvid_real_t motion[2], const auvid_real_t thrust[2])
{
    instruments_t *n = context;
    auvid_real_t *row = n->accumulator[slot];
    (void)thrust;
    if (begins) {
        auvid_clear(row, AUVID_INSTRUMENT_COLUMNS);
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int at = n->of[j].column_at;
        for (int k = at; k < at + n->of[j].count; ++k) {
            row[k] += motion[j >= AUVID_ROLL] * n->channel[k];
        }
    }
}

static void instruments_cell(void *context, const auvid_metric_t *m, const auvid_sample_t *cell,
                             const auvid_metric_place_t *place)
{
    instruments_t *n = context;
    auvid_uncertain_extra.cell(n->uncertain, m, cell, place);
    instruments_restart(n);
    instruments_rotate_waiting(n, INSTRUMENTS_ROTATED_PER_CELL);
    instruments_channels(n, m, cell);
    auvid_metric_add_extra(m, place, instruments_accumulate, n);
}

/* Let DoF j's row wait. */
static void instruments_take_row(instruments_t *n, int j)
{
    const auvid_uncertain_t *u = n->uncertain;
    const auvid_uncertain_equation_t *e = &u->equation[j];
    const auvid_instrument_t *of = &n->of[j];
    const auvid_real_t *columns = n->accumulator[u->recorded.complete] + of->column_at;
    if (!u->excited && n->given > 0 && (n->waiting >> j & 1) == 0 &&
        auvid_all_within(columns, of->count, METRIC_LARGEST_ENTRY) == AUVID_OK) {
        uint32_t newest = u->recorded.since_gap - 1u;
        const auvid_real_t *row = u->recorded.previous[newest % AUVID_METRIC_LAGS] + e->row_at;
        auvid_real_t *wide = instruments_waiting(n, j);
        memcpy(wide, columns, of->count * sizeof *wide);
        memcpy(wide + of->count, row, e->order * sizeof *wide);
        n->waiting = (uint8_t)(n->waiting | 1u << j);
    }
}

static void instruments_take(void *context, const auvid_metric_t *m, uint32_t slot, bool counts,
                             uint8_t dofs)
{
    auvid_uncertain_extra.take(((instruments_t *)context)->uncertain, m, slot, counts, dofs);
}

/* Take the rows that the uncertain inputs take. */
static void instruments_finish(void *context, const auvid_metric_t *m)
{
    instruments_t *n = context;
    const auvid_uncertain_t *u = n->uncertain;
    auvid_real_t before[AUVID_DOF_COUNT];
    memcpy(before, u->rows, sizeof before);
    auvid_uncertain_extra.finish(n->uncertain, m);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (u->rows[j] > before[j]) {
            instruments_take_row(n, j);
        }
    }
}

static const struct auvid_metric_extra instruments_extra = {instruments_finish, instruments_cell,
                                                            instruments_take};

/* ---- strength ---- */

/* Returns what the first n - 1 columns leave of the square of the last one. The products are
 * overwritten. */
static auvid_real_t instruments_left(auvid_real_t g[][INSTRUMENTS_OWN], int n)
{
    auvid_real_t square[INSTRUMENTS_OWN] = {AUVID_C(0.0)};
    for (int i = 0; i < n; ++i) {
        square[i] = g[i][i];
    }
    for (int i = 0; i < n - 1; ++i) {
        bool usable = g[i][i] > INSTRUMENTS_SMALLEST * square[i];
        for (int k = i + 1; k < n && usable; ++k) {
            for (int l = k; l < n; ++l) {
                g[k][l] -= g[i][k] * g[i][l] / g[i][i];
            }
        }
    }
    return g[n - 1][n - 1] > INSTRUMENTS_SMALLEST * square[n - 1] ? g[n - 1][n - 1] : AUVID_C(0.0);
}

/* Returns the product of two columns, projected. */
static auvid_real_t instruments_product(const instruments_t *n, int j, int k, int l)
{
    auvid_real_t sum = AUVID_C(0.0);
    for (int i = 0; i < n->of[j].count; ++i) {
        const auvid_real_t *r = auvid_instruments_row(n, j, i);
        sum += r[k] * r[l];
    }
    return sum;
}

/* Is column own[last] strong, among these columns of DoF j? */
static bool instruments_column_is_strong(const instruments_t *n, int j, const uint8_t *own,
                                         int count, int last)
{
    const auvid_uncertain_t *u = n->uncertain;
    auvid_real_t whole[INSTRUMENTS_OWN][INSTRUMENTS_OWN];
    auvid_real_t projected[INSTRUMENTS_OWN][INSTRUMENTS_OWN];
    for (int k = 0; k < count; ++k) {
        for (int l = k; l < count; ++l) { /* the last one changes places with own[last] */
            int a = own[k == last ? count - 1 : k == count - 1 ? last : k];
            int b = own[l == last ? count - 1 : l == count - 1 ? last : l];
            whole[k][l] = auvid_uncertain_product(u, j, a, b) / u->rows[j];
            projected[k][l] = instruments_product(n, j, a, b) / n->rows[j];
        }
    }
    auvid_real_t p = instruments_left(projected, count), w = instruments_left(whole, count);
    auvid_real_t noise = AUVID_CONFIDENCE_SMOOTHED * auvid_max(w - p, AUVID_C(0.0)) / n->rows[j];
    return p > INSTRUMENTS_STRONG * (auvid_real_t)n->of[j].count * noise;
}

/* The rows hold about as much as the ring: older ones are forgotten. */
static void instruments_forget(instruments_t *n, const auvid_metric_t *m, int j)
{
    const auvid_instrument_t *of = &n->of[j];
    auvid_real_t full = (auvid_real_t)m->cfg.sets * (auvid_real_t)m->cfg.set_rows;
    auvid_real_t root = auvid_sqrt(full / auvid_max(n->rows[j], full));
    for (int k = 0; n->rows[j] > full && k < auvid_qr_row(instruments_order(n, j), of->count);
         ++k) {
        n->factor[of->factor_at + k] *= root;
    }
    n->rows[j] = auvid_min(n->rows[j], full);
}

static uint32_t instruments_strong(auvid_uncertain_t *u, const auvid_metric_t *m)
{
    instruments_t *n = u->instruments;
    n->strong = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const uint8_t *index = auvid_metric_row_parameters(m, j);
        uint8_t own[INSTRUMENTS_OWN];
        int count = 0;
        if (!(n->rows[j] >= AUVID_UNCERTAIN_LEAST_ROWS) || !auvid_uncertain_has_rows(u, j)) {
            continue;
        }
        instruments_forget(n, m, j);
        for (int k = 0; k < auvid_metric_equation(m, j).count && count < INSTRUMENTS_OWN; ++k) {
            if ((int)m->cfg.vehicle->parameter[index[k]].dof == j) {
                own[count++] = (uint8_t)(u->equation[j].inputs + k);
            }
        }
        for (int k = 0; k < count; ++k) {
            int p = index[own[k] - u->equation[j].inputs];
            bool strong = m->cfg.vehicle->parameter[p].kind != AUVID_PARAMETER_FORCE &&
                          instruments_column_is_strong(n, j, own, count, k);
            n->strong |= (uint32_t)strong << p;
        }
    }
    return n->strong;
}

/* ---- attaching, and the reference ---- */

/* Lay out the columns with so many lags. @param of NULL: only try
 * @return false: there is no room */
static bool instruments_lay_out(const auvid_uncertain_t *u, const auvid_metric_t *m, int lags,
                                auvid_instrument_t *of)
{
    int factor = 0, column = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        int order = u->equation[j].order,
            count = order > 0 ? lags * auvid_metric_equation(m, j).count + 1 : 0;
        if (of != NULL) {
            of[j].factor_at = (uint16_t)factor;
            of[j].column_at = (uint16_t)column;
            of[j].count = (uint8_t)count;
        }
        factor += auvid_qr_row(count + order, count);
        column += count;
        if (count > AUVID_INSTRUMENT_ORDER || column > AUVID_INSTRUMENT_COLUMNS ||
            factor > AUVID_INSTRUMENT_FACTOR) {
            return false;
        }
    }
    return true;
}

auvid_status_t auvid_identifier_attach_instruments(auvid_identifier_t *id,
                                                   auvid_instruments_t *storage)
{
    if (id == NULL || storage == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_uncertain_t *u = id->attached.uncertain;
    auvid_status_t status = auvid_identifier_check_attach(id, u != NULL ? u->instruments : NULL);
    if (status < 0 || u == NULL) {
        return status < 0 ? status : AUVID_ERR_DETACHED;
    }
    int lags = AUVID_INSTRUMENT_LAGS;
    while (lags >= INSTRUMENTS_LEAST_LAGS && !instruments_lay_out(u, &id->metric, lags, NULL)) {
        --lags;
    }
    if (lags < INSTRUMENTS_LEAST_LAGS) {
        return AUVID_ERR_SIZE;
    }
    memset(storage, 0, sizeof *storage);
    (void)instruments_lay_out(u, &id->metric, lags, storage->of);
    storage->lags = (uint8_t)lags;
    storage->uncertain = u;
    storage->checkpoint = &auvid_instruments_checkpoint;
    u->instruments = storage;
    u->strong = instruments_strong;
    auvid_metric_attach_extra(&id->metric, &instruments_extra, storage);
    return AUVID_OK;
}

auvid_status_t auvid_instruments_reference(auvid_instruments_t *instruments, uint64_t t_us,
                                           const auvid_real_t *velocity)
{
    instruments_t *n = instruments;
    if (n == NULL || velocity == NULL) {
        return AUVID_ERR_NULL;
    }
    if (n->uncertain == NULL) {
        return AUVID_ERR_STATE;
    }
    auvid_status_t status = auvid_all_within(velocity, AUVID_DOF_COUNT, AUVID_RECORDER_LARGEST);
    if (status < 0) {
        return status;
    }
    if (n->given > 0 && t_us <= n->last_us) {
        return t_us == n->last_us ? AUVID_ERR_TIME_SAME : AUVID_ERR_TIME_BACK;
    }
    auvid_reference_t *last = &n->past[(n->given - 1u) % AUVID_INSTRUMENT_PAST];
    uint32_t half_us = auvid_metric_cell_us(&n->uncertain->id->metric) / 2u;
    if (n->given == 0 || t_us - last->t_us >= half_us) {
        n->taken += n->given - n->taken >= AUVID_INSTRUMENT_PAST;
        last = &n->past[n->given++ % AUVID_INSTRUMENT_PAST];
        last->t_us = t_us;
    }
    n->last_us = t_us;
    memcpy(last->nu, velocity, sizeof last->nu);
    return AUVID_OK;
}
