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
 *
 * Derivatives: x = k_forward F + k_backward G with the responses F, G to gains of one, which follow
 * the same lag, as does d x / d d. From x(h) follows, for s = d x / d T,
 *     s(h) = s(0) e^-a + (x(0) - g) (e^-a)'.
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
    auvid_real_t decay_slope, mean_slope; /* by the lag [1 / slots] */
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
    auvid_real_t by_lag = group->decay > AUVID_C(0.0) ? group->decay / lag : AUVID_C(0.0);
    group->decay_slope = group->decay > AUVID_C(0.0) ? by_lag / lag : AUVID_C(0.0);
    group->mean_slope = AUVID_C(1.0) - group->decay - by_lag;
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

/* The slots of a row's window, one after the other, and their weights. */
typedef struct {
    auvid_real_t row, spread; /* lengths [slots] */
    auvid_real_t per_row;     /* 1 / row */
    auvid_real_t t;           /* end of the slot, from the row's begin [slots] */
    auvid_real_t before[2];   /* integrals of the weights up to its begin */
    auvid_real_t weight[2];   /* of forces, of moments */
    const int16_t *slot;      /* its commands */
    uint32_t k;               /* its number */
} window_t;

static window_t thrusters_open_window(const auvid_thrusters_t *th, const row_slots_t *slots)
{
    const auvid_real_t per_us = AUVID_C(1.0) / (auvid_real_t)th->cfg.period_us;
    uint32_t n = th->cfg.thrusters;
    window_t w = {.row = (auvid_real_t)th->grid.row_us * per_us, .t = slots->from};
    w.per_row = AUVID_C(1.0) / w.row;
    w.spread = auvid_max((auvid_real_t)th->grid.spread_us * per_us, AUVID_C(1e-3)); /* not 0 */
    w.before[1] = auvid_clamp(w.t, AUVID_C(0.0), w.row);
    w.slot = th->cfg.log + (slots->first + slots->lead) * n;
    w.slot -= slots->first + slots->lead < th->cfg.slots ? 0u : th->cfg.slots * n;
    return w;
}

/* Weigh the present slot. */
static void thrusters_weigh_slot(window_t *w)
{
    w->t += AUVID_C(1.0);
    const auvid_real_t end[2] = {thrusters_ramp(w->t, w->spread) -
                                     thrusters_ramp(w->t - w->row, w->spread),
                                 auvid_clamp(w->t, AUVID_C(0.0), w->row)};
    for (int k = 0; k < 2; ++k) {
        w->weight[k] = (end[k] - w->before[k]) * w->per_row;
        w->before[k] = end[k];
    }
}

/* Go to the next slot; the newest one stands for those that are missing. */
static void thrusters_next_of_window(const auvid_thrusters_t *th, const row_slots_t *slots,
                                     window_t *w)
{
    if (w->k++ < slots->available) {
        w->slot = thrusters_next_slot(th, w->slot);
    }
}

/* Each thruster's mean force over the window, with the weights of forces (sum[0]) and of moments
 * (sum[1]). */
static void thrusters_mean_forces(const auvid_thrusters_t *th, const group_t *groups,
                                  const row_slots_t *slots,
                                  auvid_real_t sum[2][AUVID_COMMAND_SLOTS])
{
    auvid_real_t x[AUVID_COMMAND_SLOTS] = {AUVID_C(0.0)};
    int n = th->cfg.thrusters;
    const int16_t *first = th->cfg.log + slots->first * (uint32_t)n;
    for (int i = 0; i < n; ++i) {
        x[i] = thrusters_lead_in(th, &groups[th->cfg.group[i]], first + i, slots->lead);
    }
    window_t w = thrusters_open_window(th, slots);
    while (w.k < slots->window) {
        thrusters_weigh_slot(&w);
        for (int i = 0; i < n; ++i) {
            const group_t *group = &groups[th->cfg.group[i]];
            auvid_real_t g = thrusters_static_force(group, w.slot[i]), off = x[i] - g,
                         mean = g + off * group->mean;
            sum[0][i] += w.weight[0] * mean;
            sum[1][i] += w.weight[1] * mean;
            x[i] = g + off * group->decay;
        }
        thrusters_next_of_window(th, slots, &w);
    }
}

/* Finds a row in the log, and its groups' parameters. Returns false if the log does not contain
 * it. */
static bool thrusters_prepare_row(const auvid_thrusters_t *th, uint64_t t_us,
                                  const auvid_real_t *pi, row_slots_t *slots,
                                  group_t groups[AUVID_THRUSTERS_GROUPS])
{
    if (th->grid.row_us == 0 || !thrusters_find_row(th, t_us, slots)) {
        return false;
    }
    const auvid_real_t *group_pi = pi + th->cfg.hull->parameters;
    for (int i = th->cfg.hull->parameters, g = 0; i < th->vehicle.parameters;
         i += AUVID_THRUSTERS_PER_GROUP, ++g, group_pi += AUVID_THRUSTERS_PER_GROUP) {
        thrusters_candidate_group(th, group_pi, &groups[g]);
    }
    return true;
}

/* Responses of a thruster: to a forward gain of one, to a backward gain of one, and its
 * derivatives by the dead band and by the lag [slots]. The first three follow what they would be
 * without lag. */
typedef auvid_real_t response_t[AUVID_THRUSTERS_PER_GROUP];

/* One slot: adds its mean to mean[], unless NULL. @param settles begin in steady state */
static void thrusters_follow(const group_t *group, int32_t c, bool settles, response_t x,
                             response_t mean)
{
    response_t u = {AUVID_C(0.0)};
    if (c > group->whole_band) {
        u[AUVID_THRUSTERS_FORWARD] = (auvid_real_t)c - group->dead_band;
        u[AUVID_THRUSTERS_DEAD_BAND] = -group->gain[0];
    } else if (c < -group->whole_band) {
        u[AUVID_THRUSTERS_BACKWARD] = (auvid_real_t)c + group->dead_band;
        u[AUVID_THRUSTERS_DEAD_BAND] = group->gain[1];
    }
    if (settles) {
        memcpy(x, u, sizeof u);
        x[AUVID_THRUSTERS_LAG] = AUVID_C(0.0);
    }
    auvid_real_t off = AUVID_C(0.0), slope = x[AUVID_THRUSTERS_LAG];
    for (int k = 0; k < AUVID_THRUSTERS_LAG; ++k) {
        auvid_real_t rest = x[k] - u[k];
        off += k < 2 ? group->gain[k] * rest : AUVID_C(0.0);
        mean[k] = u[k] + rest * group->mean;
        x[k] = u[k] + rest * group->decay;
    }
    mean[AUVID_THRUSTERS_LAG] = slope * group->mean + off * group->mean_slope;
    x[AUVID_THRUSTERS_LAG] = slope * group->decay + off * group->decay_slope;
}

/* Mean responses of thruster i over the window, as in thrusters_mean_forces. */
static void thrusters_mean_responses(const auvid_thrusters_t *th, const group_t *group,
                                     const row_slots_t *slots, int i, response_t sum[2])
{
    response_t x = {AUVID_C(0.0)}, mean;
    const int16_t *slot = th->cfg.log + slots->first * (uint32_t)th->cfg.thrusters;
    window_t w = thrusters_open_window(th, slots);
    bool settles = true;
    for (uint32_t k = slots->lead; k > 0; --k, slot = thrusters_next_slot(th, slot)) {
        thrusters_follow(group, slot[i], settles, x, mean);
        settles = false;
    }
    memset(sum, 0, 2 * sizeof *sum);
    while (w.k < slots->window) {
        thrusters_weigh_slot(&w);
        thrusters_follow(group, w.slot[i], settles, x, mean);
        settles = false;
        for (int k = 0; k < AUVID_THRUSTERS_PER_GROUP; ++k) {
            sum[0][k] += w.weight[0] * mean[k];
            sum[1][k] += w.weight[1] * mean[k];
        }
        thrusters_next_of_window(th, slots, &w);
    }
}

bool auvid_thrusters_slopes(const auvid_thrusters_t *th, uint64_t t_us, const auvid_real_t *pi,
                            auvid_regressor_t *y)
{
    group_t groups[AUVID_THRUSTERS_GROUPS];
    row_slots_t slots;
    if (!thrusters_prepare_row(th, t_us, pi, &slots, groups)) {
        return false;
    }
    /* derivatives by gain, dead band and lag in their own units */
    const auvid_real_t step = th->cfg.command_max / AUVID_C(32767.0);
    const response_t unit = {step, step, AUVID_C(1.0) / step,
                             AUVID_C(1e6) / (auvid_real_t)th->cfg.period_us};
    for (int i = 0; i < th->cfg.thrusters; ++i) {
        response_t sum[2];
        int g = th->cfg.group[i], at = th->cfg.hull->parameters + g * AUVID_THRUSTERS_PER_GROUP;
        thrusters_mean_responses(th, &groups[g], &slots, i, sum);
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            for (int k = 0; k < AUVID_THRUSTERS_PER_GROUP && th->vehicle.columns[j] != 0; ++k) {
                y->row[j][at + k] -=
                    th->cfg.matrix[j][i] * unit[k] * sum[j < AUVID_ROLL ? 0 : 1][k];
            }
        }
    }
    return true;
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
    if (!thrusters_prepare_row(th, t_us, pi, &slots, groups)) {
        return AUVID_ERR_NO_DATA;
    }
    thrusters_mean_forces(th, groups, &slots, sum);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < th->cfg.thrusters; ++i) {
            wrench[j] += th->cfg.matrix[j][i] * sum[j < AUVID_ROLL ? 0 : 1][i];
        }
    }
    return AUVID_OK;
}
