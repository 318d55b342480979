/**
 * @file by_residual.h
 * Girona500 as a model without regressor: the same equations on the residual path, for tests.
 */
#ifndef BY_RESIDUAL_H
#define BY_RESIDUAL_H

#include <string.h>

#include "auvid/identifier.h"

static inline void by_residual_predict(const void *context, const auvid_sample_t *s,
                                       const auvid_real_t *pi, auvid_real_t *residual)
{
    (void)context;
    auvid_vehicle_residual(&auvid_girona500, s, pi, residual);
}

static inline auvid_vehicle_t by_residual_girona500(void)
{
    auvid_vehicle_t vehicle = auvid_girona500;
    vehicle.path = &auvid_path_residual;
    vehicle.regressor = NULL;
    vehicle.residual = by_residual_predict;
    return vehicle;
}

/** Configure that model with only surge free, in a ring of `sets` sets.
 * @param vehicle must outlive the identifier, as the rows
 * @param rows [(sets + 1) cfg->metric.set_rows] */
static inline void by_residual_surge(auvid_identifier_config_t *cfg, auvid_vehicle_t *vehicle,
                                     auvid_row_t *rows, uint8_t sets)
{
    *vehicle = by_residual_girona500();
    cfg->vehicle = vehicle;
    cfg->metric.rows = rows;
    cfg->metric.row_slots = (sets + 1u) * cfg->metric.set_rows;
    cfg->metric.sets = sets;
    cfg->metric.free = 1u << AUVID_G500_M_U | 1u << AUVID_G500_X_U | 1u << AUVID_G500_X_UU;
    memcpy(cfg->metric.fixed, auvid_girona500_paper, sizeof auvid_girona500_paper);
}

#endif
