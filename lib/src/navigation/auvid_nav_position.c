/*
 * Navigation filter, sixth part: the update with axes of the position. A depth at the filter's time
 * takes a fast path.
 */
#include "auvid_nav_internal.h"

/* Apply a depth at the filter's time. Return false, with the filter unchanged, if it does not pass
 * the gate. */
static bool nav_apply_depth(auvid_nav_t *nav, const auvid_nav_measurement_t *m)
{
    auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    const auvid_real_t c[6] = {nav->ekf.pp[2],    nav->ekf.pp[4],    nav->ekf.pp[5],
                               nav->ekf.pv[2][0], nav->ekf.pv[2][1], nav->ekf.pv[2][2]};
    auvid_real_t s = nav_variance(nav, m, c[2]);
    auvid_real_t nu = (m->z[0] - nav->ekf.position[2]) - nav->ekf.position_lo[2];
    if (!nav_within_gate(nav, d, 0, nu, s)) {
        return false;
    }
    d->nis = nav_apply(nav, c, s, nu);
    return true;
}

static auvid_status_t nav_check_position(const auvid_real_t *x, int n)
{
    for (int i = 0; i < n; ++i) {
        if (!(x[i] >= -NAV_LARGEST_POSITION && x[i] <= NAV_LARGEST_POSITION)) {
            return auvid_is_finite(x[i]) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
        }
    }
    return AUVID_OK;
}

/* Store a fix for the start as its difference from the filter's position, each axis sorted. The
 * last fix initialises the position with the medians. */
static auvid_status_t nav_collect_fix(auvid_nav_t *nav, const auvid_nav_measurement_t *m)
{
    const auvid_nav_diagnostics_t *d = &nav->diagnostics[m->sensor];
    for (int j = 0; j < 2; ++j) {
        auvid_real_t *sorted = nav->gps.offset[j];
        int i = nav->gps.count;
        for (; i > 0 && sorted[i - 1] > d->innovation[j]; --i) {
            sorted[i] = sorted[i - 1];
        }
        sorted[i] = d->innovation[j];
    }
    if (++nav->gps.count < nav->gps.start) {
        return AUVID_PENDING;
    }
    for (int j = 0; j < 2; ++j) {
        const auvid_real_t *sorted = nav->gps.offset[j];
        int low = (nav->gps.start - 1) / 2, high = nav->gps.start / 2;
        auvid_real_t median = AUVID_C(0.5) * (sorted[low] + sorted[high]);
        auvid_nav_restart_position(nav, j, median, nav->cfg.r[m->sensor]);
    }
    nav->gps.start = 0;
    return AUVID_OK;
}

/* Return the flags of auvid_nav_t that a sample of `axes` axes from `axis` on sets. */
static unsigned nav_known_flags(int axis, int axes)
{
    return (axis < 2 ? (unsigned)AUVID_NAV_POSITION_KNOWN : 0u) |
           (axis + axes > 2 ? (unsigned)AUVID_NAV_DEPTH_KNOWN : 0u);
}

/* Initialise the axes that are not known yet. */
static auvid_status_t nav_start_axes(auvid_nav_t *nav, const auvid_nav_measurement_t *m)
{
    for (int j = 0; j < m->n; ++j) {
        if ((nav->flags & nav_known_flags(m->first + j, 1)) == 0) {
            auvid_nav_restart_position(nav, m->first + j, nav->diagnostics[m->sensor].innovation[j],
                                       nav->cfg.r[m->sensor]);
        }
    }
    return AUVID_OK;
}

auvid_status_t auvid_nav_update_position(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                                         const auvid_real_t *value)
{
    const auvid_nav_row_t *row = &auvid_nav_rows[sensor];
    auvid_nav_measurement_t m;
    auvid_status_t status = nav_check_position(value, row->axes);
    if (status == AUVID_OK) {
        status = auvid_nav_check_time(nav, sensor, t_us, value, 0, &m);
    }
    if (status != AUVID_OK) {
        return status;
    }
    if (row->surface_only && (nav->flags & AUVID_NAV_DEPTH_KNOWN) != 0 &&
        nav->ekf.position[2] + nav->ekf.position_lo[2] > nav->cfg.surface_depth) {
        return AUVID_UNUSED;
    }
    m.is_velocity = false;
    m.first = row->axis;
    m.n = row->axes;
    for (int j = 0; j < m.n; ++j) {
        m.z[j] = value[j];
    }
    unsigned flags = nav_known_flags(m.first, m.n);
    bool median = row->start == NAV_START_MEDIAN && nav->gps.start > 0;
    if (median || (row->start == NAV_START_FIRST && (nav->flags & flags) != flags)) {
        (void)auvid_nav_innovations(nav, &m);
        nav_record_accepted(&nav->diagnostics[sensor], t_us);
        status = median ? nav_collect_fix(nav, &m) : nav_start_axes(nav, &m);
    } else {
        bool fast = m.first == 2 && !(m.age > AUVID_C(0.0));
        status = auvid_nav_apply_sample(nav, &m, false, fast && nav_apply_depth(nav, &m));
    }
    if (status == AUVID_OK) {
        nav_set_flag(nav, flags);
    }
    return status;
}
