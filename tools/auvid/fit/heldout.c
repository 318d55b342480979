#include "heldout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "literal.h"
#include "../base/report_error.h"
#include "simulator.h"
#include "../report/statistics.h"

/* Shortest length of the bootstrap blocks, because residuals of neighbouring cells are correlated.
 * When a log has more than BLOCKS of them, they become twice as long. */
#define BLOCK_S 10.0
enum { BLOCKS = 8192 };

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

/* Sums over a block, for one DoF. */
typedef struct {
    double count, y, yy, ee;
} block_t;

static double r2_of(const block_t *b)
{
    double about_mean = b->yy - b->y * b->y / b->count;
    return about_mean > 0.0 ? 1.0 - b->ee / about_mean : 0.0;
}

static void add(block_t *to, const block_t *from)
{
    to->count += from->count;
    to->y += from->y;
    to->yy += from->yy;
    to->ee += from->ee;
}

/* R2 over all blocks, and its 95 % interval by bootstrap over the blocks. */
static void interval(const block_t *block, size_t blocks, sim_rng_t *rng, result_t *result, int j)
{
    double r2[RESAMPLES];
    block_t all = {0};
    for (size_t i = 0; i < blocks; ++i) {
        add(&all, &block[i]);
    }
    result->r2[j] = r2_of(&all);
    for (int k = 0; k < RESAMPLES; ++k) {
        block_t drawn = {0};
        for (size_t i = 0; i < blocks; ++i) {
            add(&drawn, &block[(size_t)(sim_rng_uniform(rng) * (double)blocks)]);
        }
        r2[k] = r2_of(&drawn);
    }
    result->r2_low[j] = statistics_quantile(r2, RESAMPLES, 0.025);
    result->r2_high[j] = statistics_quantile(r2, RESAMPLES, 0.975);
}

/* Simulates cells and sums errors. */
typedef struct {
    auvid_validation_t validation;
    block_t block[BLOCKS][AUVID_DOF_COUNT];
    block_t one[BLOCKS]; /* blocks of one DoF */
    size_t used;         /* number of blocks */
    double began_us;     /* start of the last one */
    double block_us;     /* their length */
    trace_t *trace;
    bool after_gap; /* since the cell that was compared last */
} blocks_t;

/* Makes room by blocks of twice the length. */
static void merge_blocks(blocks_t *b)
{
    for (size_t i = 0; i < b->used / 2; ++i) {
        for (size_t j = 0; j < AUVID_DOF_COUNT; ++j) {
            b->block[i][j] = b->block[2 * i][j];
            add(&b->block[i][j], &b->block[2 * i + 1][j]);
        }
    }
    b->used /= 2;
    b->block_us *= 2.0;
    memset(b->block[b->used], 0, (BLOCKS - b->used) * sizeof b->block[0]);
}

static void take_cell(void *context, const auvid_sample_t *cell, bool after_gap)
{
    blocks_t *b = context;
    uint32_t before = b->validation.cells;
    if (after_gap) {
        auvid_validation_gap(&b->validation);
        b->after_gap = true;
    }
    if (auvid_validation_add(&b->validation, cell) != AUVID_OK || b->validation.cells == before) {
        return;
    }
    trace_add(b->trace, &b->validation, cell, b->after_gap);
    b->after_gap = false;
    if ((double)cell->t_us - b->began_us >= b->block_us) {
        if (b->used == BLOCKS) {
            merge_blocks(b);
        }
        b->began_us = (double)cell->t_us;
        ++b->used;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        double y = (double)cell->nu[j], e = y - (double)b->validation.predicted[j];
        const block_t one = {.count = 1.0, .y = y, .yy = y * y, .ee = e * e};
        add(&b->block[b->used - 1][j], &one);
    }
}

static void intervals(blocks_t *b, uint64_t seed, result_t *result)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, 0);
    for (size_t j = 0; j < AUVID_DOF_COUNT && b->used > 0; ++j) {
        for (size_t i = 0; i < b->used; ++i) {
            b->one[i] = b->block[i][j];
        }
        interval(b->one, b->used, &rng, result, (int)j);
    }
    result->validated = b->used > 0 ? result->estimate.excited : 0u;
    result->has_interval = true;
}

int heldout_r2(const log_set_t *logs, const log_use_t *use, const auvid_recorder_config_t *recorder,
               uint64_t seed, trace_t *trace, result_t *result)
{
    const auvid_estimate_t *e = &result->estimate;
    auvid_real_t cell_s = AUVID_C(1e-6) * (auvid_real_t)recorder->cell_us;
    blocks_t *b = calloc(1, sizeof *b);
    if (b == NULL) {
        return report_error("%s: not enough memory", logs->log[0].csv.path);
    }
    b->began_us = -1e18;
    b->block_us = 1e6 * BLOCK_S;
    b->trace = trace;
    const csv_log_t *csv = &logs->log[0].csv;
    trace_begin(trace, (size_t)((csv->last_s - csv->first_s) / (double)cell_s), (double)cell_s);
    result->has_validation = true;
    int status = 0;
    if (auvid_validation_init(&b->validation, result->vehicle, e->pi, e->excited, e->delay_s,
                              e->first_order_lag, cell_s) == AUVID_OK) {
        status = replay_cells(logs, use, recorder, take_cell, b);
        intervals(b, seed, result);
    }
    free(b);
    return status;
}
