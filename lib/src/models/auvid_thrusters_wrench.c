/*
 * Thrusters: a candidate's mean forces from the log, T x' = g(c) - x (Fossen 2011, 12.1).
 *
 * Over a slot of length h, c is constant and the solution is exact. With a = h / T:
 *
 *     x(h) = g + (x(0) - g) e^-a,      mean of x = g + (x(0) - g) (1 - e^-a) / a
 *
 * The mean of x over a row has the same weights as the motion. Moments belong to rates of the IMU,
 * with equal weights over the row. Forces belong to velocity that is interpolated between samples T
 * apart, a triangular kernel of variance T^2 / 6 (auvid_metric.c). Here a rectangle of the same
 * variance, of length s = sqrt(2) T, replaces the triangle. Its convolution with the row's
 * rectangle of length r is a trapezoid. The integral of the trapezoid from the row's beginning to t
 * is
 *
 *     (P(t) - P(t - r)) / r,   P(t) = 0 | (t + s/2)^2 / (2 s) | t   before, within, after +-s/2.
 */
#include "auvid/thrusters.h"

#include <string.h>

#include "../base/auvid_math_internal.h"
#include "auvid_thrusters_wrench_internal.h"

/* e^-x for x >= 0. Halvings give x <= 1/8, where the seventh term of Taylor's series is below
 * 1e-10; squarings undo them. */
static auvid_real_t thrusters_exponential(auvid_real_t x)
{
    int halvings = 0;
    if (!(x < AUVID_C(80.0))) {
        return AUVID_C(0.0);
    }
    while (x > AUVID_C(0.125)) {
        x *= AUVID_C(0.5);
        ++halvings;
    }
    auvid_real_t e = AUVID_C(1.0);
    for (int k = 6; k > 0; --k) {
        e = AUVID_C(1.0) - e * x / (auvid_real_t)k;
    }
    for (; halvings > 0; --halvings) {
        e *= e;
    }
    return e;
}

/* A group's parameters for one candidate. Commands are in steps of the log. */
typedef struct {
    auvid_real_t gain[2]; /* forward, backward [N per step] */
    auvid_real_t dead_band;
    int32_t whole_band; /* dead_band rounded down: a larger command exceeds it */
    auvid_real_t decay; /* e^-a */
    auvid_real_t mean;  /* (1 - e^-a) / a */
} group_t;

/* Converts the parameters pi of a group. */
static void thrusters_candidate_group(const auvid_thrusters_t *th, const auvid_real_t *pi,
                                      group_t *group)
{
    auvid_real_t step = th->cfg.command_max / AUVID_C(32767.0);
    auvid_real_t lag =
        auvid_max(pi[AUVID_THRUSTERS_LAG] * AUVID_C(1e6) / (auvid_real_t)th->cfg.period_us,
                  AUVID_C(0.0)); /* slots */
    group->gain[0] = pi[AUVID_THRUSTERS_FORWARD] * step;
    group->gain[1] = pi[AUVID_THRUSTERS_BACKWARD] * step;
    auvid_real_t dead_band = auvid_max(pi[AUVID_THRUSTERS_DEAD_BAND] / step, AUVID_C(0.0));
    group->dead_band = auvid_min(dead_band, AUVID_C(32768.0));
    group->whole_band = (int32_t)group->dead_band;
    group->decay = thrusters_exponential(AUVID_C(1.0) / lag);
    group->mean = (AUVID_C(1.0) - group->decay) * lag;
}

/* g(c) */
AUVID_INLINE auvid_real_t thrusters_static_force(const group_t *group, int32_t c)
{
    if (c > group->whole_band) {
        return group->gain[0] * ((auvid_real_t)c - group->dead_band);
    }
    if (c < -group->whole_band) {
        return group->gain[1] * ((auvid_real_t)c + group->dead_band);
    }
    return AUVID_C(0.0);
}

/* P(t), s > 0. */
static auvid_real_t thrusters_ramp(auvid_real_t t, auvid_real_t s)
{
    auvid_real_t in = t + AUVID_C(0.5) * s;
    return !(in > AUVID_C(0.0)) ? AUVID_C(0.0) : (in < s ? AUVID_C(0.5) * in * in / s : t);
}

/* The slots of a row in the log. */
typedef struct {
    uint32_t first;     /* index of the first slot of the lead-in */
    uint32_t lead;      /* number of slots of the lead-in */
    uint32_t window;    /* number of slots of the row's window */
    uint32_t available; /* number of window slots before the newest slot of the log */
    auvid_real_t from;  /* begin of the window's first slot, from the row's begin [slots] */
} row_slots_t;

/* Finds the slots of the row with middle t_us; false if the log does not contain it. */
static bool thrusters_find_row(const auvid_thrusters_t *th, uint64_t t_us, row_slots_t *slots)
{
    uint32_t period = th->cfg.period_us, length = th->grid.row_us + th->grid.spread_us;
    uint64_t begin_us = auvid_thrusters_in_log(th, t_us - length / 2u - th->cfg.delay_us);
    uint64_t ago_us = th->state.end_us - begin_us;
    if (th->state.filled == 0 || begin_us > th->state.end_us || ago_us > UINT32_MAX - period) {
        return false;
    }
    uint32_t ago = ((uint32_t)ago_us + period - 1u) / period; /* slots */
    if (ago == 0 || ago > th->state.filled) {
        return false;
    }
    uint32_t before_us = ago * period - (uint32_t)ago_us;
    slots->lead = th->grid.lead < th->state.filled - ago ? th->grid.lead : th->state.filled - ago;
    uint32_t back = ago + slots->lead;
    slots->first =
        th->state.head >= back ? th->state.head - back : th->state.head + th->cfg.slots - back;
    slots->available = ago - 1u;
    slots->window = (before_us + length + period - 1u) / period;
    slots->from = -((auvid_real_t)before_us + AUVID_C(0.5) * (auvid_real_t)th->grid.spread_us) /
                  (auvid_real_t)period;
    return true;
}

/* The next slot of the ring. */
AUVID_INLINE const int16_t *thrusters_next_slot(const auvid_thrusters_t *th, const int16_t *slot)
{
    slot += th->cfg.thrusters;
    return slot < th->cfg.log + th->cfg.slots * th->cfg.thrusters
               ? slot
               : slot - th->cfg.slots * th->cfg.thrusters;
}

/* A thruster's force at the begin of the window, after a lead-in from steady state at `slot`. */
static auvid_real_t thrusters_lead_in(const auvid_thrusters_t *th, const group_t *source,
                                      const int16_t *slot, uint32_t slots)
{
    const group_t group = *source;
    auvid_real_t x = thrusters_static_force(&group, *slot);
    for (; slots > 0; --slots, slot = thrusters_next_slot(th, slot)) {
        auvid_real_t g = thrusters_static_force(&group, *slot);
        x = g + (x - g) * group.decay;
    }
    return x;
}

/* Each thruster's mean force over the window, with the weights of forces (sum[0]) and of moments
 * (sum[1]). */
static void thrusters_mean_forces(const auvid_thrusters_t *th, const group_t *groups,
                                  const row_slots_t *slots,
                                  auvid_real_t sum[2][AUVID_COMMAND_SLOTS])
{
    const auvid_real_t per_us = AUVID_C(1.0) / (auvid_real_t)th->cfg.period_us;
    const auvid_real_t row = (auvid_real_t)th->grid.row_us * per_us, per_row = AUVID_C(1.0) / row;
    const auvid_real_t spread =
        auvid_max((auvid_real_t)th->grid.spread_us * per_us, AUVID_C(1e-3)); /* not 0 */
    auvid_real_t x[AUVID_COMMAND_SLOTS] = {AUVID_C(0.0)}, t = slots->from;
    auvid_real_t before[2] = {AUVID_C(0.0), auvid_clamp(t, AUVID_C(0.0), row)};
    int n = th->cfg.thrusters;
    const int16_t *slot = th->cfg.log + slots->first * (uint32_t)n;
    for (int i = 0; i < n; ++i) {
        x[i] = thrusters_lead_in(th, &groups[th->cfg.group[i]], slot + i, slots->lead);
    }
    slot += slots->lead * (uint32_t)n;
    slot -= slots->first + slots->lead < th->cfg.slots ? 0u : th->cfg.slots * (uint32_t)n;
    for (uint32_t k = 0; k < slots->window; ++k) {
        t += AUVID_C(1.0);
        auvid_real_t forces = thrusters_ramp(t, spread) - thrusters_ramp(t - row, spread);
        auvid_real_t moments = auvid_clamp(t, AUVID_C(0.0), row);
        auvid_real_t force_weight = (forces - before[0]) * per_row;
        auvid_real_t moment_weight = (moments - before[1]) * per_row;
        for (int i = 0; i < n; ++i) {
            const group_t *group = &groups[th->cfg.group[i]];
            auvid_real_t g = thrusters_static_force(group, slot[i]), off = x[i] - g,
                         mean = g + off * group->mean;
            sum[0][i] += force_weight * mean;
            sum[1][i] += moment_weight * mean;
            x[i] = g + off * group->decay;
        }
        before[0] = forces;
        before[1] = moments;
        if (k < slots->available) { /* repeats the newest slot for the missing ones */
            slot = thrusters_next_slot(th, slot);
        }
    }
}

auvid_status_t auvid_thrusters_wrench(const auvid_thrusters_t *thrusters, uint64_t t_us,
                                      const auvid_real_t *pi, auvid_real_t *wrench)
{
    if (thrusters == NULL || pi == NULL || wrench == NULL) {
        return AUVID_ERR_NULL;
    }
    const auvid_thrusters_t *th = thrusters;
    group_t groups[AUVID_THRUSTERS_GROUPS];
    auvid_real_t sum[2][AUVID_COMMAND_SLOTS] = {{AUVID_C(0.0)}};
    row_slots_t slots;
    memset(wrench, 0, AUVID_DOF_COUNT * sizeof *wrench);
    if (th->grid.row_us == 0 || !thrusters_find_row(th, t_us, &slots)) {
        return AUVID_ERR_NO_DATA;
    }
    const auvid_real_t *group_pi = pi + th->cfg.hull->parameters;
    for (int i = th->cfg.hull->parameters, g = 0; i < th->vehicle.parameters;
         i += AUVID_THRUSTERS_PER_GROUP, ++g, group_pi += AUVID_THRUSTERS_PER_GROUP) {
        thrusters_candidate_group(th, group_pi, &groups[g]);
    }
    thrusters_mean_forces(th, groups, &slots, sum);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < th->cfg.thrusters; ++i) {
            wrench[j] += th->cfg.matrix[j][i] * sum[j < AUVID_ROLL ? 0 : 1][i];
        }
    }
    return AUVID_OK;
}
