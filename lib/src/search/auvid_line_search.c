/*
 * Coordinate search with line-search expansions, Algorithm 2 of Karras et al., IROS 2013, after
 * Lucidi and Sciandrone 2002. Numbers in parentheses are the lines of Algorithm 2.
 *
 * The same line search serves the 2n directions and the pattern step: from base along d,
 *     trial(t) = base + t d, cut at the box,   d = +-d_i  or  base - previous
 *     POLL     t = alpha_i (pattern: 1); must pass both tests:
 *                  J(trial) <= J(base) - gamma t^2   and   J(trial) < J(theta)
 *     EXPAND   t = delta t while both hold
 *     PARABOLA q(t) = J(base) + b t + c t^2 through the points of the line; t = -b / (2 c)
 * d_i is e_i (paper), or is made in the first line along it (auvid_line_search_directions.c):
 *     AXIS     the poll of e_i
 *     PROBE    once for each d_k, k < i; then POLL along d_i
 * The iterate of the paper, x^k, is theta here.
 *
 * Deviations from the paper, switched off by `paper`:
 * - directions: the first sweep makes d_1 .. d_n conjugate with respect to the cost's curvature, by
 *   one trial for each pair, and minimizes along each of them. A quadratic is at its minimum after
 *   n^2 / 2 + 5 n evaluations. When the steps are a tenth of alpha0 the search continues along
 *   e_1 .. e_n, as in the paper, where no kink can stop it. If a later sweep still gains more than
 *   gamma, the cost is not that quadratic, and the directions are made again;
 * - -d_i is left out of a sweep in which +d_i has moved;
 * - pattern step: after a sweep of all directions that lowered the cost, the same search follows
 *   the line through the sweep's two ends, with step 1 (Hooke, Jeeves 1961);
 * - parabola: each line search tries the lowest point of the parabola through its points (or with
 *   the curvature that an earlier search along d_i found). Pattern step and parabola are accepted
 *   only if better than the iterate, and shorten no step, so the polling that the convergence proof
 *   relies on is unchanged.
 */
#include "auvid_line_search_directions_internal.h"
#include "auvid_line_search_internal.h"

#include <string.h>

/* A restart begins with this fraction of alpha0. */
#define RESTART_STEP AUVID_C(0.1)
/* Longest pattern step: 2^10 sweeps at once. */
#define PATTERN_MAX AUVID_C(1024.0)
/* A goal is out of reach if this number of sweeps, each like the last one, end above it. */
#define SWEEPS_LEFT AUVID_C(3.0)

static void line_search_raise_steps(auvid_optimizer_t *o, auvid_real_t alpha)
{
    for (size_t i = 0; i < 2u * o->cfg.n; ++i) {
        o->line_search.alpha[i] = auvid_max(o->line_search.alpha[i], alpha);
    }
}

void auvid_line_search_begin(auvid_optimizer_t *o, auvid_real_t cost)
{
    memset(&o->line_search, 0, sizeof o->line_search);
    o->line_search.cost = cost;
    memcpy(o->line_search.theta, o->trial, sizeof o->trial);
    line_search_raise_steps(
        o, o->certified ? auvid_clamp(auvid_sqrt(o->allowed), o->cfg.epsilon_line, o->cfg.alpha0)
                        : o->cfg.alpha0);
    o->line_search.restarts_left = o->cfg.restarts;
    o->state = AUVID_OPTIMIZER_START;
}

/* The certificate is wrong: search. */
static void line_search_refute(auvid_optimizer_t *o)
{
    o->certified = false;
    line_search_raise_steps(o, o->cfg.alpha0);
}

/* Is the search more than the paper's? A poll that confirms a certificate is not. */
static bool line_search_is_fast(const auvid_optimizer_t *o)
{
    return !o->cfg.paper && !o->certified;
}

static void line_search_begin_line(auvid_optimizer_t *o, uint8_t direction)
{
    auvid_line_search_t *ls = &o->line_search;
    ls->direction = direction;
    ls->move = MOVE_POLL;
    memcpy(ls->base, ls->theta, sizeof ls->base);
    memcpy(o->trial, ls->theta, sizeof o->trial); /* a line moves only some parameters */
    ls->base_cost = ls->cost;
    ls->t = line_search_is_pattern(o) ? AUVID_C(1.0) : ls->alpha[direction];
    ls->t_best = ls->t_near = ls->t_far = ls->axis_step = AUVID_C(0.0);
    if (line_search_is_pattern(o) || !line_search_is_fast(o)) {
        return;
    }
    if (line_search_parameter(o) == ls->built) {
        memset(ls->shear + AUVID_SHEAR(ls->built), 0, ls->built * sizeof *ls->shear);
        ls->curvature[ls->built] = AUVID_C(0.0);
        ls->move = MOVE_AXIS;
    }
    auvid_line_search_release(o);
}

/* Is the goal out of reach, after a sweep? */
static bool line_search_misses_goal(const auvid_optimizer_t *o)
{
    const auvid_line_search_t *ls = &o->line_search;
    return o->has_goal && ls->cost - o->least > SWEEPS_LEFT * (ls->previous_cost - ls->cost);
}

/* (3-6) At the end of a sweep, and before the first. */
static void line_search_begin_sweep(auvid_optimizer_t *o)
{
    auvid_line_search_t *ls = &o->line_search;
    if (o->certified && o->state == AUVID_OPTIMIZER_LOCAL) { /* the poll is complete */
        if (auvid_search_is_certified(o, ls->cost)) {
            o->state = AUVID_OPTIMIZER_LOCAL_CONVERGED;
            return;
        }
        line_search_refute(o);
    }
    if (o->state == AUVID_OPTIMIZER_LOCAL && line_search_misses_goal(o)) {
        o->state = AUVID_OPTIMIZER_LOCAL_CONVERGED;
        return;
    }
    const bool first =
        !o->cfg.paper && ls->restarts_left == o->cfg.restarts && o->state == AUVID_OPTIMIZER_LOCAL;
    auvid_real_t longest = AUVID_C(0.0), last = o->cfg.epsilon_line;
    for (size_t i = 0; i < 2u * o->cfg.n; ++i) {
        longest = auvid_max(longest, ls->alpha[i]);
    }
    if (first && ls->restarts_left > 0) {
        last = RESTART_STEP * o->cfg.alpha0; /* the restart does the rest */
    }
    if (ls->plain && ls->previous_cost - ls->cost > o->cfg.gamma) {
        ls->built = 0; /* the directions are no longer conjugate */
        ls->restarts_left = o->cfg.restarts;
        line_search_raise_steps(o, RESTART_STEP * o->cfg.alpha0);
    } else if (longest <= last) {
        if (ls->restarts_left == 0) {
            o->state = AUVID_OPTIMIZER_LOCAL_CONVERGED;
            return;
        }
        --ls->restarts_left;
        line_search_raise_steps(o, RESTART_STEP * o->cfg.alpha0);
        ls->built = o->cfg.n; /* now along e_i */
        memset(ls->shear, 0, sizeof ls->shear);
        memset(ls->curvature, 0, sizeof ls->curvature);
    }
    ls->plain = ls->built == o->cfg.n && line_search_is_fast(o);
    o->state = AUVID_OPTIMIZER_LOCAL;
    memcpy(ls->previous, ls->theta, sizeof ls->previous);
    ls->previous_cost = ls->cost;
    line_search_begin_line(o, 0);
}

/* (18-21) and the pattern step. -d_i is skipped if +d_i has moved; otherwise it uses the cost of
 * +d_i. */
static void line_search_next_line(auvid_optimizer_t *o)
{
    auvid_line_search_t *ls = &o->line_search;
    const uint8_t pattern = (uint8_t)(2u * o->cfg.n);
    const bool fast = line_search_is_fast(o);
    uint8_t next = (uint8_t)(ls->direction + 1u);
    auvid_real_t t_far = AUVID_C(0.0);
    if (fast && !line_search_is_pattern(o)) {
        auvid_line_search_note_slope(o);
        if (next % 2u != 0 && ls->cost < ls->base_cost) {
            ls->alpha[next] = ls->alpha[ls->direction];
            ++next;
        } else if (next % 2u != 0) {
            t_far = -ls->t_near;
        }
    }
    if (next < pattern || (next == pattern && fast && ls->cost < ls->previous_cost)) {
        const auvid_real_t cost = ls->cost_near;
        line_search_begin_line(o, next);
        ls->t_far = t_far;
        ls->cost_far = cost;
    } else {
        line_search_begin_sweep(o);
    }
}

/* Set t to the lowest point of the parabola. With q(t) = J(base) + b t + c t^2, the slope of the
 * chord to a point is s(t) = b + c t. c comes from the last two points, or from an earlier line
 * along d_i. Returns false if no minimum is known, or it is not worth a trial. */
static bool line_search_aim_parabola(auvid_optimizer_t *o)
{
    auvid_line_search_t *ls = &o->line_search;
    const auvid_real_t failed = AUVID_COST_FAILED;
    const auvid_real_t near = (ls->cost_near - ls->base_cost) / ls->t_near;
    auvid_real_t c =
        line_search_is_pattern(o) ? AUVID_C(0.0) : ls->curvature[line_search_parameter(o)];
    if (ls->cost_far < failed && (!(c > AUVID_C(0.0)) || ls->move == MOVE_EXPAND)) {
        c = ((ls->cost_far - ls->base_cost) / ls->t_far - near) / (ls->t_far - ls->t_near);
    }
    if (!(c > AUVID_C(0.0) && c <= AUVID_LARGEST && ls->base_cost < failed &&
          ls->cost_near < failed)) {
        return false;
    }
    if (!line_search_is_pattern(o)) {
        ls->curvature[line_search_parameter(o)] = c;
    }
    ls->t = (ls->t_near - near / c) * AUVID_C(0.5);
    return auvid_abs(ls->t) > o->cfg.epsilon_line && auvid_abs(ls->t) <= SEARCH_BOUND_MAX;
}

/* Make d_i: evaluate the cost along e_i, then the probes, then compare with e_i. Returns false if
 * the line continues with this cost. */
static bool line_search_build_direction(auvid_optimizer_t *o, auvid_real_t cost)
{
    auvid_line_search_t *ls = &o->line_search;
    const size_t i = line_search_parameter(o);
    if (ls->move == MOVE_AXIS) {
        ls->move = MOVE_POLL;
        if (cost >= AUVID_COST_FAILED) { /* -e_i may succeed */
            ls->built = (uint8_t)(ls->built + ls->direction % 2u);
            return false;
        }
        ++ls->built;
        ls->axis_cost = cost;
        ls->axis_step = auvid_line_search_sign(o) * ls->t;
        if (auvid_line_search_probe(o, 0)) {
            return true;
        }
    } else if (ls->move == MOVE_PROBE) {
        auvid_line_search_learn(o, cost);
        if (!auvid_line_search_probe(o, ls->probe + 1u)) {
            ls->move = MOVE_POLL;
            ls->t = auvid_abs(ls->axis_step);
        }
        return true;
    } else if (ls->move == MOVE_POLL && auvid_abs(ls->axis_step) > AUVID_C(0.0) &&
               cost > ls->axis_cost) {
        memset(ls->shear + AUVID_SHEAR(i), 0, i * sizeof *ls->shear);
        line_search_begin_line(o, ls->direction);
        return true;
    }
    ls->axis_step = AUVID_C(0.0);
    return false;
}

/* Process the cost of the trial at t (7-17) and choose the next move. */
static void line_search_take_cost(auvid_optimizer_t *o, auvid_real_t cost)
{
    auvid_line_search_t *ls = &o->line_search;
    const auvid_real_t before = ls->cost;
    if (cost < before) {
        memcpy(ls->theta, o->trial, sizeof ls->theta);
        ls->cost = cost;
    }
    if (line_search_build_direction(o, cost)) {
        return;
    }
    const auvid_real_t t = ls->t;
    const bool along = !line_search_is_pattern(o), extra = ls->move == MOVE_PARABOLA;
    const auvid_real_t min_decrease = along && !extra ? o->cfg.gamma * t * t : AUVID_C(0.0);
    const bool accepted = cost < (ls->move == MOVE_POLL ? ls->base_cost : before) &&
                          (extra || cost <= ls->base_cost - min_decrease);
    if (accepted) {
        ls->t_best = t;
    }
    if (extra) {
        if (accepted && along) {
            ls->alpha[ls->direction] = auvid_max(ls->alpha[ls->direction], auvid_abs(t));
        }
        line_search_next_line(o);
        return;
    }
    if (ls->move == MOVE_EXPAND) {
        ls->t_far = ls->t_near;
        ls->cost_far = ls->cost_near;
    }
    ls->t_near = t;
    ls->cost_near = cost;
    if (along && accepted) { /* (12); a step cut at the box does not shorten alpha */
        ls->alpha[ls->direction] = auvid_max(ls->alpha[ls->direction], t);
    } else if (along && ls->move == MOVE_POLL) { /* (15) */
        ls->alpha[ls->direction] *= o->cfg.sigma;
    }
    if (line_search_is_fast(o) && line_search_aim_parabola(o)) {
        ls->move = MOVE_PARABOLA;
    } else if (accepted && (along || t < PATTERN_MAX)) {
        ls->move = MOVE_EXPAND;
        ls->t = o->cfg.delta * t;
    } else {
        line_search_next_line(o);
    }
}

auvid_status_t auvid_line_search_next(auvid_optimizer_t *o)
{
    if (o->state == AUVID_OPTIMIZER_LOCAL_CONVERGED) {
        return AUVID_FINISHED;
    }
    if (o->work.line_search >= o->cfg.max_evaluations_line) {
        o->state = AUVID_OPTIMIZER_LOCAL_CAPPED;
        return AUVID_EVALUATION_LIMIT;
    }
    ++o->work.attempts;
    if (o->state == AUVID_OPTIMIZER_START) {
        memcpy(o->trial, o->line_search.theta, sizeof o->trial);
    } else if (!auvid_line_search_place(o)) {
        line_search_take_cost(o, o->line_search.move >= MOVE_AXIS ? AUVID_COST_FAILED
                                                                  : o->line_search.cost);
        return AUVID_PENDING;
    }
    return AUVID_OK;
}

void auvid_line_search_take(auvid_optimizer_t *o, auvid_real_t cost)
{
    ++o->work.line_search;
    if (o->state == AUVID_OPTIMIZER_START) {
        o->line_search.cost = cost;
        if (o->certified && !auvid_search_is_certified(o, cost)) {
            line_search_refute(o);
        }
        line_search_begin_sweep(o);
    } else {
        line_search_take_cost(o, cost);
    }
}
