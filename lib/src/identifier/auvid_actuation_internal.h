/**
 * @file auvid_actuation_internal.h
 * Private: what the identifier calls of an attached acting half.
 */
#ifndef AUVID_ACTUATION_INTERNAL_H
#define AUVID_ACTUATION_INTERNAL_H

#include "auvid/actuation.h"

/** Largest altitude that is taken [m]. */
#define AUVID_ACTUATION_HIGHEST_M AUVID_C(1e9)

/** The functions, called for an identifier with an acting half only. */
typedef struct auvid_actuation_functions {
    /** Last part of a tick: altitude, guard, excitation. out: zeroed before; its events are not
     * written. */
    void (*step)(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out);
    /** Report a rejected step to the guard, which aborts if it is armed. in, out: may be NULL. */
    void (*refuse)(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out);
} auvid_actuation_functions_t;

/** Is there an identifier with an acting half? @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE
 * (not initialised); AUVID_ERR_DETACHED. */
auvid_status_t auvid_actuation_check(const auvid_identifier_t *id);

/** Does the vehicle move by the excitation now? */
static inline bool auvid_actuation_excites(const auvid_identifier_t *id)
{
    return id->actuation != NULL && id->actuation->guard.state == AUVID_GUARD_EXCITING;
}

#endif
