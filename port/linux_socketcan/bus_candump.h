/*
 * The bus of bus.h over a log in the format of `candump -L`, one frame per line:
 *
 *     (1436509053.249713) can0 044#2A366C2B
 *
 * can-utils, cantools, python-can and SavvyCAN read this format, too. Ids of 29 bits have eight
 * digits, and so have error frames, with bit 29 set. Remote requests are `123#R` or `123#R8`. A
 * trailing R or T (received, sent) is ignored. CAN FD frames (`123##1112233`) are counted and
 * skipped. A last line without a line end may be truncated: the log ends before it (BUS_END), and
 * bus.text says so. Any other line is refused with its line number, after the frames before it were
 * returned.
 */
#ifndef BUS_CANDUMP_H
#define BUS_CANDUMP_H

#include <stdio.h>

#include "bus.h"

typedef struct {
    bus_t bus; /* first; fd is -1: a log never waits */
    FILE *file;
    const char *path;   /* the caller's string, not copied */
    char interface[16]; /* reading: return its frames only, "" for all; writing: the name */
    bool writing;
    uint64_t line;      /* lines read or written */
    uint64_t fd_frames; /* CAN FD frames skipped */
    uint64_t offset_us; /* writing: added to each t_us */
    uint64_t now_us;    /* of the last frame, in the log's time */
} bus_candump_t;

/* Opens a log for reading. `interface` NULL: all frames. now_us() is the time of the last frame
 * returned. Returns BUS_OK; BUS_REFUSED (interface name); BUS_BROKEN with the reason. */
int bus_candump_open(bus_candump_t *self, const char *path, const char *interface);

/*
 * Creates a log, or empties an existing one. send() writes the frame with its t_us plus
 * `offset_us`: 0, or wall clock minus bus clock, so that the log shows the time of day. Each line
 * is written at once, so after a crash the log is complete up to its last line. Returns BUS_OK;
 * BUS_REFUSED (interface name); BUS_BROKEN. send() and close() report a full disk, and a pipe that
 * nobody reads, or not fast enough.
 */
int bus_candump_create(bus_candump_t *self, const char *path, const char *interface,
                       uint64_t offset_us);

/* From now on send() waits for the reader of a pipe: for a program that keeps no time. */
void bus_candump_wait(bus_candump_t *self);

#endif
