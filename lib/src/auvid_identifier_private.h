/**
 * @file auvid_identifier_private.h
 * Private: between the tick and its excitation.
 */
#ifndef AUVID_IDENTIFIER_PRIVATE_H
#define AUVID_IDENTIFIER_PRIVATE_H

#include "auvid/identifier.h"

/** Has init succeeded? A firmware that goes on without must not fly blind. */
static inline bool identifier_is_ready(const auvid_identifier_t *id)
{
    return id->cfg.vehicle != NULL;
}

/** The last part of a tick: altitude, guard, excitation. out: zeroed; written but its events. */
void auvid_identifier_act(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out);

/** A step is refused: for a watching guard a breach. All may be null. */
void auvid_identifier_refused(auvid_identifier_t *id, const auvid_input_t *in, auvid_output_t *out);

#endif
