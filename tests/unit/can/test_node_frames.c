/*
 * The effect of each received frame on the node, and the contents of its own frames.
 */
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

static void begin(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &cfg, &thrusters, &identifier));
    if (!passive) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_attach_actuation(&node, &actuation, &acting));
    }
}

/* Copies the node with its acting half. */
static void copy_node(void)
{
    copy = node;
    copy_actuation = actuation;
    copy.id.actuation = &copy_actuation;
}

static auvid_status_t give(const auvid_can_message_t *m)
{
    auvid_can_frame_t frame;
    TEST_ASSERT_TRUE(auvid_can_pack(&sender, m, &frame) >= 0);
    return auvid_node_take(&node, &frame);
}

static auvid_status_t give_tick(uint32_t sequence, uint32_t t_us)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_TICK};
    m.as.tick.sequence = sequence;
    m.as.tick.time = t_us;
    return give(&m);
}

static void step_at_us(uint32_t sequence, uint32_t t_us)
{
    TEST_ASSERT_EQUAL(AUVID_TICK, give_tick(sequence, t_us));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, NULL, sent, &count));
}

/* Ticks of 20 ms. */
static void step_at(uint32_t sequence)
{
    step_at_us(sequence, 20000 * sequence);
}

/* A tick of the vehicle without the messages of this bit mask. */
static void tick_without(uint32_t kinds)
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

static void go(int ticks)
{
    for (int k = 0; k < ticks; ++k) {
        tick_without(0);
    }
}

static void excite(void)
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

static void give_imu(uint32_t attitude_age, uint32_t rates_age)
{
    auvid_can_message_t a = {.kind = AUVID_CAN_IMU_ATTITUDE}, r = {.kind = AUVID_CAN_IMU_RATES};
    a.as.imu_attitude.age = attitude_age;
    r.as.imu_rates.age = rates_age;
    if (attitude_age != AUVID_CAN_AGE_UNKNOWN) {
        TEST_ASSERT_EQUAL(AUVID_OK, give(&a));
    }
    if (rates_age != AUVID_CAN_AGE_UNKNOWN) {
        TEST_ASSERT_EQUAL(AUVID_OK, give(&r));
    }
}

/* Time of the last attitude and rates used by navigation; 0: none. */
static uint64_t imu_us(void)
{
    auvid_nav_state_t state;
    return auvid_nav_state(&node.id.nav, &state) == AUVID_OK ? state.t_us : 0;
}

/* ---- sensor frames ---- */

static void test_every_value_of_a_sensor_frame_arrives(void)
{
    auvid_can_message_t m;
    begin();
    for (int water = 0; water < 2; ++water) {
        m = (auvid_can_message_t){.kind = water ? AUVID_CAN_DVL_WATER : AUVID_CAN_DVL_BOTTOM};
        auvid_can_dvl_bottom_t *dvl = &m.as.dvl_bottom; /* dvl_water has the same layout */
        dvl->u = 1;
        dvl->v = 2;
        dvl->w = 3;
        dvl->age = 7;
        m.absent = AUVID_CAN_DVL_BOTTOM_NO_V;
        TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    }
    TEST_ASSERT_TRUE(node.in.dvl.present && node.in.dvl_water.present);
    TEST_ASSERT_EQUAL(AUVID_DVL_BOTTOM, node.in.dvl.sample.lock);
    TEST_ASSERT_EQUAL(AUVID_DVL_WATER, node.in.dvl_water.sample.lock);
    TEST_ASSERT_EQUAL(AUVID_DVL_X | AUVID_DVL_Z, node.in.dvl_water.sample.valid);
    TEST_ASSERT_EQUAL(AUVID_DVL_X | AUVID_DVL_Z, node.in.dvl.sample.valid);
    TEST_ASSERT_TRUE(node.in.dvl_water.sample.velocity[0] == 1);
    TEST_ASSERT_TRUE(node.in.dvl_water.sample.velocity[2] == 3);
    m = (auvid_can_message_t){.kind = AUVID_CAN_GPS};
    m.as.gps.x = 4;
    m.as.gps.y = 5;
    m.as.gps.age = 8;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    TEST_ASSERT_TRUE(node.in.gps.present);
    TEST_ASSERT_TRUE(node.in.gps.x_m == 4);
    TEST_ASSERT_TRUE(node.in.gps.y_m == 5);
    TEST_ASSERT_EQUAL_UINT64(8000, node.in.gps.t_us); /* its age until the tick */
    m = (auvid_can_message_t){.kind = AUVID_CAN_DEPTH};
    m.as.depth.depth = 6;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
    TEST_ASSERT_TRUE(node.in.depth.present);
    TEST_ASSERT_TRUE(node.in.depth.depth_m == 6);
}

static void test_attitude_and_rates_arrive_unchanged(void)
{
    auvid_can_message_t a = {.kind = AUVID_CAN_IMU_ATTITUDE}, r = {.kind = AUVID_CAN_IMU_RATES};
    auvid_nav_state_t s;
    begin();
    for (uint32_t k = 1; k <= 2; ++k) {
        a.as.imu_attitude.phi = AUVID_C(0.1);
        a.as.imu_attitude.theta = AUVID_C(-0.2);
        a.as.imu_attitude.psi = AUVID_C(0.3);
        r.as.imu_rates.p = AUVID_C(0.01);
        r.as.imu_rates.q = AUVID_C(-0.02);
        r.as.imu_rates.r = AUVID_C(0.03);
        TEST_ASSERT_EQUAL(AUVID_OK, give(&a));
        TEST_ASSERT_EQUAL(AUVID_OK, give(&r));
        step_at(k);
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&node.id.nav, &s));
    for (int i = 0; i < 3; ++i) {
        static const double attitude[3] = {0.1, -0.2, 0.3}, rates[3] = {0.01, -0.02, 0.03};
        TEST_ASSERT_TRUE(fabs((double)s.attitude[i] - attitude[i]) < 0.00021);
        TEST_ASSERT_TRUE(fabs((double)s.rates[i] - rates[i]) < 0.00026);
    }
}

/* Both halves of an IMU sample, one of them with a missing axis or age: attitude for 0-3, rates for
 * 4-7. */
static void give_wrong_imu(int wrong)
{
    auvid_can_message_t a = {.kind = AUVID_CAN_IMU_ATTITUDE}, r = {.kind = AUVID_CAN_IMU_RATES};
    auvid_can_message_t *m = wrong < 4 ? &a : &r;
    m->absent = wrong % 4 < 3 ? 1u << wrong % 4 : 0u;
    if (wrong % 4 == 3) {
        m->as.imu_attitude.age = AUVID_CAN_AGE_UNKNOWN; /* imu_rates has the same layout */
    }
    TEST_ASSERT_EQUAL(AUVID_OK, give(&a));
    TEST_ASSERT_EQUAL(AUVID_OK, give(&r));
}

/* Half a sample is no sample. */
static void test_an_imu_sample_with_a_missing_axis_or_age_is_ignored(void)
{
    for (int wrong = 0; wrong < 8; ++wrong) {
        begin();
        give_wrong_imu(wrong);
        step_at(100);
        TEST_ASSERT_EQUAL_UINT64(0, imu_us());
        TEST_ASSERT_EQUAL_UINT32(wrong % 4 == 3, node.counters.unknown_age);
    }
}

static void test_the_age_of_a_sample_is_that_of_its_frame(void)
{
    auvid_can_message_t m;
    begin();
    for (uint32_t k = 1; k <= 100; ++k) {
        give_imu(0, 0);
        m = (auvid_can_message_t){.kind = AUVID_CAN_DEPTH};
        m.as.depth.depth = 10;
        m.as.depth.age = 30;
        TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
        m = (auvid_can_message_t){.kind = AUVID_CAN_DVL_WATER};
        m.as.dvl_water.age = 50;
        TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
        m = (auvid_can_message_t){.kind = AUVID_CAN_DVL_ALTITUDE};
        m.as.dvl_altitude.altitude = 12;
        m.as.dvl_altitude.age = 70;
        TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
        step_at(k);
    }
    TEST_ASSERT_EQUAL_UINT64(2000000, imu_us());
    TEST_ASSERT_EQUAL_UINT64(1970000, node.id.nav.diagnostics[AUVID_NAV_DEPTH].good_us);
    TEST_ASSERT_EQUAL_UINT64(1950000, node.id.nav.diagnostics[AUVID_NAV_DVL_WATER].good_us);
    TEST_ASSERT_EQUAL_UINT64(1930000, actuation.altitude.t_us);
    TEST_ASSERT_TRUE(actuation.altitude_m == 12);
}

static void test_samples_without_an_age_or_a_value_are_ignored(void)
{
    static const auvid_can_kind_t kinds[] = {AUVID_CAN_DVL_BOTTOM, AUVID_CAN_DVL_WATER,
                                             AUVID_CAN_DVL_ALTITUDE, AUVID_CAN_DEPTH,
                                             AUVID_CAN_GPS};
    begin();
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; ++i) {
        auvid_can_message_t m = {.kind = kinds[i]};
        if (kinds[i] == AUVID_CAN_DVL_BOTTOM || kinds[i] == AUVID_CAN_DVL_WATER) {
            m.as.dvl_bottom.age = AUVID_CAN_AGE_UNKNOWN;
        } else if (kinds[i] == AUVID_CAN_GPS) {
            m.as.gps.age = AUVID_CAN_AGE_UNKNOWN;
        } else {
            m.as.depth.age = AUVID_CAN_AGE_UNKNOWN; /* dvl_altitude has the same layout */
        }
        TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
        TEST_ASSERT_EQUAL_UINT32(i + 1, node.counters.unknown_age);
        if (i >= 2) {
            m = (auvid_can_message_t){.kind = kinds[i], .absent = 1};
            TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
        }
    }
    TEST_ASSERT_FALSE(node.in.dvl.present || node.in.dvl_water.present || node.in.gps.present ||
                      node.in.altitude.present || node.in.depth.present);
}

static void test_an_age_beyond_the_time_of_the_tick_gives_time_0(void)
{
    begin();
    give_imu(1000, 1000);
    step_at(1);
    TEST_ASSERT_EQUAL_UINT64(0, imu_us());
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.samples_dropped);
}

static void test_halves_of_an_imu_sample_are_up_to_30_ms_apart(void)
{
    for (uint32_t gap_ms = 29; gap_ms <= 31; ++gap_ms) {
        for (int attitude_older = 0; attitude_older < 2; ++attitude_older) {
            begin();
            step_at(100);
            give_imu(attitude_older ? gap_ms : 0, attitude_older ? 0 : gap_ms);
            step_at(101);
            TEST_ASSERT_EQUAL_UINT64(gap_ms <= 30 ? 2020000 : 0, imu_us());
            if (gap_ms > 30) { /* the later half waits for its other half */
                give_imu(attitude_older ? 10 : AUVID_CAN_AGE_UNKNOWN,
                         attitude_older ? AUVID_CAN_AGE_UNKNOWN : 10);
                step_at(102);
                TEST_ASSERT_EQUAL_UINT64(2030000, imu_us());
            }
        }
    }
}

static void test_halves_of_different_ticks_are_at_most_30000_us_apart(void)
{
    for (uint32_t more = 0; more < 2; ++more) {
        begin();
        step_at_us(1, 1000000);
        give_imu(0, AUVID_CAN_AGE_UNKNOWN);
        step_at_us(2, 1020000);
        give_imu(AUVID_CAN_AGE_UNKNOWN, 0);
        step_at_us(3, 1050000 + more);
        TEST_ASSERT_EQUAL_UINT64(more == 0 ? 1050000 : 0, imu_us());
    }
}

static void test_one_half_of_an_imu_sample_waits_for_the_other(void)
{
    for (int half = 0; half < 2; ++half) {
        begin();
        give_imu(0, 0);
        step_at(100);
        give_imu(half == 0 ? 0 : AUVID_CAN_AGE_UNKNOWN, half == 1 ? 0 : AUVID_CAN_AGE_UNKNOWN);
        step_at(101);
        TEST_ASSERT_EQUAL_UINT64(2000000, imu_us());
        give_imu(half == 1 ? 20 : AUVID_CAN_AGE_UNKNOWN, half == 0 ? 20 : AUVID_CAN_AGE_UNKNOWN);
        step_at(102);
        TEST_ASSERT_EQUAL_UINT64(2020000, imu_us());
        TEST_ASSERT_EQUAL_UINT32(0, node.counters.samples_dropped);
    }
}

static void test_a_half_that_waits_keeps_its_values(void)
{
    auvid_can_message_t a = {.kind = AUVID_CAN_IMU_ATTITUDE};
    auvid_nav_state_t s;
    a.as.imu_attitude.phi = AUVID_C(0.25);
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, give(&a));
    step_at(100);
    give_imu(AUVID_CAN_AGE_UNKNOWN, 20);
    step_at(101);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&node.id.nav, &s));
    TEST_ASSERT_TRUE(fabs((double)s.attitude[0] - 0.25) < 0.00021);
}

static void test_the_earlier_of_two_halves_too_far_apart_is_dropped(void)
{
    for (int half = 0; half < 2; ++half) {
        begin();
        give_imu(half == 0 ? 50 : 0, half == 1 ? 50 : 0);
        step_at(100);
        give_imu(half == 1 ? 70 : AUVID_CAN_AGE_UNKNOWN, half == 0 ? 70 : AUVID_CAN_AGE_UNKNOWN);
        step_at(101); /* at the same time as the dropped one */
        TEST_ASSERT_EQUAL_UINT64(0, imu_us());
    }
}

/* An incomplete half must not end the wait of the other one. */
static void test_a_half_with_a_missing_axis_or_age_counts_as_not_sent(void)
{
    for (int wrong = 0; wrong < 8; ++wrong) {
        begin();
        give_wrong_imu(wrong);
        step_at(100);
        give_imu(wrong < 4 ? 20 : AUVID_CAN_AGE_UNKNOWN, wrong < 4 ? AUVID_CAN_AGE_UNKNOWN : 20);
        step_at(101);
        TEST_ASSERT_EQUAL_UINT64(2000000, imu_us());
    }
}

static void test_an_imu_sample_that_navigation_refuses_is_counted(void)
{
    begin();
    give_imu(0, 0);
    step_at(100);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.samples_dropped);
    give_imu(100, 100); /* earlier than the last one */
    step_at(101);
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.samples_dropped);
}

static void test_an_imu_sample_is_used_once(void)
{
    begin();
    go(NAVIGATED);
    uint64_t last = imu_us();
    for (int k = 0; k < 5; ++k) {
        tick_without(~(1u << AUVID_CAN_TICK)); /* others would be later than it */
    }
    TEST_ASSERT_EQUAL_UINT64(last, imu_us());
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.samples_dropped);
}

static void test_each_lost_tick_is_counted(void)
{
    begin();
    step_at(5);
    step_at(6);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.ticks_missed);
    step_at(10);
    TEST_ASSERT_EQUAL_UINT32(3, node.counters.ticks_missed);
}

/* Up to a second ahead is a pause; more is a clock step. */
static void test_a_clock_that_advances_more_than_a_second_was_set(void)
{
    for (uint32_t more = 0; more < 2; ++more) {
        auvid_can_message_t m = {.kind = AUVID_CAN_TICK};
        begin();
        step_at(1);
        m.as.tick.sequence = 2;
        m.as.tick.time = 20000 + 1000000 + more;
        TEST_ASSERT_EQUAL(AUVID_TICK, give(&m));
        TEST_ASSERT_EQUAL_UINT32(more, node.counters.clock_steps);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, NULL, sent, &count));
        TEST_ASSERT_EQUAL_UINT64(1020000, node.t_us); /* time continues a second later */
    }
}

static void test_a_clock_that_stands_still_was_set(void)
{
    begin();
    step_at_us(1, 5000000);
    step_at_us(2, 5000000);
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.clock_steps);
    TEST_ASSERT_EQUAL_UINT64(6000000, node.t_us);
}

static void test_ticks_may_start_at_any_number_and_wrap_to_0(void)
{
    begin();
    for (uint32_t k = 0; k < 4; ++k) {
        step_at_us((0xFFFFEu + k) & 0xFFFFFu, 20000 * (k + 1));
    }
    TEST_ASSERT_EQUAL_UINT32(4, node.counters.ticks);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.ticks_missed);
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.refused);
}

static void test_a_tick_up_to_15_behind_is_late_and_one_further_behind_restarts(void)
{
    for (uint32_t behind = 0; behind < 20; ++behind) {
        begin();
        step_at(100);
        TEST_ASSERT_EQUAL(behind < 16 ? AUVID_ERR_STALE : AUVID_TICK,
                          give_tick(100 - behind, 20000 * (100 - behind)));
        TEST_ASSERT_EQUAL_UINT32(behind < 16, node.counters.refused);
        TEST_ASSERT_EQUAL_UINT32(behind >= 16, node.counters.clock_steps);
    }
}

/* ---- the node's own clock ---- */

static void test_a_node_s_own_clock_may_start_at_0(void)
{
    uint64_t t_us = 0;
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, &t_us, sent, &count));
    TEST_ASSERT_EQUAL(1, count);
    TEST_ASSERT_EQUAL(AUVID_CAN_TICK, auvid_can_kind(NULL, sent[0].id));
}

static void test_a_node_s_own_tick_at_the_same_time_is_refused(void)
{
    uint64_t t_us = 1000000;
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, &t_us, sent, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_TIME_SAME, auvid_node_step(&node, NULL, sent, &count));
}

/* ---- sensors ---- */

static void test_a_sample_of_every_sensor_reaches_the_filter_with_its_values_and_age(void)
{
#define KIND(name, ...) [AUVID_NAV_##name] = AUVID_CAN_##name,
    static const auvid_can_kind_t kind[AUVID_NAV_SENSOR_COUNT] = {AUVID_SENSORS(KIND)};
    const auvid_real_t value[3] = {(auvid_real_t)0.1, (auvid_real_t)0.2, (auvid_real_t)0.3};
    const uint32_t age_ms = 70;
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        auvid_can_message_t m = {.kind = kind[i]};
        size_t bytes = auvid_input_places[i].values * sizeof value[0];
        memcpy(&m.as, value, bytes);
        memcpy((char *)&m.as + bytes, &age_ms, sizeof age_ms);
        begin();
        TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
        TEST_ASSERT_TRUE(auvid_input_has(&node.in, i));
        const uint64_t *age_us = INPUT_AT(&node.in, i, t_us);
        const auvid_real_t *got = INPUT_AT(&node.in, i, value);
        TEST_ASSERT_EQUAL_UINT64(70000, *age_us);
        for (int j = 0; j < auvid_input_places[i].values; ++j) {
            TEST_ASSERT_DOUBLE_WITHIN(0.051, (double)value[j], (double)got[j]);
        }
        give_imu(0, 0);
        step_at(50);
        const auvid_nav_diagnostics_t *d = &node.id.nav.diagnostics[i];
        TEST_ASSERT_EQUAL_UINT32(1, d->accepted);
        TEST_ASSERT_EQUAL_UINT64(930000, d->good_us);
        TEST_ASSERT_EQUAL_UINT8(auvid_input_places[i].values, d->innovation_count);
    }
}

/* ---- refused and unused frames ---- */

static void test_a_message_that_a_node_does_not_receive_is_unused(void)
{
    begin();
    for (int kind = 0; kind < AUVID_CAN_KINDS; ++kind) {
        auvid_can_message_t m = {.kind = (auvid_can_kind_t)kind};
        if (auvid_can_node_kind(m.kind) == AUVID_CAN_NODE_KINDS) {
            TEST_ASSERT_EQUAL(AUVID_UNUSED, give(&m));
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.frames + node.counters.refused);
}

static void test_a_sensor_frame_whose_counter_is_repeated_or_jumps_is_refused(void)
{
    for (uint8_t step = 0; step < 16; ++step) {
        auvid_can_message_t m = {.kind = AUVID_CAN_DEPTH};
        bool good = step >= 1 && step <= AUVID_CAN_LARGEST_STEP;
        begin();
        m.as.depth.depth = 6;
        sender.counter[AUVID_CAN_DEPTH] = 3;
        TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
        node.in.depth.present = false;
        sender.counter[AUVID_CAN_DEPTH] = (uint8_t)((3 + step) % 16);
        TEST_ASSERT_EQUAL(good        ? AUVID_OK
                          : step == 0 ? AUVID_ERR_REPEATED
                                      : AUVID_ERR_COUNTER_JUMP,
                          give(&m));
        TEST_ASSERT_EQUAL(good, node.in.depth.present);
        TEST_ASSERT_EQUAL_UINT32(!good, node.counters.refused);
        TEST_ASSERT_EQUAL_UINT32(good ? 2 : 1, node.counters.frames);
    }
}

/* It is no echo of a command either: none has been sent. */
static void test_a_sensor_frame_of_zeros_is_refused(void)
{
    for (int kind = AUVID_CAN_IMU_ATTITUDE; kind < AUVID_CAN_KINDS; ++kind) {
        auvid_can_frame_t frame = {.length = AUVID_CAN_BYTES};
        frame.id = auvid_can_id(&cfg.ids, (auvid_can_kind_t)kind);
        begin();
        bool received = auvid_can_node_kind((auvid_can_kind_t)kind) != AUVID_CAN_NODE_KINDS;
        TEST_ASSERT_EQUAL(received ? AUVID_ERR_CHECKSUM : AUVID_UNUSED,
                          auvid_node_take(&node, &frame));
        TEST_ASSERT_EQUAL_UINT32(received, node.counters.refused);
    }
}

static void test_null_is_refused(void)
{
    auvid_can_frame_t frame = {0};
    uint64_t t_us = 1000000;
    begin();
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_take(NULL, &frame));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_take(&node, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_step(NULL, &t_us, sent, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_step(&node, &t_us, NULL, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_step(&node, &t_us, sent, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_work(NULL, 1));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_report(NULL, 0, sent, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_report(&node, 0, NULL, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_report(&node, 0, sent, NULL));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_halt(NULL, sent, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_halt(&node, NULL, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_halt(&node, sent, NULL));
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.ticks);
}

/* ---- init ---- */

static void test_after_an_init_that_fails_every_function_refuses_the_node(void)
{
    uint64_t t_us = 1000000;
    auvid_can_message_t m = {.kind = AUVID_CAN_DEPTH};
    begin();
    cfg.ids.slow = cfg.ids.fast;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_node_init(&node, &cfg, &thrusters, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, give(&m));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_step(&node, &t_us, sent, &count));
    TEST_ASSERT_EQUAL(0, count);
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_work(&node, 1));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_report(&node, 0, sent, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_node_halt(&node, sent, &count));
}

static void test_one_to_eight_thrusters_are_accepted(void)
{
    for (uint8_t count_of = 0; count_of <= AUVID_CAN_THRUSTERS + 1; ++count_of) {
        for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
            thrusters.thruster[i] = auvid_allocation_girona500.thruster[i % 5];
        }
        thrusters.thrusters = count_of;
        bool some = count_of >= 1 && count_of <= AUVID_CAN_THRUSTERS;
        TEST_ASSERT_EQUAL(some ? AUVID_OK : AUVID_ERR_SIZE,
                          auvid_node_init(&node, &cfg, &thrusters, &identifier));
        TEST_ASSERT_EQUAL(some, node.ready);
    }
}

static void test_null_and_overlapping_identifiers_are_refused(void)
{
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_init(NULL, &cfg, &thrusters, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_init(&node, NULL, &thrusters, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_init(&node, &cfg, NULL, &identifier));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_init(&node, &cfg, &thrusters, NULL));
    cfg.ids.slow = cfg.ids.fast;
    TEST_ASSERT_EQUAL(AUVID_ERR_RANGE, auvid_node_init(&node, &cfg, &thrusters, &identifier));
    TEST_ASSERT_FALSE(node.ready);
    memset(&cfg, 0xFF, sizeof cfg);
    auvid_node_defaults(&cfg);
    TEST_ASSERT_FALSE(cfg.answer);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_init(&node, &cfg, &thrusters, &identifier));
}

static void test_after_init_there_is_no_sample(void)
{
    static const auvid_input_t none;
    memset(&node, 0xFF, sizeof node);
    begin();
    TEST_ASSERT_EQUAL_MEMORY(&none, &node.in, sizeof none);
}

/* ---- the guard's altitude ---- */

static void give_altitude(auvid_real_t altitude, uint32_t absent)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_DVL_ALTITUDE, .absent = absent};
    m.as.dvl_altitude.altitude = altitude;
    TEST_ASSERT_EQUAL(AUVID_OK, give(&m));
}

static void test_an_altitude_frame_below_the_limit_ends_the_excitation(void)
{
    excite();
    give_altitude(acting.guard.altitude_min_m, 0);
    tick_without(1u << AUVID_CAN_DVL_ALTITUDE);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, actuation.guard.state);
    give_altitude(acting.guard.altitude_min_m - AUVID_C(0.01), 0);
    tick_without(1u << AUVID_CAN_DVL_ALTITUDE);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, actuation.guard.state);
    TEST_ASSERT_EQUAL(AUVID_GUARD_ALTITUDE, actuation.guard.trip.cause);
    TEST_ASSERT_EQUAL(2, count);
}

static void test_altitude_frames_without_a_value_are_a_lost_altitude(void)
{
    excite();
    for (int k = 0; k < 60; ++k) {
        give_altitude(0, AUVID_CAN_DVL_ALTITUDE_NO_ALTITUDE);
        tick_without(1u << AUVID_CAN_DVL_ALTITUDE);
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_ALTITUDE_STALE, actuation.guard.trip.cause);
}

/* ---- thrust ---- */

static struct {
    int calls;
    uint64_t t_us;
    auvid_real_t command[AUVID_MAX_COMMANDS];
} heard;

static void hear(void *context, uint64_t t_us, const auvid_real_t *command)
{
    (void)context;
    ++heard.calls;
    heard.t_us = t_us;
    memcpy(heard.command, command, sizeof heard.command);
}

static void nothing(void *context, auvid_metric_t *metric)
{
    (void)context;
    (void)metric;
}

static void give_feedback(auvid_real_t first)
{
    auvid_can_message_t a = {.kind = AUVID_CAN_THRUSTER_FEEDBACK_A};
    auvid_can_message_t b = {.kind = AUVID_CAN_THRUSTER_FEEDBACK_B};
    for (int i = 0; i < 4; ++i) {
        a.as.thruster_feedback_a.thrust[i] = first + AUVID_C(0.125) * (auvid_real_t)i;
    }
    b.as.thruster_feedback_b.thrust[0] = AUVID_C(-0.5);
    TEST_ASSERT_EQUAL(AUVID_OK, give(&a));
    TEST_ASSERT_EQUAL(AUVID_OK, give(&b));
}

static void test_thrust_feedback_is_recorded_from_the_previous_tick_on(void)
{
    static const auvid_listener_t listener = {.command = hear, .set = nothing};
    memset(&heard, 0, sizeof heard);
    identifier.listener = &listener;
    begin();
    give_feedback(AUVID_C(0.25));
    step_at(1); /* the start of its action is unknown */
    TEST_ASSERT_EQUAL(0, heard.calls);
    TEST_ASSERT_FALSE(node.id.applied.known);
    give_feedback(AUVID_C(0.25));
    step_at(2);
    TEST_ASSERT_EQUAL(1, heard.calls);
    TEST_ASSERT_EQUAL_UINT64(20000, heard.t_us);
    TEST_ASSERT_EQUAL_UINT64(20000, node.id.applied.t_us);
    for (int i = 0; i < 4; ++i) {
        TEST_ASSERT_TRUE(heard.command[i] == AUVID_C(0.25) + AUVID_C(0.125) * (auvid_real_t)i);
    }
    TEST_ASSERT_TRUE(heard.command[4] == AUVID_C(-0.5));
    step_at(3); /* no feedback */
    TEST_ASSERT_EQUAL(1, heard.calls);
}

static void test_a_thruster_without_feedback_has_zero_thrust(void)
{
    static const auvid_listener_t listener = {.command = hear, .set = nothing};
    memset(&heard, 0, sizeof heard);
    identifier.listener = &listener;
    begin();
    step_at(1);
    for (int absent = 0; absent < 4; ++absent) {
        auvid_can_message_t a = {.kind = AUVID_CAN_THRUSTER_FEEDBACK_A, .absent = 1u << absent};
        for (int i = 0; i < 4; ++i) {
            a.as.thruster_feedback_a.thrust[i] = AUVID_C(0.5);
        }
        TEST_ASSERT_EQUAL(AUVID_OK, give(&a));
        step_at(2 + (uint32_t)absent);
        for (int i = 0; i < 4; ++i) {
            TEST_ASSERT_TRUE(heard.command[i] == (i == absent ? 0 : AUVID_C(0.5)));
        }
    }
}

static void test_thrust_that_the_recorder_refuses_is_counted(void)
{
    thrusters.thruster[0].max_N = AUVID_C(2e9);
    begin();
    step_at(1);
    give_feedback(AUVID_C(0.5));
    step_at(2);
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.samples_dropped);
}

/* A thruster has less force backwards: the commanded fraction refers to its direction. */
static void test_a_command_is_a_fraction_of_the_maximum_in_its_direction(void)
{
    bool forward = false, backward = false;
    for (int i = 0; i < thrusters.thrusters; ++i) {
        thrusters.thruster[i].min_N = -AUVID_C(100.0);
    }
    excite();
    for (int k = 0; k < 400; ++k) {
        tick_without(0);
        copy_node();
        auvid_input_t in = {.t_us = node.t_us + 20000};
        auvid_output_t out;
        auvid_can_message_t m = {.kind = AUVID_CAN_TICK}; /* no sensor: both see the same */
        auvid_can_frame_t frame;
        m.as.tick.sequence = node.sequence + 1;
        m.as.tick.time = (uint32_t)in.t_us;
        sender.counter[AUVID_CAN_TICK] = vehicle_sim.sender.counter[AUVID_CAN_TICK];
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, &m, &frame));
        TEST_ASSERT_EQUAL(AUVID_TICK, auvid_node_take(&copy, &frame));
        static auvid_identifier_t same;
        static auvid_actuation_t same_actuation;
        same = node.id;
        same_actuation = actuation;
        same.actuation = &same_actuation;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&same, &in, &out));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&copy, NULL, sent, &count));
        TEST_ASSERT_EQUAL(2, count);
        for (int i = 0; i < thrusters.thrusters; ++i) {
            auvid_can_message_t c;
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &sent[i / 4], &c));
            const auvid_thruster_t *t = &thrusters.thruster[i];
            auvid_real_t part = c.as.thruster_command_a.thrust[i % 4]; /* b has the same layout */
            auvid_real_t most = part > 0 ? t->max_N : -t->min_N;
            TEST_ASSERT_TRUE(fabs((double)(part * most - out.thruster_N[i])) <=
                             0.51 * (double)most / 4000.0);
            forward = forward || part > AUVID_C(0.1);
            backward = backward || part < -AUVID_C(0.1);
        }
    }
    TEST_ASSERT_TRUE(forward && backward);
}

static auvid_real_t commanded(int thruster)
{
    auvid_can_message_t m;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &sent[thruster / 4], &m));
    TEST_ASSERT_EQUAL_HEX32(0, m.absent);
    return m.as.thruster_command_a.thrust[thruster % 4]; /* b has the same layout */
}

static void test_each_half_with_thrusters_is_commanded_in_every_tick(void)
{
    static const auvid_real_t ahead[AUVID_DOF_COUNT] = {20};
    (void)auvid_excitation_plan(&acting.excitation, ahead, 30, 2, 1);
    thrusters.dofs = AUVID_DOF_BIT(AUVID_SURGE);
    for (uint8_t count_of = 1; count_of <= AUVID_CAN_THRUSTERS; ++count_of) {
        bool driven = false;
        for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
            thrusters.thruster[i] = auvid_allocation_girona500.thruster[i % 2];
        }
        thrusters.thrusters = count_of;
        excite();
        for (int k = 0; k < 20; ++k) {
            tick_without(0);
            TEST_ASSERT_EQUAL(count_of <= 4 ? 1 : 2, count);
            for (int i = 0; i < 4 * count; ++i) {
                TEST_ASSERT_TRUE(i < count_of || commanded(i) == 0);
            }
            driven = driven || commanded(count_of - 1) > 0 || commanded(count_of - 1) < 0;
        }
        TEST_ASSERT_TRUE(driven);
    }
}

/* allocation.h: a thruster without force in either direction has failed. */
static void test_a_failed_thruster_is_commanded_zero_and_a_weak_one_its_fraction(void)
{
    static const auvid_real_t amplitude[AUVID_DOF_COUNT] = {AUVID_C(0.5)};
    bool driven = false;
    (void)auvid_excitation_plan(&acting.excitation, amplitude, 30, 2, 1);
    for (int i = 0; i < 2; ++i) {
        thrusters.thruster[i].max_N = AUVID_C(0.75);
        thrusters.thruster[i].min_N = -AUVID_C(0.75);
    }
    thrusters.thruster[4].max_N = thrusters.thruster[4].min_N = 0;
    excite();
    for (int k = 0; k < 400; ++k) {
        tick_without(0);
        TEST_ASSERT_EQUAL(2, count);
        TEST_ASSERT_TRUE(commanded(4) == 0);
        driven = driven || commanded(0) > AUVID_C(0.1);
    }
    TEST_ASSERT_TRUE(driven);
}

/* The application may arm the identifier and command the thrusters itself. */
static void test_a_passive_node_commands_nothing_though_its_identifier_excites(void)
{
    passive = true;
    begin();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&node.id, &actuation, &acting,
                                                                  &node.allocation));
    go(NAVIGATED);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_arm(&node.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_excite(&node.id));
    for (int k = 0; k < 100; ++k) {
        tick_without(0);
        TEST_ASSERT_EQUAL(0, count);
    }
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, actuation.guard.state);
}

/* ---- reports ---- */

/* The next message of this kind within a cycle of reports. */
static auvid_can_message_t reported(auvid_can_kind_t kind)
{
    auvid_can_message_t m;
    for (int turn = 0; turn < 50; ++turn) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_report(&node, 0, sent, &count));
        for (int i = 0; i < count; ++i) {
            TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &sent[i], &m));
            if (m.kind == kind) {
                return m;
            }
        }
    }
    TEST_FAIL_MESSAGE("not reported");
    return m;
}

static void near(auvid_real_t expected, auvid_real_t got, double step)
{
    TEST_ASSERT_TRUE(fabs((double)(expected - got)) <= 0.51 * step);
}

static void test_the_reported_navigation_is_that_of_the_filter(void)
{
    auvid_nav_state_t s;
    excite();
    go(1000);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_nav_state(&node.id.nav, &s));
    for (int i = 0; i < 3; ++i) { /* all different, so that an exchange is detected */
        TEST_ASSERT_TRUE(fabs((double)s.velocity[i]) > 0.004);
        TEST_ASSERT_TRUE(fabs((double)s.position[i]) > 0.04);
    }
    auvid_can_message_t m = reported(AUVID_CAN_NAV_POSITION);
    near(s.position[0], m.as.nav_position.x, 0.01);
    near(s.position[1], m.as.nav_position.y, 0.01);
    TEST_ASSERT_EQUAL_UINT32(s.flags, m.as.nav_position.flags);
    m = reported(AUVID_CAN_NAV_DEPTH);
    near(s.position[2], m.as.nav_depth.z, 0.002);
    m = reported(AUVID_CAN_NAV_VELOCITY);
    near(s.velocity[0], m.as.nav_velocity.u, 0.001);
    near(s.velocity[1], m.as.nav_velocity.v, 0.001);
    near(s.velocity[2], m.as.nav_velocity.w, 0.001);
}

/* lib/can/auvid.dbc: identified, excited, not converged, identifiable, implausible, accepted. */
static void test_each_flag_of_an_estimate_is_one_bit(void)
{
    auvid_estimate_t *e = &node.id.estimate;
    for (unsigned k = 0; k < 6u * auvid_girona500.parameters; ++k) {
        unsigned bit = k % 6, i = k / 6;
        uint32_t only = 1u << i;
        uint8_t dof = (uint8_t)(1u << auvid_girona500.parameter[i].dof);
        begin();
        node.next.parameter = (uint8_t)i;
        e->identified = bit == 0 ? only : ~only;
        e->excited = (uint8_t)(bit == 1 ? dof : ~dof);
        e->not_converged = bit == 2;
        e->confidence.identifiable = bit == 3 ? only : ~only;
        e->confidence.implausible = bit == 4 ? only : ~only;
        e->accepted = bit == 5;
        auvid_can_message_t m = reported(AUVID_CAN_ESTIMATE);
        TEST_ASSERT_EQUAL_UINT32(i, m.as.estimate.index);
        TEST_ASSERT_EQUAL_HEX32(1u << bit, m.as.estimate.flags);
    }
}

static void test_a_change_and_a_drift_are_reported_alike(void)
{
    begin();
    TEST_ASSERT_EQUAL_HEX32(0, reported(AUVID_CAN_PROGRESS).as.progress.changed);
    node.id.change_test.changed = AUVID_DOF_BIT(AUVID_SWAY);
    TEST_ASSERT_EQUAL_HEX32(2, reported(AUVID_CAN_PROGRESS).as.progress.changed);
    node.id.change_test.drifted = AUVID_DOF_BIT(AUVID_YAW);
    TEST_ASSERT_EQUAL_HEX32(2 | 32, reported(AUVID_CAN_PROGRESS).as.progress.changed);
}

/* An estimate with drag in surge, sway, heave and yaw; the yaw rate was positive only. */
static void know_drag(void)
{
    const auvid_parameter_t *p = auvid_girona500.parameter;
    auvid_estimate_t *e = &node.id.estimate;
    int n = auvid_girona500.parameters;
    begin();
    e->number = 130;
    e->excited = 0x27;
    for (int i = 0, diagonal = 0; i < n; diagonal += n - i, ++i) {
        e->pi[i] = (auvid_real_t)(-10 - 7 * i);
        e->covariance[diagonal] = e->confidence.sigma[i] = 1;
        if (p[i].kind == AUVID_PARAMETER_QUADRATIC_DRAG && p[i].dof == AUVID_SWAY) {
            e->confidence.sigma[i] = AUVID_LARGEST;
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        e->speed[j][0] = (auvid_real_t)(0.5 + 0.1 * j);
        e->speed[j][1] = j == AUVID_YAW ? 0 : (auvid_real_t)(0.4 + 0.1 * j);
    }
}

/* The next pair of drag frames. */
static void next_drag(auvid_can_drag_t *force, auvid_can_drag_half_width_t *half,
                      uint32_t absent[2])
{
    auvid_can_message_t m = reported(AUVID_CAN_DRAG);
    *force = m.as.drag;
    absent[0] = m.absent;
    TEST_ASSERT_EQUAL(2, count); /* the half-width is in the same tick */
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &sent[1], &m));
    TEST_ASSERT_EQUAL(AUVID_CAN_DRAG_HALF_WIDTH, m.kind);
    *half = m.as.drag_half_width;
    absent[1] = m.absent;
}

static void test_the_reported_drag_forces_cycle_and_are_those_of_the_estimate(void)
{
    static const auvid_dof_t dofs[] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    static const double parts[] = {0.3, 0.6, 1.0};
    know_drag();
    const auvid_estimate_t *e = &node.id.estimate;
    int identifiable = 0;
    for (uint32_t k = 0; k < 2 * 24; ++k) {
        uint32_t part = k % 3, backward = k / 3 % 2, absent[2];
        auvid_dof_t dof = dofs[k / 6 % 4];
        auvid_can_drag_t force;
        auvid_can_drag_half_width_t half;
        auvid_drag_t drag;
        next_drag(&force, &half, absent);
        TEST_ASSERT_EQUAL_UINT32(6 * dof + 3 * backward + part, force.point);
        TEST_ASSERT_EQUAL_UINT32(force.point, half.point);
        TEST_ASSERT_EQUAL_UINT32(130 % 128, force.number);
        if (dof == AUVID_YAW && backward) { /* not in the data */
            TEST_ASSERT_EQUAL_HEX32(AUVID_CAN_DRAG_NO_FORCE, absent[0]);
            TEST_ASSERT_EQUAL_HEX32(AUVID_CAN_DRAG_HALF_WIDTH_NO_SPEED |
                                        AUVID_CAN_DRAG_HALF_WIDTH_NO_HALF_WIDTH,
                                    absent[1]);
            TEST_ASSERT_EQUAL_HEX32(0, force.flags);
            continue;
        }
        auvid_real_t speed = (auvid_real_t)parts[part] * e->speed[dof][backward];
        speed = backward ? -speed : speed;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_estimate_drag(e, &auvid_girona500, dof, speed, &drag));
        TEST_ASSERT_EQUAL_FLOAT((float)drag.force, (float)force.force);
        TEST_ASSERT_EQUAL_HEX32(drag.identifiable, force.flags);
        TEST_ASSERT_EQUAL_HEX32(dof == AUVID_SWAY ? AUVID_CAN_DRAG_HALF_WIDTH_NO_HALF_WIDTH : 0,
                                absent[1]);
        near(speed, half.speed, 0.001);
        if (dof != AUVID_SWAY) {
            TEST_ASSERT_EQUAL_FLOAT((float)drag.half_width, (float)half.half_width);
        }
        identifiable += drag.identifiable;
    }
    TEST_ASSERT_TRUE(identifiable > 10 && identifiable < 48 - 12);
}

static void test_before_the_first_estimate_no_drag_force_is_reported(void)
{
    begin();
    for (int turn = 0; turn < 100; ++turn) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_report(&node, 0, sent, &count));
        for (int i = 0; i < count; ++i) {
            TEST_ASSERT_TRUE(auvid_can_kind(NULL, sent[i].id) < AUVID_CAN_DRAG);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_value_of_a_sensor_frame_arrives);
    RUN_TEST(test_attitude_and_rates_arrive_unchanged);
    RUN_TEST(test_an_imu_sample_with_a_missing_axis_or_age_is_ignored);
    RUN_TEST(test_the_age_of_a_sample_is_that_of_its_frame);
    RUN_TEST(test_samples_without_an_age_or_a_value_are_ignored);
    RUN_TEST(test_an_age_beyond_the_time_of_the_tick_gives_time_0);
    RUN_TEST(test_halves_of_an_imu_sample_are_up_to_30_ms_apart);
    RUN_TEST(test_halves_of_different_ticks_are_at_most_30000_us_apart);
    RUN_TEST(test_one_half_of_an_imu_sample_waits_for_the_other);
    RUN_TEST(test_a_half_that_waits_keeps_its_values);
    RUN_TEST(test_the_earlier_of_two_halves_too_far_apart_is_dropped);
    RUN_TEST(test_a_half_with_a_missing_axis_or_age_counts_as_not_sent);
    RUN_TEST(test_an_imu_sample_that_navigation_refuses_is_counted);
    RUN_TEST(test_an_imu_sample_is_used_once);
    RUN_TEST(test_each_lost_tick_is_counted);
    RUN_TEST(test_a_clock_that_advances_more_than_a_second_was_set);
    RUN_TEST(test_a_clock_that_stands_still_was_set);
    RUN_TEST(test_ticks_may_start_at_any_number_and_wrap_to_0);
    RUN_TEST(test_a_tick_up_to_15_behind_is_late_and_one_further_behind_restarts);
    RUN_TEST(test_a_node_s_own_clock_may_start_at_0);
    RUN_TEST(test_a_node_s_own_tick_at_the_same_time_is_refused);
    RUN_TEST(test_a_sample_of_every_sensor_reaches_the_filter_with_its_values_and_age);
    RUN_TEST(test_a_message_that_a_node_does_not_receive_is_unused);
    RUN_TEST(test_a_sensor_frame_whose_counter_is_repeated_or_jumps_is_refused);
    RUN_TEST(test_a_sensor_frame_of_zeros_is_refused);
    RUN_TEST(test_null_is_refused);
    RUN_TEST(test_after_an_init_that_fails_every_function_refuses_the_node);
    RUN_TEST(test_one_to_eight_thrusters_are_accepted);
    RUN_TEST(test_null_and_overlapping_identifiers_are_refused);
    RUN_TEST(test_after_init_there_is_no_sample);
    RUN_TEST(test_an_altitude_frame_below_the_limit_ends_the_excitation);
    RUN_TEST(test_altitude_frames_without_a_value_are_a_lost_altitude);
    RUN_TEST(test_thrust_feedback_is_recorded_from_the_previous_tick_on);
    RUN_TEST(test_a_thruster_without_feedback_has_zero_thrust);
    RUN_TEST(test_thrust_that_the_recorder_refuses_is_counted);
    RUN_TEST(test_a_command_is_a_fraction_of_the_maximum_in_its_direction);
    RUN_TEST(test_each_half_with_thrusters_is_commanded_in_every_tick);
    RUN_TEST(test_a_failed_thruster_is_commanded_zero_and_a_weak_one_its_fraction);
    RUN_TEST(test_a_passive_node_commands_nothing_though_its_identifier_excites);
    RUN_TEST(test_the_reported_navigation_is_that_of_the_filter);
    RUN_TEST(test_each_flag_of_an_estimate_is_one_bit);
    RUN_TEST(test_a_change_and_a_drift_are_reported_alike);
    RUN_TEST(test_the_reported_drag_forces_cycle_and_are_those_of_the_estimate);
    RUN_TEST(test_before_the_first_estimate_no_drag_force_is_reported);
    return UNITY_END();
}
