/*
 * Residual path: a search of a model with kinks goes on beside its end, where the cost may have a
 * lower minimum. This model has no kinks, but does not say so; the cost of its end is raised, as
 * often as a test says, so that the next search finds a lower one.
 */
#include "auvid/checkpoint.h"
#include "by_residual.h"
#include "chain.h"
#include "identifier/auvid_identifier_internal.h"
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

static void save_and_restore(void)
{
    auvid_checkpoint_t cursor;
    uint32_t bytes = sizeof saved;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, &chain.id));
    TEST_ASSERT_TRUE(auvid_checkpoint_next(&cursor, saved, &bytes) >= 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&chain.id, saved, bytes));
}

/* Identify from one set. Before each of the first `raised` searches beside an end, its cost is
 * raised. Where they begin goes to at_s[], relative to the end.
 * @return searches beside an end */
static uint32_t identify(uint32_t raised, double *at_s)
{
    const auvid_identifier_work_t *now = &chain.id.work;
    const auvid_search_config_t *search = &chain.id.optimizer.cfg;
    uint32_t calls = 0, begun = 0, waits = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 1));
    while (auvid_identifier_work(&chain.id, 1) == AUVID_PENDING) {
        TEST_ASSERT_TRUE(++calls < 10000000u);
        if (now->beside > waits) {
            waits = now->beside;
            chain.id.work.minimum.cost *= waits <= raised ? AUVID_C(1.01) : AUVID_C(1.0);
            save_and_restore();
        }
        if (begun < waits && now->phase == AUVID_WORK_ASK) {
            int n = search->n - 1;
            at_s[begun++] = (double)(chain.id.optimizer.trial[n] - search->good[n]);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_UINT32(waits, begun);
    TEST_ASSERT_FALSE(chain.id.estimate.not_converged);
    return begun;
}

static void test_a_search_goes_on_from_both_sides_of_its_end(void)
{
    double at_s[WORK_SEARCHES_BESIDE];
    TEST_ASSERT_EQUAL_UINT32(2, identify(0, at_s));
    TEST_ASSERT_EQUAL_UINT32(100000, chain.id.metric.cfg.cell_us);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.15, at_s[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.15, at_s[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.2, (double)chain.id.estimate.delay_s[AUVID_SURGE]);
}

static void test_the_result_is_the_lowest_end(void)
{
    double at_s[WORK_SEARCHES_BESIDE];
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

static void test_a_lower_end_is_searched_beside_as_well(void)
{
    double at_s[WORK_SEARCHES_BESIDE];
    TEST_ASSERT_EQUAL_UINT32(3, identify(1, at_s));
    TEST_ASSERT_TRUE(at_s[1] > 0 && at_s[2] < 0);
    TEST_ASSERT_EQUAL_UINT32(4, identify(2, at_s));
}

static void test_the_searches_end_whatever_they_find(void)
{
    double at_s[WORK_SEARCHES_BESIDE];
    TEST_ASSERT_EQUAL_UINT32(WORK_SEARCHES_BESIDE, identify(UINT32_MAX, at_s));
}

static void test_no_search_begins_outside_the_bounds(void)
{
    double at_s[WORK_SEARCHES_BESIDE];
    cfg.before = NULL;
    TEST_ASSERT_EQUAL_UINT32(1, identify(0, at_s));
    TEST_ASSERT_TRUE(chain.id.estimate.delay_s[AUVID_SURGE] < AUVID_C(0.01));
}

static void test_there_is_one_search_without_delay_and_by_the_paper(void)
{
    double at_s[WORK_SEARCHES_BESIDE];
    cfg.id.search.paper = true;
    TEST_ASSERT_EQUAL_UINT32(0, identify(0, at_s));
    cfg.id.search.paper = false;
    cfg.id.metric.estimate_delay = false;
    TEST_ASSERT_EQUAL_UINT32(0, identify(0, at_s));
}

/* Also if the sets change while such a search waits: all of it begins again. */
static void test_a_change_of_the_sets_begins_the_search_again(void)
{
    const auvid_identifier_work_t *now = &chain.id.work;
    uint32_t changes = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 1));
    while (auvid_identifier_work(&chain.id, 1) == AUVID_PENDING) {
        if (changes == 0 && now->beside == 1) {
            TEST_ASSERT_EQUAL_UINT8(AUVID_WORK_MERGE, now->phase);
            chain.id.metric.sets.changed = true;
            ++changes;
            (void)auvid_identifier_work(&chain.id, 1);
            TEST_ASSERT_EQUAL_UINT8(0, now->beside);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(1, changes);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_UINT32(2, now->searches);
    TEST_ASSERT_EQUAL_UINT8(2, now->beside);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_search_goes_on_from_both_sides_of_its_end);
    RUN_TEST(test_the_result_is_the_lowest_end);
    RUN_TEST(test_a_lower_end_is_searched_beside_as_well);
    RUN_TEST(test_the_searches_end_whatever_they_find);
    RUN_TEST(test_no_search_begins_outside_the_bounds);
    RUN_TEST(test_there_is_one_search_without_delay_and_by_the_paper);
    RUN_TEST(test_a_change_of_the_sets_begins_the_search_again);
    return UNITY_END();
}
