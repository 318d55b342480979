/*
 * The effect of each received frame on the node.
 */
#include "node_frames.h"

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

/* The bus is silent for 71 min 35 s: 214749 ticks, after which the 32 bits of the time are 32.7 ms
 * further. */
static void test_ticks_that_were_missed_until_their_time_wrapped_are_a_pause(void)
{
    auvid_can_message_t m = {.kind = AUVID_CAN_TICK};
    begin();
    step_at(1);
    m.as.tick.sequence = 1 + 214749;
    m.as.tick.time = (uint32_t)(20000 + 214749ull * 20000);
    TEST_ASSERT_EQUAL(AUVID_TICK, give(&m));
    TEST_ASSERT_EQUAL_UINT32(1, node.counters.clock_steps);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_node_step(&node, NULL, sent, &count));
    TEST_ASSERT_EQUAL_UINT64(1020000, node.t_us);
}

/* Ticks are at least 1 ms apart: of 1000 in a second all may have been missed, of 1001 not. */
static void test_more_ticks_than_a_second_has_are_a_pause(void)
{
    for (uint32_t more = 0; more < 2; ++more) {
        auvid_can_message_t m = {.kind = AUVID_CAN_TICK};
        begin();
        step_at(1);
        m.as.tick.sequence = 1 + 1000 + more;
        m.as.tick.time = 20000 + 1000000;
        TEST_ASSERT_EQUAL(AUVID_TICK, give(&m));
        TEST_ASSERT_EQUAL_UINT32(more, node.counters.clock_steps);
    }
}

static void test_a_clock_may_begin_at_0_but_not_where_a_restored_one_ended(void)
{
    for (uint32_t restored = 0; restored < 2; ++restored) {
        auvid_can_message_t m = {.kind = AUVID_CAN_TICK};
        begin();
        m.as.tick.sequence = 1;
        m.as.tick.time = restored ? 5000000 : 0;
        node.id.started = restored != 0;
        node.id.t_us = m.as.tick.time;
        TEST_ASSERT_EQUAL(AUVID_TICK, give(&m));
        TEST_ASSERT_EQUAL_UINT32(restored, node.counters.clock_steps);
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
static void test_a_frame_of_zeros_is_refused(void)
{
    for (int kind = 0; kind < AUVID_CAN_KINDS; ++kind) {
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
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_halt(NULL, AUVID_GUARD_OPERATOR, sent, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_halt(&node, AUVID_GUARD_OPERATOR, NULL, &count));
    TEST_ASSERT_EQUAL(AUVID_ERR_NULL, auvid_node_halt(&node, AUVID_GUARD_OPERATOR, sent, NULL));
    TEST_ASSERT_EQUAL_UINT32(0, node.counters.ticks);
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
    RUN_TEST(test_ticks_that_were_missed_until_their_time_wrapped_are_a_pause);
    RUN_TEST(test_more_ticks_than_a_second_has_are_a_pause);
    RUN_TEST(test_a_clock_may_begin_at_0_but_not_where_a_restored_one_ended);
    RUN_TEST(test_a_clock_that_stands_still_was_set);
    RUN_TEST(test_ticks_may_start_at_any_number_and_wrap_to_0);
    RUN_TEST(test_a_tick_up_to_15_behind_is_late_and_one_further_behind_restarts);
    RUN_TEST(test_a_node_s_own_clock_may_start_at_0);
    RUN_TEST(test_a_node_s_own_tick_at_the_same_time_is_refused);
    RUN_TEST(test_a_sample_of_every_sensor_reaches_the_filter_with_its_values_and_age);
    RUN_TEST(test_a_message_that_a_node_does_not_receive_is_unused);
    RUN_TEST(test_a_sensor_frame_whose_counter_is_repeated_or_jumps_is_refused);
    RUN_TEST(test_a_frame_of_zeros_is_refused);
    RUN_TEST(test_null_is_refused);
    RUN_TEST(test_an_altitude_frame_below_the_limit_ends_the_excitation);
    RUN_TEST(test_altitude_frames_without_a_value_are_a_lost_altitude);
    return UNITY_END();
}
