/**
 * @file auvid_node_step_internal.h
 * Private: functions of the tick that the other files of the node use.
 */
#ifndef AUVID_NODE_STEP_INTERNAL_H
#define AUVID_NODE_STEP_INTERNAL_H

#include "auvid/node.h"

/** State of the guard; a passive node is DISARMED. */
static inline auvid_guard_state_t auvid_node_guard_state(const auvid_node_t *node)
{
    return node->id.actuation == NULL ? AUVID_GUARD_DISARMED : node->id.actuation->guard.state;
}

/** Returns the number of an estimate on the bus: after 127 follows 1, as 0 means none. */
static inline uint32_t auvid_node_number(uint32_t number)
{
    return number < 128u ? number : (number - 1u) % 127u + 1u;
}

/** Has the thrust of all thrusters in use arrived since it was last recorded? */
static inline bool auvid_node_has_feedback(const auvid_node_t *node)
{
    return node->feedback == (node->allocation.cfg.thrusters > 4 ? 3u : 1u);
}

/** Aborts the guard, which the node must have; as the operator does if the cause is none. */
void auvid_node_abort(auvid_node_t *node, auvid_guard_cause_t cause);

/** Obeys an arm frame. @param fresh its counter is good, so a disarm may clear an abort */
void auvid_node_order(auvid_node_t *node, uint32_t action, bool fresh);

/** Packs a message as the next frame to send. A refused message is omitted, and the sender counts
 * it. */
void auvid_node_send(auvid_node_t *node, const auvid_can_message_t *message,
                     auvid_can_frame_t *frame, int *count);

#endif
