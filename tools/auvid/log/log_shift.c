#include "log_shift.h"

#include <stdlib.h>
#include <string.h>

#include "../base/report_error.h"

enum { ROOM = 256 }; /* of the first samples */

/* Makes room for one more sample at the end. */
static bool make_room(log_shift_t *s)
{
    if (s->first + s->count < s->room) {
        return true;
    }
    if (s->first > 0) {
        memmove(s->waiting, s->waiting + s->first, s->count * sizeof s->waiting[0]);
        s->first = 0;
        return true;
    }
    size_t room = s->room > 0 ? 2 * s->room : ROOM;
    log_sample_t *more = realloc(s->waiting, room * sizeof more[0]);
    if (more == NULL) {
        return false;
    }
    s->waiting = more;
    s->room = room;
    return true;
}

int log_shift_split(log_shift_t *s, int64_t shift_us, log_sample_t *now)
{
    if (!make_room(s)) {
        return report_error("not enough memory");
    }
    log_sample_t *late = &s->waiting[s->first + s->count++];
    *late = *now;
    log_sample_t *inputs = shift_us > 0 ? late : now, *rest = shift_us > 0 ? now : late;
    inputs->has_attitude = inputs->has_reference = inputs->has_known = false;
    inputs->velocity = 0;
    rest->has_input = false;
    return 0;
}

bool log_shift_due(log_shift_t *s, uint64_t t_us, log_sample_t *out)
{
    if (s->count == 0) {
        return false;
    }
    *out = s->waiting[s->first];
    if ((out->has_input ? out->input_us : out->t_us) > t_us) {
        return false;
    }
    ++s->first;
    --s->count;
    return true;
}

void log_shift_end(log_shift_t *s)
{
    free(s->waiting);
    *s = (log_shift_t){0};
}
