/*
 * A guard with all inputs, and the steps of its tests: into each watched state, and the check that
 * an abort latches.
 */
#ifndef GUARD_STEPS_H
#define GUARD_STEPS_H

#include "auvid/guard.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "unity.h"

#define TICK 20000u
#define START 5000000u

static auvid_guard_config_t cfg;
static auvid_guard_t g;
static auvid_guard_input_t in;
static uint64_t now;

static inline void see(auvid_guard_seen_t *seen)
{
    seen->t_us = now;
    seen->known = true;
}

/* Everything fresh, the vehicle moving a little, well within the limits. */
static inline void all_is_well(void)
{
    memset(&in, 0, sizeof in);
    see(&in.imu);
    see(&in.velocity);
    see(&in.ground);
    see(&in.depth);
    see(&in.altitude);
    see(&in.applied);
    in.position[0] = 101;
    in.position[1] = -50;
    in.position[2] = 10;
    in.roll = AUVID_C(0.1);
    in.pitch = AUVID_C(-0.1);
    in.velocity_ground[0] = AUVID_C(0.5);
    in.rates[2] = AUVID_C(0.2);
    in.altitude_m = 8;
}

void setUp(void)
{
    auvid_guard_defaults(&cfg);
    memset(&g, 0, sizeof g);
    now = START;
    all_is_well();
}

void tearDown(void)
{
}

static inline bool step(void)
{
    now += TICK;
    return auvid_guard_step(&g, now, &in);
}

static inline bool step_well(void)
{
    now += TICK;
    all_is_well();
    return auvid_guard_step(&g, now, &in);
}

/* To one of the watched states, with all inputs within the limits; the excitation starts now. */
static inline void go(auvid_guard_state_t state)
{
    now = START;
    all_is_well();
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_init(&g, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_arm(&g, now, &in));
    TEST_ASSERT_FALSE(step_well());
    if (state != AUVID_GUARD_ARMED) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_excite(&g, now));
        TEST_ASSERT_TRUE(step_well());
    }
    if (state == AUVID_GUARD_SETTLING) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_guard_finished(&g, now));
        TEST_ASSERT_FALSE(step_well());
    }
    TEST_ASSERT_EQUAL(state, g.state);
}

static inline void check_aborted(auvid_guard_cause_t cause, double value, double limit)
{
    TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, g.state);
    TEST_ASSERT_EQUAL_STRING(auvid_guard_cause_str(cause), auvid_guard_cause_str(g.trip.cause));
    if (isnan(value)) {
        TEST_ASSERT_TRUE(isnan((double)g.trip.value));
    } else {
        TEST_ASSERT_EQUAL_FLOAT((float)value, (float)g.trip.value);
    }
    TEST_ASSERT_EQUAL_FLOAT((float)limit, (float)g.trip.limit);
    TEST_ASSERT_EQUAL_UINT64(now, g.trip.t_us);
}

/* Aborted now, and still so when all inputs are within the limits again. */
static inline void check_latched(auvid_guard_cause_t cause, double value, double limit)
{
    check_aborted(cause, value, limit);
    auvid_guard_trip_t trip = g.trip;
    for (int k = 0; k < 200; ++k) {
        TEST_ASSERT_FALSE(step_well());
        TEST_ASSERT_EQUAL(AUVID_GUARD_ABORTED, g.state);
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_arm(&g, now, &in));
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_excite(&g, now));
        TEST_ASSERT_EQUAL(AUVID_ERR_STATE, auvid_guard_finished(&g, now));
    }
    TEST_ASSERT_EQUAL_MEMORY(&trip, &g.trip, sizeof trip);
}

#endif
