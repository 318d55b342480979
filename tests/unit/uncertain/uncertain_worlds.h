/*
 * Two worlds with uncertain inputs: Girona500 that is excited, and a body in surge that a
 * controller drives, without or with instruments.
 */
#ifndef UNCERTAIN_WORLDS_H
#define UNCERTAIN_WORLDS_H

#include <string.h>

#include "auvid/uncertain.h"
#include "uncertain_tick.h"
#include "unity.h"

enum {
    TICK_US = 20000,
    SAMPLE = 10, /* ticks between velocities of the body */
    SET_ROWS = 40
};
#define TAU_MAX_N AUVID_C(300.0)

typedef enum { EXCITED, PASSIVE, INSTRUMENTS } world_t;

static world_t world;
static chain_config_t cfg;
static chain_t chain;
static auvid_identifier_t *const id = &chain.id;
static auvid_allocation_config_t allocation;
static auvid_allocation_t thrusters;
static auvid_uncertain_config_t inputs;
static auvid_uncertain_t uncertain, before;
static auvid_instruments_t instruments;
static double pilot_N; /* who drives surge beside the excitation */
static struct {
    sim_rng_t rng;
    double u, disturbance, wanted, smooth, sum, tau, sampled;
} body;

/* Init and attach, as a program does that was started again. */
static inline void start(void)
{
    memset(&uncertain, 0xA5, sizeof uncertain);
    memset(&instruments, 0xA5, sizeof instruments);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&thrusters, &allocation));
    TEST_ASSERT_EQUAL(AUVID_OK, chain_init(&chain, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_uncertain(id, &uncertain, &inputs, &thrusters));
    if (world == INSTRUMENTS) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_attach_instruments(id, &instruments));
    }
}

static inline void begin_world(void)
{
    memset(&body, 0, sizeof body);
    sim_rng_seed(&body.rng, 1, 1);
    memset(&chain, 0, sizeof chain);
    TEST_ASSERT_TRUE(sim_init(&chain.sim, &cfg.sim));
    chain.waiting = true;
    start();
}

/* One thruster for each DoF that is driven. */
static inline void begin(world_t of)
{
    static const int driven[] = {AUVID_SURGE, AUVID_SWAY, AUVID_HEAVE, AUVID_YAW};
    world = of;
    chain_defaults(&cfg, 1, 4, 1.0);
    cfg.id.metric.set_rows = world == INSTRUMENTS ? 6 * SET_ROWS : SET_ROWS;
    cfg.passive = world != EXCITED;
    auvid_uncertain_defaults(&inputs);
    auvid_allocation_defaults(&allocation);
    allocation.thrusters = (uint8_t)(world == EXCITED ? 4 : 1);
    for (int i = 0; i < allocation.thrusters; ++i) {
        allocation.thruster[i].wrench[driven[i]] = 1;
        allocation.thruster[i].max_N = TAU_MAX_N;
        allocation.thruster[i].min_N = -TAU_MAX_N;
    }
    if (world != EXCITED) {
        cfg.id.metric.free = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U;
    }
    begin_world();
}

/* ---- the worlds ---- */

static inline void pilot(void)
{
    chain.wrench[AUVID_SURGE] += (auvid_real_t)pilot_N;
}

static inline void tick_vehicle(void)
{
    uncertain_tick(&chain, &cfg, pilot);
}

/* A fast controller against a strong disturbance; see test_instruments.c. */
static inline void tick_body(void)
{
    const double dt = TICK_US * 1e-6;
    auvid_real_t attitude[3] = {0}, nu[AUVID_DOF_COUNT] = {0}, wrench[AUVID_DOF_COUNT] = {0};
    auvid_real_t command[AUVID_MAX_COMMANDS] = {0}, reference[AUVID_DOF_COUNT] = {0};
    uint64_t t_us = (uint64_t)(chain.tick + 1u) * TICK_US;
    if (chain.tick % SAMPLE == 0) {
        body.sampled = body.u + 0.003 * sim_rng_gauss(&body.rng);
        nu[AUVID_SURGE] = (auvid_real_t)body.sampled;
        (void)auvid_identifier_motion(id, t_us, attitude, nu);
        if (chain.tick % 500 == 0) {
            body.wanted = 2.0 * sim_rng_uniform(&body.rng) - 1.0;
        }
        body.smooth += (body.wanted - body.smooth) * 0.2;
        body.sum += 10.0 * (body.smooth - body.sampled);
        body.tau = fmax(-300.0, fmin(300.0, 250.0 * (body.smooth - body.sampled) + body.sum));
    }
    reference[AUVID_SURGE] = (auvid_real_t)body.smooth;
    if (world == INSTRUMENTS) {
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_instruments_reference(&instruments, t_us, reference));
    }
    wrench[AUVID_SURGE] = command[0] = (auvid_real_t)body.tau;
    (void)auvid_identifier_applied(id, t_us, wrench, command);
    body.disturbance += -body.disturbance * dt / 2.0 + 40.0 * sqrt(dt) * sim_rng_gauss(&body.rng);
    body.u += (body.tau + body.disturbance - 120.0 * body.u) / 250.0 * dt;
}

/* A tick, and work: so little that no phase of a solution is passed over. */
static inline void tick(void)
{
    if (world == EXCITED) {
        tick_vehicle();
    } else {
        tick_body();
    }
    ++chain.tick;
    (void)auvid_identifier_work(id, id->work.phase == AUVID_WORK_IDLE ? 400
                                    : world == EXCITED                ? 20
                                                                      : 6);
}

#endif
