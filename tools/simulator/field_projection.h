/**
 * @file field_projection.h
 * What would be right to say of a run in the field: the parameters of Eq. 12-15 that describe the
 * true hull force best along the true motion.
 *
 * Masses and W-B are those that the vehicle is built with at the end of the run. Linear and
 * quadratic drag of each degree of freedom are the least-squares projection, noise-free, of
 *
 *     hull_j - (masses, Coriolis and W-B of Eq. 12-15)_j
 *
 * on -nu and -|nu| nu, with masses and W-B as they were at the time: ballast is no drag. So cable,
 * lift, asymmetry and exponent of the hull are in them; errors of the thrust and what disturbs the
 * vehicle are not. With *told* thrust the same parameters are others: each equation divided by
 * g_j = <delivered_j, told_j> / <told_j, told_j>.
 *
 * Host side: C11, double. One call every 50 to 100 ms costs nothing beside the simulation.
 */
#ifndef FIELD_PROJECTION_H
#define FIELD_PROJECTION_H

#include "field.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The equations: surge, sway, heave, yaw. */
enum { FIELD_EQUATIONS = 4 };

/** Products of -nu, -|nu| nu, the force above, told and delivered force. */
enum { FIELD_COLUMNS = 5 };

/** Sums along the run. All zero: nothing yet. */
typedef struct {
    double product[FIELD_EQUATIONS][FIELD_COLUMNS][FIELD_COLUMNS];
    double speed[FIELD_EQUATIONS][2];     /* largest forward and backward [m/s, rad/s] */
    double acceleration[FIELD_EQUATIONS]; /* largest |.| [m/s2, rad/s2] */
    long samples;
} field_projection_t;

/** The truth of a run. */
typedef struct {
    double si[SIM_PARAMETERS];            /**< parameters in newtons as they are */
    double told[SIM_PARAMETERS];          /**< in newtons as told */
    double gain[FIELD_EQUATIONS];         /**< g_j; 1 where nothing was told */
    double residual[FIELD_EQUATIONS];     /**< rms hull force that they do not describe [N, Nm] */
    double speed[FIELD_EQUATIONS][2];     /**< largest forward, largest backward, >= 0 */
    double acceleration[FIELD_EQUATIONS]; /**< largest |.| */
} field_reference_t;

/** The equation that parameter i, SIM_M_U .., belongs to. */
int field_equation(int i);

/** The degree of freedom, 0..5, of an equation. */
int field_dof(int equation);

/** Take the motion and the forces of this moment.
 * @param built at this moment */
void field_projection_add(field_projection_t *projection, const field_truth_t *truth,
                          const field_built_t *built);

/** The truth of the run so far. Where its motion does not determine both drags of a degree of
 * freedom, they are those it is built with.
 * @param built at the end of the run */
void field_projection_solve(const field_projection_t *projection, const field_built_t *built,
                            field_reference_t *reference);

/** Drag force of a pair at a velocity, with its sign: X_u u + X_uu |u| u [N, Nm].
 * @param parameter [SIM_PARAMETERS] */
double field_drag(const double *parameter, int equation, double velocity);

#ifdef __cplusplus
}
#endif

#endif
