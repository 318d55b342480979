/**
 * @file auvid_nav_internal.h
 * Private: what the parts of the navigation filter share.
 */
#ifndef AUVID_NAV_INTERNAL_H
#define AUVID_NAV_INTERNAL_H

#include "auvid/nav.h"
#include "../base/auvid_math_internal.h"

/* auvid_nav_t.ready */
enum { NAV_BLANK, NAV_READY, NAV_RUNNING };

/* Largest values that are taken for a measurement or a setting. */
#define NAV_LARGEST_POSITION AUVID_C(1e5)
#define NAV_LARGEST_SPEED AUVID_C(100.0)
#define NAV_LARGEST_AGE_US 2000000u

/* Where element (i, j) of a symmetric block stands in its six numbers. */
static const uint8_t nav_packed[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

/** Raise a counter that stops at its largest value. */
static inline void nav_increment(uint16_t *counter)
{
    *counter = (uint16_t)(*counter + (*counter < UINT16_MAX));
}

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

/** AUVID_OK when the length of x is at most `limit`, else AUVID_ERR_NOT_FINITE or
 * AUVID_ERR_RANGE. */
AUVID_INLINE auvid_status_t nav_within(const auvid_real_t x[3], auvid_real_t limit)
{
    if (nav_dot(x, x) <= limit * limit) {
        return AUVID_OK;
    }
    return auvid_all_finite(x, 3) ? AUVID_ERR_RANGE : AUVID_ERR_NOT_FINITE;
}

/** Has a sample of this sensor passed the gate within stale_us? */
static inline bool nav_is_fresh(const auvid_nav_t *nav, int sensor)
{
    const auvid_nav_diagnostics_t *d = &nav->diagnostics[sensor];
    return d->has_sample && (nav->t_us < d->good_us || nav->t_us - d->good_us <= nav->stale_us);
}

/** Move position along an axis; what position cannot hold goes to residue (Dekker's fast two-sum,
 * exact while |position| >= |step|; else the loss is a rounding of step, once). */
AUVID_INLINE void nav_move_position(auvid_nav_t *nav, int axis, auvid_real_t step)
{
    auvid_real_t d = nav->position_lo[axis] + step;
    auvid_real_t sum = nav->position[axis] + d;
    nav->position_lo[axis] = d - (sum - nav->position[axis]);
    nav->position[axis] = sum;
}

/* One sample on its way into the filter. */
typedef struct {
    uint64_t t_us;
    uint8_t sensor;
    uint8_t n;        /* scalars */
    uint8_t first;    /* position: axis of the first */
    bool is_velocity; /* else position */
    bool directed;    /* velocity along the rows of h, else along the body's axes */
    uint8_t outside;  /* bit j: scalar j is outside the gate and enters all the same */
    auvid_real_t age; /* [s] */
    auvid_real_t z[3];
    auvid_real_t h[3][3];
} auvid_nav_measurement_t;

/* One update may shrink a variance to this part of itself, no further: what is left of P - K c'
 * must stay well above the rounding of P. It acts as a larger R. */
#define NAV_MIN_VARIANCE_RATIO (AUVID_C(16.0) * AUVID_EPSILON)

/* S, of what H P H' is once the noise since is out of it. */
AUVID_INLINE auvid_real_t nav_variance(const auvid_nav_t *nav, const auvid_nav_measurement_t *m,
                                       auvid_real_t hph)
{
    auvid_real_t r = nav->r[m->sensor], min_r = NAV_MIN_VARIANCE_RATIO * hph;
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
AUVID_INLINE void nav_subtract(auvid_real_t p[6], const auvid_real_t k[3], const auvid_real_t c[3])
{
    p[0] -= k[0] * c[0];
    p[1] -= k[0] * c[1];
    p[2] -= k[0] * c[2];
    p[3] -= k[1] * c[1];
    p[4] -= k[1] * c[2];
    p[5] -= k[2] * c[2];
}

/* Eq. 6 for one scalar of variance s and covariance c with the state; returns nu^2 / s. Position is
 * moved through its residue, which the next prediction carries over. */
AUVID_INLINE auvid_real_t nav_apply(auvid_nav_t *nav, const auvid_real_t c[6], auvid_real_t s,
                                    auvid_real_t nu)
{
    auvid_real_t inverse = AUVID_C(1.0) / s;
    const auvid_real_t k[6] = {c[0] * inverse, c[1] * inverse, c[2] * inverse,
                               c[3] * inverse, c[4] * inverse, c[5] * inverse};
    nav_subtract(nav->pp, k, c);
    nav_subtract(nav->vv, k + 3, c + 3);
    nav_add(nav->pv[0], -k[0], c + 3);
    nav_add(nav->pv[1], -k[1], c + 3);
    nav_add(nav->pv[2], -k[2], c + 3);
    nav_add(nav->position_lo, nu, k);
    nav_add(nav->velocity, nu, k + 3);
    return nu * nu * inverse;
}

/** The sample of t_us has passed. */
static inline void nav_record_accepted(auvid_nav_diagnostics_t *d, uint64_t t_us)
{
    d->good_us = t_us;
    d->has_sample = true;
    d->consecutive_rejections = 0;
}

/** Write the innovations of *m and their variances down in the sensor's diagnostics; returns a bit
 * for each that is outside the gate. */
uint8_t auvid_nav_look(auvid_nav_t *nav, const auvid_nav_measurement_t *m);

/** auvid_nav_look(), the gate, and the way out of it: AUVID_OK or AUVID_GATED. */
auvid_status_t auvid_nav_pass(auvid_nav_t *nav, auvid_nav_measurement_t *m);

/** Eq. 6 for a sample that auvid_nav_pass() let in, one scalar after the other. */
void auvid_nav_enter(auvid_nav_t *nav, const auvid_nav_measurement_t *m);

/** Keep the tick's rates, unless some were kept a short while ago. Past a step of dt_us in which no
 * late sample can lie, those from before are dropped (their times are half times, too). */
void auvid_nav_keep_rates(auvid_nav_t *nav, uint64_t dt_us);

/** Rates at the time of a late sample: straight between those kept, the oldest before all. */
void auvid_nav_past_rates(const auvid_nav_t *nav, uint32_t age_us, auvid_real_t w[3]);

/** A sample that is held: for callers AUVID_PENDING. */
#define NAV_HELD AUVID_EMPTY

/** What becomes of a sample that is not 0..max_age old: NAV_HELD, AUVID_UNUSED, AUVID_ERR_STALE;
 * AUVID_OK: use it as if it were of the last tick. */
auvid_status_t auvid_nav_hold(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                              const auvid_real_t value[3], unsigned valid);

/** Take a sample of any sensor: `value` as given, `valid` of a DVL's. Status as of auvid_nav_dvl()
 * and its like, which have checked what is theirs. */
auvid_status_t auvid_nav_update(auvid_nav_t *nav, uint8_t sensor, uint64_t t_us,
                                const auvid_real_t value[3], unsigned valid);

/** Let the held samples in whose time has come. */
void auvid_nav_release(auvid_nav_t *nav);

/** Move one axis of the position by `step` and give it a variance, whatever was known of it. */
void auvid_nav_restart(auvid_nav_t *nav, int axis, auvid_real_t step, auvid_real_t variance);

#endif
