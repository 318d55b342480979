/**
 * @file bus_identifier.h
 * The identifier of a node on a bus, as the options set it up: that of `auvid node` and of
 * `auvid replay`.
 */
#ifndef PROGRAM_BUS_IDENTIFIER_H
#define PROGRAM_BUS_IDENTIFIER_H

#include "world.h"

/** A node and what is attached to it. It must not move. */
typedef struct {
    auvid_node_t node;
    auvid_actuation_t actuation;
    auvid_validation_t prediction;
    auvid_change_detector_t change;
    auvid_uncertain_t uncertain; /* not with --plain */
} bus_identifier_t;

/** Starts.
 * @param answer the node answers each tick frame, in lock step
 * @param excites the excitation is attached
 * @return 0, or EXIT_REFUSED after one line on stderr */
int bus_identifier_begin(bus_identifier_t *to, const options_t *options, bool answer, bool excites);

#endif
