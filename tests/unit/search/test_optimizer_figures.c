/*
 * The optimizer's figures, on recorded 13-parameter problems in the box [-1000, 1000], float32
 * cost: success in 100 %, evaluations. Every seed is another problem (ls_problem.h) and another
 * random search. 100 seeds; with AUVID_TEST_LONG in the environment 1000.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/detail/optimizer.h"
#include "finish.h"
#include "ls_problem.h"
#include "unity.h"

enum { MOST = 1000 };

/* Goals; a quantile meets its goal if the upper end of its 95 % interval does. */
static const double goal_median = 550.0, goal_p95 = 700.0;

static auvid_optimizer_t optimizer;
static ls_problem_t problems[MOST];
static int seeds;

void setUp(void)
{
}

void tearDown(void)
{
}

typedef enum { NOTHING, GOOD, BAD } known_t;

static double solve(ls_problem_t *p, uint64_t seed, bool column, bool literal, known_t known)
{
    auvid_search_config_t cfg;
    auvid_real_t theta[AUVID_MAX_PARAMETERS], scale[LS_N], last = AUVID_LARGEST, best = 0;
    p->evaluations = 0;
    auvid_search_defaults(&cfg, LS_N);
    cfg.seed = seed + 1u;
    cfg.paper = literal;
    cfg.epsilon_line = literal ? AUVID_C(1e-5) : cfg.epsilon_line;
    for (int i = 0; i < LS_N; ++i) {
        double off = 0.3 * sin(1.0 + 7.0 * (double)seed + 3.0 * i);
        cfg.lower[i] = -1000;
        cfg.upper[i] = 1000;
        scale[i] = column ? (auvid_real_t)(1.0 / p->column[i]) : 0;
        theta[i] = known == GOOD ? (auvid_real_t)fmin(1000.0, p->optimum[i] * (1.0 + off))
                                 : (auvid_real_t)copysign(1000.0, -p->optimum[i]);
    }
    TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_init(&optimizer, &cfg, scale));
    if (known != NOTHING) {
        TEST_ASSERT_EQUAL_INT(AUVID_OK, auvid_optimizer_add_point(&optimizer, theta));
    }
    for (uint32_t turns = 0;;) {
        auvid_status_t status = auvid_optimizer_ask(&optimizer, theta);
        finish_turn(&turns, 10000000);
        if (status == AUVID_OK) {
            float pi[LS_N];
            for (int i = 0; i < LS_N; ++i) {
                pi[i] = (float)theta[i];
            }
            auvid_optimizer_tell(&optimizer, (auvid_real_t)ls_problem_cost(p, pi));
            auvid_optimizer_best(&optimizer, &best);
            TEST_ASSERT_TRUE(best <= last);
            last = best;
            if (optimizer.state < AUVID_OPTIMIZER_START) {
                TEST_ASSERT_TRUE(optimizer.crs.rejections < 50u * 4u * LS_N);
            }
        } else if (status != AUVID_PENDING) {
            TEST_ASSERT_EQUAL_INT(AUVID_FINISHED, status);
            break;
        }
    }
    for (int i = 0; i < 2 * LS_N; ++i) {
        TEST_ASSERT_TRUE(optimizer.line_search.alpha[i] <= AUVID_C(1e-3));
    }
    auvid_optimizer_work_t work = optimizer.work;
    TEST_ASSERT_TRUE((unsigned long)work.crs + work.line_search == p->evaluations);
    return (double)p->evaluations;
}

static void succeeded(const ls_problem_t *p)
{
    double pi[LS_N];
    for (int i = 0; i < LS_N; ++i) {
        pi[i] = (double)auvid_optimizer_best(&optimizer, NULL)[i];
        TEST_ASSERT_TRUE_MESSAGE(fabs(pi[i] / p->optimum[i] - 1.0) <= 0.01, "off by over 1 %");
    }
    TEST_ASSERT_TRUE(ls_problem_cost_double(p, pi) <= 1e-3 * p->constant);
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Upper end of the 95 % interval of quantile q: an order statistic, by the normal approximation to
 * the binomial. */
static double upper_end(double *x, double q)
{
    double rank = q * seeds + 1.96 * sqrt(q * (1.0 - q) * seeds);
    qsort(x, (size_t)seeds, sizeof *x, ascending);
    return x[rank < seeds - 1 ? (int)ceil(rank) : seeds - 1];
}

static void campaign(double *evaluations, bool column, bool literal, known_t known)
{
    for (int s = 0; s < seeds; ++s) {
        evaluations[s] = solve(&problems[s], (uint64_t)s, column, literal, known);
        succeeded(&problems[s]);
    }
}

static void test_every_seed_reaches_the_least_squares_optimum_within_the_target_evaluations(void)
{
    static double x[MOST];
    for (int column = 0; column < 2; ++column) {
        campaign(x, column != 0, false, NOTHING);
        double median = upper_end(x, 0.5), p95 = upper_end(x, 0.95);
        printf("%d of %d seeds (95 %%: >= %.1f %%), %s: evaluations median %.0f (<= %.0f), "
               "p95 %.0f (<= %.0f), most %.0f\n",
               seeds, seeds, 100.0 - 300.0 / seeds, column ? "columns" : "box", x[seeds / 2],
               median, x[seeds * 95 / 100], p95, x[seeds - 1]);
        TEST_ASSERT_TRUE(median <= goal_median);
        TEST_ASSERT_TRUE(p95 <= goal_p95);
    }
}

static void test_the_papers_algorithms_reach_it_too(void)
{
    static double x[MOST];
    campaign(x, false, true, NOTHING);
    printf("paper: median <= %.0f\n", upper_end(x, 0.5));
}

/* Upper end of the 95 % interval of the mean paired difference, and the sample's p95. */
static void no_worse(const double *known, const double *none, const char *name)
{
    static double a[MOST], b[MOST];
    double mean = 0.0, square = 0.0, base = 0.0;
    for (int s = 0; s < seeds; ++s) {
        mean += (known[s] - none[s]) / seeds;
        square += (known[s] - none[s]) * (known[s] - none[s]) / seeds;
        base += none[s] / seeds;
    }
    double end = mean + 1.96 * sqrt((square - mean * mean) / seeds);
    memcpy(a, known, sizeof a);
    memcpy(b, none, sizeof b);
    (void)upper_end(a, 0.95);
    (void)upper_end(b, 0.95);
    double ratio = a[seeds * 95 / 100] / b[seeds * 95 / 100];
    printf("%s known point: mean %+.1f %% (<= %+.1f %%), p95 %+.1f %%\n", name, 100.0 * mean / base,
           100.0 * end / base, 100.0 * (ratio - 1.0));
    TEST_ASSERT_TRUE(end <= 0.1 * base);
    TEST_ASSERT_TRUE(ratio <= 1.1);
}

static void test_a_known_point_helps_or_does_no_harm(void)
{
    static double none[MOST], known[MOST];
    campaign(none, false, false, NOTHING);
    campaign(known, false, false, GOOD);
    no_worse(known, none, "good");
    campaign(known, false, false, BAD);
    no_worse(known, none, "bad");
}

static void test_the_problems_are_normalised_and_those_of_two_seeds_differ(void)
{
    const double zero[LS_N] = {0};
    for (int s = 1; s < seeds; ++s) {
        const ls_problem_t *a = &problems[s - 1], *b = &problems[s];
        TEST_ASSERT_TRUE(fabs(ls_problem_cost_double(a, zero) + a->constant - 1.0) < 0.01);
        TEST_ASSERT_TRUE(fabs(a->optimum[0] / b->optimum[0] - 1.0) > 1e-6);
    }
}

int main(void)
{
    seeds = getenv("AUVID_TEST_LONG") != NULL ? MOST : 100;
    for (int s = 0; s < seeds; ++s) {
        if (ls_problem_make(&problems[s], (uint64_t)s) != 0) {
            return 1;
        }
    }
    UNITY_BEGIN();
    RUN_TEST(test_the_problems_are_normalised_and_those_of_two_seeds_differ);
    RUN_TEST(test_every_seed_reaches_the_least_squares_optimum_within_the_target_evaluations);
    RUN_TEST(test_the_papers_algorithms_reach_it_too);
    RUN_TEST(test_a_known_point_helps_or_does_no_harm);
    return UNITY_END();
}
