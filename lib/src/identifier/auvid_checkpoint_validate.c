/*
 * The checkpoint: validation. The checksum shows that nothing is damaged, not that auvid wrote the
 * data. First each number is checked against auvid_checkpoint_limits.c. Then the conditions between
 * members are checked, one function for each struct. All is read from the stream itself, so a
 * rejected checkpoint changes nothing.
 */
#include <string.h>

#include "auvid_checkpoint_layout_internal.h"
#include "../metric/auvid_confidence_notes_internal.h"
#include "auvid_identifier_internal.h"
#include "../search/auvid_line_search_directions_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"
#include "../navigation/auvid_nav_internal.h"

typedef struct {
    const auvid_identifier_t *id;
    const auvid_checkpoint_sizes_t *sizes;
    const uint8_t *body; /* of an outermost struct */
    int table;           /* its table */
} view_t;

/* ---- numbers ---- */

static uint64_t checkpoint_whole(const uint8_t *at, uint32_t width)
{
    uint64_t x = 0;
    for (uint32_t k = 0; k < width; ++k) {
        x |= (uint64_t)at[k] << 8 * k;
    }
    return x;
}

static auvid_real_t checkpoint_real(const uint8_t *at)
{
    auvid_real_t x;
    uint64_t bits = checkpoint_whole(at, sizeof x);
    uint32_t low = (uint32_t)bits;
    memcpy(&x, sizeof x == sizeof low ? (const void *)&low : (const void *)&bits, sizeof x);
    return x;
}

/* An integer, signed or not. */
static auvid_real_t checkpoint_number(const uint8_t *at, uint32_t width, bool has_sign)
{
    uint64_t x = checkpoint_whole(at, width), sign = (uint64_t)1 << (8 * width - 1);
    if (has_sign && (x & sign) != 0) {
        return -(auvid_real_t)((sign << 1) - x);
    }
    return (auvid_real_t)x;
}

/* Is the scalar at `at` within this limit? expected: the identifier's scalar. */
static AUVID_NOINLINE bool checkpoint_is_within(const auvid_checkpoint_limit_t *limit,
                                                const auvid_checkpoint_row_t *row,
                                                const uint8_t *at, const uint8_t *expected)
{
    if (limit->same) {
        bool same = true;
        for (uint32_t k = 0; k < row->width; ++k) {
            same = same && at[k] == expected[auvid_checkpoint_byte(row->stride, k)];
        }
        return same;
    }
    auvid_real_t x = row->finite ? checkpoint_real(at)
                                 : checkpoint_number(at, row->width, limit->low < AUVID_C(0.0));
    return x >= limit->low && x <= limit->high;
}

/* Are all scalars of a run in range? */
static bool checkpoint_check_run(const view_t *v, const auvid_checkpoint_run_t *run,
                                 const uint8_t *at)
{
    const auvid_checkpoint_row_t *row = run->row;
    size_t first = row->offset + (size_t)(row->count - run->count) * row->stride;
    const uint8_t *expected =
        (const uint8_t *)v->id + run->offset; /* read of the identifier only */
    bool good = true;
    for (uint32_t k = 0; row->finite && k < run->count; ++k) {
        good = good && auvid_is_finite(checkpoint_real(at + k * row->width));
    }
    for (size_t l = 0; l < auvid_checkpoint_limits; ++l) {
        const auvid_checkpoint_limit_t *limit = &auvid_checkpoint_limit[l];
        bool touches = limit->table == run->table && limit->end > first &&
                       limit->first < row->offset + row->count * row->stride;
        for (uint32_t k = 0; touches && k < run->count; ++k) {
            size_t here = first + (size_t)k * row->stride;
            good = good && (here < limit->first || here >= limit->end ||
                            checkpoint_is_within(limit, row, at + k * row->width,
                                                 expected + k * row->stride));
        }
    }
    return good;
}

/* ---- conditions between members ---- */

/* Find the scalar at byte `offset` of the view's struct in the body, which contains it. */
static const uint8_t *checkpoint_find(const view_t *v, size_t offset,
                                      const auvid_checkpoint_row_t **found)
{
    const uint8_t *at = v->body;
    int table = v->table;
    do {
        const auvid_checkpoint_row_t *row = auvid_checkpoint_table[table].row;
        uint32_t bytes = auvid_checkpoint_bytes(v->sizes, row);
        while (bytes == 0 || offset < row->offset ||
               offset >= row->offset + (size_t)row->count * row->stride) {
            at += bytes;
            bytes = auvid_checkpoint_bytes(v->sizes, ++row);
        }
        size_t index = (offset - row->offset) / row->stride;
        offset = (offset - row->offset) % row->stride;
        at += index * auvid_checkpoint_element(v->sizes, row);
        table = row->table;
        *found = row;
    } while ((*found)->width == 0);
    return at;
}

static uint64_t checkpoint_whole_at(const view_t *v, size_t offset)
{
    const auvid_checkpoint_row_t *row;
    const uint8_t *at = checkpoint_find(v, offset, &row);
    return checkpoint_whole(at, row->width);
}

static uint32_t checkpoint_word(const view_t *v, size_t offset)
{
    return (uint32_t)checkpoint_whole_at(v, offset);
}

static auvid_real_t checkpoint_real_at(const view_t *v, size_t offset)
{
    const auvid_checkpoint_row_t *row;
    return checkpoint_real(checkpoint_find(v, offset, &row));
}

#define MEMBER(member) offsetof(auvid_identifier_t, member)
#define WORD(member) checkpoint_word(v, MEMBER(member))

static uint32_t checkpoint_count_bits(uint32_t mask)
{
    uint32_t count = 0;
    for (; mask != 0; mask &= mask - 1u) {
        ++count;
    }
    return count;
}

/* A held sample is ahead of the IMU by at most max_age_us. */
static bool checkpoint_check_nav(const view_t *v)
{
    uint32_t holding = WORD(nav.holding);
    bool good = WORD(nav.gps_start) == 0 || WORD(nav.gps_count) < WORD(nav.gps_start);
    for (size_t i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        uint64_t held_us = checkpoint_whole_at(v, MEMBER(nav.held_us[0]) + i * sizeof(uint64_t));
        uint64_t ahead_us =
            held_us - checkpoint_whole_at(v, MEMBER(nav.t_us)); /* huge if it is older */
        uint32_t max_us = checkpoint_word(v, MEMBER(nav.max_age_us[0]) + i * sizeof(uint32_t));
        good = good && ((holding >> i & 1u) == 0 || (ahead_us > 0 && ahead_us <= max_us));
    }
    return good && (holding == 0 || WORD(nav.ready) == NAV_RUNNING);
}

/* A running record has attitude and input, within the ring. */
static bool checkpoint_check_recorder(const view_t *v)
{
    enum { STREAM_INPUT = sizeof v->id->recorder.stream / sizeof v->id->recorder.stream[0] - 1 };
    uint32_t next = WORD(recorder.next), oldest = next - 2u;
    bool good = next >= 2 && next <= UINT32_MAX - 2 * AUVID_RECORDER_CELLS &&
                WORD(recorder.opened) - oldest <= AUVID_RECORDER_CELLS;
    for (size_t s = 0; s <= STREAM_INPUT; s += STREAM_INPUT) {
        size_t at = MEMBER(recorder.stream[0]) + s * sizeof(auvid_recorder_stream_t);
        good = good && checkpoint_word(v, at + offsetof(auvid_recorder_stream_t, valid)) != 0 &&
               checkpoint_word(v, at + offsetof(auvid_recorder_stream_t, cell)) - oldest <=
                   AUVID_RECORDER_CELLS;
    }
    return good || WORD(recorder.running) == 0;
}

/* Rows of the set of that age. */
static uint32_t checkpoint_set_rows(const view_t *v, uint32_t age)
{
    uint32_t slot = auvid_metric_ring_index(WORD(metric.sets.stored), WORD(metric.cfg.sets),
                                            WORD(metric.sets.from) + age);
    return checkpoint_word(v, MEMBER(metric.sets.set[0].rows) + slot * sizeof(auvid_set_t));
}

/* Which sets are used: all, unless the ring is held, from the validation of the first set to the
 * estimate. Then the waiting newer sets are not used, nor those to be validated later. */
static bool checkpoint_check_ring(const view_t *v)
{
    uint32_t sets = WORD(metric.cfg.sets), from = WORD(metric.sets.from), untested = WORD(untested);
    uint32_t waiting = WORD(metric.sets.waiting), least = WORD(metric.sets.least),
             phase = WORD(phase);
    bool held = WORD(metric.sets.held) != 0, stored = auvid_metric_stores_rows(&v->id->metric);
    bool full = WORD(metric.sets.full) != 0, changed = WORD(metric.sets.changed) != 0;
    bool tests = phase >= AUVID_WORK_PREPARE && phase <= AUVID_WORK_CHANGE_TEST;
    uint32_t later = waiting + (untested > 0 ? untested - 1u : 0u);
    return from <= sets && waiting <= sets && untested <= sets && least <= sets &&
           WORD(metric.evaluator.sets_merged) <= sets && tests == (untested > 0) &&
           held == (phase != AUVID_WORK_IDLE) && from == (held ? later : 0u) &&
           (held || (least == 0 && !full && !changed)) && !(full && !stored) &&
           !(changed && stored) && WORD(metric.rows.set.rows) < WORD(metric.cfg.set_rows) + full;
}

/* One set, or the one being recorded: each DoF has all of its rows or some. */
static bool checkpoint_check_rows(const view_t *v, size_t rows, size_t rows_of, size_t windows,
                                  uint32_t excited)
{
    bool good = true;
    for (size_t j = 0; j < AUVID_DOF_COUNT; ++j) {
        uint32_t dof_rows = checkpoint_word(v, rows_of + j * sizeof(uint16_t));
        bool modelled = auvid_metric_order(&v->id->metric, (int)j) > 0;
        good = good &&
               (!modelled || (dof_rows <= checkpoint_word(v, rows) &&
                              checkpoint_word(v, windows + j * sizeof(uint16_t)) <= dof_rows)) &&
               ((excited >> j & 1u) == 0 || (modelled && dof_rows > 0));
    }
    return good;
}

static bool checkpoint_check_sets(const view_t *v)
{
    const auvid_metric_t *m = &v->id->metric;
    uint32_t rows = WORD(metric.cfg.set_rows), recorded = WORD(metric.sets.recorded), modelled = 0;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        modelled |= (uint32_t)(auvid_metric_order(m, j) > 0) << j;
    }
    bool good =
        (WORD(metric.result.excited) & ~modelled) == 0 &&
        checkpoint_check_rows(v, MEMBER(metric.rows.set.rows), MEMBER(metric.rows.set.rows_of[0]),
                              MEMBER(metric.rows.set.rows_of[0]), 0);
    for (size_t k = 0; k < AUVID_MAX_SETS; ++k) {
        size_t at = MEMBER(metric.sets.set[0]) + k * sizeof(auvid_set_t);
        uint32_t excited = checkpoint_word(v, at + offsetof(auvid_set_t, excited));
        uint32_t filled = checkpoint_word(v, at + offsetof(auvid_set_t, rows));
        good = good && filled <= rows && (excited != 0) == (filled != 0) &&
               checkpoint_word(v, at + offsetof(auvid_set_t, number)) <= recorded &&
               checkpoint_check_rows(v, at + offsetof(auvid_set_t, rows),
                                     at + offsetof(auvid_set_t, rows_of),
                                     at + offsetof(auvid_set_t, windows), excited);
    }
    bool any = WORD(phase) < AUVID_WORK_MERGE;
    for (size_t j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool excited = (WORD(metric.result.excited) >> j & 1u) != 0;
        good = good && (!excited || checkpoint_word(v, MEMBER(metric.result.dof_rows[0]) +
                                                           j * sizeof(uint16_t)) > 0);
        any = any || (excited && m->layout.count[j] > 0);
    }
    return good && any;
}

/* The position of the pass through the sets. */
static bool checkpoint_check_pass(const view_t *v)
{
    const auvid_metric_t *m = &v->id->metric;
    uint32_t phase = WORD(phase), pass = WORD(metric.evaluator.at.pass),
             sets = WORD(metric.cfg.sets);
    uint32_t at_set = WORD(metric.evaluator.at.set), at_dof = WORD(metric.evaluator.at.dof);
    uint32_t at_row = WORD(metric.evaluator.at.row), to_set = WORD(metric.evaluator.at.to_set);
    bool linear = !auvid_metric_stores_rows(m), merges = pass <= PASS_PRIOR;
    bool walks = pass <= PASS_LAST || pass == PASS_MEASURE; /* by DoF */
    bool in_dof = at_dof < AUVID_DOF_COUNT || !walks || at_set >= to_set;
    bool right = true;
    switch (phase) {
    case AUVID_WORK_MERGE:
        right = merges && in_dof;
        break;
    case AUVID_WORK_COST:
        right = pass == PASS_COST && at_dof <= AUVID_DOF_COUNT &&
                (!linear || at_dof == AUVID_DOF_COUNT || at_row <= m->layout.count[at_dof]);
        break;
    case AUVID_WORK_PREDICT:
    case AUVID_WORK_COMPARE:
    case AUVID_WORK_MEASURE:
        right = pass == PASS_MEASURE && in_dof;
        break;
    case AUVID_WORK_PREPARE:
    case AUVID_WORK_LINEARISE:
        right = linear || ((pass == PASS_LINEAR || merges) && in_dof);
        break;
    case AUVID_WORK_CHANGE_TEST:
        right = pass == PASS_LAST;
        break;
    default:
        break;
    }
    if (pass == PASS_LINEAR &&
        WORD(metric.evaluator.at.part) > 0) { /* the whole window is present */
        uint32_t count = sets - WORD(metric.sets.from), length = WORD(metric.layout.window_length);
        uint32_t before = at_set + 1u < count ? checkpoint_set_rows(v, at_set + 1u) : 0u;
        uint32_t parts = (2u * m->cfg.vehicle->parameters + 3u) * length;
        right = right && at_set < count && at_row < checkpoint_set_rows(v, at_set) &&
                length <= at_row + 1u + before && WORD(metric.evaluator.at.part) < parts;
    }
    return right && to_set <= sets && at_set <= sets + (phase == AUVID_WORK_CHANGE_TEST ? 2u : 0u);
}

static bool checkpoint_check_metric(const view_t *v)
{
    const auvid_metric_t *m = &v->id->metric;
    uint32_t sets = WORD(metric.cfg.sets), rows = WORD(metric.cfg.set_rows);
    bool stored = auvid_metric_stores_rows(m);
    auvid_prior_t prior;
    memset(&prior, 0, sizeof prior);
    prior.known = WORD(metric.prior.known);
    for (size_t i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        prior.pi[i] = checkpoint_real_at(v, MEMBER(metric.prior.pi[0]) + i * sizeof(auvid_real_t));
        prior.sigma[i] =
            checkpoint_real_at(v, MEMBER(metric.prior.sigma[0]) + i * sizeof(auvid_real_t));
    }
    for (size_t j = 0; j < AUVID_DOF_COUNT; ++j) {
        prior.variance_inflation[j] = checkpoint_real_at(
            v, MEMBER(metric.prior.variance_inflation[0]) + j * sizeof(auvid_real_t));
    }
    return rows * sets <= 60000u && checkpoint_check_ring(v) &&
           (!stored || (sets + 1u) * rows == (m->cfg.sets + 1u) * m->cfg.set_rows) &&
           auvid_metric_check_prior(m, &prior) == AUVID_OK && checkpoint_check_sets(v) &&
           checkpoint_check_pass(v);
}

/* Are all `n` reals of `point` between the bounds? */
static bool checkpoint_is_inside(const view_t *v, size_t point, size_t lower, size_t upper,
                                 uint32_t n)
{
    bool inside = true;
    for (size_t i = 0; i < n; ++i) {
        size_t k = i * sizeof(auvid_real_t);
        auvid_real_t x = checkpoint_real_at(v, point + k);
        inside = inside && x >= checkpoint_real_at(v, lower + k) &&
                 x <= checkpoint_real_at(v, upper + k);
    }
    return inside;
}

static bool checkpoint_check_crs(const view_t *v)
{
    uint32_t n = WORD(optimizer.cfg.n), m = WORD(optimizer.cfg.population);
    bool filling = WORD(optimizer.state) <= AUVID_OPTIMIZER_FILL;
    bool good = n < m && filling == (WORD(optimizer.work.crs) < m);
    for (size_t k = 0; k < m; ++k) {
        good =
            good && checkpoint_word(v, MEMBER(optimizer.crs.order[0]) + k * sizeof(uint16_t)) < m;
    }
    return good && WORD(optimizer.crs.known) <= m && WORD(optimizer.crs.best) < m &&
           WORD(optimizer.crs.worst) < m;
}

static bool checkpoint_check_line_search(const view_t *v)
{
    uint32_t n = WORD(optimizer.cfg.n);
    uint32_t direction = WORD(optimizer.line_search.direction);
    bool pattern = direction == 2u * n, probes = WORD(optimizer.line_search.move) == MOVE_PROBE;
    return direction <= 2u * n && WORD(optimizer.line_search.built) <= n &&
           WORD(optimizer.line_search.probe) < (probes ? direction / 2u : n) &&
           (!pattern || (WORD(optimizer.line_search.move) < MOVE_AXIS &&
                         !(auvid_abs(checkpoint_real_at(
                               v, MEMBER(optimizer.line_search.axis_step))) > AUVID_C(0.0))));
}

static bool checkpoint_check_search(const view_t *v)
{
    bool global = (v->sizes->parts & PART_GLOBAL) != 0;
    uint32_t delay = auvid_metric_stores_rows(&v->id->metric) && WORD(metric.cfg.estimate_delay);
    uint32_t n = WORD(optimizer.cfg.n);
    return n == checkpoint_count_bits(WORD(active)) + delay &&
           global == (WORD(optimizer.state) < AUVID_OPTIMIZER_START) &&
           (global ? checkpoint_check_crs(v) : checkpoint_check_line_search(v)) &&
           (!WORD(optimizer.asked) ||
            checkpoint_is_inside(v, MEMBER(optimizer.trial), MEMBER(optimizer.cfg.lower),
                                 MEMBER(optimizer.cfg.upper), n));
}

/* The partner named by a finding is one of the model's parameters. */
static bool checkpoint_check_notes(const view_t *v, size_t confidence)
{
    bool good = true;
    for (size_t i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        uint32_t note = checkpoint_word(v, confidence + offsetof(auvid_confidence_t, note) + i);
        uint32_t partner =
            checkpoint_word(v, confidence + offsetof(auvid_confidence_t, partner) + i);
        bool names = note == AUVID_NOTE_COMBINATION || note == AUVID_NOTE_BESIDE_BOUND ||
                     note == AUVID_NOTE_DISCREDITED;
        good = good && partner < (names ? identifier_vehicle(v->id)->parameters
                                        : (uint32_t)AUVID_MAX_PARAMETERS);
    }
    return good;
}

static bool checkpoint_check_optimum(const view_t *v)
{
    uint32_t n = WORD(optimum.n), dof = WORD(optimum.dof);
    bool good = n == checkpoint_count_bits(WORD(active)) && WORD(optimum.fixed_from) <= n &&
                WORD(optimum.at) <= n + 1u && WORD(optimum.changes) < 4u * (n + 1u) &&
                (dof == AUVID_DOF_COUNT || WORD(optimum.row) <= v->id->metric.layout.count[dof]);
    for (size_t k = 0; good && k < n; ++k) {
        good = checkpoint_word(v, MEMBER(optimum.order[0]) + k) < n;
    }
    return good && checkpoint_is_inside(v, MEMBER(optimum.x), MEMBER(optimum.lower),
                                        MEMBER(optimum.upper), n);
}

static bool checkpoint_check_job(const view_t *v)
{
    const auvid_metric_t *m = &v->id->metric;
    uint32_t n = WORD(confidence.n), phase = WORD(confidence.phase), j = WORD(confidence.at_dof);
    bool good = n <= m->cfg.vehicle->parameters &&
                WORD(confidence.at_set) < WORD(metric.cfg.sets) &&
                checkpoint_check_notes(v, MEMBER(confidence.result));
    for (size_t i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        uint32_t to = checkpoint_word(v, MEMBER(confidence.column_of[0]) + i);
        bool unused = i >= m->cfg.vehicle->parameters;
        good =
            good && (unused || to < n || to == NOWHERE) &&
            checkpoint_word(v, MEMBER(confidence.parameter_of[0]) + i) < m->cfg.vehicle->parameters;
    }
    if (!good || j >= AUVID_DOF_COUNT || m->layout.count[j] == 0 ||
        (WORD(metric.result.excited) >> j & 1u) == 0) {
        return false;
    }
    uint32_t steps = phase == OPTIMUM || phase == BIAS ? 1u
                     : phase == ROTATE                 ? m->layout.count[j]
                     : phase == SCATTER ? 2u * (uint32_t)auvid_metric_order(m, (int)j) + 1u
                                        : n;
    return phase < DONE && WORD(confidence.at_row) < steps;
}

static bool checkpoint_check_prediction(const view_t *v)
{
    view_t of = *v;
    bool good = identifier_vehicle(v->id)->acceleration != NULL;
    for (int root = 0; auvid_checkpoint_root[root].table != TABLE_VALIDATION; ++root) {
        of.body += auvid_checkpoint_root_bytes(v->sizes, root);
    }
    of.table = TABLE_VALIDATION;
    uint32_t cells = checkpoint_word(&of, offsetof(auvid_validation_t, cells));
    for (size_t j = 0; j < AUVID_DOF_COUNT; ++j) {
        size_t compared = offsetof(auvid_validation_t, compared) + j * sizeof(uint32_t);
        good = good && checkpoint_word(&of, compared) <= cells;
    }
    return good;
}

static bool checkpoint_search_matches_phase(const view_t *v)
{
    uint32_t phase = WORD(phase);
    uint32_t work = v->sizes->parts & (PART_GLOBAL | PART_LOCAL | PART_CONFIDENCE | PART_OPTIMUM);
    bool residual = auvid_metric_stores_rows(&v->id->metric), searching = WORD(searching) != 0;
    bool measures = phase == AUVID_WORK_MEASURE; /* again, if a set has entered the ring */
    bool linearises = phase == AUVID_WORK_LINEARISE;
    bool must = phase == AUVID_WORK_ASK || phase == AUVID_WORK_COST ||
                (residual && (measures || linearises));
    if (phase >= AUVID_WORK_ASK && WORD(active) == 0) {
        return false;
    }
    if (searching) {
        return (must || measures) && (work == PART_GLOBAL || work == PART_LOCAL) &&
               checkpoint_check_search(v);
    }
    if (phase == AUVID_WORK_CONFIDENCE) {
        return work == PART_CONFIDENCE && checkpoint_check_job(v);
    }
    if (linearises && !residual) {
        return work == PART_OPTIMUM && checkpoint_check_optimum(v);
    }
    return !must && work == 0;
}

static bool checkpoint_check_identifier(const view_t *v)
{
    uint32_t parts = v->sizes->parts;
    return parts < 2u * (PART_END - 1u) && WORD(spent) <= SEARCH_START_COST + 1u &&
           ((parts & PART_RESIDUAL) != 0) == auvid_metric_stores_rows(&v->id->metric) &&
           ((parts & PART_SIMULATED) == 0 || checkpoint_check_prediction(v)) &&
           (WORD(active) & ~auvid_metric_free_of(&v->id->metric, UINT8_MAX)) == 0 &&
           checkpoint_check_notes(v, MEMBER(estimate.confidence)) &&
           checkpoint_check_notes(v, MEMBER(accepted_estimate.confidence)) &&
           checkpoint_search_matches_phase(v);
}

auvid_status_t auvid_checkpoint_validate(const auvid_identifier_t *id,
                                         const auvid_checkpoint_sizes_t *sizes, const uint8_t *body,
                                         uint32_t bytes)
{
    const view_t view = {id, sizes, body, TABLE_IDENTIFIER};
    for (uint32_t at = 0; at < bytes;) {
        auvid_checkpoint_run_t run = auvid_checkpoint_locate(sizes, at);
        if (!checkpoint_check_run(&view, &run, body + at)) {
            return AUVID_ERR_RANGE;
        }
        at += run.count * run.row->width;
    }
    bool good = checkpoint_check_nav(&view) && checkpoint_check_recorder(&view) &&
                checkpoint_check_metric(&view) && checkpoint_check_identifier(&view);
    return good ? AUVID_OK : AUVID_ERR_RANGE;
}
