/**
 * @file surge_thrusters.h
 * Shared by the tests of free thrusters: a hull with one axis, surge, two thrusters at its stern
 * with the same command, and the identification of both in the simulator. One test program includes
 * it once.
 */
#ifndef SURGE_THRUSTERS_H
#define SURGE_THRUSTERS_H

#include <math.h>

#include "auvid/prior.h"
#include "auvid/thrusters.h"
#include "chain.h"
#include "finish.h"
#include "unity.h"

/* A hull with one axis, surge; the parameters of its couplings are known. */
enum { M_U, M_V, M_W, W_B, X_U, X_UU, HULL };
enum { FORWARD = HULL, BACKWARD, DEAD_BAND, LAG, PARAMETERS };
enum { FREE = 1u << X_U | 1u << X_UU };

static const auvid_parameter_t parameter[HULL] = {
    {"m_u", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"m_v", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"m_w", "kg", AUVID_SURGE, AUVID_PARAMETER_MASS},
    {"W-B", "N", AUVID_SURGE, AUVID_PARAMETER_FORCE},
    {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_LINEAR_DRAG},
    {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG},
};

static inline void regressor(const void *context, const auvid_sample_t *s, const auvid_real_t *pi,
                             auvid_regressor_t *y)
{
    (void)context;
    (void)pi;
    auvid_real_t *x = y->row[AUVID_SURGE], u = s->nu[AUVID_SURGE];
    x[M_U] = s->nu_dot[AUVID_SURGE];
    x[M_V] = -s->nu[AUVID_SWAY] * s->nu[AUVID_YAW];
    x[M_W] = s->nu[AUVID_HEAVE] * s->nu[AUVID_PITCH];
    x[W_B] = (auvid_real_t)sin((double)s->theta);
    x[X_U] = -u;
    x[X_UU] = -(u > 0 ? u : -u) * u;
}

static const auvid_vehicle_t hull = {.built_for = AUVID_BUILD,
                                     .path = &auvid_path_regressor,
                                     .name = "surge",
                                     .parameters = HULL,
                                     .parameter = parameter,
                                     .columns = {[AUVID_SURGE] = (1u << HULL) - 1},
                                     .free = FREE,
                                     .regressor = regressor};

enum { SETS = 8, ROW_CELLS = 2, LONGEST_S = 60, PERIOD_US = 20000 };
enum { SLOTS = AUVID_THRUSTERS_SLOTS(SETS, LONGEST_S * 1000000u, PERIOD_US) };
static int16_t commands[2 * SLOTS];
static auvid_row_t store[(SETS + 1) * LONGEST_S * 10 / ROW_CELLS];
static auvid_thrusters_config_t cfg;
static auvid_identifier_config_t id_config;
static auvid_thrusters_t thrusters;
static auvid_identifier_t id, ideal;
static auvid_prior_t prior;
static bool with_prior; /* configure() attaches it */

/** For setUp. */
static inline void surge_thrusters_defaults(void)
{
    auvid_thrusters_defaults(&cfg);
    cfg.hull = &hull;
    cfg.thrusters = 1;
    cfg.matrix[AUVID_SURGE][0] = 2;
    cfg.gain_max = 300;
    cfg.log = commands;
    cfg.slots = SLOTS;
    with_prior = false;
}

/* The defaults of an identifier whose sets have `set_s` seconds. */
static inline void defaults(uint16_t row_cells, uint16_t set_s)
{
    auvid_identifier_defaults(&id_config, &thrusters.vehicle);
    id_config.metric.rows = store;
    id_config.metric.row_slots = sizeof store / sizeof store[0];
    id_config.metric.sets = SETS;
    id_config.metric.row_cells = row_cells;
    id_config.metric.set_rows = (uint16_t)(set_s * 10u / row_cells);
    id_config.metric.fixed[M_U] = 250;
}

static inline void begin(void)
{
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg, NULL));
    defaults(ROW_CELLS, 30);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &id_config));
}

/* ---- identification ---- */

static double truth[PARAMETERS];

static inline double thrust(double c)
{
    double d = truth[DEAD_BAND];
    return c > d ? truth[FORWARD] * (c - d) : c < -d ? truth[BACKWARD] * (c + d) : 0.0;
}

/* Each seed has another vehicle, with each parameter within 30 % of its usual value. */
static inline void draw_world(sim_config_t *world, uint64_t seed, double disturbance_N)
{
    sim_rng_t rng;
    double scale[6];
    sim_rng_seed(&rng, seed, 77);
    for (int i = 0; i < 6; ++i) {
        scale[i] = 0.7 + 0.6 * sim_rng_uniform(&rng);
    }
    sim_defaults(world);
    world->seed = seed;
    world->disturbance_N = disturbance_N;
    truth[M_U] = world->parameter[SIM_M_U] *= scale[0];
    truth[M_V] = world->parameter[SIM_M_V];
    truth[M_W] = world->parameter[SIM_M_W];
    truth[W_B] = world->parameter[SIM_WB];
    truth[X_U] = world->parameter[SIM_X_U] *= scale[1];
    truth[X_UU] = world->parameter[SIM_X_UU] *= scale[2];
    truth[FORWARD] = 80.0 * scale[3];
    truth[BACKWARD] = truth[FORWARD] * (0.7 + 0.1 * sim_rng_uniform(&rng));
    truth[DEAD_BAND] = 0.1 * scale[4];
    truth[LAG] = 0.22 * scale[5];
}

static inline void configure(uint64_t seed, uint16_t set_s, uint16_t row_cells)
{
    const auvid_real_t amplitude[AUVID_DOF_COUNT] = {1}; /* of the command */
    static auvid_actuation_t actuation;
    auvid_actuation_config_t acting;
    auvid_identifier_config_t plain;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_init(&thrusters, &cfg, NULL));
    defaults(row_cells, set_s);
    auvid_identifier_defaults(&plain, &hull);
    plain.metric.set_rows = (uint16_t)(set_s * 2);
    for (int i = 0; i < X_U; ++i) {
        id_config.metric.fixed[i] = plain.metric.fixed[i] = (auvid_real_t)truth[i];
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_configure(&thrusters, &id_config));
    id_config.search.upper[X_U] = id_config.search.upper[X_UU] = 0;
    id_config.search.seed = seed;
    auvid_actuation_defaults(&acting);
    acting.guard.off = /* there is no depth sensor, and enough space */
        AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MIN) | AUVID_GUARD_BIT(AUVID_GUARD_DEPTH_MAX);
    acting.guard.distance_max_m = 1000;
    acting.guard.speed_max = 5;
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_excitation_plan(&acting.excitation, amplitude, set_s, SETS, seed));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &id_config));
    if (with_prior) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_thrusters_attach_prior(&thrusters, &id, &prior));
    }
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_actuation(&id, &actuation, &acting, NULL));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&ideal, &plain));
}

/* Returns the mean force of a thruster over a tick; the lag is computed in steps of 2 ms. */
static inline double follow(double *x, double command)
{
    double mean = 0.0, g = thrust(command), h = 0.002;
    for (int i = 0; i < 10; ++i) {
        double e = exp(-h / truth[LAG]);
        mean += 0.1 * (g + (*x - g) * (1.0 - e) * truth[LAG] / h);
        *x = g + (*x - g) * e;
    }
    return mean;
}

/* The excitation's surge "force" is the command of both thrusters. `ideal` receives the mean gain
 * times the command as force. */
static inline void identify(uint64_t seed, double disturbance_N, uint16_t set_s, uint16_t row_cells,
                            uint32_t budget)
{
    sim_config_t world;
    sim_t sim;
    sim_output_t sensed;
    double x = 0.0;
    auvid_real_t command = 0;
    bool excited = false;
    draw_world(&world, seed, disturbance_N);
    configure(seed, set_s, row_cells);
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    for (int tick = 0; tick < SETS * set_s * 50 + 300; ++tick) {
        auvid_input_t in;
        auvid_output_t out, other;
        const double wrench[6] = {2.0 * follow(&x, (double)command), 0.0, -truth[W_B]};
        sim_step(&sim, NULL, wrench, &sensed);
        TEST_ASSERT_EQUAL(AUVID_OK, chain_step_with_velocity(&id, &sensed, &excited, &in, &out));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&ideal, &in, &other));
        command = out.excitation[AUVID_SURGE];
        const auvid_real_t gain = (auvid_real_t)(truth[FORWARD] + truth[BACKWARD]);
        const auvid_real_t nominal[AUVID_DOF_COUNT] = {gain * command};
        const auvid_real_t all[AUVID_MAX_COMMANDS] = {command};
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&id, in.t_us, nominal, all));
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_applied(&ideal, in.t_us, nominal, NULL));
        (void)auvid_identifier_work(&id, budget);
        TEST_ASSERT_TRUE(id.work.last_units <= budget);
    }
    finish_work(&id, UINT32_MAX);
    finish_work(&ideal, UINT32_MAX);
    TEST_ASSERT_TRUE(id.estimate.sets == SETS || id.metric.sets.rows_dropped > 0);
    TEST_ASSERT_EQUAL_HEX32(FREE | 15u << HULL, id.estimate.identified);
    TEST_ASSERT_FALSE(id.estimate.not_converged);
}

/* Returns the relative error of a parameter. */
static inline double error_of(int i)
{
    return (double)id.estimate.pi[i] / truth[i] - 1.0;
}

/* A data sheet of the thrusters of seed 1, with a lag `by` times the true one. */
static inline void use_sheet(double by, double lag_sigma_s)
{
    sim_config_t world;
    draw_world(&world, 1, 0.0);
    with_prior = true;
    cfg.sheet[0].gain = (auvid_real_t)truth[FORWARD];
    cfg.sheet[0].backward = (auvid_real_t)(truth[BACKWARD] / truth[FORWARD]);
    cfg.sheet[0].dead_band = (auvid_real_t)truth[DEAD_BAND];
    cfg.sheet[0].lag_s = (auvid_real_t)(by * truth[LAG]);
    cfg.sheet[0].lag_sigma_s = (auvid_real_t)lag_sigma_s;
}

#endif
