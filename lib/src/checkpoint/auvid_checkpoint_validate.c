/*
 * The checkpoint: validation. The checksum shows that nothing is damaged, not that auvid wrote the
 * data. First each number is checked against auvid_checkpoint_limits.c. Then the conditions between
 * members are checked, one function for each struct. All is read from the stream itself, so a
 * rejected checkpoint changes nothing.
 */
#include <string.h>

#include "auvid_checkpoint_layout_internal.h"
#include "../metric/auvid_confidence_notes_internal.h"
#include "../identifier/auvid_identifier_internal.h"
#include "../identifier/auvid_prior_rows_internal.h"
#include "../search/auvid_gauss_newton_internal.h"
#include "../search/auvid_line_search_directions_internal.h"
#include "../base/auvid_math_internal.h"
#include "../metric/auvid_metric_evaluator_internal.h"
#include "../navigation/auvid_nav_internal.h"

typedef struct {
    const auvid_identifier_t *id;
    const auvid_checkpoint_view_t *view;
} subject_t;

/* ---- numbers ---- */

/* Where so many bytes from `offset` of a root on are in the body; NULL: they are not saved. */
static const uint8_t *checkpoint_find(const auvid_checkpoint_view_t *v, uint8_t root, size_t offset,
                                      size_t bytes)
{
    const uint8_t *at = v->body;
    for (int k = 0; k < CHECKPOINT_BLOCKS; ++k) {
        const auvid_checkpoint_block_t *block = &auvid_checkpoint_block[k];
        uint32_t size = auvid_checkpoint_bytes(v, block);
        if (block->root == root && offset >= block->offset &&
            offset - block->offset + bytes <= size) {
            return at + (offset - block->offset);
        }
        at += size;
    }
    return NULL;
}

static auvid_real_t checkpoint_real(const uint8_t *at)
{
    auvid_real_t x;
    memcpy(&x, at, sizeof x);
    return x;
}

/* Are the scalars at `at` within this limit? Not a number is not. */
static AUVID_NOINLINE bool checkpoint_is_within(const auvid_checkpoint_limit_t *limit,
                                                const uint8_t *at)
{
    bool good = true;
    for (uint32_t k = 0; k < limit->count; ++k, at += limit->width) {
        uint64_t whole = auvid_checkpoint_whole(at, limit->width);
        uint64_t sign = (uint64_t)1 << (8 * limit->width - 1);
        bool negative = limit->kind == KIND_SIGNED && (whole & sign) != 0;
        auvid_real_t x = limit->kind == KIND_REAL ? checkpoint_real(at)
                         : negative               ? -auvid_real_of((sign << 1) - whole)
                                                  : auvid_real_of(whole);
        good = good && x >= limit->low && x <= limit->high;
    }
    return good;
}

/* What is checked of a root beyond the tables of all; NULL: nothing. */
static const auvid_checkpoint_part_t *checkpoint_part(const auvid_identifier_t *id, uint8_t root)
{
    const auvid_uncertain_t *u = id->attached.uncertain;
    return root == ROOT_UNCERTAIN     ? u->checkpoint
           : root == ROOT_INSTRUMENTS ? u->instruments->checkpoint
                                      : NULL;
}

/* Are all scalars of these structs in range? */
static bool checkpoint_check_structs(const subject_t *s, const auvid_checkpoint_struct_t *structs)
{
    const auvid_checkpoint_part_t *part = checkpoint_part(s->id, structs->root);
    size_t limits = auvid_checkpoint_limits + (part != NULL ? part->limits : 0);
    uint32_t count = structs->root == ROOT_ROWS ? s->view->rows : structs->count;
    bool good = true;
    for (size_t l = 0; l < limits; ++l) {
        const auvid_checkpoint_limit_t *limit = l < auvid_checkpoint_limits
                                                    ? &auvid_checkpoint_limit[l]
                                                    : &part->limit[l - auvid_checkpoint_limits];
        for (uint32_t k = 0; limit->table == structs->table && good && k < count; ++k) {
            const uint8_t *at = checkpoint_find(
                s->view, structs->root, structs->offset + (size_t)k * structs->size + limit->first,
                (size_t)limit->count * limit->width);
            good = at == NULL || checkpoint_is_within(limit, at);
        }
    }
    return good;
}

/* ---- conditions between members ---- */

/* Copy bytes of a root, which are saved. */
static void checkpoint_copy(const subject_t *s, uint8_t root, size_t offset, void *to, size_t bytes)
{
    memcpy(to, checkpoint_find(s->view, root, offset, bytes), bytes);
}

/* An unsigned member of the identifier. */
static uint32_t checkpoint_word(const subject_t *s, size_t offset, size_t width)
{
    uint32_t x = 0;
    checkpoint_copy(s, ROOT_IDENTIFIER, offset, &x, width);
    return x;
}

#define MEMBER(member) offsetof(auvid_identifier_t, member)
#define WIDTH(member) sizeof(((auvid_identifier_t *)0)->member)
#define WORD(member) checkpoint_word(s, MEMBER(member), WIDTH(member))
/* The same of a struct that is at `at` of the identifier. */
#define WORD_AT(at, type, member)                                                                  \
    checkpoint_word(s, (at) + offsetof(type, member), sizeof(((type *)0)->member))
/* Copies as many bytes as *to has, from byte `at` of the identifier. */
#define COPY(to, at) checkpoint_copy(s, ROOT_IDENTIFIER, at, to, sizeof *(to))

/* A held sample is ahead of the IMU by at most max_age_us. */
static bool checkpoint_check_nav(const subject_t *s)
{
    uint32_t holding = WORD(nav.held.sensors);
    bool good = WORD(nav.gps.start) == 0 || WORD(nav.gps.count) < WORD(nav.gps.start);
    uint64_t held_us[AUVID_NAV_SENSOR_COUNT], t_us;
    COPY(&held_us, MEMBER(nav.held.t_us));
    COPY(&t_us, MEMBER(nav.imu.t_us));
    for (int i = 0; i < AUVID_NAV_SENSOR_COUNT; ++i) {
        bool ahead = held_us[i] > t_us && held_us[i] - t_us <= s->id->nav.cfg.max_age_us[i];
        good = good && ((holding >> i & 1u) == 0 || ahead);
    }
    bool filters = s->id->nav.imu.ready != NAV_BLANK; /* else: auvid_identifier_init_motion */
    return good && filters == (WORD(nav.imu.ready) != NAV_BLANK) &&
           (holding == 0 || WORD(nav.imu.ready) == NAV_RUNNING);
}

/* A running record has attitude and input, within the ring. The period of the velocity is as
 * configured, or observed. */
static bool checkpoint_check_recorder(const subject_t *s)
{
    auvid_recorder_stream_t
        stream[sizeof s->id->recorder.stream / sizeof s->id->recorder.stream[0]];
    const size_t input = sizeof stream / sizeof stream[0] - 1;
    uint32_t next = WORD(recorder.next), oldest = next - 2u;
    bool good = next >= 2 && next <= UINT32_MAX - 2 * AUVID_RECORDER_CELLS &&
                WORD(recorder.opened) - oldest <= AUVID_RECORDER_CELLS;
    COPY(&stream, MEMBER(recorder.stream));
    for (size_t k = 0; k <= input; k += input) {
        good = good && stream[k].valid && stream[k].cell - oldest <= AUVID_RECORDER_CELLS;
    }
    uint32_t period_us = WORD(recorder.velocity_us), given_us = s->id->recorder.cfg.velocity_us;
    bool observed = given_us == AUVID_VELOCITY_OBSERVED && period_us > 0 && period_us <= 1000000;
    uint32_t doublings = WORD(metric.result.doublings), cell_us = s->id->metric.cfg.cell_us;
    bool same = doublings < 10 && WORD(recorder.cell_us) == cell_us << doublings;
    return (good || WORD(recorder.running) == 0) && (observed || period_us == given_us) && same;
}

/* Rows of the set of that age. */
static uint32_t checkpoint_set_rows(const subject_t *s, uint32_t age)
{
    uint32_t slot = auvid_metric_ring_index(WORD(metric.sets.stored), s->id->metric.cfg.sets,
                                            WORD(metric.sets.from) + age);
    return WORD_AT(MEMBER(metric.sets.set) + slot * sizeof(auvid_set_t), auvid_set_t, rows);
}

/* Which sets are used: all, unless the ring is held, from the validation of the first set to the
 * estimate. Then the waiting newer sets are not used, nor those to be validated later. */
static bool checkpoint_check_ring(const subject_t *s)
{
    uint32_t sets = s->id->metric.cfg.sets, from = WORD(metric.sets.from),
             untested = WORD(work.untested);
    uint32_t waiting = WORD(metric.sets.waiting), least = WORD(metric.sets.least),
             phase = WORD(work.phase);
    bool held = WORD(metric.sets.held) != 0, stored = auvid_metric_stores_rows(&s->id->metric);
    bool full = WORD(metric.sets.full) != 0, changed = WORD(metric.sets.changed) != 0;
    bool tests = phase >= AUVID_WORK_PREPARE && phase <= AUVID_WORK_CHANGE_TEST;
    uint32_t later = waiting + (untested > 0 ? untested - 1u : 0u);
    return from <= sets && waiting <= sets && untested <= sets && least <= sets &&
           WORD(metric.evaluator.sets_merged) <= sets && tests == (untested > 0) &&
           held == (phase != AUVID_WORK_IDLE) && from == (held ? later : 0u) &&
           (held || (least == 0 && !full && !changed)) && !(full && !stored) &&
           !(changed && stored) && WORD(metric.rows.set.rows) <= s->id->metric.cfg.set_rows;
}

/* One set, or the one being recorded: each DoF has all of its rows or some. */
static bool checkpoint_check_rows(const subject_t *s, uint32_t rows, const uint16_t *rows_of,
                                  const uint16_t *windows, uint32_t excited)
{
    bool good = true;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool modelled = auvid_metric_order(&s->id->metric, j) > 0;
        good = good && (!modelled || (rows_of[j] <= rows && windows[j] <= rows_of[j])) &&
               ((excited >> j & 1u) == 0 || (modelled && rows_of[j] > 0));
    }
    return good;
}

static bool checkpoint_check_sets(const subject_t *s)
{
    const auvid_metric_t *m = &s->id->metric;
    uint32_t excited = WORD(metric.result.excited), modelled = 0;
    uint16_t rows_of[AUVID_DOF_COUNT], windows[AUVID_DOF_COUNT];
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        modelled |= (uint32_t)(auvid_metric_order(m, j) > 0) << j;
    }
    COPY(&rows_of, MEMBER(metric.rows.set.rows_of));
    uint32_t coupled = WORD(metric.result.coupled);
    bool good = ((excited | coupled) & ~modelled) == 0 && (excited & coupled) == 0 &&
                checkpoint_check_rows(s, WORD(metric.rows.set.rows), rows_of, rows_of, 0);
    for (size_t k = 0; k < AUVID_MAX_SETS; ++k) {
        size_t at = MEMBER(metric.sets.set) + k * sizeof(auvid_set_t);
        uint32_t of_set = WORD_AT(at, auvid_set_t, excited), rows = WORD_AT(at, auvid_set_t, rows);
        COPY(&rows_of, at + offsetof(auvid_set_t, rows_of));
        COPY(&windows, at + offsetof(auvid_set_t, windows));
        good = good && rows <= m->cfg.set_rows && (of_set != 0) == (rows != 0) &&
               WORD_AT(at, auvid_set_t, number) <= WORD(metric.sets.recorded) &&
               checkpoint_check_rows(s, rows, rows_of, windows, of_set);
    }
    bool any = WORD(work.phase) < AUVID_WORK_MERGE;
    COPY(&rows_of, MEMBER(metric.result.dof_rows));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool is_excited = (excited >> j & 1u) != 0;
        good = good && (((excited | coupled) >> j & 1u) == 0 || rows_of[j] > 0);
        any = any || (is_excited && m->layout.count[j] > 0);
    }
    return good && any;
}

/* The position of the pass through the sets. */
static bool checkpoint_check_pass(const subject_t *s)
{
    const auvid_metric_t *m = &s->id->metric;
    uint32_t phase = WORD(work.phase), sets = m->cfg.sets;
    auvid_metric_cursor_t at;
    COPY(&at, MEMBER(metric.evaluator.at));
    bool linear = !auvid_metric_stores_rows(m), merges = at.pass <= PASS_ADDED;
    bool walks = at.pass <= PASS_COUPLED || at.pass == PASS_MEASURE; /* by DoF */
    bool in_dof = at.dof < AUVID_DOF_COUNT || !walks || at.set >= at.to_set;
    bool right = true;
    switch (phase) {
    case AUVID_WORK_MERGE:
        right = ((s->view->parts & (PART_NEWTON | PART_LOCAL)) != 0 || merges) && in_dof;
        break;
    case AUVID_WORK_COST:
        right = at.pass == PASS_COST && at.dof <= AUVID_DOF_COUNT &&
                (!linear || at.dof == AUVID_DOF_COUNT || at.row <= m->layout.count[at.dof]);
        break;
    case AUVID_WORK_PREDICT:
    case AUVID_WORK_COMPARE:
    case AUVID_WORK_MEASURE:
        right = at.pass == PASS_MEASURE && in_dof;
        break;
    case AUVID_WORK_PREPARE:
    case AUVID_WORK_LINEARISE:
        right = linear || ((at.pass == PASS_LINEAR || merges) && in_dof);
        break;
    case AUVID_WORK_CHANGE_TEST:
        right = at.pass == PASS_LAST;
        break;
    default:
        break;
    }
    if (at.pass == PASS_LINEAR && right) { /* the row is present */
        uint32_t age = (uint32_t)at.to_set - at.set, count = sets - WORD(metric.sets.from);
        uint32_t rows = age < count ? checkpoint_set_rows(s, age) : 0u;
        right = at.set <= at.to_set && at.row <= rows && (at.part == 0 || at.row < rows) &&
                at.part < 2u * m->cfg.vehicle->parameters + 3u;
    }
    return right && at.to_set <= sets &&
           at.set <= sets + (phase == AUVID_WORK_CHANGE_TEST ? 2u : 0u);
}

/* The row that waits for its rotation: of the regressor path, and of DoF with an equation. */
static bool checkpoint_check_row(const subject_t *s)
{
    const auvid_metric_t *m = &s->id->metric;
    uint32_t waiting = WORD(metric.rows.waiting);
    bool good = waiting == 0 || (!auvid_metric_stores_rows(m) && WORD(metric.rows.since_gap) > 0);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        good = good && ((waiting >> j & 1u) == 0 || auvid_metric_order(m, j) > 0);
    }
    return good;
}

static bool checkpoint_check_metric(const subject_t *s)
{
    return checkpoint_check_ring(s) && checkpoint_check_row(s) && checkpoint_check_sets(s) &&
           checkpoint_check_pass(s);
}

/* Are all `n` reals of `point` between the bounds? */
static bool checkpoint_is_inside(const subject_t *s, size_t point, size_t lower, size_t upper,
                                 uint32_t n)
{
    auvid_real_t x[AUVID_MAX_PARAMETERS], low[AUVID_MAX_PARAMETERS], high[AUVID_MAX_PARAMETERS];
    bool inside = true;
    COPY(&x, point);
    COPY(&low, lower);
    COPY(&high, upper);
    for (uint32_t i = 0; i < n; ++i) {
        inside = inside && x[i] >= low[i] && x[i] <= high[i];
    }
    return inside;
}

static bool checkpoint_check_crs(const subject_t *s)
{
    uint32_t n = WORD(optimizer.cfg.n), m = WORD(optimizer.cfg.population);
    bool filling = WORD(optimizer.state) <= AUVID_OPTIMIZER_FILL;
    bool good = n < m && filling == (WORD(optimizer.work.crs) < m);
    for (size_t k = 0; good && k < m; ++k) {
        good = checkpoint_word(s, MEMBER(optimizer.crs.order) + 2 * k, 2) < m;
    }
    return good && WORD(optimizer.crs.known) <= m && WORD(optimizer.crs.best) < m &&
           WORD(optimizer.crs.worst) < m;
}

static bool checkpoint_check_line_search(const subject_t *s)
{
    uint32_t n = WORD(optimizer.cfg.n), move = WORD(optimizer.line_search.move);
    uint32_t direction = WORD(optimizer.line_search.direction);
    auvid_real_t axis_step;
    COPY(&axis_step, MEMBER(optimizer.line_search.axis_step));
    bool pattern = direction == 2u * n;
    return direction <= 2u * n && WORD(optimizer.line_search.built) <= n &&
           WORD(optimizer.line_search.probe) < (move == MOVE_PROBE ? direction / 2u : n) &&
           (!pattern || (move < MOVE_AXIS && auvid_is_zero(axis_step)));
}

static bool checkpoint_check_search(const subject_t *s)
{
    bool global = (s->view->parts & PART_GLOBAL) != 0;
    uint32_t delay = auvid_metric_stores_rows(&s->id->metric) && s->id->metric.cfg.estimate_delay;
    uint32_t n = WORD(optimizer.cfg.n);
    return n == auvid_count_bits(WORD(work.active)) + delay &&
           global == (WORD(optimizer.state) < AUVID_OPTIMIZER_START) &&
           (global ? checkpoint_check_crs(s) : checkpoint_check_line_search(s)) &&
           (!WORD(optimizer.asked) ||
            checkpoint_is_inside(s, MEMBER(optimizer.trial), MEMBER(optimizer.cfg.lower),
                                 MEMBER(optimizer.cfg.upper), n));
}

/* The partner named by a finding is one of the model's parameters. */
static bool checkpoint_check_notes(const subject_t *s, uint8_t root, size_t confidence)
{
    bool good = true;
    uint8_t note[AUVID_MAX_PARAMETERS], partner[AUVID_MAX_PARAMETERS];
    checkpoint_copy(s, root, confidence + offsetof(auvid_confidence_t, note), note, sizeof note);
    checkpoint_copy(s, root, confidence + offsetof(auvid_confidence_t, partner), partner,
                    sizeof partner);
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        bool names = note[i] == AUVID_NOTE_COMBINATION || note[i] == AUVID_NOTE_BESIDE_BOUND ||
                     note[i] == AUVID_NOTE_DISCREDITED;
        good = good && (!names || partner[i] < identifier_vehicle(s->id)->parameters);
    }
    return good;
}

/* Is the least-squares problem at that offset one of n parameters? */
static bool checkpoint_check_bounded_ls(const subject_t *s, size_t at, uint32_t n)
{
    const auvid_metric_t *m = &s->id->metric;
    uint32_t dof = WORD_AT(at, auvid_bounded_ls_t, dof);
    bool good = n == WORD_AT(at, auvid_bounded_ls_t, n) &&
                WORD_AT(at, auvid_bounded_ls_t, fixed_from) <= n &&
                WORD_AT(at, auvid_bounded_ls_t, at) <= n + 1u &&
                WORD_AT(at, auvid_bounded_ls_t, changes) <= 4u * (n + 1u) &&
                (dof == AUVID_DOF_COUNT ||
                 WORD_AT(at, auvid_bounded_ls_t, row) <= (uint32_t)auvid_metric_order(m, (int)dof));
    for (size_t k = 0; good && k < n; ++k) {
        good = checkpoint_word(s, at + offsetof(auvid_bounded_ls_t, order) + k, 1) < n;
    }
    return good;
}

static bool checkpoint_check_optimum(const subject_t *s)
{
    uint32_t n = WORD(optimum.n), dof = WORD(optimum.dof);
    return n == auvid_count_bits(WORD(work.active)) &&
           checkpoint_check_bounded_ls(s, MEMBER(optimum), n) &&
           WORD(optimum.changes) < 4u * (n + 1u) &&
           (dof == AUVID_DOF_COUNT || WORD(optimum.row) <= s->id->metric.layout.count[dof]) &&
           checkpoint_is_inside(s, MEMBER(optimum.x), MEMBER(optimum.lower), MEMBER(optimum.upper),
                                n);
}

/* Gauss-Newton steps: both points are inside, and the pass is what the state needs. */
static bool checkpoint_check_newton(const subject_t *s)
{
    const auvid_metric_t *m = &s->id->metric;
    uint32_t n = auvid_count_bits(WORD(work.active)) + m->cfg.estimate_delay;
    uint32_t state = WORD(linear.newton.state), pass = WORD(metric.evaluator.at.pass);
    bool right = state == NEWTON_COST   ? pass == PASS_COST
                 : state == NEWTON_ROWS ? pass <= PASS_ADDED || pass == PASS_LINEAR
                                        : true;
    return right && (state != NEWTON_DONE || WORD(work.spent) > WORK_OPTIMUM) &&
           checkpoint_check_bounded_ls(s, MEMBER(linear.newton.ls), n) &&
           WORD(linear.newton.damped) <= n &&
           checkpoint_is_inside(s, MEMBER(linear.newton.x), MEMBER(linear.newton.lower),
                                MEMBER(linear.newton.upper), n) &&
           checkpoint_is_inside(s, MEMBER(linear.newton.ls.x), MEMBER(linear.newton.lower),
                                MEMBER(linear.newton.upper), n);
}

/* Is a solution with uncertain inputs under way, or waiting to be published? */
static bool checkpoint_is_solving(const subject_t *s)
{
    bool solving = false;
    if ((s->view->parts & PART_UNCERTAIN) != 0) {
        checkpoint_copy(s, ROOT_UNCERTAIN, offsetof(auvid_uncertain_t, work.solving), &solving, 1);
    }
    return solving;
}

static bool checkpoint_check_job(const subject_t *s)
{
    const auvid_metric_t *m = &s->id->metric;
    uint32_t n = WORD(confidence.n), phase = WORD(confidence.phase), j = WORD(confidence.at.dof);
    bool good = n <= m->cfg.vehicle->parameters && WORD(confidence.at.set) < m->cfg.sets &&
                checkpoint_check_notes(s, ROOT_IDENTIFIER, MEMBER(confidence.result));
    uint8_t column_of[AUVID_MAX_PARAMETERS], parameter_of[AUVID_MAX_PARAMETERS];
    COPY(&column_of, MEMBER(confidence.column_of));
    COPY(&parameter_of, MEMBER(confidence.parameter_of));
    for (int i = 0; i < AUVID_MAX_PARAMETERS; ++i) {
        bool used = i < m->cfg.vehicle->parameters;
        good = good && (!used || column_of[i] < n || column_of[i] == NOWHERE) &&
               parameter_of[i] < m->cfg.vehicle->parameters;
    }
    if (phase == DONE) {
        return good;
    }
    if (!good || j >= AUVID_DOF_COUNT || m->layout.count[j] == 0 ||
        ((WORD(metric.result.excited) | WORD(metric.result.coupled)) >> j & 1u) == 0) {
        return false;
    }
    uint32_t steps = phase == OPTIMUM || phase == BIAS ? 1u
                     : phase == ROTATE                 ? m->layout.count[j]
                     : phase == SCATTER ? 2u * (uint32_t)auvid_metric_order(m, (int)j) + 1u
                                        : n;
    return phase < DONE && WORD(confidence.at.row) < steps;
}

static bool checkpoint_check_prediction(const subject_t *s)
{
    uint32_t compared[AUVID_DOF_COUNT], cells;
    checkpoint_copy(s, ROOT_PREDICTION, offsetof(auvid_validation_t, compared), compared,
                    sizeof compared);
    checkpoint_copy(s, ROOT_PREDICTION, offsetof(auvid_validation_t, cells), &cells, sizeof cells);
    bool good = identifier_vehicle(s->id)->acceleration != NULL;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        good = good && compared[j] <= cells;
    }
    return good;
}

static bool checkpoint_check_prior(const subject_t *s)
{
    auvid_prior_t prior;
    checkpoint_copy(s, ROOT_PRIOR, 0, &prior, offsetof(auvid_prior_t, known) + sizeof prior.known);
    return auvid_prior_check(&s->id->metric, &prior) == AUVID_OK;
}

static bool checkpoint_search_matches_phase(const subject_t *s)
{
    uint32_t phase = WORD(work.phase);
    uint32_t work = s->view->parts & (PART_GLOBAL | PART_LOCAL | PART_CONFIDENCE | PART_OPTIMUM |
                                      PART_NEWTON | PART_WINDOWS);
    bool residual = auvid_metric_stores_rows(&s->id->metric), searching = WORD(work.searching) != 0;
    bool measures = phase == AUVID_WORK_MEASURE; /* again, if a set has entered the ring */
    bool linearises = phase == AUVID_WORK_LINEARISE, solves = linearises && !residual;
    bool finds_optimum = phase == AUVID_WORK_MERGE && WORD(work.spent) == WORK_OPTIMUM;
    bool steps = residual && phase == AUVID_WORK_MERGE && WORD(work.spent) > 0;
    bool must = phase == AUVID_WORK_ASK || phase == AUVID_WORK_COST || (residual && measures);
    bool neighbours = WORD(work.neighbours) != 0;
    if ((phase >= AUVID_WORK_ASK && WORD(work.active) == 0) ||
        (solves && !checkpoint_is_solving(s)) ||
        (neighbours && !(residual && searching && !measures && WORD(work.sides_left) > 0))) {
        return false;
    }
    if (WORD(work.seeks_optimum) != 0) {
        return !residual && !searching && (finds_optimum || solves) && work == PART_OPTIMUM &&
               checkpoint_check_optimum(s);
    }
    if (residual && (linearises || phase == AUVID_WORK_PREPARE)) {
        return !searching && work == PART_WINDOWS;
    }
    if (steps && !searching) {
        return work == PART_NEWTON && checkpoint_check_newton(s);
    }
    if (searching) {
        bool again = steps && !finds_optimum && work == PART_LOCAL; /* not confirmed */
        return (must || again || measures || solves) &&
               (work == PART_GLOBAL || work == PART_LOCAL) && checkpoint_check_search(s);
    }
    if (phase == AUVID_WORK_CONFIDENCE) {
        return work == PART_CONFIDENCE && checkpoint_check_job(s);
    }
    return !must && !finds_optimum && work == 0;
}

static bool checkpoint_check_identifier(const subject_t *s)
{
    uint32_t parts = s->view->parts;
    return parts < 2u * (PART_END - 1u) && WORD(work.spent) <= WORK_LAST_SPENT + 1u &&
           ((parts & PART_RESIDUAL) != 0) == auvid_metric_stores_rows(&s->id->metric) &&
           ((parts & PART_SIMULATED) == 0 || checkpoint_check_prediction(s)) &&
           (WORD(work.active) & ~auvid_metric_free_of(&s->id->metric, UINT8_MAX)) == 0 &&
           checkpoint_check_notes(s, ROOT_IDENTIFIER, MEMBER(estimate.confidence)) &&
           ((parts & PART_CHANGE) != 0
                ? checkpoint_check_notes(s, ROOT_CHANGE,
                                         offsetof(auvid_change_detector_t, accepted.confidence))
                : WORD(work.untested) == 0) &&
           ((parts & PART_PRIOR) == 0 || checkpoint_check_prior(s)) &&
           ((parts & PART_UNCERTAIN) == 0 ||
            checkpoint_check_notes(s, ROOT_UNCERTAIN,
                                   offsetof(auvid_uncertain_t, estimate.confidence))) &&
           checkpoint_search_matches_phase(s);
}

/* Do the members of a part agree? @param first offset of its block */
static bool checkpoint_check_part(const subject_t *s, uint32_t bit, uint8_t root, size_t first)
{
    if ((s->view->parts & bit) == 0) {
        return true;
    }
    const auvid_checkpoint_part_t *part = checkpoint_part(s->id, root);
    const uint8_t *state = checkpoint_find(s->view, root, first, 1);
    return part->check(s->id, state, s->view->parts, WORD(work.phase));
}

auvid_status_t auvid_checkpoint_validate(const auvid_identifier_t *id,
                                         const auvid_checkpoint_view_t *v)
{
    const subject_t subject = {id, v};
    bool good = true;
    for (size_t k = 0; good && k < auvid_checkpoint_structs; ++k) {
        const auvid_checkpoint_struct_t *structs = &auvid_checkpoint_struct[k];
        bool there = structs->parts == 0 || (structs->parts & v->parts) != 0;
        good = !there || checkpoint_check_structs(&subject, structs);
    }
    good = good && checkpoint_check_nav(&subject) && checkpoint_check_recorder(&subject) &&
           checkpoint_check_metric(&subject) && checkpoint_check_identifier(&subject) &&
           checkpoint_check_part(&subject, PART_UNCERTAIN, ROOT_UNCERTAIN,
                                 offsetof(auvid_uncertain_t, begin_us)) &&
           checkpoint_check_part(&subject, PART_INSTRUMENTS, ROOT_INSTRUMENTS,
                                 offsetof(auvid_instruments_t, last_us));
    return good ? AUVID_OK : AUVID_ERR_RANGE;
}
