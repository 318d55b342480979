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
enum { MOVE_POLL = 0, MOVE_EXPAND, MOVE_PARABOLA };

/* Restarts and re-evaluations begin with this part of alpha0. */
#define RESTART_STEP AUVID_C(0.1)
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
    config->alpha0 = AUVID_C(0.05);
    config->sigma = AUVID_C(0.5);
    config->delta = AUVID_C(2.0);
    config->gamma = AUVID_C(1e-6);
    config->epsilon = AUVID_C(3e-5);
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

static auvid_status_t check(const auvid_line_search_config_t *c)
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
    if (!(c->epsilon > AUVID_C(0.0) && c->epsilon <= AUVID_C(1e-3)) ||
        !(c->alpha0 > c->epsilon && c->alpha0 <= AUVID_C(1e3)) ||
        !(c->sigma > AUVID_C(0.0) && c->sigma < AUVID_C(1.0)) ||
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

static size_t parameter(const auvid_line_search_t *ls)
{
    return ls->direction < ls->config.n ? ls->direction : (size_t)ls->direction - ls->config.n;
}

/* trial = base + t d, cut at the box; for a single parameter t becomes the step that remains.
 * False if that is where the iterate already is. */
static bool place(auvid_line_search_t *ls)
{
    const auvid_line_search_config_t *c = &ls->config;
    if (is_pattern(ls)) {
        bool moved = false;
        for (size_t i = 0; i < c->n; ++i) {
            auvid_real_t x = ls->base[i] + ls->t * (ls->base[i] - ls->previous[i]);
            ls->trial[i] = auvid_clamp(x, c->lower[i], c->upper[i]);
            moved = moved || ls->trial[i] < ls->theta[i] || ls->trial[i] > ls->theta[i];
        }
        return moved;
    }
    size_t i = parameter(ls);
    auvid_real_t unit = ls->direction < c->n ? c->scale[i] : -c->scale[i];
    auvid_real_t x = auvid_clamp(ls->base[i] + ls->t * unit, c->lower[i], c->upper[i]);
    memcpy(ls->trial, ls->base, c->n * sizeof *ls->trial);
    ls->trial[i] = x;
    ls->t = (x - ls->base[i]) / unit;
    return x < ls->theta[i] || x > ls->theta[i];
}

static void begin_line(auvid_line_search_t *ls, uint8_t direction)
{
    ls->direction = direction;
    ls->move = MOVE_POLL;
    memcpy(ls->base, ls->theta, sizeof ls->base);
    ls->base_cost = ls->cost;
    ls->t = is_pattern(ls) ? AUVID_C(1.0) : ls->alpha[direction];
    ls->t_far = AUVID_C(0.0);
}

/* (3-6) At the end of a sweep, and before the first. */
static void begin_sweep(auvid_line_search_t *ls)
{
    auvid_real_t longest = AUVID_C(0.0);
    for (size_t i = 0; i < 2u * ls->config.n; ++i) {
        longest = auvid_max(longest, ls->alpha[i]);
    }
    if (longest <= ls->config.epsilon) {
        if (ls->restarts_left == 0) {
            ls->state = STATE_FINISHED;
            return;
        }
        --ls->restarts_left;
        set_steps(ls, RESTART_STEP * ls->config.alpha0);
    }
    ls->state = STATE_SEARCH;
    memcpy(ls->previous, ls->theta, sizeof ls->previous);
    ls->previous_cost = ls->cost;
    begin_line(ls, 0);
}

/* (18-21) and the pattern step. */
static void next_line(auvid_line_search_t *ls)
{
    const uint8_t pattern = (uint8_t)(2u * ls->config.n);
    const uint8_t next = (uint8_t)(ls->direction + 1u);
    if (next < pattern ||
        (next == pattern && !ls->config.literal && ls->cost < ls->previous_cost)) {
        begin_line(ls, next);
    } else {
        begin_sweep(ls);
    }
}

/* Set t to the lowest point of the parabola. With q(t) = J(base) + b t + c t^2, the slope of the
 * chord to a point is s(t) = b + c t. c comes from the two points of an expansion, or is what the
 * last expansion along this parameter found. False if no minimum is known of. */
static bool aim(auvid_line_search_t *ls)
{
    const auvid_real_t failed = AUVID_LINE_SEARCH_COST_FAILED;
    auvid_real_t c = is_pattern(ls) ? AUVID_C(0.0) : ls->curvature[parameter(ls)];
    if (!(ls->cost_near < failed && ls->base_cost < failed)) {
        return false;
    }
    const auvid_real_t near = (ls->cost_near - ls->base_cost) / ls->t_near;
    if (ls->t_far > ls->t_near && ls->cost_far < failed) {
        c = ((ls->cost_far - ls->base_cost) / ls->t_far - near) / (ls->t_far - ls->t_near);
        if (!is_pattern(ls)) {
            ls->curvature[parameter(ls)] = c;
        }
    }
    if (!(c > AUVID_C(0.0))) {
        return false;
    }
    ls->t = (ls->t_near - near / c) * AUVID_C(0.5);
    return auvid_abs(ls->t) <= MAGNITUDE_MAX;
}

/* The trial at t has this cost (7-17): move on. A step without room counts as a failure. */
static void settle(auvid_line_search_t *ls, auvid_real_t cost)
{
    const auvid_real_t t = ls->t;
    const bool along_axis = !is_pattern(ls), extra = ls->move == MOVE_PARABOLA;
    const auvid_real_t least = along_axis && !extra ? ls->config.gamma * t * t : AUVID_C(0.0);
    const bool accepted = cost < ls->cost && (extra || cost <= ls->base_cost - least);

    if (accepted) {
        memcpy(ls->theta, ls->trial, sizeof ls->theta);
        ls->cost = cost;
    }
    if (extra) {
        next_line(ls);
        return;
    }
    if (accepted || ls->move == MOVE_POLL) {
        ls->t_near = t;
        ls->cost_near = cost;
    } else {
        ls->t_far = t;
        ls->cost_far = cost;
    }
    if (along_axis && accepted) { /* (12); a step cut at the box does not shorten alpha */
        ls->alpha[ls->direction] = auvid_max(ls->alpha[ls->direction], t);
    } else if (along_axis && ls->move == MOVE_POLL) { /* (15) */
        ls->alpha[ls->direction] *= ls->config.sigma;
    }
    if (accepted && (along_axis || t < PATTERN_MAX)) {
        ls->move = MOVE_EXPAND;
        ls->t = ls->config.delta * t;
    } else if (!ls->config.literal && aim(ls)) {
        ls->move = MOVE_PARABOLA;
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
            settle(ls, AUVID_LINE_SEARCH_COST_FAILED);
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
