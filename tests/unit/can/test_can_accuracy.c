/*
 * Do the frames reduce the accuracy of the identification? The whole chain runs twice with the same
 * seeds. The data between sensors, thrusters and identifier pass directly, or through pack and
 * unpack.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/can.h"
#include "binomial.h"
#include "chain.h"
#include "unity.h"

#define LARGEST_N 153.8

enum { SETS = 8 };

static auvid_can_sender_t sender;
static auvid_allocation_t allocation;

void setUp(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_sender_init(&sender, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &auvid_allocation_girona500));
}

void tearDown(void)
{
}

static void pass(auvid_can_message_t *message)
{
    auvid_can_frame_t frame;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_pack(&sender, message, &frame));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_can_unpack(NULL, &frame, message));
}

/* Passes three reals through a message as its first three signals. */
static void pass3(auvid_can_kind_t kind, auvid_real_t x[3])
{
    auvid_can_message_t message;
    memset(&message, 0, sizeof message);
    message.kind = kind;
    memcpy(&message.as, x, 3 * sizeof x[0]);
    pass(&message);
    memcpy(x, &message.as, 3 * sizeof x[0]);
}

static void sensors_pass(auvid_input_t *in)
{
    auvid_can_message_t message;
    memset(&message, 0, sizeof message);
    in->imu.attitude[2] =
        (auvid_real_t)remainder((double)in->imu.attitude[2], 2.0 * 3.14159265358979323846);
    pass3(AUVID_CAN_IMU_ATTITUDE, in->imu.attitude);
    pass3(AUVID_CAN_IMU_RATES, in->imu.rates);
    if (in->dvl.present) {
        pass3(AUVID_CAN_DVL_BOTTOM, in->dvl.sample.velocity);
    }
    message.kind = AUVID_CAN_DEPTH;
    if (in->depth.present) {
        message.as.depth.depth = in->depth.depth_m;
        pass(&message);
        in->depth.depth_m = message.as.depth.depth;
    }
}

/* The wrench of the thrusters; with frames, that of the commands they receive. */
static void thrusters_act(chain_t *chain, auvid_input_t *in, bool frames)
{
    auvid_allocation_result_t result;
    auvid_can_message_t message[2];
    TEST_ASSERT_TRUE(auvid_allocation_solve(&allocation, chain->wrench, &result) >= 0);
    memset(message, 0, sizeof message);
    for (int i = 0; i < 2; ++i) {
        auvid_real_t *thrust = message[i].as.thruster_command_a.thrust; /* b has the same layout */
        message[i].kind = i == 0 ? AUVID_CAN_THRUSTER_COMMAND_A : AUVID_CAN_THRUSTER_COMMAND_B;
        for (int j = 0; j < 4; ++j) {
            int n = 4 * i + j;
            auvid_real_t force = n < allocation.cfg.thrusters ? result.force_N[n] : 0;
            thrust[j] = force / (auvid_real_t)LARGEST_N;
        }
        if (frames) {
            pass(&message[i]);
        }
    }
    memset(chain->wrench, 0, sizeof chain->wrench);
    for (int n = 0; n < allocation.cfg.thrusters; ++n) {
        auvid_real_t force =
            message[n / 4].as.thruster_command_a.thrust[n % 4] * (auvid_real_t)LARGEST_N;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            chain->wrench[j] += allocation.cfg.thruster[n].wrench[j] * force;
        }
    }
    memcpy(in->applied.wrench, chain->wrench, sizeof chain->wrench);
}

static void without_frames(chain_t *chain, auvid_input_t *in)
{
    thrusters_act(chain, in, false);
}

static void with_frames(chain_t *chain, auvid_input_t *in)
{
    sensors_pass(in);
    thrusters_act(chain, in, true);
}

enum { SEEDS = 200, RESAMPLES = 1000 };

static struct {
    double plain, framed; /* mean square error */
} run[SEEDS];

static double mean_square(uint64_t seed, double disturbance_N, chain_before_t before)
{
    static chain_t chain;
    chain_config_t cfg;
    chain_defaults(&cfg, seed, SETS, disturbance_N);
    chain_set_driver(&cfg);
    cfg.before = before;
    TEST_ASSERT_EQUAL(AUVID_OK, chain_run_sets(&chain, &cfg, SETS));
    TEST_ASSERT_TRUE(chain_finish(&chain, 1000, 6000) <= 6000);
    return chain_mean_square(&chain);
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Half-width of the 95 % interval of the ratio of the mean squares, by bootstrap over seeds. */
static double half_width(int seeds)
{
    static double ratio[RESAMPLES];
    sim_rng_t rng;
    sim_rng_seed(&rng, 1, 1);
    for (int b = 0; b < RESAMPLES; ++b) {
        double plain = 0.0, framed = 0.0;
        for (int k = 0; k < seeds; ++k) {
            int i = (int)(sim_rng_uniform(&rng) * seeds);
            plain += run[i].plain;
            framed += run[i].framed;
        }
        ratio[b] = framed / plain;
    }
    qsort(ratio, RESAMPLES, sizeof ratio[0], ascending);
    return 0.5 * (ratio[RESAMPLES - 1 - RESAMPLES / 40] - ratio[RESAMPLES / 40]);
}

/* The two runs of a seed have the same noise, but different rounding, so single seeds differ either
 * way. A relevant quantisation would show in the mean square over all seeds. Without disturbance it
 * would show most clearly. */
static void compare(double disturbance_N, int seeds, double *plain, double *framed)
{
    *plain = *framed = 0.0;
    for (int i = 0; i < seeds; ++i) {
        uint64_t seed = 500 + (uint64_t)i;
        run[i].plain = mean_square(seed, disturbance_N, without_frames);
        run[i].framed = mean_square(seed, disturbance_N, with_frames);
        *plain += run[i].plain / seeds;
        *framed += run[i].framed / seeds;
    }
    printf("%g N, %d seeds, rms parameter error: %.3f %% without frames, %.3f %% with; "
           "mean square %+.1f %% (+- %.1f)\n",
           disturbance_N, seeds, 100.0 * sqrt(*plain), 100.0 * sqrt(*framed),
           100.0 * (*framed / *plain - 1.0), 100.0 * half_width(seeds));
}

static void test_the_frames_do_not_reduce_accuracy(void)
{
    const double disturbance_N[] = {0.0, 1.0, 3.0};
    double plain, framed;
    for (int k = 0; k < (campaign_is_long() ? 3 : 1); ++k) {
        compare(disturbance_N[k], campaign_is_long() ? (int)campaign_runs(SEEDS) : 6, &plain,
                &framed);
        TEST_ASSERT_TRUE(sqrt(framed) <= 1.05 * sqrt(plain));
        TEST_ASSERT_TRUE(k > 0 || sqrt(framed) <= 0.016);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_frames_do_not_reduce_accuracy);
    return UNITY_END();
}
