/*
 * The checkpoint: the ranges of the members of the uncertain inputs and of the instruments, and the
 * conditions between them. Their columns are not saved; they are those that were laid out when they
 * were attached.
 */
#include "../checkpoint/auvid_checkpoint_limits_internal.h"
#include "auvid_uncertain_parts_internal.h"

enum { UNCERTAIN_MAX_ORDER = AUVID_UNCERTAIN_ORDER };

/* What is unlimited is checked before it enters a row. */
static const auvid_checkpoint_limit_t checkpoint_limit_uncertain[] = {
    COUNT(uncertain, uint16_t, recorded.pending, recorded.pending,
          (1 << AUVID_METRIC_BANDS * AUVID_DOF_COUNT) - 1),
    BYTE(uncertain, recorded.successive, recorded.successive, AUVID_METRIC_LAGS),
    BYTE(uncertain, recorded.begun_before, recorded.begun_before, MAX_OVERLAP),
    BYTE(uncertain, recorded.slot, recorded.complete, MAX_OVERLAP - 1),
    DOF_BITS(uncertain, recorded.dofs, recorded.dofs),
    BYTE(uncertain, recorded.waits, recorded.waits, 2),
    FLAG(uncertain, recorded.completes, recorded.takes_rows),
    VALUE(uncertain, recorded.previous, recorded.band),
    VALUE(uncertain, recorded.speed, recorded.curvature),
    UP_TO(uncertain, recorded.spread, recorded.spread, AUVID_C(0.5)),
    UP_TO(uncertain, recorded.elapsed, recorded.elapsed, AUVID_C(1e5)),
    UP_TO(uncertain, recorded.wrench, recorded.difference, AUVID_LARGEST),
    BYTE(uncertain, work.pass, work.pass, 3),
    FLAG(uncertain, work.solving, work.solving),
    FINITE(uncertain, work.joint, work.weight),
    FINITE(uncertain, work.causes.asymmetry, work.causes.one_way),
    BYTE(uncertain, work.part.drag_at, work.part.sag_at, UNCERTAIN_MAX_ORDER),
    BYTE(uncertain, work.part.mass_at, work.part.mass_at, UNCERTAIN_MAX_ORDER - 1),
    FINITE(uncertain, work.part.factor, work.part.scale),
    FINITE(uncertain, factor, factor),
    UP_TO(uncertain, rows, rows, AUVID_C(1e9)),
    FINITE(uncertain, forgotten, forgotten),
    UP_TO(uncertain, linear, linear, 1),
    FINITE(uncertain, hidden, hidden),
    UP_TO(uncertain, half_length_m, half_length_m, AUVID_LARGEST),
    VALUE(uncertain, pi, own),
    UP_TO(uncertain, scale, scale, 2),
    FLAG(uncertain, excited, excited),
    BYTE(uncertain, informed, informed, 2),
    FLAG(uncertain, contradicted, gave_set),
    FINITE(uncertain, causes.asymmetry, causes.one_way),
    BYTE(uncertain, causes.order, causes.order, AUVID_CAUSE_COUNT - 1),
    BYTE(uncertain, causes.named, causes.named, AUVID_CAUSE_COUNT),
    FLAG(uncertain, causes.contradicted, causes.thrust_differs),
    VALUE(cause, value, share),
    BYTE(cause, input, input, INPUTS - 1),
    BYTE(cause, dof, dof, AUVID_DOF_COUNT - 1),
    FLAG(cause, named, named),
};

static const auvid_checkpoint_limit_t checkpoint_limit_instruments[] = {
    WITHIN(reference, nu, nu, AUVID_RECORDER_LARGEST),
    VALUE(instruments, lagged, lagged),
    VALUE(instruments, factor, factor),
    UP_TO(instruments, rows, rows, AUVID_C(1e9)),
    VALUE(instruments, wide, wide),
};

/* Byte of the block in which a member is; the member, unsigned; a real. */
#define STATE_AT(type, first, member) (state + offsetof(type, member) - offsetof(type, first))
#define WHOLE_AT(type, first, member)                                                              \
    auvid_checkpoint_whole(STATE_AT(type, first, member), sizeof(((type *)0)->member))
#define OF_INPUTS(member) WHOLE_AT(auvid_uncertain_t, begin_us, member)
#define OF_INSTRUMENTS(member) WHOLE_AT(auvid_instruments_t, last_us, member)

/* A solution is at one of its steps, and the memory that it shares with the search is saved. While
 * the sets are measured again, or the confidence is computed, it is complete. */
static bool checkpoint_check_solution(const auvid_identifier_t *id, const uint8_t *state,
                                      uint32_t parts, uint32_t work)
{
    const auvid_uncertain_t *u = id->attached.uncertain;
    int phase = (int)OF_INPUTS(work.phase), j = (int)OF_INPUTS(work.dof);
    int i = (int)OF_INPUTS(work.row);
    bool projected = OF_INPUTS(work.strong) != 0;
    bool seeks = (phase == SOLVE_REDUCE && i > 0) || phase == SOLVE_OPTIMUM || phase == SOLVE_START;
    if (work != AUVID_WORK_LINEARISE) {
        return (work == AUVID_WORK_MEASURE || work == AUVID_WORK_CONFIDENCE) && phase == SOLVE_DONE;
    }
    return (!projected || u->instruments != NULL) &&
           auvid_uncertain_is_step(u, &id->metric, phase, j, i, projected) &&
           seeks == ((parts & PART_OPTIMUM) != 0) &&
           (phase == SOLVE_SEARCH || (parts & (PART_GLOBAL | PART_LOCAL)) == 0);
}

/* A named cause is of its class: there are words for it. */
static bool checkpoint_check_causes(const uint8_t *causes)
{
    bool good = true;
    for (int k = 0; k < AUVID_CAUSE_COUNT; ++k) {
        auvid_cause_t cause;
        memcpy(&cause, causes + offsetof(auvid_causes_t, cause) + (size_t)k * sizeof cause,
               sizeof cause);
        good = good && (!cause.named || (int)auvid_uncertain_row(cause.input)->class == k);
    }
    return good;
}

/* Rows are of DoF that have columns. */
static bool checkpoint_check_uncertain(const auvid_identifier_t *id, const uint8_t *state,
                                       uint32_t parts, uint32_t phase)
{
    const auvid_uncertain_t *u = id->attached.uncertain;
    auvid_real_t rows[AUVID_DOF_COUNT];
    memcpy(rows, STATE_AT(auvid_uncertain_t, begin_us, rows), sizeof rows);
    bool good = checkpoint_check_causes(STATE_AT(auvid_uncertain_t, begin_us, causes)) &&
                checkpoint_check_causes(STATE_AT(auvid_uncertain_t, begin_us, work.causes));
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool any = rows[j] > AUVID_C(0.0) || (OF_INPUTS(recorded.pending) >> 2 * j & 3u) != 0;
        good = good && (!any || u->equation[j].order > 0);
    }
    if (OF_INPUTS(work.solving) != 0) {
        uint32_t j = (uint32_t)OF_INPUTS(work.dof);
        good = good && checkpoint_check_solution(id, state, parts, phase) && j <= AUVID_DOF_COUNT &&
               (j == AUVID_DOF_COUNT || rows[j] > AUVID_C(0.0));
    }
    return good;
}

/* The ring holds the references that were not yet taken; rows are of DoF that have instruments. */
static bool checkpoint_check_instruments(const auvid_identifier_t *id, const uint8_t *state,
                                         uint32_t parts, uint32_t phase)
{
    (void)parts;
    (void)phase;
    const auvid_instruments_t *n = id->attached.uncertain->instruments;
    uint32_t given = (uint32_t)OF_INSTRUMENTS(given), taken = (uint32_t)OF_INSTRUMENTS(taken);
    bool good = given - taken <= AUVID_INSTRUMENT_PAST;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        good = good && ((OF_INSTRUMENTS(waiting) >> j & 1u) == 0 || n->of[j].count > 0);
    }
    return good;
}

#define PART(what)                                                                                 \
    {                                                                                              \
        checkpoint_limit_##what,                                                                   \
            sizeof checkpoint_limit_##what / sizeof checkpoint_limit_##what[0],                    \
            checkpoint_check_##what                                                                \
    }
const auvid_checkpoint_part_t auvid_uncertain_checkpoint = PART(uncertain);
const auvid_checkpoint_part_t auvid_instruments_checkpoint = PART(instruments);
