/*
 * Time of the node: a clock of the bus that is set or wraps, ticks that are lost, late or repeated,
 * samples between two ticks, and a clock of its own.
 */
#include "node_run.h"
#include "save_checkpoint.h"

static void clock_is_set(int32_t by_us)
{
    begin(true);
    run.jump_at = 400;
    run.jump_us = by_us;
    go(399);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, actuation.guard.state);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.clock_steps);
    uint64_t before = node.t_us;
    tick();
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.clock_steps);
    TEST_ASSERT_TRUE(node.t_us > before);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, actuation.guard.state);
    TEST_ASSERT_TRUE(run.largest == 0.0);
    go(200);
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.clock_steps);
    TEST_ASSERT_EQUAL_UINT32(600, node.counters.ticks);
    uint32_t dropped = node.counters.samples_dropped; /* gated until converged */
    go(200);
    TEST_ASSERT_EQUAL_UINT32(dropped, node.counters.samples_dropped);
}

static void test_a_clock_set_back_is_counted_and_the_node_continues(void)
{
    clock_is_set(-5000000);
}

static void test_a_clock_set_ahead_is_counted_and_the_node_continues(void)
{
    clock_is_set(5000000);
}

static void test_a_wrap_of_the_clock_has_no_effect(void)
{
    begin(true);
    run.jump_at = 1;
    run.jump_us = -4000000; /* the tick's 32 bits wrap at 4 s */
    go(400);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.clock_steps);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, actuation.guard.state);
}

static void test_a_lost_tick_is_counted(void)
{
    auvid_can_frame_t frame[VEHICLE_SIM_FRAMES];
    begin(false);
    go(100);
    (void)vehicle_sim_tick(&vehicle_sim, frame);
    go(10);
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.ticks_missed);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.clock_steps);
    TEST_ASSERT_EQUAL_UINT32(110, node.counters.ticks);
}

static auvid_can_frame_t tick_frame(auvid_can_sender_t *from, uint32_t sequence)
{
    auvid_can_frame_t frame;
    auvid_can_message_t m = {.kind = AUVID_CAN_TICK};
    m.as.tick.sequence = sequence;
    m.as.tick.time = 20000 * sequence;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(from, &m, &frame));
    return frame;
}

/* 2 overtakes 1 and is repeated after it, where its counter is in sequence. */
static void test_a_late_or_repeated_tick_is_refused_and_no_clock_step(void)
{
    auvid_can_sender_t from;
    begin(false);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&from, NULL));
    auvid_can_frame_t first = tick_frame(&from, 1), second = tick_frame(&from, 2);
    auvid_can_frame_t third = tick_frame(&from, 3);
    TEST_ASSERT_EQUAL(AUVID_TICK, auvid_node_take(&node, &second));
    TEST_ASSERT_EQUAL(AUVID_ERR_COUNTER_JUMP, auvid_node_take(&node, &first));
    TEST_ASSERT_EQUAL(AUVID_ERR_STALE, auvid_node_take(&node, &second));
    TEST_ASSERT_EQUAL(AUVID_TICK, auvid_node_take(&node, &third));
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.clock_steps);
    TEST_ASSERT_EQUAL_UINT32(2, node.counters.refused);
    TEST_ASSERT_EQUAL_UINT32(2, node.counters.frames);
}

static void test_halves_of_an_imu_sample_may_arrive_in_neighbouring_ticks(void)
{
    auvid_can_frame_t frame[VEHICLE_SIM_FRAMES], late;
    bool has = false;
    begin(false);
    for (int k = 0; k < 100; ++k) {
        int count = vehicle_sim_tick(&vehicle_sim, frame);
        for (int i = 0; i < count; ++i) {
            auvid_can_message_t m;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &frame[i], &m));
            if (m.kind != AUVID_CAN_IMU_RATES) {
                (void)give(&frame[i]);
                continue;
            }
            if (has) { /* from the previous tick: it is 20 ms old now */
                (void)give(&late);
            }
            auvid_can_sender_t sender;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
            sender.counter[AUVID_CAN_IMU_RATES] = m.counter;
            m.as.imu_rates.age = 20;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &m, &late));
            has = true;
        }
    }
    auvid_nav_state_t state;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&node.id.nav, &state));
    TEST_ASSERT_TRUE(state.t_us + 40000u >= node.t_us);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.samples_dropped);
}

static void test_a_node_with_its_own_clock_sends_the_tick_and_refuses_to_go_back(void)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    auvid_can_message_t m;
    int count = 0;
    uint64_t t_us = 1000000;
    begin(true);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, &t_us, frame, &count));
    TEST_ASSERT_EQUAL(1, count);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, frame, &m));
    TEST_ASSERT_EQUAL(AUVID_CAN_TICK, m.kind);
    TEST_ASSERT_EQUAL_UINT32(1000000, m.as.tick.time);
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_node_step(&node, &t_us, frame, &count));
    t_us = 900000;
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_BACK, auvid_node_step(&node, &t_us, frame, &count));
    t_us = 1020000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, &t_us, frame, &count));
}

static void test_samples_of_a_refused_tick_are_counted_as_dropped(void)
{
    static const auvid_can_kind_t kind[] = {AUVID_CAN_DVL_BOTTOM, AUVID_CAN_DVL_WATER,
                                            AUVID_CAN_DVL_ALTITUDE, AUVID_CAN_DEPTH, AUVID_CAN_GPS};
    auvid_can_frame_t frame[AUVID_NODE_FRAMES], sample;
    auvid_can_sender_t from;
    int count = 0;
    uint64_t t_us = 1000000;
    begin(false);
    auvid_can_sender_init(&from, NULL);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, &t_us, frame, &count));
    for (uint32_t k = 0; k < sizeof kind / sizeof kind[0]; ++k) {
        auvid_can_message_t m = {.kind = kind[k]};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&from, &m, &sample));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_take(&node, &sample));
        TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_node_step(&node, &t_us, frame, &count));
        TEST_ASSERT_EQUAL_UINT32(k + 1u, node.counters.samples_dropped);
    }
    t_us = 1020000;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, &t_us, frame, &count));
    TEST_ASSERT_EQUAL_UINT32(5, node.counters.samples_dropped);
}

/* A node is restarted after an hour and 20 minutes, when the 32 bits of the tick frames have
 * wrapped, from the checkpoint of the last one; the bus clock goes on, or begins at zero. */
static void restart(int32_t later_us, uint32_t steps)
{
    static uint8_t saved[64 * 1024];
    static auvid_identifier_t dive;
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    auvid_can_sender_t from;
    uint64_t t_us = 4800000000u;
    uint32_t bytes = 0;
    int count = 0;
    begin(false);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, &t_us, frame, &count));
    bytes = save_checkpoint(&node.id, saved, sizeof saved);
    dive = node.id;
    begin(false);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_restore(&node.id, saved, bytes));
    auvid_can_sender_init(&from, NULL);
    for (uint32_t k = 0; k < 3; ++k) {
        auvid_can_message_t m = {
            .kind = AUVID_CAN_TICK,
            .as.tick = {.sequence = k, .time = (uint32_t)t_us + (uint32_t)later_us + 20000u * k}};
        auvid_can_frame_t tick;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&from, &m, &tick));
        TEST_ASSERT_EQUAL(AUVID_TICK, auvid_node_take(&node, &tick));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, NULL, frame, &count));
    }
    TEST_ASSERT_EQUAL_UINT32(steps, node.counters.clock_steps);
    TEST_ASSERT_EQUAL_UINT32(3, node.counters.ticks);
    TEST_ASSERT_TRUE(node.t_us ==
                     dive.t_us + (later_us > 0 ? (uint32_t)later_us : 1000000u) + 40000u);
}

static void test_a_restored_node_goes_on_with_the_clock_of_the_bus(void)
{
    restart(7000000, 0);
}

static void test_a_restored_node_goes_on_if_the_clock_of_the_bus_went_back(void)
{
    restart(-600000000, 1);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_clock_set_back_is_counted_and_the_node_continues);
    RUN_TEST(test_a_clock_set_ahead_is_counted_and_the_node_continues);
    RUN_TEST(test_a_wrap_of_the_clock_has_no_effect);
    RUN_TEST(test_a_lost_tick_is_counted);
    RUN_TEST(test_a_late_or_repeated_tick_is_refused_and_no_clock_step);
    RUN_TEST(test_halves_of_an_imu_sample_may_arrive_in_neighbouring_ticks);
    RUN_TEST(test_a_node_with_its_own_clock_sends_the_tick_and_refuses_to_go_back);
    RUN_TEST(test_samples_of_a_refused_tick_are_counted_as_dropped);
    RUN_TEST(test_a_restored_node_goes_on_with_the_clock_of_the_bus);
    RUN_TEST(test_a_restored_node_goes_on_if_the_clock_of_the_bus_went_back);
    return UNITY_END();
}
