/*
 * The node in lock step with the simulated vehicle, through frames in plain arrays.
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "by_residual.h"
#include "chain.h"
#include "dropper.h"
#include "node_run.h"

enum { SET_TICKS = 1500 };

static auvid_node_t other;
static auvid_actuation_t other_actuation;
static chain_t chain;

static void send(const auvid_can_message_t *m)
{
    auvid_can_frame_t frame;
    static auvid_can_sender_t operator;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&operator, NULL));
    operator.counter[m->kind] =(uint8_t)(vehicle_sim.sender.counter[m->kind]);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&operator, m, &frame));
    vehicle_sim.sender.counter[m->kind] = operator.counter[m->kind];
    (void)give(&frame);
}

static void order(uint32_t action)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_ARM};
    m.as.arm.action = action;
    m.as.arm.key = AUVID_CAN_ARM_KEY;
    send(&m);
}

static void abort_run(void)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_ABORT};
    m.as.abort.cause = AUVID_CAN_CAUSE_OPERATOR;
    send(&m);
}

/* Runs until the search over all sets has finished. */
static void identify(void)
{
    uint32_t limit = SETS * SET_TICKS + 6000;
    while (run.ticks < limit &&
           (node.id.metric.sets.recorded < SETS || node.id.work.phase != AUVID_WORK_IDLE ||
            node.id.work.searches == 0)) {
        tick();
    }
    TEST_ASSERT_TRUE(run.ticks < limit);
}

static double rms(const auvid_node_t *n)
{
    double sum = 0.0;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        double truth = vehicle_sim.sim.cfg.parameter[i];
        double e = (double)n->id.estimate.pi[i] / truth - 1.0;
        sum += e * e;
    }
    return sqrt(sum / SIM_PARAMETERS);
}

static void same_estimate(const auvid_node_t *a, const auvid_node_t *b)
{
    TEST_ASSERT_TRUE(a->id.estimate.number > 0);
    TEST_ASSERT_EQUAL_UINT32(a->id.estimate.number, b->id.estimate.number);
    TEST_ASSERT_EQUAL_MEMORY(a->id.estimate.pi, b->id.estimate.pi, sizeof a->id.estimate.pi);
    TEST_ASSERT_EQUAL_MEMORY(&a->id.estimate.confidence, &b->id.estimate.confidence,
                             sizeof a->id.estimate.confidence);
}

/* ---- identification ---- */

/* The seeds are the same, but the search draws other numbers: the ratio is not exactly 1. */
static void test_identification_through_frames_is_as_accurate_as_without(void)
{
    double with = 0.0, without = 0.0;
    for (uint64_t seed = 1; seed <= 30; ++seed) {
        chain_config_t direct;
        prepare(seed);
        begin(true);
        identify();
        with += rms(&node) * rms(&node);
        chain_defaults(&direct, seed, SETS, 0.0);
        TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &direct, SETS));
        (void)chain_finish(&chain, 1000, 6000);
        without += chain_mean_square(&chain);
    }
    printf("rms error of %d sets: %.2f %% through frames, %.2f %% without, 30 runs\n", SETS,
           100.0 * sqrt(with / 30.0), 100.0 * sqrt(without / 30.0));
    TEST_ASSERT_TRUE(sqrt(with / without) < 1.3);
}

static void test_the_same_frames_give_the_same_bits(void)
{
    begin(true);
    identify();
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.refused);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.samples_dropped);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.ticks_missed);
    TEST_ASSERT_EQUAL_UINT32(run.ticks, node.counters.ticks);
    TEST_ASSERT_EQUAL_UINT32(0, node.sender.saturated);
    TEST_ASSERT_EQUAL_UINT32(0, node.sender.refused);
    TEST_ASSERT_EQUAL(0, vehicle_sim.command.half[0].lost + vehicle_sim.command.half[1].lost);

    /* replay the same frames */
    uint32_t ticks = node.counters.ticks;
    TEST_ASSERT_TRUE(taken_count < LOG);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_node_init(&other, &config, &auvid_allocation_girona500, &identifier));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&other, &other_actuation, &acting));
    for (int i = 0; i < taken_count; ++i) {
        taken[i].t_us = draw(); /* at random times of arrival */
        if (auvid_node_take(&other, &taken[i]) == AUVID_TICK) {
            serve(&other);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(ticks, other.counters.ticks);
    same_estimate(&node, &other);
}

static void test_times_of_arrival_change_no_bit(void)
{
    begin(true);
    go(SET_TICKS / 3);
    other = node;
    setUp();
    run.random_arrival = true;
    begin(true);
    go(SET_TICKS / 3);
    TEST_ASSERT_EQUAL_MEMORY(&other.id.nav, &node.id.nav, sizeof node.id.nav);
    TEST_ASSERT_EQUAL_MEMORY(&other.id.recorder, &node.id.recorder, sizeof node.id.recorder);
    TEST_ASSERT_EQUAL_MEMORY(other.received, node.received, sizeof node.received);
}

static auvid_uncertain_t uncertain;
static auvid_uncertain_config_t inputs;

static auvid_status_t attach_uncertain(void)
{
    return auvid_node_attach_uncertain(&node, &uncertain, &inputs);
}

static void test_uncertain_inputs_that_do_not_fit_are_refused(void)
{
    auvid_uncertain_defaults(&inputs);
    memset(&node, 0, sizeof node);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, attach_uncertain());
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_attach_uncertain(NULL, &uncertain, &inputs));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_attach_uncertain(&node, &uncertain, NULL));
    begin(false);
    inputs.backward = -1;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, attach_uncertain());
    inputs.backward = (auvid_real_t)NAN;
    TEST_ASSERT_EQUAL(AUVID_ERR_NOT_FINITE, attach_uncertain());
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK, attach_uncertain());
    TEST_ASSERT_EQUAL(AUVID_ERR_ATTACHED, attach_uncertain());
    begin(false);
    go(100);
    TEST_ASSERT_EQUAL(AUVID_ERR_STARTED, attach_uncertain());

    auvid_allocation_config_t everywhere = auvid_allocation_girona500;
    everywhere.thrusters = AUVID_CAN_THRUSTERS;
    for (int i = 0; i < AUVID_CAN_THRUSTERS; ++i) {
        everywhere.thruster[i] = auvid_allocation_girona500.thruster[0];
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            everywhere.thruster[i].wrench[j] = 1; /* more columns than there is room for */
        }
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &config, &everywhere, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, attach_uncertain());

    static auvid_vehicle_t vehicle;
    static auvid_row_t rows[180];
    by_residual_surge(&identifier, &vehicle, rows, 2);
    begin(false);
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, attach_uncertain());
}

/* Without uncertain inputs, or the word that there are none, nothing is identifiable. */
static void test_uncertain_inputs_read_the_thrust_of_the_bus(void)
{
    auvid_uncertain_defaults(&inputs);
    identifier.exact_inputs = false;
    begin(true);
    TEST_ASSERT_EQUAL(AUVID_OK, attach_uncertain());
    identify();
    const auvid_estimate_t *with = auvid_identifier_estimate(&node.id);
    TEST_ASSERT_EQUAL_PTR(&uncertain.estimate, with);
    TEST_ASSERT_TRUE(node.id.estimate.confidence.unchecked);
    TEST_ASSERT_EQUAL_HEX32(0, node.id.estimate.confidence.identifiable);
    TEST_ASSERT_EQUAL(AUVID_NOTE_UNCHECKED, node.id.estimate.confidence.note[AUVID_G500_M_U]);
    TEST_ASSERT_FALSE(with->confidence.unchecked);
    for (int i = AUVID_G500_M_U; i <= AUVID_G500_M_R; ++i) {
        double truth = vehicle_sim.sim.cfg.parameter[i];
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * truth, truth, (double)with->pi[i]);
        TEST_ASSERT_TRUE((with->confidence.identifiable >> i & 1u) != 0);
    }
}

/* ---- thruster commands ---- */

static void test_a_passive_node_never_commands(void)
{
    begin(false);
    go(200);
    order(AUVID_CAN_ACTION_ARM);
    go(500);
    TEST_ASSERT_TRUE(vehicle_sim.navigates);
    TEST_ASSERT_EQUAL_UINT32(0, run.commands);
}

static void test_there_is_no_command_before_the_arm_frame(void)
{
    vehicle_sim.no_arm = true;
    begin(true);
    go(300);
    TEST_ASSERT_EQUAL_UINT32(0, run.commands);
    order(AUVID_CAN_ACTION_ARM);
    go(3);
    TEST_ASSERT_TRUE(run.commands > 0);
}

static void test_an_arm_frame_without_sensors_is_refused_and_discarded(void)
{
    vehicle_sim.no_arm = true;
    begin(true);
    order(AUVID_CAN_ACTION_ARM);
    go(200);
    TEST_ASSERT_EQUAL_UINT32(0, run.commands);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, actuation.guard.state);
    TEST_ASSERT_NOT_EQUAL(AUVID_GUARD_NO_CAUSE, actuation.guard.refused.cause);
}

static void test_an_abort_gives_one_command_of_zero_and_then_none(void)
{
    begin(true);
    go(500);
    TEST_ASSERT_TRUE(run.largest > 0.0);
    uint32_t before = run.commands;
    abort_run();
    tick();
    TEST_ASSERT_EQUAL_UINT32(before + 1, run.commands);
    TEST_ASSERT_TRUE(run.largest == 0.0);
    go(300);
    order(AUVID_CAN_ACTION_ARM); /* the abort is latched */
    go(100);
    TEST_ASSERT_EQUAL_UINT32(before + 1, run.commands);
}

static void test_an_abort_with_a_repeated_counter_is_obeyed(void)
{
    begin(true);
    go(400);
    abort_run();
    order(AUVID_CAN_ACTION_DISARM);
    tick();
    order(AUVID_CAN_ACTION_ARM);
    go(10);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, actuation.guard.state);
    vehicle_sim.sender.counter[AUVID_CAN_ABORT] =
        (vehicle_sim.sender.counter[AUVID_CAN_ABORT] + 15u) & 15u;
    abort_run();
    tick();
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, actuation.guard.state);
}

static void test_a_stop_fades_the_excitation_out(void)
{
    begin(true);
    go(500);
    order(AUVID_CAN_ACTION_STOP);
    uint32_t before = run.commands;
    tick();
    TEST_ASSERT_TRUE(run.largest > 0.0); /* not at once */
    go(500);
    TEST_ASSERT_TRUE(run.commands > before + 10);
    TEST_ASSERT_TRUE(run.largest == 0.0);
    TEST_ASSERT_NOT_EQUAL(AUVID_GUARD_EXCITING, actuation.guard.state);
    TEST_ASSERT_NOT_EQUAL(AUVID_GUARD_ABORTED, actuation.guard.state);
}

static void test_a_trip_of_the_guard_commands_zero(void)
{
    begin(true);
    go(500);
    vehicle_sim.sim.sensor[SIM_DVL].period_us = 1000000000u;
    vehicle_sim.sim.sensor[SIM_DVL].next_us = UINT64_MAX / 2;
    go(500);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, actuation.guard.state);
    TEST_ASSERT_EQUAL(AUVID_GUARD_VELOCITY_STALE, actuation.guard.trip.cause);
    TEST_ASSERT_TRUE(run.largest == 0.0);
    TEST_ASSERT_FALSE(vehicle_sim.commanded);
}

static void test_halt_commands_zero_once_and_only_after_a_command(void)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    int count = -1;
    begin(true);
    go(20);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_halt(&node, AUVID_GUARD_OPERATOR, frame, &count));
    TEST_ASSERT_EQUAL(0, count);
    setUp();
    begin(true);
    go(500);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_halt(&node, AUVID_GUARD_OPERATOR, frame, &count));
    TEST_ASSERT_EQUAL(2, count);
    deliver(frame, count);
    TEST_ASSERT_TRUE(run.largest == 0.0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_halt(&node, AUVID_GUARD_OPERATOR, frame, &count));
    TEST_ASSERT_EQUAL(0, count);
}

/* ---- frames that are refused ---- */

static void test_foreign_repeated_and_bad_frames_are_refused_and_counted(void)
{
    begin(false);
    go(100);
    uint32_t good = node.counters.frames;
    TEST_ASSERT_EQUAL_UINT32(taken_count, good);
    auvid_can_frame_t frame = taken[taken_count - 1]; /* a tick frame */
    TEST_ASSERT_EQUAL(AUVID_ERR_REPEATED, auvid_node_take(&node, &frame));
    frame.data[4] ^= 1u;
    TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_node_take(&node, &frame));
    frame = taken[taken_count - 1];
    frame.length = 7;
    TEST_ASSERT_EQUAL(AUVID_ERR_LENGTH, auvid_node_take(&node, &frame));
    frame.length = AUVID_CAN_BYTES;
    frame.id = auvid_can_id(NULL, AUVID_CAN_ARM);
    memset(frame.data, 0, sizeof frame.data); /* without the key */
    frame.data[0] = auvid_can_crc(frame.data, AUVID_CAN_ARM + 1);
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_node_take(&node, &frame));
    TEST_ASSERT_EQUAL_UINT32(4, node.counters.refused);
    const auvid_node_received_t *ticks = &node.received[auvid_can_node_kind(AUVID_CAN_TICK)],
                                *arm = &node.received[auvid_can_node_kind(AUVID_CAN_ARM)];
    TEST_ASSERT_EQUAL_UINT32(100, ticks->good);
    TEST_ASSERT_EQUAL_UINT32(3, ticks->refused);
    TEST_ASSERT_EQUAL_UINT32(1, arm->refused);
    frame.id = 0x123;
    TEST_ASSERT_EQUAL(AUVID_UNUSED, auvid_node_take(&node, &frame));
    TEST_ASSERT_EQUAL_UINT32(4, node.counters.refused);
    TEST_ASSERT_EQUAL_UINT32(good, node.counters.frames);
    go(10);
    TEST_ASSERT_EQUAL_UINT32(110, node.counters.ticks);
}

static void test_null_and_not_initialised_are_refused(void)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES] = {{0}};
    int count = 7;
    memset(&node, 0, sizeof node);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_take(&node, frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_step(&node, NULL, frame, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_report(&node, 0, frame, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_halt(&node, AUVID_GUARD_OPERATOR, frame, &count));
    TEST_ASSERT_EQUAL(0, count);
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_take(NULL, frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_step(&node, NULL, NULL, &count));
    begin(false);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_step(&node, NULL, frame, &count));
    auvid_allocation_config_t none = auvid_allocation_girona500;
    none.thrusters = 0;
    TEST_ASSERT_EQUAL(AUVID_ERR_SIZE, auvid_node_init(&node, &config, &none, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_take(&node, frame));
}

/* ---- numbers of the DBC ---- */

#define SAME(a, b) _Static_assert((int)(a) == (int)(b), #a)
SAME(AUVID_CAN_GUARD_DISARMED, AUVID_GUARD_DISARMED);
SAME(AUVID_CAN_GUARD_ARMED, AUVID_GUARD_ARMED);
SAME(AUVID_CAN_GUARD_EXCITING, AUVID_GUARD_EXCITING);
SAME(AUVID_CAN_GUARD_SETTLING, AUVID_GUARD_SETTLING);
SAME(AUVID_CAN_GUARD_DONE, AUVID_GUARD_DONE);
SAME(AUVID_CAN_GUARD_ABORTED, AUVID_GUARD_ABORTED);
SAME(AUVID_CAN_WORK_IDLE, AUVID_WORK_IDLE);
SAME(AUVID_CAN_WORK_PREPARE, AUVID_WORK_PREPARE);
SAME(AUVID_CAN_WORK_PREDICT, AUVID_WORK_PREDICT);
SAME(AUVID_CAN_WORK_COMPARE, AUVID_WORK_COMPARE);
SAME(AUVID_CAN_WORK_CHANGE_TEST, AUVID_WORK_CHANGE_TEST);
SAME(AUVID_CAN_WORK_MERGE, AUVID_WORK_MERGE);
SAME(AUVID_CAN_WORK_ASK, AUVID_WORK_ASK);
SAME(AUVID_CAN_WORK_COST, AUVID_WORK_COST);
SAME(AUVID_CAN_WORK_MEASURE, AUVID_WORK_MEASURE);
SAME(AUVID_CAN_WORK_LINEARISE, AUVID_WORK_LINEARISE);
SAME(AUVID_CAN_WORK_CONFIDENCE, AUVID_WORK_CONFIDENCE);
SAME(AUVID_CAN_CAUSE_OPERATOR, AUVID_GUARD_OPERATOR);
SAME(AUVID_CAN_CAUSE_NO_INPUT, AUVID_GUARD_NO_INPUT);
SAME(AUVID_CAN_CAUSE_TIME, AUVID_GUARD_TIME);
SAME(AUVID_CAN_CAUSE_TICK, AUVID_GUARD_TICK);
SAME(AUVID_CAN_CAUSE_LINK, AUVID_GUARD_LINK);
SAME(AUVID_CAN_CAUSE_IMU_STALE, AUVID_GUARD_IMU_STALE);
SAME(AUVID_CAN_CAUSE_VELOCITY_STALE, AUVID_GUARD_VELOCITY_STALE);
SAME(AUVID_CAN_CAUSE_DEPTH_STALE, AUVID_GUARD_DEPTH_STALE);
SAME(AUVID_CAN_CAUSE_ALTITUDE_STALE, AUVID_GUARD_ALTITUDE_STALE);
SAME(AUVID_CAN_CAUSE_APPLIED_STALE, AUVID_GUARD_APPLIED_STALE);
SAME(AUVID_CAN_CAUSE_DEPTH_MIN, AUVID_GUARD_DEPTH_MIN);
SAME(AUVID_CAN_CAUSE_DEPTH_MAX, AUVID_GUARD_DEPTH_MAX);
SAME(AUVID_CAN_CAUSE_ALTITUDE, AUVID_GUARD_ALTITUDE);
SAME(AUVID_CAN_CAUSE_ROLL, AUVID_GUARD_ROLL);
SAME(AUVID_CAN_CAUSE_PITCH, AUVID_GUARD_PITCH);
SAME(AUVID_CAN_CAUSE_SPEED, AUVID_GUARD_SPEED);
SAME(AUVID_CAN_CAUSE_YAW_RATE, AUVID_GUARD_YAW_RATE);
SAME(AUVID_CAN_CAUSE_DISTANCE, AUVID_GUARD_DISTANCE);
SAME(AUVID_CAN_CAUSE_RUN_TIME, AUVID_GUARD_RUN_TIME);
SAME(AUVID_CAN_CAUSE_SATURATION, AUVID_GUARD_SATURATION);
SAME(AUVID_CAN_CAUSE_FOREIGN_COMMAND, AUVID_GUARD_FOREIGN_COMMAND);
SAME(AUVID_CAN_CAUSE_NONE, AUVID_GUARD_NO_CAUSE);
SAME(AUVID_CAN_NOTE_NONE, AUVID_NOTE_NONE);
SAME(AUVID_CAN_NOTE_FIXED, AUVID_NOTE_FIXED);
SAME(AUVID_CAN_NOTE_NOT_EXCITED, AUVID_NOTE_NOT_EXCITED);
SAME(AUVID_CAN_NOTE_COMBINATION, AUVID_NOTE_COMBINATION);
SAME(AUVID_CAN_NOTE_SMALL, AUVID_NOTE_SMALL);
SAME(AUVID_CAN_NOTE_NOISE, AUVID_NOTE_NOISE);
SAME(AUVID_CAN_NOTE_UNCERTAIN, AUVID_NOTE_UNCERTAIN);
SAME(AUVID_CAN_NOTE_IMPLAUSIBLE, AUVID_NOTE_IMPLAUSIBLE);
SAME(AUVID_CAN_NOTE_AT_BOUND, AUVID_NOTE_AT_BOUND);
SAME(AUVID_CAN_NOTE_BESIDE_BOUND, AUVID_NOTE_BESIDE_BOUND);
SAME(AUVID_CAN_NOTE_NOT_CONVERGED, AUVID_NOTE_NOT_CONVERGED);
SAME(AUVID_CAN_NOTE_DISCREDITED, AUVID_NOTE_DISCREDITED);
SAME(AUVID_CAN_NOTE_THRUST_SCALE, AUVID_NOTE_THRUST_SCALE);
SAME(AUVID_CAN_NOTE_FEEDBACK, AUVID_NOTE_FEEDBACK);
SAME(AUVID_CAN_NOTE_UNCHECKED, AUVID_NOTE_UNCHECKED);
SAME(AUVID_CAN_NOTE_INPUTS, AUVID_NOTE_INPUTS);

static void test_the_configuration_may_be_inside_the_node(void)
{
    static auvid_node_t separate, inside;
    static auvid_identifier_config_t cfg;
    auvid_node_config_t bus;
    auvid_node_defaults(&bus);
    memset(&separate, 0xA5, sizeof separate);
    memset(&inside, 0x5A, sizeof inside);
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    inside.id.cfg = cfg;
    TEST_ASSERT_EQUAL_INT(AUVID_OK,
                          auvid_node_init(&separate, &bus, &auvid_allocation_girona500, &cfg));
    TEST_ASSERT_EQUAL_INT(
        AUVID_OK, auvid_node_init(&inside, &bus, &auvid_allocation_girona500, &inside.id.cfg));
    TEST_ASSERT_EQUAL_MEMORY(&separate, &inside, offsetof(auvid_node_t, id.cfg));
}

static void test_work_is_that_of_the_identifier(void)
{
    const auvid_real_t level[3] = {0, 0, 0};
    auvid_status_t status;
    identifier.listener = &dropper;
    begin(false);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_work(&node, 100));
    for (uint64_t t_us = 20000; t_us <= 20000000; t_us += 20000) {
        auvid_real_t s = (auvid_real_t)sin(1e-6 * (double)t_us);
        const auvid_real_t nu[AUVID_DOF_COUNT] = {s}, tau[AUVID_DOF_COUNT] = {100 * s};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&node.id, t_us, level, nu));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&node.id, t_us, tau, NULL));
    }
    TEST_ASSERT_EQUAL(AUVID_SET_COMPLETE, auvid_identifier_close(&node.id));
    TEST_ASSERT_EQUAL(AUVID_PENDING, auvid_node_work(&node, 0));
    do {
        status = auvid_node_work(&node, 100);
    } while (status == AUVID_PENDING);
    TEST_ASSERT_EQUAL(AUVID_ERR_NO_DATA, status);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_identification_through_frames_is_as_accurate_as_without);
    RUN_TEST(test_uncertain_inputs_that_do_not_fit_are_refused);
    RUN_TEST(test_uncertain_inputs_read_the_thrust_of_the_bus);
    RUN_TEST(test_the_same_frames_give_the_same_bits);
    RUN_TEST(test_times_of_arrival_change_no_bit);
    RUN_TEST(test_a_passive_node_never_commands);
    RUN_TEST(test_there_is_no_command_before_the_arm_frame);
    RUN_TEST(test_an_arm_frame_without_sensors_is_refused_and_discarded);
    RUN_TEST(test_an_abort_gives_one_command_of_zero_and_then_none);
    RUN_TEST(test_an_abort_with_a_repeated_counter_is_obeyed);
    RUN_TEST(test_a_stop_fades_the_excitation_out);
    RUN_TEST(test_a_trip_of_the_guard_commands_zero);
    RUN_TEST(test_halt_commands_zero_once_and_only_after_a_command);
    RUN_TEST(test_foreign_repeated_and_bad_frames_are_refused_and_counted);
    RUN_TEST(test_null_and_not_initialised_are_refused);
    RUN_TEST(test_the_configuration_may_be_inside_the_node);
    RUN_TEST(test_work_is_that_of_the_identifier);
    return UNITY_END();
}
