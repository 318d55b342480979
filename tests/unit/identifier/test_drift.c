/*
 * Drift since the first accepted estimate. Campaigns of vehicles that drift are in
 * tests/program/test_drift.sh.
 */
#include <string.h>

#include "chain.h"
#include "unity.h"

enum { SETS = 11, FIRST_SET = 6, MASS = 0, DRAG = 1 };

static chain_t chain;
static chain_config_t cfg;
static bool loaded;
static uint8_t closed; /* bit j: DoF j, as the identifier is told */

/* Of each set, when it was validated. */
static struct {
    uint32_t events;
    bool has_first;
    uint8_t drifted;
    auvid_real_t drift[AUVID_DOF_COUNT];
} seen[SETS + 2];

/* What is changed in the reference after set 8, to what the estimates have drifted from. */
typedef void (*edit_t)(auvid_change_detector_t *detector);

void setUp(void)
{
    memset(seen, 0, sizeof seen);
    loaded = false;
    closed = 0;
    chain_defaults(&cfg, 51, SETS, 1.0);
    cfg.budget = 2000;
}

void tearDown(void)
{
}

static void note(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    const auvid_identifier_t *id = &c->id;
    uint32_t set = id->change_test.set;
    TEST_ASSERT_EQUAL(AUVID_OK, status);
    c->id.metric.cfg.closed_loop = closed;
    seen[set].events |= out->events;
    if (out->events & AUVID_EVENT_VALIDATED) {
        seen[set].has_first = id->attached.change->first.variance[MASS][AUVID_SURGE] > AUVID_C(0.0);
        seen[set].drifted = id->change_test.drifted;
        memcpy(seen[set].drift, id->change_test.drift, sizeof seen[set].drift);
        if (set == 8 && c->cfg.context != NULL) {
            (*(edit_t *)c->cfg.context)(id->attached.change);
        }
    }
}

static void run(edit_t *edit)
{
    cfg.after = note;
    cfg.context = edit;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, SETS));
    TEST_ASSERT_TRUE(seen[SETS].events & AUVID_EVENT_VALIDATED);
}

static void test_the_first_accepted_estimate_of_five_sets_is_the_reference(void)
{
    run(NULL);
    for (uint32_t set = 2; set <= SETS; ++set) {
        TEST_ASSERT_EQUAL(set >= FIRST_SET, seen[set].has_first);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            TEST_ASSERT_EQUAL(set > FIRST_SET && (0x27 >> j & 1) != 0,
                              seen[set].drift[j] > AUVID_C(0.0));
        }
    }
    const auvid_drift_reference_t *first = &chain.change.first;
    const auvid_estimate_t *e = &chain.id.estimate;
    auvid_drag_t drag;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(e, &auvid_girona500, AUVID_SURGE,
                                                    first->speed[AUVID_SURGE], &drag));
    TEST_ASSERT_TRUE(first->speed[AUVID_SURGE] < AUVID_C(0.7) * e->speed[AUVID_SURGE][0]);
    TEST_ASSERT_FLOAT_WITHIN(0.05 * (double)-drag.force, (double)drag.force,
                             (double)first->value[DRAG][AUVID_SURGE]);
    TEST_ASSERT_FLOAT_WITHIN(0.05 * 250, (double)e->pi[AUVID_G500_M_U],
                             (double)first->value[MASS][AUVID_SURGE]);
}

static void test_a_constant_vehicle_does_not_drift(void)
{
    run(NULL);
    for (uint32_t set = 1; set <= SETS; ++set) {
        TEST_ASSERT_FALSE(seen[set].events & AUVID_EVENT_DRIFTED);
        TEST_ASSERT_EQUAL_HEX8(0, seen[set].drifted);
    }
}

static void lighter_in_sway(auvid_change_detector_t *detector)
{
    detector->first.value[MASS][AUVID_SWAY] *= AUVID_C(0.85);
}

static void less_drag_in_yaw(auvid_change_detector_t *detector)
{
    detector->first.value[DRAG][AUVID_YAW] *= AUVID_C(0.85);
}

/* The event comes once, the verdict with each set. Estimates and sets stay. */
static void assert_drift_of(edit_t edit, auvid_dof_t dof)
{
    memset(seen, 0, sizeof seen);
    run(&edit);
    for (uint32_t set = 1; set <= SETS; ++set) {
        TEST_ASSERT_EQUAL(set == 9, (seen[set].events & AUVID_EVENT_DRIFTED) != 0);
        TEST_ASSERT_EQUAL_HEX8(set >= 9 ? AUVID_DOF_BIT(dof) : 0u, seen[set].drifted);
        TEST_ASSERT_EQUAL(set >= 9, seen[set].drift[dof] > AUVID_C(1.0));
        TEST_ASSERT_FALSE(seen[set].events & AUVID_EVENT_CHANGED);
    }
    TEST_ASSERT_EQUAL(8, chain.id.estimate.confidence.sets);
}

static void test_another_mass_or_drag_force_is_a_drift_of_its_degree_of_freedom(void)
{
    assert_drift_of(lighter_in_sway, AUVID_SWAY);
    assert_drift_of(less_drag_in_yaw, AUVID_YAW);
}

/* Each by itself is below the limit. */
static void less_drag(auvid_change_detector_t *detector)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_drift_reference_t *first = &detector->first;
        first->variance[MASS][j] = AUVID_C(0.0);
        first->value[DRAG][j] *= AUVID_C(0.8);
        first->variance[DRAG][j] = AUVID_C(0.0025) * first->value[DRAG][j] * first->value[DRAG][j];
    }
}

static void test_a_degree_of_freedom_in_closed_loop_is_left_out(void)
{
    edit_t edit = lighter_in_sway;
    closed = AUVID_DOF_BIT(AUVID_SWAY);
    run(&edit);
    TEST_ASSERT_EQUAL_HEX8(0, seen[SETS].drifted);
    TEST_ASSERT_TRUE(seen[SETS].drift[AUVID_SURGE] > AUVID_C(0.0));
    assert_drift_of(less_drag_in_yaw, AUVID_YAW);
}

static void test_the_same_change_of_all_drag_forces_counts_together(void)
{
    edit_t edit = less_drag;
    run(&edit);
    int above = 0, near = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        above += seen[9].drift[j] > AUVID_C(1.0);
        near += seen[9].drift[j] > AUVID_C(0.5) && seen[9].drift[j] < AUVID_C(1.0);
    }
    TEST_ASSERT_EQUAL(1, above);
    TEST_ASSERT_EQUAL(3, near);
    TEST_ASSERT_TRUE(seen[9].events & AUVID_EVENT_DRIFTED);
}

/* As if the first estimate had not known them. */
static void unknown(auvid_change_detector_t *detector)
{
    lighter_in_sway(detector);
    less_drag_in_yaw(detector);
    detector->first.variance[MASS][AUVID_SWAY] = AUVID_C(0.0);
    detector->first.variance[DRAG][AUVID_YAW] = AUVID_C(0.0);
}

static void test_what_the_first_estimate_did_not_know_begins_with_the_next(void)
{
    edit_t edit = unknown;
    run(&edit);
    TEST_ASSERT_FALSE(seen[9].events & AUVID_EVENT_DRIFTED);
    TEST_ASSERT_TRUE(chain.change.first.variance[MASS][AUVID_SWAY] > AUVID_C(0.0));
    TEST_ASSERT_TRUE(chain.change.first.variance[DRAG][AUVID_YAW] > AUVID_C(0.0));
}

/* Heavier, with more drag, from set 10 on. */
static void payload(chain_t *c, auvid_input_t *in)
{
    double *parameter = c->sim.cfg.parameter;
    (void)in;
    if (c->id.metric.sets.recorded == 9 && !loaded) {
        loaded = true;
        for (int i = 0; i < SIM_PARAMETERS; ++i) {
            parameter[i] *= i == SIM_WB ? 1.0 : 1.3;
        }
    }
}

static void test_after_a_change_there_is_no_reference_and_no_drift(void)
{
    edit_t edit = lighter_in_sway;
    cfg.before = payload;
    run(&edit);
    TEST_ASSERT_TRUE(seen[9].drifted != 0);
    TEST_ASSERT_TRUE(seen[10].events & AUVID_EVENT_CHANGED);
    TEST_ASSERT_EQUAL_HEX8(0, seen[10].drifted);
    TEST_ASSERT_FALSE(seen[10].has_first);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_TRUE(seen[10].drift[j] == AUVID_C(0.0));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_first_accepted_estimate_of_five_sets_is_the_reference);
    RUN_TEST(test_a_constant_vehicle_does_not_drift);
    RUN_TEST(test_another_mass_or_drag_force_is_a_drift_of_its_degree_of_freedom);
    RUN_TEST(test_a_degree_of_freedom_in_closed_loop_is_left_out);
    RUN_TEST(test_the_same_change_of_all_drag_forces_counts_together);
    RUN_TEST(test_what_the_first_estimate_did_not_know_begins_with_the_next);
    RUN_TEST(test_after_a_change_there_is_no_reference_and_no_drift);
    return UNITY_END();
}
