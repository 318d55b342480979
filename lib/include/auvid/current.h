/**
 * @file current.h
 * A constant current, estimated together with the parameters of a hull.
 *
 * With bottom lock the DVL measures velocity over ground; what acts on the hull depends on velocity
 * through the water. This model puts a hull's model (of vehicle.h, or one's own) into water that
 * moves with c = (c_north, c_east, c_down), constant in the world:
 *
 *     nu_r = nu - R(eta)' c,    nu_r' = nu' + omega x R(eta)' c        (Fossen 2011, 8.3)
 *
 * and adds the components of c [m/s] to the hull's parameters. It is not linear in them, so it
 * takes the metric's residual path, which needs memory for its rows (metric.h: `rows`): 152 bytes
 * each with AUVID_MAX_COMMANDS 1, 240 with 8; the nine sets of 60 that are usual, 80 or 127 KiB.
 *
 * What tells a current from a constant force (a biased thruster, a cable): in the vehicle's axes
 * the current turns when the vehicle does; and quadratic drag has its kink where velocity through
 * the water is zero. With neither nothing does: a constant force that is free gets the note "only a
 * combination with c_north" then. One that is not free is taken for what it is fixed at, zero as a
 * rule. Surge must be driven, or sway where surge is not modelled: else c is not searched.
 *
 * The search: Girona500's 13 parameters, c_north, c_east and the delay take about 1700 evaluations
 * for the first set and 700 for a further one. Each costs as many units of work as there are rows
 * (vehicle.work is the hull's), of 2.3k instructions of a Cortex-M4F each, not of 250. At
 * AUVID_DEFAULT_BUDGET a result over eight sets takes 50 to 70 s, longer than a set: one set waits
 * meanwhile, and rows that come after it are dropped (identifier.h). With a budget of 600 (12 s)
 * none are. Whether the vehicle has changed is judged only where a result is
 * of five sets or more. The delay is one shift, common to all degrees of freedom.
 *
 * A vehicle that is quicker than a row: means over a row of 0.5 s are not its motion. BlueROV2 in
 * 0.3 m/s is 7 % off (rms) with the usual rows, X_u by 3.1 N s/m, and c is 2 % too small, well
 * beyond their standard errors. Give it rows of two cells (metric.row_cells) and, as hull,
 * averages over these (auvid_averaged_init with 200000 as cell): 2.1 % (13 of 14 seeds; one search
 * ended `capped`, 49 % off) against 1.0 % in still water by regressor, and c half a percent too
 * small.
 *
 * A vertical current that is not a parameter spoils heave: with 0.05 m/s Girona500's error is 12 %
 * instead of 2 %, and with `down` 2 % again. One that turns by 0.05 m/s in five minutes makes 3.7 %
 * of 2.0 %.
 *
 * Called before auvid_identifier_init. Cost of an evaluation: the hull's and 390 instructions.
 * Memory: sizeof(auvid_current_t). Where it is not used it is not linked. Not with
 * AUVID_REGRESSOR_ONLY.
 */
#ifndef AUVID_CURRENT_H
#define AUVID_CURRENT_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A hull in a current. Written by auvid_current_init; must stay where it is, unchanged, as long as
 * `vehicle` is used. */
typedef struct {
    auvid_vehicle_t vehicle;   /**< the model: hand out this one. Its first parameters are the
                                    hull's, then come c_north, c_east and, if wanted, c_down */
    const auvid_vehicle_t *hull; /**< in still water */
    auvid_parameter_t parameter[AUVID_MAX_PARAMETERS]; /**< of `vehicle` */
} auvid_current_t;

#define auvid_current_init AUVID_SIZED1(auvid_current_init, AUVID_MAX_PARAMETERS)
/**
 * Put a hull into a current.
 * @param hull its model; must outlive *current
 * @param down c_down is a parameter, too; it is told from the weight less buoyancy by drag alone
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_PARAMETERS (hull and current together have more than
 * AUVID_MAX_PARAMETERS); AUVID_ERR_MODEL (neither surge nor sway is modelled, no heave where
 * `down`, or the hull is current->vehicle), and what auvid_vehicle_check has against the hull.
 * Cost: O(n).
 */
auvid_status_t auvid_current_init(auvid_current_t *current, const auvid_vehicle_t *hull, bool down);

#define auvid_current_bounds AUVID_SIZED1(auvid_current_bounds, AUVID_MAX_PARAMETERS)
/**
 * Bounds for a search: of the current, and of the hull what its signs demand. Without these, drags
 * that drive the vehicle in a current against the true one are a second, worse optimum, from which
 * the search does not always find out.
 * @param most no component of the current is larger [m/s], > 0; 1, say
 * @param lower, upper [AUVID_MAX_PARAMETERS] bounds so far; changed for the current, and
 * for the hull's masses and inertias (not below zero) and drags (not above; signs as in types.h)
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (most not > 0);
 * AUVID_ERR_STATE (not initialised).
 */
auvid_status_t auvid_current_bounds(const auvid_current_t *current, auvid_real_t most,
                                    auvid_real_t *lower, auvid_real_t *upper);

#ifdef __cplusplus
}
#endif

#endif
