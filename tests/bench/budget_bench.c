/*
 * Measures the time to a result for different budgets [units of work per tick]. It counts ticks of
 * 20 ms from the end of a set's recording until the work is complete, with the simulated Girona500
 * under a disturbance of 1 N.
 *
 *     budget_bench [seeds]             default 10
 */
#include <stdio.h>
#include <stdlib.h>

#include "chain.h"

enum { MAX_CALLS = 10000000 };

static const uint32_t budgets[] = {1, 2, 5, 10, 20, 50, 100, AUVID_DEFAULT_BUDGET, 500, 1000};
enum { BUDGETS = sizeof budgets / sizeof budgets[0] };

static chain_t recorded, chain;

int main(int argc, char **argv)
{
    uint64_t seeds = argc > 1 ? strtoul(argv[1], NULL, 10) : 10;
    static const uint32_t sets[] = {1, 8};
    double mean[2][BUDGETS] = {{0}}, longest[2][BUDGETS] = {{0}};
    for (int k = 0; k < 2; ++k) {
        for (uint64_t seed = 1; seed <= seeds; ++seed) {
            chain_config_t cfg;
            chain_defaults(&cfg, seed, sets[k], 1.0);
            cfg.budget = 0;
            if (chain_run_sets(&recorded, &cfg, sets[k]) != AUVID_OK) {
                return 1;
            }
            for (int b = 0; b < BUDGETS; ++b) {
                chain = recorded;
                double s = 0.02 * chain_finish(&chain, budgets[b], MAX_CALLS);
                mean[k][b] += s / (double)seeds;
                longest[k][b] = s > longest[k][b] ? s : longest[k][b];
            }
        }
    }
    printf("%u seeds; time to a result [s], mean / longest\n%14s %20s %20s\n", (unsigned)seeds,
           "units a tick", "one set", "eight sets");
    for (int b = 0; b < BUDGETS; ++b) {
        printf("%14u", (unsigned)budgets[b]);
        for (int k = 0; k < 2; ++k) {
            printf(" %10.1f / %7.1f", mean[k][b], longest[k][b]);
        }
        printf("\n");
    }
    return 0;
}
