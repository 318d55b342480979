/*
 * Sensors whose samples arrive late: the demo's world over the bus, Girona500, a disturbance of
 * 1 N, eight sets, the DVL half a metre from the body's origin.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "unity.h"
#include "bus/world.h"

static world_t world;

void setUp(void)
{
}

void tearDown(void)
{
}

/* @return rms relative error of the parameters [%] */
static double identify(uint64_t seed, double dvl_s, double imu_s)
{
    static const options_t as_told; /* no uncertainty of thrust and DVL */
    const world_config_t cfg = {.options = &as_told,
                                .seed = seed,
                                .sets = 8,
                                .disturbance_N = 1,
                                .dvl_arm_m = {0.4, 0.3, 0},
                                .age_s = {[SIM_DVL] = dvl_s, [SIM_IMU] = imu_s}};
    TEST_ASSERT_TRUE(world_begin(&world, &cfg));
    const auvid_identifier_t *id = &world.node[0].id;
    bool busy = true;
    while ((busy || id->metric.sets.recorded < cfg.sets) && world_time_s(&world) < 600) {
        world_tick(&world);
        busy = world_work(&world, UINT32_MAX);
    }
    TEST_ASSERT_EQUAL(cfg.sets, id->metric.sets.recorded);
    TEST_ASSERT_EQUAL(AUVID_GUARD_NO_CAUSE, id->actuation->guard.trip.cause);
    TEST_ASSERT_EQUAL(AUVID_G500_FREE, id->estimate.confidence.identifiable);
    double sum = 0;
    for (int i = 0; i < SIM_PARAMETERS; ++i) {
        sum += pow((double)id->estimate.pi[i] / (double)auvid_girona500_paper[i] - 1, 2);
    }
    return 100 * sqrt(sum / SIM_PARAMETERS);
}

/* The mean over all seeds. Late samples may cost at most one second. */
static double campaign(double dvl_s, double imu_s)
{
    int seeds = getenv("AUVID_TEST_LONG") != NULL ? 20 : 4;
    double sum = 0;
    for (int k = 1; k <= seeds; ++k) {
        double rms = identify((uint64_t)k, dvl_s, imu_s);
        sum += rms * rms;
    }
    double rms = sqrt(sum / seeds);
    printf("DVL %3.0f ms late, IMU %3.0f ms: rms error %.2f %% (%d seeds)\n", 1e3 * dvl_s,
           1e3 * imu_s, rms, seeds);
    return rms;
}

/* In steps of 50 ms; the short form uses the middle and the end. */
static double first_step(double last_s)
{
    return getenv("AUVID_TEST_LONG") != NULL ? 0.05 : 0.5 * last_s;
}

static void test_a_dvl_up_to_200_ms_late_and_off_its_origin_costs_no_accuracy(void)
{
    double prompt = campaign(0, 0), step = first_step(0.2);
    for (int k = 1; k * step < 0.2 + 1e-9; ++k) {
        TEST_ASSERT_TRUE(campaign(k * step, 0) <= 1.2 * prompt);
    }
}

static void test_an_imu_up_to_100_ms_late_identifies_like_a_punctual_one(void)
{
    double prompt = campaign(0, 0), step = first_step(0.1);
    for (int k = 1; k * step < 0.1 + 1e-9; ++k) {
        TEST_ASSERT_TRUE(campaign(0, k * step) <= 1.2 * prompt);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_dvl_up_to_200_ms_late_and_off_its_origin_costs_no_accuracy);
    RUN_TEST(test_an_imu_up_to_100_ms_late_identifies_like_a_punctual_one);
    return UNITY_END();
}
