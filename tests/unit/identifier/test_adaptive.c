/* Adaptive excitation: it excites for missing information within its limits, and ends by itself. */
#include <math.h>
#include <string.h>

#include "adaptive_run.h"
#include "auvid/prior.h"
#include "auvid/uncertain.h"
#include "unity.h"

enum { SWAY_ONES = 1 << 1 | 1 << 7 | 1 << 8 };

void setUp(void)
{
    make_world(1, 1.0);
}

void tearDown(void)
{
}

static void test_it_ends_by_itself_when_everything_is_known(void)
{
    begin();
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(ALL, chain.id.estimate.confidence.identifiable);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.missing);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.abandoned);
    /* at once: with the fade and two ticks */
    const double fade_s = (double)chain.actuation.excitation.cfg.fade_s;
    TEST_ASSERT_TRUE(seen.rest_s > 0.0 && seen.rest_s <= seen.done_s + fade_s + 0.04);
    TEST_ASSERT_FALSE(seen.over);
    TEST_ASSERT_FALSE(seen.outside);
    TEST_ASSERT_TRUE((chain.events & AUVID_EVENT_EXCITATION_DONE) != 0);
}

/* What cannot become known is not waited for. */
static void test_it_ends_with_a_degree_of_freedom_in_closed_loop(void)
{
    const uint32_t heave = 1u << 2 | 1u << 4 | 1u << 9 | 1u << 10;
    config.id.metric.closed_loop = AUVID_DOF_BIT(AUVID_HEAVE);
    begin();
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(ALL & ~heave, chain.id.estimate.confidence.identifiable);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.missing | chain.adaptive.abandoned);
}

/* The estimate that the user reads decides, not the one with the inputs as supplied, which is known
 * sooner. */
static void test_with_uncertain_inputs_it_ends_when_the_estimate_with_them_is_known(void)
{
    static auvid_uncertain_t uncertain;
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        make_world(seed, 0.3);
        config.id.exact_inputs = false;
        config.id.uncertainty.thrust_scale = AUVID_C(0.05);
        begin();
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(&chain.id, &uncertain,
                                                                      &inputs, &chain.allocation));
        run(600);
        TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
        TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.missing);
        const auvid_estimate_t *e = auvid_identifier_estimate(&chain.id);
        TEST_ASSERT_TRUE(e == &uncertain.estimate);
        for (int i = 0; i < N; ++i) { /* or no motion helps */
            auvid_note_t note = (auvid_note_t)e->confidence.note[i];
            bool abandoned = (chain.adaptive.abandoned >> i & 1u) != 0;
            uint32_t ended = e->confidence.identifiable | chain.adaptive.abandoned;
            TEST_ASSERT_TRUE(!abandoned || i == AUVID_G500_W_B || note == AUVID_NOTE_INPUTS);
            TEST_ASSERT_TRUE((ended >> i & 1u) != 0 || note == AUVID_NOTE_THRUST_SCALE ||
                             note == AUVID_NOTE_SMALL);
        }
    }
}

static void test_a_run_may_be_begun_again(void)
{
    begin();
    run(300);
    double first_s = 1e-6 * (double)chain.t_us;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
    chain.waiting = true;
    chain_tick(&chain);
    run(600); /* everything is known: nothing remains to be done */
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_TRUE(1e-6 * (double)chain.t_us < first_s + 12.0);
}

/* A prior from the last dive does not count as known until a set has confirmed it. */
static void test_dives_with_a_prior_record_end_sooner_but_not_without_a_set(void)
{
    enum { DIVES = 10 };
    uint8_t record[AUVID_PRIOR_BYTES];
    double cold_s = 0, prior_s = 0;
    for (uint64_t dive = 1; dive <= DIVES; ++dive) {
        begin();
        run(300);
        cold_s += seen.end_s;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_save(&chain.id, record));
        make_world(100 + dive, 1.0);
        TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_prior_load(&chain.id, record, sizeof record));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
        run(300);
        prior_s += seen.end_s;
        TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
        TEST_ASSERT_EQUAL_HEX32(ALL, chain.id.estimate.confidence.identifiable);
        TEST_ASSERT_TRUE(chain.id.metric.sets.recorded >= 1);
        make_world(1 + dive, 1.0);
    }
    printf("mean time until the end: %.1f s, with a prior %.1f s\n", cold_s / DIVES,
           prior_s / DIVES);
    TEST_ASSERT_TRUE(prior_s < 0.75 * cold_s);
}

static void test_without_a_side_thruster_coupling_identifies_sway(void)
{
    config.thrusters.thruster[4].min_N = config.thrusters.thruster[4].max_N = 0;
    config.acting.excitation.segments = 0; /* the excitation would reject that plan */
    begin();
    chain.waiting = true;
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.abandoned);
    TEST_ASSERT_EQUAL_HEX8(1u << AUVID_SWAY, chain.id.estimate.coupled);
    TEST_ASSERT_EQUAL_HEX32(ALL, chain.id.estimate.confidence.identifiable);
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        TEST_ASSERT_TRUE(fabs(chain_error(&chain, i)) < 0.2);
    }
}

/* Without yaw moment only disturbances turn the vehicle. */
static void test_sway_that_hardly_moves_is_abandoned(void)
{
    const uint32_t drag = 1u << SIM_Y_V | 1u << SIM_Y_VV;
    config.thrusters.thruster[4].min_N = config.thrusters.thruster[4].max_N = 0;
    config.acting.excitation.segments = 0;
    cfg.amplitude[AUVID_YAW] = 0;
    begin();
    chain.waiting = true;
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(drag, chain.adaptive.abandoned & drag);
    TEST_ASSERT_EQUAL_HEX32(0, chain.id.estimate.confidence.identifiable & drag);
}

/* The sway thruster runs without effect: an infinite mass. */
static void test_a_dof_that_does_not_move_is_abandoned_in_time(void)
{
    config.sim.parameter[SIM_M_V] = 1e9;
    begin();
    run(450);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(SWAY_ONES, chain.adaptive.abandoned & SWAY_ONES);
    TEST_ASSERT_TRUE(seen.end_s < 250.0);
}

static void test_weak_thrusters_excite_in_turn_and_everything_is_known(void)
{
    for (int i = 0; i < 5; ++i) { /* X or N, not both */
        config.thrusters.thruster[i].min_N = i < 2 ? -60 : -153;
        config.thrusters.thruster[i].max_N = i < 2 ? 60 : 153;
    }
    config.acting.excitation.segments = 0;
    begin();
    chain.waiting = true;
    uint8_t together = 0, ever = 0;
    while (1e-6 * (double)chain.t_us < 450 && chain.out.guard != AUVID_GUARD_DONE) {
        chain_tick(&chain);
        uint8_t driving = chain.adaptive.playing;
        ever |= driving;
        together |= (driving & 0x21) == 0x21;
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_EQUAL_HEX32(0, together);
    TEST_ASSERT_EQUAL_HEX32(0x27, ever);
    TEST_ASSERT_FALSE(seen.over);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.abandoned);
    TEST_ASSERT_EQUAL_HEX32(0, chain.adaptive.missing);
}

static void test_it_ends_after_the_longest_run_time(void)
{
    cfg.max_s = 40;
    begin();
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    TEST_ASSERT_TRUE(seen.end_s < 52.0);
    TEST_ASSERT_TRUE(chain.adaptive.missing != 0); /* and reports what is missing */
}

static void test_the_operator_ends_it_with_a_fade_or_at_once(void)
{
    begin();
    chain_run(&chain, 20);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_stop(&chain.id));
    run(40);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
    begin();
    chain_run(&chain, 20);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_abort(&chain.id));
    chain_tick(&chain);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.out.guard);
    chain_run(&chain, 5);
    TEST_ASSERT_FALSE(seen.outside);
}

static void test_a_limit_of_the_guard_ends_it(void)
{
    config.acting.guard.distance_max_m = 3;
    cfg.excursion_limit[AUVID_SURGE] = cfg.excursion_limit[AUVID_SWAY] = 0; /* never brought back */
    begin();
    run(300);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.out.guard);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISTANCE, chain.out.cause);
    TEST_ASSERT_FALSE(seen.outside);
}

/* The default excursion limit of 5 m would equal the distance at which the guard aborts. */
static void test_with_a_small_distance_limit_it_is_brought_back_in_time(void)
{
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        make_world(seed, 1.0);
        config.acting.guard.distance_max_m = 5;
        begin();
        run(300);
        TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, chain.out.guard);
        TEST_ASSERT_EQUAL_HEX32(ALL, chain.id.estimate.confidence.identifiable);
    }
}

/* In heave a part of the depths that the guard permits; none, which is 0, would be no limit. */
static void test_heave_stays_within_the_depths_of_the_guard(void)
{
    static const double depths[][3] = {{1, 12, 1.65}, {1, 100, 3}, {5, 5, 0.1}};
    for (size_t k = 0; k < sizeof depths / sizeof depths[0]; ++k) {
        make_world(1, 1.0);
        config.acting.guard.depth_min_m = (auvid_real_t)depths[k][0];
        config.acting.guard.depth_max_m = (auvid_real_t)depths[k][1];
        begin();
        TEST_ASSERT_DOUBLE_WITHIN(
            1e-6, depths[k][2],
            (double)chain.id.actuation->excitation.cfg.excursion_limit[AUVID_HEAVE]);
    }
}

static void check_refused(auvid_status_t status)
{
    static auvid_identifier_t before;
    before = chain.id;
    TEST_ASSERT_EQUAL(status, auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    setUp();
}

static void test_an_invalid_configuration_is_refused(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &config));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_adaptive_begin(NULL, &chain.adaptive, &cfg, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_adaptive_begin(&chain.id, &chain.adaptive, NULL, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_adaptive_begin(&chain.id, NULL, &cfg, NULL));
    auvid_adaptive_defaults(NULL);
    memset(cfg.amplitude, 0, sizeof cfg.amplitude);
    check_refused(AUVID_ERR_RANGE);
    cfg.amplitude[0] = -1;
    check_refused(AUVID_ERR_RANGE);
    cfg.excursion_limit[5] = -1;
    check_refused(AUVID_ERR_RANGE);
    cfg.max_s = 29;
    check_refused(AUVID_ERR_RANGE);
    cfg.max_s = 3601;
    check_refused(AUVID_ERR_RANGE);
    cfg.amplitude[2] = (auvid_real_t)NAN;
    check_refused(AUVID_ERR_NOT_FINITE);
    cfg.excursion_limit[2] = (auvid_real_t)INFINITY;
    check_refused(AUVID_ERR_NOT_FINITE);
    cfg.amplitude[0] = 400;
    check_refused(AUVID_ERR_CAPACITY);
}

static void test_calls_out_of_order_are_refused(void)
{
    memset(&chain, 0, sizeof chain);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE,
                      auvid_adaptive_begin(&chain.id, &chain.adaptive, &cfg, NULL));
    begin();
    chain_run(&chain, 5); /* exciting */
    check_refused(AUVID_ERR_STATE);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_it_ends_by_itself_when_everything_is_known);
    RUN_TEST(test_it_ends_with_a_degree_of_freedom_in_closed_loop);
    RUN_TEST(test_with_uncertain_inputs_it_ends_when_the_estimate_with_them_is_known);
    RUN_TEST(test_a_run_may_be_begun_again);
    RUN_TEST(test_dives_with_a_prior_record_end_sooner_but_not_without_a_set);
    RUN_TEST(test_without_a_side_thruster_coupling_identifies_sway);
    RUN_TEST(test_sway_that_hardly_moves_is_abandoned);
    RUN_TEST(test_a_dof_that_does_not_move_is_abandoned_in_time);
    RUN_TEST(test_weak_thrusters_excite_in_turn_and_everything_is_known);
    RUN_TEST(test_it_ends_after_the_longest_run_time);
    RUN_TEST(test_the_operator_ends_it_with_a_fade_or_at_once);
    RUN_TEST(test_a_limit_of_the_guard_ends_it);
    RUN_TEST(test_with_a_small_distance_limit_it_is_brought_back_in_time);
    RUN_TEST(test_heave_stays_within_the_depths_of_the_guard);
    RUN_TEST(test_an_invalid_configuration_is_refused);
    RUN_TEST(test_calls_out_of_order_are_refused);
    return UNITY_END();
}
