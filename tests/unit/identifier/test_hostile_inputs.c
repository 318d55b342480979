/*
 * A tick stays short for any input: work never uses more units than its budget. A node gets frames,
 * an identifier gets samples: sensible ones, none, too many, random or malicious ones. On a
 * microcontroller, tests/firmware/test_instructions.sh also counts the instructions of every tick
 * of the node.
 */
#include <math.h>
#include <string.h>

#include "auvid/node.h"
#include "can/auvid_can_table_internal.h"
#include "binomial.h"
#include "unity.h"

#if defined(__arm__) || defined(__riscv)
/* Some of the node's ticks are left out. The firmware's test counts the remaining ten thousand. */
enum { TICKS = 11000, LONG_TICKS = 11000 };
#else
enum { TICKS = 20000, LONG_TICKS = 1000000 };
#endif

/* Kinds of input, for some hundreds of ticks each. */
typedef enum {
    CALM,   /* a vehicle that oscillates, its sensors at their usual rates */
    FLOOD,  /* the same, every sensor in every tick, all work at once */
    CHANCE, /* random values, samples missing, too old, ahead of time */
    HARM,   /* frames of random bits; NaN and infinities; clocks set; orders */
    MODES
} manner_t;

static auvid_identifier_config_t cfg;
static auvid_actuation_config_t acting;
static auvid_actuation_t actuation;
static auvid_allocation_t allocation;
static auvid_node_t node;
static auvid_identifier_t id;
static auvid_can_sender_t sender;
static uint64_t state, t_us;
static uint32_t tick, exciting;
static manner_t manner;

static uint32_t draw(uint32_t below)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)((state >> 33) % below);
}

/* -1..1 */
static auvid_real_t chance(void)
{
    return (auvid_real_t)draw(2001) / 1000 - 1;
}

/* Sets of 6 s: sets complete in every phase of a search. The guard's limits are wide. */
void setUp(void)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    state = 1;
    t_us = 0;
    tick = exciting = 0;
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    auvid_actuation_defaults(&acting);
    cfg.metric.set_rows = 12;
    acting.guard.off = AUVID_GUARD_SWITCHABLE;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&acting.excitation, amplitude, 30, AUVID_MAX_SETS, 1));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
}

void tearDown(void)
{
}

static uint32_t ticks(void)
{
    return campaign_is_long() ? LONG_TICKS : TICKS;
}

/* The next tick's time and kind. Half the ticks are CALM, else nothing is ever identified. */
static void next_tick(void)
{
    if (tick++ % 700 == 0) {
        manner = draw(2) ? CALM : (manner_t)draw(MODES);
    }
    t_us += 20000;
    if (manner == HARM && draw(100) == 0) {
        t_us += draw(3) ? draw(3000000) : UINT64_C(1) << draw(40);
    }
}

/* Oscillation of the vehicle: a value between -1 and 1; each channel has its own period. */
static auvid_real_t swing(int channel)
{
    uint32_t period = 150 + 37 * (uint32_t)channel, at = tick % period;
    return manner >= CHANCE ? chance() : (auvid_real_t)sin(6.283185307 * at / period);
}

/* Is a sample due from a sensor with this period in ticks? */
static bool due(uint32_t every)
{
    return manner == FLOOD || (manner == CALM ? tick % every == 0 : draw(every) == 0);
}

static uint32_t age(void)
{
    return manner >= CHANCE && draw(4) == 0 ? draw(1024) : 0;
}

/* ---- a node and frames ---- */

static uint32_t budget(void)
{
    static const uint32_t budgets[] = {0, 1, 7, AUVID_DEFAULT_BUDGET, AUVID_DEFAULT_BUDGET, 1000};
#if defined(__arm__) || defined(__riscv)
    (void)budgets;
    return AUVID_DEFAULT_BUDGET;
#else
    return budgets[draw(6)];
#endif
}

static void serve(void)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    int count = -1;
    uint32_t units = budget();
    TEST_ASSERT_TRUE(auvid_node_step(&node, NULL, frame, &count) >= 0);
    TEST_ASSERT_TRUE(count >= 0 && count <= AUVID_NODE_FRAMES);
    (void)auvid_node_work(&node, units);
    TEST_ASSERT_TRUE(node.id.work.last_units <= units);
    exciting += actuation.guard.state == AUVID_GUARD_EXCITING;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_report(&node, draw(300), frame, &count));
    TEST_ASSERT_TRUE(count >= 0 && count <= AUVID_NODE_FRAMES);
}

static void give(const auvid_can_message_t *message)
{
    auvid_can_frame_t frame;
    if (auvid_can_pack(&sender, message, &frame) < 0) {
        return;
    }
    if (manner == HARM && draw(3) == 0) { /* random bits, most with a correct checksum */
        for (int i = 1; i < AUVID_CAN_BYTES; ++i) {
            frame.data[i] = (uint8_t)draw(256);
        }
        if (draw(8) != 0) {
            frame.data[0] = auvid_can_crc(frame.data, AUVID_CAN_DATA_ID(message->kind));
        }
    }
    for (uint32_t times = manner == HARM && draw(20) == 0 ? 2 : 1; times > 0; --times) {
        if (auvid_node_take(&node, &frame) == AUVID_TICK) {
            serve();
        }
    }
}

static void give_sensors(void)
{
    auvid_can_message_t m;
    memset(&m, 0, sizeof m);
    m.kind = AUVID_CAN_IMU_ATTITUDE;
    m.as.imu_attitude =
        (auvid_can_imu_attitude_t){swing(0) / 10, swing(1) / 10, 3 * swing(2), age()};
    give(&m);
    m.kind = AUVID_CAN_IMU_RATES;
    m.as.imu_rates = (auvid_can_imu_rates_t){swing(3) / 10, swing(4) / 10, swing(5) / 2, age()};
    give(&m);
    for (int half = 0; half < 2; ++half) {
        m.kind = half ? AUVID_CAN_THRUSTER_FEEDBACK_B : AUVID_CAN_THRUSTER_FEEDBACK_A;
        for (int i = 0; i < 4; ++i) {
            m.as.thruster_feedback_a.thrust[i] = swing(6 + i + 4 * half);
        }
        give(&m);
    }
    if (due(10)) {
        m.kind = manner >= CHANCE && draw(2) ? AUVID_CAN_DVL_WATER : AUVID_CAN_DVL_BOTTOM;
        m.as.dvl_bottom = (auvid_can_dvl_bottom_t){swing(14), swing(15) / 2, swing(16) / 2, age()};
        give(&m);
        m.kind = AUVID_CAN_DVL_ALTITUDE;
        m.as.dvl_altitude = (auvid_can_dvl_altitude_t){20 + 10 * swing(17), age()};
        give(&m);
    }
    if (due(5)) {
        m.kind = AUVID_CAN_DEPTH;
        m.as.depth = (auvid_can_depth_t){5 + swing(18), age()};
        give(&m);
    }
    if (due(50)) {
        m.kind = AUVID_CAN_GPS;
        m.as.gps = (auvid_can_gps_t){swing(19), swing(20), age()};
        give(&m);
    }
}

static void give_orders(void)
{
    auvid_can_message_t m;
    memset(&m, 0, sizeof m);
    if (tick % 50 == 0) {
        m.kind = AUVID_CAN_ARM;
        m.as.arm = (auvid_can_arm_t){AUVID_CAN_ACTION_ARM, AUVID_CAN_ARM_KEY};
        if (actuation.guard.state == AUVID_GUARD_ABORTED || (manner == HARM && draw(4) == 0)) {
            m.as.arm.action = draw(3);
        }
        give(&m);
    }
    if (manner == HARM && draw(500) == 0) {
        m.kind = AUVID_CAN_ABORT;
        m.as.abort.cause = draw(32);
        give(&m);
    }
    m.kind = AUVID_CAN_TICK;
    m.as.tick = (auvid_can_tick_t){tick & 0xFFFFFu, (uint32_t)t_us};
    if (manner != HARM || draw(20) != 0) {
        give(&m);
    }
}

static void test_no_frames_make_a_node_use_more_than_its_budget(void)
{
    auvid_node_config_t bus;
    uint32_t end = ticks();
    auvid_node_defaults(&bus);
    bus.answer = true;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &bus, &auvid_allocation_girona500, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&node, &actuation, &acting));
    while (tick < end) {
        next_tick();
        give_sensors();
        give_orders();
    }
    /* It worked all the time, and excited. */
    TEST_ASSERT_TRUE(node.counters.ticks > end / 2);
    TEST_ASSERT_TRUE(node.id.metric.sets.recorded > end / 1000);
    TEST_ASSERT_TRUE(node.id.work.searches > end / 2000);
    TEST_ASSERT_TRUE(exciting > end / 2);
    TEST_ASSERT_TRUE(node.counters.refused > 0 && node.counters.samples_dropped > 0);
}

/* ---- an identifier and samples ---- */

/* In HARM: infinite, NaN, huge, tiny. */
static auvid_real_t value(auvid_real_t good)
{
    static const auvid_real_t bad[] = {AUVID_C(1e30), AUVID_C(-1e30), AUVID_C(1e-40), AUVID_C(1e9)};
    uint32_t which = manner == HARM ? draw(60) : 60;
    return which < 4    ? bad[which]
           : which == 4 ? (auvid_real_t)NAN
           : which == 5 ? (auvid_real_t)INFINITY
                        : good;
}

static uint64_t sample_time(void)
{
    return manner >= CHANCE && draw(5) == 0 ? t_us + draw(100000) - 90000u : t_us;
}

static void sense(auvid_input_t *in)
{
    memset(in, 0, sizeof *in);
    in->t_us = t_us;
    in->imu.present = due(1);
    in->imu.t_us = sample_time();
    in->dvl.present = due(10);
    in->dvl.sample.t_us = sample_time();
    in->dvl.sample.lock = manner >= CHANCE ? (auvid_dvl_lock_t)draw(4) : AUVID_DVL_BOTTOM;
    in->dvl.sample.valid = manner >= CHANCE ? (uint8_t)draw(16) : AUVID_DVL_ALL;
    in->depth.present = due(5);
    in->depth.t_us = sample_time();
    in->depth.depth_m = value(5 + swing(18));
    in->gps.present = due(50);
    in->gps.t_us = sample_time();
    in->gps.x_m = value(swing(19));
    in->gps.y_m = value(swing(20));
    in->altitude.present = due(10);
    in->altitude.t_us = sample_time();
    in->altitude.altitude_m = value(20);
    in->applied.present = due(1);
    for (int j = 0; j < 3; ++j) {
        in->imu.attitude[j] = value(swing(j) / 10);
        in->imu.rates[j] = value(swing(3 + j) / 10);
        in->dvl.sample.velocity[j] = value(swing(14 + j));
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        in->applied.wrench[j] = value(100 * swing(6 + j));
    }
}

static void test_no_samples_make_an_identifier_use_more_than_its_budget(void)
{
    auvid_input_t in;
    auvid_output_t out;
    uint32_t end = ticks();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &auvid_allocation_girona500));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_actuation(&id, &actuation, &acting, &allocation));
    while (tick < end) {
        uint32_t units = budget();
        next_tick();
        sense(&in);
        if (tick % 50 == 0 && auvid_identifier_arm(&id) != AUVID_OK && draw(4) == 0) {
            (void)auvid_identifier_disarm(&id);
        }
        (void)auvid_identifier_excite(&id);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            TEST_ASSERT_TRUE(fabs((double)out.excitation[j]) <= 1000);
        }
        (void)auvid_identifier_work(&id, units);
        TEST_ASSERT_TRUE(id.work.last_units <= units);
        exciting += actuation.guard.state == AUVID_GUARD_EXCITING;
        if (manner == HARM && draw(1000) == 0) {
            (void)auvid_identifier_close(&id);
        }
    }
    /* This motion has nothing to do with the wrench, so the cells become longer. */
    uint32_t longer = id.metric.result.doublings;
    TEST_ASSERT_TRUE(id.metric.sets.recorded << longer > end / 1000);
    TEST_ASSERT_TRUE(id.work.searches << longer > end / 2000);
    TEST_ASSERT_TRUE(exciting > end / 2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_frames_make_a_node_use_more_than_its_budget);
    RUN_TEST(test_no_samples_make_an_identifier_use_more_than_its_budget);
    return UNITY_END();
}
