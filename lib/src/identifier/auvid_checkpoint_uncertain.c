/*
 * The checkpoint: conditions between the members of the uncertain inputs, and of the instruments.
 * Their columns are not saved; they are those that were laid out when they were attached.
 */
#include "auvid_checkpoint_layout_internal.h"
#include "auvid_uncertain_parts_internal.h"

/* Byte of the block in which a member is; the member, unsigned; a real. */
#define AT(type, first, member) (state + offsetof(type, member) - offsetof(type, first))
#define WHOLE_AT(type, first, member)                                                              \
    auvid_checkpoint_whole(AT(type, first, member), sizeof(((type *)0)->member))
#define OF_INPUTS(member) WHOLE_AT(auvid_uncertain_t, begin_us, member)
#define OF_INSTRUMENTS(member) WHOLE_AT(auvid_instruments_t, last_us, member)

/* Rows are of DoF that have columns. A solution is at one of its steps. */
bool auvid_checkpoint_check_uncertain(const auvid_identifier_t *id, const uint8_t *state)
{
    const auvid_uncertain_t *u = id->attached.uncertain;
    auvid_real_t rows[AUVID_DOF_COUNT];
    bool good = true;
    memcpy(rows, AT(auvid_uncertain_t, begin_us, rows), sizeof rows);
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        bool any = rows[j] > AUVID_C(0.0) || (OF_INPUTS(recorded.pending) >> 2 * j & 3u) != 0;
        good = good && (!any || u->equation[j].order > 0);
    }
    if (OF_INPUTS(work.solving) != 0) {
        int phase = (int)OF_INPUTS(work.phase), j = (int)OF_INPUTS(work.dof);
        bool projected = OF_INPUTS(work.strong) != 0;
        good = good && (!projected || u->instruments != NULL) &&
               auvid_uncertain_is_step(u, &id->metric, phase, j, (int)OF_INPUTS(work.row),
                                       projected) &&
               (j == AUVID_DOF_COUNT || rows[j] > AUVID_C(0.0));
    }
    return good;
}

/* The ring holds the references that were not yet taken; rows are of DoF that have instruments. */
bool auvid_checkpoint_check_instruments(const auvid_identifier_t *id, const uint8_t *state)
{
    const auvid_instruments_t *n = id->attached.uncertain->instruments;
    uint32_t given = (uint32_t)OF_INSTRUMENTS(given), taken = (uint32_t)OF_INSTRUMENTS(taken);
    bool good = given - taken <= AUVID_INSTRUMENT_PAST;
    for (int j = 0; j < AUVID_DOF_COUNT; ++j) {
        good = good && ((OF_INSTRUMENTS(waiting) >> j & 1u) == 0 || n->of[j].count > 0);
    }
    return good;
}
