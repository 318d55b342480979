/*
 * A hull in a constant current (Fossen 2011, 8.3). c is constant in the world frame, so in the body
 * frame (R' c)' = -omega x R' c. Then
 *
 *     nu_r = nu - R' c,    nu_r' = nu' + omega x R' c,
 *
 * and the hull's model for still water is valid for nu_r, nu_r'.
 */
#include "auvid/current.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "auvid_vehicle_internal.h"

/* c in body axes, and the derivative of these components. */
static void current_in_body(const auvid_sample_t *s, const auvid_real_t c[3], auvid_real_t body[3],
                            auvid_real_t rate[3])
{
    auvid_real_t r[3][3];
    const auvid_real_t *omega = s->nu + AUVID_ROLL;
    auvid_rotation(s->phi, s->theta, s->psi, r);
    for (int i = 0; i < 3; ++i) {
        body[i] = r[0][i] * c[0] + r[1][i] * c[1] + r[2][i] * c[2];
    }
    rate[0] = omega[2] * body[1] - omega[1] * body[2];
    rate[1] = omega[0] * body[2] - omega[2] * body[0];
    rate[2] = omega[1] * body[0] - omega[0] * body[1];
}

/* Copies the sample to *water, with motion through the water. rate: see current_in_body. */
static void current_through_water(const auvid_current_t *current, const auvid_sample_t *sample,
                                  const auvid_real_t *pi, auvid_sample_t *water,
                                  auvid_real_t rate[3])
{
    auvid_real_t c[3] = {AUVID_C(0.0), AUVID_C(0.0), AUVID_C(0.0)}, body[3];
    int n = current->hull->parameters;
    memcpy(c, pi + n, (size_t)(current->vehicle.parameters - n) * sizeof *c);
    current_in_body(sample, c, body, rate);
    *water = *sample;
    for (int i = 0; i < 3; ++i) {
        water->nu[i] -= body[i];
        water->nu_dot[i] -= rate[i];
    }
}

static void current_residual(const void *context, const auvid_sample_t *sample,
                             const auvid_real_t *pi, auvid_real_t residual[AUVID_DOF_COUNT])
{
    const auvid_current_t *current = context;
    auvid_sample_t water;
    auvid_real_t rate[3];
    current_through_water(current, sample, pi, &water, rate);
    auvid_vehicle_residual(current->hull, &water, pi, residual);
}

static bool current_acceleration(const void *context, const auvid_sample_t *sample,
                                 const auvid_real_t *pi, auvid_real_t nu_dot[AUVID_DOF_COUNT])
{
    const auvid_current_t *current = context;
    const auvid_vehicle_t *vehicle = current->hull;
    auvid_sample_t water;
    auvid_real_t rate[3];
    current_through_water(current, sample, pi, &water, rate);
    bool possible = vehicle->acceleration(vehicle->context, &water, pi, nu_dot);
    for (int i = 0; i < 3; ++i) {
        nu_dot[i] += vehicle->columns[i] != 0 ? rate[i] : AUVID_C(0.0);
    }
    return possible;
}

auvid_status_t auvid_current_init(auvid_current_t *current, const auvid_vehicle_t *hull, bool down)
{
    static const auvid_parameter_t component[3] = {
        {"c_north", "m/s", AUVID_SURGE, AUVID_PARAMETER_UNSCALED},
        {"c_east", "m/s", AUVID_SURGE, AUVID_PARAMETER_UNSCALED},
        {"c_down", "m/s", AUVID_HEAVE, AUVID_PARAMETER_UNSCALED}};
    if (current == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_vehicle_check(hull);
    if (status < 0) {
        return status;
    }
    int n = hull->parameters, components = down ? 3 : 2;
    if (n + components > AUVID_MAX_PARAMETERS) {
        return AUVID_ERR_PARAMETERS;
    }
    bool surge = hull->columns[AUVID_SURGE] != 0, sway = hull->columns[AUVID_SWAY] != 0;
    if (!(surge || sway) || (down && hull->columns[AUVID_HEAVE] == 0) ||
        hull == &current->vehicle) {
        return AUVID_ERR_MODEL;
    }
    memset(current, 0, sizeof *current);
    auvid_vehicle_t *vehicle = &current->vehicle;
    uint32_t bits = ((1u << components) - 1u) << n;
    *vehicle = *hull;
    vehicle->parameters = (uint8_t)(n + components);
    vehicle->parameter = current->parameter;
    vehicle->free |= hull->free != 0 ? bits : 0u;
    vehicle->path = &auvid_path_residual;
    vehicle->residual = current_residual;
    vehicle->thrust = NULL; /* the hull's is called in its residual */
    vehicle->regressor = NULL;
    vehicle->affine = auvid_vehicle_affine(hull);
    vehicle->smooth = hull->residual == NULL || hull->smooth;
    vehicle->acceleration = hull->acceleration != NULL ? current_acceleration : NULL;
    vehicle->context = current;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        vehicle->columns[j] |= hull->columns[j] != 0 ? bits : 0u;
        if (hull->reads[j] != 0) { /* the current in body axes depends on the rates */
            vehicle->reads[j] |= 1u << AUVID_ROLL | 1u << AUVID_PITCH | 1u << AUVID_YAW;
        }
    }
    current->hull = hull;
    memcpy(current->parameter, hull->parameter, (size_t)n * sizeof *component);
    memcpy(current->parameter + n, component, (size_t)components * sizeof *component);
    for (int i = n; i < n + 2; ++i) {
        current->parameter[i].dof = surge ? AUVID_SURGE : AUVID_SWAY;
    }
    return AUVID_OK;
}

auvid_status_t auvid_current_bounds(const auvid_current_t *current, auvid_real_t max_component,
                                    auvid_real_t *lower, auvid_real_t *upper)
{
    if (current == NULL || lower == NULL || upper == NULL) {
        return AUVID_ERR_NULL;
    }
    if (current->hull == NULL) {
        return AUVID_ERR_STATE;
    }
    if (!auvid_is_finite(max_component)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (!(max_component > AUVID_C(0.0))) {
        return AUVID_ERR_RANGE;
    }
    int n = current->hull->parameters;
    for (int i = 0; i < n; ++i) {
        auvid_parameter_kind_t kind = current->parameter[i].kind;
        if (kind == AUVID_PARAMETER_MASS || kind == AUVID_PARAMETER_INERTIA) {
            lower[i] = auvid_max(lower[i], AUVID_C(0.0));
        } else if (auvid_vehicle_is_drag(kind)) {
            upper[i] = auvid_min(upper[i], AUVID_C(0.0));
        }
    }
    for (int i = n; i < current->vehicle.parameters; ++i) {
        lower[i] = -max_component;
        upper[i] = max_component;
    }
    return AUVID_OK;
}
