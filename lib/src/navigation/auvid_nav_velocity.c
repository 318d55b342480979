/*
 * Navigation filter, fifth part: the update with a velocity of the DVL. A complete one at the
 * filter's time takes a fast path.
 */
#include <string.h>

#include "auvid_nav_internal.h"

/* Set z in the body frame, without the velocity of the lever arm: M v - omega x r. For a subset of
 * the axes: the directions h_j (columns of M) and v_j - h_j'(omega x r). */
static void nav_dvl_to_body(const auvid_nav_t *nav, const auvid_real_t v[3], unsigned valid,
                            auvid_nav_measurement_t *m)
{
    const auvid_real_t *w = nav->imu.rates, *r = nav->cfg.lever;
    auvid_real_t past[3];
    if (m->age > AUVID_C(0.0)) {
        auvid_nav_rates_at(nav, (uint32_t)(nav->imu.t_us - m->t_us), past);
        w = past;
    }
    const auvid_real_t turning[3] = {w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2],
                                     w[0] * r[1] - w[1] * r[0]};
    m->is_velocity = true;
    m->directed = valid != AUVID_DVL_ALL;
    if (!m->directed) {
        m->z[0] = nav_dot(nav->cfg.mount[0], v) - turning[0];
        m->z[1] = nav_dot(nav->cfg.mount[1], v) - turning[1];
        m->z[2] = nav_dot(nav->cfg.mount[2], v) - turning[2];
        m->n = 3;
        return;
    }
    m->n = 0;
    for (int j = 0; j < 3; ++j) {
        if ((valid >> j & 1) != 0) {
            for (int k = 0; k < 3; ++k) {
                m->h[m->n][k] = nav->cfg.mount[k][j];
            }
            m->z[m->n] = v[j] - nav_dot(m->h[m->n], turning);
            ++m->n;
        }
    }
}

/* Set row i of Ppv = r W and correct axis i of the position; w: row i of W. */
AUVID_INLINE void nav_update_cross_covariance_row(auvid_nav_t *nav, int i, auvid_real_t r,
                                                  const auvid_real_t w[3], const auvid_real_t e[3])
{
    nav->ekf.position_lo[i] += nav_dot(nav->ekf.pv[i], e);
    nav->ekf.pv[i][0] = r * w[0];
    nav->ekf.pv[i][1] = r * w[1];
    nav->ekf.pv[i][2] = r * w[2];
}

/* Largest ratio of a diagonal element of S to its pivot. */
#define LARGEST_PIVOT_LOSS AUVID_C(1e3)

/*
 * Apply all axes of a velocity at the filter's time: H = [0 I], R = r I, S = Pvv + r I. With
 * W = Ppv S^-1
 *
 *     e = S^-1 nu,   p += Ppv e,   v += nu - r e
 *     Ppp -= W Ppv',   Ppv = r W,   Pvv = r Pvv S^-1 = r (I - r S^-1)
 *
 * This equals three scalar updates for two thirds of the work. S^-1 comes from S = L D L',
 * L^-1 = [1; a 1; b c 1]. The last form of Pvv is used off the diagonal, where it needs no
 * subtraction. Return false, with the filter unchanged, if the sample does not pass the gate, or S
 * is too far from diagonal: S^-1 loses the digits that a pivot loses. Not inlined, to save stack on
 * the slow path.
 */
static AUVID_NOINLINE bool nav_apply_velocity(auvid_nav_t *nav, const auvid_nav_measurement_t *m)
{
    auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    const auvid_real_t v[6] = {nav->ekf.vv[0], nav->ekf.vv[1], nav->ekf.vv[2],
                               nav->ekf.vv[3], nav->ekf.vv[4], nav->ekf.vv[5]};
    auvid_real_t r = nav->cfg.r[m->sensor], e[3], w[3];
    const auvid_real_t s[3] = {v[0] + r, v[3] + r, v[5] + r};
    const auvid_real_t nu[3] = {m->z[0] - nav->ekf.velocity[0], m->z[1] - nav->ekf.velocity[1],
                                m->z[2] - nav->ekf.velocity[2]};
    if (!(nav_within_gate(nav, d, 0, nu[0], s[0]) && nav_within_gate(nav, d, 1, nu[1], s[1]) &&
          nav_within_gate(nav, d, 2, nu[2], s[2]))) {
        return false;
    }
    auvid_real_t d0 = AUVID_C(1.0) / s[0];
    auvid_real_t a = -v[1] * d0, l2 = v[2] * d0;
    auvid_real_t d1 = AUVID_C(1.0) / (s[1] + a * v[1]);
    auvid_real_t f = v[4] + a * v[2], c = -f * d1;
    auvid_real_t d2 = AUVID_C(1.0) / (s[2] - l2 * v[2] + c * f);
    if (!(s[1] * d1 <= LARGEST_PIVOT_LOSS && s[2] * d2 <= LARGEST_PIVOT_LOSS)) {
        return false;
    }
    auvid_real_t b = c * a - l2;
    auvid_real_t bd = b * d2, cd = c * d2, ad = a * d1;
    const auvid_real_t inverse[6] = {d0 + a * ad + b * bd, ad + c * bd, bd, d1 + c * cd, cd, d2};
    nav_times(inverse, nu, e);
    d->nis = nav_dot(nu, e);
    nav->ekf.velocity[0] = m->z[0] - r * e[0];
    nav->ekf.velocity[1] = m->z[1] - r * e[1];
    nav->ekf.velocity[2] = m->z[2] - r * e[2];
    auvid_real_t rr = -r * r;
    nav->ekf.vv[0] = r * (v[0] * inverse[0] + v[1] * inverse[1] + v[2] * inverse[2]);
    nav->ekf.vv[1] = rr * inverse[1];
    nav->ekf.vv[2] = rr * inverse[2];
    nav->ekf.vv[3] = r * (v[1] * inverse[1] + v[3] * inverse[3] + v[4] * inverse[4]);
    nav->ekf.vv[4] = rr * inverse[4];
    nav->ekf.vv[5] = r * (v[2] * inverse[2] + v[4] * inverse[4] + v[5] * inverse[5]);
    nav_times(inverse, nav->ekf.pv[0], w);
    nav->ekf.pp[0] -= nav_dot(w, nav->ekf.pv[0]);
    nav->ekf.pp[1] -= nav_dot(w, nav->ekf.pv[1]);
    nav->ekf.pp[2] -= nav_dot(w, nav->ekf.pv[2]);
    nav_update_cross_covariance_row(nav, 0, r, w, e);
    nav_times(inverse, nav->ekf.pv[1], w);
    nav->ekf.pp[3] -= nav_dot(w, nav->ekf.pv[1]);
    nav->ekf.pp[4] -= nav_dot(w, nav->ekf.pv[2]);
    nav_update_cross_covariance_row(nav, 1, r, w, e);
    nav_times(inverse, nav->ekf.pv[2], w);
    nav->ekf.pp[5] -= nav_dot(w, nav->ekf.pv[2]);
    nav_update_cross_covariance_row(nav, 2, r, w, e);
    return true;
}

/* Return the body axes in the span of the valid axes of the instrument: bit i. The component of
 * axis i outside the span is that along the invalid axes, M_ij. */
static uint8_t nav_measured_axes(const auvid_nav_t *nav, unsigned valid)
{
    const auvid_real_t max_outside = AUVID_NAV_MEASURED_SINE * AUVID_NAV_MEASURED_SINE;
    unsigned measured = 0;
    if (valid == AUVID_DVL_ALL) {
        return AUVID_DVL_ALL;
    }
    for (int i = 0; i < 3; ++i) {
        auvid_real_t outside = AUVID_C(0.0);
        for (int j = 0; j < 3; ++j) {
            auvid_real_t part = (valid >> j & 1) != 0 ? AUVID_C(0.0) : nav->cfg.mount[i][j];
            outside += part * part;
        }
        measured |= (unsigned)(outside <= max_outside) << i;
    }
    return (uint8_t)measured;
}

static void nav_store_sample(auvid_nav_velocity_sample_t *stored, uint64_t t_us,
                             const auvid_real_t velocity[3], uint8_t measured)
{
    stored->measured = measured;
    stored->t_us = t_us;
    memcpy(stored->velocity, velocity, sizeof stored->velocity);
    ++stored->sequence;
}

auvid_status_t auvid_nav_update_velocity(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                                         const auvid_real_t *v, unsigned valid)
{
    if (valid == 0 || valid > AUVID_DVL_ALL) {
        return valid == 0 ? AUVID_UNUSED : AUVID_ERR_RANGE;
    }
    auvid_real_t part[3];
    if (valid != AUVID_DVL_ALL) {
        for (int j = 0; j < 3; ++j) {
            part[j] = (valid >> j & 1) != 0 ? v[j] : AUVID_C(0.0);
        }
        v = part;
    }
    auvid_nav_measurement_t m;
    auvid_status_t status = nav_within(v, nav->cfg.speed_limit);
    if (status == AUVID_OK) {
        status = auvid_nav_check_time(nav, sensor, t_us, v, valid, &m);
    }
    if (status != AUVID_OK) {
        return status;
    }
    nav_dvl_to_body(nav, v, valid, &m);
    bool water = sensor == AUVID_NAV_DVL_WATER;
    bool hold_back = water && nav_is_fresh(nav, AUVID_NAV_DVL_BOTTOM);
    bool present = !hold_back && !m.directed && !(m.age > AUVID_C(0.0));
    status = auvid_nav_apply_sample(nav, &m, hold_back, present && nav_apply_velocity(nav, &m));
    if (status != AUVID_OK) {
        return status;
    }
    if (water && !m.directed) {
        nav_store_sample(&nav->water, m.t_us, m.z, AUVID_DVL_ALL);
    }
    if (hold_back) {
        return AUVID_UNUSED;
    }
    nav->flags = (uint16_t)(nav->flags & ~AUVID_NAV_WATER_AIDED);
    nav_set_flag(nav, AUVID_NAV_VELOCITY_KNOWN | (water ? AUVID_NAV_WATER_AIDED : 0u));
    if (!water) {
        uint8_t measured = nav_measured_axes(nav, valid);
        nav_store_sample(&nav->ground, m.t_us, nav->ekf.velocity, measured);
        if ((measured & 3u) == 3u) {
            nav->horizontal_us = m.t_us;
            nav->horizontal = true;
        }
        if (measured == AUVID_DVL_ALL) {
            nav->complete_us = m.t_us;
            nav->complete = true;
        }
    }
    return AUVID_OK;
}
