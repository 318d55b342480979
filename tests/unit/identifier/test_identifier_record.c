/*
 * What the identifier records of samples that are late, rare or not there.
 */
#include <math.h>
#include <string.h>

#include "two_sets.h"
#include "unity.h"

#define ALL_DROPPED                                                                                \
    (AUVID_EVENT_IMU_DROPPED | AUVID_EVENT_DVL_DROPPED | AUVID_EVENT_DEPTH_DROPPED |               \
     AUVID_EVENT_GPS_DROPPED | AUVID_EVENT_INPUT_DROPPED | AUVID_EVENT_TIME)

void setUp(void)
{
    two_sets_defaults();
}

void tearDown(void)
{
}

static void check_masses(const chain_t *c)
{
    for (int i = SIM_M_U; i <= SIM_M_R; ++i) {
        TEST_ASSERT_TRUE(fabs(chain_error(c, i)) < 0.10);
    }
}

/* ---- an IMU that is later than the other sensors ---- */

enum { LATE_TICKS = 5 };

typedef struct {
    uint32_t dvl; /* samples sent */
    struct {
        bool present;
        uint64_t t_us;
        auvid_real_t attitude[3], rates[3];
    } past[LATE_TICKS];
} late_t;

/* The IMU's sample of five ticks ago. */
static void delay_imu(chain_t *c, auvid_input_t *in)
{
    late_t *late = c->cfg.context;
    auvid_input_t now = *in;
    int slot = (int)(c->tick % LATE_TICKS);
    late->dvl += in->dvl.present;
    in->imu.present = late->past[slot].present;
    in->imu.t_us = late->past[slot].t_us;
    memcpy(in->imu.attitude, late->past[slot].attitude, sizeof in->imu.attitude);
    memcpy(in->imu.rates, late->past[slot].rates, sizeof in->imu.rates);
    late->past[slot].present = now.imu.present;
    late->past[slot].t_us = now.imu.t_us;
    memcpy(late->past[slot].attitude, now.imu.attitude, sizeof now.imu.attitude);
    memcpy(late->past[slot].rates, now.imu.rates, sizeof now.imu.rates);
}

static void test_an_imu_that_is_100_ms_late_loses_no_sample_of_the_others(void)
{
    late_t late = {0};
    cfg.before = delay_imu;
    cfg.context = &late;
    cfg.budget = 0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 0.15); /* before the first IMU sample no other is accepted */
    chain.events = late.dvl = 0;
    chain_run(&chain, 30.1);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & (ALL_DROPPED | AUVID_EVENT_GAP));
    const auvid_nav_t *nav = &chain.id.nav;
    TEST_ASSERT_TRUE(late.dvl >= 150);
    TEST_ASSERT_EQUAL_UINT32(late.dvl - 1, nav->diagnostics[AUVID_NAV_DVL_BOTTOM].accepted);
    TEST_ASSERT_EQUAL_UINT32(late.dvl - 1, nav->ground.sequence); /* the last is held */
    TEST_ASSERT_EQUAL_UINT(0, nav->diagnostics[AUVID_NAV_DVL_BOTTOM].unused);
    TEST_ASSERT_EQUAL_UINT32(nav->ground.sequence, chain.id.last_sample);
}

/* A step with an IMU sample of imu_us, and a DVL sample of dvl_us if that is not 0. */
static uint32_t step_at(uint64_t t_us, uint64_t imu_us, uint64_t dvl_us, double u)
{
    auvid_input_t in;
    auvid_output_t out;
    memset(&in, 0, sizeof in);
    in.t_us = t_us;
    in.imu.present = true;
    in.imu.t_us = imu_us;
    in.dvl.present = dvl_us != 0;
    in.dvl.sample.t_us = dvl_us;
    in.dvl.sample.velocity[0] = (auvid_real_t)u;
    in.dvl.sample.valid = AUVID_DVL_ALL;
    in.applied.present = true;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    return out.events;
}

static void test_a_held_sample_that_is_refused_is_an_event_when_the_imu_comes_to_it(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL_HEX32(0, step_at(1000000, 1000000, 1000000, 0) & ALL_DROPPED);
    TEST_ASSERT_EQUAL_HEX32(0, step_at(1100000, 1020000, 1100000, 2.9) & ALL_DROPPED);
    TEST_ASSERT_EQUAL_HEX32(0, step_at(1120000, 1040000, 0, 0) & ALL_DROPPED);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_DVL_DROPPED, step_at(1180000, 1100000, 0, 0) & ALL_DROPPED);
    TEST_ASSERT_EQUAL_UINT(1, chain.id.nav.diagnostics[AUVID_NAV_DVL_BOTTOM].gated);
    TEST_ASSERT_EQUAL_HEX32(0, step_at(1200000, 1120000, 0, 0) & ALL_DROPPED);
}

/* The IMU catches up in one step: a held sample and one of this tick are used together. Without the
 * held one the record would have a gap. */
static void test_a_held_sample_and_the_next_one_are_both_recorded(void)
{
    uint32_t events = 0;
    cfg.id.recorder.gap_us = 150000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    for (uint64_t k = 0; k <= 5; ++k) {
        uint64_t t = 1000000 + 100000 * k;
        (void)step_at(t, t, t, 0);
    }
    events |= step_at(1580000, 1520000, 0, 0);
    events |= step_at(1600000, 1540000, 1600000, 0);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_NAV_DVL_BOTTOM, chain.id.nav.held.sensors);
    events |= step_at(1690000, 1690000, 1690000, 0);
    events |= step_at(1790000, 1790000, 1790000, 0);
    TEST_ASSERT_EQUAL_UINT32(9, chain.id.nav.ground.sequence);
    TEST_ASSERT_EQUAL_HEX32(0, events & (AUVID_EVENT_GAP | ALL_DROPPED));
}

/* ---- gaps ---- */

typedef enum { GAP_DVL, GAP_IMU, GAP_INPUT, GAP_ALL, GAPS } gap_t;

/* No samples from 20 s to 25 s. */
static void drop_all_samples(chain_t *c, auvid_input_t *in)
{
    gap_t gap = *(const gap_t *)c->cfg.context;
    if (c->tick >= 1000 && c->tick < 1250) {
        in->dvl.present = in->dvl.present && gap != GAP_DVL && gap != GAP_ALL;
        in->imu.present = in->imu.present && gap != GAP_IMU && gap != GAP_ALL;
        in->applied.present = in->applied.present && gap != GAP_INPUT && gap != GAP_ALL;
        in->depth.present = in->depth.present && gap != GAP_ALL;
    }
}

static auvid_validation_t cells;

/* Compare every subsequent cell with the simulated truth. */
static void attach(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_validation_init(&cells, &auvid_girona500, auvid_girona500_paper, 0,
                                            NULL, 0, AUVID_C(0.1)));
    auvid_identifier_attach(&chain.id, &cells);
}

/* No row may contain cells from both sides of the gap, and no integration may cross it. */
static void test_a_gap_of_5_s_breaks_the_record_and_identification_continues(void)
{
    for (gap_t gap = GAP_DVL; gap < GAPS; ++gap) {
        auvid_real_t r2[AUVID_DOF_COUNT];
        chain_defaults(&cfg, 11, SETS + 1, 0.0);
        chain_set_driver(&cfg);
        cfg.before = drop_all_samples;
        cfg.context = &gap;
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
        attach();
        chain_run(&chain, 19.0);
        TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_GAP);
        chain_run(&chain, 8.0);
        TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_GAP, chain.events & AUVID_EVENT_GAP);
        chain_run(&chain, 17.0); /* a set is 30 s; the gap 5; before each piece 5 of the filter */
        TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_SET);
        chain.events = 0;
        chain_run(&chain, 33.0);
        finish(&chain);
        TEST_ASSERT_EQUAL_HEX32(0, chain.events & (AUVID_EVENT_GAP | ALL_DROPPED));
        TEST_ASSERT_EQUAL_UINT32(SETS, chain.id.estimate.sets);
        TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE, chain.id.estimate.identified);
        check_masses(&chain);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_validation_r2(&cells, r2));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            bool excited = j != AUVID_ROLL && j != AUVID_PITCH;
            TEST_ASSERT_TRUE(!excited || r2[j] > AUVID_C(0.98));
        }
    }
}

/* No tick for 5 s, while the vehicle continues to move. */
static void test_ticks_left_out_for_5_s_are_a_gap(void)
{
    sim_output_t seen;
    const double hover[AUVID_DOF_COUNT] = {0, 0, -cfg.sim.parameter[SIM_WB], 0, 0, 0};
    chain_defaults(&cfg, 11, SETS + 1, 0.0);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, 20.0);
    for (int k = 0; k < 250; ++k) {
        sim_step(&chain.sim, NULL, hover, &seen);
    }
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL_HEX32(AUVID_EVENT_GAP, chain.events & AUVID_EVENT_GAP);
    chain_run(&chain, 55.0);
    finish(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED,
                      chain.actuation.guard.state); /* no excitation from now on */
    TEST_ASSERT_EQUAL_UINT32(1, chain.id.estimate.sets);
    check_masses(&chain);
}

/* ---- cells ---- */

static void count_cells(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    uint32_t *last = c->cfg.context;
    (void)status;
    (void)out;
    TEST_ASSERT_TRUE(cells.cells - *last <= AUVID_CELLS_PER_STEP);
    *last = cells.cells;
}

/* DVL samples 0.4 s apart, and late, make several cells complete at once. */
static void test_a_step_takes_no_more_cells_than_it_says(void)
{
    uint32_t last = 0;
    chain_set_driver(&cfg);
    cfg.sim.sensor[SIM_DVL].rate_hz = 2.5;
    cfg.sim.sensor[SIM_DVL].age_s = 0.1;
    cfg.id.metric.velocity_us = 400000;
    cfg.after = count_cells;
    cfg.context = &last;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    attach();
    chain_run(&chain, 30.0);
    TEST_ASSERT_TRUE(cells.cells > 270); /* it keeps up: of 300, less both ends */
    TEST_ASSERT_EQUAL_HEX32(0, chain.events & AUVID_EVENT_GAP);
    auvid_identifier_attach(&chain.id, NULL);
    chain_run(&chain, 1.0);
    TEST_ASSERT_EQUAL_UINT32(last, cells.cells);
}

/* ---- period of the velocity samples ---- */

static void test_the_period_of_the_dvl_is_observed_and_no_cell_is_lost_at_5_hz(void)
{
    chain_set_driver(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    cfg.id.metric.velocity_us = 200000;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&other, &cfg));
    chain_run(&chain, 20.0);
    chain_run(&other, 20.0);
    other.id.metric.prior_context = chain.id.metric.prior_context; /* each has its own */
    TEST_ASSERT_EQUAL_MEMORY(&other.id.metric, &chain.id.metric, sizeof chain.id.metric);
}

static void test_the_period_of_another_dvl_spreads_the_wrench_as_if_it_were_given(void)
{
    chain_set_driver(&cfg);
    cfg.sim.sensor[SIM_DVL].rate_hz = 10.0;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    cfg.id.metric.velocity_us = 100000;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&other, &cfg));
    chain_run(&chain, 20.0);
    chain_run(&other, 20.0);
    TEST_ASSERT_EQUAL_UINT32(100000, chain.id.metric.cfg.velocity_us);
    other.id.metric.prior_context = chain.id.metric.prior_context; /* each has its own */
    TEST_ASSERT_EQUAL_MEMORY(&other.id.metric, &chain.id.metric, sizeof chain.id.metric);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_an_imu_that_is_100_ms_late_loses_no_sample_of_the_others);
    RUN_TEST(test_a_held_sample_that_is_refused_is_an_event_when_the_imu_comes_to_it);
    RUN_TEST(test_a_held_sample_and_the_next_one_are_both_recorded);
    RUN_TEST(test_a_gap_of_5_s_breaks_the_record_and_identification_continues);
    RUN_TEST(test_ticks_left_out_for_5_s_are_a_gap);
    RUN_TEST(test_a_step_takes_no_more_cells_than_it_says);
    RUN_TEST(test_the_period_of_the_dvl_is_observed_and_no_cell_is_lost_at_5_hz);
    RUN_TEST(test_the_period_of_another_dvl_spreads_the_wrench_as_if_it_were_given);
    return UNITY_END();
}
