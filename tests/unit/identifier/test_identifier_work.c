/*
 * The identifier's work: it keeps to the budget, it always ends, and the result does not depend on
 * the budget.
 */
#include <math.h>
#include <string.h>

#include "dropper.h"
#include "finish.h"
#include "identifier_work.h"
#include "unity.h"

static chain_t recorded;

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- budgets ---- */

static void test_work_keeps_to_its_budget_in_every_tick(void)
{
    for (int k = 0; k < BUDGETS; ++k) {
        chain_defaults(&cfg, 1, 2, 0.0);
        cfg.budget = budgets[k];
        TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 2));
        TEST_ASSERT_FALSE(chain.over_budget);
        TEST_ASSERT_TRUE(chain.max_units <= budgets[k]);
        TEST_ASSERT_TRUE(budgets[k] > 200 || chain.max_units == budgets[k]); /* all used */
        finish(budgets[k], units_of_13(52));
        TEST_ASSERT_EQUAL_UINT32(2, chain.id.estimate.sets);
        check_optimum();
    }
}

static void test_the_result_does_not_depend_on_how_work_is_portioned(void)
{
    auvid_estimate_t once;
    chain_defaults(&cfg, 2, 3, 0.0);
    record(3);
    recorded = chain;
    for (int k = 0; k < BUDGETS; ++k) {
        chain = recorded;
        finish(budgets[BUDGETS - 1 - k], units_of_13(52));
        if (k == 0) {
            once = chain.id.estimate;
        }
        TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
        TEST_ASSERT_EQUAL_MEMORY(&once, &chain.id.estimate, sizeof once);
    }
}

/* Rows and points, including those without room. */
static void test_rows_and_trial_points_are_counted(void)
{
    uint32_t units = 0, turns = 0;
    chain_defaults(&cfg, 2, 1, 0.0);
    record(1);
    while (chain.id.work.phase != AUVID_WORK_ASK) {
        finish_turn(&turns, 1000000);
        (void)auvid_identifier_work(&chain.id, 1);
    }
    while (chain.id.work.phase != AUVID_WORK_MEASURE) {
        finish_turn(&turns, 1000000);
        (void)auvid_identifier_work(&chain.id, 1);
        TEST_ASSERT_EQUAL_UINT32(1, chain.id.work.last_units);
        ++units;
    }
    auvid_optimizer_work_t done = chain.id.optimizer.work;
    TEST_ASSERT_EQUAL_UINT32(rows_of_girona500() * (done.crs + done.line_search) + done.attempts +
                                 1, /* to find that the search has ended */
                             units);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.work.max_units);
}

static void test_a_budget_of_zero_does_nothing_and_reports_waiting_work(void)
{
    chain_defaults(&cfg, 2, 1, 0.0);
    record(1);
    recorded = chain;
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_identifier_work(&chain.id, 0));
    TEST_ASSERT_EQUAL_MEMORY(&recorded.id, &chain.id, sizeof chain.id);
    finish(1000, units_of_13(52));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_work(&chain.id, 0));
}

static void test_the_default_budget_searches_in_about_ten_seconds(void)
{
    chain_defaults(&cfg, 3, 8, 1.0);
    record(8);
    uint32_t calls = chain_finish(&chain, AUVID_DEFAULT_BUDGET, 10000);
    TEST_ASSERT_TRUE(calls <= 10 * 50);
}

/* ---- boxes ---- */

/* The box from low times the truth to high times the truth, for every parameter. */
static void box(double low, double high)
{
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        double a = low * cfg.sim.parameter[i], b = high * cfg.sim.parameter[i];
        cfg.id.search.lower[i] = (auvid_real_t)fmin(a, b);
        cfg.id.search.upper[i] = (auvid_real_t)fmax(a, b);
    }
}

/* In the box, and no worse than the box's nearest point to the truth. */
static void check_in_box(void)
{
    auvid_real_t near[AUVID_MAX_PARAMETERS] = {0};
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        auvid_real_t truth = (auvid_real_t)cfg.sim.parameter[i], x = chain.id.estimate.pi[i];
        TEST_ASSERT_TRUE(x >= cfg.id.search.lower[i] && x <= cfg.id.search.upper[i]);
        near[i] = (auvid_real_t)fmin(fmax((double)truth, (double)cfg.id.search.lower[i]),
                                     (double)cfg.id.search.upper[i]);
    }
    double tolerance = 1e-3 * (double)chain.id.metric.result.constant;
    TEST_ASSERT_TRUE(cost_of(chain.id.estimate.pi) <= cost_of(near) + tolerance);
}

static void search_in_box(double low, double high, uint16_t population)
{
    for (uint64_t seed = 1; seed <= 5; ++seed) {
        for (int k = 0; k < BUDGETS; ++k) {
            chain_defaults(&cfg, seed, 2, 0.0);
            box(low, high);
            cfg.id.search.population = population;
            if (k == 0) {
                record(2);
                recorded = chain;
            }
            chain = recorded;
            finish(budgets[k], units_of_13(population > 0 ? population : 52));
            TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
            check_in_box();
        }
    }
}

static void test_a_search_with_the_truth_on_the_bounds_ends(void)
{
    search_in_box(1.0, 2.0, 0);
    search_in_box(0.5, 1.0, 0);
}

static void test_a_search_with_the_truth_outside_the_box_ends(void)
{
    search_in_box(1.2, 3.0, 0);
    search_in_box(0.1, 0.8, 0);
}

static void test_a_population_of_n_plus_one_ends(void)
{
    search_in_box(-2.0, 3.0, 14);
}

/* ---- known good points ---- */

static void test_a_good_point_helps_and_a_bad_one_does_no_harm(void)
{
    for (uint64_t seed = 1; seed <= 5; ++seed) {
        for (int kind = 0; kind < 4; ++kind) {
            chain_defaults(&cfg, seed, 2, 0.0);
            cfg.id.search.has_good = kind > 0;
            for (int i = 0; i < SIM_PARAMETERS; ++i) {
                double truth = cfg.sim.parameter[i];
                /* within a tenth; a distant corner; far outside the box: clipped to it */
                cfg.id.search.good[i] = (auvid_real_t)(kind == 1   ? 1.1 * truth
                                                       : kind == 2 ? (truth > 0 ? -1000.0 : 1000.0)
                                                                   : -1e30);
            }
            record(2);
            finish(200, units_of_13(52));
            check_optimum();
            TEST_ASSERT_FALSE(chain.id.estimate.not_converged);
        }
    }
}

/* Work until a search asks for its first point. */
static void ask_first(void)
{
    uint32_t searches = chain.id.work.searches;
    for (int k = 0; k < 100000; ++k) {
        (void)auvid_identifier_work(&chain.id, 1);
        if (chain.id.work.searches > searches && chain.id.work.phase == AUVID_WORK_COST) {
            return;
        }
    }
    TEST_FAIL_MESSAGE("no search");
}

static void test_the_good_point_clipped_to_the_box_is_tried_first(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    box(0.5, 1.5);
    cfg.id.search.has_good = true;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        cfg.id.search.good[i] = (auvid_real_t)((i % 2 ? 1.1 : 2.0) * cfg.sim.parameter[i]);
    }
    record(1);
    ask_first();
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        double expected = (i % 2 ? 1.1 : 1.5) * cfg.sim.parameter[i];
        TEST_ASSERT_TRUE(chain.id.work.candidate[i] == (auvid_real_t)expected);
    }
}

static void test_the_last_estimate_is_tried_first(void)
{
    chain_defaults(&cfg, 1, 2, 0.0);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 55.0);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    chain.cfg.budget = 0;
    chain_run(&chain, 15.0);
    ask_first();
    TEST_ASSERT_EQUAL_MEMORY(chain.id.estimate.pi, chain.id.work.candidate,
                             sizeof chain.id.work.candidate);
}

static void test_the_search_is_the_one_configured(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    cfg.id.search.population = 20;
    cfg.id.search.omega = 500;
    cfg.id.search.paper = true;
    cfg.id.search.scale_by_bounds = true;
    cfg.id.search.max_evaluations_line = 77;
    record(1);
    ask_first();
    TEST_ASSERT_EQUAL_UINT16(20, chain.id.optimizer.cfg.population);
    TEST_ASSERT_TRUE(chain.id.optimizer.cfg.omega == 500);
    TEST_ASSERT_TRUE(chain.id.optimizer.cfg.paper);
    TEST_ASSERT_EQUAL_UINT32(77, chain.id.optimizer.cfg.max_evaluations_line);
    TEST_ASSERT_TRUE(chain.id.optimizer.scale[0] == 1000); /* half the width of the box */
}

static void test_a_search_without_sets_ends_and_says_so(void)
{
    auvid_status_t status;
    chain_defaults(&cfg, 2, 1, 0.0);
    cfg.id.listener = &dropper;
    record(1);
    do {
        status = auvid_identifier_work(&chain.id, 100);
    } while (status == AUVID_PENDING);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, status);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_work(&chain.id, 100));
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.number);
}

static void test_a_minimum_that_no_search_can_have_is_none(void)
{
    const auvid_real_t most = AUVID_COST_FAILED, far = AUVID_C(1e30);
    auvid_minimum_t minimum = auvid_identifier_minimum(2, 0, 1);
    TEST_ASSERT_TRUE(minimum.cost == 2 && minimum.allowed < AUVID_C(0.003));
    minimum = auvid_identifier_minimum(far, 0, far * far);
    TEST_ASSERT_TRUE(minimum.cost == most && minimum.allowed == most);
    minimum = auvid_identifier_minimum((auvid_real_t)NAN, 0, 1);
    TEST_ASSERT_TRUE(minimum.cost == most && minimum.allowed == most);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_work_keeps_to_its_budget_in_every_tick);
    RUN_TEST(test_the_result_does_not_depend_on_how_work_is_portioned);
    RUN_TEST(test_rows_and_trial_points_are_counted);
    RUN_TEST(test_a_budget_of_zero_does_nothing_and_reports_waiting_work);
    RUN_TEST(test_the_default_budget_searches_in_about_ten_seconds);
    RUN_TEST(test_a_search_with_the_truth_on_the_bounds_ends);
    RUN_TEST(test_a_search_with_the_truth_outside_the_box_ends);
    RUN_TEST(test_a_population_of_n_plus_one_ends);
    RUN_TEST(test_a_good_point_helps_and_a_bad_one_does_no_harm);
    RUN_TEST(test_the_good_point_clipped_to_the_box_is_tried_first);
    RUN_TEST(test_the_last_estimate_is_tried_first);
    RUN_TEST(test_the_search_is_the_one_configured);
    RUN_TEST(test_a_search_without_sets_ends_and_says_so);
    RUN_TEST(test_a_minimum_that_no_search_can_have_is_none);
    return UNITY_END();
}
