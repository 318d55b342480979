/**
 * @file current.h
 * Estimates a constant current together with the parameters of a hull.
 *
 * With bottom lock the DVL measures velocity over ground, but the forces on the hull depend on
 * velocity through the water. This model wraps a hull's model (vehicle.h, or your own). The water
 * moves with c = (c_north, c_east, c_down), constant in the world frame:
 *
 *     nu_r = nu - R(eta)' c,    nu_r' = nu' + omega x R(eta)' c        (Fossen 2011, 8.3)
 *
 * The components of c [m/s] are additional parameters. The model is not linear in them, so it uses
 * the metric's residual path, which needs memory for its rows (metric_config.h: `rows`). A row
 * takes 152 bytes with AUVID_MAX_COMMANDS 1 and 240 with 8. The usual nine sets of 60 rows take 80
 * or 127 KiB.
 *
 * Two effects separate a current from a constant force (a biased thruster, a cable). In body axes,
 * the current turns when the vehicle turns. And quadratic drag |u|u has its kink where velocity
 * through the water is zero. Without both, current and force are not separable: a free constant
 * force then gets the note "only a combination with c_north". A fixed one has its fixed value,
 * usually zero. Surge must be excited, or sway if surge is not modelled; otherwise c is not
 * searched.
 *
 * The search: for Girona500's 13 parameters, c_north, c_east and the delay, Gauss-Newton steps
 * find a minimum. About 100 evaluations confirm it in the first search, and 33 in each further
 * one (tests/vehicles/test_search_current.c). An evaluation costs one unit of work for each row
 * (vehicle.work is the hull's). Such a unit takes 2.0k instructions of a Cortex-M4F instead of
 * 250. At AUVID_DEFAULT_BUDGET a first result over eight sets takes 27 s, a further one 12 s. The
 * change test runs only if a result uses five sets or more.
 * The delay is one shift, common to all degrees of freedom.
 *
 * Vehicles with fast dynamics: the mean over a row of 0.5 s does not represent their motion.
 * BlueROV2 in 0.3 m/s, usual rows: the rms error is 7 %, X_u is off by 3.1 N s/m, and c is 2 % too
 * small. These errors are far larger than the standard errors. Use rows of two cells
 * (metric.row_cells) and, as hull, the averaged model of such rows (auvid_averaged_init with 200000
 * as cell). Then the rms error is 2.1 % (13 of 14 seeds; one search did not converge, 49 % off),
 * and c is half a percent too small. In still water with the regressor the rms error is 1.0 %.
 *
 * A vertical current that is not a parameter biases heave. At 0.05 m/s Girona500's error is 12 %
 * instead of 2 %; with `down` it is 2 % again. If the current turns, by 0.05 m/s in five minutes,
 * the error is 3.7 % instead of 2.0 %.
 *
 * Call the functions before auvid_identifier_init. Cost of an evaluation: the hull's plus 390
 * instructions. Memory: sizeof(auvid_current_t). Unused code is not linked. Not available with
 * AUVID_MAX_COMMANDS 0.
 */
#ifndef AUVID_CURRENT_H
#define AUVID_CURRENT_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A hull in a current. Written by auvid_current_init. It must not move or change while `vehicle`
 * is in use. */
typedef struct {
    auvid_vehicle_t vehicle; /**< pass this model to the identifier. Parameters: the hull's, then
                                  c_north, c_east and, with `down`, c_down */
    const auvid_vehicle_t *hull;                       /**< model in still water */
    auvid_parameter_t parameter[AUVID_MAX_PARAMETERS]; /**< parameters of `vehicle` */
} auvid_current_t;

#define auvid_current_init AUVID_SIZED(auvid_current_init)
/**
 * Makes the model of a hull in a current.
 * @param current out, completely written; unchanged if refused
 * @param hull the hull's model; must outlive *current; must not be &current->vehicle
 * @param down true: c_down is a parameter, too. It is separable from W-B only through drag
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_PARAMETERS (hull and current together have more than
 * AUVID_MAX_PARAMETERS); AUVID_ERR_MODEL (neither surge nor sway is modelled; `down` without heave;
 * the hull is &current->vehicle); the errors of auvid_vehicle_check for the hull. Cost: O(n).
 */
auvid_status_t auvid_current_init(auvid_current_t *current, const auvid_vehicle_t *hull, bool down);

#define auvid_current_bounds AUVID_SIZED(auvid_current_bounds)
/**
 * Sets search bounds for the current and for the signs of the hull's parameters. Without the sign
 * bounds there is a second, worse optimum: drags that accelerate the vehicle, in a current opposite
 * to the true one. The search does not always leave it.
 * @param max_component largest component of the current [m/s], > 0; for example 1
 * @param lower, upper in and out, [AUVID_MAX_PARAMETERS] bounds. Changed: those of the current, the
 * lower bounds of the hull's masses and inertias (at least 0), and the upper bounds of its drags
 * (at most 0; signs as in types.h)
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (max_component not > 0);
 * AUVID_ERR_STATE (not initialised). Cost: O(n).
 */
auvid_status_t auvid_current_bounds(const auvid_current_t *current, auvid_real_t max_component,
                                    auvid_real_t *lower, auvid_real_t *upper);

#ifdef __cplusplus
}
#endif

#endif
