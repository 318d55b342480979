// Velocity that is measured now and then: what it does to sets, estimates and verdicts.
//
// Partial samples: a DVL that measures only one or two of its axes in 0 to 10 % of its samples, the
// two or one left out drawn at random. The vehicle stays as it is: at most 1 of 1000 sets may say
// that it has changed.
// Drop-outs: 20 % of the samples never arrive. At least 6 of 8 sets are complete in the time of
// eight, the rms error of the parameters is at most 1.2 times that without drop-outs, and two
// standard errors cover the truth in 92-98 %.
//
// Long form (AUVID_TEST_LONG): 1120 sets of each rate of partial samples, 200 runs of drop-outs.
// Short form: 10 runs of each; fails when these goals are refuted at the 99.9 % level.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>

#include "binomial.h"

extern "C" {
#include "chain.h"
#include "unity.h"
}

enum { PARAMETERS = SIM_PARAMETERS, SETS = 8 };
static chain_t chain;

void setUp()
{
}

void tearDown()
{
}

// What many runs show, summed.
struct outcome_t {
    int runs, sets, changes, covered, identified;
    double square, run_square; // of the relative errors: sum over runs, and of its square
    double share, share_square; // of parameters covered, likewise
    double missed;              // share of rows lost
};

static void count_changes(chain_t *c, auvid_status_t, const auvid_output_t *out)
{
    *static_cast<int *>(c->config.context) += (out->events & AUVID_EVENT_CHANGED) != 0;
}

static void run(outcome_t *to, uint64_t seed, double partial, double dropout, uint32_t budget)
{
    chain_config_t config;
    chain_defaults(&config, seed, SETS, getenv("DN") ? atof(getenv("DN")) : 1.0);
    config.sim.dvl_partial = partial;
    config.sim.sensor[SIM_DVL].dropout = dropout;
    config.sim.dvl_partial_run = getenv("PR") ? atof(getenv("PR")) : 1.0;
    config.budget = budget;
    config.after = count_changes;
    config.context = &to->changes;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &config, SETS));
    TEST_ASSERT_TRUE(chain_finish(&chain, UINT32_MAX, 10) <= 10);
    ++to->runs;
    to->sets += int(chain.id.metric.sets_recorded);
    if (chain.id.estimate.number == 0) {
        return;
    }
    int covered = 0;
    for (int i = 0; i < PARAMETERS; ++i) {
        double sigma = double(chain.id.estimate.confidence.sigma[i]) /
                       std::fabs(chain.sim.config.parameter[i]);
        covered += std::fabs(chain_error(&chain, i)) <= 2 * sigma;
    }
    double square = chain_mean_square(&chain), share = double(covered) / PARAMETERS;
    ++to->identified;
    to->square += square;
    to->run_square += square * square;
    to->share += share;
    to->share_square += share * share;
}

static outcome_t runs(int count, uint64_t first, double partial, double dropout, uint32_t budget)
{
    outcome_t total = {};
    for (int k = 0; k < count; ++k) {
        run(&total, first + uint64_t(k), partial, dropout, budget);
    }
    std::printf("  %2.0f %% partial, %2.0f %% lost: %d runs, %.2f sets a run, %d changes in %d "
                "sets, rms error %.2f %%, two standard errors cover %.1f %%\n",
                100 * partial, 100 * dropout, count, double(total.sets) / count, total.changes,
                total.sets, 100 * std::sqrt(total.square / total.identified),
                100 * total.share / total.identified);
    return total;
}

static void test_partial_samples_do_not_look_like_another_vehicle()
{
    int changes = 0, sets = 0;
    for (double partial : {0.0, 0.02, 0.05, 0.1}) {
        outcome_t total = runs(campaign_is_long() ? 140 : 10, 1000, partial, 0.0, 100000);
        changes += total.changes;
        sets += total.sets;
    }
    if (campaign_is_long()) {
        TEST_ASSERT_TRUE(sets >= 4000);
        TEST_ASSERT_TRUE(1000 * changes <= sets);
    } else {
        TEST_ASSERT_TRUE(binomial_lower(changes, sets, 0.001) <= 0.001);
    }
}

static void test_drop_outs_cost_few_sets_and_little_precision()
{
    int count = campaign_is_long() ? 200 : 20;
    outcome_t none = runs(count, 2000, 0.0, 0.0, 0), some = runs(count, 2000, 0.0, 0.2, 0);
    TEST_ASSERT_EQUAL(count, some.identified);
    TEST_ASSERT_TRUE(some.sets >= 6 * some.runs);
    TEST_ASSERT_TRUE(some.square <= 1.2 * 1.2 * none.square);
    double share = some.share / count;
    double error = std::sqrt((some.share_square / count - share * share) / (count - 1));
    double slack = campaign_is_long() ? 0.0 : 3.3 * error;
    TEST_ASSERT_TRUE(share >= 0.92 - slack && share <= 0.98 + slack);
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(test_partial_samples_do_not_look_like_another_vehicle);
    RUN_TEST(test_drop_outs_cost_few_sets_and_little_precision);
    return UNITY_END();
}
