/**
 * @file averaged.h
 * A model for vehicles whose velocity changes faster than their DVL samples it.
 *
 * The recorder interpolates velocity between DVL samples and averages it over a cell. The mean of
 * the drag over that time is not the drag of the mean velocity:
 *
 *     mean |u|u = |u|u + sign(u) u'^2 s^2,   s^2 = T^2 / 6 + cell^2 / 12,
 *
 * T is the time between DVL samples. s^2 is the second moment of interpolation and cell mean. At
 * 5 Hz and 0.5 m/s^2 the difference is a force of 0.3 N in a BlueROV2, always along the motion.
 * Interpreted as linear drag, it makes X_u 2 % too large, for any amount of data. For a Girona500,
 * which needs seconds to change its velocity, the effect is negligible.
 *
 * This model averages the wrapped model's rows at two times, s before and s after the sample. The
 * mean is correct for quadratic drag and a good approximation for products of velocities. Angular
 * rates (s^2 = cell^2 / 12) are treated in the same way. The angles in the restoring terms are not
 * averaged.
 *
 *     static auvid_averaged_t model;
 *     (void)auvid_averaged_init(&model, &auvid_bluerov2_heavy, 100000, 200000);
 *     auvid_identifier_defaults(&cfg, &model.vehicle);
 *     cfg.metric.max_cell_us = 0;  // the average is over cells of this length
 *
 * The metric calls the regressor once for each cell. Cost: two calls of the wrapped regressor and n
 * means for each degree of freedom, 2.3k instructions of a Cortex-M4F for BlueROV2; 0.7 KiB of
 * stack with 22 parameters. Memory: sizeof(auvid_averaged_t), 88 bytes on a Cortex-M. The model is
 * not part of the paper. Unused code is not linked.
 */
#ifndef AUVID_AVERAGED_H
#define AUVID_AVERAGED_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The averaged model. It must not move while `vehicle`, which points back to it, is in use. */
typedef struct {
    auvid_vehicle_t vehicle;      /**< model for identifier, metric and validation */
    const auvid_vehicle_t *other; /* the wrapped model */
    auvid_real_t spread_s[2];     /* s of velocities and of angular rates [s] */
} auvid_averaged_t;

#define auvid_averaged_init AUVID_SIZED(auvid_averaged_init)
/** Makes a->vehicle, the averaged version of a model.
 * @param a out; unchanged if refused
 * @param vehicle the model to wrap, with regressor; must outlive *a; must not be &a->vehicle
 * @param cell_us the recorder's cell [us], 1000..1000000; the recorder's default is 100000
 * @param velocity_us time between velocity samples [us], 0..1000000, as in metric_config.h
 * @return AUVID_OK; AUVID_ERR_NULL; the errors of auvid_vehicle_check; AUVID_ERR_MODEL (the model
 * has no regressor, or is &a->vehicle); AUVID_ERR_RANGE (a time). Cost: constant. */
auvid_status_t auvid_averaged_init(auvid_averaged_t *a, const auvid_vehicle_t *vehicle,
                                   uint32_t cell_us, uint32_t velocity_us);

#ifdef __cplusplus
}
#endif

#endif
