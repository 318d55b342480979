/*
 * The guide's two configurations whose search takes longest, with continuous excitation at the
 * default budget. They are two thrusters at the stern with four sets, and a Girona500 in a current.
 * Each search ends with an estimate that explains the force. There is one for each set.
 *
 * Long form (AUVID_TEST_LONG): 2 h with thrusters, 1 h in the current. Short form: 4 minutes in the
 * current. A seed as argument changes noise and excitation.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "auvid/current.h"
#include "auvid/thrusters.h"
#include "binomial.h"
#include "chain.h"
#include "unity.h"

enum { SETS = 4, SLOTS = AUVID_THRUSTERS_SLOTS(SETS, 30000000u, 20000u), ROWS = 60 };
enum { THRUSTERS = 2, FIRST_OF_GROUP = AUVID_G500_COUNT };

static int16_t commands[THRUSTERS * SLOTS];
static auvid_row_t rows[(AUVID_MAX_SETS + 1) * ROWS];
static auvid_thrusters_t thrusters;
static auvid_current_t current;
static auvid_identifier_config_t cfg;
static auvid_identifier_t id;
static auvid_change_detector_t change;
static sim_config_t world;
static uint64_t seed; /* 0: as the simulator has it */
static const double thruster_pi[] = {80, 60, 0.1, 0.2};

/* Outputs so far. */
static struct {
    uint32_t estimates, begun;
    double begun_s, longest_s; /* begin of the last search; longest search time */
    bool dropped;
} seen;

void setUp(void)
{
    memset(&seen, 0, sizeof seen);
}

void tearDown(void)
{
}

static void record_outputs(const auvid_output_t *out)
{
    double t_s = 1e-6 * (double)id.t_us;
    seen.dropped = seen.dropped || (out->events & AUVID_EVENT_ROWS_DROPPED) != 0;
    if (id.work.searches > seen.begun) {
        ++seen.begun;
        seen.begun_s = t_s;
        TEST_ASSERT_EQUAL_UINT32(seen.begun, id.work.searches);
        TEST_ASSERT_EQUAL_UINT32(seen.estimates + 1, seen.begun); /* the previous one has ended */
    }
    if (out->events & AUVID_EVENT_ESTIMATE) {
        ++seen.estimates;
        seen.longest_s = fmax(seen.longest_s, t_s - seen.begun_s);
        printf("  %5.0f s  an estimate of %u sets; its search took %.0f s, %u + %u evaluations\n",
               t_s, (unsigned)id.estimate.sets, t_s - seen.begun_s,
               (unsigned)id.estimate.evaluations_crs, (unsigned)id.estimate.evaluations_line);
        TEST_ASSERT_TRUE((double)id.estimate.r2_force[AUVID_SURGE] > 0.99);
        TEST_ASSERT_TRUE((double)id.estimate.r2_force[AUVID_YAW] > 0.99);
        for (int i = 0; i < id.metric.cfg.vehicle->parameters; ++i) {
            bool known = (id.estimate.identified >> i & 1u) != 0;
            TEST_ASSERT_TRUE(!known || id.estimate.confidence.sigma[i] > 0);
        }
    }
}

/* Starts half an hour of steps and sines. */
static void begin_excitation(const auvid_real_t *amplitude, uint64_t t_us,
                             auvid_excitation_t *driver)
{
    auvid_excitation_config_t plan;
    auvid_excitation_defaults(&plan);
    TEST_ASSERT_EQUAL(
        AUVID_OK, auvid_excitation_plan(&plan, amplitude, 30, 60, t_us + 7 + 1000000000 * seed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_init(driver, &plan));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_start(driver, t_us));
}

/* Excites the vehicle for `seconds`, or until `estimates` estimates. */
static void run(double seconds, uint32_t estimates, const auvid_real_t *amplitude)
{
    static auvid_excitation_t driver;
    static sim_t sim;
    double x[THRUSTERS] = {0};
    auvid_real_t wrench[AUVID_DOF_COUNT] = {0}, command[AUVID_MAX_COMMANDS] = {0};
    sim_output_t sensed;
    world.seed += seed;
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    begin_excitation(amplitude, 0, &driver);
    for (int tick = 0; tick < 50 * seconds && seen.estimates < estimates; ++tick) {
        auvid_input_t in;
        auvid_output_t out;
        double force[6];
        for (int j = 0; j < 6; ++j) {
            force[j] = (double)wrench[j];
        }
        if (id.attached.listener != NULL) { /* the thrust follows the commands with a lag */
            for (int i = 0; i < THRUSTERS; ++i) {
                double c = (double)command[i], d = thruster_pi[AUVID_THRUSTERS_DEAD_BAND];
                double g = c > d    ? thruster_pi[AUVID_THRUSTERS_FORWARD] * (c - d)
                           : c < -d ? thruster_pi[AUVID_THRUSTERS_BACKWARD] * (c + d)
                                    : 0.0;
                x[i] = g + (x[i] - g) * exp(-0.02 / thruster_pi[AUVID_THRUSTERS_LAG]);
            }
            force[AUVID_SURGE] = x[0] + x[1];
            force[AUVID_YAW] = 0.4 * (x[0] - x[1]);
        }
        sim_step(&sim, NULL, force, &sensed);
        chain_sense(&sensed, 0, &in);
        in.applied.present = true;
        memcpy(in.applied.wrench, wrench, sizeof wrench);
        memcpy(in.applied.command, command, sizeof command);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
        record_outputs(&out);
        (void)auvid_identifier_work(&id, AUVID_DEFAULT_BUDGET);
        TEST_ASSERT_TRUE(id.work.last_units <= AUVID_DEFAULT_BUDGET);
        uint64_t next_us = (uint64_t)(tick + 1) * SIM_TICK_US;
        if (auvid_excitation_step(&driver, next_us, wrench) != AUVID_OK) {
            begin_excitation(amplitude, next_us, &driver);
        }
        wrench[AUVID_HEAVE] -=
            (auvid_real_t)(world.parameter[SIM_WB] + 30.0 * (sim.truth.position[2] - 50.0));
        command[0] = (wrench[AUVID_SURGE] + wrench[AUVID_YAW] / AUVID_C(0.4)) / AUVID_C(140.0);
        command[1] = (wrench[AUVID_SURGE] - wrench[AUVID_YAW] / AUVID_C(0.4)) / AUVID_C(140.0);
    }
}

static void check(double seconds)
{
    uint32_t sets = (uint32_t)(seconds / 30) - 1; /* the last one is not complete */
    printf("  %u estimates in %.0f s, the longest search took %.0f s; %u rows were dropped\n",
           (unsigned)seen.estimates, seconds, seen.longest_s,
           (unsigned)id.metric.sets.rows_dropped);
    TEST_ASSERT_EQUAL_UINT32(sets, seen.estimates);
    TEST_ASSERT_TRUE(seen.begun <= seen.estimates + 1);
    TEST_ASSERT_EQUAL(seen.dropped, id.metric.sets.rows_dropped > 0);
    while (auvid_identifier_work(&id, 1000000) == AUVID_PENDING) {
    }
    TEST_ASSERT_TRUE(id.estimate.number >= id.work.searches);
    TEST_ASSERT_TRUE(id.work.phase == AUVID_WORK_IDLE);
}

static void test_thrusters_with_continuous_excitation_give_estimates(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 0, 0, 0, 0, 20};
    const uint32_t sway = 1u << AUVID_G500_M_V | 1u << AUVID_G500_Y_V | 1u << AUVID_G500_Y_VV,
                   known = 1u << AUVID_G500_M_U | sway;
    double seconds = 7200;
    auvid_thrusters_config_t two;
    auvid_thrusters_defaults(&two);
    two.hull = &auvid_girona500;
    two.thrusters = THRUSTERS;
    two.matrix[AUVID_SURGE][0] = two.matrix[AUVID_SURGE][1] = 1;
    two.matrix[AUVID_YAW][0] = (auvid_real_t)0.4;
    two.matrix[AUVID_YAW][1] = (auvid_real_t)-0.4;
    two.log = commands;
    two.slots = SLOTS;
    sim_defaults(&world);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &two, NULL));
    auvid_identifier_defaults(&cfg, &thrusters.vehicle);
    cfg.metric.rows = rows;
    cfg.metric.row_slots = sizeof rows / sizeof rows[0];
    cfg.metric.sets = SETS;
    cfg.metric.free = (AUVID_G500_FREE | 15u << FIRST_OF_GROUP) & ~known;
    for (int i = 0; i < AUVID_G500_COUNT; ++i) {
        cfg.metric.fixed[i] = (known >> i & 1u) != 0 ? (auvid_real_t)world.parameter[i] : 0;
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    run(seconds, UINT32_MAX, amplitude);
    check(seconds);
}

static void test_a_current_with_continuous_excitation_gives_estimates(void)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    double seconds = campaign_is_long() ? 3600 : 240;
    sim_defaults(&world);
    world.current[0] = 0.2;
    world.current[1] = -0.2;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_current_init(&current, &auvid_girona500, false));
    auvid_identifier_defaults(&cfg, &current.vehicle);
    cfg.metric.rows = rows;
    cfg.metric.row_slots = sizeof rows / sizeof rows[0];
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_current_bounds(&current, 1, cfg.search.lower, cfg.search.upper));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    run(seconds, UINT32_MAX, amplitude);
    check(seconds);
}

int main(int argc, char **argv)
{
    seed = argc > 1 ? strtoull(argv[1], NULL, 10) : 0;
    UNITY_BEGIN();
    RUN_TEST(test_a_current_with_continuous_excitation_gives_estimates);
    if (campaign_is_long()) {
        RUN_TEST(test_thrusters_with_continuous_excitation_give_estimates);
    }
    return UNITY_END();
}
