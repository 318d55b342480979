/*
 * Measures the number of evaluations of an identification and its success rate.
 *
 *     optimizer_bench [seeds]          default 200; each seed is another recorded problem
 *
 * Success: excess cost <= 1e-3 of the residual, and every parameter within 1 % of the least-squares
 * optimum computed in double. If all N seeds succeed, the 95 % interval of the rate is [1 - 3/N,
 * 1].
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/detail/optimizer.h"
#include "ls_problem.h"

typedef struct {
    const char *name;
    uint16_t population;
    auvid_real_t omega;
    bool column; /* scale by the inverse norms of the columns, else by the bounds */
    bool literal;
    int point; /* 0 none, 1 within 30 % of the optimum, -1 a corner of the bounds */
} row_t;

static const row_t rows[] = {
    {"m 4n,  omega 2", 52, 0, false, false, 0},
    {"m 4n,  omega 2,     columns", 52, 0, true, false, 0},
    {"m 4n,  omega n,              literal", 52, 0, false, true, 0},
    {"m 4n,  omega n,     columns, literal", 52, 0, true, true, 0},
    {"m 10n, omega 2", 130, 0, false, false, 0},
    {"m 10n, omega n,              literal", 130, 0, false, true, 0},
    {"m 4n,  omega 1e6 n", 52, AUVID_C(13e6), false, false, 0},
    {"m 10n, omega 1e6 n", 130, AUVID_C(13e6), false, false, 0},
    {"m 10n, omega 1e6 n,          literal", 130, AUVID_C(13e6), false, true, 0},
    {"m 4n,  omega 2,     good point", 52, 0, false, false, 1},
    {"m 4n,  omega 2,     bad point", 52, 0, false, false, -1},
    {"m 4n,  omega n,     good,    literal", 52, 0, false, true, 1},
    {"m 4n,  omega n,     bad,     literal", 52, 0, false, true, -1},
};

static void configure(auvid_search_config_t *c, auvid_real_t *scale, const row_t *row,
                      const ls_problem_t *p, uint64_t seed)
{
    auvid_search_defaults(c, LS_N);
    c->population = row->population;
    c->omega = row->omega;
    c->seed = seed + 1u;
    if (row->omega > 0) { /* this one converges by its own criterion */
        c->epsilon_crs = AUVID_C(1e-6);
        c->max_evaluations_crs = 150u * row->population;
    }
    c->paper = row->literal;
    if (row->literal) {
        c->epsilon_line = AUVID_C(1e-5);
    }
    for (int i = 0; i < LS_N; ++i) {
        c->lower[i] = AUVID_C(-1000.0);
        c->upper[i] = AUVID_C(1000.0);
        scale[i] = row->column ? (auvid_real_t)(1.0 / p->column[i]) : 0;
    }
}

static auvid_optimizer_t optimizer;

/* Returns the largest number of consecutive rejections. */
static uint32_t solve(const row_t *row, ls_problem_t *p, uint64_t seed)
{
    auvid_search_config_t cfg;
    auvid_real_t theta[AUVID_MAX_PARAMETERS], scale[LS_N];
    uint32_t rejections = 0;
    configure(&cfg, scale, row, p, seed);
    if (auvid_optimizer_init(&optimizer, &cfg, scale) != AUVID_OK) {
        fprintf(stderr, "%s: configuration refused\n", row->name);
        exit(1);
    }
    for (int i = 0; i < LS_N; ++i) {
        double factor = 1.0 + 0.3 * sin(1.0 + (double)seed * 7.0 + i * 3.0);
        theta[i] = row->point > 0 ? (auvid_real_t)fmin(p->optimum[i] * factor, 1000.0)
                                  : (auvid_real_t)(p->optimum[i] > 0 ? -1000.0 : 1000.0);
    }
    if (row->point != 0 && auvid_optimizer_add_point(&optimizer, theta) != AUVID_OK) {
        exit(1);
    }
    for (;;) {
        auvid_status_t status = auvid_optimizer_ask(&optimizer, theta);
        if (optimizer.state < AUVID_OPTIMIZER_START && optimizer.crs.rejections > rejections) {
            rejections = optimizer.crs.rejections;
        }
        if (status == AUVID_OK) {
            float pi[LS_N];
            for (int i = 0; i < LS_N; ++i) {
                pi[i] = (float)theta[i];
            }
            (void)auvid_optimizer_tell(&optimizer, (auvid_real_t)ls_problem_cost(p, pi));
        } else if (status != AUVID_PENDING) {
            return rejections;
        }
    }
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double quantile(double *x, size_t n, double q)
{
    qsort(x, n, sizeof *x, ascending);
    return x[(size_t)(q * (double)(n - 1) + 0.5)];
}

int main(int argc, char **argv)
{
    size_t seeds = argc > 1 ? (size_t)strtoul(argv[1], NULL, 10) : 200u;
    seeds = seeds > 0 ? seeds : 200u;
    double *x = malloc(3 * seeds * sizeof *x), *local = x + seeds, *total = local + seeds;
    if (x == NULL || AUVID_MAX_POPULATION < 130) {
        fprintf(stderr, "build with -DAUVID_MAX_POPULATION=130 or more\n");
        return 1;
    }
    printf("%zu problems, 13 parameters, box [-1000, 1000]; evaluations median / p95\n"
           "%-38s %8s %14s %14s %14s %9s %10s\n",
           seeds, "", "success", "global", "local", "total", "rejected*", "worst dev");
    for (size_t r = 0; r < sizeof rows / sizeof *rows; ++r) {
        size_t good = 0;
        uint32_t rejections = 0;
        double worst = 0.0;
        for (size_t s = 0; s < seeds; ++s) {
            ls_problem_t p;
            double pi[LS_N], deviation = 0.0;
            if (ls_problem_make(&p, s) != 0) {
                return 1;
            }
            uint32_t in_a_row = solve(&rows[r], &p, s);
            rejections = in_a_row > rejections ? in_a_row : rejections;
            const auvid_real_t *best = auvid_optimizer_best(&optimizer, NULL);
            for (int i = 0; i < LS_N; ++i) {
                pi[i] = (double)best[i];
                deviation = fmax(deviation, fabs(pi[i] / p.optimum[i] - 1.0));
            }
            good += deviation <= 0.01 && ls_problem_cost_double(&p, pi) <= 1e-3 * p.constant;
            worst = fmax(worst, deviation);
            auvid_optimizer_work_t work = optimizer.work;
            x[s] = work.crs;
            local[s] = work.line_search;
            total[s] = x[s] + local[s];
        }
        double *columns[3] = {x, local, total};
        printf("%-38s %7.1f%%", rows[r].name, 100.0 * (double)good / (double)seeds);
        for (int i = 0; i < 3; ++i) {
            double median = quantile(columns[i], seeds, 0.5);
            printf(" %6.0f /%6.0f", median, quantile(columns[i], seeds, 0.95));
        }
        printf(" %9u %9.2f%%\n", (unsigned)rejections, 100.0 * worst);
    }
    printf("* largest number of consecutive rejections in a run. m 4n = 52, 10n = 130.\n");
    free(x);
    return 0;
}
