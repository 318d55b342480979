/*
 * Navigation filter, fourth part: samples whose time differs from the filter's. It stores past
 * rates for late samples, and holds samples ahead of the filter while the IMU is later than the
 * sensor.
 */
#include <string.h>

#include "auvid_nav_internal.h"

void auvid_nav_store_rates(auvid_nav_t *nav, uint64_t dt_us)
{
    const uint32_t intervals = AUVID_NAV_PAST - 1;
    uint32_t interval_us = (nav->cfg.max_age_us[AUVID_NAV_DVL_BOTTOM] + intervals - 1u) / intervals;
    uint32_t next = dt_us > NAV_LARGEST_AGE_US ? 0u : nav->imu.past_next,
             now_us = (uint32_t)nav->imu.t_us;
    if (next == 0 || now_us - nav->imu.past_us[(next - 1u) % AUVID_NAV_PAST] >= interval_us) {
        nav->imu.past_us[next % AUVID_NAV_PAST] = now_us;
        memcpy(nav->imu.past_rates[next % AUVID_NAV_PAST], nav->imu.rates, sizeof nav->imu.rates);
        next = next + 1u < 2 * AUVID_NAV_PAST ? next + 1u : AUVID_NAV_PAST;
    }
    nav->imu.past_next = (uint8_t)next;
}

void auvid_nav_rates_at(const auvid_nav_t *nav, uint32_t age_us, auvid_real_t w[3])
{
    const auvid_real_t *later = nav->imu.rates, *past = later;
    auvid_real_t fraction = AUVID_C(0.0);
    uint32_t later_us = 0, next = nav->imu.past_next; /* later_us: age of `later` */
    uint32_t oldest = next < AUVID_NAV_PAST ? 0u : next - AUVID_NAV_PAST;
    while (next > oldest) {
        --next;
        uint32_t past_us = (uint32_t)nav->imu.t_us - nav->imu.past_us[next % AUVID_NAV_PAST];
        past = nav->imu.past_rates[next % AUVID_NAV_PAST];
        if (past_us >= age_us) {
            fraction = (auvid_real_t)(past_us - age_us) / (auvid_real_t)(past_us - later_us);
            break;
        }
        later = past;
        later_us = past_us;
    }
    for (int i = 0; i < 3; ++i) {
        w[i] = past[i] + fraction * (later[i] - past[i]);
    }
}

/* Hold, accept or reject a sample whose age is outside 0..max_age. Return NAV_HELD, AUVID_UNUSED,
 * AUVID_ERR_STALE, or AUVID_OK if it is to be used as if it were of the last tick. */
static auvid_status_t nav_hold(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                               const auvid_real_t *value, unsigned valid)
{
    uint64_t ahead_us = t_us - nav->imu.t_us; /* huge if it is older */
    bool beyond = nav->held.until_us != 0 && t_us > nav->held.until_us;
    if (ahead_us > nav->cfg.future_us && (beyond || ahead_us > nav->cfg.max_age_us[sensor])) {
        return AUVID_ERR_STALE;
    }
    if ((nav->held.sensors >> sensor & 1) != 0) {
        return AUVID_UNUSED;
    }
    if (ahead_us <= nav->cfg.future_us) {
        return AUVID_OK;
    }
    nav->held.sensors = (uint8_t)(nav->held.sensors | 1u << sensor);
    nav->held.t_us[sensor] = t_us;
    nav->held.valid[sensor] = (uint8_t)valid;
    memcpy(nav->held.value[sensor], value, auvid_nav_rows[sensor].axes * sizeof value[0]);
    return NAV_HELD;
}

auvid_status_t auvid_nav_check_time(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                                    const auvid_real_t *value, unsigned valid,
                                    auvid_nav_measurement_t *m)
{
    const auvid_nav_diagnostics_t *d = &nav->diagnostics[sensor];
    uint64_t age_us = nav->imu.t_us - t_us; /* huge if it is ahead */
    if (age_us > nav->cfg.max_age_us[sensor]) {
        auvid_status_t status = nav_hold(nav, sensor, t_us, value, valid);
        if (status != AUVID_OK) {
            return status;
        }
        age_us = 0;
    }
    if (d->innovation_count > 0 && t_us <= d->seen_us) {
        return t_us < d->seen_us ? AUVID_ERR_TIME_BACK : AUVID_ERR_TIME_SAME;
    }
    m->t_us = t_us;
    m->sensor = sensor;
    m->age = (auvid_real_t)(uint32_t)age_us * AUVID_C(1e-6);
    return AUVID_OK;
}
