/*
 * The adaptive excitation beside the plan, on many vehicles: the time until everything is known,
 * and the error then.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "adaptive_run.h"
#include "binomial.h"
#include "unity.h"

void setUp(void)
{
    make_world(1, 1.0);
}

void tearDown(void)
{
}

enum { MOST_RUNS = 100, MAX_S = 480, SETS = MAX_S / 30, RESAMPLES = 1000 };

enum { ADAPTIVE, AT_ONCE, ONE_BY_ONE, WAYS };

/* Of one run: time until everything was known, at most MAX_S (one by one four times that); mean
 * square error at the run's end, or after each set. */
typedef struct {
    double done_s[WAYS], end_s, end_square, square[SETS + 1], set_s[SETS + 1];
    double known_square[WAYS]; /* mean square error when everything was known */
    bool known[WAYS];
} outcome_t;

static outcome_t outcome[MOST_RUNS];
static uint32_t aborted, gave_up, false_alarms;
static bool over;

/* One of many vehicles: each mass and drag of the Girona500 up to halved or doubled. */
static void vary(uint64_t seed)
{
    sim_rng_t rng;
    sim_rng_seed(&rng, seed, 77);
    for (int i = 0; i < N; ++i) {
        double f = exp2(2.0 * sim_rng_uniform(&rng) - 1.0);
        config.sim.parameter[i] *= i == SIM_WB ? 1.0 : f;
    }
}

static void run_one(uint32_t seed, double disturbance_N, bool other, int way)
{
    outcome_t *o = &outcome[seed - 1];
    double max_s = way == ONE_BY_ONE ? 4.0 * MAX_S : MAX_S;
    uint32_t number = 0;
    make_world(seed, disturbance_N);
    if (way == ONE_BY_ONE) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_schedule(&config.acting.excitation, amplitude,
                                                              30, SETS, seed, 0, true));
    }
    config.acting.guard.run_max_s = 3600; /* one by one takes longer */
    if (other) {
        vary(seed);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    if (way == ADAPTIVE) {
        cfg.max_s = MAX_S;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
    }
    const auvid_estimate_t *e = &chain.id.estimate;
    while (1e-6 * (double)chain.t_us < max_s + 12.0 && chain.out.guard != AUVID_GUARD_ABORTED &&
           !(way != AT_ONCE && (seen.done_s > 0.0 || chain.out.guard == AUVID_GUARD_DONE))) {
        chain_tick(&chain);
        if (way == AT_ONCE && e->number != number && e->sets <= SETS) {
            number = e->number;
            o->square[e->sets] = chain_mean_square(&chain);
            o->set_s[e->sets] = 1e-6 * (double)chain.t_us;
        }
    }
    o->known[way] = seen.done_s > 0.0;
    o->known_square[way] = seen.square;
    o->done_s[way] = seen.done_s > 0.0 && seen.done_s < max_s ? seen.done_s : max_s;
    aborted += chain.out.guard == AUVID_GUARD_ABORTED;
    if (way == ADAPTIVE) {
        o->end_s = 1e-6 * (double)chain.t_us;
        o->end_square = chain_mean_square(&chain);
        gave_up += chain.adaptive.abandoned != 0;
        over = over || seen.over || seen.outside;
        false_alarms += seen.changed;
    }
}

/* Of a sample of runs: time until everything is known, over that of `way`. */
static double ratio_known(const int *sample, int runs, int way)
{
    double adaptive = 0.0, fixed = 0.0;
    for (int k = 0; k < runs; ++k) {
        adaptive += outcome[sample[k]].done_s[ADAPTIVE];
        fixed += outcome[sample[k]].done_s[way];
    }
    return adaptive / fixed;
}

/* Of a sample of runs: time until their end, over that after which the plan, all at once, has the
 * same rms error, between sets on a straight line of logarithms. */
static double ratio_error(const int *sample, int runs, int way)
{
    double square = 0.0, end_s = 0.0, before = 0.0, before_s = 0.0;
    (void)way;
    for (int k = 0; k < runs; ++k) {
        square += outcome[sample[k]].end_square;
        end_s += outcome[sample[k]].end_s;
    }
    for (int set = 1; set <= SETS; ++set) {
        double now = 0.0, now_s = 0.0;
        for (int k = 0; k < runs; ++k) {
            now += outcome[sample[k]].square[set];
            now_s += outcome[sample[k]].set_s[set];
        }
        if (now <= square && set > 1) {
            double part = log(square / before) / log(now / before);
            return end_s / (before_s * pow(now_s / before_s, part > 0.0 ? part : 0.0));
        }
        before = now;
        before_s = now_s;
    }
    return end_s / before_s; /* the plan never gets there */
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The ratio, and its 95 % interval by bootstrap over runs. */
static void print_ratio(const char *what, double (*ratio)(const int *, int, int), int runs, int way,
                        double interval[3])
{
    static double value[RESAMPLES];
    int sample[MOST_RUNS];
    sim_rng_t rng;
    sim_rng_seed(&rng, 1, 1);
    for (int b = 0; b < RESAMPLES; ++b) {
        for (int k = 0; k < runs; ++k) {
            sample[k] = (int)(sim_rng_uniform(&rng) * runs);
        }
        value[b] = ratio(sample, runs, way);
    }
    for (int k = 0; k < runs; ++k) {
        sample[k] = k;
    }
    qsort(value, RESAMPLES, sizeof value[0], ascending);
    interval[0] = ratio(sample, runs, way);
    interval[1] = value[RESAMPLES / 40];
    interval[2] = value[RESAMPLES - 1 - RESAMPLES / 40];
    printf("  %-50s %.2f [%.2f, %.2f]\n", what, interval[0], interval[1], interval[2]);
}

static double mean_s(int runs, int way)
{
    double sum = 0.0;
    for (int k = 0; k < runs; ++k) {
        sum += outcome[k].done_s[way];
    }
    return sum / runs;
}

/* Over the runs in which everything was known [%]. */
static double rms_known(int runs, int way)
{
    double sum = 0.0;
    int count = 0;
    for (int k = 0; k < runs; ++k) {
        sum += outcome[k].known[way] ? outcome[k].known_square[way] : 0.0;
        count += outcome[k].known[way];
    }
    return count > 0 ? 100.0 * sqrt(sum / count) : 0.0;
}

/* The short form has fewer runs, and omits the plan one by one. */
static void compare(double disturbance_N, bool other, int few, double interval[3])
{
    int runs = campaign_is_long() ? MOST_RUNS : few, known[WAYS] = {0};
    int ways = campaign_is_long() ? WAYS : ONE_BY_ONE;
    double square = 0.0, ignored[3];
    memset(outcome, 0, sizeof outcome);
    aborted = gave_up = false_alarms = 0;
    over = false;
    for (int way = 0; way < ways; ++way) {
        for (int k = 0; k < runs; ++k) {
            run_one((uint32_t)k + 1, disturbance_N, other, way);
            known[way] += outcome[k].known[way];
        }
    }
    for (int k = 0; k < runs; ++k) {
        square += outcome[k].end_square / runs;
    }
    printf(
        "%g N, %s, %d runs of at most %d s; adaptive, all at once, one by one (%d s):\n"
        "  all 13 identifiable in %d, %d, %d runs, after %.1f, %.1f, %.1f s, rms error then %.2f, "
        "%.2f, %.2f %%\n  adaptive: %u abandoned something, rms error at the end %.2f %%\n",
        disturbance_N, other ? "other vehicles" : "Girona500", runs, MAX_S, 4 * MAX_S,
        known[ADAPTIVE], known[AT_ONCE], known[ONE_BY_ONE], mean_s(runs, ADAPTIVE),
        mean_s(runs, AT_ONCE), mean_s(runs, ONE_BY_ONE), rms_known(runs, ADAPTIVE),
        rms_known(runs, AT_ONCE), rms_known(runs, ONE_BY_ONE), (unsigned)gave_up,
        100.0 * sqrt(square));
    print_ratio("time until known, over all at once", ratio_known, runs, AT_ONCE, interval);
    if (ways == WAYS) {
        print_ratio("time until known, over one by one", ratio_known, runs, ONE_BY_ONE, ignored);
    }
    print_ratio("time until the end, over that of the same error", ratio_error, runs, AT_ONCE,
                ignored);
    TEST_ASSERT_EQUAL_UINT32(0, aborted);
    TEST_ASSERT_EQUAL_UINT32(0, false_alarms);
    TEST_ASSERT_FALSE(over);
}

static void test_it_needs_no_more_data_than_the_plan(void)
{
    double interval[3];
    compare(1.0, false, 20, interval);
    TEST_ASSERT_TRUE(interval[campaign_is_long() ? 2 : 0] < 1.0);
}

static void test_nor_does_it_for_other_vehicles_and_disturbances(void)
{
    double interval[3];
    for (int k = campaign_is_long() ? 0 : 2; k < 3; ++k) {
        compare(k == 0 ? 1.0 : 3.0, k != 1, (int)campaign_runs(10), interval);
        TEST_ASSERT_TRUE(interval[1] < 1.0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_it_needs_no_more_data_than_the_plan);
    RUN_TEST(test_nor_does_it_for_other_vehicles_and_disturbances);
    return UNITY_END();
}
