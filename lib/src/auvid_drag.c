/*
 * Drag force of an estimate at a speed v (Karras et al. 2013, Eq. 12-15: X_u u + X_uu |u| u):
 *
 *     F = a' pi,  a = (v, |v| v),  var F = a' C a + (a' d_thrust)^2 + (a' d_dvl)^2
 *
 * with C the covariance at thrust and DVL scale as told, d what one standard deviation of each of
 * these scales moves the parameters by. The variance is not in the paper.
 */
#include "auvid/identifier.h"
#include "auvid_linalg.h"

/* DoF j's drag: its terms' parameters and what they are multiplied by. @return how many */
static int terms_of(const auvid_vehicle_t *vehicle, auvid_dof_t j, auvid_real_t v,
                    uint8_t index[AUVID_MAX_PARAMETERS], auvid_real_t a[AUVID_MAX_PARAMETERS])
{
    int terms = 0;
    for (uint8_t i = 0; i < vehicle->parameters; ++i) {
        auvid_parameter_kind_t kind = vehicle->parameter[i].kind;
        bool linear = kind == AUVID_PARAMETER_LINEAR_DRAG;
        if (vehicle->parameter[i].dof == j && (linear || kind == AUVID_PARAMETER_QUADRATIC_DRAG)) {
            index[terms] = i;
            a[terms++] = linear ? v : auvid_abs(v) * v;
        }
    }
    return terms;
}

/* Its standard error; AUVID_LARGEST: not known. Parameters that are fixed are exact. */
static auvid_real_t sigma_of(const auvid_estimate_t *e, int n, int terms, const uint8_t *index,
                             const auvid_real_t *a)
{
    const auvid_confidence_t *c = &e->confidence;
    auvid_real_t sum = AUVID_C(0.0), thrust = AUVID_C(0.0), dvl = AUVID_C(0.0);
    for (int k = 0; k < terms; ++k) {
        int i = index[k];
        const auvid_real_t *row = e->covariance + auvid_triangle_row(n, i);
        if (c->note[i] == AUVID_NOTE_FIXED) {
            continue;
        }
        if (!(c->sigma[i] < AUVID_LARGEST && row[0] > AUVID_C(0.0))) {
            return AUVID_LARGEST;
        }
        thrust += a[k] * c->thrust_error[i];
        dvl += a[k] * c->dvl_error[i];
        sum += a[k] * a[k] * row[0];
        for (int l = k + 1; l < terms; ++l) { /* what is fixed has no covariance */
            sum += AUVID_C(2.0) * a[k] * a[l] * row[index[l] - i];
        }
    }
    auvid_real_t sigma = auvid_sqrt(sum + thrust * thrust + dvl * dvl);
    return sigma < AUVID_LARGEST ? sigma : AUVID_LARGEST;
}

/* Could DoF j's equation be true, as far as it is seen? */
static bool is_credible(const auvid_estimate_t *e, const auvid_vehicle_t *vehicle, auvid_dof_t j)
{
    bool credible = (e->driven >> j & 1) != 0 && !e->capped;
    for (int i = 0; i < vehicle->parameters; ++i) {
        bool impossible = (e->confidence.implausible >> i & 1u) != 0;
        credible = credible && !(impossible && vehicle->parameter[i].dof == j);
    }
    return credible;
}

auvid_status_t auvid_estimate_drag(const auvid_estimate_t *estimate, const auvid_vehicle_t *vehicle,
                                   auvid_dof_t dof, auvid_real_t speed, auvid_drag_t *drag)
{
    const auvid_estimate_t *e = estimate;
    uint8_t index[AUVID_MAX_PARAMETERS];
    auvid_real_t a[AUVID_MAX_PARAMETERS], force = AUVID_C(0.0);
    if (e == NULL || vehicle == NULL || drag == NULL) {
        return AUVID_ERR_NULL;
    }
    if (e->number == 0) {
        return AUVID_ERR_NO_DATA;
    }
    if (!auvid_is_finite(speed)) {
        return AUVID_ERR_NOT_FINITE;
    }
    int terms = terms_of(vehicle, dof, speed, index, a);
    if (!(auvid_abs(speed) <= AUVID_RECORDER_LARGEST) || (unsigned)dof >= AUVID_DOF_COUNT ||
        terms == 0) {
        return AUVID_ERR_RANGE;
    }
    for (int k = 0; k < terms; ++k) {
        force += a[k] * e->pi[index[k]];
    }
    auvid_real_t sigma = sigma_of(e, vehicle->parameters, terms, index, a);
    auvid_real_t half = sigma < AUVID_LARGEST ? AUVID_CONFIDENCE_HALF_WIDTH * sigma : AUVID_LARGEST;
    auvid_real_t seen = AUVID_DRAG_REACH * e->speed[dof][speed < AUVID_C(0.0)];
    drag->speed = speed;
    drag->force = force;
    drag->sigma = sigma;
    drag->half_width = half;
    drag->identifiable = is_credible(e, vehicle, dof) &&
                         half <= AUVID_CONFIDENCE_IDENTIFIABLE * auvid_abs(force) &&
                         force * speed < AUVID_C(0.0) && auvid_abs(speed) <= seen;
    return AUVID_OK;
}
