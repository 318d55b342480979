/*
 * Navigation filter, second part: one measurement enters (Karras et al. 2013, Eq. 6-8).
 *
 * Every scalar measurement comes down to an innovation nu, its variance S and its covariance c with
 * the state; then
 *
 *     K = c / S,   x += K nu,   P -= K c'
 *
 * which is symmetric by construction, and positive as long as (c, S) is a possible covariance.
 * A sample of the present: c = P H', S = H P H' + R. A sample of age a:
 *
 * Position i: p_i(t - a) = p_i - a R_i v, so H = [e_i, -a R_i], R_i row i of R(phi, theta, psi).
 *
 * Velocity along h: z = h'(v - w) + noise, w the noise that came in since, of variance a diag(q).
 *     With m = a diag(q) h the covariance of x with h'w is q_x = [a/2 R m; m], and
 *     c = P H' - q_x,   S = H P H' - 2 h'm + h'm + R = H P H' - h'm + R        (Bar-Shalom's B1)
 *     The filter's velocity of the sample's time is then its present one: cov(w, nu) = m - m = 0.
 *     This holds while nothing entered since (a measurement would have told something about w) and
 *     R stood still; long ticks and fast turns can make (c, S) an impossible covariance, which is
 *     checked. Else w is taken as the part beta = h'm / H P H' of what is unknown along h:
 *     c = (1 - beta) P H',   S = (1 - beta) H P H' + R
 *     of which P - c c'/S is positive for any beta in [0, 1).
 */
#include <string.h>

#include "auvid_nav_private.h"

/* One update may shrink a variance to this part of itself, no further: what is left of P - K c'
 * must stay well above the rounding of P. It acts as a larger R. */
#define SMALLEST_REST (AUVID_C(16.0) * AUVID_EPSILON)
#define LARGEST_BETA AUVID_C(0.99)

/* P H' of a velocity along h. */
static auvid_real_t along(const auvid_nav_t *nav, const auvid_real_t h[3], auvid_real_t c[6])
{
    for (int k = 0; k < 3; ++k) {
        const uint8_t *row = nav_packed[k];
        c[k] = nav_dot(nav->pv[k], h);
        c[3 + k] = nav->vv[row[0]] * h[0] + nav->vv[row[1]] * h[1] + nav->vv[row[2]] * h[2];
    }
    return nav_dot(h, c + 3);
}

/* Is c' P^-1 c < s, so that P - c c'/s is positive definite? P = L D L', y = L^-1 c. */
static bool is_possible(const auvid_nav_t *nav, const auvid_real_t c[6], auvid_real_t s)
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
    return sum < s * (AUVID_C(1.0) - SMALLEST_REST);
}

/* Take the noise since the sample out of c; return what H P H' becomes. */
static auvid_real_t take_noise_out(const auvid_nav_t *nav, const auvid_nav_measurement_t *m,
                                   const auvid_real_t h[3], auvid_real_t c[6], auvid_real_t hph)
{
    auvid_real_t noise[3], exact[6];
    for (int k = 0; k < 3; ++k) {
        noise[k] = m->age * nav->q[k] * h[k];
    }
    auvid_real_t variance = nav_dot(noise, h);
    if (m->clean && hph > variance) {
        for (int k = 0; k < 3; ++k) {
            exact[k] = c[k] - AUVID_C(0.5) * m->age * nav_dot(nav->rotation[k], noise);
            exact[3 + k] = c[3 + k] - noise[k];
        }
        if (is_possible(nav, exact, hph - variance + nav->r[m->sensor])) {
            memcpy(c, exact, sizeof exact);
            return hph - variance;
        }
    }
    auvid_real_t rest = AUVID_C(1.0) - auvid_min(variance / hph, LARGEST_BETA);
    for (int k = 0; k < 6; ++k) {
        c[k] *= rest;
    }
    return hph * rest;
}

/* Scalar j of a velocity is the velocity along this. */
static const auvid_real_t *direction(const auvid_nav_measurement_t *m, int j)
{
    static const auvid_real_t unit[3][3] = {{AUVID_C(1.0), AUVID_C(0.0), AUVID_C(0.0)},
                                            {AUVID_C(0.0), AUVID_C(1.0), AUVID_C(0.0)},
                                            {AUVID_C(0.0), AUVID_C(0.0), AUVID_C(1.0)}};
    return m->directed ? m->h[j] : unit[j];
}

static auvid_real_t linearise_velocity(const auvid_nav_t *nav, const auvid_nav_measurement_t *m,
                                       int j, auvid_nav_scalar_t *out)
{
    const auvid_real_t *h = direction(m, j);
    auvid_real_t hph;
    if (m->directed) {
        hph = along(nav, h, out->c);
        out->nu = m->z[j] - nav_dot(h, nav->velocity);
    } else {
        for (int k = 0; k < 3; ++k) {
            out->c[k] = nav->pv[k][j];
            out->c[3 + k] = nav->vv[nav_packed[j][k]];
        }
        hph = out->c[3 + j];
        out->nu = m->z[j] - nav->velocity[j];
    }
    return m->age > AUVID_C(0.0) ? take_noise_out(nav, m, h, out->c, hph) : hph;
}

static auvid_real_t linearise_position(const auvid_nav_t *nav, const auvid_nav_measurement_t *m,
                                       int j, auvid_nav_scalar_t *out)
{
    int i = m->first + j;
    for (int k = 0; k < 3; ++k) {
        out->c[k] = nav->pp[nav_packed[i][k]];
        out->c[3 + k] = nav->pv[i][k];
    }
    out->nu = (m->z[j] - nav->position[i]) - nav->residue[i];
    if (!(m->age > AUVID_C(0.0))) {
        return out->c[i];
    }
    auvid_real_t h[3], c[6];
    for (int k = 0; k < 3; ++k) {
        h[k] = -m->age * nav->rotation[i][k];
    }
    (void)along(nav, h, c);
    for (int k = 0; k < 6; ++k) {
        out->c[k] += c[k];
    }
    out->nu -= nav_dot(h, nav->velocity);
    return out->c[i] + nav_dot(h, out->c + 3);
}

static void linearise(const auvid_nav_t *nav, const auvid_nav_measurement_t *m, int j,
                      auvid_nav_scalar_t *out)
{
    auvid_real_t hph =
        m->is_velocity ? linearise_velocity(nav, m, j, out) : linearise_position(nav, m, j, out);
    out->s = hph + auvid_max(nav->r[m->sensor], SMALLEST_REST * hph);
}

/* P -= k c' of a symmetric block */
static inline void subtract(auvid_real_t p[6], const auvid_real_t k[3], const auvid_real_t c[3])
{
    p[0] -= k[0] * c[0];
    p[1] -= k[0] * c[1];
    p[2] -= k[0] * c[2];
    p[3] -= k[1] * c[1];
    p[4] -= k[1] * c[2];
    p[5] -= k[2] * c[2];
}

/* Eq. 6 for one scalar. Returns nu^2 / S. The position is moved through its residue, which the next
 * prediction carries over. */
static auvid_real_t apply(auvid_nav_t *nav, const auvid_nav_scalar_t *m)
{
    auvid_real_t inverse = AUVID_C(1.0) / m->s, k[6];
    for (int i = 0; i < 6; ++i) {
        k[i] = m->c[i] * inverse;
    }
    subtract(nav->pp, k, m->c);
    subtract(nav->vv, k + 3, m->c + 3);
    for (int i = 0; i < 3; ++i) {
        nav->pv[i][0] -= k[i] * m->c[3];
        nav->pv[i][1] -= k[i] * m->c[4];
        nav->pv[i][2] -= k[i] * m->c[5];
        nav->residue[i] += k[i] * m->nu;
        nav->velocity[i] += k[3 + i] * m->nu;
    }
    return m->nu * m->nu * inverse;
}

uint8_t auvid_nav_look(auvid_nav_t *nav, auvid_nav_measurement_t *m)
{
    auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    unsigned outside = 0;
    d->nis = AUVID_C(0.0);
    for (int j = m->n - 1; j >= 0; --j) {
        linearise(nav, m, j, &m->scalar);
        auvid_real_t ratio = m->scalar.nu * m->scalar.nu / m->scalar.s;
        d->innovation[j] = m->scalar.nu;
        d->variance[j] = m->scalar.s;
        d->nis = auvid_max(d->nis, ratio);
        outside |= ratio > nav->gate ? 1u << j : 0u;
    }
    d->axes = m->n;
    d->seen_us = m->t_us;
    return (uint8_t)outside;
}

auvid_status_t auvid_nav_pass(auvid_nav_t *nav, auvid_nav_measurement_t *m)
{
    auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    m->outside = auvid_nav_look(nav, m);
    if (m->outside != 0) {
        nav_count(&d->refusals);
        if (nav->lockout == 0 || d->refusals < nav->lockout) {
            return AUVID_GATED;
        }
        nav_count(&d->resets);
    }
    nav_note_good(d, m->t_us);
    return AUVID_OK;
}

/* Set the velocity along h from a measurement, whatever was known of it, with u = [0; h], g = P u:
 * P = (I - u u') P (I - u u') + variance u u' = P - g u' - u g' + (u'g + variance) u u' */
static void restart_velocity(auvid_nav_t *nav, const auvid_real_t h[3], auvid_real_t step,
                             auvid_real_t variance)
{
    auvid_real_t g[6];
    auvid_real_t sum = along(nav, h, g) + variance;
    for (int k = 0; k < 3; ++k) {
        for (int l = 0; l < 3; ++l) {
            nav->pv[k][l] -= g[k] * h[l];
        }
        for (int l = k; l < 3; ++l) {
            nav->vv[nav_packed[k][l]] += (sum * h[k] * h[l] - g[3 + k] * h[l]) - h[k] * g[3 + l];
        }
        nav->velocity[k] += step * h[k];
    }
}

/* The filter was wrong about scalar j by far more than it thought: start that one again. */
static void start_again(auvid_nav_t *nav, const auvid_nav_measurement_t *m, int j)
{
    auvid_real_t step = nav->diagnostics[m->sensor].innovation[j];
    auvid_real_t variance = nav->r[m->sensor];
    if (!m->is_velocity) {
        auvid_nav_restart(nav, m->first + j, step, variance);
        return;
    }
    const auvid_real_t *h = direction(m, j);
    for (int k = 0; k < 3; ++k) {
        variance += m->age * nav->q[k] * h[k] * h[k];
    }
    restart_velocity(nav, h, step, variance);
}

void auvid_nav_enter(auvid_nav_t *nav, auvid_nav_measurement_t *m)
{
    auvid_real_t nis = AUVID_C(0.0);
    for (int j = 0; m->outside != 0 && j < m->n; ++j) {
        if ((m->outside >> j & 1) != 0) {
            start_again(nav, m, j);
        }
    }
    for (int j = 0; j < m->n; ++j) {
        if ((m->outside >> j & 1) == 0) {
            if (j > 0 || m->outside != 0) {
                linearise(nav, m, j, &m->scalar);
            }
            nis += apply(nav, &m->scalar);
        }
    }
    if (m->outside == 0) {
        nav->diagnostics[m->sensor].nis = nis;
    }
    nav->touched_us = nav->t_us;
}

void auvid_nav_restart(auvid_nav_t *nav, int axis, auvid_real_t step, auvid_real_t variance)
{
    nav_move(nav, axis, step);
    for (int k = 0; k < 3; ++k) {
        nav->pp[nav_packed[axis][k]] = AUVID_C(0.0);
        nav->pv[axis][k] = AUVID_C(0.0);
    }
    nav->pp[nav_packed[axis][axis]] = variance;
    nav->touched_us = nav->t_us;
}
