/**
 * @file auvid_node_step_internal.h
 * Private: what the tick shares with the other files of the node.
 */
#ifndef AUVID_NODE_STEP_INTERNAL_H
#define AUVID_NODE_STEP_INTERNAL_H

#include "auvid/node.h"

/** Obey an arm frame. @param fresh its counter is good: a disarm may clear an abort */
void auvid_node_order(auvid_node_t *node, uint32_t action, bool fresh);

/** Pack a message as the next of the frames to be sent. One that is refused is left out, and
 * counted by the sender. */
void auvid_node_send(auvid_node_t *node, const auvid_can_message_t *message,
                     auvid_can_frame_t *frame, int *count);

#endif
