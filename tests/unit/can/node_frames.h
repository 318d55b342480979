/*
 * A node beside a simulated vehicle: frames into it, ticks, and the frames that it sends.
 */
#ifndef NODE_FRAMES_H
#define NODE_FRAMES_H

#include <math.h>
#include <string.h>

#include "auvid/node.h"
#include "identifier/auvid_input_internal.h"
#include "navigation/auvid_sensors_internal.h"
#include "vehicle_sim.h"
#include "unity.h"

enum { NAVIGATED = 100 };

static auvid_node_t node, copy;
static auvid_actuation_t actuation, copy_actuation;
static auvid_actuation_config_t acting;
static auvid_allocation_config_t thrusters;
static bool passive;
static vehicle_sim_t vehicle_sim;
static auvid_identifier_config_t identifier;
static auvid_node_config_t cfg;
static auvid_can_sender_t sender;
static auvid_can_frame_t sent[AUVID_NODE_FRAMES];
static int count;

void setUp(void)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    vehicle_sim_config_t vehicle;
    vehicle_sim_defaults(&vehicle);
    vehicle.no_arm = true;
    TEST_ASSERT_TRUE(vehicle_sim_init(&vehicle_sim, &vehicle));
    auvid_identifier_defaults(&identifier, &auvid_girona500);
    identifier.exact_inputs = true;
    thrusters = auvid_allocation_girona500;
    passive = false;
    auvid_actuation_defaults(&acting);
    (void)auvid_excitation_plan(&acting.excitation, amplitude, 30, 2, 1);
    auvid_node_defaults(&cfg);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
}

void tearDown(void)
{
}

static inline void begin(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &cfg, &thrusters, &identifier));
    if (!passive) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&node, &actuation, &acting));
    }
}

/* Copies the node with its acting half. */
static inline void copy_node(void)
{
    copy = node;
    copy_actuation = actuation;
    copy.id.actuation = &copy_actuation;
}

static inline auvid_status_t give(const auvid_can_message_t *m)
{
    auvid_can_frame_t frame;
    TEST_ASSERT_TRUE(auvid_can_pack(&sender, m, &frame) >= 0);
    return auvid_node_take(&node, &frame);
}

static inline auvid_status_t give_tick(uint32_t sequence, uint32_t t_us)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_TICK};
    m.as.tick.sequence = sequence;
    m.as.tick.time = t_us;
    return give(&m);
}

static inline void step_at_us(uint32_t sequence, uint32_t t_us)
{
    TEST_ASSERT_EQUAL(AUVID_TICK, give_tick(sequence, t_us));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, NULL, sent, &count));
}

/* Ticks of 20 ms. */
static inline void step_at(uint32_t sequence)
{
    step_at_us(sequence, 20000 * sequence);
}

/* A tick of the vehicle without the messages of this bit mask. */
static inline void tick_without(uint32_t kinds)
{
    auvid_can_frame_t frame[VEHICLE_SIM_FRAMES];
    int frames = vehicle_sim_tick(&vehicle_sim, frame);
    for (int i = 0; i < frames; ++i) {
        if ((kinds >> auvid_can_kind(NULL, frame[i].id) & 1u) == 0 &&
            auvid_node_take(&node, &frame[i]) == AUVID_TICK) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, NULL, sent, &count));
            for (int k = 0; k < count; ++k) {
                vehicle_sim_take(&vehicle_sim, &sent[k]);
            }
        }
    }
}

static inline void go(int ticks)
{
    for (int k = 0; k < ticks; ++k) {
        tick_without(0);
    }
}

static inline void excite(void)
{
    begin();
    go(NAVIGATED);
    auvid_can_message_t m = {.kind = AUVID_CAN_ARM};
    m.as.arm.action = AUVID_CAN_ACTION_ARM;
    m.as.arm.key = AUVID_CAN_ARM_KEY;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    go(50);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, actuation.guard.state);
}

#endif
