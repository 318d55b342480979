/*
 * The identifier's work aboard the simulated vehicle: bounds of its units, recording without work,
 * and the cost of a result.
 */
#ifndef IDENTIFIER_WORK_H
#define IDENTIFIER_WORK_H

#include "chain.h"
#include "identifier/auvid_identifier_internal.h"
#include "unity.h"

static const uint32_t budgets[] = {1, 7, 200, 100000};
enum { BUDGETS = sizeof budgets / sizeof budgets[0] };

static chain_t chain;
static chain_config_t cfg;

/* Upper bound of the units of a search: the caps of types.h (40 m evaluations, 50 m trials outside
 * the box before each, and 1000 n evaluations; trials without room are
 * bounded), `rows` units for an evaluation, three passes of the merge, and the measurement. */
static inline uint32_t units_at_most(uint32_t n, uint32_t m, uint32_t rows)
{
    uint32_t evaluations = 40 * m + 1000 * n;
    return evaluations * (rows + 2) + 40 * m * 50 * m + 8 * 10000;
}

/* Rows of R: the columns of all equations together. */
static inline uint32_t rows_of_girona500(void)
{
    uint32_t rows = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (uint32_t c = auvid_girona500.columns[j] & AUVID_G500_FREE; c != 0; c &= c - 1) {
            ++rows;
        }
    }
    return rows;
}

/* The same for the 13 parameters with a population m. */
static inline uint32_t units_of_13(uint32_t m)
{
    return units_at_most(13, m, rows_of_girona500());
}

/* Work to the end with a budget; check every call. */
static inline void finish(uint32_t budget, uint32_t units)
{
    chain.max_units = 0;
    TEST_ASSERT_TRUE(chain_finish(&chain, budget, units / budget + 1) <= units / budget + 1);
    TEST_ASSERT_EQUAL(AUVID_OK, chain.work);
    TEST_ASSERT_FALSE(chain.over_budget);
    TEST_ASSERT_TRUE(chain.max_units <= budget);
}

/* Record `sets` sets without work. */
static inline void record(uint32_t sets)
{
    cfg.budget = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, sets));
    TEST_ASSERT_EQUAL_UINT32(sets, chain.id.metric.sets.recorded);
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.number);
}

/* The cost of any pi on the merged sets, with a copy of the metric. */
static inline double cost_on(const auvid_metric_t *merged, const auvid_real_t *pi)
{
    static auvid_metric_t metric;
    uint32_t budget = UINT32_MAX;
    metric = *merged;
    auvid_metric_cost_begin(&metric, pi, chain.id.estimate.delay_s[AUVID_SURGE]);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    return (double)metric.result.cost;
}

/* The same on the data in the ring. */
static inline double cost_of(const auvid_real_t *pi)
{
    return cost_on(&chain.id.metric, pi);
}

/* The estimate is as good as the least-squares optimum: excess cost within 1e-3 of the residual. */
static inline void check_optimum(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&chain.id.metric, AUVID_G500_FREE, pi));
    double optimum = cost_of(pi), found = cost_of(chain.id.estimate.pi);
    TEST_ASSERT_TRUE(found - optimum <= 1e-3 * (double)chain.id.metric.result.constant);
    TEST_ASSERT_TRUE(chain.id.estimate.cost == (auvid_real_t)found); /* not stale */
}

/* Events while sets complete during searches. */
typedef struct {
    uint32_t begun, ended;      /* searches */
    uint32_t validated, newest; /* number of the last set validated; of the newest in the search */
    uint32_t drops, restored;   /* events for dropped rows, for an estimate restored */
} watch_t;

#endif
