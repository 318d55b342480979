/**
 * @file surge_only.h
 * Shared by the tests of user's models with one axis, surge: their simulation, with two thrusters
 * at the stern, and an identifier that excites it. One test program includes it once.
 */
#ifndef SURGE_ONLY_H
#define SURGE_ONLY_H

#include <math.h>
#include <string.h>

#include "auvid/identifier.h"
#include "chain.h"
#include "finish.h"
#include "unity.h"

enum { SETS = 8, SET_ROWS = 150 };
static auvid_identifier_t id;
static auvid_actuation_t actuation;
static auvid_validation_t prediction;
static auvid_change_detector_t change;
static auvid_row_t store[(SETS + 1) * SET_ROWS];

static inline void surge_configure(auvid_identifier_config_t *cfg, const auvid_vehicle_t *model,
                                   const auvid_real_t *lower, const auvid_real_t *upper,
                                   uint64_t seed)
{
    auvid_identifier_defaults(cfg, model);
    cfg->exact_inputs = true;
    cfg->metric.rows = store;
    cfg->metric.row_slots = sizeof store / sizeof store[0];
    cfg->metric.sets = SETS;
    cfg->metric.set_rows = SET_ROWS;
    cfg->metric.row_cells = 2;
    memcpy(cfg->search.lower, lower, model->parameters * sizeof *lower);
    memcpy(cfg->search.upper, upper, model->parameters * sizeof *upper);
    cfg->search.seed = seed;
}

/* Initialise the identifier and attach the excitation, in units of the command. */
static inline void begin(const auvid_identifier_config_t *cfg, uint64_t seed)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {1, 0, 0, 0, 0, 0};
    auvid_actuation_config_t acting;
    auvid_actuation_defaults(&acting);
    /* no depth sensor */
    acting.guard.off =
        AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN) | AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX);
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&acting.excitation, amplitude, 30, SETS, seed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&id, &actuation, &acting, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_prediction(&id, &prediction));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_change_test(&id, &change));
}

/** Called at each step, before the work of its tick; may be NULL. */
static void (*each_step)(const auvid_identifier_t *id, const auvid_output_t *out);

/** The surge "force" of the excitation is the command of both thrusters; their recorded wrench is
 * 100 N times that.
 * Runs until `sets` of the SETS are complete, and then until the work is done.
 * @param force on the hull at a command and a speed, beside that of `world`
 * @param budget of each step; 0: the work is done at the end, at the default budget */
static inline void surge_identify(const auvid_identifier_config_t *cfg, const sim_config_t *world,
                                  double (*force)(double command, double speed), uint32_t sets,
                                  uint32_t budget, double delay_s)
{
    static auvid_real_t past[32];
    sim_t sim;
    sim_output_t sensed;
    auvid_real_t command = 0;
    bool excited = false;
    size_t ticks_late = (size_t)lround(delay_s / 0.02);
    memset(past, 0, sizeof past);
    begin(cfg, cfg->search.seed);
    TEST_ASSERT_TRUE(sim_init(&sim, world));
    for (size_t tick = 0; tick < sets * 1500 + 300; ++tick) {
        auvid_input_t in;
        auvid_output_t out;
        past[tick % 32] = command;
        double late = (double)past[(tick + 32 - ticks_late) % 32];
        const double wrench[6] = {force(late, sim.truth.nu[AUVID_SURGE]), 0.0,
                                  -world->parameter[SIM_WB]};
        sim_step(&sim, NULL, wrench, &sensed);
        TEST_ASSERT_EQUAL(AUVID_OK, chain_step_with_velocity(&id, &sensed, &excited, &in, &out));
        command = out.excitation[AUVID_SURGE];
        const auvid_real_t nominal[AUVID_DOF_COUNT] = {100 * command};
        const auvid_real_t commands[AUVID_MAX_COMMANDS] = {command, command};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, in.t_us, nominal, commands));
        if (each_step != NULL) {
            each_step(&id, &out);
        }
        (void)auvid_identifier_work(&id, budget);
        TEST_ASSERT_TRUE(id.work.last_units <= budget);
    }
    finish_work(&id, budget > 0 ? budget : AUVID_DEFAULT_BUDGET);
}

#endif
