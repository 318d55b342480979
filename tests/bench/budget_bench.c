/*
 * Measures the time to a result for different budgets [units of work per tick]. It counts ticks of
 * 20 ms from the end of a set's recording until the work is complete: the first set, and the eighth
 * after the results of the others. A driver moves the simulated Girona500 under a disturbance of
 * 1 N; the inputs are exact, then uncertain.
 *
 *     budget_bench [seeds]             default 10
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/uncertain.h"
#include "chain.h"

enum { MAX_CALLS = 10000000, CASES = 4 };

static const uint32_t budgets[] = {1, 2, 5, 10, 20, 50, 100, AUVID_DEFAULT_BUDGET, 500, 1000};
enum { BUDGETS = sizeof budgets / sizeof budgets[0] };

static chain_t chain;
static auvid_uncertain_t uncertain;

static void supply_forces(struct chain *c, auvid_input_t *in)
{
    auvid_allocation_result_t result;
    (void)auvid_allocation_solve(&c->allocation, in->applied.wrench, &result);
    memcpy(in->applied.command, result.force_N, sizeof result.force_N);
}

static void begin(uint64_t seed, uint32_t sets, bool is_uncertain)
{
    chain_config_t cfg;
    auvid_uncertain_config_t inputs;
    chain_defaults(&cfg, seed, sets, 1.0);
    chain_set_driver(&cfg);
    cfg.before = supply_forces;
    auvid_uncertain_defaults(&inputs);
    bool begun = chain_begin(&chain, &cfg) >= 0 &&
                 auvid_allocation_init(&chain.allocation, &cfg.thrusters) >= 0 &&
                 (!is_uncertain || auvid_identifier_attach_uncertain(&chain.id, &uncertain, &inputs,
                                                                     &chain.allocation) >= 0);
    if (!begun) {
        exit(1);
    }
}

/* Returns the seconds from the last of these sets to its result. */
static double seconds(uint64_t seed, uint32_t sets, bool is_uncertain, uint32_t budget)
{
    begin(seed, sets, is_uncertain);
    while (chain.id.metric.sets.recorded < sets) {
        bool last = chain.id.metric.sets.recorded == sets - 1 && chain.work == AUVID_OK;
        chain.cfg.budget = last ? 0 : AUVID_DEFAULT_BUDGET;
        chain_tick(&chain);
    }
    return 0.02 * chain_finish(&chain, budget, MAX_CALLS);
}

int main(int argc, char **argv)
{
    uint64_t seeds = argc > 1 ? strtoul(argv[1], NULL, 10) : 10;
    printf("%u seeds; time to a result [s], mean / longest\n%14s %39s  %39s\n%14s", (unsigned)seeds,
           "", "exact inputs", "uncertain inputs", "units a tick");
    printf(" %19s %19s  %19s %19s\n", "one set", "eight sets", "one set", "eight sets");
    for (int b = 0; b < BUDGETS; ++b) {
        printf("%14u", (unsigned)budgets[b]);
        for (int k = 0; k < CASES; ++k) {
            double mean = 0.0, longest = 0.0;
            for (uint64_t seed = 1; seed <= seeds; ++seed) {
                double s = seconds(seed, k % 2 > 0 ? 8 : 1, k >= 2, budgets[b]);
                mean += s / (double)seeds;
                longest = s > longest ? s : longest;
            }
            printf("%s %9.1f / %7.1f", k == 2 ? " " : "", mean, longest);
        }
        printf("\n");
    }
    return 0;
}
