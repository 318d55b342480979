/**
 * @file auvid_nav_internal.h
 * Private: common types and functions of the navigation filter.
 */
#ifndef AUVID_NAV_INTERNAL_H
#define AUVID_NAV_INTERNAL_H

#include "auvid/nav.h"
#include "../base/auvid_math_internal.h"
#include "auvid_sensors_internal.h"

/* auvid_nav_ticks_t.ready */
enum { NAV_BLANK, NAV_READY, NAV_RUNNING };

/* Largest accepted values of a measurement or a setting. */
#define NAV_LARGEST_POSITION AUVID_C(1e5)
#define NAV_LARGEST_SPEED AUVID_C(100.0)
#define NAV_LARGEST_AGE_US 2000000u

/* Index of element (i, j) of a symmetric block in its six numbers. */
static const uint8_t nav_packed[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

_Static_assert(1 << (AUVID_NAV_SENSOR_COUNT - 1) <= UINT8_MAX, "auvid_nav_held_t.sensors");
_Static_assert(AUVID_NAV_FLAG_END - 1 <= UINT16_MAX, "auvid_nav_t.flags");

/** auvid_nav_init, with *why instead of a status: nothing happens if it is refused. */
void auvid_nav_set_up(auvid_nav_t *nav, const auvid_nav_config_t *cfg, auvid_refusal_t *why);

/** auvid_nav_state() but for the flags, which are left as they are. @return whether there is one */
bool auvid_nav_pose(const auvid_nav_t *nav, auvid_nav_state_t *state);

/** Increment a counter that saturates. */
void auvid_nav_increment(uint16_t *counter);

AUVID_INLINE auvid_real_t nav_dot(const auvid_real_t a[3], const auvid_real_t b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* y += a x */
AUVID_INLINE void nav_add(auvid_real_t y[3], auvid_real_t a, const auvid_real_t x[3])
{
    y[0] += a * x[0];
    y[1] += a * x[1];
    y[2] += a * x[2];
}

/** Return AUVID_OK if the length of x is at most `limit`, else AUVID_ERR_NOT_FINITE or
 * AUVID_ERR_RANGE. */
AUVID_INLINE auvid_status_t nav_within(const auvid_real_t x[3], auvid_real_t limit)
{
    if (nav_dot(x, x) <= limit * limit) {
        return AUVID_OK;
    }
    return auvid_all_finite(x, 3) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
}

/** Return whether a sample of this sensor was accepted within stale_us. */
static inline bool nav_is_fresh(const auvid_nav_t *nav, int sensor)
{
    const auvid_nav_diagnostics_t *d = &nav->diagnostics[sensor];
    return d->has_sample &&
           (nav->imu.t_us < d->good_us || nav->imu.t_us - d->good_us <= nav->cfg.stale_us);
}

/** Add a step to one axis of the position. The rounding error goes to position_lo: Dekker's fast
 * two-sum, exact while |position| >= |step|; otherwise the loss is one rounding of step. */
AUVID_INLINE void nav_move_position(auvid_nav_t *nav, int axis, auvid_real_t step)
{
    auvid_real_t d = nav->ekf.position_lo[axis] + step;
    auvid_real_t sum = nav->ekf.position[axis] + d;
    nav->ekf.position_lo[axis] = d - (sum - nav->ekf.position[axis]);
    nav->ekf.position[axis] = sum;
}

/* Kinds and starts of auvid_sensors_internal.h. */
enum { NAV_VELOCITY, NAV_POSITION };
enum { NAV_START_UPDATE, NAV_START_FIRST, NAV_START_MEDIAN };

/** A sensor: see auvid_sensors_internal.h. */
typedef struct {
    uint16_t sigma, max_age; /* offsets in auvid_nav_config_t */
    uint16_t noise_mm;
    uint8_t kind, axis, axes, surface_only, start;
} auvid_nav_row_t;

/** By auvid_nav_sensor_t. */
extern const auvid_nav_row_t auvid_nav_rows[AUVID_NAV_SENSOR_COUNT];

/* A sample in the form of the filter. */
typedef struct {
    uint64_t t_us;
    uint8_t sensor;
    uint8_t n;        /* scalars */
    uint8_t first;    /* position: axis of the first scalar */
    bool is_velocity; /* else position */
    bool directed;    /* velocity along the rows of h, else along the body axes */
    uint8_t outside;  /* bit j: scalar j is outside the gate, yet is applied */
    auvid_real_t age; /* [s] */
    auvid_real_t z[3];
    auvid_real_t h[3][3];
} auvid_nav_measurement_t;

/* Smallest factor by which one update may reduce a variance: P - K c' must stay well above the
 * rounding errors of P. The limit acts as a larger R. */
#define NAV_MIN_VARIANCE_RATIO (AUVID_C(16.0) * AUVID_EPSILON)

/* Return S. hph: H P H' without the process noise since the sample. */
AUVID_INLINE auvid_real_t nav_variance(const auvid_nav_t *nav, const auvid_nav_measurement_t *m,
                                       auvid_real_t hph)
{
    auvid_real_t r = nav->cfg.r[m->sensor], min_r = NAV_MIN_VARIANCE_RATIO * hph;
    return hph + (r > min_r ? r : min_r);
}

/* y = s x, s a symmetric block */
AUVID_INLINE void nav_times(const auvid_real_t s[6], const auvid_real_t x[3], auvid_real_t y[3])
{
    y[0] = s[0] * x[0] + s[1] * x[1] + s[2] * x[2];
    y[1] = s[1] * x[0] + s[3] * x[1] + s[4] * x[2];
    y[2] = s[2] * x[0] + s[4] * x[1] + s[5] * x[2];
}

/* P -= k c' of a symmetric block */
AUVID_SHARED void auvid_nav_subtract(auvid_real_t *p, const auvid_real_t *k, const auvid_real_t *c)
{
    p[0] -= k[0] * c[0];
    p[1] -= k[0] * c[1];
    p[2] -= k[0] * c[2];
    p[3] -= k[1] * c[1];
    p[4] -= k[1] * c[2];
    p[5] -= k[2] * c[2];
}

/* Apply Eq. 6 for one scalar of variance s and covariance c with the state; return nu^2 / s. The
 * position correction goes to position_lo, which the next prediction adds to position. */
AUVID_INLINE auvid_real_t nav_apply(auvid_nav_t *nav, const auvid_real_t c[6], auvid_real_t s,
                                    auvid_real_t nu)
{
    auvid_real_t inverse = AUVID_C(1.0) / s;
    const auvid_real_t k[6] = {c[0] * inverse, c[1] * inverse, c[2] * inverse,
                               c[3] * inverse, c[4] * inverse, c[5] * inverse};
    auvid_nav_subtract(nav->ekf.pp, k, c);
    auvid_nav_subtract(nav->ekf.vv, k + 3, c + 3);
    nav_add(nav->ekf.pv[0], -k[0], c + 3);
    nav_add(nav->ekf.pv[1], -k[1], c + 3);
    nav_add(nav->ekf.pv[2], -k[2], c + 3);
    nav_add(nav->ekf.position_lo, nu, k);
    nav_add(nav->ekf.velocity, nu, k + 3);
    return nu * nu * inverse;
}

/** Record that the sample of t_us is accepted. */
static inline void nav_record_accepted(auvid_nav_diagnostics_t *d, uint64_t t_us)
{
    d->good_us = t_us;
    d->has_sample = true;
    d->consecutive_rejections = 0;
}

/** Store the innovations of *m and their variances in the diagnostics of the sensor; return a bit
 * for each one outside the gate. */
uint8_t auvid_nav_innovations(auvid_nav_t *nav, const auvid_nav_measurement_t *m);

/** Store the rates of the tick, unless the last stored ones are recent. After a step of dt_us
 * longer than any late sample's age, discard the earlier ones (only the lower halves of their times
 * are stored). */
void auvid_nav_store_rates(auvid_nav_t *nav, uint64_t dt_us);

/** Interpolate the stored rates linearly at the time of a late sample. Before all of them use the
 * oldest. */
void auvid_nav_rates_at(const auvid_nav_t *nav, uint32_t age_us, auvid_real_t w[3]);

/** Internal status of a held sample; the public functions return AUVID_PENDING. */
#define NAV_HELD AUVID_EMPTY

/** Re-initialise one axis of the position: add `step`, set its variance, clear its correlations. */
void auvid_nav_restart_position(auvid_nav_t *nav, int axis, auvid_real_t step,
                                auvid_real_t variance);

/** Reject a sample outside the accepted time window, hold one ahead of the filter, or set sensor
 * and time of *m. Return AUVID_OK; NAV_HELD; AUVID_UNUSED; AUVID_ERR_STALE; AUVID_ERR_TIME_SAME;
 * AUVID_ERR_TIME_BACK. */
auvid_status_t auvid_nav_check_time(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                                    const auvid_real_t *value, unsigned valid,
                                    auvid_nav_measurement_t *m);

/** Test the gate, with re-initialisation after repeated rejections. Then apply the sample, unless
 * `hold_back`. @param applied a fast path has done both @return AUVID_OK or AUVID_GATED */
auvid_status_t auvid_nav_apply_sample(auvid_nav_t *nav, auvid_nav_measurement_t *m, bool hold_back,
                                      bool applied);

static inline void nav_set_flag(auvid_nav_t *nav, unsigned flag)
{
    nav->flags = (uint16_t)(nav->flags | flag);
}

/* Store innovation j; return whether it is within the gate. */
AUVID_INLINE bool nav_within_gate(auvid_nav_t *nav, auvid_nav_diagnostics_t *d, int j,
                                  auvid_real_t nu, auvid_real_t s)
{
    d->innovation[j] = nu;
    d->variance[j] = s;
    return nu * nu <= nav->cfg.gate * s;
}

/** Apply a DVL sample: `v` along the instrument's axes, those of `valid`. Return the statuses of
 * auvid_nav_dvl(). */
auvid_status_t auvid_nav_update_velocity(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                                         const auvid_real_t *v, unsigned valid);

/** Apply a sample of the position: the sensor's axes. Return the statuses of auvid_nav_update(). */
auvid_status_t auvid_nav_update_position(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                                         const auvid_real_t *value);

#endif
