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
 */
#include "auvid_line_search_directions_internal.h"

#include <string.h>

/* Restarts and re-evaluations begin with this fraction of alpha0. */
#define RESTART_STEP AUVID_C(0.1)
/* Longest pattern step: 2^10 sweeps at once. */
#define PATTERN_MAX AUVID_C(1024.0)
/* Largest step of a parameter for which all products are finite in float32. */
#define MAGNITUDE_MAX AUVID_C(1e18)

void auvid_line_search_defaults(auvid_line_search_config_t *cfg, uint8_t n)
{
    if (cfg == NULL) {
        return;
    }
    memset(cfg, 0, sizeof *cfg);
    cfg->n = n;
    cfg->restarts = 1;
    cfg->delta = AUVID_C(2.0);
    cfg->gamma = AUVID_C(1e-6);
}

static auvid_status_t line_search_check_box(const auvid_line_search_config_t *c)
{
    for (size_t i = 0; i < c->n; ++i) {
        if (!(c->lower[i] < c->upper[i])) {
            return AUVID_ERR_BOUNDS;
        }
        if (c->lower[i] < -MAGNITUDE_MAX || c->upper[i] > MAGNITUDE_MAX ||
            c->scale[i] < AUVID_C(0.0) || c->scale[i] > MAGNITUDE_MAX) {
            return AUVID_ERR_RANGE;
        }
    }
    return auvid_line_search_inside(c, c->start) ? AUVID_OK : AUVID_ERR_RANGE;
}

/* alpha0, sigma, epsilon: as given, or the defaults for zero. */
static void line_search_resolve_steps(const auvid_line_search_config_t *c, auvid_real_t step[3])
{
    static const auvid_real_t defaults[2][3] = {{AUVID_C(0.35), AUVID_C(0.09), AUVID_C(3e-6)},
                                                {AUVID_C(0.05), AUVID_C(0.5), AUVID_C(3e-5)}};
    const auvid_real_t given[3] = {c->alpha0, c->sigma, c->epsilon};
    for (size_t i = 0; i < 3; ++i) {
        step[i] =
            auvid_abs(given[i]) > AUVID_C(0.0) ? given[i] : defaults[line_search_is_paper(c)][i];
    }
}

static auvid_status_t line_search_check(const auvid_line_search_config_t *c,
                                        const auvid_real_t step[3])
{
    const auvid_real_t reals[] = {c->alpha0, c->sigma, c->delta, c->gamma, c->epsilon};
    if (c->n < 1 || c->n > AUVID_MAX_PARAMETERS) {
        return AUVID_ERR_PARAMETERS;
    }
    if (!auvid_all_finite(reals, 5) || !auvid_all_finite(c->lower, c->n) ||
        !auvid_all_finite(c->upper, c->n) || !auvid_all_finite(c->scale, c->n) ||
        !auvid_all_finite(c->start, c->n)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (!(step[2] > AUVID_C(0.0) && step[2] <= AUVID_C(1e-3)) ||
        !(step[0] > step[2] && step[0] <= AUVID_C(1e3)) ||
        !(step[1] > AUVID_C(0.0) && step[1] < AUVID_C(1.0)) ||
        !(c->delta > AUVID_C(1.0) && c->delta <= AUVID_C(100.0)) ||
        !(c->gamma >= AUVID_C(0.0) && c->gamma < AUVID_C(1.0))) {
        return AUVID_ERR_RANGE;
    }
    return line_search_check_box(c);
}

static void line_search_raise_steps(auvid_line_search_t *ls, auvid_real_t alpha)
{
    for (size_t i = 0; i < 2u * ls->cfg.n; ++i) {
        ls->alpha[i] = auvid_max(ls->alpha[i], alpha);
    }
}

auvid_status_t auvid_line_search_init(auvid_line_search_t *ls,
                                      const auvid_line_search_config_t *cfg)
{
    if (ls == NULL || cfg == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_real_t step[3];
    line_search_resolve_steps(cfg, step);
    auvid_status_t status = line_search_check(cfg, step);
    if (status != AUVID_OK) {
        return status;
    }
    auvid_line_search_config_t *c = &ls->cfg;
    memset(ls, 0, sizeof *ls);
    *c = *cfg;
    c->alpha0 = step[0];
    c->sigma = step[1];
    c->epsilon = step[2];
    if (c->max_evaluations == 0) {
        c->max_evaluations = 1000u * c->n;
    }
    for (size_t i = 0; i < c->n; ++i) {
        if (!(c->scale[i] > AUVID_C(0.0))) {
            c->scale[i] = (c->upper[i] - c->lower[i]) * AUVID_C(0.5);
        }
    }
    memcpy(ls->theta, c->start, sizeof ls->theta);
    line_search_raise_steps(ls, c->alpha0);
    ls->restarts_left = c->restarts;
    ls->state = LINE_EVALUATE;
    return AUVID_OK;
}

static void line_search_begin_line(auvid_line_search_t *ls, uint8_t direction)
{
    ls->direction = direction;
    ls->move = MOVE_POLL;
    memcpy(ls->base, ls->theta, sizeof ls->base);
    memcpy(ls->trial, ls->theta, sizeof ls->trial); /* a line moves only some parameters */
    ls->base_cost = ls->cost;
    ls->t = line_search_is_pattern(ls) ? AUVID_C(1.0) : ls->alpha[direction];
    ls->t_best = ls->t_near = ls->t_far = ls->axis_step = AUVID_C(0.0);
    if (line_search_is_pattern(ls) || line_search_is_paper(&ls->cfg)) {
        return;
    }
    if (line_search_parameter(ls) == ls->built) {
        memset(ls->shear + AUVID_SHEAR(ls->built), 0, ls->built * sizeof *ls->shear);
        ls->curvature[ls->built] = AUVID_C(0.0);
        ls->move = MOVE_AXIS;
    }
    auvid_line_search_release(ls);
}

/* (3-6) At the end of a sweep, and before the first. */
static void line_search_begin_sweep(auvid_line_search_t *ls)
{
    const bool first = !line_search_is_paper(&ls->cfg) && ls->restarts_left == ls->cfg.restarts &&
                       ls->state == LINE_SEARCH;
    auvid_real_t longest = AUVID_C(0.0), last = ls->cfg.epsilon;
    for (size_t i = 0; i < 2u * ls->cfg.n; ++i) {
        longest = auvid_max(longest, ls->alpha[i]);
    }
    if (first && ls->restarts_left > 0) {
        last = RESTART_STEP * ls->cfg.alpha0; /* the restart does the rest */
    }
    if (ls->plain && ls->previous_cost - ls->cost > ls->cfg.gamma) {
        ls->built = 0; /* the directions are no longer conjugate */
        ls->restarts_left = ls->cfg.restarts;
        line_search_raise_steps(ls, RESTART_STEP * ls->cfg.alpha0);
    } else if (longest <= last) {
        if (ls->restarts_left == 0) {
            ls->state = LINE_FINISHED;
            return;
        }
        --ls->restarts_left;
        line_search_raise_steps(ls, RESTART_STEP * ls->cfg.alpha0);
        ls->built = ls->cfg.n; /* now along e_i */
        memset(ls->shear, 0, sizeof ls->shear);
        memset(ls->curvature, 0, sizeof ls->curvature);
    }
    ls->plain = ls->built == ls->cfg.n && !line_search_is_paper(&ls->cfg);
    ls->state = LINE_SEARCH;
    memcpy(ls->previous, ls->theta, sizeof ls->previous);
    ls->previous_cost = ls->cost;
    line_search_begin_line(ls, 0);
}

/* (18-21) and the pattern step. -d_i is skipped if +d_i has moved; otherwise it uses the cost of
 * +d_i. */
static void line_search_next_line(auvid_line_search_t *ls)
{
    const uint8_t pattern = (uint8_t)(2u * ls->cfg.n);
    const bool fast = !line_search_is_paper(&ls->cfg);
    uint8_t next = (uint8_t)(ls->direction + 1u);
    auvid_real_t t_far = AUVID_C(0.0);
    if (fast && !line_search_is_pattern(ls)) {
        auvid_line_search_note_slope(ls);
        if (next % 2u != 0 && ls->cost < ls->base_cost) {
            ls->alpha[next] = ls->alpha[ls->direction];
            ++next;
        } else if (next % 2u != 0) {
            t_far = -ls->t_near;
        }
    }
    if (next < pattern || (next == pattern && fast && ls->cost < ls->previous_cost)) {
        const auvid_real_t cost = ls->cost_near;
        line_search_begin_line(ls, next);
        ls->t_far = t_far;
        ls->cost_far = cost;
    } else {
        line_search_begin_sweep(ls);
    }
}

/* Set t to the lowest point of the parabola. With q(t) = J(base) + b t + c t^2, the slope of the
 * chord to a point is s(t) = b + c t. c comes from the last two points, or from an earlier line
 * along d_i. Returns false if no minimum is known, or it is not worth a trial. */
static bool line_search_aim_parabola(auvid_line_search_t *ls)
{
    const auvid_real_t failed = AUVID_LINE_SEARCH_COST_FAILED;
    const auvid_real_t near = (ls->cost_near - ls->base_cost) / ls->t_near;
    auvid_real_t c =
        line_search_is_pattern(ls) ? AUVID_C(0.0) : ls->curvature[line_search_parameter(ls)];
    if (ls->cost_far < failed && (!(c > AUVID_C(0.0)) || ls->move == MOVE_EXPAND)) {
        c = ((ls->cost_far - ls->base_cost) / ls->t_far - near) / (ls->t_far - ls->t_near);
    }
    if (!(c > AUVID_C(0.0) && c <= AUVID_LARGEST && ls->base_cost < failed &&
          ls->cost_near < failed)) {
        return false;
    }
    if (!line_search_is_pattern(ls)) {
        ls->curvature[line_search_parameter(ls)] = c;
    }
    ls->t = (ls->t_near - near / c) * AUVID_C(0.5);
    return auvid_abs(ls->t) > ls->cfg.epsilon && auvid_abs(ls->t) <= MAGNITUDE_MAX;
}

/* Make d_i: evaluate the cost along e_i, then the probes, then compare with e_i. Returns false if
 * the line continues with this cost. */
static bool line_search_build_direction(auvid_line_search_t *ls, auvid_real_t cost)
{
    const size_t i = line_search_parameter(ls);
    if (ls->move == MOVE_AXIS) {
        ls->move = MOVE_POLL;
        if (cost >= AUVID_LINE_SEARCH_COST_FAILED) { /* -e_i may succeed */
            ls->built = (uint8_t)(ls->built + ls->direction % 2u);
            return false;
        }
        ++ls->built;
        ls->axis_cost = cost;
        ls->axis_step = line_search_sign(ls) * ls->t;
        if (auvid_line_search_probe(ls, 0)) {
            return true;
        }
    } else if (ls->move == MOVE_PROBE) {
        auvid_line_search_learn(ls, cost);
        if (!auvid_line_search_probe(ls, ls->probe + 1u)) {
            ls->move = MOVE_POLL;
            ls->t = auvid_abs(ls->axis_step);
        }
        return true;
    } else if (ls->move == MOVE_POLL && auvid_abs(ls->axis_step) > AUVID_C(0.0) &&
               cost > ls->axis_cost) {
        memset(ls->shear + AUVID_SHEAR(i), 0, i * sizeof *ls->shear);
        line_search_begin_line(ls, ls->direction);
        return true;
    }
    ls->axis_step = AUVID_C(0.0);
    return false;
}

/* Process the cost of the trial at t (7-17) and choose the next move. */
static void line_search_take_cost(auvid_line_search_t *ls, auvid_real_t cost)
{
    const auvid_real_t before = ls->cost;
    if (cost < before) {
        memcpy(ls->theta, ls->trial, sizeof ls->theta);
        ls->cost = cost;
    }
    if (line_search_build_direction(ls, cost)) {
        return;
    }
    const auvid_real_t t = ls->t;
    const bool along = !line_search_is_pattern(ls), extra = ls->move == MOVE_PARABOLA;
    const auvid_real_t min_decrease = along && !extra ? ls->cfg.gamma * t * t : AUVID_C(0.0);
    const bool accepted = cost < (ls->move == MOVE_POLL ? ls->base_cost : before) &&
                          (extra || cost <= ls->base_cost - min_decrease);
    if (accepted) {
        ls->t_best = t;
    }
    if (extra) {
        if (accepted && along) {
            ls->alpha[ls->direction] = auvid_max(ls->alpha[ls->direction], auvid_abs(t));
        }
        line_search_next_line(ls);
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
        ls->alpha[ls->direction] *= ls->cfg.sigma;
    }
    if (!line_search_is_paper(&ls->cfg) && line_search_aim_parabola(ls)) {
        ls->move = MOVE_PARABOLA;
    } else if (accepted && (along || t < PATTERN_MAX)) {
        ls->move = MOVE_EXPAND;
        ls->t = ls->cfg.delta * t;
    } else {
        line_search_next_line(ls);
    }
}

auvid_status_t auvid_line_search_ask(auvid_line_search_t *ls, auvid_real_t *theta)
{
    if (ls == NULL || theta == NULL) {
        return AUVID_ERR_NULL;
    }
    if (ls->state == LINE_NONE) {
        return AUVID_ERR_STATE;
    }
    if (!ls->asked) {
        if (ls->state == LINE_FINISHED) {
            return AUVID_FINISHED;
        }
        if (ls->state == LINE_CAPPED || ls->evaluations >= ls->cfg.max_evaluations) {
            ls->state = LINE_CAPPED;
            return AUVID_EVALUATION_LIMIT;
        }
        ++ls->attempts;
        if (ls->state == LINE_EVALUATE) {
            memcpy(ls->trial, ls->theta, sizeof ls->trial);
        } else if (!auvid_line_search_place(ls)) {
            line_search_take_cost(ls,
                                  ls->move >= MOVE_AXIS ? AUVID_LINE_SEARCH_COST_FAILED : ls->cost);
            return AUVID_PENDING;
        }
        ls->asked = true;
    }
    memcpy(theta, ls->trial, ls->cfg.n * sizeof *theta);
    return AUVID_OK;
}

auvid_status_t auvid_line_search_tell(auvid_line_search_t *ls, auvid_real_t cost)
{
    if (ls == NULL) {
        return AUVID_ERR_NULL;
    }
    if (!ls->asked) {
        return AUVID_ERR_STATE;
    }
    if (!(cost >= -AUVID_LINE_SEARCH_COST_FAILED && cost <= AUVID_LINE_SEARCH_COST_FAILED)) {
        cost = AUVID_LINE_SEARCH_COST_FAILED;
    }
    ls->asked = false;
    ++ls->evaluations;
    if (ls->state == LINE_EVALUATE) {
        ls->cost = cost;
        line_search_begin_sweep(ls);
    } else {
        line_search_take_cost(ls, cost);
    }
    return AUVID_OK;
}

auvid_status_t auvid_line_search_reevaluate(auvid_line_search_t *ls)
{
    if (ls == NULL) {
        return AUVID_ERR_NULL;
    }
    if (ls->state == LINE_NONE) {
        return AUVID_ERR_STATE;
    }
    ls->asked = false;
    line_search_raise_steps(ls, RESTART_STEP * ls->cfg.alpha0);
    ls->plain = false;
    if (!line_search_is_paper(&ls->cfg)) {
        ls->restarts_left = ls->cfg.restarts;
    }
    ls->state = LINE_EVALUATE;
    return AUVID_OK;
}

const auvid_real_t *auvid_line_search_best(const auvid_line_search_t *ls, auvid_real_t *cost)
{
    if (ls == NULL || ls->state == LINE_NONE || ls->evaluations == 0) {
        return NULL;
    }
    if (cost != NULL) {
        *cost = ls->cost;
    }
    return ls->theta;
}
