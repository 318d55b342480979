/* A checkpoint with impossible values is refused, although its checksum is right. */
#include <math.h>

#include "checkpoint_case.h"
#include "search/auvid_line_search_directions_internal.h"
#include "identifier/auvid_identifier_internal.h"
#include "navigation/auvid_nav_internal.h"

/* As auvid_checkpoint_begin writes them if memory is damaged. */
static auvid_identifier_t good;
#define IMPOSSIBLE(assignment)                                                                     \
    other = good;                                                                                  \
    other.assignment;                                                                              \
    bytes = save(&other, saved, sizeof saved);                                                     \
    check_refused(AUVID_ERR_RANGE, saved, bytes)

static void check_good(void)
{
    bytes = save(&good, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_impossible_values_are_refused(void)
{
    init(&good);
    IMPOSSIBLE(work.phase = UINT8_MAX);
    IMPOSSIBLE(metric.rows.set.rows = SET_ROWS + 1);
    IMPOSSIBLE(metric.sets.set[3].exponent[0] = 100);
    IMPOSSIBLE(metric.sets.set[3].excited = 1); /* without a row */
    IMPOSSIBLE(metric.rows.set.factor[0][0] = AUVID_C(1e30));
    IMPOSSIBLE(nav.gps.count = 200);
    IMPOSSIBLE(nav.ekf.position[0] = (auvid_real_t)NAN);
    IMPOSSIBLE(estimate.pi[0] = (auvid_real_t)-INFINITY);
    IMPOSSIBLE(nav.ground.measured = 8);
    IMPOSSIBLE(nav.imu.past_next = 2 * AUVID_NAV_PAST);
    IMPOSSIBLE(nav.held.valid[1] = 8);
    IMPOSSIBLE(nav.held.sensors = 1); /* before the first tick */
    IMPOSSIBLE(metric.rows.missing[0][1] = 64);
    IMPOSSIBLE(metric.rows.successive[0] = AUVID_METRIC_LAGS + 1);
    IMPOSSIBLE(metric.evaluator.window_of[0] = AUVID_METRIC_WINDOW + 1);
    IMPOSSIBLE(metric.rows.set.rows_of[0] = 1);    /* of no row */
    IMPOSSIBLE(metric.sets.set[3].number = 1);     /* none was recorded */
    IMPOSSIBLE(metric.sets.set[3].windows[0] = 1); /* of no row */
    IMPOSSIBLE(metric.sets.from = 1);              /* the ring is not held */
    IMPOSSIBLE(metric.sets.least = 1);
    IMPOSSIBLE(metric.sets.full = true);
    IMPOSSIBLE(metric.sets.changed = true);
    IMPOSSIBLE(metric.sets.held = true); /* no work is under way */
    IMPOSSIBLE(metric.sets.waiting = AUVID_MAX_SETS + 1);
    IMPOSSIBLE(metric.evaluator.sets_merged = AUVID_MAX_SETS + 1);
    IMPOSSIBLE(work.untested = 1);
    IMPOSSIBLE(work.active = 1u << 31);
    IMPOSSIBLE(work.searching = true);
    IMPOSSIBLE(work.neighbours = 1); /* of no search */
    IMPOSSIBLE(estimate.speed[0][0] = -1);
    IMPOSSIBLE(estimate.confidence.lost[0] = 101);
    IMPOSSIBLE(estimate.confidence.note[0] = AUVID_NOTE_COUNT);
    IMPOSSIBLE(estimate.confidence.thrust_error[0] = AUVID_C(2e18));
    IMPOSSIBLE(estimate.confidence.dvl_error[0] = (auvid_real_t)NAN);
    IMPOSSIBLE(estimate.confidence.uncertainty.thrust_scale = AUVID_C(1.1));
    IMPOSSIBLE(estimate.covariance[0] = AUVID_C(2e37));
    check_good();
}

static void test_impossible_values_of_the_acting_half_are_refused(void)
{
    static auvid_actuation_t before;
    static auvid_adaptive_t adaptive;
    auvid_adaptive_config_t plan;
    auvid_adaptive_defaults(&plan);
    plan.amplitude[AUVID_SURGE] = 100;
    init_acting();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_adaptive_begin(&id, &adaptive, &plan, NULL));
    before = actuation;
    for (int k = 0; k < 6; ++k) {
        actuation = before;
        actuation.guard.state = k == 0 ? (auvid_guard_state_t)17 : before.guard.state;
        adaptive.low_owed[0] = k == 1 ? AUVID_C(2e9) : 0;
        actuation.altitude_m = k == 2 ? -1 : 0;
        actuation.home[1] = k == 3 ? (auvid_real_t)NAN : 0;
        actuation.excitation.displacement[2] = k == 4 ? (auvid_real_t)INFINITY : 0;
        bytes = save(&id, saved, sizeof saved);
        actuation = before;
        adaptive.low_owed[0] = 0;
        if (k < 5) {
            check_refused(AUVID_ERR_RANGE, saved, bytes);
            TEST_ASSERT_EQUAL_MEMORY(&before, &actuation, sizeof before);
        }
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_a_note_that_names_no_parameter_is_refused(void)
{
    static auvid_vehicle_t vehicle; /* with fewer parameters than there is room for */
    vehicle = auvid_girona500;
    --vehicle.parameters;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        vehicle.columns[j] &= ~(1u << vehicle.parameters);
    }
    vehicle.free &= ~(1u << vehicle.parameters);
    cfg.vehicle = &vehicle;
    init(&id);
    init(&good);
    good.estimate.confidence.note[0] = AUVID_NOTE_BESIDE_BOUND;
    change.accepted.confidence.note[0] = AUVID_NOTE_COMBINATION;
    IMPOSSIBLE(estimate.confidence.partner[0] = vehicle.parameters);
    IMPOSSIBLE(attached.change->accepted.confidence.partner[0] = vehicle.parameters);
    change.accepted.confidence.partner[0] = 0;
    IMPOSSIBLE(attached.change->suspected = 1u << AUVID_DOF_COUNT);
    change.suspected = 0;
    good.estimate.confidence.note[0] = AUVID_NOTE_DISCREDITED;
    IMPOSSIBLE(estimate.confidence.partner[0] = vehicle.parameters);
    check_good();
}

/* The recorder's ring does not reach from its oldest cell to the newest: a walk through it would
 * take hours. */
static void test_a_record_of_too_many_cells_is_refused(void)
{
    move_from_to(&id, 1, 9);
    TEST_ASSERT_TRUE(id.recorder.running);
    good = id;
    IMPOSSIBLE(recorder.next = 0);
    IMPOSSIBLE(recorder.next = UINT32_MAX);
    IMPOSSIBLE(recorder.opened = good.recorder.next + AUVID_RECORDER_CELLS);
    IMPOSSIBLE(recorder.stream[0].cell = UINT32_MAX);
    IMPOSSIBLE(recorder.stream[4].valid = false);
    IMPOSSIBLE(recorder.measured[15] = 8);
    IMPOSSIBLE(recorder.velocity_us = 0);
    IMPOSSIBLE(recorder.cell_us = 200000);
    IMPOSSIBLE(metric.result.doublings = 1);
    IMPOSSIBLE(metric.result.doublings = 32);
    IMPOSSIBLE(metric.evaluator.noise = 4);
    IMPOSSIBLE(recorder.velocity_us = 1000001);
    IMPOSSIBLE(recorder.intervals = AUVID_RECORDER_INTERVALS);
    IMPOSSIBLE(recorder.interval_us[6] = 1000001);
    IMPOSSIBLE(recorder.gap_us = 0);
    check_good();
}

/* Work until this phase, a few units at a time. */
static void move_to_phase(uint8_t phase)
{
    for (int cell = 1; cell < CELLS && id.work.phase != phase; ++cell) {
        record(&id, cell);
        for (int k = 0; k < BUDGET && id.work.phase != phase; ++k) {
            (void)auvid_identifier_work(&id, 10);
        }
    }
    TEST_ASSERT_EQUAL(phase, id.work.phase);
    good = id;
}

static void test_an_impossible_optimum_is_refused(void)
{
    move_to_phase(AUVID_WORK_MERGE);
    for (int k = 0; k < 100000 && good.work.spent != WORK_OPTIMUM; ++k) {
        (void)auvid_identifier_work(&good, 1);
    }
    TEST_ASSERT_EQUAL(AUVID_WORK_MERGE, good.work.phase);
    TEST_ASSERT_TRUE(good.optimum.n > 1);
    IMPOSSIBLE(optimum.n = 0);
    IMPOSSIBLE(optimum.n = (uint8_t)(good.optimum.n - 1));
    IMPOSSIBLE(optimum.order[0] = good.optimum.n);
    IMPOSSIBLE(optimum.fixed_from = (uint8_t)(good.optimum.n + 1));
    IMPOSSIBLE(optimum.at = (uint8_t)(good.optimum.n + 2));
    IMPOSSIBLE(optimum.changes = UINT8_MAX);
    IMPOSSIBLE(optimum.dof = AUVID_DOF_COUNT + 1);
    IMPOSSIBLE(optimum.row = UINT8_MAX);
    IMPOSSIBLE(optimum.x[0] = good.optimum.upper[0] + 1);
    IMPOSSIBLE(optimum.qr_factor[0] = (auvid_real_t)NAN);
    IMPOSSIBLE(work.active = 0);
    IMPOSSIBLE(metric.sets.held = false);
    IMPOSSIBLE(metric.sets.waiting = 1); /* it would not be used */
    check_good();
}

/* Directions are made conjugate by probes along the directions before. On the regressor path only
 * if the certificate is wrong. */
static void test_a_probe_along_a_direction_not_before_its_own_is_refused(void)
{
    const auvid_line_search_t *search = &good.optimizer.line_search;
    move_to_phase(AUVID_WORK_COST);
    good.optimizer.least = AUVID_C(1.0);
    for (int k = 0; k < 100000 && !(good.optimizer.state == AUVID_OPTIMIZER_LOCAL &&
                                    search->move == MOVE_PROBE && good.optimizer.asked);
         ++k) {
        (void)auvid_identifier_work(&good, 1);
    }
    TEST_ASSERT_EQUAL(MOVE_PROBE, search->move);
    TEST_ASSERT_TRUE(good.optimizer.asked);
    TEST_ASSERT_TRUE(search->probe < search->direction / 2);
    IMPOSSIBLE(optimizer.line_search.probe = (uint8_t)(search->direction / 2));
    IMPOSSIBLE(optimizer.line_search.probe = (uint8_t)(good.optimizer.cfg.n - 1));
    IMPOSSIBLE(optimizer.line_search.direction = 0);
    check_good();
}

static void test_sets_that_contradict_the_phase_of_work_are_refused(void)
{
    move_to_phase(AUVID_WORK_PREDICT); /* of the first estimate, by the next set */
    TEST_ASSERT_EQUAL(1, good.work.untested);
    IMPOSSIBLE(work.untested = 0);
    IMPOSSIBLE(work.untested = 2);
    IMPOSSIBLE(metric.sets.from = 1);
    IMPOSSIBLE(metric.sets.full = true); /* with a regressor */
    IMPOSSIBLE(metric.evaluator.at.to_set = AUVID_MAX_SETS + 1);
    IMPOSSIBLE(metric.sets.set[0].rows_of[0] = SET_ROWS + 1);
    IMPOSSIBLE(metric.sets.set[0].rows_of[0] = 0); /* of an excited DoF */
    check_good();
}

static void test_a_prediction_of_more_cells_than_there_were_is_refused(void)
{
    init_predicting(&id);
    for (int cell = 1; cell < CELLS && id.estimate.number == 0; ++cell) {
        move(&id, cell);
    }
    TEST_ASSERT_NOT_NULL(prediction.vehicle);
    ++prediction.compared[0];
    bytes = save(&id, saved, sizeof saved);
    --prediction.compared[0];
    check_refused(AUVID_ERR_RANGE, saved, bytes);
    bytes = save(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
}

static void test_a_held_sample_not_ahead_of_the_imu_is_refused(void)
{
    const auvid_real_t still[3] = {0};
    const auvid_dvl_sample_t ahead = {.t_us = 200000, .valid = AUVID_DVL_ALL};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_imu(&id.nav, 100000, still, still));
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_nav_dvl(&id.nav, &ahead));
    good = id;
    IMPOSSIBLE(nav.held.t_us[AUVID_NAV_DVL_BOTTOM] = 100000);
    IMPOSSIBLE(nav.held.t_us[AUVID_NAV_DVL_BOTTOM] = 100001 + good.nav.cfg.max_age_us[0]);
    IMPOSSIBLE(nav.held.value[AUVID_NAV_DVL_BOTTOM][0] = AUVID_C(1e6));
    check_good();
}

static void test_an_identifier_without_the_filter_is_restored_without_it(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init_motion(&id, &cfg));
    move_from_to(&id, 0, 30);
    bytes = save(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init_motion(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&id, saved, bytes));
    id.nav.imu.ready = NAV_READY; /* damaged */
    bytes = save(&id, saved, sizeof saved);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init_motion(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_checkpoint_restore(&id, saved, bytes));
    init(&id);
    init(&good);
    IMPOSSIBLE(nav.imu.ready = NAV_BLANK);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_impossible_values_are_refused);
    RUN_TEST(test_impossible_values_of_the_acting_half_are_refused);
    RUN_TEST(test_a_note_that_names_no_parameter_is_refused);
    RUN_TEST(test_a_record_of_too_many_cells_is_refused);
    RUN_TEST(test_an_impossible_optimum_is_refused);
    RUN_TEST(test_a_probe_along_a_direction_not_before_its_own_is_refused);
    RUN_TEST(test_sets_that_contradict_the_phase_of_work_are_refused);
    RUN_TEST(test_a_prediction_of_more_cells_than_there_were_is_refused);
    RUN_TEST(test_a_held_sample_not_ahead_of_the_imu_is_refused);
    RUN_TEST(test_an_identifier_without_the_filter_is_restored_without_it);
    return UNITY_END();
}
