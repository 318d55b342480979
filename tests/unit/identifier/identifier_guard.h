/*
 * The identifier aboard the simulated vehicle, failures of its inputs, and the check that from an
 * abort on the excitation and the thruster forces are exactly zero.
 */
#ifndef IDENTIFIER_GUARD_H
#define IDENTIFIER_GUARD_H

#include <math.h>

#include "chain.h"
#include "unity.h"

#define BEFORE_S 12.0 /* of excitation before the failure */

enum {
    NO_IMU = 1,
    NO_DVL = 2,
    NO_DEPTH = 4,
    NO_ALTITUDE = 8,
    SATURATED = 16,
    NAN_IMU = 32,
    HEAVE_ONLY = 64, /* one axis of the DVL is valid */
    NO_HEAVE = 128,
    WATER = 256 /* the DVL has no bottom lock */
};

static chain_t chain;
static chain_config_t cfg;
static unsigned wrong; /* the present failures */

static inline void spoil(chain_t *c, auvid_input_t *in)
{
    in->imu.present = in->imu.present && !(wrong & NO_IMU);
    in->dvl.present = in->dvl.present && !(wrong & NO_DVL);
    if (wrong & HEAVE_ONLY) {
        in->dvl.sample.valid &= AUVID_DVL_Z;
    }
    if (wrong & NO_HEAVE) {
        in->dvl.sample.valid &= AUVID_DVL_X | AUVID_DVL_Y;
    }
    if (wrong & WATER) {
        in->dvl.sample.lock = AUVID_DVL_WATER;
        for (int i = 0; i < 3; ++i) {
            in->dvl.sample.velocity[i] = (auvid_real_t)c->sim.truth.nu[i];
        }
    }
    in->depth.present = in->depth.present && !(wrong & NO_DEPTH);
    in->altitude.present = in->altitude.present && !(wrong & NO_ALTITUDE);
    in->saturated = (wrong & SATURATED) != 0;
    if (wrong & NAN_IMU) {
        in->imu.attitude[0] = (auvid_real_t)NAN;
    }
}

void setUp(void)
{
    chain_defaults(&cfg, 3, 2, 1.0);
    cfg.budget = 0;
    cfg.before = spoil;
    wrong = 0;
}

void tearDown(void)
{
}

static inline bool is_zero(const auvid_output_t *out)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!(out->excitation[j] == 0)) {
            return false;
        }
    }
    for (int i = 0; i < AUVID_MAX_THRUSTERS; ++i) {
        if (!(out->thruster_N[i] == 0)) {
            return false;
        }
    }
    return true;
}

static inline void begin(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, chain_begin(&chain, &cfg));
    chain_run(&chain, BEFORE_S);
    TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
    TEST_ASSERT_EQUAL(AUVID_GUARD_NO_CAUSE, chain.out.cause);
    TEST_ASSERT_FALSE(is_zero(&chain.out));
}

/* Zero for ten seconds after the failure has ended; excite is refused. */
static inline void check_stays_zero(auvid_guard_cause_t cause)
{
    wrong = 0;
    for (int k = 0; k < 500; ++k) {
        chain_tick(&chain);
        TEST_ASSERT_TRUE(is_zero(&chain.out));
        TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, chain.out.guard);
        TEST_ASSERT_EQUAL(cause, chain.out.cause);
        TEST_ASSERT_EQUAL_HEX32(0, chain.out.events & AUVID_EVENT_ABORTED); /* reported once */
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_arm(&chain.id));
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_excite(&chain.id));
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_identifier_stop(&chain.id));
    }
}

/* The output of a tick that aborts. */
static inline void check_aborted(const auvid_output_t *out, auvid_guard_cause_t cause)
{
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, out->guard);
    TEST_ASSERT_EQUAL_STRING(auvid_guard_cause_str(cause), auvid_guard_cause_str(out->cause));
    TEST_ASSERT_TRUE(is_zero(out));
    TEST_ASSERT_TRUE(out->events & AUVID_EVENT_ABORTED);
}

/* Run until it aborts, within so many seconds; it excites in every tick before. @return ticks */
static inline int check_aborts(auvid_guard_cause_t cause, double seconds)
{
    int ticks = 0;
    do {
        TEST_ASSERT_EQUAL(AUVID_GUARD_EXCITING, chain.out.guard);
        TEST_ASSERT_TRUE(ticks < seconds * 50);
        chain_tick(&chain);
        ++ticks;
    } while (chain.out.guard == AUVID_GUARD_EXCITING);
    check_aborted(&chain.out, cause);
    TEST_ASSERT_EQUAL_UINT64(chain.t_us, chain.actuation.guard.trip.t_us);
    check_stays_zero(cause);
    return ticks;
}

#endif
