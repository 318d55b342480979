/**
 * @file search_campaign.h
 * Searches of the residual path, seed by seed: how far the result is from the optimum and from the
 * truth, and what it took. A test program includes it once, and runs
 *
 *     campaign_options, then campaign_run with a function that identifies with one seed and ends
 *     with campaign_take. At each step it calls campaign_step.
 *
 * Long form (AUVID_TEST_LONG): 100 seeds; or COUNT and FIRST as arguments.
 */
#ifndef SEARCH_CAMPAIGN_H
#define SEARCH_CAMPAIGN_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/identifier.h"
#include "binomial.h"
#include "finish.h"
#include "unity.h"

enum { CAMPAIGN_MAX = 400 };

/** What the searches from all sets, and those from one set more than the last, came to. */
typedef struct {
    double evaluations[CAMPAIGN_MAX], seconds[CAMPAIGN_MAX], excess[CAMPAIGN_MAX];
    double squares; /**< of the relative errors of the parameters */
    int count, values;
} campaign_t;

static auvid_metric_t campaign_metric;

/** Cost of the stored rows. */
static inline double campaign_cost(const auvid_real_t *pi, auvid_real_t delay_s)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_cost_begin(&campaign_metric, pi, delay_s);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&campaign_metric, &budget));
    return (double)campaign_metric.result.cost;
}

/** Lowest cost that Algorithm 2 finds from pi; its steps are those of the standard errors. */
static inline double campaign_polish(const auvid_identifier_t *id, const auvid_real_t *start,
                                     auvid_real_t delay_s)
{
    static auvid_optimizer_t optimizer;
    auvid_search_config_t cfg;
    auvid_real_t scale[AUVID_MAX_PARAMETERS], theta[AUVID_MAX_PARAMETERS], best = 0;
    auvid_real_t pi[AUVID_MAX_PARAMETERS];
    uint8_t of[AUVID_MAX_PARAMETERS], n = 0;
    const auvid_metric_config_t *m = &id->metric.cfg;
    auvid_search_defaults(&cfg, 1);
    memcpy(pi, m->fixed, sizeof pi);
    for (uint8_t p = 0; p < m->vehicle->parameters; ++p) {
        if (m->free == 0 || (m->free >> p & 1u) != 0) {
            cfg.lower[n] = id->search.lower[p];
            cfg.upper[n] = id->search.upper[p];
            cfg.good[n] = start[p];
            scale[n] = 30 * id->estimate.confidence.sigma[p];
            of[n++] = p;
        }
    }
    cfg.n = n;
    if (m->estimate_delay) {
        cfg.lower[n] = 0;
        cfg.upper[n] = auvid_metric_longest_delay(&id->metric);
        cfg.good[n] = delay_s;
        scale[n] = (auvid_real_t)0.02;
        ++cfg.n;
    }
    cfg.phases = AUVID_SEARCH_LOCAL;
    cfg.has_good = true;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_optimizer_init(&optimizer, &cfg, scale));
    for (;;) {
        auvid_status_t status = auvid_optimizer_ask(&optimizer, theta);
        if (status == AUVID_OK) {
            for (int i = 0; i < n; ++i) {
                pi[of[i]] = theta[i];
            }
            auvid_real_t delay = m->estimate_delay ? theta[n] : m->delay_s[0];
            (void)auvid_optimizer_tell(&optimizer, (auvid_real_t)campaign_cost(pi, delay));
        } else if (status != AUVID_PENDING) {
            break;
        }
    }
    (void)auvid_optimizer_best(&optimizer, &best);
    return (double)best;
}

/** Cost of the estimate over the lowest that is found, less one: from it, also with the delay 10,
 * 20 and 40 ms longer and shorter, and from the truth. */
static inline double campaign_excess(const auvid_identifier_t *id, const double *truth,
                                     double delay_s)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    auvid_real_t delay = 0;
    campaign_metric = id->metric;
    auvid_metric_merge_begin(&campaign_metric); /* the weights */
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        delay = id->estimate.delay_s[j] > delay ? id->estimate.delay_s[j] : delay;
    }
    for (int i = 0; i < id->metric.cfg.vehicle->parameters; ++i) {
        pi[i] = (auvid_real_t)truth[i];
    }
    double cost = campaign_cost(id->estimate.pi, delay);
    double best = fmin(cost, campaign_polish(id, id->estimate.pi, delay));
    best = fmin(best, campaign_polish(id, pi, (auvid_real_t)delay_s));
    for (int k = 0; id->metric.cfg.estimate_delay && k < 6; ++k) {
        static const double beside_s[] = {-0.04, -0.02, -0.01, 0.01, 0.02, 0.04};
        double at = fmax(0.0, (double)delay + beside_s[k]);
        best = fmin(best, campaign_polish(id, id->estimate.pi, (auvid_real_t)at));
    }
    return cost / best - 1.0;
}

/** Set after which the first of two searches runs; 0: one search, of all sets. */
static uint32_t campaign_early;

/** The earlier search. */
static inline void campaign_step(auvid_identifier_t *id)
{
    if (campaign_early > 0 && id->metric.sets.recorded == campaign_early &&
        id->estimate.number == 0) {
        finish_work(id, UINT32_MAX);
    }
}

static campaign_t campaign_first, campaign_later;

/** Take the result of the last search, which ended with finish_work at the default budget.
 * @param wanted bit i: truth[i] counts */
static inline void campaign_take(const auvid_identifier_t *id, const double *truth, uint32_t wanted,
                                 double delay_s)
{
    campaign_t *c = campaign_early > 0 ? &campaign_later : &campaign_first;
    int k = c->count++;
    TEST_ASSERT_EQUAL_UINT32(campaign_early > 0 ? 2 : 1, id->estimate.number);
    TEST_ASSERT_FALSE(id->estimate.not_converged);
    double squares = 0.0;
    int values = 0;
    TEST_ASSERT_TRUE(c->count <= CAMPAIGN_MAX);
    c->evaluations[k] = id->estimate.evaluations_crs + id->estimate.evaluations_line;
    c->seconds[k] = 0.02 * (finish_calls + 1.0); /* the work begins in a call of its own */
    c->excess[k] = campaign_excess(id, truth, delay_s);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        if ((wanted >> i & 1u) != 0) {
            double error = (double)id->estimate.pi[i] / truth[i] - 1.0;
            squares += error * error;
            ++values;
        }
    }
    c->squares += squares;
    c->values += values;
    if (campaign_is_long()) {
        printf("  %u + %u evaluations, %.1f s, excess %.1e, rms error %.2f %%\n",
               (unsigned)id->estimate.evaluations_crs, (unsigned)id->estimate.evaluations_line,
               c->seconds[k], c->excess[k], 100.0 * sqrt(squares / values));
        (void)fflush(stdout);
    }
}

static inline int campaign_order(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static inline double campaign_quantile(double *x, int n, double part)
{
    qsort(x, (size_t)n, sizeof *x, campaign_order);
    return x[(int)fmin(n - 1, part * n)];
}

/** Print median, 95 % and largest; rms error. @return runs with an excess above 1e-3 */
static inline int campaign_report(campaign_t *c, const char *name)
{
    int n = c->count, above = 0;
    for (int k = 0; k < n; ++k) {
        above += c->excess[k] > 1e-3;
    }
    printf(
        "%s, %d runs: evaluations %.0f, %.0f (95 %%); %.1f, %.1f s; excess %.1e, %.1e, %.1e (the "
        "largest), %d above 1e-3; rms error %.3f %%\n",
        name, n, campaign_quantile(c->evaluations, n, 0.5),
        campaign_quantile(c->evaluations, n, 0.95), campaign_quantile(c->seconds, n, 0.5),
        campaign_quantile(c->seconds, n, 0.95), campaign_quantile(c->excess, n, 0.5),
        campaign_quantile(c->excess, n, 0.95), campaign_quantile(c->excess, n, 1.0), above,
        100.0 * sqrt(c->squares / c->values));
    return above;
}

/** Seeds of a campaign: `few` of them, or those given as COUNT and FIRST to the program. */
static struct {
    uint64_t first, count;
} campaign_seeds = {1, 0};

static inline void campaign_options(int argc, char **argv, uint32_t few)
{
    campaign_seeds.count = campaign_is_long() ? 100 : few;
    if (argc > 1) {
        campaign_seeds.count = strtoull(argv[1], NULL, 10);
    }
    if (argc > 2) {
        campaign_seeds.first = strtoull(argv[2], NULL, 10);
    }
}

/** Report; no search may end above the optimum. */
static inline void campaign_judge(campaign_t *c, const char *name, const char *which)
{
    char of[64];
    (void)snprintf(of, sizeof of, "%s, %s search", name, which);
    TEST_ASSERT_EQUAL_MESSAGE(0, campaign_report(c, of), "above the optimum");
}

/** Identify with each seed: one search of all `sets` sets; one after a search of all but one. */
static inline void campaign_run(void (*identify_seed)(uint64_t seed), uint32_t sets,
                                const char *name)
{
    for (uint64_t k = 0; k < campaign_seeds.count; ++k) {
        campaign_early = 0;
        identify_seed(campaign_seeds.first + k);
        campaign_early = sets - 1;
        identify_seed(campaign_seeds.first + k);
    }
    campaign_judge(&campaign_first, name, "first");
    campaign_judge(&campaign_later, name, "later");
}

#endif
