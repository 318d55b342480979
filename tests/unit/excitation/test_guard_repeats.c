/*
 * Sensors that repeat their values while the vehicle is excited: a hung driver counts as no sample,
 * a coarse sensor of a vehicle at rest does not.
 */
#include "guard_steps.h"

#define PERIODS 10 /* ticks between two samples */

static auvid_real_t dvl[3], angle[3], rate[3], depth;

/* Eight seconds of the samples, or until the breach. @return its time [s] */
static double excite(void (*sample)(int k))
{
    uint64_t start = now;
    for (int k = 0; k < 400; ++k) {
        now += TICK;
        all_is_well();
        if (k % PERIODS == 0) {
            sample(k / PERIODS);
            in.values[AUVID_GUARD_ATTITUDE] = auvid_guard_values(angle, 3);
            in.values[AUVID_GUARD_RATES] = auvid_guard_values(rate, 3);
            in.values[AUVID_GUARD_BOTTOM] = auvid_guard_values(dvl, 3);
            in.values[AUVID_GUARD_PRESSURE] = auvid_guard_values(&depth, 1);
        }
        memcpy(in.rates, rate, sizeof in.rates);
        memcpy(in.velocity_ground, dvl, sizeof in.velocity_ground);
        bool may = auvid_guard_step(&g, now, &in);
        TEST_ASSERT_EQUAL(g.state == AUVID_GUARD_EXCITING, may);
        if (g.state == AUVID_GUARD_ABORTED) {
            return 1e-6 * (double)(now - start);
        }
    }
    return 0.0;
}

/* Live samples of a vehicle that turns, surges and sinks. */
static void live(int k)
{
    for (int i = 0; i < 3; ++i) {
        dvl[i] = AUVID_C(0.2) + AUVID_C(0.001) * (auvid_real_t)(k % 2);
        rate[i] = AUVID_C(0.2) + AUVID_C(0.001) * (auvid_real_t)(k % 2);
        angle[i] = AUVID_C(0.001) * (auvid_real_t)(k % 7);
    }
    depth = 10 + AUVID_C(0.01) * (auvid_real_t)k;
}

static void hung_dvl(int k)
{
    live(k);
    dvl[0] = dvl[1] = dvl[2] = AUVID_C(0.2);
}

static void hung_rates(int k)
{
    live(k);
    rate[0] = rate[1] = rate[2] = AUVID_C(0.01);
}

static void hung_attitude(int k)
{
    live(k);
    angle[0] = angle[1] = angle[2] = AUVID_C(0.03);
}

static void hung_depth(int k)
{
    live(k);
    depth = 10;
}

static void at_rest(int k)
{
    live(k);
    hung_depth(k);
    for (int i = 0; i < 3; ++i) {
        dvl[i] = 0; /* a coarse DVL */
        rate[i] = AUVID_C(0.0005) * (auvid_real_t)(k % 2);
        angle[i] = AUVID_C(0.03); /* a coarse attitude */
    }
}

/* One equal axis is chance. */
static void one_axis_differs(int k)
{
    hung_dvl(k);
    dvl[2] += AUVID_C(0.001) * (auvid_real_t)(k % 2);
    hung_rates(k);
    rate[1] += AUVID_C(0.0005) * (auvid_real_t)(k % 2);
}

static void check_hung(void (*sample)(int), auvid_guard_cause_t cause)
{
    cfg.repeat_us = 3000000;
    go(AUVID_GUARD_EXCITING);
    TEST_ASSERT_FLOAT_WITHIN(0.25F, 3.2F, (float)excite(sample));
    check_aborted(cause, (double)g.trip.value, 3.0);
    TEST_ASSERT_TRUE(g.trip.value > 3);
    cfg.off = AUVID_GUARD_BIT(cause);
    go(AUVID_GUARD_EXCITING);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, (float)excite(sample));
    cfg.off = 0;
    cfg.repeat_us = 0;
    go(AUVID_GUARD_EXCITING);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, (float)excite(sample));
}

static void check_quiet(void (*sample)(int))
{
    go(AUVID_GUARD_EXCITING);
    TEST_ASSERT_EQUAL_FLOAT(0.0F, (float)excite(sample));
}

static void test_a_dvl_that_repeats_its_values_is_no_velocity(void)
{
    check_hung(hung_dvl, AUVID_GUARD_VELOCITY_STALE);
}

static void test_an_imu_that_repeats_its_rates_is_no_imu(void)
{
    check_hung(hung_rates, AUVID_GUARD_IMU_STALE);
}

static void test_an_attitude_that_repeats_while_the_vehicle_turns_is_no_attitude(void)
{
    check_hung(hung_attitude, AUVID_GUARD_IMU_STALE);
}

static void test_a_depth_that_repeats_while_the_vehicle_sinks_is_no_depth(void)
{
    check_hung(hung_depth, AUVID_GUARD_DEPTH_STALE);
}

static void test_live_coarse_and_partly_equal_samples_are_no_repetition(void)
{
    check_quiet(live);
    check_quiet(at_rest);
    check_quiet(one_axis_differs);
}

/* A pressure sensor on a surface craft, or where no depth limit is on, is not watched. */
static void test_a_depth_that_is_not_watched_may_repeat(void)
{
    cfg.off = AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN) | AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX);
    check_quiet(hung_depth);
}

static void test_only_the_excitation_is_ended(void)
{
    for (int state = AUVID_GUARD_ARMED; state <= AUVID_GUARD_SETTLING;
         state += AUVID_GUARD_SETTLING - AUVID_GUARD_ARMED) {
        go((auvid_guard_state_t)state);
        TEST_ASSERT_EQUAL_FLOAT(0.0F, (float)excite(hung_dvl));
    }
}

/* Bottom lock lost for longer than the limit, and the same velocity afterwards, by chance. */
static void test_a_pause_counts_for_an_eighth_only(void)
{
    hung_dvl(0);
    go(AUVID_GUARD_EXCITING);
    for (int k = 0; k < 7 * 250; ++k) {
        now += TICK;
        all_is_well();
        in.values[AUVID_GUARD_BOTTOM] = k % 250 == 0 ? auvid_guard_values(dvl, 3) : 0;
        TEST_ASSERT_TRUE(auvid_guard_step(&g, now, &in));
    }
    TEST_ASSERT_TRUE(g.repeat_us[AUVID_GUARD_BOTTOM] > 2000000);
}

static void test_values_tell_samples_apart(void)
{
    auvid_real_t x[3] = {0, 0, 0};
    TEST_ASSERT_EQUAL_HEX32(1, auvid_guard_values(x, 3));
    TEST_ASSERT_EQUAL_HEX32(1, auvid_guard_values(NULL, 3));
    for (int i = 0; i < 3; ++i) {
        x[i] = AUVID_C(0.25);
        uint32_t before = auvid_guard_values(x, 3);
        TEST_ASSERT_TRUE(before > 1);
        x[i] += AUVID_C(0.001);
        TEST_ASSERT_TRUE(auvid_guard_values(x, 3) != before);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_dvl_that_repeats_its_values_is_no_velocity);
    RUN_TEST(test_an_imu_that_repeats_its_rates_is_no_imu);
    RUN_TEST(test_an_attitude_that_repeats_while_the_vehicle_turns_is_no_attitude);
    RUN_TEST(test_a_depth_that_repeats_while_the_vehicle_sinks_is_no_depth);
    RUN_TEST(test_live_coarse_and_partly_equal_samples_are_no_repetition);
    RUN_TEST(test_a_depth_that_is_not_watched_may_repeat);
    RUN_TEST(test_only_the_excitation_is_ended);
    RUN_TEST(test_a_pause_counts_for_an_eighth_only);
    RUN_TEST(test_values_tell_samples_apart);
    return UNITY_END();
}
