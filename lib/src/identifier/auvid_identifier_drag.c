/*
 * Drag force of an estimate at a speed v (Karras et al. 2013, Eq. 12-15: X_u u + X_uu |u| u):
 *
 *     F = a' pi,  a = (v, |v| v),  var F = a' C a + (a' d_thrust)^2 + (a' d_dvl)^2
 *
 * C is the covariance if thrust and DVL scale are exact; d is the parameters' change per standard
 * deviation of each scale. The variance is not in the paper.
 */
#include "auvid_identifier_internal.h"
#include "../base/auvid_math_internal.h"

void auvid_identifier_add_term(auvid_combination_t *s, const auvid_estimate_t *e,
                               const auvid_vehicle_t *vehicle, int i, auvid_real_t a)
{
    const auvid_confidence_t *c = &e->confidence;
    s->value += a * e->pi[i];
    if (c->note[i] == AUVID_NOTE_FIXED) {
        return;
    }
    auvid_real_t variance = auvid_estimate_covariance(e, vehicle, i, i);
    s->known = s->known && c->sigma[i] < AUVID_LARGEST && variance > AUVID_C(0.0);
    s->variance += a * a * variance;
    for (int k = 0; k < s->terms; ++k) {
        s->variance +=
            AUVID_C(2.0) * a * s->a[k] * auvid_estimate_covariance(e, vehicle, s->index[k], i);
    }
    s->thrust += a * c->thrust_error[i];
    s->dvl += a * c->dvl_error[i];
    s->a[s->terms] = a;
    s->index[s->terms++] = (uint8_t)i;
}

auvid_status_t auvid_estimate_drag(const auvid_estimate_t *estimate, const auvid_vehicle_t *vehicle,
                                   auvid_dof_t dof, auvid_real_t speed, auvid_drag_t *drag)
{
    const auvid_estimate_t *e = estimate;
    if (e == NULL || vehicle == NULL || drag == NULL) {
        return AUVID_ERR_NULL;
    }
    if (e->number == 0) {
        return AUVID_ERR_NO_DATA;
    }
    if (!auvid_is_finite(speed)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if ((unsigned)dof >= AUVID_DOF_COUNT || vehicle->columns[dof] == 0 ||
        auvid_abs(speed) > AUVID_RECORDER_LARGEST) {
        return AUVID_ERR_RANGE;
    }
    auvid_combination_t s = {.known = true};
    uint32_t equation = 0;
    bool any = false, denied = false;
    for (int i = 0; i < vehicle->parameters; ++i) {
        const auvid_parameter_t *p = &vehicle->parameter[i];
        bool linear = p->kind == AUVID_PARAMETER_LINEAR_DRAG;
        auvid_note_t note = (auvid_note_t)e->confidence.note[i];
        equation |= (uint32_t)(p->dof == dof) << i;
        denied = denied || (p->dof == dof && note == AUVID_NOTE_DISCREDITED);
        if (p->dof == dof && (linear || p->kind == AUVID_PARAMETER_QUADRATIC_DRAG)) {
            auvid_identifier_add_term(&s, e, vehicle, i, linear ? speed : auvid_abs(speed) * speed);
            any = true;
            denied = denied || note == AUVID_NOTE_FEEDBACK;
        }
    }
    if (!any) {
        return AUVID_ERR_RANGE;
    }
    auvid_real_t max_speed = AUVID_DRAG_REACH * e->speed[dof][speed < AUVID_C(0.0)];
    bool credible = ((e->excited | e->coupled) >> dof & 1) != 0 && !e->not_converged && !denied &&
                    !e->confidence.unchecked && auvid_abs(speed) <= max_speed &&
                    (e->confidence.implausible & equation) == 0 && s.value * speed < AUVID_C(0.0);
    auvid_real_t sigma = auvid_sqrt(s.variance + s.thrust * s.thrust + s.dvl * s.dvl);
    auvid_real_t half = AUVID_CONFIDENCE_HALF_WIDTH * sigma;
    s.known = s.known && half < AUVID_LARGEST;
    drag->speed = speed;
    drag->force = s.value;
    drag->sigma = s.known ? sigma : AUVID_LARGEST;
    drag->half_width = s.known ? half : AUVID_LARGEST;
    drag->identifiable =
        credible && drag->half_width <= AUVID_CONFIDENCE_IDENTIFIABLE * auvid_abs(s.value);
    return AUVID_OK;
}
