/**
 * @file underactuated.h
 * Two simulated vehicles without lateral thruster, driven by a pilot, with a passive identifier.
 *
 * - A surface craft with two propellers side by side: surge and yaw.
 * - A torpedo with one propeller, rudder and elevator. A fin makes the force c |u| u delta, 0.8 m
 *   behind the middle. Depth and heading follow from the fins only.
 *
 * Their model is Girona500's, with other values; the heave equation of the craft is not estimated.
 */
#ifndef UNDERACTUATED_H
#define UNDERACTUATED_H

#include <math.h>
#include <string.h>

#include "auvid/identifier.h"
#include "chain.h"
#include "finish.h"

enum { UNDER_SETS = 8, UNDER_SET_S = 30 };

/** How the world differs from the model and from what is reported; all zero: not at all. */
typedef struct {
    double disturbance_N;   /**< rms; 0.4 of it in Nm */
    bool straight;          /**< no yaw moment is commanded, nor rudder */
    bool untold_side_force; /**< the rudder's side force is not reported */
    double dvl_yaw_rad, dvl_arm_m, thrust_gain, lag_s, latency_s, current_m_s;
} under_world_t;

typedef struct {
    const char *name;
    uint32_t free; /**< as in auvid_metric_config_t */
    double hull[SIM_PARAMETERS];
    double tilt_inertia;
    auvid_real_t tau_max[AUVID_DOF_COUNT]; /**< sway, heave: of the force of coupling */
    double ahead_N;                        /**< mean of the thrust */
    auvid_real_t
        amplitude[AUVID_DOF_COUNT]; /**< of the excitation; yaw of a torpedo: of N at 1.5 m/s */
    double fin;                     /**< c [N s2/m2]; 0: no fins */
} under_vehicle_t;

static const under_vehicle_t under_craft = {
    .name = "craft",
    .free = ~(1u << AUVID_G500_M_W | 1u << AUVID_G500_W_B | 1u << AUVID_G500_Z_W |
              1u << AUVID_G500_Z_WW),
    .hull = {[SIM_M_U] = 35,
             [SIM_M_V] = 50,
             [SIM_M_W] = 60,
             [SIM_M_R] = 8,
             [SIM_WB] = 0,
             [SIM_X_U] = -5,
             [SIM_X_UU] = -12,
             [SIM_Y_V] = -20,
             [SIM_Y_VV] = -60,
             [SIM_Z_W] = -50,
             [SIM_Z_WW] = -100,
             [SIM_N_R] = -5,
             [SIM_N_RR] = -8},
    .tilt_inertia = 8,
    .tau_max = {40, 30, 30, 10, 10, 8},
    .ahead_N = 12,
    .amplitude = {14, 0, 0, 0, 0, 5},
};

static const under_vehicle_t under_torpedo = {
    .name = "torpedo",
    .free = (1u << SIM_PARAMETERS) - 1,
    .hull = {[SIM_M_U] = 52,
             [SIM_M_V] = 75,
             [SIM_M_W] = 75,
             [SIM_M_R] = 18,
             [SIM_WB] = -2,
             [SIM_X_U] = -4,
             [SIM_X_UU] = -8,
             [SIM_Y_V] = -50,
             [SIM_Y_VV] = -120,
             [SIM_Z_W] = -50,
             [SIM_Z_WW] = -120,
             [SIM_N_R] = -35,
             [SIM_N_RR] = -30},
    .tilt_inertia = 18,
    .tau_max = {40, 30, 30, 10, 10, 12},
    .ahead_N = 22,
    .amplitude = {14, 0, 0, 0, 0, 8},
    .fin = 12,
};

#define UNDER_FIN_ARM_M 0.8
#define UNDER_FIN_MAX_RAD 0.4

static auvid_identifier_t under_id;
static double under_max_rate[AUVID_DOF_COUNT], under_max_speed[AUVID_DOF_COUNT];

/* Elevator: depth steps of 6 m every 40 s. */
static inline double under_elevator(const sim_truth_t *t)
{
    double wanted = 50.0 + ((int)(1e-6 * (double)t->t_us / 40.0) % 2 ? 6.0 : 0.0);
    double pitch = fmax(-0.3, fmin(0.3, 0.1 * (t->position[2] - wanted)));
    double delta = 1.2 * (pitch - t->euler[1]) - 0.8 * t->nu[4];
    return fmax(-UNDER_FIN_MAX_RAD, fmin(UNDER_FIN_MAX_RAD, delta));
}

/* The wrench that acts in the next tick. */
static inline void under_pilot(const under_vehicle_t *v, const sim_truth_t *t,
                               const auvid_real_t *excitation, bool straight, double *wrench)
{
    memset(wrench, 0, AUVID_DOF_COUNT * sizeof *wrench);
    wrench[AUVID_SURGE] = v->ahead_N + (double)excitation[AUVID_SURGE];
    double yaw = straight ? 0.0 : (double)excitation[AUVID_YAW];
    if (v->fin > 0.0) {
        double pressure = v->fin * fabs(t->nu[0]) * t->nu[0];
        double largest = v->fin * 2.25 * UNDER_FIN_ARM_M;
        double rudder = fmax(-UNDER_FIN_MAX_RAD, fmin(UNDER_FIN_MAX_RAD, yaw / largest));
        double elevator = under_elevator(t);
        wrench[AUVID_YAW] = UNDER_FIN_ARM_M * pressure * rudder;
        wrench[AUVID_SWAY] = -pressure * rudder;
        wrench[AUVID_PITCH] = UNDER_FIN_ARM_M * pressure * elevator;
        wrench[AUVID_HEAVE] = pressure * elevator;
    } else {
        wrench[AUVID_YAW] = yaw;
    }
}

static inline void under_configure(const under_vehicle_t *v, const under_world_t *w, uint64_t seed,
                                   sim_config_t *sim, auvid_identifier_config_t *cfg)
{
    sim_defaults(sim);
    sim->seed = seed;
    memcpy(sim->parameter, v->hull, sizeof sim->parameter);
    sim->tilt_inertia = v->tilt_inertia;
    sim->tilt_linear = 20;
    sim->tilt_quadratic = 20;
    sim->tilt_righting = 20;
    sim->roll_arm_m = sim->pitch_arm_m = 0;
    sim->disturbance_N = w->disturbance_N;
    sim->disturbance_Nm = 0.4 * w->disturbance_N;
    sim->dvl_yaw_rad = w->dvl_yaw_rad;
    sim->dvl_arm_m[0] = w->dvl_arm_m;
    sim->lag_s = w->lag_s;
    sim->current[0] = w->current_m_s;
    auvid_identifier_defaults(cfg, &auvid_girona500);
    cfg->exact_inputs = true;
    cfg->metric.free = v->free & ((1u << SIM_PARAMETERS) - 1);
    memcpy(cfg->metric.tau_max, v->tau_max, sizeof v->tau_max);
    cfg->search.seed = seed;
}

static inline void under_track(const sim_truth_t *t)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        under_max_speed[j] = fmax(under_max_speed[j], fabs(t->nu[j]));
        under_max_rate[j] = fmax(under_max_rate[j], fabs(t->nu_dot[j]));
    }
}

/** Run 8 sets; the result is in under_id. */
static inline void under_identify(const under_vehicle_t *v, const under_world_t *w, uint64_t seed)
{
    static sim_t sim;
    sim_config_t world;
    sim_output_t seen;
    auvid_identifier_config_t cfg;
    auvid_excitation_t excitation;
    auvid_actuation_config_t plan;
    double wrench[AUVID_DOF_COUNT] = {0};
    under_configure(v, w, seed, &world, &cfg);
    memset(under_max_rate, 0, sizeof under_max_rate);
    memset(under_max_speed, 0, sizeof under_max_speed);
    auvid_actuation_defaults(&plan);
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_plan(&plan.excitation, v->amplitude, UNDER_SET_S,
                                                      UNDER_SETS, seed));
    TEST_ASSERT_TRUE(sim_init(&sim, &world));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_init(&under_id, &cfg));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_init(&excitation, &plan.excitation));
    TEST_ASSERT_EQUAL(AUVID_OK, auvid_excitation_start(&excitation, SIM_TICK_US));
    for (int tick = 0; tick < (UNDER_SETS * UNDER_SET_S + 6) * 50; ++tick) {
        auvid_input_t in;
        auvid_output_t out;
        auvid_real_t shape[AUVID_DOF_COUNT];
        sim_step(&sim, NULL, wrench, &seen);
        under_track(&sim.truth);
        chain_sense(&seen, 0, &in);
        (void)auvid_excitation_step(&excitation, in.t_us, shape);
        under_pilot(v, &sim.truth, shape, w->straight, wrench);
        in.applied.present = true;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            in.applied.wrench[j] = (auvid_real_t)wrench[j];
        }
        if (w->untold_side_force) {
            in.applied.wrench[AUVID_SWAY] = in.applied.wrench[AUVID_HEAVE] = 0;
        }
        wrench[AUVID_SURGE] *= 1.0 + w->thrust_gain;
        wrench[AUVID_YAW] *= 1.0 + w->thrust_gain;
        TEST_ASSERT_EQUAL(AUVID_OK, auvid_identifier_step(&under_id, &in, &out));
        (void)auvid_identifier_work(&under_id, AUVID_DEFAULT_BUDGET);
    }
    finish_work(&under_id, UINT32_MAX);
}

/** Is the estimate more than 20 % off, and the error's force at the largest motion above 2 % of
 * tau_max? */
static inline bool under_is_wrong(const under_vehicle_t *v, int i)
{
    const auvid_parameter_t *p = &auvid_girona500.parameter[i];
    double truth = v->hull[i], error = fabs((double)under_id.estimate.pi[i] - truth);
    double speed = under_max_speed[p->dof];
    double force = p->kind == AUVID_PARAMETER_LINEAR_DRAG      ? error * speed
                   : p->kind == AUVID_PARAMETER_QUADRATIC_DRAG ? error * speed * speed
                   : p->kind == AUVID_PARAMETER_FORCE          ? error
                                                               : error * under_max_rate[p->dof];
    return force > 0.02 * (double)v->tau_max[p->dof] &&
           (p->kind == AUVID_PARAMETER_FORCE || error > 0.2 * fabs(truth));
}

#endif
