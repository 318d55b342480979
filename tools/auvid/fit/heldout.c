#include "heldout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "literal.h"
#include "metric/auvid_confidence_notes_internal.h"
#include "../base/report_error.h"
#include "simulator.h"
#include "../report/statistics.h"

/* Shortest length of the bootstrap blocks, because residuals of neighbouring cells are correlated.
 * When a log has more than HELDOUT_BLOCKS of them, they become twice as long. */
#define BLOCK_S 10.0

/* ---- cross-validation ---- */

static bool merge(auvid_metric_t *metric)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(metric);
    return literal_merge(metric, &budget) == AUVID_OK;
}

/* Sum of squared residuals / tau_max^2 over the excited DoF of set `age`; *rows counts them. */
static double left_out(const auvid_metric_t *whole, uint8_t age, uint8_t sets, uint32_t *rows)
{
    auvid_metric_t train = *whole, test = *whole;
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    memcpy(pi, whole->cfg.fixed, sizeof pi);
    (void)auvid_metric_drop(&train, age);
    for (uint8_t other = 0; other < sets; ++other) {
        if (other != age) {
            (void)auvid_metric_drop(&test, other);
        }
    }
    if (!merge(&train)) {
        return 0.0;
    }
    (void)auvid_metric_least_squares(&train, auvid_metric_searched(&train), pi);
    test.cfg.estimate_delay = false;
    memcpy(test.cfg.delay_s, train.result.delay_s, sizeof test.cfg.delay_s);
    test.cfg.first_order_lag = train.result.first_order_lag;
    uint32_t budget = UINT32_MAX;
    if (!merge(&test)) {
        return 0.0;
    }
    auvid_metric_measure_begin(&test, pi, AUVID_C(0.0));
    if (auvid_metric_measure(&test, &budget) != AUVID_OK) {
        return 0.0;
    }
    double sum = 0.0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (test.result.excited & train.result.excited & 1u << j) {
            double scale = (double)test.cfg.tau_max[j];
            sum += (double)test.result.sse[j] / (scale * scale);
            *rows += test.result.dof_rows[j];
        }
    }
    return sum;
}

double heldout_cross_validation(const auvid_metric_t *metric)
{
    uint32_t rows = 0, recorded = metric->sets.recorded;
    uint8_t sets = recorded < metric->cfg.sets ? (uint8_t)recorded : metric->cfg.sets;
    double sum = 0.0;
    for (uint8_t age = 0; age < sets && sets > 1; ++age) {
        sum += left_out(metric, age, sets, &rows);
    }
    return rows > 0 ? sum / rows : -1.0;
}

/* ---- R2 of simulated velocity ---- */

typedef heldout_sums_t sums_t;

static double r2_of(const sums_t *b)
{
    double about_mean = b->yy - b->y * b->y / b->count;
    return about_mean > 0.0 ? 1.0 - b->ee / about_mean : 0.0;
}

static void add(sums_t *to, const sums_t *from)
{
    to->count += from->count;
    to->y += from->y;
    to->yy += from->yy;
    to->ee += from->ee;
}

/* R2 over all blocks, and its 95 % interval by bootstrap over the blocks. */
static void interval(const heldout_blocks_t *b, sim_rng_t *rng, result_t *result, int j)
{
    double r2[RESAMPLES];
    sums_t all = {0};
    for (size_t i = 0; i < b->used; ++i) {
        add(&all, &b->block[i][j]);
    }
    result->r2[j] = r2_of(&all);
    for (int k = 0; k < RESAMPLES; ++k) {
        sums_t drawn = {0};
        for (size_t i = 0; i < b->used; ++i) {
            add(&drawn, &b->block[(size_t)(sim_rng_uniform(rng) * (double)b->used)][j]);
        }
        r2[k] = r2_of(&drawn);
    }
    result->r2_low[j] = statistics_quantile(r2, RESAMPLES, 0.025);
    result->r2_high[j] = statistics_quantile(r2, RESAMPLES, 0.975);
}

/* Simulates cells and sums errors. */
typedef struct {
    auvid_validation_t validation;
    heldout_blocks_t *blocks;
    double began_us; /* start of the last block */
    trace_t *trace;  /* NULL: none is wanted */
    bool after_gap;  /* since the cell that was compared last */
} simulation_t;

/* Makes room by blocks of twice the length. */
static void merge_blocks(heldout_blocks_t *b)
{
    for (size_t i = 0; i < b->used / 2; ++i) {
        for (size_t j = 0; j < AUVID_DOF_COUNT; ++j) {
            b->block[i][j] = b->block[2 * i][j];
            add(&b->block[i][j], &b->block[2 * i + 1][j]);
        }
    }
    b->used /= 2;
    b->block_us *= 2.0;
    memset(b->block[b->used], 0, (HELDOUT_BLOCKS - b->used) * sizeof b->block[0]);
}

static void take_cell(void *context, const auvid_sample_t *cell, bool after_gap)
{
    simulation_t *s = context;
    heldout_blocks_t *b = s->blocks;
    uint32_t before = s->validation.cells;
    if (after_gap) {
        auvid_validation_gap(&s->validation);
        s->after_gap = true;
    }
    if (auvid_validation_add(&s->validation, cell) != AUVID_OK || s->validation.cells == before) {
        return;
    }
    if (s->trace != NULL) {
        trace_add(s->trace, &s->validation, cell, s->after_gap);
    }
    s->after_gap = false;
    if ((double)cell->t_us - s->began_us >= b->block_us) {
        if (b->used == HELDOUT_BLOCKS) {
            merge_blocks(b);
        }
        s->began_us = (double)cell->t_us;
        ++b->used;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double y = (double)cell->nu[j], e = y - (double)s->validation.predicted[j];
        const sums_t one = {.count = 1.0, .y = y, .yy = y * y, .ee = e * e};
        add(&b->block[b->used - 1][j], &one);
    }
}

heldout_blocks_t *heldout_blocks(void)
{
    heldout_blocks_t *b = calloc(1, sizeof *b);
    if (b == NULL) {
        (void)report_error("fit: not enough memory");
    } else {
        b->block_us = 1e6 * BLOCK_S;
    }
    return b;
}

/* The degrees of freedom to simulate, a bit each. Where most of the force is unexplained the
 * simulated velocity has nothing to do with the log, and spoils those that are coupled to it. */
static uint32_t explained(const auvid_estimate_t *e, const auvid_vehicle_t *vehicle)
{
    uint32_t dofs = e->excited;
    for (int i = 0; i < vehicle->parameters; ++i) {
        if (e->confidence.note[i] == AUVID_NOTE_UNCERTAIN &&
            e->confidence.partner[i] == UNEXPLAINED) {
            dofs &= ~(1u << vehicle->parameter[i].dof);
        }
    }
    return dofs;
}

int heldout_simulate(const log_set_t *logs, const log_use_t *use,
                     const auvid_recorder_config_t *recorder, const auvid_vehicle_t *vehicle,
                     const auvid_estimate_t *e, trace_t *trace, heldout_blocks_t *blocks)
{
    simulation_t s = {.blocks = blocks, .began_us = -1e18, .trace = trace};
    auvid_real_t cell_s = AUVID_C(1e-6) * (auvid_real_t)recorder->cell_us;
    blocks->dofs = explained(e, vehicle);
    blocks->impossible = blocks->impossible || blocks->dofs == 0 ||
                         auvid_validation_init(&s.validation, vehicle, e->pi, blocks->dofs,
                                               e->delay_s, e->first_order_lag, cell_s) != AUVID_OK;
    return blocks->impossible ? 0 : replay_cells(logs, use, recorder, take_cell, &s);
}

int heldout_r2(const log_set_t *logs, const log_use_t *use, const auvid_identifier_t *id,
               uint64_t seed, trace_t *trace, result_t *result)
{
    const auvid_recorder_config_t *recorder = &id->recorder.cfg;
    double cell_s = 1e-6 * (double)recorder->cell_us;
    heldout_blocks_t *b = heldout_blocks();
    if (b == NULL) {
        return EXIT_REFUSED;
    }
    const csv_log_t *csv = &logs->log[0].csv;
    trace_begin(trace, (size_t)((csv->last_s - csv->first_s) / cell_s), cell_s);
    result->has_validation = true;
    int status = heldout_simulate(logs, use, recorder, result->vehicle,
                                  auvid_identifier_estimate(id), trace, b);
    if (!b->impossible) {
        sim_rng_t rng;
        sim_rng_seed(&rng, seed, 0);
        for (int j = 0; j < AUVID_DOF_COUNT && b->used > 0; ++j) {
            interval(b, &rng, result, j);
        }
        result->validated = b->used > 0 ? b->dofs : 0u;
        result->has_interval = true;
    }
    free(b);
    return status;
}
