/**
 * @file bus_link.h
 * A bus with an optional log, for the node and the vehicle. Converts between frames of the library
 * and frames of the port.
 */
#ifndef PROGRAM_BUS_LINK_H
#define PROGRAM_BUS_LINK_H

#include "auvid/can.h"
#include "bus_candump.h"
#include "bus_socketcan.h"
#include "../options/options.h"
#include "tick.h"

/** Length of a tick [us]. */
#define LINK_TICK_US 20000u

/** Time without frames after which the other side counts as lost [us]. */
#define LINK_SILENCE_US 2000000u

typedef struct {
    const char *command; /**< name of the sub-command, for messages */
    bus_t *bus;
    bus_socketcan_t socket;
    bus_candump_t log;
    tick_t tick;
    uint32_t unsent; /**< bit i: the bus did not take frame i of the last link_send */
    bool logging, log_failed, ticking, down;
} link_t;

/** Opens a real interface and the tick. Returns 0, or EXIT_REFUSED after one line on stderr. */
int link_open(link_t *link, const char *command, const options_t *options);

/** Starts the tick, with real-time scheduling if the options ask for it. Returns as link_open. */
int link_tick(link_t *link, const options_t *options);

/** Uses a bus that is already open, without a tick. */
void link_take(link_t *link, const char *command, bus_t *bus);

/** Creates a log. Returns as link_open. */
int link_log(link_t *link, const char *path, const char *interface);

/** Sends up to 32 frames, then logs those that the bus took, then reports failures. The bus counts
 * a frame that is lost, link->unsent says which one. Returns 0 or EXIT_REFUSED. */
int link_send(link_t *link, const auvid_can_frame_t *frame, int count);

/** Receives and logs the next data frame with an 11-bit identifier. Returns 1; 0 if there is none
 * now; -1 after one line on stderr if the bus is broken. */
int link_receive(link_t *link, auvid_can_frame_t *frame);

/** Closes everything. Returns 0, or EXIT_REFUSED if the log could not be written. */
int link_close(link_t *link);

#endif
