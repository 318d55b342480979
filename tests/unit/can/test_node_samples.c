/*
 * The effect of frames on the node. An identifier that receives the same samples by calls reaches
 * the same state, byte for byte of its checkpoint, and gives the same commands.
 */
#include <math.h>
#include <string.h>

#include "auvid/checkpoint.h"
#include "auvid/node.h"
#include "base/auvid_math_internal.h"
#include "unity.h"

enum { THRUSTERS = 5, TICK_US = 20000, ARMED = 200 };

static auvid_node_t node;
static auvid_identifier_t id;
static auvid_actuation_t actuation[2]; /* of the node and of the identifier, if `excite` */
static auvid_actuation_config_t acting;
static auvid_allocation_t allocation;
static auvid_allocation_config_t thrusters;
static bool excite;
static auvid_identifier_config_t cfg;
static auvid_node_config_t node_config;
static auvid_input_t in; /* of the reference identifier */
static auvid_output_t out;
static auvid_real_t thrust[8]; /* of the last feedback */
static auvid_can_sender_t sender;
static auvid_rng_t rng;
static struct {
    uint32_t ticks;
    uint32_t unknown_age, dropped; /* samples */
    double largest;                /* maximum thrust of the node in the last tick */
    unsigned halves;               /* of the feedback that wait, a bit each */
    bool arm;
    double altitude_m, depth_m;
} run;
static uint8_t saved[2][AUVID_CHECKPOINT_MAX(0)];

void setUp(void)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {60, 40, 30, 0, 0, 20};
    memset(&run, 0, sizeof run);
    memset(thrust, 0, sizeof thrust);
    run.altitude_m = 20;
    run.depth_m = 5;
    auvid_rng_seed(&rng, 1);
    auvid_identifier_defaults(&cfg, &auvid_girona500);
    thrusters = auvid_allocation_girona500;
    excite = false;
    auvid_actuation_defaults(&acting);
    for (int i = 0; i < THRUSTERS; ++i) { /* each has a different, smaller force backwards */
        thrusters.thruster[i].min_N *= AUVID_C(0.5) + AUVID_C(0.07) * (auvid_real_t)i;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_plan(&acting.excitation, amplitude, 20, 2, 1));
    auvid_node_defaults(&node_config);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
}

void tearDown(void)
{
}

static void begin(void)
{
    for (int j = 0; j < AUVID_DOF_COUNT && !excite; ++j) { /* only the node knows the thrusters */
        cfg.metric.tau_max[j] = 100;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &node_config, &thrusters, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    if (excite) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&node, &actuation[0], &acting));
        TEST_ASSERT_EQUAL(
            AUVID_OK, auvid_identifier_attach_actuation(&id, &actuation[1], &acting, &allocation));
    }
}

static bool chance(double p)
{
    return (double)auvid_rng_uniform(&rng) < p;
}

/* Sends the message to the node as a frame, then rounds it to the values of the frame. */
static auvid_status_t give(auvid_can_message_t *m)
{
    auvid_can_frame_t frame;
    TEST_ASSERT_TRUE(auvid_can_pack(&sender, m, &frame) >= 0);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &frame, m));
    return auvid_node_take(&node, &frame);
}

/* Mostly small, sometimes too old for any use, sometimes unknown. */
static uint32_t draw_age(void)
{
    return chance(0.02) ? AUVID_CAN_AGE_UNKNOWN : chance(0.02) ? 1022u : auvid_rng_below(&rng, 10);
}

/* Returns true if the sample is used; sets its time for the call. */
static bool dated(uint32_t age, uint64_t *t_us)
{
    run.unknown_age += age == AUVID_CAN_AGE_UNKNOWN;
    *t_us = in.t_us > 1000u * age ? in.t_us - 1000u * age : 0;
    return age != AUVID_CAN_AGE_UNKNOWN;
}

static void imu(double t)
{
    auvid_can_message_t a = {.kind = AUVID_CAN_IMU_ATTITUDE}, r = {.kind = AUVID_CAN_IMU_RATES};
    uint32_t age = auvid_rng_below(&rng, 10);
    a.as.imu_attitude = (auvid_can_imu_attitude_t){.phi = (auvid_real_t)(0.03 * sin(0.9 * t)),
                                                   .theta = (auvid_real_t)(0.02 * cos(0.7 * t)),
                                                   .psi = (auvid_real_t)(0.5 * sin(0.2 * t)),
                                                   .age = age};
    r.as.imu_rates = (auvid_can_imu_rates_t){.p = (auvid_real_t)(0.027 * cos(0.9 * t)),
                                             .q = (auvid_real_t)(-0.014 * sin(0.7 * t)),
                                             .r = (auvid_real_t)(0.1 * cos(0.2 * t)),
                                             .age = age};
    TEST_ASSERT_EQUAL(AUVID_OK, give(&a));
    TEST_ASSERT_EQUAL(AUVID_OK, give(&r));
    in.imu.present = dated(age, &in.imu.t_us);
    in.imu.attitude[0] = a.as.imu_attitude.phi;
    in.imu.attitude[1] = a.as.imu_attitude.theta;
    in.imu.attitude[2] = a.as.imu_attitude.psi;
    in.imu.rates[0] = r.as.imu_rates.p;
    in.imu.rates[1] = r.as.imu_rates.q;
    in.imu.rates[2] = r.as.imu_rates.r;
}

static void dvl(double t)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_DVL_BOTTOM};
    m.as.dvl_bottom = (auvid_can_dvl_bottom_t){.u = (auvid_real_t)(0.3 * sin(0.3 * t)),
                                               .v = (auvid_real_t)(0.2 * sin(0.4 * t)),
                                               .w = (auvid_real_t)(0.1 * sin(0.5 * t)),
                                               .age = draw_age()};
    m.absent = chance(0.1) ? AUVID_CAN_DVL_BOTTOM_NO_W : 0u;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    in.dvl.present = dated(m.as.dvl_bottom.age, &in.dvl.sample.t_us);
    in.dvl.sample.velocity[0] = m.as.dvl_bottom.u;
    in.dvl.sample.velocity[1] = m.as.dvl_bottom.v;
    in.dvl.sample.velocity[2] = m.as.dvl_bottom.w;
    in.dvl.sample.valid = m.absent != 0 ? AUVID_DVL_X | AUVID_DVL_Y : AUVID_DVL_ALL;
    in.dvl.sample.lock = AUVID_DVL_BOTTOM;
}

static void dvl_water(double t)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_DVL_WATER};
    m.as.dvl_water = (auvid_can_dvl_water_t){.u = (auvid_real_t)(0.1 + 0.3 * sin(0.3 * t)),
                                             .v = (auvid_real_t)(0.2 * sin(0.4 * t)),
                                             .w = (auvid_real_t)(0.1 * sin(0.5 * t)),
                                             .age = draw_age()};
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    in.dvl_water.present = dated(m.as.dvl_water.age, &in.dvl_water.sample.t_us);
    in.dvl_water.sample.velocity[0] = m.as.dvl_water.u;
    in.dvl_water.sample.velocity[1] = m.as.dvl_water.v;
    in.dvl_water.sample.velocity[2] = m.as.dvl_water.w;
    in.dvl_water.sample.valid = AUVID_DVL_ALL;
    in.dvl_water.sample.lock = AUVID_DVL_WATER;
}

static void depth(double t)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_DEPTH};
    m.as.depth = (auvid_can_depth_t){(auvid_real_t)(run.depth_m - 0.2 * cos(0.5 * t)), draw_age()};
    m.absent = chance(0.05) ? AUVID_CAN_DEPTH_NO_DEPTH : 0u;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    in.depth.present = m.absent == 0 && dated(m.as.depth.age, &in.depth.t_us);
    in.depth.depth_m = m.as.depth.depth;
}

static void gps(double t)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_GPS};
    m.as.gps = (auvid_can_gps_t){(auvid_real_t)(10.0 - cos(0.3 * t)),
                                 (auvid_real_t)(-5.0 - 0.5 * cos(0.4 * t)), draw_age()};
    m.absent = chance(0.1) ? (chance(0.5) ? AUVID_CAN_GPS_NO_X : AUVID_CAN_GPS_NO_Y) : 0u;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    in.gps.present = m.absent == 0 && dated(m.as.gps.age, &in.gps.t_us);
    in.gps.x_m = m.as.gps.x;
    in.gps.y_m = m.as.gps.y;
}

static void altitude(void)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_DVL_ALTITUDE};
    m.as.dvl_altitude = (auvid_can_dvl_altitude_t){(auvid_real_t)run.altitude_m, draw_age()};
    m.absent = chance(0.05) ? AUVID_CAN_DVL_ALTITUDE_NO_ALTITUDE : 0u;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    in.altitude.present = m.absent == 0 && dated(m.as.dvl_altitude.age, &in.altitude.t_us);
    in.altitude.altitude_m = m.as.dvl_altitude.altitude;
}

/* Sometimes of one half only: it waits for the other one, but is lost if it comes again before. */
static void feedback(void)
{
    for (int half = 0; half < 2; ++half) {
        auvid_can_message_t m = {.kind = AUVID_CAN_THRUSTER_FEEDBACK_A};
        auvid_real_t *of = m.as.thruster_feedback_a.thrust; /* b has the same layout */
        if (chance(0.1)) {
            continue;
        }
        for (int i = 0; i < 4; ++i) {
            of[i] = auvid_rng_uniform(&rng) - AUVID_C(0.5);
        }
        m.kind = half == 0 ? AUVID_CAN_THRUSTER_FEEDBACK_A : AUVID_CAN_THRUSTER_FEEDBACK_B;
        TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
        memcpy(thrust + 4 * half, of, 4 * sizeof of[0]);
        run.dropped += run.halves == 1u << half;
        run.halves |= 1u << half;
    }
}

/* The feedback acted from the previous tick on. */
static void apply(uint64_t before_us)
{
    auvid_real_t force_N[AUVID_MAX_THRUSTERS] = {0}, wrench[AUVID_DOF_COUNT];
    auvid_real_t command[AUVID_MAX_COMMANDS] = {0};
    for (int i = 0; i < THRUSTERS; ++i) {
        const auvid_thruster_t *t = &thrusters.thruster[i];
        force_N[i] = thrust[i] > 0 ? thrust[i] * t->max_N : -thrust[i] * t->min_N;
        if (i < AUVID_MAX_COMMANDS) {
            command[i] = thrust[i];
        }
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_wrench(&allocation, force_N, wrench));
    run.dropped += auvid_identifier_applied(&id, before_us, wrench, command) < 0;
}

/* The node's commands are the forces of the identifier, each divided by the thruster's maximum in
 * that direction. */
static void check_commands(const auvid_can_frame_t *frame, int count)
{
    double force_N[8] = {0};
    run.largest = 0.0;
    for (int k = 0; k < count; ++k) {
        auvid_can_message_t m;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &frame[k], &m));
        int half = m.kind == AUVID_CAN_THRUSTER_COMMAND_B;
        for (int i = 4 * half; i < 4 * half + 4; ++i) {
            double part = (double)m.as.thruster_command_a.thrust[i - 4 * half];
            run.largest = fmax(run.largest, fabs(part));
            TEST_ASSERT_TRUE(i < THRUSTERS || part == 0.0);
            const auvid_thruster_t *t = &thrusters.thruster[i < THRUSTERS ? i : 0];
            force_N[i] = part > 0.0 ? part * (double)t->max_N : -part * (double)t->min_N;
        }
    }
    for (int i = 0; i < THRUSTERS; ++i) { /* half a step of 1/4000 */
        double step_N = (double)thrusters.thruster[i].max_N / 7999.0;
        TEST_ASSERT_TRUE(fabs(force_N[i] - (double)out.thruster_N[i]) <= step_N);
    }
}

static void count_dropped(void)
{
    static const uint32_t dropped[] = {AUVID_EVENT_IMU_DROPPED,   AUVID_EVENT_DVL_DROPPED,
                                       AUVID_EVENT_DEPTH_DROPPED, AUVID_EVENT_GPS_DROPPED,
                                       AUVID_EVENT_INPUT_DROPPED, AUVID_EVENT_ALTITUDE_DROPPED};
    for (int i = 0; i < 6; ++i) {
        run.dropped += (out.events & dropped[i]) != 0;
    }
}

static void arm_both(void)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_ARM};
    m.as.arm.action = AUVID_CAN_ACTION_ARM;
    m.as.arm.key = AUVID_CAN_ARM_KEY;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    run.arm = true;
}

static void tick(void)
{
    auvid_can_frame_t frame[AUVID_NODE_FRAMES];
    int count = -1;
    uint64_t before_us = in.t_us;
    double t = 0.02 * ++run.ticks;
    memset(&in, 0, sizeof in);
    in.t_us = (uint64_t)TICK_US * run.ticks;
    if (run.ticks == 1 || chance(0.95)) {
        imu(t);
    }
    if (chance(0.3)) {
        dvl(t);
    }
    if (chance(0.2)) {
        dvl_water(t);
    }
    if (chance(0.4)) {
        depth(t);
    }
    if (chance(0.05)) {
        gps(t);
    }
    if (chance(0.3)) {
        altitude();
    }
    feedback();
    auvid_can_message_t m = {.kind = AUVID_CAN_TICK};
    m.as.tick = (auvid_can_tick_t){.sequence = run.ticks, .time = (uint32_t)in.t_us};
    TEST_ASSERT_EQUAL(AUVID_TICK, give(&m));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, NULL, frame, &count));
    if (run.halves == 3 && run.ticks > 1) {
        apply(before_us);
    }
    run.halves = run.halves == 3 ? 0 : run.halves;
    if (run.arm) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&id));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&id));
        run.arm = false;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
    count_dropped();
    check_commands(frame, count);
}

static uint32_t save(const auvid_identifier_t *from, uint8_t *to)
{
    auvid_checkpoint_t cursor;
    uint32_t bytes = sizeof saved[0];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_begin(&cursor, from));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_checkpoint_next(&cursor, to, &bytes));
    return bytes;
}

static void go(int ticks)
{
    for (int k = 0; k < ticks; ++k) {
        tick();
        if (k % 50 == 0 || k + 1 == ticks) {
            uint32_t bytes = save(&id, saved[1]);
            TEST_ASSERT_EQUAL_UINT32(bytes, save(&node.id, saved[0]));
            TEST_ASSERT_EQUAL_MEMORY(saved[1], saved[0], bytes);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(run.ticks, node.counters.ticks);
    TEST_ASSERT_EQUAL_UINT32(run.unknown_age, node.counters.unknown_age);
    TEST_ASSERT_EQUAL_UINT32(run.dropped, node.counters.samples_dropped);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.refused);
}

static void test_frames_have_the_effect_of_calls_with_their_samples(void)
{
    auvid_nav_state_t state;
    run.depth_m = 0.25; /* a fix counts near the surface */
    begin();
    go(3000);
    TEST_ASSERT_TRUE(run.unknown_age > 10 && run.dropped > 10);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&node.id.nav, &state));
    TEST_ASSERT_TRUE(fabs((double)state.position[0] - 10.0) < 3.0);
    TEST_ASSERT_TRUE(fabs((double)state.position[1] + 5.0) < 3.0);
    TEST_ASSERT_TRUE(id.metric.sets.recorded > 0);
}

static void test_frames_have_the_effect_of_calls_with_water_lock(void)
{
    cfg.velocity = AUVID_VELOCITY_WATER;
    begin();
    go(3000);
    TEST_ASSERT_TRUE(id.metric.sets.recorded > 0);
}

static void test_commands_are_the_forces_divided_by_the_maximum_in_that_direction(void)
{
    excite = true;
    begin();
    go(ARMED);
    TEST_ASSERT_TRUE(run.largest == 0.0);
    arm_both();
    double largest = 0.0;
    for (int k = 0; k < 20; ++k) {
        go(50);
        largest = fmax(largest, run.largest);
    }
    TEST_ASSERT_TRUE(largest > 0.1);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, out.guard);
}

static void test_an_altitude_below_the_limit_ends_the_excitation(void)
{
    excite = true;
    begin();
    go(ARMED);
    arm_both();
    go(250);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, actuation[0].guard.state);
    run.altitude_m = 1.9; /* the limit is 2 m */
    go(25);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, actuation[0].guard.state);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ALTITUDE, actuation[0].guard.trip.cause);
    TEST_ASSERT_TRUE(run.largest == 0.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_frames_have_the_effect_of_calls_with_their_samples);
    RUN_TEST(test_frames_have_the_effect_of_calls_with_water_lock);
    RUN_TEST(test_commands_are_the_forces_divided_by_the_maximum_in_that_direction);
    RUN_TEST(test_an_altitude_below_the_limit_ends_the_excitation);
    return UNITY_END();
}
