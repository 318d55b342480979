/*
 * The same inputs give the same bits, whatever their path, and identifiers do not interact.
 */
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

static void test_same_inputs_give_the_same_bits(void)
{
    cfg.budget = 50;
    run(&chain);
    run(&other);
    check_same_estimate();
}

static void test_interleaved_identifiers_do_not_interact(void)
{
    static chain_t single[2];
    chain_config_t second;
    chain_defaults(&second, 12, SETS, 0.0);
    cfg.budget = 500;
    second.budget = 1000;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&single[0], &cfg, SETS));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&single[1], &second, SETS));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&other, &second));
    while (chain.tick < single[0].tick) {
        chain_tick(&chain);
        chain_tick(&other);
    }
    TEST_ASSERT_TRUE(single[0].id.estimate.number > 0 && single[1].id.estimate.number > 0);
    TEST_ASSERT_TRUE(chain_is_same(&single[0], &chain) && chain_is_same(&single[1], &other));
}

static void test_a_copy_of_an_identifier_continues_identically(void)
{
    cfg.budget = 20;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 40.0); /* searching, exciting, recording */
    TEST_ASSERT_EQUAL(AUVID_PENDING, chain.work);
    chain_copy(&other, &chain);
    chain_run(&chain, 30.0);
    memset(&chain.cfg.id, 0xFF, sizeof chain.cfg.id); /* no pointer refers to them */
    memset(&chain.cfg.acting, 0xFF, sizeof chain.cfg.acting);
    chain_run(&other, 30.0);
    TEST_ASSERT_TRUE(chain_is_same(&chain, &other));
    TEST_ASSERT_TRUE(chain.id.estimate.number > 0);
}

static void give_applied_separately(chain_t *c, auvid_input_t *in)
{
    in->applied.present = false;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&c->id, in->t_us, in->applied.wrench,
                                                         in->applied.command));
}

static void test_the_applied_wrench_may_come_with_the_step_or_separately(void)
{
    chain_set_driver(&cfg);
    run(&other);
    cfg.before = give_applied_separately;
    run(&chain);
    check_same_estimate();
}

/* The test's own navigation filter; its state is recorded in every tick, by the identifier and by a
 * recorder of the test. */
static auvid_nav_t own_nav;
static auvid_recorder_t own_recorder;
static auvid_metric_t own_metric;

static void navigate_separately(chain_t *c, auvid_input_t *in)
{
    auvid_nav_state_t state;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_nav_imu(&own_nav, in->imu.t_us, in->imu.attitude, in->imu.rates));
    if (in->dvl.present) {
        (void)auvid_nav_dvl(&own_nav, &in->dvl.sample);
    }
    if (in->depth.present) {
        (void)auvid_nav_depth(&own_nav, in->depth.t_us, in->depth.depth_m);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&own_nav, &state));
    if (state.flags & AUVID_NAV_FRESH_BOTTOM) {
        auvid_real_t nu[AUVID_DOF_COUNT];
        memcpy(nu, state.velocity, sizeof state.velocity);
        memcpy(nu + AUVID_ROLL, state.rates, sizeof state.rates);
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_identifier_motion(&c->id, state.t_us, state.attitude, nu));
        TEST_ASSERT_EQUAL(AUVID_OK,
                          auvid_recorder_motion(&own_recorder, state.t_us, state.attitude, nu));
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_input(&own_recorder, in->t_us, in->applied.wrench,
                                                     in->applied.command));
    for (auvid_sample_t cell; auvid_recorder_pop(&own_recorder, &cell) == AUVID_OK;) {
        TEST_ASSERT_TRUE(auvid_metric_add(&own_metric, &cell) >= 0);
    }
    in->imu.present = in->dvl.present = in->depth.present = false;
}

static void test_motion_from_another_source_reaches_the_metric_through_the_recorder(void)
{
    chain_set_driver(&cfg);
    cfg.id.metric.velocity_us = 200000; /* only the identifier observes it */
    cfg.id.recorder.gap_us = auvid_recorder_gap(cfg.id.metric.velocity_us);
    cfg.id.metric.delay_sigma_s = cfg.id.uncertainty.delay_s;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_init(&own_nav, &cfg.id.nav));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_recorder_init(&own_recorder, &cfg.id.recorder));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&own_metric, &cfg.id.metric));
    cfg.before = navigate_separately;
    run(&chain);
    TEST_ASSERT_EQUAL(SETS, own_metric.sets.recorded);
    TEST_ASSERT_EQUAL_MEMORY(own_metric.sets.set, chain.id.metric.sets.set,
                             sizeof own_metric.sets.set);
    TEST_ASSERT_TRUE(chain.id.estimate.number > 0);
}

static void test_the_clock_may_begin_anywhere(void)
{
    run(&other);
    cfg.epoch_us = UINT64_C(1) << 60;
    run(&chain);
    TEST_ASSERT_EQUAL_MEMORY(other.id.estimate.pi, chain.id.estimate.pi,
                             sizeof chain.id.estimate.pi);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_same_inputs_give_the_same_bits);
    RUN_TEST(test_interleaved_identifiers_do_not_interact);
    RUN_TEST(test_a_copy_of_an_identifier_continues_identically);
    RUN_TEST(test_the_applied_wrench_may_come_with_the_step_or_separately);
    RUN_TEST(test_motion_from_another_source_reaches_the_metric_through_the_recorder);
    RUN_TEST(test_the_clock_may_begin_anywhere);
    return UNITY_END();
}
