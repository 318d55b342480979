/*
 * Navigation filter, first part: configuration and output. The prediction is in auvid_nav_step.c.
 */
#include <string.h>

#include "../base/auvid_refusal_internal.h"
#include "auvid_nav_internal.h"

extern void auvid_nav_subtract(auvid_real_t *p, const auvid_real_t *k, const auvid_real_t *c);

#define NAV_SENSOR(name, input, event, kind, axis, axes, config, noise_mm, surface, start)         \
    [AUVID_NAV_##name] = {offsetof(auvid_nav_config_t, sigma_##config),                            \
                          offsetof(auvid_nav_config_t, config##_max_age_us),                       \
                          noise_mm,                                                                \
                          NAV_##kind,                                                              \
                          axis,                                                                    \
                          axes,                                                                    \
                          surface,                                                                 \
                          NAV_START_##start},
const auvid_nav_row_t auvid_nav_rows[AUVID_NAV_SENSOR_COUNT] = {AUVID_SENSORS(NAV_SENSOR)};

#define NAV_ONE(...) +1
_Static_assert(AUVID_SENSORS(NAV_ONE) == AUVID_NAV_SENSOR_COUNT, "a row for each sensor");
#define NAV_MEDIAN(name, input, event, kind, axis, axes, config, noise_mm, surface, start)         \
    +(NAV_START_##start == NAV_START_MEDIAN)
_Static_assert(AUVID_SENSORS(NAV_MEDIAN) <= 1, "gps_start, gps_count, gps_offset: of one sensor");

void auvid_nav_defaults(auvid_nav_config_t *cfg)
{
    if (cfg == NULL) {
        return;
    }
    memset(cfg, 0, sizeof *cfg);
    for (int i = 0; i < 3; ++i) {
        cfg->sigma_acceleration[i] = AUVID_C(1.0);
    }
    cfg->reference_tick = AUVID_C(0.02);
    cfg->sigma_current = AUVID_C(0.3);
    cfg->sigma_position = AUVID_C(1.0);
    cfg->sigma_velocity = AUVID_C(1.0);
    cfg->gate = AUVID_C(16.0);
    cfg->max_acceleration = AUVID_C(3.0);
    cfg->speed_limit = AUVID_C(3.0);
    cfg->density = AUVID_C(1025.0);
    cfg->gravity = AUVID_C(9.80665);
    cfg->surface_pressure = AUVID_C(101325.0);
    cfg->surface_depth = AUVID_C(0.5);
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        const uint32_t max_age_us = 500000;
        auvid_real_t sigma = (auvid_real_t)auvid_nav_rows[i].noise_mm / AUVID_C(1000.0);
        memcpy((char *)cfg + auvid_nav_rows[i].sigma, &sigma, sizeof sigma);
        memcpy((char *)cfg + auvid_nav_rows[i].max_age, &max_age_us, sizeof max_age_us);
    }
    cfg->future_us = 20000;
    cfg->stale_us = 1000000;
    cfg->gap_us = 1000000;
    cfg->max_consecutive_rejections = 10;
    cfg->gps_start = 4;
}

/* The ranges of nav.h. A DVL has two rows of the sensor table, so its fields occur twice. */
#define NAV_REALS(name, n, low, high) REALS_IN(auvid_nav_config_t, name, n, low, high)
#define NAV_WHOLE(name, low, high) WHOLE_IN(auvid_nav_config_t, name, 1, low, high)
#define NAV_MIN_SIGMA_VELOCITY AUVID_C(1e-4)
#define NAV_MIN_SIGMA_POSITION AUVID_C(1e-3)
#define NAV_SENSOR_FIELDS(name, input, event, kind, axis, axes, config, ...)                       \
    NAV_REALS(sigma_##config, 1, NAV_MIN_SIGMA_##kind, AUVID_C(1e3)),                              \
        NAV_WHOLE(config##_max_age_us, 0, NAV_LARGEST_AGE_US),
static const auvid_field_t nav_fields[] = {
    NAV_REALS(sigma_acceleration, 3, AUVID_C(1e-4), AUVID_C(100.0)),
    NAV_REALS(reference_tick, 1, AUVID_C(1e-4), AUVID_C(10.0)),
    NAV_REALS(sigma_current, 1, AUVID_C(0.0), AUVID_C(1e3)),
    NAV_REALS(position, 3, -NAV_LARGEST_POSITION, NAV_LARGEST_POSITION),
    NAV_REALS(sigma_position, 1, AUVID_C(1e-4), AUVID_C(1e3)),
    NAV_REALS(sigma_velocity, 1, AUVID_C(1e-4), AUVID_C(10.0)),
    NAV_REALS(gate, 1, AUVID_C(0.0), AUVID_C(1e6)),
    NAV_REALS(max_acceleration, 1, AUVID_C(0.0), AUVID_C(100.0)),
    NAV_REALS(speed_limit, 1, AUVID_C(0.0), NAV_LARGEST_SPEED),
    NAV_REALS(mount.imu_euler, 3, AUVID_C(-10.0), AUVID_C(10.0)),
    NAV_REALS(mount.dvl_euler, 3, AUVID_C(-10.0), AUVID_C(10.0)),
    NAV_REALS(mount.dvl_lever, 3, AUVID_C(-1e3), AUVID_C(1e3)),
    NAV_REALS(density, 1, AUVID_C(1.0), AUVID_C(1e5)),
    NAV_REALS(gravity, 1, AUVID_C(0.1), AUVID_C(100.0)),
    NAV_REALS(surface_pressure, 1, AUVID_C(0.0), AUVID_C(1e6)),
    NAV_REALS(surface_depth, 1, -NAV_LARGEST_POSITION, NAV_LARGEST_POSITION),
    NAV_WHOLE(future_us, 0, NAV_LARGEST_AGE_US),
    NAV_WHOLE(stale_us, 1, AUVID_C(4294967296.0)),
    NAV_WHOLE(gps_start, 0, AUVID_NAV_GPS_START_MAX),
    AUVID_SENSORS(NAV_SENSOR_FIELDS)};

static inline auvid_real_t nav_square(auvid_real_t x)
{
    return x * x;
}

void auvid_nav_set_up(auvid_nav_t *nav, const auvid_nav_config_t *cfg, auvid_refusal_t *why)
{
    AUVID_CHECK_TABLE(why, cfg, nav_fields);
    if (why->status != AUVID_OK) {
        return;
    }
    auvid_nav_prepared_t *to = &nav->cfg;
    memset(nav, 0, sizeof *nav);
    for (int i = 0; i < 3; ++i) {
        to->q[i] = nav_square(cfg->sigma_acceleration[i]) * cfg->reference_tick;
        nav->ekf.position[i] = cfg->position[i];
        nav->ekf.pp[nav_packed[i][i]] = nav_square(cfg->sigma_position);
        nav->ekf.vv[nav_packed[i][i]] = nav_square(cfg->sigma_velocity);
    }
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        const unsigned char *from = (const unsigned char *)cfg;
        memcpy(&to->r[i], from + auvid_nav_rows[i].sigma, sizeof to->r[i]);
        to->r[i] = nav_square(to->r[i]);
        memcpy(&to->max_age_us[i], from + auvid_nav_rows[i].max_age, sizeof to->max_age_us[i]);
    }
    to->r[AUVID_NAV_DVL_WATER] += nav_square(cfg->sigma_current);
    to->future_us = cfg->future_us;
    to->stale_us = cfg->stale_us;
    to->gap_us = cfg->gap_us;
    to->gate = cfg->gate > AUVID_C(0.0) ? cfg->gate : AUVID_LARGEST;
    to->max_acceleration = cfg->max_acceleration;
    to->speed_limit = cfg->speed_limit > AUVID_C(0.0) ? cfg->speed_limit : NAV_LARGEST_SPEED;
    to->metres_per_pascal = AUVID_C(1.0) / (cfg->density * cfg->gravity);
    to->surface_pressure = cfg->surface_pressure;
    to->surface_depth = cfg->surface_depth;
    to->max_consecutive_rejections = cfg->max_consecutive_rejections;
    nav->gps.start = cfg->gps_start;
    memcpy(to->lever, cfg->mount.dvl_lever, sizeof to->lever);
    auvid_rotation(cfg->mount.dvl_euler[0], cfg->mount.dvl_euler[1], cfg->mount.dvl_euler[2],
                   to->mount);
    auvid_rotation(cfg->mount.imu_euler[0], cfg->mount.imu_euler[1], cfg->mount.imu_euler[2],
                   to->imu_mount);
    for (int i = 0; i < 3; ++i) {
        to->imu_turned = to->imu_turned || !auvid_is_zero(cfg->mount.imu_euler[i]);
    }
    nav->imu.ready = NAV_READY;
}

auvid_status_t auvid_nav_init(auvid_nav_t *nav, const auvid_nav_config_t *cfg)
{
    auvid_refusal_t why;
    if (nav == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_check_begin(&why);
    auvid_nav_set_up(nav, cfg, &why);
    return why.status;
}

void auvid_nav_increment(uint16_t *counter)
{
    *counter = (uint16_t)(*counter + (*counter < UINT16_MAX));
}

bool auvid_nav_pose(const auvid_nav_t *nav, auvid_nav_state_t *state)
{
    if (nav->imu.ready != NAV_RUNNING) {
        return false;
    }
    state->t_us = nav->imu.t_us;
    for (int i = 0; i < 3; ++i) {
        state->position[i] = nav->ekf.position[i] + nav->ekf.position_lo[i];
        state->attitude[i] = nav->imu.attitude[i] +
                             (auvid_real_t)nav->imu.revolutions[i] * (AUVID_C(2.0) * AUVID_PI);
        state->velocity[i] = nav->ekf.velocity[i];
        state->rates[i] = nav->imu.rates[i];
    }
    return true;
}

auvid_status_t auvid_nav_state(const auvid_nav_t *nav, auvid_nav_state_t *state)
{
    if (nav == NULL || state == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!auvid_nav_pose(nav, state)) {
        return AUVID_ERR_STATE;
    }
    state->flags = nav->flags;
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        state->flags |= nav_is_fresh(nav, i) ? AUVID_NAV_FRESH(i) : 0u;
    }
    return AUVID_OK;
}

auvid_status_t auvid_nav_covariance(const auvid_nav_t *nav, auvid_real_t p[6][6])
{
    if (nav == NULL || p == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->imu.ready == NAV_BLANK) {
        return AUVID_ERR_STATE;
    }
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            p[i][j] = nav->ekf.pp[nav_packed[i][j]];
            p[i][3 + j] = p[3 + j][i] = nav->ekf.pv[i][j];
            p[3 + i][3 + j] = nav->ekf.vv[nav_packed[i][j]];
        }
    }
    return AUVID_OK;
}
