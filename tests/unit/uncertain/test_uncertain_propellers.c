/*
 * Uncertain inputs: the propellers' forces in each cell against an integration in steps of 0.1 ms,
 * where commands change within a cell, as those of an autopilot do.
 */
#include <math.h>
#include <string.h>

#include "auvid/uncertain.h"
#include "chain.h"
#include "unity.h"

static chain_config_t cfg;
static chain_t chain;
static auvid_uncertain_config_t inputs;
static auvid_uncertain_t uncertain;

enum { TICK_US = 20000, CELL_TICKS = 5, TICKS = 600, STEPS = 200, THRUSTER = 1 };

/* Largest command [N]; step of the difference by the lag, before an estimate of it [s]. */
#define LARGEST 40.0
#define LAG_STEP 0.02

void setUp(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    memset(&chain, 0, sizeof chain);
    auvid_uncertain_defaults(&inputs);
}

void tearDown(void)
{
}

/* The command from a tick on: a slow swing, and a part that changes in each tick. */
static double command(int tick)
{
    uint32_t noise = ((uint32_t)tick * 2654435761u >> 16) & 1023u;
    return LARGEST * (0.4 * sin(0.03 * tick) + 0.6 * (noise / 511.5 - 1.0));
}

/* The mean force of a propeller with this lag over each cell, in parts of LARGEST. */
static void integrate(double lag_s, double mean_force[TICKS / CELL_TICKS])
{
    const double half = exp(-0.5e-6 * TICK_US / STEPS / lag_s);
    double speed = 0.0;
    memset(mean_force, 0, TICKS / CELL_TICKS * sizeof mean_force[0]);
    for (int tick = 0; tick < TICKS; ++tick) {
        double to = copysign(sqrt(fabs(command(tick)) / LARGEST), command(tick));
        speed = tick == 0 ? to : speed;
        for (int k = 0; k < STEPS; ++k) {
            speed = to + (speed - to) * half;
            mean_force[tick / CELL_TICKS] += speed * fabs(speed) / (CELL_TICKS * STEPS);
            speed = to + (speed - to) * half;
        }
    }
}

static double force[TICKS / CELL_TICKS], late[TICKS / CELL_TICKS];

/* Compares the last cell with the integration. Returns its number. */
static int compare_cell(double tolerance)
{
    const auvid_uncertain_rows_t *r = &uncertain.recorded;
    int k = (int)((uncertain.cell.t_us - 1000000u) / (CELL_TICKS * TICK_US));
    double slope = (8.0 * (force[k + 1] - force[k - 1]) - (force[k + 2] - force[k - 2])) / 1.2;
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, force[k], r->force[THRUSTER] / LARGEST);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance / LAG_STEP, (force[k] - late[k]) / LAG_STEP,
                              r->later[THRUSTER] / LARGEST);
    TEST_ASSERT_DOUBLE_WITHIN(20.0 * tolerance, slope, r->rate[THRUSTER] / LARGEST);
    TEST_ASSERT_TRUE(r->force[0] == 0 && r->later[0] == 0 && r->rate[0] == 0);
    return k;
}

/* A record of this thruster, of a vehicle at rest. */
static void follow(double lag_s, double tolerance)
{
    int last = 0, cells = 0;
    inputs.nominal_lag_s = (auvid_real_t)lag_s;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &cfg.thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(&chain.id, &uncertain, &inputs,
                                                                  &chain.allocation));
    integrate(lag_s, force);
    integrate(lag_s + LAG_STEP, late);
    for (int tick = 0; tick < TICKS; ++tick) {
        const auvid_real_t rest[AUVID_DOF_COUNT] = {0};
        auvid_real_t forces[AUVID_MAX_COMMANDS] = {0};
        uint64_t t_us = 1000000u + (uint64_t)tick * TICK_US;
        forces[THRUSTER] = (auvid_real_t)command(tick);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, t_us, rest, forces));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&chain.id, t_us, rest, rest));
        if (uncertain.cell.t_us > 0) {
            int k = compare_cell(tolerance);
            cells += k != last;
            last = k;
        }
    }
    TEST_ASSERT_GREATER_THAN(100, cells);
}

static void test_the_speed_follows_commands_that_change_within_a_cell(void)
{
    follow(0.15, 1e-3);
    follow(0.05, 1e-3);
}

static void test_a_propeller_that_is_quicker_than_a_cell_is_followed(void)
{
    follow(0.02, 1e-2);
    follow(0.01, 1e-2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_speed_follows_commands_that_change_within_a_cell);
    RUN_TEST(test_a_propeller_that_is_quicker_than_a_cell_is_followed);
    return UNITY_END();
}
