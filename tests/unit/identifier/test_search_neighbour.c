/*
 * Residual path: after a search of a model with kinks, its neighbouring minima are searched. This
 * model has none, but does not say so; the cost of its end is raised, as often as a test says, so
 * that the next search finds a lower one.
 */
#include <math.h>

#include "by_residual.h"
#include "chain.h"
#include "identifier/auvid_identifier_internal.h"
#include "save_checkpoint.h"
#include "unity.h"

enum { SETS = 2, SET_ROWS = 60, LATE = 10 }; /* ticks: 0.2 s */

static auvid_row_t store[(SETS + 1) * SET_ROWS];
static auvid_vehicle_t vehicle;
static chain_config_t cfg;
static chain_t chain;
static uint8_t saved[1 << 18];
static auvid_real_t past[LATE][AUVID_DOF_COUNT];

/* The wrench acts on the vehicle LATE ticks after it is recorded. */
static void delay(chain_t *c, auvid_input_t *in)
{
    auvid_real_t *slot = past[c->tick % LATE];
    memcpy(c->wrench, slot, sizeof c->wrench);
    memcpy(slot, in->applied.wrench, sizeof c->wrench);
}

void setUp(void)
{
    chain_defaults(&cfg, 5, SETS + 1, 1.0);
    cfg.budget = 0;
    chain_set_driver(&cfg);
    cfg.before = delay;
    memset(past, 0, sizeof past);
    by_residual_surge(&cfg.id, &vehicle, store, SETS);
}

void tearDown(void)
{
}

static void fail(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                 auvid_real_t *residual)
{
    by_residual_predict(context, s, pi, residual);
    residual[AUVID_SURGE] = (auvid_real_t)NAN;
}

static void save_and_restore(void)
{
    uint32_t bytes = save_checkpoint(&chain.id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&chain.id, saved, bytes));
}

/* Identify from one set. The cost of the best end is raised before each of the first `raised`
 * searches of neighbours. Where they begin goes to at_s[], relative to that end. A checkpoint is
 * taken before each, after its first evaluation, and after the last one.
 * @return searches of neighbours */
static uint32_t identify(uint32_t raised, double *at_s)
{
    const auvid_identifier_work_t *now = &chain.id.work;
    const auvid_search_config_t *search = &chain.id.optimizer.cfg;
    uint32_t calls = 0, begun = 0, waits = 0, saves = 0;
    bool measures = false;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 1));
    while (auvid_identifier_work(&chain.id, 1) == AUVID_PENDING) {
        TEST_ASSERT_TRUE(++calls < 10000000u);
        if (now->neighbours > waits) {
            waits = now->neighbours;
            chain.id.work.minimum.cost *= waits <= raised ? AUVID_C(1.01) : AUVID_C(1.0);
            save_and_restore();
        }
        if (begun < waits && now->phase == AUVID_WORK_ASK) {
            int n = search->n - 1;
            at_s[begun++] = (double)(chain.id.optimizer.trial[n] - search->good[n]);
        }
        if (saves < begun && chain.id.optimizer.work.line_search > 0) {
            ++saves;
            save_and_restore();
        }
        if (now->phase == AUVID_WORK_MEASURE && !measures) {
            measures = true;
            save_and_restore();
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_UINT32(waits, saves);
    TEST_ASSERT_EQUAL_UINT8(0, now->neighbours);
    return begun;
}

static void test_a_search_goes_on_from_both_sides_of_its_end(void)
{
    double at_s[WORK_NEIGHBOURS];
    TEST_ASSERT_EQUAL_UINT32(2, identify(0, at_s));
    TEST_ASSERT_EQUAL_UINT32(100000, chain.id.metric.cfg.cell_us);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.15, at_s[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.15, at_s[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.2, (double)chain.id.estimate.delay_s[AUVID_SURGE]);
    TEST_ASSERT_FALSE(chain.id.estimate.not_converged);
}

static void test_the_result_is_the_lowest_end(void)
{
    double at_s[WORK_NEIGHBOURS];
    vehicle.smooth = true;
    TEST_ASSERT_EQUAL_UINT32(0, identify(0, at_s));
    auvid_estimate_t alone = chain.id.estimate;
    vehicle.smooth = false;
    for (uint32_t raised = 0; raised < 3; ++raised) {
        (void)identify(raised, at_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * (double)alone.cost, (double)alone.cost,
                                  (double)chain.id.estimate.cost);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)alone.delay_s[AUVID_SURGE],
                                  (double)chain.id.estimate.delay_s[AUVID_SURGE]);
        TEST_ASSERT_TRUE(chain.id.estimate.evaluations_line > alone.evaluations_line);
    }
}

static void test_a_lower_end_has_neighbours_as_well(void)
{
    double at_s[WORK_NEIGHBOURS];
    TEST_ASSERT_EQUAL_UINT32(3, identify(1, at_s));
    TEST_ASSERT_TRUE(at_s[1] > 0 && at_s[2] < 0);
    TEST_ASSERT_EQUAL_UINT32(4, identify(2, at_s));
}

static void test_the_searches_end_whatever_they_find(void)
{
    double at_s[WORK_NEIGHBOURS];
    TEST_ASSERT_EQUAL_UINT32(WORK_NEIGHBOURS, identify(UINT32_MAX, at_s));
}

static void test_no_search_begins_outside_the_bounds(void)
{
    double at_s[WORK_NEIGHBOURS];
    cfg.before = NULL;
    TEST_ASSERT_EQUAL_UINT32(1, identify(0, at_s));
    TEST_ASSERT_TRUE(chain.id.estimate.delay_s[AUVID_SURGE] < AUVID_C(0.01));
}

static void test_there_is_one_search_without_delay_or_kinks_and_of_one_phase(void)
{
    double at_s[WORK_NEIGHBOURS];
    cfg.id.search.paper = true;
    TEST_ASSERT_EQUAL_UINT32(0, identify(0, at_s));
    cfg.id.search.paper = false;
    cfg.id.search.phases = AUVID_SEARCH_GLOBAL;
    TEST_ASSERT_EQUAL_UINT32(0, identify(0, at_s));
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.evaluations_line);
    cfg.id.search.phases = AUVID_SEARCH_BOTH;
    cfg.id.metric.estimate_delay = false;
    TEST_ASSERT_EQUAL_UINT32(0, identify(0, at_s));
    cfg.id.metric.estimate_delay = true;
    vehicle.smooth = true;
    TEST_ASSERT_EQUAL_UINT32(0, identify(0, at_s));
}

/* A cap that only the first search reaches, or only later ones do. */
static void test_the_estimate_converged_if_the_best_end_did(void)
{
    double at_s[WORK_NEIGHBOURS];
    (void)identify(0, at_s);
    uint32_t all = chain.id.estimate.evaluations_line;
    cfg.id.search.max_evaluations_line = 5;
    TEST_ASSERT_EQUAL_UINT32(2, identify(0, at_s));
    TEST_ASSERT_TRUE(chain.id.estimate.not_converged);
    TEST_ASSERT_TRUE(chain.id.estimate.evaluations_line < all);
    cfg.id.search.max_evaluations_line = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 1));
    while (auvid_identifier_work(&chain.id, 1) == AUVID_PENDING) {
        if (chain.id.work.neighbours == 1) {
            chain.id.optimizer.cfg.max_evaluations_line = 5; /* of the searches that follow */
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_FALSE(chain.id.estimate.not_converged);
}

static void test_a_model_that_fails_everywhere_has_no_neighbours(void)
{
    double at_s[WORK_NEIGHBOURS];
    vehicle.residual = fail;
    TEST_ASSERT_EQUAL_UINT32(0, identify(0, at_s));
    TEST_ASSERT_TRUE(chain.id.estimate.not_converged);
}

/* Restored, it would search beside no end. */
static void test_an_impossible_checkpoint_is_refused(void)
{
    static chain_t forged;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 1));
    while (chain.id.work.neighbours == 0) {
        TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_identifier_work(&chain.id, 1));
    }
    save_and_restore();
    for (int k = 0; k < 3; ++k) {
        forged = chain;
        forged.id.work.sides_left = k == 0 ? 0 : 2;
        forged.id.work.searching = k != 1;
        forged.id.work.neighbours = k == 2 ? WORK_NEIGHBOURS + 1 : 1;
        uint32_t bytes = save_checkpoint(&forged.id, saved, sizeof saved);
        TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_checkpoint_restore(&chain.id, saved, bytes));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_search_goes_on_from_both_sides_of_its_end);
    RUN_TEST(test_the_result_is_the_lowest_end);
    RUN_TEST(test_a_lower_end_has_neighbours_as_well);
    RUN_TEST(test_the_searches_end_whatever_they_find);
    RUN_TEST(test_no_search_begins_outside_the_bounds);
    RUN_TEST(test_there_is_one_search_without_delay_or_kinks_and_of_one_phase);
    RUN_TEST(test_the_estimate_converged_if_the_best_end_did);
    RUN_TEST(test_a_model_that_fails_everywhere_has_no_neighbours);
    RUN_TEST(test_an_impossible_checkpoint_is_refused);
    return UNITY_END();
}
