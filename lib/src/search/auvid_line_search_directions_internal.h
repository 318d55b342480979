/**
 * @file auvid_line_search_directions_internal.h
 * Private: declarations shared by the files of the line search, and the directions.
 */
#ifndef AUVID_LINE_SEARCH_DIRECTIONS_INTERNAL_H
#define AUVID_LINE_SEARCH_DIRECTIONS_INTERNAL_H

#include "auvid/detail/line_search.h"

#include "../base/auvid_math_internal.h"

/** auvid_line_search_t.state */
enum { LINE_NONE = 0, LINE_EVALUATE, LINE_SEARCH, LINE_FINISHED, LINE_CAPPED };

/** Purpose of a trial: (9) a poll, (12) an expansion, the lowest point of the line's parabola, the
 * point of e_i from which d_i is made, and a probe from there. */
enum { MOVE_POLL = 0, MOVE_EXPAND, MOVE_PARABOLA, MOVE_AXIS, MOVE_PROBE };

/** Start of the row of d_i in shear. */
#define AUVID_SHEAR(i) ((i) * ((i)-1u) / 2u)

static inline bool line_search_is_paper(const auvid_line_search_config_t *c)
{
    return c->paper;
}

static inline bool line_search_is_pattern(const auvid_line_search_t *ls)
{
    return ls->direction == 2u * ls->cfg.n;
}

/** Parameter of the direction: paper +e_1..+e_n, -e_1..-e_n; else +d_1, -d_1, +d_2, -d_2 .. */
static inline size_t line_search_parameter(const auvid_line_search_t *ls)
{
    const size_t n = ls->cfg.n, d = ls->direction;
    return !line_search_is_paper(&ls->cfg) ? d / 2u : (d < n ? d : d - n);
}

static inline auvid_real_t line_search_sign(const auvid_line_search_t *ls)
{
    const bool minus =
        line_search_is_paper(&ls->cfg) ? ls->direction >= ls->cfg.n : ls->direction % 2u != 0;
    return minus ? AUVID_C(-1.0) : AUVID_C(1.0);
}

/** Is the point in the box? */
bool auvid_line_search_inside(const auvid_line_search_config_t *c, const auvid_real_t *theta);

/** Make the trial of the present move at t, cut at the box. Returns false if there is nothing to
 * evaluate: the trial equals the iterate, or a probe has no room. */
bool auvid_line_search_place(auvid_line_search_t *ls);

/** At the start of a line: take a parameter that leaves almost no room out of d_i, so that the
 * others can move. */
void auvid_line_search_release(auvid_line_search_t *ls);

/** At the end of a line: store the slope along d_i. */
void auvid_line_search_note_slope(auvid_line_search_t *ls);

/** Probe the next direction from k on that may not be conjugate to d_i. Returns false if none. */
bool auvid_line_search_probe(auvid_line_search_t *ls, size_t k);

/** Use the cost of the probe to make d_i conjugate to the probed direction. */
void auvid_line_search_learn(auvid_line_search_t *ls, auvid_real_t cost);

#endif
