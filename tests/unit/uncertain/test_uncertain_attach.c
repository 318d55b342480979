/*
 * Uncertain inputs: what is refused when they are attached, and that they delay no set.
 */
#include <math.h>
#include <string.h>

#include "auvid/uncertain.h"
#include "by_residual.h"
#include "chain.h"
#include "uncertain/auvid_uncertain_table_internal.h"
#include "unity.h"

static chain_config_t cfg;
static chain_t chain;
static auvid_uncertain_config_t inputs;
static auvid_uncertain_t storage, unchanged;
static auvid_identifier_t before;

void setUp(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    memset(&chain, 0, sizeof chain);
    memset(&storage, 0, sizeof storage);
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &cfg.thrusters));
}

void tearDown(void)
{
}

static auvid_status_t attach(void)
{
    before = chain.id;
    auvid_status_t status =
        auvid_identifier_attach_uncertain(&chain.id, &storage, &inputs, &chain.allocation);
    if (status < 0) {
        TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    }
    return status;
}

/* A ring of fewer rows than a solution needs: 15 s. */
static void test_a_small_ring_has_solutions(void)
{
    chain_t *c = &chain;
    cfg.id.metric.sets = 1;
    cfg.id.metric.set_rows = 30;
    memset(c, 0, sizeof *c);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&c->id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&c->allocation, &cfg.thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    for (uint32_t k = 1; k < 1000; ++k) {
        static const auvid_real_t level[3] = {0};
        auvid_sample_t sample = {.t_us = 100000u * k};
        auvid_real_t wrench[AUVID_DOF_COUNT];
        auvid_allocation_result_t thrust;
        for (int j = 0; j < 2 * AUVID_DOF_COUNT; ++j) {
            int dof = j / 2;
            auvid_real_t w =
                AUVID_C(0.3) * (auvid_real_t)(1 + j % 2) + AUVID_C(0.11) * (auvid_real_t)dof;
            double phase = 0.1 * k * (double)w + dof;
            sample.nu[dof] += dof == 3 || dof == 4 ? 0 : AUVID_C(0.2) * (auvid_real_t)sin(phase);
            sample.nu_dot[dof] +=
                dof == 3 || dof == 4 ? 0 : AUVID_C(0.2) * w * (auvid_real_t)cos(phase);
        }
        auvid_vehicle_residual(&auvid_girona500, &sample, auvid_girona500_paper, wrench);
        (void)auvid_allocation_solve(&c->allocation, wrench, &thrust);
        (void)auvid_identifier_applied(&c->id, sample.t_us, thrust.wrench, thrust.force_N);
        (void)auvid_identifier_motion(&c->id, sample.t_us, level, sample.nu);
        (void)auvid_identifier_work(&c->id, 400);
    }
    TEST_ASSERT_TRUE(storage.estimate.number > 1);
    TEST_ASSERT_TRUE(fabs((double)storage.estimate.pi[0] - 250.0) < 25.0);
}

static void test_null_is_refused(void)
{
    const auvid_allocation_t *a = &chain.allocation;
    before = chain.id;
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_identifier_attach_uncertain(NULL, &storage, &inputs, a));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_identifier_attach_uncertain(&chain.id, NULL, &inputs, a));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_identifier_attach_uncertain(&chain.id, &storage, NULL, a));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL,
                      auvid_identifier_attach_uncertain(&chain.id, &storage, &inputs, NULL));
    TEST_ASSERT_EQUAL_MEMORY(&before, &chain.id, sizeof before);
    auvid_uncertain_defaults(NULL);
}

static void test_it_attaches_once_and_before_the_first_step_or_wrench(void)
{
    const auvid_real_t wrench[AUVID_DOF_COUNT] = {0};
    auvid_input_t in = {.t_us = 1};
    auvid_output_t out;
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    unchanged = storage;
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, attach());
    TEST_ASSERT_EQUAL_MEMORY(&unchanged, &storage, sizeof storage);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id)); /* detaches it */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, attach());
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, 1, wrench, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, attach());
    memset(&chain.id, 0, sizeof chain.id);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, attach());
}

static void test_a_prior_out_of_range_is_refused(void)
{
    inputs.sag = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, attach());
    auvid_uncertain_defaults(&inputs);
    inputs.backward = (auvid_real_t)-0.01;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, attach());
    TEST_ASSERT_EQUAL_STRING("backward", storage.refusal.field);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -0.01, (double)storage.refusal.value);
    auvid_uncertain_defaults(&inputs);
    inputs.nominal_lag_s = 0; /* it is divided by */
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, attach());
}

static void test_thrusters_that_are_not_initialised_are_refused(void)
{
    memset(&chain.allocation, 0, sizeof chain.allocation);
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, attach());
    TEST_ASSERT_EQUAL_STRING("thrusters", storage.refusal.field);
}

static auvid_real_t dead_band_of(auvid_real_t forward_N, auvid_real_t backward_N)
{
    auvid_allocation_config_t thrusters = cfg.thrusters;
    for (int i = 0; i < thrusters.thrusters; ++i) {
        thrusters.thruster[i].max_N = forward_N;
        thrusters.thruster[i].min_N = -backward_N;
    }
    setUp();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    storage.scale = 1;
    return auvid_uncertain_sigma(&storage, &chain.id.metric, AUVID_UNCERTAIN_DEAD_BAND,
                                 AUVID_SURGE);
}

static void test_the_dead_band_is_relative_to_the_largest_force_in_either_direction(void)
{
    auvid_real_t ahead = dead_band_of(150, 20), astern = dead_band_of(20, 150);
    TEST_ASSERT_TRUE(ahead > 0 && ahead == astern);
}

/* It depends on the thrusters, which set tau_max only when they are attached. */
/* Of surge: has it asymmetry and cross-flow drag if these are fixed? */
static void expect_drag_inputs(bool linear, double square, bool asymmetry, bool cross_flow)
{
    const auvid_metric_t *m = &chain.id.metric;
    cfg.id.metric.free &= ~(1u << AUVID_G500_X_U | 1u << AUVID_G500_X_UU);
    cfg.id.metric.free |= linear ? 1u << AUVID_G500_X_U : 0u;
    cfg.id.metric.fixed[AUVID_G500_X_UU] = (auvid_real_t)square;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    TEST_ASSERT_EQUAL(asymmetry, auvid_uncertain_has(&storage, m, INPUT_ASYMMETRY, AUVID_SURGE));
    TEST_ASSERT_EQUAL(cross_flow, auvid_uncertain_has(&storage, m, INPUT_CROSS_FLOW, AUVID_SURGE));
}

static void test_drag_that_is_fixed_has_its_uncertain_inputs_if_it_is_not_zero(void)
{
    expect_drag_inputs(true, 0.0, true, false);
    expect_drag_inputs(true, -100.0, true, true);
    expect_drag_inputs(false, -100.0, true, true);
    expect_drag_inputs(false, 0.0, false, false);
}

static void test_the_first_length_is_that_of_the_thrusters(void)
{
    auvid_allocation_config_t short_arms = cfg.thrusters;
    for (int i = 0; i < short_arms.thrusters; ++i) {
        short_arms.thruster[i].wrench[AUVID_YAW] *= AUVID_C(0.5);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &short_arms));
    memset(cfg.id.metric.tau_max, 0, sizeof cfg.id.metric.tau_max);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    const auvid_real_t *max = chain.id.metric.cfg.tau_max;
    double force = fmax(fmax((double)max[0], (double)max[1]), (double)max[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0 * (double)max[AUVID_YAW] / force,
                              (double)storage.half_length_m);
    TEST_ASSERT_TRUE(storage.half_length_m < AUVID_C(0.6));
}

static void test_more_columns_than_there_is_room_for_are_refused(void)
{
    auvid_allocation_config_t many = cfg.thrusters;
    many.thrusters = AUVID_MAX_THRUSTERS;
    for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            many.thruster[i].wrench[j] = 1; /* each acts in all DoF */
        }
        many.thruster[i].max_N = 1;
        many.thruster[i].gain_forward = 1;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &many));
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, attach());
    TEST_ASSERT_EQUAL_STRING("AUVID_MAX_UNCERTAIN", storage.refusal.field);
    TEST_ASSERT_TRUE(storage.refusal.value > storage.refusal.limit);
    TEST_ASSERT_TRUE(storage.refusal.limit == AUVID_MAX_UNCERTAIN);
}

#if AUVID_MAX_THRUSTERS >= 8
static void test_eight_thrusters_fit(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_allocation_init(&chain.allocation, &auvid_allocation_bluerov2_heavy));
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
}
#endif

static void test_a_model_of_the_residual_path_is_refused(void)
{
    static auvid_vehicle_t vehicle;
    static auvid_row_t rows[180];
    by_residual_surge(&cfg.id, &vehicle, rows, 2);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, attach());
}

static void expect_no_start(auvid_status_t status, const auvid_uncertain_t *known)
{
    static auvid_uncertain_t as_before;
    as_before = storage;
    TEST_ASSERT_EQUAL(status, auvid_uncertain_start(&storage, known));
    TEST_ASSERT_EQUAL_MEMORY(&as_before, &storage, sizeof storage);
}

static void test_it_starts_only_with_a_solution_for_the_same_columns(void)
{
    const auvid_real_t wrench[AUVID_DOF_COUNT] = {0};
    expect_no_start(AUVID_ERR_STATE, &unchanged); /* not attached */
    TEST_ASSERT_EQUAL(AUVID_OK, attach());
    unchanged = storage;
    unchanged.shared[AUVID_UNCERTAIN_LAG] = AUVID_C(0.1);
    expect_no_start(AUVID_ERR_NULL, NULL);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_uncertain_start(NULL, &unchanged));
    expect_no_start(AUVID_ERR_STATE, &unchanged); /* has no estimate */
    unchanged.estimate.number = 1;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_uncertain_start(&storage, &unchanged));
    TEST_ASSERT_TRUE(storage.shared[AUVID_UNCERTAIN_LAG] == AUVID_C(0.1));
    TEST_ASSERT_NULL(auvid_identifier_estimate(&chain.id));
    ++unchanged.code[0];
    expect_no_start(AUVID_ERR_MODEL, &unchanged);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, 1, wrench, NULL));
    expect_no_start(AUVID_ERR_STARTED, &unchanged);
}

/* Moves for 100 s, with a tick of this length and a DVL of 5 Hz. Returns the sets; *first_us: when
 * the first one was complete. */
static uint32_t sets_in_ticks_of(uint64_t tick_us, bool uncertain, uint64_t *first_us)
{
    *first_us = 0;
    setUp();
    if (uncertain) {
        TEST_ASSERT_EQUAL(AUVID_OK, attach());
    }
    for (uint64_t t_us = tick_us; t_us <= 100000000; t_us += tick_us) {
        double t = 1e-6 * (double)t_us;
        auvid_output_t out;
        auvid_input_t in = {.t_us = t_us,
                            .imu = {.present = true, .t_us = t_us},
                            .depth = {.present = true, .t_us = t_us, .depth_m = 5},
                            .gps = {.present = t_us == tick_us, .t_us = t_us},
                            .applied = {.present = true}};
        in.dvl.present = t_us % 200000 == 0;
        in.dvl.sample.t_us = t_us;
        in.dvl.sample.valid = AUVID_DVL_X | AUVID_DVL_Y | AUVID_DVL_Z;
        for (int i = 0; i < 3; ++i) {
            in.dvl.sample.velocity[i] = (auvid_real_t)(0.3 * sin((0.3 + 0.1 * i) * t));
            in.applied.wrench[i] = (auvid_real_t)(30.0 * sin((0.3 + 0.1 * i) * t + 1.0));
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&chain.id, &in, &out));
        (void)auvid_identifier_work(&chain.id, AUVID_DEFAULT_BUDGET);
        *first_us = chain.id.metric.sets.recorded > 0 && *first_us == 0 ? t_us : *first_us;
    }
    return chain.id.metric.sets.recorded;
}

/* The last cell of the first set is complete at 35 s. A cell waits for what the one before has left
 * to do; where ticks are as slow as cells, none waits. */
static void test_no_cell_is_lost_and_a_set_is_at_most_seven_ticks_later(void)
{
    const uint64_t complete_us = 35000000;
    const uint64_t tick_us[] = {10000, 20000, 50000, 100000, 200000};
    for (size_t k = 0; k < sizeof tick_us / sizeof tick_us[0]; ++k) {
        uint64_t with_us, without_us;
        uint32_t without = sets_in_ticks_of(tick_us[k], false, &without_us);
        TEST_ASSERT_EQUAL(3, without);
        TEST_ASSERT_EQUAL(without, sets_in_ticks_of(tick_us[k], true, &with_us));
        TEST_ASSERT_TRUE(with_us >= complete_us && with_us <= complete_us + 7 * tick_us[k]);
        TEST_ASSERT_TRUE(without_us >= complete_us && without_us <= complete_us + 5 * tick_us[k]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_small_ring_has_solutions);
    RUN_TEST(test_null_is_refused);
    RUN_TEST(test_it_attaches_once_and_before_the_first_step_or_wrench);
    RUN_TEST(test_a_prior_out_of_range_is_refused);
    RUN_TEST(test_thrusters_that_are_not_initialised_are_refused);
    RUN_TEST(test_the_dead_band_is_relative_to_the_largest_force_in_either_direction);
    RUN_TEST(test_drag_that_is_fixed_has_its_uncertain_inputs_if_it_is_not_zero);
    RUN_TEST(test_the_first_length_is_that_of_the_thrusters);
    RUN_TEST(test_more_columns_than_there_is_room_for_are_refused);
#if AUVID_MAX_THRUSTERS >= 8
    RUN_TEST(test_eight_thrusters_fit);
#endif
    RUN_TEST(test_a_model_of_the_residual_path_is_refused);
    RUN_TEST(test_it_starts_only_with_a_solution_for_the_same_columns);
    RUN_TEST(test_no_cell_is_lost_and_a_set_is_at_most_seven_ticks_later);
    return UNITY_END();
}
