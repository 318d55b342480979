/*
 * Sets in which nothing, or too little, moves the vehicle; and the excitation from start to end.
 */
#include <math.h>
#include <string.h>

#include "two_sets.h"
#include "unity.h"

void setUp(void)
{
    two_sets_defaults();
}

void tearDown(void)
{
}

/* ---- no work to do ---- */

static void test_an_empty_set_cannot_be_closed(void)
{
    static auvid_identifier_t before;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_identifier_close(&chain.id));
    chain_run(&chain, 2.0);                  /* cells, but no row yet */
    (void)auvid_identifier_close(&chain.id); /* takes the last one */
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, auvid_identifier_close(&chain.id));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_work(&chain.id, 100));
    TEST_ASSERT_EQUAL_UINT32(0, chain.id.work.last_units);
}

static void test_a_set_may_be_closed_early(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 25.0);
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, auvid_identifier_close(&chain.id));
    finish(&chain);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, chain.id.estimate.identified);
    chain_tick(&chain);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_SET | AUVID_EVENT_ESTIMATE, chain.out.events);
}

/* One more set is recorded, and not used. */
static void check_idle_set(void)
{
    uint32_t number = chain.id.estimate.number;
    do {
        chain_tick(&chain);
    } while (!(chain.out.events & AUVID_EVENT_SET));
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_SET | AUVID_EVENT_NOT_EXCITED, chain.out.events);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_work(&chain.id, 1000));
    TEST_ASSERT_EQUAL_UINT32(number, chain.id.estimate.number);
    chain_tick(&chain);
    TEST_ASSERT_EQUAL_HEX32(0, chain.out.events);
}

static void test_sets_without_excitation_are_not_searched(void)
{
    auvid_excitation_defaults(&cfg.acting.excitation); /* hovers */
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    check_idle_set();
    chain_run(&chain, 25.0);
    TEST_ASSERT_EQUAL(AUVID_SET_IDLE, auvid_identifier_close(&chain.id));
}

static void test_an_idle_vehicle_keeps_its_estimate(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, SETS));
    chain_run(&chain, 40.0); /* the set in which the excitation ends */
    finish(&chain);
    for (int k = 0; k <= AUVID_MAX_SETS; ++k) {
        check_idle_set();
    }
    auvid_metric_merge_begin(&chain.id.metric);
    uint32_t budget = UINT32_MAX;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&chain.id.metric, &budget));
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, auvid_metric_active(&chain.id.metric));
}

static void test_excitation_without_a_free_parameter_is_not_searched(void)
{
    cfg.id.metric.free = 1u << AUVID_G500_M_R | 1u << AUVID_G500_N_R; /* only of yaw */
    cfg.acting.excitation.segments = 2;                               /* only surge */
    TEST_ASSERT_EQUAL(AUVID_SURGE, cfg.acting.excitation.segment[0].dof);
    TEST_ASSERT_EQUAL(AUVID_SURGE, cfg.acting.excitation.segment[1].dof);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    check_idle_set();
}

static void stand_still(chain_t *c, auvid_input_t *in)
{
    (void)c;
    memset(in->dvl.sample.velocity, 0, sizeof in->dvl.sample.velocity);
}

static void test_a_velocity_stuck_at_zero_identifies_nothing(void)
{
    const uint32_t yaw = 1u << AUVID_G500_M_R | 1u << AUVID_G500_N_R | 1u << AUVID_G500_N_RR;
    cfg.before = stand_still;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, SETS));
    finish(&chain);
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.number);
    TEST_ASSERT_EQUAL_HEX32(0, chain.id.estimate.confidence.identifiable & ~yaw);
}

/* ---- excitation ---- */

static void test_excitation_is_zero_until_it_is_requested(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain.waiting = false;
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_stop(&chain.id)); /* before its start */
    chain_tick(&chain);
    TEST_ASSERT_TRUE(chain.out.events & AUVID_EVENT_EXCITATION_DONE);
    for (int k = 0; k < 250; ++k) {
        TEST_ASSERT_TRUE(is_zero(&chain.out));
        chain_tick(&chain);
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id));
    chain_run(&chain, 5.0);
    TEST_ASSERT_FALSE(is_zero(&chain.out));
}

/* Largest change of the excitation from tick to tick, relative to the amplitude. */
static double step_of(const auvid_real_t *before, const auvid_real_t *now)
{
    static const double amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 1, 1, 40};
    double max_change = 0.0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (j != AUVID_ROLL && j != AUVID_PITCH) {
            max_change = fmax(max_change, fabs((double)now[j] - (double)before[j]) / amplitude[j]);
        }
    }
    return max_change;
}

/* The run's fade is a raised cosine of fade_s: its steepest slope is pi / 2 / fade_s. Sines add at
 * most 2 pi 0.28 Hz (the changes between segments are not in this set). */
static void test_stop_fades_the_excitation_out(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&cfg.acting.excitation, amplitude, CHAIN_SET_S, 2, 1));
    double fade_s = (double)cfg.acting.excitation.fade_s, tick_s = 1e-6 * SIM_TICK_US;
    double steepest = tick_s * (3.1416 / 2.0 / fade_s + 2.0 * 3.1416 * 0.28);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 40.0); /* in the sines of the second set */
    TEST_ASSERT_FALSE(is_zero(&chain.out));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_stop(&chain.id));
    for (int k = 1; (double)k * tick_s <= fade_s + 0.1; ++k) {
        auvid_output_t before = chain.out;
        chain_tick(&chain);
        TEST_ASSERT_TRUE(step_of(before.excitation, chain.out.excitation) <= steepest);
        TEST_ASSERT_TRUE((double)k * tick_s > fade_s - 0.5 || !is_zero(&chain.out));
    }
    TEST_ASSERT_TRUE(is_zero(&chain.out));
    TEST_ASSERT_TRUE(chain.events & AUVID_EVENT_EXCITATION_DONE);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_stop(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_disarm(&chain.id)); /* without waiting for rest */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&chain.id)); /* it may start again */
    chain_run(&chain, 5.0);
    TEST_ASSERT_FALSE(is_zero(&chain.out));
}

static void test_the_excitation_ends_by_itself(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, SETS * CHAIN_SET_S - 1.0);
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_EXCITATION_DONE);
    chain_run(&chain, 2.0);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_EXCITATION_DONE,
                            chain.events & AUVID_EVENT_EXCITATION_DONE);
    TEST_ASSERT_TRUE(is_zero(&chain.out));
}

static void test_a_passive_identifier_cannot_excite(void)
{
    chain_set_driver(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_DETACHED, auvid_identifier_arm(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_DETACHED, auvid_identifier_excite(&chain.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_DETACHED, auvid_identifier_stop(&chain.id));
}

static void test_the_wrench_returned_is_that_of_the_thruster_forces_returned(void)
{
    auvid_real_t wrench[AUVID_DOF_COUNT];
    double roll = 0.0;
    /* a side thruster above the centre: sway causes roll */
    cfg.thrusters.thruster[4].wrench[AUVID_ROLL] = AUVID_C(0.1);
    cfg.thrusters.dofs = (uint8_t)~AUVID_DOF_BIT(AUVID_ROLL) & 0x3Fu;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    for (int k = 0; k < 1000; ++k) {
        chain_tick(&chain);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_allocation_wrench(&chain.allocation, chain.out.thruster_N, wrench));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-3, (double)wrench[j], (double)chain.out.excitation[j]);
        }
        roll += fabs((double)chain.out.excitation[AUVID_ROLL]);
    }
    TEST_ASSERT_TRUE(roll > 0.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_empty_set_cannot_be_closed);
    RUN_TEST(test_a_set_may_be_closed_early);
    RUN_TEST(test_sets_without_excitation_are_not_searched);
    RUN_TEST(test_an_idle_vehicle_keeps_its_estimate);
    RUN_TEST(test_a_velocity_stuck_at_zero_identifies_nothing);
    RUN_TEST(test_excitation_without_a_free_parameter_is_not_searched);
    RUN_TEST(test_excitation_is_zero_until_it_is_requested);
    RUN_TEST(test_stop_fades_the_excitation_out);
    RUN_TEST(test_the_excitation_ends_by_itself);
    RUN_TEST(test_a_passive_identifier_cannot_excite);
    RUN_TEST(test_the_wrench_returned_is_that_of_the_thruster_forces_returned);
    return UNITY_END();
}
