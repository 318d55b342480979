#include "heldout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "literal.h"
#include "simulator.h"
#include "statistics.h"

/* Length of the bootstrap blocks, because residuals of neighbouring cells are correlated. */
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

/* Simulates all cells, sums errors in block[][AUVID_DOF_COUNT], returns the number of blocks. */
static size_t simulate(auvid_validation_t *validation, const cells_t *cells, block_t *block)
{
    size_t used = 0;
    double began_us = -1e18;
    for (size_t i = 0; i < cells->cells; ++i) {
        const auvid_sample_t *cell = &cells->cell[i].sample;
        uint32_t before = validation->cells;
        if (cells->cell[i].after_gap) {
            auvid_validation_gap(validation);
        }
        if (auvid_validation_add(validation, cell) != AUVID_OK || validation->cells == before) {
            continue;
        }
        if ((double)cell->t_us - began_us >= 1e6 * BLOCK_S) {
            began_us = (double)cell->t_us;
            ++used;
        }
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            double y = (double)cell->nu[j], e = y - (double)validation->predicted[j];
            const block_t one = {.count = 1.0, .y = y, .yy = y * y, .ee = e * e};
            add(&block[(used - 1) * AUVID_DOF_COUNT + (size_t)j], &one);
        }
    }
    return used;
}

bool heldout_r2(const csv_log_t *log, const replay_t *replay,
                const auvid_recorder_config_t *recorder, uint64_t seed, result_t *result)
{
    cells_t cells;
    auvid_validation_t validation;
    auvid_real_t cell_s = AUVID_C(1e-6) * (auvid_real_t)recorder->cell_us;
    uint32_t dofs = result->estimate.excited;
    if (!replay_record(log, replay, recorder, &cells)) {
        return false;
    }
    result->has_validation = true;
    size_t max_blocks = cells.cells + 1; /* at most one block per cell */
    block_t *block = calloc(max_blocks * AUVID_DOF_COUNT, sizeof *block);
    block_t *one = calloc(max_blocks, sizeof *one);
    if (block == NULL || one == NULL) {
        free(block);
        free(one);
        cells_free(&cells);
        return false;
    }
    if (auvid_validation_init(&validation, result->vehicle, result->estimate.pi, dofs,
                              result->estimate.delay_s, result->estimate.first_order_lag,
                              cell_s) == AUVID_OK) {
        size_t blocks = simulate(&validation, &cells, block);
        sim_rng_t rng;
        sim_rng_seed(&rng, seed, 0);
        for (size_t j = 0; j < AUVID_DOF_COUNT && blocks > 0; ++j) {
            for (size_t i = 0; i < blocks; ++i) {
                one[i] = block[i * AUVID_DOF_COUNT + j];
            }
            interval(one, blocks, &rng, result, (int)j);
        }
        result->validated = blocks > 0 ? dofs : 0u;
        result->has_interval = true;
    }
    free(block);
    free(one);
    cells_free(&cells);
    return true;
}
