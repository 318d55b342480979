/**
 * @file auvid_vehicle_internal.h
 * Private: the check of a model, shared with the metric and the identifier.
 */
#ifndef AUVID_VEHICLE_INTERNAL_H
#define AUVID_VEHICLE_INTERNAL_H

#include "auvid/vehicle.h"

/** auvid_vehicle_check; *why names what is refused. */
void auvid_vehicle_check_fields(const auvid_vehicle_t *vehicle, auvid_refusal_t *why);

/** Returns the parameters in which a model's residual is affine: all, if rows give it. */
static inline uint32_t auvid_vehicle_affine(const auvid_vehicle_t *vehicle)
{
    return vehicle->residual == NULL ? UINT32_MAX >> (32 - vehicle->parameters) : vehicle->affine;
}

/** Is it a coefficient of drag? */
static inline bool auvid_vehicle_is_drag(auvid_parameter_kind_t kind)
{
    return kind == AUVID_PARAMETER_LINEAR_DRAG || kind == AUVID_PARAMETER_QUADRATIC_DRAG;
}

#endif
