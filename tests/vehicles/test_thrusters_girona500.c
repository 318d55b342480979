/*
 * A whole Girona500 with five thrusters that have a dead band, a gain in each direction and a lag,
 * alike for all: hull and thrusters identified together, the mass in surge known.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "auvid/current.h"
#include "auvid/thrusters.h"
#include "binomial.h"
#include "chain.h"
#include "finish.h"
#include "unity.h"

enum { THRUSTERS = 5, SETS = 8, SET_S = 30, PERIOD_US = 40000 };
enum { OWN = AUVID_G500_COUNT, PARAMETERS = OWN + AUVID_THRUSTERS_PER_GROUP };
enum { FREE = (AUVID_G500_FREE & ~(1u << AUVID_G500_M_U)) | 15u << OWN };
enum { SLOTS = AUVID_THRUSTERS_SLOTS(SETS, SET_S * 1000000u, PERIOD_US) };

static const double of_thrusters[AUVID_THRUSTERS_PER_GROUP] = {80.0, 62.0, 0.1, 0.2};
static double truth[PARAMETERS];
static int16_t commands[THRUSTERS * SLOTS];
static auvid_row_t store[(SETS + 1) * SET_S * 2];
static auvid_thrusters_t thrusters;
static auvid_allocation_t allocation;
static auvid_identifier_t id;
static sim_config_t world;

void setUp(void)
{
    sim_defaults(&world);
    memset(truth, 0, sizeof truth);
    memcpy(truth, world.parameter, sizeof world.parameter); /* in the same order */
    memcpy(truth + OWN, of_thrusters, sizeof of_thrusters);
}

void tearDown(void)
{
}

static void configure(uint64_t seed)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    auvid_thrusters_config_t config;
    auvid_identifier_config_t cfg;
    auvid_thrusters_defaults(&config);
    config.hull = &auvid_girona500;
    config.thrusters = THRUSTERS;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < THRUSTERS; ++i) {
            config.matrix[j][i] = (auvid_real_t)world.thruster_matrix[j][i];
        }
    }
    config.command_max = 2;
    config.gain_max = 300;
    config.period_us = PERIOD_US;
    config.log = commands;
    config.slots = SLOTS;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &config));
    auvid_identifier_defaults(&cfg, &thrusters.vehicle);
    memset(&cfg.uncertainty, 0, sizeof cfg.uncertainty); /* this world is as told */
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE | 15u << OWN, cfg.metric.free);
    cfg.metric.rows = store;
    cfg.metric.sets = SETS;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_configure(&thrusters, &cfg));
    cfg.metric.free = FREE;
    cfg.metric.fixed[AUVID_G500_M_U] = (auvid_real_t)truth[AUVID_G500_M_U];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &cfg));
    cfg.search.seed = seed;
    cfg.guard.distance_max_m = 1000;
    cfg.guard.speed_max = 5;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&cfg.excitation, amplitude, SET_S, SETS, seed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &auvid_allocation_girona500));
}

/* Mean force of a thruster over a tick, its lag in steps of 2 ms. */
static double follow(double *x, double c)
{
    double d = of_thrusters[AUVID_THRUSTERS_DEAD_BAND], mean = 0.0;
    double g = c > d    ? of_thrusters[AUVID_THRUSTERS_FORWARD] * (c - d)
               : c < -d ? of_thrusters[AUVID_THRUSTERS_BACKWARD] * (c + d)
                        : 0.0;
    double a = 0.002 / of_thrusters[AUVID_THRUSTERS_LAG], e = exp(-a);
    for (int i = 0; i < 10; ++i) {
        mean += 0.1 * (g + (*x - g) * (1.0 - e) / a);
        *x = g + (*x - g) * e;
    }
    return mean;
}

/* A pilot who holds the depth adds to the excitation; commands are a 70th of the force wanted. */
static void command(const sim_t *sim, const auvid_output_t *out, auvid_real_t *commanded,
                    auvid_real_t *nominal)
{
    auvid_allocation_result_t result;
    memcpy(nominal, out->excitation, AUVID_DOF_COUNT * sizeof *nominal);
    nominal[AUVID_HEAVE] +=
        (auvid_real_t)(-truth[AUVID_G500_W_B] - 30.0 * (sim->truth.position[2] - 50.0));
    TEST_ASSERT_TRUE(auvid_allocation_solve(&allocation, nominal, &result) >= 0);
    for (int i = 0; i < THRUSTERS; ++i) {
        commanded[i] = result.force_N[i] / 70;
    }
}

static void identify(uint64_t seed)
{
    sim_t sim;
    sim_output_t sensed;
    double x[THRUSTERS] = {0};
    auvid_real_t commanded[AUVID_MAX_COMMANDS] = {0};
    bool excited = false;
    world.seed = seed;
    configure(seed);
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    for (int tick = 0; tick < SETS * SET_S * 50 + 300; ++tick) {
        auvid_real_t nominal[AUVID_DOF_COUNT];
        double force[THRUSTERS];
        auvid_input_t in;
        auvid_output_t out;
        for (int i = 0; i < THRUSTERS; ++i) {
            force[i] = follow(&x[i], (double)commanded[i]);
        }
        sim_step(&sim, force, NULL, &sensed);
        chain_sense(&sensed, 0, &in);
        if (!excited && auvid_identifier_arm(&id) == AUVID_OK) {
            excited = auvid_identifier_excite(&id) == AUVID_OK;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
        command(&sim, &out, commanded, nominal);
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, in.t_us, nominal, commanded));
    }
    TEST_ASSERT_EQUAL_UINT32(SETS, id.metric.sets_recorded);
    finish_work(&id, UINT32_MAX);
}

/* Relative error of parameter i, printed in a campaign. */
static double error_of(int i)
{
    double error = (double)id.estimate.pi[i] / truth[i] - 1.0;
    if (campaign_is_long()) {
        printf("seed %u %-10s %6.2f +- %.2f %%\n", (unsigned)world.seed,
               thrusters.parameter[i].name, 100.0 * error,
               196.0 * fabs((double)id.estimate.confidence.sigma[i] / truth[i]));
    }
    return error;
}

/* An rms error of 2.5 % over the 16 parameters, 5 % of the thrusters' own. */
static void test_hull_and_thrusters_are_identified_together(void)
{
    for (uint64_t seed = 1; seed <= (campaign_is_long() ? 10 : 1); ++seed) {
        double squares = 0.0;
        identify(seed);
        TEST_ASSERT_EQUAL_HEX32(FREE, id.estimate.identified);
        TEST_ASSERT_EQUAL_HEX32(FREE, id.estimate.confidence.identifiable);
        TEST_ASSERT_FALSE(id.estimate.capped);
        for (int i = 0; i < PARAMETERS; ++i) {
            double error = FREE >> i & 1u ? error_of(i) : 0.0;
            TEST_ASSERT_TRUE(i < OWN || fabs(error) < 0.05);
            squares += error * error / 16.0;
        }
        TEST_ASSERT_TRUE(sqrt(squares) < 0.025);
    }
}

/* Two wrappers: the thrusters' wrench on the hull, in water that moves. */
static void test_thrusters_may_be_around_a_hull_in_a_current(void)
{
    static auvid_current_t current;
    auvid_thrusters_config_t config;
    auvid_identifier_config_t cfg;
    auvid_real_t pi[AUVID_MAX_PARAMETERS] = {0}, e[AUVID_DOF_COUNT], expected[AUVID_DOF_COUNT];
    const auvid_real_t ahead[AUVID_MAX_COMMANDS] = {1};
    auvid_sample_t sample;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_current_init(&current, &auvid_girona500, false));
    auvid_thrusters_defaults(&config);
    config.hull = &current.vehicle;
    config.thrusters = 1;
    config.matrix[AUVID_SURGE][0] = 1;
    config.log = commands;
    config.slots = SLOTS;
    config.period_us = PERIOD_US;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &config));
    TEST_ASSERT_EQUAL_UINT8(OWN + 2 + 4, thrusters.vehicle.parameters);
    auvid_identifier_defaults(&cfg, &thrusters.vehicle);
    cfg.metric.rows = store;
    cfg.metric.free &= ~(1u << AUVID_G500_M_U);
    cfg.metric.fixed[AUVID_G500_M_U] = (auvid_real_t)truth[AUVID_G500_M_U];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    for (uint64_t t_us = 0; t_us < 20000000; t_us += PERIOD_US) {
        auvid_thrusters_command(&thrusters, t_us, ahead);
    }
    for (int i = 0; i < PARAMETERS; ++i) {
        pi[i < OWN ? i : i + 2] = (auvid_real_t)truth[i];
    }
    pi[OWN] = (auvid_real_t)0.3;
    memset(&sample, 0, sizeof sample);
    sample.t_us = 15000000;
    sample.nu[AUVID_SURGE] = (auvid_real_t)0.5;
    sample.psi = (auvid_real_t)0.4;
    auvid_vehicle_residual(&thrusters.vehicle, &sample, pi, e);
    sample.tau[AUVID_SURGE] = (auvid_real_t)(80.0 * (1.0 - 0.1)); /* steady */
    auvid_vehicle_residual(&current.vehicle, &sample, pi, expected);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        TEST_ASSERT_DOUBLE_WITHIN(0.01, (double)expected[j], (double)e[j]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_hull_and_thrusters_are_identified_together);
    RUN_TEST(test_thrusters_may_be_around_a_hull_in_a_current);
    return UNITY_END();
}
