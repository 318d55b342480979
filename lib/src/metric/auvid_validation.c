/*
 * Validation (Karras et al. 2013, Section IV): Eq. 12-15 solved for the velocities under the
 * recorded inputs.
 *
 * The classical Runge-Kutta method integrates from the middle of one cell to the middle of the
 * next. In the first half the wrench is the mean of the older cell, in the second that of the newer
 * one. It is shifted by the delay or passed through the lag T y' = tau - y. Attitude and the
 * velocities that are not integrated are interpolated linearly between the cells.
 */
#include "auvid/validation.h"

#include <string.h>

#include "auvid_metric_internal.h"

/* A simulated velocity beyond this [m/s, rad/s] has diverged. It is clamped here; R2 shows it. */
#define DIVERGED AUVID_C(100.0)

/* Steps in half a cell. With cells of 0.1 s the integration is stable up to a damping of 55 times
 * the mass per second; small vehicles need 30 in yaw. */
enum { STEPS = 1 };

/* Cells after a gap until the wrench is known at every delay. */
enum { WARM_UP = AUVID_VALIDATION_PAST };

auvid_status_t auvid_validation_init(auvid_validation_t *validation, const auvid_vehicle_t *vehicle,
                                     const auvid_real_t *pi, uint32_t dofs,
                                     const auvid_real_t *delay_s, uint32_t first_order_lag,
                                     auvid_real_t cell_s)
{
    if (validation == NULL || pi == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = auvid_vehicle_check(vehicle);
    if (status < 0) {
        return status;
    }
    auvid_sample_t rest;
    auvid_real_t nu_dot[AUVID_DOF_COUNT] = {AUVID_C(0.0)};
    memset(&rest, 0, sizeof rest);
    if (!auvid_all_finite(pi, vehicle->parameters)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (vehicle->acceleration == NULL ||
        !vehicle->acceleration(vehicle->context, &rest, pi, nu_dot)) {
        return AUVID_ERR_MODEL;
    }
    if (!(cell_s > AUVID_C(0.0) && cell_s <= AUVID_C(1.0))) {
        return AUVID_ERR_RANGE;
    }
    for (int j = 0; j < AUVID_DOF_COUNT && delay_s != NULL; ++j) {
        auvid_real_t cells = delay_s[j] / cell_s; /* accepts a rounded delay of the metric */
        if (!(cells >= AUVID_C(-2.001) && cells <= AUVID_C(6.001))) {
            return AUVID_ERR_RANGE;
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if ((dofs >> j & 1u) != 0 && vehicle->columns[j] == 0) {
            return AUVID_ERR_RANGE;
        }
        if ((dofs == 0 || (dofs >> j & 1u) != 0) && !auvid_is_finite(nu_dot[j])) {
            return AUVID_ERR_MODEL;
        }
    }
    auvid_validation_t *v = validation;
    auvid_zero(v, sizeof *v);
    v->vehicle = vehicle;
    v->cell_s = cell_s;
    v->first_order_lag = first_order_lag;
    memcpy(v->pi, pi, vehicle->parameters * sizeof pi[0]);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool integrate = vehicle->columns[j] != 0 && (dofs == 0 || (dofs >> j & 1u));
        v->dofs |= (uint32_t)integrate << j;
        v->delay_cells[j] =
            delay_s == NULL ? AUVID_C(0.0) : auvid_max(delay_s[j] / cell_s, AUVID_C(0.0));
    }
    return AUVID_OK;
}

/* Returns the wrench of DoF j `ago` cells before the newest, linear between cells. */
static auvid_real_t validation_past_wrench(const auvid_validation_t *v, int j, auvid_real_t ago)
{
    ago = auvid_min(ago, (auvid_real_t)(AUVID_VALIDATION_PAST - 1)); /* rounding */
    uint32_t whole = (uint32_t)ago;
    uint32_t further = whole + 1 < AUVID_VALIDATION_PAST ? whole + 1 : whole;
    auvid_real_t near = v->past[(v->since_gap - whole) % AUVID_VALIDATION_PAST][j];
    auvid_real_t far = v->past[(v->since_gap - further) % AUVID_VALIDATION_PAST][j];
    return near + (ago - (auvid_real_t)whole) * (far - near);
}

/* Interpolate the recorded signals by `part` from the last cell to `to`. */
static void validation_interpolate(const auvid_validation_t *v, const auvid_sample_t *to,
                                   auvid_real_t part, auvid_sample_t *s)
{
    s->phi = v->last.phi + part * (to->phi - v->last.phi);
    s->theta = v->last.theta + part * (to->theta - v->last.theta);
    s->psi = v->last.psi + part * (to->psi - v->last.psi);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if ((v->dofs >> j & 1u) == 0) {
            s->nu[j] = v->last.nu[j] + part * (to->nu[j] - v->last.nu[j]);
        }
    }
}

/* One step over `part` of a cell, starting at `from` of it, under a constant wrench. */
static void validation_runge_kutta(auvid_validation_t *v, const auvid_sample_t *to,
                                   const auvid_sample_t *half, auvid_real_t from, auvid_real_t part,
                                   const auvid_real_t *tau)
{
    static const auvid_real_t node[4] = {AUVID_C(0.0), AUVID_C(0.5), AUVID_C(0.5), AUVID_C(1.0)};
    static const auvid_real_t weight[4] = {AUVID_C(1.0), AUVID_C(2.0), AUVID_C(2.0), AUVID_C(1.0)};
    auvid_real_t h = part * v->cell_s, k[AUVID_DOF_COUNT] = {AUVID_C(0.0)};
    auvid_real_t step[AUVID_DOF_COUNT] = {AUVID_C(0.0)};
    auvid_sample_t s = v->last;
    memcpy(s.command, half->command, sizeof s.command);
    memcpy(s.tau, tau, sizeof s.tau);
    for (int stage = 0; stage < 4; ++stage) {
        if (stage != 2) { /* its node is that of stage 1 */
            validation_interpolate(v, to, from + part * node[stage], &s);
        }
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            if ((v->dofs >> j & 1u) != 0) {
                s.nu[j] = v->predicted[j] + node[stage] * h * k[j];
            }
            k[j] = AUVID_C(0.0);
        }
        (void)v->vehicle->acceleration(v->vehicle->context, &s, v->pi, k);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            step[j] += weight[stage] * k[j];
        }
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        auvid_real_t next = v->predicted[j] + h / AUVID_C(6.0) * step[j];
        v->predicted[j] =
            auvid_is_finite(next) ? auvid_clamp_here(next, -DIVERGED, DIVERGED) : DIVERGED;
    }
}

/* Half a cell under a constant wrench. */
static void validation_half_cell(auvid_validation_t *v, const auvid_sample_t *to, auvid_real_t from,
                                 const auvid_real_t *tau)
{
    const auvid_sample_t *half = from > AUVID_C(0.0) ? to : &v->last;
    auvid_real_t part = AUVID_C(0.5) / (auvid_real_t)STEPS;
    for (int i = 0; i < STEPS; ++i) {
        validation_runge_kutta(v, to, half, from + part * (auvid_real_t)i, part, tau);
    }
}

/* Compute the mean wrench of one half cell; `ago`: the cell of that half, before the delay. */
static void validation_half_cell_wrench(auvid_validation_t *v, auvid_real_t ago, auvid_real_t *tau)
{
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!(v->first_order_lag >> j & 1u) || !(v->delay_cells[j] > AUVID_C(0.0))) {
            tau[j] = validation_past_wrench(v, j, ago + v->delay_cells[j]);
            continue;
        }
        /* y(h) - y(0) by the trapezoidal rule, h half a cell */
        auvid_real_t target = validation_past_wrench(v, j, ago);
        auvid_real_t step =
            (target - v->wrench[j]) * AUVID_C(0.5) / (v->delay_cells[j] + AUVID_C(0.25));
        tau[j] = v->wrench[j] + AUVID_C(0.5) * step;
        v->wrench[j] += step;
    }
}

static void validation_compare(auvid_validation_t *v, const auvid_sample_t *s)
{
    ++v->cells;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        if (!(v->dofs >> j & 1u)) {
            v->predicted[j] = s->nu[j];
            continue;
        }
        if ((s->missing >> j & 1) != 0) {
            continue;
        }
        auvid_real_t off = s->nu[j] - v->mean[j], e = s->nu[j] - v->predicted[j];
        v->mean[j] += off / (auvid_real_t)++v->compared[j];
        v->m2[j] += off * (s->nu[j] - v->mean[j]);
        v->sse[j] += e * e;
    }
}

/* Returns true if the integrated equations read one of these velocities. */
static bool validation_lacks_velocity(const auvid_validation_t *v, uint32_t missing)
{
    return (auvid_vehicle_unmeasured(v->vehicle, (uint8_t)missing) & v->dofs) != 0;
}

auvid_status_t auvid_validation_add(auvid_validation_t *validation, const auvid_sample_t *sample)
{
    if (validation == NULL || sample == NULL) {
        return AUVID_ERR_NULL;
    }
    if (validation->vehicle == NULL) {
        return AUVID_ERR_STATE;
    }
    if (!auvid_metric_is_finite(sample)) {
        return AUVID_ERR_NOT_FINITE;
    }
    auvid_validation_t *v = validation;
    ++v->since_gap;
    memcpy(v->past[v->since_gap % AUVID_VALIDATION_PAST], sample->tau, sizeof sample->tau);
    if (validation_lacks_velocity(v, sample->missing & ~v->dofs)) {
        v->running = false; /* the missing velocity comes from the record */
    } else if (!v->running && v->since_gap >= WARM_UP &&
               !validation_lacks_velocity(v, sample->missing)) {
        memcpy(v->predicted, sample->nu, sizeof v->predicted);
        memcpy(v->wrench, v->last.tau, sizeof v->wrench);
        v->running = true;
    } else if (v->running) {
        auvid_real_t tau[AUVID_DOF_COUNT];
        validation_half_cell_wrench(v, AUVID_C(1.0), tau);
        validation_half_cell(v, sample, AUVID_C(0.0), tau);
        validation_half_cell_wrench(v, AUVID_C(0.0), tau);
        validation_half_cell(v, sample, AUVID_C(0.5), tau);
    }
    if (v->running) {
        validation_compare(v, sample);
    }
    v->last = *sample;
    return AUVID_OK;
}

void auvid_validation_gap(auvid_validation_t *validation)
{
    if (validation != NULL) {
        validation->since_gap = 0;
        validation->running = false;
    }
}

auvid_status_t auvid_validation_r2(const auvid_validation_t *validation, auvid_real_t *r2)
{
    if (validation == NULL || r2 == NULL) {
        return AUVID_ERR_NULL;
    }
    if (validation->cells < 2) {
        return AUVID_ERR_NO_DATA;
    }
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        r2[j] = auvid_r2(validation->sse[j], validation->m2[j]);
    }
    return AUVID_OK;
}
