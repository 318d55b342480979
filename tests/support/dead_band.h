/**
 * @file dead_band.h
 * Shared by the tests of a user's own model: surge with two thrusters that have a dead band and a
 * different gain in each direction, with commands as inputs. Contains its simulation, and an
 * identifier that excites it. One test program includes it once.
 */
#ifndef DEAD_BAND_H
#define DEAD_BAND_H

#include <math.h>
#include <string.h>

#include "auvid/identifier.h"
#include "chain.h"
#include "finish.h"
#include "unity.h"

enum { GAIN_FORWARD, GAIN_BACKWARD, DEAD_BAND, X_U, X_UU, PARAMETERS };

static const auvid_parameter_t parameter[PARAMETERS] = {
    {"gain_forward", "N", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"gain_backward", "N", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"dead_band", "1", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_LINEAR_DRAG},
    {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG},
};
static const double truth[PARAMETERS] = {70.0, 55.0, 0.12, -42.4181, -125.3578};
static const auvid_real_t mass = AUVID_C(249.5384), weight_minus_buoyancy = AUVID_C(-37.3058);

static inline auvid_real_t thrust(auvid_real_t command, const auvid_real_t *pi)
{
    auvid_real_t gain = command > 0 ? pi[GAIN_FORWARD] : pi[GAIN_BACKWARD];
    auvid_real_t beyond = (command > 0 ? command : -command) - pi[DEAD_BAND];
    auvid_real_t force = beyond > 0 ? gain * beyond : 0;
    return command > 0 ? force : -force;
}

/* Two stern thrusters; only surge. */
static inline void residual(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                            auvid_real_t *e)
{
    (void)context;
    auvid_real_t u = s->nu[AUVID_SURGE], speed = u > 0 ? u : -u;
    e[AUVID_SURGE] = mass * s->nu_dot[AUVID_SURGE] +
                     weight_minus_buoyancy * (auvid_real_t)sin((double)s->theta) - pi[X_U] * u -
                     pi[X_UU] * speed * u - thrust(s->command[0], pi) - thrust(s->command[1], pi);
}

static const auvid_vehicle_t vehicle = {.built_for = AUVID_BUILD,
                                        .path = &auvid_path_residual,
                                        .name = "surge with dead band",
                                        .parameters = PARAMETERS,
                                        .parameter = parameter,
                                        .columns = {[AUVID_SURGE] = (1u << PARAMETERS) - 1},
                                        .residual = residual};

enum { SETS = 8, SET_ROWS = 150 };
static auvid_identifier_t id;
static auvid_actuation_t actuation;
static auvid_validation_t prediction;
static auvid_change_detector_t change;
static auvid_row_t store[(SETS + 1) * SET_ROWS];

static inline void configure(auvid_identifier_config_t *cfg, uint64_t seed)
{
    static const auvid_real_t low[PARAMETERS] = {0, 0, 0, -200, -500};
    static const auvid_real_t high[PARAMETERS] = {300, 300, AUVID_C(0.5), 0, 0};
    auvid_identifier_defaults(cfg, &vehicle);
    cfg->exact_inputs = true;
    cfg->metric.rows = store;
    cfg->metric.sets = SETS;
    cfg->metric.set_rows = SET_ROWS;
    cfg->metric.row_cells = 2;
    memcpy(cfg->search.lower, low, sizeof low);
    memcpy(cfg->search.upper, high, sizeof high);
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

/** The surge "force" of the excitation is the command of both thrusters.
 * Runs until `sets` of the SETS are complete, and then until the work is done.
 * @param budget of each step; 0: the work is done at once at the end */
static inline void identify(uint64_t seed, uint32_t sets, uint32_t budget, double disturbance_N,
                            double delay_s)
{
    static auvid_real_t past[32];
    auvid_identifier_config_t cfg;
    sim_config_t world;
    sim_t sim;
    sim_output_t sensed;
    auvid_real_t pi[PARAMETERS], command = 0;
    bool excited = false;
    size_t ticks_late = (size_t)lround(delay_s / 0.02);
    for (int i = 0; i < PARAMETERS; ++i) {
        pi[i] = (auvid_real_t)truth[i];
    }
    memset(past, 0, sizeof past);
    configure(&cfg, seed);
    begin(&cfg, seed);
    sim_defaults(&world);
    world.seed = seed;
    world.disturbance_N = disturbance_N;
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    for (size_t tick = 0; tick < sets * 1500 + 300; ++tick) {
        auvid_input_t in;
        auvid_output_t out;
        past[tick % 32] = command;
        double force = 2.0 * (double)thrust(past[(tick + 32 - ticks_late) % 32], pi);
        const double wrench[6] = {force, 0.0, -world.parameter[SIM_WB]};
        sim_step(&sim, NULL, wrench, &sensed);
        chain_sense(&sensed, 0, &in);
        in.depth.present = in.altitude.present = in.gps.present = false;
        if (!excited && auvid_identifier_arm(&id) == AUVID_OK) {
            excited = auvid_identifier_excite(&id) == AUVID_OK;
        }
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&id, &in, &out));
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
    finish_work(&id, budget > 0 ? budget : UINT32_MAX);
}

#endif
