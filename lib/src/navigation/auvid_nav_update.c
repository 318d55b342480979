/*
 * Navigation filter, second part: the update with one measurement (Karras et al. 2013, Eq. 6-8).
 *
 * Every scalar measurement is reduced to an innovation nu, its variance S and its covariance c with
 * the state; then
 *
 *     K = c / S,   x += K nu,   P -= K c'
 *
 * P stays symmetric by construction, and positive if c' P^-1 c < S.
 * A sample at the filter's time: c = P H', S = H P H' + R. A sample of age a:
 *
 * Position i: p_i(t - a) = p_i - a R_i v, so H = [e_i, -a R_i], R_i row i of R(phi, theta, psi).
 *
 * Velocity along h: z = h'(v - w) + noise, w the process noise since then, of variance a diag(q).
 *     With m = a diag(q) h the covariance of x with h'w is q_x = [a/2 R m; m], and
 *     c = P H' - q_x,   S = H P H' - 2 h'm + h'm + R = H P H' - h'm + R        (Bar-Shalom's B1)
 *     The filter's velocity at the sample's time equals its current one: cov(w, nu) = m - m = 0.
 *     This holds if no update was applied since (a measurement carries information on w) and R is
 *     constant. Long ticks and fast rotation can make P - c c'/S indefinite; this is checked.
 *     Otherwise w counts as the fraction beta = h'm / H P H' of the uncertainty along h:
 *     c = (1 - beta) P H',   S = (1 - beta) H P H' + R
 *     so that P - c c'/S is positive for any beta in [0, 1).
 */
#include <string.h>

#include "auvid_nav_internal.h"

/* Other sensors may have reduced H P H' below h'm since the sample. A limit of 0.8 keeps S a
 * realistic variance of nu and the gain near one. With 0.99 the gate rejected a quarter of the DVL
 * samples 0.4 s late. */
#define LARGEST_BETA AUVID_C(0.8)

/* Compute P H' of a velocity along h; return H P H'. */
static auvid_real_t nav_velocity_covariance(const auvid_nav_t *nav, const auvid_real_t h[3],
                                            auvid_real_t c[6])
{
    c[0] = nav_dot(nav->ekf.pv[0], h);
    c[1] = nav_dot(nav->ekf.pv[1], h);
    c[2] = nav_dot(nav->ekf.pv[2], h);
    nav_times(nav->ekf.vv, h, c + 3);
    return nav_dot(h, c + 3);
}

/* Compute P H' of position axis i, `age` ago; return H P H'. */
static auvid_real_t nav_position_covariance(const auvid_nav_t *nav, int i, auvid_real_t age,
                                            auvid_real_t c[6])
{
    const uint8_t *row = nav_packed[i];
    const auvid_real_t *pv = nav->ekf.pv[i];
    c[0] = nav->ekf.pp[row[0]];
    c[1] = nav->ekf.pp[row[1]];
    c[2] = nav->ekf.pp[row[2]];
    c[3] = pv[0];
    c[4] = pv[1];
    c[5] = pv[2];
    if (!(age > AUVID_C(0.0))) {
        return c[i];
    }
    auvid_real_t h[3] = {AUVID_C(0.0), AUVID_C(0.0), AUVID_C(0.0)}, more[6];
    nav_add(h, -age, nav->imu.rotation[i]);
    (void)nav_velocity_covariance(nav, h, more);
    nav_add(c, AUVID_C(1.0), more);
    nav_add(c + 3, AUVID_C(1.0), more + 3);
    return c[i] + nav_dot(h, c + 3);
}

/* Return z - p_i(t - age). */
static auvid_real_t nav_position_innovation(const auvid_nav_t *nav, int i, auvid_real_t age,
                                            auvid_real_t z)
{
    auvid_real_t nu = (z - nav->ekf.position[i]) - nav->ekf.position_lo[i];
    return age > AUVID_C(0.0) ? nu + age * nav_dot(nav->imu.rotation[i], nav->ekf.velocity) : nu;
}

/* Return the number of scalars. The minimum shows the compiler that it is at most three. */
AUVID_INLINE int nav_scalar_count(const auvid_nav_measurement_t *m)
{
    return m->n < 3 ? m->n : 3;
}

/* Return the direction of scalar j of a velocity. */
static const auvid_real_t *nav_direction(const auvid_nav_measurement_t *m, int j)
{
    static const auvid_real_t unit[3][3] = {{AUVID_C(1.0), AUVID_C(0.0), AUVID_C(0.0)},
                                            {AUVID_C(0.0), AUVID_C(1.0), AUVID_C(0.0)},
                                            {AUVID_C(0.0), AUVID_C(0.0), AUVID_C(1.0)}};
    return m->directed ? m->h[j] : unit[j];
}

/* Compute m = age diag(q) h; return h'm, the variance along h of the noise since the sample. */
static auvid_real_t nav_noise_since(const auvid_nav_t *nav, auvid_real_t age,
                                    const auvid_real_t h[3], auvid_real_t m[3])
{
    for (int k = 0; k < 3; ++k) {
        m[k] = age * nav->cfg.q[k] * h[k];
    }
    return nav_dot(m, h);
}

/* Return whether c' P^-1 c < s, so that P - c c'/s is positive definite. P = L D L', y = L^-1 c. */
static bool nav_is_positive(const auvid_nav_t *nav, const auvid_real_t c[6], auvid_real_t s)
{
    auvid_real_t p[6][6], y[6], sum = AUVID_C(0.0);
    (void)auvid_nav_covariance(nav, p);
    for (int i = 0; i < 6; ++i) {
        y[i] = c[i];
    }
    for (int j = 0; j < 6; ++j) {
        if (!(p[j][j] > AUVID_C(0.0))) {
            return false;
        }
        auvid_real_t inverse = AUVID_C(1.0) / p[j][j];
        sum += y[j] * y[j] * inverse;
        for (int i = j + 1; i < 6; ++i) {
            auvid_real_t l = p[i][j] * inverse;
            y[i] -= l * y[j];
            for (int k = j + 1; k <= i; ++k) {
                p[i][k] -= l * p[k][j];
            }
        }
    }
    return sum < s * (AUVID_C(1.0) - NAV_MIN_VARIANCE_RATIO);
}

/* Compute c of a late velocity: P H' without the noise since the sample; return S - R. */
static auvid_real_t nav_late_covariance(const auvid_nav_t *nav, const auvid_nav_measurement_t *m,
                                        int j, auvid_real_t c[6])
{
    auvid_real_t noise[3], exact[6];
    const auvid_real_t *h = nav_direction(m, j);
    auvid_real_t hph = nav_velocity_covariance(nav, h, c);
    auvid_real_t variance = nav_noise_since(nav, m->age, h, noise);
    if (m->t_us >= nav->ekf.updated_us && hph > variance) {
        for (int k = 0; k < 3; ++k) {
            exact[k] = c[k] - AUVID_C(0.5) * m->age * nav_dot(nav->imu.rotation[k], noise);
            exact[3 + k] = c[3 + k] - noise[k];
        }
        if (nav_is_positive(nav, exact, hph - variance + nav->cfg.r[m->sensor])) {
            memcpy(c, exact, sizeof exact);
            return hph - variance;
        }
    }
    auvid_real_t kept = AUVID_C(1.0) - auvid_min(variance / hph, LARGEST_BETA);
    for (int k = 0; k < 6; ++k) {
        c[k] *= kept;
    }
    return hph * kept;
}

/* Apply scalar j; return nu^2 / S. */
static auvid_real_t nav_apply_scalar(auvid_nav_t *nav, const auvid_nav_measurement_t *m, int j)
{
    auvid_real_t c[6], hph, nu;
    if (m->is_velocity) {
        const auvid_real_t *h = nav_direction(m, j);
        hph = m->age > AUVID_C(0.0) ? nav_late_covariance(nav, m, j, c)
                                    : nav_velocity_covariance(nav, h, c);
        nu = m->z[j] - nav_dot(h, nav->ekf.velocity);
    } else {
        int i = m->first + j;
        hph = nav_position_covariance(nav, i, m->age, c);
        nu = nav_position_innovation(nav, i, m->age, m->z[j]);
    }
    return nav_apply(nav, c, nav_variance(nav, m, hph), nu);
}

/* Compute innovation j; return its H P H', for a velocity without the noise since the sample. */
static auvid_real_t nav_innovation(const auvid_nav_t *nav, const auvid_nav_measurement_t *m, int j,
                                   auvid_real_t *nu)
{
    auvid_real_t c[6];
    if (!m->is_velocity) {
        int i = m->first + j;
        *nu = nav_position_innovation(nav, i, m->age, m->z[j]);
        return m->age > AUVID_C(0.0) ? nav_position_covariance(nav, i, m->age, c)
                                     : nav->ekf.pp[nav_packed[i][i]];
    }
    const auvid_real_t *h = nav_direction(m, j);
    auvid_real_t hph = nav_velocity_covariance(nav, h, c);
    *nu = m->z[j] - nav_dot(h, nav->ekf.velocity);
    if (m->age > AUVID_C(0.0)) {
        hph = auvid_max(hph - nav_noise_since(nav, m->age, h, c),
                        (AUVID_C(1.0) - LARGEST_BETA) * hph);
    }
    return hph;
}

/* Store innovation j; return its bit if it is outside the gate. */
AUVID_INLINE unsigned nav_record_innovation(auvid_nav_diagnostics_t *d, int j, auvid_real_t nu,
                                            auvid_real_t s, auvid_real_t gate)
{
    auvid_real_t ratio = nu * nu / s;
    d->innovation[j] = nu;
    d->variance[j] = s;
    if (ratio > d->nis) {
        d->nis = ratio;
    }
    return ratio > gate ? 1u << j : 0u;
}

uint8_t auvid_nav_innovations(auvid_nav_t *nav, const auvid_nav_measurement_t *m)
{
    auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    unsigned outside = 0;
    d->nis = AUVID_C(0.0);
    for (int j = 0; j < nav_scalar_count(m); ++j) {
        auvid_real_t nu, hph = nav_innovation(nav, m, j, &nu);
        outside |= nav_record_innovation(d, j, nu, nav_variance(nav, m, hph), nav->cfg.gate);
    }
    d->innovation_count = m->n;
    d->seen_us = m->t_us;
    return (uint8_t)outside;
}

/* Return those scalars outside the gate that no manoeuvre since the last accepted sample explains,
 * within max_acceleration. */
static uint8_t nav_beyond_max_acceleration(const auvid_nav_t *nav, const auvid_nav_measurement_t *m)
{
    const auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    uint64_t us = d->has_sample ? m->t_us - d->good_us : 0; /* in order per sensor */
    auvid_real_t dt = AUVID_C(1e-6) * (auvid_real_t)(uint32_t)(us < 10000000u ? us : 10000000u);
    uint8_t outside = m->outside;
    for (int j = 0; j < nav_scalar_count(m); ++j) {
        auvid_real_t reach =
            auvid_sqrt(nav->cfg.gate * d->variance[j]) + nav->cfg.max_acceleration * dt;
        if (auvid_abs(d->innovation[j]) <= reach) {
            outside = (uint8_t)(outside & ~(1u << j));
        }
    }
    return outside;
}

/* Return AUVID_OK or AUVID_GATED. */
static auvid_status_t nav_test_gate(auvid_nav_t *nav, auvid_nav_measurement_t *m)
{
    auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    m->outside = auvid_nav_innovations(nav, m);
    if (m->outside != 0 && m->is_velocity) {
        m->outside = nav_beyond_max_acceleration(nav, m);
    }
    if (m->outside != 0) {
        auvid_nav_increment(&d->consecutive_rejections);
        if (nav->cfg.max_consecutive_rejections == 0 ||
            d->consecutive_rejections < nav->cfg.max_consecutive_rejections) {
            return AUVID_GATED;
        }
        auvid_nav_increment(&d->resets);
    }
    nav_record_accepted(d, m->t_us);
    return AUVID_OK;
}

/* Re-initialise the velocity along h from a measurement, with u = [0; h], g = P u:
 * P = (I - u u') P (I - u u') + variance u u' = P - g u' - u g' + (u'g + variance) u u'
 * A variance far below that of P would be lost in the differences. */
static void nav_restart_velocity(auvid_nav_t *nav, const auvid_real_t h[3], auvid_real_t step,
                                 auvid_real_t variance)
{
    auvid_real_t g[6], hph = nav_velocity_covariance(nav, h, g);
    auvid_real_t sum = hph + auvid_max(variance, NAV_MIN_VARIANCE_RATIO * hph);
    for (int k = 0; k < 3; ++k) {
        nav_add(nav->ekf.pv[k], -g[k], h);
        for (int l = k; l < 3; ++l) {
            nav->ekf.vv[nav_packed[k][l]] +=
                (sum * h[k] * h[l] - g[3 + k] * h[l]) - h[k] * g[3 + l];
        }
    }
    nav_add(nav->ekf.velocity, step, h);
}

/* Re-initialise what scalar j measures: the error is far larger than its variance. */
static void nav_restart_scalar(auvid_nav_t *nav, const auvid_nav_measurement_t *m, int j)
{
    auvid_real_t step = nav->diagnostics[m->sensor].innovation[j], noise[3];
    auvid_real_t variance = nav->cfg.r[m->sensor];
    if (m->is_velocity) {
        const auvid_real_t *h = nav_direction(m, j);
        nav_restart_velocity(nav, h, step, variance + nav_noise_since(nav, m->age, h, noise));
    } else {
        auvid_nav_restart_position(nav, m->first + j, step, variance);
    }
}

/* Apply Eq. 6 to a sample that passed the gate, one scalar after the other. Not inlined: its frame
 * is not below auvid_nav_innovations(). */
static AUVID_NOINLINE void nav_apply_scalars(auvid_nav_t *nav, const auvid_nav_measurement_t *m)
{
    auvid_real_t nis = AUVID_C(0.0);
    for (int j = 0; m->outside != 0 && j < nav_scalar_count(m); ++j) {
        if ((m->outside >> j & 1) != 0) {
            nav_restart_scalar(nav, m, j);
        }
    }
    for (int j = 0; j < nav_scalar_count(m); ++j) {
        if ((m->outside >> j & 1) == 0) {
            nis += nav_apply_scalar(nav, m, j);
        }
    }
    if (m->outside == 0) {
        nav->diagnostics[m->sensor].nis = nis;
    }
}

void auvid_nav_restart_position(auvid_nav_t *nav, int axis, auvid_real_t step,
                                auvid_real_t variance)
{
    nav_move_position(nav, axis, step);
    for (int k = 0; k < 3; ++k) {
        nav->ekf.pp[nav_packed[axis][k]] = AUVID_C(0.0);
        nav->ekf.pv[axis][k] = AUVID_C(0.0);
    }
    nav->ekf.pp[nav_packed[axis][axis]] = variance;
    nav->ekf.updated_us = nav->imu.t_us;
}

auvid_status_t auvid_nav_apply_sample(auvid_nav_t *nav, auvid_nav_measurement_t *m, bool hold_back,
                                      bool applied)
{
    auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    if (applied) {
        d->innovation_count = m->n;
        d->seen_us = m->t_us;
        nav_record_accepted(d, m->t_us);
    } else {
        auvid_status_t status = nav_test_gate(nav, m);
        if (status != AUVID_OK || hold_back) {
            return status;
        }
        nav_apply_scalars(nav, m);
    }
    nav->ekf.updated_us = nav->imu.t_us;
    return AUVID_OK;
}
