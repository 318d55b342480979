/*
 * Navigation filter, third part: the samples. It passes each to the update of its kind, and counts
 * it.
 */
#include "auvid_nav_internal.h"

/* Increment the counter of a status; return the status for the caller. */
static auvid_status_t nav_count_unapplied(auvid_nav_diagnostics_t *d, auvid_status_t status)
{
    switch ((int)status) {
    case NAV_HELD:
        return AUVID_PENDING;
    case AUVID_UNUSED:
        auvid_nav_increment(&d->unused);
        break;
    case AUVID_GATED:
        auvid_nav_increment(&d->gated);
        break;
    case AUVID_ERR_NOT_FINITE:
        auvid_nav_increment(&d->not_finite);
        break;
    case AUVID_ERR_RANGE:
        auvid_nav_increment(&d->invalid);
        break;
    default: /* AUVID_ERR_STALE, _TIME_SAME, _TIME_BACK */
        auvid_nav_increment(&d->stale);
        break;
    }
    return status;
}

static inline auvid_status_t nav_count_status(auvid_nav_diagnostics_t *d, auvid_status_t status)
{
    if (status != AUVID_OK && status != AUVID_PENDING) {
        return nav_count_unapplied(d, status);
    }
    d->accepted += d->accepted < UINT32_MAX ? 1u : 0u;
    return status;
}

auvid_status_t auvid_nav_update(auvid_nav_t *nav, auvid_nav_sensor_t sensor, uint64_t t_us,
                                const auvid_real_t *value, unsigned valid)
{
    if (nav == NULL || value == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->imu.ready != NAV_RUNNING) {
        return AUVID_ERR_STATE;
    }
    if ((unsigned)sensor >= AUVID_NAV_SENSOR_COUNT) {
        return AUVID_ERR_RANGE;
    }
    uint8_t i = (uint8_t)sensor;
    return nav_count_status(&nav->diagnostics[i],
                            auvid_nav_rows[i].kind == NAV_VELOCITY
                                ? auvid_nav_update_velocity(nav, i, t_us, value, valid)
                                : auvid_nav_update_position(nav, i, t_us, value));
}

auvid_status_t auvid_nav_dvl(auvid_nav_t *nav, const auvid_dvl_sample_t *sample)
{
    if (sample == NULL) {
        return AUVID_ERR_NULL;
    }
    bool water = sample->lock == AUVID_DVL_WATER, known = water || sample->lock == AUVID_DVL_BOTTOM;
    return auvid_nav_update(nav, water ? AUVID_NAV_DVL_WATER : AUVID_NAV_DVL_BOTTOM, sample->t_us,
                            sample->velocity, known ? sample->valid : AUVID_DVL_ALL + 1u);
}

auvid_status_t auvid_nav_depth(auvid_nav_t *nav, uint64_t t_us, auvid_real_t depth_m)
{
    return auvid_nav_update(nav, AUVID_NAV_DEPTH, t_us, &depth_m, 0);
}

auvid_status_t auvid_nav_pressure(auvid_nav_t *nav, uint64_t t_us, auvid_real_t pressure_pa)
{
    if (nav == NULL) {
        return AUVID_ERR_NULL;
    }
    return auvid_nav_depth(nav, t_us,
                           (pressure_pa - nav->cfg.surface_pressure) * nav->cfg.metres_per_pascal);
}

auvid_status_t auvid_nav_gps(auvid_nav_t *nav, uint64_t t_us, auvid_real_t x_m, auvid_real_t y_m)
{
    const auvid_real_t value[2] = {x_m, y_m};
    return auvid_nav_update(nav, AUVID_NAV_GPS, t_us, value, 0);
}
