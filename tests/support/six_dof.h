/**
 * @file six_dof.h
 * A simulated vehicle in six degrees of freedom, and an identifier that records its dive: passive,
 * with uncertain inputs. A pilot pushes each stick to another place every 1 to 5 s.
 */
#ifndef SIX_DOF_H
#define SIX_DOF_H

#include "auvid/allocation.h"
#include "auvid/fossen.h"
#include "auvid/uncertain.h"
#include "simulator.h"
#include "unity.h"

enum { SIX_DOF_S = 420, SIX_DOF_TICKS_PER_S = 1000000 / SIM_TICK_US };

/** Where the pilot pushes the sticks: mean and range of the wrench [N, Nm]. */
typedef struct {
    double mean[AUVID_DOF_COUNT], range[AUVID_DOF_COUNT];
} six_dof_sticks_t;

static sim_t sim;
static sim_config_t world;
static auvid_identifier_config_t cfg;
static auvid_identifier_t id;
static auvid_uncertain_t uncertain;
static auvid_allocation_t allocation;
static double truth[SIM_FOSSEN_PARAMETERS];

static void six_dof_push(const six_dof_sticks_t *sticks, sim_rng_t *rng, double *until,
                         auvid_real_t *wrench)
{
    for (int k = 0; k < AUVID_DOF_COUNT; ++k) {
        until[k] -= 1.0 / SIX_DOF_TICKS_PER_S;
        if (until[k] <= 0.0) {
            until[k] = 1.0 + 4.0 * sim_rng_uniform(rng);
            wrench[k] = (auvid_real_t)(sticks->mean[k] +
                                       sticks->range[k] * (2.0 * sim_rng_uniform(rng) - 1.0));
        }
    }
}

static void six_dof_record(const sim_output_t *seen)
{
    const sim_measurement_t *imu = &seen->sensor[SIM_IMU], *dvl = &seen->sensor[SIM_DVL];
    auvid_real_t attitude[3], nu[AUVID_DOF_COUNT], wrench[AUVID_DOF_COUNT];
    auvid_real_t command[SIM_THRUSTERS];
    for (int i = 0; i < 3; ++i) {
        attitude[i] = (auvid_real_t)imu->value[i];
        nu[i] = (auvid_real_t)dvl->value[i];
        nu[AUVID_ROLL + i] = (auvid_real_t)imu->value[3 + i];
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        wrench[j] = (auvid_real_t)seen->wrench[j];
    }
    for (int i = 0; i < SIM_THRUSTERS; ++i) {
        command[i] = (auvid_real_t)seen->thruster_N[i];
    }
    (void)auvid_identifier_applied(&id, seen->t_us - SIM_TICK_US, wrench, command);
    if (dvl->has && imu->has) {
        (void)auvid_identifier_motion(&id, dvl->t_us, attitude, nu);
    }
    (void)auvid_identifier_work(&id, 10000);
}

static void six_dof_attach(const auvid_allocation_config_t *thrusters)
{
    auvid_uncertain_config_t inputs;
    auvid_uncertain_defaults(&inputs);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_allocation_init(&allocation, thrusters));
    TEST_ASSERT_EQUAL(AUVID_OK,
                      auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &allocation));
}

/** Dive, and identify the vehicle: `world` and `cfg` say which one. */
static void six_dof_dive(const auvid_allocation_config_t *thrusters, const six_dof_sticks_t *sticks)
{
    sim_rng_t rng;
    auvid_real_t wrench[AUVID_DOF_COUNT] = {0};
    double until[AUVID_DOF_COUNT] = {0};
    six_dof_attach(thrusters);
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    sim_rng_seed(&rng, 11, 1);
    for (int k = 0; k < SIX_DOF_S * SIX_DOF_TICKS_PER_S; ++k) {
        auvid_allocation_result_t thrust;
        double force[SIM_THRUSTERS] = {0};
        sim_output_t seen;
        six_dof_push(sticks, &rng, until, wrench);
        (void)auvid_allocation_solve(&allocation, wrench, &thrust);
        for (int i = 0; i < world.thrusters; ++i) {
            force[i] = (double)thrust.force_N[i];
        }
        sim_step(&sim, force, NULL, &seen);
        six_dof_record(&seen);
    }
    while (auvid_identifier_work(&id, 1000000) == AUVID_PENDING) {
    }
}

#endif
