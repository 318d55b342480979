/*
 * A node in lock step with the simulated vehicle: all frames that it receives, and the thrust that
 * it commands.
 */
#ifndef NODE_RUN_H
#define NODE_RUN_H

#include <math.h>
#include <string.h>

#include "auvid/node.h"
#include "vehicle_sim.h"
#include "unity.h"

enum { SETS = 2, LOG = 60000 };

static auvid_node_t node;
static auvid_actuation_t actuation;
static auvid_actuation_config_t acting;
static vehicle_sim_t vehicle_sim;
static auvid_identifier_config_t identifier;
static auvid_node_config_t config;

/* Frames received by the node, in order. */
static auvid_can_frame_t taken[LOG];
static int taken_count;

/* State of the current run. */
static struct {
    uint32_t commands;   /* frames of thruster command A sent by the node */
    double largest;      /* maximum thrust of the last command */
    uint32_t ticks;      /* number so far */
    uint32_t jump_at;    /* tick in which the bus's clock is set ... */
    int32_t jump_us;     /* ... by this much */
    bool random_arrival; /* times of arrival are random */
    uint64_t random;
} run;

static inline void prepare(uint64_t seed)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    vehicle_sim_config_t vehicle;
    memset(&run, 0, sizeof run);
    run.random = 88172645463325252u;
    taken_count = 0;
    vehicle_sim_defaults(&vehicle);
    vehicle.sim.seed = seed;
    TEST_ASSERT_TRUE(vehicle_sim_init(&vehicle_sim, &vehicle));
    auvid_identifier_defaults(&identifier, &auvid_girona500);
    identifier.exact_inputs = true;
    auvid_actuation_defaults(&acting);
    (void)auvid_excitation_plan(&acting.excitation, amplitude, 30, SETS, seed);
    identifier.search.seed = seed;
    auvid_node_defaults(&config);
    config.answer = true;
}

void setUp(void)
{
    prepare(1);
}

void tearDown(void)
{
}

static inline void begin(bool excite)
{
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_node_init(&node, &config, &auvid_allocation_girona500, &identifier));
    if (excite) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&node, &actuation, &acting));
    }
}

static inline uint64_t draw(void)
{
    run.random ^= run.random << 13;
    run.random ^= run.random >> 7;
    run.random ^= run.random << 17;
    return run.random;
}

/* Passes the frames of the node to the vehicle. */
static inline void deliver(const auvid_can_frame_t *frame, int count)
{
    for (int i = 0; i < count; ++i) {
        auvid_can_message_t m;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &frame[i], &m));
        if (m.kind == AUVID_CAN_THRUSTER_COMMAND_A) {
            run.largest = 0.0;
            ++run.commands;
            for (int k = 0; k < 4; ++k) {
                run.largest = fmax(run.largest, fabs((double)m.as.thruster_command_a.thrust[k]));
            }
        }
        if (m.kind == AUVID_CAN_THRUSTER_COMMAND_B) {
            run.largest = fmax(run.largest, fabs((double)m.as.thruster_command_b.thrust[0]));
        }
        vehicle_sim_take(&vehicle_sim, &frame[i]);
    }
}

/* The node's part of a tick that has begun. */
static inline void serve(auvid_node_t *n)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    int count = 0;
    (void)auvid_node_step(n, NULL, frame, &count);
    deliver(frame, count);
    (void)auvid_node_work(n, AUVID_DEFAULT_BUDGET);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_report(n, 1, frame, &count));
    deliver(frame, count);
}

static inline auvid_status_t give(auvid_can_frame_t *frame)
{
    if (taken_count < LOG) {
        taken[taken_count++] = *frame;
    }
    auvid_status_t status = auvid_node_take(&node, frame);
    if (status == AUVID_TICK) {
        serve(&node);
    }
    return status;
}

static inline void set_clock(auvid_can_frame_t *frame)
{
    auvid_can_message_t m;
    if (run.jump_at == 0 || run.ticks < run.jump_at ||
        auvid_can_unpack(NULL, frame, &m) != AUVID_OK || m.kind != AUVID_CAN_TICK) {
        return;
    }
    auvid_can_sender_t sender;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
    sender.counter[AUVID_CAN_TICK] = m.counter;
    m.as.tick.time += (uint32_t)run.jump_us;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &m, frame));
}

static inline void tick(void)
{
    auvid_can_frame_t frame[VEHICLE_SIM_FRAMES];
    int count = vehicle_sim_tick(&vehicle_sim, frame);
    ++run.ticks;
    for (int i = 0; i < count; ++i) {
        set_clock(&frame[i]);
        frame[i].t_us = run.random_arrival ? draw() : frame[i].t_us;
        (void)give(&frame[i]);
    }
}

static inline void go(uint32_t ticks)
{
    for (uint32_t k = 0; k < ticks; ++k) {
        tick();
    }
}

#endif
