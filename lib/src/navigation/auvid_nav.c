/*
 * Navigation filter, first part: configuration, prediction, output (Karras et al. 2013, II-B).
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

#define LARGEST_ANGLE AUVID_C(1e4) /* what auvid_sincos takes */
#define LARGEST_RATE AUVID_C(100.0)

void auvid_nav_defaults(auvid_nav_config_t *config)
{
    if (config == NULL) {
        return;
    }
    memset(config, 0, sizeof *config);
    for (int i = 0; i < 3; ++i) {
        config->sigma_acceleration[i] = AUVID_C(1.0);
    }
    config->reference_tick = AUVID_C(0.02);
    config->sigma_dvl = AUVID_C(0.007);
    config->sigma_current = AUVID_C(0.3);
    config->sigma_depth = AUVID_C(0.015);
    config->sigma_gps = AUVID_C(1.5);
    config->sigma_position = AUVID_C(1.0);
    config->sigma_velocity = AUVID_C(1.0);
    config->gate = AUVID_C(16.0);
    config->agility = AUVID_C(3.0);
    config->speed_limit = AUVID_C(3.0);
    config->density = AUVID_C(1025.0);
    config->gravity = AUVID_C(9.80665);
    config->surface_pressure = AUVID_C(101325.0);
    config->surface_depth = AUVID_C(0.5);
    config->dvl_max_age_us = 500000;
    config->depth_max_age_us = 500000;
    config->gps_max_age_us = 500000;
    config->future_us = 20000;
    config->stale_us = 1000000;
    config->gap_us = 1000000;
    config->lockout = 10;
    config->gps_start = 4;
}

/* The ranges of nav.h; `n` reals stand at `offset` in the configuration. */
#define FIELD(name, n, low, high)                                                                  \
    {                                                                                              \
        (uint8_t) offsetof(auvid_nav_config_t, name), n, low, high                                 \
    }
static const struct {
    uint8_t offset, n;
    auvid_real_t low, high;
} ranges[] = {
    FIELD(sigma_acceleration, 3, AUVID_C(1e-4), AUVID_C(100.0)),
    FIELD(reference_tick, 1, AUVID_C(1e-4), AUVID_C(10.0)),
    FIELD(sigma_dvl, 1, AUVID_C(1e-4), AUVID_C(1e3)),
    FIELD(sigma_current, 1, AUVID_C(0.0), AUVID_C(1e3)),
    FIELD(sigma_depth, 1, AUVID_C(1e-3), AUVID_C(1e3)),
    FIELD(sigma_gps, 1, AUVID_C(1e-3), AUVID_C(1e3)),
    FIELD(position, 3, -NAV_LARGEST_POSITION, NAV_LARGEST_POSITION),
    FIELD(sigma_position, 1, AUVID_C(1e-4), AUVID_C(1e3)),
    FIELD(sigma_velocity, 1, AUVID_C(1e-4), AUVID_C(10.0)),
    FIELD(gate, 1, AUVID_C(0.0), AUVID_C(1e6)),
    FIELD(agility, 1, AUVID_C(0.0), AUVID_C(100.0)),
    FIELD(speed_limit, 1, AUVID_C(0.0), NAV_LARGEST_SPEED),
    FIELD(dvl_euler, 3, AUVID_C(-10.0), AUVID_C(10.0)),
    FIELD(dvl_lever, 3, AUVID_C(-1e3), AUVID_C(1e3)),
    FIELD(density, 1, AUVID_C(1.0), AUVID_C(1e5)),
    FIELD(gravity, 1, AUVID_C(0.1), AUVID_C(100.0)),
    FIELD(surface_pressure, 1, AUVID_C(0.0), AUVID_C(1e6)),
    FIELD(surface_depth, 1, -NAV_LARGEST_POSITION, NAV_LARGEST_POSITION),
};

static auvid_status_t check_config(const auvid_nav_config_t *c)
{
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; ++i) {
        for (size_t k = 0; k < ranges[i].n; ++k) {
            auvid_real_t x;
            memcpy(&x, (const char *)c + ranges[i].offset + k * sizeof x, sizeof x);
            if (!(x >= ranges[i].low && x <= ranges[i].high)) {
                return auvid_is_finite(x) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
            }
        }
    }
    const uint32_t most_us = NAV_LARGEST_AGE_US;
    bool good = c->dvl_max_age_us <= most_us && c->depth_max_age_us <= most_us &&
                c->gps_max_age_us <= most_us && c->future_us <= most_us && c->stale_us > 0 &&
                c->gps_start <= AUVID_NAV_GPS_START_MAX;
    return good ? AUVID_OK : AUVID_ERR_RANGE;
}

static inline auvid_real_t square(auvid_real_t x)
{
    return x * x;
}

auvid_status_t auvid_nav_init(auvid_nav_t *nav, const auvid_nav_config_t *config)
{
    if (nav == NULL || config == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = check_config(config);
    if (status != AUVID_OK) {
        return status;
    }
    memset(nav, 0, sizeof *nav);
    for (int i = 0; i < 3; ++i) {
        nav->q[i] = square(config->sigma_acceleration[i]) * config->reference_tick;
        nav->position[i] = config->position[i];
        nav->pp[nav_packed[i][i]] = square(config->sigma_position);
        nav->vv[nav_packed[i][i]] = square(config->sigma_velocity);
    }
    nav->r[AUVID_NAV_DVL_BOTTOM] = square(config->sigma_dvl);
    nav->r[AUVID_NAV_DVL_WATER] = square(config->sigma_dvl) + square(config->sigma_current);
    nav->r[AUVID_NAV_DEPTH] = square(config->sigma_depth);
    nav->r[AUVID_NAV_GPS] = square(config->sigma_gps);
    nav->max_age_us[AUVID_NAV_DVL_BOTTOM] = config->dvl_max_age_us;
    nav->max_age_us[AUVID_NAV_DVL_WATER] = config->dvl_max_age_us;
    nav->max_age_us[AUVID_NAV_DEPTH] = config->depth_max_age_us;
    nav->max_age_us[AUVID_NAV_GPS] = config->gps_max_age_us;
    nav->future_us = config->future_us;
    nav->stale_us = config->stale_us;
    nav->gap_us = config->gap_us;
    nav->gate = config->gate > AUVID_C(0.0) ? config->gate : AUVID_LARGEST;
    nav->agility = config->agility;
    nav->speed_limit = config->speed_limit > AUVID_C(0.0) ? config->speed_limit : NAV_LARGEST_SPEED;
    nav->metres_per_pascal = AUVID_C(1.0) / (config->density * config->gravity);
    nav->surface_pressure = config->surface_pressure;
    nav->surface_depth = config->surface_depth;
    nav->lockout = config->lockout;
    nav->gps_start = config->gps_start;
    memcpy(nav->lever, config->dvl_lever, sizeof nav->lever);
    auvid_rotation(config->dvl_euler[0], config->dvl_euler[1], config->dvl_euler[2], nav->mount);
    nav->ready = NAV_READY;
    return AUVID_OK;
}

/* Row i of t R, N and Ppv, and the position; a: A, its upper half. */
AUVID_INLINE void predict_row(auvid_nav_t *nav, int i, auvid_real_t t, const auvid_real_t a[6],
                              const auvid_real_t quarter[3], auvid_real_t tr[3], auvid_real_t n[3])
{
    auvid_real_t x = t * nav->rotation[i][0];
    auvid_real_t y = t * nav->rotation[i][1];
    auvid_real_t z = t * nav->rotation[i][2];
    auvid_real_t c0 = x * a[0] + y * a[1] + z * a[2];
    auvid_real_t c1 = x * a[1] + y * a[3] + z * a[4];
    auvid_real_t c2 = x * a[2] + y * a[4] + z * a[5];
    auvid_real_t *pv = nav->pv[i];
    tr[0] = x;
    tr[1] = y;
    tr[2] = z;
    n[0] = pv[0] + AUVID_C(0.5) * c0;
    n[1] = pv[1] + AUVID_C(0.5) * c1;
    n[2] = pv[2] + AUVID_C(0.5) * c2;
    pv[0] += c0 + x * quarter[0];
    pv[1] += c1 + y * quarter[1];
    pv[2] += c2 + z * quarter[2];
    nav_move(nav, i, x * nav->velocity[0] + y * nav->velocity[1] + z * nav->velocity[2]);
}

/* Eq. 5 and the covariance that goes with it, as above. */
static AUVID_APART void predict(auvid_nav_t *nav, auvid_real_t t)
{
    auvid_real_t tr[3][3], n[3][3], t4 = t * AUVID_C(0.25);
    const auvid_real_t quarter[3] = {nav->q[0] * t4, nav->q[1] * t4, nav->q[2] * t4};
    const auvid_real_t a[6] = {nav->vv[0] + quarter[0], nav->vv[1], nav->vv[2],
                               nav->vv[3] + quarter[1], nav->vv[4], nav->vv[5] + quarter[2]};
    predict_row(nav, 0, t, a, quarter, tr[0], n[0]);
    predict_row(nav, 1, t, a, quarter, tr[1], n[1]);
    predict_row(nav, 2, t, a, quarter, tr[2], n[2]);
    nav->pp[0] += AUVID_C(2.0) * nav_dot(n[0], tr[0]);
    nav->pp[1] += nav_dot(n[0], tr[1]) + nav_dot(n[1], tr[0]);
    nav->pp[2] += nav_dot(n[0], tr[2]) + nav_dot(n[2], tr[0]);
    nav->pp[3] += AUVID_C(2.0) * nav_dot(n[1], tr[1]);
    nav->pp[4] += nav_dot(n[1], tr[2]) + nav_dot(n[2], tr[1]);
    nav->pp[5] += AUVID_C(2.0) * nav_dot(n[2], tr[2]);
    nav->vv[0] += AUVID_C(4.0) * quarter[0];
    nav->vv[3] += AUVID_C(4.0) * quarter[1];
    nav->vv[5] += AUVID_C(4.0) * quarter[2];
}

/* Whole turns that an angle left behind when it jumped by more than half a turn. */
static inline void count_turns(int32_t *turns, auvid_real_t from, auvid_real_t to)
{
    if (!(auvid_abs(from - to) < AUVID_C(3.0))) {
        auvid_real_t part = (from - to) * (AUVID_C(0.5) / AUVID_PI);
        *turns += (int32_t)(part + (part < AUVID_C(0.0) ? AUVID_C(-0.5) : AUVID_C(0.5)));
    }
}

auvid_status_t auvid_nav_imu(auvid_nav_t *nav, uint64_t t_us, const auvid_real_t attitude[3],
                             const auvid_real_t rates[3])
{
    if (nav == NULL || attitude == NULL || rates == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->ready == NAV_BLANK) {
        return AUVID_ERR_STATE;
    }
    bool running = nav->ready == NAV_RUNNING;
    auvid_status_t status = nav_within(attitude, LARGEST_ANGLE);
    if (status == AUVID_OK) {
        status = nav_within(rates, LARGEST_RATE);
    }
    if (status != AUVID_OK) {
        nav_count(&nav->imu_invalid);
        return status;
    }
    if (running && t_us <= nav->t_us) {
        nav_count(&nav->imu_time);
        return t_us < nav->t_us ? AUVID_ERR_TIME_BACK : AUVID_ERR_TIME_SAME;
    }
    uint64_t dt_us = t_us - nav->t_us;
    nav->t_us = t_us;
    auvid_rotation(attitude[0], attitude[1], attitude[2], nav->rotation);
    auvid_real_t phi = nav->attitude[0], psi = nav->attitude[2];
    memcpy(nav->attitude, attitude, sizeof nav->attitude);
    memcpy(nav->rates, rates, sizeof nav->rates);
    auvid_nav_keep_rates(nav, dt_us);
    nav->flags = (uint16_t)(nav->flags & ~AUVID_NAV_IN_GAP);
    nav->held_refused = 0;
    if (!running) {
        nav->ready = NAV_RUNNING;
        nav->touched_us = t_us;
        return AUVID_OK;
    }
    count_turns(&nav->turns[0], phi, attitude[0]);
    count_turns(&nav->turns[2], psi, attitude[2]);
    predict(nav, auvid_seconds(0, dt_us));
    if (nav->holding != 0) {
        auvid_nav_release(nav);
    }
    if (nav->gap_us > 0 && dt_us > nav->gap_us) {
        nav->flags = (uint16_t)(nav->flags | AUVID_NAV_IN_GAP);
        nav_count(&nav->imu_gaps);
        return AUVID_GAP;
    }
    return AUVID_OK;
}

auvid_status_t auvid_nav_state(const auvid_nav_t *nav, auvid_nav_state_t *state)
{
    if (nav == NULL || state == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->ready != NAV_RUNNING) {
        return AUVID_ERR_STATE;
    }
    state->t_us = nav->t_us;
    for (int i = 0; i < 3; ++i) {
        state->position[i] = nav->position[i] + nav->residue[i];
        state->attitude[i] =
            nav->attitude[i] + (auvid_real_t)nav->turns[i] * (AUVID_C(2.0) * AUVID_PI);
        state->velocity[i] = nav->velocity[i];
        state->rates[i] = nav->rates[i];
    }
    state->flags = nav->flags;
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        state->flags |= nav_fresh(nav, i) ? 1u << i : 0u;
    }
    return AUVID_OK;
}

auvid_status_t auvid_nav_covariance(const auvid_nav_t *nav, auvid_real_t p[6][6])
{
    if (nav == NULL || p == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->ready == NAV_BLANK) {
        return AUVID_ERR_STATE;
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            p[i][j] = nav->pp[nav_packed[i][j]];
            p[i][3 + j] = p[3 + j][i] = nav->pv[i][j];
            p[3 + i][3 + j] = nav->vv[nav_packed[i][j]];
        }
    }
    return AUVID_OK;
}
