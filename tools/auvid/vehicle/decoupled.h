/**
 * @file decoupled.h
 * A six-degree-of-freedom model without the terms between degrees of freedom: each equation keeps
 * its own mass or inertia, its own drags, constant forces, weight and buoyancy.
 */
#ifndef PROGRAM_DECOUPLED_H
#define PROGRAM_DECOUPLED_H

#include "auvid/vehicle.h"

/** The model. It must not move while `vehicle` is in use. */
typedef struct {
    auvid_vehicle_t vehicle;
    const auvid_vehicle_t *rows; /* whose rows these are */
    const auvid_vehicle_t *hull; /* whose motion this is: not averaged over rows */
    uint8_t mass[AUVID_DOF_COUNT];
    char name[64];
} decoupled_t;

/** Can a model be decoupled? Those of Fossen can. */
bool decoupled_exists(const auvid_vehicle_t *model);

/** Makes the model. @param rows the hull's model, or its average over rows (fossen.h) */
void decoupled_init(decoupled_t *d, const auvid_vehicle_t *rows, const auvid_vehicle_t *hull);

#endif
