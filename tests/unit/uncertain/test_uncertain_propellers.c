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

enum { CELL_US = 100000, CELLS = 120, STEP_US = 100, THRUSTER = 1 };

/* Largest command [N]; step of the difference by the lag, before an estimate of it [s]. */
#define LARGEST 40.0
#define LAG_STEP 0.02

static uint32_t tick_us; /* between commands */

void setUp(void)
{
    chain_defaults(&cfg, 1, 1, 0.0);
    memset(&chain, 0, sizeof chain);
    auvid_uncertain_defaults(&inputs);
    tick_us = 20000;
}

void tearDown(void)
{
}

/* The command at this time, in parts of LARGEST: a slow swing, and what changes with each one. */
static double command(uint32_t us)
{
    uint32_t tick = us / tick_us, noise = (tick * 2654435761u >> 16) & 1023u;
    return 0.4 * sin(1.5e-6 * tick * tick_us) + 0.6 * (noise / 511.5 - 1.0);
}

static double signed_root(double x)
{
    return copysign(sqrt(fabs(x)), x);
}

/* The mean force of a propeller with this lag over each cell. */
static void integrate(double lag_s, double mean_force[CELLS])
{
    const double half = exp(-0.5e-6 * STEP_US / lag_s);
    double speed = 0.0;
    memset(mean_force, 0, CELLS * sizeof mean_force[0]);
    for (uint32_t us = 0; us < CELLS * CELL_US; us += STEP_US) {
        double to = signed_root(command(us)), weight = (double)STEP_US / CELL_US;
        if (us < CELL_US) {
            speed += weight * to;
            mean_force[0] += weight * command(us);
            continue;
        }
        speed = to + (speed - to) * half;
        mean_force[us / CELL_US] += weight * speed * fabs(speed);
        speed = to + (speed - to) * half;
    }
}

static double force[CELLS], late[CELLS];

/* Compares the last cell with the integration. Returns its number. */
static int compare_cell(double tolerance)
{
    const auvid_uncertain_rows_t *r = &uncertain.recorded;
    int k = (int)((uncertain.cell.t_us - 1000000u) / CELL_US);
    double slope = (8.0 * (force[k + 1] - force[k - 1]) - (force[k + 2] - force[k - 2])) / 1.2;
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, force[k], r->force[THRUSTER] / LARGEST);
    TEST_ASSERT_DOUBLE_WITHIN(tolerance / LAG_STEP, (force[k] - late[k]) / LAG_STEP,
                              r->lag_slope[THRUSTER] / LARGEST);
    TEST_ASSERT_DOUBLE_WITHIN(20.0 * tolerance, slope, r->rate[THRUSTER] / LARGEST);
    TEST_ASSERT_TRUE(r->force[0] == 0 && r->lag_slope[0] == 0 && r->rate[0] == 0);
    return k;
}

/* A record of a vehicle at rest. Only this thruster works. */
static void follow(double lag_s, double tolerance)
{
    int last = 0, cells = 0;
    inputs.nominal_lag_s = (auvid_real_t)lag_s;
    cfg.thrusters.thruster[0].max_N = cfg.thrusters.thruster[0].min_N = 0;
    cfg.thrusters.thruster[THRUSTER].max_N = (auvid_real_t)LARGEST;
    cfg.thrusters.thruster[THRUSTER].min_N = (auvid_real_t)-LARGEST;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&chain.id, &cfg.id));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&chain.allocation, &cfg.thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_uncertain(&chain.id, &uncertain, &inputs,
                                                                  &chain.allocation));
    integrate(lag_s, force);
    integrate(lag_s + LAG_STEP, late);
    for (uint32_t us = 0; us < (CELLS - 3) * CELL_US; us += tick_us) {
        const auvid_real_t rest[AUVID_DOF_COUNT] = {0};
        auvid_real_t commands[AUVID_MAX_COMMANDS] = {20};
        uint64_t t_us = 1000000u + us;
        commands[THRUSTER] = (auvid_real_t)(command(us) * (inputs.fractions ? 1.0 : LARGEST));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&chain.id, t_us, rest, commands));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_motion(&chain.id, t_us, rest, rest));
        if (uncertain.cell.t_us > 0) {
            int k = compare_cell(tolerance);
            cells += k != last;
            last = k;
        }
    }
    TEST_ASSERT_GREATER_THAN(30, cells);
}

static void test_the_speed_follows_commands_that_change_within_a_cell(void)
{
    follow(0.15, 1e-3);
    follow(0.05, 1e-3);
}

static void test_commands_may_be_longer_than_a_cell_and_across_its_ends(void)
{
    tick_us = 17000;
    follow(0.15, 1e-3);
    tick_us = 230000;
    follow(0.15, 3e-2); /* Simpson's rule over 0.1 s in which a propeller is reversed */
}

static void test_quick_commands_cost_no_accuracy(void)
{
    tick_us = 1000;
    follow(0.15, 2e-4);
}

static void test_a_propeller_that_is_quicker_than_a_cell_is_followed(void)
{
    follow(0.02, 1e-2);
    follow(0.01, 1e-2);
}

static void test_commands_may_be_fractions(void)
{
    inputs.fractions = true;
    follow(0.15, 1e-3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_speed_follows_commands_that_change_within_a_cell);
    RUN_TEST(test_commands_may_be_longer_than_a_cell_and_across_its_ends);
    RUN_TEST(test_quick_commands_cost_no_accuracy);
    RUN_TEST(test_commands_may_be_fractions);
    RUN_TEST(test_a_propeller_that_is_quicker_than_a_cell_is_followed);
    return UNITY_END();
}
