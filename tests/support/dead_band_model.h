/**
 * @file dead_band_model.h
 * A user's own model: surge with two thrusters that have a dead band and a different gain in each
 * direction, with commands as inputs.
 */
#ifndef DEAD_BAND_MODEL_H
#define DEAD_BAND_MODEL_H

#include <math.h>

#include "auvid/vehicle.h"

enum { GAIN_FORWARD, GAIN_BACKWARD, DEAD_BAND, X_U, X_UU, PARAMETERS };

static const auvid_parameter_t parameter[PARAMETERS] = {
    {"gain_forward", "N", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"gain_backward", "N", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"dead_band", "1", AUVID_SURGE, AUVID_PARAMETER_OTHER},
    {"X_u", "N s/m", AUVID_SURGE, AUVID_PARAMETER_LINEAR_DRAG},
    {"X_uu", "N s2/m2", AUVID_SURGE, AUVID_PARAMETER_QUADRATIC_DRAG},
};
static const double truth[PARAMETERS] = {70.0, 55.0, 0.12, -42.4181, -125.3578};
static const auvid_real_t low[PARAMETERS] = {0, 0, 0, -200, -500};
static const auvid_real_t high[PARAMETERS] = {300, 300, AUVID_C(0.5), 0, 0};
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

/** Force of both thrusters at a command, with the true parameters [N]. The speed has no effect. */
double dead_band_force(double command, double speed);

/** The model and its bounds, for Python.
 * @param lower [PARAMETERS]
 * @param upper [PARAMETERS] */
const auvid_vehicle_t *dead_band_vehicle(void);
void dead_band_bounds(auvid_real_t *lower, auvid_real_t *upper);

#endif
