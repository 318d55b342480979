/**
 * @file sim_run.h
 * Shared by the tests of the simulator: one simulator, how it is begun and run, and what is taken
 * out of it. A test program includes it once.
 */
#ifndef SIM_RUN_H
#define SIM_RUN_H

#include <math.h>

#include "simulator.h"
#include "unity.h"

static sim_config_t cfg;
static sim_t sim;
static sim_output_t out;

static inline void begin(void)
{
    TEST_ASSERT_TRUE(sim_init(&sim, &cfg));
}

static inline void without_noise(void)
{
    cfg.imu_angle_rad = cfg.imu_rate_rad_s = cfg.dvl_m_s = cfg.depth_m = cfg.gps_m = 0;
}

/** Neutral and without drag: only inertia, and Coriolis forces that do no work. */
static inline void without_losses(void)
{
    for (int i = SIM_X_U; i < SIM_PARAMETERS; ++i) {
        cfg.parameter[i] = 0;
    }
    cfg.tilt_linear = cfg.tilt_quadratic = 0;
    cfg.munk = 1;
}

static inline void run(double seconds, const double wrench[6])
{
    for (long i = lround(seconds * 50); i > 0; --i) {
        sim_step(&sim, NULL, wrench, &out);
    }
}

#endif
