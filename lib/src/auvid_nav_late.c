/*
 * Navigation filter, fourth part: samples of another time than the filter's. What a late one needs
 * of the past, and one that is ahead of the filter because the IMU is later still.
 */
#include <string.h>

#include "auvid_nav_private.h"

void auvid_nav_keep_rates(auvid_nav_t *nav, uint64_t dt_us)
{
    const uint32_t parts = AUVID_NAV_PAST - 1;
    uint32_t apart_us = (nav->max_age_us[AUVID_NAV_DVL_BOTTOM] + parts - 1u) / parts;
    auvid_nav_past_t *past = &nav->past[nav->past_newest % AUVID_NAV_PAST];
    if (dt_us > NAV_LARGEST_AGE_US) {
        nav->past_count = 0;
    }
    if (nav->past_count > 0 && (uint32_t)nav->t_us - past->t_us < apart_us) {
        return;
    }
    nav->past_newest = (uint8_t)((nav->past_newest + 1u) % AUVID_NAV_PAST);
    nav->past_count = (uint8_t)(nav->past_count + (nav->past_count < AUVID_NAV_PAST));
    past = &nav->past[nav->past_newest];
    past->t_us = (uint32_t)nav->t_us;
    memcpy(past->rates, nav->rates, sizeof past->rates);
}

void auvid_nav_past_rates(const auvid_nav_t *nav, uint32_t age_us, auvid_real_t w[3])
{
    const auvid_real_t *later = nav->rates;
    uint32_t later_us = 0;
    for (unsigned k = 0; k < nav->past_count && later_us < age_us; ++k) {
        const auvid_nav_past_t *past = &nav->past[(nav->past_newest - k) % AUVID_NAV_PAST];
        uint32_t past_us = (uint32_t)nav->t_us - past->t_us; /* old */
        if (past_us >= age_us) {
            auvid_real_t part =
                (auvid_real_t)(age_us - later_us) / (auvid_real_t)(past_us - later_us);
            for (int i = 0; i < 3; ++i) {
                w[i] = later[i] + part * (past->rates[i] - later[i]);
            }
            return;
        }
        later = past->rates;
        later_us = past_us;
    }
    memcpy(w, later, 3 * sizeof *w);
}

auvid_status_t auvid_nav_hold(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                              const auvid_real_t value[3], unsigned valid)
{
    uint64_t ahead_us = t_us - nav->t_us; /* huge, when it is older */
    bool ahead = ahead_us <= nav->max_age_us[sensor];
    auvid_nav_held_t *held = &nav->held[sensor];
    if (ahead && (nav->holding >> sensor & 1) != 0) {
        return AUVID_UNUSED;
    }
    if (ahead_us <= nav->future_us) {
        return AUVID_OK;
    }
    if (!ahead) {
        return AUVID_ERR_STALE;
    }
    nav->holding = (uint8_t)(nav->holding | 1u << sensor);
    held->t_us = t_us;
    memcpy(held->value, value, sizeof held->value);
    held->valid = (uint8_t)valid;
    return NAV_HELD;
}

void auvid_nav_release(auvid_nav_t *nav)
{
    for (uint8_t i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        const auvid_nav_held_t *held = &nav->held[i];
        auvid_status_t status;
        if ((nav->holding >> i & 1) == 0 || held->t_us > nav->t_us) {
            continue;
        }
        nav->holding = (uint8_t)(nav->holding & ~(1u << i));
        if (i == AUVID_NAV_DEPTH) {
            status = auvid_nav_depth(nav, held->t_us, held->value[0]);
        } else if (i == AUVID_NAV_GPS) {
            status = auvid_nav_gps(nav, held->t_us, held->value[0], held->value[1]);
        } else {
            auvid_dvl_sample_t s = {.t_us = held->t_us, .valid = held->valid};
            s.lock = i == AUVID_NAV_DVL_WATER ? AUVID_DVL_WATER : AUVID_DVL_BOTTOM;
            memcpy(s.velocity, held->value, sizeof s.velocity);
            status = auvid_nav_dvl(nav, &s);
        }
        if (status < 0 || status == AUVID_GATED) {
            nav->held_refused = (uint8_t)(nav->held_refused | 1u << i);
        }
    }
}
