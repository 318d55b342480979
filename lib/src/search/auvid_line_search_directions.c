/*
 * Line search, directions: the position of a trial, and how d_i is made conjugate (Smith 1962,
 * Powell 1964: the minima of parallel subspaces).
 *
 * Consider a quadratic with half second derivatives c_k along d_k, slope g_k at the line's start,
 * and all d_k, k < i, conjugate to each other. From p = base + a e_i the slope along d_k is
 *     s_k = (J(p + t d_k) - J(p)) / t - c_k t
 * So with the step a, the minimum over the span of all d_k moves by t_k = -(s_k - g_k) / (2 c_k),
 * and d_i = e_i + sum (t_k / a) d_k is conjugate to all of them. One trial for each k,
 * n (n - 1) / 2 in all, and four or five for each line, minimize a quadratic. d_i has no component
 * along e_k, k > i: the d_i span the space whatever the probes return.
 */
#include "auvid_line_search_directions_internal.h"

#include <string.h>

/* A larger part of d_k per unit of e_i is rounding. */
#define PART_MAX AUVID_C(1e6)

auvid_real_t auvid_line_search_sign(const auvid_optimizer_t *o)
{
    const bool minus =
        o->cfg.paper ? o->line_search.direction >= o->cfg.n : o->line_search.direction % 2u != 0;
    return minus ? AUVID_C(-1.0) : AUVID_C(1.0);
}

/* Component of d_i along parameter k <= i [parameter's unit]. */
static auvid_real_t line_search_component(const auvid_optimizer_t *o, size_t i, size_t k)
{
    const auvid_line_search_t *ls = &o->line_search;
    const auvid_real_t unit = o->scale[k];
    return k == i ? unit : unit * ls->shear[AUVID_SHEAR(i) + k];
}

/* trial = base + axis_step e_i + t d_probe, or with -t. Returns false if neither is in the box. */
static bool line_search_place_probe(auvid_optimizer_t *o)
{
    auvid_line_search_t *ls = &o->line_search;
    const size_t i = line_search_parameter(o);
    for (int side = 0; side < 2; ++side) {
        memcpy(o->trial, ls->base, i * sizeof *o->trial);
        o->trial[i] = ls->base[i] + ls->axis_step * o->scale[i];
        for (size_t k = 0; k <= ls->probe; ++k) {
            o->trial[k] += ls->t * line_search_component(o, ls->probe, k);
        }
        if (auvid_search_inside(&o->cfg, o->trial)) {
            return true;
        }
        ls->t = -ls->t;
    }
    return false;
}

/* Set parameter k of the trial, cut at the box. @return does it differ from the iterate's? */
static bool line_search_put(auvid_optimizer_t *o, size_t k, auvid_real_t x)
{
    const auvid_real_t best = o->line_search.theta[k];
    o->trial[k] = auvid_clamp_here(x, o->cfg.lower[k], o->cfg.upper[k]);
    return o->trial[k] < best || o->trial[k] > best;
}

/* trial = base + t d_i; the box limits t. Returns false if the trial equals the iterate. */
static bool line_search_place_along(auvid_optimizer_t *o)
{
    auvid_line_search_t *ls = &o->line_search;
    const auvid_search_config_t *c = &o->cfg;
    const size_t i = line_search_parameter(o), first = c->paper ? i : 0;
    const auvid_real_t sign = auvid_line_search_sign(o);
    auvid_real_t d = AUVID_C(0.0), to = AUVID_C(0.0), t = ls->t;
    size_t bound = AUVID_MAX_PARAMETERS;
    bool moved = false;
    for (size_t k = first; k <= i; ++k) {
        d = sign * line_search_component(o, i, k);
        const auvid_real_t x = ls->base[k] + t * d;
        if (!(x >= c->lower[k] && x <= c->upper[k])) {
            bound = k;
            to = auvid_clamp(x, c->lower[k], c->upper[k]);
            t = (to - ls->base[k]) / d;
        }
    }
    for (size_t k = first; k <= i; ++k) {
        const auvid_real_t x = ls->base[k] + t * (sign * line_search_component(o, i, k));
        moved = line_search_put(o, k, k == bound ? to : x) || moved;
    }
    ls->t = c->paper ? (o->trial[i] - ls->base[i]) / d : t;
    return moved;
}

/* The same with d the displacement of the sweep. */
static bool line_search_place_pattern(auvid_optimizer_t *o)
{
    const auvid_line_search_t *ls = &o->line_search;
    bool moved = false;
    for (size_t k = 0; k < o->cfg.n; ++k) {
        const auvid_real_t x = ls->base[k] + ls->t * (ls->base[k] - ls->previous[k]);
        moved = line_search_put(o, k, x) || moved;
    }
    return moved;
}

bool auvid_line_search_place(auvid_optimizer_t *o)
{
    auvid_line_search_t *ls = &o->line_search;
    if (ls->move == MOVE_PROBE) {
        return line_search_place_probe(o);
    }
    return line_search_is_pattern(o) ? line_search_place_pattern(o) : line_search_place_along(o);
}

void auvid_line_search_release(auvid_optimizer_t *o)
{
    auvid_line_search_t *ls = &o->line_search;
    const auvid_search_config_t *c = &o->cfg;
    const size_t i = line_search_parameter(o);
    for (size_t k = 0; k < i && i < AUVID_MAX_PARAMETERS; ++k) {
        const auvid_real_t d = auvid_line_search_sign(o) * line_search_component(o, i, k);
        const auvid_real_t x = ls->base[k] + c->sigma * ls->t * d;
        if (!(x >= c->lower[k] && x <= c->upper[k])) {
            ls->shear[AUVID_SHEAR(i) + k] = AUVID_C(0.0);
            ls->curvature[i] = AUVID_C(0.0);
        }
    }
}

/* From the slope of the chord to a point of the line and the curvature in between. */
void auvid_line_search_note_slope(auvid_optimizer_t *o)
{
    auvid_line_search_t *ls = &o->line_search;
    const size_t i = line_search_parameter(o);
    const auvid_real_t c = ls->curvature[i], t = ls->t_near;
    if (auvid_abs(t) > AUVID_C(0.0) && c > AUVID_C(0.0) && ls->cost_near < AUVID_COST_FAILED) {
        const auvid_real_t chord = (ls->cost_near - ls->base_cost) / t;
        ls->slope[i] = auvid_line_search_sign(o) * (chord + c * (AUVID_C(2.0) * ls->t_best - t));
    }
}

bool auvid_line_search_probe(auvid_optimizer_t *o, size_t k)
{
    auvid_line_search_t *ls = &o->line_search;
    while (k < line_search_parameter(o) && !(ls->curvature[k] > AUVID_C(0.0))) {
        ++k;
    }
    if (k == line_search_parameter(o)) {
        return false;
    }
    ls->probe = (uint8_t)k;
    ls->move = MOVE_PROBE;
    ls->t = ls->alpha[2u * k];
    return true;
}

void auvid_line_search_learn(auvid_optimizer_t *o, auvid_real_t cost)
{
    auvid_line_search_t *ls = &o->line_search;
    const size_t i = line_search_parameter(o), k = ls->probe;
    const auvid_real_t c = ls->curvature[k];
    const auvid_real_t slope = (cost - ls->axis_cost) / ls->t - c * ls->t - ls->slope[k];
    const auvid_real_t part = AUVID_C(-0.5) * slope / (c * ls->axis_step);
    if (cost < AUVID_COST_FAILED && auvid_abs(part) <= PART_MAX) {
        auvid_real_t *u = ls->shear + AUVID_SHEAR(i), *v = ls->shear + AUVID_SHEAR(k);
        for (size_t j = 0; j < k; ++j) {
            u[j] = auvid_clamp(u[j] + part * v[j], -PART_MAX, PART_MAX);
        }
        u[k] = part;
    }
}
