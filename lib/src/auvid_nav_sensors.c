/*
 * Navigation filter, third part: the sensors. Each brings its sample into the form that the filter
 * takes (auvid_nav_private.h), or says why not, and counts it.
 */
#include <string.h>

#include "auvid_nav_private.h"

/* Refuse a sample out of its time, or fill in the time of *m. */
static auvid_status_t admit(const auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                            auvid_nav_measurement_t *m)
{
    const auvid_nav_diagnostics_t *d = &nav->diagnostics[sensor];
    bool ahead = t_us > nav->t_us;
    uint64_t apart = ahead ? t_us - nav->t_us : nav->t_us - t_us;
    if (apart > (ahead ? nav->future_us : nav->max_age_us[sensor])) {
        return AUVID_ERR_STALE;
    }
    if (d->axes > 0 && t_us <= d->seen_us) {
        return t_us < d->seen_us ? AUVID_ERR_TIME_BACK : AUVID_ERR_TIME_SAME;
    }
    m->t_us = t_us;
    m->sensor = sensor;
    m->age = ahead ? AUVID_C(0.0) : (auvid_real_t)(uint32_t)apart * AUVID_C(1e-6);
    m->clean = t_us >= nav->touched_us;
    return AUVID_OK;
}

static void raise_flag(auvid_nav_t *nav, unsigned flag)
{
    nav->flags = (uint16_t)(nav->flags | flag);
}

/* Raise the counter that goes with a status, and hand the status on. */
static auvid_status_t tally(auvid_nav_diagnostics_t *d, auvid_status_t status)
{
    switch (status) {
    case AUVID_UNUSED:
        nav_count(&d->unused);
        break;
    case AUVID_GATED:
        nav_count(&d->gated);
        break;
    case AUVID_ERR_NOT_FINITE:
        nav_count(&d->not_finite);
        break;
    case AUVID_ERR_RANGE:
        nav_count(&d->invalid);
        break;
    case AUVID_ERR_STALE:
    case AUVID_ERR_TIME_SAME:
    case AUVID_ERR_TIME_BACK:
        nav_count(&d->stale);
        break;
    default:
        d->accepted += d->accepted < UINT32_MAX ? 1u : 0u;
        break;
    }
    return status;
}

/* z in the body frame, what the lever arm adds removed: M v - omega x r; for a part of the axes the
 * directions h_j (columns of M) and v_j - h_j'(omega x r). */
static void to_body(const auvid_nav_t *nav, const auvid_real_t v[3], unsigned valid,
                    auvid_nav_measurement_t *m)
{
    const auvid_real_t *w = nav->rates, *r = nav->lever;
    const auvid_real_t turning[3] = {w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2],
                                     w[0] * r[1] - w[1] * r[0]};
    m->is_velocity = true;
    m->directed = valid != AUVID_DVL_ALL;
    if (!m->directed) {
        m->z[0] = nav_dot(nav->mount[0], v) - turning[0];
        m->z[1] = nav_dot(nav->mount[1], v) - turning[1];
        m->z[2] = nav_dot(nav->mount[2], v) - turning[2];
        m->n = 3;
        return;
    }
    m->n = 0;
    for (int j = 0; j < 3; ++j) {
        if ((valid >> j & 1) != 0) {
            for (int k = 0; k < 3; ++k) {
                m->h[m->n][k] = nav->mount[k][j];
            }
            m->z[m->n] = v[j] - nav_dot(m->h[m->n], turning);
            ++m->n;
        }
    }
}

static void tie_knot(auvid_nav_knot_t *knot, uint64_t t_us, const auvid_real_t velocity[3])
{
    knot->t_us = t_us;
    memcpy(knot->velocity, velocity, sizeof knot->velocity);
    ++knot->sequence;
}

static auvid_status_t update_dvl(auvid_nav_t *nav, const auvid_dvl_sample_t *sample, uint8_t sensor)
{
    unsigned valid = sample->valid;
    if (valid == 0) {
        return AUVID_UNUSED;
    }
    const auvid_real_t v[3] = {(valid & AUVID_DVL_X) != 0 ? sample->velocity[0] : AUVID_C(0.0),
                               (valid & AUVID_DVL_Y) != 0 ? sample->velocity[1] : AUVID_C(0.0),
                               (valid & AUVID_DVL_Z) != 0 ? sample->velocity[2] : AUVID_C(0.0)};
    auvid_nav_measurement_t m;
    auvid_status_t status = nav_within(v, nav->speed_limit);
    if (status == AUVID_OK) {
        status = admit(nav, sensor, sample->t_us, &m);
    }
    if (status != AUVID_OK) {
        return status;
    }
    to_body(nav, v, valid, &m);
    bool water = sensor == AUVID_NAV_DVL_WATER;
    bool apart = water && nav_fresh(nav, AUVID_NAV_DVL_BOTTOM);
    status = auvid_nav_pass(nav, &m);
    if (status != AUVID_OK) {
        return status;
    }
    if (water && !m.directed) {
        tie_knot(&nav->water, m.t_us, m.z);
    }
    if (apart) {
        return AUVID_UNUSED;
    }
    auvid_nav_enter(nav, &m);
    nav->flags = (uint16_t)(nav->flags & ~AUVID_NAV_WATER_AIDED);
    raise_flag(nav, AUVID_NAV_VELOCITY_KNOWN | (water ? AUVID_NAV_WATER_AIDED : 0u));
    if (!water) {
        tie_knot(&nav->ground, m.t_us, nav->velocity);
    }
    return AUVID_OK;
}

auvid_status_t auvid_nav_dvl(auvid_nav_t *nav, const auvid_dvl_sample_t *sample)
{
    if (nav == NULL || sample == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->ready != NAV_RUNNING) {
        return AUVID_ERR_STATE;
    }
    uint8_t sensor = sample->lock == AUVID_DVL_WATER ? AUVID_NAV_DVL_WATER : AUVID_NAV_DVL_BOTTOM;
    if ((sample->lock != AUVID_DVL_WATER && sample->lock != AUVID_DVL_BOTTOM) ||
        sample->valid > AUVID_DVL_ALL) {
        return tally(&nav->diagnostics[sensor], AUVID_ERR_RANGE);
    }
    return tally(&nav->diagnostics[sensor], update_dvl(nav, sample, sensor));
}

static auvid_status_t check_position(const auvid_real_t *x, int n)
{
    for (int i = 0; i < n; ++i) {
        if (!(x[i] >= -NAV_LARGEST_POSITION && x[i] <= NAV_LARGEST_POSITION)) {
            return auvid_is_finite(x[i]) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
        }
    }
    return AUVID_OK;
}

static auvid_status_t update_depth(auvid_nav_t *nav, uint64_t t_us, auvid_real_t depth_m)
{
    auvid_nav_measurement_t m;
    auvid_status_t status = check_position(&depth_m, 1);
    if (status == AUVID_OK) {
        status = admit(nav, AUVID_NAV_DEPTH, t_us, &m);
    }
    if (status != AUVID_OK) {
        return status;
    }
    m.is_velocity = false;
    m.first = 2;
    m.n = 1;
    m.z[0] = depth_m;
    if ((nav->flags & AUVID_NAV_DEPTH_KNOWN) == 0) {
        (void)auvid_nav_look(nav, &m);
        nav_note_good(&nav->diagnostics[AUVID_NAV_DEPTH], t_us);
        auvid_nav_restart(nav, 2, nav->diagnostics[AUVID_NAV_DEPTH].innovation[0],
                          nav->r[AUVID_NAV_DEPTH]);
        raise_flag(nav, AUVID_NAV_DEPTH_KNOWN);
        return AUVID_OK;
    }
    status = auvid_nav_pass(nav, &m);
    if (status == AUVID_OK) {
        auvid_nav_enter(nav, &m);
    }
    return status;
}

auvid_status_t auvid_nav_depth(auvid_nav_t *nav, uint64_t t_us, auvid_real_t depth_m)
{
    if (nav == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->ready != NAV_RUNNING) {
        return AUVID_ERR_STATE;
    }
    return tally(&nav->diagnostics[AUVID_NAV_DEPTH], update_depth(nav, t_us, depth_m));
}

auvid_status_t auvid_nav_pressure(auvid_nav_t *nav, uint64_t t_us, auvid_real_t pressure_pa)
{
    if (nav == NULL) {
        return AUVID_ERR_NULL;
    }
    return auvid_nav_depth(nav, t_us,
                           (pressure_pa - nav->surface_pressure) * nav->metres_per_pascal);
}

/* Keep a fix for the start, as its distance from the filter's position; each axis stays sorted.
 * With the last one the position starts from the medians. */
static auvid_status_t collect_fix(auvid_nav_t *nav, const auvid_nav_diagnostics_t *d)
{
    for (int j = 0; j < 2; ++j) {
        auvid_real_t *sorted = nav->gps_offset[j];
        int i = nav->gps_count;
        for (; i > 0 && sorted[i - 1] > d->innovation[j]; --i) {
            sorted[i] = sorted[i - 1];
        }
        sorted[i] = d->innovation[j];
    }
    if (++nav->gps_count < nav->gps_start) {
        return AUVID_PENDING;
    }
    for (int j = 0; j < 2; ++j) {
        const auvid_real_t *sorted = nav->gps_offset[j];
        int low = (nav->gps_start - 1) / 2, high = nav->gps_start / 2;
        auvid_real_t median = AUVID_C(0.5) * (sorted[low] + sorted[high]);
        auvid_nav_restart(nav, j, median, nav->r[AUVID_NAV_GPS]);
    }
    nav->gps_start = 0;
    raise_flag(nav, AUVID_NAV_POSITION_KNOWN);
    return AUVID_OK;
}

static auvid_status_t update_gps(auvid_nav_t *nav, uint64_t t_us, auvid_real_t x_m,
                                 auvid_real_t y_m)
{
    auvid_nav_measurement_t m;
    m.z[0] = x_m;
    m.z[1] = y_m;
    auvid_status_t status = check_position(m.z, 2);
    if (status == AUVID_OK) {
        status = admit(nav, AUVID_NAV_GPS, t_us, &m);
    }
    if (status != AUVID_OK) {
        return status;
    }
    if (nav->position[2] + nav->residue[2] > nav->surface_depth) {
        return AUVID_UNUSED;
    }
    m.is_velocity = false;
    m.first = 0;
    m.n = 2;
    if (nav->gps_start > 0) {
        auvid_nav_diagnostics_t *d = &nav->diagnostics[AUVID_NAV_GPS];
        (void)auvid_nav_look(nav, &m);
        nav_note_good(d, t_us);
        return collect_fix(nav, d);
    }
    status = auvid_nav_pass(nav, &m);
    if (status == AUVID_OK) {
        auvid_nav_enter(nav, &m);
        raise_flag(nav, AUVID_NAV_POSITION_KNOWN);
    }
    return status;
}

auvid_status_t auvid_nav_gps(auvid_nav_t *nav, uint64_t t_us, auvid_real_t x_m, auvid_real_t y_m)
{
    if (nav == NULL) {
        return AUVID_ERR_NULL;
    }
    if (nav->ready != NAV_RUNNING) {
        return AUVID_ERR_STATE;
    }
    return tally(&nav->diagnostics[AUVID_NAV_GPS], update_gps(nav, t_us, x_m, y_m));
}
