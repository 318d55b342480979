/**
 * @file auvid_line_search_directions_internal.h
 * Private: declarations shared by the files of the line search, and the directions.
 */
#ifndef AUVID_LINE_SEARCH_DIRECTIONS_INTERNAL_H
#define AUVID_LINE_SEARCH_DIRECTIONS_INTERNAL_H

#include "auvid/detail/optimizer.h"

#include "../base/auvid_math_internal.h"
#include "auvid_search_internal.h"

/** Purpose of a trial: (9) a poll, (12) an expansion, the lowest point of the line's parabola, the
 * point of e_i from which d_i is made, and a probe from there. */
enum { MOVE_POLL = 0, MOVE_EXPAND, MOVE_PARABOLA, MOVE_AXIS, MOVE_PROBE };

/** Start of the row of d_i in shear. */
#define AUVID_SHEAR(i) ((i) * ((i)-1u) / 2u)

static inline bool line_search_is_pattern(const auvid_optimizer_t *o)
{
    return o->line_search.direction == 2u * o->cfg.n;
}

/** Parameter of the direction: paper +e_1..+e_n, -e_1..-e_n; else +d_1, -d_1, +d_2, -d_2 .. */
static inline size_t line_search_parameter(const auvid_optimizer_t *o)
{
    const size_t n = o->cfg.n, d = o->line_search.direction;
    return !o->cfg.paper ? d / 2u : (d < n ? d : d - n);
}

/** Sign of the direction. */
auvid_real_t auvid_line_search_sign(const auvid_optimizer_t *o);

/** Make the trial of the present move at t, cut at the box. Returns false if there is nothing to
 * evaluate: the trial equals the iterate, or a probe has no room. */
bool auvid_line_search_place(auvid_optimizer_t *o);

/** At the start of a line: take a parameter that leaves almost no room out of d_i, so that the
 * others can move. */
void auvid_line_search_release(auvid_optimizer_t *o);

/** At the end of a line: store the slope along d_i. */
void auvid_line_search_note_slope(auvid_optimizer_t *o);

/** Probe the next direction from k on that may not be conjugate to d_i. Returns false if none. */
bool auvid_line_search_probe(auvid_optimizer_t *o, size_t k);

/** Use the cost of the probe to make d_i conjugate to the probed direction. */
void auvid_line_search_learn(auvid_optimizer_t *o, auvid_real_t cost);

#endif
