/*
 * The identifier's work: it keeps to the budget, it always ends, the result does not depend on the
 * budget, and nothing is stale when sets change during a search.
 */
#include <math.h>
#include <string.h>

#include "chain.h"
#include "dropper.h"
#include "finish.h"
#include "identifier/auvid_identifier_internal.h"
#include "unity.h"

static const uint32_t budgets[] = {1, 7, 200, 100000};
enum { BUDGETS = sizeof budgets / sizeof budgets[0] };

static chain_t chain, recorded;
static chain_config_t cfg;

void setUp(void)
{
}

void tearDown(void)
{
}

/* Upper bound of the units of a search: the caps of types.h (40 m evaluations, 50 m trials outside
 * the box before each, and 1000 n evaluations; trials without room are
 * bounded), `rows` units for an evaluation, three passes of the merge, and the measurement. */
static uint32_t units_at_most(uint32_t n, uint32_t m, uint32_t rows)
{
    uint32_t evaluations = 40 * m + 1000 * n;
    return evaluations * (rows + 2) + 40 * m * 50 * m + 8 * 10000;
}

/* Rows of R: the columns of all equations together. */
static uint32_t rows_of_girona500(void)
{
    uint32_t rows = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (uint32_t c = auvid_girona500.columns[j] & AUVID_G500_FREE; c != 0; c &= c - 1) {
            ++rows;
        }
    }
    return rows;
}

/* The same for the 13 parameters with a population m. */
static uint32_t units_of_13(uint32_t m)
{
    return units_at_most(13, m, rows_of_girona500());
}

/* Work to the end with a budget; check every call. */
static void finish(uint32_t budget, uint32_t units)
{
    chain.max_units = 0;
    TEST_ASSERT_TRUE(chain_finish(&chain, budget, units / budget + 1) <= units / budget + 1);
    TEST_ASSERT_EQUAL(AUVID_OK, chain.work);
    TEST_ASSERT_FALSE(chain.over_budget);
    TEST_ASSERT_TRUE(chain.max_units <= budget);
}

/* Record `sets` sets without work. */
static void record(uint32_t sets)
{
    cfg.budget = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, sets));
    TEST_ASSERT_EQUAL_UINT32(sets, chain.id.metric.sets.recorded);
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.number);
}

/* The cost of any pi on the merged sets, with a copy of the metric. */
static double cost_on(const auvid_metric_t *merged, const auvid_real_t *pi)
{
    static auvid_metric_t metric;
    uint32_t budget = UINT32_MAX;
    metric = *merged;
    auvid_metric_cost_begin(&metric, pi, chain.id.estimate.delay_s[AUVID_SURGE]);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_cost(&metric, &budget));
    return (double)metric.result.cost;
}

/* The same on the data in the ring. */
static double cost_of(const auvid_real_t *pi)
{
    return cost_on(&chain.id.metric, pi);
}

/* The estimate is as good as the least-squares optimum: excess cost within 1e-3 of the residual. */
static void check_optimum(void)
{
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&chain.id.metric, AUVID_G500_FREE, pi));
    double optimum = cost_of(pi), found = cost_of(chain.id.estimate.pi);
    TEST_ASSERT_TRUE(found - optimum <= 1e-3 * (double)chain.id.metric.result.constant);
    TEST_ASSERT_TRUE(chain.id.estimate.cost == (auvid_real_t)found); /* not stale */
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

/* ---- sets that change during a search ---- */

/* Events while sets complete during searches. */
typedef struct {
    uint32_t begun, ended;      /* searches */
    uint32_t validated, newest; /* number of the last set validated; of the newest in the search */
    uint32_t drops, restored;   /* events for dropped rows, for an estimate restored */
} watch_t;

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

/* ---- a user's model, without a regressor ---- */

enum { USER_M, USER_X_U, USER_X_UU, USER_PARAMETERS };

static const auvid_parameter_t user_parameter[USER_PARAMETERS] = {
    {"m", "kg", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_OTHER}};

/* It has no coupling, tilt and weight: only surge is excited. */
static uint32_t residual_calls;

static void user_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                          auvid_real_t *e)
{
    auvid_real_t u = s->nu[AUVID_SURGE], speed = u > 0 ? u : -u;
    (void)context;
    ++residual_calls;
    e[AUVID_SURGE] = pi[USER_M] * s->nu_dot[AUVID_SURGE] - pi[USER_X_U] * u -
                     pi[USER_X_UU] * speed * u - s->tau[AUVID_SURGE];
}

static void failing_residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                             auvid_real_t *e)
{
    user_residual(context, s, pi, e);
    e[AUVID_SURGE] = (auvid_real_t)NAN;
}

static auvid_vehicle_t user_vehicle = {.built_for = AUVID_BUILD,
                                       .path = &auvid_path_residual,
                                       .name = "surge",
                                       .parameters = USER_PARAMETERS,
                                       .parameter = user_parameter,
                                       .columns = {[AUVID_SURGE] = 7},
                                       .residual = user_residual};

enum { USER_SETS = 2, USER_ROWS = 60 };
static auvid_row_t store[(USER_SETS + 1) * USER_ROWS];

static void configure_user(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 0, 0, 0, 0, 0};
    chain_defaults(&cfg, 9, USER_SETS, 0.0);
    auvid_excitation_config_t excitation = cfg.acting.excitation;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&excitation, amplitude, CHAIN_SET_S, USER_SETS, 9));
    auvid_identifier_defaults(&cfg.id, &user_vehicle);
    cfg.id.search.seed = 9;
    cfg.acting.excitation = excitation;
    cfg.id.metric.rows = store;
    cfg.id.metric.sets = USER_SETS;
    cfg.id.metric.set_rows = USER_ROWS;
}

/* As finish(). The user's function takes the time: a call of it is at least one unit. */
static void finish_counting(uint32_t budget, uint32_t units)
{
    uint32_t turns = 0;
    auvid_status_t status = AUVID_PENDING;
    while (status == AUVID_PENDING) {
        residual_calls = 0;
        finish_turn(&turns, units / budget + 1);
        status = auvid_identifier_work(&chain.id, budget);
        TEST_ASSERT_TRUE(chain.id.work.last_units <= budget);
        TEST_ASSERT_TRUE(residual_calls <= chain.id.work.last_units);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, status);
}

static void test_a_users_model_keeps_to_the_budget_and_ends(void)
{
    auvid_estimate_t once;
    configure_user();
    record(USER_SETS);
    recorded = chain; /* the rows stay in place: nothing is recorded from now on */
    for (int k = 0; k < BUDGETS; ++k) {
        chain = recorded;
        finish_counting(budgets[k], units_at_most(4, 16, USER_SETS * USER_ROWS));
        if (k == 0) {
            once = chain.id.estimate;
        }
        TEST_ASSERT_EQUAL_MEMORY(&once, &chain.id.estimate, sizeof once);
    }
    TEST_ASSERT_EQUAL_HEX32(7, once.identified);
    TEST_ASSERT_EQUAL_HEX32(1u << AUVID_SURGE, once.excited);
    TEST_ASSERT_FALSE(once.not_converged);
    TEST_ASSERT_DOUBLE_WITHIN(12.0, cfg.sim.parameter[SIM_M_U], (double)once.pi[USER_M]);
    TEST_ASSERT_TRUE(once.r2_force[AUVID_SURGE] > AUVID_C(0.98));
    TEST_ASSERT_TRUE((double)once.cost == cost_of(once.pi));
}

/* The rows that a search began with, and the index of those recorded meanwhile. */
static auvid_row_t began_rows[sizeof store / sizeof store[0]];

static void watch_rows(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    watch_t *w = c->cfg.context;
    const auvid_identifier_t *id = &c->id;
    TEST_ASSERT_EQUAL(AUVID_OK, status);
    w->drops += (out->events & AUVID_EVENT_ROWS_DROPPED) != 0;
    w->restored += (out->events & AUVID_EVENT_RESTORED) != 0;
    if (id->work.searches > w->begun) {
        w->begun = id->work.searches;
        w->newest = id->metric.sets.stored % (USER_SETS + 1) * USER_ROWS;
        memcpy(began_rows, store, sizeof store);
    }
    if (out->events & AUVID_EVENT_ESTIMATE) {
        ++w->ended;
        TEST_ASSERT_EQUAL_UINT32(w->begun, w->ended);
        for (uint32_t k = 0; k < sizeof store / sizeof store[0]; ++k) {
            if (k < w->newest || k >= w->newest + USER_ROWS) {
                TEST_ASSERT_EQUAL_MEMORY(&began_rows[k], &store[k], sizeof store[k]);
            }
        }
    }
}

static void test_rows_that_come_while_a_full_set_waits_are_dropped_and_counted(void)
{
    enum { LONG = 12 };
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 0, 0, 0, 0, 0};
    watch_t watch = {0};
    configure_user();
    TEST_ASSERT_EQUAL(
        AUVID_OK, auvid_excitation_plan(&cfg.acting.excitation, amplitude, CHAIN_SET_S, LONG, 9));
    cfg.budget = 1;
    cfg.after = watch_rows;
    cfg.context = &watch;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, LONG));
    uint32_t kept = chain.id.metric.sets.recorded * USER_ROWS + chain.id.metric.rows.set.rows;
    TEST_ASSERT_TRUE(watch.ended >= 1);
    TEST_ASSERT_TRUE(chain.id.metric.sets.recorded < LONG);
    TEST_ASSERT_EQUAL_UINT32(watch.drops, chain.id.metric.sets.rows_dropped);
    TEST_ASSERT_UINT32_WITHIN(2 * USER_ROWS / 10, LONG * USER_ROWS,
                              kept + chain.id.metric.sets.rows_dropped);
    finish(1000, 3 * units_at_most(4, 16, USER_SETS * USER_ROWS));
    watch.restored += (chain.id.events & AUVID_EVENT_RESTORED) != 0;
    TEST_ASSERT_EQUAL_UINT32(chain.id.work.searches + watch.restored, chain.id.estimate.number);
    TEST_ASSERT_FALSE(chain.id.estimate.not_converged);
    TEST_ASSERT_DOUBLE_WITHIN(12.0, cfg.sim.parameter[SIM_M_U],
                              (double)chain.id.estimate.pi[USER_M]);
}

static void test_a_model_that_fails_everywhere_ends_and_is_reported(void)
{
    user_vehicle.residual = failing_residual;
    configure_user();
    record(USER_SETS);
    finish(7, units_at_most(4, 16, USER_SETS * USER_ROWS));
    user_vehicle.residual = user_residual;
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_TRUE(chain.id.estimate.not_converged);
    TEST_ASSERT_EQUAL_DOUBLE(0, (double)chain.id.estimate.r2_force[AUVID_SURGE]); /* no NaN */
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
    RUN_TEST(test_a_search_slower_than_a_set_ends_on_the_sets_it_began_with);
    RUN_TEST(test_a_newly_excited_dof_is_searched);
    RUN_TEST(test_no_cost_of_an_earlier_vehicle_survives);
    RUN_TEST(test_an_estimate_stays_whole_until_the_next_is_ready);
    RUN_TEST(test_a_users_model_keeps_to_the_budget_and_ends);
    RUN_TEST(test_rows_that_come_while_a_full_set_waits_are_dropped_and_counted);
    RUN_TEST(test_a_model_that_fails_everywhere_ends_and_is_reported);
    RUN_TEST(test_a_search_without_sets_ends_and_says_so);
    RUN_TEST(test_a_minimum_that_no_search_can_have_is_none);
    return UNITY_END();
}
