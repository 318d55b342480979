// Velocity with gaps: its effect on sets, estimates and change tests.
//
// Partial samples: the DVL measures only one or two of its axes in 0 to 10 % of its samples, the
// axes drawn at random, for one sample or for ten in a row (2 s). The vehicle does not change: at
// most 1 of 1000 sets may report a change.
// Drop-outs: 20 % of the samples never arrive. At least 6 of 8 sets are complete in the time of
// eight, the rms error of the parameters is at most 1.2 times that without drop-outs, and two
// standard errors cover the truth in 92-98 %.
//
// A pilot drives, so that the guard does not end a run in which velocity is lost for long.
//
// Long form (AUVID_TEST_LONG): 4000 sets with partial samples, 200 runs with drop-outs, and the
// figures themselves must hold. Short form: it fails if they are refuted at the 99.9 % level or by
// 3.3 standard errors of the mean over runs.
#include <cmath>
#include <cstdio>

#include "binomial.h"

extern "C" {
#include "chain.h"
#include "unity.h"
}

enum { PARAMETERS = SIM_PARAMETERS, SETS = 8, MOST = 200 };
static chain_t chain;

void setUp()
{
}

void tearDown()
{
}

// What many runs show.
struct outcome_t {
    int runs, sets, changes;
    double square[MOST];  // mean square error of a run
    double covered[MOST]; // part of its parameters within two standard errors
};
static outcome_t whole, part;

static void count_changes(chain_t *c, auvid_status_t, const auvid_output_t *out)
{
    *static_cast<int *>(c->cfg.context) += (out->events & AUVID_EVENT_CHANGED) != 0;
}

static void run(outcome_t *to, uint64_t seed, const sim_config_t &dvl, uint32_t budget)
{
    chain_config_t cfg;
    chain_defaults(&cfg, seed, SETS, 1.0);
    chain_set_driver(&cfg);
    cfg.sim.dvl_partial = dvl.dvl_partial;
    cfg.sim.dvl_partial_run = dvl.dvl_partial_run;
    cfg.sim.sensor[SIM_DVL].dropout = dvl.sensor[SIM_DVL].dropout;
    cfg.budget = budget;
    cfg.after = count_changes;
    cfg.context = &to->changes;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, SETS));
    TEST_ASSERT_TRUE(chain_finish(&chain, UINT32_MAX, 10) <= 10);
    TEST_ASSERT_TRUE(chain.id.estimate.number > 0);
    int covered = 0;
    for (int i = 0; i < PARAMETERS; ++i) {
        double sigma = double(chain.id.estimate.confidence.sigma[i]);
        covered += std::fabs(chain_error(&chain, i) * chain.sim.cfg.parameter[i]) <= 2 * sigma;
    }
    to->sets += int(chain.id.metric.sets.recorded);
    to->square[to->runs] = chain_mean_square(&chain);
    to->covered[to->runs] = double(covered) / PARAMETERS;
    ++to->runs;
}

static double mean(const double *x, int n)
{
    double sum = 0;
    for (int k = 0; k < n; ++k) {
        sum += x[k];
    }
    return sum / n;
}

static double error_of_mean(const double *x, int n)
{
    double square = 0, m = mean(x, n);
    for (int k = 0; k < n; ++k) {
        square += (x[k] - m) * (x[k] - m);
    }
    return std::sqrt(square / n / (n - 1));
}

static void runs(outcome_t *to, int count, uint64_t first, const sim_config_t &dvl, uint32_t budget)
{
    *to = {};
    for (int k = 0; k < count; ++k) {
        run(to, first + uint64_t(k), dvl, budget);
    }
    std::printf("  %2.0f %% partial, %2.0f in a row, %2.0f %% lost: %d runs, %.2f sets a run, %d "
                "changes in %d sets, rms error %.2f %%, two standard errors cover %.1f %%\n",
                100 * dvl.dvl_partial, dvl.dvl_partial_run, 100 * dvl.sensor[SIM_DVL].dropout,
                count, double(to->sets) / count, to->changes, to->sets,
                100 * std::sqrt(mean(to->square, count)), 100 * mean(to->covered, count));
}

static void test_partial_samples_do_not_look_like_another_vehicle()
{
    static const double partial[] = {0.1, 0.1, 0.02, 0.02, 0.05, 0.05, 0};
    static const double in_a_row[] = {10, 1, 10, 1, 10, 1, 1};
    bool is_long = campaign_is_long();
    int changes = 0, sets = 0;
    for (int k = 0; k < (is_long ? 7 : 2); ++k) {
        sim_config_t dvl;
        sim_defaults(&dvl);
        dvl.dvl_partial = partial[k];
        dvl.dvl_partial_run = in_a_row[k];
        runs(&part, is_long ? 85 : 16, 1000, dvl, 100000);
        changes += part.changes;
        sets += part.sets;
    }
    TEST_ASSERT_TRUE(!is_long || sets >= 4000);
    TEST_ASSERT_TRUE(is_long ? 1000 * changes <= sets
                             : binomial_lower(changes, sets, 0.001) <= 0.001);
}

static void test_drop_outs_cost_few_sets_and_little_precision()
{
    int count = campaign_is_long() ? MOST : 16;
    double beyond[MOST], slack = campaign_is_long() ? 0.0 : 3.3;
    sim_config_t dvl;
    sim_defaults(&dvl);
    runs(&whole, count, 2000, dvl, 0);
    dvl.sensor[SIM_DVL].dropout = 0.2;
    runs(&part, count, 2000, dvl, 0);
    for (int k = 0; k < count; ++k) {
        beyond[k] = part.square[k] - 1.2 * 1.2 * whole.square[k];
    }
    double covered = mean(part.covered, count), error = error_of_mean(part.covered, count);
    TEST_ASSERT_TRUE(part.sets >= 6 * count);
    TEST_ASSERT_TRUE(mean(beyond, count) <= slack * error_of_mean(beyond, count));
    TEST_ASSERT_TRUE(covered >= 0.92 - slack * error && covered <= 0.98 + slack * error);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_partial_samples_do_not_look_like_another_vehicle);
    RUN_TEST(test_drop_outs_cost_few_sets_and_little_precision);
    return UNITY_END();
}
