/*
 * Navigation filter, last part: the prediction, for each sample of the IMU.
 *
 * Eq. 5 with R = R(phi_k, theta_k, psi_k), t the tick and n the accelerations:
 *
 *     p_k = p_{k-1} + R (v_{k-1} t + n t^2/2)          F = [ I  t R ]      G = [ R t^2/2 ]
 *     v_k = v_{k-1} + n t                                  [ 0   I  ]          [ I t     ]
 *
 *     P_k = F P F' + G Q G',   Q = diag(q) / t,   q = sigma^2 reference_tick
 *
 * In blocks, with A = Pvv + diag(q) t/4, C = t R A and N = Ppv + C/2:
 *
 *     Ppp += N (t R)' + (t R) N'
 *     Ppv += C + t R diag(q) t/4
 *     Pvv += diag(q) t
 */
#include <string.h>

#include "auvid_nav_internal.h"

#define LARGEST_ANGLE AUVID_C(1e4) /* limit of auvid_sincos */
#define LARGEST_RATE AUVID_C(100.0)

/* Compute row i of t R, N and Ppv, and axis i of the position; a: upper half of A. */
AUVID_INLINE void nav_predict_row(auvid_nav_t *nav, int i, auvid_real_t t, const auvid_real_t a[6],
                                  const auvid_real_t quarter[3], auvid_real_t tr[3],
                                  auvid_real_t n[3])
{
    auvid_real_t x = t * nav->imu.rotation[i][0];
    auvid_real_t y = t * nav->imu.rotation[i][1];
    auvid_real_t z = t * nav->imu.rotation[i][2];
    auvid_real_t c0 = x * a[0] + y * a[1] + z * a[2];
    auvid_real_t c1 = x * a[1] + y * a[3] + z * a[4];
    auvid_real_t c2 = x * a[2] + y * a[4] + z * a[5];
    auvid_real_t *pv = nav->ekf.pv[i];
    tr[0] = x;
    tr[1] = y;
    tr[2] = z;
    n[0] = pv[0] + AUVID_C(0.5) * c0;
    n[1] = pv[1] + AUVID_C(0.5) * c1;
    n[2] = pv[2] + AUVID_C(0.5) * c2;
    pv[0] += c0 + x * quarter[0];
    pv[1] += c1 + y * quarter[1];
    pv[2] += c2 + z * quarter[2];
    nav_move_position(
        nav, i, x * nav->ekf.velocity[0] + y * nav->ekf.velocity[1] + z * nav->ekf.velocity[2]);
}

/* Apply Eq. 5 to the state and its covariance, as above. */
static AUVID_NOINLINE void nav_predict(auvid_nav_t *nav, auvid_real_t t)
{
    auvid_real_t tr[3][3], n[3][3], t4 = t * AUVID_C(0.25);
    const auvid_real_t quarter[3] = {nav->cfg.q[0] * t4, nav->cfg.q[1] * t4, nav->cfg.q[2] * t4};
    const auvid_real_t a[6] = {
        nav->ekf.vv[0] + quarter[0], nav->ekf.vv[1], nav->ekf.vv[2],
        nav->ekf.vv[3] + quarter[1], nav->ekf.vv[4], nav->ekf.vv[5] + quarter[2]};
    nav_predict_row(nav, 0, t, a, quarter, tr[0], n[0]);
    nav_predict_row(nav, 1, t, a, quarter, tr[1], n[1]);
    nav_predict_row(nav, 2, t, a, quarter, tr[2], n[2]);
    nav->ekf.pp[0] += AUVID_C(2.0) * nav_dot(n[0], tr[0]);
    nav->ekf.pp[1] += nav_dot(n[0], tr[1]) + nav_dot(n[1], tr[0]);
    nav->ekf.pp[2] += nav_dot(n[0], tr[2]) + nav_dot(n[2], tr[0]);
    nav->ekf.pp[3] += AUVID_C(2.0) * nav_dot(n[1], tr[1]);
    nav->ekf.pp[4] += nav_dot(n[1], tr[2]) + nav_dot(n[2], tr[1]);
    nav->ekf.pp[5] += AUVID_C(2.0) * nav_dot(n[2], tr[2]);
    nav->ekf.vv[0] += AUVID_C(4.0) * quarter[0];
    nav->ekf.vv[3] += AUVID_C(4.0) * quarter[1];
    nav->ekf.vv[5] += AUVID_C(4.0) * quarter[2];
}

/* Count the revolutions of an angle that jumps by more than half a revolution. */
static inline void nav_count_revolutions(int32_t *turns, auvid_real_t from, auvid_real_t to)
{
    if (!(auvid_abs(from - to) < AUVID_C(3.0))) {
        auvid_real_t part = (from - to) * (AUVID_C(0.5) / AUVID_PI);
        *turns += (int32_t)auvid_half_further(part);
    }
}

/* Apply the held samples whose time is reached. */
static void nav_release(auvid_nav_t *nav)
{
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        unsigned bit = 1u << i;
        if ((nav->held.sensors & bit) == 0 || nav->held.t_us[i] > nav->imu.t_us) {
            continue;
        }
        nav->held.sensors = (uint8_t)(nav->held.sensors & ~bit);
        auvid_status_t status = auvid_nav_update(nav, (auvid_nav_sensor_t)i, nav->held.t_us[i],
                                                 nav->held.value[i], nav->held.valid[i]);
        if (status < 0 || status == AUVID_GATED) {
            nav->held.rejected = (uint8_t)(nav->held.rejected | bit);
        }
    }
}

static auvid_status_t nav_check_quaternion(const auvid_real_t q[4])
{
    const auvid_real_t low = AUVID_C(1.0) - AUVID_NAV_QUATERNION_TOLERANCE;
    const auvid_real_t high = AUVID_C(1.0) + AUVID_NAV_QUATERNION_TOLERANCE;
    auvid_real_t square = q[0] * q[0] + nav_dot(q + 1, q + 1);
    if (square >= low * low && square <= high * high) {
        return AUVID_OK;
    }
    return auvid_all_finite(q, 4) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
}

static auvid_status_t nav_check_imu(auvid_nav_t *nav, const auvid_real_t *attitude,
                                    const auvid_real_t rates[3], bool quaternion)
{
    if (nav == NULL || attitude == NULL || rates == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->imu.ready == NAV_BLANK) {
        return AUVID_ERR_STATE;
    }
    auvid_status_t status =
        quaternion ? nav_check_quaternion(attitude) : nav_within(attitude, LARGEST_ANGLE);
    if (status == AUVID_OK) {
        status = nav_within(rates, LARGEST_RATE);
    }
    if (status != AUVID_OK) {
        auvid_nav_increment(&nav->imu.invalid);
    }
    return status;
}

/* Predict to the time of a valid sample, along the axes of the body. */
static auvid_status_t nav_advance(auvid_nav_t *nav, uint64_t t_us, const auvid_real_t attitude[3],
                                  const auvid_real_t rates[3])
{
    bool running = nav->imu.ready == NAV_RUNNING;
    if (running && t_us <= nav->imu.t_us) {
        auvid_nav_increment(&nav->imu.stale);
        return t_us < nav->imu.t_us ? AUVID_ERR_TIME_BACK : AUVID_ERR_TIME_SAME;
    }
    uint64_t dt_us = t_us - nav->imu.t_us;
    nav->imu.t_us = t_us;
    auvid_rotation(attitude[0], attitude[1], attitude[2], nav->imu.rotation);
    auvid_real_t phi = nav->imu.attitude[0], psi = nav->imu.attitude[2];
    memcpy(nav->imu.attitude, attitude, sizeof nav->imu.attitude);
    memcpy(nav->imu.rates, rates, sizeof nav->imu.rates);
    auvid_nav_store_rates(nav, dt_us);
    nav->flags = (uint16_t)(nav->flags & ~AUVID_NAV_IN_GAP);
    nav->held.rejected = 0;
    if (!running) {
        nav->imu.ready = NAV_RUNNING;
        nav->ekf.updated_us = t_us;
        return AUVID_OK;
    }
    nav_count_revolutions(&nav->imu.revolutions[0], phi, attitude[0]);
    nav_count_revolutions(&nav->imu.revolutions[2], psi, attitude[2]);
    nav_predict(nav, auvid_seconds(0, dt_us));
    if (nav->held.sensors != 0) {
        nav_release(nav);
    }
    if (nav->cfg.gap_us > 0 && dt_us > nav->cfg.gap_us) {
        nav->flags = (uint16_t)(nav->flags | AUVID_NAV_IN_GAP);
        auvid_nav_increment(&nav->imu.gaps);
        return AUVID_GAP;
    }
    return AUVID_OK;
}

/* Continue with a sample whose rotation from the IMU's frame to the world is r. With M from the
 * IMU's frame to the body's: R = r M', omega = M rates. At a pitch of 90 degrees only psi -+ phi is
 * determined; phi is zero then. */
static auvid_status_t nav_advance_turned(auvid_nav_t *nav, uint64_t t_us, auvid_real_t r[3][3],
                                         const auvid_real_t rates[3])
{
    auvid_real_t b[3][3], attitude[3], turned[3];
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            b[i][j] = nav_dot(r[i], nav->cfg.imu_mount[j]);
        }
        turned[j] = nav_dot(nav->cfg.imu_mount[j], rates);
    }
    auvid_real_t level = auvid_sqrt(b[0][0] * b[0][0] + b[1][0] * b[1][0]); /* cos theta */
    bool vertical = !(level > AUVID_C(1e-3));
    attitude[0] = vertical ? AUVID_C(0.0) : auvid_atan2(b[2][1], b[2][2]);
    attitude[1] = auvid_atan2(-b[2][0], level);
    attitude[2] = vertical ? auvid_atan2(-b[0][1], b[1][1]) : auvid_atan2(b[1][0], b[0][0]);
    return nav_advance(nav, t_us, attitude, turned);
}

auvid_status_t auvid_nav_imu(auvid_nav_t *nav, uint64_t t_us, const auvid_real_t attitude[3],
                             const auvid_real_t rates[3])
{
    auvid_status_t status = nav_check_imu(nav, attitude, rates, false);
    if (status != AUVID_OK || !nav->cfg.imu_turned) {
        return status != AUVID_OK ? status : nav_advance(nav, t_us, attitude, rates);
    }
    auvid_real_t r[3][3];
    auvid_rotation(attitude[0], attitude[1], attitude[2], r);
    return nav_advance_turned(nav, t_us, r, rates);
}

auvid_status_t auvid_nav_imu_quaternion(auvid_nav_t *nav, uint64_t t_us,
                                        const auvid_real_t quaternion[4],
                                        const auvid_real_t rates[3])
{
    auvid_status_t status = nav_check_imu(nav, quaternion, rates, true);
    if (status != AUVID_OK) {
        return status;
    }
    /* Fossen 2011, 2.2.2: R = I + 2 w S(e) + 2 S(e)^2 = I + 2 w S(e) + 2 (e e' - e'e I) */
    auvid_real_t w = quaternion[0], r[3][3];
    const auvid_real_t *e = quaternion + 1;
    auvid_real_t square = nav_dot(e, e), scale = AUVID_C(2.0) / (w * w + square);
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        r[i][i] = AUVID_C(1.0) - scale * (square - e[i] * e[i]);
        r[i][j] = scale * (e[i] * e[j] - w * e[k]);
        r[i][k] = scale * (e[i] * e[k] + w * e[j]);
    }
    return nav_advance_turned(nav, t_us, r, rates);
}
