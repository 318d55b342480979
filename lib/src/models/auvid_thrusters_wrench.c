/*
 * Thrusters: a candidate's mean forces from the log, T x' = g(c) - x (Fossen 2011, 12.1).
 *
 * Over a slot of length h, c is constant and the solution is exact. With a = h / T:
 *
 *     x(h) = g + (x(0) - g) e^-a,      mean of x = g + (x(0) - g) (1 - e^-a) / a
 *
 * The mean of x over a row has the same weights as the motion. Moments belong to rates of the IMU,
 * with equal weights over the row. Forces belong to velocity that is interpolated between samples T
 * apart, a triangular kernel of variance T^2 / 6 (auvid_metric_regressor.c). Here a rectangle of
 * the same variance, of length s = sqrt(2) T, replaces the triangle. Its convolution with the row's
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

/* What a row leaves to the next one. */
enum { CARRY_FORCES, CARRY_RESPONSES };

/* A group's parameters for one candidate. Commands are in steps of the log. */
typedef struct {
    auvid_real_t gain[2]; /* forward, backward [N per step] */
    auvid_real_t dead_band;
    int32_t whole_band;                   /* dead_band rounded down: a larger command exceeds it */
    auvid_real_t decay;                   /* e^-a */
    auvid_real_t mean;                    /* (1 - e^-a) / a */
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

/* The slots of a row in the log: those of the lead-in, where it has no weight, then its window. */
typedef struct {
    uint32_t first; /* index of the first slot */
    uint32_t count; /* number of slots */
    uint32_t known; /* slots before the newest slot of the log, which stands for those after it */
    uint32_t next;  /* slots before the window of the row after this one */
    auvid_real_t from; /* begin of the first slot, from the row's begin [slots] */
    bool resumes;      /* the lag continues from the row before */
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
    uint32_t lead = th->grid.lead < th->state.filled - ago ? th->grid.lead : th->state.filled - ago;
    uint32_t back = ago + lead;
    slots->first =
        th->state.head >= back ? th->state.head - back : th->state.head + th->cfg.slots - back;
    slots->known = back - 1u;
    slots->count = lead + (before_us + length + period - 1u) / period;
    slots->next = lead + (before_us + th->grid.row_us) / period;
    slots->from = -((auvid_real_t)before_us + AUVID_C(0.5) * (auvid_real_t)th->grid.spread_us) /
                      (auvid_real_t)period -
                  (auvid_real_t)lead;
    slots->resumes = false;
    return true;
}

/* Begins at the slot that the row before has reached, if that was one of the same candidate, and
 * not longer ago than the lead-in. Returns what it left; NULL: nothing. */
static auvid_thrusters_carry_t *thrusters_resume(const auvid_thrusters_t *th, uint64_t t_us,
                                                 const auvid_real_t *group_pi, int kind,
                                                 row_slots_t *slots)
{
    auvid_thrusters_carry_t *carry = th->carry;
    int count = th->vehicle.parameters - th->cfg.hull->parameters;
    bool same = true;
    for (int i = 0; i < count; ++i) { /* never the same if not a number */
        same = same && group_pi[i] <= carry->pi[i] && group_pi[i] >= carry->pi[i];
        carry->pi[i] = group_pi[i];
    }
    carry->ready[0] = carry->ready[0] && same;
    carry->ready[1] = carry->ready[1] && same;
    uint32_t at = carry->slot[kind], skipped = at - slots->first, lead = th->grid.lead;
    skipped += at < slots->first ? th->cfg.slots : 0u;
    if (carry->ready[kind] && t_us >= carry->t_us[kind] &&
        t_us - carry->t_us[kind] <= (uint64_t)lead * th->cfg.period_us && skipped <= lead) {
        slots->resumes = true;
        slots->first = at;
        slots->count -= skipped;
        slots->known -= skipped;
        slots->next -= skipped;
        slots->from += (auvid_real_t)skipped;
    }
    uint32_t next = slots->first + slots->next;
    carry->slot[kind] = next < th->cfg.slots ? next : next - th->cfg.slots;
    carry->t_us[kind] = t_us + th->grid.row_us;
    carry->ready[kind] = slots->next <= slots->known;
    return carry;
}

/* The weights of a row, slot by slot. */
typedef struct {
    auvid_real_t row, spread; /* lengths [slots] */
    auvid_real_t half;        /* 1 / (2 spread) */
    auvid_real_t per_row;     /* 1 / row */
    auvid_real_t t;           /* end of the slot, from the row's begin [slots] */
    auvid_real_t before[2];   /* integrals of the weights up to its begin */
} window_t;

/* P(t) */
AUVID_INLINE auvid_real_t thrusters_ramp(const window_t *w, auvid_real_t t)
{
    auvid_real_t in = t + AUVID_C(0.5) * w->spread;
    return !(in > AUVID_C(0.0)) ? AUVID_C(0.0) : (in < w->spread ? in * in * w->half : t);
}

static window_t thrusters_open_window(const auvid_thrusters_t *th, const row_slots_t *slots)
{
    const auvid_real_t per_us = AUVID_C(1.0) / (auvid_real_t)th->cfg.period_us;
    window_t w = {.row = (auvid_real_t)th->grid.row_us * per_us, .t = slots->from};
    w.per_row = AUVID_C(1.0) / w.row;
    w.spread = auvid_max((auvid_real_t)th->grid.spread_us * per_us, AUVID_C(1e-3)); /* not 0 */
    w.half = AUVID_C(0.5) / w.spread;
    return w;
}

/* Weigh the next slots. @param weight of forces, of moments */
static void thrusters_weigh_slots(window_t *source, uint32_t count, auvid_real_t weight[][2])
{
    window_t w = *source;
    for (uint32_t k = 0; k < count; ++k) {
        w.t += AUVID_C(1.0);
        auvid_real_t force = thrusters_ramp(&w, w.t) - thrusters_ramp(&w, w.t - w.row);
        auvid_real_t moment = auvid_clamp(w.t, AUVID_C(0.0), w.row);
        weight[k][0] = (force - w.before[0]) * w.per_row;
        weight[k][1] = (moment - w.before[1]) * w.per_row;
        w.before[0] = force;
        w.before[1] = moment;
    }
    *source = w;
}

/* Successive slots of a row in the log, and their weights. */
enum { RUN_SLOTS = 16 };
typedef struct {
    const int16_t *slot;
    uint32_t stride; /* 0: the newest slot, again and again */
    uint32_t count;
    auvid_real_t weight[RUN_SLOTS][2];
} run_t;

/* The slots from slot k of the row on, and before slot `end`. Returns the first one after them. */
static uint32_t thrusters_next_run(const auvid_thrusters_t *th, const row_slots_t *slots,
                                   uint32_t k, uint32_t end, window_t *w, run_t *run)
{
    uint32_t at = slots->first + (k < slots->known ? k : slots->known), count = end - k;
    at -= at < th->cfg.slots ? 0u : th->cfg.slots;
    run->slot = th->cfg.log + at * th->cfg.thrusters;
    run->stride = k < slots->known ? th->cfg.thrusters : 0u;
    if (k < slots->known) {
        count = count < slots->known - k ? count : slots->known - k;
        count = count < th->cfg.slots - at ? count : th->cfg.slots - at;
    }
    run->count = count < RUN_SLOTS ? count : RUN_SLOTS;
    thrusters_weigh_slots(w, run->count, run->weight);
    return k + run->count;
}

/* Thruster i's force x over a run; adds its weighted means. */
static void thrusters_follow_force(const group_t *source, const run_t *run, int i, auvid_real_t *x,
                                   auvid_real_t sum[2])
{
    const group_t group = *source;
    const int16_t *slot = run->slot + i;
    auvid_real_t force = *x, of_force = sum[0], of_moment = sum[1];
    for (uint32_t k = 0; k < run->count; ++k, slot += run->stride) {
        auvid_real_t g = thrusters_static_force(&group, *slot), off = force - g,
                     mean = g + off * group.mean;
        of_force += run->weight[k][0] * mean;
        of_moment += run->weight[k][1] * mean;
        force = g + off * group.decay;
    }
    *x = force;
    sum[0] = of_force;
    sum[1] = of_moment;
}

/* Each thruster's mean force over the row, with the weights of forces (sum[i][0]) and of moments
 * (sum[i][1]), which begin at zero. @param carry NULL: nothing is left to the next row */
static void thrusters_mean_forces(const auvid_thrusters_t *th, const group_t *groups,
                                  const row_slots_t *slots, auvid_thrusters_carry_t *carry,
                                  auvid_real_t sum[AUVID_COMMAND_SLOTS][2])
{
    auvid_real_t x[AUVID_COMMAND_SLOTS] = {AUVID_C(0.0)};
    window_t w = thrusters_open_window(th, slots);
    run_t run;
    for (uint32_t k = 0; k < slots->count;) {
        uint32_t at = k, end = k < slots->next ? slots->next : slots->count;
        k = thrusters_next_run(th, slots, k, end, &w, &run);
        for (int i = 0; i < th->cfg.thrusters; ++i) {
            const group_t *group = &groups[th->cfg.group[i]];
            if (at == 0) { /* else from steady state */
                x[i] =
                    slots->resumes ? carry->force[i] : thrusters_static_force(group, run.slot[i]);
            }
            thrusters_follow_force(group, &run, i, &x[i], sum[i]);
        }
        if (k == slots->next && carry != NULL) {
            memcpy(carry->force, x, sizeof x);
        }
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
 * without lag, u. */
typedef auvid_real_t response_t[AUVID_THRUSTERS_PER_GROUP];

/* u at a command; of the lag: 0 */
AUVID_INLINE void thrusters_static_response(const group_t *group, int32_t c, response_t u)
{
    bool forward = c > group->whole_band, backward = c < -group->whole_band;
    u[AUVID_THRUSTERS_FORWARD] = forward ? (auvid_real_t)c - group->dead_band : AUVID_C(0.0);
    u[AUVID_THRUSTERS_BACKWARD] = backward ? (auvid_real_t)c + group->dead_band : AUVID_C(0.0);
    u[AUVID_THRUSTERS_DEAD_BAND] =
        forward ? -group->gain[0] : (backward ? group->gain[1] : AUVID_C(0.0));
    u[AUVID_THRUSTERS_LAG] = AUVID_C(0.0);
}

/* One slot of one response. Returns the difference to u at its begin. */
AUVID_INLINE auvid_real_t thrusters_follow_one(const group_t *group, auvid_real_t u,
                                               const auvid_real_t *weight, auvid_real_t *x,
                                               auvid_real_t *of_force, auvid_real_t *of_moment)
{
    auvid_real_t off = *x - u, mean = u + off * group->mean;
    *of_force += weight[0] * mean;
    *of_moment += weight[1] * mean;
    *x = u + off * group->decay;
    return off;
}

/* Thruster i's responses x over a run; adds their weighted means. The responses are spelled out:
 * compilers keep them in registers then. */
static void thrusters_follow_response(const group_t *source, const run_t *run, int i,
                                      response_t state, response_t sum[2])
{
    const group_t group = *source;
    const int16_t *slot = run->slot + i;
    response_t x, force, moment, u;
    memcpy(x, state, sizeof x);
    memcpy(force, sum[0], sizeof force);
    memcpy(moment, sum[1], sizeof moment);
    for (uint32_t k = 0; k < run->count; ++k, slot += run->stride) {
        const auvid_real_t *weight = run->weight[k];
        thrusters_static_response(&group, *slot, u);
        auvid_real_t ahead =
            thrusters_follow_one(&group, u[0], weight, &x[0], &force[0], &moment[0]);
        auvid_real_t back =
            thrusters_follow_one(&group, u[1], weight, &x[1], &force[1], &moment[1]);
        auvid_real_t off = group.gain[0] * ahead + group.gain[1] * back;
        (void)thrusters_follow_one(&group, u[2], weight, &x[2], &force[2], &moment[2]);
        auvid_real_t mean = x[3] * group.mean + off * group.mean_slope;
        force[3] += weight[0] * mean;
        moment[3] += weight[1] * mean;
        x[3] = x[3] * group.decay + off * group.decay_slope;
    }
    memcpy(state, x, sizeof x);
    memcpy(sum[0], force, sizeof force);
    memcpy(sum[1], moment, sizeof moment);
}

/* Mean responses of each thruster over the row, as in thrusters_mean_forces. */
static void thrusters_mean_responses(const auvid_thrusters_t *th, const group_t *groups,
                                     const row_slots_t *slots, auvid_thrusters_carry_t *carry,
                                     response_t sum[AUVID_COMMAND_SLOTS][2])
{
    response_t x[AUVID_COMMAND_SLOTS];
    window_t w = thrusters_open_window(th, slots);
    run_t run;
    for (uint32_t k = 0; k < slots->count;) {
        uint32_t at = k, end = k < slots->next ? slots->next : slots->count;
        k = thrusters_next_run(th, slots, k, end, &w, &run);
        for (int i = 0; i < th->cfg.thrusters; ++i) {
            const group_t *group = &groups[th->cfg.group[i]];
            if (at == 0 && slots->resumes) {
                memcpy(x[i], carry->response[i], sizeof x[i]);
            } else if (at == 0) {
                thrusters_static_response(group, run.slot[i], x[i]);
            }
            thrusters_follow_response(group, &run, i, x[i], sum[i]);
        }
        if (k == slots->next) {
            memcpy(carry->response, x, (size_t)th->cfg.thrusters * sizeof x[0]);
        }
    }
}

bool auvid_thrusters_slopes(const auvid_thrusters_t *th, uint64_t t_us, const auvid_real_t *pi,
                            auvid_regressor_t *y)
{
    group_t groups[AUVID_THRUSTERS_GROUPS];
    row_slots_t slots;
    response_t sum[AUVID_COMMAND_SLOTS][2];
    if (!thrusters_prepare_row(th, t_us, pi, &slots, groups)) {
        return false;
    }
    memset(sum, 0, sizeof sum);
    thrusters_mean_responses(
        th, groups, &slots,
        thrusters_resume(th, t_us, pi + th->cfg.hull->parameters, CARRY_RESPONSES, &slots), sum);
    /* derivatives by gain, dead band and lag in their own units */
    const auvid_real_t step = th->cfg.command_max / AUVID_C(32767.0);
    const response_t unit = {step, step, AUVID_C(1.0) / step,
                             AUVID_C(1e6) / (auvid_real_t)th->cfg.period_us};
    for (int i = 0; i < th->cfg.thrusters; ++i) {
        int at = th->cfg.hull->parameters + th->cfg.group[i] * AUVID_THRUSTERS_PER_GROUP;
        for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
            for (int k = 0; k < AUVID_THRUSTERS_PER_GROUP && th->vehicle.columns[j] != 0; ++k) {
                y->row[j][at + k] -=
                    th->cfg.matrix[j][i] * unit[k] * sum[i][j < AUVID_ROLL ? 0 : 1][k];
            }
        }
    }
    return true;
}

bool auvid_thrusters_force(const auvid_thrusters_t *th, uint64_t t_us, const auvid_real_t *pi,
                           bool resume, auvid_real_t *wrench)
{
    group_t groups[AUVID_THRUSTERS_GROUPS];
    auvid_real_t sum[AUVID_COMMAND_SLOTS][2] = {{AUVID_C(0.0)}};
    row_slots_t slots;
    memset(wrench, 0, AUVID_DOF_COUNT * sizeof *wrench);
    if (!thrusters_prepare_row(th, t_us, pi, &slots, groups)) {
        return false;
    }
    auvid_thrusters_carry_t *carry =
        resume ? thrusters_resume(th, t_us, pi + th->cfg.hull->parameters, CARRY_FORCES, &slots)
               : NULL;
    thrusters_mean_forces(th, groups, &slots, carry, sum);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        for (int i = 0; i < th->cfg.thrusters; ++i) {
            wrench[j] += th->cfg.matrix[j][i] * sum[i][j < AUVID_ROLL ? 0 : 1];
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
    return auvid_thrusters_force(thrusters, t_us, pi, false, wrench) ? AUVID_OK : AUVID_ERR_NO_DATA;
}
