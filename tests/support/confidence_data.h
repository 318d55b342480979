/**
 * @file confidence_data.h
 * Shared by the tests of the confidence. They evaluate a vehicle's equations for synthetic motion
 * at the cells of the recorder. A metric is then full at once, and the test chooses what the data
 * determine. A test program includes it once.
 */
#ifndef CONFIDENCE_DATA_H
#define CONFIDENCE_DATA_H

#include <math.h>
#include <string.h>

#include "auvid/detail/confidence.h"
#include "sines.h"
#include "unity.h"

enum { SETS = 8, COUNT = 13 };

static auvid_metric_t metric;
static auvid_confidence_job_t job;
static const auvid_confidence_t *const result = &job.result;
static auvid_real_t truth[AUVID_G500_COUNT], estimate[AUVID_MAX_PARAMETERS];

/** For setUp. */
static inline void confidence_data_defaults(void)
{
    memcpy(truth, auvid_girona500_paper, sizeof truth);
}

/* Motion in the DoF of the mask, with some roll. */
static inline void move(double t, uint32_t dofs, auvid_sample_t *s)
{
    sines_motion(t, dofs, s);
    s->phi = (auvid_real_t)(0.02 * sin(0.29 * t + 1.0));
}

/* A synthetic run: the DoF that move, the number of sets, white noise of the force and of the
 * measured acceleration. */
typedef struct {
    uint32_t dofs;
    int sets;
    double force_N, acceleration;
} world_t;

enum {
    SURGE = 1u << AUVID_SURGE,
    ALL = 1u << AUVID_SURGE | 1u << AUVID_SWAY | 1u << AUVID_HEAVE | 1u << AUVID_YAW
};

/* The wrench that gives the motion with the true parameters, then the noise. */
static inline void add_noise(auvid_sample_t *s, const world_t *world, uint64_t *state)
{
    double tau[AUVID_DOF_COUNT];
    sines_wrench(s, truth, tau);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        s->tau[j] = (auvid_real_t)(tau[j] + sines_noise(world->force_N, j, state));
        s->nu_dot[j] += (auvid_real_t)(world->acceleration * sines_gauss(state));
    }
}

/* Fill the metric with the sets of the world. */
static inline void record(const auvid_metric_config_t *cfg, const world_t *world)
{
    uint64_t state = 5;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_init(&metric, cfg));
    for (uint64_t k = 1; metric.sets.recorded < (uint32_t)world->sets; ++k) {
        auvid_sample_t s;
        move(0.1 * (double)k, world->dofs, &s);
        add_noise(&s, world, &state);
        s.t_us = 100000 * k;
        TEST_ASSERT_TRUE(auvid_metric_add(&metric, &s) >= AUVID_OK);
    }
}

static inline auvid_metric_config_t default_config(void)
{
    auvid_metric_config_t cfg;
    auvid_metric_defaults(&cfg, &auvid_girona500);
    cfg.estimate_delay = false;
    cfg.velocity_us = 0;
    return cfg;
}

/* The confidence in `estimate`. */
static inline void compute_confidence(auvid_real_t dry_mass_kg)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_measure_begin(&metric, estimate, AUVID_C(0.0));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_measure(&metric, &budget));
    auvid_confidence_begin(&job, &metric, estimate, dry_mass_kg, NULL);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_confidence_work(&job, &metric, &budget));
}

/* Least squares over the searched parameters, except those left at zero, and their confidence. */
static inline void estimate_without(uint32_t left_out, auvid_real_t dry_mass_kg)
{
    uint32_t budget = UINT32_MAX;
    auvid_metric_merge_begin(&metric);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_merge(&metric, &budget));
    memcpy(estimate, metric.cfg.fixed, sizeof metric.cfg.fixed);
    uint32_t solved = auvid_metric_searched(&metric) & ~left_out;
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_metric_least_squares(&metric, solved, estimate));
    compute_confidence(dry_mass_kg);
}

static inline void estimate_all(void)
{
    estimate_without(0, AUVID_C(0.0));
}

/* A run of the world with the default configuration: its estimate and the confidence in it. */
static inline void observe(const world_t *world)
{
    auvid_metric_config_t cfg = default_config();
    record(&cfg, world);
    estimate_all();
}

#endif
