/*
 * The identifier's work while sets come during a search: nothing in the result is stale.
 */
#include <string.h>

#include "identifier_work.h"
#include "unity.h"

void setUp(void)
{
}

void tearDown(void)
{
}

/* A search uses the sets that it began with, and each of these was validated before. */
static void watch_searches(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    static auvid_metric_t began;
    watch_t *w = c->cfg.context;
    const auvid_identifier_t *id = &c->id;
    TEST_ASSERT_EQUAL(AUVID_OK, status);
    if (out->events & AUVID_EVENT_VALIDATED) {
        TEST_ASSERT_TRUE(id->change_test.set > w->validated);
        TEST_ASSERT_TRUE(id->change_test.set == w->validated + 1 || w->validated < 2 ||
                         w->drops > 0);
        w->validated = id->change_test.set;
    }
    if (id->work.searches > w->begun) {
        w->begun = id->work.searches;
        w->newest = auvid_metric_newest(&id->metric)->number;
        TEST_ASSERT_TRUE(w->begun == 1 || w->newest == w->validated);
        began = id->metric;
    }
    w->drops += (out->events & AUVID_EVENT_ROWS_DROPPED) != 0;
    if (out->events & AUVID_EVENT_ESTIMATE) {
        auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
        ++w->ended;
        TEST_ASSERT_EQUAL_UINT32(w->begun, w->ended);
        TEST_ASSERT_EQUAL_UINT32(w->newest, id->estimate.sets);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&began, AUVID_G500_FREE, pi));
        double optimum = cost_on(&began, pi), found = cost_on(&began, id->estimate.pi);
        TEST_ASSERT_TRUE(found - optimum <= 1e-3 * (double)began.result.constant);
        TEST_ASSERT_TRUE(id->estimate.cost == (auvid_real_t)found);
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            TEST_ASSERT_TRUE(id->estimate.confidence.sigma[i] > 0);
            TEST_ASSERT_TRUE(id->estimate.confidence.sigma[i] < AUVID_LARGEST);
        }
    }
}

/* Budgets so small that sets complete before their search has ended. */
static void test_a_search_slower_than_a_set_ends_on_the_sets_it_began_with(void)
{
    static const uint32_t tiny[] = {1, 3, 5, 8, 16, 25};
    for (size_t k = 0; k < sizeof tiny / sizeof tiny[0]; ++k) {
        uint32_t sets = tiny[k] == 1 ? 40 : tiny[k] == 3 ? 16 : 12;
        watch_t watch = {0};
        chain_defaults(&cfg, k + 1, sets, 0.0);
        cfg.budget = tiny[k];
        cfg.after = watch_searches;
        cfg.context = &watch;
        TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, sets));
        TEST_ASSERT_TRUE(watch.ended >= 2);
        TEST_ASSERT_TRUE(watch.begun <= watch.ended + 1);
        TEST_ASSERT_TRUE(chain.id.work.searches < sets || tiny[k] >= 16); /* some took several */
        TEST_ASSERT_EQUAL_UINT32(watch.drops * 60, chain.id.metric.sets.rows_dropped);
        TEST_ASSERT_TRUE(tiny[k] > 1 || watch.drops > 0);
        TEST_ASSERT_TRUE(tiny[k] < 8 || watch.drops == 0);
        finish(tiny[k], 3 * units_of_13(52));
        TEST_ASSERT_EQUAL_UINT32(chain.id.work.searches, chain.id.estimate.number);
        for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
            TEST_ASSERT_TRUE(fabs(chain_error(&chain, i)) < 0.05);
        }
    }
}

/* Only surge is excited in the first set, all DoF in the second. The second completes during the
 * search over the first: the parameters to search have changed. */
static void test_a_newly_excited_dof_is_searched(void)
{
    const auvid_real_t surge[AUVID_DOF_COUNT] = {100, 0, 0, 0, 0, 0};
    chain_config_t full;
    chain_defaults(&cfg, 3, 1, 0.0);
    full = cfg;
    cfg.budget = 0;
    chain_set_driver(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_plan(&cfg.driver, surge, CHAIN_SET_S, 1, 1));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 1));
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_identifier_work(&chain.id, 1000)); /* it only begins */
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_identifier_work(&chain.id, 1000));
    TEST_ASSERT_TRUE(chain.id.work.searching);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_init(&chain.driver, &full.acting.excitation));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_start(&chain.driver, chain.t_us));
    chain_run(&chain, 32.0);
    TEST_ASSERT_EQUAL_UINT32(2, chain.id.metric.sets.recorded);
    finish(200, units_of_13(52));
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, chain.id.estimate.identified);
    check_optimum();
}

/* Progress of the search over vehicle A's set when B's sets come: every phase. */
typedef enum {
    IN_MERGE,
    IN_OPTIMUM,
    IN_FILL,
    IN_GLOBAL,
    IN_LOCAL,
    IN_MEASURE,
    ENDED,
    CATCHES
} catch_t;

static bool is_there(catch_t where)
{
    const auvid_identifier_t *id = &chain.id;
    auvid_optimizer_work_t done = id->optimizer.work;
    bool local = id->optimizer.state >= AUVID_OPTIMIZER_START;
    switch (where) {
    case IN_MERGE:
        return id->work.phase == AUVID_WORK_MERGE;
    case IN_OPTIMUM:
        return id->work.phase == AUVID_WORK_MERGE && id->work.spent == WORK_OPTIMUM;
    case IN_FILL:
        return done.crs == 30;
    case IN_GLOBAL:
        return done.crs == 150;
    case IN_LOCAL:
        return local && done.line_search == 200;
    case IN_MEASURE:
        return id->work.phase == AUVID_WORK_MEASURE;
    default:
        return id->estimate.number > 0;
    }
}

/* One set in the ring. After the first set the vehicle has 1.5 times the mass and the drag;
 * its next set completes in some phase of the search over the first. */
static void test_no_cost_of_an_earlier_vehicle_survives(void)
{
    for (catch_t where = IN_MERGE; where < CATCHES; ++where) {
        chain_defaults(&cfg, 7, 4, 0.0);
        cfg.id.metric.sets = 1;
        cfg.id.search.paper = where == IN_GLOBAL || where == IN_LOCAL; /* without certificate */
        cfg.budget = 0;
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
        while (chain.id.metric.sets.recorded == 0) {
            chain_tick(&chain);
        }
        for (uint32_t k = 0; k < units_of_13(52) && !is_there(where); ++k) {
            (void)auvid_identifier_work(&chain.id, 1);
        }
        TEST_ASSERT_TRUE(is_there(where));
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            chain.sim.cfg.parameter[i] *= i == SIM_WB ? 1.0 : 1.5;
        }
        while (chain.id.metric.sets.recorded < 3) {
            chain_tick(&chain);
        }
        finish(200, 2 * units_of_13(52));
        TEST_ASSERT_EQUAL_UINT32(3, chain.id.estimate.sets);
        check_optimum();
        for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
            TEST_ASSERT_TRUE(fabs(chain_error(&chain, i)) < 0.05);
        }
    }
}

static void test_an_estimate_stays_whole_until_the_next_is_ready(void)
{
    chain_defaults(&cfg, 8, 3, 0.0);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 50.0);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    auvid_estimate_t before = chain.id.estimate;
    chain.cfg.budget = 0;
    chain_run(&chain, 20.0);
    for (int k = 0; k < 100000 && chain.id.estimate.number == 1; ++k) {
        before.accepted = chain.id.estimate.accepted; /* that concerns the next set */
        TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id.estimate, sizeof before);
        (void)auvid_identifier_work(&chain.id, 3);
    }
    TEST_ASSERT_EQUAL_UINT32(2, chain.id.estimate.number);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_search_slower_than_a_set_ends_on_the_sets_it_began_with);
    RUN_TEST(test_a_newly_excited_dof_is_searched);
    RUN_TEST(test_no_cost_of_an_earlier_vehicle_survives);
    RUN_TEST(test_an_estimate_stays_whole_until_the_next_is_ready);
    return UNITY_END();
}
