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
 * and adds the components of c [m/s] to the hull's parameters. It is not linear in them: it takes
 * the metric's residual path, which needs memory for its rows (metric.h: `rows`; with one command,
 * 152 bytes a row).
 *
 * Only a vehicle that turns tells a current from a constant force: in its own axes the one turns,
 * the other does not. The constant forces that a model does not have it takes for none, and a
 * vehicle that does not turn then finds c by drag alone; free them where a bias is possible.
 *
 * Called before auvid_identifier_init. Cost of an evaluation: that of the hull, and three sincos.
 * Memory: sizeof(auvid_current_t). Where it is not used it is not linked.
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
 * AUVID_MAX_PARAMETERS); AUVID_ERR_MODEL (neither surge nor sway is modelled, or no heave where
 * `down`), and what auvid_vehicle_check has against the hull. Cost: O(n).
 */
auvid_status_t auvid_current_init(auvid_current_t *current, const auvid_vehicle_t *hull, bool down);

/**
 * Bounds of the current for a search; those of the hull stay.
 * @param most no component of the current is larger [m/s], > 0; 1, say
 * @param lower, upper [AUVID_MAX_PARAMETERS] written from c_north on
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE (most not > 0);
 * AUVID_ERR_STATE (not initialised).
 */
auvid_status_t auvid_current_bounds(const auvid_current_t *current, auvid_real_t most,
                                    auvid_real_t *lower, auvid_real_t *upper);

#ifdef __cplusplus
}
#endif

#endif
