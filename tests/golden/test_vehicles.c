/*
 * Golden vectors of whole vehicles, at the program's sizes.
 */
#include "chain.h"
#include "own_thrusters.h"
#include "unity.h"
#include "vector.h"
#include "current_world.h"

enum { IDS = 0x800 }; /* of frames */

static chain_t chain;
static world_t bus;

void setUp(void)
{
    own_thrusters_defaults();
}

void tearDown(void)
{
}

static void look(chain_t *c, auvid_status_t status, const auvid_output_t *out)
{
    (void)status;
    vector_step(&c->id, out);
}

static void test_a_girona500_at_1_newton(void)
{
    chain_config_t config;
    vector_begin(1);
    chain_defaults(&config, 1, SETS, 1.0);
    config.after = look;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &config, SETS));
    TEST_ASSERT_TRUE(chain_finish(&chain, 1000, 1000) <= 1000);
    vector_whole(&chain.id);
    golden_end("girona500");
}

/* The order of the frames on the bus: their identifiers, in each tick. */
static void hear(uint32_t *count)
{
    auvid_can_frame_t frame;
    while (frames_receive(&bus.hub.end[WORLD_LISTENER], &frame)) {
        vector_add(&frame.id, sizeof frame.id);
        ++count[frame.id];
    }
}

static void test_a_bluerov2_in_six_degrees_of_freedom(void)
{
    const world_config_t config = {
        .vehicle = vehicle_named("bluerov2"), .seed = 1, .disturbance_N = 0.2, .sets = SETS};
    const auvid_node_t *node = &bus.node[0];
    uint32_t count[IDS] = {0};
    vector_begin(1);
    TEST_ASSERT_TRUE(world_begin(&bus, &config));
    for (bool busy = true; busy || node->id.metric.sets.recorded < SETS;) {
        world_tick(&bus);
        busy = world_work(&bus, AUVID_DEFAULT_BUDGET);
        hear(count);
        vector_add(bus.excitation, sizeof bus.excitation);
        vector_look(&node->id, node->events);
        TEST_ASSERT_TRUE(world_time_s(&bus) < 400.0);
    }
    for (int i = 0; i < IDS; ++i) {
        if (count[i] > 0) {
            golden_put("frame %03x count %u\n", (unsigned)i, (unsigned)count[i]);
        }
    }
    vector_whole(&node->id);
    golden_end("bluerov2");
}

static void test_a_girona500_with_thrusters_of_its_own(void)
{
    vector_begin(1);
    each_step = vector_step;
    identify(1);
    vector_whole(&id);
    golden_end("thrusters");
}

/* A second node listens, and has the model of a hull in a current. */
static void test_a_girona500_in_a_current(void)
{
    static auvid_current_t current;
    const world_config_t config = {
        .seed = 1, .disturbance_N = 1.0, .sets = SETS, .current = {0.2, -0.2, 0.0}};
    const auvid_node_t *node = &bus.node[1];
    vector_begin(1);
    begin_current_world(&bus, &config, &current, store);
    while (node->id.metric.sets.recorded < SETS) {
        world_tick(&bus);
        (void)world_work(&bus, 1000);
        vector_look(&node->id, node->events);
        TEST_ASSERT_TRUE(world_time_s(&bus) < 600.0);
    }
    finish_work(&bus.node[1].id, 1000);
    vector_whole(&node->id);
    golden_end("current");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_girona500_at_1_newton);
    RUN_TEST(test_a_bluerov2_in_six_degrees_of_freedom);
    RUN_TEST(test_a_girona500_with_thrusters_of_its_own);
    RUN_TEST(test_a_girona500_in_a_current);
    return UNITY_END();
}
