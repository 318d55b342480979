#include "literal.h"

#include <math.h>
#include <string.h>

#include "auvid/smoother.h"
#include "../../lib/src/identifier/auvid_identifier_internal.h"
#include "../../lib/src/metric/auvid_metric_evaluator_internal.h"
#include "../../lib/src/metric/auvid_metric_rows_internal.h"

enum { ORDER = 3, HALF_US = 500000 };

/* Cells before the first row of a metric: the oldest wrench that it stores. */
enum { PAST = AUVID_METRIC_DELAY_CELLS * (AUVID_METRIC_DELAYS - 1) };

/* Taps of the metric's smoother, which passes the middle one. */
enum { TAPS = 3 };

/* Where the recorder has its last input, and the time of it. */
enum { INPUT = 4, FIRST_INPUT = 9 };

/* Rows of the smoothed state, whatever the cell. So the metric finds no noise of the acceleration
 * in them, either. */
static void smoothed_rows(const void *context, const auvid_sample_t *sample, const auvid_real_t *pi,
                          auvid_regressor_t *y)
{
    const literal_t *l = context;
    (void)sample;
    l->model->regressor(l->model->context, &l->smoothed, pi, y);
}

static bool model_acceleration(const void *context, const auvid_sample_t *sample,
                               const auvid_real_t *pi, auvid_real_t nu_dot[AUVID_DOF_COUNT])
{
    const literal_t *l = context;
    return l->model->acceleration(l->model->context, sample, pi, nu_dot);
}

auvid_status_t literal_metric(literal_t *l, auvid_metric_config_t *cfg)
{
    memset(l, 0, sizeof *l);
    l->half = cfg->cell_us == 0 ? 0 : HALF_US / cfg->cell_us;
    l->half = l->half < 2 ? 2 : l->half;
    if (cfg->row_cells < 2 || l->half > AUVID_MAX_HALF_WIDTH ||
        l->half + cfg->row_cells + PAST + TAPS > LITERAL_CELLS) {
        return AUVID_ERR_RANGE;
    }
    for (uint8_t derivative = 0; derivative < 2; ++derivative) {
        auvid_status_t status = auvid_smoother_coefficients(
            (uint8_t)l->half, ORDER, derivative, (auvid_real_t)cfg->cell_us * AUVID_C(1e-6), 0,
            l->c[derivative]);
        if (status < 0) {
            return status;
        }
    }
    l->model = cfg->vehicle;
    l->vehicle = *cfg->vehicle;
    l->vehicle.context = l;
    l->vehicle.regressor = smoothed_rows;
    l->vehicle.acceleration = l->model->acceleration == NULL ? NULL : model_acceleration;
    cfg->vehicle = &l->vehicle;
    cfg->half_width[0] = cfg->half_width[1] = 1;
    cfg->passes = 1;
    cfg->velocity_us = 0;
    cfg->estimate_delay = false;
    cfg->max_cell_us = 0;
    return AUVID_OK;
}

auvid_status_t literal_identifier(literal_t *l, auvid_identifier_config_t *cfg)
{
    if (cfg->recorder.gap_us == 0) {
        cfg->recorder.gap_us = auvid_recorder_gap(cfg->metric.velocity_us);
    }
    cfg->metric.vehicle = cfg->vehicle;
    cfg->metric.cell_us = cfg->recorder.cell_us;
    auvid_status_t status = literal_metric(l, &cfg->metric);
    cfg->vehicle = cfg->metric.vehicle;
    return status < 0 ? status : auvid_recorder_init(&l->recorder, &cfg->recorder);
}

void literal_attach(literal_t *l, auvid_metric_t *metric)
{
    l->metric = metric;
}

/* The cell `ago` cells before the last one. */
static auvid_sample_t *cell_at(literal_t *l, uint32_t ago)
{
    return &l->cell[(l->cells - 1u - ago) % LITERAL_CELLS];
}

/* Smooths the states in the window that ends with the last cell. */
static void smooth(literal_t *l)
{
    auvid_sample_t *s = &l->smoothed;
    memset(s, 0, sizeof *s);
    for (uint32_t k = 0; k <= 2 * l->half; ++k) {
        const auvid_sample_t *cell = cell_at(l, 2 * l->half - k);
        auvid_real_t value = l->c[0][k], derivative = l->c[1][k];
        s->phi += value * cell->phi;
        s->theta += value * cell->theta;
        s->psi += value * cell->psi;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            s->nu[j] += value * cell->nu[j];
            s->nu_dot[j] += derivative * cell->nu[j];
        }
        s->missing |= cell->missing;
    }
}

/* Gives the metric the cells of a row: those up to one after the middle of the window, which are
 * not yet given. For the largest speed they have the extreme velocities since the last row. */
static auvid_status_t add_row(literal_t *l, bool first)
{
    auvid_status_t status = AUVID_OK;
    uint32_t count = first ? PAST + TAPS : l->metric->cfg.row_cells;
    for (uint32_t k = count; k > 0 && status >= 0; --k) {
        auvid_sample_t cell = *cell_at(l, l->half - 2u + k);
        memcpy(cell.nu, l->fastest[k % 2], sizeof cell.nu);
        cell.missing = l->smoothed.missing;
        status = auvid_metric_add(l->metric, &cell);
    }
    memset(l->fastest, 0, sizeof l->fastest);
    return status;
}

auvid_status_t literal_add(literal_t *l, const auvid_sample_t *cell)
{
    uint32_t before = PAST + 2 * l->half; /* the first row */
    ++l->cells;
    *cell_at(l, 0) = *cell;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t *fastest = &l->fastest[cell->nu[j] < 0][j];
        bool counts = (cell->missing >> j & 1) == 0 && fabs(cell->nu[j]) > fabs(*fastest);
        *fastest = counts ? cell->nu[j] : *fastest;
    }
    if (l->cells <= before || (l->cells - 1u - before) % l->metric->cfg.row_cells != 0) {
        return AUVID_OK;
    }
    smooth(l);
    return add_row(l, l->cells - 1u == before);
}

void literal_gap(literal_t *l)
{
    uint32_t before = PAST + 2 * l->half, mine = l->cells < before ? l->cells : before;
    uint32_t rows = mine / l->metric->cfg.row_cells, its = auvid_metric_rows_begun(l->metric);
    auvid_metric_count_lost_rows(&l->metric->rows.set, rows - its);
    l->cells = 0;
    auvid_metric_gap(l->metric);
}

/* Ends a merge after its first pass. */
static void end_merge(auvid_metric_t *m)
{
    if (auvid_metric_pass(m) == PASS_RESIDUAL && m->cfg.vehicle->regressor == smoothed_rows) {
        auvid_metric_restart_pass(m, PASS_ADDED);
    }
}

auvid_status_t literal_merge(auvid_metric_t *metric, uint32_t *budget)
{
    auvid_status_t status = AUVID_PENDING;
    while (*budget > 0 && status == AUVID_PENDING) {
        uint32_t unit = 1;
        status = auvid_metric_merge(metric, &unit);
        *budget -= 1u - unit;
        end_merge(metric);
    }
    return status;
}

void literal_cell(literal_t *l, auvid_identifier_t *id, const auvid_sample_t *cell)
{
    if (cell == NULL) {
        literal_gap(l);
        auvid_validation_gap(id->attached.prediction);
        id->events |= AUVID_EVENT_GAP;
        return;
    }
    if (id->attached.prediction != NULL && id->attached.prediction->vehicle != NULL) {
        (void)auvid_validation_add(id->attached.prediction, cell);
    }
    identifier_take_set(id, literal_add(l, cell));
}

void literal_tick(literal_t *l, auvid_identifier_t *id)
{
    const auvid_recorder_t *given = &id->recorder;
    const auvid_real_t *input = given->last + FIRST_INPUT;
    auvid_nav_state_t state;
    auvid_sample_t cell;
    auvid_status_t status = AUVID_OK;
    if (auvid_nav_state(&id->nav, &state) == AUVID_OK) {
        (void)auvid_recorder_attitude(&l->recorder, state.t_us, state.attitude, state.rates);
        if (state.flags & AUVID_NAV_FRESH_BOTTOM) {
            (void)auvid_recorder_velocity(&l->recorder, state.t_us, state.velocity,
                                          id->nav.ground.measured);
        }
    }
    if (given->stream[INPUT].valid) {
        (void)auvid_recorder_input(&l->recorder, given->stream[INPUT].t_us, input,
                                   input + AUVID_DOF_COUNT);
    }
    while (status == AUVID_OK || status == AUVID_GAP) {
        status = auvid_recorder_pop(&l->recorder, &cell);
        if (status == AUVID_OK || status == AUVID_GAP) {
            literal_cell(l, id, status == AUVID_OK ? &cell : NULL);
        }
    }
    auvid_recorder_config_t cfg = id->recorder.cfg;
    (void)auvid_recorder_init(&id->recorder, &cfg);
}

auvid_status_t literal_work(auvid_identifier_t *id, uint32_t budget)
{
    uint32_t left = budget, max_work = id->work.max_units;
    auvid_status_t status = AUVID_PENDING;
    while (left > 0 && status == AUVID_PENDING) {
        status = auvid_identifier_work(id, 1);
        left -= id->work.last_units;
        end_merge(&id->metric);
        if (id->work.phase == AUVID_WORK_IDLE) {
            break; /* a set that waits is for the next call */
        }
    }
    id->work.last_units = budget - left;
    id->work.max_units = id->work.last_units > max_work ? id->work.last_units : max_work;
    return status;
}
