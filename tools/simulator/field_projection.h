/**
 * @file field_projection.h
 * The correct result of a field run: the parameters of Eq. 12-15 that best describe the true hull
 * force along the true motion.
 *
 * Masses and W-B are the true ones at the end of the run. Linear and quadratic drag of each degree
 * of freedom are the least-squares projection, noise-free, of
 *
 *     hull_j - (masses, Coriolis and W-B of Eq. 12-15)_j
 *
 * on -nu and -|nu| nu, with masses and W-B as they were at the time, so that ballast is not drag.
 * The projection includes cable, lift, asymmetry and exponent of the hull, but not errors of the
 * thrust or disturbances. With *reported* thrust each equation is divided by
 * g_j = <delivered_j, reported_j> / <reported_j, reported_j>.
 *
 * The drag in one direction is the same projection of the motion in this direction only.
 *
 * Host side: C11, double. One call every 50 to 100 ms costs nothing compared with the simulation.
 */
#ifndef FIELD_PROJECTION_H
#define FIELD_PROJECTION_H

#include "field.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The equations: surge, sway, heave, yaw. */
enum { FIELD_EQUATIONS = 4 };

/** Products of -nu, -|nu| nu, the force above, reported and delivered force. */
enum { FIELD_COLUMNS = 5 };

/** Sums along the run, initially all zero. */
typedef struct {
    double product[2][FIELD_EQUATIONS][FIELD_COLUMNS][FIELD_COLUMNS]; /* forward, backward */
    double speed[FIELD_EQUATIONS][2];     /* largest forward and backward [m/s, rad/s] */
    double acceleration[FIELD_EQUATIONS]; /* largest |.| [m/s2, rad/s2] */
    long samples;
} field_projection_t;

/** The truth of a run. */
typedef struct {
    double si[SIM_PARAMETERS];            /**< parameters in true newtons */
    double reported[SIM_PARAMETERS];      /**< parameters in reported newtons */
    double one_way[2][SIM_PARAMETERS];    /**< as si, with drags forward, and backward */
    double gain[FIELD_EQUATIONS];         /**< g_j; 1 if no thrust was reported */
    double residual[FIELD_EQUATIONS];     /**< rms hull force not described by them [N, Nm] */
    double speed[FIELD_EQUATIONS][2];     /**< largest forward, largest backward, >= 0 */
    double acceleration[FIELD_EQUATIONS]; /**< largest |.| */
} field_reference_t;

/** The equation of parameter i, SIM_M_U ... */
int field_equation(int i);

/** The degree of freedom, 0..5, of an equation. */
int field_dof(int equation);

/** Adds the current motion and forces.
 * @param built current true parameters */
void field_projection_add(field_projection_t *projection, const field_truth_t *truth,
                          const field_built_t *built);

/** Computes the truth of the run so far. If its motion does not determine both drags of a degree of
 * freedom, they are taken from `built`; in one direction, from both directions.
 * @param built true parameters at the end of the run */
void field_projection_solve(const field_projection_t *projection, const field_built_t *built,
                            field_reference_t *reference);

/** Drag force of a pair at a velocity, with sign: X_u u + X_uu |u| u [N, Nm].
 * @param parameter [SIM_PARAMETERS] */
double field_drag(const double *parameter, int equation, double velocity);

#ifdef __cplusplus
}
#endif

#endif
