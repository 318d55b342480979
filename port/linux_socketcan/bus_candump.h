/*
 * The bus of bus.h over a log as `candump -L` writes it: one frame a line,
 *
 *     (1436509053.249713) can0 044#2A366C2B
 *
 * which can-utils, cantools, python-can and SavvyCAN read too. Ids of 29 bits have eight digits,
 * error frames too with bit 29 set, remote requests are `123#R` or `123#R8`. A trailing R or T
 * (received, sent) is ignored. CAN FD frames (`123##1112233`) are counted and skipped. A last line
 * without a line end may be cut off: the log ends before it (BUS_END), and bus.text says so.
 * Anything else is refused with its line number. The frames before it have been handed out by then.
 */
#ifndef BUS_CANDUMP_H
#define BUS_CANDUMP_H

#include <stdio.h>

#include "bus.h"

typedef struct {
    bus_t bus; /* first; fd is -1: a log never makes one wait */
    FILE *file;
    const char *path;   /* the caller's string, kept */
    char interface[16]; /* reading: take only this one's frames, "" for all; writing: the name */
    bool writing;
    uint64_t line;      /* lines read or written */
    uint64_t fd_frames; /* CAN FD frames skipped */
    uint64_t offset_us; /* writing: added to each t_us */
    uint64_t now_us;    /* of the last frame, in the log's time */
} bus_candump_t;

/* Opens a log for reading. `interface` NULL takes all frames. now_us() is the time of the last
 * frame handed out. BUS_OK; BUS_BROKEN with the reason. */
int bus_candump_open(bus_candump_t *self, const char *path, const char *interface);

/*
 * Creates a log, or empties one; send() writes the frame with its own t_us plus `offset_us` (0, or
 * the wall clock's lead over the bus's, so that the log shows the time of day). Each line leaves
 * the program at once: the log of a crash is whole to its last line. BUS_OK; BUS_REFUSED (interface
 * name); BUS_BROKEN. What a full disk lost is told by send() and close().
 */
int bus_candump_create(bus_candump_t *self, const char *path, const char *interface,
                       uint64_t offset_us);

#endif
