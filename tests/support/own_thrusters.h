/**
 * @file own_thrusters.h
 * Shared by the tests of a complete Girona500 with five custom thrusters, all with the same dead
 * band, gain in each direction and lag. The mass in surge is known. One test program includes it
 * once.
 */
#ifndef OWN_THRUSTERS_H
#define OWN_THRUSTERS_H

#include <math.h>
#include <string.h>

#include "auvid/thrusters.h"
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
static auvid_change_detector_t change;
static auvid_actuation_t actuation;
static sim_config_t world;

/** Called at each step, before the work of its tick; may be NULL. */
static void (*each_step)(const auvid_identifier_t *id, const auvid_output_t *out);

/** For setUp. */
static inline void own_thrusters_defaults(void)
{
    sim_defaults(&world);
    memset(truth, 0, sizeof truth);
    memcpy(truth, world.parameter, sizeof world.parameter); /* in the same order */
    memcpy(truth + OWN, of_thrusters, sizeof of_thrusters);
}

static inline void configure(uint64_t seed)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {100, 100, 100, 0, 0, 40};
    auvid_thrusters_config_t config;
    auvid_identifier_config_t cfg;
    auvid_actuation_config_t acting;
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
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &config, NULL));
    auvid_identifier_defaults(&cfg, &thrusters.vehicle);
    cfg.exact_inputs = true;
    memset(&cfg.uncertainty, 0,
           sizeof cfg.uncertainty); /* nothing is uncertain in this simulation */
    TEST_ASSERT_EQUAL_HEX32(AUVID_G500_FREE | 15u << OWN, cfg.metric.free);
    cfg.metric.rows = store;
    cfg.metric.row_slots = sizeof store / sizeof store[0];
    cfg.metric.sets = SETS;
    TEST_ASSERT_EQUAL(AUVID_ERR_MODEL, auvid_thrusters_configure(&thrusters, &cfg));
    cfg.metric.free = FREE;
    cfg.metric.fixed[AUVID_G500_M_U] = (auvid_real_t)truth[AUVID_G500_M_U];
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &cfg));
    cfg.search.seed = seed;
    auvid_actuation_defaults(&acting);
    acting.guard.distance_max_m = 1000;
    acting.guard.speed_max = 5;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&acting.excitation, amplitude, SET_S, SETS, seed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&id, &actuation, &acting, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, &auvid_allocation_girona500));
}

/* Mean force of a thruster over a tick, with its lag in steps of 2 ms. */
static inline double follow(double *x, double c)
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

/* A pilot adds depth control to the excitation. Commands are the force divided by 70. */
static inline void command(const sim_t *sim, const auvid_output_t *out, auvid_real_t *commanded,
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

static inline void identify(uint64_t seed)
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
        if (each_step != NULL) {
            each_step(&id, &out);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(SETS, id.metric.sets.recorded);
    finish_work(&id, AUVID_DEFAULT_BUDGET);
}

#endif
