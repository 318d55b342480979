/*
 * Uncertain inputs: the drag force in one direction. With b the asymmetry of DoF j, whose column is
 * its drag without a sign, made orthogonal to linear and quadratic drag (auvid_uncertain_solve.c),
 *
 *     F(v) = F_0 - b c(v),   F_0 = X_u v + X_uu |v| v,
 *     c(v) = (l + s a_0) |v| + (1 - l + s a_1) v^2,
 *     var F = f^2 var F_0 + c(v)^2 var b
 *
 * s is the sign of v, l the linear part of the drag; a_0 and a_1 are what was taken from the
 * column: X_u and X_uu contain b a_0 and b a_1 of the asymmetry ("hidden"). With motion in one
 * direction only, a_0 = -s l, a_1 = -s (1 - l), and c(v) = 0 for it. c is kept relative to the drag
 * at 1 m/s, so that it holds for an estimate in other newtons, too (auvid_calibrated_t). The
 * standard error of F_0 is that of the thrust's scale to a good part: it grows with the force,
 * f = F / F_0, but does not shrink, f >= 1. F_0 and b are correlated through the other inputs, but
 * so little that half-widths differ by 1 or 2 % of themselves: left out.
 */
#include "../identifier/auvid_identifier_internal.h"
#include "auvid_uncertain_parts_internal.h"

auvid_real_t auvid_uncertain_find_one_way(auvid_uncertain_t *u, int j, int k, auvid_real_t value)
{
    const auvid_metric_t *m = &u->id->metric;
    auvid_real_t linear[2] = {u->linear[j], AUVID_C(1.0) - u->linear[j]}, part[2], size[2];
    auvid_uncertain_drag_parts(u, m, j, k, part);
    for (int d = 0; d < 2; ++d) {
        u->hidden[j][d] = value * part[d];
    }
    auvid_uncertain_hull_drag(u, m, j, size);
    auvid_real_t hull = size[0] + size[1], unit = hull / auvid_uncertain_mean_drag(u, m, j);
    if (!(hull > AUVID_C(0.0)) || !auvid_is_finite(unit)) {
        auvid_clear(u->hidden[j], 2);
        return AUVID_C(0.0);
    }
    for (int d = 0; d < 2; ++d) {
        u->work.causes.one_way[j][0][d] = unit * (linear[d] + part[d]);
        u->work.causes.one_way[j][1][d] = unit * (linear[d] - part[d]);
    }
    return AUVID_C(1.0) / hull;
}

/* Add the asymmetry's force to F_0. column: c(v), per unit of the asymmetry. */
static void drag_add(const auvid_causes_t *causes, auvid_dof_t dof, auvid_real_t column,
                     auvid_drag_t *drag)
{
    auvid_real_t speed = drag->speed, force = drag->force - column * causes->asymmetry[dof];
    auvid_real_t limit = AUVID_CONFIDENCE_IDENTIFIABLE * -force;
    auvid_real_t of_mean = drag->sigma * auvid_max(AUVID_C(1.0), force / drag->force);
    auvid_real_t of_asymmetry = column * causes->asymmetry_sigma[dof];
    auvid_real_t sigma = auvid_sqrt(of_mean * of_mean + of_asymmetry * of_asymmetry);
    bool known = AUVID_CONFIDENCE_HALF_WIDTH * sigma < AUVID_LARGEST;
    drag->force = force;
    drag->sigma = known ? sigma : AUVID_LARGEST;
    drag->half_width = known ? AUVID_CONFIDENCE_HALF_WIDTH * sigma : AUVID_LARGEST;
    drag->identifiable =
        drag->identifiable && drag->half_width <= (speed < AUVID_C(0.0) ? -limit : limit);
}

auvid_status_t auvid_causes_drag(const auvid_causes_t *causes, const auvid_estimate_t *estimate,
                                 const auvid_vehicle_t *vehicle, auvid_dof_t dof,
                                 auvid_real_t speed, auvid_drag_t *drag)
{
    if (causes == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_estimate_drag(estimate, vehicle, dof, speed, drag);
    if (status == AUVID_OK && causes->number == estimate->number &&
        causes->asymmetry_sigma[dof] > AUVID_C(0.0) && auvid_abs(drag->force) > AUVID_C(0.0)) {
        const auvid_real_t *part = causes->one_way[dof][speed < AUVID_C(0.0)];
        auvid_real_t magnitude = auvid_abs(speed);
        auvid_drag_t mean;
        (void)auvid_estimate_drag(estimate, vehicle, dof, AUVID_C(1.0), &mean);
        drag_add(causes, dof, -mean.force * (part[0] + part[1] * magnitude) * magnitude, drag);
    }
    return status;
}

auvid_status_t auvid_uncertain_drag(const auvid_identifier_t *id, auvid_dof_t dof,
                                    auvid_real_t speed, auvid_drag_t *drag)
{
    return auvid_causes_drag(&id->attached.uncertain->causes, identifier_read_estimate(id),
                             id->metric.cfg.vehicle, dof, speed, drag);
}
