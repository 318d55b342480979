/*
 * Arm, disarm, stop and abort with any counter; commands of other nodes; the node's own clock.
 * Frames in plain arrays. Each test starts from a copy of a prepared state.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/node.h"
#include "vehicle_sim.h"
#include "unity.h"

enum { NAVIGATED = 100, EXCITED = 150 };

/* A node with its vehicle, and its commands of the last tick. */
typedef struct {
    auvid_node_t node;
    auvid_actuation_t actuation;
    vehicle_sim_t vehicle_sim;
    auvid_can_frame_t sent[AUVID_NODE_COMMANDS];
    int count;
    double largest; /* thrust */
} pair_t;

static pair_t idle, exciting; /* prepared once */
static pair_t now, other;
static auvid_can_sender_t operator;

static void configure(pair_t *p, uint64_t seed, bool excite)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    static auvid_identifier_config_t identifier;
    static auvid_actuation_config_t acting;
    auvid_node_config_t cfg;
    vehicle_sim_config_t vehicle;
    memset(p, 0, sizeof *p);
    vehicle_sim_defaults(&vehicle);
    vehicle.no_arm = true;
    TEST_ASSERT_TRUE(vehicle_sim_init(&p->vehicle_sim, &vehicle));
    auvid_identifier_defaults(&identifier, &auvid_girona500);
    auvid_actuation_defaults(&acting);
    (void)auvid_excitation_plan(&acting.excitation, amplitude, 30, 2, seed);
    auvid_node_defaults(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_node_init(&p->node, &cfg, &auvid_allocation_girona500, &identifier));
    if (excite) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&p->node, &p->actuation, &acting));
    }
}

static void copy(pair_t *to, const pair_t *from)
{
    *to = *from;
    to->node.id.actuation = from->node.id.actuation == NULL ? NULL : &to->actuation;
}

/* Passes the commands to the vehicle. */
static void deliver(pair_t *p)
{
    p->largest = 0.0;
    for (int i = 0; i < p->count; ++i) {
        auvid_can_message_t m;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &p->sent[i], &m));
        for (int k = 0; k < 4; ++k) { /* b has the same layout */
            p->largest = fmax(p->largest, fabs((double)m.as.thruster_command_a.thrust[k]));
        }
        vehicle_sim_take(&p->vehicle_sim, &p->sent[i]);
    }
}

static void tick(pair_t *p)
{
    auvid_can_frame_t frame[VEHICLE_SIM_FRAMES];
    int count = vehicle_sim_tick(&p->vehicle_sim, frame);
    for (int i = 0; i < count; ++i) {
        if (auvid_node_take(&p->node, &frame[i]) == AUVID_TICK) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&p->node, NULL, p->sent, &p->count));
        }
    }
    deliver(p);
}

static void go(pair_t *p, int ticks)
{
    for (int k = 0; k < ticks; ++k) {
        tick(p);
    }
}

/* A frame of the operator; its counter increases. */
static auvid_can_frame_t order_frame(uint32_t action, unsigned counter)
{
    auvid_can_frame_t frame;
    auvid_can_message_t m = {.kind = AUVID_CAN_ARM};
    m.as.arm.action = action;
    m.as.arm.key = AUVID_CAN_ARM_KEY;
    operator.counter[AUVID_CAN_ARM] =(uint8_t)(counter % 16u);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&operator, & m, &frame));
    return frame;
}

static auvid_status_t order(pair_t *p, uint32_t action, unsigned counter)
{
    auvid_can_frame_t frame = order_frame(action, counter);
    return auvid_node_take(&p->node, &frame);
}

static void abort_run(pair_t *p)
{
    auvid_can_frame_t frame;
    auvid_can_message_t m = {.kind = AUVID_CAN_ABORT};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&operator, & m, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_take(&p->node, &frame));
}

static auvid_guard_state_t state(const pair_t *p)
{
    return p->actuation.guard.state;
}

static auvid_guard_cause_t cause(const pair_t *p)
{
    return p->actuation.guard.trip.cause;
}

void setUp(void)
{
    if (exciting.node.ready) {
        return;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&operator, NULL));
    configure(&idle, 1, true);
    go(&idle, NAVIGATED);
    copy(&exciting, &idle);
    TEST_ASSERT_EQUAL(AUVID_OK, order(&exciting, AUVID_CAN_ACTION_ARM, 0));
    go(&exciting, EXCITED);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&exciting));
    TEST_ASSERT_TRUE(exciting.largest > 0.0);
}

void tearDown(void)
{
}

/* ---- disarm and stop with any counter ---- */

/* Counter of the last authentic arm frame taken by the node. */
#define LAST 9u

typedef enum { IDLE, PENDING, EXCITING, STOPPING, ABORTED, AFTER_BREACH, SITUATIONS } situation_t;

/* Sends arm frames up to the counter LAST, then prepares the situation. */
static void reach(situation_t situation)
{
    copy(&now, situation <= PENDING ? &idle : &exciting);
    TEST_ASSERT_NOT_EQUAL(AUVID_UNUSED, order(&now, AUVID_CAN_ACTION_ARM, LAST - 1u));
    now.node.arming = false; /* the situation has no pending arm frame */
    if (situation == PENDING) {
        TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, LAST));
        return;
    }
    if (situation == STOPPING) {
        TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_STOP, LAST));
        tick(&now);
        return;
    }
    (void)order(&now, AUVID_CAN_ACTION_ARM, LAST);
    now.node.arming = false;
    if (situation == ABORTED) {
        abort_run(&now);
        tick(&now);
    } else if (situation == AFTER_BREACH) {
        auvid_guard_t *guard = &now.actuation.guard;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_abort_for(guard, now.node.t_us, AUVID_GUARD_ROLL));
        tick(&now);
    }
}

typedef struct {
    auvid_guard_state_t state; /* after the frame and a tick */
    auvid_guard_cause_t cause;
} wanted_t;

static const wanted_t after_fresh_disarm = {AUVID_GUARD_DISARMED, AUVID_GUARD_NO_CAUSE};

/* By situation: after a disarm that is repeated or jumped, and after any stop. */
static const wanted_t after_stale_disarm[SITUATIONS] = {
    {AUVID_GUARD_DISARMED, AUVID_GUARD_NO_CAUSE}, {AUVID_GUARD_DISARMED, AUVID_GUARD_NO_CAUSE},
    {AUVID_GUARD_ABORTED, AUVID_GUARD_OPERATOR},  {AUVID_GUARD_ABORTED, AUVID_GUARD_OPERATOR},
    {AUVID_GUARD_ABORTED, AUVID_GUARD_OPERATOR},  {AUVID_GUARD_ABORTED, AUVID_GUARD_ROLL}};
static const wanted_t after_stop[SITUATIONS] = {
    {AUVID_GUARD_DISARMED, AUVID_GUARD_NO_CAUSE}, {AUVID_GUARD_DISARMED, AUVID_GUARD_NO_CAUSE},
    {AUVID_GUARD_EXCITING, AUVID_GUARD_NO_CAUSE}, {AUVID_GUARD_EXCITING, AUVID_GUARD_NO_CAUSE},
    {AUVID_GUARD_ABORTED, AUVID_GUARD_OPERATOR},  {AUVID_GUARD_ABORTED, AUVID_GUARD_ROLL}};

static void check_order(situation_t situation, uint32_t action, unsigned step, int copies)
{
    char where[100];
    (void)snprintf(where, sizeof where, "situation %d, action %u, counter + %u, %d copies",
                   (int)situation, (unsigned)action, step, copies);
    reach(situation);
    uint32_t refused = now.node.counters.refused;
    for (int k = 0; k < copies; ++k) { /* a copy is a repeated frame */
        TEST_ASSERT_EQUAL_MESSAGE(AUVID_OK, order(&now, action, LAST + step), where);
    }
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(refused, now.node.counters.refused, where);
    tick(&now);
    const bool fresh = step >= 1 && step <= AUVID_CAN_LARGEST_STEP;
    const wanted_t *wanted = action == AUVID_CAN_ACTION_STOP ? &after_stop[situation]
                             : fresh                         ? &after_fresh_disarm
                                                             : &after_stale_disarm[situation];
    TEST_ASSERT_EQUAL_MESSAGE(wanted->state, state(&now), where);
    TEST_ASSERT_EQUAL_MESSAGE(wanted->cause, cause(&now), where);
    if (wanted->state == AUVID_GUARD_EXCITING) {
        TEST_ASSERT_TRUE_MESSAGE(now.actuation.excitation.stopping, where);
        return;
    }
    TEST_ASSERT_EQUAL_MESSAGE(situation == EXCITING || situation == STOPPING ? 2 : 0, now.count,
                              where); /* one command of zero, if it commanded */
    TEST_ASSERT_TRUE_MESSAGE(now.largest == 0.0, where);
    tick(&now);
    TEST_ASSERT_EQUAL_MESSAGE(0, now.count, where);
}

static void test_disarm_and_stop_take_thrust_away_with_any_counter(void)
{
    for (int situation = IDLE; situation < SITUATIONS; ++situation) {
        for (unsigned step = 0; step < 16; ++step) {
            for (int copies = 1; copies <= 2; ++copies) {
                check_order((situation_t)situation, AUVID_CAN_ACTION_DISARM, step, copies);
                check_order((situation_t)situation, AUVID_CAN_ACTION_STOP, step, copies);
            }
        }
    }
}

/* Its second frame follows the first one, with any counter of the first one. */
static void test_a_restarted_console_clears_the_abort_within_two_frames(void)
{
    for (unsigned last = 0; last < 16; ++last) {
        copy(&now, &exciting);
        abort_run(&now);
        (void)order(&now, AUVID_CAN_ACTION_STOP, last); /* from the previous console */
        TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_DISARM, 0));
        bool fresh = last >= 13;
        TEST_ASSERT_EQUAL(fresh ? AUVID_GUARD_DISARMED : AUVID_GUARD_ABORTED, state(&now));
        TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_DISARM, 1));
        TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, state(&now));
        TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 2));
        tick(&now);
        TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
    }
}

/* Sent before the arm frame and overtaken by it. */
static void test_a_delayed_disarm_or_stop_cancels_a_pending_arm_frame(void)
{
    for (uint32_t action = 0; action <= 2; action += 2) {
        copy(&now, &idle);
        auvid_can_frame_t delayed = order_frame(action, 5);
        TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 6));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_take(&now.node, &delayed));
        go(&now, 3);
        TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, state(&now));
        TEST_ASSERT_EQUAL(0, now.count);
    }
}

static void test_an_abort_cancels_a_pending_arm_frame(void)
{
    copy(&now, &idle);
    TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 1));
    abort_run(&now);
    TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_DISARM, 2));
    go(&now, 3);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, state(&now));
}

static void test_only_the_arm_action_needs_a_good_counter(void)
{
    for (unsigned step = 0; step < 16; ++step) {
        bool fresh = step >= 1 && step <= AUVID_CAN_LARGEST_STEP;
        reach(IDLE);
        TEST_ASSERT_EQUAL(fresh       ? AUVID_OK
                          : step == 0 ? AUVID_ERR_REPEATED
                                      : AUVID_ERR_COUNTER_JUMP,
                          order(&now, AUVID_CAN_ACTION_ARM, LAST + step));
        tick(&now);
        TEST_ASSERT_EQUAL(fresh ? AUVID_GUARD_EXCITING : AUVID_GUARD_DISARMED, state(&now));
    }
    copy(&now, &idle); /* a copy does not cancel the arm frame */
    TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 3));
    TEST_ASSERT_EQUAL(AUVID_ERR_REPEATED, order(&now, AUVID_CAN_ACTION_ARM, 3));
    tick(&now);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
}

static void test_a_disarm_that_is_not_authentic_has_no_effect(void)
{
    auvid_can_frame_t frame = order_frame(AUVID_CAN_ACTION_DISARM, 1);
    for (int i = 0; i < AUVID_CAN_BYTES; ++i) {
        copy(&now, &exciting);
        frame.data[i] ^= 0x10u;
        TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_node_take(&now.node, &frame));
        frame.data[i] ^= 0x10u;
        TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
    }
    frame.length = 7;
    TEST_ASSERT_EQUAL(AUVID_ERR_LENGTH, auvid_node_take(&now.node, &frame));
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
}

/* Number of ticks until the guard leaves EXCITING, with a stop in each tick. */
static int ticks_to_stop(int orders)
{
    int ticks = 0;
    copy(&now, &exciting);
    for (; state(&now) == AUVID_GUARD_EXCITING && ticks < 1000; ++ticks) {
        if (ticks < orders) {
            TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_STOP, 0)); /* repeated */
        }
        tick(&now);
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_SETTLING, state(&now));
    TEST_ASSERT_EQUAL(AUVID_GUARD_NO_CAUSE, cause(&now));
    return ticks;
}

static void test_repeated_stops_fade_out_like_one(void)
{
    int once = ticks_to_stop(1);
    TEST_ASSERT_TRUE(once > 10 && once < 1000);
    TEST_ASSERT_EQUAL(once, ticks_to_stop(1000));
}

static void test_thrust_is_commanded_in_every_tick_from_the_arm_frame_on(void)
{
    copy(&now, &idle);
    TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 1));
    for (int k = 0; k < 10; ++k) {
        tick(&now);
        TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
        TEST_ASSERT_EQUAL(2, now.count);
    }
}

/* ---- halt ---- */

static void test_halt_aborts_only_an_armed_guard(void)
{
    copy(&now, &idle);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_node_halt(&now.node, AUVID_GUARD_OPERATOR, now.sent, &now.count));
    TEST_ASSERT_EQUAL(0, now.count);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, state(&now));
    TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 1));
    tick(&now);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
    tick(&now);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_node_halt(&now.node, AUVID_GUARD_OPERATOR, now.sent, &now.count));
    TEST_ASSERT_EQUAL(2, now.count);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, state(&now));
    TEST_ASSERT_EQUAL(AUVID_GUARD_OPERATOR, cause(&now));
}

static void test_halt_takes_its_cause_and_aborts_without_one(void)
{
    static const auvid_guard_cause_t given[] = {AUVID_GUARD_TICK, AUVID_GUARD_NO_CAUSE,
                                                AUVID_GUARD_CAUSE_COUNT};
    static const auvid_guard_cause_t seen[] = {AUVID_GUARD_TICK, AUVID_GUARD_OPERATOR,
                                               AUVID_GUARD_OPERATOR};
    for (int k = 0; k < 3; ++k) {
        copy(&now, &idle);
        TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 1));
        go(&now, 2);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_halt(&now.node, given[k], now.sent, &now.count));
        TEST_ASSERT_EQUAL(2, now.count);
        TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, state(&now));
        TEST_ASSERT_EQUAL(seen[k], cause(&now));
        tick(&now);
        TEST_ASSERT_TRUE(now.node.events & AUVID_EVENT_ABORTED);
        TEST_ASSERT_EQUAL(0, now.count); /* no second command of zero */
    }
}

static void test_halt_does_not_change_a_finished_run(void)
{
    copy(&now, &idle);
    now.actuation.guard.state = AUVID_GUARD_DONE;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_node_halt(&now.node, AUVID_GUARD_OPERATOR, now.sent, &now.count));
    TEST_ASSERT_EQUAL(AUVID_GUARD_DONE, state(&now));
}

static void test_halt_cancels_a_pending_arm_frame(void)
{
    copy(&now, &idle);
    TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 1));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_node_halt(&now.node, AUVID_GUARD_OPERATOR, now.sent, &now.count));
    go(&now, 3);
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, state(&now));
    TEST_ASSERT_EQUAL(0, now.count);
}

/* ---- another node's commands ---- */

/* Passes the last commands of one node to the other. */
static void hear(pair_t *to, const auvid_can_frame_t *frame, int count)
{
    for (int i = 0; i < count; ++i) {
        TEST_ASSERT_TRUE(auvid_node_take(&to->node, &frame[i]) >= 0);
    }
}

/* Both on one bus, armed by the same frame. @return ticks until one of them aborts */
static int both_excite(uint64_t seed, int ticks)
{
    int k = 0;
    copy(&now, &idle);
    configure(&other, seed, true);
    go(&other, NAVIGATED);
    auvid_can_frame_t arm = order_frame(AUVID_CAN_ACTION_ARM, 1);
    hear(&now, &arm, 1);
    hear(&other, &arm, 1);
    for (; k < ticks && cause(&now) == AUVID_GUARD_NO_CAUSE; ++k) {
        tick(&now);
        tick(&other);
        hear(&now, other.sent, other.count);
        hear(&other, now.sent, now.count);
    }
    return k;
}

static void test_two_nodes_that_excite_on_one_bus_both_abort(void)
{
    TEST_ASSERT_LESS_THAN_INT(5, both_excite(2, 100));
    pair_t *const both[] = {&now, &other};
    for (int i = 0; i < 2; ++i) {
        TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, state(both[i]));
        TEST_ASSERT_EQUAL(AUVID_GUARD_FOREIGN_COMMAND, cause(both[i]));
        TEST_ASSERT_TRUE(both[i]->node.counters.foreign_commands > 0);
        tick(both[i]);
        TEST_ASSERT_TRUE((both[i]->node.events & AUVID_EVENT_ABORTED) != 0);
        TEST_ASSERT_EQUAL(2, both[i]->count);
        TEST_ASSERT_TRUE(both[i]->largest == 0.0);
        tick(both[i]);
        TEST_ASSERT_EQUAL(0, both[i]->count);
    }
}

/* The limit of the method: both send the same bytes, so a receiver obeys one of every two frames,
 * as from one node. */
static void test_a_node_that_sends_identical_bytes_is_not_detected(void)
{
    TEST_ASSERT_EQUAL(200, both_excite(1, 200));
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
    TEST_ASSERT_EQUAL(2, now.count);
    for (int i = 0; i < now.count; ++i) {
        TEST_ASSERT_EQUAL_MEMORY(other.sent[i].data, now.sent[i].data, AUVID_CAN_BYTES);
    }
}

/* Echoes of the commands of `late` ticks ago, `copies` of each. @return is it still exciting? */
static bool echoed(int late, int copies)
{
    static auvid_can_frame_t sent[8][AUVID_NODE_COMMANDS];
    copy(&now, &exciting);
    for (int k = 0; k < 60 && state(&now) == AUVID_GUARD_EXCITING; ++k) {
        tick(&now);
        memcpy(sent[k % 8], now.sent, sizeof now.sent);
        for (int i = 0; i < copies && k >= late; ++i) {
            hear(&now, sent[(k - late) % 8], 2);
        }
    }
    return state(&now) == AUVID_GUARD_EXCITING && now.node.counters.foreign_commands == 0;
}

static void test_echoes_of_the_last_four_commands_are_not_foreign(void)
{
    for (int late = 0; late < 4; ++late) {
        TEST_ASSERT_TRUE(echoed(late, 1));
        TEST_ASSERT_TRUE(echoed(late, 2));
    }
    TEST_ASSERT_FALSE(echoed(4, 1));
    TEST_ASSERT_EQUAL(AUVID_GUARD_FOREIGN_COMMAND, cause(&now));
}

static auvid_can_frame_t foreign_command(auvid_can_kind_t kind)
{
    auvid_can_sender_t sender;
    auvid_can_frame_t frame;
    auvid_can_message_t m = {.kind = kind};
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &m, &frame));
    return frame;
}

static void test_one_foreign_command_of_either_half_aborts(void)
{
    for (int half = 0; half < 2; ++half) {
        auvid_can_frame_t frame = foreign_command(half == 0 ? AUVID_CAN_THRUSTER_COMMAND_A
                                                            : AUVID_CAN_THRUSTER_COMMAND_B);
        copy(&now, &exciting);
        hear(&now, &frame, 1);
        TEST_ASSERT_EQUAL(AUVID_GUARD_FOREIGN_COMMAND, cause(&now));
        copy(&now, &exciting);
        frame.data[2] ^= 1u; /* not authentic */
        TEST_ASSERT_EQUAL(AUVID_ERR_CHECKSUM, auvid_node_take(&now.node, &frame));
        TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
        TEST_ASSERT_EQUAL_UINT32(0, now.node.counters.foreign_commands);
    }
}

static void test_a_foreign_command_aborts_a_guard_that_is_armed_only(void)
{
    auvid_can_frame_t frame = foreign_command(AUVID_CAN_THRUSTER_COMMAND_A);
    copy(&now, &idle);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&now.node.id));
    hear(&now, &frame, 1);
    TEST_ASSERT_EQUAL(AUVID_GUARD_FOREIGN_COMMAND, cause(&now));
    copy(&now, &exciting); /* SETTLING sends no commands */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_finished(&now.actuation.guard, now.node.t_us));
    hear(&now, &frame, 1);
    TEST_ASSERT_EQUAL(AUVID_GUARD_SETTLING, state(&now));
}

static void test_a_node_that_is_not_armed_only_counts_foreign_commands(void)
{
    auvid_can_frame_t frame = foreign_command(AUVID_CAN_THRUSTER_COMMAND_A);
    auvid_can_frame_t second = foreign_command(AUVID_CAN_THRUSTER_COMMAND_B);
    for (int excite = 0; excite < 2; ++excite) {
        configure(&now, 1, excite);
        go(&now, NAVIGATED);
        for (uint32_t k = 1; k <= 3; ++k) { /* with any counter */
            hear(&now, &frame, 1);
            hear(&now, &second, 1);
            TEST_ASSERT_EQUAL_UINT32(2 * k, now.node.counters.foreign_commands);
        }
        TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, state(&now));
        TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 1));
        tick(&now);
        TEST_ASSERT_EQUAL(excite ? AUVID_GUARD_EXCITING : AUVID_GUARD_DISARMED, state(&now));
    }
    copy(&now, &exciting);
    abort_run(&now);
    hear(&now, &frame, 1);
    TEST_ASSERT_EQUAL(AUVID_GUARD_OPERATOR, cause(&now)); /* the first cause is kept */
}

/* ---- the node's own clock ---- */

/* A tick of the node's clock: all frames of the vehicle except its tick. */
static auvid_status_t own_tick(pair_t *p, uint64_t t_us)
{
    auvid_can_frame_t frame[VEHICLE_SIM_FRAMES];
    int count = vehicle_sim_tick(&p->vehicle_sim, frame);
    for (int i = 0; i < count - 1; ++i) {
        (void)auvid_node_take(&p->node, &frame[i]);
    }
    return auvid_node_step(&p->node, &t_us, p->sent, &p->count);
}

static void excite_by_own_clock(uint64_t *t_us)
{
    configure(&now, 1, true);
    *t_us = 5000000;
    for (int k = 0; k < NAVIGATED + EXCITED; ++k, *t_us += 20000) {
        if (k == NAVIGATED) {
            TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 1));
        }
        TEST_ASSERT_EQUAL(AUVID_OK, own_tick(&now, *t_us));
        for (int i = 1; i < now.count; ++i) {
            vehicle_sim_take(&now.vehicle_sim, &now.sent[i]);
        }
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
    *t_us -= 20000; /* time of the last tick */
}

static uint32_t own_sequence(const pair_t *p)
{
    auvid_can_message_t m;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &p->sent[0], &m));
    TEST_ASSERT_EQUAL(AUVID_CAN_TICK, m.kind);
    return m.as.tick.sequence;
}

static void test_an_own_clock_set_back_sends_only_the_command_of_zero(void)
{
    for (uint64_t back_us = 0; back_us <= 100000; back_us += 100000) {
        uint64_t t_us;
        excite_by_own_clock(&t_us);
        uint32_t before = own_sequence(&now);
        TEST_ASSERT_EQUAL(back_us == 0 ? AUVID_ERR_TIME_SAME : AUVID_ERR_TIME_BACK,
                          own_tick(&now, t_us - back_us));
        TEST_ASSERT_EQUAL(AUVID_GUARD_TIME, cause(&now));
        TEST_ASSERT_EQUAL(2, now.count);
        TEST_ASSERT_EQUAL(AUVID_CAN_THRUSTER_COMMAND_A, auvid_can_kind(NULL, now.sent[0].id));
        TEST_ASSERT_EQUAL(AUVID_CAN_THRUSTER_COMMAND_B, auvid_can_kind(NULL, now.sent[1].id));
        deliver(&now);
        TEST_ASSERT_TRUE(now.largest == 0.0);
        TEST_ASSERT_NOT_EQUAL(AUVID_OK, own_tick(&now, t_us - back_us));
        TEST_ASSERT_EQUAL(0, now.count);
        TEST_ASSERT_EQUAL(AUVID_OK, own_tick(&now, t_us + 20000));
        TEST_ASSERT_EQUAL(1, now.count);
        TEST_ASSERT_EQUAL_UINT32(before + 1, own_sequence(&now)); /* no number is missing */
        TEST_ASSERT_EQUAL_UINT64(t_us + 20000, now.node.t_us);
    }
}

static void test_an_arm_frame_remains_pending_until_a_valid_tick(void)
{
    uint64_t t_us;
    excite_by_own_clock(&t_us);
    TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_DISARM, 2));
    TEST_ASSERT_EQUAL(AUVID_OK, own_tick(&now, t_us += 20000));
    TEST_ASSERT_EQUAL(AUVID_OK, order(&now, AUVID_CAN_ACTION_ARM, 3));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, own_tick(&now, t_us - 1));
    TEST_ASSERT_EQUAL(AUVID_GUARD_DISARMED, state(&now));
    TEST_ASSERT_EQUAL(AUVID_OK, own_tick(&now, t_us + 20000));
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, state(&now));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_disarm_and_stop_take_thrust_away_with_any_counter);
    RUN_TEST(test_a_restarted_console_clears_the_abort_within_two_frames);
    RUN_TEST(test_a_delayed_disarm_or_stop_cancels_a_pending_arm_frame);
    RUN_TEST(test_an_abort_cancels_a_pending_arm_frame);
    RUN_TEST(test_only_the_arm_action_needs_a_good_counter);
    RUN_TEST(test_a_disarm_that_is_not_authentic_has_no_effect);
    RUN_TEST(test_repeated_stops_fade_out_like_one);
    RUN_TEST(test_thrust_is_commanded_in_every_tick_from_the_arm_frame_on);
    RUN_TEST(test_halt_aborts_only_an_armed_guard);
    RUN_TEST(test_halt_takes_its_cause_and_aborts_without_one);
    RUN_TEST(test_halt_does_not_change_a_finished_run);
    RUN_TEST(test_halt_cancels_a_pending_arm_frame);
    RUN_TEST(test_two_nodes_that_excite_on_one_bus_both_abort);
    RUN_TEST(test_a_node_that_sends_identical_bytes_is_not_detected);
    RUN_TEST(test_echoes_of_the_last_four_commands_are_not_foreign);
    RUN_TEST(test_one_foreign_command_of_either_half_aborts);
    RUN_TEST(test_a_foreign_command_aborts_a_guard_that_is_armed_only);
    RUN_TEST(test_a_node_that_is_not_armed_only_counts_foreign_commands);
    RUN_TEST(test_an_own_clock_set_back_sends_only_the_command_of_zero);
    RUN_TEST(test_an_arm_frame_remains_pending_until_a_valid_tick);
    return UNITY_END();
}
