/*
 * The identifier: drift since the first accepted estimate.
 *
 * Chow's F compares a set with the sets before it. A slow change (fouling, a sagging battery) is
 * small from set to set, and the estimates follow it unnoticed. So the last accepted estimate is
 * compared with the first one: in each DoF the mass and the drag force F at one speed,
 *
 *     t = (x - x_0) / s,  s^2 = var x + var x_0
 *
 * and all drag forces with one common factor, by weighted least squares:
 *
 *     t = sum_j F_j0 (F_j - F_j0) / s_j^2  /  sqrt(sum_j F_j0^2 / s_j^2)
 *
 * The variances hold if thrust and DVL scale are exact. A constant error of these scales is in both
 * estimates and cancels; one that varies is a drift. DoF in closed loop are left out.
 */
#include "auvid_identifier_internal.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_feedback_internal.h"

/* Limit of |t|. None of 41194 unchanged sets without mismatch exceeds it, and none of 40956 with
 * mixtures of usual size. */
#define DRIFT_LIMIT AUVID_C(6.0)
/* Speed of the drag force relative to the largest in the first estimate's data: there linear and
 * quadratic drag together are known best. */
#define DRIFT_SPEED AUVID_C(0.6)

enum { DRIFT_MASS, DRIFT_DRAG };

/* Coefficient of a parameter in the mass, or in the drag force at this speed. */
static auvid_real_t identifier_drift_weight(const auvid_parameter_t *p, int quantity,
                                            auvid_real_t speed)
{
    bool linear = p->kind == AUVID_PARAMETER_LINEAR_DRAG;
    if (quantity == DRIFT_DRAG) {
        bool drag = linear || p->kind == AUVID_PARAMETER_QUADRATIC_DRAG;
        return drag ? speed * (linear ? AUVID_C(1.0) : speed) : AUVID_C(0.0);
    }
    bool mass = p->kind == AUVID_PARAMETER_MASS || p->kind == AUVID_PARAMETER_INERTIA;
    return mass ? AUVID_C(1.0) : AUVID_C(0.0);
}

/* Mass of DoF j in the last estimate, or drag force at this speed. */
static auvid_combination_t identifier_drift_value(const auvid_identifier_t *id, int j, int quantity,
                                                  auvid_real_t speed)
{
    const auvid_vehicle_t *vehicle = identifier_vehicle(id);
    auvid_combination_t sum = {.known = true};
    for (int i = 0; i < vehicle->parameters; ++i) {
        const auvid_parameter_t *p = &vehicle->parameter[i];
        auvid_real_t a = identifier_drift_weight(p, quantity, speed);
        if ((int)p->dof == j && !auvid_is_zero(a)) {
            auvid_identifier_add_term(&sum, &id->estimate, vehicle, i, a);
        }
    }
    sum.known = sum.known && sum.variance > AUVID_C(0.0) && auvid_is_finite(sum.variance) &&
                auvid_is_finite(sum.value);
    return sum;
}

/* Sums of the weighted least squares for a common relative difference of the drag forces. */
typedef struct {
    auvid_real_t product, square;
} drift_common_t;

/* |t| of one quantity of DoF j; 0: not known now. Where it was not known before, it is from now on
 * the first. */
static auvid_real_t identifier_drift_of(auvid_identifier_t *id, int j, int quantity,
                                        drift_common_t *common)
{
    auvid_drift_reference_t *first = &id->attached.change->first;
    auvid_real_t *value = &first->value[quantity][j], *variance = &first->variance[quantity][j];
    auvid_combination_t now = identifier_drift_value(id, j, quantity, first->speed[j]);
    if (!now.known) {
        return AUVID_C(0.0);
    }
    if (!(*variance > AUVID_C(0.0))) {
        *value = now.value;
        *variance = now.variance;
    }
    auvid_real_t step = now.value - *value, sum = now.variance + *variance;
    if (quantity == DRIFT_DRAG) {
        common->product += *value * step / sum;
        common->square += *value * *value / sum;
    }
    return auvid_abs(step) / auvid_sqrt(sum);
}

void auvid_identifier_test_drift(auvid_identifier_t *id)
{
    auvid_change_test_t *test = &id->change_test;
    auvid_drift_reference_t *first = &id->attached.change->first;
    drift_common_t common = {AUVID_C(0.0), AUVID_C(0.0)};
    uint32_t feedback = auvid_metric_feedback_dofs(&id->metric);
    int clearest = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        const auvid_real_t *speed = id->estimate.speed[j];
        if ((feedback >> j & 1u) != 0) {
            test->drift[j] = AUVID_C(0.0);
            continue;
        }
        if (!(first->variance[DRIFT_DRAG][j] > AUVID_C(0.0))) {
            first->speed[j] = DRIFT_SPEED * auvid_max(speed[0], speed[1]);
        }
        auvid_real_t mass = identifier_drift_of(id, j, DRIFT_MASS, &common);
        auvid_real_t t = auvid_max(mass, identifier_drift_of(id, j, DRIFT_DRAG, &common));
        test->drift[j] = auvid_is_finite(t) ? t / DRIFT_LIMIT : AUVID_C(0.0);
        clearest = test->drift[j] > test->drift[clearest] ? j : clearest;
    }
    auvid_real_t t = auvid_abs(common.product) / auvid_sqrt(common.square);
    if (auvid_is_finite(t)) {
        test->drift[clearest] = auvid_max(test->drift[clearest], t / DRIFT_LIMIT);
    }
    bool was = test->drifted != 0;
    test->drifted = (uint8_t)((test->drift[clearest] > AUVID_C(1.0)) << clearest);
    if (test->drifted != 0 && !was) {
        id->events |= AUVID_EVENT_DRIFTED;
    }
}

void auvid_identifier_restart_drift(auvid_identifier_t *id)
{
    memset(&id->attached.change->first, 0, sizeof id->attached.change->first);
    memset(id->change_test.drift, 0, sizeof id->change_test.drift);
    id->change_test.drifted = 0;
}
