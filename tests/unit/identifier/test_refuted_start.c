/*
 * Residual path: the poll of a search finds a better point than the end of the steps of
 * Gauss-Newton. Here that end is moved away, as often as a test says.
 */
#include "auvid/checkpoint.h"
#include "by_residual.h"
#include "chain.h"
#include "identifier/auvid_identifier_internal.h"
#include "unity.h"

enum { SETS = 2, SET_ROWS = 60, N = 3 }; /* m_u, X_u, X_uu */

static auvid_row_t store[(SETS + 1) * SET_ROWS];
static auvid_vehicle_t vehicle;
static chain_config_t cfg;
static chain_t chain;
static uint8_t saved[1 << 18];

void setUp(void)
{
    chain_defaults(&cfg, 5, SETS + 1, 1.0);
    cfg.budget = 0;
    by_residual_surge(&cfg.id, &vehicle, store, SETS);
    cfg.id.metric.estimate_delay = false;
    vehicle.smooth = true;
}

void tearDown(void)
{
}

/* A checkpoint is taken, and the work continues from it. */
static void save_and_restore(void)
{
    auvid_checkpoint_t cursor;
    uint32_t bytes = sizeof saved;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, &chain.id));
    TEST_ASSERT_TRUE(auvid_checkpoint_next(&cursor, saved, &bytes) >= 0);
    TEST_ASSERT_EQUAL_UINT32(cursor.bytes, bytes);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&chain.id, saved, bytes));
}

/* Works until nothing is left. Moves the first `moves` ends of the steps. */
static void work(uint32_t moves)
{
    const auvid_identifier_work_t *now = &chain.id.work;
    uint32_t calls = 0, moved = 0;
    uint8_t refuted = 0;
    bool found = false;
    while (auvid_identifier_work(&chain.id, 1) == AUVID_PENDING) {
        bool at_end = now->phase == AUVID_WORK_MERGE && !now->searching && now->spent >= WORK_START;
        TEST_ASSERT_TRUE(++calls < 10000000u);
        if (at_end && !found && moved < moves) {
            chain.id.work.candidate[AUVID_G500_X_UU] *= AUVID_C(1.5);
            ++moved;
        }
        found = at_end;
        if (now->refuted != refuted) {
            refuted = now->refuted;
            save_and_restore();
        }
    }
    TEST_ASSERT_EQUAL_UINT32(moves, moved);
}

/* The first search, of one set, or a later one, of two. */
static void search(uint32_t estimates, uint32_t moves)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, 1));
    for (uint32_t k = 1; k <= estimates; ++k) {
        work(k == estimates ? moves : 0);
        TEST_ASSERT_EQUAL_UINT32(k, chain.id.estimate.number);
        TEST_ASSERT_EQUAL_UINT32(k, chain.id.work.searches);
        if (k < estimates) {
            chain_run(&chain, CHAIN_SET_S);
        }
    }
}

static void assert_at_the_optimum(double cost)
{
    TEST_ASSERT_FALSE(chain.id.estimate.not_converged);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * cost, cost, (double)chain.id.estimate.cost);
}

static double cost_of_search(uint32_t estimates)
{
    search(estimates, 0);
    TEST_ASSERT_EQUAL_UINT8(0, chain.id.work.refuted);
    return (double)chain.id.estimate.cost;
}

static void test_a_confirmed_start_costs_one_poll(void)
{
    (void)cost_of_search(2);
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.evaluations_crs);
    TEST_ASSERT_EQUAL_UINT32(2 * N + 1, chain.id.estimate.evaluations_line);
}

static void test_the_steps_continue_from_a_better_point_and_a_poll_confirms_their_end(void)
{
    double cost = cost_of_search(2);
    for (uint32_t moves = 1; moves <= WORK_CONTINUATIONS; ++moves) {
        search(2, moves);
        assert_at_the_optimum(cost);
        TEST_ASSERT_EQUAL_UINT32(moves, chain.id.work.refuted);
        TEST_ASSERT_EQUAL_UINT32(0, chain.id.estimate.evaluations_crs);
        /* the first evaluation of a poll is that of the start itself */
        TEST_ASSERT_EQUAL_UINT32(moves + 2 * N + 1, chain.id.estimate.evaluations_line);
    }
}

static void test_a_start_that_is_always_refuted_ends_in_a_search_by_both_algorithms(void)
{
    double cost = cost_of_search(2);
    search(2, WORK_CONTINUATIONS + 1);
    assert_at_the_optimum(cost);
    TEST_ASSERT_EQUAL_UINT32(WORK_CONTINUATIONS + 1, chain.id.work.refuted);
    TEST_ASSERT_TRUE(chain.id.estimate.evaluations_crs > 0);
}

static void test_so_it_is_in_the_first_search_after_its_population(void)
{
    double cost = cost_of_search(1);
    uint32_t population = chain.id.estimate.evaluations_crs;
    TEST_ASSERT_TRUE(population > 0);
    search(1, 1);
    assert_at_the_optimum(cost);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.work.refuted);
    TEST_ASSERT_TRUE(chain.id.estimate.evaluations_crs >= population);
}

static void test_the_next_sets_are_searched_as_if_nothing_had_been_refuted(void)
{
    search(2, 1);
    chain_run(&chain, CHAIN_SET_S);
    work(0);
    TEST_ASSERT_EQUAL_UINT32(3, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_UINT8(0, chain.id.work.refuted);
    TEST_ASSERT_EQUAL_UINT32(2 * N + 1, chain.id.estimate.evaluations_line);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_confirmed_start_costs_one_poll);
    RUN_TEST(test_the_steps_continue_from_a_better_point_and_a_poll_confirms_their_end);
    RUN_TEST(test_a_start_that_is_always_refuted_ends_in_a_search_by_both_algorithms);
    RUN_TEST(test_so_it_is_in_the_first_search_after_its_population);
    RUN_TEST(test_the_next_sets_are_searched_as_if_nothing_had_been_refuted);
    return UNITY_END();
}
