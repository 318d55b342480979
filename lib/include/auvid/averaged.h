/**
 * @file averaged.h
 * A vehicle model for vehicles that are quicker than their DVL.
 *
 * The recorder's velocity is no value at one time: it is interpolated between DVL samples, and then
 * averaged over a cell. The mean of the drag over that time is not the drag of the mean velocity:
 *
 *     mean |u|u = |u|u + sign(u) u'^2 s^2,   s^2 = T^2 / 6 + cell^2 / 12,
 *
 * T the time between DVL samples, s^2 the variance of the time that a velocity stands for. At 5 Hz
 * and a change of 0.5 m/s^2 that is a force of 0.3 N in a BlueROV2, always along the motion: taken
 * for linear drag, it makes X_u 2 % too large, however much data there is. In a Girona500, which
 * needs seconds to change its velocity, it is nothing.
 *
 * This model has the other's rows, averaged over the two moments s before and s after the sample:
 * right for quadratic drag, near enough for products of velocities. Rates (s^2 = cell^2 / 12) are
 * treated alike. The angles of gravity's terms are left as they are.
 *
 *     static auvid_averaged_t model;
 *     (void)auvid_averaged_init(&model, &auvid_bluerov2_heavy, 100000, 200000);
 *     auvid_identifier_defaults(&cfg, &model.vehicle);
 *
 * Called by the metric, once a cell. Cost: twice the other regressor and n means for each degree of
 * freedom, 2.3k instructions of a Cortex-M4F for BlueROV2; 0.7 KiB of stack with 22 parameters.
 * Memory: sizeof(auvid_averaged_t), 72 bytes on a Cortex-M. Nothing of the paper's; where it is not
 * used it is not linked.
 */
#ifndef AUVID_AVERAGED_H
#define AUVID_AVERAGED_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The model. Must stay where it is while somebody uses `vehicle`, which points back to it. */
typedef struct {
    auvid_vehicle_t vehicle;      /**< for identifier, metric and validation */
    const auvid_vehicle_t *other; /* of which it is */
    auvid_real_t spread_s[2];     /* s of velocities and of rates [s] */
} auvid_averaged_t;

#define auvid_averaged_init AUVID_SIZED1(auvid_averaged_init, AUVID_MAX_PARAMETERS)
/** Make a->vehicle.
 * @param vehicle a model with regressor; must outlive *a
 * @param cell_us the recorder's cell [us], 1000..1000000, default there 100000
 * @param velocity_us time between velocity samples [us], 0..1000000: metric.h's
 * @return AUVID_OK; AUVID_ERR_NULL; those of auvid_vehicle_check; AUVID_ERR_MODEL (it has no
 * regressor, or is a->vehicle); AUVID_ERR_RANGE (a time). Refused: *a is as before. */
auvid_status_t auvid_averaged_init(auvid_averaged_t *a, const auvid_vehicle_t *vehicle,
                                   uint32_t cell_us, uint32_t velocity_us);

#ifdef __cplusplus
}
#endif

#endif
