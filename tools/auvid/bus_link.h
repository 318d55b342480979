/**
 * @file bus_link.h
 * A bus with a log beside it, for the node and the vehicle: frames of the library to and from those
 * of the port.
 */
#ifndef PROGRAM_BUS_LINK_H
#define PROGRAM_BUS_LINK_H

#include "auvid/can.h"
#include "bus_candump.h"
#include "bus_socketcan.h"
#include "options.h"
#include "tick.h"

/** Length of a tick [us]. */
#define LINK_TICK_US 20000u

/** Silence after which the other side counts as gone [us]. */
#define LINK_SILENCE_US 2000000u

typedef struct {
    const char *command; /**< sub-command, for messages */
    bus_t *bus;
    bus_socketcan_t socket;
    bus_candump_t log;
    tick_t tick;
    bool logging, log_failed, ticking, down;
} link_t;

/** Open a real interface and the tick. Returns 0, or EXIT_REFUSED after one line on stderr. */
int link_open(link_t *link, const char *command, const options_t *options);

/** Tick; ask for real-time scheduling if told so. Returns as link_open. */
int link_tick(link_t *link, const options_t *options);

/** Take a bus that is there already; no tick. */
void link_take(link_t *link, const char *command, bus_t *bus);

/** Create a log. Returns 0 or EXIT_REFUSED, as above. */
int link_log(link_t *link, const char *path, const char *interface);

/** Send all frames, then log them, then tell what failed. A frame that is lost is counted by the
 * bus. Returns 0 or EXIT_REFUSED. */
int link_send(link_t *link, const auvid_can_frame_t *frame, int count);

/** Next data frame with an 11-bit identifier, logged. Returns 1; 0: none now; -1 after one line on
 * stderr: the bus is broken. */
int link_receive(link_t *link, auvid_can_frame_t *frame);

/** Close all. Returns 0 or EXIT_REFUSED (the log could not be written). */
int link_close(link_t *link);

#endif
