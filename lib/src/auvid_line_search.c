/*
 * Coordinate search with line-search expansions, Algorithm 2 of Karras et al., IROS 2013, after
 * Lucidi and Sciandrone 2002. Numbers in parentheses are the lines of Algorithm 2.
 *
 * One line search serves the 2n directions and the pattern step: from base along d,
 *     trial(t) = base + t d, cut at the box,   d = +-scale_i e_i  or  base - previous
 *     POLL     t = alpha_i (pattern: 1); must pass both tests:
 *                  J(trial) <= J(base) - gamma t^2   and   J(trial) < J(theta)
 *     EXPAND   t = delta t while both hold
 *     PARABOLA q(t) = J(base) + b t + c t^2 through the points of the line; t = -b / (2 c)
 * The iterate of the paper, x^k, is theta here.
 */
#include "auvid/line_search.h"

#include <string.h>

#include "auvid_math.h"

enum { STATE_NONE = 0, STATE_EVALUATE, STATE_SEARCH, STATE_FINISHED, STATE_CAPPED };
enum { MOVE_POLL = 0, MOVE_EXPAND, MOVE_PARABOLA, MOVE_AXIS, MOVE_PROBE };

/* Where the row of d_i stands in shear. */
#define SHEAR(i) ((i) * ((i) - 1u) / 2u * ((i) > 0))

/* Restarts and re-evaluations begin with this part of alpha0. */
#define RESTART_STEP AUVID_C(0.1)
/* More of d_k for one of e_i is rounding. */
#define SHARE_MAX AUVID_C(1e6)
/* Longest pattern step: 2^10 sweeps at once. */
#define PATTERN_MAX AUVID_C(1024.0)
/* Largest step by parameter, at which all products stay finite in float32. */
#define MAGNITUDE_MAX AUVID_C(1e18)

void auvid_line_search_defaults(auvid_line_search_config_t *config, uint8_t n)
{
    if (config == NULL) {
        return;
    }
    memset(config, 0, sizeof *config);
    config->n = n;
    config->restarts = 1;
    config->delta = AUVID_C(2.0);
    config->gamma = AUVID_C(1e-6);
}

static bool inside(const auvid_line_search_config_t *c, const auvid_real_t *theta)
{
    for (size_t i = 0; i < c->n; ++i) {
        if (!(theta[i] >= c->lower[i] && theta[i] <= c->upper[i])) {
            return false;
        }
    }
    return true;
}

static auvid_status_t check_box(const auvid_line_search_config_t *c)
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
    return inside(c, c->start) ? AUVID_OK : AUVID_ERR_RANGE;
}

static auvid_real_t given_or(auvid_real_t given, auvid_real_t usual)
{
    return given < AUVID_C(0.0) || given > AUVID_C(0.0) ? given : usual;
}

static auvid_real_t first_step(const auvid_line_search_config_t *c)
{
    return given_or(c->alpha0, c->literal ? AUVID_C(0.05) : AUVID_C(0.35));
}

static auvid_real_t contraction(const auvid_line_search_config_t *c)
{
    return given_or(c->sigma, c->literal ? AUVID_C(0.5) : AUVID_C(0.09));
}

static auvid_real_t last_step(const auvid_line_search_config_t *c)
{
    return given_or(c->epsilon, c->literal ? AUVID_C(3e-5) : AUVID_C(3e-6));
}

static auvid_status_t check(const auvid_line_search_config_t *c)
{
    const auvid_real_t alpha0 = first_step(c), sigma = contraction(c), epsilon = last_step(c);
    const auvid_real_t reals[] = {c->alpha0, c->sigma, c->delta, c->gamma, c->epsilon};
    if (c->n < 1 || c->n > AUVID_MAX_PARAMETERS) {
        return AUVID_ERR_PARAMETERS;
    }
    if (!auvid_all_finite(reals, 5) || !auvid_all_finite(c->lower, c->n) ||
        !auvid_all_finite(c->upper, c->n) || !auvid_all_finite(c->scale, c->n) ||
        !auvid_all_finite(c->start, c->n)) {
        return AUVID_ERR_NOT_FINITE;
    }
    if (!(epsilon > AUVID_C(0.0) && epsilon <= AUVID_C(1e-3)) ||
        !(alpha0 > epsilon && alpha0 <= AUVID_C(1e3)) ||
        !(sigma > AUVID_C(0.0) && sigma < AUVID_C(1.0)) ||
        !(c->delta > AUVID_C(1.0) && c->delta <= AUVID_C(100.0)) ||
        !(c->gamma >= AUVID_C(0.0) && c->gamma < AUVID_C(1.0))) {
        return AUVID_ERR_RANGE;
    }
    return check_box(c);
}

static void set_steps(auvid_line_search_t *ls, auvid_real_t alpha)
{
    for (size_t i = 0; i < 2u * ls->config.n; ++i) {
        ls->alpha[i] = auvid_max(ls->alpha[i], alpha);
    }
}

auvid_status_t auvid_line_search_init(auvid_line_search_t *ls,
                                      const auvid_line_search_config_t *config)
{
    if (ls == NULL || config == NULL) {
        return AUVID_ERR_NULL;
    }
    auvid_status_t status = check(config);
    if (status != AUVID_OK) {
        return status;
    }
    auvid_line_search_config_t *c = &ls->config;
    memset(ls, 0, sizeof *ls);
    *c = *config;
    c->alpha0 = first_step(config);
    c->sigma = contraction(config);
    c->epsilon = last_step(config);
    if (c->max_evaluations == 0) {
        c->max_evaluations = 1000u * c->n;
    }
    for (size_t i = 0; i < c->n; ++i) {
        if (!(c->scale[i] > AUVID_C(0.0))) {
            c->scale[i] = (c->upper[i] - c->lower[i]) * AUVID_C(0.5);
        }
    }
    memcpy(ls->theta, c->start, sizeof ls->theta);
    set_steps(ls, c->alpha0);
    ls->restarts_left = c->restarts;
    ls->state = STATE_EVALUATE;
    return AUVID_OK;
}

static bool is_pattern(const auvid_line_search_t *ls)
{
    return ls->direction == 2u * ls->config.n;
}

/* To the letter +e_1..+e_n, -e_1..-e_n; else +d_1, -d_1, +d_2, -d_2 .. */
static size_t parameter(const auvid_line_search_t *ls)
{
    const size_t n = ls->config.n, d = ls->direction;
    return !ls->config.literal ? d / 2u : (d < n ? d : d - n);
}

static auvid_real_t sign(const auvid_line_search_t *ls)
{
    const bool minus = ls->config.literal ? ls->direction >= ls->config.n : ls->direction % 2u != 0;
    return minus ? AUVID_C(-1.0) : AUVID_C(1.0);
}

/* Of d_i, along parameter k <= i [parameter's unit]. */
static auvid_real_t component(const auvid_line_search_t *ls, size_t i, size_t k)
{
    const auvid_real_t unit = ls->config.scale[k];
    return k == i ? unit : unit * ls->shear[SHEAR(i) + k];
}

/* trial = base + axis_step e_i + t d_probe, or with -t. False if neither is in the box. */
static bool place_probe(auvid_line_search_t *ls)
{
    for (int side = 0; side < 2; ++side) {
        const size_t i = parameter(ls);
        memcpy(ls->trial, ls->base, sizeof ls->trial);
        ls->trial[i] += ls->axis_step * ls->config.scale[i];
        for (size_t k = 0; k <= ls->probe; ++k) {
            ls->trial[k] += ls->t * component(ls, ls->probe, k);
        }
        if (inside(&ls->config, ls->trial)) {
            return true;
        }
        ls->t = -ls->t;
    }
    return false;
}

/* trial = base + t d_i; t becomes the step that the box leaves. */
static void place_along(auvid_line_search_t *ls)
{
    const auvid_line_search_config_t *c = &ls->config;
    const size_t i = parameter(ls), first = c->literal ? i : 0;
    size_t bound = AUVID_MAX_PARAMETERS;
    auvid_real_t d = AUVID_C(0.0), to = AUVID_C(0.0);
    memcpy(ls->trial, ls->base, sizeof ls->trial);
    for (size_t k = first; k <= i; ++k) {
        d = sign(ls) * component(ls, i, k);
        const auvid_real_t x = ls->base[k] + ls->t * d;
        if (!(x >= c->lower[k] && x <= c->upper[k])) {
            bound = k;
            to = auvid_clamp(x, c->lower[k], c->upper[k]);
            ls->t = (to - ls->base[k]) / d;
        }
    }
    for (size_t k = first; k <= i; ++k) {
        const auvid_real_t x = ls->base[k] + ls->t * (sign(ls) * component(ls, i, k));
        ls->trial[k] = k == bound ? to : auvid_clamp(x, c->lower[k], c->upper[k]);
    }
    if (c->literal) {
        ls->t = (ls->trial[i] - ls->base[i]) / d;
    }
}

/* trial = base + t d. False if that is where the iterate already is. */
static bool place(auvid_line_search_t *ls)
{
    const auvid_line_search_config_t *c = &ls->config;
    bool moved = false;
    if (ls->move == MOVE_PROBE) {
        return place_probe(ls);
    }
    if (is_pattern(ls)) {
        for (size_t i = 0; i < c->n; ++i) {
            auvid_real_t x = ls->base[i] + ls->t * (ls->base[i] - ls->previous[i]);
            ls->trial[i] = auvid_clamp(x, c->lower[i], c->upper[i]);
        }
    } else {
        place_along(ls);
    }
    for (size_t i = 0; i < c->n; ++i) {
        moved = moved || ls->trial[i] < ls->theta[i] || ls->trial[i] > ls->theta[i];
    }
    return moved;
}

/* A parameter that leaves next to no room to d_i leaves d_i instead: the others can move. */
static void release(auvid_line_search_t *ls)
{
    const auvid_line_search_config_t *c = &ls->config;
    const size_t i = parameter(ls);
    for (size_t k = 0; k < i; ++k) {
        const auvid_real_t d = sign(ls) * component(ls, i, k);
        const auvid_real_t x = ls->base[k] + c->sigma * ls->t * d;
        if (!(x >= c->lower[k] && x <= c->upper[k])) {
            ls->shear[SHEAR(i) + k] = AUVID_C(0.0);
            ls->curvature[i] = AUVID_C(0.0);
        }
    }
}

static void begin_line(auvid_line_search_t *ls, uint8_t direction)
{
    ls->direction = direction;
    ls->move = MOVE_POLL;
    memcpy(ls->base, ls->theta, sizeof ls->base);
    ls->base_cost = ls->cost;
    ls->t = is_pattern(ls) ? AUVID_C(1.0) : ls->alpha[direction];
    ls->t_best = ls->t_near = ls->t_far = ls->axis_step = AUVID_C(0.0);
    if (is_pattern(ls) || ls->config.literal) {
        return;
    }
    if (parameter(ls) == ls->built) {
        memset(ls->shear + SHEAR(ls->built), 0, ls->built * sizeof *ls->shear);
        ls->curvature[ls->built] = AUVID_C(0.0);
        ls->move = MOVE_AXIS;
    }
    release(ls);
}

/* (3-6) At the end of a sweep, and before the first. */
static void begin_sweep(auvid_line_search_t *ls)
{
    const bool first = !ls->config.literal && ls->restarts_left == ls->config.restarts;
    auvid_real_t longest = AUVID_C(0.0), last = ls->config.epsilon;
    for (size_t i = 0; i < 2u * ls->config.n; ++i) {
        longest = auvid_max(longest, ls->alpha[i]);
    }
    if (first && ls->restarts_left > 0) {
        last = RESTART_STEP * ls->config.alpha0; /* the rest is for the restart */
    }
    if (ls->plain && ls->previous_cost - ls->cost > ls->config.gamma) {
        ls->built = 0; /* the directions are not conjugate any more */
        set_steps(ls, RESTART_STEP * ls->config.alpha0);
    } else if (longest <= last) {
        if (ls->restarts_left == 0) {
            ls->state = STATE_FINISHED;
            return;
        }
        --ls->restarts_left;
        set_steps(ls, RESTART_STEP * ls->config.alpha0);
        ls->built = ls->config.n; /* now along e_i */
        memset(ls->shear, 0, sizeof ls->shear);
        memset(ls->curvature, 0, sizeof ls->curvature);
    }
    ls->plain = ls->built == ls->config.n && !ls->config.literal;
    ls->state = STATE_SEARCH;
    memcpy(ls->previous, ls->theta, sizeof ls->previous);
    ls->previous_cost = ls->cost;
    begin_line(ls, 0);
}

/* The slope along d_i where the line ends: that of the chord to a point of it, and the bend. */
static void note_slope(auvid_line_search_t *ls)
{
    const size_t i = parameter(ls);
    const auvid_real_t c = ls->curvature[i], t = ls->t_near;
    if (auvid_abs(t) > AUVID_C(0.0) && c > AUVID_C(0.0)) {
        const auvid_real_t chord = (ls->cost_near - ls->base_cost) / t;
        ls->slope[i] = sign(ls) * (chord + c * (AUVID_C(2.0) * ls->t_best - t));
    }
}

/* (18-21) and the pattern step. -d_i need not be tried when +d_i has moved; else it knows what
 * +d_i has cost. */
static void next_line(auvid_line_search_t *ls)
{
    const uint8_t pattern = (uint8_t)(2u * ls->config.n);
    const bool fast = !ls->config.literal;
    uint8_t next = (uint8_t)(ls->direction + 1u);
    auvid_real_t t_far = AUVID_C(0.0);
    if (fast && !is_pattern(ls)) {
        note_slope(ls);
        if (next % 2u != 0 && ls->cost < ls->base_cost) {
            ls->alpha[next] = ls->alpha[ls->direction];
            ++next;
        } else if (next % 2u != 0) {
            t_far = -ls->t_near;
        }
    }
    if (next < pattern || (next == pattern && fast && ls->cost < ls->previous_cost)) {
        const auvid_real_t cost = ls->cost_near;
        begin_line(ls, next);
        ls->t_far = t_far;
        ls->cost_far = cost;
    } else {
        begin_sweep(ls);
    }
}

/* Set t to the lowest point of the parabola. With q(t) = J(base) + b t + c t^2, the slope of the
 * chord to a point is s(t) = b + c t. c comes from the last two points, or is what an earlier line
 * along d_i found. False if no minimum is known of, or it is not worth a trial. */
static bool aim(auvid_line_search_t *ls)
{
    const auvid_real_t failed = AUVID_LINE_SEARCH_COST_FAILED;
    const auvid_real_t near = (ls->cost_near - ls->base_cost) / ls->t_near;
    auvid_real_t c = is_pattern(ls) ? AUVID_C(0.0) : ls->curvature[parameter(ls)];
    if (!(c > AUVID_C(0.0)) || (ls->move == MOVE_EXPAND && ls->cost_far < failed)) {
        c = ((ls->cost_far - ls->base_cost) / ls->t_far - near) / (ls->t_far - ls->t_near);
    }
    if (!(c > AUVID_C(0.0) && c <= AUVID_LARGEST && ls->base_cost < failed &&
          ls->cost_near < failed)) {
        return false;
    }
    if (!is_pattern(ls)) {
        ls->curvature[parameter(ls)] = c;
    }
    ls->t = (ls->t_near - near / c) * AUVID_C(0.5);
    return auvid_abs(ls->t) > ls->config.epsilon && auvid_abs(ls->t) <= MAGNITUDE_MAX;
}

/* Probe the next direction from k on along which d_i may be skew. False if there is none. */
static bool probe(auvid_line_search_t *ls, size_t k)
{
    while (k < parameter(ls) && !(ls->curvature[k] > AUVID_C(0.0))) {
        ++k;
    }
    if (k == parameter(ls)) {
        return false;
    }
    ls->probe = (uint8_t)k;
    ls->move = MOVE_PROBE;
    ls->t = ls->alpha[2u * k];
    return true;
}

/* The probe's cost tells how far the minimum along d_k has gone with the step along e_i: d_i goes
 * there. */
static void learn(auvid_line_search_t *ls, auvid_real_t cost)
{
    const size_t i = parameter(ls), k = ls->probe;
    const auvid_real_t c = ls->curvature[k];
    const auvid_real_t slope = (cost - ls->axis_cost) / ls->t - c * ls->t - ls->slope[k];
    const auvid_real_t share = AUVID_C(-0.5) * slope / (c * ls->axis_step);
    if (cost < AUVID_LINE_SEARCH_COST_FAILED && auvid_abs(share) <= SHARE_MAX) {
        for (size_t j = 0; j < k; ++j) {
            ls->shear[SHEAR(i) + j] += share * ls->shear[SHEAR(k) + j];
        }
        ls->shear[SHEAR(i) + k] += share;
    }
}

/* Make d_i: the cost along e_i, then the probes, then whether it is better than e_i. False when the
 * line is to go on with this cost. */
static bool build(auvid_line_search_t *ls, auvid_real_t cost)
{
    const size_t i = parameter(ls);
    if (ls->move == MOVE_AXIS) {
        ls->move = MOVE_POLL;
        if (cost >= AUVID_LINE_SEARCH_COST_FAILED && ls->direction % 2u == 0) {
            return false; /* -e_i may do */
        }
        ++ls->built;
        ls->axis_cost = cost;
        ls->axis_step = sign(ls) * ls->t;
        if (probe(ls, 0)) {
            return true;
        }
    } else if (ls->move == MOVE_PROBE) {
        learn(ls, cost);
        if (!probe(ls, ls->probe + 1u)) {
            ls->move = MOVE_POLL;
            ls->t = auvid_abs(ls->axis_step);
        }
        return true;
    } else if (ls->move == MOVE_POLL && auvid_abs(ls->axis_step) > AUVID_C(0.0) &&
               cost > ls->axis_cost) {
        memset(ls->shear + SHEAR(i), 0, i * sizeof *ls->shear);
        begin_line(ls, ls->direction);
        return true;
    }
    ls->axis_step = AUVID_C(0.0);
    return false;
}

/* The trial at t has this cost (7-17): move on. */
static void settle(auvid_line_search_t *ls, auvid_real_t cost)
{
    const auvid_real_t before = ls->cost;
    if (cost < before) {
        memcpy(ls->theta, ls->trial, sizeof ls->theta);
        ls->cost = cost;
    }
    if (build(ls, cost)) {
        return;
    }
    const auvid_real_t t = ls->t;
    const bool along = !is_pattern(ls), extra = ls->move == MOVE_PARABOLA;
    const auvid_real_t least = along && !extra ? ls->config.gamma * t * t : AUVID_C(0.0);
    const bool accepted = cost < (ls->move == MOVE_POLL ? ls->base_cost : before) &&
                          (extra || cost <= ls->base_cost - least);
    if (accepted) {
        ls->t_best = t;
    }
    if (extra) {
        if (accepted && along) {
            ls->alpha[ls->direction] = auvid_max(ls->alpha[ls->direction], auvid_abs(t));
        }
        next_line(ls);
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
        ls->alpha[ls->direction] *= ls->config.sigma;
    }
    if (!ls->config.literal && aim(ls)) {
        ls->move = MOVE_PARABOLA;
    } else if (accepted && (along || t < PATTERN_MAX)) {
        ls->move = MOVE_EXPAND;
        ls->t = ls->config.delta * t;
    } else {
        next_line(ls);
    }
}

auvid_status_t auvid_line_search_ask(auvid_line_search_t *ls, auvid_real_t *theta)
{
    if (ls == NULL || theta == NULL) {
        return AUVID_ERR_NULL;
    }
    if (ls->state == STATE_NONE) {
        return AUVID_ERR_STATE;
    }
    if (!ls->asked) {
        if (ls->state == STATE_FINISHED) {
            return AUVID_FINISHED;
        }
        if (ls->state == STATE_CAPPED || ls->evaluations >= ls->config.max_evaluations) {
            ls->state = STATE_CAPPED;
            return AUVID_CAPPED;
        }
        ++ls->attempts;
        if (ls->state == STATE_EVALUATE) {
            memcpy(ls->trial, ls->theta, sizeof ls->trial);
        } else if (!place(ls)) {
            settle(ls, ls->move >= MOVE_AXIS ? AUVID_LINE_SEARCH_COST_FAILED : ls->cost);
            return AUVID_PENDING;
        }
        ls->asked = true;
    }
    memcpy(theta, ls->trial, ls->config.n * sizeof *theta);
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
    if (ls->state == STATE_EVALUATE) {
        ls->cost = cost;
        begin_sweep(ls);
    } else {
        settle(ls, cost);
    }
    return AUVID_OK;
}

auvid_status_t auvid_line_search_reevaluate(auvid_line_search_t *ls)
{
    if (ls == NULL) {
        return AUVID_ERR_NULL;
    }
    if (ls->state == STATE_NONE) {
        return AUVID_ERR_STATE;
    }
    ls->asked = false;
    set_steps(ls, RESTART_STEP * ls->config.alpha0);
    ls->plain = false;
    if (!ls->config.literal) {
        ls->restarts_left = ls->config.restarts;
    }
    ls->state = STATE_EVALUATE;
    return AUVID_OK;
}

const auvid_real_t *auvid_line_search_best(const auvid_line_search_t *ls, auvid_real_t *cost)
{
    if (ls == NULL || ls->state == STATE_NONE || ls->evaluations == 0) {
        return NULL;
    }
    if (cost != NULL) {
        *cost = ls->cost;
    }
    return ls->theta;
}
